//! W013: layouts of bind groups, and bind groups, that do not have what the shaders of a pipeline use.

mod fits;

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Diagnostic, Message, Severity, message};
use base::text::Span;
use hosts::HostFile;
use hosts::script::webgpu::{BindGroup, Bound, GroupLayout, PipelineLayout};
use reading::Project;

use super::interface::{Used, used};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("W013"),
    name: "binding-layout-differs",
    severity: Severity::Error,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Host(check),
};

fn check(host: &HostFile, project: &Project, findings: &mut Findings<'_>) {
    let Some(webgpu) = host.webgpu() else { return };
    for pipeline in &webgpu.pipelines {
        if let PipelineLayout::Groups(groups, place) = &pipeline.layout
            && let Some(used) = used(project, host, pipeline)
        {
            used.iter().for_each(|used| of_layout(host, used, groups, *place, findings));
        }
    }
    for group in &webgpu.groups {
        if let Some(used) = webgpu.pipelines.get(group.pipeline).and_then(|p| used(project, host, p)) {
            of_group(host, group, &used, findings);
        }
    }
}

fn report(host: &HostFile, place: Span, what: Message, used: &Used<'_>, findings: &Findings<'_>) -> Diagnostic {
    let (group, binding) = (used.resource.group, used.resource.binding);
    let there = message!("group {group}, binding {binding} here", "ここがグループ {group}、バインディング {binding}");
    findings
        .at(&host.file, place, what)
        .with_related(&used.file.file, used.resource.place(), there)
        .with_why(message!("the pipeline is refused", "パイプラインは拒否されます"))
}

fn of_layout(
    host: &HostFile,
    used: &Used<'_>,
    groups: &[Option<GroupLayout>],
    place: Span,
    findings: &mut Findings<'_>,
) {
    let (name, stage) = (&used.resource.variable.name.name, used.stage.name());
    let (group, binding) = (used.resource.group, used.resource.binding);
    let add = || {
        message!(
            "add an entry with binding {binding} for `{name}`",
            "`{name}` のためにバインディング {binding} のエントリを加えてください"
        )
    };
    let Some(layout) = usize::try_from(group).ok().and_then(|g| groups.get(g)) else {
        let count = groups.len();
        let what = message!(
            "the {stage} stage uses group {group} (`{name}`), and the pipeline has {count} groups",
            "{stage} ステージはグループ {group}（`{name}`）を使いますが、パイプラインのグループは {count} 個です"
        );
        let d = report(host, place, what, used, findings).with_label(message!("no such group", "このグループがない"));
        findings.push(
            d.with_help(message!("add a layout for group {group}", "グループ {group} のレイアウトを加えてください")),
        );
        return;
    };
    let Some(layout) = layout else { return };
    let Some(entry) = layout.entries.iter().find(|e| e.binding == binding) else {
        let what = message!(
            "the layout of group {group} has no binding {binding}, which the {stage} stage uses as `{name}`",
            "グループ {group} のレイアウトに、{stage} ステージが `{name}` として使うバインディング {binding} がありません"
        );
        let d = report(host, layout.place, what, used, findings)
            .with_label(message!("not in this layout", "このレイアウトにない"));
        findings.push(d.with_help(add()));
        return;
    };
    if entry.visibility.as_ref().is_some_and(|stages| !stages.contains(&used.stage)) {
        let what = message!(
            "`{name}` is used by the {stage} stage, for which the binding is not visible",
            "`{name}` は {stage} ステージで使われますが、バインディングはそのステージから見えません"
        );
        let d = report(host, entry.place, what, used, findings)
            .with_label(message!("not visible there", "そこから見えない"));
        findings.push(d.with_help(message!(
            "add the {stage} stage to the visibility",
            "visibility に {stage} ステージを加えてください"
        )));
    }
    if let Some((here, there)) = fits::difference(&used.file.shader, used.module, &used.resource, &entry.kind) {
        let what = message!(
            "the layout has {here}, and the shader declares {there}",
            "レイアウトは {here}、シェーダの宣言は {there} です"
        );
        let d = report(host, entry.place, what, used, findings).with_label(message!("{here}", "{here}"));
        findings.push(d.with_help(message!(
            "change the entry, or the declaration of `{name}`",
            "エントリか `{name}` の宣言を直してください"
        )));
    }
}

