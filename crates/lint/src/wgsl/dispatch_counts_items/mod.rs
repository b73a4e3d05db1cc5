//! W014: a dispatch whose count of work groups is the number of items.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use analysis::kernel::{kernels, unguarded_store};
use base::diagnostic::{Code, Severity, message};
use hosts::HostFile;
use reading::Project;

use super::interface::{module_of, started};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("W014"),
    name: "dispatch-counts-items",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Host(check),
};

fn check(host: &HostFile, project: &Project, findings: &mut Findings<'_>) {
    let Some(webgpu) = host.webgpu() else { return };
    for dispatch in &webgpu.dispatches {
        let Some([stage]) = webgpu.pipelines.get(dispatch.pipeline).map(|p| p.stages.as_slice()) else { continue };
        let Some((file, module)) = module_of(project, host, &stage.source) else { continue };
        let Some(entry) = started(module, stage) else { continue };
        // Groups that are one invocation wide are items.
        let Some([wide, 1, 1]) = entry.workgroup.filter(|size| size[0] > 1) else { continue };
        let kernel = kernels(&file.shader).into_iter().find(|k| k.function == entry.function);
        let Some(stored) = kernel.and_then(|k| unguarded_store(&file.shader, &k)) else { continue };
        let stored = file.shader.expr(stored).span;
        let (name, count, all) = (&dispatch.name, dispatch.count, dispatch.count.saturating_mul(u64::from(wide)));
        let what = message!(
            "`{name}` work groups of {wide} are {all} invocations, for {count} items",
            "{wide} 個ずつのワークグループ `{name}` 個は {all} 回の実行になりますが、要素は {count} 個です"
        );
        findings.push(
            findings
                .at(&host.file, dispatch.place, what)
                .with_label(message!("the number of items", "要素の数"))
                .with_related(&file.file, stored, message!("stored here without a guard", "ここで確かめずに書き込む"))
                .with_why(message!(
                    "a dispatch counts work groups, and invocations past the end read and write elements that are not there",
                    "ディスパッチはワークグループを数えます。終わりを超えた実行は、存在しない要素を読み書きします"
                ))
                .with_help(message!(
                    "divide by {wide} and round up, and leave the entry point where the index is past the end",
                    "{wide} で割って切り上げ、添字が終わりを超えたらエントリポイントから戻ってください"
                )),
        );
    }
}

#[cfg(test)]
mod tests {
    use crate::{Input, run};
    use base::text::SourceFile;

    fn count(argument: &str, module: &str) -> usize {
        let host = format!(
            "import code from './a.wgsl?raw';\nconst n = 1500;\nconst data = new Float32Array(n * 4);\n\
             const p = device.createComputePipeline({{ layout: 'auto', compute: {{ module: device.createShaderModule({{ code }}), entryPoint: 'main' }} }});\n\
             function frame() {{ const pass = e.beginComputePass(); pass.setPipeline(p); pass.dispatchWorkgroups({argument}); }}\n"
        );
        let files = [("a.ts", host.as_str()), ("a.wgsl", module)];
        let inputs: Vec<Input> = files.iter().map(|(n, t)| Input::new(SourceFile::new(*n, *t))).collect();
        run(&inputs).iter().filter(|d| d.code.0 == "W014").count()
    }

    fn module(size: u32, body: &str) -> String {
        format!(
            "@group(0) @binding(0) var<storage, read_write> data: array<vec4f>;\n\
             @compute @workgroup_size({size}) fn main(@builtin(global_invocation_id) id: vec3u) {{ {body} }}\n"
        )
    }

    #[test]
    fn items_for_groups_are_reported() {
        assert_eq!(count("n", &module(64, "let i = id.x; data[i] = data[i] * 2.0;")), 1);
        let compared = "let i = id.x; for (var k = 0u; k < 8u; k++) { if (k == i) { continue; } data[i] += data[k]; }";
        assert_eq!(count("n", &module(64, compared)), 1);
    }

    #[test]
    fn groups_and_guards_are_not() {
        assert_eq!(count("Math.ceil(n / 64)", &module(64, "data[id.x] = vec4f();")), 0);
        assert_eq!(count("n", &module(1, "data[id.x] = vec4f();")), 0, "one invocation a group");
        assert_eq!(count("n", &module(64, "if (id.x >= arrayLength(&data)) { return; } data[id.x] = vec4f();")), 0);
        assert_eq!(count("n", &module(64, "let i = min(id.x, 9u); data[i] = vec4f();")), 0);
        assert_eq!(count("n", &module(64, "let m = id.x; if (m < 1500u) { data[m] = vec4f(); }")), 0);
        assert_eq!(count("m", &module(64, "data[id.x] = vec4f();")), 0, "not known");
    }
}
