//! Files that hold several shaders, each behind a line that says its stage: `#type vertex`,
//! `#shader fragment`. Hosts cut them apart.

use base::text::{SourceFile, Span};
use syntax::Stage;

use super::host::Literal;

/// The shaders of such a file; none when it is one shader.
pub fn sections(file: &SourceFile) -> Vec<(Stage, Literal)> {
    let text = file.text();
    let mut marks: Vec<(usize, usize, Stage)> = Vec::new();
    let mut at = 0;
    for line in text.split_inclusive('\n') {
        if let Some(stage) = mark(line) {
            marks.push((at, at + line.len(), stage));
        }
        at += line.len();
    }
    // What stands in front of the first shader belongs to none, or to all: only comments are clear.
    let Some(&(first, ..)) = marks.first() else { return Vec::new() };
    let plain = |line: &str| line.trim().is_empty() || line.trim_start().starts_with("//");
    if !text[..first].lines().all(plain) {
        return Vec::new();
    }
    let ends = marks.iter().skip(1).map(|m| m.0).chain([text.len()]);
    marks
        .iter()
        .zip(ends)
        .map(|(&(_, start, stage), end)| (stage, Literal::part(file, Span::new(start, end))))
        .collect()
}

/// The stage that a line says.
fn mark(line: &str) -> Option<Stage> {
    let mut words = line.trim_start().strip_prefix('#')?.split_whitespace();
    if !matches!(words.next()?, "type" | "shader" | "stage") {
        return None;
    }
    let stage = words.next()?.to_ascii_lowercase();
    words.next().is_none().then_some(())?;
    Some(match stage.as_str() {
        "vertex" | "vert" | "vs" => Stage::Vertex,
        "fragment" | "frag" | "pixel" | "fs" => Stage::Fragment,
        "geometry" | "geom" | "gs" => Stage::Geometry,
        "compute" | "comp" | "cs" => Stage::Compute,
        "tesscontrol" | "tess_control" | "tesc" => Stage::TessControl,
        "tesseval" | "tess_evaluation" | "tese" => Stage::TessEvaluation,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use crate::{Input, run};
    use base::text::SourceFile;

    fn reported(text: &str) -> Vec<String> {
        let file = SourceFile::new("both.glsl", text);
        let found = run(&[Input::new(file)]);
        found.iter().map(|d| format!("{} {} {}", d.code, d.file.locate(d.span.start), d.message)).collect()
    }

    const BOTH: &str = "// Both stages\n#type vertex\n#version 330 core\nlayout(location = 0) in vec3 p;\nout vec3 n;\n\
        void main() { n = p; gl_Position = vec4(p, 1.0); }\n\n#type fragment\n#version 330 core\n\
        in vec3 n;\nout vec4 c;\nvoid main() { c = vec4(n, 1.0); }\n";

    #[test]
    fn both_shaders_are_read() {
        assert_eq!(reported(BOTH), [""; 0]);
        let wrong = BOTH.replace("vec4(n, 1.0)", "vec3(n, 1.0)");
        let found = reported(&wrong);
        assert_eq!(found.len(), 1, "{found:?}");
        assert!(found[0].contains("both.glsl:12:19"), "{found:?}");
    }

    #[test]
    fn other_languages_under_the_same_ending_are_left_alone() {
        let file = SourceFile::new("toon.shader", "Shader \"Toon\" { SubShader { Pass { CGPROGRAM ENDCG } } }\n");
        assert!(run(&[Input::new(file)]).is_empty());
        let file = SourceFile::new("both.shader", BOTH.replace("#type", "#shader").replace("vec4(n", "vec3(n"));
        assert_eq!(run(&[Input::new(file)]).len(), 1);
    }

    #[test]
    fn they_are_linked() {
        let apart = BOTH.replace("in vec3 n;", "in vec3 normal;").replace("vec4(n, 1.0)", "vec4(normal, 1.0)");
        let found = reported(&apart);
        assert!(found.iter().any(|f| f.starts_with("I001")), "{found:?}");
    }
}
