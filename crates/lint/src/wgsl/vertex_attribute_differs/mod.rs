//! W012: vertex buffers that do not give what the vertex entry point reads.

use std::collections::BTreeMap;

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Diagnostic, Severity, message};
use base::text::Span;
use hosts::HostFile;
use hosts::script::webgpu::{Attribute, VertexBuffer};
use reading::{Project, ShaderFile};
use syntax::Stage;
use syntax::types::ScalarType;

use super::interface::{VertexInput, module_of, started, vertex_inputs};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("W012"),
    name: "vertex-attribute-differs",
    severity: Severity::Error,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Host(check),
};

fn check(host: &HostFile, project: &Project, findings: &mut Findings<'_>) {
    let Some(webgpu) = host.webgpu() else { return };
    for stage in webgpu.stages.iter().filter(|s| s.stage == Stage::Vertex) {
        let Some((buffers, place)) = &stage.buffers else { continue };
        let by_location = beside_each_other(host, buffers, findings);
        let Some((file, module)) = module_of(project, host, &stage.source) else { continue };
        let Some(entry) = started(module, stage) else { continue };
        let Some(inputs) = vertex_inputs(&file.shader, module, entry) else { continue };
        let lacking: Vec<&VertexInput<'_>> = inputs.iter().filter(|i| !by_location.contains_key(&i.location)).collect();
        if !lacking.is_empty() {
            findings.push(missing(host, *place, file, &lacking, findings));
        }
        for input in &inputs {
            if let Some(given) = by_location.get(&input.location).filter(|g| g.format.scalar != input.scalar) {
                findings.push(other_type(host, given, file, input, findings));
            }
        }
    }
}

/// Reports what is wrong with buffers by themselves, and gives their attributes by location.
fn beside_each_other<'b>(
    host: &HostFile,
    buffers: &'b [VertexBuffer],
    findings: &mut Findings<'_>,
) -> BTreeMap<u64, &'b Attribute> {
    let mut found: BTreeMap<u64, &Attribute> = BTreeMap::new();
    for buffer in buffers {
        for attribute in &buffer.attributes {
            let location = attribute.location;
            if let Some(first) = found.insert(location, attribute).filter(|first| first.place != attribute.place) {
                let d = findings
                    .at(
                        &host.file,
                        attribute.place,
                        message!(
                            "location {location} is given twice",
                            "ロケーション {location} が二度与えられています"
                        ),
                    )
                    .with_label(message!("again", "二度目"))
                    .with_related(&host.file, first.place, message!("first here", "最初はここ"));
                findings.push(refused(d).with_help(message!(
                    "give each attribute a location of its own",
                    "属性ごとに別のロケーションを与えてください"
                )));
            }
            let end = attribute.offset.and_then(|at| at.checked_add(attribute.format.size));
            if let (Some(end), Some((stride, place))) = (end, buffer.stride)
                && stride > 0
                && end > stride
            {
                let d = findings
                    .at(
                        &host.file,
                        attribute.place,
                        message!(
                            "the attribute ends at byte {end}, and a vertex has {stride} bytes",
                            "属性は {end} バイト目で終わりますが、頂点は {stride} バイトです"
                        ),
                    )
                    .with_label(message!("past the stride", "ストライドを超える"))
                    .with_related(&host.file, place, message!("the stride", "ストライド"));
                findings.push(refused(d).with_help(message!(
                    "state the bytes from one vertex to the next as the stride",
                    "ストライドには、次の頂点までのバイト数を指定してください"
                )));
            }
        }
    }
    found
}

fn refused(d: Diagnostic) -> Diagnostic {
    d.with_why(message!("the pipeline is refused", "パイプラインは拒否されます"))
}

