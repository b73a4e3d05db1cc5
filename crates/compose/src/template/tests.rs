//! Templates with what is stated, with what is assumed, and with names that stand in.

use super::*;
use crate::import::ModulePath;
use crate::{Library, Problems, Wanted};

/// Files by their names.
struct Files(Vec<SourceFile>);

impl Library for Files {
    fn include(&mut self, wanted: &Wanted) -> Option<SourceFile> {
        self.0.iter().find(|file| file.name() == wanted.path).cloned()
    }

    fn module(&mut self, _: &SourceFile, _: &ModulePath) -> Option<SourceFile> {
        None
    }

    fn modules(&mut self, _: &SourceFile) -> Vec<String> {
        Vec::new()
    }

    fn siblings(&mut self, _: &SourceFile) -> Vec<SourceFile> {
        Vec::new()
    }
}

struct Filled {
    text: String,
    errors: Vec<String>,
    notes: Vec<String>,
}

fn rendered(text: &str, defines: &[(&str, &str)], files: &[(&str, &str)]) -> Filled {
    let defines: Vec<_> = defines.iter().map(|&(n, v)| (n.to_owned(), v.to_owned())).collect();
    let mut library = Files(files.iter().map(|&(name, text)| SourceFile::new(name, text)).collect());
    let mut problems = Problems::default();
    let Rendered { file: out, notes, .. } =
        render(&SourceFile::new("a.wgsl", text), (&defines, false), &mut library, &mut problems);
    let shown = |d: &base::diagnostic::Diagnostic| format!("{} {}", d.file.locate(d.span.start), d.message);
    Filled {
        text: out.text().to_owned(),
        errors: problems.found.iter().map(shown).collect(),
        notes: notes.iter().map(shown).collect(),
    }
}

fn filled(text: &str, defines: &[(&str, &str)]) -> (String, Vec<String>) {
    let Filled { text, errors, .. } = rendered(text, defines, &[]);
    (text, errors)
}

#[test]
fn values_stand_where_their_names_stood() {
    let (text, told) =
        filled("struct P {\n{{FIELDS}}\n}\nconst n = {{ count }};", &[("FIELDS", "x: f32"), ("count", "3")]);
    assert_eq!((text.as_str(), told.len()), ("struct P {\nx: f32\n}\nconst n = 3;", 0));
}

#[test]
fn conditions_choose_by_values() {
    let text = "{% if a %}A{% elif b %}B{% else %}C{% endif %} {{#unless a}}D{{else}}E{{/unless}}";
    assert_eq!(filled(text, &[("a", "1")]).0, "A E");
    assert_eq!(filled(text, &[("b", "1"), ("a", "0")]).0, "B D");
    assert_eq!(filled(text, &[]), ("C D".to_owned(), vec![]));
    let compared = "{% if n[0] % 4 == 0 and kind != \"x\" %}A{% else %}B{% endif %}";
    assert_eq!(filled(compared, &[("n", "[8, 3]"), ("kind", "y")]).0, "A");
    assert_eq!(filled(compared, &[("n", "[6]"), ("kind", "y")]).0, "B");
}

#[test]
fn loops_and_files_are_put_in() {
    let text = "{% for n in lens %}a{{ loop.index0 }}[{{ n / 2 }}u]{% if not loop.last %}, {% endif %}{% endfor %};";
    assert_eq!(filled(text, &[("lens", "[4, 6]")]), ("a0[2u], a1[3u];".to_owned(), vec![]));
    let Filled { text, errors, .. } =
        rendered("{% include 'b.wgsl' %}\nf();", &[("T", "f16")], &[("b.wgsl", "{# a\n note #}alias S = {{ T }};")]);
    assert_eq!((text.as_str(), errors.len()), ("alias S = f16;\nf();", 0));
    // What declares something is taken once, what does not as often as it is named.
    let twice = |part: &str| rendered("{% include 'b' %}{% include 'b' %}", &[], &[("b", part)]);
    assert_eq!(twice("struct S { x: f32 }").text, "struct S { x: f32 }");
    assert_eq!(twice("x += 1;").text, "x += 1;x += 1;");
    assert_eq!(filled("{% include \"c\" %}", &[]).1, ["a.wgsl:1:1 `c` is not found"]);
}

#[test]
fn what_a_place_says_is_assumed_and_told() {
    let text = "@workgroup_size({{ wg }}) {% if kind == \"max\" %}x{% else %}y{% endif %} = {{ wg / 2 }}u;";
    let Filled { text, errors, notes } = rendered(text, &[], &[]);
    assert_eq!((text.as_str(), errors.len()), ("@workgroup_size(64) x = 32u;", 0));
    assert_eq!(
        notes,
        [
            "a.wgsl:1:17 `wg` is taken for 64, the size of a workgroup; `--define wg=VALUE` states another",
            "a.wgsl:1:27 `kind` is taken for max, what it is compared with; `--define kind=VALUE` states another",
        ]
    );
    let Filled { text, notes, .. } = rendered("{% for s in all %}g({{ s }}u);{% endfor %}", &[], &[]);
    assert_eq!((text.as_str(), notes.len()), ("g(64u);", 2));
}

