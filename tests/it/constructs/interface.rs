//! What goes in and out: old and new storage qualifiers, blocks, arrays, structures and built-in variables.

use program::Language;

use super::{built, expect};

#[test]
fn the_oldest_dialect() {
    let text = "attribute vec3 normal;\nvarying vec2 uv;\nuniform float scale;\n#define PI 3.0
      void main() { uv = normal.xy * scale; gl_FrontColor = gl_Color * PI; gl_Position = ftransform(); }";
    let translate = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 10.0, 20.0, 30.0, 1.0];
    let uniforms = [&[2.0][..], &translate].concat();
    // normal, gl_Color, gl_Vertex; gl_Position and gl_FrontColor come out before the author's own.
    let inputs = [1.0, 2.0, 3.0, 0.1, 0.2, 0.3, 1.0, 4.0, 5.0, 6.0, 1.0];
    let program = built("t.vert", text).unwrap();
    let names: Vec<&str> = program.inputs.iter().chain(&program.outputs).map(|p| p.field.name.as_str()).collect();
    assert_eq!(names, ["normal", "gl_Color", "gl_Vertex", "gl_FrontColor", "gl_Position", "uv"]);
    expect("t.vert", text, &inputs, &uniforms, &[0.3, 0.6, 0.9, 3.0, 14.0, 25.0, 36.0, 1.0, 2.0, 4.0]);
}

#[test]
fn state_of_the_old_pipeline_is_uniform() {
    let text = "#version 120
      void main() { gl_Position = gl_LightSource[1].position * gl_LightSource[1].constantAttenuation
        + vec4(gl_NormalMatrix[0], gl_Fog.density); }";
    let program = built("t.vert", text).unwrap();
    let lights = program.uniforms.iter().position(|u| u.field.name == "gl_LightSource[1].position").unwrap();
    let words = |k: usize| program.uniforms[..k].iter().map(|u| u.field.shape.words()).sum::<usize>();
    let at = |name: &str| words(program.uniforms.iter().position(|u| u.field.name == name).unwrap());
    let mut uniforms = vec![0.0; words(program.uniforms.len())];
    uniforms[words(lights)..words(lights) + 4].copy_from_slice(&[1.0, 2.0, 3.0, 4.0]);
    uniforms[at("gl_LightSource[1].constantAttenuation")] = 10.0;
    uniforms[at("gl_NormalMatrix") + 1] = 0.5;
    uniforms[at("gl_Fog.density")] = 0.25;
    expect("t.vert", text, &[], &uniforms, &[10.0, 20.5, 30.0, 40.25]);
}

#[test]
fn uniforms_of_every_kind() {
    let text = "#version 430
      struct Light { vec3 at; bool on; float falloff[2]; };
      uniform Light lights[2]; layout(location = 3) uniform bool flip = true; uniform mat4x2 wide;
      layout(std140, row_major) uniform Block { bvec2 flags; float list[3]; mat2 turn; } block;
      layout(shared) uniform Plain { int count; };
      out vec4 r;
      void main() { int k = count; r = vec4(lights[k].at.y, lights[k].on, lights[k - 1].falloff[k], flip);
        r += vec4(block.flags, block.list[k], (block.turn * vec2(1, 2)).y + (wide * vec4(0, 0, 0, 1)).x); }";
    let light = |base: f64, on: f64| vec![base, base + 1.0, base + 2.0, on, base + 3.0, base + 4.0];
    let wide = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 100.0, 0.0];
    // flags, list, turn (columns), count.
    let block = [1.0, 0.0, 5.0, 6.0, 7.0, 1.0, 2.0, 3.0, 4.0, 1.0];
    let uniforms = [&light(10.0, 1.0)[..], &light(20.0, 1.0), &[1.0], &wide, &block].concat();
    // lights[1].at.y = 21, on, lights[0].falloff[1] = 14, flip; turn * (1, 2) = (7, 10).
    expect("t.vert", text, &[], &uniforms, &[22.0, 1.0, 20.0, 111.0]);
}

#[test]
fn attributes_and_varyings_of_several_locations() {
    let text = "#version 410
      in mat3 m; layout(location = 5) in vec2 pair[2]; struct S { float a; vec2 b; };
      out S s; out mat2 n; out Block { vec3 c; float d[2]; } block; flat out ivec2 k;
      void main() { s = S(m[2].x, pair[1]); n = mat2(m); block.c = m[1]; block.d = float[2](pair[0].x, 9.0); k = ivec2(3, 4);
        gl_Position = vec4(1.0); }";
    let inputs: Vec<f64> = (1..=13).map(f64::from).collect();
    let expected = [1.0, 1.0, 1.0, 1.0, 7.0, 12.0, 13.0, 1.0, 2.0, 4.0, 5.0, 4.0, 5.0, 6.0, 10.0, 9.0, 3.0, 4.0];
    expect("t.vert", text, &inputs, &[], &expected);
}

