//! H007: more components than the attribute has.

use super::HostFile;
use super::attributes::attributes;
use crate::project::Project;
use crate::rule::{Check, Example, Findings, Japanese, Level, Page, Rule};
use base::diagnostic::{Code, Severity, message};
use syntax::types::Type;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("H007"),
    name: "attrib-size-mismatch",
    severity: Severity::Warning,
    level: Level::Strict,
    summary: "glVertexAttribPointer gives more components than the attribute has, or an impossible number",
    page: Page {
        what: "Reports literal sizes above the number of components of the attribute, and sizes that are not 1 to 4. Fewer components are filled up with (0, 0, 0, 1), which is often meant, and stay silent.",
        why: "Components beyond those of the attribute are read and thrown away; a size outside 1 to 4 is GL_INVALID_VALUE. Often the size or the declaration is wrong.",
        bad: &[
            Example {
                name: "lamp.vert",
                text: "#version 330 core\nlayout(location = 0) in vec3 position;\nlayout(location = 1) in int material;\nflat out int m;\nvoid main(void)\n{\n  m = material;\n  gl_Position = vec4(position, 1.0);\n}\n",
            },
            Example {
                name: "lamp.frag",
                text: "#version 330 core\nflat in int m;\nout vec4 fc;\nvoid main(void)\n{\n  fc = vec4(m);\n}\n",
            },
            Example {
                name: "lamp.cpp",
                text: "void setUp(const GLfloat *m)\n{\n  GLuint program = load(\"lamp.vert\", \"lamp.frag\");\n  GLint place = glGetAttribLocation(program, \"position\");\n  glVertexAttribPointer(place, 4, GL_FLOAT, GL_FALSE, 0, 0);\n}\n",
            },
        ],
        good: &[
            Example {
                name: "lamp.vert",
                text: "#version 330 core\nlayout(location = 0) in vec3 position;\nlayout(location = 1) in int material;\nflat out int m;\nvoid main(void)\n{\n  m = material;\n  gl_Position = vec4(position, 1.0);\n}\n",
            },
            Example {
                name: "lamp.frag",
                text: "#version 330 core\nflat in int m;\nout vec4 fc;\nvoid main(void)\n{\n  fc = vec4(m);\n}\n",
            },
            Example {
                name: "lamp.cpp",
                text: "void setUp(const GLfloat *m)\n{\n  GLuint program = load(\"lamp.vert\", \"lamp.frag\");\n  GLint place = glGetAttribLocation(program, \"position\");\n  glVertexAttribPointer(place, 3, GL_FLOAT, GL_FALSE, 0, 0);\n}\n",
            },
        ],
        fix: "There is no fix: the size, the declaration or the data may be wrong.",
        references: &[
            "OpenGL 3.3 core specification, section 2.8 (Vertex Arrays): size is 1 to 4; missing components are (0, 0, 0, 1)",
        ],
        ja: Japanese {
            summary: "glVertexAttribPointer の成分数が頂点属性より多いか、あり得ない数です",
            what: "頂点属性の成分数より大きい、または 1 から 4 でないリテラルの成分数を報告します。少ない成分は (0, 0, 0, 1) で補われ、意図的であることが多いので報告しません。",
            why: "頂点属性にない成分は読まれて捨てられます。1 から 4 でない成分数は GL_INVALID_VALUE になります。成分数か宣言が間違っていることが多いです。",
            fix: "no fix（修正なし）: 成分数、宣言、データのどれが間違いか分かりません。",
        },
    },
    check: Check::Host(check),
};

fn check(host: &HostFile, project: &Project, findings: &mut Findings<'_>) {
    for pointer in attributes(host, project) {
        let Some(place) = pointer.arguments.get(1).copied() else { continue };
        let Ok(size) = host.file.slice(place).parse::<usize>() else { continue };
        let ty = &pointer.variable.ty;
        let has = match ty {
            Type::Scalar(_) => 1,
            Type::Vector(_, n) => usize::from(*n),
            Type::Matrix(_, _, rows) => usize::from(*rows),
            Type::Array(..) | Type::Error | Type::Void | Type::Opaque(_) | Type::Struct(_) => continue,
        };
        if (1..=has).contains(&size) {
            continue;
        }
        let (name, ty) = (&pointer.variable.name, ty.to_string());
        findings.push(
            findings
                .at(
                    &host.file,
                    place,
                    message!(
                        "{size} components are given to `{name}`, which is `{ty}`",
                        "`{ty}` の `{name}` に {size} 成分を渡しています"
                    ),
                )
                .with_label(message!("{has} are used", "使われるのは {has} 成分です"))
                .with_related(
                    &pointer.shader.file,
                    pointer.variable.name_span,
                    message!("declared here", "ここで宣言されています"),
                )
                .with_why(message!(
                    "components that the attribute does not have are thrown away, and a size has to be 1 to 4",
                    "頂点属性にない成分は捨てられ、成分数は 1 から 4 でなければなりません"
                ))
                .with_help(message!(
                    "give {has}, or declare the attribute with {size}",
                    "{has} を渡すか、属性を {size} 成分で宣言してください"
                )),
        );
    }
}
