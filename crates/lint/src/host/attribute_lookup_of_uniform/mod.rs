//! H002: the location of a uniform is asked for as that of an attribute.

use crate::project::Project;
use crate::rule::{Check, Example, Findings, Japanese, Level, Page, Rule};
use base::diagnostic::{Code, Safety, Severity, message};
use base::text::Edit;

use super::HostFile;
use super::lookup::LookupKind;
use super::program::resolve;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("H002"),
    name: "attribute-lookup-of-uniform",
    severity: Severity::Error,
    level: Level::Default,
    summary: "glGetAttribLocation or glBindAttribLocation is given the name of a uniform",
    page: Page {
        what: "Reports `glGetAttribLocation` and `glBindAttribLocation` with the name of a uniform that is not a \
               vertex attribute as well. It stays silent when the vertex stage is not known.",
        why: "Attributes and uniforms have locations of their own. The look-up gives -1 and raises no GL error; \
              `glUniform` functions ignore the location -1, so that the uniform keeps the value 0.",
        bad: &[
            Example { name: "morph.vert", text: SHADER },
            Example {
                name: "morph.cpp",
                text: "void setTime(GLuint program, float t)\n{\n  GLint tLoc = glGetAttribLocation(program, \"t\");\n  \
                       glUniform1f(tLoc, t);\n}\n",
            },
        ],
        good: &[
            Example { name: "morph.vert", text: SHADER },
            Example {
                name: "morph.cpp",
                text: "void setTime(GLuint program, float t)\n{\n  GLint tLoc = glGetUniformLocation(program, \"t\");\n  \
                       glUniform1f(tLoc, t);\n}\n",
            },
        ],
        fix: "Calls `glGetUniformLocation` instead. Safe when the location is used by `glUniform` functions and by \
              no function for attributes: the call gave -1 before, and has one sensible reading. Unsafe \
              otherwise. There is no fix for `glBindAttribLocation`.",
        references: &[
            "OpenGL 3.2 core specification, section 2.11.3 (glGetAttribLocation) and 2.11.4 (glGetUniformLocation)",
        ],
        ja: Japanese {
            summary: "glGetAttribLocation または glBindAttribLocation に uniform の名前を渡しています",
            what: "頂点属性ではない uniform の名前を渡した `glGetAttribLocation` と `glBindAttribLocation` を報告します。頂点シェーダが分からないときは報告しません。",
            why: "属性と uniform の位置は別々のものです。問い合わせは GL エラーなしに -1 を返し、`glUniform` 系の関数は位置 -1 を無視するので、uniform は 0 のままになります。",
            fix: "`glGetUniformLocation` を呼ぶように直します。位置が `glUniform` 系の関数で使われ、属性用の関数で使われていなければ safe です。それ以外は unsafe です。`glBindAttribLocation` には no fix（修正なし）です。",
        },
    },
    check: Check::Host(check),
};

const SHADER: &str = "#version 150 core\nin vec4 p0, p1;\nuniform float t;\nuniform mat4 mc;\n\
                      void main(void)\n{\n  gl_Position = mc * mix(p0, p1, t);\n}\n";

fn check(host: &HostFile, project: &Project, findings: &mut Findings<'_>) {
    for lookup in host.lookups() {
        if lookup.kind == LookupKind::Uniform || lookup.is_reserved() || lookup.wrapped {
            continue;
        }
        let Some(program) = resolve(host, project, &lookup.source) else { continue };
        let name = lookup.base_name();
        let Some((shader, variable)) = program.uniform(name) else { continue };
        if program.vertex().is_none() || program.attribute(name).is_some() {
            continue;
        }
        let found = findings
            .at(
                &host.file,
                lookup.function,
                message!(
                    "`{name}` is a uniform, but is looked up as an attribute",
                    "`{name}` は uniform ですが、頂点属性として位置を求めています"
                ),
            )
            .with_related(
                &shader.file,
                variable.name_span,
                message!("`{name}` is declared `uniform` here", "`{name}` はここで `uniform` と宣言されています"),
            );
        let right = LookupKind::Uniform.function();
        findings.push(if lookup.kind == LookupKind::BindAttribute {
            found
                .with_label(message!("binds nothing", "何にも結び付きません"))
                .with_why(message!(
                    "glBindAttribLocation of a name that is no attribute has no effect, and raises no GL error",
                    "頂点属性でない名前の glBindAttribLocation は効果がなく、GL エラーにもなりません"
                ))
                .with_help(message!(
                    "remove the call; `{name}` is set with a glUniform function",
                    "この呼び出しを消してください。`{name}` には glUniform 系の関数で値を設定します"
                ))
        } else {
            let safety = if lookup.feeds.only_uniform() { Safety::Safe } else { Safety::Unsafe };
            found
                .with_label(message!("gives -1 here", "ここでは -1 になります"))
                .with_why(message!(
                    "glGetAttribLocation knows no uniforms: it gives -1 without a GL error, and glUniform \
                     functions ignore the location -1",
                    "glGetAttribLocation は uniform を知りません。GL エラーなしに -1 を返し、glUniform 系の関数は位置 -1 を無視します"
                ))
                .with_fix(message!("call `{right}`", "`{right}` を呼ぶ"), safety, vec![Edit::replace(lookup.function, right)])
        });
    }
}
