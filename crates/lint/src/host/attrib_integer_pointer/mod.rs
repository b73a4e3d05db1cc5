//! H008: integer attributes and pointers of floats.

use super::HostFile;
use super::attributes::attributes;
use crate::project::Project;
use crate::rule::{Check, Example, Findings, Japanese, Level, Page, Rule};
use base::diagnostic::{Code, Safety, Severity, message};
use base::text::{Edit, Span};
use syntax::types::ScalarType;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("H008"),
    name: "attrib-integer-pointer",
    severity: Severity::Error,
    level: Level::Default,
    summary: "an integer attribute gets its array from glVertexAttribPointer, or a float one from glVertexAttribIPointer",
    page: Page {
        what: "Reports `glVertexAttribPointer` for attributes of integers and `glVertexAttribIPointer` for attributes of floats. The attribute is known by its look-up, or by `layout(location = …)` in a file about one program.",
        why: "`glVertexAttribPointer` converts to float, whatever the type of the data; the bits of a float reach the integer attribute, or undefined values. The specification leaves them undefined, and no GL error tells.",
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
                text: "void setUp(const GLfloat *m)\n{\n  GLuint program = load(\"lamp.vert\", \"lamp.frag\");\n  glVertexAttribPointer(1, 1, GL_INT, GL_FALSE, 0, 0);\n}\n",
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
                text: "void setUp(const GLfloat *m)\n{\n  GLuint program = load(\"lamp.vert\", \"lamp.frag\");\n  glVertexAttribIPointer(1, 1, GL_INT, 0, 0);\n}\n",
            },
        ],
        fix: "Calls `glVertexAttribIPointer`, without the argument `normalized`, where the data are integers. Unsafe: the values change.",
        references: &[
            "OpenGL 3.3 core specification, section 2.7 (Vertex Specification): the values are undefined when the types do not match",
        ],
        ja: Japanese {
            summary: "整数の頂点属性に glVertexAttribPointer、または浮動小数点の属性に glVertexAttribIPointer を使っています",
            what: "整数の頂点属性に対する `glVertexAttribPointer` と、浮動小数点の属性に対する `glVertexAttribIPointer` を報告します。属性は、位置の問い合わせ、または一つのプログラムだけを扱うファイルでは `layout(location = …)` から求めます。",
            why: "`glVertexAttribPointer` はデータの型にかかわらず float に変換します。整数の属性には float のビット列や不定な値が届きます。仕様では不定で、GL エラーにもなりません。",
            fix: "データが整数のときは、引数 `normalized` を除いて `glVertexAttribIPointer` を呼ぶように直します。値が変わるので unsafe です。",
        },
    },
    check: Check::Host(check),
};

fn check(host: &HostFile, project: &Project, findings: &mut Findings<'_>) {
    const WHOLE: &[&str] =
        &["GL_BYTE", "GL_UNSIGNED_BYTE", "GL_SHORT", "GL_UNSIGNED_SHORT", "GL_INT", "GL_UNSIGNED_INT"];
    for pointer in attributes(host, project) {
        let Some(scalar) = pointer.variable.ty.scalar() else { continue };
        let wants = matches!(scalar, ScalarType::Int | ScalarType::Uint);
        let gives = pointer.function == "glVertexAttribIPointer";
        if wants == gives || !matches!(pointer.function.as_str(), "glVertexAttribPointer" | "glVertexAttribIPointer") {
            continue;
        }
        let (name, ty, function) = (&pointer.variable.name, pointer.variable.ty.to_string(), &pointer.function);
        let mut found = findings
            .at(&host.file, pointer.place, message!("`{function}` does not fit `{name}`, which is `{ty}`", "`{function}` は `{ty}` の `{name}` に合いません"))
            .with_label(if wants { message!("converts to float", "float に変換されます") } else { message!("gives integers", "整数を渡します") })
            .with_related(&pointer.shader.file, pointer.variable.name_span, message!("declared here", "ここで宣言されています"))
            .with_why(message!(
                "the values of the attribute are undefined when it is of integers and the pointer is not, or the other way round",
                "属性とポインタの一方だけが整数のとき、属性の値は不定です"
            ))
            .with_help(if wants {
                message!("call glVertexAttribIPointer with integer data", "整数のデータを glVertexAttribIPointer で渡してください")
            } else {
                message!("call glVertexAttribPointer", "glVertexAttribPointer を呼んでください")
            });
        let arguments = &pointer.arguments;
        if let (true, [_, _, kind, normalized, stride, _]) = (wants, arguments.as_slice())
            && WHOLE.contains(&host.file.slice(*kind))
        {
            let edits = vec![
                Edit::replace(pointer.place, "glVertexAttribIPointer"),
                Edit::delete(Span::new(normalized.start, stride.start)),
            ];
            found = found.with_fix(
                message!("call `glVertexAttribIPointer`", "`glVertexAttribIPointer` を呼ぶ"),
                Safety::Unsafe,
                edits,
            );
        }
        findings.push(found);
    }
}
