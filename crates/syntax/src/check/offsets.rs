//! `offset` and `align` of the members of blocks (GLSL 4.60 specification, section 4.4.5; OpenGL 4.6 specification,
//! section 7.6.2.2).

use super::super::ast::{InterfaceBlock, Qualifiers};
use super::super::interface::Storage;
use super::super::memory::packing_word;
use super::super::types::{ArraySize, ScalarType, Type};
use super::Checker;
use base::diagnostic::message;

/// Alignment and size in bytes; none where a size is not known.
pub fn extent_of(ty: &Type, std140: bool, row_major: bool) -> Option<(i64, i64)> {
    let up = |n: i64, to: i64| (n + to - 1) / to * to;
    let unit = |s: ScalarType| i64::from(s.bits() / 8);
    Some(match ty {
        Type::Scalar(s) => (unit(*s), unit(*s)),
        Type::Vector(s, n) => (unit(*s) * if *n == 2 { 2 } else { 4 }, unit(*s) * i64::from(*n)),
        Type::Matrix(s, columns, rows) => {
            let (count, length) = if row_major { (*rows, *columns) } else { (*columns, *rows) };
            let column = Type::Vector(*s, length).array(u32::from(count));
            return extent_of(&column, std140, row_major);
        }
        Type::Array(element, size) => {
            let (align, bytes) = extent_of(element, std140, row_major)?;
            let align = if std140 { up(align, 16) } else { align };
            let count = match size {
                ArraySize::Known(n) => i64::from(*n),
                // The last member, as long as its buffer.
                ArraySize::Unsized => 0,
                ArraySize::Unknown => return None,
            };
            (align, up(bytes, align).checked_mul(count)?)
        }
        Type::Struct(s) => {
            let (mut most, mut at) = (if std140 { 16 } else { 1 }, 0i64);
            for field in &s.fields {
                let (align, bytes) = extent_of(&field.ty, std140, row_major)?;
                most = most.max(align);
                at = up(at, align).checked_add(bytes)?;
            }
            (most, up(at, most))
        }
        Type::Void | Type::Error | Type::Opaque(_) => return None,
    })
}

impl Checker<'_> {
    /// Rules of the offsets in a block; `members` are types with their qualifiers.
    pub(super) fn offset_rules(&mut self, block: &InterfaceBlock, storage: Storage, members: &[(Type, &Qualifiers)]) {
        let moved = |q: &Qualifiers| q.layout_entry("offset").or_else(|| q.layout_entry("align")).cloned();
        let first = members.iter().find_map(|m| moved(m.1)).or_else(|| moved(&block.qualifiers));
        let (Some(first), Storage::Uniform | Storage::Buffer, false) = (first, storage, self.language.is_open()) else {
            return;
        };
        let defaults = self.out.interface.stage_layouts.iter().filter(|l| l.storage == Some(storage));
        let packing = packing_word(&block.qualifiers)
            .or_else(|| defaults.filter_map(|l| packing_word(&l.qualifiers)).next_back());
        let std140 = match packing.as_deref() {
            Some("std140") => true,
            Some("std430") => false,
            _ => {
                let why = message!(
                    "the block needs `std140` or `std430` for that",
                    "ブロックに `std140` か `std430` が必要です"
                );
                return self.layout_error(&first, why);
            }
        };
        let row_major = |q: &Qualifiers| q.layout_entry("row_major").is_some();
        let align = self.entry_number(&block.qualifiers, "align");
        let mut next = 0i64;
        for (ty, qualifiers) in members {
            let Some((base, bytes)) = extent_of(ty, std140, row_major(qualifiers) || row_major(&block.qualifiers))
            else {
                return;
            };
            let mut at = next;
            if let Some(entry) = qualifiers.layout_entry("offset") {
                let Some(offset) = self.entry_number(qualifiers, "offset") else { return };
                if offset % base != 0 {
                    let why = message!(
                        "the offset of `{ty}` is a multiple of {base}",
                        "`{ty}` のオフセットは {base} の倍数です"
                    );
                    return self.layout_error(entry, why);
                }
                if offset < next {
                    let why =
                        message!("the member before ends at byte {next}", "前のメンバーは {next} バイト目で終わります");
                    return self.layout_error(entry, why);
                }
                at = offset;
            }
            let align = self.entry_number(qualifiers, "align").or(align).unwrap_or(1).max(base).max(1);
            let Some(end) = ((at + align - 1) / align * align).checked_add(bytes) else { return };
            next = end;
        }
    }
}
