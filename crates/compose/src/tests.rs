//! Files that are composed, and what is told of those that cannot be.

use std::collections::HashMap;

use base::text::SourceFile;

use crate::{Composed, Library, ModulePath, Options, Origin, Wanted, compose};

/// Files by path, where modules of `package::` and of a package named as the first folder are.
struct Shelf(HashMap<&'static str, &'static str>);

impl Shelf {
    fn file(&self, path: &str) -> Option<SourceFile> {
        self.0.get(path).map(|text| SourceFile::new(path, *text))
    }
}

impl Library for Shelf {
    fn include(&mut self, wanted: &Wanted) -> Option<SourceFile> {
        self.file(&wanted.path).or_else(|| self.file(&format!("{}.wgsl", wanted.path)))
    }

    fn module(&mut self, from: &SourceFile, path: &ModulePath) -> Option<SourceFile> {
        let folders: Vec<&str> = from.name().split('/').collect();
        let mut parts: Vec<&str> = match &path.origin {
            Origin::Package => folders[..1].to_vec(),
            Origin::Super(count) => folders[..folders.len() - count].to_vec(),
            Origin::Named => Vec::new(),
            Origin::File(file) => return self.file(file),
        };
        parts.extend(path.names.iter().map(String::as_str));
        let said = format!("#define_import_path {}\n", path.names.join("::"));
        let says = self.0.iter().find(|(_, text)| text.contains(&said)).map(|(path, _)| *path);
        let path = parts.join("/");
        self.file(&format!("{path}.wesl")).or_else(|| self.file(says?))
    }

    fn modules(&mut self, _: &SourceFile) -> Vec<String> {
        let paths = self.0.keys().map(|path| path.trim_end_matches(".wesl").replace('/', "::"));
        let said = self.0.values().filter_map(|text| text.lines().find_map(|l| l.strip_prefix("#define_import_path ")));
        paths.chain(said.map(str::to_owned)).collect()
    }

    fn siblings(&mut self, from: &SourceFile) -> Vec<SourceFile> {
        let mut names: Vec<_> = self.0.keys().filter(|path| **path != from.name() && !path.contains('/')).collect();
        names.sort();
        names.into_iter().filter_map(|path| self.file(path)).collect()
    }
}

type Files = &'static [(&'static str, &'static str)];

fn run(files: Files, defines: &[(&str, &str)]) -> Result<Composed, Vec<String>> {
    let mut shelf = Shelf(files.iter().copied().collect());
    let defines = defines.iter().map(|&(n, v)| (n.to_owned(), v.to_owned())).collect();
    let options = Options { defines, ..Options::default() };
    let root = SourceFile::new(files[0].0, files[0].1);
    compose(&root, &options, &mut shelf).map_err(|found| {
        let shown = |d: &base::diagnostic::Diagnostic| {
            let help = d.help.as_ref().map(ToString::to_string).unwrap_or_default();
            format!("{} {} {} | {help}", d.code, d.file.locate(d.span.start), d.message)
        };
        found.iter().map(shown).collect()
    })
}

fn text(files: Files, defines: &[(&str, &str)]) -> String {
    let composed = run(files, defines).unwrap_or_else(|told| panic!("{told:#?}"));
    composed.file.text().split_whitespace().collect::<Vec<_>>().join(" ")
}

fn told(files: Files) -> String {
    run(files, &[]).map(|composed| composed.file.text().to_owned()).expect_err("a fault").join("\n")
}

#[test]
fn a_file_that_needs_nothing_stays_as_it_is() {
    let text = "// a\nfn f(x: f32) -> f32 {\n  return x; /* b */\n}\n";
    let mut shelf = Shelf(HashMap::new());
    let file = SourceFile::new("a.wgsl", text);
    assert_eq!(compose(&file, &Options::default(), &mut shelf).unwrap().file, file);
}

