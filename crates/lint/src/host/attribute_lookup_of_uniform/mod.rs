//! H002: the location of a uniform is asked for as that of an attribute.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Safety, Severity, message};
use base::text::Edit;
use reading::Project;

use hosts::HostFile;
use hosts::cpp::lookup::LookupKind;
use hosts::spelling::spelled;
use reading::program::resolve;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("H002"),
    name: "attribute-lookup-of-uniform",
    severity: Severity::Error,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Host(check),
};

fn check(host: &HostFile, project: &Project, findings: &mut Findings<'_>) {
    for lookup in host.lookups() {
        if matches!(lookup.kind, LookupKind::Uniform | LookupKind::Name) || lookup.is_reserved() || lookup.wrapped {
            continue;
        }
        let Some(program) = resolve(host, project, &lookup.source) else { continue };
        let name = lookup.base_name();
        let Some((shader, variable)) = program.uniform(name) else { continue };
        if program.vertex().is_none() || program.attribute(name).is_some() {
            continue;
        }
        let found = findings
            .at(
                &host.file,
                lookup.function,
                message!(
                    "`{name}` is a uniform, but is looked up as an attribute",
                    "`{name}` は uniform ですが、頂点属性として位置を求めています"
                ),
            )
            .with_related(
                &shader.file,
                variable.name_span,
                message!("`{name}` is declared `uniform` here", "`{name}` はここで `uniform` と宣言されています"),
            );
        let right = spelled(host, lookup.function, LookupKind::Uniform.function());
        findings.push(if lookup.kind == LookupKind::BindAttribute {
            found
                .with_label(message!("binds nothing", "何にも結び付きません"))
                .with_why(message!(
                    "glBindAttribLocation of a name that is no attribute has no effect, and raises no GL error",
                    "頂点属性でない名前の glBindAttribLocation は効果がなく、GL エラーにもなりません"
                ))
                .with_help(message!(
                    "remove the call; `{name}` is set with a glUniform function",
                    "この呼び出しを消してください。`{name}` には glUniform 系の関数で値を設定します"
                ))
        } else {
            let safety = if lookup.feeds.only_uniform() { Safety::Safe } else { Safety::Unsafe };
            found
                .with_label(message!("gives -1 here", "ここでは -1 になります"))
                .with_why(message!(
                    "glGetAttribLocation knows no uniforms: it gives -1 without a GL error, and glUniform \
                     functions ignore the location -1",
                    "glGetAttribLocation は uniform を知りません。GL エラーなしに -1 を返し、glUniform 系の関数は位置 -1 を無視します"
                ))
                .with_fix(message!("call `{right}`", "`{right}` を呼ぶ"), safety, vec![Edit::replace(lookup.function, right.as_str())])
        });
    }
}
