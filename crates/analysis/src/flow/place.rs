//! Which components of which variable an expression names.

use syntax::ast::{ExprId, ExprKind};
use syntax::swizzle::component;
use syntax::symbols::SymbolId;
use syntax::types::Type;
use syntax::{Const, Shader};

/// Most components of a variable that are followed one by one.
const MOST: u32 = 64;

/// Components of a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// The variable.
    pub root: SymbolId,
    /// A bit for each component.
    pub mask: u64,
    /// True when exactly these components are meant; false when an index that is not constant, or an
    /// element of an array, leaves open which.
    pub exact: bool,
}

/// Components of a type: those of scalars, vectors, matrices and of all members of a structure. An
/// array counts as one.
fn count(ty: &Type) -> u32 {
    match ty {
        Type::Scalar(_) | Type::Array(..) | Type::Opaque(_) | Type::Error | Type::Void => 1,
        Type::Vector(_, n) => u32::from(*n),
        Type::Matrix(_, columns, rows) => u32::from(*columns) * u32::from(*rows),
        Type::Struct(s) => s.fields.iter().fold(0u32, |sum, f| sum.saturating_add(count(&f.ty))).max(1),
    }
}

/// The components of a variable of this type that are followed: one for all when there are too many.
fn followed(ty: &Type) -> u32 {
    let all = count(ty);
    if all > MOST { 1 } else { all }
}

/// A bit for each followed component.
pub fn full(ty: &Type) -> u64 {
    u64::MAX >> (MOST - followed(ty))
}

/// The components that an expression names, when it is a variable or a part of one.
pub fn place(shader: &Shader, id: ExprId) -> Option<Place> {
    let walk = walk(shader, id)?;
    let mask = walk.components.iter().fold(0, |mask, c| mask | 1u64 << c);
    Some(Place { root: walk.root, mask, exact: walk.exact })
}

struct Walk {
    root: SymbolId,
    /// Followed components in the order of the value.
    components: Vec<u32>,
    exact: bool,
}

fn walk(shader: &Shader, id: ExprId) -> Option<Walk> {
    match &shader.expr(id).kind {
        ExprKind::Name(_) => {
            let root = shader.symbol_of(id)?;
            Some(Walk { root, components: (0..followed(&shader.symbol(root).ty)).collect(), exact: true })
        }
        ExprKind::Paren(inner) => walk(shader, *inner),
        ExprKind::Index { base, index } => {
            let mut walk = walk(shader, *base)?;
            let ty = shader.type_of(*base);
            let part = match ty {
                Type::Vector(..) => Some(1),
                Type::Matrix(_, _, rows) => Some(usize::from(*rows)),
                _ => None,
            };
            let at = shader.fold(*index).and_then(Const::as_integer).and_then(|i| usize::try_from(i).ok());
            match (part, at) {
                (Some(part), Some(at)) if walk.exact && walk.components.len() == count(ty) as usize => {
                    walk.components = walk.components.get(at * part..(at + 1) * part)?.to_vec();
                }
                _ => walk.exact = false,
            }
            Some(walk)
        }
        ExprKind::Field { base, field } => {
            let mut walk = walk(shader, *base)?;
            let ty = shader.type_of(*base);
            if !walk.exact || walk.components.len() != count(ty) as usize {
                walk.exact = false;
                return Some(walk);
            }
            match ty {
                Type::Struct(s) => {
                    let at = s.fields.iter().position(|f| f.name == field.name)?;
                    let before: u32 = s.fields[..at].iter().map(|f| count(&f.ty)).sum();
                    let len = count(&s.fields[at].ty);
                    walk.components = walk.components.get(before as usize..(before + len) as usize)?.to_vec();
                }
                Type::Scalar(_) | Type::Vector(..) => {
                    let picked: Option<Vec<u32>> =
                        field.name.chars().map(|c| walk.components.get(component(c)?).copied()).collect();
                    walk.components = picked?;
                }
                Type::Error | Type::Void | Type::Matrix(..) | Type::Opaque(_) | Type::Array(..) => return None,
            }
            Some(walk)
        }
        ExprKind::Literal(_)
        | ExprKind::Method { .. }
        | ExprKind::Call { .. }
        | ExprKind::Unary { .. }
        | ExprKind::Postfix { .. }
        | ExprKind::Binary { .. }
        | ExprKind::Assign { .. }
        | ExprKind::Ternary { .. }
        | ExprKind::Comma { .. }
        | ExprKind::List(_)
        | ExprKind::Error => None,
    }
}

/// The letters of the components of a vector that a mask has, such as `zw`; none for other types.
pub fn letters(ty: &Type, mask: u64) -> Option<String> {
    let Type::Vector(_, n) = ty else { return None };
    Some("xyzw".chars().take(usize::from(*n)).enumerate().filter(|(i, _)| mask >> i & 1 == 1).map(|(_, c)| c).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use base::text::SourceFile;
    use syntax::Stage;

    /// The mask of the last expression statement's target, and whether it is exact.
    fn of(target: &str) -> (u64, bool) {
        let text = format!(
            "struct S {{ vec3 a; float b[9]; mat2 m; }};\nvoid main() {{ vec4 v; mat3 m; S s; float f[4]; int i = 0; {target} = {target}; }}"
        );
        let parsed = Shader::parse(&SourceFile::new("a.vert", text), Stage::Vertex);
        assert!(parsed.diagnostics.is_empty(), "{:#?}", parsed.diagnostics);
        let shader = parsed.shader;
        let (id, _) = shader.arena().iter().find(|(_, e)| matches!(e.kind, ExprKind::Assign { .. })).unwrap();
        let ExprKind::Assign { target, .. } = shader.expr(id).kind else { unreachable!() };
        let place = place(&shader, target).unwrap();
        (place.mask, place.exact)
    }

    #[test]
    fn components_are_told_apart() {
        assert_eq!(of("v"), (0b1111, true));
        assert_eq!(of("v.zx"), (0b0101, true));
        assert_eq!(of("(v).ab.y"), (0b0100, true));
        assert_eq!(of("v[2]"), (0b0100, true));
        assert_eq!(of("v[i]"), (0b1111, false));
        assert_eq!(of("m[1].yz"), (0b000_110_000, true));
        assert_eq!(of("s.a.y"), (0b010, true));
        assert_eq!(of("s.b[3]"), (0b1000, false));
        assert_eq!(of("s.m[1]"), (0b1100_0000, true));
        assert_eq!(of("f[1]"), (1, false));
    }
}
