//! From the syntax tree to the graph of paths.

use std::collections::HashMap;

use base::text::Span;
use syntax::ast::{BinaryOp, Block as Body, Condition, Declaration, ExprId, ExprKind, Stmt, StmtKind};
use syntax::interface::Storage;
use syntax::symbols::{Direction, FunctionId, SymbolId, SymbolKind};
use syntax::types::Type;
use syntax::{Const, Shader, Stage};

use super::graph::{Block, Edge, Event, Graph, Kind, Store, Variable};
use super::place::full;

/// Graphs with more blocks or events are given up.
const MOST: usize = 6_000;

/// The graph of a function; none when it recurses, calls what has no body, or is too large. Global
/// variables have no value at the start of `main`, unless they are initialised, and have one at the start
/// of any other function.
pub fn graph(shader: &Shader, root: FunctionId) -> Option<Graph> {
    let mut declared = HashMap::new();
    for (id, symbol) in shader.symbols().filter(|(_, s)| s.kind == SymbolKind::Local) {
        // Names from a macro may share their place.
        if declared.insert(symbol.span?, id).is_some() {
            return None;
        }
    }
    let mut builder = Builder {
        shader,
        declared,
        graph: Graph { blocks: vec![Block::default()], exit: 0, variables: Vec::new(), functions: Vec::new() },
        variables: HashMap::new(),
        current: 0,
        frames: Vec::new(),
        copies: 0,
        loops: 0,
        events: 0,
        assigning: None,
        failed: false,
    };
    builder.root(root);
    let small = builder.graph.blocks.len() * builder.graph.variables.len() <= 2_000_000;
    (!builder.failed && small).then_some(builder.graph)
}

/// True when the variable is followed: it can be written, and what it holds comes from the paths.
fn is_followed(shader: &Shader, id: SymbolId) -> bool {
    let symbol = shader.symbol(id);
    let outputs = shader.stage() != Stage::TessControl;
    let of_block =
        |index: usize| outputs && shader.interface().blocks.get(index).is_some_and(|b| b.storage == Storage::Out);
    !symbol.read_only
        && match symbol.kind {
            SymbolKind::Local | SymbolKind::Param(_) | SymbolKind::Global(Storage::Global) => true,
            // What one stage writes, the stage that is not known may be given.
            SymbolKind::Builtin if shader.stage() == Stage::Library => !syntax::is_given_by_a_stage(&symbol.name),
            SymbolKind::Global(Storage::Out) | SymbolKind::Builtin => outputs,
            SymbolKind::BlockMember(index) | SymbolKind::BlockInstance(index) => of_block(index),
            SymbolKind::Global(Storage::In | Storage::Uniform | Storage::Buffer | Storage::Shared | Storage::Const) => {
                false
            }
        }
}

pub(super) struct Frame {
    pub(super) function: FunctionId,
    pub(super) copy: u32,
    pub(super) exit: usize,
    pub(super) breaks: Vec<usize>,
    pub(super) continues: Vec<usize>,
}

pub(super) struct Builder<'s> {
    pub(super) shader: &'s Shader,
    pub(super) declared: HashMap<Span, SymbolId>,
    pub(super) graph: Graph,
    pub(super) variables: HashMap<(SymbolId, u32), usize>,
    pub(super) current: usize,
    pub(super) frames: Vec<Frame>,
    pub(super) copies: u32,
    pub(super) loops: u32,
    pub(super) events: usize,
    /// The variable whose next value is being computed.
    pub(super) assigning: Option<SymbolId>,
    pub(super) failed: bool,
}

impl<'s> Builder<'s> {
    pub(super) fn block(&mut self) -> usize {
        if self.graph.blocks.len() >= MOST {
            self.failed = true;
            return 0;
        }
        self.graph.blocks.push(Block::default());
        self.graph.blocks.len() - 1
    }

    pub(super) fn edge(&mut self, from: usize, to: usize, weak: bool) {
        self.graph.blocks[from].next.push(Edge { to, weak });
    }

