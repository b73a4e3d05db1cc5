//! W004: the place of a fragment, rounded.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Safety, Severity, message};
use base::text::Edit;
use reading::ShaderFile;
use syntax::ast::{Callee, ExprKind};
use syntax::symbols::CallTarget;
use syntax::wgsl::Module;
use syntax::{BuiltinFunction, Stage};

use analysis::entry::{builtin_value, inputs, root};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("W004"),
    name: "pixel-centre-rounded",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Wgsl(check),
};

fn check(file: &ShaderFile, module: &Module, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let places: Vec<_> = module
        .entry_points
        .iter()
        .filter(|e| e.stage == Stage::Fragment)
        .flat_map(|e| inputs(shader, module, e.item))
        .filter(|i| builtin_value(shader, i.attributes) == Some("position"))
        .collect();
    for (id, expr) in shader.arena().iter() {
        let ExprKind::Call { callee: Callee::Name(name), args } = &expr.kind else { continue };
        let rounds =
            matches!(shader.callee(id), Some(CallTarget::Builtin(c)) if c.function == BuiltinFunction::RoundEven);
        let Some((symbol, members)) = args.first().filter(|_| rounds).and_then(|a| root(shader, *a)) else { continue };
        let mut members = members.into_iter();
        let place = places.iter().find(|p| p.param == symbol && p.member.is_none_or(|m| members.next() == Some(m)));
        // Depth and distance are no places of pixels.
        if place.is_none() || members.next().is_none_or(|swizzle| swizzle.contains(['z', 'w', 'b', 'a'])) {
            continue;
        }
        findings.push(
            findings
                .at(
                    &file.file,
                    expr.span,
                    message!(
                        "`round` of the centre of a pixel gives this pixel or the next",
                        "ピクセルの中心を `round` すると、このピクセルか隣になります"
                    ),
                )
                .with_label(message!("its argument ends in .5", "引数の端数は .5 です"))
                .with_why(message!(
                    "halves are rounded to the even neighbour: 0.5 gives 0, and 1.5 gives 2",
                    "端数 .5 は偶数側に丸められます。0.5 は 0、1.5 は 2 です"
                ))
                .with_fix(
                    message!("write `floor`", "`floor` にする"),
                    Safety::Unsafe,
                    vec![Edit::replace(name.span, "floor")],
                ),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{count, found};

    #[test]
    fn the_position_of_a_fragment_is_known_through_structures() {
        let of = |body: &str| {
            count(
                "W004",
                &format!(
                    "struct In {{ @builtin(position) at: vec4f, @location(0) uv: vec2f, }}\n\
                 @fragment fn main(i: In) -> @location(0) vec4f {{ return vec4f({body}, 0.0, 1.0); }}\n"
                ),
            )
        };
        assert_eq!(of("round(i.at.xy)"), 1);
        assert_eq!(of("vec2f(round(i.at.x), 1.0)"), 1);
        assert_eq!(of("floor(i.at.xy)"), 0);
        assert_eq!(of("round(i.uv)"), 0);
        assert_eq!(of("vec2f(round(i.at.z), 1.0)"), 0);
    }

    #[test]
    fn the_fix_writes_floor() {
        let text = "@fragment fn main(@builtin(position) p: vec4f) -> @location(0) vec4f { return vec4f(round(p.x)); }";
        let fix = found("W004", text)[0].fix.clone().unwrap();
        assert_eq!(
            fix.edits.into_iter().collect::<base::text::EditList>().apply(text).unwrap().text,
            text.replace("round", "floor")
        );
    }
}
