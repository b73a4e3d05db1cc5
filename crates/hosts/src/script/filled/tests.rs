//! Texts that templates make.

use super::*;

/// The modules of a file beside others.
fn read_with(text: &str, others: &[(&str, &str)]) -> Vec<Filled> {
    let file = SourceFile::new("src/a.ts", text);
    filled(&file, &[], &mut |from, path| {
        let folder = from.rsplit_once('/').map_or("", |(folder, _)| folder);
        let name = format!("{folder}/{}", path.trim_start_matches("./"));
        others.iter().find(|(other, _)| *other == name).map(|(other, text)| SourceFile::new(*other, *text))
    })
}

fn only(text: &str) -> Filled {
    let mut all = read_with(text, &[]);
    assert_eq!(all.len(), 1, "{all:?}");
    all.remove(0)
}

/// A module around a statement.
fn kernel(before: &str, statement: &str) -> String {
    format!("{before}\nexport const CODE = `\n@compute @workgroup_size(64)\nfn main() {{\n  {statement}\n}}\n`;\n")
}

#[test]
fn values_of_the_file_are_filled_in() {
    for (before, hole, expected) in [
        ("const N = 1 << 5;", "${N}u", "32u"),
        ("const C = { size: { x: 8 }, y: 0x10 };", "${C.size.x * C.y}u", "128u"),
        ("const C = { size: 8 } as const;\nconst c = C;", "${c['size']}u", "8u"),
        ("export const PARTS = [0.5, 1e-3];", "${PARTS[1]} + ${PARTS[0]}", "0.001 + 0.5"),
        ("const f = (x: number, y = 2) => `vec2f(${x}, ${y})`;", "${f(1)}", "vec2f(1, 2)"),
        ("function f({ x, y }: P) { const z = x + y; return `${z}.0`; }", "${f({ x: 1, y: 2 })}", "3.0"),
        ("class A { static N: number = 4; static f(n: number): string { return `${n}u`; } }", "${A.f(A.N)}", "4u"),
        ("enum Mode { Plain, Lit = 4, Both }", "${Mode.Both}", "5"),
        ("const N = 3;\nconst s = N === 3 ? 'yes' : 'no';", "${s}", "yes"),
        ("const A = Object.freeze({ get B() { return `${A.C}u`; }, get C(): number { return 7; } });", "${A.B}", "7u"),
        ("class A { static get B(): number { return 8; } }", "${A.B}", "8"),
        ("const a = f(1, 2), N = 3;", "${N}", "3"),
        ("const a = ['x', 'y'];", "${a.join(' + ')}", "x + y"),
        ("const P = Math.max(2, 3) / Math.PI * Math.PI;", "${P.toFixed(1)}", "3.0"),
        ("const f = (x) => { if (x > 1) { return 'big'; } return 'small'; };", "${f(2)} ${f(1)}", "big small"),
    ] {
        let found = only(&kernel(before, &format!("let x = {hole};")));
        assert!(found.text.text().contains(&format!("let x = {expected};")), "{before}: {}", found.text.text());
        assert!(found.notes.is_empty() && found.open.is_none(), "{before}: {:?}", found.notes);
    }
}

#[test]
fn what_changes_or_is_computed_is_no_value() {
    for before in [
        "let N = 3;\nN = 4;",
        "let N = 'a';\nN += 'b';",
        "const N = count();",
        "const N = new Size(3);",
        "const O = { N: 1, ...other };\nconst N = O.N;",
        "function f(N: number) {}",
        "const N = N;",
        "const N = M;\nconst M = N;",
        "const N = f();\nconst f = () => f();",
    ] {
        let found = only(&kernel(before, "let x = ${N} * 2.0;"));
        assert!(found.text.text().contains("let x = N"), "{before}: {}", found.text.text());
        assert_eq!(found.made_up.len(), 1, "{before}: {:?}", found.made_up);
        assert!(found.open.is_some(), "{before}");
    }
}

#[test]
fn names_are_those_of_the_place() {
    let text = "const n = 1;\nfunction make(n: number) {\n  const m = n + 1;\n  for (const k of [1, 2]) {\n\
                use(`@compute @workgroup_size(1) fn main() { let x = ${n} + ${m} + ${k}; }`);\n  }\n}\nmake(2);\n";
    let found = only(text);
    assert!(found.text.text().contains("let x = n + m + k;"), "{}", found.text.text());
    // The twin, whose value nothing else has.
    let found = only(&text.replace("(n: number)", "()"));
    assert!(found.text.text().contains("let x = 1 + 2 + k;"), "{}", found.text.text());
}