    /// Goes on in a new block behind the current one.
    pub(super) fn go_on(&mut self) -> usize {
        let next = self.block();
        self.edge(self.current, next, false);
        self.current = next;
        next
    }

    pub(super) fn event(&mut self, kind: Kind, variable: usize, mask: u64, span: Span, expr: Option<ExprId>) {
        self.events += 1;
        if self.events > MOST * 4 {
            self.failed = true;
        } else {
            self.graph.blocks[self.current].events.push(Event { kind, variable, mask, span, expr });
        }
    }

    pub(super) fn variable(&mut self, symbol: SymbolId) -> Option<usize> {
        if !is_followed(self.shader, symbol) {
            return None;
        }
        let info = self.shader.symbol(symbol);
        let own = matches!(info.kind, SymbolKind::Local | SymbolKind::Param(_));
        let copy = if own { self.frames.last().map_or(0, |f| f.copy) } else { 0 };
        let loops = if own { self.loops } else { 0 };
        let variables = &mut self.graph.variables;
        Some(*self.variables.entry((symbol, copy)).or_insert_with(|| {
            variables.push(Variable { symbol, full: full(&info.ty), loops });
            variables.len() - 1
        }))
    }

    fn root(&mut self, root: FunctionId) {
        let shader = self.shader;
        let info = shader.function_info(root);
        let is_main = info.name.name == "main";
        let Some(body) = shader.function_syntax(info).and_then(|f| f.body.as_ref()) else {
            self.failed = true;
            return;
        };
        for (id, symbol) in shader.symbols() {
            let global = !matches!(symbol.kind, SymbolKind::Local | SymbolKind::Param(_));
            if !global || !is_followed(shader, id) {
                continue;
            }
            let variable = shader.interface().variables().find(|v| v.symbol == id);
            let given = variable.is_some_and(|v| {
                use syntax::ast::StorageQualifier::InOut;
                v.initializer.is_some() || v.qualifiers.storage().is_some_and(|(s, _)| s == InOut)
            });
            let Some(variable) = self.variable(id) else { continue };
            let span = symbol.span.unwrap_or_default();
            if given || !is_main {
                self.event(Kind::Write { exact: true, store: Store::Passed }, variable, full(&symbol.ty), span, None);
            } else {
                self.event(Kind::Declare, variable, full(&symbol.ty), span, None);
            }
        }
        let exit = self.block();
        self.graph.exit = exit;
        self.frames.push(Frame { function: root, copy: 0, exit, breaks: Vec::new(), continues: Vec::new() });
        self.graph.functions.push(root);
        for param in &info.params {
            let Some(variable) = param.symbol.and_then(|s| self.variable(s)) else { continue };
            let kind = match param.direction {
                Direction::In | Direction::InOut => Kind::Write { exact: true, store: Store::Passed },
                Direction::Out => Kind::Declare,
            };
            self.event(kind, variable, full(&param.ty), param.span, None);
        }
        self.body(body, &info.return_type);
    }

    pub(super) fn body(&mut self, body: &'s Body, returns: &Type) {
        self.statements(&body.statements);
        if *returns != Type::Void {
            let root = self.frames.len() == 1;
            self.event(Kind::NoReturn { root }, 0, 0, body.span, None);
        }
        if let Some(exit) = self.frames.last().map(|f| f.exit) {
            self.edge(self.current, exit, false);
            self.current = exit;
        }
    }

    fn statements(&mut self, statements: &'s [Stmt]) {
        for statement in statements {
            self.statement(statement, false);
        }
    }

