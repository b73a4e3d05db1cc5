//! N006: `acos` or `asin` of a number that can be beyond 1.

use crate::project::{Project, ShaderFile};
use crate::range::{Evidence, Observed, Range};
use crate::rule::{Check, Example, Findings, Japanese, Level, Page, Rule};
use base::diagnostic::{Code, Safety, Severity, message};
use syntax::ast::ExprId;

use super::numeric::{around, calls, ends};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("N006"),
    name: "acos-asin-domain",
    severity: Severity::Warning,
    level: Level::Default,
    summary: "the argument of `acos` or `asin` can be beyond -1 or 1",
    page: Page {
        what: "Reports `acos(x)` and `asin(x)` when the text shows that `x` goes beyond -1 or 1, if only by rounding: \
               the scalar product of two normalised vectors, a component of one, a declared range. With `--level \
               strict`, arguments are reported as well whose range goes beyond, but perhaps never comes up. An argument of \
               which nothing is known is not reported.",
        why: "The functions are undefined outside [-1, 1]. A normalised vector is 1 long up to rounding only: the \
              product of two that are parallel may be 1.0000001, and its arc cosine is NaN just where the angle \
              should be 0.",
        bad: &[Example {
            name: "angle.frag",
            text: "#version 330 core\nin vec3 a;\nin vec3 b;\nout vec4 color;\nvoid main()\n{\n  \
                   float angle = acos(dot(normalize(a), normalize(b)));\n  color = vec4(angle);\n}\n",
        }],
        good: &[Example {
            name: "angle.frag",
            text: "#version 330 core\nin vec3 a;\nin vec3 b;\nout vec4 color;\nvoid main()\n{\n  \
                   float angle = acos(clamp(dot(normalize(a), normalize(b)), -1.0, 1.0));\n  \
                   color = vec4(angle);\n}\n",
        }],
        fix: "Writes `clamp(x, -1.0, 1.0)`. Unsafe: where the argument is beyond, the result changes.",
        references: &[
            "GLSL 4.60 specification, section 8.1 \"Angle and Trigonometry Functions\": undefined if |x| > 1",
        ],
        ja: Japanese {
            summary: "`acos` や `asin` の引数が -1 から 1 の範囲を超えることがあります",
            what: "`acos(x)` や `asin(x)` の `x` が、丸めによるわずかな分も含めて -1 から 1 の範囲を超えることが本文から分かる場合に報告します。正規化した 2 つのベクトルの内積、その成分、宣言した範囲などです。`--level strict` では、範囲は超えるものの、実際にその値を取るとは限らない引数も報告します。何も分からない引数は報告しません。",
            why: "これらの関数は [-1, 1] の外では未定義です。正規化したベクトルの長さは丸めの分だけ 1 からずれます。平行な 2 つのベクトルの内積は 1.0000001 になることがあり、角度が 0 になるはずのところで逆余弦が NaN になります。",
            fix: "`clamp(x, -1.0, 1.0)` と書きます。unsafe: 引数が範囲を超えるところで結果が変わります。",
        },
    },
    check: Check::ShaderWith(check),
};

/// From which level on an argument counts as possibly outside, with its range.
pub fn hazard(observed: &Observed, call: ExprId) -> Option<(Level, Range)> {
    let args = observed.visits(call).iter().filter_map(|v| v.operands.first()).flat_map(|v| &v.parts);
    let level = |r: &Range| {
        if r.goes_below(-1.0, Evidence::Nature) || r.goes_above(1.0, Evidence::Nature) {
            Some(Level::Default)
        } else {
            let outside = (r.lo < -1.0 && r.lo.is_finite()) || (r.hi > 1.0 && r.hi.is_finite());
            outside.then_some(Level::Strict)
        }
    };
    args.filter_map(|r| Some((level(r)?, *r))).min_by_key(|(level, _)| *level)
}

fn check(file: &ShaderFile, project: &Project, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let observed = file.observed(project);
    for call in calls(shader, &["acos", "asin"]) {
        let (Some((level, range)), [arg]) = (hazard(&observed, call.id), call.args) else { continue };
        let (name, (lo, hi)) = (call.name, ends(&range));
        let mut found = findings
            .at(
                &file.file,
                shader.expr(*arg).span,
                message!(
                    "the argument of `{name}` can be beyond -1 or 1",
                    "`{name}` の引数が -1 から 1 の範囲を超えることがあります"
                ),
            )
            .with_label(message!("from {lo} to {hi}", "{lo} から {hi} まで"))
            .with_why(message!(
                "`{name}` is undefined there, and most devices give NaN",
                "そこでは `{name}` は未定義で、多くの装置では NaN になります"
            ))
            .with_help(message!("clamp the argument to -1 and 1", "引数を -1 から 1 に制限してください"));
        if let Some(edits) = around(shader, call.id, *arg, "clamp(", ", -1.0, 1.0)") {
            found = found.with_fix(message!("clamp the argument", "引数を制限する"), Safety::Unsafe, edits);
        }
        findings.push_at(level, found);
    }
}

#[cfg(test)]
mod tests {
    use super::super::numeric::testing::{fixed, macro_has_no_fix, rings, silent};
    use super::*;

    #[test]
    fn arguments_beyond_one_are_told() {
        rings(
            "N006",
            Level::Default,
            &[
                "r = acos(dot(normalize(p), normalize(q)));",
                "vec3 d = normalize(p); r = asin(d.y);",
                "r = acos(declared);",
                "r = acos(2.0 * sin(s));",
                "float c = dot(normalize(p), normalize(q)); if (t > 0.0) r = acos(c);",
            ],
        );
        rings("N006", Level::Strict, &["r = asin(sin(s) + cos(s));"]);
    }

    #[test]
    fn others_are_not() {
        silent(
            "N006",
            Level::Heuristic,
            &[
                "r = acos(s);",
                "r = acos(clamp(dot(normalize(p), normalize(q)), -1.0, 1.0));",
                "r = acos(min(max(s, -1.0), 1.0));",
                "r = asin(sin(s));",
                "r = acos(0.5);",
                "r = acos(2.0 * fract(s) - 1.0);",
                "r = acos(texture(image, p.xy).r);",
                "float c = dot(normalize(p), normalize(q)); if (c < 1.0 && c > -1.0) r = acos(c);",
                "float c = dot(normalize(p), normalize(q)); if (abs(c) >= 1.0) { v = q; } else { r = acos(c * s); }",
            ],
        );
    }

    #[test]
    fn the_fix_clamps() {
        assert_eq!(fixed("N006", "r = acos(sin(s) * 2.0);"), "r = acos(clamp(sin(s) * 2.0, -1.0, 1.0));");
        macro_has_no_fix("N006", "acos(2.0 * sin(a))");
    }
}
