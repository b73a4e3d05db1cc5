//! W015: a uniform buffer that is not of the size of what the shader reads from it.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use hosts::HostFile;
use reading::Project;

use super::interface::used;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("W015"),
    name: "buffer-size-differs",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Host(check),
};

/// Bytes to whose multiple hosts round sizes. Of this size and above, a multiple has room for more than the variable.
const ROUNDED: u64 = 16;

fn check(host: &HostFile, project: &Project, findings: &mut Findings<'_>) {
    let Some(webgpu) = host.webgpu() else { return };
    for group in &webgpu.groups {
        let Some(used) = webgpu.pipelines.get(group.pipeline).and_then(|p| used(project, host, p)) else { continue };
        for bound in &group.bindings {
            let here = |r: &super::interface::Resource<'_>| (r.group, r.binding) == (group.index, bound.binding);
            let (Some(used), Some((size, place))) = (used.iter().find(|u| here(&u.resource)), bound.size) else {
                continue;
            };
            let variable = used.resource.variable;
            let uniform = variable.space.first().is_some_and(|s| s.name == "uniform");
            let Some(extent) = used.module.extent(used.resource.symbol).filter(|_| uniform) else { continue };
            let wanted = extent.size;
            if size == wanted || (size > wanted && size.is_multiple_of(ROUNDED)) {
                continue;
            }
            let name = &variable.name.name;
            let (level, why) = if size < wanted {
                let why = message!(
                    "a buffer that is smaller than its variable is refused when something is drawn",
                    "変数より小さいバッファは、描画のときに拒否されます"
                );
                (Level::Default, why)
            } else {
                let why = message!(
                    "mostly the host pads in another place than WGSL, so that members behind it get other values",
                    "多くの場合、ホストの詰め物の位置が WGSL と異なり、その後のメンバが別の値になります"
                );
                (Level::Strict, why)
            };
            findings.push_at(
                level,
                findings
                    .at(
                        &host.file,
                        place,
                        message!(
                            "the buffer has {size} bytes, and `{name}` in the shader has {wanted}",
                            "バッファは {size} バイト、シェーダの `{name}` は {wanted} バイトです"
                        ),
                    )
                    .with_label(message!("{size} bytes", "{size} バイト"))
                    .with_related(
                        &used.file.file,
                        variable.name.span,
                        message!("{wanted} bytes here", "ここでは {wanted} バイト"),
                    )
                    .with_why(why)
                    .with_help(message!(
                        "compare the members one by one; `vec3` and `vec4` begin at multiples of 16",
                        "メンバを一つずつ比べてください。`vec3` と `vec4` は 16 の倍数から始まります"
                    )),
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::{Input, Level, Selection, Settings, run_with};
    use base::text::SourceFile;

    fn count(size: &str, level: Level) -> usize {
        let host = format!(
            "import code from './a.wgsl?raw';\nconst bytes = {size};\n\
             const p = device.createComputePipeline({{ layout: 'auto', compute: {{ module: device.createShaderModule({{ code }}), entryPoint: 'main' }} }});\n\
             const buffer = device.createBuffer({{ size: bytes, usage: 1 }});\n\
             const group = device.createBindGroup({{ layout: p.getBindGroupLayout(0), entries: [{{ binding: 0, resource: {{ buffer }} }}, {{ binding: 1, resource: {{ buffer: other }} }}] }});\n"
        );
        let module = "struct P { a: f32, b: f32, seed: vec4f }\n@group(0) @binding(0) var<uniform> p: P;\n\
             @group(0) @binding(1) var<storage, read_write> out: array<vec4f>;\n\
             @compute @workgroup_size(1) fn main() { out[0] = p.seed * p.a + p.b; }\n";
        let files = [("a.js", host.as_str()), ("a.wgsl", module)];
        let inputs: Vec<Input> = files.iter().map(|(n, t)| Input::new(SourceFile::new(*n, *t))).collect();
        let settings = Settings { selection: Selection::default().at(level), ..Settings::default() };
        run_with(&inputs, &settings).iter().filter(|d| d.code.0 == "W015").count()
    }

    #[test]
    fn other_sizes_are_reported() {
        assert_eq!(count("1 * 4 + 1 * 4 + 3 * 4 + 4 * 4", Level::Strict), 1);
        assert_eq!(count("36", Level::Default), 0);
        assert_eq!(count("6 * 4", Level::Default), 1, "too small");
    }

    #[test]
    fn the_size_and_multiples_are_not() {
        assert_eq!(count("32", Level::Heuristic), 0);
        assert_eq!(count("48", Level::Heuristic), 0, "room for more");
        assert_eq!(count("256", Level::Heuristic), 0);
        assert_eq!(count("n * 4", Level::Heuristic), 0, "not known");
    }
}
