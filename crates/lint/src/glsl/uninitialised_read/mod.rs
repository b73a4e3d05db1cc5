//! D001: a variable is read before it has a value.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use analysis::flow::{Certainty, Unassigned};
use analysis::forms::builtin;
use base::diagnostic::{Code, Diagnostic, Severity, message};
use reading::ShaderFile;
use syntax::Shader;
use syntax::symbols::SymbolKind;

use super::variable::{part, with_zero};

mod counter;
mod element;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("D001"),
    name: "uninitialised-read",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Shader(check),
};

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    for read in &file.flow().unassigned {
        let elsewhere = is_of_an_extension(file, read) || is_taken_from_another(&file.shader, read);
        if read.certainty != Certainty::Perhaps && !read.accumulates && !elsewhere {
            let found = diagnostic(file, read, findings);
            findings.push(found);
        }
    }
    element::check(file, findings);
    counter::check(file, findings);
}

/// True for a variable with a qualifier of an extension, which other stages may fill: `hitAttributeEXT vec2 hit;`
fn is_of_an_extension(file: &ShaderFile, read: &Unassigned) -> bool {
    let symbol = file.shader.symbol(read.symbol);
    let global = matches!(symbol.kind, SymbolKind::Global(_));
    let line = symbol.span.filter(|_| global).map_or_else(String::new, |span| file.file.line_at(span.start));
    line.split(|c: char| !c.is_ascii_alphanumeric()).any(|word| word.ends_with("EXT") || word.ends_with("NV"))
}

/// True for a value that an operation of a subgroup takes from another invocation, which may be the one that wrote it.
fn is_taken_from_another(shader: &Shader, read: &Unassigned) -> bool {
    const TAKE: [&str; 4] =
        ["subgroupBroadcastFirst", "subgroupBroadcast", "subgroupShuffle", "readFirstInvocationARB"];
    shader.arena().iter().any(|(id, _)| {
        let first = builtin(shader, id, &TAKE).and_then(|(_, args)| args.first());
        first.is_some_and(|first| shader.expr(*first).span == read.span)
    })
}

/// The diagnostic for a read without a value.
pub(super) fn diagnostic(file: &ShaderFile, read: &Unassigned, findings: &Findings<'_>) -> Diagnostic {
    let shader = &file.shader;
    let symbol = shader.symbol(read.symbol);
    let name = part(shader, read.symbol, read.mask);
    let (message, why) = match read.certainty {
        Certainty::Always => (
            message!("`{name}` is read before it has a value", "`{name}` は値が入る前に読まれています"),
            message!(
                "nothing has been written to it when this place is reached for the first time: the value is undefined",
                "この場所に最初に来たとき、まだ何も書き込まれていません。値は未定義です"
            ),
        ),
        Certainty::SomePath | Certainty::Perhaps => (
            message!("`{name}` may be read before it has a value", "`{name}` は値が入る前に読まれる可能性があります"),
            message!(
                "on one of the paths to this place nothing is written to it, and the value is undefined there",
                "この場所に来る経路の中に何も書き込まれないものがあり、その場合の値は未定義です"
            ),
        ),
    };
    let mut found = findings
        .at(&file.file, read.span, message)
        .with_label(message!("no value here", "ここで値がない"))
        .with_why(why)
        .with_help(message!("give `{name}` a value on every path", "すべての経路で `{name}` に値を入れてください"));
    if let Some(span) = symbol.span {
        found = found.with_related(&file.file, span, message!("declared without a value", "値のない宣言"));
    }
    with_zero(found, file, read.symbol)
}

#[cfg(test)]
mod tests {
    use super::super::testing::{found, messages};
    use base::text::EditList;

    fn reported(body: &str) -> Vec<String> {
        let text = format!(
            "#version 150 core\nin vec4 q;\nuniform int n;\nuniform bool b;\nout vec4 c;\nvoid set(out float x, inout vec3 y) {{ x = q.x; y += 1.0; }}\nfloat last(float z) {{ return z; }}\nvoid main(void)\n{{\n  c = q;\n  {body}\n  gl_Position = q;\n}}\n"
        );
        messages("D001", "a.vert", &text)
    }

    #[test]
    fn what_another_stage_fills_has_a_value() {
        let text = |qualifier: &str| {
            format!(
                "#version 460\n#extension GL_EXT_ray_tracing : enable\n{qualifier} vec3 hit;\nout vec4 c;\n\
                 void main() {{ c = vec4(hit, 1.0); gl_Position = c; }}\n"
            )
        };
        assert_eq!(messages("D001", "a.vert", &text("hitAttributeEXT")), [""; 0]);
        assert_eq!(messages("D001", "a.vert", &text("")).len(), 1);
    }

