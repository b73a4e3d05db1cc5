//! I011: a function is called that has no body.

use std::collections::BTreeSet;

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use hosts::HostFile;
use reading::{Project, ShaderFile};
use syntax::Stage;
use syntax::symbols::{CallTarget, FunctionInfo};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("I011"),
    name: "function-without-body",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::ShaderWith(check),
};

fn check(file: &ShaderFile, project: &Project, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    if !file.is_sound() || file.conditional || shader.stage() == Stage::Library {
        return;
    }
    let mut told = BTreeSet::new();
    for (id, expr) in shader.arena().iter() {
        let Some(CallTarget::User(called)) = shader.callee(id) else { continue };
        let function = shader.function_info(*called);
        if function.definition.is_some() || expr.from_macro || has_body_elsewhere(file, project, function) {
            continue;
        }
        if !told.insert(*called) {
            continue;
        }
        let name = &function.name.name;
        findings.push(
            findings
                .at(
                    &file.file,
                    expr.span,
                    message!("`{name}` is called, but has no body", "`{name}` が呼ばれていますが、本体がありません"),
                )
                .with_label(message!("nothing to call", "呼び出す本体がない"))
                .with_related(
                    &file.file,
                    function.name.span,
                    message!("only declared here", "ここで宣言されているだけです"),
                )
                .with_why(message!(
                    "the program does not link unless another text of this stage defines the function",
                    "同じステージの別のテキストが定義しなければ、プログラムはリンクできません"
                ))
                .with_help(message!("write the body of `{name}`", "`{name}` の本体を書いてください")),
        );
    }
}

/// True when another text of the project defines a function of this name: it may be attached to the same stage.
fn has_body_elsewhere(file: &ShaderFile, project: &Project, function: &FunctionInfo) -> bool {
    let name = &function.name.name;
    let others = project.shaders().filter(|s| s.file.name() != file.file.name());
    let defines = |s: &ShaderFile| s.shader.functions().any(|(_, f)| f.name.name == *name && f.definition.is_some());
    others.into_iter().any(defines) || stands_in_a_host(file, project, function)
}

/// True where host code has the head of this function outside of the text itself: in a string that is no whole shader.
fn stands_in_a_host(file: &ShaderFile, project: &Project, function: &FunctionInfo) -> bool {
    let head = format!("{} {}(", function.return_type, function.name.name);
    let own = |host: &HostFile| match &file.origin {
        Some(origin) if origin.host.name() == host.file.name() => file.file.text().matches(&head).count(),
        _ => 0,
    };
    project.hosts().any(|host| host.file.text().matches(&head).count() > own(host))
}

#[cfg(test)]
mod tests {
    use super::super::testing::messages;
    use crate::{Input, run};
    use base::text::SourceFile;

    const CALL: &str = "#version 330 core\nout vec4 c;\nfloat shade(float x);\nvoid main() { c = vec4(shade(1.0)); }\n";

    #[test]
    fn a_call_needs_a_body() {
        assert_eq!(messages("I011", "a.frag", CALL), ["`shade` is called, but has no body"]);
        let defined = format!("{CALL}float shade(float x) {{ return x; }}\n");
        assert_eq!(messages("I011", "a.frag", &defined), [""; 0]);
        let unused = CALL.replace("vec4(shade(1.0))", "vec4(1.0)");
        assert_eq!(messages("I011", "a.frag", &unused), [""; 0]);
        let overload = format!("{CALL}float shade(vec2 x) {{ return x.x; }}\n");
        assert_eq!(messages("I011", "a.frag", &overload).len(), 1, "another overload is no body of this one");
    }

    #[test]
    fn a_body_in_another_string_of_a_host_counts() {
        let main = CALL.replace('\n', "\\n\"\n\"");
        let host = |other: &str| {
            format!(
                "const char* fragmentSource = \"{main}\";\nconst char* shadeSource = \"{other} {{ return x; }}\\n\";\n"
            )
        };
        let count = |text: String| {
            let found = run(&[Input::new(SourceFile::new("a.cpp", text))]);
            found.iter().filter(|d| d.code.0 == "I011").count()
        };
        assert_eq!(count(host("float shade(float x)")), 0);
        assert_eq!(count(host("float other(float x)")), 1);
    }

    #[test]
    fn a_body_in_another_text_counts() {
        let other = "#version 330 core\nfloat shade(float x) { return x; }\n";
        let files = [("a.frag", CALL), ("shade.glsl", other)].map(|(n, t)| Input::new(SourceFile::new(n, t)));
        assert!(run(&files).iter().all(|d| d.code.0 != "I011"));
    }
}
