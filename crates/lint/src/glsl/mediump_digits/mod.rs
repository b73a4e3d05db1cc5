//! N041: a whole part, fraction or remainder of a number that has no such digits at `mediump`.

use crate::project::ShaderFile;
use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Message, Severity, message};
use syntax::ast::{BinaryOp, ExprId, ExprKind};
use syntax::interface::Storage;
use syntax::precision::Precisions;
use syntax::symbols::{SymbolId, SymbolKind};
use syntax::types::Type;
use syntax::{Const, Shader, Stage};

use super::forms::builtin;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("N041"),
    name: "mediump-digits",
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
    let initial = Initial::of(shader);
    let whole = ["fract", "floor", "ceil", "mod", "round", "trunc"];
    let mut found = Vec::new();
    for (id, expr) in shader.arena().iter() {
        let ExprKind::Call { args, .. } = &expr.kind else { continue };
        let Some(first) = args.first().copied() else { continue };
        let what = if builtin(shader, id, &whole).is_some() && precisions.is_lowered(first) {
            large(shader, &initial, first, 0).or_else(|| packed(shader, id, args))
        } else {
            depth(shader, &precisions, id, first)
        };
        found.extend(what.map(|what| (expr.span, what)));
    }
    // The outer one of two operations on the same number says it.
    let spans: Vec<_> = found.iter().map(|(span, _)| *span).collect();
    let inner =
        |span: base::text::Span| spans.iter().any(|of| *of != span && of.start <= span.start && span.end <= of.end);
    for (span, what) in found.into_iter().filter(|(span, _)| !inner(*span)) {
        findings.push(
            findings
                .at(&file.file, span, what)
                .with_label(message!("computed at `mediump` or `lowp`", "`mediump` か `lowp` で計算"))
                .with_why(message!(
                    "GLSL ES promises 11 bits of `mediump`: beyond 1024 no fraction is left, beyond 2048 no odd number",
                    "GLSL ES が `mediump` に保証するのは 11 ビットです。1024 を超えると小数部が、2048 を超えると奇数が表せません"
                ))
                .with_help(message!(
                    "declare `highp` what it is computed from",
                    "計算のもとになる値を `highp` で宣言してください"
                )),
        );
    }
}

/// What variables are initialised with, where that is their only value.
struct Initial(Vec<(SymbolId, ExprId)>);

impl Initial {
    fn of(shader: &Shader) -> Self {
        let mut all = Vec::new();
        for (_, expr) in shader.arena().iter() {
            if let ExprKind::Assign { op: None, target, value, .. } = &expr.kind
                && let Some(symbol) = shader.symbol_of(*target)
            {
                all.push((symbol, *value));
            }
        }
        for (id, symbol) in shader.symbols() {
            all.extend(symbol.initializer.map(|value| (id, value)));
        }
        Self(all)
    }

    fn of_symbol(&self, symbol: SymbolId) -> Option<ExprId> {
        let mut values = self.0.iter().filter(|(of, _)| *of == symbol);
        let only = values.next()?;
        values.next().is_none().then_some(only.1)
    }
}

