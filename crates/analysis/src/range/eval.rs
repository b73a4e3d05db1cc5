//! Expressions: what they give, and what they write.

use std::collections::{BTreeMap, BTreeSet};

use syntax::ast::{BinaryOp, Callee, ExprId, ExprKind, ItemKind, UnaryOp};
use syntax::interface::Storage;
use syntax::symbols::{CallTarget, Direction, FunctionId, SymbolId, SymbolKind};
use syntax::types::{ScalarType, Type};
use syntax::{Const, Shader};

use super::builtin::Call;
use super::key::Keys;
use super::operator;
use super::start::{beginning, folded, hash, path, specialized, swizzle, unknown_of, within};
use super::state::State;
use super::transfer as t;
use super::value::{Evidence, Range, Sources, Value};
use super::{MOST_VISITS, Stated, Visit, bits, stated};

/// Expressions that are looked at before the analysis gives up on the rest of a shader.
const MOST_STEPS: usize = 400_000;

/// Calls inside calls that are followed.
const MOST_CALLS: usize = 16;

/// What runs a shader over intervals.
pub struct Machine<'s> {
    pub(super) shader: &'s Shader,
    pub(super) stated: &'s [Stated],
    pub(super) state: State,
    pub(super) keys: Keys,
    /// The functions being run.
    pub(super) frames: Vec<Frame>,
    /// Loops of the innermost function being run.
    pub(super) loops: Vec<Jumps>,
    /// False while a loop is not yet stable: what is seen then is not final.
    pub(super) recording: bool,
    /// What `discard`s depend on: paths that go on did not take them.
    pub(super) discarded: Sources,
    pub(super) visits: BTreeMap<ExprId, Vec<Visit>>,
    /// An expression that is watched, with all that it gave.
    pub(super) watched: Option<(ExprId, Option<Value>)>,
    /// Variables by the place of their declaration.
    pub(super) declared: BTreeMap<usize, SymbolId>,
    specialized: BTreeSet<SymbolId>,
    steps: usize,
    reached: Vec<FunctionId>,
}

/// A function being run.
pub struct Frame {
    pub function: FunctionId,
    /// Where it came back, and with what.
    pub returned: Option<State>,
    pub value: Option<Value>,
    /// The path on which it was called.
    pub path: Sources,
    /// Its parameters, and the variables that it declared.
    pub locals: BTreeSet<SymbolId>,
}

/// Where the ways out of a loop's body lead.
#[derive(Default)]
pub struct Jumps {
    pub breaks: Option<State>,
    pub continues: Option<State>,
}

impl<'s> Machine<'s> {
    /// A machine before the first statement.
    pub fn new(shader: &'s Shader, stated: &'s [Stated]) -> Self {
        Self {
            shader,
            stated,
            state: State::default(),
            keys: Keys::default(),
            frames: Vec::new(),
            loops: Vec::new(),
            recording: true,
            discarded: Sources::NONE,
            visits: BTreeMap::new(),
            watched: None,
            declared: shader.symbols().filter_map(|(id, s)| Some((s.span?.start, id))).collect(),
            specialized: specialized(shader),
            steps: 0,
            reached: Vec::new(),
        }
    }

    /// Runs the initialisers of globals, `main`, and what `main` does not reach: functions that none calls before others.
    pub fn run(&mut self) {
        let shader = self.shader;
        for item in &shader.unit().items {
            if let ItemKind::Declaration(d) = &item.kind {
                self.declare(d);
            }
        }
        let start = self.state.clone();
        let called: BTreeSet<FunctionId> = shader
            .arena()
            .iter()
            .filter_map(|(id, _)| match shader.callee(id) {
                Some(CallTarget::User(function)) => Some(*function),
                _ => None,
            })
            .collect();
        let mut roots: Vec<FunctionId> = shader.functions().map(|(id, _)| id).collect();
        // What others call is met with the values that they give it.
        roots.sort_by_key(|id| (shader.function_info(*id).name.name != "main", called.contains(id)));
        for root in roots {
            if self.reached.contains(&root) {
                continue;
            }
            self.state = start.clone();
            let params = shader.function_info(root).params.iter();
            let args =
                params.map(|p| p.symbol.map_or_else(|| Value::opaque(Sources::ALL), |s| self.beginning(s))).collect();
            self.enter(root, args);
        }
    }

