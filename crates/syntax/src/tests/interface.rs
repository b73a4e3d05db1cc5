//! The stage interface of the listings, with exact spans.

use super::*;
use crate::Const;
use crate::ast::{Interpolation, Precision, StorageQualifier};
use crate::interface::{InputPrimitive, OutputPrimitive, Storage, Variable};
use crate::symbols::{Access, Direction, SymbolKind};

fn described(shader: &Shader, variables: &[Variable]) -> Vec<String> {
    variables.iter().map(|v| format!("{} {} <{}>", v.ty, v.name, text(shader, v.declarator_span))).collect()
}

#[test]
fn skinning_has_its_interface() {
    let shader = clean(SKINNING, Stage::Vertex);
    let i = shader.interface();
    assert_eq!(described(&shader, &i.inputs), ["vec4 position <position>"]);
    assert_eq!(
        described(&shader, &i.uniforms),
        [
            "mat4 modelViewMatrix <modelViewMatrix>",
            "mat4 projectionMatrix <projectionMatrix>",
            "int numberOfBones <numberOfBones>",
            "vec4[8] p0 <p0[MAXBONES]>",
            "vec4[8] p1 <p1[MAXBONES]>",
            "mat4[8] blendMatrix <blendMatrix[MAXBONES]>",
        ]
    );
    assert_eq!(described(&shader, &i.constants), ["int MAXBONES <MAXBONES = 8>", "float exponent <exponent = -16.0>"]);
    assert_eq!(i.constant("MAXBONES").unwrap().value, Some(Const::Int(8)));
    assert_eq!(i.constant("exponent").unwrap().value, Some(Const::Float(-16.0)));
    assert!(i.outputs.is_empty() && i.blocks.is_empty());
}

#[test]
fn two_names_in_one_declaration_keep_their_places() {
    let shader = clean(SKINNING, Stage::Vertex);
    let (p0, p1) = (shader.interface().uniform("p0").unwrap(), shader.interface().uniform("p1").unwrap());
    assert_eq!((p0.position, p1.position, p0.siblings), (0, 1, 2));
    assert_eq!(p0.item, p1.item);
    assert_eq!(text(&shader, p1.declaration_span), "uniform vec4 p0[MAXBONES], p1[MAXBONES];");
    assert_eq!(text(&shader, p1.type_span), "vec4");
    assert_eq!(text(&shader, p1.name_span), "p1");
    assert_eq!(text(&shader, p1.dims[0].span), "[MAXBONES]");
    let (storage, span) = p1.qualifiers.storage().unwrap();
    assert_eq!((storage, text(&shader, span)), (StorageQualifier::Uniform, "uniform"));
    assert_eq!(p1.ty.shape().map(|s| s.to_string()).as_deref(), Some("vec4[8]"));
}

#[test]
fn places_behind_multi_byte_comments_are_in_characters() {
    let shader = clean(SKINNING, Stage::Vertex);
    let p0 = shader.interface().uniform("p0").unwrap();
    assert_eq!(shader.file().position(p0.name_span.start).to_string(), "13:14");
    assert_eq!(shader.comments().len(), 4);
    assert_eq!(text(&shader, shader.comments()[0].span), "// 骨の数の上限");
}

#[test]
fn version_and_extensions_have_the_span_of_their_directive() {
    let shader = clean(HAIR, Stage::Geometry);
    assert_eq!(shader.version().number, 150);
    assert_eq!(text(&shader, shader.version().span.unwrap()), "#version 150 core");
    let [extension] = shader.extensions() else { panic!("one extension") };
    assert_eq!((extension.name.as_str(), extension.behavior.as_str()), ("GL_ARB_explicit_attrib_location", "enable"));
    assert_eq!(text(&shader, extension.span), "#extension GL_ARB_explicit_attrib_location : enable");
}

#[test]
fn hair_has_its_geometry_layout() {
    let shader = clean(HAIR, Stage::Geometry);
    let g = &shader.interface().geometry;
    let (input, output, max) = (g.input.unwrap(), g.output.unwrap(), g.max_vertices.unwrap());
    assert_eq!((input.value, text(&shader, input.span)), (InputPrimitive::LinesAdjacency, "lines_adjacency"));
    assert_eq!((output.value, text(&shader, output.span)), (OutputPrimitive::LineStrip, "line_strip"));
    assert_eq!((max.value, text(&shader, max.span)), (20, "max_vertices = 20"));
    assert_eq!(g.invocations, None);
    let layouts: Vec<_> = shader.interface().stage_layouts.iter().map(|l| text(&shader, l.span)).collect();
    assert_eq!(layouts, ["layout(lines_adjacency) in;", "layout(line_strip, max_vertices = 20) out;"]);
    assert_eq!(
        described(&shader, &shader.interface().outputs),
        ["vec3 v <v>", "vec3 l <l>", "vec3 t <t>"],
        "three names in one declaration"
    );
    let gl_in = shader.symbol(shader.builtin("gl_in").unwrap());
    assert_eq!(gl_in.ty.to_string(), "gl_PerVertex[4]");
    assert_eq!(shader.uses_of(shader.builtin("gl_in").unwrap()).count(), 4);
}

