//! Precisions of expressions.

use crate::ast::{ExprKind, Precision};
use crate::precision::Precisions;
use crate::{Shader, Stage};
use base::text::SourceFile;

/// The precision of the expression that is written so.
fn of(text: &str, stage: Stage, expression: &str) -> Option<Precision> {
    let parsed = Shader::parse(&SourceFile::new("a.glsl", text), stage);
    assert!(parsed.diagnostics.is_empty(), "{:#?}", parsed.diagnostics);
    let shader = parsed.shader;
    let precisions = Precisions::of(&shader);
    let found =
        shader.arena().iter().filter(|(id, e)| shader.text_of(*id) == expression && !matches!(e.kind, ExprKind::Error));
    let (id, _) = found.last().unwrap_or_else(|| panic!("`{expression}` is not in the text"));
    precisions.of_expr(id)
}

const HEAD: &str = "#version 100\nprecision mediump float;\nuniform highp float h;\nuniform lowp float l;\nuniform float m;\n\
                    uniform sampler2D s;\nvarying vec2 uv;\n";

fn fragment(body: &str, expression: &str) -> Option<Precision> {
    of(
        &format!("{HEAD}float g(highp float x) {{ return x; }}\nvoid main() {{ {body} }}\n"),
        Stage::Fragment,
        expression,
    )
}

#[test]
fn an_operation_has_the_highest_precision_of_its_operands() {
    assert_eq!(fragment("float x = m * l;", "m * l"), Some(Precision::Medium));
    assert_eq!(fragment("float x = m * h;", "m * h"), Some(Precision::High));
    assert_eq!(fragment("float x = l * 2.0;", "l * 2.0"), Some(Precision::Low));
    assert_eq!(fragment("float x = max(h, m);", "max(h, m)"), Some(Precision::High));
    assert_eq!(fragment("vec2 x = vec2(m, h).xy;", "vec2(m, h).xy"), Some(Precision::High));
}

#[test]
fn what_has_none_takes_that_of_what_it_goes_to() {
    assert_eq!(fragment("float x = 2.0 * 3.0;", "2.0 * 3.0"), Some(Precision::Medium));
    assert_eq!(fragment("highp float x = 2.0 * 3.0;", "2.0 * 3.0"), Some(Precision::High));
    assert_eq!(fragment("float x = g(1.0 + 2.0);", "1.0 + 2.0"), Some(Precision::High));
}

#[test]
fn calls_and_texels_have_their_own() {
    assert_eq!(fragment("float x = g(m);", "g(m)"), Some(Precision::Medium), "what it returns");
    assert_eq!(fragment("vec4 x = texture2D(s, uv);", "texture2D(s, uv)"), Some(Precision::Low), "its sampler");
    assert_eq!(fragment("vec4 x = texture2D(s, uv);", "uv"), Some(Precision::Medium), "not its sampler");
}

#[test]
fn defaults_are_those_of_the_stage_and_end_with_their_block() {
    let vertex = "#version 100\nattribute vec4 a;\nvoid main() { gl_Position = a * 2.0; }\n";
    assert_eq!(of(vertex, Stage::Vertex, "a * 2.0"), Some(Precision::High));
    assert_eq!(
        fragment("{ precision highp float; float x = 1.0 + 1.0; } float y = 3.0 + 3.0;", "1.0 + 1.0"),
        Some(Precision::High)
    );
    assert_eq!(
        fragment("{ precision highp float; float x = 1.0; } float y = 3.0 + 3.0;", "3.0 + 3.0"),
        Some(Precision::Medium)
    );
    let coordinate = "void main() { float x = gl_FragCoord.x * 2.0; }\n";
    let first = format!("#version 100\nprecision mediump float;\n{coordinate}");
    let third = format!("#version 300 es\nprecision mediump float;\n{coordinate}");
    assert_eq!(of(&first, Stage::Fragment, "gl_FragCoord.x * 2.0"), Some(Precision::Medium));
    assert_eq!(of(&third, Stage::Fragment, "gl_FragCoord.x * 2.0"), Some(Precision::High));
}

#[test]
fn desktop_qualifiers_mean_nothing_and_a_text_without_a_version_is_for_browsers() {
    let desktop = "#version 330\nuniform mediump float m;\nvoid main() { float x = m * 2.0; }\n";
    assert_eq!(of(desktop, Stage::Fragment, "m * 2.0"), None);
    let browser = "precision mediump float;\nuniform float m;\nvoid main() { float x = m * 2.0; }\n";
    assert_eq!(of(browser, Stage::Fragment, "m * 2.0"), Some(Precision::Medium));
}

#[test]
fn what_flows_into_something_precise_is_precise() {
    let text = "#version 450\nin float a;\nin float b;\nout float e;\nvoid main() {\n  float s = a + b;\n  float d = a * b;\n  \
                precise float r = (s - a) - b;\n  e = r + d;\n}\n";
    let parsed = Shader::parse(&SourceFile::new("a.vert", text), Stage::Vertex);
    let shader = parsed.shader;
    let precisions = Precisions::of(&shader);
    let precise = |expression: &str| {
        let found = shader.arena().iter().find(|(id, _)| shader.text_of(*id) == expression).unwrap();
        precisions.is_precise(found.0)
    };
    assert!(precise("(s - a) - b") && precise("a + b"));
    assert!(!precise("a * b") && !precise("r + d"));
}
