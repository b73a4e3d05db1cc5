//! Tessellation stages as functions over the vertices of a patch, and what else has no counterpart in naga by itself.

use program::{Language, Program, read_back};

use super::{built, outputs};

/// What one invocation gives: inputs by name, and outputs by name in binary64 and binary32.
fn run(name: &str, text: &str, given: &[(&str, &[f64])]) -> [Vec<(String, Vec<f64>)>; 2] {
    let program = built(name, text).unwrap_or_else(|e| panic!("{e}\n{text}"));
    let mut inputs = Vec::new();
    for port in &program.inputs {
        let found = given.iter().find(|(name, _)| *name == port.field.name);
        let (_, values) = found.unwrap_or_else(|| panic!("nothing for `{}`", port.field.name));
        assert_eq!(values.len(), port.field.shape.words(), "{}", port.field.name);
        inputs.extend_from_slice(values);
    }
    assert_eq!(program.inputs.len(), given.len());
    outputs(&program, &inputs, &[]).map(|all| {
        let mut rest = all.as_slice();
        let ports = program.outputs.iter().map(|port| {
            let (own, behind) = rest.split_at(port.field.shape.words());
            rest = behind;
            (port.field.name.clone(), own.to_vec())
        });
        ports.collect()
    })
}

#[track_caller]
fn translates(program: &Program) {
    for language in [Language::SpirV, Language::Wgsl] {
        let translation = program.translate(language).unwrap_or_else(|e| panic!("{language}: {e}"));
        read_back(&translation, language, &program.role).unwrap_or_else(|e| panic!("{language}: {e}"));
    }
}

#[test]
fn an_evaluation_stage_gives_one_vertex() {
    let text = "#version 410
      layout(quads) in;
      in vec2 uv[];
      patch in float height;
      out vec2 st;
      void main() {
        gl_Position = mix(gl_in[0].gl_Position, gl_in[2].gl_Position, gl_TessCoord.x) + vec4(0.0, height, 0.0, 0.0);
        st = uv[1] * gl_TessCoord.y;
      }";
    // The patch has as many vertices as the text reads.
    let given: [(&str, &[f64]); 4] = [
        ("gl_Position", &[1.0, 2.0, 3.0, 1.0, 0.0, 0.0, 0.0, 0.0, 5.0, 6.0, 7.0, 1.0]),
        ("uv", &[0.0, 0.0, 8.0, 4.0, 0.0, 0.0]),
        ("height", &[10.0]),
        ("gl_TessCoord", &[0.25, 0.5, 0.25]),
    ];
    for found in run("t.tese", text, &given) {
        let want = [("gl_Position".to_owned(), vec![2.0, 13.0, 4.0, 1.0]), ("st".to_owned(), vec![4.0, 2.0])];
        assert_eq!(found, want);
    }
    translates(&built("t.tese", text).unwrap());
}

#[test]
fn an_invocation_of_a_control_stage_writes_its_vertex() {
    let text = "#version 400
      layout(vertices = 2) out;
      in vec2 c[];
      out vec2 d[];
      patch out float e;
      void main() {
        d[gl_InvocationID] = c[gl_InvocationID] * 2.0;
        e = gl_in[gl_InvocationID].gl_Position.x;
        gl_TessLevelOuter[1] = 3.0;
      }";
    let given: [(&str, &[f64]); 3] = [
        ("gl_Position", &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0]),
        ("c", &[1.0, 2.0, 3.0, 4.0]),
        ("gl_InvocationID", &[1.0]),
    ];
    for found in run("t.tesc", text, &given) {
        let of = |name: &str| found.iter().find(|(n, _)| n == name).unwrap().1.clone();
        assert_eq!(of("d")[2..], [6.0, 8.0]);
        assert_eq!((of("e"), of("gl_TessLevelOuter")[1]), (vec![5.0], 3.0));
    }
    translates(&built("t.tesc", text).unwrap());
}

#[test]
fn a_computed_index_into_structures_with_samplers_chooses_the_call() {
    let text = "#version 430
      struct Light { float power; sampler2D shadow; };
      uniform Light lights[3];
      uniform int n;
      out float r;
      float f(Light l) { return l.power; }
      void main() { r = f(lights[n]); }";
    let program = built("t.frag", text).unwrap();
    let uniforms = program.uniforms.iter().map(|u| match u.field.name.as_str() {
        "n" => 2.0,
        "lights[0].power" => 10.0,
        "lights[1].power" => 20.0,
        "lights[2].power" => 30.0,
        other => panic!("{other}"),
    });
    let uniforms: Vec<f64> = uniforms.collect();
    for found in outputs(&program, &[], &uniforms) {
        assert_eq!(found, [30.0]);
    }
}

#[test]
fn what_the_reader_of_spirv_lacks_is_translated() {
    let texts = [
        // The number of layers, and a division of vectors, of which naga writes `&&` of vectors.
        (
            "t.frag",
            "#version 430\nuniform sampler2DArray t;\nout vec4 c;\nvoid main() { c = vec4(textureSize(t, 0), 1); }",
        ),
        ("t.frag", "#version 430\nflat in ivec2 a;\nflat in ivec2 b;\nout vec2 c;\nvoid main() { c = vec2(a / b); }"),
        // Attributes at one location, and memory of a stage that becomes a kernel.
        (
            "t.vert",
            "#version 430\nlayout(location = 0) in vec4 a;\nlayout(location = 0) in vec4 b;\nvoid main() { gl_Position = a + b; }",
        ),
        (
            "t.geom",
            "#version 430\nlayout(points) in;\nlayout(points, max_vertices = 1) out;\nbuffer B { vec4 a[]; };\n\
             void main() { gl_Position = a[gl_PrimitiveIDIn]; EmitVertex(); }",
        ),
        (
            "t.geom",
            "#version 430\nlayout(points) in;\nlayout(points, max_vertices = 1) out;\n\
             void main() { gl_Position = vec4(0.0); gl_ClipDistance = gl_in[0].gl_ClipDistance; EmitVertex(); }",
        ),
        (
            "t.frag",
            "#version 430\nlayout(size1x32) uniform image2D i;\nout vec4 c;\nvoid main() { c = imageLoad(i, ivec2(0)); }",
        ),
    ];
    for (name, text) in texts {
        let program = built(name, text).unwrap_or_else(|e| panic!("{e}\n{text}"));
        let translation = program.translate(Language::SpirV).unwrap_or_else(|e| panic!("{e}\n{text}"));
        read_back(&translation, Language::SpirV, &program.role).unwrap_or_else(|e| panic!("{e}\n{text}"));
    }
}