/// What no buffer gives, in one message: it has one place in the host.
fn missing(
    host: &HostFile,
    place: Span,
    file: &ShaderFile,
    lacking: &[&VertexInput<'_>],
    findings: &Findings<'_>,
) -> Diagnostic {
    let each: Vec<String> = lacking.iter().map(|i| format!("{} (`{}`)", i.location, i.name.name)).collect();
    let list = each.join(", ");
    let mut d = findings
        .at(
            &host.file,
            place,
            message!(
                "no vertex buffer gives what the shader reads at location {list}",
                "シェーダが読むロケーション {list} を与える頂点バッファがありません"
            ),
        )
        .with_label(message!("not among these", "この中にない"));
    for input in lacking {
        d = d.with_related(&file.file, input.name.span, message!("read here", "ここで読まれる"));
    }
    refused(d).with_help(message!(
        "add an attribute with that location, or remove the input of the shader",
        "そのロケーションの属性を加えるか、シェーダの入力を削除してください"
    ))
}

fn other_type(
    host: &HostFile,
    given: &Attribute,
    file: &ShaderFile,
    input: &VertexInput<'_>,
    findings: &Findings<'_>,
) -> Diagnostic {
    let spelled = |s: ScalarType| match s {
        ScalarType::Bool => "bool",
        s if s.is_floating() => "f32",
        s if s.is_unsigned() => "u32",
        _ => "i32",
    };
    let (name, format) = (&input.name.name, &given.format.name);
    let (here, there) = (spelled(given.format.scalar), spelled(input.scalar));
    let d = findings
        .at(
            &host.file,
            given.place,
            message!(
                "`{format}` is read as {here}, and `{name}` in the shader is of {there}",
                "`{format}` は {here} として読まれますが、シェーダの `{name}` は {there} です"
            ),
        )
        .with_label(message!("of {here}", "{here} の値"))
        .with_related(&file.file, input.name.span, message!("of {there}", "{there} の値"));
    refused(d).with_help(message!(
        "choose a format of {there}, or declare `{name}` with {here}",
        "{there} の形式を選ぶか、`{name}` を {here} で宣言してください"
    ))
}

#[cfg(test)]
mod tests {
    use crate::{Input, run};
    use base::text::SourceFile;

    const MODULE: &str = "struct In { @location(0) place: vec3f, @location(1) kind: u32, @builtin(vertex_index) i: u32 }\n\
                          @vertex fn vs(v: In) -> @builtin(position) vec4f { return vec4f(v.place, f32(v.kind + v.i)); }\n";

    fn found(name: &str, host: &str) -> Vec<String> {
        let files = [(name, host), ("a.wgsl", MODULE)];
        let inputs: Vec<Input> = files.iter().map(|(n, t)| Input::new(SourceFile::new(*n, *t))).collect();
        run(&inputs).iter().filter(|d| d.code.0 == "W012").map(|d| d.message.to_string()).collect()
    }

    fn rust(attributes: &str, stride: &str) -> Vec<String> {
        let host = format!(
            "#[repr(C)]\nstruct Vertex {{ place: [f32; 3], kind: u32 }}\n\
             impl Vertex {{\n  const ATTRIBUTES: [wgpu::VertexAttribute; 2] = {attributes};\n\
             fn desc() -> wgpu::VertexBufferLayout<'static> {{\n  use std::mem;\n  wgpu::VertexBufferLayout {{ array_stride: {stride}, step_mode: wgpu::VertexStepMode::Vertex, attributes: &Self::ATTRIBUTES }}\n}} }}\n\
             fn f(device: &wgpu::Device) {{ let m = device.create_shader_module(wgpu::include_wgsl!(\"a.wgsl\"));\n\
             let s = wgpu::VertexState {{ module: &m, entry_point: Some(\"vs\"), buffers: &[Vertex::desc()] }}; }}\n"
        );
        found("a.rs", &host)
    }

    const SIZE: &str = "mem::size_of::<Vertex>() as wgpu::BufferAddress";

    #[test]
    fn attributes_of_rust_are_held_against_the_inputs() {
        assert!(rust("wgpu::vertex_attr_array![0 => Float32x3, 1 => Uint32]", SIZE).is_empty());
        assert!(rust("wgpu::vertex_attr_array![0 => Float32x2, 1 => Uint8x2]", SIZE).is_empty(), "fewer components");
        let told = rust("wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32]", SIZE);
        assert_eq!(told, ["`Float32` is read as f32, and `kind` in the shader is of u32"]);
        let told = rust("wgpu::vertex_attr_array![0 => Float32x3, 2 => Uint32]", SIZE);
        assert_eq!(told, ["no vertex buffer gives what the shader reads at location 1 (`kind`)"]);
        let told = rust("wgpu::vertex_attr_array![0 => Float32x4, 1 => Uint32]", SIZE);
        assert_eq!(told, ["the attribute ends at byte 20, and a vertex has 16 bytes"]);
        let told = rust("wgpu::vertex_attr_array![0 => Float32x3, 1 => Uint32, 1 => Uint32]", "24");
        assert_eq!(told, ["location 1 is given twice"]);
        let written = "[wgpu::VertexAttribute { shader_location: 0, offset: 0, format: wgpu::VertexFormat::Float32x3 },\n\
                       wgpu::VertexAttribute { shader_location: 1, offset: mem::size_of::<[f32; 3]>() as u64 + 4, format: wgpu::VertexFormat::Uint32 }]";
        assert!(rust(written, SIZE).is_empty(), "a sum of sizes is not followed");
    }

    #[test]
    fn attributes_of_javascript_are_held_against_the_inputs() {
        let host = |buffers: &str| {
            format!(
                "import code from './a.wgsl?raw';\nconst p = device.createRenderPipeline({{ layout: 'auto', vertex: {{ module: device.createShaderModule({{ code }}), buffers: {buffers} }} }});\n"
            )
        };
        let of = |buffers: &str| found("a.ts", &host(buffers));
        let place = "{ arrayStride: 4 * 3, attributes: [{ shaderLocation: 0, offset: 0, format: 'float32x3' }] }";
        assert!(
            of(&format!(
                "[{place}, {{ arrayStride: 4, attributes: [{{ shaderLocation: 1, offset: 0, format: 'uint32' }}] }}]"
            ))
            .is_empty()
        );
        assert_eq!(of(&format!("[{place}]")), ["no vertex buffer gives what the shader reads at location 1 (`kind`)"]);
        assert_eq!(of("[]"), ["no vertex buffer gives what the shader reads at location 0 (`place`), 1 (`kind`)"]);
        assert!(of(&format!("[{place}, ...more]")).is_empty(), "more may come");
        assert!(of(&format!("[{place}, other]")).is_empty());
    }
}
