//! Which shaders are linked together.

use std::collections::{BTreeMap, BTreeSet};

use crate::project::{Project, ShaderFile};
use hosts::HostFile;
use hosts::paths::{file_name, folder, stem};
use syntax::Stage;

use super::link::producer;
use super::{Known, Program};

/// All programs of a project whose stages are known for certain, each set of shaders once: those that
/// host files make, those that the configuration states, and shaders of one name in one folder that no
/// host file names.
pub fn find(project: &Project) -> Vec<Program<'_>> {
    let mut found: Vec<Program<'_>> = Vec::new();
    let mut named: BTreeSet<&str> = BTreeSet::new();
    for host in project.hosts() {
        let programs = host.programs();
        let shader = |r| project.shader_of(host, r);
        named.extend(programs.named.iter().filter_map(shader).map(|s| s.file.name()));
        for shaders in &programs.linked {
            let known: Option<Vec<&ShaderFile>> = shaders.iter().map(shader).collect();
            let known = known.map(|known| with_siblings(project, host, known));
            found.extend(known.and_then(|k| Program::new(k, true)));
        }
    }
    for entry in &project.config().programs {
        let program = project.configured(&entry.shaders);
        named.extend(program.iter().flat_map(|p| p.shaders()).map(|s| s.file.name()));
        found.extend(program.map(|p| p.known(Known::Config)));
    }
    let mut stems: BTreeMap<(&str, &str), Vec<&ShaderFile>> = BTreeMap::new();
    for (path, shader) in project.shader_files() {
        stems.entry((folder(path), stem(path))).or_default().push(shader);
    }
    for shaders in stems.into_values() {
        if is_one_program(&shaders) && !shaders.iter().any(|s| named.contains(s.file.name())) {
            found.extend(Program::new(shaders, true).map(|p| p.known(Known::Name)));
        }
    }
    for shaders in project.sections() {
        if is_one_program(&shaders) {
            found.extend(Program::new(shaders, true).map(|p| p.known(Known::Name)));
        }
    }
    for sets in project.document_programs().into_values() {
        let single = sets.len() == 1;
        for shaders in sets {
            if is_one_program(&shaders) && ((single && hands_on(&shaders)) || have_a_link(&shaders)) {
                found.extend(Program::new(shaders, true).map(|p| p.known(Known::Name)));
            }
        }
    }
    let mut seen = BTreeSet::new();
    found.retain(|p| seen.insert(p.names()));
    let mut uses: BTreeMap<&str, usize> = BTreeMap::new();
    for shader in found.iter().flat_map(|p| &p.shaders) {
        *uses.entry(shader.file.name()).or_default() += 1;
    }
    for program in &mut found {
        let names = program.shaders.iter().map(|s| s.file.name());
        program.shared = names.filter(|n| uses.get(n).is_some_and(|count| *count > 1)).collect();
    }
    found
}

/// The shaders of a program, with those between them that have the name of one of them and another ending, where the host
/// names their files as well: what loads `fire.vert`, `fire.frag` and `fire.gem`.
fn with_siblings<'p>(project: &'p Project, host: &HostFile, mut known: Vec<&'p ShaderFile>) -> Vec<&'p ShaderFile> {
    let between = [Stage::Geometry, Stage::TessControl, Stage::TessEvaluation];
    let place = |path: &str| (folder(path).to_owned(), stem(path).to_owned());
    let places: BTreeSet<(String, String)> = known.iter().map(|shader| place(shader.file.name())).collect();
    for (path, shader) in project.shader_files() {
        let stage = shader.shader.stage();
        let is_new = between.contains(&stage) && !known.iter().any(|own| own.shader.stage() == stage);
        if is_new && places.contains(&place(path)) && host.file.text().contains(file_name(path)) {
            known.push(shader);
        }
    }
    known
}

/// True for a vertex and a fragment shader, with at most one shader of each other stage.
fn is_one_program(shaders: &[&ShaderFile]) -> bool {
    let stages: Vec<Stage> = shaders.iter().map(|s| s.shader.stage()).collect();
    let other = |s: &Stage| matches!(s, Stage::Compute | Stage::Library);
    let distinct = stages.iter().enumerate().all(|(i, s)| !stages[..i].contains(s));
    distinct && stages.contains(&Stage::Vertex) && stages.contains(&Stage::Fragment) && !stages.iter().any(other)
}

/// True when the first stage is printed first and hands something on.
fn hands_on(shaders: &[&ShaderFile]) -> bool {
    shaders.first().is_some_and(|s| s.shader.stage() == Stage::Vertex && !s.shader.interface().outputs.is_empty())
}

/// True when each stage takes something that the one before hands on under that name.
fn have_a_link(shaders: &[&ShaderFile]) -> bool {
    let Some(program) = Program::new(shaders.to_vec(), true) else { return false };
    program.links().all(|(from, to)| {
        let inputs = &to.shader.interface().inputs;
        inputs.is_empty() || inputs.iter().any(|i| producer(from, to, i).is_some())
    })
}
