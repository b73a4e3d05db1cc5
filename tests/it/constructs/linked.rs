//! Several texts of one stage, and locations that several variables share.

use base::text::SourceFile;
use program::lower::Target;
use program::{Program, ProgramError};
use syntax::{Stage, link};

use super::{built, expect, outputs};

fn files(texts: &[&str]) -> Vec<SourceFile> {
    texts.iter().enumerate().map(|(k, t)| SourceFile::new(format!("{k}.vert"), *t)).collect()
}

fn linked(texts: &[&str]) -> Result<Program, ProgramError> {
    Program::from_sources(&files(texts), Stage::Vertex, &[], |_| Ok(Target::Stage))
}

#[track_caller]
fn refused(texts: &[&str], said: &str, at: &str) {
    let found = match linked(texts) {
        Err(ProgramError::Source(found)) => found,
        other => panic!("not refused: {:?}", other.map(|p| p.file.text().to_owned())),
    };
    assert!(found[0].message.contains(said), "{}", &*found[0].message);
    let found = found[0].file.locate(found[0].span.start);
    assert!(found.starts_with(at), "{found}");
}

const MAIN: &str = "#version 330
#define SCALE 2.0
struct Light { vec3 at; float gain; };
uniform Light light; uniform float a, b; in vec3 p;
vec3 lit(vec3 p); float sum(float x); float count = 1.0;
void main() { count += SCALE; gl_Position = vec4(lit(p) * SCALE, sum(a)); }
";

const LIBRARY: &str = "#version 330
#define SCALE 10.0
struct Light { vec3 at; float gain; };
uniform Light light; uniform float b, c; float count = 1.0;
float sum(float x);
vec3 lit(vec3 p) { count += SCALE; return p * light.gain + light.at; }
float sum(float x) { return x + b + c + count; }
";

#[test]
fn what_one_text_declares_another_defines() {
    // `count` is one variable: 1, and 2 of the first text, and 10 of the second one.
    let expected = [1.0, 2.0, 3.0].map(|p| (p * 3.0 + 10.0 * p) * 2.0);
    // light.at, light.gain, a, b, c
    let uniforms = [10.0, 20.0, 30.0, 3.0, 0.5, 0.25, 0.125];
    for texts in [[MAIN, LIBRARY], [MAIN, LIBRARY.trim_start_matches("#version 330")]] {
        let program = linked(&texts).unwrap_or_else(|e| panic!("{e}"));
        let names: Vec<&str> = program.uniforms.iter().map(|u| u.field.name.as_str()).collect();
        assert_eq!(names, ["light.at", "light.gain", "a", "b", "c"]);
        for found in outputs(&program, &[1.0, 2.0, 3.0], &uniforms) {
            assert_eq!(found, [&expected[..], &[13.875]].concat());
        }
    }
}

#[test]
fn macros_end_with_their_text_and_places_lead_back() {
    let joined = link::link(&files(&[MAIN, LIBRARY]), Stage::Vertex, &[]).unwrap();
    let place = joined.text().find("return x + b").unwrap();
    assert_eq!(joined.locate(place), "1.vert:7:22");
}

#[test]
fn what_does_not_go_together_is_reported_at_its_place() {
    refused(
        &[MAIN, &LIBRARY.replace("float b, c", "vec2 b; uniform float c").replace("x + b", "x + b.x")],
        "`b` is uniform vec2 here",
        "1.vert:4:",
    );
    refused(
        &[MAIN, &LIBRARY.replace("vec3 at; float gain", "float gain; vec3 at")],
        "`Light` is another structure",
        "1.vert:3:",
    );
    refused(&[MAIN, &LIBRARY.replace("count = 1.0", "count = 2.0")], "another initial value", "1.vert:4:");
    // The same word with another value.
    let with = |n: &str| (MAIN.replace("count = 1.0", "count = SCALE"), LIBRARY.replace("count = 1.0", n));
    let (main, library) = with("count = SCALE");
    refused(&[&main, &library], "another initial value", "1.vert:4:");
    refused(
        &[MAIN, &LIBRARY.replace("float sum(float x) {", "float sum(int x) { return 0.0; } float sum(float x) {")],
        "another text has a `sum`",
        "0.vert:6:",
    );
    refused(
        &[MAIN, &LIBRARY.replace("#version 330", "#version 300 es\nprecision highp float;")],
        "cannot be linked",
        "1.vert:1:",
    );
    refused(
        &[MAIN, "#version 330\nfloat sum(float x) { return x; }"],
        "`lit`, which is declared and never defined,",
        "0.vert:6:",
    );
}

#[test]
fn variables_share_a_location() {
    let text = "#version 440
      layout(location = 1) in vec4 p; layout(location = 3) out vec2 a; layout(location = 3, component = 2) out float b;
      layout(location = 4, component = 1) out float c[2];
      void main() { a = p.xy; b = p.z; c = float[2](p.w, 7.0); gl_Position = p; }";
    let program = built("t.vert", text).unwrap();
    let function = &program.module.entry_points[0].function;
    let naga::TypeInner::Struct { members, .. } = &program.module.types[function.result.as_ref().unwrap().ty].inner
    else {
        panic!()
    };
    // Locations 3, 4 and 5, of three, two and two numbers.
    let found: Vec<String> = members[1..].iter().map(|m| format!("{:?}", program.module.types[m.ty].inner)).collect();
    assert!(found[0].contains("Tri") && found[1].contains("Bi") && found.len() == 3, "{found:?}");
    expect("t.vert", text, &[1.0, 2.0, 3.0, 4.0], &[], &[1.0, 2.0, 3.0, 4.0, 1.0, 2.0, 3.0, 4.0, 7.0]);
    // In the fragment stage the vector is taken apart.
    let text = "#version 440
      layout(location = 0) flat in ivec2 a; layout(location = 0, component = 3) flat in uint b; out vec4 r;
      void main() { r = vec4(a, b, 1.0); }";
    let program = built("t.frag", text).unwrap();
    let argument = &program.module.entry_points[0].function.arguments[0];
    assert!(format!("{:?}", program.module.types[argument.ty].inner).contains("Quad"));
    assert!(program.check_fed().unwrap_err().to_string().contains("`a`, which shares a location,"));
}
