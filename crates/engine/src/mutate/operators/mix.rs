//! `mix(a, b, t)` replaced by `a` and by `b`.

use super::becomes;
use crate::mutate::{Code, Draft};

pub(super) fn make(code: &Code<'_>, drafts: &mut Vec<Draft>) {
    for &id in &code.exprs {
        let Some((name, args)) = code.built_in(id) else { continue };
        let ([a, b, _], "mix") = (args, name.name.as_str()) else { continue };
        for end in [*a, *b] {
            // An integer end would change the type of the whole.
            if code.shader.type_of(end) == code.shader.type_of(id) {
                let to = code.operand(end);
                drafts.push(Draft::new(code.replace(id, &*to), becomes(code.shader.text_of(id), &to)));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::mutate::testing::changes;

    #[test]
    fn mix_is_replaced_by_its_ends() {
        assert_eq!(
            changes("mix", "vec2 f(vec2 a, vec2 b, float t) {\n  return mix(a, b + a, t);\n}"),
            ["return a;", "return (b + a);"]
        );
    }
}
