//! K001: shared memory that one invocation writes and another uses, with no barrier between.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use analysis::kernel::{Kind, Race, races};
use base::diagnostic::{Code, Severity, message};
use reading::ShaderFile;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("K001"),
    name: "missing-barrier",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Any(check),
};

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    if super::has_errors(shader) {
        return;
    }
    for Race { symbol, later, earlier, kind, before, witness } in races(shader) {
        let name = &shader.symbol(symbol).name;
        let what = match (kind, before) {
            (Kind::Write, _) => message!(
                "`{name}` is written here while another invocation may still read it",
                "`{name}` を、他のインベケーションがまだ読んでいるかもしれない所で書き換えています"
            ),
            (Kind::AtomicUpdate, _) => message!(
                "`{name}` is updated here while another invocation may not have set it yet",
                "`{name}` を、他のインベケーションがまだ初期化していないかもしれない所で更新しています"
            ),
            _ => message!(
                "`{name}` is read here while another invocation may not have written it yet",
                "`{name}` を、他のインベケーションがまだ書いていないかもしれない所で読んでいます"
            ),
        };
        let first = match before {
            Kind::Read => message!("read here", "ここで読み込み"),
            _ => message!("written here", "ここで書き込み"),
        };
        let why = match witness {
            Some((a, b)) => message!(
                "invocation {a} of a work group does the first, invocation {b} the second, to one element, and no barrier parts them",
                "ワークグループのインベケーション {a} が前者を、{b} が後者を同じ要素に行い、間にバリアのない経路があります"
            ),
            None => message!(
                "which element the index means is up to data, so that two invocations can meet in one, and no barrier parts them",
                "添字がどの要素を指すかはデータ次第なので、二つのインベケーションが同じ要素に触れることがあり、間にバリアのない経路があります"
            ),
        };
        let barrier = if shader.wgsl().is_some() { "workgroupBarrier()" } else { "barrier()" };
        findings.push(
            findings
                .at(&file.file, later, what)
                .with_related(&file.file, earlier, first)
                .with_why(why)
                .with_help(message!(
                    "put `{barrier}` between them, where all invocations come; in a loop also between its rounds",
                    "両者の間の、全インベケーションが通る所に `{barrier}` を置いてください。ループでは回と回の間にも必要です"
                )),
        );
    }
}

#[cfg(test)]
mod tests;