#[test]
fn items_come_with_what_they_need_and_lead_back_to_their_files() {
    let files: Files = &[
        (
            "app/main.wesl",
            "import super::light::{shade, K as k};\nimport package::types;\nfn f(t: types::T) -> f32 {\n  return shade(t) * k;\n}\n",
        ),
        (
            "app/light.wesl",
            "import super::types::T;\nconst K = 2.0;\nconst UNUSED = 1;\n  fn shade(t: T) -> f32 { return helper(t.x); }\nfn helper(x: f32) -> f32 { return x; }\n",
        ),
        ("app/types.wesl", "struct T { x: f32 }\n"),
    ];
    let composed = run(files, &[]).unwrap();
    let text = composed.file.text();
    assert!(text.contains("fn f(t: T) -> f32 {\n  return shade(t) * K;\n}"), "{text}");
    assert!(text.contains("fn helper") && text.contains("struct T") && !text.contains("UNUSED"), "{text}");
    let place = |needle: &str| composed.file.locate(text.find(needle).unwrap());
    assert_eq!(place("shade(t: T)"), "app/light.wesl:4:6");
    assert_eq!(place("* K;"), "app/main.wesl:4:19");
    assert_eq!(place("K;"), "app/main.wesl:4:21");
    assert_eq!(place("struct T"), "app/types.wesl:1:1");
}

#[test]
fn names_of_several_files_do_not_collide() {
    let files: Files = &[
        ("app/main.wesl", "import super::a::f; import super::b::f as g; const C = 1; fn main(C: i32) { f(g(C)); }"),
        ("app/a.wesl", "const C = 2; fn f(x: i32) -> i32 { return x + C; }"),
        (
            "app/b.wesl",
            "fn f(x: i32) -> i32 { let a_f = max(x, 1); return a_f; } fn max(x: i32, y: i32) -> i32 { return x; }",
        ),
    ];
    let composed = run(files, &[]).unwrap();
    let text = composed.file.text();
    assert!(text.contains("const C = 1;") && text.contains("fn main(C: i32)"), "{text}");
    let renamed: Vec<_> = composed.renamed.iter().map(|r| (r.name.as_str(), r.file.as_str())).collect();
    assert_eq!(renamed.len(), 3, "{renamed:?}");
    let written =
        |name, file| composed.renamed.iter().find(|r| r.name == name && r.file == file).unwrap().written.as_str();
    let (c, f, g) = (written("C", "app/a.wesl"), written("f", "app/a.wesl"), written("f", "app/b.wesl"));
    assert!(text.contains(&format!("{f}({g}(C))")) && text.contains(&format!("x + {c};")), "{text}");
    assert_eq!(composed.authored(f), "f");
    let at = text.find(&format!("const {c} =")).unwrap();
    assert_eq!(composed.file.locate(at), "app/a.wesl:1:1");
}

#[test]
fn built_in_functions_stay_those_of_the_language_in_other_files() {
    let files: Files = &[
        ("app/main.wesl", "import super::a::f; fn g() -> f32 { return f(1.0); }"),
        ("app/a.wesl", "import super::b; fn f(x: f32) -> f32 { return max(x, b::max(x)); }"),
        ("app/b.wesl", "fn max(x: f32) -> f32 { return x; }"),
    ];
    let text = text(files, &[]);
    assert!(text.contains("return max(x, super_b_max(x));") || text.contains("return max(x, b_max(x));"), "{text}");
}

#[test]
fn a_local_variable_does_not_hide_what_is_imported() {
    let files: Files = &[
        ("app/main.wesl", "import super::m; fn f() -> f32 { let view = m::view.x; return view; }"),
        ("app/m.wesl", "struct V { x: f32 } @group(0) @binding(0) var<uniform> view: V;"),
    ];
    let text = text(files, &[]);
    assert!(text.contains("let view = ") && !text.contains("let view = view.x"), "{text}");
}

#[test]
fn features_choose_imports_and_their_files_follow() {
    let files: Files = &[
        (
            "app/main.wesl",
            "@if(FAST) import super::fast::f; @else import super::slow::f;\nfn g() -> f32 { return f(); }",
        ),
        ("app/fast.wesl", "fn f() -> f32 { @if(HALF) return 0.5; @else return 1.0; }"),
        ("app/slow.wesl", "fn f() -> f32 { return 2.0; }"),
    ];
    assert!(text(files, &[]).contains("return 2.0;"));
    assert!(text(files, &[("FAST", ""), ("HALF", "")]).contains("{ return 0.5; }"));
    assert!(text(files, &[("FAST", "true"), ("HALF", "false")]).contains("{ return 1.0; }"));
}

