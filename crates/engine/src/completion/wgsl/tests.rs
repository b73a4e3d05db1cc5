//! What stands for declarations that a text in WGSL lacks.

use base::text::SourceFile;
use compose::Options;
use disk::Modules;
use program::{ModuleText, Written};

use super::completed;

/// What each name is taken for; none where the text is wrong whatever stands for them.
fn of(text: &str) -> Option<Vec<String>> {
    let file = SourceFile::new("a.wgsl", text);
    let options = Options { open: true, ..Options::default() };
    let composed = Modules::new(Vec::new()).compose(&file, &options).unwrap();
    let (whole, stands) = completed(&composed)?;
    ModuleText::read(&whole, Written::Wgsl).unwrap();
    assert!(whole.text().starts_with(composed.file.text()), "{}", whole.text());
    Some(stands.iter().map(|stand| format!("{} {}", stand.name, stand.what().replace('`', ""))).collect())
}

#[test]
fn a_name_is_of_the_type_that_its_uses_ask_for() {
    for (text, expected) in [
        (
            "fn f(n: vec3f) -> vec3f { let d = max(dot(n, sun.direction), 0.0); return sun.color * d + ambient; }",
            &["sun a structure", "sun_type a structure", "ambient vec3f"][..],
        ),
        (
            "fn f(i: u32) -> f32 { if i >= count { return 0.0; } return hash1(i) * f32(seed & 15u); }",
            &["count u32", "seed u32", "hash1 a function that gives f32"],
        ),
        // A texture and its sampler, by the function that takes them.
        (
            "@fragment fn main(@location(0) uv: vec2f) -> @location(0) vec4f {\n\
             return textureSample(albedo, albedo_sampler, uv); }",
            &["albedo texture_2d<f32>", "albedo_sampler sampler"],
        ),
        // What has to be known before anything runs is a constant, and what is written a variable.
        ("struct P { x: REAL, n: COUNT } fn f(p: P) -> f32 { return f32(p.x) * 2.0; }", &["REAL f32", "COUNT f32"]),
        (
            "struct P { x: REAL } fn f(p: P) -> vec3f { let y = p.x * 2.0; return y + vec3f(1.0, 0.5, y.z); }",
            &["REAL vec3f"],
        ),
        ("const N = SIZE * 2u; fn f(i: u32) -> u32 { return i * N; }", &["SIZE u32"]),
        ("fn f(x: f32) -> f32 { state = x * 2.0; return state; }", &["state f32"]),
        // Numbers have no array of their own in a uniform.
        ("fn f(i: u32) -> f32 { return weights[i] + 1.0; }", &["weights vec4f"]),
        ("fn f(i: u32) -> vec3f { return points[i] + vec3f(1.0); }", &["points vec3f[16]"]),
        // A pointer to a variable.
        ("fn f(x: f32) -> f32 { var s = x; advance(&s, 0.5); return s; }", &["advance a function"]),
        // The first guess is wrong, and naga says where.
        (
            "fn f(p: vec3f) -> vec4f { let q = vec4f(p, 1.0); let w = model * q; return projection * w; }",
            &["model vec4f", "projection vec4f"],
        ),
        // What goes from stage to stage has places.
        (
            "@vertex fn main(v: Vertex) -> Varying { var out: Varying; out.position = vec4f(v.place, 1.0);\n\
             out.id = v.instance_index; return out; }",
            &["Vertex a structure", "Varying a structure"],
        ),
        (
            "#import engine::{view, noise}\nfn f(x: vec2f) -> f32 { return noise::fbm(x * view::scale); }",
            &["scale vec2f", "fbm a function that gives f32"],
        ),
    ] {
        let expected: Vec<String> = expected.iter().map(|&own| own.to_owned()).collect();
        assert_eq!(of(text), Some(expected), "{text}");
    }
}

#[test]
fn what_is_wrong_otherwise_is_left_alone() {
    for text in [
        // Whatever `x` is.
        "fn f(x: f32) -> f32 { return vec3f(x, missing, 1.0); }",
        "fn f(x: f32) -> f32 { let y = missing; return y + true; }",
        // Nothing is lacking.
        "fn f(x: f32) -> f32 { return x; }",
    ] {
        assert_eq!(of(text), None, "{text}");
    }
}
