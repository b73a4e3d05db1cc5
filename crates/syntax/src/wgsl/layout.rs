//! Sizes and places in memory that host and shader share (WGSL, section 14.4 "Memory layout").

use std::collections::HashMap;

use super::super::ast::ExprId;
use super::super::fold::Const;
use super::syntax::{Attribute, ModuleItem, TypeSyntax};

/// Where a type's values may begin, and how long they are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Extent {
    /// Bytes, a power of two.
    pub align: u64,
    /// Bytes; of a runtime-sized array, those of one element.
    pub size: u64,
}

/// A member of a structure in memory.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Placed {
    /// The name.
    pub name: String,
    /// The type as written.
    pub ty: String,
    /// Bytes from the start of the structure.
    pub offset: u64,
    /// Size and alignment.
    pub extent: Extent,
}

/// A structure in memory.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Layout {
    /// The members in order.
    pub members: Vec<Placed>,
    /// Of the whole.
    pub extent: Extent,
}

/// Computes layouts of a module.
pub(super) struct Layouts<'a> {
    pub items: &'a [ModuleItem],
    pub values: &'a [Option<Const>],
    pub text: &'a str,
    pub done: HashMap<String, Option<Layout>>,
    /// Types inside of types.
    pub depth: u32,
}

/// Types inside of types that are followed: an alias may stand for itself.
const DEEPEST: u32 = 100;

fn round_up(value: u64, align: u64) -> u64 {
    value.div_ceil(align) * align
}

impl Layouts<'_> {
    fn integer(&self, id: ExprId) -> Option<u64> {
        self.values.get(id.index()).copied().flatten()?.as_integer().and_then(|v| u64::try_from(v).ok())
    }

    fn attribute(&self, all: &[Attribute], name: &str) -> Option<Option<u64>> {
        let found = all.iter().find(|a| a.name.name == name)?;
        Some(found.args.first().and_then(|a| self.integer(*a)))
    }

    /// The layout of a structure; none where a member has none, or depends on what the text does not have.
    pub fn structure(&mut self, name: &str) -> Option<Layout> {
        if let Some(known) = self.done.get(name) {
            return known.clone();
        }
        // A structure inside of itself has no size.
        self.done.insert(name.to_owned(), None);
        let items = self.items;
        let members = items.iter().find_map(|i| match i {
            ModuleItem::Struct { name: n, members } if n.name == name => Some(members),
            _ => None,
        })?;
        let (mut placed, mut at, mut align) = (Vec::new(), 0, 1);
        for member in members {
            let mut extent = self.extent(&member.ty)?;
            if let Some(stated) = self.attribute(&member.attributes, "align") {
                extent.align = stated.filter(|a| a.is_power_of_two())?;
            }
            if let Some(stated) = self.attribute(&member.attributes, "size") {
                extent.size = stated?;
            }
            let offset = round_up(at, extent.align);
            (at, align) = (offset.checked_add(extent.size)?, align.max(extent.align));
            let ty = self.text.get(member.ty.span.range()).unwrap_or("").to_owned();
            placed.push(Placed { name: member.name.name.clone(), ty, offset, extent });
        }
        let layout = Layout { members: placed, extent: Extent { align, size: round_up(at, align) } };
        self.done.insert(name.to_owned(), Some(layout.clone()));
        Some(layout)
    }

    /// Size and alignment of a type.
    pub fn extent(&mut self, ty: &TypeSyntax) -> Option<Extent> {
        if self.depth >= DEEPEST {
            return None;
        }
        self.depth += 1;
        let extent = self.extent_here(ty);
        self.depth -= 1;
        extent
    }

    fn extent_here(&mut self, ty: &TypeSyntax) -> Option<Extent> {
        let name = ty.name.name.as_str();
        let items = self.items;
        if let Some(ModuleItem::Alias { ty, .. }) =
            items.iter().find(|i| matches!(i, ModuleItem::Alias { name: n, .. } if n.name == name))
        {
            return self.extent(ty);
        }
        let inner = |n: usize| ty.args.get(n).and_then(|a| a.ty.as_ref());
        match name {
            "array" => {
                let element = self.extent(inner(0)?)?;
                let stride = round_up(element.size, element.align);
                let count = match ty.args.get(1) {
                    Some(count) => self.integer(count.expr?)?,
                    None => 1,
                };
                return Some(Extent { align: element.align, size: stride.checked_mul(count)? });
            }
            "atomic" => return self.extent(inner(0)?),
            _ => {}
        }
        if let Some(unit) = unit(name) {
            return Some(Extent { align: unit, size: unit });
        }
        // `vec3f` is `vec3` of `f`; so is `vec3<f32>`.
        let (stem, unit) = match inner(0) {
            Some(component) => (name, unit(&component.name.name)?),
            None => match (name.get(..name.len().checked_sub(1)?)?, name.chars().last()?) {
                (stem, 'f' | 'i' | 'u') => (stem, 4),
                (stem, 'h') => (stem, 2),
                _ => return self.structure(name).map(|l| l.extent),
            },
        };
        let vector = |n: u64| Extent { align: unit * if n == 3 { 4 } else { n }, size: unit * n };
        let count = |t: &str| t.parse::<u64>().ok().filter(|n| (2..=4).contains(n));
        if let Some(n) = stem.strip_prefix("vec").and_then(count) {
            return Some(vector(n));
        }
        if let Some((columns, rows)) = stem.strip_prefix("mat").and_then(|s| s.split_once('x')) {
            let column = vector(count(rows)?);
            let size = count(columns)? * round_up(column.size, column.align);
            return Some(Extent { align: column.align, size });
        }
        self.structure(name).map(|l| l.extent)
    }
}

/// Bytes of a scalar that host and shader share.
fn unit(name: &str) -> Option<u64> {
    match name {
        "f32" | "i32" | "u32" => Some(4),
        "f16" => Some(2),
        _ => None,
    }
}