#[test]
fn constants_are_what_is_defined() {
    let files: Files = &[("app/main.wesl", "@group(constants::GROUP) @binding(0) var<uniform> x: f32;")];
    assert!(text(files, &[("GROUP", "2"), ("FLAG", "")]).contains("@group(GROUP)"));
    let told = told(files);
    assert!(told.contains("E070 app/main.wesl:1:8") && told.contains("--define GROUP=VALUE"), "{told}");
}

#[test]
fn modules_of_naga_oil_are_found_by_what_they_say() {
    let files: Files = &[
        ("main.wgsl", "#import engine::{\n  types as t,\n  view::{view, #{N} }\n}\n"),
        ("types.wgsl", "#define_import_path engine::types\nstruct T { x: f32, }\n"),
    ];
    assert!(told(files).starts_with("E001 main.wgsl:3:16"));
    let files: Files = &[
        (
            "main.wgsl",
            "#import engine::types as t\n#import engine::view::view\n#ifdef WIDE\nfn f(x: t::T) -> f32 { return x.x * view[#{N}u] + engine::types::K; }\n#else\nfn g() {}\n#endif\n",
        ),
        (
            "types.wgsl",
            "#define_import_path engine::types\nstruct T { x: f32, }\n#if N >= 3\nconst K = 1.0;\n#else\nconst K = 2.0;\n#endif\n",
        ),
        (
            "view.wgsl",
            "#define_import_path engine::view\n@group(0) @binding(0) var<uniform> view: array<vec4f, #{N}>;\n",
        ),
    ];
    let text = text(files, &[("WIDE", ""), ("N", "3")]);
    assert!(text.contains("fn f(x: T) -> f32 { return x.x * view[3u] + K; }"), "{text}");
    assert!(text.contains("const K = 1.0;") && text.contains("array<vec4f, 3>") && !text.contains("fn g"), "{text}");
}

#[test]
fn included_files_are_copied_with_their_macros() {
    let files: Files = &[
        (
            "main.wgsl",
            "#include \"common.wgsl\"\n#import <once.wgsl>\n#import once\n#ifdef F16\nenable f16;\n#endif\nfn f(x: TYPE) -> TYPE { return SQ(x) + ONE; }\n",
        ),
        ("common.wgsl", "#define TYPE f32\n#define SQ(x) ((x) * (x))\n"),
        ("once.wgsl", "const ONE = 1.0;\n"),
    ];
    let composed = run(files, &[]).unwrap();
    let text = composed.file.text();
    assert_eq!(text.matches("const ONE").count(), 1);
    assert!(!text.contains("enable") && !text.contains("TYPE"), "{text}");
    assert_eq!(composed.file.locate(text.find("ONE;").unwrap()), "main.wgsl:7:40");
    assert_eq!(composed.file.locate(text.find("const ONE").unwrap()), "once.wgsl:1:1");
}

#[test]
fn a_file_that_is_included_twice_is_there_once_unless_it_is_read_in_several_ways() {
    let files: Files = &[
        (
            "main.wgsl",
            "#include \"a.wgsl\"\n#include \"b.wgsl\"\n#include \"a.wgsl\"\nfn f() -> f32 { return ONE + two(); }\n",
        ),
        ("a.wgsl", "const ONE = 1.0;\n"),
        ("b.wgsl", "#include \"a.wgsl\"\nfn two() -> f32 { return ONE + ONE; }\n"),
    ];
    assert_eq!(text(files, &[]).matches("const ONE").count(), 1);
    let files: Files = &[
        (
            "main.wgsl",
            "#ifdef LEFT_OUT\n#include \"a.wgsl\"\n#endif\n#include \"a.wgsl\"\nfn f() -> f32 { return ONE; }\n",
        ),
        ("a.wgsl", "const ONE = 1.0;\n"),
    ];
    assert_eq!(text(files, &[]).matches("const ONE").count(), 1);
    let files: Files = &[
        (
            "main.wgsl",
            "#define NAME a\n#include \"a.wgsl\"\n#undef NAME\n#define NAME b\n#include \"a.wgsl\"\nfn f() { a(); b(); }\n",
        ),
        ("a.wgsl", "fn NAME() {}\n"),
    ];
    let both = text(files, &[]);
    assert!(both.contains("fn a()") && both.contains("fn b()"), "{both}");
}

