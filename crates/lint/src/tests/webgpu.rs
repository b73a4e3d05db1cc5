//! How far modules are followed, seen from W010: a name that the module lacks is reported where it is found.

use crate::{Input, run};
use base::text::SourceFile;

const MODULE: &str = "@vertex fn vs_main() -> @builtin(position) vec4f { return vec4f(); }\n\
                      @fragment fn fs_main() -> @location(0) vec4f { return vec4f(); }\n";
const OTHER: &str = "@vertex fn main() -> @builtin(position) vec4f { return vec4f(); }\n";

/// What W010 says of a host.
fn found(name: &str, host: &str) -> Vec<String> {
    let files = [(name, host), ("src/shader.wgsl", MODULE), ("src/other.wgsl", OTHER)];
    let inputs: Vec<Input> = files.iter().map(|(n, t)| Input::new(SourceFile::new(*n, *t))).collect();
    run(&inputs).iter().filter(|d| d.code.0 == "W010").map(|d| d.message.to_string()).collect()
}

fn rust(host: &str) -> Vec<String> {
    found("src/a.rs", host)
}

fn typescript(host: &str) -> Vec<String> {
    found("src/a.ts", host)
}

const LACKS: &str = "the module has no entry point `main`";

fn state(module: &str) -> String {
    format!(
        "device.create_render_pipeline(&D {{ vertex: wgpu::VertexState {{ module: {module}, entry_point: Some(\"main\"), buffers: &[] }} }});"
    )
}

#[test]
fn modules_are_followed_through_variables_of_rust() {
    for module in [
        "let m = device.create_shader_module(wgpu::include_wgsl!(\"shader.wgsl\"));",
        "let d = wgpu::ShaderModuleDescriptor { label: None, source: wgpu::ShaderSource::Wgsl(include_str!(\"shader.wgsl\").into()) };\nlet m = device.create_shader_module(d);",
        "let m = device.create_shader_module(wgpu::ShaderModuleDescriptor { label: None, source: wgpu::ShaderSource::Wgsl(Cow::Borrowed(TEXT)) });",
        "let m = device.create_shader_module(wgpu::ShaderModuleDescriptor { label: None, source: wgpu::ShaderSource::Wgsl(std::borrow::Cow::Borrowed(include_str!(\"shader.wgsl\"))) });",
        "let o = device.create_shader_module(wgpu::include_wgsl!(\"other.wgsl\")); let m = make(&device);",
    ] {
        let host = format!(
            "const TEXT: &str = include_str!(\"shader.wgsl\");\nfn make(device: &wgpu::Device) -> wgpu::ShaderModule {{ device.create_shader_module(wgpu::include_wgsl!(\"shader.wgsl\")) }}\n\
             fn f(device: wgpu::Device) {{\n{module}\n{} }}\n",
            state("&m")
        );
        assert_eq!(rust(&host), [LACKS], "{module}");
    }
}

#[test]
fn a_function_is_entered_from_each_of_its_calls() {
    let host = |file: &str| {
        format!(
            "fn create_render_pipeline(device: &wgpu::Device, shader: wgpu::ShaderModuleDescriptor) {{\n\
             let shader = device.create_shader_module(shader);\n{} }}\n\
             fn f(device: wgpu::Device) {{ let a = {{ let shader = wgpu::ShaderModuleDescriptor {{ label: None, source: wgpu::ShaderSource::Wgsl(include_str!(\"{file}\").into()) }};\n\
             create_render_pipeline(&device, shader) }}; }}\n",
            state("&shader")
        )
    };
    assert_eq!(rust(&host("shader.wgsl")), [LACKS]);
    assert!(rust(&host("other.wgsl")).is_empty());
}

#[test]
fn members_and_shadowed_names_are_told_apart() {
    let host = |member: &str| {
        format!(
            "impl A {{ fn new(device: &wgpu::Device) -> Self {{ let shader = device.create_shader_module(wgpu::include_wgsl!(\"{member}\")); Self {{ shader }} }}\n\
             fn f(&self, device: wgpu::Device) {{ {} }} }}\n",
            state("&self.shader")
        )
    };
    assert_eq!(rust(&host("shader.wgsl")), [LACKS]);
    assert!(rust(&host("other.wgsl")).is_empty());
    let shadowed = format!(
        "fn f(device: wgpu::Device) {{ let m = device.create_shader_module(wgpu::include_wgsl!(\"shader.wgsl\"));\n\
         let m = device.create_shader_module(wgpu::include_wgsl!(\"other.wgsl\"));\n{} }}\n",
        state("&m")
    );
    assert!(rust(&shadowed).is_empty());
}

#[test]
fn what_has_two_answers_has_none() {
    for module in [
        "let m = if x { a } else { b };",
        "for m in modules {",
        "let (m, n) = pair;",
        "let Some(m) = given else { return };",
        "let m = load(\"shader.wgsl\");",
        "",
    ] {
        let host =
            format!("fn f(device: wgpu::Device, given: Option<&wgpu::ShaderModule>) {{ {module} {} }}\n", state("&m"));
        assert!(rust(&host).is_empty(), "{module}");
    }
}

#[test]
fn texts_in_strings_are_modules() {
    let rust_host = |text: &str| {
        format!(
            "fn f(device: wgpu::Device) {{ let m = device.create_shader_module(wgpu::ShaderModuleDescriptor {{ label: None, source: wgpu::ShaderSource::Wgsl(r#\"{text}\"#.into()) }});\n{} }}\n",
            state("&m")
        )
    };
    assert_eq!(rust(&rust_host(MODULE)), [LACKS]);
    assert!(rust(&rust_host(OTHER)).is_empty());
    let script = |text: &str| {
        format!(
            "const code = /* wgsl */ `{text}`;\nconst p = device.createRenderPipeline({{ layout: 'auto', vertex: {{ module: device.createShaderModule({{ code }}), entryPoint: 'main' }} }});\n"
        )
    };
    assert_eq!(typescript(&script(MODULE)), [LACKS]);
    assert!(typescript(&script(OTHER)).is_empty());
    assert!(typescript(&script(&format!("{MODULE}${{more}}"))).is_empty(), "something is filled in");
}

