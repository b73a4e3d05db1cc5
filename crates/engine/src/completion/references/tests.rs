use base::text::SourceFile;
use syntax::{Shader, Stage};

use super::{Unfolded, unfolded};

const VERSION: &str = "#version 460\n#extension GL_EXT_buffer_reference2 : require\n\
    #extension GL_EXT_scalar_block_layout : require\n#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require\n\
    layout(local_size_x = 64) in;\nvoid main() {}\n";

/// What a text becomes, without what stands in front of it, and the errors of that.
fn of(text: &str) -> Option<(String, Vec<String>)> {
    let file = SourceFile::new("a.comp", format!("{VERSION}{text}"));
    let parsed = Shader::parse_with(&file, Stage::Compute, &[]);
    let Unfolded { file, .. } = unfolded(&parsed.shader)?;
    let errors = Shader::parse_with(&file, Stage::Compute, &[]).diagnostics;
    Some((file.text().strip_prefix(VERSION)?.to_owned(), errors.iter().map(|d| d.message.to_string()).collect()))
}

#[test]
fn each_address_leads_to_a_buffer_of_its_own() {
    let floats =
        "layout(buffer_reference, std430, buffer_reference_align = 4) readonly buffer Floats { float data[]; };\n";
    let text = "layout(push_constant) uniform P { Floats a; Floats b[2]; uint64_t c; } p;\n\
                float f(Floats x) { return x.data[1]; }\n\
                float g() { Floats y = Floats(p.c); return y.data[0] + p.a.data[2] + p.b[1].data[3] + f(Floats(p.c)); }\n";
    let (out, errors) = of(&format!("{floats}{text}")).expect("a text without references");
    assert_eq!(errors, [""; 0], "{out}");
    let one = |name: &str| format!("layout(std430) readonly buffer sc_{name} {{ float data[]; }} {name}; ");
    let buffers = ["Floats_a", "Floats_b", "Floats_address", "Floats_x"].map(one);
    assert!(buffers.iter().all(|buffer| out.contains(buffer)), "{out}");
    assert!(
        out.ends_with(
            "layout(push_constant) uniform P { uvec2 a; uvec2 b[2]; uint64_t c; } p;\n\
         float f(uvec2 x) { return Floats_x.data[1]; }\n\
         float g() { uvec2 y = uvec2(1u); return Floats_address.data[0] + Floats_a.data[2] + Floats_b.data[3] + \
         f(uvec2(1u)); }\n"
        ),
        "{out}"
    );
}

#[test]
fn an_element_behind_a_reference_is_one_of_an_array() {
    let text = "layout(buffer_reference) buffer Node;\n\
                layout(buffer_reference, scalar) buffer Vertex { vec3 position; float w; };\n\
                layout(buffer_reference, std430) buffer Node { Node next; float value; };\n\
                struct Mesh { Vertex vertices; uint count; };\n\
                layout(set = 0, binding = 0) readonly buffer Meshes { Mesh meshes[]; };\n\
                layout(push_constant) uniform P { uint mesh; Node head; };\n\
                float f(Vertex v, uint i) { return v[i].position.x + v.w; }\n\
                float g() { Mesh m = meshes[mesh]; return f(m.vertices, m.count) + head.value + head.next.value; }\n";
    let (out, errors) = of(text).expect("a text without references");
    assert_eq!(errors, [""; 0], "{out}");
    assert!(out.contains("return Vertex_v.all[i].position.x + Vertex_v.all[0].w;"), "{out}");
    assert!(out.contains("return f(m.vertices, m.count) + Node_head.value + Node_next.value;"), "{out}");
}

#[test]
fn a_variable_with_several_addresses_leaves_the_text_as_it_is() {
    let node = "layout(buffer_reference, std430) buffer Node { uvec2 next; float value; };\n\
                layout(push_constant) uniform P { Node head; Node other; };\n";
    let of = |body: &str| of(&format!("{node}float f() {{ {body} }}\n")).map(|_| ());
    assert_eq!(of("Node n = head; return n.value;"), Some(()));
    assert_eq!(of("Node n; n = head; return n.value;"), Some(()));
    assert_eq!(of("Node n = head; n = other; return n.value;"), None);
    assert_eq!(of("float s = 0.0; for (Node n = head; s < 9.0; n = Node(n.next)) s += n.value; return s;"), None);
    let plain = SourceFile::new("a.comp", format!("{VERSION}void main() {{}}\n"));
    assert!(unfolded(&Shader::parse_with(&plain, Stage::Compute, &[]).shader).is_none());
}

#[test]
fn an_address_that_an_index_chooses_is_told() {
    let text = |index: &str| {
        format!(
            "{VERSION}layout(buffer_reference, std430) buffer Sum {{ float total; }};\n\
             layout(push_constant) uniform P {{ Sum sums[4]; uint k; }};\n\
             void f(uint i) {{ restrict Sum own = sums[{index}]; own.total += 1.0; }}\n"
        )
    };
    let shares = |index: &str| {
        let file = SourceFile::new("a.comp", text(index));
        let found = unfolded(&Shader::parse_with(&file, Stage::Compute, &[]).shader).expect("a reference");
        let errors = Shader::parse_with(&found.file, Stage::Compute, &[]).diagnostics;
        assert!(errors.is_empty(), "{}", found.file.text());
        found.shares
    };
    assert_eq!((shares("2"), shares("i")), (false, true));
}
