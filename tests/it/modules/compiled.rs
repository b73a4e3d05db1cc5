//! HLSL and Slang, through the compilers that are found.

use std::fs;
use std::path::Path;
use std::process::Command;

use test_record::not_run;

use super::folder;
use crate::binary::{root, run, run_in};

/// What is found here of the compilers: the option that names each, with the languages that it takes.
fn compilers() -> Vec<(&'static str, &'static [&'static str])> {
    let starts = |program: &str, option: &str| Command::new(program).arg(option).output().is_ok();
    let mut found: Vec<(&str, &[&str])> = Vec::new();
    match starts("slangc", "-v") {
        true => found.push(("slangc", &["hlsl", "slang"])),
        false => not_run("slangc is not on PATH: Slang was not read, nor HLSL by it"),
    }
    match starts("glslangValidator", "--version") {
        true => found.push(("glslangValidator", &["hlsl"])),
        false => not_run("glslangValidator is not on PATH: no HLSL was read by it"),
    }
    found
}

/// Runs a test for each compiler and language.
fn each(test: impl Fn(&str, &str)) {
    for (compiler, languages) in compilers() {
        languages.iter().for_each(|language| test(compiler, language));
    }
}

/// Runs the binary with a compiler in a folder.
fn with(compiler: &str, at: &Path, args: &str) -> crate::binary::Ran {
    run_in(at, &format!("{args} --compiler {compiler}"))
}

#[test]
fn every_copy_agrees_by_the_compiler_that_is_found() {
    let copies = || super::suites::COPIES.iter();
    let found = compilers();
    for language in ["hlsl", "slang"] {
        if !found.iter().any(|(_, languages)| languages.contains(&language)) {
            continue;
        }
        let ran = run(&format!("check fixtures/{language} --quick --lane embedded --format json")).expect(0).json();
        let suites = ran["suites"].as_array().unwrap();
        assert_eq!(suites.len(), copies().count());
        let wanted = copies().map(|name| format!("{name}_{language}"));
        assert!(suites.iter().zip(wanted).all(|(suite, wanted)| suite["suite"] == wanted));
    }
}

#[test]
fn every_copy_is_equal_to_that_in_wgsl() {
    each(|compiler, language| {
        for name in super::suites::COPIES {
            let texts = format!("fixtures/languages/{name}.wgsl fixtures/{language}/{name}.{language}");
            let args = format!("compare {texts} --lane embedded --samples 256 --format json");
            let report = with(compiler, root(), &args).expect(0).json();
            let pairs = report["pairs"].as_array().unwrap();
            assert!(!pairs.is_empty(), "{compiler}: {name}: {report}");
            assert!(pairs.iter().all(|p| p["equal"].as_u64().unwrap() > 128), "{compiler}: {name}: {report}");
        }
    });
}

#[test]
fn a_loop_that_slangc_writes_ends() {
    if !compilers().iter().any(|(name, _)| *name == "slangc") {
        return;
    }
    let text = "float sum(int n)\n{\n    float s = 0.0;\n    for (int i = 0; i < n; ++i)\n        s += 0.5;\n    return s;\n}\n";
    let ran =
        with("slangc", folder(&[("f.slang", text.as_bytes())]).path(), "fuzz f.slang --lane embedded --samples 512");
    let ran = ran.expect(0);
    assert!(ran.out.contains("384 agreed"), "{ran:?}");
}

#[test]
fn a_finding_stands_at_the_authors_line_and_its_twin_is_silent() {
    each(|compiler, language| {
        let text = |divisor: &str| {
            format!(
                "float twice(float x) {{ return 2 * x; }}\n\nfloat f(float x)\n{{\n    float y = {divisor};\n    return 1.0 / y;\n}}\n"
            )
        };
        let name = format!("f.{language}");
        let at = |divisor: &str| folder(&[(name.as_str(), text(divisor).as_bytes())]);
        let args = format!("fuzz {name} --samples 4096 --lane embedded --domain x=[0,1]");
        let ran = with(compiler, at("x * x").path(), &args).expect(1);
        // The place of slangc is that of the statement before at times.
        let places = [6, 5].map(|line| format!("f.{language}:{line}:5: `"));
        assert!(
            places.iter().take(if compiler == "slangc" { 2 } else { 1 }).any(|at| ran.out.contains(at)),
            "{compiler}: {}",
            ran.out
        );
        let reads = if compiler == "slangc" { "slangc" } else { "glslang" };
        assert!(ran.err.contains(&format!("note: {name} is read by {reads}")), "{}", ran.err);
        assert!(ran.out.contains(&format!(" --compiler {compiler} --lane")), "{}", ran.out);
        with(compiler, at("x * x + 1.0").path(), &args).expect(0);
    });
}

#[test]
fn every_function_is_run_alone_and_what_cannot_be_is_told() {
    let text = "struct P { float3 a; float b; };\nfloat sq(float x) { return x * x; }\nfloat sq(float2 x) { return dot(x, x); }\n\
                namespace N { float half_of(float x) { return x * 0.5; } }\n\
                P move(P p, inout float3 n, out float q) { n = n * 0.5; q = p.b; p.b = 1.0; return p; }\n\
                Texture2D tex; SamplerState smp;\nfloat4 look(Texture2D t, float2 uv) { return t.SampleLevel(smp, uv, 0); }\n\
                float4 main(float2 uv : UV) : SV_Target { return tex.SampleLevel(smp, uv, 0); }\n";
    each(|compiler, language| {
        // glslang keeps the function with a texture, and naga's reader refuses the whole module.
        if compiler != "slangc" {
            return;
        }
        let name = format!("f.{language}");
        let folder = folder(&[(name.as_str(), text.as_bytes())]);
        let args = format!("fuzz {name} --samples 512 --lane embedded --format json");
        let ran = with(compiler, folder.path(), &args).json();
        let functions = ran["files"][0]["functions"].as_array().unwrap();
        let names: Vec<&str> = functions.iter().map(|f| f["function"].as_str().unwrap()).collect();
        assert_eq!(names, ["sq(float)", "sq(float2)", "N::half_of", "move", "look", "main"], "{compiler}: {ran:#}");
        for function in functions {
            let refused = function["not_run"].as_str();
            assert_eq!(refused.is_some(), function["function"] == "look", "{compiler}: {function:#}");
        }
    });
}

#[test]
fn rows_of_a_matrix_are_those_of_its_declaration() {
    let text = |order: &str, first: &str| {
        format!(
            "{first}\ncbuffer Scene : register(b0, space1)\n{{\n    {order} float4x4 m;\n}};\n\
                 float4 main(float4 p : POSITION) : SV_Position\n{{\n    return mul(m, p) + 0.0 * m[0];\n}}\n"
        )
    };
    // The same numbers in memory: by columns the first row is every fourth of them.
    let by_columns = "#version 330\nin vec4 p;\nuniform mat4 m;\nvoid main() { gl_Position = m * p; }\n";
    let by_rows = by_columns.replace("m * p", "p * m");
    let cases = [("", "", true), ("column_major", "", true), ("row_major", "", false)];
    each(|compiler, language| {
        for (order, first, columns) in cases {
            let (name, text) = (format!("b.{language}"), text(order, first));
            let files: &[(&str, &[u8])] =
                &[("columns.vert", by_columns.as_bytes()), ("rows.vert", by_rows.as_bytes()), (&name, text.as_bytes())];
            let folder = folder(files);
            for (other, same) in [("columns.vert", columns), ("rows.vert", !columns)] {
                let args = format!("translate {name} --to glsl450 --stage vertex");
                let _ = with(compiler, folder.path(), &args).expect(0);
                let suite = format!(
                    "suite = \"m\"\nshader = \"{name}\"\nstage = \"vertex\"\nreference = {{ file = \"{other}\" }}\nsamples = 256\n\
                     [[inputs]]\nnames = [\"p\"]\ngenerator = \"point\"\nrange = [-2.0, 2.0]\n\
                     [[inputs]]\nnames = [\"m\"]\ngenerator = \"affine\"\nrange = [-2.0, 2.0]\n[floors]\njudged = 1\nundetermined = 0.9\nreason = \"small\"\n"
                );
                fs::write(folder.path().join("m.suite.toml"), suite).unwrap();
                let ran = run_in(folder.path(), "check m.suite.toml --quick --lane embedded");
                assert_eq!(ran.code, i32::from(!same), "{compiler} {order} {first} {other}: {}{}", ran.out, ran.err);
            }
        }
    });
}

#[test]
fn a_function_is_equal_in_four_languages_and_planted_differences_are_found() {
    each(|compiler, language| {
        for name in super::suites::COPIES.iter().filter(|name| !["hair", "skinning", "two_bones"].contains(name)) {
            let own = root().join(format!("fixtures/{language}/{name}.{language}"));
            let wgsl = root().join(format!("fixtures/languages/{name}.wgsl"));
            if !fs::read_to_string(&wgsl).unwrap().contains(&format!("fn {name}(")) {
                continue;
            }
            let args =
                format!("compare {} {} --samples 512 --lane embedded --function {name}", wgsl.display(), own.display());
            with(compiler, root(), &args).expect(0);
        }
        let glsl = "vec3 turned(mat3 m, vec3 v) { return m * v; }\nfloat rest(float x, float y) { return mod(x, y); }\n\
                    float angle(float y, float x) { return atan(y, x); }\n";
        let right = "float3 turned(float3x3 m, float3 v) { return mul(m, v); }\n\
                     float rest(float x, float y) { return x - y * floor(x / y); }\n\
                     float angle(float y, float x) { return atan2(y, x); }\n";
        // `fmod` has the sign of its first operand; glslang 12 makes the other remainder of it.
        let rest = if compiler == "slangc" { "fmod(x, y)" } else { "x - y * trunc(x / y)" };
        let wrong = right.replace("mul(m, v)", "mul(v, m)").replace("x - y * floor(x / y)", rest);
        let wrong = wrong.replace("atan2(y, x)", "atan2(x, y)");
        let (same, other) = (format!("same.{language}"), format!("other.{language}"));
        let files: &[(&str, &[u8])] =
            &[("f.glsl", glsl.as_bytes()), (&same, right.as_bytes()), (&other, wrong.as_bytes())];
        let folder = folder(files);
        let rest = "--samples 2048 --lane embedded --domain x=[-8,8] --domain y=[1,4]";
        let ran = with(compiler, folder.path(), &format!("compare f.glsl {same} {rest}"));
        assert_eq!(ran.code, 0, "{compiler} {language}: {}{}", ran.out, ran.err);
        let ran =
            with(compiler, folder.path(), &format!("compare f.glsl {other} {rest} --format json")).expect(1).json();
        for pair in ran["pairs"].as_array().unwrap() {
            assert!(
                pair["unlike"].as_u64() > Some(0) && pair["smallest"]["inputs"][0]["bits"][0].is_string(),
                "{compiler} {language}: {pair:#}"
            );
        }
    });
}

#[test]
fn errors_of_a_compiler_stand_at_the_authors_place() {
    each(|compiler, language| {
        let name = format!("f.{language}");
        let text = b"#include \"common.hlsl\"\nfloat f(float x)\n{\n    return y + part_of(x);\n}\n";
        let common = b"float part_of(float x) { return x; }\n";
        let folder = folder(&[(name.as_str(), text), ("common.hlsl", common)]);
        let ran = with(compiler, folder.path(), &format!("fuzz {name} --lane embedded --samples 64")).expect(1);
        assert!(ran.out.contains(&format!("f.{language}:4:")), "{compiler}: {}", ran.out);
        fs::write(folder.path().join("common.hlsl"), "float part_of(float x) { return z; }\n").unwrap();
        let ran = with(compiler, folder.path(), &format!("fuzz {name} --lane embedded --samples 64")).expect(1);
        assert!(ran.out.contains("common.hlsl:1:"), "{compiler}: {}", ran.out);
        fs::remove_file(folder.path().join("common.hlsl")).unwrap();
        let ran = with(compiler, folder.path(), &format!("fuzz {name} --lane embedded --samples 64")).expect(1);
        assert!(
            ran.out.contains(&format!("f.{language}:1:1")) && ran.out.contains("common.hlsl"),
            "{compiler}: {}",
            ran.out
        );
        let _ = with(compiler, folder.path(), &format!("translate {name} --to wgsl --entry nope")).expect(1);
    });
}

#[test]
fn what_is_missing_or_wrong_is_told_with_what_to_do() {
    let folder =
        folder(&[("f.hlsl", b"float f(float x) { return x; }\n"), ("g.slang", b"float f(float x) { return x; }\n")]);
    let ran = run_in(folder.path(), "fuzz f.hlsl --lane embedded --compiler ./slangc");
    assert!(ran.code == 2 && ran.err.contains("there is no compiler"), "{ran:?}");
    assert_eq!(ran.err.matches("f.hlsl").count(), 1, "{ran:?}");
    let ran = run_in(folder.path(), "fuzz g.slang --lane embedded --compiler glslangValidator");
    assert!(ran.code == 2 && ran.err.contains("no Slang"), "{ran:?}");
    #[cfg(unix)]
    for (script, said) in [
        ("kill -SEGV $$", "signal 11"),
        ("echo nothing to see", "gave no whole module"),
        ("printf '\\003\\002\\043\\007\\0\\0'", "gave no whole module"),
        ("exit 7", "status 7"),
    ] {
        use std::os::unix::fs::PermissionsExt;
        let program = folder.path().join("slangc");
        fs::write(&program, format!("#!/bin/sh\n{script}\n")).unwrap();
        fs::set_permissions(&program, fs::Permissions::from_mode(0o755)).unwrap();
        let ran = run_in(folder.path(), "fuzz f.hlsl --lane embedded --samples 64 --compiler ./slangc");
        assert!([1, 2].contains(&ran.code) && format!("{}{}", ran.out, ran.err).contains(said), "{script}: {ran:?}");
    }
}

#[test]
fn lint_says_that_it_has_no_rules_for_a_file_and_passes_over_it_in_a_folder() {
    let folder =
        folder(&[("f.hlsl", b"float f(float x) { return x; }\n"), ("a.glsl", b"float f(float x) { return x; }\n")]);
    let ran = run_in(folder.path(), "lint f.hlsl");
    assert!(ran.code == 2 && ran.err.contains("there are no rules for HLSL"), "{ran:?}");
    // In a folder, and beside other files, it is passed over, which is said once.
    let folder = tempfile::tempdir().unwrap();
    for name in ["a.hlsl", "b.hlsl", "c.slang"] {
        std::fs::write(folder.path().join(name), "float f(float x) { return x; }\n").unwrap();
    }
    for text in [None, Some("float f(float x) { return x; }\n")] {
        text.iter().for_each(|text| std::fs::write(folder.path().join("d.glsl"), text).unwrap());
        let ran = crate::binary::run_in(folder.path(), "lint .").expect(0);
        assert_eq!(ran.err.matches("there are no rules for HLSL").count(), 1, "{}", ran.err);
    }
    crate::binary::run_in(folder.path(), "lint a.hlsl d.glsl").expect(0);
    let ran = run_in(folder.path(), "lint .").expect(0);
    assert!(!ran.out.contains("f.hlsl") && !ran.err.contains("f.hlsl"), "{ran:?}");
}

#[test]
fn registers_of_two_kinds_may_have_one_number() {
    each(|compiler, language| {
        let name = format!("f.{language}");
        let text = "Texture2D t : register(t1);\nSamplerState s : register(s1);\ncbuffer C : register(b1) { float k; };\n\
                    float4 main(float2 uv : TEXCOORD0) : SV_Target { return t.Sample(s, uv) * sqrt(k); }\n";
        let folder = folder(&[(name.as_str(), text.as_bytes())]);
        let ran = with(compiler, folder.path(), &format!("fuzz {name} --lane embedded --samples 256"));
        assert!(ran.out.contains("1 function run, 0 not run"), "{compiler}: {}{}", ran.out, ran.err);
        assert!(ran.out.contains("sqrt(-"), "{compiler}: {}", ran.out);
    });
}
