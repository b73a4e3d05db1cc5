//! N043: the square of a number of pixels, which is larger than numbers of `mediump` are.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Message, Severity, message};
use reading::{Project, ShaderFile};
use syntax::Shader;
use syntax::ast::{BinaryOp, ExprId, ExprKind};
use syntax::precision::Precisions;
use syntax::types::Type;

use super::pixel_stages;
use analysis::forms::{builtin, is_square};
use analysis::pixels::{Pixels, Unit};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("N043"),
    name: "mediump-square",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::ShaderWith(check),
};

fn check(file: &ShaderFile, project: &Project, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    if !shader.has_precisions() {
        return;
    }
    let precisions = Precisions::of(shader);
    let squares: Vec<(ExprId, Square)> = shader
        .arena()
        .iter()
        .filter(|(id, _)| precisions.is_lowered(*id))
        .filter_map(|(id, _)| Some((id, square(shader, id)?)))
        .collect();
    if squares.is_empty() {
        return;
    }
    let pixels = Pixels::of(shader, &pixel_stages::before(file, project));
    for (id, square) in squares {
        let Unit::Known(power, seed) = pixels.unit(square.of(id)) else { continue };
        if power < square.least() {
            continue;
        }
        let Some(seed) = pixels.seed(seed).filter(|seed| !seed.along).map(|seed| seed.name.as_str()) else { continue };
        let what = shader.text_of(id);
        let message: Message = match square {
            Square::Whole => message!(
                "`{what}` is the square of a number of pixels, and overflows at `mediump` beyond 128 of them",
                "`{what}` は画素数の 2 乗で、128 画素を超えると `mediump` で桁あふれします"
            ),
            Square::Inside(_) => message!(
                "`{what}` squares numbers of pixels, and overflows at `mediump` beyond 128 of them",
                "`{what}` は画素数を 2 乗するので、128 画素を超えると `mediump` で桁あふれします"
            ),
        };
        findings.push(
            findings
                .at(&file.file, shader.expr(id).span, message)
                .with_label(message!("taken for pixels because of `{seed}`", "`{seed}` から画素数とみなしています"))
                .with_why(message!(
                    "GLSL ES promises of `mediump` numbers up to 16384, the square of 128; binary16 ends at 65504, the square of 255",
                    "GLSL ES が `mediump` に保証するのは 16384 (128 の 2 乗) までです。binary16 の上限は 65504 (255 の 2 乗) です"
                ))
                .with_help(message!(
                    "divide by the size first, or declare what it is computed from `highp`",
                    "先に大きさで割るか、計算のもとになる値を `highp` で宣言してください"
                )),
        );
    }
}

/// How an expression squares.
#[derive(Clone, Copy)]
enum Square {
    /// It is the square.
    Whole,
    /// It squares the components of this on its way.
    Inside(ExprId),
}

impl Square {
    fn of(self, id: ExprId) -> ExprId {
        match self {
            Self::Whole => id,
            Self::Inside(of) => of,
        }
    }

    fn least(self) -> i32 {
        match self {
            Self::Whole => 2,
            Self::Inside(_) => 1,
        }
    }
}