    #[test]
    fn what_one_invocation_gives_to_all_has_a_value_there() {
        let text = |taken: &str| {
            format!(
                "#version 450\n#extension GL_KHR_shader_subgroup_ballot : enable\nlayout(local_size_x = 64) in;\n\
                 layout(binding = 0) buffer B {{ uint n; uint o[]; }};\nvoid main() {{ uint b; if (subgroupElect()) \
                 b = atomicAdd(n, 1u); b = {taken}; o[gl_GlobalInvocationID.x] = b; }}\n"
            )
        };
        assert_eq!(messages("D001", "a.comp", &text("subgroupBroadcastFirst(b)")), [""; 0]);
        assert_eq!(messages("D001", "a.comp", &text("b + 1u")).len(), 1);
    }

    #[test]
    fn reads_without_a_value_are_reported() {
        for (body, name) in [
            ("float x; c.x = x;", "x"),
            ("float x; if (b) { float y = x; x = y; c.x = x; }", "x"),
            ("vec4 p; p.xyz = q.xyz; c = p * 2.0;", "p.w"),
            ("vec3 y; float x; set(x, y); c.x = x + y.x;", "y"),
            ("float x; c.x = last(x);", "x"),
            ("mat2 m; m[0] = q.xy; c.xy = m * q.xy;", "m"),
            ("struct S { float a; vec2 b; } s; s.a = 1.0; c.xy = s.b;", "s"),
            ("float x; for (int i = 0; i < n; ++i) { c.x += x; x = 1.0; }", "x"),
            ("float x; x += 1.0; c.x = x;", "x"),
            ("float f[3]; c.x = f[n];", "f"),
            ("for (int i = 0; i < 3; ++i) { float x; c.x += x; x = 1.0; }", "x"),
        ] {
            assert_eq!(reported(body), [format!("`{name}` is read before it has a value")], "{body}");
        }
        for body in ["float x; if (b) x = 1.0; c.x = x;", "float x; do { if (n > 3) x = 1.0; c.x = x; } while (b);"] {
            assert_eq!(reported(body), ["`x` may be read before it has a value"], "{body}");
        }
    }

    #[test]
    fn what_has_a_value_is_not() {
        for body in [
            "float x; x = 1.0; c.x = x;",
            "float x = 1.0, y = x; c.x = y;",
            "float x; if (b) x = 1.0; else x = 2.0; c.x = x;",
            "float x; if (b) x = 1.0; if (b) c.x = x;",
            "float x; if (n == 0) x = 1.0; else if (n == 1) x = 2.0; c.x = x;",
            "float x; if (n == 0) x = 1.0; if (n == 1) x = 2.0; c.x = x;",
            "float x; switch (n) { case 0: x = 1.0; break; case 1: x = 2.0; break; } c.x = x;",
            "float x; for (int i = 0; i < n; ++i) x = float(i); c.x = x;",
            "float x; for (int i = 0; i < 3; ++i) x = float(i); c.x = x;",
            "float x; for (int i = 0; i < n; ++i) { if (i > 0) c.x += x; x = 1.0; }",
            "float x; for (int i = 0; i < n; ++i) { c.x += i > 0 ? x : 0.0; x = 1.0; }",
            "float x; if (!b) return; x = 1.0; c.x = x;",
            "vec4 p; p.xy = q.xy; p.w = 1.0; p.z = 0.0; c = p;",
            "vec4 p; p.xyz = q.xyz; c.xyz = p.xyz;",
            "vec4 p; for (int i = 0; i < 4; ++i) p[i] = 1.0; c = p;",
            "mat2 m; m[0] = q.xy; m[1] = q.zw; c.xy = m * q.xy;",
            "float f[3]; f[0] = 1.0; c.x = f[0];",
            "float f[3]; c.x = float(f.length());",
            "float x; vec3 y = q.xyz; set(x, y); c.x = x;",
            "struct S { float a; vec2 b; } s; s.a = 1.0; struct T { S s; } t; t.s = s; c.x = t.s.a;",
            "float x; if (false) c.x = x;",
            "float x; do { x = 1.0; } while (b); c.x = x;",
            "float x; bool found = false; if (b) { x = 1.0; found = true; } if (found) c.x = x;",
        ] {
            assert_eq!(reported(body), [""; 0], "{body}");
        }
    }

    #[test]
    fn text_that_depends_on_the_host_is_left_alone() {
        let text = |inner: &str| {
            format!("#version 150 core\nvoid main(void)\n{{\n  float x;\n{inner}\n  gl_Position = vec4(x);\n}}\n")
        };
        assert!(messages("D001", "a.vert", &text("#ifdef A\n  x = 1.0;\n#endif")).is_empty());
        assert_eq!(messages("D001", "a.vert", &text("#ifdef GL_ES\nprecision highp float;\n#endif")).len(), 1);
    }

    #[test]
    fn a_local_variable_gets_a_zero() {
        let text =
            "#version 150 core\nvoid main(void)\n{\n  vec4 p, q[2], r;\n  r.x = 0.0;\n  gl_Position = p + r;\n}\n";
        let reported = found("D001", "a.vert", text);
        let edits: EditList = reported.iter().flat_map(|d| d.fix.clone().unwrap().edits).collect();
        let fixed = edits.apply(text).unwrap().text;
        assert!(fixed.contains("vec4 p = vec4(0.0), q[2], r = vec4(0.0);"), "{fixed}");
    }
}