#[test]
fn what_is_not_there_is_told_with_what_was_meant() {
    let files: Files = &[
        (
            "app/main.wesl",
            "import super::light::shadee;\nimport super::ligth::shade;\nimport other::x;\nfn f() { a::b(); x(shadee()); shade(); }",
        ),
        ("app/light.wesl", "fn shade() {} @if(FOG) fn fog() {}"),
    ];
    let told = told(files);
    assert!(
        told.contains("E070 app/main.wesl:1:22 `app/light.wesl` declares no `shadee` | did you mean `shade`?"),
        "{told}"
    );
    assert!(told.contains("E070 app/main.wesl:2:22 no module is found for `super::ligth::shade`"), "{told}");
    assert!(told.contains("E070 app/main.wesl:3:15") && told.contains("-I FOLDER"), "{told}");
    assert!(told.contains("E070 app/main.wesl:4:10"), "{told}");
    let files: Files = &[
        ("app/main.wesl", "import super::light::fog;\nfn f() { fog(); }"),
        ("app/light.wesl", "fn shade() {} @if(FOG) fn fog() {}"),
    ];
    let fault = run(files, &[]).unwrap_err().join("\n");
    assert!(
        fault.contains("it stands under `@if(FOG)`, which does not hold: state features with `--define NAME`"),
        "{fault}"
    );
    assert!(run(files, &[("FOG", "")]).is_ok());
    let files: Files = &[("app/main.wesl", "@if(A) fn f() {}")];
    assert!(run(files, &[]).unwrap_err()[0].starts_with("E074 app/main.wesl:1:1 conditions leave out everything"));
}

#[test]
fn what_nobody_uses_is_not_missed() {
    let files: Files = &[("app/main.wesl", "import super::gone::x;\nfn f() {}")];
    let composed = run(files, &[]).unwrap();
    let [warning] = &composed.notes[..] else { panic!("{:?}", composed.notes) };
    assert_eq!(warning.file.locate(warning.span.start), "app/main.wesl:1:21");
    let files: Files = &[
        ("main.wgsl", "#import e::m::x\nfn f() { x(); }"),
        ("m.wgsl", "#define_import_path e::m\n#ifdef SLOW\nfn x() {}\n#endif\n"),
    ];
    let told = told(files);
    assert!(told.contains("E070 main.wgsl:1:15") && told.contains("under a directive such as `#ifdef`"), "{told}");
}

#[test]
fn bindings_are_assigned_where_no_resource_has_one() {
    let bound = |text: &str| {
        let mut shelf = Shelf(HashMap::new());
        let options = Options { assign_bindings: true, ..Options::default() };
        compose(&SourceFile::new("a.wgsl", text), &options, &mut shelf).unwrap()
    };
    let assigned = |text: &str| bound(text).assigned;
    let bound = |text: &str| bound(text).file;
    let file = bound("var<private> p: f32;\nvar t: texture_2d<f32>;\nvar<storage, read> s: array<u32>;\n");
    assert!(file.text().contains("@group(0) @binding(0) var t:") && file.text().contains("@binding(1) var<storage"));
    assert!(file.text().contains("var<private> p") && !file.text().contains("@binding(2)"));
    assert_eq!(file.locate(file.text().find("var t").unwrap()), "a.wgsl:2:1");
    let some = "@group(0) @binding(0) var t: sampler;\nvar s: sampler;\n";
    assert_eq!(bound(some).text(), some);
    assert!(assigned("var<uniform> a: vec4f;\n") && !assigned(some) && !assigned("const A = 1;\n"));
}

