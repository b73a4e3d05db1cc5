//! N041: a whole part, fraction or remainder of a number that has no such digits at `mediump`.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use reading::{Project, ShaderFile};
use std::collections::HashMap;

use base::diagnostic::{Code, Message, Severity, message};
use base::text::Span;
use syntax::ast::{BinaryOp, ExprId, ExprKind};
use syntax::interface::Storage;
use syntax::precision::{Precisions, is_lower};
use syntax::symbols::{CallTarget, SymbolId, SymbolKind};
use syntax::types::Type;
use syntax::{Const, Shader, Stage, Token, TokenPlace};

use super::pixel_stages;
use super::walk::declarators;
use analysis::forms::builtin;
use analysis::numeric::bare;
use analysis::pixels::{Pixels, Unit};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("N041"),
    name: "mediump-digits",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::ShaderWith(check),
};

/// A factor beyond which a number between 0 and 1 has no fraction left.
const NO_FRACTION: f32 = 2048.0;

fn check(file: &ShaderFile, project: &Project, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    if !shader.has_precisions() {
        return;
    }
    let precisions = Precisions::of(shader);
    let initial = Initial::of(shader);
    let pixels = Pixels::of(shader, &pixel_stages::before(file, project));
    let whole = ["fract", "floor", "ceil", "mod", "round", "trunc"];
    let mut found = Vec::new();
    for (id, expr) in shader.arena().iter() {
        let ExprKind::Call { args, .. } = &expr.kind else { continue };
        let Some(first) = args.first().copied() else { continue };
        found.extend(scaled_back(shader, &precisions, &pixels, id));
        let takes_digits = builtin(shader, id, &whole).is_some();
        let what = if takes_digits && !precisions.is_lowered(first) {
            // What is computed at `highp` has no more digits than what it is computed from.
            large(shader, &initial, first, 0).filter(|_| from_lowered(shader, &initial, &precisions, first, 0))
        } else if takes_digits {
            large(shader, &initial, first, 0)
                .or_else(|| packed(shader, id, args))
                .or_else(|| scaled(shader, id, first))
                .or_else(|| counted(&pixels, first))
        } else {
            depth(shader, &precisions, id, first).filter(|_| !is_packed(shader, &initial, id))
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
        let places: HashMap<usize, SymbolId> =
            shader.symbols().filter_map(|(id, symbol)| Some((symbol.span?.start, id))).collect();
        declarators(shader, |one| {
            let value = one.initializer.as_ref().map(|value| value.value);
            all.extend(places.get(&one.name.span.start).copied().zip(value));
        });
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

/// `fract(x * 43758.5)`: of a number as large as that no digit behind the point is left.
fn scaled(shader: &Shader, id: ExprId, first: ExprId) -> Option<Message> {
    builtin(shader, id, &["fract"])?;
    let ExprKind::Binary { op: BinaryOp::Mul, left, right, .. } = shader.expr(bare(shader, first)).kind else {
        return None;
    };
    let factor = |id| match shader.fold(id)? {
        Const::Float(value) => Some(value.abs()).filter(|value| *value >= NO_FRACTION),
        _ => None,
    };
    let value = factor(left).xor(factor(right))?;
    Some(message!(
        "the fraction is taken of a number times {value} at `mediump`, which has none beyond 1024",
        "{value} 倍した数の小数部を `mediump` で求めていますが、1024 を超えると小数部はありません"
    ))
}

/// A number that counts pixels, by what it is computed with.
fn counted(pixels: &Pixels<'_>, id: ExprId) -> Option<Message> {
    let Unit::Known(1, seed) = pixels.unit(id) else { return None };
    pixels.varies(id).then_some(())?;
    let seed = pixels.seed(seed)?;
    let name = &seed.name;
    Some(if seed.along {
        message!(
            "the fraction or remainder is taken at `mediump` of a length along a line, as `{name}` is one",
            "`{name}` から線に沿った長さとみなせる数の小数部や剰余を `mediump` で求めています"
        )
    } else {
        message!(
            "the fraction or whole part is taken at `mediump` of a number of pixels, as `{name}` is one",
            "`{name}` から画素数とみなせる数の小数部や整数部を `mediump` で求めています"
        )
    })
}

/// `width - length(p / size) * size` at an edge of one pixel: what was rounded beside 1 becomes as large as the size.
fn scaled_back(shader: &Shader, precisions: &Precisions, pixels: &Pixels<'_>, id: ExprId) -> Option<(Span, Message)> {
    let (_, far) = pixels.edge_of(id)?;
    let mut at = bare(shader, far);
    if let Some(value) = shader.symbol_of(at).and_then(|symbol| pixels.initial(symbol).next()) {
        at = bare(shader, value);
    }
    let (_, size) = pixels.scaled_back(at).filter(|_| precisions.is_lowered(at))?;
    let size = shader.text_of(size);
    Some((
        shader.expr(at).span,
        message!(
            "a distance between shares is multiplied by `{size}` at `mediump`: its step grows to `{size}` / 1024 at an edge of one pixel",
            "割合どうしの距離を `mediump` で `{size}` 倍しています。1 画素の縁で刻みが `{size}` / 1024 になります"
        ),
    ))
}

/// True where a value of `highp` is computed from an input of the stage that is of lower precision itself, or from a quotient
/// that is computed so, such as the step from one texel to the next.
fn from_lowered(shader: &Shader, initial: &Initial, precisions: &Precisions, id: ExprId, depth: usize) -> bool {
    if depth > 8 {
        return false;
    }
    match &shader.expr(id).kind {
        ExprKind::Name(_) => shader.symbol_of(id).is_some_and(|symbol| match shader.symbol(symbol).kind {
            SymbolKind::Global(Storage::In) => {
                shader.stage() == Stage::Fragment && precisions.of_symbol(symbol).is_some_and(is_lower)
            }
            SymbolKind::Local => initial
                .of_symbol(symbol)
                .is_some_and(|value| from_lowered(shader, initial, precisions, value, depth + 1)),
            _ => false,
        }),
        ExprKind::Binary { op: BinaryOp::Div, right, .. }
            if precisions.is_lowered(id) && shader.fold(*right).is_none() =>
        {
            true
        }
        ExprKind::Call { .. } if !matches!(shader.callee(id), Some(syntax::symbols::CallTarget::Constructor(_))) => {
            false
        }
        _ => shader
            .expr(id)
            .children()
            .into_iter()
            .any(|child| from_lowered(shader, initial, precisions, child, depth + 1)),
    }
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
    // Whoever puts the precision of `float` in front of a text may put that of samplers there.
    let states = |token: &Token| token.place == TokenPlace::Text && shader.file().slice(token.span) == "precision";
    if shader.version().span.is_none() && !shader.tokens().iter().any(states) {
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

/// True for a texel of which several components make up one number, which has more digits than each of them: it goes into a
/// scalar product or a function that unpacks it.
fn is_packed(shader: &Shader, initial: &Initial, texel: ExprId) -> bool {
    let of = initial.0.iter().find(|(_, value)| bare(shader, *value) == texel).map(|(symbol, _)| *symbol);
    let is_texel = |id: ExprId| id == texel || (of.is_some() && shader.symbol_of(id) == of);
    let several = |id: ExprId| match &shader.expr(bare(shader, id)).kind {
        ExprKind::Field { base, field } => field.name.len() > 1 && is_texel(bare(shader, *base)),
        _ => is_texel(bare(shader, id)),
    };
    shader.arena().iter().any(|(id, expr)| match &expr.kind {
        ExprKind::Call { args, .. } => {
            let joins =
                matches!(shader.callee(id), Some(CallTarget::User(_))) || builtin(shader, id, &["dot"]).is_some();
            joins && args.iter().any(|arg| several(*arg))
        }
        _ => false,
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
        assert_eq!(fragment(mediump, "highp vec4 s = texture2D(sceneDepth, uv); gl_FragColor = vec4(s.r);"), 1);
        let packed =
            "highp vec4 s = texture2D(sceneDepth, uv); gl_FragColor = vec4(dot(s.ba, vec2(1.0, 1.0 / 255.0)));";
        assert_eq!(fragment(mediump, packed), 0, "two components are one number");
        assert_eq!(fragment(mediump, "highp vec2 m = texture2D(sceneDepth, uv).xy; gl_FragColor = vec4(m, m);"), 1);
        assert_eq!(fragment(mediump, "vec2 p = gl_FragCoord.xy; gl_FragColor = vec4(mod(p.x, 2.0));"), 1);
        assert_eq!(
            fragment(mediump, "gl_FragColor = vec4(floor(OutputSize.x / 200.0));"),
            0,
            "one number for all pixels"
        );
        let noise = "gl_FragColor = vec4(fract(sin(dot(uv, vec2(12.9898, 78.233))) * 43758.5453));";
        assert_eq!((fragment(mediump, noise), fragment("precision highp float;", noise)), (1, 0));
        assert_eq!(fragment(mediump, "gl_FragColor = vec4(fract(uv.x * 4.0));"), 0, "a small number");
        assert_eq!(fragment(mediump, "gl_FragColor = vec4(uv.x * OutputSize.x);"), 0, "no fraction is taken");
    }

    #[test]
    fn highp_is_left_alone() {
        let highp = "precision highp float;\nprecision highp sampler2D;";
        assert_eq!(fragment(highp, "gl_FragColor = vec4(floor(uv.x * OutputSize.x));"), 0);
        assert_eq!(fragment(highp, "gl_FragColor = texture2D(sceneDepth, uv);"), 0);
        assert_eq!(fragment("#version 120", "gl_FragColor = vec4(floor(uv.x * OutputSize.x));"), 0);
        let varying = |p: &str| {
            let text = format!(
                "precision highp float;\nuniform vec2 OutputSize;\nvarying {p} vec2 uv;\n\
                 void main() {{ vec2 t = uv * OutputSize; gl_FragColor = vec4(floor(t.x)); }}\n"
            );
            found("a.frag", &text)
        };
        assert_eq!((varying("mediump"), varying("highp")), (1, 0), "the input has no such digits");
        let step = |p: &str| {
            let text = format!(
                "precision highp float;\nuniform {p} vec2 TextureSize;\nvarying vec2 uv;\n\
                 void main() {{ vec2 texelSize = 1.0 / TextureSize; gl_FragColor = vec4(floor(uv.x / texelSize.x)); }}\n"
            );
            found("a.frag", &text)
        };
        assert_eq!((step("mediump"), step("highp")), (1, 0), "the step has no such digits");
    }

    #[test]
    fn lengths_along_lines_and_scaled_distances_are_found() {
        let dashes = |p: &str| {
            let text = format!(
                "#ifdef GLES\nprecision {p} float;\n#endif\nattribute vec2 a_len;\nattribute vec2 a_p;\nuniform float u_s;\n\
                 varying vec2 v_st;\nvoid main() {{ v_st = vec2(a_len.x / u_s, 1.0); gl_Position = vec4(a_p, 0.0, 1.0); }}\n$$\n\
                 #ifdef GLES\nprecision {p} float;\n#endif\nvarying vec2 v_st;\n\
                 void main() {{ gl_FragColor = vec4(mod(v_st.s, 2.0)); }}\n"
            );
            found("line.glsl", &text)
        };
        assert_eq!((dashes("mediump"), dashes("highp")), (1, 0));
        let scaled = |p: &str, scale: &str| {
            let text = format!(
                "precision {p} float;\nuniform vec4 u_ends;\nuniform float u_lineThickness;\nvarying vec2 v;\nvoid main() {{\n\
                 float size = max(1.0, abs(u_ends.z - u_ends.x));\nvec2 p = (v - u_ends.xy){scale};\n\
                 float far = length(p) * size;\ngl_FragColor = vec4(clamp(u_lineThickness * 0.5 - far, 0.0, 1.0));\n\
                 vec2 at = v / u_viewportSize - u_ends.xy / u_viewportSize;\ngl_FragColor.r += at.x;\n}}\n"
            );
            found("a.frag", &text.replace("uniform vec4 u_ends;", "uniform vec4 u_ends;\nuniform vec2 u_viewportSize;"))
        };
        assert_eq!((scaled("mediump", " / size"), scaled("highp", " / size"), scaled("mediump", "")), (1, 0, 0));
    }

    #[test]
    fn bits_of_an_attribute_are_found() {
        let text = |p: &str| {
            format!("precision {p} float;\nattribute vec4 a;\nvoid main() {{ gl_Position = vec4(mod(a.z, 4.0)); }}\n")
        };
        assert_eq!((found("a.vert", &text("mediump")), found("a.vert", &text("highp"))), (1, 0));
    }
}
