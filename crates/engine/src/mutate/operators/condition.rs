//! A condition negated: of a branch, a loop or `?:`.

use crate::mutate::{Code, Draft};

pub(super) fn make(code: &Code<'_>, drafts: &mut Vec<Draft>) {
    for &condition in code.conditions.iter().filter(|id| code.is_plain(**id)) {
        let text = code.shader.text_of(condition);
        let edit = code.replace(condition, format!("!({text})"));
        drafts.push(Draft::new(edit, format!("the condition `{text}` is negated")));
    }
}

#[cfg(test)]
mod tests {
    use crate::mutate::testing::changes;

    #[test]
    fn conditions_of_branches_loops_and_selections_are_negated() {
        let text = "float f(float a) {\n  for (int i = 0; i < 4; ++i)\n    if (a < 1.0) a += 1.0;\n  return a > 2.0 ? a : 2.0;\n}";
        assert_eq!(
            changes("condition", text),
            ["for (int i = 0; !(i < 4); ++i)", "if (!(a < 1.0)) a += 1.0;", "return !(a > 2.0) ? a : 2.0;"]
        );
    }
}