    /// A statement; `chained` when it is the `else` of an `if`.
    fn statement(&mut self, statement: &'s Stmt, chained: bool) {
        if self.failed {
            return;
        }
        match &statement.kind {
            StmtKind::Empty | StmtKind::Precision(_) | StmtKind::Qualified(_) => {}
            StmtKind::Declaration(declaration) => self.declaration(declaration),
            StmtKind::Expr(value) => self.value(*value),
            StmtKind::Block(block) => self.statements(&block.statements),
            StmtKind::If { condition, then, otherwise } => self.branch(*condition, then, otherwise.as_deref(), chained),
            StmtKind::For { init, condition, step, body, head_span: _ } => {
                self.statement(init, false);
                let entered = self.enters(init, condition.as_ref());
                self.repeat(condition.as_ref(), *step, body, entered);
            }
            StmtKind::While { condition, body } => self.repeat(Some(condition), None, body, false),
            StmtKind::DoWhile { body, condition } => self.do_while(body, *condition),
            StmtKind::Switch { selector, body } => self.switch(*selector, body),
            // Labels are met in `switch`.
            StmtKind::Case(_) | StmtKind::Default => {}
            StmtKind::Return(value) => {
                if let Some(value) = value {
                    self.value(*value);
                }
                let exit = self.frames.last().map(|f| f.exit);
                self.jump(exit);
            }
            StmtKind::Break => {
                let to = self.frames.last().and_then(|f| f.breaks.last().copied());
                self.jump(to);
            }
            StmtKind::Continue => {
                let to = self.frames.last().and_then(|f| f.continues.last().copied());
                self.jump(to);
            }
            StmtKind::Discard => self.current = self.block(),
            StmtKind::Error => self.failed = true,
        }
    }

    fn jump(&mut self, to: Option<usize>) {
        match to {
            Some(to) => self.edge(self.current, to, false),
            None => self.failed = true,
        }
        self.current = self.block();
    }

    fn declaration(&mut self, declaration: &'s Declaration) {
        for declarator in &declaration.declarators {
            if let Some(initializer) = &declarator.initializer {
                self.value(initializer.value);
            }
            let Some(&symbol) = self.declared.get(&declarator.name.span) else { continue };
            let Some(variable) = self.variable(symbol) else { continue };
            let mask = full(&self.shader.symbol(symbol).ty);
            self.event(Kind::Declare, variable, mask, declarator.name.span, None);
            if declarator.initializer.is_some() {
                let kind = Kind::Write { exact: true, store: Store::Initial };
                self.event(kind, variable, mask, declarator.name.span, None);
            }
        }
    }

    fn branch(&mut self, condition: ExprId, then: &'s Stmt, otherwise: Option<&'s Stmt>, chained: bool) {
        self.value(condition);
        let known = self.known(condition);
        let head = self.current;
        let yes = self.block();
        if known != Some(false) {
            self.edge(head, yes, false);
        }
        self.current = yes;
        self.statement(then, false);
        let after_yes = self.current;
        let no = self.block();
        if known != Some(true) {
            let weak = otherwise.is_none() && (chained || self.compares_with_constant(condition));
            self.edge(head, no, weak);
        }
        self.current = no;
        if let Some(otherwise) = otherwise {
            self.statement(otherwise, true);
        }
        self.go_on();
        self.edge(after_yes, self.current, false);
    }

    fn known(&self, condition: ExprId) -> Option<bool> {
        match self.shader.fold(condition)? {
            Const::Bool(value) => Some(value),
            Const::Int(_) | Const::Uint(_) | Const::Float(_) | Const::Double(_) => None,
        }
    }

    /// True for `a == 3`: one of several values that the host may know to be all.
    fn compares_with_constant(&self, condition: ExprId) -> bool {
        match self.shader.expr(condition).kind {
            ExprKind::Paren(inner) => self.compares_with_constant(inner),
            ExprKind::Binary { op: BinaryOp::Equal, op_span: _, left, right } => {
                self.shader.fold(left).is_some() || self.shader.fold(right).is_some()
            }
            _ => false,
        }
    }

