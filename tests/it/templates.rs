//! WGSL in templates of TypeScript and JavaScript, on the command line.

use std::fs;

use tempfile::TempDir;

use crate::binary::{Ran, run_in};

fn project(files: &[(&str, &str)]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
    folder
}

fn fuzz(files: &[(&str, &str)], arguments: &str) -> Ran {
    let folder = project(files);
    run_in(folder.path(), &format!("fuzz --lane embedded --samples 4096 {arguments}"))
}

/// A pass with its constants in another file, and a snippet in a third.
const PASS: &str = "import { LIGHT } from '../light.ts';\nimport { CONFIG } from '../config.js';\n\
    const b = { a: 0, out: 3 };\n\
    export const CODE = () => /* wgsl */ `\n\
    ${LIGHT('sun')}\n\
    @group(0) @binding(${b.a}) var<storage, read> a: array<f32>;\n\
    @group(0) @binding(${b.out}) var<storage, read_write> o: array<f32>;\n\
    @compute @workgroup_size(${CONFIG.size}, 1, 1)\n\
    fn main(@builtin(global_invocation_id) id: vec3<u32>) {\n\
    if (id.x >= arrayLength(&o)) { return; }\n\
    o[id.x] = shade(a[id.x]);\n\
    }\n\
    `;\n";
const LIGHT: &str = "export const LIGHT = (name: string) => `\nfn shade(x: f32) -> f32 {\n  let ${name} = vec2f(x, 0.0);\n  \
     return normalize(${name}).x;\n}\n`;\n";
const CONFIG: &str = "export const CONFIG = { size: 1 << 5 };\n";

#[test]
fn a_module_of_templates_is_run_and_places_lead_to_their_files() {
    let files = [("src/passes/pass.ts", PASS), ("src/light.ts", LIGHT), ("src/config.ts", CONFIG)];
    let ran = fuzz(&files, "src/passes/pass.ts");
    assert!(ran.err.contains("filled with is read from src/config.ts, src/light.ts"), "{ran:?}");
    assert!(ran.out.contains("src/light.ts:4:10: `normalize`"), "{ran:?}");
    assert!(ran.out.contains("2 functions run, 0 not run"), "{ran:?}");
    assert!(!ran.err.contains("is taken for") && !ran.err.contains("are taken for"), "{ran:?}");
    // The repaired twin, which the command of a finding names by its line.
    let right = LIGHT.replace("normalize(${name})", "${name}");
    let files = [files[0], ("src/light.ts", &right), files[2]];
    let ran = fuzz(&files, "src/passes/pass.ts:5").expect(0);
    assert!(ran.out.contains("0 findings, 0 warnings"), "{ran:?}");
}

/// A pass of which a function gets the parts.
const OPEN: &str = "export const code = (b, w, snippet, limit) => /* wgsl */ `\n\
    ${snippet}\n\
    @group(0) @binding(${b.a}) var<storage, read> a: array<f32>;\n\
    @group(0) @binding(${b.o}) var<storage, read_write> o: array<f32>;\n\
    @compute @workgroup_size(${w})\n\
    fn main(@builtin(global_invocation_id) id: vec3<u32>) {\n\
    if (id.x >= arrayLength(&o)) { return; }\n\
    o[id.x] = shade(a[id.x]);\n\
    }\n\
    fn shade(x: f32) -> f32 { return tone(1.0 / (x - ${limit})); }\n\
    `;\n";

#[test]
fn what_is_not_known_is_an_input_and_told() {
    let ran = fuzz(&[("pass.ts", OPEN)], "pass.ts").expect(0);
    for told in [
        "nothing stands for what is filled in and is not known: `${snippet}` at pass.ts:2:1",
        "`${b.a}` at pass.ts:3:20 is taken for 0, a binding that nothing else has",
        "`${b.o}` at pass.ts:4:20 is taken for 1, a binding that nothing else has",
        "`${w}` at pass.ts:5:26 is taken for 64, a size of a workgroup",
        "taken for inputs of any value: `${limit}` at pass.ts:10:50 as `limit`",
        "`tone` as a function that gives `f32`",
    ] {
        assert!(ran.err.contains(told), "{told}: {ran:?}");
    }
    // What rests on an input that is made up is no more than a warning.
    assert!(ran.out.contains("pass.ts:10:39: `1.0 / (x -`: `return` has no value"), "{ran:?}");
    assert!(ran.out.contains("2 functions run, 0 not run, 0 findings, 2 warnings"), "{ran:?}");
    // The repaired twin.
    let right = OPEN.replace("1.0 / (x - ${limit})", "x - ${limit}").replace("tone(", "(");
    let ran = fuzz(&[("pass.ts", &right)], "pass.ts").expect(0);
    assert!(ran.out.contains("0 findings, 0 warnings"), "{ran:?}");
}

