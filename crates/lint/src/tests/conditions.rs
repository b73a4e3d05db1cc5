//! Rules about numbers behind conditions from outside.

use base::text::SourceFile;

use crate::Input;

#[test]
fn numbers_are_looked_at_behind_conditions_from_outside() {
    let found = |condition: &str, line: &str, more: &str| {
        let text = format!(
            "#version 330 core\n{more}\nin vec3 p;\nin vec3 q;\nout vec4 c;\nvoid main() {{\nfloat r = 0.0;\n\
             {condition}\n{line}\n#endif\nc = vec4(r);\n}}\n"
        );
        let found = crate::run(&[Input::new(SourceFile::new("a.frag", text))]);
        found
            .iter()
            .filter(|d| d.code.0.starts_with('N'))
            .map(|d| d.file.position(d.span.start).line)
            .collect::<Vec<_>>()
    };
    let line = "r = acos(dot(normalize(p), normalize(q)));";
    assert_eq!(found("#ifdef ANGLE", line, ""), [9]);
    assert_eq!(found("#if defined(ANGLE) && !defined(FLAT)", line, ""), [9]);
    assert_eq!(found("#ifndef FLAT", line, ""), [9]);
    assert_eq!(found("#ifdef ANGLE\n#ifdef NESTED", &format!("{line}\n#endif"), ""), [10]);
    assert_eq!(found("#ifdef ANGLE", "r = 1.0;", ""), [0usize; 0]);
    // What is a value as well is not made up, and what the text defines is known.
    assert_eq!(found("#if ANGLES > 0", &format!("r = float(ANGLES); {line}"), ""), [0usize; 0]);
    assert_eq!(found("#if ANGLE", line, "#define ANGLE 0"), [0usize; 0]);
}
