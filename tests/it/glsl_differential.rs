//! Our verdict on shaders, accepted or refused, against that of the reference compiler, where it is
//! installed: on the shaders of this repository, on a table of programs, and on generated ones.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

use base::diagnostic::Severity;
use base::text::SourceFile;
use lint::{Input, Level, Selection, Settings, run_with};
use rand_core::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use syntax::{Shader, Stage};
use test_record::not_run;

/// A program, whether it is right, and where the reference compiler thinks otherwise, why.
struct Case {
    stage: &'static str,
    text: &'static str,
    right: bool,
    differs: Option<&'static str>,
}

const fn right(stage: &'static str, text: &'static str) -> Case {
    Case { stage, text, right: true, differs: None }
}

const fn wrong(stage: &'static str, text: &'static str) -> Case {
    Case { stage, text, right: false, differs: None }
}

const TABLE: &[Case] = &[
    right("vert", "#version 150\nin vec4 p;\nvoid main() { gl_Position = p; }\n"),
    right("vert", "#version 110\nattribute vec4 p;\nvarying float x;\nvoid main() { x = p.x; gl_Position = p; }\n"),
    right("vert", "#version 120\nvoid main() { float x = 1; gl_Position = vec4(x); }\n"),
    wrong("vert", "#version 110\nvoid main() { float x = 1; gl_Position = vec4(x); }\n"),
    wrong("vert", "#version 150\nin vec4 p;\nvoid main() { p = vec4(1.0); gl_Position = p; }\n"),
    wrong("vert", "#version 150\nvoid main() { vec4 v = vec3(1.0); gl_Position = v; }\n"),
    wrong("vert", "#version 150\nvoid main() { vec4 v = vec4(vec3(1.0)); gl_Position = v; }\n"),
    wrong("vert", "#version 150\nvoid main() { vec3 v = vec3(1.0); gl_Position = vec4(v.w); }\n"),
    wrong("vert", "#version 150\nvoid main() { float f = 3.0 % 2.0; gl_Position = vec4(f); }\n"),
    wrong("vert", "#version 150\nuniform mat4 m;\nvoid main() { gl_Position = m * vec3(1.0); }\n"),
    wrong("vert", "#version 150\nvoid main() { bool b = vec2(1.0) < vec2(2.0); gl_Position = vec4(b); }\n"),
    wrong("vert", "#version 150\nvoid main() { float a[2]; a[2] = 1.0; gl_Position = vec4(a[0]); }\n"),
    wrong("vert", "#version 150\nvoid main() { discard; }\n"),
    wrong("vert", "#version 150\nvoid main() { break; }\n"),
    Case {
        stage: "vert",
        text: "#version 150\nfloat f(float x) { return f(x); }\nvoid main() { gl_Position = vec4(f(1.0)); }\n",
        right: false,
        differs: Some("recursion is told when the program is linked"),
    },
    wrong("vert", "#version 150\nfloat f() { }\nvoid main() { gl_Position = vec4(f()); }\n"),
    wrong("vert", "#version 150\nconst float f;\nvoid main() { gl_Position = vec4(f); }\n"),
    wrong("vert", "#version 330\nvoid main() { float output = 1.0; gl_Position = vec4(output); }\n"),
    wrong("vert", "float x;\n#version 150\nvoid main() { gl_Position = vec4(x); }\n"),
    right("frag", "#version 330\nflat in int k;\nout vec4 c;\nvoid main() { if (k == 0) discard; c = vec4(k); }\n"),
    wrong("frag", "#version 330\nin int k;\nout vec4 c;\nvoid main() { c = vec4(k); }\n"),
    wrong("frag", "#version 300 es\nout vec4 c;\nvoid main() { c = vec4(1.0); }\n"),
    right("frag", "#version 300 es\nprecision mediump float;\nout vec4 c;\nvoid main() { c = vec4(1.0); }\n"),
    wrong("frag", "#version 300 es\nprecision mediump float;\nout vec4 c;\nvoid main() { c = vec4(1.0) * 2; }\n"),
    right(
        "geom",
        "#version 150\nlayout(triangles) in;\nlayout(points, max_vertices = 1) out;\nin vec3 n[];\nvoid main() { gl_Position = vec4(n[2], 1.0); EmitVertex(); }\n",
    ),
    wrong(
        "geom",
        "#version 150\nlayout(triangles) in;\nlayout(points, max_vertices = 1) out;\nin vec3 n[];\nvoid main() { gl_Position = vec4(n[3], 1.0); EmitVertex(); }\n",
    ),
    wrong(
        "geom",
        "#version 150\nlayout(triangles) in;\nlayout(points, max_vertices = 1) out;\nin vec3 n;\nvoid main() { gl_Position = vec4(n, 1.0); EmitVertex(); }\n",
    ),
    wrong(
        "geom",
        "#version 150\nlayout(triangles) in;\nlayout(triangles, max_vertices = 3) out;\nvoid main() { EmitVertex(); }\n",
    ),
    Case {
        stage: "geom",
        text: "#version 150\nlayout(points, max_vertices = 1) out;\nvoid main() { EmitVertex(); }\n",
        right: false,
        differs: Some("a missing input primitive is told when the program is linked, and one file is not"),
    },
    Case {
        stage: "vert",
        text: "#version 150\nvoid f() { }\n",
        right: false,
        differs: Some("a missing `main` is told when the program is linked, and one file is not"),
    },
];

