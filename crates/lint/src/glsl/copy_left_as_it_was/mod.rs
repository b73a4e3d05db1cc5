//! D021: a copied statement in which one name was not changed with the others.

use std::collections::{BTreeMap, BTreeSet};

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use reading::ShaderFile;
use syntax::Shader;
use syntax::ast::{Block, ExprId, ExprKind, ItemKind, Stmt, StmtKind};
use syntax::symbols::SymbolId;

use super::walk::{expressions, statements};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("D021"),
    name: "copy-left-as-it-was",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Any(check),
};

/// How often a pair must be met elsewhere, to say which name belongs to which.
const PAIRS: usize = 3;

/// `target = value`, with the variables of the value from left to right.
struct Copy {
    id: ExprId,
    target: SymbolId,
    /// The value, with `#` for each of its variables.
    shape: String,
    sources: Vec<SymbolId>,
    /// The block that it stands in.
    block: usize,
}

fn assigned(shader: &Shader, statement: &Stmt, block: usize) -> Option<Copy> {
    let (id, target, value) = match &statement.kind {
        StmtKind::Expr(id) => match shader.expr(*id).kind {
            ExprKind::Assign { op: None, target, value, .. } => (*id, shader.symbol_of(target)?, value),
            _ => return None,
        },
        StmtKind::Declaration(declaration) => {
            let [declarator] = declaration.declarators.as_slice() else { return None };
            let value = declarator.initializer.as_ref()?.value;
            let (target, _) = shader.symbols().find(|(_, s)| s.span == Some(declarator.name.span))?;
            (value, target, value)
        }
        _ => return None,
    };
    let whole = shader.expr(value).span;
    let mut names: Vec<(usize, usize, SymbolId)> = Vec::new();
    for part in expressions(shader, value) {
        let expr = shader.expr(part);
        if expr.from_macro {
            return None;
        }
        if let (ExprKind::Name(_), Some(symbol)) = (&expr.kind, shader.symbol_of(part)) {
            names.push((expr.span.start, expr.span.end, symbol));
        }
    }
    names.sort();
    let (mut shape, mut at) = (String::new(), whole.start);
    for (start, end, _) in &names {
        shape.push_str(shader.file().text().get(at..*start)?);
        shape.push('#');
        at = *end;
    }
    shape.push_str(shader.file().text().get(at..whole.end)?);
    shape.retain(|c| !c.is_whitespace());
    Some(Copy { id, target, shape, sources: names.into_iter().map(|n| n.2).collect(), block })
}

/// The copies of a shader, block by block.
fn copies(shader: &Shader) -> Vec<Copy> {
    let mut blocks: Vec<&Block> = Vec::new();
    for item in &shader.unit().items {
        if let ItemKind::Function(function) = &item.kind {
            blocks.extend(&function.body);
        }
    }
    statements(shader, |statement| match &statement.kind {
        StmtKind::Block(block) | StmtKind::Switch { selector: _, body: block } => blocks.push(block),
        _ => {}
    });
    let all = |(k, block): (usize, &&Block)| -> Vec<Copy> {
        block.statements.iter().filter_map(|s| assigned(shader, s, k)).collect()
    };
    blocks.iter().enumerate().flat_map(all).collect()
}

/// Names that go together: where a statement is repeated with another target, which names change with it.
type Pairs = BTreeMap<(SymbolId, SymbolId), BTreeMap<(SymbolId, SymbolId), usize>>;

/// Pairs of statements of one block and shape, the first above the second, with different targets.
fn repeated(all: &[Copy]) -> impl Iterator<Item = (&Copy, &Copy)> {
    let pairs = all.iter().enumerate().flat_map(|(k, first)| {
        all[k + 1..].iter().take_while(|second| second.block == first.block).map(move |second| (first, second))
    });
    pairs.filter(|(first, second)| {
        first.target != second.target && first.shape == second.shape && !first.sources.is_empty()
    })
}

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let all = copies(shader);
    let mut pairs: Pairs = BTreeMap::new();
    for (first, second) in repeated(&all) {
        let changed = first.sources.iter().zip(&second.sources).filter(|(a, b)| a != b);
        let changed: BTreeSet<(SymbolId, SymbolId)> = changed.map(|(a, b)| (*a, *b)).collect();
        let known = pairs.entry((first.target, second.target)).or_default();
        changed.into_iter().for_each(|pair| *known.entry(pair).or_default() += 1);
    }
    let mut told = BTreeSet::new();
    for (first, second) in repeated(&all).filter(|(first, second)| first.sources == second.sources) {
        let Some(known) = pairs.get(&(first.target, second.target)) else { continue };
        let wanted = first.sources.iter().find_map(|source| {
            // One name alone changes with these targets, and it is there already.
            let mut others = known.iter().filter(|((from, _), _)| from == source);
            let ((_, to), count) = others.next()?;
            let there = shader.symbol(*to).span.is_some_and(|s| s.start < shader.expr(second.id).span.start);
            (others.next().is_none() && *count >= 2 && there).then_some((*source, *to))
        });
        let Some((source, to)) = wanted else { continue };
        if told.insert((first.target, second.target, source)) {
            push(file, findings, second, (first.target, second.target), (source, to));
        }
    }
    irregular(file, &all, findings);
}

