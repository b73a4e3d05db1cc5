//! Values of expressions, with the accesses to shared memory in the order in which they happen.

use base::text::Span;
use syntax::ast::{BinaryOp, Callee, ExprId, ExprKind, UnaryOp};
use syntax::interface::Storage;
use syntax::symbols::{CallTarget, Direction, SymbolId, SymbolKind};
use syntax::types::{ScalarType, Type};

use super::shared::{Access, Kind, Step};
use super::value::{Number, Origin, Value};
use super::walk::Walk;
use super::{Part, place};

/// Functions at which all invocations of a group meet.
const BARRIERS: [&str; 7] = [
    "barrier",
    "workgroupBarrier",
    "storageBarrier",
    "textureBarrier",
    "controlBarrier",
    "subgroupBarrier",
    "workgroupUniformLoad",
];

impl Walk<'_> {
    /// The number of an expression; what has none is not known.
    pub(super) fn number(&mut self, id: ExprId) -> Number {
        match self.eval(id) {
            Value::One(number) => number,
            Value::Vector(all) => self.opaque(&all),
        }
    }

    /// Something that follows from these numbers.
    fn opaque(&mut self, from: &[Number]) -> Number {
        let mut origin = Origin { uniform: true, data: false };
        for number in from {
            let of = self.terms.origin_of(number);
            origin = Origin { uniform: origin.uniform && of.uniform, data: origin.data || of.data };
        }
        self.terms.fresh(origin)
    }

    /// A number of each component of what is not known.
    fn unknown_of(&mut self, id: ExprId, origin: Origin) -> Value {
        match self.shader.type_of(id) {
            Type::Vector(_, n) => Value::Vector((0..*n).map(|_| self.terms.fresh(origin)).collect()),
            _ => Value::One(self.terms.fresh(origin)),
        }
    }

    pub(super) fn eval(&mut self, id: ExprId) -> Value {
        if !self.step() {
            return Value::One(self.terms.fresh(Origin::default()));
        }
        let shader = self.shader;
        if let Some(value) = shader.fold(id) {
            let integer = value.as_integer().or(match value {
                syntax::Const::Bool(truth) => Some(i64::from(truth)),
                _ => None,
            });
            if let Some(integer) = integer {
                return Value::One(Number::constant(integer));
            }
        }
        match &shader.expr(id).kind {
            ExprKind::Paren(inner) => self.eval(*inner),
            ExprKind::Name(_) | ExprKind::Index { .. } | ExprKind::Field { .. } => self.read(id),
            ExprKind::Binary { op, op_span: _, left, right } => self.binary(*op, *left, *right),
            ExprKind::Unary { op, op_span: _, operand } => self.unary(id, *op, *operand),
            ExprKind::Postfix { increment, op_span: _, operand } => {
                let before = self.eval(*operand);
                self.count(*operand, before.clone(), *increment);
                before
            }
            ExprKind::Assign { op, op_span: _, target, value } => {
                let mut result = self.eval(*value);
                if let Some(op) = op {
                    let before = self.eval(*target);
                    result = self.combined(*op, &before, &result, *target);
                }
                self.write(*target, result.clone());
                result
            }
            ExprKind::Ternary { condition, yes, no } => {
                let condition = self.number(*condition);
                self.conditional += 1;
                let (yes, no) = (self.eval(*yes), self.eval(*no));
                self.conditional -= 1;
                match (condition.single(), condition.is_known(), &yes, &no) {
                    (Some(truth), ..) => {
                        if truth != 0 {
                            yes
                        } else {
                            no
                        }
                    }
                    (None, true, Value::One(yes), Value::One(no)) => {
                        let mask: Vec<u8> = (0..self.lanes).map(|l| u8::from(condition.lane(l) != 0)).collect();
                        Value::One(self.terms.select(&mask, yes, no))
                    }
                    _ => {
                        let all: Vec<Number> =
                            [&yes, &no].iter().flat_map(|v| v.numbers().to_vec()).chain([condition]).collect();
                        let origin = self.opaque(&all);
                        let origin = self.terms.origin_of(&origin);
                        self.unknown_of(id, origin)
                    }
                }
            }
            ExprKind::Comma { left, right } => {
                self.eval(*left);
                self.eval(*right)
            }
            ExprKind::Call { callee, args } => self.call(id, callee, args),
            ExprKind::Method { .. } => {
                let name = shader.text_of(id).to_owned();
                Value::One(self.terms.named(&name, Origin { uniform: true, data: false }))
            }
            ExprKind::Literal(_) | ExprKind::List(_) | ExprKind::Error => {
                for child in shader.expr(id).children() {
                    self.eval(child);
                }
                Value::One(self.terms.fresh(Origin { uniform: true, data: false }))
            }
        }
    }

    fn scalar(&self, id: ExprId) -> Option<ScalarType> {
        self.shader.type_of(id).scalar()
    }

    fn binary(&mut self, op: BinaryOp, left: ExprId, right: ExprId) -> Value {
        let before = self.eval(left);
        let skips = usize::from(matches!(op, BinaryOp::And | BinaryOp::Or));
        self.conditional += skips;
        let after = self.eval(right);
        self.conditional -= skips;
        self.combined(op, &before, &after, left)
    }

    fn combined(&mut self, op: BinaryOp, a: &Value, b: &Value, typed: ExprId) -> Value {
        let ty = self.scalar(typed).filter(|t| t.is_integer());
        let count = a.numbers().len().max(b.numbers().len());
        let of = |v: &Value, i: usize| v.numbers().get(i).or(v.number()).cloned();
        let mut all = Vec::new();
        for i in 0..count {
            if let (Some(a), Some(b)) = (of(a, i), of(b, i)) {
                let integers = ty.is_some() || self.scalar(typed) == Some(ScalarType::Bool);
                all.push(match integers {
                    true => self.terms.binary(op, &a, &b, ty),
                    false => self.opaque(&[a, b]),
                });
            }
        }
        match (a, b) {
            (Value::One(_), Value::One(_)) if !all.is_empty() => Value::One(all.swap_remove(0)),
            _ => Value::Vector(all),
        }
    }

    fn unary(&mut self, id: ExprId, op: UnaryOp, operand: ExprId) -> Value {
        let value = self.eval(operand);
        let zero = Value::One(Number::constant(0));
        match op {
            UnaryOp::Plus => value,
            UnaryOp::Minus => self.combined(BinaryOp::Sub, &zero, &value, operand),
            UnaryOp::Not => match value {
                Value::One(number) => Value::One(number.negated()),
                Value::Vector(all) => Value::Vector(all.iter().map(Number::negated).collect()),
            },
            UnaryOp::Complement => {
                let origin = value.numbers().to_vec();
                let origin = self.opaque(&origin);
                let origin = self.terms.origin_of(&origin);
                self.unknown_of(id, origin)
            }
            UnaryOp::Increment | UnaryOp::Decrement => self.count(operand, value, op == UnaryOp::Increment),
        }
    }

    fn count(&mut self, operand: ExprId, before: Value, up: bool) -> Value {
        let one = Value::One(Number::constant(1));
        let op = if up { BinaryOp::Add } else { BinaryOp::Sub };
        let after = self.combined(op, &before, &one, operand);
        self.write(operand, after.clone());
        after
    }

    /// The shared variable and the way to its part, where that is what an expression means.
    fn shared_place(&mut self, id: ExprId) -> Option<(SymbolId, Vec<Step>)> {
        let (symbol, parts) = place(self.shader, id)?;
        let (root, mut path) = match self.aliases.get(&symbol) {
            Some((root, path)) => (*root, path.clone()),
            None => (symbol, Vec::new()),
        };
        if self.shader.symbol(root).kind != SymbolKind::Global(Storage::Shared) {
            return None;
        }
        for part in parts {
            path.push(match part {
                Part::Index(index) => Step::Index(self.number(index)),
                Part::Member(name) => Step::Member(name),
            });
        }
        Some((root, path))
    }

    fn touch(&mut self, symbol: SymbolId, path: Vec<Step>, kind: Kind, span: Span) {
        self.note_beyond(symbol, &path, span);
        let lanes = self.state.active.iter().map(|a| *a != 0).collect();
        let access = Access { symbol, path, kind, lanes, atoms: self.state.atoms.clone(), span };
        let races = self.state.pending.add(access, &self.terms);
        self.found.extend(races);
    }

    fn read(&mut self, id: ExprId) -> Value {
        let shader = self.shader;
        let Some((symbol, parts)) = place(shader, id) else {
            let mut from = Vec::new();
            for child in shader.expr(id).children() {
                from.extend(self.eval(child).numbers().to_vec());
            }
            let origin = self.opaque(&from);
            let origin = self.terms.origin_of(&origin);
            return self.unknown_of(id, origin);
        };
        if let Some((root, path)) = self.shared_place(id) {
            let uniform = path.iter().all(|s| match s {
                Step::Index(number) => self.terms.origin_of(number).uniform,
                Step::Member(_) => true,
            });
            self.touch(root, path, Kind::Read, shader.expr(id).span);
            return self.unknown_of(id, Origin { uniform, data: true });
        }
        let info = shader.symbol(symbol);
        let value = match info.kind {
            SymbolKind::Builtin => self.builtin(&info.name),
            _ => self.state.env.get(&symbol).cloned().or_else(|| self.input(symbol, None)),
        };
        let (value, rest) = match parts.split_first() {
            Some((Part::Member(name), rest)) if value.is_none() => (self.input(symbol, Some(name)), rest),
            _ => (value, parts.as_slice()),
        };
        if let Some(value) = value {
            return self.part(id, value, rest);
        }
        let mut indices = Vec::new();
        for part in &parts {
            if let Part::Index(index) = part {
                indices.push(self.number(*index));
            }
        }
        match info.kind {
            SymbolKind::Global(Storage::Uniform | Storage::Const)
            | SymbolKind::BlockMember(_)
            | SymbolKind::BlockInstance(_)
                if indices.is_empty() && info.read_only =>
            {
                let name = shader.text_of(id).to_owned();
                let origin = Origin { uniform: true, data: false };
                match shader.type_of(id) {
                    Type::Vector(_, n) => {
                        Value::Vector((0..*n).map(|c| self.terms.named(&format!("{name}#{c}"), origin)).collect())
                    }
                    _ => Value::One(self.terms.named(&name, origin)),
                }
            }
            SymbolKind::Global(Storage::Global) => self.unknown_of(id, Origin::default()),
            SymbolKind::Global(_) | SymbolKind::BlockMember(_) | SymbolKind::BlockInstance(_) => {
                let uniform = indices.iter().all(|i| self.terms.origin_of(i).uniform);
                self.unknown_of(id, Origin { uniform, data: true })
            }
            SymbolKind::Builtin | SymbolKind::Param(_) | SymbolKind::Local => self.unknown_of(id, Origin::default()),
        }
    }

    /// Components of a value.
    fn part(&mut self, id: ExprId, value: Value, parts: &[Part]) -> Value {
        let all = value.numbers().to_vec();
        match (parts, &value) {
            ([], _) => value,
            ([Part::Member(name)], Value::Vector(_)) => {
                let at =
                    |c: char| "xyzw".find(c).or("rgba".find(c)).or("stpq".find(c)).and_then(|i| all.get(i).cloned());
                let mut picked: Vec<Number> = name.chars().filter_map(at).collect();
                match picked.len() {
                    1 => Value::One(picked.swap_remove(0)),
                    _ => Value::Vector(picked),
                }
            }
            ([Part::Index(index)], Value::Vector(_)) => {
                let index = self.number(*index).single().and_then(|i| usize::try_from(i).ok());
                match index.and_then(|i| all.get(i).cloned()) {
                    Some(number) => Value::One(number),
                    None => Value::One(self.opaque(&all)),
                }
            }
            _ => {
                let origin = self.opaque(&all);
                let origin = self.terms.origin_of(&origin);
                self.unknown_of(id, origin)
            }
        }
    }

    pub(super) fn write(&mut self, target: ExprId, value: Value) {
        if let Some((root, path)) = self.shared_place(target) {
            self.touch(root, path, Kind::Write, self.shader.expr(target).span);
            return;
        }
        let Some((symbol, parts)) = place(self.shader, target) else { return };
        let old = self.state.env.get(&symbol).cloned();
        let value = match (parts.as_slice(), old) {
            ([], _) => value,
            ([Part::Member(name)], Some(Value::Vector(mut all))) if name.len() == 1 => {
                let at = name.chars().next().and_then(|c| "xyzw".find(c).or("rgba".find(c)));
                if let (Some(slot), Some(number)) = (at.and_then(|i| all.get_mut(i)), value.number()) {
                    *slot = number.clone();
                }
                Value::Vector(all)
            }
            (_, old) => {
                // Elements of arrays are not followed: what the variable holds is not known from here on.
                let mut from = value.numbers().to_vec();
                from.extend(old.iter().flat_map(|o| o.numbers().to_vec()));
                Value::One(self.opaque(&from))
            }
        };
        self.assign(symbol, value);
    }

    fn call(&mut self, id: ExprId, callee: &Callee, args: &[ExprId]) -> Value {
        let shader = self.shader;
        let name = match callee {
            Callee::Name(name) => name.name.clone(),
            Callee::Type(_) => String::new(),
        };
        if BARRIERS.contains(&name.as_str()) {
            self.state.pending.clear();
            self.barriers += 1;
            return self.unknown_of(id, Origin { uniform: true, data: true });
        }
        if let Some(value) = name.strip_prefix("atomic").and_then(|what| self.atomic(id, what, args)) {
            return value;
        }
        if let Some(CallTarget::User(function)) = shader.callee(id) {
            return self.enter(id, *function, args);
        }
        let values: Vec<Value> = args.iter().map(|a| self.eval(*a)).collect();
        let all: Vec<Number> = values.iter().flat_map(|v| v.numbers().to_vec()).collect();
        match (shader.callee(id), shader.type_of(id)) {
            (Some(CallTarget::Constructor(_)), Type::Scalar(to)) if to.is_integer() && all.len() == 1 => {
                let from = args.first().and_then(|a| self.scalar(*a));
                if from.is_some_and(|f| f.is_integer() || f == ScalarType::Bool) {
                    return Value::One(super::value::wrapped(all[0].clone(), Some(*to)));
                }
            }
            (Some(CallTarget::Constructor(_)), Type::Vector(_, n)) => {
                let integers = args.iter().all(|a| self.scalar(*a).is_some_and(ScalarType::is_integer));
                if integers && all.len() >= usize::from(*n) {
                    return Value::Vector(all.into_iter().take(usize::from(*n)).collect());
                }
                if integers && all.len() == 1 {
                    return Value::Vector(vec![all[0].clone(); usize::from(*n)]);
                }
            }
            _ => {}
        }
        match (name.as_str(), all.as_slice()) {
            ("min" | "max", [a, b]) if self.scalar(id).is_some_and(ScalarType::is_integer) => {
                let less = self.terms.binary(BinaryOp::Less, a, b, None);
                if less.is_known() {
                    let smaller = name == "min";
                    let mask: Vec<u8> = (0..self.lanes).map(|l| u8::from((less.lane(l) != 0) == smaller)).collect();
                    return Value::One(self.terms.select(&mask, a, b));
                }
            }
            ("arrayLength", _) => {
                let name = shader.text_of(id).to_owned();
                return Value::One(self.terms.named(&name, Origin { uniform: true, data: false }));
            }
            _ => {}
        }
        // A function that is not seen may wait for the others.
        if shader.callee(id).is_none()
            && !name.is_empty()
            && shader.wgsl().is_none_or(|_| !syntax::wgsl::is_builtin(&name))
        {
            self.state.pending.clear();
        }
        let loads = ["textureLoad", "imageLoad", "texelFetch", "texture"].iter().any(|f| name.starts_with(f));
        let subgroup = name.starts_with("subgroup");
        let origin = self.opaque(&all);
        let origin = self.terms.origin_of(&origin);
        let origin =
            Origin { uniform: origin.uniform && !subgroup && !loads, data: (origin.data || loads) && !subgroup };
        self.unknown_of(id, origin)
    }

    /// An atomic operation on shared memory; the name is without `atomic`.
    fn atomic(&mut self, id: ExprId, what: &str, args: &[ExprId]) -> Option<Value> {
        let (symbol, path) = self.shared_place(*args.first()?)?;
        for arg in &args[1..] {
            self.eval(*arg);
        }
        let kind = match what {
            "Load" => Kind::AtomicLoad,
            "Store" => Kind::AtomicStore,
            _ => Kind::AtomicUpdate,
        };
        self.touch(symbol, path, kind, self.shader.expr(id).span);
        // Numbers that atomics give out are often each invocation's own.
        Some(self.unknown_of(id, Origin { uniform: false, data: kind == Kind::AtomicLoad }))
    }

    /// Walks through a function of the text.
    fn enter(&mut self, id: ExprId, function: syntax::symbols::FunctionId, args: &[ExprId]) -> Value {
        let shader = self.shader;
        let params = &shader.function_info(function).params;
        let mut bound = Vec::new();
        for (param, arg) in params.iter().zip(args) {
            let Some(symbol) = param.symbol else { continue };
            let pointer = shader.wgsl().is_some() && param.direction != Direction::In;
            if pointer && let Some(place) = self.shared_place(*arg) {
                self.aliases.insert(symbol, place);
                continue;
            }
            let value = self.eval(*arg);
            bound.push((symbol, value, *arg, param.direction));
        }
        let Some(body) = super::body(shader, function).filter(|_| self.may_enter(function)) else {
            self.state.pending.clear();
            return self.unknown_of(id, Origin::default());
        };
        for (symbol, value, ..) in &bound {
            self.state.env.insert(*symbol, value.clone());
        }
        let result = self.run_function(function, body);
        for (symbol, _, arg, direction) in bound {
            if direction != Direction::In
                && let Some(value) = self.state.env.get(&symbol).cloned()
            {
                self.write(arg, value);
            }
        }
        result.unwrap_or_else(|| self.unknown_of(id, Origin::default()))
    }
}
