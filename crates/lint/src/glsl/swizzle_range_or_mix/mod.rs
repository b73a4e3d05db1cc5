//! T009: a swizzle names components that are not there, or mixes sets of names.

use crate::project::ShaderFile;
use crate::rule::{Check, Example, Japanese, Level, Page, Rule};
use base::diagnostic::{Code, Diagnostic, Severity, message};

use super::compile::explained;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("T009"),
    name: "swizzle-range-or-mix",
    severity: Severity::Error,
    level: Level::Default,
    summary: "a swizzle names components that are not there, or mixes sets of names",
    page: Page {
        what: "Reports components beyond the size of a vector (`v3.w`), names of two sets in one swizzle (`.xg`), more than four components, and a component that is named twice where it is written.",
        why: "There is no such component, or no single place to write to: the shader does not compile.",
        bad: &[Example {
            name: "a.vert",
            text: "#version 150 core\nin vec3 position;\nuniform mat4 mvp;\nvoid main(void)\n{\n  gl_Position = mvp * vec4(position.xyw, 1.0);\n}\n",
        }],
        good: &[Example {
            name: "a.vert",
            text: "#version 150 core\nin vec3 position;\nuniform mat4 mvp;\nvoid main(void)\n{\n  gl_Position = mvp * vec4(position.xyz, 1.0);\n}\n",
        }],
        fix: "There is no fix: which component is meant is not known.",
        references: &["GLSL 4.60 specification, section 5.5 \"Vector and Scalar Components and Length\""],
        ja: Japanese {
            summary: "存在しない成分や、混在した名前のスウィズルです",
            what: "ベクトルの大きさを超える成分（`v3.w`）、二つの組の名前の混在（`.xg`）、四つを超える成分、書き込み先で重複した成分を報告します。",
            why: "その成分がないか、書き込む場所が一つに決まらないため、コンパイルできません。",
            fix: "どの成分のつもりかは分からないので、自動修正はありません（no fix）。",
        },
    },
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
