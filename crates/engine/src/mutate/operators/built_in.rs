//! A built-in function replaced by a near one, or left out.

use super::becomes;
use crate::mutate::{Code, Draft};
use base::text::Edit;

/// Functions that take each other's arguments.
const NEAR: [(&str, &str); 10] = [
    ("sin", "cos"),
    ("asin", "acos"),
    ("sinh", "cosh"),
    ("min", "max"),
    ("floor", "ceil"),
    ("exp", "exp2"),
    ("log", "log2"),
    ("sqrt", "inversesqrt"),
    ("radians", "degrees"),
    ("round", "trunc"),
];

/// Functions that can be left out: their first argument has the type of the result.
const DROPPED: [&str; 8] = ["normalize", "clamp", "abs", "sqrt", "fract", "pow", "saturate", "reflect"];

pub(super) fn make(code: &Code<'_>, drafts: &mut Vec<Draft>) {
    for &id in &code.exprs {
        let Some((name, args)) = code.built_in(id) else { continue };
        let own = name.name.as_str();
        for (a, b) in NEAR {
            let other = if own == a {
                b
            } else if own == b {
                a
            } else {
                continue;
            };
            drafts.push(Draft::new(Edit::replace(name.span, other), becomes(own, other)));
        }
        let Some(&first) = args.first() else { continue };
        let replaced = if own == "length" && args.len() == 1 {
            let text = code.shader.text_of(first);
            format!("dot({text}, {text})")
        } else if DROPPED.contains(&own) && code.shader.type_of(first) == code.shader.type_of(id) {
            code.operand(first)
        } else {
            continue;
        };
        drafts.push(Draft::new(code.replace(id, &*replaced), becomes(code.shader.text_of(id), &replaced)));
    }
}

#[cfg(test)]
mod tests {
    use crate::mutate::testing::changes;

    #[test]
    fn functions_give_way_to_near_ones() {
        assert_eq!(
            changes("built-in", "float f(float a) {\n  return sin(a) + max(a, floor(a));\n}"),
            [
                "return cos(a) + max(a, floor(a));",
                "return sin(a) + min(a, floor(a));",
                "return sin(a) + max(a, ceil(a));"
            ]
        );
    }

    #[test]
    fn length_loses_its_root_and_others_are_left_out() {
        assert_eq!(
            changes("built-in", "float f(vec3 a) {\n  return clamp(length(a), 0.0, 1.0);\n}"),
            ["return length(a);", "return clamp(dot(a, a), 0.0, 1.0);"]
        );
        assert_eq!(changes("built-in", "vec3 f(vec3 a) {\n  return normalize(a - 1.0);\n}"), ["return (a - 1.0);"]);
    }

    #[test]
    fn a_function_of_the_shader_is_no_built_in() {
        let text = "float sine(float a) { return a; }\nfloat f(float a) {\n  return sine(a);\n}";
        assert!(changes("built-in", text).is_empty());
    }
}
