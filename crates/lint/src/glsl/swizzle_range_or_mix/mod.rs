//! T009: a swizzle names components that are not there, or mixes sets of names.

use crate::rule::{Check, Level, Pages, Rule};
use base::diagnostic::{Code, Diagnostic, Severity, message};
use reading::ShaderFile;

use super::compile::explained;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("T009"),
    name: "swizzle-range-or-mix",
    severity: Severity::Error,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::FrontEnd(complete),
};

fn complete(_: &ShaderFile, found: Diagnostic) -> Option<Diagnostic> {
    Some(explained(
        found,
        message!(
            "a swizzle takes one to four components of one set: `xyzw`, `rgba` or `stpq`",
            "スウィズルは `xyzw`・`rgba`・`stpq` のどれか一組から一つから四つの成分を取ります"
        ),
        message!("name components that the vector has", "ベクトルにある成分を指定してください"),
    ))
}

#[cfg(test)]
mod tests {
    use crate::{Input, run};
    use base::text::SourceFile;

    #[test]
    fn components_must_be_there_and_of_one_set() {
        let codes = |e: &str| {
            let text =
                format!("#version 150\nin vec3 p;\nvoid main() {{ vec4 q = vec4(1.0); {e} gl_Position = q; }}\n");
            run(&[Input::new(SourceFile::new("a.vert", text.as_str()))]).iter().map(|d| d.code.0).collect::<Vec<_>>()
        };
        for wrong in ["q.x = p.w;", "q.xy = p.xg;", "q.xx = p.xy;", "q = q.xyzzy;"] {
            assert_eq!(codes(wrong), ["T009"], "{wrong}");
        }
        for right in ["q.x = p.z;", "q.xy = p.xx;", "q.wz = p.rg;", "q = q.stpq;"] {
            assert!(codes(right).is_empty(), "{right}");
        }
    }
}
