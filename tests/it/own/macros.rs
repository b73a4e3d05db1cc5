//! Places in what macros write: the use, with the macro named, and in an argument the author's text there.

use super::{check, folder, suite};
use crate::binary::{Ran, command};

/// Suite of a function of three numbers beside a reference.
fn judged(shader: &str, reference: &str, more: &[(&str, &str)], options: &[&str]) -> Ran {
    let text = suite(&["x", "y", "z"], "reference = \"r.glsl\"");
    let mut files = vec![("f.glsl", shader), ("r.glsl", reference), ("f.suite.toml", &*text)];
    files.extend(more);
    check(&files, options)
}

/// Where the first finding is, and the text and macro there.
#[track_caller]
fn computed(ran: &Ran) -> (String, String, Option<String>) {
    let json = ran.json();
    let place = &json["suites"][0]["findings"][0]["case"]["computed_at"];
    let text = |key: &str| place[key].as_str().map(str::to_owned);
    (text("at").unwrap_or_else(|| panic!("{json:#}")), text("text").unwrap(), text("macro"))
}

const RIGHT: &str = "float f(float x, float y, float z) { return (x * x + y) * 0.5 + z; }\n";

/// What stands before the function, its body, and where the deviation is computed: line and column, text and macro.
type Message = (&'static str, &'static str, &'static str, &'static str, Option<&'static str>);

const USES: &[Message] = &[
    // Without a macro, and with one elsewhere.
    ("", "return z + (x * x + y) * 0.501;", "1:52", "z + (x * x + y) * 0.501", None),
    (
        "#define SQ(x) ((x) * (x))\n",
        "float s = SQ(x); return (s + y) * 0.501 + z;",
        "2:69",
        "(s + y) * 0.501 + z",
        None,
    ),
    // A function-like macro, nested ones, and one of several lines that is used on several lines.
    (
        "#define ALL(a, b, c) (((a) * (a) + b) * 0.501 + c)\n",
        "return ALL(x, y, z);",
        "2:52",
        "ALL(x, y, z)",
        Some("ALL"),
    ),
    (
        "#define SQ(x) ((x) * (x))\n#define HALF(x) ((x) * 0.501)\n#define ALL(a, b, c) (HALF(SQ(a) + b) + c)\n",
        "return ALL(x, y, z);",
        "4:52",
        "ALL(x, y, z)",
        Some("ALL"),
    ),
    (
        "#define ALL(a, b, c) \\\n  (((a) * (a) + b) \\\n  * 0.501 + c)\n",
        "return ALL(x,\n y, z);",
        "4:52",
        "ALL(x,\n y, z)",
        Some("ALL"),
    ),
    // An operator between two arguments is the macro's.
    (
        "#define PLUS(a, b) a + b\n",
        "return PLUS((x * x + y) * 0.501, z);",
        "2:52",
        "PLUS((x * x + y) * 0.501, z)",
        Some("PLUS"),
    ),
    // An argument, also one of a macro within a macro, is the author's text.
    ("#define ID(a) a\n", "return ID((x * x + y) * 0.501 + z);", "2:55", "(x * x + y) * 0.501 + z", None),
    (
        "#define ID(a) a\n#define TWICE(a) ID(ID(a))\n",
        "return TWICE((x * x + y) * 0.501 + z);",
        "3:58",
        "(x * x + y) * 0.501 + z",
        None,
    ),
    // A macro in an argument of another one, and one that names the next.
    (
        "#define ID(a) a\n#define ALL(a) (((a) * (a) + y) * 0.501 + z)\n",
        "return ID(ALL(x));",
        "3:55",
        "ALL(x)",
        Some("ALL"),
    ),
    (
        "#define ALL(a) (((a) * (a) + y) * 0.501 + z)\n#define NAME ALL\n",
        "return NAME(x);",
        "3:52",
        "NAME(x)",
        Some("ALL"),
    ),
    // Without arguments, and with a name that is put together.
    ("#define ALL ((x * x + y) * 0.501 + z)\n", "return ALL;", "2:52", "ALL", Some("ALL")),
    ("#define JOIN(a) a##_1 * 0.501 + z\n", "float s_1 = x * x + y; return JOIN(s);", "2:75", "JOIN(s)", Some("JOIN")),
];

#[test]
fn a_place_in_a_macro_is_its_use() {
    for (before, body, at, text, name) in USES {
        let shader = format!("{before}float f(float x, float y, float z) {{        {body} }}\n");
        let ran = judged(&shader, RIGHT, &[], &["--format", "json"]).expect(1);
        let found = computed(&ran);
        let want = (format!("./f.glsl:{at}"), (*text).to_owned(), name.map(str::to_owned));
        assert_eq!(found, want, "{shader}");
    }
}

#[test]
fn every_format_has_the_use() {
    let shader = "#define ALL(a, b, c) \\\n (((a) * (a) + b) * 0.501 + c)\nfloat f(float x, float y, float z) {\n  return ALL(x, y, z);\n}\n";
    let text = judged(shader, RIGHT, &[], &[]).expect(1).out;
    assert!(text.contains("  computed   ./f.glsl:4:10, in the expansion of `ALL`\n"), "{text}");
    assert!(
        text.contains("return ALL(x, y, z);\n           |          ^^^^^^^^^^^^\n") || text.contains("^^^^^^^^^^^^"),
        "{text}"
    );
    assert!(!text.contains("define ALL"), "{text}");
    let github = judged(shader, RIGHT, &[], &["--format", "github"]).expect(1).out;
    assert!(github.contains("file=f.glsl,line=4,col=10,"), "{github}");
    let sarif = judged(shader, RIGHT, &[], &["--format", "sarif"]).expect(1).json();
    let region = &sarif["runs"][0]["results"][0]["locations"][0]["physicalLocation"]["region"];
    assert_eq!((&region["startLine"], &region["startColumn"]), (&4.into(), &10.into()), "{sarif:#}");
}

#[test]
fn a_macro_of_an_included_file_is_used_where_it_stands() {
    let shader = "#include \"m.glsl\"\nfloat f(float x, float y, float z) {\n  return ALL(x) + inner(z);\n}\n";
    let included = "#define ALL(a) (((a) * (a) + y) * 0.5)\n#define SAME(a) ((a) * 1.001)\nfloat inner(float a) {\n\n  return SAME(a);\n}\n";
    let ran = judged(shader, RIGHT, &[("m.glsl", included)], &["--format", "json"]).expect(1);
    assert_eq!(computed(&ran).0, "./f.glsl:3:10");
    // What an included file uses itself stands there.
    let shader = "#include \"m.glsl\"\nfloat f(float x, float y, float z) {\n  return outer(x, y, z);\n}\n";
    let included = "#define ALL(a) (((a) * (a) + y) * 0.501 + z)\nfloat outer(float x, float y, float z) {\n\n  return ALL(x);\n}\n";
    let ran = judged(shader, RIGHT, &[("m.glsl", included)], &["--format", "json"]).expect(1);
    let (at, text, name) = computed(&ran);
    assert!(at.ends_with("m.glsl:4:10"), "{at}");
    assert_eq!((&*text, name.as_deref()), ("ALL(x)", Some("ALL")));
}

#[test]
fn undefined_values_and_doubts_are_reported_at_the_use() {
    let shader = "#define ROOT(a) sqrt(a)\nfloat f(float x, float y, float z) {\n  return ROOT(x) + y + z;\n}\n";
    let text = suite(&["x", "y", "z"], "");
    let files = [("f.glsl", shader), ("f.suite.toml", &*text)];
    let ran = check(&files, &[]).expect(1);
    assert!(
        ran.out
            .contains("the shader gives an undefined value: `ROOT(x)` at ./f.glsl:3:10, in the expansion of `ROOT`: "),
        "{}",
        ran.out
    );
    let sarif = check(&files, &["--format", "sarif"]).expect(1).json();
    let found = sarif["runs"][0]["results"].as_array().unwrap().iter().find(|r| r["ruleId"] == "undefined").unwrap();
    let region = &found["locations"][0]["physicalLocation"]["region"];
    assert_eq!((&region["startLine"], &region["startColumn"]), (&3.into(), &10.into()), "{sarif:#}");
}

#[test]
fn a_call_around_a_macro_is_not_what_the_macro_writes() {
    // The inner `sqrt` is undefined, not the outer one.
    let shader =
        "#define ROOT(a) sqrt(a)\nfloat f(float x, float y, float z) {\n  return sqrt(ROOT(x) + 1.0) + y + z;\n}\n";
    let text = suite(&["x", "y", "z"], "");
    let ran = check(&[("f.glsl", shader), ("f.suite.toml", &text)], &[]).expect(1);
    assert!(
        ran.out.contains("undefined value: `ROOT(x)` at ./f.glsl:3:15, in the expansion of `ROOT`: "),
        "{}",
        ran.out
    );
}

/// `shadercheck lint` of a shader in one format.
fn lint(text: &str, format: &str) -> Ran {
    let folder = folder(&[("a.vert", text)]);
    command(folder.path(), "lint a.vert --format").arg(format).output().unwrap().into()
}

#[test]
fn lint_names_the_macro() {
    let text = "#version 330 core\n#define SUM(a) ((a) + vec4(1.0))\n#define ID(a) a\nin vec3 p;\nvoid main() {\n  \
                gl_Position = vec4(1.0) *\n    SUM(p);\n  float x = ID((p + vec2(1.0))).x;\n}\n";
    let concise = lint(text, "concise").expect(1).out;
    assert_eq!(
        concise,
        "a.vert:7:5: error[E031]: `+` cannot combine a `vec3` and a `vec4` (in the expansion of `SUM`)\n\
         a.vert:8:19: error[E031]: `+` cannot combine a `vec3` and a `vec2`\n"
    );
    let found = lint(text, "json").expect(1).json();
    assert_eq!((&found[0]["line"], &found[0]["end_column"]), (&7.into(), &11.into()), "{found:#}");
    assert_eq!(found[0]["related"][0]["line"], 2, "{found:#}");
    assert!(found[1]["related"].as_array().unwrap().is_empty(), "{found:#}");
    for format in ["text", "github", "sarif"] {
        assert!(lint(text, format).expect(1).out.contains("(in the expansion of `SUM`)"), "{format}");
    }
}

#[test]
fn nothing_is_repaired_inside_of_a_use() {
    // Outside of a macro this has a repair.
    let text = |value: &str| {
        format!("#version 330 core\n#define TWICE(a) (a + a)\nvoid main() {{ gl_Position = vec4(TWICE({value})); }}\n")
    };
    let fixes =
        |text: &str| lint(text, "json").json().as_array().unwrap().iter().filter(|d| !d["fix"].is_null()).count();
    let wrong = "vec2(1.0, 2.0, 3.0)";
    let plain = format!("#version 330 core\nvoid main() {{ gl_Position = vec4({wrong}, 0.0, 0.0); }}\n");
    assert!(fixes(&plain) > 0, "{}", lint(&plain, "text").out);
    assert_eq!(fixes(&text(wrong)), 0, "{}", lint(&text(wrong), "text").out);
}
