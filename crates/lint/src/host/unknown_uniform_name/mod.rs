//! H003: a uniform is looked up by a name that no stage declares.

use crate::project::Project;
use crate::rule::{Check, Example, Findings, Japanese, Level, Page, Rule};
use base::diagnostic::{Code, Safety, Severity, message};
use base::text::{Edit, Span};

use super::HostFile;
use super::lookup::LookupKind;
use super::program::resolve;
use super::suggest::{list, list_in_japanese, nearest};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("H003"),
    name: "unknown-uniform-name",
    severity: Severity::Warning,
    level: Level::Default,
    summary: "glGetUniformLocation is given a name that no stage of the program declares",
    page: Page {
        what: "Reports `glGetUniformLocation` with a name that no stage declares as a uniform. It speaks only when \
               all stages of the program are known and read without error, and none has `#if` or `#include`.",
        why: "The call gives -1 and raises no GL error, and `glUniform` functions ignore the location -1: the \
              uniform that was meant keeps the value 0. Spaces and capitals count.",
        bad: &[
            Example { name: "point.vert", text: VERTEX },
            Example { name: "point.frag", text: FRAGMENT },
            Example {
                name: "point.cpp",
                text: "void setMatrix(GLuint program, const GLfloat *m)\n{\n  \
                       glUniformMatrix4fv(glGetUniformLocation(program, \"mvc\"), 1, GL_FALSE, m);\n}\n",
            },
        ],
        good: &[
            Example { name: "point.vert", text: VERTEX },
            Example { name: "point.frag", text: FRAGMENT },
            Example {
                name: "point.cpp",
                text: "void setMatrix(GLuint program, const GLfloat *m)\n{\n  \
                       glUniformMatrix4fv(glGetUniformLocation(program, \"mc\"), 1, GL_FALSE, m);\n}\n",
            },
        ],
        fix: "Writes the one declared name that is nearest to the given one. Unsafe: the nearest name need not be \
              the one that was meant.",
        references: &["OpenGL 3.2 core specification, section 2.11.4 (glGetUniformLocation)"],
        ja: Japanese {
            summary: "glGetUniformLocation に、プログラムのどのステージも宣言していない名前を渡しています",
            what: "どのステージも uniform として宣言していない名前を渡した `glGetUniformLocation` を報告します。プログラムの全ステージが分かり、エラーなく読め、`#if` も `#include` も含まないときだけ報告します。",
            why: "この呼び出しは GL エラーなしに -1 を返し、`glUniform` 系の関数は位置 -1 を無視します。本来の uniform は 0 のままです。空白や大文字・小文字も区別されます。",
            fix: "宣言された名前のうち、最も近いものが一つに決まるときはそれに書き換えます。unsafe: 意図した名前とは限りません。",
        },
    },
    check: Check::Host(check),
};

const VERTEX: &str = "#version 150 core\nin vec4 position;\nuniform mat4 mc;\n\
                      void main(void)\n{\n  gl_Position = mc * position;\n}\n";
const FRAGMENT: &str = "#version 150 core\nout vec4 fc;\nvoid main(void)\n{\n  fc = vec4(1.0);\n}\n";

fn check(host: &HostFile, project: &Project, findings: &mut Findings<'_>) {
    for lookup in host.lookups() {
        if lookup.kind != LookupKind::Uniform || lookup.is_reserved() {
            continue;
        }
        let Some(program) = resolve(host, project, &lookup.source) else { continue };
        let name = lookup.base_name();
        // A block's member has no location either, but its name is known.
        let declared = program.uniform(name).is_some() || program.in_block(name);
        let attribute = program.attribute(name).is_some() && !lookup.wrapped;
        if !program.is_complete() || declared || attribute {
            continue;
        }
        let place = program.names();
        let mut found = findings
            .at(
                &host.file,
                lookup.literal_span(),
                message!("no uniform of {place} is called `{name}`", "{place} に `{name}` という uniform はありません"),
            )
            .with_label(message!("gives -1", "-1 になります"))
            .with_why(message!(
                "glGetUniformLocation gives -1 without a GL error, and glUniform functions ignore the location -1",
                "glGetUniformLocation は GL エラーなしに -1 を返し、glUniform 系の関数は位置 -1 を無視します"
            ));
        if let Some(meant) = nearest(name, program.uniforms()) {
            if let Some((shader, variable)) = program.uniform(meant) {
                found = found.with_related(
                    &shader.file,
                    variable.name_span,
                    message!("`{meant}` is declared here", "`{meant}` はここで宣言されています"),
                );
            }
            let place = Span::new(lookup.name_span.start, lookup.name_span.start + name.len());
            found = found.with_fix(
                message!("write `{meant}`", "`{meant}` と書く"),
                Safety::Unsafe,
                vec![Edit::replace(place, meant)],
            );
        }
        let mut all: Vec<&str> = program.uniforms().collect();
        all.sort_unstable();
        all.dedup();
        findings.push(found.with_help(match all.as_slice() {
            [] => {
                message!(
                    "the program has no uniform outside blocks",
                    "プログラムにはブロックの外の uniform がありません"
                )
            }
            all => {
                let (en, ja) = (list(all), list_in_japanese(all));
                message!("the uniforms are {en}", "uniform は {ja} です")
            }
        }));
    }
}
