//! W011: a structure that host and shader lay out differently.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Message, Severity, message};
use base::text::Span;
use hosts::HostFile;
use hosts::script::webgpu::{Field, Structure};
use reading::{Project, ShaderFile};
use syntax::wgsl::{Layout, MemberSyntax};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("W011"),
    name: "structure-laid-out-differently",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Host(check),
};

/// A structure of a module, with its layout.
struct Shared<'p> {
    file: &'p ShaderFile,
    name: &'p str,
    members: &'p [MemberSyntax],
    layout: &'p Layout,
    /// True when an array of it is somewhere.
    arrayed: bool,
}

/// Structures that variables in shared memory hold. Modules that an engine completes declare them for others.
fn shared(project: &Project) -> Vec<Shared<'_>> {
    let mut found = Vec::new();
    let texts: Vec<&str> = project.shaders().filter(|s| s.is_wgsl()).map(|s| s.file.text()).collect();
    for file in project.shaders() {
        let Some(module) = file.shader.wgsl().filter(|m| !m.varies) else { continue };
        for (name, layout) in &module.layouts {
            let Some(members) = module.members(name) else { continue };
            // What stands between stages is not in memory.
            if members
                .iter()
                .any(|m| m.attributes.iter().any(|a| ["location", "builtin"].contains(&a.name.name.as_str())))
            {
                continue;
            }
            let arrayed =
                texts.iter().any(|t| t.contains(&format!("array<{name}>")) || t.contains(&format!("array<{name},")));
            let bound = texts.iter().any(|t| {
                t.lines().any(|l| {
                    l.contains("var<") && (l.contains(&format!(": {name};")) || l.contains(&format!("<{name}")))
                })
            });
            if arrayed || bound {
                found.push(Shared { file, name, members, layout, arrayed });
            }
        }
    }
    found
}

/// True when one stands for the other: the same name, or all members of one name with one name the beginning of the other.
fn is_same(structure: &Structure, shared: &Shared<'_>) -> bool {
    let (a, b) = (structure.name.as_str(), shared.name);
    let names =
        || structure.fields.iter().map(|f| f.name.as_str()).eq(shared.members.iter().map(|m| m.name.name.as_str()));
    let common = structure.fields.iter().filter(|f| shared.members.iter().any(|m| m.name.name == f.name)).count();
    (a == b && common >= 2) || ((a.starts_with(b) || b.starts_with(a)) && names() && common >= 2)
}

fn check(host: &HostFile, project: &Project, findings: &mut Findings<'_>) {
    let Some(webgpu) = host.webgpu().filter(|w| !w.structures.is_empty()) else { return };
    let all = shared(project);
    for structure in &webgpu.structures {
        let same: Vec<&Shared<'_>> = all.iter().filter(|s| is_same(structure, s)).collect();
        let (placed, whole) = structure.places();
        let size = whole.map(|w| w.size);
        let differs = |s: &Shared<'_>| difference(structure, &placed, size, s);
        // Where several modules have one of the name, one that agrees is the one that is meant.
        let Some((shared, (place, what))) = same.first().and_then(|s| Some((*s, differs(s)?))) else { continue };
        if same.iter().any(|s| differs(s).is_none()) || another_agrees(project, structure, &same) {
            continue;
        }
        let (name, layout) = (&structure.name, shown(shared));
        findings.push(
            findings
                .at(&host.file, place, what)
                .with_label(message!("in the host", "ホスト側"))
                .with_related(&shared.file.file, shared.members.first().map_or(Span::at(0), |m| m.name.span), layout)
                .with_why(message!(
                    "the bytes of `{name}` are copied as they are, and WGSL places members at multiples of their alignment",
                    "`{name}` のバイト列はそのままコピーされ、WGSL はメンバを整列の倍数に置きます"
                ))
                .with_help(message!(
                    "fill the holes with fields of the host, or reorder the members on both sides",
                    "隙間をホスト側のフィールドで埋めるか、両方でメンバの順序を変えてください"
                )),
        );
    }
}