#[test]
fn a_slip_of_the_text_stays_an_error() {
    let text = OPEN.replace("tone(", "normalise(").replace("1.0 / (x - ${limit})", "vec2f(x, ${limit})");
    let ran = fuzz(&[("pass.ts", &text.replace("; }\n`", ".x; }\n`"))], "pass.ts").expect(1);
    assert!(ran.out.contains("error[E021]: `normalise` is not declared"), "{ran:?}");
    assert!(!ran.out.contains("`limit` is not"), "{ran:?}");
    // A name that is made up is none, however near it is to another.
    let near = OPEN.replace("limit", "arrayLengths").replace("tone(", "(");
    let ran = fuzz(&[("pass.ts", &near)], "pass.ts").expect(0);
    assert!(!ran.out.contains("is not declared"), "{ran:?}");
}

#[test]
fn an_error_that_may_follow_from_what_is_not_known_is_not_the_authors() {
    let text = OPEN.replace("var<storage, read> a: array<f32>", "var<storage, read> a: array<${w.element}>");
    let text = text.replace("shade(a[id.x])", "shade(a[id.x].x)");
    let ran = fuzz(&[("pass.ts", &text)], "pass.ts");
    assert!(ran.out.contains("not run: `${snippet}` at pass.ts:2:1 is not known:"), "{ran:?}");
    assert!(!ran.out.contains("error["), "{ran:?}");
    // Where all is known, it is.
    let known = "const b = { a: 0, o: 1 };\nconst w = 64, snippet = '', limit = 1;\n".to_owned() + OPEN;
    let known = known
        .replace("(b, w, snippet, limit)", "()")
        .replace("tone(", "(")
        .replace("shade(a[id.x])", "shade(a[id.x].x)");
    let ran = fuzz(&[("pass.ts", &known)], "pass.ts").expect(1);
    assert!(ran.out.contains("1 file does not compile") && ran.out.contains("pass.ts:10:"), "{ran:?}");
}

#[test]
fn what_a_statement_that_is_left_out_may_change_is_a_warning() {
    let text = "export const code = (more) => `\nfn f(normal: vec3f, toEye: vec3f) -> f32 {\n  ${more}\n  \
                return pow(dot(normal, toEye), 5.0);\n}\n@compute @workgroup_size(1) fn main() { }\n`;\n";
    let ran = fuzz(&[("a.ts", text)], "a.ts").expect(0);
    assert!(ran.err.contains("`${more}` at a.ts:3:3") && ran.out.contains("warning: f: `return` has no"), "{ran:?}");
    let ran = fuzz(&[("a.ts", &text.replace("  ${more}\n", ""))], "a.ts").expect(1);
    assert!(ran.out.contains("1 finding"), "{ran:?}");
}

#[test]
fn parts_without_a_stage_are_run() {
    let text =
        "export const PART = (n: number) => /* wgsl */ `\nfn f(x: f32) -> f32 { return 1.0 / (x - f32(${n})); }\n`;\n";
    let ran = fuzz(&[("part.ts", text)], "part.ts").expect(0);
    assert!(ran.out.contains("1 function run") && ran.out.contains("part.ts:2:30"), "{ran:?}");
}

#[test]
fn other_commands_take_templates_as_well() {
    let folder = project(&[("src/passes/pass.ts", PASS), ("src/light.ts", LIGHT), ("src/config.ts", CONFIG)]);
    let ran = run_in(folder.path(), "translate src/passes/pass.ts:9 --to glsl450").expect(0);
    assert!(ran.out.contains("local_size_x = 32"), "{ran:?}");
    let both = "compare src/passes/pass.ts src/passes/pass.ts:5 --function shade --lane embedded --samples 64";
    let ran = run_in(folder.path(), both).expect(0);
    assert!(ran.out.contains("shade"), "{ran:?}");
    let text = "const k = 2;\nexport const PART = /* wgsl */ `\n\
                fn f(x: f32) -> f32 { return x * ${k}.0; }\nfn g(x: f32) -> f32 { return sqrt(x + 1.0) - sqrt(x); }\n`;\n";
    fs::write(folder.path().join("part.ts"), text).unwrap();
    let ran = run_in(folder.path(), "improve part.ts --lane embedded --samples 512 --domain x=[0,1000000]");
    assert!(ran.out.contains("+fn g(x: f32) -> f32 { return 1.0 / (sqrt(x + 1.0) + sqrt(x)); }"), "{ran:?}");
    // The linter reads no text with holes.
    run_in(folder.path(), "lint .").expect(0);
}
