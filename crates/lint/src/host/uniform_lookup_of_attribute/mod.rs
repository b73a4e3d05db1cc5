//! H001: the location of an attribute is asked for as that of a uniform.

use crate::project::Project;
use crate::rule::{Check, Example, Findings, Japanese, Level, Page, Rule};
use base::diagnostic::{Code, Safety, Severity, message};
use base::text::Edit;

use super::HostFile;
use super::lookup::LookupKind;
use super::program::resolve;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("H001"),
    name: "uniform-lookup-of-attribute",
    severity: Severity::Error,
    level: Level::Default,
    summary: "glGetUniformLocation is asked for a vertex attribute",
    page: Page {
        what: "Reports `glGetUniformLocation` with the name of a vertex attribute (`in` of the vertex stage). \
               It stays silent when a stage of the program is not known and could declare a uniform of that \
               name, unless the location is then used as that of an attribute.",
        why: "Attributes and uniforms have locations of their own. The call gives -1 and raises no GL error; \
              `glVertexAttribPointer` with -1 then fails with GL_INVALID_VALUE, the attribute keeps its \
              constant value (0, 0, 0, 1), and every vertex lands on the same place.",
        bad: &[
            Example { name: "morph.vert", text: SHADER },
            Example {
                name: "morph.cpp",
                text: "void setUp(GLuint program)\n{\n  GLint p1Loc = glGetUniformLocation(program, \"p1\");\n  \
                       glVertexAttribPointer(p1Loc, 3, GL_FLOAT, GL_FALSE, 0, 0);\n}\n",
            },
        ],
        good: &[
            Example { name: "morph.vert", text: SHADER },
            Example {
                name: "morph.cpp",
                text: "void setUp(GLuint program)\n{\n  GLint p1Loc = glGetAttribLocation(program, \"p1\");\n  \
                       glVertexAttribPointer(p1Loc, 3, GL_FLOAT, GL_FALSE, 0, 0);\n}\n",
            },
        ],
        fix: "Calls `glGetAttribLocation` instead. Safe when the location is used by `glVertexAttribPointer`, \
              `glEnableVertexAttribArray` and the like, and by no `glUniform` function: the call gave -1 \
              before, and has one sensible reading. Unsafe otherwise.",
        references: &[
            "OpenGL 3.2 core specification, section 2.11.3 (glGetAttribLocation) and 2.11.4 (glGetUniformLocation)",
        ],
        ja: Japanese {
            summary: "glGetUniformLocation に頂点属性の名前を渡しています",
            what: "頂点属性（頂点シェーダの `in`）の名前を渡した `glGetUniformLocation` を報告します。同じ名前の uniform を宣言しているかもしれない不明なステージがあるときは、得た位置が属性として使われる場合を除いて報告しません。",
            why: "属性と uniform の位置は別々のものです。この呼び出しは GL エラーなしに -1 を返します。-1 を渡した `glVertexAttribPointer` は GL_INVALID_VALUE で失敗し、属性は定数 (0, 0, 0, 1) のままとなり、全頂点が一点に集まります。",
            fix: "`glGetAttribLocation` を呼ぶように直します。位置が `glVertexAttribPointer` や `glEnableVertexAttribArray` などで使われ、`glUniform` 系の関数で使われていなければ safe です。元の呼び出しは -1 を返すだけで、妥当な読み方は一つです。それ以外は unsafe です。",
        },
    },
    check: Check::Host(check),
};

const SHADER: &str = "#version 150 core\nin vec4 p0, p1;\nuniform float t;\nuniform mat4 mc;\n\
                      void main(void)\n{\n  gl_Position = mc * mix(p0, p1, t);\n}\n";

fn check(host: &HostFile, project: &Project, findings: &mut Findings<'_>) {
    for lookup in host.lookups() {
        if lookup.kind != LookupKind::Uniform || lookup.is_reserved() || lookup.wrapped {
            continue;
        }
        let Some(program) = resolve(host, project, &lookup.source) else { continue };
        let name = lookup.base_name();
        let Some((shader, variable)) = program.attribute(name) else { continue };
        let elsewhere = program.uniform(name).is_some() || program.in_block(name);
        if elsewhere || !(program.is_complete() || lookup.feeds.attribute) {
            continue;
        }
        let safety = if lookup.feeds.only_attribute() { Safety::Safe } else { Safety::Unsafe };
        let right = LookupKind::Attribute.function();
        findings.push(
            findings
                .at(&host.file, lookup.function, message!(
                        "`{name}` is an attribute, but is looked up as a uniform",
                        "`{name}` は頂点属性ですが、uniform として位置を求めています"
                    ))
                .with_label(message!("gives -1 here", "ここでは -1 になります"))
                .with_related(&shader.file, variable.name_span, message!("`{name}` is declared `in` here", "`{name}` はここで `in` と宣言されています"))
                .with_why(message!(
                    "glGetUniformLocation knows no attributes: it gives -1 without a GL error, and the \
                     attribute never gets its array",
                    "glGetUniformLocation は頂点属性を知りません。GL エラーなしに -1 を返し、頂点属性に配列が結び付きません"
                ))
                .with_fix(message!("call `{right}`", "`{right}` を呼ぶ"), safety, vec![Edit::replace(lookup.function, right)]),
        );
    }
}
