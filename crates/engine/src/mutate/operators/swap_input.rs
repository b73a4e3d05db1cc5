//! One use of an input or uniform replaced by another one of the same type.

use super::becomes;
use crate::mutate::{Code, Draft};
use base::text::Edit;

pub(super) fn make(code: &Code<'_>, drafts: &mut Vec<Draft>) {
    let inputs = code.inputs();
    for used in code.shader.uses() {
        let reached = used.function.is_some_and(|f| code.reaches(f));
        if used.from_macro || used.access.writes() || !reached || !inputs.contains(&used.symbol) {
            continue;
        }
        let own = code.shader.symbol(used.symbol);
        for &id in inputs.iter().filter(|id| **id != used.symbol) {
            let other = code.shader.symbol(id);
            // Parameters of one name may belong to several functions; a name must mean this one.
            if other.ty == own.ty && other.name != own.name {
                drafts.push(Draft::new(Edit::replace(used.span, &*other.name), becomes(&own.name, &other.name)));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::mutate::testing::{changes, vertex};

    #[test]
    fn a_parameter_gives_way_to_another_of_its_type() {
        assert_eq!(
            changes("swap-input", "float f(float a, float b, vec2 c) {\n  return a + c.x;\n}"),
            ["return b + c.x;"]
        );
    }

    #[test]
    fn uniforms_and_attributes_are_exchanged() {
        let text = vertex("in vec4 p, q;\nuniform vec4 u;\nuniform mat4 m;", "gl_Position = m * p;");
        assert_eq!(changes("swap-input", &text), ["gl_Position = m * q;", "gl_Position = m * u;"]);
    }

    #[test]
    fn locals_stay() {
        assert!(changes("swap-input", "float f(float a) {\n  float b = 1.0, c = 2.0;\n  return b;\n}").is_empty());
    }
}
