//! W016: a structure whose members have other names in the host than in the shader.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use base::text::Span;
use hosts::HostFile;
use hosts::script::webgpu::Structure;
use reading::{Project, ShaderFile};
use syntax::wgsl::{MemberSyntax, ModuleItem};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("W016"),
    name: "members-differ",
    severity: Severity::Warning,
    level: Level::Strict,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Host(check),
};

/// Members of one name at the beginning of both that make them the same structure.
const FEWEST: usize = 4;

/// A structure of a module whose members are all written in the text.
struct Declared<'p> {
    file: &'p ShaderFile,
    name: &'p str,
    members: &'p [MemberSyntax],
}

fn declared(project: &Project) -> Vec<Declared<'_>> {
    let mut found = Vec::new();
    for file in project.shaders() {
        let Some(module) = file.shader.wgsl() else { continue };
        for item in &module.items {
            let ModuleItem::Struct { name, members } = item else { continue };
            let (Some(first), Some(last)) = (members.first(), members.last()) else { continue };
            let text = file.file.slice(Span::new(first.name.span.start, last.ty.span.end));
            let outside = |m: &MemberSyntax| m.attributes.iter().any(|a| a.name.name == "location");
            if !text.contains(['#', '{']) && !members.iter().any(outside) {
                found.push(Declared { file, name: &name.name, members });
            }
        }
    }
    found
}

/// True for a name of something that is not read.
fn is_filler(name: &str) -> bool {
    ["pad", "unused", "dummy", "reserved", "_"].iter().any(|w| name.to_ascii_lowercase().starts_with(w))
        || name.to_ascii_lowercase().contains("pad")
}

/// The number of members in front that have one name in both.
fn common(structure: &Structure, members: &[MemberSyntax]) -> usize {
    structure.fields.iter().zip(members).take_while(|(f, m)| f.name == m.name.name).count()
}

fn check(host: &HostFile, project: &Project, findings: &mut Findings<'_>) {
    let Some(webgpu) = host.webgpu().filter(|w| !w.mirrored.is_empty()) else { return };
    let all = declared(project);
    let hosts = || project.hosts().filter_map(|h| h.webgpu()).flat_map(|w| w.mirrored.iter().chain(&w.structures));
    let agrees = |s: &Structure, d: &Declared<'_>| common(s, d.members) == s.fields.len().max(d.members.len());
    for structure in &webgpu.mirrored {
        if all.iter().any(|d| agrees(structure, d)) {
            continue;
        }
        let longest = all.iter().max_by_key(|d| common(structure, d.members));
        let Some(shared) = longest.filter(|d| common(structure, d.members) >= FEWEST) else { continue };
        let at = common(structure, shared.members);
        let (Some(field), Some(member)) = (structure.fields.get(at), shared.members.get(at)) else { continue };
        if is_filler(&field.name) || is_filler(&member.name.name) || hosts().any(|s| agrees(s, shared)) {
            continue;
        }
        let (here, there) = (&field.name, &member.name.name);
        let (host_name, name) = (&structure.name, shared.name);
        findings.push(
            findings
                .at(
                    &shared.file.file,
                    member.name.span,
                    message!(
                        "`{there}` of `{name}` is read where the host writes `{here}` of `{host_name}`",
                        "`{name}` の `{there}` が読む位置に、ホストは `{host_name}` の `{here}` を書きます"
                    ),
                )
                .with_label(message!("another member in the host", "ホストでは別のメンバ"))
                .with_related(&host.file, field.place, message!("`{here}` in the host", "ホストの `{here}`"))
                .with_why(message!(
                    "the {at} members in front have the same names, so that both are one structure",
                    "先頭の {at} 個のメンバは同じ名前なので、両者は同じ構造体です"
                ))
                .with_help(message!(
                    "give both the same members in the same order",
                    "両方のメンバと順序をそろえてください"
                )),
        );
    }
}

#[cfg(test)]
mod tests {
    use crate::{Input, Level, Selection, Settings, run_with};
    use base::text::SourceFile;

    fn count(end: &str, members: &str) -> usize {
        let host = format!(
            "#[derive(Component, ShaderType, Clone)]\npub struct CloudUniform {{\n    pub transform: Mat4,\n    pub opacity: f32,\n    \
             pub scale: f32,\n    pub count: u32,\n    {end}\n}}\n"
        );
        let module = format!(
            "struct Uniforms {{\n  transform: mat4x4f,\n  opacity: f32,\n  scale: f32,\n  count: u32,\n{members}\n}}\n\
             @group(0) @binding(0) var<uniform> uniforms: Uniforms;\n"
        );
        let files = [("a.rs", host.as_str()), ("a.wgsl", module.as_str())];
        let inputs: Vec<Input> = files.iter().map(|(n, t)| Input::new(SourceFile::new(*n, *t))).collect();
        let settings = Settings { selection: Selection::default().at(Level::Strict), ..Settings::default() };
        run_with(&inputs, &settings).iter().filter(|d| d.code.0 == "W016").count()
    }

    #[test]
    fn another_member_is_reported() {
        assert_eq!(count("pub time_start: f32, pub time_stop: f32,", "  duration: f32,"), 1);
    }

    #[test]
    fn equal_ends_padding_and_conditions_are_not() {
        assert_eq!(count("pub time: f32,", "  time: f32,"), 0);
        assert_eq!(count("pub time: f32, pub end: f32,", "  time: f32,"), 0, "the host has more");
        assert_eq!(count("pub pad_0: f32,", "  time: f32,"), 0);
        assert_eq!(count("pub time: f32,", "#ifdef A\n  duration: f32,\n#endif\n  time: f32,"), 0);
    }
}