#[test]
fn circles_are_told_with_their_chain() {
    let files: Files = &[
        ("a.wgsl", "#import e::b\nfn a() {}\n"),
        ("b.wgsl", "#define_import_path e::b\n#import e::c\nfn b() {}\n"),
        ("c.wgsl", "#define_import_path e::c\n#import e::b\nfn c() { b::b(); }\n"),
    ];
    assert!(run(files, &[]).is_ok(), "nothing of what is imported is used");
    let files: Files = &[
        ("a.wgsl", "#import e::b\nfn a() { b::b(); }\n"),
        ("b.wgsl", "#define_import_path e::b\n#import e::c\nfn b() { c::c(); }\n"),
        ("c.wgsl", "#define_import_path e::c\n#import e::b\nfn c() { b::b(); }\n"),
    ];
    let told_ = told(files);
    assert!(told_.contains("E071 c.wgsl:2:12 these files take in each other: b.wgsl → c.wgsl → b.wgsl"), "{told_}");
    let files: Files = &[("app/a.wesl", "fn f() {}\nimport super::a::g;\nfn g() {}")];
    assert!(told(files).contains("E071 app/a.wesl:2:18 this file takes in itself"));
    let files: Files = &[("a", "#include \"b\"\n"), ("b", "\n#include \"a\"\n")];
    assert!(told(files).contains("E071 b:2:1 these files take in each other: a → b → a"));
    // In WESL, modules may use each other.
    let files: Files = &[
        ("app/a.wesl", "import super::b::g; const N = 1; fn f() { g(); }"),
        ("app/b.wesl", "import super::a::N; fn g() -> i32 { return N; }"),
    ];
    assert!(text(files, &[]).contains("return N;"));
}

#[test]
fn wrong_statements_are_told_with_their_places() {
    let told_of = |text: &'static str| {
        run(&[("a.wesl", "")], &[])
            .and_then(|_| {
                let mut shelf = Shelf(HashMap::new());
                let file = SourceFile::new("a.wesl", text);
                compose(&file, &Options::default(), &mut shelf).map_err(|found| {
                    found.iter().map(|d| format!("{} {}", d.code, d.file.locate(d.span.start))).collect()
                })
            })
            .map(|_| ())
            .unwrap_err()
            .join(", ")
    };
    assert_eq!(told_of("@else const a = 1;"), "E072 a.wesl:1:1");
    assert_eq!(told_of("\n{{X}}"), "E073 a.wesl:2:1");
    assert_eq!(told_of("#ifdef A\n"), "E011 a.wesl:1:1");
    assert_eq!(told_of("#if A\n#endif"), "E016 a.wesl:1:5");
    assert_eq!(told_of("#use X\n"), "E010 a.wesl:1:1");
    assert_eq!(told_of("import a::;"), "E001 a.wesl:1:11");
    assert_eq!(told_of("#include \"gone\"\n"), "E070 a.wesl:1:1");
}

#[test]
fn a_name_that_comes_twice_is_told() {
    let files: Files = &[
        ("app/main.wesl", "import super::a::f;\nimport super::b::f;\nimport super::a::g;\nfn g() { f(); g(); }"),
        ("app/a.wesl", "fn f() {} fn g() {}"),
        ("app/b.wesl", "fn f() {}"),
    ];
    let told = told(files);
    assert!(told.contains("E075 app/main.wesl:2:18 `f` is imported twice"), "{told}");
    assert!(told.contains("E075 app/main.wesl:3:18 `g` is imported and declared here"), "{told}");
}

#[test]
fn a_fragment_takes_what_one_file_beside_it_declares() {
    let files: Files = &[
        ("main.wgsl", "fn f(c: Camera) -> vec4f { return c.m * g(); }"),
        ("camera.wgsl", "struct Camera { m: mat4x4f, l: Light }\nconst Unused = 1;"),
        ("light.wgsl", "struct Light { c: vec4f }\nfn g() -> vec4f { return vec4f(f2()); }"),
        ("more.wgsl", "struct Light { c: vec4f }"),
    ];
    let composed = run(files, &[]).unwrap();
    let guessed: Vec<_> = composed.guessed.iter().map(|g| (g.name.as_str(), g.file.as_str())).collect();
    assert_eq!(guessed, [("Camera", "camera.wgsl"), ("g", "light.wgsl"), ("Light", "light.wgsl")]);
    assert!(!composed.file.text().contains("Unused"));
    let found = composed.fragment().unwrap();
    assert_eq!(format!("{} {}", found.code, found.file.locate(found.span.start)), "E074 light.wgsl:2:32");
    assert!(found.message.contains("`f2`"), "{}", &*found.message);
}

