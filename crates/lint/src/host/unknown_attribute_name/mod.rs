//! H004: an attribute is looked up by a name that the vertex stage does not declare.

use crate::project::Project;
use crate::rule::{Check, Example, Findings, Japanese, Level, Page, Rule};
use base::diagnostic::{Code, Safety, Severity, message};
use base::text::Edit;

use super::HostFile;
use super::lookup::LookupKind;
use super::program::resolve;
use super::suggest::{list, list_in_japanese, nearest};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("H004"),
    name: "unknown-attribute-name",
    severity: Severity::Error,
    level: Level::Default,
    summary: "glGetAttribLocation is given a name that the vertex stage does not declare",
    page: Page {
        what: "Reports `glGetAttribLocation` with a name that is neither an attribute of the vertex stage nor a \
               uniform (H002 reports that). It speaks only when the vertex stage is known, was read without \
               error and has no `#if` or `#include`. For `glBindAttribLocation`, which many programs call with \
               names for several shaders, it speaks only when one attribute's name is nearly the given one.",
        why: "The call gives -1 and raises no GL error. `glVertexAttribPointer` with -1 fails with \
              GL_INVALID_VALUE, and the attribute that was meant keeps its constant value (0, 0, 0, 1).",
        bad: &[
            Example { name: "grid.vert", text: SHADER },
            Example {
                name: "grid.cpp",
                text: "void setUp(GLuint program)\n{\n  GLint loc = glGetAttribLocation(program, \"p1\");\n  \
                       glVertexAttribPointer(loc, 2, GL_FLOAT, GL_FALSE, 0, 0);\n}\n",
            },
        ],
        good: &[
            Example { name: "grid.vert", text: SHADER },
            Example {
                name: "grid.cpp",
                text: "void setUp(GLuint program)\n{\n  GLint loc = glGetAttribLocation(program, \"parameter\");\n  \
                       glVertexAttribPointer(loc, 2, GL_FLOAT, GL_FALSE, 0, 0);\n}\n",
            },
        ],
        fix: "Writes the one attribute that is nearest to the given name, or else the only attribute there is, \
              unless the file looks that up as well. Unsafe: it need not be the one that was meant.",
        references: &["OpenGL 3.2 core specification, section 2.11.3 (glGetAttribLocation, glBindAttribLocation)"],
        ja: Japanese {
            summary: "glGetAttribLocation に、頂点シェーダが宣言していない名前を渡しています",
            what: "頂点属性でも uniform でもない名前（uniform は H002）を渡した `glGetAttribLocation` を報告します。頂点シェーダが分かり、エラーなく読め、`#if` も `#include` も含まないときだけ報告します。`glBindAttribLocation` は複数のシェーダ用の名前で呼ばれることが多いので、よく似た属性名が一つあるときだけ報告します。",
            why: "この呼び出しは GL エラーなしに -1 を返します。-1 を渡した `glVertexAttribPointer` は GL_INVALID_VALUE で失敗し、本来の属性は定数 (0, 0, 0, 1) のままです。",
            fix: "最も近い属性名が一つに決まるとき、または属性が一つしかないときは、その名前に書き換えます（その属性が別に問い合わせられている場合を除く）。unsafe: 意図した名前とは限りません。",
        },
    },
    check: Check::Host(check),
};

const SHADER: &str = "#version 150 core\nin vec2 parameter;\nvoid main(void)\n{\n  \
                      gl_Position = vec4(parameter, 0.0, 1.0);\n}\n";

fn check(host: &HostFile, project: &Project, findings: &mut Findings<'_>) {
    let all = host.lookups();
    for lookup in all {
        if lookup.kind == LookupKind::Uniform || lookup.is_reserved() {
            continue;
        }
        let Some(program) = resolve(host, project, &lookup.source) else { continue };
        let Some(vertex) = program.vertex() else { continue };
        let interface = vertex.shader.interface();
        let name = lookup.base_name();
        if interface.input(name).is_some() || program.uniform(name).is_some() || program.in_block(name) {
            continue;
        }
        let taken = |v: &str| all.iter().any(|l| l.kind != LookupKind::Uniform && l.base_name() == v);
        let names: Vec<&str> = interface.inputs.iter().map(|v| v.name.as_str()).collect();
        let free: Vec<&str> = names.iter().copied().filter(|n| !taken(n)).collect();
        let near = nearest(name, free.iter().copied());
        if lookup.kind == LookupKind::BindAttribute && near.is_none() {
            continue;
        }
        let only = if names.len() == 1 { free.first().copied() } else { None };
        let place = vertex.file.name();
        let label = if lookup.kind == LookupKind::Attribute {
            message!("gives -1", "-1 になります")
        } else {
            message!("binds nothing", "何にも結び付きません")
        };
        let mut found = findings
            .at(&host.file, lookup.literal_span(), message!("no attribute of {place} is called `{name}`", "{place} に `{name}` という頂点属性はありません"))
            .with_label(label)
            .with_why(match lookup.kind {
                LookupKind::BindAttribute => message!(
                    "glBindAttribLocation of a name that is no attribute has no effect",
                    "頂点属性でない名前の glBindAttribLocation は効果がありません"
                ),
                LookupKind::Attribute | LookupKind::Uniform => message!(
                    "glGetAttribLocation gives -1 without a GL error, and glVertexAttribPointer refuses the location -1",
                    "glGetAttribLocation は GL エラーなしに -1 を返し、glVertexAttribPointer は位置 -1 を受け付けません"
                ),
            })
            .with_help(match names.as_slice() {
                [] => message!("{place} has no attribute", "{place} に頂点属性はありません"),
                [one] => message!("the only attribute is `{one}`", "頂点属性は `{one}` だけです"),
                all => {
                    let (en, ja) = (list(all), list_in_japanese(all));
                    message!("the attributes are {en}", "頂点属性は {ja} です")
                }
            });
        if let Some(meant) = near.or(only) {
            if let Some(variable) = interface.input(meant) {
                found = found.with_related(
                    &vertex.file,
                    variable.name_span,
                    message!("`{meant}` is declared here", "`{meant}` はここで宣言されています"),
                );
            }
            let edit = Edit::replace(lookup.name_span, meant);
            found = found.with_fix(message!("write `{meant}`", "`{meant}` と書く"), Safety::Unsafe, vec![edit]);
        }
        findings.push(found);
    }
}
