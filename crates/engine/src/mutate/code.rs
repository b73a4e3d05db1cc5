//! The code of a shader that can be mutated: what an entry function reaches.

use std::collections::HashSet;

use base::text::{Edit, Span};
use syntax::Shader;
use syntax::ast::{
    Block, Callee, Condition, Declaration, ExprId, ExprKind, Item, ItemKind, Stmt, StmtKind, TypeSpecifier, UnaryOp,
};
use syntax::interface::Storage;
use syntax::swizzle;
use syntax::symbols::{CallTarget, Direction, FunctionId, SymbolId, SymbolKind};

/// A statement that consists of an expression.
#[derive(Clone, Copy, Debug)]
pub struct ExprStatement {
    /// The expression.
    pub expr: ExprId,
    /// The statement with its `;`, or the step of a `for` loop.
    pub span: Span,
    /// True for the step of a `for` loop, which has no `;`.
    pub step: bool,
    /// True when it is the last statement of the entry function.
    pub last: bool,
}

/// What the entry function of a shader reaches, in the order of the text.
///
/// Left out is what a macro produced, because its text does not stand where it is used, and what
/// decides the interface: sizes of arrays, constants that occur in them, and labels of a `switch`.
pub struct Code<'a> {
    /// The shader.
    pub shader: &'a Shader,
    /// Expressions, operands before their users.
    pub exprs: Vec<ExprId>,
    /// Statements that consist of an expression.
    pub statements: Vec<ExprStatement>,
    /// Conditions of branches, loops and `?:`.
    pub conditions: Vec<ExprId>,
    /// Conditions of loops alone.
    pub loops: Vec<ExprId>,
    /// Expressions that are written, with the parts of them that name the place.
    written: HashSet<ExprId>,
    functions: HashSet<FunctionId>,
    entry: Option<FunctionId>,
}

impl<'a> Code<'a> {
    /// The code that the function `entry` reaches; none when there is no such function.
    pub fn new(shader: &'a Shader, entry: &str) -> Self {
        let entry = shader.functions().find(|(_, f)| f.name.name == entry && f.definition.is_some()).map(|(id, _)| id);
        let mut code = Self {
            shader,
            exprs: Vec::new(),
            statements: Vec::new(),
            conditions: Vec::new(),
            loops: Vec::new(),
            written: HashSet::new(),
            functions: HashSet::new(),
            entry,
        };
        let mut waiting: Vec<FunctionId> = entry.into_iter().collect();
        while let Some(id) = waiting.pop() {
            let Some(function) = shader.function_syntax(shader.function_info(id)) else { continue };
            let (Some(body), true) = (&function.body, code.functions.insert(id)) else { continue };
            let before = code.exprs.len();
            code.block(body);
            for &expr in &code.exprs[before..] {
                if let Some(CallTarget::User(called)) = shader.callee(expr) {
                    waiting.push(*called);
                }
            }
            if Some(id) == entry
                && let Some(last) = body.statements.last()
            {
                code.statements.iter_mut().filter(|s| s.span == last.span).for_each(|s| s.last = true);
            }
        }
        code.constants();
        code.conditions.extend(code.exprs.iter().filter_map(|&id| match shader.expr(id).kind {
            ExprKind::Ternary { condition, .. } => Some(condition),
            _ => None,
        }));
        code.exprs.sort_unstable();
        code.exprs.dedup();
        code.mark_written();
        code
    }

    /// Initialisers of constants at file scope, other than those that decide sizes.
    fn constants(&mut self) {
        let sizes = size_symbols(self.shader);
        let reached: HashSet<SymbolId> = self
            .shader
            .uses()
            .iter()
            .filter(|u| u.function.is_none_or(|f| self.functions.contains(&f)))
            .map(|u| u.symbol)
            .collect();
        for item in &self.shader.unit().items {
            let ItemKind::Declaration(declaration) = &item.kind else { continue };
            for declarator in &declaration.declarators {
                let symbol =
                    self.shader.symbols().find(|(_, s)| s.span == Some(declarator.name.span)).map(|(id, _)| id);
                let counts = symbol.is_some_and(|id| reached.contains(&id) && !sizes.contains(&id));
                if let (Some(initializer), true) = (&declarator.initializer, counts) {
                    self.expr(initializer.value);
                }
            }
        }
    }

