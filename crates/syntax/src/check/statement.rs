//! Statements and function bodies.

use super::super::ast::{Block, Condition, ExprId, Stmt, StmtKind};
use super::super::types::{ScalarType, Type};
use super::super::{Stage, errors};
use super::Checker;
use super::expression::article;
use base::diagnostic::{Message, message};
use base::text::Span;

/// What is around a statement.
#[derive(Clone, Debug, Default)]
pub(super) struct Around {
    in_loop: bool,
    switch: Option<Switch>,
    /// Inside a block or a branch of the switch, where no label may stand.
    nested: bool,
    /// Inside something that not every invocation runs once.
    branched: bool,
}

#[derive(Clone, Debug)]
struct Switch {
    selector: Type,
    labels: Vec<i64>,
    default: bool,
}

impl Switch {
    fn new(selector: Type) -> Self {
        Self { selector, labels: Vec::new(), default: false }
    }
}

impl Around {
    pub(super) fn is_branched(&self) -> bool {
        self.branched
    }

    /// Marks a nested statement; gives what was before.
    fn enter_nested(&mut self) -> Self {
        let before = self.clone();
        self.nested = true;
        before
    }
}

impl Checker<'_> {
    fn in_loop(&mut self, run: impl FnOnce(&mut Self)) {
        let inner = Around { in_loop: true, switch: None, nested: false, branched: true };
        let outer = std::mem::replace(&mut self.around, inner);
        run(self);
        self.around = outer;
    }

    pub(super) fn misplaced(&mut self, word: &str, why: Message, span: Span) {
        let message = message!("`{word}` cannot stand here", "`{word}` はここに書けません");
        let d = self.sink.start(errors::PLACEMENT, span, message).with_label(message!("here", "ここ")).with_why(why);
        self.sink.push(d);
    }

    /// A `case` with its value, or `default`.
    fn label(&mut self, value: Option<ExprId>, span: Span) {
        let word = if value.is_some() { "case" } else { "default" };
        if self.around.nested || self.around.switch.is_none() {
            return self.misplaced(
                word,
                message!("it belongs directly into a `switch`", "`switch` の直下に書くラベルです"),
                span,
            );
        }
        let Some(mut switch) = self.around.switch.take() else { return };
        match value {
            None if switch.default => {
                let message =
                    message!("a second `default` in one `switch`", "一つの `switch` に二つ目の `default` があります");
                self.sink.error(errors::PLACEMENT, span, message, message!("second one", "二つ目"));
            }
            None => switch.default = true,
            Some(value) => self.case(value, &mut switch),
        }
        self.around.switch = Some(switch);
    }

    fn case(&mut self, value: ExprId, switch: &mut Switch) {
        let ty = self.type_of(value).clone();
        let span = self.arena.get(value).span;
        if ty.is_error() {
            return;
        }
        let integer = ty.is_scalar() && ty.scalar().is_some_and(ScalarType::is_integer);
        let agrees = switch.selector.is_error()
            || ty == switch.selector
            || (integer && (self.conversions.int_to_uint || self.language.is_open()));
        if !integer || !agrees {
            let selector = &switch.selector;
            let message = message!(
                "a label of `{ty}` for a selector of `{selector}`",
                "`{selector}` の値を `{ty}` のラベルと比べています"
            );
            return self.sink.error(errors::CONDITION_TYPE, span, message, message!("this is `{ty}`", "これは `{ty}`"));
        }
        if !self.is_constant(value) {
            let message = message!("the value of `case` must be constant", "`case` の値は定数でなければなりません");
            return self.sink.error(errors::CONSTANT, span, message, message!("not constant", "定数ではない"));
        }
        let Some(number) = self.value_of(value).and_then(super::super::fold::Const::as_integer) else { return };
        if switch.labels.contains(&number) {
            let message = message!("a second `case {number}`", "二つ目の `case {number}` です");
            return self.sink.error(errors::PLACEMENT, span, message, message!("second one", "二つ目"));
        }
        switch.labels.push(number);
    }

    /// Statements of a block, in a scope that exists already.
    pub(super) fn statements(&mut self, block: &Block) {
        for statement in &block.statements {
            self.statement(statement);
        }
    }

    /// The body of a loop whose head may declare something: one scope holds both (GLSL 4.60 specification, section 6.3).
    fn body(&mut self, body: &Stmt) {
        match &body.kind {
            StmtKind::Block(block) => {
                let around = self.around.enter_nested();
                self.statements(block);
                self.around = around;
            }
            _ => self.statement(body),
        }
    }

    fn statement(&mut self, statement: &Stmt) {
        match &statement.kind {
            StmtKind::Empty => {}
            // It may be a `return`.
            StmtKind::Error => self.returned = true,
            StmtKind::Precision(precision) => self.precision_statement(precision),
            StmtKind::Default => self.label(None, statement.span),
            StmtKind::Break if !self.around.in_loop && self.around.switch.is_none() => {
                self.misplaced(
                    "break",
                    message!("it leaves a loop or a `switch`", "ループか `switch` を抜ける文です"),
                    statement.span,
                );
            }
            StmtKind::Continue if !self.around.in_loop => {
                self.misplaced(
                    "continue",
                    message!("it belongs into a loop", "ループの中に書く文です"),
                    statement.span,
                );
            }
            StmtKind::Discard if !matches!(self.stage, Stage::Fragment | Stage::Library) => {
                self.misplaced(
                    "discard",
                    message!("only fragment shaders have it", "フラグメントシェーダだけの文です"),
                    statement.span,
                );
            }
            StmtKind::Break | StmtKind::Continue | StmtKind::Discard => {}
            StmtKind::Declaration(declaration) => self.local_declaration(declaration),
            StmtKind::Qualified(names) => self.qualified_names(names),
            StmtKind::Expr(value) => {
                self.expression(*value);
            }
            StmtKind::Block(block) => {
                let around = self.around.enter_nested();
                self.scoped(|this| this.statements(block));
                self.around = around;
            }
            StmtKind::If { condition, then, otherwise } => {
                let nested = self.around.enter_nested();
                self.bool_condition(*condition, "the condition of `if`");
                self.around.branched = true;
                self.scoped(|this| this.statement(then));
                if let Some(otherwise) = otherwise {
                    self.scoped(|this| this.statement(otherwise));
                }
                self.around = nested;
            }
            StmtKind::For { init, condition, step, body, head_span: _ } => self.scoped(|this| {
                this.statement(init);
                if let Some(condition) = condition {
                    this.condition(condition, "the condition of `for`");
                }
                if let Some(step) = step {
                    this.expression(*step);
                }
                this.in_loop(|this| this.body(body));
            }),
            StmtKind::While { condition, body } => self.scoped(|this| {
                this.condition(condition, "the condition of `while`");
                this.in_loop(|this| this.body(body));
            }),
            StmtKind::DoWhile { body, condition } => {
                self.in_loop(|this| this.scoped(|this| this.statement(body)));
                self.bool_condition(*condition, "the condition of `while`");
            }
            StmtKind::Switch { selector, body } => {
                let ty = self.expression(*selector);
                let integer = ty.is_scalar() && ty.scalar().is_some_and(ScalarType::is_integer);
                if !integer && !ty.is_error() {
                    let message = format!("`switch` needs an integer, not {} `{ty}`", article(&ty));
                    let span = self.arena.get(*selector).span;
                    self.sink.error(errors::CONDITION_TYPE, span, message, "selector");
                }
                let switch = Some(Switch::new(ty));
                let inner = Around { in_loop: self.around.in_loop, switch, nested: false, branched: true };
                let outer = std::mem::replace(&mut self.around, inner);
                if let Some(first) = body.statements.first()
                    && !matches!(first.kind, StmtKind::Case(_) | StmtKind::Default | StmtKind::Error)
                {
                    let message =
                        message!("a statement stands before the first label", "最初のラベルの前に文があります");
                    let label = message!("never reached", "実行されない文");
                    self.sink.error(errors::PLACEMENT, first.span, message, label);
                }
                if let Some(last) = body.statements.last()
                    && matches!(last.kind, StmtKind::Case(_) | StmtKind::Default)
                    && self.language.es()
                {
                    let message = message!("the last label has no statement", "最後のラベルに文がありません");
                    let label = message!("add `break;`", "`break;` を足してください");
                    self.sink.error(errors::PLACEMENT, last.span, message, label);
                }
                self.scoped(|this| this.statements(body));
                self.around = outer;
            }
            StmtKind::Case(value) => {
                self.expression(*value);
                self.label(Some(*value), statement.span);
            }
            StmtKind::Return(value) => {
                self.returned = true;
                self.return_statement(*value, statement.span);
            }
        }
    }

    fn condition(&mut self, condition: &Condition, what: &str) {
        match condition {
            Condition::Expr(value) => self.bool_condition(*value, what),
            Condition::Declaration(declaration) => {
                self.local_declaration(declaration);
                let ty = self.out.symbols.last().map_or(Type::Error, |s| s.ty.clone());
                if !ty.is_error() && ty != Type::BOOL {
                    let message = message!(
                        "{what} must be a `bool`, not a `{ty}`",
                        "条件は `bool` でなければなりません（`{ty}` です）"
                    );
                    self.sink.error(
                        errors::CONDITION_TYPE,
                        declaration.span,
                        message,
                        message!("declared here", "ここで宣言"),
                    );
                }
            }
        }
    }

    fn bool_condition(&mut self, value: ExprId, what: &str) {
        self.expression(value);
        self.require_bool(value, what);
    }

    fn return_statement(&mut self, value: Option<ExprId>, span: Span) {
        let given = match value {
            Some(value) => self.expression(value),
            None => Type::Void,
        };
        let Some((function, wanted)) = self.current.clone() else { return };
        if self.conversions.allow(&given, &wanted) {
            if let Some(value) = value {
                self.implicit(value, &given, &wanted);
            }
            if let (Some(value), Type::Void) = (value, &wanted)
                && given == Type::Void
            {
                let message = message!(
                    "`return` of a function without a value takes none",
                    "値を返さない関数の `return` に式は書けません"
                );
                let span = self.arena.get(value).span;
                self.sink.error(errors::RETURN_TYPE, span, message, message!("returned here", "ここで返しています"));
            }
            return;
        }
        let name = &self.out.functions[function.index()].name.name;
        let (span, message) = match value {
            None => {
                (span, format!("`return` without a value in `{name}`, which returns {} `{wanted}`", article(&wanted)))
            }
            Some(value) if wanted == Type::Void => {
                (self.arena.get(value).span, format!("`{name}` returns nothing, but a value is returned"))
            }
            Some(value) => (
                self.arena.get(value).span,
                format!(
                    "{} `{given}` is returned from `{name}`, which returns {} `{wanted}`",
                    article(&given),
                    article(&wanted)
                ),
            ),
        };
        self.sink.error(errors::RETURN_TYPE, span, message, "returned here");
    }
}