#[test]
fn a_fragment_stage_is_a_function_of_its_inputs() {
    let text = "#version 130\nvarying vec3 normal; uniform vec3 light; const float k = 0.5;
      void main() { float d = max(dot(normalize(normal), light), 0.0); gl_FragColor = vec4(vec3(d * k), 1.0); gl_FragDepth = d; }";
    expect("t.frag", text, &[0.0, 3.0, 4.0], &[0.0, 1.0, 0.0], &[0.3, 0.3, 0.3, 1.0, 0.6]);
    let text = "#version 300 es\nprecision highp float;\nin vec2 uv; layout(location = 1) out vec2 a; layout(location = 0) out vec4 b;
      void main() { a = uv.yx; b = gl_FrontFacing ? vec4(1.0) : vec4(uv, 0.0, 0.0); }";
    expect("t.frag", text, &[5.0, 6.0, 0.0], &[], &[6.0, 5.0, 5.0, 6.0, 0.0, 0.0]);
}

#[test]
fn several_outputs_by_index() {
    let text = "#version 120\nvarying vec4 c;\nvoid main() { gl_FragData[0] = c; gl_FragData[1].x = c.w; }";
    let program = built("t.frag", text).unwrap();
    assert_eq!(program.outputs[0].field.shape.to_string(), "vec4[2]");
    // An index that is computed may be any.
    let computed = text.replace("[1]", "[int(c.x)]");
    assert_eq!(built("t.frag", &computed).unwrap().outputs[0].field.shape.to_string(), "vec4[8]");
}

#[test]
fn a_geometry_stage_with_blocks_and_invocations() {
    let text = "#version 400
      layout(lines, invocations = 2) in; layout(points, max_vertices = 2) out;
      in Data { float w; vec2 uv; } data[]; in float extra[]; out float o; int calls = 5;
      void main() { for (int k = 0; k < gl_in.length(); k++) { calls++;
        gl_Position = gl_in[k].gl_Position; o = data[k].w + data[k].uv.y + extra[k] + float(100 * gl_InvocationID + calls);
        EmitVertex(); } EndPrimitive(); }";
    let program = built("t.geom", text).unwrap();
    let names: Vec<&str> = program.inputs.iter().map(|p| p.field.name.as_str()).collect();
    assert_eq!(names, ["gl_Position", "data.w", "data.uv", "extra"]);
    let inputs = [1.0, 2.0, 3.0, 1.0, 4.0, 5.0, 6.0, 1.0, 10.0, 20.0, 7.0, 8.0, 9.0, 3.0, 0.5, 0.25];
    let vertex = |p: [f64; 4], o: f64| [&p[..], &[o]].concat();
    // data[0] = (10, (7, 8)), data[1] = (20, (9, 3)); `calls` starts anew in each invocation.
    let (a, b) = ([1.0, 2.0, 3.0, 1.0], [4.0, 5.0, 6.0, 1.0]);
    let expected = [vertex(a, 24.5), vertex(b, 30.25), vertex(a, 124.5), vertex(b, 130.25)].concat();
    expect("t.geom", text, &inputs, &[], &expected);
}

#[test]
fn samplers_are_passed_to_functions() {
    let text = "#version 400
      struct Material { sampler2D diffuse; sampler2D maps[2]; float gain; };
      uniform Material material; uniform samplerCubeShadow shadow; uniform sampler2DArray layers; in vec3 uv; out vec4 c;
      vec4 shade(Material m, int k) { return texture(m.maps[k], uv.xy) * m.gain; }
      vec4 look(sampler2D s, vec2 p) { return texture(s, p); }
      vec4 twice(sampler2D s) { return look(s, uv.xy) * 2.0; }
      void main() { int k = int(uv.z); c = twice(material.diffuse) + look(material.maps[1], uv.yz) * material.gain
        + texture(shadow, vec4(uv, 0.5)) + textureLod(layers, uv, 1.0) + texelFetch(material.maps[0], ivec2(uv), 0)
        + vec4(textureSize(layers, 0), 1.0) + shade(material, 1) + shade(material, k); }";
    let program = built("t.frag", text).unwrap();
    let wgsl = program.translate(Language::Wgsl).unwrap().into_bytes();
    let wgsl = String::from_utf8(wgsl).unwrap();
    for part in
        ["textureSampleCompare(", "textureSampleLevel(layers", "textureLoad(material_maps_0", "textureDimensions("]
    {
        assert!(wgsl.contains(part), "no `{part}` in\n{wgsl}");
    }
    assert!(program.compute_kernel().is_ok());
}

