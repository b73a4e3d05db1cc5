//! T033: a colour that is multiplied by one channel of its texture.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use reading::ShaderFile;
use syntax::Shader;
use syntax::ast::{BinaryOp, ExprId, ExprKind};
use syntax::types::{ScalarType, Type};

use analysis::numeric::bare;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("T033"),
    name: "one-channel-of-colour",
    severity: Severity::Warning,
    level: Level::Strict,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Any(check),
};

/// What colours of materials are called.
const COLOURS: [&str; 8] = ["emissive", "emission", "albedo", "colour", "color", "diffuse", "specular", "tint"];

/// The first channel of a call that gives a colour.
fn channel(shader: &Shader, id: ExprId) -> Option<ExprId> {
    let id = bare(shader, id);
    let ExprKind::Field { base, field } = &shader.expr(id).kind else { return None };
    let colour = matches!(shader.type_of(*base), Type::Vector(ScalarType::Float, 3 | 4));
    let called = matches!(shader.expr(bare(shader, *base)).kind, ExprKind::Call { .. });
    (colour && called && ["r", "x"].contains(&field.name.as_str())).then_some(id)
}

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    for (_, expr) in shader.arena().iter().filter(|(_, e)| !e.from_macro) {
        let ExprKind::Binary { op: BinaryOp::Mul, op_span: _, left, right } = expr.kind else { continue };
        let vector = |id: ExprId| matches!(shader.type_of(id), Type::Vector(ScalarType::Float, 3 | 4));
        let found = [(left, right), (right, left)]
            .into_iter()
            .find_map(|(whole, part)| Some((whole, channel(shader, part).filter(|_| vector(whole))?)));
        let Some((whole, part)) = found else { continue };
        let (colour, texel) = (shader.text_of(whole), shader.text_of(part));
        let (whole, lookup) = (colour.to_lowercase(), texel.to_lowercase());
        if !COLOURS.iter().any(|name| whole.contains(name) && lookup.contains(name)) {
            continue;
        }
        findings.push(
            findings
                .at(
                    &file.file,
                    shader.expr(part).span,
                    message!(
                        "`{colour}` is multiplied by the red channel of its texture alone",
                        "`{colour}` に、テクスチャの赤チャンネルだけを掛けています"
                    ),
                )
                .with_label(message!("one channel for all", "全成分に 1 チャンネル"))
                .with_why(message!(
                    "the green and the blue of the texture have no effect on the colour",
                    "テクスチャの緑と青が色に反映されません"
                ))
                .with_help(message!("take `.rgb`", "`.rgb` を使ってください")),
        );
    }
}

#[cfg(test)]
mod tests {
    use crate::wgsl::testing::count;

    fn found(line: &str) -> usize {
        count(
            "T033",
            &format!(
                "struct M {{ emissive: vec3f, metallic: f32 }}\n\
                 fn emissive_texture(p: vec2f) -> vec4f {{ return p.xyxy; }}\n\
                 fn occlusion_texture(p: vec2f) -> vec4f {{ return p.xyxy; }}\n\
                 fn f(m: M, p: vec2f) -> vec3f {{ return {line}; }}\n"
            ),
        )
    }

    #[test]
    fn a_colour_by_one_channel_is_reported() {
        assert_eq!(found("m.emissive * emissive_texture(p).r"), 1);
        assert_eq!(found("emissive_texture(p).x * m.emissive"), 1);
    }

    #[test]
    fn masks_and_whole_colours_are_not() {
        assert_eq!(found("m.emissive * emissive_texture(p).rgb"), 0);
        assert_eq!(found("m.emissive * emissive_texture(p).a"), 0);
        assert_eq!(found("m.emissive * occlusion_texture(p).r"), 0);
        assert_eq!(found("vec3f(m.metallic * emissive_texture(p).r)"), 0);
    }
}