#[test]
fn unsized_geometry_inputs_have_the_vertices_of_the_primitive() {
    for (primitive, n) in
        [("points", 1), ("lines", 2), ("lines_adjacency", 4), ("triangles", 3), ("triangles_adjacency", 6)]
    {
        // The layout may stand behind the input.
        let source = format!(
            "#version 150\nin vec3 n[];\nin B {{ vec2 uv; }} b[];\nlayout({primitive}) in;\n\
             layout(points, max_vertices = 1) out;\nvoid main() {{ gl_Position = gl_in[0].gl_Position + n.length(); }}"
        );
        let shader = clean(&source, Stage::Geometry);
        assert_eq!(shader.interface().input("n").unwrap().ty.to_string(), format!("vec3[{n}]"));
        assert_eq!(shader.interface().blocks[0].ty.to_string(), format!("B[{n}]"));
    }
}

#[test]
fn constants_in_layouts_and_macros_are_folded() {
    let shader = clean(PARTICLES, Stage::Geometry);
    assert_eq!(shader.interface().geometry.max_vertices.unwrap().value, 4);
    let source = "#version 440\nconst int N = 1 << 2;\nlayout(triangles, invocations = 2) in;\n\
                  layout(points, max_vertices = N * 3 - 2) out;\nvoid main() {}";
    let g = clean(source, Stage::Geometry).interface().geometry.clone();
    assert_eq!((g.max_vertices.unwrap().value, g.invocations.unwrap().value), (10, 2));
}

#[test]
fn qualifiers_keep_their_spans_and_values() {
    let source =
        "#version 410\nlayout(location = 2) flat in highp int k[];\ninvariant centroid out vec4 o;\nvoid main() {}";
    let shader = clean(source, Stage::TessEvaluation);
    let k = shader.interface().input("k").unwrap();
    let location = k.qualifiers.layout_entry("location").unwrap();
    assert_eq!(text(&shader, location.span), "location = 2");
    assert_eq!(shader.fold(location.value.unwrap()), Some(Const::Int(2)));
    assert_eq!(text(&shader, k.qualifiers.layouts().next().unwrap().1), "layout(location = 2)");
    assert_eq!(k.qualifiers.interpolation().map(|(i, s)| (i, text(&shader, s))), Some((Interpolation::Flat, "flat")));
    assert_eq!(k.qualifiers.precision().map(|(p, s)| (p, text(&shader, s))), Some((Precision::High, "highp")));
    let o = shader.interface().output("o").unwrap();
    assert_eq!(o.qualifiers.invariant().map(|s| text(&shader, s)), Some("invariant"));
    assert_eq!(text(&shader, k.qualifiers.span().unwrap()), "layout(location = 2) flat in highp");
}

#[test]
fn attributes_and_varyings_are_inputs_and_outputs_by_stage() {
    let shader = clean(LEGACY, Stage::Vertex);
    assert_eq!(described(&shader, &shader.interface().inputs), ["vec3 tangent <tangent>"]);
    assert_eq!(described(&shader, &shader.interface().outputs), ["vec3 normal <normal>", "vec2 uv <uv>"]);
    assert_eq!((shader.version().number, shader.version().span), (110, None));
    let fragment = clean("varying vec2 uv;\nvoid main() { gl_FragColor = vec4(uv, 0.0, 1.0); }", Stage::Fragment);
    assert_eq!(fragment.interface().inputs.len(), 1);
}

#[test]
fn blocks_have_members_and_instances() {
    let shader = clean(PHONG, Stage::Fragment);
    let [scene, surface] = shader.interface().blocks.as_slice() else { panic!("two blocks") };
    assert_eq!((scene.name.name.as_str(), scene.storage), ("Scene", Storage::Uniform));
    let members: Vec<_> = scene.members.iter().map(|m| format!("{} {}", m.ty, m.name.name)).collect();
    assert_eq!(members, ["mat4 view", "vec3 eye", "int count"]);
    assert_eq!(surface.storage, Storage::In);
    assert_eq!(surface.instance.as_ref().unwrap().name, "surface");
    assert!(
        text(&shader, surface.span).starts_with("in VertexData {")
            && text(&shader, surface.span).ends_with("} surface;")
    );
    assert_eq!(text(&shader, scene.members[1].declaration_span), "vec3 eye;");
    let uses = shader.uses_of(surface.symbol.unwrap()).count();
    assert_eq!(uses, 5, "each use of the instance counts");
}

