//! T011: a type or function of HLSL.

use crate::rule::{Check, Level, Pages, Rule};
use base::diagnostic::Safety;
use base::diagnostic::{Code, Diagnostic, Severity, message};
use base::text::Edit;
use reading::ShaderFile;
use reading::hlsl::{Counterpart, counterpart};
use syntax::ast::{Callee, ExprKind};
use syntax::{TokenKind, TokenPlace};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("T011"),
    name: "hlsl-name",
    severity: Severity::Error,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::FrontEnd(complete),
};

fn complete(file: &ShaderFile, told_before: Diagnostic) -> Option<Diagnostic> {
    let shader = &file.shader;
    let name = file.file.slice(told_before.span);
    let found = Diagnostic::new(
        RULE.code,
        RULE.severity,
        &file.file,
        told_before.span,
        message!("`{name}` is a name of HLSL", "`{name}` は HLSL の名前です"),
    )
    .with_label(message!("unknown in GLSL", "GLSL にはない"))
    .with_why(message!("no compiler of GLSL knows this name", "GLSL のコンパイラはこの名前を知りません"));
    Some(match counterpart(name)? {
        Counterpart::Rewritten(en, ja) => found.with_help(message!("{en}", "{ja}")),
        Counterpart::Renamed(to) => {
            let words = shader.tokens().iter().filter(|t| t.kind == TokenKind::Word && t.place != TokenPlace::Inactive);
            let same = words.filter(|t| file.file.slice(t.span) == name);
            let edits = same.map(|t| Edit::replace(t.span, to.clone())).collect();
            found.with_fix(message!("write `{to}`", "`{to}` と書く"), Safety::Safe, edits)
        }
        Counterpart::Clamped => {
            let found =
                found.with_help(message!("write `clamp(x, 0.0, 1.0)`", "`clamp(x, 0.0, 1.0)` と書いてください"));
            let calls = shader.arena().iter().filter_map(|(_, e)| match &e.kind {
                ExprKind::Call { callee: Callee::Name(callee), args } if callee.name == name && args.len() == 1 => {
                    (!e.from_macro).then_some((callee.span, e.span))
                }
                _ => None,
            });
            let edits: Vec<Edit> = calls
                .flat_map(|(callee, call)| [Edit::replace(callee, "clamp"), Edit::insert(call.end - 1, ", 0.0, 1.0")])
                .collect();
            if edits.is_empty() {
                return Some(found);
            }
            found.with_fix(message!("write `clamp`", "`clamp` と書く"), Safety::Safe, edits)
        }
    })
}

#[cfg(test)]
mod tests {
    use super::super::testing::found;
    use base::text::EditList;

    fn fixed(statement: &str) -> (usize, String) {
        let mut text = format!("#version 150 core\nin vec3 v;\nout vec4 c;\nvoid main(void)\n{{\n  {statement}\n}}\n");
        let first = crate::run(&[crate::Input::new(base::text::SourceFile::new("a.frag", text.as_str()))]);
        let count = first.iter().filter(|d| d.severity == base::diagnostic::Severity::Error).count();
        for d in first.iter().filter(|d| d.code.0 == "T011") {
            if let Some(fix) = &d.fix {
                let edits: EditList = fix.edits.iter().cloned().collect();
                if let Ok(edited) = edits.apply(&text) {
                    text = edited.text;
                    break;
                }
            }
        }
        (count, text.lines().nth(5).unwrap().trim().to_owned())
    }

    #[test]
    fn names_of_hlsl_get_those_of_glsl() {
        for (statement, after) in [
            ("c = float4(v, 1.0);", "c = vec4(v, 1.0);"),
            ("float3 a = v; float3 b = a; c = vec4(b, 1.0);", "vec3 a = v; vec3 b = a; c = vec4(b, 1.0);"),
            ("c = lerp(c, c, 0.5) + lerp(c, c, 0.1);", "c = mix(c, c, 0.5) + mix(c, c, 0.1);"),
            ("c = vec4(saturate(v.x + (v.y)));", "c = vec4(clamp(v.x + (v.y), 0.0, 1.0));"),
            ("c.x = frac(v.x);", "c.x = fract(v.x);"),
            ("float2x3 m; c.xyz = v;", "mat3x2 m; c.xyz = v;"),
        ] {
            let (count, text) = fixed(statement);
            assert_eq!((count, text.as_str()), (1, after), "{statement}");
        }
        assert_eq!(fixed("c = mul(mat4(1.0), c);"), (1, "c = mul(mat4(1.0), c);".to_owned()), "no fix");
    }

    #[test]
    fn names_of_the_shader_are_left_alone() {
        let text = "#version 150 core\nout vec4 c;\n#define saturate(x) clamp(x, 0.0, 1.0)\nfloat lerp(float a) { return saturate(a); }\nvoid main(void) { c = vec4(lerp(1.0)); }\n";
        assert!(found("T011", "a.frag", text).is_empty());
    }
}