    fn block(&mut self, block: &Block) {
        block.statements.iter().for_each(|s| self.statement(s));
    }

    fn statement(&mut self, statement: &Stmt) {
        match &statement.kind {
            StmtKind::Declaration(declaration) => self.declaration(declaration),
            StmtKind::Expr(expr) => {
                self.statements.push(ExprStatement { expr: *expr, span: statement.span, step: false, last: false });
                self.expr(*expr);
            }
            StmtKind::Block(block) => self.block(block),
            StmtKind::If { condition, then, otherwise } => {
                self.conditions.push(*condition);
                self.expr(*condition);
                self.statement(then);
                otherwise.iter().for_each(|s| self.statement(s));
            }
            StmtKind::For { init, condition, step, body, head_span: _ } => {
                // The first part of a loop: without it the variable of the loop has no value, so it
                // is no statement that could be dropped.
                match &init.kind {
                    StmtKind::Expr(expr) => self.expr(*expr),
                    StmtKind::Declaration(declaration) => self.declaration(declaration),
                    _ => {}
                }
                condition.iter().for_each(|c| self.loop_condition(c));
                if let Some(step) = step {
                    let span = self.shader.expr(*step).span;
                    self.statements.push(ExprStatement { expr: *step, span, step: true, last: false });
                    self.expr(*step);
                }
                self.statement(body);
            }
            StmtKind::While { condition, body } => {
                self.loop_condition(condition);
                self.statement(body);
            }
            StmtKind::DoWhile { body, condition } => {
                self.statement(body);
                self.loop_condition(&Condition::Expr(*condition));
            }
            StmtKind::Switch { selector, body } => {
                self.expr(*selector);
                self.block(body);
            }
            StmtKind::Return(Some(value)) => self.expr(*value),
            StmtKind::Return(None)
            | StmtKind::Case(_)
            | StmtKind::Default
            | StmtKind::Empty
            | StmtKind::Precision(_)
            | StmtKind::Qualified(_)
            | StmtKind::Break
            | StmtKind::Continue
            | StmtKind::Discard
            | StmtKind::Error => {}
        }
    }

    fn loop_condition(&mut self, condition: &Condition) {
        match condition {
            Condition::Expr(expr) => {
                self.conditions.push(*expr);
                self.loops.push(*expr);
                self.expr(*expr);
            }
            Condition::Declaration(declaration) => self.declaration(declaration),
        }
    }

    fn declaration(&mut self, declaration: &Declaration) {
        for declarator in &declaration.declarators {
            declarator.initializer.iter().for_each(|i| self.expr(i.value));
        }
    }

    fn expr(&mut self, id: ExprId) {
        let expr = self.shader.expr(id);
        // What a macro produced may still hold arguments that stand in the text; their expressions
        // are their own.
        if !expr.from_macro {
            self.exprs.push(id);
        }
        match &expr.kind {
            // Sizes of an array constructor decide its type.
            ExprKind::Call { callee: Callee::Type(_), args } => args.iter().for_each(|a| self.expr(*a)),
            _ => expr.children().into_iter().for_each(|c| self.expr(c)),
        }
    }

    fn mark_written(&mut self) {
        let mut written = HashSet::new();
        for &id in &self.exprs {
            let targets: Vec<ExprId> = match &self.shader.expr(id).kind {
                ExprKind::Assign { target, .. } => vec![*target],
                ExprKind::Unary { op: UnaryOp::Increment | UnaryOp::Decrement, operand, .. }
                | ExprKind::Postfix { operand, .. } => vec![*operand],
                ExprKind::Call { args, .. } => {
                    let out = |k: usize| self.direction(id, k) != Direction::In;
                    args.iter().enumerate().filter(|(k, _)| out(*k)).map(|(_, a)| *a).collect()
                }
                _ => Vec::new(),
            };
            for mut target in targets {
                loop {
                    written.insert(target);
                    target = match &self.shader.expr(target).kind {
                        ExprKind::Paren(inner) => *inner,
                        ExprKind::Field { base, .. } | ExprKind::Index { base, .. } => *base,
                        _ => break,
                    };
                }
            }
        }
        self.written = written;
    }