    /// True when the first test of a `for` is known to hold.
    fn enters(&self, init: &Stmt, condition: Option<&Condition>) -> bool {
        let shader = self.shader;
        let start = match &init.kind {
            StmtKind::Declaration(d) => match d.declarators.as_slice() {
                [one] => one
                    .initializer
                    .as_ref()
                    .and_then(|i| Some((*self.declared.get(&one.name.span)?, shader.fold(i.value)?))),
                _ => None,
            },
            StmtKind::Expr(e) => match shader.expr(*e).kind {
                ExprKind::Assign { op: None, op_span: _, target, value } => {
                    shader.symbol_of(target).zip(shader.fold(value))
                }
                _ => None,
            },
            _ => None,
        };
        let (Some((counter, start)), Some(Condition::Expr(condition))) = (start, condition) else { return false };
        let ExprKind::Binary { op, op_span: _, left, right } = shader.expr(*condition).kind else { return false };
        if shader.symbol_of(left) != Some(counter) {
            return false;
        }
        let (Some(start), Some(end)) = (start.as_f64(), shader.fold(right).and_then(Const::as_f64)) else {
            return false;
        };
        match op {
            BinaryOp::Less => start < end,
            BinaryOp::LessEqual => start <= end,
            BinaryOp::Greater => start > end,
            BinaryOp::GreaterEqual => start >= end,
            BinaryOp::NotEqual => (start - end).abs() > 0.0,
            _ => false,
        }
    }

    fn test(&mut self, condition: Option<&'s Condition>) -> Option<bool> {
        match condition {
            None => Some(true),
            Some(Condition::Expr(e)) => {
                self.value(*e);
                self.known(*e)
            }
            Some(Condition::Declaration(d)) => {
                self.declaration(d);
                None
            }
        }
    }

    /// `for` and `while`. The first test has a block of its own, because it fails less often than others.
    fn repeat(&mut self, condition: Option<&'s Condition>, step: Option<ExprId>, body: &'s Stmt, entered: bool) {
        let (start, after, next) = (self.block(), self.block(), self.block());
        self.loops += 1;
        let known = if entered { Some(true) } else { self.test(condition) };
        if known != Some(false) {
            self.edge(self.current, start, false);
        }
        if known != Some(true) {
            self.edge(self.current, after, known.is_none());
        }
        self.inside(start, after, next, body);
        self.edge(self.current, next, false);
        self.current = next;
        if let Some(step) = step {
            self.value(step);
        }
        let known = self.test(condition);
        if known != Some(false) {
            self.edge(self.current, start, false);
        }
        if known != Some(true) {
            self.edge(self.current, after, false);
        }
        self.loops -= 1;
        self.current = after;
    }

    fn do_while(&mut self, body: &'s Stmt, condition: ExprId) {
        let (start, after, test) = (self.go_on(), self.block(), self.block());
        self.loops += 1;
        self.inside(start, after, test, body);
        self.edge(self.current, test, false);
        self.current = test;
        self.value(condition);
        let known = self.known(condition);
        if known != Some(false) {
            self.edge(self.current, start, false);
        }
        if known != Some(true) {
            self.edge(self.current, after, false);
        }
        self.loops -= 1;
        self.current = after;
    }

    fn inside(&mut self, start: usize, breaks: usize, continues: usize, body: &'s Stmt) {
        if let Some(frame) = self.frames.last_mut() {
            frame.breaks.push(breaks);
            frame.continues.push(continues);
        }
        self.current = start;
        self.statement(body, false);
        if let Some(frame) = self.frames.last_mut() {
            frame.breaks.pop();
            frame.continues.pop();
        }
    }

    fn switch(&mut self, selector: ExprId, body: &'s Body) {
        self.value(selector);
        let head = self.current;
        let after = self.block();
        if let Some(frame) = self.frames.last_mut() {
            frame.breaks.push(after);
        }
        self.current = self.block();
        let mut has_default = false;
        for statement in &body.statements {
            if matches!(statement.kind, StmtKind::Case(_) | StmtKind::Default) {
                has_default |= statement.kind == StmtKind::Default;
                self.go_on();
                self.edge(head, self.current, false);
            }
            self.statement(statement, false);
        }
        self.edge(self.current, after, false);
        if !has_default {
            self.edge(head, after, true);
        }
        if let Some(frame) = self.frames.last_mut() {
            frame.breaks.pop();
        }
        self.current = after;
    }
}