#[test]
fn a_module_that_is_kept_for_others_is_one() {
    let module = "\nvar<private> seed: u32;\n@compute @workgroup_size(1) fn main() { _ = seed; }\n";
    let told = |host: &str| {
        let found = run(&[Input::new(SourceFile::new("a.js", host))]);
        found.iter().map(|d| format!("{} {}", d.file.locate(d.span.start), d.code)).collect::<Vec<_>>()
    };
    assert_eq!(told(&format!("const source = /* wgsl */ `{module}`\nexport default source")), ["a.js:2:14 W003"]);
    for other in [
        format!("export const source = `{module}` + rest;"),
        format!("export const source = head + `{module}`;"),
        format!("export const source = `{module}`.replace('seed', name);"),
        format!("export const source = `{module} fn f() {{`;"),
    ] {
        assert_eq!(told(&other), [""; 0], "{other}");
    }
}

#[test]
fn rules_on_modules_report_in_strings() {
    let host = "const m = device.createShaderModule({ code: `\nvar<private> seed: u32;\n@compute @workgroup_size(1) fn main() { _ = seed; }\n` });\n";
    let told: Vec<String> = run(&[Input::new(SourceFile::new("a.ts", host))])
        .iter()
        .map(|d| format!("{} {}", d.file.locate(d.span.start), d.code))
        .collect();
    assert_eq!(told, ["a.ts:2:14 W003"]);
}

#[test]
fn an_entry_in_the_words_of_another_interface_says_nothing() {
    let told = |buffer: &str| -> Vec<String> {
        let host = format!(
            "const module = device.createShaderModule({{ code: `\n@group(0) @binding(0) var<storage, read> a: array<f32>;\n\
             @compute @workgroup_size(1) fn main() {{ _ = a[0]; }}\n` }});\n\
             const l = device.createBindGroupLayout({{ entries: [{{ binding: 0, visibility: GPUShaderStage.COMPUTE, buffer: {buffer} }}] }});\n\
             const p = device.createComputePipeline({{ layout: device.createPipelineLayout({{ bindGroupLayouts: [l] }}), \
             compute: {{ module, entryPoint: 'main' }} }});\n"
        );
        let found = run(&[Input::new(SourceFile::new("a.ts", host))]);
        found.iter().filter(|d| d.code.0 == "W013").map(|d| d.message.to_string()).collect()
    };
    let differs = "the layout has a uniform buffer, and the shader declares a read-only storage buffer";
    assert_eq!(told("{}"), [differs]);
    assert_eq!(told("{ hasDynamicOffset: false }"), [differs]);
    assert!(told("{ type: 'read-only-storage' }").is_empty());
    assert!(told("{ bindingType: 'read-only-storage' }").is_empty());
}

#[test]
fn stages_are_held_apart() {
    let host = |entry: &str| {
        format!(
            "import code from './shader.wgsl?raw';\nconst module = device.createShaderModule({{ code }});\n\
             const p = device.createRenderPipeline({{ layout: 'auto', vertex: {{ module{entry} }} }});\n"
        )
    };
    assert!(typescript(&host("")).is_empty(), "the only one");
    assert!(typescript(&host(", entryPoint: 'vs_main'")).is_empty());
    let told = typescript(&host(", entryPoint: 'fs_main'"));
    assert_eq!(told, ["`fs_main` is an entry point of the fragment stage, not of the vertex stage"]);
}

#[test]
fn a_text_that_breaks_off_anywhere_does_no_harm() {
    let rust_host = format!(
        "impl V {{ const A: [wgpu::VertexAttribute; 2] = wgpu::vertex_attr_array![0 => Float32x3, 1 => 頂Uint32];\n\
         fn desc() -> wgpu::VertexBufferLayout {{ wgpu::VertexBufferLayout {{ array_stride: size_of::<V>() as u64, attributes: &Self::A }} }} }}\n\
         #[repr(C)] #[derive(Pod)] struct V {{ p: [f32; 3 * N], q: glam::Vec4 }}\n\
         fn f(d: &D) {{ let m = d.create_shader_module(wgpu::include_wgsl!(\"shader.wgsl\")); let l = d.create_pipeline_layout(&P {{ bind_group_layouts: &[&d.create_bind_group_layout(&B {{ entries: &[E {{ binding: 0, visibility: S::VERTEX, ty: wgpu::BindingType::Buffer {{ ty: T::Storage {{ read_only: true }}, min_binding_size: None }}, count: None }}] }})] }});\n\
         {} }}\n",
        state("&m").replace("&[]", "&[V::desc()]")
    );
    for (end, _) in rust_host.char_indices() {
        let _ = rust(&rust_host[..end]);
    }
    let script = "const n = 4; const a = new Float32Array(n * 2);\nconst c = device.createShaderModule({ code: `@compute fn 頂() {}` });\n\
                  const p = device.createComputePipeline({ layout: 'auto', compute: { module: c, ...x } });\n\
                  const g = device.createBindGroup({ layout: p.getBindGroupLayout(0), entries: [{ binding: 0, resource: { buffer } }] });\n\
                  function f({ a, b }) { pass.setPipeline(p); pass.dispatchWorkgroups(n); } f({ a: 1, b });";
    for (end, _) in script.char_indices() {
        let _ = typescript(&script[..end]);
    }
}
