//! What no module can say is refused by name, at its place.

use base::text::SourceFile;
use program::lower::Target;
use program::{Program, ProgramError};
use syntax::{Shader, Stage};

use super::built;

#[track_caller]
fn refused(name: &str, text: &str, at: &str, said: &str) {
    let Err(ProgramError::Source(found)) = built(name, text) else { panic!("not refused:\n{text}") };
    let first = &found[0];
    assert!(first.message.contains(said), "{}", &*first.message);
    assert!(text[first.span.start..].starts_with(at), "at `{}`", &text[first.span.start..]);
}

#[test]
fn constructs_without_a_counterpart() {
    let head = "#version 430\nuniform sampler2D t;\nuniform isamplerCube n;\nin vec2 uv;\nout vec4 c;\n";
    let cases = [
        ("c = vec4(textureQueryLod(t, uv), 0, 0);", "textureQueryLod", "`textureQueryLod`"),
        ("c = vec4(interpolateAtCentroid(uv), 0, 0);", "interpolateAtCentroid", "interpolation at another place"),
        ("c = vec4(texture(n, uv.xyx));", "texture(n", "`texture` of a `isamplerCube`"),
    ];
    for (body, at, said) in cases {
        refused("t.frag", &format!("{head}void main() {{ {body} }}\n"), at, said);
    }
}

#[test]
fn memory_that_has_no_type() {
    refused(
        "t.comp",
        "#version 430\nlayout(local_size_x = 1) in;\nlayout(r8ui) uniform uimageBuffer b;\nvoid main() { imageStore(b, 0, uvec4(1)); }",
        "b, 0",
        "`uimageBuffer` of the format `r8ui`",
    );
    refused(
        "t.vert",
        "#version 400\nsubroutine float Shape(float x);\nsubroutine uniform Shape shape;\n\
            subroutine(Shape) float round_one(float x) { return x; }\nvoid main() { gl_Position = vec4(shape(1.0)); }",
        "shape;",
        "a subroutine uniform",
    );
    refused(
        "t.tesc",
        "#version 400\nlayout(vertices = 1) out;\nvoid main() { barrier(); gl_TessLevelOuter[0] = 1.0; }",
        "barrier",
        "`barrier` outside of a compute shader",
    );
    refused(
        "t.vert",
        "#version 330\nfloat f(float a);\nvoid main() { gl_Position = vec4(f(1.0)); }",
        "f(1.0)",
        "`f`, which is declared and never defined,",
    );
}

#[test]
fn a_function_that_reads_an_input_of_the_stage_is_not_run_alone() {
    let text = "#version 330\nin vec4 p;\nvec4 f(float a) { return p * a; }\nfloat g(float a) { return float(gl_VertexID) * a; }
      float h(float a) { return a; }\nvoid main() { gl_Position = f(1.0) * g(1.0) * h(1.0); }";
    let shader = Shader::parse(&SourceFile::new("t.vert", text), Stage::Vertex).shader;
    let function = |name: &str| Program::build(&shader, &Target::Function(name.to_owned())).unwrap();
    for (name, said) in [("f", "`p`, an input of the stage,"), ("g", "`gl_VertexID`, an input of the stage,")] {
        assert!(function(name).check_fed().unwrap_err().to_string().contains(said));
    }
    assert!(function("h").check_fed().is_ok());
}

#[test]
fn what_a_fragment_stage_cannot_be_given() {
    let head = "#version 430\nin vec2 uv;\nout vec4 c;\nuniform sampler2DMSArray m;\nlayout(rgba8) uniform image2D i;\n\
                float cut(float a) { if (a > 0.5) discard; return a; }\n";
    let cases = [
        ("c = texelFetch(m, ivec3(uv, 0), 0);", "`m` of type `sampler2DMSArray` cannot be fed"),
        ("c = imageLoad(i, ivec2(uv));", "`i` of type `image2D` cannot be fed"),
        ("c = vec4(0); for (int k = 0; k < 3; k++) c += dFdx(uv.xyxy);", "a derivative in a loop cannot be fed"),
        (
            "c = vec4(0); for (float k = 0.0; k < 3.0; k += cut(uv.x)) c += 1.0;",
            "called in the step of a loop, cannot be",
        ),
    ];
    for (body, said) in cases {
        let program = built("t.frag", &format!("{head}void main() {{ {body} }}\n")).unwrap();
        let error = program.check_fed().unwrap_err().to_string();
        assert!(error.contains(said), "{error}");
    }
}

#[test]
fn a_constructor_with_arguments_left_over_or_missing() {
    // The front end reads on; the module would drop the fourth number.
    let head = "#version 330\nin vec4 v;\nvoid main() { gl_Position = ";
    for (value, said) in [
        ("vec4(vec3(v.x, v.y, v.z, 1.0), 1.0)", "`vec3` takes 3 components, and 4 are given"),
        ("vec4(v.xyz)", "`vec4` takes 4 components, and only 3 are given"),
    ] {
        let text = format!("{head}{value}; }}\n");
        let shader = Shader::parse(&SourceFile::new("t.vert", text.as_str()), Stage::Vertex).shader;
        let error = Program::build(&shader, &Target::Stage).unwrap_err();
        assert!(error.to_string().contains(said), "{error}");
    }
}
