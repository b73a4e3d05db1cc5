//! G002: more vertices declared than a geometry stage can emit.

use std::collections::BTreeSet;

use crate::diagnostic::{Code, Safety, Severity};
use crate::glsl::ast::{BinaryOp, Callee, Condition, ExprId, ExprKind, Stmt, StmtKind, UnaryOp};
use crate::glsl::symbols::{CallTarget, SymbolId};
use crate::glsl::{Shader, Stage};
use crate::lint::project::ShaderFile;
use crate::lint::rule::{Check, Example, Findings, Japanese, Level, Page, Rule};
use crate::text::Edit;

use super::walk::expressions;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("G002"),
    name: "max-vertices-too-large",
    severity: Severity::Info,
    level: Level::Default,
    summary: "a geometry stage declares more vertices than it can emit",
    page: Page {
        what: "Reports a `max_vertices` above the largest number of vertices that `main` can emit. It speaks only \
               when that number is known: every loop around `EmitVertex` counts from one constant to another.",
        why: "The output space of a primitive is set aside by the declared number, whatever is emitted: fewer \
              primitives are worked on at a time, and limits on the total of components are met sooner.",
        bad: &[Example {
            name: "pass.geom",
            text: "#version 150 core\nlayout (lines) in;\nlayout (line_strip, max_vertices = 8) out;\nvoid main(void)\n{\n  \
                   for (int i = 0; i < 2; ++i)\n  {\n    gl_Position = gl_in[i].gl_Position;\n    EmitVertex();\n  }\n}\n",
        }],
        good: &[Example {
            name: "pass.geom",
            text: "#version 150 core\nlayout (lines) in;\nlayout (line_strip, max_vertices = 2) out;\nvoid main(void)\n{\n  \
                   for (int i = 0; i < 2; ++i)\n  {\n    gl_Position = gl_in[i].gl_Position;\n    EmitVertex();\n  }\n}\n",
        }],
        fix: "Declares the number that can be emitted. Unsafe: a constant that is changed later needs the \
              declaration to be changed with it.",
        references: &[
            "OpenGL 3.2 core specification, section 2.12.4 \"Geometry Shader Execution Environment\"",
            "GLSL 1.50 specification, section 4.3.8.2 \"Output Layout Qualifiers\"",
        ],
        ja: Japanese {
            summary: "ジオメトリシェーダが、出力しうる数より多い頂点数を宣言しています",
            what: "`main` が出力しうる頂点の最大数より大きい `max_vertices` を報告します。`EmitVertex` を囲むループの回数がすべて定数で決まり、その数が分かるときだけ報告します。",
            why: "プリミティブの出力領域は、実際の出力数にかかわらず宣言した数だけ確保されます。同時に処理できるプリミティブが減り、成分の総数の上限にも早く達します。",
            fix: "出力しうる数を宣言します。unsafe: 後で定数を変えるときは、この宣言も合わせて変える必要があります。",
        },
    },
    check: Check::Shader(check),
};

/// Loops with more rounds than any `max_vertices` are not counted out.
const MOST_ROUNDS: u64 = 65_536;

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    if shader.stage() != Stage::Geometry || !file.is_sound() {
        return;
    }
    let layouts = &shader.interface().stage_layouts;
    let mut entries = layouts.iter().filter_map(|l| l.qualifiers.layout_entry("max_vertices"));
    let (Some(entry), None) = (entries.next(), entries.next()) else { return };
    let Some(declared) = shader.interface().geometry.max_vertices else { return };
    let Some(emitted) = (Emits { shader, calling: BTreeSet::new() }).function("main") else { return };
    // A stage that emits nothing has another fault.
    if emitted == 0 || emitted >= u64::from(declared.value) {
        return;
    }
    let are = if emitted == 1 { "is" } else { "are" };
    let mut found = findings
        .at(
            &file.file,
            declared.span,
            format!("{} vertices are declared, at most {emitted} {are} emitted", declared.value),
        )
        .with_label(format!("{emitted} would do"))
        .with_why("output space is set aside by the declared number, so that fewer primitives are worked on at a time")
        .with_help(format!("declare `max_vertices = {emitted}`"));
    if let Some(value) = entry.value.map(|v| shader.expr(v)).filter(|v| !v.from_macro) {
        let edit = Edit::replace(value.span, emitted.to_string());
        found = found.with_fix(format!("declare {emitted}"), Safety::Unsafe, vec![edit]);
    }
    findings.push(found);
}

/// Counts the most vertices that a piece of the shader can emit; none when that is not known.
struct Emits<'s> {
    shader: &'s Shader,
    /// Functions being counted: a shader must not recurse, but a text may.
    calling: BTreeSet<String>,
}

