//! What cannot be read or run is told with its place and what to do; nothing panics.

use super::{folder, scene};
use crate::binary::run_in;

#[track_caller]
fn says(name: &str, bytes: &[u8], args: &str, wanted: &[&str]) {
    let folder = folder(&[(name, bytes)]);
    for command in [format!("translate {name} --to wgsl {args}"), format!("fuzz {name} --lane embedded --samples 64")] {
        let ran = run_in(folder.path(), &command);
        assert!([1, 2].contains(&ran.code), "{command}: {ran:?}");
        assert!(!ran.err.contains("panicked at"), "{command}: {}", ran.err);
        let said = format!("{}{}", ran.out, ran.err);
        for part in wanted.iter().filter(|_| args.is_empty() || command.starts_with("translate")) {
            assert!(said.contains(part), "{command}: `{part}` in\n{said}");
        }
    }
}

#[test]
fn which_entry_point_is_meant_is_asked() {
    let ran = scene("translate scene.wgsl --to glsl").expect(1);
    assert!(ran.err.contains("`vs_main` (vertex), `fs_main` (fragment)"), "{}", ran.err);
    assert!(ran.err.contains("--entry vs_main"), "{}", ran.err);
    let ran = scene("translate scene.wgsl --to glsl --entry fs_mian").expect(1);
    assert!(ran.err.contains("did you mean `fs_main`?"), "{}", ran.err);
    let ran = scene("translate scene.wgsl --to glsl --stage vertex --entry fs_main").expect(1);
    assert!(ran.err.contains("an entry point of the fragment stage, not of the vertex"), "{}", ran.err);
    let ran = scene("translate scene.wgsl --to glsl --stage vertex").expect(1);
    assert!(ran.err.contains("scene.wgsl:6:10") && ran.err.contains("without a value"), "{}", ran.err);
    let ran = scene("translate scene.wgsl --to glsl --stage vertex -D cuont=3").expect(1);
    assert!(ran.err.contains("did you mean `count`?"), "{}", ran.err);
    let ran = scene("translate scene.wgsl --to glsl --stage vertex -D count=wide").expect(1);
    assert!(ran.err.contains("`count` cannot be `wide`"), "{}", ran.err);
}

#[test]
fn a_text_without_entry_point_says_what_it_has() {
    let text = b"fn f(x: f32) -> f32 { return x; }\nfn g(x: f32) -> f32 { return x; }\n";
    let folder = folder(&[("f.wgsl", text)]);
    let ran = run_in(folder.path(), "translate f.wgsl --to glsl").expect(1);
    assert!(ran.err.contains("there is no entry point") && ran.err.contains("f, g"), "{}", ran.err);
}

#[test]
fn another_language_than_the_ending_says_is_recognised() {
    says("f.wgsl", b"#version 330\nvoid main() {}\n", "", &["f.wgsl:1:1", "looks like GLSL"]);
    says("f.wgsl", b"float f(float x) { return x; }\n", "", &["f.wgsl:1:1"]);
    says("f.wgsl", b"cbuffer C { float4 a; };\n", "", &["f.wgsl:1:1", "error[E077]", "looks like HLSL"]);
    says(
        "f.frag",
        b"cbuffer C { float4 a; };\n",
        "",
        &["f.frag:1:1", "error[E077]", "looks like HLSL, and is read as GLSL"],
    );
}

#[test]
fn rubbish_is_an_error() {
    says("f.wgsl", b"", "", &["is empty"]);
    says("f.wgsl", b"// nothing\n", "", &["no declaration"]);
    says("f.wgsl", &[0, 159, 146, 150, 255, 1, 2, 3], "", &["f.wgsl"]);
    says("f.wgsl", b"fn f() -> f32 { return f(); }\n", "", &["f.wgsl:1"]);
    says("f.wgsl", b"fn f(x: f32) -> f32 { return x + true; }\n", "", &["f.wgsl:1:30", "bool"]);
    // A name that nothing declares: `fuzz` takes it for an input, and a translation has none.
    let folder = folder(&[("f.wgsl", b"fn f(x: f32) -> f32 { return x + y; }\n")]);
    let ran = run_in(folder.path(), "translate f.wgsl --to wgsl").expect(1);
    let said = format!("{}{}", ran.out, ran.err);
    assert!(said.contains("f.wgsl:1:34") && said.contains("`y`"), "{said}");
}

#[test]
fn what_is_nested_deeply_is_refused_and_not_run_into() {
    let deep = |open: &str, close: &str| {
        let text = format!("fn f(x: f32) -> f32 {{ return {}x{}; }}\n", open.repeat(100_000), close.repeat(100_000));
        says("f.wgsl", text.as_bytes(), "", &["f.wgsl:1"]);
    };
    deep("(", ")");
    deep("-", "");
    deep("vec2f(", ", 1.0).x");
    let chain = format!(
        "fn f(x: f32) -> f32 {{ if x > 0.0 {{ return 1.0; }} {} return x; }}\n",
        "else if x < 1.0 {}".repeat(50_000)
    );
    says("f.wgsl", chain.as_bytes(), "", &["f.wgsl:1"]);
}

#[test]
fn spirv_that_is_none_is_told() {
    says("f.spv", b"", "", &["is empty"]);
    says("f.spv", b"abc", "", &["no whole words"]);
    says("f.spv", &[7, 35, 2, 3, 0, 0, 1, 0], "", &["other byte order"]);
    says("f.spv", &[3, 2, 35, 7, 0, 0, 1, 0], "", &["cut short"]);
    if std::process::Command::new("spirv-as").arg("--version").output().is_err() {
        test_record::not_run("spirv-as is not installed");
        return;
    }
    says("f.spvasm", b"OpCapability Shader\nOpMemoryMode Logical\n", "", &["f.spvasm:2", "assembler"]);
}
