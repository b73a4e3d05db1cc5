//! `for (uint i; i < n; i++)`: the counter of a loop that begins with no value, whatever the host puts around the text.

use crate::rule::Findings;
use base::diagnostic::message;
use reading::ShaderFile;
use syntax::ast::{Condition, StmtKind};
use syntax::symbols::SymbolId;

use super::super::walk::{expressions, statements};

/// Reports counters that the condition of their loop reads before anything gives them a value, where the flow of data does
/// not tell it: it is not followed through texts whose host includes others.
pub(super) fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let mut counters: Vec<SymbolId> = Vec::new();
    statements(shader, |stmt| {
        let StmtKind::For { init, condition: Some(Condition::Expr(condition)), .. } = &stmt.kind else { return };
        let StmtKind::Declaration(declaration) = &init.kind else { return };
        let condition = expressions(shader, *condition);
        for declarator in declaration.declarators.iter().filter(|d| d.initializer.is_none()) {
            let declared = shader.symbols().find(|(_, s)| s.span == Some(declarator.name.span));
            let Some((symbol, _)) = declared.filter(|(_, s)| s.ty.scalar().is_some()) else { continue };
            let read = condition.iter().any(|e| shader.symbol_of(*e) == Some(symbol));
            let written = shader.uses_of(symbol).any(|u| u.access.writes() && condition.contains(&u.expr));
            if read && !written {
                counters.push(symbol);
            }
        }
    });
    let known = |symbol: &SymbolId| file.flow().unassigned.iter().any(|read| read.symbol == *symbol);
    for symbol in counters.into_iter().filter(|symbol| !known(symbol)) {
        let info = shader.symbol(symbol);
        let (Some(span), name) = (info.span, &info.name) else { continue };
        findings.push(
            findings
                .at(
                    &file.file,
                    span,
                    message!(
                        "the loop counts with `{name}`, which has no value",
                        "ループのカウンタ `{name}` に値がありません"
                    ),
                )
                .with_label(message!("declared without a value", "値のない宣言"))
                .with_why(message!(
                    "the condition reads it before anything is written to it: how often the loop runs is undefined",
                    "条件は、何も書き込まれないうちにこれを読みます。ループの回数は未定義です"
                ))
                .with_help(message!(
                    "give `{name}` its first value: `{name} = 0`",
                    "最初の値を入れてください: `{name} = 0`"
                )),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::testing::{messages, strict_count};
    use super::super::RULE;

    fn text(head: &str, init: &str) -> String {
        format!(
            "#version 450\n{head}layout(local_size_x = 8) in;\nlayout(std430, binding = 0) buffer D {{ uint d[]; }};\n\
             void main()\n{{\n for ({init}; i < 6u; i++) {{ d[i] = i; }}\n}}\n"
        )
    }

    #[test]
    fn counters_without_a_value_are_told_once_with_and_without_includes() {
        assert_eq!(messages("D001", "a.comp", &text("", "uint i")).len(), 1);
        assert_eq!(strict_count(RULE.code, "a.comp", &text("#include \"x.h\"\n", "uint i")), 1);
        assert_eq!(strict_count(RULE.code, "a.comp", &text("#include \"x.h\"\n", "uint i = 0u")), 0);
        let other = text("#include \"x.h\"\n", "uint n, i = 0u");
        assert_eq!(strict_count(RULE.code, "a.comp", &other), 0, "another one");
    }

    #[test]
    fn variables_of_wgsl_begin_with_zero() {
        let text = "@group(0) @binding(0) var<storage, read_write> d: array<u32>;\n@compute @workgroup_size(8)\n\
                    fn main() {\n for (var i: u32; i < 6u; i++) { d[i] = i; }\n}\n";
        assert_eq!(strict_count(RULE.code, "a.wgsl", text), 0);
    }
}