/// True where another structure of a host has the layout of the shader, with its name or all of its members: that one is
/// meant.
fn another_agrees(project: &Project, structure: &Structure, shared: &[&Shared<'_>]) -> bool {
    let others = project.hosts().filter_map(|h| h.webgpu()).flat_map(|w| &w.structures);
    others.filter(|o| !std::ptr::eq(*o, structure)).any(|other| {
        let (placed, whole) = other.places();
        let has = |name: &str| other.fields.iter().any(|f| f.name == name);
        let stands_for = |s: &Shared<'_>| other.name == structure.name || s.members.iter().all(|m| has(&m.name.name));
        let agrees = |s: &Shared<'_>| difference(other, &placed, whole.map(|w| w.size), s).is_none();
        shared.iter().any(|s| stands_for(s) && agrees(s))
    })
}

/// The first place where the two differ.
fn difference(
    structure: &Structure,
    placed: &[(&Field, u64)],
    size: Option<u64>,
    shared: &Shared<'_>,
) -> Option<(Span, Message)> {
    for (field, at) in placed.iter().filter(|(f, _)| !f.name.contains("pad")) {
        let Some(member) = shared.layout.members.iter().find(|m| m.name == field.name) else { continue };
        let (name, offset) = (&field.name, member.offset);
        if offset != *at {
            let what = message!(
                "`{name}` is at byte {at} here, and at byte {offset} in the shader",
                "`{name}` はここでは {at} バイト目、シェーダでは {offset} バイト目です"
            );
            return Some((field.place, what));
        }
    }
    let (name, stride) = (&structure.name, shared.layout.extent.size);
    let here = size.filter(|s| *s != stride && shared.arrayed)?;
    // A last array without a size makes the whole longer than it says.
    if shared.layout.members.last().is_some_and(|m| m.ty.starts_with("array<") && !m.ty.contains(',')) {
        return None;
    }
    let what = message!(
        "`{name}` has {here} bytes here, and elements of its array have {stride} in the shader",
        "`{name}` はここでは {here} バイト、シェーダの配列要素は {stride} バイトです"
    );
    // What is missing goes behind the last field.
    Some((structure.fields.last().map_or(structure.place, |f| f.place), what))
}

/// The layout in the shader, in one line.
fn shown(shared: &Shared<'_>) -> Message {
    let members: Vec<String> =
        shared.layout.members.iter().map(|m| format!("{}: {} at {}", m.name, m.ty, m.offset)).collect();
    let (list, size) = (members.join(", "), shared.layout.extent.size);
    message!("in WGSL: {list}; {size} bytes", "WGSL では {list}、計 {size} バイト")
}

#[cfg(test)]
mod tests {
    use crate::{Input, run};
    use base::text::SourceFile;

    fn found(fields: &str, members: &str, variable: &str) -> Vec<String> {
        let host = format!("#[repr(C)]\n#[derive(Clone, Copy, Pod, Zeroable)]\npub struct Light {{ {fields} }}\n");
        let module = format!("struct Light {{ {members} }}\n@group(0) @binding(0) {variable}\n");
        let files = [("a.rs", host.as_str()), ("a.wgsl", module.as_str())];
        let inputs: Vec<Input> = files.iter().map(|(n, t)| Input::new(SourceFile::new(*n, *t))).collect();
        run(&inputs).iter().filter(|d| d.code.0 == "W011").map(|d| d.message.to_string()).collect()
    }

    const UNIFORM: &str = "var<uniform> light: Light;";
    const ARRAY: &str = "var<storage> lights: array<Light>;";

    #[test]
    fn holes_that_the_host_does_not_have_are_reported() {
        let found_here = found("kind: u32, place: [f32; 3],", "kind: u32, place: vec3f,", UNIFORM);
        assert_eq!(found_here, ["`place` is at byte 4 here, and at byte 16 in the shader"]);
        assert_eq!(found("place: [f32; 4], kind: u32,", "place: vec4f, kind: u32,", ARRAY).len(), 1);
    }

    #[test]
    fn another_structure_that_agrees_is_the_one_that_is_meant() {
        let pod = |name: &str, fields: &str| format!("#[repr(C)]\n#[derive(Pod)]\npub struct {name} {{ {fields} }}\n");
        let wrong = pod("Time", "time: f32, frame: u32,");
        let right = "time: f32, delta: f32, frame: u32,";
        let module = format!("struct Time {{ {right} }}\n@group(0) @binding(0) var<uniform> t: Time;\n");
        let count = |other: &str| {
            let files = [("a.rs", wrong.as_str()), ("b.rs", other), ("a.wgsl", module.as_str())];
            let inputs: Vec<Input> = files.iter().map(|(n, t)| Input::new(SourceFile::new(*n, *t))).collect();
            run(&inputs).iter().filter(|d| d.code.0 == "W011").count()
        };
        assert_eq!(count(&pod("Other", "a: f32,")), 1);
        assert_eq!(count(&pod("Time", right)), 0);
        assert_eq!(count(&pod("ComputeTime", right)), 0, "by all of its members");
    }

    #[test]
    fn vectors_of_libraries_have_their_sizes() {
        let with = |fields: &str, members: &str| {
            let host = format!("use glam::Vec3;\n#[repr(C)]\n#[derive(Pod)]\npub struct Light {{ {fields} }}\n");
            let module = format!("struct Light {{ {members} }}\n@group(0) @binding(0) {UNIFORM}\n");
            let files = [("a.rs", host.as_str()), ("a.wgsl", module.as_str())];
            let inputs: Vec<Input> = files.iter().map(|(n, t)| Input::new(SourceFile::new(*n, *t))).collect();
            run(&inputs).iter().filter(|d| d.code.0 == "W011").map(|d| d.message.to_string()).collect::<Vec<_>>()
        };
        assert_eq!(
            with("a: Vec3, b: Vec3, c: f32,", "a: vec3f, b: vec3f, c: f32,"),
            ["`b` is at byte 12 here, and at byte 16 in the shader"]
        );
        assert!(with("a: Vec3, p: f32, b: Vec3, c: f32,", "a: vec3f, p: f32, b: vec3f, c: f32,").is_empty());
        assert!(with("a: f32, m: Mat4,", "a: f32, m: mat4x4f,").is_empty(), "the alignment depends on the target");
        assert_eq!(with("v: glam::Mat4, a: Vec3, b: Vec3,", "v: mat4x4f, a: vec3f, b: vec3f,").len(), 1);
        assert!(with("a: Own, b: Vec3, c: f32,", "a: vec3f, b: vec3f, c: f32,").is_empty());
    }

    #[test]
    fn what_agrees_or_is_not_known_is_not() {
        assert!(
            found("kind: u32, pad: [u32; 3], place: [f32; 3], end: u32,", "kind: u32, place: vec3f,", UNIFORM)
                .is_empty()
        );
        assert!(found("place: [f32; 3], power: f32,", "place: vec3f, power: f32,", ARRAY).is_empty());
        assert!(found("place: [f32; 4], kind: u32,", "place: vec4f, kind: u32,", UNIFORM).is_empty(), "one alone");
        assert!(found("kind: Kind, place: [f32; 3],", "kind: u32, place: vec3f,", UNIFORM).is_empty());
        assert!(found("@x: u32,", "kind: u32, place: vec3f,", UNIFORM).is_empty());
        assert!(
            found("kind: u32, place: [f32; 3],", "@location(0) kind: u32, @location(1) place: vec3f,", UNIFORM)
                .is_empty()
        );
    }
}
