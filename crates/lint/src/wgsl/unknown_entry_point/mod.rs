//! W010: the name of an entry point that its module does not have.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Message, Severity, message};
use base::text::Span;
use hosts::HostFile;
use hosts::script::webgpu::{StageUse, Start};
use reading::{Project, ShaderFile};
use syntax::Stage;
use syntax::wgsl::Module;

use super::interface::{beside, module_of, started};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("W010"),
    name: "unknown-entry-point",
    severity: Severity::Error,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Host(check),
};

fn check(host: &HostFile, project: &Project, findings: &mut Findings<'_>) {
    let Some(webgpu) = host.webgpu() else { return };
    for stage in &webgpu.stages {
        if let Some((file, module)) = module_of(project, host, &stage.source) {
            of_stage(host, stage, file, module, findings);
        }
    }
    // Names beside a module that is not seen are held against all that the file names.
    let seen = |place: Span| webgpu.stages.iter().any(|s| matches!(s.start, Start::Named(_, p) if p == place));
    let open: Vec<&(String, Span)> = webgpu.entry_points.iter().filter(|(_, place)| !seen(*place)).collect();
    if !open.is_empty() && webgpu.modules_are_known {
        in_any(host, project, &open, findings);
    }
}

fn of_stage(host: &HostFile, stage: &StageUse, file: &ShaderFile, module: &Module, findings: &mut Findings<'_>) {
    if started(module, stage).is_some() {
        return;
    }
    let of_stage: Vec<&str> =
        module.entry_points.iter().filter(|e| e.stage == stage.stage).map(|e| e.name.name.as_str()).collect();
    let kind = stage.stage.name();
    let (place, what) = match &stage.start {
        Start::Named(name, place) => {
            let other = module.entry_points.iter().find(|e| e.name.name == *name).map(|e| e.stage);
            let what = match other.map(Stage::name) {
                Some(other) => message!(
                    "`{name}` is an entry point of the {other} stage, not of the {kind} stage",
                    "`{name}` は {kind} ステージではなく {other} ステージのエントリポイントです"
                ),
                None => message!(
                    "the module has no entry point `{name}`",
                    "モジュールにエントリポイント `{name}` がありません"
                ),
            };
            (*place, what)
        }
        Start::Only if of_stage.is_empty() => (
            stage.place,
            message!(
                "the module has no entry point of the {kind} stage",
                "モジュールに {kind} ステージのエントリポイントがありません"
            ),
        ),
        Start::Only => (
            stage.place,
            message!(
                "no entry point is named, and the module has several of the {kind} stage",
                "エントリポイントの指定がなく、モジュールには {kind} ステージのものが複数あります"
            ),
        ),
    };
    let (list, all) = (of_stage.join("`, `"), module.entry_points.iter().map(|e| e.name.name.as_str()));
    let all = all.collect::<Vec<&str>>().join("`, `");
    let help = match (of_stage.is_empty(), all.is_empty()) {
        (false, _) => message!("name one of `{list}`", "`{list}` のどれかを指定してください"),
        (true, false) => message!("the module has `{all}`", "モジュールにあるのは `{all}` です"),
        (true, true) => message!("the module has no entry points", "モジュールにエントリポイントがありません"),
    };
    let first = module.entry_points.first().map_or(Span::at(0), |e| e.name.span);
    let d = findings.at(&host.file, place, what).with_label(message!("not in the module", "モジュールにない"));
    let related = message!("the module", "モジュール");
    findings.push(explained(d.with_related(&file.file, first, related), help));
}

fn explained(d: base::diagnostic::Diagnostic, help: Message) -> base::diagnostic::Diagnostic {
    d.with_why(message!(
        "a pipeline whose entry point is missing is refused",
        "エントリポイントのないパイプラインは拒否されます"
    ))
    .with_help(help)
}

