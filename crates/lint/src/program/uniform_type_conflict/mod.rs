//! I006: a uniform with two types.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use reading::Project;

use reading::program::Program;
use reading::program::link::agree;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("I006"),
    name: "uniform-type-conflict",
    severity: Severity::Error,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Program(check),
};

fn check(program: &Program<'_>, _project: &Project, findings: &mut Findings<'_>) {
    let shaders = program.shaders();
    if !shaders.iter().all(|s| s.is_plain()) {
        return;
    }
    for (i, shader) in shaders.iter().enumerate() {
        for uniform in &shader.shader.interface().uniforms {
            let earlier = shaders[..i].iter().find_map(|s| s.shader.interface().uniform(&uniform.name).map(|u| (s, u)));
            let Some((other, first)) = earlier.filter(|(_, u)| !agree(&u.ty, &uniform.ty)) else { continue };
            let (name, here, there) = (&uniform.name, uniform.ty.to_string(), first.ty.to_string());
            let place = other.file.name();
            findings.push(
                findings
                    .at(
                        &shader.file,
                        uniform.name_span,
                        message!(
                            "the uniform `{name}` is `{here}` here, and `{there}` in {place}",
                            "uniform `{name}` はここでは `{here}`、{place} では `{there}` です"
                        ),
                    )
                    .with_label(message!("`{here}` here", "ここでは `{here}`"))
                    .with_related(&other.file, first.name_span, message!("`{there}` here", "ここでは `{there}`"))
                    .with_why(message!(
                        "stages share their uniforms; two types for one name do not link",
                        "uniform はステージの間で共有されるので、型が違うとリンクできません"
                    ))
                    .with_help(message!(
                        "declare `{name}` with one type, or give one of them another name",
                        "`{name}` を同じ型で宣言するか、一方の名前を変えてください"
                    )),
            );
        }
    }
}