/// True when nothing of the language is wrong with the text.
fn accepted(name: &str, text: &str) -> bool {
    // What a host may put around the text counts as missing here.
    let selection = Selection::new(&[], &[]).unwrap().at(Level::Strict);
    let found = run_with(&[Input::new(SourceFile::new(name, text))], &Settings { selection, ..Settings::default() });
    !found.iter().any(|d| d.severity == Severity::Error)
}

/// Verdicts of the reference compiler, one for each text; none where it is not installed.
fn reference(texts: &BTreeMap<String, String>) -> Option<BTreeMap<String, bool>> {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in texts {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let out = Command::new("glslangValidator").args(texts.keys()).current_dir(folder.path()).output();
    let Ok(out) = out else {
        // A test may not fail for what is not installed, but has to say so.
        not_run("glslangValidator is not on PATH: only the expectations of the table are checked");
        return None;
    };
    let mut verdicts = BTreeMap::new();
    let mut current: Option<&str> = None;
    let shown = String::from_utf8_lossy(&out.stdout).into_owned();
    for line in shown.lines() {
        if let Some((name, _)) = texts.get_key_value(line.trim()) {
            current = Some(name);
            verdicts.insert(name.clone(), true);
        } else if let Some(name) = current.filter(|_| line.starts_with("ERROR")) {
            verdicts.insert(name.to_owned(), false);
        }
    }
    assert_eq!(verdicts.len(), texts.len(), "every text has a verdict: {shown}");
    Some(verdicts)
}

#[test]
fn the_table_holds_and_the_reference_compiler_agrees() {
    let name = |i: usize, c: &Case| format!("t{i}.{}", c.stage);
    let texts: BTreeMap<String, String> =
        TABLE.iter().enumerate().map(|(i, c)| (name(i, c), c.text.to_owned())).collect();
    let verdicts = reference(&texts);
    for (i, case) in TABLE.iter().enumerate() {
        let name = name(i, case);
        assert_eq!(accepted(&name, case.text), case.right, "{}", case.text);
        if let Some(verdicts) = &verdicts {
            let differs = verdicts[&name] != case.right;
            assert_eq!(differs, case.differs.is_some(), "{:?}\n{}", case.differs, case.text);
        }
    }
}

/// Files of the repository on which the verdicts differ, and why.
const FILES: &[(&str, &str)] = &[
    ("crates/syntax/src/tests/shaders/grammar.frag", "drivers of desktop GLSL take a structure defined inside another"),
    ("crates/syntax/src/tests/shaders/legacy.vert", "GLSL 1.10 has the variables of the fixed-function pipeline"),
    ("fixtures/panics/naga_panic_size.vert", "built-in functions of constants are constant, `inverse` too"),
    ("fixtures/errors/recursion.vert", "recursion is told when the program is linked"),
];

#[test]
fn the_shaders_of_this_repository_get_the_same_verdict() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut texts = BTreeMap::new();
    let mut names = BTreeMap::new();
    let mut folders = vec![root.join("shaders"), root.join("fixtures"), root.join("crates/syntax/src/tests/shaders")];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            let ending = path.extension().and_then(|e| e.to_str()).unwrap_or_default();
            let (true, Ok(text)) = (matches!(ending, "vert" | "frag" | "geom"), std::fs::read_to_string(&path)) else {
                continue;
            };
            let name = format!("s{}.{ending}", names.len());
            let shown = path.strip_prefix(root).unwrap().to_string_lossy().replace('\\', "/");
            names.insert(name.clone(), shown);
            texts.insert(name, text);
        }
    }
    assert!(texts.len() > 20, "{}", texts.len());
    let Some(verdicts) = reference(&texts) else { return };
    let mut wrong = Vec::new();
    for (name, text) in &texts {
        let listed = FILES.iter().any(|(file, _)| *file == names[name]);
        if (accepted(name, text) == verdicts[name]) == listed {
            wrong.push(format!("{}: the reference compiler says {}", names[name], verdicts[name]));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// Makes programs of expressions of many types; each place may get something of a wrong type.
struct Generator {
    rng: Xoshiro256PlusPlus,
    /// One place in so many is broken; 0 breaks none.
    broken: usize,
}

const TYPES: [&str; 8] = ["float", "int", "bool", "vec2", "vec3", "vec4", "mat3", "ivec2"];

impl Generator {
    fn below(&mut self, n: usize) -> usize {
        usize::try_from(self.rng.next_u64() % n as u64).unwrap()
    }

    fn expression(&mut self, ty: &str, depth: usize) -> String {
        if self.broken > 0 && self.below(self.broken) == 0 {
            let other = TYPES[self.below(TYPES.len())];
            return self.value(other, depth);
        }
        self.value(ty, depth)
    }

    fn value(&mut self, ty: &str, depth: usize) -> String {
        if depth == 0 {
            return match self.below(2) {
                0 => format!("v_{ty}"),
                _ => match ty {
                    "float" => "1.5".to_owned(),
                    "int" => "7".to_owned(),
                    "bool" => "true".to_owned(),
                    "ivec2" => "ivec2(3)".to_owned(),
                    other => format!("{other}(0.5)"),
                },
            };
        }
        let part = |g: &mut Self, ty: &str| g.expression(ty, depth - 1);
        match (ty, self.below(5)) {
            ("bool", 0) => format!("({} < {})", part(self, "float"), part(self, "float")),
            ("bool", 1) => format!("({} == {})", part(self, "vec3"), part(self, "vec3")),
            ("bool", 2) => format!("(!{})", part(self, "bool")),
            ("bool", 3) => format!("({} && {})", part(self, "bool"), part(self, "bool")),
            ("bool", _) => format!("any(lessThan({}, {}))", part(self, "vec2"), part(self, "vec2")),
            ("int", 0) => format!("({} % {})", part(self, "int"), part(self, "int")),
            ("int", 1) => format!("({} << 1)", part(self, "int")),
            ("int", 2) => format!("int({})", part(self, "float")),
            ("int", _) => format!("({} * {})", part(self, "int"), part(self, "int")),
            ("float", 0) => format!("dot({}, {})", part(self, "vec3"), part(self, "vec3")),
            ("float", 1) => format!("{}.x", part(self, "vec2")),
            ("float", 2) => format!("pow({}, {})", part(self, "float"), part(self, "float")),
            ("float", 3) => format!("{}[1]", part(self, "vec4")),
            ("float", _) => format!("({} - {})", part(self, "float"), part(self, "float")),
            ("vec2", 0) => format!("vec2({})", part(self, "ivec2")),
            ("vec2", 1) => format!("{}.zy", part(self, "vec3")),
            ("vec3", 0) => format!("({} * {})", part(self, "mat3"), part(self, "vec3")),
            ("vec3", 1) => format!("cross({}, {})", part(self, "vec3"), part(self, "vec3")),
            ("vec3", 2) => format!("vec3({}, {})", part(self, "vec2"), part(self, "float")),
            ("vec4", 0) => format!("vec4({}, {})", part(self, "vec3"), part(self, "float")),
            ("vec4", 1) => format!("vec4({}, {})", part(self, "vec2"), part(self, "vec2")),
            ("mat3", 0) => format!("({} * {})", part(self, "mat3"), part(self, "mat3")),
            ("mat3", 1) => format!("transpose({})", part(self, "mat3")),
            ("ivec2", 0) => format!("(-{})", part(self, "ivec2")),
            ("ivec2", 1) => format!("ivec2({}, {})", part(self, "int"), part(self, "int")),
            (_, 2) => format!("({} ? {} : {})", part(self, "bool"), part(self, ty), part(self, ty)),
            (ty, _) => format!("({} + {})", part(self, ty), part(self, ty)),
        }
    }

    fn statement(&mut self) -> String {
        let ty = TYPES[self.below(TYPES.len())];
        let depth = self.below(4);
        match self.below(6) {
            0 => format!("if ({}) v_{ty} = {};", self.expression("bool", depth), self.expression(ty, depth)),
            1 => format!(
                "for (int i = 0; i < {}; i++) v_{ty} = {};",
                self.expression("int", 1),
                self.expression(ty, depth)
            ),
            2 => format!("{{ {ty} w = {}; v_{ty} = w; }}", self.expression(ty, depth)),
            _ => format!("v_{ty} = {};", self.expression(ty, depth)),
        }
    }

    fn program(&mut self, version: &str) -> String {
        let globals: String = TYPES.iter().map(|t| format!("{t} v_{t};\n")).collect();
        let body: String = (0..4).map(|_| format!("  {}\n", self.statement())).collect();
        format!("#version {version}\n{globals}void main()\n{{\n{body}  gl_Position = vec4(v_float);\n}}\n")
    }
}

#[test]
fn generated_programs_get_the_same_verdict() {
    let mut texts = BTreeMap::new();
    let rng = Xoshiro256PlusPlus::seed_from_u64(0x6715);
    let mut generator = Generator { rng, broken: 0 };
    for i in 0..400 {
        // Half of them are right; the others have about one broken place.
        generator.broken = if i % 2 == 0 { 0 } else { 25 };
        let version = ["130", "150", "330", "410"][i / 2 % 4];
        texts.insert(format!("g{i}.vert"), generator.program(version));
    }
    let refused = texts.iter().filter(|(name, text)| !accepted(name, text)).count();
    for (name, text) in &texts {
        let number: usize = name[1..name.len() - 5].parse().unwrap();
        let parsed = Shader::parse(&SourceFile::new(name.as_str(), text.as_str()), Stage::Vertex);
        assert!(number % 2 == 1 || parsed.diagnostics.is_empty(), "{:#?}\n{text}", parsed.diagnostics);
    }
    assert!((50..200).contains(&refused), "both verdicts occur: {refused}");
    let Some(verdicts) = reference(&texts) else { return };
    for (name, text) in &texts {
        assert_eq!(accepted(name, text), verdicts[name], "{name} by the reference compiler\n{text}");
    }
}
