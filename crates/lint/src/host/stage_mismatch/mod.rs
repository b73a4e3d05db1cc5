//! H022: a shader compiled as another stage.

use super::HostFile;
use super::creation::stage_constant;
use super::group::is_shader_name;
use super::index::Index;
use super::syntax::{arguments, bare, plain_string, span};
use crate::program::stage_in_japanese;
use crate::project::Project;
use crate::rule::{Check, Example, Findings, Japanese, Level, Page, Rule};
use base::diagnostic::{Code, Safety, Severity, message};
use base::text::{Edit, Span};
use syntax::Stage;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("H022"),
    name: "stage-mismatch",
    severity: Severity::Error,
    level: Level::Default,
    summary: "a shader is compiled as another stage than its name or text says",
    page: Page {
        what: "Reports calls that get the constant of a stage (`GL_FRAGMENT_SHADER`, `QOpenGLShader::Vertex`) together with a file whose ending says another stage, and shader texts in literals whose contents belong to another stage than they are compiled as.",
        why: "Built-in variables differ from stage to stage; the shader does not compile, or the program lacks a stage.",
        bad: &[Example {
            name: "build.cpp",
            text: "const char *source =\n  \"#version 150 core\\n\"\n  \"in vec4 position;\\n\"\n  \"void main() { gl_Position = position; }\\n\";\nvoid build()\n{\n  GLuint shader = glCreateShader(GL_FRAGMENT_SHADER);\n  glShaderSource(shader, 1, &source, 0);\n}\n",
        }],
        good: &[Example {
            name: "build.cpp",
            text: "const char *source =\n  \"#version 150 core\\n\"\n  \"in vec4 position;\\n\"\n  \"void main() { gl_Position = position; }\\n\";\nvoid build()\n{\n  GLuint shader = glCreateShader(GL_VERTEX_SHADER);\n  glShaderSource(shader, 1, &source, 0);\n}\n",
        }],
        fix: "Writes the constant of the stage that the name or the text says. Unsafe: the other file may be meant.",
        references: &[
            "OpenGL 3.2 core specification, section 2.11.1 (CreateShader)",
            "OpenGL Shading Language 1.50, section 7 (Built-in Variables)",
        ],
        ja: Japanese {
            summary: "名前や内容が示すステージと違うステージとしてシェーダをコンパイルしています",
            what: "ステージの定数（`GL_FRAGMENT_SHADER`, `QOpenGLShader::Vertex` など）と、別のステージを示す拡張子のファイルを同時に受け取る呼び出し、および内容と違うステージとしてコンパイルされるリテラルのシェーダを報告します。",
            why: "組み込み変数はステージごとに違うので、シェーダがコンパイルできないか、プログラムのステージが足りなくなります。",
            fix: "名前や内容が示すステージの定数に書き換えます。別のファイルのつもりかもしれないので unsafe です。",
        },
    },
    check: Check::Host(check),
};

fn check(host: &HostFile, _: &Project, findings: &mut Findings<'_>) {
    for embedded in host.embedded() {
        let Some((as_stage, place)) = embedded.created_as.filter(|(s, _)| *s != embedded.stage) else { continue };
        report(host, &embedded.name, embedded.stage, as_stage, place, findings);
    }
    let text = host.file.text();
    if !text.contains("_SHADER") && !text.contains("Shader::") {
        return;
    }
    let Some(index) = Index::new(host) else { return };
    for &call in &index.calls {
        let all = arguments(call);
        let constants: Vec<_> =
            all.iter().filter_map(|a| stage_constant(host.text(bare(*a))).map(|s| (s, span(bare(*a))))).collect();
        let names: Vec<&str> = all
            .iter()
            .filter_map(|a| plain_string(*a, &host.file))
            .map(|(n, _)| n)
            .filter(|n| is_shader_name(n))
            .collect();
        let (&[(as_stage, place)], &[name]) = (constants.as_slice(), names.as_slice()) else { continue };
        let Some(stage) = Stage::from_path(name).filter(|s| *s != as_stage) else { continue };
        report(host, name, stage, as_stage, place, findings);
    }
}

fn report(host: &HostFile, name: &str, stage: Stage, as_stage: Stage, place: Span, findings: &mut Findings<'_>) {
    let (is, taken) = (stage.name(), as_stage.name());
    let (ja_is, ja_taken) = (stage_in_japanese(stage), stage_in_japanese(as_stage));
    let mut found = findings
        .at(
            &host.file,
            place,
            message!(
                "{name} is a {is} shader, but is compiled as a {taken} shader",
                "{name} は{ja_is}ですが、{ja_taken}としてコンパイルされます"
            ),
        )
        .with_label(message!("the {taken} stage", "{ja_taken}"))
        .with_why(message!(
            "each stage has its own built-in variables; what is written for another one does not compile or link",
            "組み込み変数はステージごとに違い、別のステージ用のシェーダはコンパイルやリンクができません"
        ))
        .with_help(message!(
            "compile it as a {is} shader, or give another text",
            "{ja_is}としてコンパイルするか、別のシェーダを渡してください"
        ));
    let right = match stage {
        Stage::Vertex => Some("GL_VERTEX_SHADER"),
        Stage::Fragment => Some("GL_FRAGMENT_SHADER"),
        Stage::Geometry => Some("GL_GEOMETRY_SHADER"),
        Stage::TessControl => Some("GL_TESS_CONTROL_SHADER"),
        Stage::TessEvaluation => Some("GL_TESS_EVALUATION_SHADER"),
        Stage::Compute => Some("GL_COMPUTE_SHADER"),
        Stage::Library => None,
    };
    if let Some(right) = right.filter(|_| host.file.slice(place).starts_with("GL_")) {
        found = found.with_fix(
            message!("write `{right}`", "`{right}` と書く"),
            Safety::Unsafe,
            vec![Edit::replace(place, right)],
        );
    }
    findings.push(found);
}