/// A target that is made of one certain variable everywhere but here, where it is made of the one of another target.
fn irregular(file: &ShaderFile, all: &[Copy], findings: &mut Findings<'_>) {
    let mut regular: BTreeMap<SymbolId, BTreeMap<SymbolId, usize>> = BTreeMap::new();
    for copy in all {
        if let [source] = copy.sources.as_slice() {
            *regular.entry(copy.target).or_default().entry(*source).or_default() += 1;
        }
    }
    // The one that a target is made of, and how often.
    let usual = |target: SymbolId| {
        let of = regular.get(&target)?;
        let (source, count) = of.iter().max_by_key(|(_, count)| **count)?;
        Some((*source, *count))
    };
    for copy in all {
        let [source] = copy.sources.as_slice() else { continue };
        let Some((own, count)) = usual(copy.target).filter(|(own, _)| own != source) else { continue };
        let alone = regular[&copy.target].iter().all(|(s, n)| *s == own || (s == source && *n == 1));
        // The variable belongs to another target as firmly.
        let other = regular.keys().find(|other| {
            **other != copy.target
                && usual(**other).is_some_and(|(s, n)| s == *source && n >= PAIRS && regular[*other].len() == 1)
        });
        let Some(other) = other.filter(|_| alone && count >= PAIRS) else { continue };
        push(file, findings, copy, (*other, copy.target), (*source, own));
    }
}

fn push(
    file: &ShaderFile,
    findings: &mut Findings<'_>,
    copy: &Copy,
    (first, second): (SymbolId, SymbolId),
    (source, to): (SymbolId, SymbolId),
) {
    let shader = &file.shader;
    let name = |symbol: SymbolId| &shader.symbol(symbol).name;
    let (first, second, source, to) = (name(first), name(second), name(source), name(to));
    findings.push(
        findings
            .at(
                &file.file,
                shader.expr(copy.id).span,
                message!(
                    "`{second}` is made of `{source}` here, and of `{to}` elsewhere",
                    "`{second}` はここでは `{source}`、他では `{to}` から作られています"
                ),
            )
            .with_why(message!(
                "`{source}` goes with `{first}`, and `{to}` with `{second}`: a copied statement seems to have kept the name",
                "`{source}` は `{first}` と、`{to}` は `{second}` と対になっています。写した文に元の名前が残ったようです"
            ))
            .with_help(message!(
                "write `{to}` if it is meant; a comment helps if not",
                "意図が `{to}` なら書き換え、そうでなければコメントを付けてください"
            )),
    );
}

#[cfg(test)]
mod tests {
    use super::super::testing::strict_count;
    use super::*;

    fn count(body: &str) -> usize {
        let text = format!(
            "#version 450\nlayout(local_size_x = 8) in;\nlayout(std430, binding = 0) buffer D {{ int d[]; }};\n\
             layout(binding = 1) uniform P {{ int mode, w, h; }};\nvoid main()\n{{\n int i = int(gl_GlobalInvocationID.x);\n \
             int j = i + 4;\n int x = 0;\n int y = 0;\n int u = 0;\n int v = 0;\n {body}\n d[i] = x + y + u + v;\n}}\n"
        );
        strict_count(RULE.code, "a.comp", &text)
    }

    #[test]
    fn a_name_that_stayed_is_reported() {
        let rest = "if (mode == 1) { x = i / h; y = i % h; u = j / h; v = j % h; }\n\
                    if (mode == 2) { x = i / 3; y = i % 3; u = j / 3; v = j % 3; }";
        assert_eq!(count(&format!("if (mode == 0) {{ x = i / w; y = i % w; u = i / w; v = j % w; }} {rest}")), 1);
        assert_eq!(count(&format!("if (mode == 0) {{ x = i / w; y = i % w; u = j / w; v = j % w; }} {rest}")), 0);
        let rest = "if (mode == 1) { x = 1; u = x; y = 3; v = y + 4; } if (mode == 2) { u = x + 4; v = y; }\n\
                    if (mode == 3) { u = x; v = y + 1; }";
        assert_eq!(count(&format!("if (mode == 0) {{ u = x; v = x; }} {rest}")), 1);
        assert_eq!(count(&format!("if (mode == 0) {{ u = x; v = y; }} {rest}")), 0);
    }

    #[test]
    fn what_is_repeated_on_purpose_is_not() {
        assert_eq!(count("x = i / w; u = i / w; y = i % w; v = i % w;"), 0);
        assert_eq!(count("x = i; u = j; y = i; v = j; u = i;"), 0);
    }
}