impl<'s> Emits<'s> {
    fn function(&mut self, name: &str) -> Option<u64> {
        // Overloads are not told apart: the largest counts.
        if !self.calling.insert(name.to_owned()) {
            return None;
        }
        let mut most = 0;
        for (_, info) in self.shader.functions().filter(|(_, f)| f.name.name == name) {
            let body = self.shader.function_syntax(info)?.body.as_ref()?;
            most = most.max(self.block(&body.statements)?);
        }
        self.calling.remove(name);
        Some(most)
    }

    fn block(&mut self, statements: &'s [Stmt]) -> Option<u64> {
        statements.iter().try_fold(0u64, |sum, s| sum.checked_add(self.statement(s)?))
    }

    fn statement(&mut self, stmt: &'s Stmt) -> Option<u64> {
        match &stmt.kind {
            StmtKind::Expr(e) => self.expression(*e),
            StmtKind::Declaration(d) => {
                let values = d.declarators.iter().filter_map(|d| d.initializer.as_ref());
                values.map(|i| i.value).try_fold(0u64, |sum, v| sum.checked_add(self.expression(v)?))
            }
            StmtKind::Block(block) => self.block(&block.statements),
            StmtKind::If { condition, then, otherwise } => {
                let head = self.expression(*condition)?;
                let then = self.statement(then)?;
                let otherwise = otherwise.as_deref().map_or(Some(0), |o| self.statement(o))?;
                head.checked_add(then.max(otherwise))
            }
            StmtKind::For { init, condition, step, body, head_span: _ } => {
                let head = match condition {
                    Some(Condition::Expr(c)) => self.expression(*c)?,
                    Some(Condition::Declaration(_)) => return None,
                    None => 0,
                };
                let step_emits = step.map_or(Some(0), |s| self.expression(s))?;
                let round = self.statement(body)?;
                if head + step_emits > 0 {
                    return None;
                }
                let init_emits = self.statement(init)?;
                let all = if round == 0 {
                    0
                } else {
                    round.checked_mul(self.rounds(init, condition.as_ref(), *step, body)?)?
                };
                init_emits.checked_add(all)
            }
            StmtKind::While { condition, body } => {
                let head = match condition {
                    Condition::Expr(c) => self.expression(*c)?,
                    Condition::Declaration(_) => return None,
                };
                (head == 0 && self.statement(body)? == 0).then_some(0)
            }
            StmtKind::DoWhile { body, condition } => {
                (self.statement(body)? == 0 && self.expression(*condition)? == 0).then_some(0)
            }
            // All cases together: with fall-through each of them may run.
            StmtKind::Switch { selector, body } => {
                self.expression(*selector)?.checked_add(self.block(&body.statements)?)
            }
            StmtKind::Case(e) | StmtKind::Return(Some(e)) => self.expression(*e),
            StmtKind::Empty
            | StmtKind::Precision(_)
            | StmtKind::Qualified(_)
            | StmtKind::Default
            | StmtKind::Return(None)
            | StmtKind::Break
            | StmtKind::Continue
            | StmtKind::Discard => Some(0),
            StmtKind::Error => None,
        }
    }

    fn expression(&mut self, root: ExprId) -> Option<u64> {
        let mut sum = 0u64;
        for id in expressions(self.shader, root) {
            let ExprKind::Call { callee: Callee::Name(name), args: _ } = &self.shader.expr(id).kind else { continue };
            let emits = match (self.shader.callee(id), name.name.as_str()) {
                (Some(CallTarget::Builtin(_)), "EmitVertex" | "EmitStreamVertex") => 1,
                (Some(CallTarget::User(_)), name) => self.function(name)?,
                (Some(CallTarget::Builtin(_) | CallTarget::Constructor(_)), _) => 0,
                (None, _) => return None,
            };
            sum = sum.checked_add(emits)?;
        }
        Some(sum)
    }