    /// Value of a constant scalar expression, a component of a constant vector included.
    pub fn value(&self, id: ExprId) -> Option<f64> {
        if let Some(value) = self.shader.fold(id) {
            return value.as_f64();
        }
        let ExprKind::Field { base, field } = &self.shader.expr(id).kind else { return None };
        let mut chars = field.name.chars();
        let (Some(c), None) = (chars.next(), chars.next()) else { return None };
        swizzle::component(c).and_then(|k| self.component(*base, k))
    }

    /// Component `k` of a constant vector that a name stands for and that lists its components.
    pub fn component(&self, vector: ExprId, k: usize) -> Option<f64> {
        let symbol = self.shader.symbol(self.shader.symbol_of(vector)?);
        if symbol.kind != SymbolKind::Global(Storage::Const) {
            return None;
        }
        let declarations = self.shader.unit().items.iter().filter_map(|item| match &item.kind {
            ItemKind::Declaration(d) => Some(d),
            _ => None,
        });
        let declarator = declarations.flat_map(|d| &d.declarators).find(|d| Some(d.name.span) == symbol.span)?;
        let value = declarator.initializer.as_ref()?.value;
        let ExprKind::Call { callee: Callee::Type(_), args } = &self.shader.expr(value).kind else { return None };
        let listed =
            args.iter().all(|a| self.shader.type_of(*a).is_scalar()) && Some(args.len()) == symbol.ty.components();
        if listed { self.shader.fold(*args.get(k)?)?.as_f64() } else { None }
    }

    /// True when the expression is written, or names the variable of which a part is written.
    pub fn is_written(&self, id: ExprId) -> bool {
        self.written.contains(&id)
    }

    /// Which way argument `k` of a call carries its value.
    pub fn direction(&self, call: ExprId, k: usize) -> Direction {
        match self.shader.callee(call) {
            Some(CallTarget::Builtin(call)) => call.directions.get(k).copied().unwrap_or_default(),
            Some(CallTarget::User(id)) => {
                self.shader.function_info(*id).params.get(k).map_or(Direction::In, |p| p.direction)
            }
            Some(CallTarget::Constructor(_)) | None => Direction::In,
        }
    }

    /// True when neither the expression nor a part of it came from a macro: its text is what it says.
    pub fn is_plain(&self, id: ExprId) -> bool {
        let expr = self.shader.expr(id);
        !expr.from_macro && expr.children().into_iter().all(|c| self.is_plain(c))
    }

    /// The text of an expression so that it can stand as an operand anywhere.
    pub fn operand(&self, id: ExprId) -> String {
        let text = self.shader.text_of(id);
        let atomic = matches!(
            self.shader.expr(id).kind,
            ExprKind::Literal(_)
                | ExprKind::Name(_)
                | ExprKind::Paren(_)
                | ExprKind::Index { .. }
                | ExprKind::Field { .. }
                | ExprKind::Method { .. }
                | ExprKind::Call { .. }
        );
        if atomic { text.to_owned() } else { format!("({text})") }
    }

    /// An edit that puts `text` in place of an expression.
    pub fn replace(&self, id: ExprId, text: impl Into<String>) -> Edit {
        Edit::replace(self.shader.expr(id).span, text)
    }

    /// A call of a built-in function: its arguments, in plain text.
    pub fn built_in(&self, id: ExprId) -> Option<(&syntax::ast::Ident, &[ExprId])> {
        match (&self.shader.expr(id).kind, self.shader.callee(id)) {
            (ExprKind::Call { callee: Callee::Name(name), args }, Some(CallTarget::Builtin(_)))
                if self.is_plain(id) =>
            {
                Some((name, args))
            }
            _ => None,
        }
    }

    /// Functions that are reached.
    pub fn reaches(&self, function: FunctionId) -> bool {
        self.functions.contains(&function)
    }