    /// The value of a variable that was not written yet.
    pub fn beginning(&self, id: SymbolId) -> Value {
        beginning(self.shader, self.stated, id)
    }

    /// Records the operands at a place.
    pub fn record(&mut self, id: ExprId, operands: Vec<Value>) {
        if self.recording && !self.state.dead {
            let visits = self.visits.entry(id).or_default();
            let visit = Visit { operands };
            if visits.len() < MOST_VISITS && !visits.contains(&visit) {
                visits.push(visit);
            }
        }
    }

    /// Evaluates without a record and without a trace: a second look at something that was evaluated.
    pub fn look(&mut self, id: ExprId) -> Value {
        let recording = std::mem::replace(&mut self.recording, false);
        let pure = self.keys.of(self.shader, id).is_some();
        let state = if pure { None } else { Some(self.state.clone()) };
        let value = self.eval(id);
        if let Some(state) = state {
            self.state = state;
        }
        self.recording = recording;
        value
    }

    /// Evaluates the indices in what is written, for what they write themselves.
    fn indices(&mut self, target: ExprId) {
        match &self.shader.expr(target).kind {
            ExprKind::Paren(inner) => self.indices(*inner),
            ExprKind::Field { base, field: _ } => self.indices(*base),
            ExprKind::Index { base, index } => {
                self.indices(*base);
                self.index(target, *index);
            }
            _ => {}
        }
    }

    /// What an expression gives; what it writes is written.
    pub fn eval(&mut self, id: ExprId) -> Value {
        self.steps += 1;
        if self.steps > MOST_STEPS {
            return self.anything(id);
        }
        let value = self.eval_kind(id);
        let written = matches!(self.shader.expr(id).kind, ExprKind::Literal(_) | ExprKind::Name(_));
        let mut value = match folded(self.shader, &self.specialized, id) {
            Some(Const::Bool(b)) => Value::scalar(Range::exactly(f64::from(u8::from(b)))),
            Some(Const::Int(v)) => Value::scalar(Range::exactly(f64::from(v))),
            Some(Const::Uint(v)) => Value::scalar(Range::exactly(f64::from(v))),
            // A device may compute a constant otherwise than the front end: its range holds both.
            Some(Const::Float(v)) if written => Value::scalar(Range::exactly(f64::from(v))),
            Some(Const::Double(v)) if written => Value::scalar(Range::exactly(v)),
            Some(Const::Float(_) | Const::Double(_)) | None => value,
        };
        if let [only] = value.parts.as_mut_slice()
            && !self.state.facts.is_empty()
            && let Some(fact) = self.keys.of(self.shader, id).and_then(|k| self.state.facts.get(&k))
        {
            *only = only.narrowed(fact);
        }
        let value = if value.sources().apart_from(self.state.path) { value } else { value.vague() };
        if let Some((watched, gave)) = &mut self.watched
            && *watched == id
            && self.recording
            && !self.state.dead
        {
            *gave = Some(gave.as_ref().map_or_else(|| value.clone(), |before| before.join(&value)));
        }
        value
    }

    /// A value of which only the type is known.
    pub fn anything(&self, id: ExprId) -> Value {
        unknown_of(self.shader.type_of(id), Sources::ALL)
    }