    /// Rounds of `for (int i = a; i < b; i += c)` with constants, when the body leaves `i` alone.
    fn rounds(&self, init: &Stmt, condition: Option<&Condition>, step: Option<ExprId>, body: &Stmt) -> Option<u64> {
        let shader = self.shader;
        let StmtKind::Declaration(declaration) = &init.kind else { return None };
        let [declarator] = declaration.declarators.as_slice() else { return None };
        let start = shader.fold(declarator.initializer.as_ref()?.value)?.as_integer()?;
        let (counter, _) = shader.symbols().find(|(_, s)| s.span == Some(declarator.name.span))?;
        let Some(Condition::Expr(condition)) = condition else { return None };
        let step_id = step?;
        let step = self.step(step_id, counter)?;
        let step_span = shader.expr(step_id).span;
        let written_elsewhere =
            shader.uses_of(counter).any(|u| u.access.writes() && (u.from_macro || !step_span.contains(u.span.start)));
        if written_elsewhere || shader.expr(step_id).from_macro || body.span.is_empty() {
            return None;
        }
        let ExprKind::Binary { op, op_span: _, left, right } = shader.expr(*condition).kind else { return None };
        if shader.symbol_of(left) != Some(counter) {
            return None;
        }
        let end = shader.fold(right)?.as_integer()?;
        let distance = match (op, step > 0) {
            (BinaryOp::Less, true) => end - start,
            (BinaryOp::LessEqual, true) => end - start + 1,
            (BinaryOp::Greater, false) => start - end,
            (BinaryOp::GreaterEqual, false) => start - end + 1,
            _ => return None,
        };
        let rounds = u64::try_from(distance.max(0)).ok()?.div_ceil(step.unsigned_abs());
        (rounds <= MOST_ROUNDS).then_some(rounds)
    }

    /// What a step adds to the counter; never 0.
    fn step(&self, step: ExprId, counter: SymbolId) -> Option<i64> {
        let shader = self.shader;
        let (target, by) = match shader.expr(step).kind {
            ExprKind::Unary { op: UnaryOp::Increment, op_span: _, operand } => (operand, 1),
            ExprKind::Unary { op: UnaryOp::Decrement, op_span: _, operand } => (operand, -1),
            ExprKind::Postfix { increment, op_span: _, operand } => (operand, if increment { 1 } else { -1 }),
            ExprKind::Assign { op: Some(BinaryOp::Add), op_span: _, target, value } => {
                (target, shader.fold(value)?.as_integer()?)
            }
            ExprKind::Assign { op: Some(BinaryOp::Sub), op_span: _, target, value } => {
                (target, -shader.fold(value)?.as_integer()?)
            }
            _ => return None,
        };
        (shader.symbol_of(target) == Some(counter) && by != 0).then_some(by)
    }
}

#[cfg(test)]
mod tests {
    use crate::lint::{Input, run};
    use crate::text::SourceFile;

    /// The message for a geometry stage with 20 declared vertices and this body.
    fn lint(before: &str, body: &str) -> Option<String> {
        let text = format!(
            "#version 150 core\nlayout (points) in;\nlayout (points, max_vertices = 20) out;\nuniform int n;\n{before}\nvoid main(void)\n{{\n  gl_Position = gl_in[0].gl_Position;\n  {body}\n}}\n"
        );
        let found = run(&[Input::new(SourceFile::new("a.geom", text))]);
        assert!(found.iter().all(|d| d.code.0 == "G002"), "{found:#?}");
        found.first().map(|d| d.message.to_string())
    }

    fn told(n: u32) -> Option<String> {
        let are = if n == 1 { "is" } else { "are" };
        Some(format!("20 vertices are declared, at most {n} {are} emitted"))
    }

    #[test]
    fn counts_what_can_be_emitted() {
        assert_eq!(lint("", "EmitVertex();"), told(1));
        assert_eq!(lint("const int division = 4;", "for (int i = 0; i <= division; ++i) EmitVertex();"), told(5));
        assert_eq!(lint("", "for (int i = 6; i > 0; i -= 2) { EmitVertex(); EmitVertex(); }"), told(6));
        assert_eq!(lint("", "if (n > 0) { EmitVertex(); EmitVertex(); } else EmitVertex();"), told(2));
        assert_eq!(lint("void two() { EmitVertex(); EmitVertex(); }", "two(); two();"), told(4));
        assert_eq!(
            lint(
                "",
                "for (int i = 0; i < 3; ++i) { for (int j = 0; j < 3; j++) { if (j == n) break; EmitVertex(); } }"
            ),
            told(9)
        );
    }

    #[test]
    fn is_silent_when_the_number_is_not_known_or_fits() {
        for body in [
            "for (int i = 0; i < n; ++i) EmitVertex();",
            "while (true) { EmitVertex(); break; }",
            "for (int i = 0; i < 4; ++i) { EmitVertex(); --i; }",
            "for (int i = 0; i < 20; ++i) EmitVertex();",
            "for (int i = 0; i < 30; ++i) EmitVertex();",
            "for (int i = 0; i != 4; ++i) EmitVertex();",
            "EndPrimitive();",
        ] {
            assert_eq!(lint("", body), None, "{body}");
        }
    }
}
