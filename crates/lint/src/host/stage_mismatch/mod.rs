//! H022: a shader compiled as another stage.

use crate::program::stage_in_japanese;
use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Safety, Severity, message};
use base::text::{Edit, Span};
use hosts::HostFile;
use hosts::cpp::creation::stage_constant;
use hosts::cpp::group::is_shader_name;
use hosts::cpp::index::Index;
use hosts::cpp::tree::{arguments, bare, plain_string, span};
use reading::Project;
use syntax::Stage;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("H022"),
    name: "stage-mismatch",
    severity: Severity::Error,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Host(check),
};

fn check(host: &HostFile, _: &Project, findings: &mut Findings<'_>) {
    for embedded in host.embedded() {
        let differs = |(stage, _): &(Stage, Span)| embedded.stage != Stage::Library && *stage != embedded.stage;
        let Some((as_stage, place)) = embedded.created_as.filter(differs) else { continue };
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
        // A name that says no stage is no name of another one: several texts may make one stage.
        let says_another = |stage: &Stage| *stage != Stage::Library && *stage != as_stage;
        let Some(stage) = Stage::from_path(name).filter(says_another) else { continue };
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
