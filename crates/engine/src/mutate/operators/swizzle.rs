//! Components permuted and replaced: neighbours exchanged, each replaced by every other one.

use super::becomes;
use crate::mutate::{Code, Draft};
use base::text::Edit;
use syntax::ast::ExprKind;
use syntax::swizzle::SETS;
use syntax::types::Type;

pub(super) fn make(code: &Code<'_>, drafts: &mut Vec<Draft>) {
    for &id in &code.exprs {
        let ExprKind::Field { base, field } = &code.shader.expr(id).kind else { continue };
        let Type::Vector(_, size) = code.shader.type_of(*base) else { continue };
        let chars: Vec<char> = field.name.chars().collect();
        let Some(set) = SETS.iter().find(|set| chars.iter().all(|c| set.contains(*c))) else { continue };
        let mut others = Vec::new();
        for k in 0..chars.len().saturating_sub(1) {
            let mut other = chars.clone();
            other.swap(k, k + 1);
            others.push(other);
        }
        for k in 0..chars.len() {
            for component in set.chars().take(usize::from(*size)) {
                let mut other = chars.clone();
                other[k] = component;
                // What is written must name each component once.
                if !code.is_written(id) || chars.len() == 1 {
                    others.push(other);
                }
            }
        }
        for other in others.into_iter().filter(|other| *other != chars) {
            let other: String = other.into_iter().collect();
            let what = becomes(&format!(".{}", field.name), &format!(".{other}"));
            let same = |c: char| set.find(c).and_then(|k| code.component(*base, k));
            let equal =
                chars.iter().zip(other.chars()).all(|(a, b)| *a == b || (same(*a).is_some() && same(*a) == same(b)));
            let mut draft = Draft::new(Edit::replace(field.span, other), what);
            draft.identity = equal.then_some("the constant has the same value in both components");
            drafts.push(draft);
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::mutate::testing::{changes, identities};

    #[test]
    fn a_component_is_replaced_by_every_other_one_of_its_set() {
        assert_eq!(changes("swizzle", "float f(vec3 v) {\n  return v.s;\n}"), ["return v.t;", "return v.p;"]);
    }

    #[test]
    fn neighbours_are_exchanged() {
        let made = changes("swizzle", "vec2 f(vec2 v) {\n  return v.xy;\n}");
        assert_eq!(made, ["return v.yx;", "return v.yy;", "return v.xx;"]);
    }

    #[test]
    fn a_written_swizzle_keeps_each_component_once() {
        let made = changes("swizzle", "vec2 f(vec2 v) {\n  v.xy = vec2(1.0, 2.0);\n  return v;\n}");
        assert_eq!(made, ["v.yx = vec2(1.0, 2.0);"]);
    }

    #[test]
    fn equal_components_of_a_constant_are_known() {
        let text = "const vec2 K = vec2(2.0, 2.0);\nfloat f(float a) {\n  return a * K.x;\n}";
        assert_eq!((changes("swizzle", text).len(), identities("swizzle", text)), (1, 1));
        assert_eq!(identities("swizzle", &text.replacen("2.0,", "3.0,", 1)), 0);
    }

    #[test]
    fn members_of_structures_are_no_components() {
        let text = "struct S { float x; float y; };\nfloat f(float a) {\n  S s = S(a, a);\n  return s.x;\n}";
        assert!(changes("swizzle", text).is_empty());
    }
}