/// A number that counts pixels of a window or texels of a texture.
fn large(shader: &Shader, initial: &Initial, id: ExprId, depth: usize) -> Option<Message> {
    if depth > 8 {
        return None;
    }
    let deeper = |id| large(shader, initial, id, depth + 1);
    match &shader.expr(id).kind {
        ExprKind::Name(name) if name == "gl_FragCoord" => Some(message!(
            "the fraction or whole part of a pixel's coordinate is taken of `gl_FragCoord` at `mediump`",
            "`gl_FragCoord` の小数部や整数部を `mediump` で求めています"
        )),
        ExprKind::Name(_) => initial.of_symbol(shader.symbol_of(id)?).and_then(deeper),
        ExprKind::Paren(inner) | ExprKind::Field { base: inner, .. } | ExprKind::Index { base: inner, .. } => {
            deeper(*inner)
        }
        ExprKind::Unary { operand, .. } => deeper(*operand),
        ExprKind::Binary { op: BinaryOp::Mul, left, right, .. } => {
            let count = |id| size_of(shader, id);
            // A coordinate from 0 to 1 times a number of texels.
            let texels = count(*left)
                .filter(|_| varies(shader, *right))
                .or_else(|| count(*right).filter(|_| varies(shader, *left)));
            match texels {
                Some(name) => Some(message!(
                    "the fraction or whole part is taken of a coordinate times `{name}` at `mediump`",
                    "座標と `{name}` の積の小数部や整数部を `mediump` で求めています"
                )),
                None => deeper(*left).or_else(|| deeper(*right)),
            }
        }
        ExprKind::Binary { op: BinaryOp::Div, left, right, .. } => {
            let texel = step_of(shader, *right).filter(|_| varies(shader, *left));
            match texel {
                Some(name) => Some(message!(
                    "the fraction or whole part is taken of a coordinate divided by `{name}` at `mediump`",
                    "座標を `{name}` で割った値の小数部や整数部を `mediump` で求めています"
                )),
                None => deeper(*left),
            }
        }
        ExprKind::Binary { op: BinaryOp::Add | BinaryOp::Sub, left, right, .. } => {
            deeper(*left).or_else(|| deeper(*right))
        }
        ExprKind::Call { args, .. } => {
            let keeps = builtin(shader, id, &["floor", "abs", "max", "min", "clamp"]).is_some()
                || matches!(shader.callee(id), Some(syntax::symbols::CallTarget::Constructor(_)));
            if keeps { args.iter().find_map(|&arg| deeper(arg)) } else { None }
        }
        _ => None,
    }
}

/// The name of a uniform that counts pixels or texels, with a swizzle or without.
fn size_of(shader: &Shader, id: ExprId) -> Option<String> {
    named(
        shader,
        id,
        &["size", "resolution", "dimension", "viewport"],
        &["texelsize", "pixelsize", "invsize", "rcpsize"],
    )
}

/// The name of a uniform or variable that is the step from one texel to the next.
fn step_of(shader: &Shader, id: ExprId) -> Option<String> {
    named(shader, id, &["texelsize", "pixelsize", "texel"], &[])
}

fn named(shader: &Shader, id: ExprId, parts: &[&str], none: &[&str]) -> Option<String> {
    match &shader.expr(id).kind {
        ExprKind::Name(name) => {
            let symbol = shader.symbol(shader.symbol_of(id)?);
            let plain: String = name.chars().filter(|c| *c != '_').collect::<String>().to_lowercase();
            let fits = parts.iter().any(|part| plain.contains(part)) && !none.iter().any(|part| plain.contains(part));
            (fits && symbol.value.is_none()).then(|| name.clone())
        }
        ExprKind::Paren(inner) => named(shader, *inner, parts, none),
        ExprKind::Field { base, .. } => named(shader, *base, parts, none),
        _ => None,
    }
}

/// True for what is computed from what a stage gets for each vertex or pixel.
fn varies(shader: &Shader, id: ExprId) -> bool {
    match &shader.expr(id).kind {
        ExprKind::Name(_) => shader.symbol_of(id).is_some_and(|symbol| {
            matches!(
                shader.symbol(symbol).kind,
                SymbolKind::Global(Storage::In) | SymbolKind::Local | SymbolKind::Param(_)
            )
        }),
        _ => shader.expr(id).children().into_iter().any(|child| varies(shader, child)),
    }
}

/// `mod(attribute, 2.0)`: bits that are packed into a whole number.
fn packed(shader: &Shader, id: ExprId, args: &[ExprId]) -> Option<Message> {
    if shader.stage() != Stage::Vertex || builtin(shader, id, &["mod"]).is_none() {
        return None;
    }
    let Some(Const::Float(base)) = shader.fold(*args.get(1)?) else { return None };
    let power = (2.0..=256.0).contains(&base) && base.log2().fract() == 0.0;
    let symbol = attribute(shader, args[0]).filter(|_| power)?;
    let name = &shader.symbol(symbol).name;
    Some(message!(
        "the low bits of the attribute `{name}` are taken at `mediump`",
        "頂点属性 `{name}` の下位ビットを `mediump` で取り出しています"
    ))
}