#[test]
fn what_is_not_known_has_what_its_place_asks_for() {
    let text = "export const code = (b, g, w, t, access, more, x, l) => /* wgsl */ `\n${more}\n\
                @group(${g.scene}) @binding(${b.first}) var<storage, ${access}> a: array<${t}>;\n\
                @group(${g.scene}) @binding(${b.second}) var<uniform> b: array<vec4<${t}>, ${l}>;\n\
                @group(0) @binding(0) var<uniform> c: f32; // ${more}\n\
                struct S {\n  x: ${t},\n  ${more}\n}\n\
                @compute @workgroup_size(${w}, ${w}, 1)\nfn main() {\n  ${more}\n  let y = c * ${x}.0 + ${x + 1}f;\n}\n`;\n";
    let found = only(text);
    let written = found.text.text();
    for expected in [
        "@group(1) @binding(1) var<storage, read_write> a: array<f32>;",
        "@group(1) @binding(2) var<uniform> b: array<vec4<f32>, l>;",
        "struct S {\n  x: f32,\n   \n}",
        "@workgroup_size(8, 8, 1)",
        "let y = c * x_in + x_1f;",
    ] {
        assert!(written.contains(expected), "{expected}: {written}");
    }
    for told in [
        "`${b.first}` at src/a.ts:3:29 is taken for 1, a binding that nothing else has",
        "`${w}` at src/a.ts:10:26 is taken for 8, a size of a workgroup",
        "nothing stands for what is filled in and is not known: `${more}` at src/a.ts:2:1, `${more}` at src/a.ts:8:3",
    ] {
        assert!(found.notes.iter().any(|note| note.starts_with(told)), "{told}: {:?}", found.notes);
    }
    assert_eq!(found.notes.iter().filter(|note| note.starts_with("`${g.scene}`")).count(), 1, "{:?}", found.notes);
    assert_eq!(found.resting, ["main"]);
}

#[test]
fn a_condition_of_a_directive_is_not_so() {
    let text = "export const code = (shadows) => `\n#if ${shadows}\nconst a = 1;\n#else\nconst a = 2;\n#endif\n\
                @compute @workgroup_size(1) fn main() {}\n`;\n";
    let found = read_with(text, &[]);
    assert!(found[0].text.text().contains("\n#if 0\n"), "{}", found[0].text.text());
    assert!(found[0].notes[0].contains("`${shadows}` at src/a.ts:2:5 is taken for 0"), "{:?}", found[0].notes);
}

#[test]
fn a_function_rests_on_what_is_left_out_in_it_and_in_what_it_calls() {
    let text = "export const code = (more) => `\nfn f(x: f32) -> f32 {\n  ${more}\n  return x;\n}\n\
                fn g(x: f32) -> f32 { return f(x); }\nfn h(x: f32) -> f32 { return x; }\n\
                @compute @workgroup_size(1) fn main() { let y = h(1.0); }\n`;\n";
    assert_eq!(only(text).resting, ["f", "g"]);
    assert!(only(&text.replace("  ${more}\n", "")).resting.is_empty());
}

#[test]
fn imports_are_followed_and_places_lead_to_their_files() {
    let others = [
        (
            "src/parts.ts",
            "export * from './deep.ts';\nexport { N as COUNT } from './deep.ts';\nexport default `fn d() {}`;\n",
        ),
        (
            "src/deep.ts",
            "export const N = 7;\nexport const PART = (n: number) => `\nfn part() -> u32 { return ${n}u; }\n`;\n",
        ),
        ("src/plain.wgsl", "fn plain() {}\n"),
    ];
    let text = "import d, { PART as P, COUNT } from './parts.ts';\nimport * as all from './parts.ts';\n\
                import plain from './plain.wgsl?raw';\nimport type { T } from './parts.ts';\n\
                export const CODE = `\n${P(COUNT)}\n${d}\n${all.N}\n${plain}\n@compute @workgroup_size(1) fn main() {}\n`;\n";
    let found = read_with(text, &others);
    let [found] = &found[..] else { panic!("{found:?}") };
    let place = |word: &str| found.text.locate(found.text.text().find(word).unwrap());
    assert_eq!(place("fn part"), "src/deep.ts:3:1");
    assert_eq!(place("7u"), "src/deep.ts:3:27");
    assert_eq!(place("fn d"), "src/parts.ts:3:17");
    assert_eq!(place("fn plain"), "src/plain.wgsl:1:1");
    assert_eq!(place("fn main"), "src/a.ts:10:29");
    assert_eq!(found.notes, ["what templates are filled with is read from src/deep.ts, src/parts.ts, src/plain.wgsl"]);
    // Without the files.
    let found = only(text);
    assert!(found.notes[0].contains("`${P(COUNT)}` at src/a.ts:6:1, `${d}` at src/a.ts:7:1"), "{:?}", found.notes);
}