    fn eval_kind(&mut self, id: ExprId) -> Value {
        let shader = self.shader;
        match &shader.expr(id).kind {
            ExprKind::Literal(_) | ExprKind::Error => unknown_of(shader.type_of(id), Sources::NONE),
            ExprKind::Name(_) => self.name(id),
            ExprKind::Paren(inner) => self.eval(*inner),
            ExprKind::Index { base, index } => {
                let base = self.eval(*base);
                let at = self.index(id, *index);
                self.indexed(id, &base, &at)
            }
            ExprKind::Field { base, field } => {
                let value = self.eval(*base);
                self.field(id, *base, &value, &field.name)
            }
            ExprKind::Method { base, method: _, args } => {
                let value = self.eval(*base);
                args.iter().for_each(|a| drop(self.eval(*a)));
                unknown_of(shader.type_of(id), value.sources())
            }
            ExprKind::Call { callee, args } => self.call(id, callee, args),
            ExprKind::Unary { op, op_span: _, operand } => self.unary(id, *op, *operand),
            ExprKind::Postfix { increment, op_span: _, operand } => {
                let before = self.eval(*operand);
                self.step(*operand, &before, *increment);
                before
            }
            ExprKind::Binary { op, op_span: _, left, right } => self.binary(id, *op, *left, *right),
            ExprKind::Assign { op, op_span: _, target, value } => {
                self.indices(*target);
                let mut given = self.eval(*value);
                if let Some(op) = op {
                    let before = self.look(*target);
                    let same = self.same(*target, *value);
                    self.record(id, vec![before.clone(), given.clone()]);
                    given = operator::binary(*op, &before, &given, shader.type_of(*target), same);
                }
                self.assign(*target, given.clone());
                given
            }
            ExprKind::Ternary { condition, yes, no } => {
                let c = self.eval(*condition);
                let known = c.part(0).and_then(|r| r.single());
                self.fork(*condition, &c, known, |m| m.eval(*yes), |m| m.eval(*no))
            }
            ExprKind::Comma { left, right } => {
                self.eval(*left);
                self.eval(*right)
            }
            ExprKind::List(items) => {
                let sources = items.iter().fold(Sources::NONE, |all, i| all.and(self.eval(*i).sources()));
                unknown_of(shader.type_of(id), sources)
            }
        }
    }

    /// Runs one or both of two branches and gives what either gives.
    pub fn fork(
        &mut self,
        condition: ExprId,
        value: &Value,
        known: Option<f64>,
        yes: impl FnOnce(&mut Self) -> Value,
        no: impl FnOnce(&mut Self) -> Value,
    ) -> Value {
        match known {
            Some(0.0) => return no(self),
            Some(_) => return yes(self),
            None => {}
        }
        let before = self.state.clone();
        self.assume(condition, true);
        let a = yes(self);
        let then = std::mem::replace(&mut self.state, before.clone());
        self.assume(condition, false);
        let b = no(self);
        let otherwise = std::mem::take(&mut self.state);
        let (shader, stated) = (self.shader, self.stated);
        let on = value.sources();
        self.state = then.meet(otherwise, before.path, on, |s| beginning(shader, stated, s));
        if a == b { a } else { a.join(&b).depending(on) }
    }

    fn name(&self, id: ExprId) -> Value {
        match self.shader.symbol_of(id) {
            Some(symbol) if self.specialized.contains(&symbol) => self.anything(id),
            Some(symbol) => self.state.vars.get(&symbol).cloned().unwrap_or_else(|| self.beginning(symbol)),
            None => self.anything(id),
        }
    }