#[test]
fn a_compute_stage_is_translated() {
    let text = "#version 430
      layout(local_size_x = 4, local_size_y = 2) in;
      layout(std430, binding = 0) buffer Data { uint count; bool flag; float values[]; };
      layout(rgba8, binding = 1) uniform image2D target; shared float tile[gl_WorkGroupSize.x + 2u];
      void main() { tile[gl_LocalInvocationIndex] = values[gl_GlobalInvocationID.x]; barrier();
        if (flag) values[atomicAdd(count, 1u)] = tile[0] + float(values.length());
        imageStore(target, ivec2(gl_WorkGroupID.xy), imageLoad(target, ivec2(0)) + 1.0); }";
    let wgsl = built("t.comp", text).unwrap().translate(Language::Wgsl).unwrap().into_bytes();
    let wgsl = String::from_utf8(wgsl).unwrap();
    for part in ["workgroup_size(4, 2, 1)", "atomicAdd(", "arrayLength(", "textureStore(", "array<f32, 6>"] {
        assert!(wgsl.contains(part), "no `{part}` in\n{wgsl}");
    }
}

#[test]
fn each_vertex_has_the_number_of_its_stream() {
    let text = "#version 400
      layout(points) in; layout(points, max_vertices = 3) out;
      layout(stream = 0) out float a; layout(stream = 1) out float b; layout(stream = 1) out Block { vec2 c; };
      void main() { a = 1.0; gl_Position = gl_in[0].gl_Position; b = 9.0; EmitStreamVertex(0); EndStreamPrimitive(0);
        b = 2.0; c = vec2(3.0, 4.0); a = 9.0; EmitStreamVertex(1); a = 5.0; gl_Position = vec4(6.0); EmitVertex(); }";
    let program = built("t.geom", text).unwrap();
    let names: Vec<&str> = program.outputs.iter().map(|p| p.field.name.as_str()).collect();
    assert_eq!(names, ["gl_Position", "emit_stream", "a", "b", "c"]);
    // What belongs to another stream is 0. `EmitVertex` is for the first stream.
    let first = [1.0, 2.0, 3.0, 4.0, 0.0, 1.0, 0.0, 0.0, 0.0];
    let second = [0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 2.0, 3.0, 4.0];
    for found in super::outputs(&program, &[1.0, 2.0, 3.0, 4.0], &[]) {
        assert_eq!(found[..9], first);
        assert_eq!(found[9..18], second);
        assert_eq!(found[18..], [6.0, 6.0, 6.0, 6.0, 0.0, 5.0, 0.0, 0.0, 0.0]);
    }
}

#[test]
fn arrays_and_structures_of_each_vertex() {
    let text = "#version 330
      layout(lines) in; layout(points, max_vertices = 1) out; struct S { float s; vec2 t; };
      in Data { float a[2]; S b; } data[]; out float r;
      void main() { r = data[0].a[1] + 10.0 * data[1].a[0] + 100.0 * data[1].b.t.y + gl_in[1].gl_ClipDistance[1];
        gl_Position = gl_in[0].gl_Position; EmitVertex(); }";
    let program = built("t.geom", text).unwrap();
    let names: Vec<&str> = program.inputs.iter().map(|p| p.field.name.as_str()).collect();
    assert_eq!(names[..4], ["gl_Position", "gl_in[0].gl_ClipDistance", "gl_in[1].gl_ClipDistance", "data[0].a"]);
    assert_eq!(names[4..], ["data[1].a", "data[0].b.s", "data[0].b.t", "data[1].b.s", "data[1].b.t"]);
    // Two positions, two distances of two vertices, then a and b of each.
    let inputs: Vec<f64> = (1..=22).map(f64::from).collect();
    // data[0].a = (13, 14), data[1].a = (15, 16), data[1].b.t = (21, 22), the distances of vertex 1 are (11, 12).
    expect("t.geom", text, &inputs, &[], &[1.0, 2.0, 3.0, 4.0, 14.0 + 150.0 + 2200.0 + 12.0]);
    assert!(program.compute_kernel().is_ok());
}

#[test]
fn an_array_of_one_element_goes_in() {
    let text = "#version 330\nin float a[1]; in vec2 b[2]; out float r; void main() { r = a[0] + b[1].y; gl_Position = vec4(0.0); }";
    expect("t.vert", text, &[1.0, 2.0, 3.0, 4.0, 5.0], &[], &[0.0, 0.0, 0.0, 0.0, 6.0]);
    assert!(built("t.vert", text).unwrap().compute_kernel().is_ok());
}

