//! What is wrong in parts of a text that only a macro from outside switches on: hosts define what an `#if` asks.

use base::diagnostic::Diagnostic;
use base::text::Span;
use syntax::errors::Around;
use syntax::{Parsed, Shader, TokenPlace, errors};

use crate::conditions::{self, Conditions};
use crate::open::{self, Surroundings};

/// Names that are tried one by one at most.
const MOST: usize = 8;

/// Errors in parts that macros from outside switch on, with true for what is certain: each holds under every definition
/// that was tried and that switches its place on.
pub fn errors(shader: &Shader) -> Vec<(bool, Diagnostic)> {
    let conditions = Conditions::of(shader);
    let asked = conditions.undefined(false);
    if asked.is_empty() || !shader.defines().is_empty() {
        return Vec::new();
    }
    // A piece is put into shaders of any version; conversions differ between versions.
    let stated = shader.version().span.is_some();
    let whole = shader.function("main").is_some();
    let outside = if stated { !Around::TYPES } else { Around::all() };
    // All at once may contradict each other.
    let many = asked.len() > MOST;
    let mut sets = conditions::each_and_all(&asked);
    if many {
        sets.drain(..asked.len());
    }
    let mut found: Vec<(bool, Diagnostic)> = Vec::new();
    let mut tried: Vec<Parsed> = Vec::new();
    for defines in sets {
        let parsed = shader.with_defines(&defines);
        let surroundings = Surroundings::new(&parsed.shader, &conditions, &parsed.diagnostics);
        for error in &parsed.diagnostics {
            let told = |(_, d): &(bool, Diagnostic)| open::stands_in(std::slice::from_ref(d), error);
            if is_active(shader, error.span) || found.iter().any(told) {
                continue;
            }
            let name = error.file.slice(error.span);
            // The macro stands where a name is wanted: what guards a declaration has taken its name.
            let own = error.code == errors::SYNTAX && defines.iter().any(|(macro_name, _)| macro_name == name);
            let unsure = open::is_of_unknown_value(&parsed.shader, &asked, error);
            let of_names = open::is_of_another(error) || errors::is_name(error.code);
            let open = unsure || of_names || surroundings.leave_open(error, outside);
            let certain = own || (!many && whole && !open);
            let unknown = error.code == errors::UNKNOWN_NAME && !syntax::is_macro(name);
            let of_types = !errors::rests_on(error.code).intersects(!(Around::TYPES | Around::VALUES));
            let on_request = !many && (unknown || of_types);
            if certain || on_request {
                found.push((certain, error.clone()));
            }
        }
        tried.push(parsed);
    }
    found.retain(|(_, error)| {
        let holds = |p: &Parsed| !is_active(&p.shader, error.span) || open::stands_in(&p.diagnostics, error);
        tried.iter().all(holds)
    });
    found
}

/// True for a place that is compiled.
fn is_active(shader: &Shader, span: Span) -> bool {
    conditions::place_of(shader, span) == Some(TokenPlace::Text)
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
