//! N044: a time that grows, of which `mediump` soon has no fraction.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use reading::ShaderFile;
use syntax::Shader;
use syntax::ast::{BinaryOp, ExprId, ExprKind, UnaryOp};
use syntax::interface::Storage;
use syntax::precision::{Precisions, is_lower};
use syntax::symbols::{SymbolId, SymbolKind};
use syntax::types::Type;
use syntax::words::words;

use analysis::forms::{Forms, builtin};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("N044"),
    name: "mediump-time",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Shader(check),
};

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    if !shader.has_precisions() {
        return;
    }
    let precisions = Precisions::of(shader);
    let times: Vec<SymbolId> = shader
        .symbols()
        .filter(|(id, symbol)| {
            matches!(symbol.kind, SymbolKind::Global(Storage::Uniform))
                && matches!(symbol.ty, Type::Scalar(_))
                && is_time(&symbol.name)
                && precisions.of_symbol(*id).is_some_and(is_lower)
        })
        .map(|(id, _)| id)
        .collect();
    if times.is_empty() {
        return;
    }
    let forms = Forms::new(shader);
    for time in times {
        // The first place says it.
        let found = shader.arena().iter().filter(|(id, _)| precisions.is_lowered(*id)).find(|(id, _)| {
            builtin(shader, *id, &["sin", "cos", "tan", "fract", "mod", "floor"])
                .and_then(|(_, args)| args.first())
                .is_some_and(|arg| carries(shader, &forms, *arg, time, 0))
        });
        let Some((id, expr)) = found else { continue };
        let name = &shader.symbol(time).name;
        let what = shader.text_of(id);
        findings.push(
            findings
                .at(
                    &file.file,
                    expr.span,
                    message!(
                        "`{what}` moves in steps at `mediump`: after 64 seconds `{name}` grows by 1/16 at a time",
                        "`{what}` は `mediump` では飛び飛びに動きます。64 秒を過ぎると `{name}` は 1/16 ずつしか増えません"
                    ),
                )
                .with_label(message!(
                    "`{name}` is taken for seconds that grow",
                    "`{name}` を増え続ける秒数とみなしています"
                ))
                .with_why(message!(
                    "GLSL ES promises 11 bits of `mediump`: beyond 1024 no fraction is left, and beyond 16384 no number",
                    "GLSL ES が `mediump` に保証するのは 11 ビットです。1024 を超えると小数部がなく、16384 を超えると数がありません"
                ))
                .with_help(message!(
                    "declare `{name}` `highp`, or let the host take the remainder of a period",
                    "`{name}` を `highp` で宣言するか、周期の剰余をホスト側で求めてください"
                )),
        );
    }
}

/// True where a value grows with the time.
fn carries(shader: &Shader, forms: &Forms<'_>, id: ExprId, time: SymbolId, depth: usize) -> bool {
    if depth > 12 {
        return false;
    }
    let id = forms.value(id);
    let deeper = |id: ExprId| carries(shader, forms, id, time, depth + 1);
    match &shader.expr(id).kind {
        ExprKind::Name(_) => shader.symbol_of(id) == Some(time),
        ExprKind::Unary { op: UnaryOp::Plus | UnaryOp::Minus, operand, .. } => deeper(*operand),
        ExprKind::Field { base, .. } => deeper(*base),
        ExprKind::Binary { op: BinaryOp::Add | BinaryOp::Sub | BinaryOp::Mul, left, right, .. } => {
            deeper(*left) || deeper(*right)
        }
        ExprKind::Binary { op: BinaryOp::Div, left, .. } => deeper(*left),
        ExprKind::Call { args, .. }
            if matches!(shader.callee(id), Some(syntax::symbols::CallTarget::Constructor(_))) =>
        {
            args.iter().any(|arg| deeper(*arg))
        }
        _ => false,
    }
}

/// True for the name of a time that is counted from the start.
fn is_time(name: &str) -> bool {
    let words = words(name);
    let not = [
        "delta",
        "step",
        "dt",
        "scale",
        "speed",
        "life",
        "lifetime",
        "fade",
        "start",
        "end",
        "duration",
        "ratio",
        "factor",
        "offset",
        "rate",
        "loop",
        "cycle",
        "period",
        "day",
        "daytime",
        "deltatime",
        "normalized",
        "percent",
        "of",
    ];
    let is = |word: &String| ["seconds", "elapsed", "clock"].contains(&word.as_str()) || word.ends_with("time");
    words.iter().any(is) && !words.iter().any(|word| not.contains(&word.as_str()))
}

#[cfg(test)]
mod tests {
    use crate::glsl::testing::messages;

    fn found(uniform: &str, body: &str) -> usize {
        let text =
            format!("precision mediump float;\nuniform {uniform};\nvarying vec2 uv;\nvoid main() {{ {body} }}\n");
        messages("N044", "a.frag", &text).len()
    }

    #[test]
    fn a_time_at_mediump_is_found_once() {
        let wave = "gl_FragColor = vec4(sin(uv.x * 4.0 + u_time), fract(u_time), 0.0, 1.0);";
        assert_eq!(found("float u_time", wave), 1);
        assert_eq!(found("highp float u_time", wave), 0);
        assert_eq!(found("float iGlobalTime", "float t = iGlobalTime * 0.5; gl_FragColor = vec4(cos(t + uv.y));"), 1);
    }

    #[test]
    fn other_numbers_are_left_alone() {
        assert_eq!(found("float deltaTime", "gl_FragColor = vec4(sin(deltaTime));"), 0);
        assert_eq!(found("float u_time", "gl_FragColor = vec4(uv * min(u_time, 1.0), 0.0, 1.0);"), 0, "no period");
        assert_eq!(found("float phase", "gl_FragColor = vec4(sin(phase));"), 0);
    }
}
