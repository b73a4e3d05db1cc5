//! V001: `#version` is not the first thing in the text.

use crate::project::ShaderFile;
use crate::rule::{Check, Example, Japanese, Level, Page, Rule};
use base::diagnostic::{Code, Diagnostic, Safety, Severity, message};
use base::text::{Edit, Span};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("V001"),
    name: "missing-or-late-version",
    severity: Severity::Error,
    level: Level::Default,
    summary: "#version does not stand first in the text",
    page: Page {
        what: "Reports a `#version` with anything but blanks and comments before it. A text without `#version` is GLSL 1.10 and is not reported.",
        why: "The version decides how everything before it would have been read: compilers refuse the shader.",
        bad: &[Example {
            name: "a.vert",
            text: "#define SCALE 2.0\n#version 150 core\nvoid main(void)\n{\n  gl_Position = vec4(1.0);\n}\n",
        }],
        good: &[Example {
            name: "a.vert",
            text: "#version 150 core\n#define SCALE 2.0\nvoid main(void)\n{\n  gl_Position = vec4(1.0);\n}\n",
        }],
        fix: "The directive moves to the first line. Safe: the text did not compile, and there is no other place for it.",
        references: &["GLSL 4.60 specification, section 3.3 \"Preprocessor\""],
        ja: Japanese {
            summary: "#version がテキストの先頭にありません",
            what: "空白とコメント以外のものが前にある `#version` を報告します。`#version` のないテキストは GLSL 1.10 とみなし、報告しません。",
            why: "バージョンはそれより前の読み方も決めるため、コンパイラに拒否されます。",
            fix: "ディレクティブを一行目に移します。元はコンパイルできず、置き場所は他にないので safe です。",
        },
    },
    check: Check::FrontEnd(complete),
};

fn complete(file: &ShaderFile, found: Diagnostic) -> Option<Diagnostic> {
    let text = file.file.text();
    let line = file.file.slice(found.span).to_owned();
    let end = text[found.span.end..].find('\n').map_or(text.len(), |n| found.span.end + n + 1);
    // A comment behind the directive stays where it is.
    let alone = text[found.span.end..end].trim().is_empty();
    let delete = if alone { Span::new(found.span.start, end) } else { found.span };
    let edits = vec![Edit::insert(0, format!("{line}\n")), Edit::delete(delete)];
    Some(found.with_fix(message!("move it to the first line", "一行目へ移す"), Safety::Safe, edits))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::glsl::testing::repaired as lint;

    #[test]
    fn the_version_moves_to_the_top() {
        let text = "#define A 1\n#version 150 // why\nvoid main() { gl_Position = vec4(A); }\n";
        let (codes, fixed) = lint("a.vert", text);
        assert_eq!(codes, ["V001"]);
        let (safety, fixed) = fixed.unwrap();
        assert_eq!(
            (safety, fixed.as_str()),
            (Safety::Safe, "#version 150\n#define A 1\n // why\nvoid main() { gl_Position = vec4(A); }\n")
        );
        assert!(lint("a.vert", &fixed).0.is_empty());
        assert!(lint("a.vert", "// c\n\n/* d */ #version 150\nvoid main() { gl_Position = vec4(1); }\n").0.is_empty());
    }
}
