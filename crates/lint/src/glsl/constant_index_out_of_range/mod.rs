//! T016: a constant index that no element has.

use crate::project::ShaderFile;
use crate::rule::{Check, Example, Japanese, Level, Page, Rule};
use base::diagnostic::{Code, Diagnostic, Severity};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("T016"),
    name: "constant-index-out-of-range",
    severity: Severity::Error,
    level: Level::Default,
    summary: "a constant index lies outside the array, vector or matrix",
    page: Page {
        what: "Reports constant indices below 0 or not below the number of elements: of arrays, vectors and matrices, and of the inputs of a geometry shader against its input primitive.",
        why: "There is no such element: compilers refuse it, and where one does not, the value is undefined.",
        bad: &[Example {
            name: "a.vert",
            text: "#version 150 core\nin vec3 position;\nuniform mat4 mvp;\nvoid main(void)\n{\n  float last = position[3];\n  gl_Position = mvp * vec4(position, last);\n}\n",
        }],
        good: &[Example {
            name: "a.vert",
            text: "#version 150 core\nin vec3 position;\nuniform mat4 mvp;\nvoid main(void)\n{\n  float last = position[2];\n  gl_Position = mvp * vec4(position, last);\n}\n",
        }],
        fix: "There is no fix: which element is meant is not known.",
        references: &["GLSL 4.60 specification, section 5.7 \"Structure and Array Operations\""],
        ja: Japanese {
            summary: "定数の添字が範囲の外にあります",
            what: "配列・ベクトル・行列、ジオメトリシェーダの入力（入力プリミティブの頂点数が上限）で、0 未満か要素数以上の定数の添字を報告します。",
            why: "その要素はなく、コンパイラに拒否されます。通った場合も値は未定義です。",
            fix: "どの要素のつもりかは分からないので、自動修正はありません（no fix）。",
        },
    },
    check: Check::FrontEnd(complete),
};

fn complete(_: &ShaderFile, found: Diagnostic) -> Option<Diagnostic> {
    Some(found)
}

#[cfg(test)]
mod tests {
    use crate::{Input, run};
    use base::text::SourceFile;

    #[test]
    fn constant_indices_stay_inside() {
        let codes = |s: &str| {
            let text = format!(
                "#version 150\nconst int n = 4;\nuniform mat3 m;\nvoid main() {{ float a[n]; vec3 v = m[0]; {s} gl_Position = vec4(v, a[0]); }}\n"
            );
            run(&[Input::new(SourceFile::new("a.vert", text.as_str()))]).iter().map(|d| d.code.0).collect::<Vec<_>>()
        };
        for wrong in ["a[n] = 1.0;", "a[0] = v[3];", "v = m[3];", "a[-1] = 0.0;", "a[2 * 2] = 0.0;"] {
            assert_eq!(codes(wrong)[..1], ["T016"], "{wrong}");
        }
        for right in ["a[n - 1] = 1.0;", "a[0] = v[2];", "v = m[2];", "for (int i = 0; i < 9; i++) a[i] = 0.0;"] {
            assert!(!codes(right).contains(&"T016"), "{right}");
        }
    }
}