#[test]
fn a_fragment_with_two_readings_is_told_by_name() {
    let files: Files = &[
        ("main.wgsl", "fn f(c: Camera) {}"),
        ("a.wgsl", "struct Camera { m: mat4x4f }"),
        ("b.wgsl", "struct Camera { v: vec4f }"),
    ];
    let found = run(files, &[]).unwrap().fragment().unwrap();
    assert_eq!(found.file.locate(found.span.start), "main.wgsl:1:9");
    let help = found.help.unwrap().to_string();
    assert!(help.contains("a.wgsl, b.wgsl") && help.contains("--with FILE"), "{help}");
}

#[test]
fn a_prelude_gives_what_the_text_lacks() {
    let mut shelf = Shelf(HashMap::new());
    let prelude =
        SourceFile::new("p.wgsl", "struct Camera { m: mat4x4f, n: f32 }\nfn helper() -> f32 { return scale(); }");
    let options = Options { preludes: vec![prelude], ..Options::default() };
    let root = SourceFile::new(
        "a.wgsl",
        "#use Camera\nfn f(c: Camera) -> f32 { return helper(); }\nfn scale() -> f32 { return 1.0; }\n",
    );
    let composed = compose(&root, &options, &mut shelf).unwrap();
    assert!(composed.undeclared.is_empty() && composed.guessed.is_empty(), "{composed:?}");
    assert!(composed.file.text().contains("struct Camera"));
}

#[test]
fn directives_of_the_language_come_first_and_once() {
    let files: Files = &[
        ("app/main.wesl", "import super::a::f; enable f16; fn g() { f(); }"),
        ("app/a.wesl", "enable  f16;\nenable subgroups; fn f() {} const_assert 1 < 2;"),
    ];
    let text = text(files, &[]);
    assert!(text.starts_with("enable f16; enable subgroups;"), "{text}");
    assert!(text.contains("const_assert 1 < 2;"));
}

#[test]
fn entry_points_keep_their_names() {
    let files: Files = &[
        ("app/main.wesl", "import super::a::main; fn helper() {} fn g() { main(); }"),
        ("app/a.wesl", "override X = 1; fn helper() {} @compute @workgroup_size(1) fn main() { helper(); let x = X; }"),
    ];
    let text = text(files, &[]);
    assert!(text.contains("fn main()") && text.contains("override X = 1;") && text.contains("_helper()"), "{text}");
}

/// What a text of one file becomes.
fn current(text: &'static str) -> String {
    let root = SourceFile::new("old.wgsl", text);
    let composed = compose(&root, &Options::default(), &mut Shelf(HashMap::new())).unwrap();
    assert_eq!(composed.notes.len(), usize::from(composed.file.text().trim() != text.trim()), "{:?}", composed.notes);
    composed.file.text().trim().to_owned()
}

