//! What is wrong in parts of a text that only a macro from outside switches on: hosts define what an `#if` asks.

use base::diagnostic::{Code, Diagnostic};
use base::text::Span;
use syntax::{Shader, TokenPlace, errors};

use crate::context;

/// Names that are tried one by one at most.
const MOST: usize = 8;

/// Errors of types, which no declaration in front takes away.
pub const CERTAIN: [Code; 11] = [
    errors::ASSIGN_TYPE,
    errors::OPERAND_TYPE,
    errors::CONDITION_TYPE,
    errors::RETURN_TYPE,
    errors::ASSIGN_SIZE,
    errors::MATRIX_SIZE,
    errors::SCALAR_SWIZZLE,
    errors::SWIZZLE,
    errors::VECTOR_RELATION,
    errors::TOO_MANY,
    errors::TOO_FEW,
];

/// Errors in parts that macros from outside switch on, with true for what is certain: each holds under every definition
/// that was tried and that switches its place on.
pub fn errors(shader: &Shader) -> Vec<(bool, Diagnostic)> {
    let (mut asked, set) = context::conditions(shader);
    asked.retain(|name| !set.contains(name) && !name.starts_with("GL_") && !name.starts_with("__"));
    if asked.is_empty() || !shader.defines().is_empty() {
        return Vec::new();
    }
    // A piece is put into shaders of any version; conversions differ between versions.
    let stated = shader.version().span.is_some();
    let whole = shader.function("main").is_some();
    let holds = |code: Code| {
        whole && CERTAIN.contains(&code) && (stated || ![errors::ASSIGN_TYPE, errors::OPERAND_TYPE].contains(&code))
    };
    // All at once may contradict each other.
    let many = asked.len() > MOST;
    let each = asked.iter().filter(|_| !many).map(|name| vec![(name.clone(), "1".to_owned())]);
    let all = (asked.len() > 1).then(|| asked.iter().map(|name| (name.clone(), "1".to_owned())).collect::<Vec<_>>());
    let mut found: Vec<(bool, Diagnostic)> = Vec::new();
    let mut tried: Vec<Shader> = Vec::new();
    let mut told: Vec<Vec<(Code, Span)>> = Vec::new();
    for defines in each.chain(all) {
        let parsed = shader.with_defines(&defines);
        for error in &parsed.diagnostics {
            if is_active(shader, error.span) || found.iter().any(|(_, d)| same(d, (error.code, error.span))) {
                continue;
            }
            let name = error.file.slice(error.span);
            // The macro stands where a name is wanted: what guards a declaration has taken its name.
            let own = error.code == errors::SYNTAX && defines.iter().any(|(macro_name, _)| macro_name == name);
            let certain = own || (!many && holds(error.code));
            let unknown = error.code == errors::UNKNOWN_NAME && !context::is_macro(name);
            let on_request = !many && (unknown || CERTAIN.contains(&error.code));
            if certain || on_request {
                found.push((certain, error.clone()));
            }
        }
        told.push(parsed.diagnostics.iter().map(|d| (d.code, d.span)).collect());
        tried.push(parsed.shader);
    }
    found.retain(|(_, error)| {
        let holds = |(shader, told): (&Shader, &Vec<(Code, Span)>)| {
            !is_active(shader, error.span) || told.iter().any(|t| same(error, *t))
        };
        tried.iter().zip(&told).all(holds)
    });
    found
}

fn same(error: &Diagnostic, (code, span): (Code, Span)) -> bool {
    error.code == code && error.span.start == span.start
}

/// True for a place that is compiled.
fn is_active(shader: &Shader, span: Span) -> bool {
    let all = shader.tokens();
    let at = all.partition_point(|t| t.span.end <= span.start);
    all.get(at).is_some_and(|t| t.place == TokenPlace::Text)
}

#[cfg(test)]
mod tests {
    use base::text::SourceFile;

    use crate::{Input, Level, Selection, Settings, run_with};

    fn reported(text: &str, level: Level) -> Vec<String> {
        let selection = Selection::new(&["E".to_owned(), "T".to_owned()], &[]).unwrap().at(level);
        let input = Input::new(SourceFile::new("a.frag", text));
        let found = run_with(&[input], &Settings { selection, ..Settings::default() });
        found.iter().map(|d| format!("{} {}", d.code, d.file.locate(d.span.start))).collect()
    }

    fn cutoff(ty: &str) -> String {
        format!(
            "#version 330\nuniform {ty} cutoff;\nout vec4 c;\nvoid main() {{\n  c = vec4(1.0);\n#ifdef CUTOFF\n  if (c.a < cutoff) discard;\n#endif\n}}\n"
        )
    }

    #[test]
    fn errors_behind_a_macro_from_outside_are_told() {
        assert_eq!(reported(&cutoff("vec4"), Level::Default), ["T010 a.frag:7:11"]);
        assert_eq!(reported(&cutoff("float"), Level::Default), [""; 0]);
    }

    #[test]
    fn a_name_that_is_the_macro_around_it_is_told() {
        let text = |name: &str| {
            format!(
                "#version 330\n#ifdef HAS_MAP\nuniform sampler2D {name};\n#endif\nout vec4 c;\nvoid main() {{ c = vec4(1.0); }}\n"
            )
        };
        assert_eq!(reported(&text("HAS_MAP"), Level::Default), ["E001 a.frag:3:19"]);
        assert_eq!(reported(&text("map"), Level::Default), [""; 0]);
    }

    #[test]
    fn what_another_macro_repairs_is_no_error() {
        let text = "#version 330\n#ifdef B\nin vec3 n;\n#else\nin vec2 n;\n#endif\nout vec4 c;\n\
            void main() {\n  c = vec4(1.0);\n#ifdef A\n  c.rgb = n;\n#endif\n}\n";
        assert_eq!(reported(text, Level::Default), [""; 0]);
        let name = "#version 330\n#ifdef A\nconst float edge = 1.0;\n#endif\nout vec4 c;\nvoid main() {\n  c = vec4(1.0);\n\
            #ifdef B\n  c.r = edge + rim;\n#endif\n}\n";
        assert_eq!(reported(name, Level::Default), [""; 0]);
        assert_eq!(reported(name, Level::Strict), ["E020 a.frag:9:16"]);
    }
}