fn attribute(shader: &Shader, id: ExprId) -> Option<SymbolId> {
    match &shader.expr(id).kind {
        ExprKind::Name(_) => {
            let symbol = shader.symbol_of(id)?;
            let info = shader.symbol(symbol);
            match info.kind {
                SymbolKind::Global(Storage::In) => Some(symbol),
                SymbolKind::Local => attribute(shader, Initial::of(shader).of_symbol(symbol)?),
                _ => None,
            }
        }
        ExprKind::Paren(inner) | ExprKind::Field { base: inner, .. } => attribute(shader, *inner),
        ExprKind::Call { args, .. } if builtin(shader, id, &["abs", "floor"]).is_some() => {
            attribute(shader, *args.first()?)
        }
        _ => None,
    }
}

/// A depth that is read through a sampler of `lowp`, the default: 8 bits.
fn depth(shader: &Shader, precisions: &Precisions, id: ExprId, sampler: ExprId) -> Option<Message> {
    if !matches!(shader.type_of(sampler), Type::Opaque(_)) || !precisions.is_lowered(sampler) {
        return None;
    }
    let text = shader.text_of(sampler).to_lowercase();
    let names_depth = text.contains("depth") || text.contains("shadowmap");
    let decodes = || comment_names_depth(shader, sampler);
    (builtin(shader, id, &["texture2D", "texture", "textureCube", "texture2DLod", "textureLod"]).is_some()
        && (names_depth || decodes()))
    .then(|| {
        message!(
            "a depth is read through a sampler of less than `highp`, which may give 8 bits of it",
            "`highp` でないサンプラーから深度を読んでいます。8 ビットしか得られないことがあります"
        )
    })
}

/// The declaration of the sampler says in a comment that it is a depth.
fn comment_names_depth(shader: &Shader, sampler: ExprId) -> bool {
    let Some(span) = shader.symbol_of(sampler).and_then(|symbol| shader.symbol(symbol).span) else { return false };
    shader.comments().iter().any(|comment| {
        let between = comment.span.start.checked_sub(span.end).filter(|gap| *gap < 64);
        between.is_some()
            && !shader.file().slice(base::text::Span::new(span.end, comment.span.start)).contains('\n')
            && shader.file().slice(comment.span).to_lowercase().contains("depth")
    })
}

#[cfg(test)]
mod tests {
    use crate::glsl::testing::messages;

    fn found(name: &str, text: &str) -> usize {
        messages("N041", name, text).len()
    }

    fn fragment(head: &str, body: &str) -> usize {
        let all = format!(
            "{head}\nuniform vec2 OutputSize;\nuniform vec2 texelSize;\nuniform sampler2D sceneDepth;\nvarying vec2 uv;\n\
             void main() {{ {body} }}\n"
        );
        found("a.frag", &all)
    }

    #[test]
    fn digits_that_are_not_there_are_found() {
        let mediump = "precision mediump float;";
        assert_eq!(fragment(mediump, "gl_FragColor = vec4(fract(gl_FragCoord.x * 0.5));"), 1);
        assert_eq!(fragment(mediump, "gl_FragColor = vec4(fract(floor(uv.x * OutputSize.x) * -0.5));"), 1);
        assert_eq!(fragment(mediump, "gl_FragColor = vec4(floor(uv.x / texelSize.x));"), 1);
        assert_eq!(fragment(mediump, "gl_FragColor = texture2D(sceneDepth, uv);"), 1);
        assert_eq!(fragment(mediump, "gl_FragColor = vec4(fract(uv.x * 4.0));"), 0, "a small number");
        assert_eq!(fragment(mediump, "gl_FragColor = vec4(uv.x * OutputSize.x);"), 0, "no fraction is taken");
    }

    #[test]
    fn highp_is_left_alone() {
        let highp = "precision highp float;\nprecision highp sampler2D;";
        assert_eq!(fragment(highp, "gl_FragColor = vec4(floor(uv.x * OutputSize.x));"), 0);
        assert_eq!(fragment(highp, "gl_FragColor = texture2D(sceneDepth, uv);"), 0);
        assert_eq!(fragment("#version 120", "gl_FragColor = vec4(floor(uv.x * OutputSize.x));"), 0);
    }

    #[test]
    fn bits_of_an_attribute_are_found() {
        let text = |p: &str| {
            format!("precision {p} float;\nattribute vec4 a;\nvoid main() {{ gl_Position = vec4(mod(a.z, 4.0)); }}\n")
        };
        assert_eq!((found("a.vert", &text("mediump")), found("a.vert", &text("highp"))), (1, 0));
    }
}
