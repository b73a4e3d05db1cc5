//! H010: a uniform set by a function for another type.

use super::settings::Setting;
use super::settings::settings;
use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Safety, Severity, message};
use base::text::Edit;
use hosts::HostFile;
use hosts::setter::Setter;
use hosts::spelling::spelled;
use reading::Project;
use syntax::types::Type;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("H010"),
    name: "uniform-setter-type",
    severity: Severity::Error,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Host(check),
};

fn check(host: &HostFile, project: &Project, findings: &mut Findings<'_>) {
    for set in settings(host, project) {
        let matrix = set.setter.matrix || matches!(set.element(), Type::Matrix(..));
        if matrix || matches!(set.element(), Type::Opaque(_) | Type::Error | Type::Struct(_)) {
            continue;
        }
        if set.setter.fits(set.ty) {
            count(host, &set, findings);
            continue;
        }
        let (function, name, ty) = (&set.function, &set.lookup.name, set.ty.to_string());
        let mut found = findings
            .at(
                &host.file,
                set.place,
                message!(
                    "`{function}` does not fit `{name}`, which is `{ty}`",
                    "`{function}` は `{ty}` の `{name}` に合いません"
                ),
            )
            .with_label(message!("GL_INVALID_OPERATION", "GL_INVALID_OPERATION になります"))
            .with_related(&set.shader.file, set.variable.name_span, message!("declared here", "ここで宣言されています"))
            .with_why(message!(
                "size and type of the function have to be those of the uniform; the call fails and changes nothing",
                "関数の成分数と型は uniform と同じでなければならず、呼び出しは失敗して何も変わりません"
            ));
        found = match set.setter.function_for(set.ty).filter(|_| set.user.is_some()) {
            Some(right) => {
                let right = if function.starts_with("glProgram") {
                    right.replacen("glUniform", "glProgramUniform", 1)
                } else {
                    right
                };
                let rows = Setter::of_function(&right).map(|r| (r.rows, r.vector));
                let right = spelled(host, set.place, &right);
                let same = rows == Some((set.setter.rows, set.setter.vector))
                    || (set.setter.vector && rows.is_some_and(|r| r.1));
                let found = found.with_help(message!("`{ty}` is set by `{right}`", "`{ty}` は `{right}` で設定します"));
                if same && !set.setter.vector {
                    let edit = Edit::replace(set.place, right.as_str());
                    found.with_fix(message!("call `{right}`", "`{right}` を呼ぶ"), Safety::Unsafe, vec![edit])
                } else {
                    found
                }
            }
            None => found.with_help(message!("set a `{ty}`", "`{ty}` として設定してください")),
        };
        findings.push(found);
    }
}

/// Reports a count above 1 for what is no array.
fn count(host: &HostFile, set: &Setting<'_>, findings: &mut Findings<'_>) {
    let Some(user) = set.user.filter(|_| set.setter.vector) else { return };
    let Some(place) = user.arguments.get(user.position + 1) else { return };
    let many = host.file.slice(*place).parse::<u32>().is_ok_and(|n| n > 1);
    let elements = set.lookup.name.ends_with(']');
    if !many || elements || matches!(set.ty, Type::Array(..)) {
        return;
    }
    let (name, ty) = (&set.lookup.name, set.ty.to_string());
    findings.push(
        findings
            .at(
                &host.file,
                *place,
                message!(
                    "more than one value is given to `{name}`, which is `{ty}` and no array",
                    "配列でない `{ty}` の `{name}` に複数の値を渡しています"
                ),
            )
            .with_label(message!("counts values, not components", "成分ではなく値の個数です"))
            .with_related(&set.shader.file, set.variable.name_span, message!("declared here", "ここで宣言されています"))
            .with_why(message!(
                "a count above 1 for a uniform that is no array is GL_INVALID_OPERATION, and nothing is set",
                "配列でない uniform に 1 より大きい個数を渡すと GL_INVALID_OPERATION になり、何も設定されません"
            ))
            .with_fix(message!("write 1", "1 と書く"), Safety::Unsafe, vec![Edit::replace(*place, "1")]),
    );
}