#[test]
fn conditions_that_are_not_known_are_taken_for_false_and_told() {
    let text = kernel("const IS_OLD = window.old;", "let x = ${IS_OLD ? '1' : '2'} + ${!IS_OLD ? 3 : 4};");
    let found = only(&text);
    assert!(found.text.text().contains("let x = 2 + 3;"), "{}", found.text.text());
    assert_eq!(found.notes.len(), 2, "{:?}", found.notes);
    assert!(found.notes[0].ends_with("src/a.ts:5:13 is not known, and taken for false"), "{:?}", found.notes);
    let found = only(&text.replace("window.old", "true"));
    assert!(found.text.text().contains("let x = 1 + 4;") && found.notes.is_empty(), "{found:?}");
}

#[test]
fn parts_are_read_by_themselves_where_no_module_has_them() {
    let text = "const HALF = `fn half(x: f32) -> f32 { return x / 2.0; }`;\n\
                export const OTHER = (n) => /* wgsl */ `fn other() -> u32 { return ${n}u; }`;\n\
                export const CODE = `${HALF}\n@compute @workgroup_size(1) fn main() {}`;\n";
    let found = read_with(text, &[]);
    let names: Vec<&str> = found.iter().map(|one| one.text.name()).collect();
    assert_eq!(names, ["src/a.ts#OTHER.wgsl", "src/a.ts#CODE.wgsl"]);
    assert_eq!(found.iter().map(|one| one.part).collect::<Vec<_>>(), [true, false]);
}

#[test]
fn other_texts_are_left_alone() {
    for text in [
        "const a = `fn ${name}() in prose`;",
        "expect(code).toBe(`@compute @workgroup_size(1) fn main() { ${x} }`);\nx.toContain(`fn f() { }`);",
        "const rust = `fn main() { println!(\"${x}\"); }`;",
        "const glsl = `void main() { gl_FragColor = vec4(${x}); }`;",
        "const cut = `@compute @workgroup_size(1) fn main() { ${x}`;",
    ] {
        assert!(read_with(text, &[]).is_empty(), "{text}");
    }
}

#[test]
fn nothing_that_is_written_makes_it_fail() {
    let texts = [
        "const N = `fn f() { ${".to_owned(),
        kernel(&format!("const N = {}1{};", "(".repeat(5000), ")".repeat(5000)), "let x = ${N};"),
        kernel(&format!("const N = {}1;", "-".repeat(5000)), "let x = ${N};"),
        kernel(&format!("const N = {}1;", "a => ".repeat(5000)), "let x = ${N()};"),
        kernel("const a = `${b}${b}`, b = `${a}`; const f = n => `${f(n)}${f(n)}`;", "let x = ${f(1)};"),
        kernel("const 頂 = {頂: '\\頂'};", "let x = ${頂.頂}; // ${'`'}"),
        "class A { static = ; } enum E { const f = ( => `fn f() { ${A.x} ${E.y} }`;".to_owned(),
    ];
    for text in texts {
        let ends = (0..text.len().min(400)).chain([text.len()]).filter(|end| text.is_char_boundary(*end));
        ends.for_each(|end| drop(read_with(&text[..end], &[])));
    }
    // Each doubles the one before.
    let mut doubles = String::from("const a0 = `fn f0() {} `;\n");
    (1..40).for_each(|k| doubles += &format!("const a{k} = `${{a{0}}}${{a{0}}}`;\n", k - 1));
    drop(read_with(&kernel(&doubles, "${a39}"), &[]));
}