/// Holds a bind group against the layout that its pipeline derives.
fn of_group(host: &HostFile, group: &BindGroup, used: &[Used<'_>], findings: &mut Findings<'_>) {
    let index = group.index;
    let own: Vec<&Used<'_>> = used.iter().filter(|u| u.resource.group == index).collect();
    for Bound { binding, place, size: _ } in &group.bindings {
        if own.iter().any(|u| u.resource.binding == *binding) {
            continue;
        }
        let what = message!(
            "the shaders do not use binding {binding} of group {index}, so the derived layout does not have it",
            "シェーダはグループ {index} のバインディング {binding} を使わないので、導かれるレイアウトにありません"
        );
        findings.push(
            findings
                .at(&host.file, *place, what)
                .with_label(message!("not in the derived layout", "導かれるレイアウトにない"))
                .with_why(message!(
                    "a bind group with other entries than its layout is refused",
                    "レイアウトと異なるエントリを持つバインドグループは拒否されます"
                ))
                .with_help(message!(
                    "remove the entry, use the binding in the shader, or state the layout",
                    "エントリを削除するか、シェーダで使うか、レイアウトを明示してください"
                )),
        );
    }
    for used in own {
        let (name, binding) = (&used.resource.variable.name.name, used.resource.binding);
        if group.bindings.iter().any(|b| b.binding == binding) {
            continue;
        }
        let what = message!(
            "the bind group has no binding {binding}, which the shader uses as `{name}`",
            "シェーダが `{name}` として使うバインディング {binding} がバインドグループにありません"
        );
        let d = report(host, group.place, what, used, findings)
            .with_label(message!("not in this group", "このグループにない"));
        findings.push(
            d.with_why(message!(
                "a bind group with other entries than its layout is refused",
                "レイアウトと異なるエントリを持つバインドグループは拒否されます"
            ))
            .with_help(message!(
                "add an entry with binding {binding}",
                "バインディング {binding} のエントリを加えてください"
            )),
        );
    }
}

#[cfg(test)]
mod tests {
    use crate::{Input, run};
    use base::text::SourceFile;

    fn found(name: &str, host: &str, module: &str) -> Vec<String> {
        let files = [(name, host), ("a.wgsl", module)];
        let inputs: Vec<Input> = files.iter().map(|(n, t)| Input::new(SourceFile::new(*n, *t))).collect();
        run(&inputs).iter().filter(|d| d.code.0 == "W013").map(|d| d.message.to_string()).collect()
    }

    /// A fragment stage that uses a variable of group 0 with binding 0.
    fn module(variable: &str, value: &str) -> String {
        format!(
            "struct Light {{ place: vec4f, power: f32 }}\n@group(0) @binding(0) {variable}\n@group(0) @binding(1) var s: sampler;\n\
             @vertex fn vs() -> @builtin(position) vec4f {{ return vec4f(); }}\n\
             fn lit() -> vec4f {{ return vec4f({value}); }}\n@fragment fn fs() -> @location(0) vec4f {{ return lit(); }}\n"
        )
    }

    fn rust(visibility: &str, ty: &str, module: &str) -> Vec<String> {
        found("a.rs", &rust_host(visibility, ty), module)
    }

    fn rust_host(visibility: &str, ty: &str) -> String {
        format!(
            "struct A {{ layout: wgpu::BindGroupLayout }}\nfn f(device: &wgpu::Device) {{\n\
             let m = device.create_shader_module(wgpu::include_wgsl!(\"a.wgsl\"));\n\
             let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {{ label: None, entries: &[wgpu::BindGroupLayoutEntry {{ binding: 0, visibility: wgpu::ShaderStages::{visibility}, ty: wgpu::BindingType::{ty}, count: None }}] }});\n\
             let pl = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {{ label: None, bind_group_layouts: &[&layout], push_constant_ranges: &[] }});\n\
             let p = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {{ layout: Some(&pl),\n\
             vertex: wgpu::VertexState {{ module: &m, entry_point: Some(\"vs\"), buffers: &[] }},\n\
             fragment: Some(wgpu::FragmentState {{ module: &m, entry_point: Some(\"fs\"), targets: &[] }}), multiview: None }});\n}}\n"
        )
    }

    const UNIFORM: &str =
        "Buffer { ty: wgpu::BufferBindingType::Uniform, has_dynamic_offset: false, min_binding_size: None }";

    #[test]
    fn kinds_and_stages_are_held_against_the_layout() {
        let light = module("var<uniform> light: Light;", "light.power");
        assert!(rust("FRAGMENT", UNIFORM, &light).is_empty());
        assert!(rust("all()", UNIFORM, &light).is_empty(), "not followed");
        assert_eq!(
            rust("VERTEX", UNIFORM, &light),
            ["`light` is used by the fragment stage, for which the binding is not visible"]
        );
        let storage = "Buffer { ty: wgpu::BufferBindingType::Storage { read_only: true }, has_dynamic_offset: false, min_binding_size: None }";
        assert_eq!(
            rust("FRAGMENT", storage, &light),
            ["the layout has a read-only storage buffer, and the shader declares a uniform buffer"]
        );
        let small = UNIFORM.replace("None", "NonZeroU64::new(16)");
        assert_eq!(
            rust("FRAGMENT", &small, &light),
            ["the layout has a buffer of at least 16 bytes, and the shader declares a type of 32 bytes"]
        );
        let written = module("var<storage, read_write> lights: array<Light>;", "lights[0].power");
        assert_eq!(rust("FRAGMENT", storage, &written).len(), 1);
        let read = module("var<storage> lights: array<Light>;", "lights[0].power");
        assert!(rust("FRAGMENT", storage, &read).is_empty());
        let texture = module("var t: texture_2d<u32>;", "f32(textureLoad(t, vec2i(), 0).x)");
        let sampled = |ty: &str, dimension: &str| {
            format!(
                "Texture {{ sample_type: wgpu::TextureSampleType::{ty}, view_dimension: wgpu::TextureViewDimension::{dimension}, multisampled: false }}"
            )
        };
        assert!(rust("FRAGMENT", &sampled("Uint", "D2"), &texture).is_empty());
        assert_eq!(rust("FRAGMENT", &sampled("Float { filterable: true }", "D2"), &texture).len(), 1);
        assert_eq!(rust("FRAGMENT", &sampled("Uint", "D2Array"), &texture).len(), 1);
        let stored = module("var t: texture_storage_2d<rgba8unorm, write>;", "f32(textureDimensions(t).x)");
        let storage_texture = |format: &str, access: &str| {
            format!(
                "StorageTexture {{ access: wgpu::StorageTextureAccess::{access}, format: wgpu::TextureFormat::{format}, view_dimension: wgpu::TextureViewDimension::D2 }}"
            )
        };
        assert!(rust("FRAGMENT", &storage_texture("Rgba8Unorm", "WriteOnly"), &stored).is_empty());
        assert_eq!(rust("FRAGMENT", &storage_texture("Rgba16Float", "WriteOnly"), &stored).len(), 1);
        assert_eq!(rust("FRAGMENT", &storage_texture("Rgba8Unorm", "ReadOnly"), &stored).len(), 1);
    }

    #[test]
    fn a_list_that_grows_is_not_known() {
        let light = module("var<uniform> light: Light;", "light.power")
            .replace("@group(0) @binding(0)", "@group(1) @binding(0)");
        let listed = |changed: &str| {
            let list = format!("let mut all = vec![&layout];\n{changed}\nlet pl =");
            let host = rust_host("FRAGMENT", UNIFORM).replace("let pl =", &list);
            found("a.rs", &host.replace("&[&layout]", "&all"), &light)
        };
        assert_eq!(
            listed("other.push(1);"),
            ["the fragment stage uses group 1 (`light`), and the pipeline has 1 groups"]
        );
        for changed in ["if let Some(more) = more { all.extend_from_slice(more); }", "all.push(&more);"] {
            assert!(listed(changed).is_empty(), "{changed}");
        }
    }

    #[test]
    fn what_no_stage_uses_is_not_asked_for() {
        let unused = module("var<uniform> light: Light;", "1.0");
        assert!(rust("VERTEX", "Sampler(wgpu::SamplerBindingType::Filtering)", &unused).is_empty());
        let sampler = module("var t: texture_2d<f32>;", "textureSampleLevel(t, s, vec2f(), 0.0)");
        let told = rust("FRAGMENT", "Sampler(wgpu::SamplerBindingType::Filtering)", &sampler);
        assert_eq!(told.len(), 2, "another kind, and the sampler at binding 1: {told:#?}");
    }

    #[test]
    fn bind_groups_are_held_against_derived_layouts() {
        let host = |layout: &str, entries: &str| {
            format!(
                "import code from './a.wgsl?raw';\nconst module = device.createShaderModule({{ code }});\n\
                 const p = device.createRenderPipeline({{ layout: {layout}, vertex: {{ module }}, fragment: {{ module, targets: [] }} }});\n\
                 const g = device.createBindGroup({{ layout: p.getBindGroupLayout(0), entries: [{entries}] }});\n"
            )
        };
        let light = module("var<uniform> light: Light;", "light.power");
        let of = |layout: &str, entries: &str| found("a.ts", &host(layout, entries), &light);
        let entry = "{ binding: 0, resource: { buffer } }";
        assert!(of("'auto'", entry).is_empty());
        assert_eq!(
            of("'auto'", &format!("{entry}, {{ binding: 1, resource: sampler }}")),
            ["the shaders do not use binding 1 of group 0, so the derived layout does not have it"]
        );
        assert_eq!(of("'auto'", ""), ["the bind group has no binding 0, which the shader uses as `light`"]);
        assert!(of("'auto'", "...entries").is_empty());
        assert!(of("stated", "").is_empty());
    }

    #[test]
    fn entries_and_layouts_may_come_from_small_functions_and_texts_from_paths() {
        let host = |made: &str, entries: &str| {
            format!(
                "class Solver {{\n\
                 static async create(device) {{\n\
                 const solver = new Solver(device);\n\
                 const [other, text] = await Promise.all([\n\
                 fetch('/b.wgsl').then(r => r.text()), {made},\n\
                 ]);\n\
                 const module = device.createShaderModule({{ code: text }});\n\
                 solver.pipeline = device.createRenderPipeline({{ layout: 'auto', vertex: {{ module }}, fragment: {{ module, targets: [] }} }});\n\
                 solver.bind();\n\
                 }}\n\
                 bind() {{\n\
                 const layout = (pipeline) => pipeline.getBindGroupLayout(0);\n\
                 const entry = (binding, buffer) => ({{ binding, resource: {{ buffer }} }});\n\
                 this.group = this.device.createBindGroup({{ layout: layout(this.pipeline), entries: [{entries}] }});\n\
                 }}\n\
                 }}\n"
            )
        };
        let light = module("var<uniform> light: Light;", "light.power");
        let of = |made: &str, entries: &str| found("src/solver.js", &host(made, entries), &light);
        let lacks = ["the shaders do not use binding 1 of group 0, so the derived layout does not have it"];
        for made in [
            "fetch('/a.wgsl').then(r => r.text())",
            "(await fetch('../a.wgsl?v=1')).text()",
            "fetch(new URL('./a.wgsl', import.meta.url)).then(async (r) => { return r.text(); })",
        ] {
            assert_eq!(of(made, "entry(0, this.a), entry(1, this.b)"), lacks, "{made}");
            assert!(of(made, "entry(0, this.a)").is_empty(), "{made}");
        }
        // A text of which nothing is known, a response that is no text, a layout of another object.
        assert!(of("load('/a.wgsl')", "entry(0, this.a), entry(1, this.b)").is_empty());
        assert!(of("fetch('/a.wgsl').then(r => r.json())", "entry(1, this.b)").is_empty());
        let other =
            host("fetch('/a.wgsl').then(r => r.text())", "entry(1, this.b)").replace("new Solver(", "new Other(");
        assert!(found("src/solver.js", &other, &light).is_empty());
    }
}
