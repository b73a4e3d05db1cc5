//! D003: an output that nothing writes.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use reading::ShaderFile;
use syntax::interface::Storage;
use syntax::symbols::SymbolKind;
use syntax::types::{OpaqueKind, Type};
use syntax::{Shader, Stage};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("D003"),
    name: "output-never-written",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Shader(check),
};

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let (shader, flow) = (&file.shader, file.flow());
    let declared = |o: &&analysis::flow::Output| shader.symbol(o.symbol).kind != SymbolKind::Builtin;
    // Where no invocation comes to its end, as behind a `discard`, none has to be written.
    for output in flow.outputs.iter().filter(declared).filter(|o| o.written == 0 && o.surely == 0) {
        let symbol = shader.symbol(output.symbol);
        let (Some(span), name) = (symbol.span, &symbol.name) else { continue };
        let to = if shader.stage() == Stage::Fragment {
            message!("the frame buffer gets an undefined value", "フレームバッファに未定義の値が書き込まれます")
        } else {
            message!("the next stage gets an undefined value", "次のステージに未定義の値が渡ります")
        };
        // A shader that works on images or buffers may leave its output alone on purpose.
        let level = if stores(file) || does_nothing(shader) { Level::Strict } else { Level::Default };
        findings.push_at(
            level,
            findings
                .at(
                    &file.file,
                    span,
                    message!("output `{name}` is never written", "出力変数 `{name}` に書き込みがありません"),
                )
                .with_label(message!("nothing writes it", "どこでも書き込まれない"))
                .with_why(to)
                .with_help(message!("write `{name}`, or remove it", "`{name}` に書き込むか、宣言を削除してください")),
        );
    }
    let silent = flow.reached.is_some() && flow.outputs.iter().all(|o| o.written == 0);
    if shader.stage() != Stage::Vertex || !silent || stores(file) {
        return;
    }
    let Some(main) = shader.function("main") else { return };
    findings.push(
        findings
            .at(
                &file.file,
                main.name.span,
                message!("this vertex shader writes no output", "このバーテックスシェーダは何も出力していません"),
            )
            .with_label(message!("`gl_Position` is not written", "`gl_Position` に書き込みがない"))
            .with_why(message!("the position of the vertex is undefined", "頂点の位置が未定義になります"))
            .with_help(message!("write `gl_Position`", "`gl_Position` に書き込んでください")),
    );
}

/// True for a fragment shader with an empty `main`, which stands behind a vertex shader whose outputs are captured.
fn does_nothing(shader: &Shader) -> bool {
    let body = shader.function("main").and_then(|main| shader.function_syntax(main)?.body.as_ref());
    shader.stage() == Stage::Fragment && body.is_some_and(|body| body.statements.is_empty())
}

/// True when the shader can write to memory.
pub(super) fn stores(file: &ShaderFile) -> bool {
    let interface = file.shader.interface();
    let memory = |ty: &Type| {
        let mut ty = ty;
        while let Type::Array(element, _) = ty {
            ty = element;
        }
        matches!(ty, Type::Opaque(o) if o.kind != OpaqueKind::Sampler)
    };
    interface.blocks.iter().any(|b| b.storage == Storage::Buffer) || interface.uniforms.iter().any(|u| memory(&u.ty))
}

#[cfg(test)]
mod tests {
    use super::super::testing::messages;

    fn reported(name: &str, outer: &str, body: &str) -> Vec<String> {
        messages("D003", name, &format!("#version 150 core\n{outer}\nvoid main(void)\n{{\n  {body}\n}}\n"))
    }

    #[test]
    fn outputs_that_nothing_writes_are_reported() {
        assert_eq!(reported("a.frag", "out vec4 c;", ""), ["output `c` is never written"]);
        assert_eq!(reported("a.frag", "out vec4 c; void f() { c = vec4(1.0); }", ""), ["output `c` is never written"]);
        assert_eq!(reported("a.frag", "out vec4 c;", "if (false) c = vec4(1.0);"), ["output `c` is never written"]);
        assert_eq!(reported("a.vert", "", ""), ["this vertex shader writes no output"]);
        assert_eq!(
            reported("a.vert", "out V { vec3 n; } v;", "gl_Position = vec4(1.0);"),
            ["output `v` is never written"]
        );
    }

    #[test]
    fn outputs_that_something_writes_are_not() {
        for (name, outer, body) in [
            ("a.frag", "out vec4 c; void f() { c = vec4(1.0); }", "f();"),
            ("a.frag", "out vec4 c; void f(out vec4 x) { x = vec4(1.0); }", "f(c);"),
            ("a.frag", "out vec4 c; void f(inout vec4 x) { x = vec4(1.0); }", "f(c);"),
            ("a.frag", "out vec4 c[2];", "c[1].x = 1.0;"),
            ("a.frag", "", ""),
            ("a.frag", "out vec4 c;", "discard;"),
            ("a.vert", "out vec3 p; in vec3 q;", "p = q;"),
            ("a.vert", "out V { vec3 n; };", "n = vec3(1.0); gl_Position = vec4(n, 1.0);"),
            ("a.geom", "layout(points) in; layout(points, max_vertices = 1) out; out vec3 n;", "n = vec3(1.0);"),
        ] {
            assert_eq!(reported(name, outer, body), [""; 0], "{outer} {body}");
        }
        assert!(messages("D003", "a.glsl", "out vec4 c;\nvoid f() {}\n").is_empty());
    }
}