#[test]
fn early_drafts_become_the_language_of_today() {
    let pairs = [
        (
            "[[block]]\nstruct U { [[align(16)]] m: mat4x4<f32>; [[size(16)]] a: f32; };\n\
             [[group(0), binding(1)]] var<uniform> u: U;",
            "struct U { @align(16) m: mat4x4<f32>, @size(16) a: f32, };\n@group(0) @binding(1) var<uniform> u: U;",
        ),
        (
            "[[stage(vertex)]] fn main([[builtin(vertex_idx)]] i: u32) -> [[builtin(position)]] vec4<f32> { return vec4<f32>(); }",
            "@vertex fn main(@builtin(vertex_index) i: u32) -> @builtin(position) vec4<f32> { return vec4<f32>(); }",
        ),
        (
            "[[stage(compute), workgroup_size(8, 4)]] fn main() -> void { const a = 1; if (a > 2) { } elseif (a < 1) { } }",
            "@compute @workgroup_size(8, 4) fn main()  { let a = 1; if (a > 2) { } else if (a < 1) { } }",
        ),
        ("[[location 0]] [[set 1, binding 2]]\nfn f() {}", "@location(0) @group(1) @binding(2)\nfn f() {}"),
        (
            "struct V { [[location(0)]] a: u32; [[location(1), interpolate(flat)]] b: i32; [[location(2)]] c: f32; };\n\
             [[stage(vertex)]] fn main([[location(0)]] v: vec2<i32>) {}\n\
             [[stage(fragment)]] fn main() -> [[location(0)]] vec4<f32> {}\n[[stage(compute)]] fn c() { ignore(b); }",
            "struct V { @location(0) @interpolate(flat) a: u32, @location(1) @interpolate(flat) b: i32, @location(2) c: f32, };\n\
             @vertex fn main(@location(0) @interpolate(flat) v: vec2<i32>) {}\n\
             @fragment fn main_fragment() -> @location(0) vec4<f32> {}\n@workgroup_size(1) @compute fn c() { ; }",
        ),
        ("let a = 1; type T = f32;\nfn f() { let b = 2; }", "const a = 1; alias T = f32;\nfn f() { let b = 2; }"),
        (
            "@stage(fragment) fn f() { let a = smoothStep(0., 1., 2.); }",
            "@fragment fn f() { let a = smoothstep(0., 1., 2.); }",
        ),
        (
            "[[override(3)]] let n: i32 = 1; @override let m: i32 = 2;",
            "@id(3) override n: i32 = 1;  override m: i32 = 2;",
        ),
        (
            "struct B { d: [[stride(4)]] array<f32>; };\nvar<storage> b: [[access(write)]] B;\n\
             var t: [[access(read)]] texture_storage_2d<rgba8unorm>;\n\
             fn f() { let s = textureDimensions(t); let n = arrayLength(b.d); ignore(n + 1); }",
            "struct B { d:  array<f32>, };\nvar<storage, read_write> b:  B;\n\
             var t:  texture_storage_2d<rgba8unorm, read>;\n\
             fn f() { let s = vec2<i32>(textureDimensions(t)); let n = arrayLength(&b.d); _ = (n + 1); }",
        ),
        (
            "[[group(0), binding(0)]] var<storage, write> b: B;\n\
             fn f(a: u32) { let b = a; for (var a = 0u; a < b; a += 1u) { let b = c.b + b; g(b); } let b = b + a; \
             { let b = b * 2; g(b); } let a = a; g(a + b); }\nfn g(b: u32) { let c = b; }",
            "@group(0) @binding(0) var<storage, read_write> b: B;\n\
             fn f(a: u32) { let b = a; for (var a = 0u; a < b; a += 1u) { let b = c.b + b; g(b); } let b_2 = b + a; \
             { let b_2 = b_2 * 2; g(b_2); } let a_2 = a; g(a_2 + b_2); }\nfn g(b: u32) { let c = b; }",
        ),
    ];
    for (old, new) in pairs {
        let tidy = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
        assert_eq!(tidy(&current(old)), tidy(new));
    }
}

#[test]
fn the_language_of_today_is_no_draft() {
    for text in [
        "// [[block]] let a = 1;\n@vertex fn f(@location(0) a: f32) -> @builtin(position) vec4f { let b = x[y[0]]; return vec4f(a); }",
        "fn smoothStep(a: f32) -> f32 { return a; }\nfn f() -> f32 { return smoothStep(1.0); }",
        "struct A { a: f32, b: array<f32, 4> }\nfn f() { const a = 1; let s = select(1, 2, true); }",
        "fn ignore(a: f32) {}\nfn f() { ignore(1.0); };",
    ] {
        assert_eq!(current(text), text);
    }
}

