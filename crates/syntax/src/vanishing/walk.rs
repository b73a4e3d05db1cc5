//! The values of variables, statement after statement.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use super::Vanishing;
use super::polynomial::{Atom, Polynomial};
use crate::Shader;
use crate::ast::{BinaryOp, Block, Condition, Declaration, ExprId, ExprKind, Stmt, StmtKind, UnaryOp};
use crate::swizzle;
use crate::symbols::{CallTarget, Direction, FunctionId, SymbolId, SymbolKind};
use crate::types::Type;
use base::text::Span;

/// A variable and a member of it; an empty name is the whole.
type Place = (SymbolId, String);

pub(super) fn of_function(shader: &Shader, function: FunctionId) -> Vec<Vanishing> {
    let Some(body) = shader.function_syntax(shader.function_info(function)).and_then(|f| f.body.as_ref()) else {
        return Vec::new();
    };
    let locals = shader.symbols().filter_map(|(id, symbol)| Some((symbol.span?.start, id))).collect();
    let mut walk = Walk {
        shader,
        function,
        locals,
        atoms: Vec::new(),
        numbers: HashMap::new(),
        values: BTreeMap::new(),
        copies: BTreeMap::new(),
        goes_to: None,
        found: Vec::new(),
    };
    walk.block(body);
    let mut seen = BTreeSet::new();
    walk.found.retain(|one| seen.insert(one.sum.index()));
    walk.found
}

/// What an unknown number is.
struct Known {
    name: String,
    /// The same for all components of a vector.
    scalar: bool,
}

struct Walk<'s> {
    shader: &'s Shader,
    function: FunctionId,
    locals: HashMap<usize, SymbolId>,
    atoms: Vec<Known>,
    numbers: HashMap<String, Atom>,
    values: BTreeMap<Place, Polynomial>,
    /// Variables that hold what others do, bit for bit.
    copies: BTreeMap<SymbolId, SymbolId>,
    goes_to: Option<SymbolId>,
    found: Vec<Vanishing>,
}

