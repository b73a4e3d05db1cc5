//! Spellings of expressions by which equal ones are recognised.

use std::collections::{BTreeSet, HashMap};
use std::fmt::Write as _;

use syntax::Shader;
use syntax::ast::{BinaryOp, ExprId, ExprKind, UnaryOp};
use syntax::symbols::{CallTarget, Direction, SymbolId};

/// A spelling among the [`Keys`] of a shader.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Key(usize);

/// The spellings of a shader's expressions: each is worked out once, and compared as a number.
#[derive(Default)]
pub struct Keys {
    all: Vec<Spelling>,
    by_text: HashMap<String, Key>,
    /// By the index of the expression; none for one that was not asked for.
    known: Vec<Option<Option<Key>>>,
}

/// A spelling, and the variables in it.
#[derive(Default)]
struct Spelling {
    text: String,
    symbols: Vec<SymbolId>,
}

impl Keys {
    /// The spelling of an expression without side effects: two expressions with one spelling have the same value as long
    /// as no variable in it is written. None for others.
    pub fn of(&mut self, shader: &Shader, id: ExprId) -> Option<Key> {
        if let Some(Some(known)) = self.known.get(id.index()) {
            return *known;
        }
        let mut spelling = Spelling::default();
        let key = write(shader, id, &mut spelling).map(|()| self.intern(spelling));
        if self.known.len() <= id.index() {
            self.known.resize(id.index() + 1, None);
        }
        self.known[id.index()] = Some(key);
        key
    }

    /// The spelling of `left op right`.
    pub fn of_binary(&mut self, op: BinaryOp, left: Key, right: Key) -> Key {
        let (left, right) = (&self.all[left.0], &self.all[right.0]);
        let text = binary(op, &left.text, &right.text);
        let symbols = left.symbols.iter().chain(&right.symbols).copied().collect();
        self.intern(Spelling { text, symbols })
    }

    /// A spelling as it is written.
    pub fn text(&self, key: Key) -> &str {
        &self.all[key.0].text
    }

    /// True when the variable is in the spelling.
    pub fn mentions(&self, key: Key, symbol: SymbolId) -> bool {
        self.all[key.0].symbols.contains(&symbol)
    }

    /// True when one of the variables is in the spelling.
    pub fn mentions_any(&self, key: Key, symbols: &BTreeSet<SymbolId>) -> bool {
        self.all[key.0].symbols.iter().any(|symbol| symbols.contains(symbol))
    }

    fn intern(&mut self, spelling: Spelling) -> Key {
        if let Some(key) = self.by_text.get(&spelling.text) {
            return *key;
        }
        let key = Key(self.all.len());
        self.by_text.insert(spelling.text.clone(), key);
        self.all.push(spelling);
        key
    }
}

/// The spelling of an expression without side effects, as [`Keys`] have it.
pub fn of(shader: &Shader, id: ExprId) -> Option<String> {
    let mut spelling = Spelling::default();
    write(shader, id, &mut spelling)?;
    Some(spelling.text)
}

fn binary(op: BinaryOp, left: &str, right: &str) -> String {
    format!("({left}{}{right})", op.text())
}

fn write(shader: &Shader, id: ExprId, into: &mut Spelling) -> Option<()> {
    if let Some(value) = shader.fold(id) {
        into.text.push_str(&value.to_string());
        return Some(());
    }
    match &shader.expr(id).kind {
        ExprKind::Paren(inner) => write(shader, *inner, into)?,
        ExprKind::Name(_) => {
            let symbol = shader.symbol_of(id)?;
            into.symbols.push(symbol);
            let _ = write!(into.text, "<{}>", symbol.index());
        }
        ExprKind::Index { base, index } => {
            write(shader, *base, into)?;
            into.text.push('[');
            write(shader, *index, into)?;
            into.text.push(']');
        }
        ExprKind::Field { base, field } => {
            write(shader, *base, into)?;
            into.text.push('.');
            into.text.push_str(&field.name);
        }
        ExprKind::Unary { op: UnaryOp::Increment | UnaryOp::Decrement, .. } => return None,
        ExprKind::Unary { op, op_span: _, operand } => {
            into.text.push_str(op.text());
            write(shader, *operand, into)?;
        }
        ExprKind::Binary { op, op_span: _, left, right } => {
            into.text.push('(');
            write(shader, *left, into)?;
            into.text.push_str(op.text());
            write(shader, *right, into)?;
            into.text.push(')');
        }
        ExprKind::Call { args, .. } => {
            match shader.callee(id) {
                Some(CallTarget::Builtin(call)) if call.directions.iter().all(|d| *d == Direction::In) => {
                    into.text.push_str(call.function.name());
                }
                Some(CallTarget::Constructor(ty)) => into.text.push_str(&ty.to_string()),
                _ => return None,
            }
            into.text.push('(');
            for arg in args {
                write(shader, *arg, into)?;
                into.text.push(',');
            }
            into.text.push(')');
        }
        ExprKind::Literal(_)
        | ExprKind::Method { .. }
        | ExprKind::Postfix { .. }
        | ExprKind::Assign { .. }
        | ExprKind::Ternary { .. }
        | ExprKind::Comma { .. }
        | ExprKind::List(_)
        | ExprKind::Error => return None,
    }
    Some(())
}
