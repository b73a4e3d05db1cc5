//! W017: a pass that binds a resource of the pass before it.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use hosts::HostFile;
use reading::Project;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("W017"),
    name: "resource-of-another-pass",
    severity: Severity::Warning,
    level: Level::Strict,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Host(check),
};

fn check(host: &HostFile, _: &Project, findings: &mut Findings<'_>) {
    let Some(webgpu) = host.webgpu() else { return };
    for mixed in &webgpu.mixed {
        let (own, other, meant) = (&mixed.own, &mixed.other, &mixed.meant);
        findings.push(
            findings
                .at(
                    &host.file,
                    mixed.place,
                    message!(
                        "the pipeline is that of `{own}`, and this resource is that of `{other}`",
                        "パイプラインは `{own}` のもの、このリソースは `{other}` のものです"
                    ),
                )
                .with_label(message!("of the pass before", "前のパスのもの"))
                .with_related(&host.file, mixed.before, message!("bound there as well", "そこでも設定されている"))
                .with_why(message!(
                    "the code of a pass is often copied, and a name is left unchanged",
                    "パスのコードはよくコピーされ、名前の変え忘れが起こります"
                ))
                .with_help(message!(
                    "`{meant}` exists: bind it, if it is meant",
                    "`{meant}` があります。意図していればそれを設定してください"
                )),
        );
    }
}

#[cfg(test)]
mod tests {
    use crate::{Input, Level, Selection, Settings, run_with};
    use base::text::SourceFile;

    fn count(name: &str, second: &str) -> usize {
        let text = if name.ends_with(".rs") {
            format!(
                "fn draw(pass: &mut RenderPass, light: &Light) {{\n    pass.set_pipeline(&self.opaque_pipeline);\n    \
                 pass.set_bind_group(0, &self.camera, &[]);\n    pass.set_bind_group(1, &light.opaque_objects.group, &[]);\n    \
                 pass.set_pipeline(&self.cutout_pipeline);\n    pass.set_bind_group(0, &self.camera, &[]);\n    \
                 pass.set_bind_group(1, &light.{second}, &[]);\n    run(&light.cutout_objects.calls);\n}}\n"
            )
        } else {
            format!(
                "function frame() {{\n  pass.setPipeline(opaquePipeline);\n  pass.setBindGroup(0, opaqueGroup);\n  \
                 pass.setPipeline(cutoutPipeline);\n  pass.setBindGroup(0, {second});\n}}\nlet cutoutGroup;\n"
            )
        };
        let settings = Settings { selection: Selection::default().at(Level::Strict), ..Settings::default() };
        let found = run_with(&[Input::new(SourceFile::new(name, text))], &settings);
        found.iter().filter(|d| d.code.0 == "W017").count()
    }

    #[test]
    fn a_copy_that_was_not_changed_is_reported() {
        assert_eq!(count("a.rs", "opaque_objects.group"), 1);
        assert_eq!(count("a.js", "opaqueGroup"), 1);
    }

    #[test]
    fn own_and_shared_resources_are_not() {
        assert_eq!(count("a.rs", "cutout_objects.group"), 0);
        assert_eq!(count("a.rs", "opaque_lights.group"), 0, "no such name for the other pass");
        assert_eq!(count("a.js", "cutoutGroup"), 0);
        assert_eq!(count("a.js", "sharedGroup"), 0);
    }
}