#[test]
fn what_a_branch_declares_that_is_off_is_told() {
    let root = SourceFile::new("a.wgsl", "{% if wide %}alias T = f32;{% endif %}\nfn f(x: T) -> T { return x; }");
    let found = crate::compose(&root, &crate::Options::default(), &mut Files(Vec::new())).unwrap();
    let told = found.fragment().unwrap();
    assert_eq!(told.help.unwrap().to_string(), "`T` is declared under `wide`: state it with `--define`");
}

#[test]
fn what_an_included_template_asks_for_is_stated() {
    let root = SourceFile::new("a.wgsl", "{% include 'b.wgsl' %}\nfn f(x: T) -> T { return x; }");
    let options = crate::Options { defines: vec![("wide".to_owned(), "1".to_owned())], ..Default::default() };
    let part = SourceFile::new("b.wgsl", "{% if wide %}alias T = f32;{% endif %}");
    let found = crate::compose(&root, &options, &mut Files(vec![part])).unwrap();
    assert_eq!((found.stated, found.undeclared), (vec!["wide".to_owned()], vec![]));
}

#[test]
fn what_has_no_value_and_what_needs_an_engine_is_told() {
    let told = |text| filled(text, &[]).1;
    assert_eq!(told("a\n  {{X}}"), ["a.wgsl:2:3 the placeholder `X` has no value"]);
    assert_eq!(told("{% macro f() %}"), ["a.wgsl:1:1 `{% macro f() %}` is not read: the engine of its host"]);
    assert_eq!(told("{% if a %}"), ["a.wgsl:1:1 this condition is never ended"]);
    assert_eq!(told("{% endif %}"), ["a.wgsl:1:1 nothing ends here"]);
    assert_eq!(told("// {{X}}"), Vec::<String>::new());
}

#[test]
fn what_has_a_line_for_itself_may_be_nothing() {
    let composed = |text: &str| {
        crate::compose(&SourceFile::new("a.wgsl", text), &crate::Options::default(), &mut Files(Vec::new()))
    };
    let text = "struct P {\n  x: f32,\n  {{PADDING}}\n}\nfn f(p: P) -> f32 { return p.x; }";
    let found = composed(text).unwrap();
    assert_eq!(found.file.text(), text.replace("{{PADDING}}", ""));
    assert_eq!(
        found.notes.iter().map(|note| note.message.to_string()).collect::<Vec<_>>(),
        ["`PADDING` is left empty: nothing states it; `--define PADDING=VALUE` does"]
    );
    // What the text needs is no padding.
    for text in ["{{DECLARATIONS}}\nfn f() -> f32 { return missing; }", "{{X}}", "fn f() {\n  x = {{X}};\n}\n{{Y}}"] {
        assert!(composed(text).is_err(), "{text}");
    }
}

#[test]
fn quotients_of_tera_are_rounded_as_a_whole() {
    assert_eq!(filled("{{ n / 4 | int }}u", &[("n", "6")]).0, "1u");
    assert_eq!(filled("{{ n / 4 | round }}u", &[("n", "6")]).0, "2u");
    assert_eq!(filled("{{ n | int / 4 }}u", &[("n", "8")]).0, "2u");
}

#[test]
fn names_stand_in_for_what_is_not_known() {
    let standing = |text: &str| stand_in(&SourceFile::new("a.wgsl", text), &[]).text().to_owned();
    assert_eq!(
        standing("if (i < {{ n[0] / 4 }}u && j < {{ n[0] / 4 }}u) { x = {{ a }}; }"),
        "if (i < stand_in_0 && j < stand_in_0) { x = stand_in_1; }\noverride stand_in_0: u32;"
    );
    assert_eq!(standing("struct S {\n  a: f32,\n  {{PADDING}}\n}"), "struct S {\n  a: f32,\n  \n}");
    assert_eq!(standing("{% if n % 4 == 0 %}A{% else %}B{% endif %}C"), "AC");
    assert_eq!(standing("{%- include \"a\" -%}\n// {{X}}\n{{#each xs}}D{{/each}}"), "\n// \nD");
    assert_eq!(standing("{% for i in xs %}{{ i }}{% endfor"), "stand_in_0{% endfor");
}

#[test]
fn blocks_in_blocks_are_no_placeholders() {
    let text = "fn f() {{ let a = 1; }}\nfn g() {{\n}}\nfn h() {{}}";
    assert_eq!(filled(text, &[]), (text.to_owned(), vec![]));
}

#[test]
fn names_without_braces_are_declared_where_their_places_tell_what_they_are() {
    let composed = |text: &str| {
        let root = SourceFile::new("a.wgsl", text);
        crate::compose(&root, &crate::Options::default(), &mut Files(Vec::new())).unwrap()
    };
    let text = "@group(0) @binding(0) var<storage, read_write> a: array<elem>;\n\
        @compute @workgroup_size(SIZE_X, SIZE_Y) fn main() { a[0] = elem(1); }\n";
    let whole = composed(text);
    assert_eq!(whole.undeclared, []);
    assert!(
        whole.file.text().ends_with("\nalias elem = f32;\nconst SIZE_X = 8;\nconst SIZE_Y = 8;"),
        "{}",
        whole.file.text()
    );
    assert_eq!(whole.notes.len(), 3);
    // A structure, and a number that may be anything.
    for text in
        ["var<private> a: array<Particle, 4>; fn f() { a[0].x = 1; }", "fn f(x: f32) -> f32 { return x * RADIUS; }"]
    {
        assert_eq!(composed(text).undeclared.len(), 1, "{text}");
    }
}
