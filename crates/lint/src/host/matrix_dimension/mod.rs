//! H019: a matrix set by a function for another size.

use super::settings::settings;
use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Safety, Severity, message};
use base::text::Edit;
use hosts::HostFile;
use hosts::spelling::spelled;
use reading::Project;
use syntax::types::Type;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("H019"),
    name: "matrix-dimension",
    severity: Severity::Error,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Host(check),
};

fn check(host: &HostFile, project: &Project, findings: &mut Findings<'_>) {
    for set in settings(host, project) {
        let matrix = set.setter.matrix || matches!(set.element(), Type::Matrix(..));
        if !matrix || matches!(set.element(), Type::Opaque(_) | Type::Error | Type::Struct(_)) {
            continue;
        }
        let (function, name, ty) = (&set.function, &set.lookup.name, set.ty.to_string());
        let declared = message!("declared here", "ここで宣言されています");
        if !set.setter.fits(set.ty) {
            let found = findings
                .at(
                    &host.file,
                    set.place,
                    message!("`{function}` does not fit `{name}`, which is `{ty}`", "`{function}` は `{ty}` の `{name}` に合いません"),
                )
                .with_label(message!("GL_INVALID_OPERATION", "GL_INVALID_OPERATION になります"))
                .with_related(&set.shader.file, set.variable.name_span, declared)
                .with_why(message!(
                    "columns and rows of the function have to be those of the uniform; the call fails and changes nothing",
                    "関数の列数と行数は uniform と同じでなければならず、呼び出しは失敗して何も変わりません"
                ));
            let right = set.setter.function_for(set.ty).filter(|_| set.user.is_some());
            let both = set.setter.matrix && matches!(set.element(), Type::Matrix(..));
            findings.push(match right {
                Some(right) if both && !function.starts_with("glProgram") => {
                    let right = spelled(host, set.place, &right);
                    let edit = Edit::replace(set.place, right.as_str());
                    found.with_fix(message!("call `{right}`", "`{right}` を呼ぶ"), Safety::Unsafe, vec![edit])
                }
                Some(_) | None => found.with_help(message!("set a `{ty}`", "`{ty}` として設定してください")),
            });
            continue;
        }
        let Some((user, place)) = set.user.and_then(|u| Some((u, *u.arguments.get(u.position + 1)?))) else { continue };
        let many = host.file.slice(place).parse::<u32>().is_ok_and(|n| n > 1);
        if many && !name.ends_with(']') && !matches!(set.ty, Type::Array(..)) && user.arguments.len() > 3 {
            findings.push(
                findings
                    .at(
                        &host.file,
                        place,
                        message!(
                            "more than one matrix is given to `{name}`, which is no array",
                            "配列でない `{name}` に複数の行列を渡しています"
                        ),
                    )
                    .with_label(message!("counts matrices", "行列の個数です"))
                    .with_related(&set.shader.file, set.variable.name_span, declared)
                    .with_why(message!(
                        "a count above 1 for a uniform that is no array is GL_INVALID_OPERATION, and nothing is set",
                        "配列でない uniform に 1 より大きい個数を渡すと GL_INVALID_OPERATION になり、何も設定されません"
                    ))
                    .with_fix(message!("write 1", "1 と書く"), Safety::Unsafe, vec![Edit::replace(place, "1")]),
            );
        }
    }
}
