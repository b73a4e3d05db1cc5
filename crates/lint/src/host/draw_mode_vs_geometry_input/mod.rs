//! H023: a draw mode that the geometry shader does not take.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use hosts::HostFile;
use hosts::cpp::index::Index;
use hosts::cpp::program::{ProgramSource, is_call, whole};
use hosts::cpp::tree::{arguments, bare, callee, span};
use reading::Project;
use reading::program::resolve;
use syntax::Stage;
use syntax::interface::InputPrimitive;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("H023"),
    name: "draw-mode-vs-geometry-input",
    severity: Severity::Error,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Host(check),
};

fn check(host: &HostFile, project: &Project, findings: &mut Findings<'_>) {
    if !host.file.text().contains("glDraw") && !host.file.text().contains("glMultiDraw") {
        return;
    }
    let Some(index) = Index::new(host) else { return };
    let source = whole(&index);
    if !matches!(source, ProgramSource::Named(_)) {
        return;
    }
    let Some(program) = resolve(host, project, &source) else { return };
    let tessellated = program.stage(Stage::TessEvaluation).is_some() || program.stage(Stage::TessControl).is_some();
    let Some(shader) = program.stage(Stage::Geometry).filter(|_| program.is_complete() && !tessellated) else { return };
    let Some(input) = shader.shader.interface().geometry.input else { return };
    // With a second program it is not known which one draws.
    let mut used: Vec<&str> = index
        .calls
        .iter()
        .filter(|c| is_call(host, **c, "glUseProgram"))
        .filter_map(|c| arguments(*c).first().map(|a| host.text(bare(*a))))
        .filter(|a| *a != "0")
        .collect();
    used.sort_unstable();
    used.dedup();
    let [only] = used.as_slice() else { return };
    // The one that is used has to be the one that is made here.
    let made = index.writes.iter().any(|w| host.text(w.target) == *only);
    if !made {
        return;
    }
    for &call in &index.calls {
        let draws =
            callee(call, &host.file).is_some_and(|(f, _)| f.starts_with("glDraw") || f.starts_with("glMultiDraw"));
        let Some(mode) = arguments(call).first().map(|a| bare(*a)).filter(|_| draws) else { continue };
        let text = host.text(mode);
        let Some(primitive) = primitive(text).filter(|p| *p != input.value) else { continue };
        let wanted = input.value.name();
        let given = primitive.name();
        findings.push(
            findings
                .at(
                    &host.file,
                    span(mode),
                    message!(
                        "`{text}` gives {given}, but the geometry shader takes {wanted}",
                        "`{text}` は {given} ですが、ジオメトリシェーダが受け取るのは {wanted} です"
                    ),
                )
                .with_label(message!("GL_INVALID_OPERATION", "GL_INVALID_OPERATION になります"))
                .with_related(&shader.file, input.span, message!("the input primitive", "入力プリミティブ"))
                .with_why(message!(
                    "the mode has to give the input primitive of the geometry shader; otherwise nothing is drawn",
                    "描画の種類はジオメトリシェーダの入力プリミティブに合わせる必要があり、合わないと何も描かれません"
                ))
                .with_help(message!(
                    "draw with a mode of {wanted}, or change the layout",
                    "{wanted} の種類で描くか、layout を変えてください"
                )),
        );
    }
}

/// The primitive that a mode gives to a geometry shader.
fn primitive(mode: &str) -> Option<InputPrimitive> {
    Some(match mode {
        "GL_POINTS" => InputPrimitive::Points,
        "GL_LINES" | "GL_LINE_STRIP" | "GL_LINE_LOOP" => InputPrimitive::Lines,
        "GL_LINES_ADJACENCY" | "GL_LINE_STRIP_ADJACENCY" => InputPrimitive::LinesAdjacency,
        "GL_TRIANGLES" | "GL_TRIANGLE_STRIP" | "GL_TRIANGLE_FAN" => InputPrimitive::Triangles,
        "GL_TRIANGLES_ADJACENCY" | "GL_TRIANGLE_STRIP_ADJACENCY" => InputPrimitive::TrianglesAdjacency,
        _ => return None,
    })
}
