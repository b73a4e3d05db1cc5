//! What tests of operators share.

use super::operators::by_name;
use super::{Mutant, mutants};
use base::text::SourceFile;
use program::Program;
use program::lower::Target;
use syntax::{Shader, Stage};

/// A function that every operator finds something in.
pub(super) const ALL: &str = "const float K = 0.5;
vec4 f(mat4 m, vec4 v, vec4 u, int n, bool b) {
  for (int i = 0; i < n; ++i) {
    if (i > 2 && !b) v = v + u;
    v *= mix(1.0, 2.0, K);
  }
  return m * v.xyzw - vec4(sin(v.x), -v.y, 3.0, 1.0);
}";

pub(super) fn vertex(declarations: &str, body: &str) -> String {
    format!("{declarations}\nvoid main() {{\n{body}\n}}")
}

/// A geometry shader over points.
pub(super) fn geometry(body: &str) -> String {
    format!("layout(points) in;\nlayout(points, max_vertices = 4) out;\nvoid main() {{\n{body}\n}}")
}

/// The mutants of one operator; each must go through the front end and become a program.
fn made(operator: &str, text: &str) -> (SourceFile, Vec<Mutant>) {
    let stage = if text.contains("max_vertices") {
        Stage::Geometry
    } else if text.contains("void main") {
        Stage::Vertex
    } else {
        Stage::Library
    };
    let (entry, target) = match stage {
        Stage::Library => ("f", Target::Function("f".to_owned())),
        _ => ("main", Target::Stage),
    };
    let compile = |file: &SourceFile| {
        let parsed = Shader::parse(file, stage);
        assert!(parsed.diagnostics.is_empty(), "{}\n{:?}", file.text(), parsed.diagnostics);
        Program::build(&parsed.shader, &target).unwrap_or_else(|e| panic!("{}\n{e}", file.text()));
        parsed.shader
    };
    let file = SourceFile::new("test", format!("#version 150 core\n{text}\n"));
    let shader = compile(&file);
    let mutants = mutants(&shader, entry, &[by_name(operator).unwrap()]);
    mutants.iter().for_each(|m| drop(compile(&m.shader)));
    (file, mutants)
}

/// For each mutant, the line that it changes, without leading blanks.
pub(super) fn changes(operator: &str, text: &str) -> Vec<String> {
    let (file, mutants) = made(operator, text);
    let changed = |m: &Mutant| {
        let mut lines = file.text().lines().zip(m.shader.text().lines()).filter(|(a, b)| a != b).map(|(_, b)| b.trim());
        let line = lines.next().unwrap().to_owned();
        assert_eq!(lines.next(), None, "{}", m.what);
        line
    };
    mutants.iter().map(changed).collect()
}

/// Mutants that are known to mean the same.
pub(super) fn identities(operator: &str, text: &str) -> usize {
    made(operator, text).1.iter().filter(|m| m.identity.is_some()).count()
}
