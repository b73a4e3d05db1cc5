//! Numbers of pixels that one stage of a program hands on to the next.

use analysis::pixels::{HandedOn, Pixels};
use reading::{Project, ShaderFile};
use syntax::Stage;

/// Powers of what the vertex stage of the same program hands on to a fragment stage, by name.
pub fn before(file: &ShaderFile, project: &Project) -> HandedOn {
    if file.shader.stage() != Stage::Fragment {
        return HandedOn::new();
    }
    let Some(vertex) = vertex_of(file, project) else { return HandedOn::new() };
    let defines = file.shader.defines();
    let same = vertex.shader.defines() == defines;
    let again = (!same).then(|| vertex.shader.with_defines(defines));
    let shader = again.as_ref().map_or(&vertex.shader, |parsed| &parsed.shader);
    Pixels::of(shader, &HandedOn::new()).handed_on()
}

/// The vertex stage that stands in the same file, or in one of the same name beside it; in host code the only one that hands on
/// all that this stage takes.
fn vertex_of<'p>(file: &ShaderFile, project: &'p Project) -> Option<&'p ShaderFile> {
    let name = file.file.name();
    let is = |shader: &&ShaderFile| shader.file.name() == name;
    let vertex = |shaders: Vec<&'p ShaderFile>| {
        let mut all = shaders.into_iter().filter(|shader| shader.shader.stage() == Stage::Vertex);
        all.next().filter(|_| all.next().is_none())
    };
    if let Some(section) = project.sections().into_iter().find(|section| section.iter().any(is)) {
        return vertex(section);
    }
    let Some(origin) = &file.origin else { return vertex(project.shaders_beside(name)) };
    let of_host =
        |shader: &&ShaderFile| shader.origin.as_ref().is_some_and(|other| other.host.name() == origin.host.name());
    let feeds = |shader: &&ShaderFile| {
        let own = &shader.shader.interface().outputs;
        file.shader.interface().inputs.iter().all(|input| own.iter().any(|output| output.name == input.name))
    };
    vertex(project.shaders().filter(of_host).filter(|s| s.shader.stage() == Stage::Vertex).filter(feeds).collect())
}