impl Walk<'_> {
    fn block(&mut self, block: &Block) {
        block.statements.iter().for_each(|statement| self.statement(statement));
    }

    fn statement(&mut self, statement: &Stmt) {
        match &statement.kind {
            StmtKind::Expr(id) => drop(self.value(*id)),
            StmtKind::Return(value) => value.iter().for_each(|id| drop(self.value(*id))),
            StmtKind::Declaration(declaration) => self.declaration(declaration),
            StmtKind::Block(block) => self.block(block),
            StmtKind::If { condition, then, otherwise } => {
                self.value(*condition);
                let before = self.values.clone();
                self.statement(then);
                let after = std::mem::replace(&mut self.values, before);
                otherwise.iter().for_each(|other| self.statement(other));
                self.join(&after);
            }
            StmtKind::For { init, condition, step, body, .. } => {
                self.statement(init);
                self.changed_in(statement.span);
                self.condition(condition.as_ref());
                self.statement(body);
                step.iter().for_each(|step| drop(self.value(*step)));
                self.changed_in(statement.span);
            }
            StmtKind::While { condition, body } => {
                self.changed_in(statement.span);
                self.condition(Some(condition));
                self.statement(body);
                self.changed_in(statement.span);
            }
            StmtKind::DoWhile { body, condition } => {
                self.changed_in(statement.span);
                self.statement(body);
                self.value(*condition);
                self.changed_in(statement.span);
            }
            StmtKind::Switch { selector, body } => {
                self.value(*selector);
                for inner in &body.statements {
                    if matches!(inner.kind, StmtKind::Case(_) | StmtKind::Default) {
                        self.changed_in(statement.span);
                    }
                    self.statement(inner);
                }
                self.changed_in(statement.span);
            }
            StmtKind::Empty
            | StmtKind::Precision(_)
            | StmtKind::Qualified(_)
            | StmtKind::Case(_)
            | StmtKind::Default
            | StmtKind::Break
            | StmtKind::Continue
            | StmtKind::Discard
            | StmtKind::Error => {}
        }
    }

    fn condition(&mut self, condition: Option<&Condition>) {
        match condition {
            Some(Condition::Expr(id)) => drop(self.value(*id)),
            Some(Condition::Declaration(declaration)) => self.declaration(declaration),
            None => {}
        }
    }

    fn declaration(&mut self, declaration: &Declaration) {
        for one in &declaration.declarators {
            let Some(&symbol) = self.locals.get(&one.name.span.start) else { continue };
            match &one.initializer {
                Some(value) => self.assigned(symbol, value.value),
                None => self.any(symbol),
            }
        }
    }

    /// A variable gets the value of an expression.
    fn assigned(&mut self, symbol: SymbolId, value: ExprId) {
        let outer = self.goes_to.replace(symbol);
        let polynomial = self.value(value);
        let parts = self.components(value);
        self.goes_to = outer;
        self.any(symbol);
        self.values.insert((symbol, String::new()), polynomial);
        if let Some(of) = self.original(value) {
            self.copies.insert(symbol, of);
        }
        for (k, part) in parts.into_iter().enumerate() {
            self.values.insert((symbol, COMPONENTS[k].to_owned()), part);
        }
    }

    /// The components of a vector that is made of numbers, or else none.
    fn components(&mut self, value: ExprId) -> Vec<Polynomial> {
        let shader = self.shader;
        let value = self.bare(value);
        let ExprKind::Call { args, .. } = &shader.expr(value).kind else { return Vec::new() };
        let scalars = args.iter().all(|arg| shader.type_of(*arg).is_scalar());
        match shader.callee(value) {
            Some(CallTarget::Constructor(Type::Vector(_, n))) if scalars && args.len() == usize::from(*n) => {
                let found = self.found.len();
                let parts = args.iter().map(|arg| self.value(*arg)).collect();
                // They were looked at already.
                self.found.truncate(found);
                parts
            }
            _ => Vec::new(),
        }
    }

    /// Nothing is known of a variable any more.
    fn any(&mut self, symbol: SymbolId) {
        self.copies.retain(|copy, of| *copy != symbol && *of != symbol);
        self.values.retain(|(of, _), _| *of != symbol);
        let fresh = self.fresh(self.shader.symbol(symbol).ty.is_scalar());
        self.values.insert((symbol, String::new()), fresh);
    }

    /// What stays known is the same after both of two ways.
    fn join(&mut self, other: &BTreeMap<Place, Polynomial>) {
        let differ = |place: &&Place| self.values.get(*place) != other.get(*place);
        let places = self.values.keys().chain(other.keys()).filter(differ);
        let changed: BTreeSet<SymbolId> = places.map(|(symbol, _)| *symbol).collect();
        changed.into_iter().for_each(|symbol| self.any(symbol));
    }

    /// What a statement writes is not known while it may be run again.
    fn changed_in(&mut self, span: Span) {
        let shader = self.shader;
        let written = shader.uses().iter().filter(|one| one.access.writes() && span.contains(one.span.start));
        let mut all: BTreeSet<SymbolId> = written.map(|one| one.symbol).collect();
        let calls = shader
            .arena()
            .iter()
            .any(|(id, expr)| span.contains(expr.span.start) && matches!(shader.callee(id), Some(CallTarget::User(_))));
        if calls {
            all.extend(self.globals());
        }
        all.into_iter().for_each(|symbol| self.any(symbol));
    }

    /// Variables at file scope that a function may write.
    fn globals(&self) -> Vec<SymbolId> {
        let global = |symbol: SymbolId| {
            let info = self.shader.symbol(symbol);
            !info.read_only && !matches!(info.kind, SymbolKind::Local | SymbolKind::Param(_))
        };
        let known: BTreeSet<SymbolId> = self.values.keys().map(|(symbol, _)| *symbol).collect();
        known.into_iter().filter(|symbol| global(*symbol)).collect()
    }

    fn bare(&self, id: ExprId) -> ExprId {
        match self.shader.expr(id).kind {
            ExprKind::Paren(inner) => self.bare(inner),
            _ => id,
        }
    }

    fn number(&mut self, name: String, scalar: bool) -> Atom {
        if let Some(known) = self.numbers.get(&name) {
            return *known;
        }
        let atom = self.atoms.len() as Atom;
        self.atoms.push(Known { name: name.clone(), scalar });
        self.numbers.insert(name, atom);
        atom
    }

    fn named(&mut self, name: String, scalar: bool) -> Polynomial {
        Polynomial::atom(self.number(name, scalar))
    }

    fn fresh(&mut self, scalar: bool) -> Polynomial {
        let name = format!("#{}", self.atoms.len());
        self.named(name, scalar)
    }

    /// A member or component of a value.
    fn member(&mut self, of: &Polynomial, field: &str, vector: bool) -> Polynomial {
        if vector && field.len() == 1 {
            return of.renamed(&mut |atom| {
                let known = &self.atoms[atom as usize];
                let (name, scalar) = (format!("{}.{field}", known.name), known.scalar);
                if scalar { atom } else { self.number(name, true) }
            });
        }
        self.named(format!("{of:?}.{field}"), false)
    }

    /// The variable in which an expression lies.
    fn root(&self, id: ExprId) -> Option<SymbolId> {
        match &self.shader.expr(id).kind {
            ExprKind::Paren(inner) => self.root(*inner),
            ExprKind::Field { base, .. } | ExprKind::Index { base, .. } => self.root(*base),
            ExprKind::Name(_) => self.shader.symbol_of(id),
            _ => None,
        }
    }

    /// A variable with the member that is meant, where that is one.
    fn place(&self, id: ExprId) -> Option<Place> {
        let id = self.bare(id);
        match &self.shader.expr(id).kind {
            ExprKind::Name(_) => Some((self.shader.symbol_of(id)?, String::new())),
            ExprKind::Field { base, field } => {
                let base = self.bare(*base);
                let symbol = self.shader.symbol_of(base)?;
                let vector = matches!(self.shader.type_of(base), Type::Vector(..));
                (!vector || field.name.len() == 1).then(|| (symbol, component(&field.name, vector)))
            }
            _ => None,
        }
    }

    fn read(&mut self, (symbol, member): Place) -> Polynomial {
        let scalar = self.shader.symbol(symbol).ty.is_scalar();
        if !self.values.contains_key(&(symbol, String::new())) {
            let fresh = self.fresh(scalar);
            self.values.insert((symbol, String::new()), fresh);
        }
        if let Some(known) = self.values.get(&(symbol, member.clone())).filter(|_| !member.is_empty()) {
            return known.clone();
        }
        let whole = self.values[&(symbol, String::new())].clone();
        if !member.is_empty() {
            let vector = matches!(self.shader.symbol(symbol).ty, Type::Vector(..));
            return self.member(&whole, &member, vector);
        }
        let parts: Vec<_> = self.values.iter().filter(|((of, part), _)| *of == symbol && !part.is_empty()).collect();
        if parts.is_empty() { whole } else { self.named(format!("{whole:?} with {parts:?}"), scalar) }
    }

    fn store(&mut self, target: ExprId, value: Polynomial) {
        match self.place(target) {
            Some((symbol, member)) if member.is_empty() => {
                self.any(symbol);
                self.values.insert((symbol, member), value);
            }
            Some((symbol, member)) => {
                self.read((symbol, String::new()));
                self.values.insert((symbol, member), value);
            }
            None => self.root(target).into_iter().for_each(|symbol| self.any(symbol)),
        }
    }

    /// The value of an expression, and what it changes.
    fn value(&mut self, id: ExprId) -> Polynomial {
        let shader = self.shader;
        if let Some(constant) = shader.fold(id).and_then(crate::Const::as_f64) {
            return Polynomial::constant(constant);
        }
        let ty = shader.type_of(id);
        let real = ty.scalar().is_some_and(|scalar| scalar.is_floating()) && !matches!(ty, Type::Matrix { .. });
        match &shader.expr(id).kind {
            ExprKind::Paren(inner) => self.value(*inner),
            ExprKind::Name(_) | ExprKind::Field { .. } => match (self.place(id), &shader.expr(id).kind) {
                (Some(place), _) => self.read(place),
                (None, ExprKind::Field { base, field }) => {
                    let of = self.value(*base);
                    let vector = matches!(shader.type_of(*base), Type::Vector(..));
                    self.member(&of, &component(&field.name, vector), vector)
                }
                _ => self.fresh(ty.is_scalar()),
            },
            ExprKind::Unary { op: UnaryOp::Plus, operand, .. } if real => self.value(*operand),
            ExprKind::Unary { op: UnaryOp::Minus, operand, .. } if real => {
                Polynomial::default().plus(&self.value(*operand), -1.0)
            }
            ExprKind::Unary { op: UnaryOp::Increment | UnaryOp::Decrement, operand, .. }
            | ExprKind::Postfix { operand, .. } => {
                self.root(*operand).into_iter().for_each(|symbol| self.any(symbol));
                self.fresh(ty.is_scalar())
            }
            ExprKind::Binary { op, left, right, .. } => {
                let of = [*left, *right];
                let [a, b] = of.map(|side| self.value(side));
                self.combined(id, *op, of, [a, b], real)
            }
            ExprKind::Assign { op, target, value, .. } => {
                let target_of = self.root(*target);
                if let (None, Some((symbol, whole))) = (op, self.place(*target))
                    && whole.is_empty()
                {
                    self.assigned(symbol, *value);
                    return self.read((symbol, whole));
                }
                let outer = std::mem::replace(&mut self.goes_to, target_of);
                let mut result = self.value(*value);
                if let Some(op) = op {
                    let before = self.value(*target);
                    result = self.combined(id, *op, [*target, *value], [before, result], real);
                }
                self.goes_to = outer;
                self.store(*target, result.clone());
                result
            }
            ExprKind::Comma { left, right } => {
                self.value(*left);
                self.value(*right)
            }
            ExprKind::Call { args, .. } => self.call(id, args, real),
            _ => {
                let parts: Vec<Polynomial> =
                    shader.expr(id).children().into_iter().map(|child| self.value(child)).collect();
                self.named(format!("{}{parts:?}", shape(&shader.expr(id).kind)), ty.is_scalar())
            }
        }
    }

    /// The value of an operator. `of` are the operands, `values` their values.
    fn combined(
        &mut self,
        id: ExprId,
        op: BinaryOp,
        of: [ExprId; 2],
        values: [Polynomial; 2],
        real: bool,
    ) -> Polynomial {
        let [a, b] = &values;
        let plain = of.iter().all(|side| !matches!(self.shader.type_of(*side), Type::Matrix { .. }));
        let known = match op {
            BinaryOp::Add | BinaryOp::Sub if real => {
                let sum = a.plus(b, if op == BinaryOp::Add { 1.0 } else { -1.0 });
                let [left, right] = of.map(|side| self.shader.text_of(self.bare(side)));
                // A number less itself is 0 however it was rounded.
                let [first, second] = of.map(|side| self.original(side));
                let same = op == BinaryOp::Sub && first.is_some() && first == second;
                self.look(id, &sum, &values, left != right && !same);
                Some(sum)
            }
            BinaryOp::Mul if real && plain => a.times(b),
            BinaryOp::Div if real && plain => {
                b.value().filter(|by| *by != 0.0).map(|by| Polynomial::default().plus(a, by.recip()))
            }
            _ => None,
        };
        let scalar = self.shader.type_of(id).is_scalar();
        known.map_or_else(|| self.named(format!("{op:?}{a:?}{b:?}"), scalar), Polynomial::rounded)
    }

    /// The variable whose bits a variable holds: it itself, or the one that it is a copy of.
    fn original(&self, id: ExprId) -> Option<SymbolId> {
        let symbol = self.shader.symbol_of(self.bare(id))?;
        Some(self.copies.get(&symbol).copied().unwrap_or(symbol))
    }

    /// Notes a sum of two terms that vanishes though they do not.
    fn look(&mut self, id: ExprId, sum: &Polynomial, terms: &[Polynomial; 2], differ: bool) {
        let rounds = terms.iter().any(Polynomial::is_rounded);
        if differ && rounds && sum.is_zero() && terms.iter().all(|term| !term.is_constant()) {
            self.found.push(Vanishing { sum: id, function: self.function, goes_to: self.goes_to });
        }
    }

    fn call(&mut self, id: ExprId, args: &[ExprId], real: bool) -> Polynomial {
        let shader = self.shader;
        let scalar = shader.type_of(id).is_scalar();
        let values: Vec<Polynomial> = args.iter().map(|arg| self.value(*arg)).collect();
        let text = shader.text_of(id);
        match shader.callee(id) {
            Some(CallTarget::Constructor(_)) => {
                let same = |arg: &ExprId| real && shader.type_of(*arg).scalar().is_some_and(|s| s.is_floating());
                match (args, values.as_slice()) {
                    ([arg], [value]) if same(arg) && (scalar || shader.type_of(*arg).is_scalar()) => value.clone(),
                    _ => {
                        let name = text.split('(').next().unwrap_or(text).to_owned();
                        self.named(format!("{name}{values:?}"), scalar)
                    }
                }
            }
            Some(CallTarget::Builtin(call)) if call.directions.iter().all(|way| *way == Direction::In) => {
                let name = call.function.name();
                if let ("fma", [a, b, c]) = (name, values.as_slice())
                    && let Some(product) = a.times(b)
                {
                    let sum = product.plus(c, 1.0);
                    self.look(id, &sum, &[product.rounded(), c.clone()], true);
                    return sum.rounded();
                }
                self.named(format!("{name}{values:?}"), scalar)
            }
            target => {
                let mut written: Vec<SymbolId> = args
                    .iter()
                    .enumerate()
                    .filter(|(k, _)| match target {
                        Some(CallTarget::User(of)) => {
                            shader.function_info(*of).params.get(*k).is_some_and(|p| p.direction != Direction::In)
                        }
                        _ => true,
                    })
                    .filter_map(|(_, arg)| self.root(*arg))
                    .collect();
                written.extend(self.globals());
                written.into_iter().for_each(|symbol| self.any(symbol));
                self.fresh(scalar)
            }
        }
    }
}

/// Names of the components of a vector.
const COMPONENTS: [&str; 4] = ["x", "y", "z", "w"];

/// The name of a component of a vector, whatever its set, or the member.
fn component(field: &str, vector: bool) -> String {
    let mut letters = field.chars();
    match (letters.next().and_then(swizzle::component), letters.next()) {
        (Some(k), None) if vector => COMPONENTS[k].to_owned(),
        _ => field.to_owned(),
    }
}

/// What tells expressions of other kinds apart.
fn shape(kind: &ExprKind) -> String {
    match kind {
        ExprKind::Unary { op, .. } => format!("{op:?}"),
        ExprKind::Index { .. } => "index".to_owned(),
        ExprKind::Ternary { .. } => "choice".to_owned(),
        ExprKind::Literal(literal) => format!("{literal:?}"),
        ExprKind::Method { method, .. } => method.name.clone(),
        _ => "list".to_owned(),
    }
}
