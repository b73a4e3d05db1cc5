//! H011: a sampler set with something else than a unit.

use super::settings::{Setting, settings};
use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Safety, Severity, message};
use base::text::Edit;
use hosts::HostFile;
use hosts::cpp::tree::{arguments, bare, callee, descendants};
use reading::Project;
use syntax::types::{OpaqueKind, Type};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("H011"),
    name: "sampler-setter",
    severity: Severity::Error,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Host(check),
};

fn check(host: &HostFile, project: &Project, findings: &mut Findings<'_>) {
    for set in settings(host, project) {
        if !matches!(set.element(), Type::Opaque(o) if matches!(o.kind, OpaqueKind::Sampler)) {
            continue;
        }
        let (function, name) = (&set.function, &set.lookup.name);
        let declared = (&set.shader.file, set.variable.name_span);
        if !set.setter.fits(set.ty) {
            findings.push(
                findings
                    .at(
                        &host.file,
                        set.place,
                        message!(
                            "`{function}` cannot set the sampler `{name}`",
                            "`{function}` ではサンプラ `{name}` を設定できません"
                        ),
                    )
                    .with_label(message!("GL_INVALID_OPERATION", "GL_INVALID_OPERATION になります"))
                    .with_related(declared.0, declared.1, message!("a sampler", "サンプラです"))
                    .with_why(message!(
                        "a sampler holds the number of a texture unit, and only glUniform1i and glUniform1iv set it",
                        "サンプラの値はテクスチャユニットの番号で、glUniform1i と glUniform1iv だけで設定できます"
                    ))
                    .with_help(message!(
                        "call glUniform1i with the number of the unit",
                        "ユニットの番号を glUniform1i で設定してください"
                    )),
            );
            continue;
        }
        let Some(value) = set.value() else { continue };
        let text = host.file.slice(value);
        if is_texture(host, text) {
            object(host, &set, findings);
            continue;
        }
        let Some(unit) = text.strip_prefix("GL_TEXTURE").filter(|n| n.parse::<u8>().is_ok()) else { continue };
        findings.push(
            findings
                .at(
                    &host.file,
                    value,
                    message!(
                        "`{text}` is not the number of a texture unit",
                        "`{text}` はテクスチャユニットの番号ではありません"
                    ),
                )
                .with_label(message!("the unit is {unit}", "ユニットの番号は {unit} です"))
                .with_related(declared.0, declared.1, message!("a sampler", "サンプラです"))
                .with_why(message!(
                    "`{text}` is the name that glActiveTexture takes; a sampler takes the number {unit}",
                    "`{text}` は glActiveTexture に渡す名前です。サンプラには番号 {unit} を渡します"
                ))
                .with_fix(
                    message!("write `{unit}`", "`{unit}` と書く"),
                    Safety::Unsafe,
                    vec![Edit::replace(value, unit)],
                ),
        );
    }
}

/// True when the file binds something of this name as a texture, and selects no unit with it.
fn is_texture(host: &HostFile, text: &str) -> bool {
    let number = text.bytes().all(|b| b.is_ascii_digit());
    if number || !host.file.text().contains("glBindTexture") {
        return false;
    }
    let takes = |functions: &[&str], at: usize| {
        let calls = host.root().into_iter().flat_map(descendants);
        calls.filter(|c| callee(*c, &host.file).is_some_and(|(name, _)| functions.contains(&name))).any(|c| {
            arguments(c).get(at).is_some_and(|a| {
                let given = host.text(bare(*a));
                given == text || given.strip_prefix("GL_TEXTURE0 +").is_some_and(|unit| unit.trim() == text)
            })
        })
    };
    takes(&["glBindTexture"], 1) && !takes(&["glActiveTexture", "glBindTextureUnit", "glBindSampler"], 0)
}

fn object(host: &HostFile, set: &Setting<'_>, findings: &mut Findings<'_>) {
    let Some(value) = set.value() else { return };
    let text = host.file.slice(value);
    findings.push(
        findings
            .at(
                &host.file,
                value,
                message!(
                    "`{text}` is a texture, not the number of a unit",
                    "`{text}` はテクスチャで、ユニットの番号ではありません"
                ),
            )
            .with_label(message!("bound by glBindTexture", "glBindTexture に渡しています"))
            .with_related(&set.shader.file, set.variable.name_span, message!("a sampler", "サンプラです"))
            .with_why(message!(
                "a sampler holds the number of a unit; the texture is the one that is bound to the unit",
                "サンプラの値はユニットの番号で、そのユニットに結び付けたテクスチャが使われます"
            ))
            .with_help(message!(
                "give the number of the unit that glActiveTexture selects before `{text}` is bound",
                "`{text}` を結び付ける前に glActiveTexture で選ぶユニットの番号を渡してください"
            )),
    );
}

#[cfg(test)]
mod tests {
    use crate::{Input, run};
    use base::text::SourceFile;

    fn reported(body: &str) -> usize {
        let vertex = "#version 330\nvoid main() { gl_Position = vec4(0.0); }\n";
        let fragment =
            "#version 330\nuniform sampler2D image;\nout vec4 c;\nvoid main() { c = texture(image, vec2(0.5)); }\n";
        let host =
            format!("void f(GLuint wood, GLuint unit)\n{{\n  GLuint p = load(\"a.vert\", \"a.frag\");\n{body}\n}}\n");
        let files = [("a.vert", vertex), ("a.frag", fragment), ("a.cpp", &host)];
        let inputs: Vec<Input> = files.iter().map(|(n, t)| Input::new(SourceFile::new(*n, *t))).collect();
        run(&inputs).iter().filter(|d| d.code.0 == "H011").count()
    }

    #[test]
    fn a_texture_is_no_unit() {
        let bind = "glActiveTexture(GL_TEXTURE0); glBindTexture(GL_TEXTURE_2D, wood);";
        let set = |value: &str| format!("{bind} glUniform1i(glGetUniformLocation(p, \"image\"), {value});");
        assert_eq!(reported(&set("wood")), 1);
        assert_eq!(reported(&set("0")), 0);
        assert_eq!(reported(&set("unit")), 0);
        let counted = set("unit").replace("GL_TEXTURE0", "GL_TEXTURE0 + unit").replace("wood);", "unit);");
        assert_eq!(reported(&counted), 0, "a number that serves for both");
    }
}