#[test]
fn what_drafts_had_and_nothing_replaces_is_refused_by_name() {
    for (text, told) in [
        (
            "struct B { d: [[stride(16)]] array<f32>; };",
            "E076 old.wgsl:1:17 a stride of 16 bytes where elements follow each other after 4",
        ),
        ("[[location(0)]] var<in> a: f32;", "E076 old.wgsl:1:21 `var<in>`"),
        ("[[foo(1)]] fn f() {}", "E076 old.wgsl:1:3 the attribute `foo`"),
        ("fn f(x: f32) -> bool { return isNan(x); }\nlet a = 1;", "E076 old.wgsl:1:31 `isNan`"),
        ("entry_point vertex as \"main\" = f;\nlet a = 1;", "E076 old.wgsl:1:1 `entry_point`"),
        ("[[block] struct A { a: f32; };", "E076 old.wgsl:1:1 this attribute"),
    ] {
        let mut shelf = Shelf(HashMap::new());
        let found = compose(&SourceFile::new("old.wgsl", text), &Options::default(), &mut shelf).unwrap_err();
        let shown: Vec<String> =
            found.iter().map(|d| format!("{} {} {}", d.code, d.file.locate(d.span.start), &*d.message)).collect();
        assert!(shown.iter().any(|one| one.starts_with(told)), "{shown:?}");
    }
}

#[test]
fn places_in_a_draft_are_those_of_its_author() {
    let text =
        "[[group(0), binding(1)]] var<uniform> u: f32;\nstruct S { a: f32; b: f32; };\nfn f() -> f32 { return u; }";
    let (file, note) = crate::from_draft(&SourceFile::new("old.wgsl", text)).unwrap();
    for word in ["var<uniform>", "b: f32", "return u"] {
        let (own, span) = file.origin(base::text::Span::at(file.text().find(word).unwrap()));
        assert!(own.text()[span.start..].starts_with(word), "{word}");
    }
    assert_eq!(note.file.locate(note.span.start), "old.wgsl:1:1");
    let edits: base::text::EditList = note.fix.unwrap().edits.into_iter().collect();
    assert_eq!(edits.apply(text).unwrap().text, file.text());
    assert!(crate::from_draft(&SourceFile::new("new.wgsl", file.text())).is_none(), "once is enough");
}

#[test]
fn where_many_names_are_unknown_none_is_taken_for_a_slip() {
    let helped = |count: usize| {
        let lines: String = (0..count).map(|i| format!("  let value{i} = valeu{i};\n")).collect();
        let file = SourceFile::new("a.wgsl", format!("fn f() {{\n{lines}}}\n"));
        let options = Options { assume_nothing: true, ..Options::default() };
        let found = compose(&file, &options, &mut Shelf(HashMap::new())).unwrap().unknown_names();
        assert_eq!(found.len(), count);
        found.iter().filter(|d| d.help.is_some()).count()
    };
    assert_eq!(helped(40), 40);
    assert_eq!(helped(100), 0);
}

#[test]
fn what_leads_nowhere_is_undeclared_where_that_is_asked_for() {
    let file = SourceFile::new(
        "a.wgsl",
        "#import engine::{view::View, mesh as m}\n@group(#{GROUP}) @binding(0) var<uniform> v: View;\n\
         fn f(x: f32) -> f32 {\n#if QUALITY > 2\n  return x;\n#endif\n  return m::scale(x) * v.size; }\n",
    );
    let with = |open: bool| compose(&file, &Options { open, ..Options::default() }, &mut Shelf(HashMap::new()));
    assert!(with(false).is_err());
    let composed = with(true).unwrap();
    let names: Vec<&str> = composed.undeclared.iter().map(|lacking| lacking.name.as_str()).collect();
    assert_eq!(names, ["View", "scale"]);
    let text = composed.file.text();
    assert!(text.contains("@group(0)") && text.contains("return scale(x) * v.size"), "{text}");
    assert!(!text.contains("return x;"), "{text}");
    // A name stands where its author has it.
    let lacking = &composed.undeclared[1];
    let (author, span) = composed.file.origin(lacking.span);
    assert_eq!((composed.file.slice(lacking.span), author.locate(span.start)), ("scale", "a.wgsl:7:10".to_owned()));
    let notes: Vec<String> = composed.notes.iter().map(|note| note.message.to_string()).collect();
    assert!(notes.iter().any(|note| note.starts_with("`GROUP` is taken for 0, a group of bindings")), "{notes:?}");
    assert!(notes.iter().any(|note| note.starts_with("`QUALITY` is taken for 1, a number")), "{notes:?}");
}