/// Names that none of the modules has which the file names.
fn in_any(host: &HostFile, project: &Project, open: &[&(String, Span)], findings: &mut Findings<'_>) {
    let Some(webgpu) = host.webgpu().filter(|w| !w.modules.is_empty()) else { return };
    let text = host.file.text();
    // A module that comes from elsewhere may have the name.
    if ["&wgpu::ShaderModule", "&ShaderModule", ": wgpu::ShaderModule", "GPUShaderModule"]
        .iter()
        .any(|w| text.contains(w))
    {
        return;
    }
    let mut modules: Vec<&ShaderFile> = Vec::new();
    for path in &webgpu.modules {
        match beside(project, host.file.name(), path) {
            Some(file) if file.shader.wgsl().is_some_and(|m| !m.composed) && file.is_sound() => modules.push(file),
            _ => return,
        }
    }
    let names: Vec<&str> = modules
        .iter()
        .filter_map(|m| m.shader.wgsl())
        .flat_map(|m| m.entry_points.iter().map(|e| e.name.name.as_str()))
        .collect();
    for (name, place) in open {
        // A module in a string of this file has it.
        if names.contains(&name.as_str())
            || text.contains(&format!("fn {name}(")) && text.contains("@fragment")
            || names.is_empty()
        {
            continue;
        }
        let list = names.join("`, `");
        let what =
            message!("no module has an entry point `{name}`", "エントリポイント `{name}` を持つモジュールがありません");
        let help = message!("the modules named here have `{list}`", "ここで使うモジュールにあるのは `{list}` です");
        let d = findings.at(&host.file, *place, what);
        findings.push(explained(d.with_label(message!("not in the module", "モジュールにない")), help));
    }
}

#[cfg(test)]
mod tests {
    use crate::{Input, run};
    use base::text::SourceFile;

    fn count(name: &str, host: &str, module: &str) -> usize {
        let files = [(name, host), ("src/shader.wgsl", module)];
        let inputs: Vec<Input> = files.iter().map(|(n, t)| Input::new(SourceFile::new(*n, *t))).collect();
        run(&inputs).iter().filter(|d| d.code.0 == "W010").count()
    }

    const MODULE: &str = "@vertex fn vs_main() -> @builtin(position) vec4f { return vec4f(); }\n";

    #[test]
    fn names_that_no_module_has_are_reported() {
        let rust = |entry: &str| {
            format!(
                "fn f() {{ let m = include_wgsl!(\"shader.wgsl\"); g(State {{ module: &m, entry_point: {entry}, b: 1 }}); }}"
            )
        };
        assert_eq!(count("src/a.rs", &rust("\"main\""), MODULE), 1);
        assert_eq!(count("src/a.rs", &rust("Some(\"main\")"), MODULE), 1);
        assert_eq!(count("src/a.rs", &rust("Some(\"vs_main\")"), MODULE), 0);
        assert_eq!(count("src/a.rs", &rust("name"), MODULE), 0);
        let js = "import code from './shader.wgsl?raw';\nconst p = f({ vertex: { module: m, entryPoint: 'main' } });\n";
        assert_eq!(count("src/a.ts", js, MODULE), 1);
    }

    #[test]
    fn modules_from_elsewhere_may_have_them() {
        let given = "fn f(m: &wgpu::ShaderModule) { include_wgsl!(\"shader.wgsl\"); g(S { entry_point: \"main\", }); }";
        assert_eq!(count("src/a.rs", given, MODULE), 0);
        let other = "fn f() { include_wgsl!(\"other.wgsl\"); g(S { entry_point: \"main\", }); }";
        assert_eq!(count("src/a.rs", other, MODULE), 0);
        // A module in SPIR-V is no text that is read.
        for other in ["include_spirv_raw!(\"a.spv\")", "wgpu::ShaderSource::SpirV(words)"] {
            let either = format!(
                "fn f() {{ include_wgsl!(\"shader.wgsl\"); let m = make({other}); g(S {{ entry_point: \"main\", }}); }}"
            );
            assert_eq!(count("src/a.rs", &either, MODULE), 0);
        }
        let plain = "fn f() { include_wgsl!(\"shader.wgsl\"); g(S { entry_point: \"main\", }); }";
        assert_eq!(count("src/a.rs", plain, &format!("#import b\n{MODULE}")), 0);
    }
}