#[test]
fn built_in_variables_that_are_varyings_here() {
    let text = "#version 430\nin vec4 p; out vec4 r; void main() { r = p * float(gl_Layer) + vec4(gl_ViewportIndex, gl_SamplePosition, gl_HelperInvocation); }";
    let program = built("t.frag", &text.replace("430", "450")).unwrap();
    let names: Vec<&str> = program.inputs.iter().map(|p| p.field.name.as_str()).collect();
    assert_eq!(names, ["p", "gl_Layer", "gl_ViewportIndex", "gl_SamplePosition", "gl_HelperInvocation"]);
    let inputs = [1.0, 2.0, 3.0, 4.0, 2.0, 5.0, 0.25, 0.75, 1.0];
    expect("t.frag", &text.replace("430", "450"), &inputs, &[], &[7.0, 4.25, 6.75, 9.0]);
}

#[test]
fn arrays_take_their_size_from_constants_and_from_their_use() {
    let text = "#version 150
      flat out ivec4 f[min(gl_MaxVertexOutputComponents, gl_MaxGeometryInputComponents) / 32]; in vec4 p;
      out Block { float open[]; vec2 b; } block;
      void main() { gl_Position = p; f[1] = ivec4(p); f[0] = ivec4(f.length()); block.open[2] = 5.0; block.open[0] = 1.0; block.open[1] = 3.0; block.b = p.xy; }";
    expect(
        "t.vert",
        text,
        &[1.0, 2.0, 3.0, 4.0],
        &[],
        &[1.0, 2.0, 3.0, 4.0, 2.0, 2.0, 2.0, 2.0, 1.0, 2.0, 3.0, 4.0, 1.0, 3.0, 5.0, 1.0, 2.0],
    );
}

#[test]
fn four_offsets_are_four_gathers() {
    let text = "#version 400\nuniform sampler2D t; in vec2 uv; out vec4 c; const ivec2 at[4] = ivec2[4](ivec2(0), ivec2(1), ivec2(-2, 1), ivec2(3, 0));
      void main() { c = textureGatherOffsets(t, uv, at, 2); }";
    let wgsl = built("t.frag", text).unwrap().translate(Language::Wgsl).unwrap().into_bytes();
    let wgsl = String::from_utf8(wgsl).unwrap();
    assert_eq!(wgsl.matches("textureGather(2, ").count(), 4, "{wgsl}");
    assert!(wgsl.contains("vec2<i32>(-2i, 1i)") && wgsl.contains("vec2<i32>(3i, 0i)"), "{wgsl}");
}

#[test]
fn offset_and_component_of_a_gather() {
    let text = "#version 400\nuniform sampler2D t; uniform sampler2DShadow s; in vec2 uv; out vec4 c;
      void main() { c = textureGatherOffset(t, uv, ivec2(1, 2), 3) + textureGatherOffset(s, uv, 0.25, ivec2(3, 4)); }";
    let wgsl = built("t.frag", text).unwrap().translate(Language::Wgsl).unwrap().into_bytes();
    let wgsl = String::from_utf8(wgsl).unwrap();
    assert!(wgsl.contains("textureGather(3, t") && wgsl.contains("vec2<i32>(1i, 2i)"), "{wgsl}");
    let compare = wgsl.split("textureGatherCompare(").nth(1).unwrap();
    let call = compare.split(';').next().unwrap();
    assert!(call.contains("0.25f, vec2<i32>(3i, 4i)"), "{wgsl}");
}

#[test]
fn locations_that_are_not_written_go_around_those_that_are() {
    let text = "#version 460
      layout(location = 0) out Block { vec4 a; layout(location = 4) vec4 b[2]; vec4 c; }; out vec4 d; out vec4 e[3]; in vec4 p;
      layout(location = 10) out Open { float o[]; }; out float f[5];
      void main() { o[4] = float(gl_BaseVertex); f[0] = 1.0; a = p; b[0] = p; b[1] = p; c = p; d = p; e[2] = p; gl_Position = p; }";
    let program = built("t.vert", text).unwrap();
    let function = &program.module.entry_points[0].function;
    let naga::TypeInner::Struct { members, .. } = &program.module.types[function.result.as_ref().unwrap().ty].inner
    else {
        panic!()
    };
    let location = |m: &naga::StructMember| match m.binding {
        Some(naga::Binding::Location { location, .. }) => Some(location),
        _ => None,
    };
    assert_eq!(
        members.iter().filter_map(location).collect::<Vec<_>>(),
        [0, 4, 5, 6, 1, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19]
    );
}
