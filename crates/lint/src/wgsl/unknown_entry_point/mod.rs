//! W010: the name of an entry point that no module has.

use crate::host::HostFile;
use crate::project::{Project, ShaderFile, folder, normalise};
use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};

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
    let Some(webgpu) = host.webgpu().filter(|w| !w.entry_points.is_empty() && !w.modules.is_empty()) else { return };
    let text = host.file.text();
    // A module that comes from elsewhere may have the name.
    if ["&wgpu::ShaderModule", "&ShaderModule", ": wgpu::ShaderModule", "GPUShaderModule"]
        .iter()
        .any(|w| text.contains(w))
    {
        return;
    }
    if !webgpu.modules_are_known {
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
    for (name, place) in &webgpu.entry_points {
        // A module in a string of this file has it.
        if names.contains(&name.as_str())
            || text.contains(&format!("fn {name}(")) && text.contains("@fragment")
            || names.is_empty()
        {
            continue;
        }
        let list = names.join("`, `");
        findings.push(
            findings
                .at(
                    &host.file,
                    *place,
                    message!(
                        "no module has an entry point `{name}`",
                        "エントリポイント `{name}` を持つモジュールがありません"
                    ),
                )
                .with_label(message!("not in the module", "モジュールにない"))
                .with_why(message!(
                    "a pipeline whose entry point is missing is refused",
                    "エントリポイントのないパイプラインは拒否されます"
                ))
                .with_help(message!(
                    "the modules named here have `{list}`",
                    "ここで使うモジュールにあるのは `{list}` です"
                )),
        );
    }
}

/// The file that a path means which is written in a host file: from its folder, or as the end of one path alone.
fn beside<'p>(project: &'p Project, host: &str, path: &str) -> Option<&'p ShaderFile> {
    let wanted = normalise(&format!("{}/{path}", folder(host)));
    let mut all = project.shader_files();
    if let Some((_, file)) = all.find(|(p, _)| *p == wanted.trim_start_matches('/') || *p == wanted) {
        return Some(file);
    }
    let end = format!("/{}", path.trim_start_matches(['.', '/', '@', '~']));
    let mut found = project.shader_files().filter(|(p, _)| p.ends_with(&end));
    found.next().filter(|_| found.next().is_none()).map(|(_, file)| file)
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
        let plain = "fn f() { include_wgsl!(\"shader.wgsl\"); g(S { entry_point: \"main\", }); }";
        assert_eq!(count("src/a.rs", plain, &format!("#import b\n{MODULE}")), 0);
    }
}