    fn indexed(&self, id: ExprId, base: &Value, at: &Value) -> Value {
        let sources = base.sources().and(at.sources());
        if base.parts.is_empty() {
            let mut element = unknown_of(self.shader.type_of(id), sources);
            element.made_from = base.made_from;
            return element;
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "an index that does not fit is none"
        )]
        let part = at.part(0).and_then(|r| r.single()).filter(|i| *i >= 0.0).and_then(|i| base.parts.get(i as usize));
        let range = part.copied().or_else(|| base.hull()).unwrap_or_else(|| Range::unknown(sources));
        let range = Range { sources, ..range };
        Value { made_from: base.made_from, ..Value::scalar(range) }
    }

    fn field(&self, id: ExprId, base_id: ExprId, base: &Value, field: &str) -> Value {
        if base.parts.is_empty() {
            let mut member = self.member(id, base);
            member.made_from = base.made_from;
            return member;
        }
        let scalar = base.parts.len() == 1 && self.shader.type_of(base_id).is_scalar();
        let parts: Option<Vec<Range>> =
            swizzle(field).map(|i| if scalar { base.part(0) } else { base.parts.get(i?).copied() }).collect();
        match parts {
            Some(parts) if !parts.is_empty() => Value { made_from: base.made_from, ..Value::new(parts) },
            _ => self.anything(id),
        }
    }

    /// A member of a structure: only what the configuration says of it is known.
    fn member(&self, id: ExprId, base: &Value) -> Value {
        let ty = self.shader.type_of(id);
        if let Some((path, true)) = path(self.shader, id)
            && let Some((lo, hi)) = stated(self.stated, &path)
        {
            return within(ty, lo, hi, Evidence::Stated, Sources::of(hash(&path)));
        }
        unknown_of(ty, base.sources())
    }

    fn unary(&mut self, id: ExprId, op: UnaryOp, operand: ExprId) -> Value {
        let value = self.eval(operand);
        match op {
            UnaryOp::Plus => value,
            UnaryOp::Minus => Value { parts: value.parts.iter().map(|p| t::neg(*p)).collect(), ..value },
            UnaryOp::Not => Value::new(value.parts.iter().map(|p| t::sub(Range::exactly(1.0), *p)).collect()),
            UnaryOp::Complement => unknown_of(self.shader.type_of(id), value.sources()),
            UnaryOp::Increment | UnaryOp::Decrement => {
                self.step(operand, &value, op == UnaryOp::Increment);
                self.look(operand)
            }
        }
    }

    fn step(&mut self, operand: ExprId, before: &Value, up: bool) {
        let op = if up { BinaryOp::Add } else { BinaryOp::Sub };
        let one = Value::scalar(Range::exactly(1.0));
        let after = operator::binary(op, before, &one, self.shader.type_of(operand), false);
        self.assign(operand, after);
    }

    fn binary(&mut self, id: ExprId, op: BinaryOp, left: ExprId, right: ExprId) -> Value {
        let a = self.eval(left);
        let b = match op {
            BinaryOp::And | BinaryOp::Or => {
                let whole = if op == BinaryOp::And { 1.0 } else { 0.0 };
                // The right side runs only when the left one does not decide.
                if a.part(0).and_then(|r| r.single()).is_some_and(|v| v != whole) {
                    return a;
                }
                let before = self.state.clone();
                self.assume(left, op == BinaryOp::And);
                let b = self.eval(right);
                let then = std::mem::take(&mut self.state);
                let (shader, stated, path) = (self.shader, self.stated, before.path);
                self.state = then.meet(before, path, a.sources(), |s| beginning(shader, stated, s));
                b
            }
            _ => self.eval(right),
        };
        let same = self.same(left, right);
        self.record(id, vec![a.clone(), b.clone()]);
        let ty = self.shader.type_of(id);
        let whole = matches!(op, BinaryOp::Equal | BinaryOp::NotEqual) && a.parts.len() != 1;
        if whole {
            return Value::scalar(Range::truth(a.sources().and(b.sources())));
        }
        operator::binary(op, &a, &b, ty, same)
    }

    /// True when two expressions have one spelling.
    fn same(&mut self, a: ExprId, b: ExprId) -> bool {
        let spelling = self.keys.of(self.shader, a);
        spelling.is_some() && spelling == self.keys.of(self.shader, b)
    }

    fn call(&mut self, id: ExprId, callee: &'s Callee, args: &'s [ExprId]) -> Value {
        let shader = self.shader;
        let values: Vec<Value> = args.iter().map(|a| self.eval(*a)).collect();
        let ty = shader.type_of(id);
        match (shader.callee(id), callee) {
            (Some(CallTarget::Constructor(to)), _) => self.construct(to, args, &values),
            (Some(CallTarget::User(function)), _) => self.user(id, *function, args, values),
            (target, Callee::Name(name)) if bits::takes_bits(&name.name, target) => {
                let sources = values.iter().fold(Sources::NONE, |all, v| all.and(v.sources()));
                bits::taken(shader, ty, args, sources)
            }
            (Some(CallTarget::Builtin(built_in)), Callee::Name(name)) => {
                let sources = values.iter().fold(Sources::NONE, |all, v| all.and(v.sources()));
                for (arg, _) in args.iter().zip(&built_in.directions).filter(|(_, way)| **way != Direction::In) {
                    let out = unknown_of(shader.type_of(*arg), sources);
                    self.assign(*arg, out);
                }
                let same = matches!(args, [a, b] if self.same(*a, *b));
                self.record(id, values.clone());
                let selects = name.name == "mix"
                    && matches!(shader.type_of(args[args.len() - 1]).scalar(), Some(ScalarType::Bool));
                if selects && let [a, b, c] = values.as_slice() {
                    return a.join(b).depending(c.sources());
                }
                let components = if matches!(ty, Type::Scalar(_) | Type::Vector(..)) { ty.components() } else { None };
                // Equal calls make the same direction.
                let spelling = self.keys.of(shader, id);
                let number = spelling.map_or_else(|| hash(&id.index().to_string()), |key| hash(self.keys.text(key)));
                let mark = 1 << (number % 128);
                let call = Call { name: &name.name, args: &values, components: components.unwrap_or(0), same, mark };
                let value = call.value();
                let carries = matches!(name.name.as_str(), "normalize" | "reflect" | "faceforward" | "dot");
                if carries {
                    return value;
                }
                Value { made_from: values.iter().fold(0, |all, v| all | v.made_from), ..value }
            }
            (Some(CallTarget::Builtin(_)) | None, _) => {
                self.havoc();
                self.anything(id)
            }
        }
    }

    fn construct(&self, to: &Type, args: &[ExprId], values: &[Value]) -> Value {
        let made_from = values.iter().fold(0, |all, v| all | v.made_from);
        let sources = values.iter().fold(Sources::NONE, |all, v| all.and(v.sources()));
        let (Type::Scalar(scalar) | Type::Vector(scalar, _), Some(n)) = (to, to.components()) else {
            return Value { made_from, ..Value::opaque(sources) };
        };
        let mut parts = Vec::new();
        for (arg, value) in args.iter().zip(values) {
            let ty = self.shader.type_of(*arg);
            if value.parts.is_empty() {
                parts.extend(vec![Range::unknown(sources); ty.components().unwrap_or(n)]);
            }
            let from = ty.scalar().unwrap_or(ScalarType::Float);
            parts.extend(value.parts.iter().map(|p| operator::convert(*p, from, *scalar)));
        }
        if let ([only], true) = (parts.as_slice(), n > 1) {
            parts = vec![*only; n];
        }
        parts.resize(n, Range::unknown(sources));
        // A conversion of the same vector keeps its length.
        let unit = matches!(values, [only] if only.unit && only.parts.len() == n);
        Value { made_from, unit, ..Value::new(parts) }
    }

    fn user(&mut self, id: ExprId, function: FunctionId, args: &[ExprId], values: Vec<Value>) -> Value {
        let info = self.shader.function_info(function);
        let known = self.shader.function_syntax(info).is_some_and(|f| f.body.is_some());
        let running = self.frames.iter().any(|f| f.function == function);
        self.record(id, values.clone());
        if !known || running || self.frames.len() >= MOST_CALLS {
            self.havoc();
            for (arg, p) in args.iter().zip(&info.params).filter(|(_, p)| p.direction != Direction::In) {
                self.assign(*arg, unknown_of(&p.ty, Sources::ALL));
            }
            return self.anything(id);
        }
        let (value, locals) = self.enter(function, values).unwrap_or_default();
        for (arg, p) in args.iter().zip(&info.params).filter(|(_, p)| p.direction != Direction::In) {
            let out = p.symbol.and_then(|s| self.state.vars.get(&s).cloned());
            self.assign(*arg, out.unwrap_or_else(|| unknown_of(&p.ty, Sources::ALL)));
        }
        self.state.leave(&locals, &self.keys);
        value.unwrap_or_else(|| self.anything(id))
    }

    /// Runs a function with these arguments; gives what it returns, and its variables.
    fn enter(&mut self, function: FunctionId, args: Vec<Value>) -> Option<(Option<Value>, BTreeSet<SymbolId>)> {
        let shader = self.shader;
        let info = shader.function_info(function);
        let body = shader.function_syntax(info)?.body.as_ref()?;
        if !self.reached.contains(&function) {
            self.reached.push(function);
        }
        let mut locals = BTreeSet::new();
        for (p, value) in info.params.iter().zip(args) {
            if let Some(symbol) = p.symbol {
                locals.insert(symbol);
                self.state.forget(symbol, &self.keys);
                if p.direction == Direction::Out {
                    self.state.vars.remove(&symbol);
                } else {
                    self.state.vars.insert(symbol, value);
                }
            }
        }
        let (path, ended) = (self.state.path, self.state.ended);
        let discarded = std::mem::replace(&mut self.discarded, Sources::NONE);
        let loops = std::mem::take(&mut self.loops);
        self.frames.push(Frame { function, returned: None, value: None, path, locals });
        self.block(&body.statements);
        self.come_back(None);
        self.loops = loops;
        let frame = self.frames.pop()?;
        if let Some(state) = frame.returned {
            self.state = state;
            self.state.path = path.and(self.discarded);
            self.state.ended = ended.and(self.discarded);
        }
        self.discarded = self.discarded.and(discarded);
        Some((frame.value, frame.locals))
    }

    /// Forgets all globals that may be written, and all facts.
    fn havoc(&mut self) {
        self.state.facts.clear();
        for (id, symbol) in self.shader.symbols() {
            let written = match symbol.kind {
                SymbolKind::Global(Storage::Global | Storage::Out | Storage::Shared | Storage::Buffer)
                | SymbolKind::Builtin => !symbol.read_only,
                SymbolKind::Global(Storage::In | Storage::Uniform | Storage::Const)
                | SymbolKind::BlockMember(_)
                | SymbolKind::BlockInstance(_)
                | SymbolKind::Param(_)
                | SymbolKind::Local => false,
            };
            if written {
                self.state.vars.insert(id, unknown_of(&symbol.ty, Sources::ALL));
            }
        }
    }

    /// Writes a variable or a part of one.
    pub fn assign(&mut self, target: ExprId, value: Value) {
        let shader = self.shader;
        match &shader.expr(target).kind {
            ExprKind::Paren(inner) => self.assign(*inner, value),
            ExprKind::Name(_) => {
                if let Some(symbol) = shader.symbol_of(target) {
                    self.state.forget(symbol, &self.keys);
                    self.state.vars.insert(symbol, value);
                }
            }
            ExprKind::Field { base, field } if matches!(shader.type_of(*base), Type::Vector(..)) => {
                let mut whole = self.look(*base);
                for (from, to) in swizzle(&field.name).enumerate() {
                    let given = value.part(from);
                    if let (Some(given), Some(slot)) = (given, to.and_then(|i| whole.parts.get_mut(i))) {
                        *slot = given;
                    }
                }
                (whole.unit, whole.made_from) = (false, whole.made_from | value.made_from);
                self.assign(*base, whole);
            }
            ExprKind::Index { base, index } if matches!(shader.type_of(*base), Type::Vector(..)) => {
                let mut whole = self.look(*base);
                let at = self.look(*index);
                let given = value.part(0).unwrap_or_else(|| Range::unknown(Sources::ALL));
                let known = at.part(0).and_then(|r| r.single());
                for (i, slot) in whole.parts.iter_mut().enumerate() {
                    match known {
                        #[expect(clippy::cast_precision_loss, reason = "a vector has four components")]
                        Some(k) if k != i as f64 => {}
                        Some(_) => *slot = given,
                        None => {
                            *slot = slot.join(given);
                            slot.sources = slot.sources.and(at.sources());
                        }
                    }
                }
                (whole.unit, whole.made_from) = (false, whole.made_from | value.made_from);
                self.assign(*base, whole);
            }
            ExprKind::Field { base, field: _ } | ExprKind::Index { base, index: _ } => {
                // A part of a structure, array or matrix: only what the whole depends on is kept.
                let whole = self.look(*base);
                let sources = whole.sources().and(value.sources());
                let made_from = whole.made_from | value.made_from;
                self.assign(*base, Value { made_from, ..Value::opaque(sources) });
            }
            ExprKind::Literal(_)
            | ExprKind::Method { .. }
            | ExprKind::Call { .. }
            | ExprKind::Unary { .. }
            | ExprKind::Postfix { .. }
            | ExprKind::Binary { .. }
            | ExprKind::Assign { .. }
            | ExprKind::Ternary { .. }
            | ExprKind::Comma { .. }
            | ExprKind::List(_)
            | ExprKind::Error => {}
        }
    }
}
