//! What is read, run and translated.

use super::{SCENE, folder, scene};
use crate::binary::run_in;

#[test]
fn every_language_takes_a_stage_of_wgsl() {
    for (language, has) in [
        ("glsl", "uniform Uniforms_block"),
        ("glsl450", "in vec3"),
        ("wgsl", "@vertex"),
        ("msl", "vertex "),
        ("hlsl", "SV_Position"),
    ] {
        let args = format!("translate scene.wgsl --to {language} --entry vs_main -D count=3");
        let ran = scene(&args).expect(0);
        assert!(ran.out.contains(has), "{language}: {}", ran.out);
    }
    let ran = scene("translate scene.wgsl --to wgsl --entry fs_main").expect(0);
    assert!(ran.out.contains("discard") && !ran.out.contains("vs_main"), "{}", ran.out);
}

#[test]
fn every_function_and_entry_point_is_fuzzed() {
    let ran = scene("fuzz scene.wgsl -D count=3 --samples 2048 --lane embedded --format json").expect(0).json();
    let functions = ran["files"][0]["functions"].as_array().unwrap();
    let names: Vec<&str> = functions.iter().map(|f| f["function"].as_str().unwrap()).collect();
    assert_eq!(names, ["lift", "hit", "vs_main", "fs_main", "fs_slope"]);
    for function in functions {
        assert!(function["not_run"].is_null(), "{function:#}");
    }
}

#[test]
fn a_finding_stands_at_the_authors_line_and_its_twin_is_silent() {
    let text = |guard: &str| {
        format!("// shadercheck: x in [0, 1]\nfn f(x: f32) -> f32 {{\n  let y = {guard};\n  return 1.0 / y;\n}}\n")
    };
    let run = |guard: &str| {
        let folder = folder(&[("f.wgsl", text(guard).as_bytes())]);
        run_in(folder.path(), "fuzz f.wgsl --samples 4096 --lane embedded")
    };
    let wrong = run("x * x").expect(1);
    assert!(wrong.out.contains("f.wgsl:4:10: `1.0 / y`"), "{}", wrong.out);
    run("x * x + 1.0").expect(0);
}

#[test]
fn whole_numbers_are_those_of_wgsl() {
    // The language says what these give; GLSL does not.
    let text = "fn f(a: i32, b: i32) -> i32 { return (a / b) ^ (a % b) ^ (a << u32(b)); }\n";
    let folder = folder(&[("f.wgsl", text.as_bytes())]);
    let domain = "--domain a=[-8,8] --domain b=[-2,2]";
    let args = format!("fuzz f.wgsl --samples 4096 --lane embedded {domain}");
    run_in(folder.path(), &args).expect(0);
}

#[test]
fn spirv_is_run_as_its_source_is() {
    let folder = folder(&[("scene.wgsl", SCENE.as_bytes())]);
    let at = folder.path();
    run_in(at, "translate scene.wgsl --to spirv --entry vs_main -D count=3 -o scene.spv").expect(0);
    let ran = run_in(at, "fuzz scene.spv --samples 1024 --lane embedded").expect(0);
    assert!(ran.out.contains("vs_main"), "{}", ran.out);
    run_in(at, "translate scene.spv --to glsl450").expect(0);
}

#[test]
fn a_constant_keeps_the_digits_of_the_author() {
    // In binary32 the product is another number than what is meant, which the formula finds.
    let text = "const turn = 2.0 * 3.14159265358979;\nfn f(s: f32) -> f32 { return sin(turn * s); }\n";
    let suite = "suite = \"f\"\nshader = \"f.wgsl\"\nstage = \"function\"\nentry = \"f\"\nsamples = 2048\n\
         reference = { file = \"f.glsl\", function = \"f\" }\n[[inputs]]\nnames = [\"s\"]\ngenerator = \"interval\"\n\
         range = [0.0, 1.0]\n[floors]\njudged = 100\nundetermined = 0.9\nreason = \"sin\"\n";
    let glsl = "float f(float s) { return sin(6.28318530717958 * s); }\n";
    let files: &[(&str, &[u8])] =
        &[("f.wgsl", text.as_bytes()), ("f.glsl", glsl.as_bytes()), ("f.suite.toml", suite.as_bytes())];
    run_in(folder(files).path(), "check . --lane embedded").expect(0);
    let wrong = text.replace("3.14159265358979", "3.14158265358979");
    let files: &[(&str, &[u8])] = &[("f.wgsl", wrong.as_bytes()), files[1], files[2]];
    run_in(folder(files).path(), "check . --lane embedded").expect(1);
}

#[test]
fn a_buffer_in_the_group_of_textures_is_none_of_them() {
    let text = "@group(2) @binding(0) var<uniform> tint: vec4f;\n@group(0) @binding(0) var t: texture_2d<f32>;\n\
                @group(0) @binding(1) var s: sampler;\n@fragment fn main(@location(0) uv: vec2f) -> @location(0) vec4f {\n\
                return tint * textureSample(t, s, uv);\n}\n";
    let folder = folder(&[("f.wgsl", text.as_bytes())]);
    let ran = run_in(folder.path(), "fuzz f.wgsl --samples 256 --lane embedded").expect(0);
    assert!(ran.out.contains("1 function run, 0 not run"), "{}", ran.out);
}