#[test]
fn members_of_blocks_without_instance_are_variables() {
    let source = "#version 150\nuniform U { mat4 m; vec4 k; };\nin vec4 p;\nvoid main() { gl_Position = m * p + k; }";
    let shader = clean(source, Stage::Vertex);
    let symbol = shader.interface().blocks[0].members[1].symbol.unwrap();
    assert_eq!(shader.symbol(symbol).kind, SymbolKind::BlockMember(0));
    assert_eq!(shader.uses_of(symbol).count(), 1);
}

#[test]
fn uses_tell_reads_from_writes() {
    let source = "#version 150\nin vec4 p;\nout vec4 a, b, c;\nvoid set(out vec4 x, inout vec4 y) { x = y; }\n\
                  void main() {\n  a.xy = p.xy;\n  set(b, c);\n  gl_Position = p;\n  gl_Position.w += 1.0;\n}";
    let shader = clean(source, Stage::Vertex);
    let access = |name: &str| -> Vec<(Access, bool)> {
        let symbol = shader.interface().output(name).unwrap().symbol;
        shader.uses_of(symbol).map(|u| (u.access, u.partial)).collect()
    };
    assert_eq!(access("a"), [(Access::Write, true)]);
    assert_eq!(access("b"), [(Access::Write, false)]);
    assert_eq!(access("c"), [(Access::ReadWrite, false)]);
    let p = shader.interface().input("p").unwrap().symbol;
    assert!(!shader.is_written(p) && shader.symbol(p).read_only);
    assert_eq!(shader.uses_of(p).count(), 2);
    let position = shader.builtin("gl_Position").unwrap();
    let uses: Vec<_> = shader.uses_of(position).map(|u| (u.access, text(&shader, u.span))).collect();
    assert_eq!(uses, [(Access::Write, "gl_Position"), (Access::ReadWrite, "gl_Position")]);
    assert_eq!(shader.builtin("gl_PointSize"), None, "not used");
    let main = shader.functions().find(|(_, f)| f.name.name == "main").unwrap().0;
    assert!(shader.uses_of(position).all(|u| u.function == Some(main)));
}

#[test]
fn an_output_that_is_never_written_is_known() {
    let shader = clean("#version 150\nout vec4 c;\nvoid main() { vec4 d = c; }", Stage::Fragment);
    assert!(!shader.is_written(shader.interface().output("c").unwrap().symbol));
}

#[test]
fn functions_have_signatures_and_prototypes() {
    let shader = clean(PHONG, Stage::Fragment);
    let shade = shader.function("shade").unwrap();
    let params: Vec<_> = shade.params.iter().map(|p| format!("{:?} {}", p.direction, p.ty)).collect();
    assert_eq!(params, ["In Light", "In vec3", "In vec3", "Out float"]);
    assert_eq!(shade.params[3].direction, Direction::Out);
    assert_eq!(text(&shader, shade.params[3].span), "out float specular");
    let falloff = shader.function("falloff").unwrap();
    assert!(falloff.definition > falloff.prototypes.first().copied());
    let syntax = shader.function_syntax(falloff).unwrap();
    assert_eq!(text(&shader, syntax.head_span), "float falloff(in Light light, float d)");
    assert!(shader.function_syntax(shade).unwrap().body.is_some());
    let overloads = clean(GRAMMAR, Stage::Fragment);
    assert_eq!(overloads.functions().filter(|(_, f)| f.name.name == "pick").count(), 2);
}

#[test]
fn a_library_needs_no_main() {
    let shader = clean("float f(float x) { return x * 2.0; }", Stage::Library);
    assert_eq!(shader.function("f").unwrap().return_type.to_string(), "float");
}

#[test]
fn redeclared_built_ins_stay_built_in() {
    let source = "#version 150\nin vec4 p;\nout gl_PerVertex { vec4 gl_Position; };\nvoid main() { gl_Position = p; }";
    let shader = clean(source, Stage::Vertex);
    assert!(shader.is_written(shader.builtin("gl_Position").unwrap()));
    assert!(shader.interface().outputs.is_empty());
}