fn square(shader: &Shader, id: ExprId) -> Option<Square> {
    match &shader.expr(id).kind {
        ExprKind::Binary { op: BinaryOp::Mul, .. } => is_square(shader, id).then_some(Square::Whole),
        ExprKind::Call { args, .. } => match builtin(shader, id, &["dot", "pow", "length", "distance", "normalize"])?.0
        {
            "dot" => Some(Square::Whole),
            "pow" => is_square(shader, id).then_some(Square::Whole),
            // The length of a number is its magnitude.
            _ => args
                .iter()
                .find(|arg| matches!(shader.type_of(**arg), Type::Vector(..)))
                .map(|_| Square::Inside(if args.len() == 1 { args[0] } else { id })),
        },
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use crate::glsl::testing::messages;

    fn found(precision: &str, body: &str) -> usize {
        let text = format!(
            "precision {precision} float;\nuniform vec2 u_resolution;\nuniform vec2 a, b;\nuniform float u_lineWidth;\n\
             varying vec2 v;\nvoid main() {{ {body} }}\n"
        );
        messages("N043", "a.frag", &text).len()
    }

    #[test]
    fn squares_of_pixels_are_found() {
        let all = [
            "float l = length(gl_FragCoord.xy - a); gl_FragColor = vec4(l);",
            "vec2 p = gl_FragCoord.xy - 0.5 * u_resolution; gl_FragColor = vec4(dot(p, p) / u_resolution.x);",
            "gl_FragColor = vec4(clamp(u_lineWidth * 0.5 - distance(v, a), 0.0, 1.0));",
            "vec2 ba = b - a; float d = length(v - ba * clamp(dot(v - a, ba) / dot(ba, ba), 0.0, 1.0) - a);\n\
             gl_FragColor = vec4(clamp((u_lineWidth + 1.0) * 0.5 - d, 0.0, 1.0));",
        ];
        for body in all {
            assert!(found("mediump", body) > 0, "{body}");
            assert_eq!(found("highp", body), 0, "{body}");
        }
    }

    #[test]
    fn shares_of_a_size_are_left_alone() {
        for body in [
            "vec2 p = (gl_FragCoord.xy - 0.5 * u_resolution) / u_resolution.y; gl_FragColor = vec4(length(p));",
            "vec2 p = gl_FragCoord.xy / u_resolution; gl_FragColor = vec4(dot(p, p));",
            "gl_FragColor = vec4(length(v - a));",
            "float s = 1.0 / max(1.0, max(abs(a.x), abs(a.y))); vec2 p = (gl_FragCoord.xy - a) * s;\n\
             gl_FragColor = vec4(dot(p, p));",
            "gl_FragColor = vec4(u_resolution.x * u_resolution.y > 0.0 ? 1.0 : 0.0);",
        ] {
            assert_eq!(found("mediump", body), 0, "{body}");
        }
    }

    #[test]
    fn what_a_phone_reads_is_judged() {
        let text = |p: &str| {
            format!(
                "#ifdef GL_ES\nprecision {p} float;\n#endif\nuniform vec2 m;\n\
                 void main() {{ gl_FragColor = vec4(distance(gl_FragCoord.xy, m)); }}\n"
            )
        };
        assert_eq!(messages("N043", "a.frag", &text("mediump")).len(), 1);
        assert_eq!(messages("N043", "a.frag", &text("highp")).len(), 0);
        assert_eq!(messages("N043", "a.frag", &format!("#version 120\n{}", text("mediump"))).len(), 0);
    }

    #[test]
    fn devices_without_highp_are_judged_on_request() {
        use crate::glsl::testing::{default_count, strict_count};
        let text = |body: &str| {
            format!(
                "#ifdef GL_FRAGMENT_PRECISION_HIGH\nprecision highp float;\n#else\nprecision mediump float;\n#endif\n\
                 uniform vec2 u_dimensions;\nvarying vec2 v;\nvoid main() {{ vec2 p = v * u_dimensions; {body} }}\n"
            )
        };
        let count = |body: &str| {
            let text = text(body);
            (default_count(super::RULE.code, "a.frag", &text), strict_count(super::RULE.code, "a.frag", &text))
        };
        assert_eq!(count("gl_FragColor = vec4(dot(p, p));"), (0, 1));
        assert_eq!(count("vec2 q = p / u_dimensions.x; gl_FragColor = vec4(dot(q, q));"), (0, 0));
    }

    #[test]
    fn what_the_vertex_stage_hands_on_is_known() {
        use crate::{Input, run};
        use base::text::SourceFile;
        let vertex = |scale: &str| {
            format!(
                "precision highp float;\nattribute vec2 p;\nuniform vec2 u_stageSize;\nvarying vec2 v_at;\n\
                 void main() {{ v_at = p * u_stageSize * {scale}; gl_Position = vec4(p, 0.0, 1.0); }}\n"
            )
        };
        let fragment = "precision mediump float;\nvarying vec2 v_at;\nuniform vec2 c;\n\
                        void main() { gl_FragColor = vec4(length(v_at - c)); }\n";
        let count = |scale: &str| {
            let files = [("line.vert", vertex(scale)), ("line.frag", fragment.to_owned())];
            let files = files.map(|(name, text)| Input::new(SourceFile::new(name, text)));
            run(&files).iter().filter(|d| d.code.0 == "N043").count()
        };
        assert_eq!((count("1.0"), count("(1.0 / u_stageSize.y)")), (1, 0));
    }
}
