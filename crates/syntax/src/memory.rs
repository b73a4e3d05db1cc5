//! Where the members of a block lie in memory (OpenGL 4.6 specification, section 7.6.2.2).

use super::Shader;
use super::ast::Qualifiers;
use super::check::extent_of;
use super::interface::{Block, Storage};

/// How the members of a block are packed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Packing {
    /// `std140`
    Std140,
    /// `std430`
    Std430,
}

impl Packing {
    /// The word in `layout(…)`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Std140 => "std140",
            Self::Std430 => "std430",
        }
    }
}

/// A member of a block in memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Placement {
    /// Bytes from the start of the block.
    pub offset: u64,
    /// Bytes; 0 for an array without size.
    pub size: u64,
}

/// The word that says how a block is packed.
pub(super) fn packing_word(qualifiers: &Qualifiers) -> Option<String> {
    let keys = qualifiers.layouts().flat_map(|(entries, _)| entries).map(|entry| &entry.key.name);
    keys.filter(|k| matches!(k.as_str(), "std140" | "std430" | "shared" | "packed")).last().cloned()
}

impl Shader {
    /// How a block is packed; none where that is left to the implementation.
    pub fn packing(&self, block: &Block) -> Option<Packing> {
        let defaults = self.interface().stage_layouts.iter().filter(|l| l.storage == Some(block.storage));
        let word = packing_word(&block.qualifiers);
        match word.or_else(|| defaults.filter_map(|l| packing_word(&l.qualifiers)).next_back()).as_deref() {
            Some("std140") => Some(Packing::Std140),
            Some("std430") => Some(Packing::Std430),
            _ => None,
        }
    }

    /// Where the members of a uniform or storage block lie, in their order; none where the layout is left to the
    /// implementation, or a size is not known.
    pub fn placements(&self, block: &Block) -> Option<Vec<Placement>> {
        if !matches!(block.storage, Storage::Uniform | Storage::Buffer) {
            return None;
        }
        let packing = self.packing(block)?;
        let number = |qualifiers: &Qualifiers, key: &str| {
            let value = qualifiers.layout_entry(key).and_then(|entry| entry.value)?;
            self.fold(value)?.as_integer().filter(|n| *n >= 0)
        };
        let row_major = |q: &Qualifiers| q.layout_entry("row_major").is_some();
        let column_major = |q: &Qualifiers| q.layout_entry("column_major").is_some();
        let mut next = 0i64;
        let mut placed = Vec::new();
        for member in &block.members {
            let by_row =
                row_major(&member.qualifiers) || row_major(&block.qualifiers) && !column_major(&member.qualifiers);
            let (base, size) = extent_of(&member.ty, packing == Packing::Std140, by_row)?;
            let align = number(&member.qualifiers, "align").or_else(|| number(&block.qualifiers, "align"));
            let align = align.unwrap_or(1).max(base).max(1);
            let at = number(&member.qualifiers, "offset").unwrap_or(next);
            let at = at.checked_add(align - 1)? / align * align;
            next = at.checked_add(size)?;
            placed.push(Placement { offset: u64::try_from(at).ok()?, size: u64::try_from(size).ok()? });
        }
        Some(placed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Stage;
    use base::text::SourceFile;

    fn offsets(packing: &str, members: &str) -> Option<Vec<(u64, u64)>> {
        let text = format!("#version 450\nlayout({packing}) buffer B {{ {members} }};\nvoid main() {{}}\n");
        let parsed = Shader::parse(&SourceFile::new("a.comp", text), Stage::Compute);
        assert!(parsed.diagnostics.is_empty(), "{:?}", parsed.diagnostics);
        let block = &parsed.shader.interface().blocks[0];
        Some(parsed.shader.placements(block)?.iter().map(|p| (p.offset, p.size)).collect())
    }

    /// Example of the specification of OpenGL, section 7.6.2.2, in its first members.
    #[test]
    fn members_lie_where_the_specification_puts_them() {
        let members = "float a; vec2 b; vec3 c; float f; float g[2]; mat2x3 h; vec3 last;";
        assert_eq!(
            offsets("std140", members),
            Some(vec![(0, 4), (8, 8), (16, 12), (28, 4), (32, 32), (64, 32), (96, 12)])
        );
        assert_eq!(
            offsets("std430", members),
            Some(vec![(0, 4), (8, 8), (16, 12), (28, 4), (32, 8), (48, 32), (80, 12)])
        );
        assert_eq!(
            offsets("std430", "layout(offset = 32) float a; layout(align = 64) float b;"),
            Some(vec![(32, 4), (64, 4)])
        );
        assert_eq!(offsets("shared", "float a;"), None);
        assert_eq!(offsets("std430", "int n; float all[];"), Some(vec![(0, 4), (4, 0)]));
    }
}