    /// Variables that the host feeds: inputs and uniforms, and parameters of an entry other than
    /// `main`.
    pub fn inputs(&self) -> Vec<SymbolId> {
        let params: HashSet<SymbolId> = self.entry.map_or_else(HashSet::new, |entry| {
            self.shader.function_info(entry).params.iter().filter_map(|p| p.symbol).collect()
        });
        let fed = |id: &SymbolId, kind: SymbolKind| match kind {
            SymbolKind::Global(Storage::In | Storage::Uniform) | SymbolKind::BlockMember(_) => true,
            SymbolKind::Param(Direction::In) => params.contains(id),
            SymbolKind::Global(_)
            | SymbolKind::Builtin
            | SymbolKind::BlockInstance(_)
            | SymbolKind::Param(_)
            | SymbolKind::Local => false,
        };
        self.shader.symbols().filter(|(id, s)| fed(id, s.kind)).map(|(id, _)| id).collect()
    }
}

/// Variables that occur in the size of an array or in a layout, directly or through a constant.
fn size_symbols(shader: &Shader) -> HashSet<SymbolId> {
    let mut waiting: Vec<ExprId> = Vec::new();
    let ty = |ty: &TypeSpecifier, sizes: &mut Vec<ExprId>| sizes.extend(ty.dims.iter().filter_map(|d| d.size));
    let declared = |d: &Declaration, sizes: &mut Vec<ExprId>| {
        ty(&d.ty, sizes);
        sizes.extend(d.declarators.iter().flat_map(|v| v.dims.iter().filter_map(|d| d.size)));
        sizes.extend(d.qualifiers.layouts().flat_map(|(entries, _)| entries.iter().filter_map(|e| e.value)));
    };
    for Item { kind, .. } in &shader.unit().items {
        match kind {
            ItemKind::Declaration(d) => declared(d, &mut waiting),
            ItemKind::Block(block) => {
                block.members.iter().for_each(|d| declared(d, &mut waiting));
                waiting.extend(block.dims.iter().filter_map(|d| d.size));
            }
            ItemKind::Function(function) => {
                ty(&function.return_type, &mut waiting);
                for param in &function.params {
                    ty(&param.ty, &mut waiting);
                    waiting.extend(param.dims.iter().filter_map(|d| d.size));
                }
                function.body.iter().for_each(|b| local_sizes(b, &declared, &mut waiting));
            }
            ItemKind::Qualified(names) => {
                let entries = names.qualifiers.layouts().flat_map(|(entries, _)| entries);
                waiting.extend(entries.filter_map(|e| e.value));
            }
            ItemKind::Precision(_) | ItemKind::Empty | ItemKind::Error => {}
        }
    }
    let mut found = HashSet::new();
    while let Some(id) = waiting.pop() {
        waiting.extend(shader.expr(id).children());
        let Some(symbol) = shader.symbol_of(id) else { continue };
        if found.insert(symbol) {
            let span = shader.symbol(symbol).span;
            let declarations = shader.unit().items.iter().filter_map(|item| match &item.kind {
                ItemKind::Declaration(d) => Some(d),
                _ => None,
            });
            let declarator = declarations.flat_map(|d| &d.declarators).find(|d| Some(d.name.span) == span);
            waiting.extend(declarator.and_then(|d| d.initializer.as_ref()).map(|i| i.value));
        }
    }
    found
}

fn local_sizes(block: &Block, declared: &impl Fn(&Declaration, &mut Vec<ExprId>), sizes: &mut Vec<ExprId>) {
    for statement in &block.statements {
        match &statement.kind {
            StmtKind::Declaration(d) => declared(d, sizes),
            StmtKind::Block(block) | StmtKind::Switch { body: block, .. } => local_sizes(block, declared, sizes),
            StmtKind::If { then, otherwise, .. } => {
                for inner in [Some(then), otherwise.as_ref()].into_iter().flatten() {
                    if let StmtKind::Block(block) = &inner.kind {
                        local_sizes(block, declared, sizes);
                    }
                }
            }
            StmtKind::For { body, .. } | StmtKind::While { body, .. } | StmtKind::DoWhile { body, .. } => {
                if let StmtKind::Block(block) = &body.kind {
                    local_sizes(block, declared, sizes);
                }
            }
            _ => {}
        }
    }
}
