//! Where integer expressions become floats.

use std::collections::HashMap;

use syntax::Shader;
use syntax::ast::{BinaryOp, Callee, ExprId, ExprKind, ItemKind, Literal, StmtKind, UnaryOp};
use syntax::symbols::CallTarget;
use syntax::types::Type;

use syntax::walk::{declarators, statements};

/// How an integer becomes a float.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Context<'s> {
    /// By the implicit conversion of an operand, a value that is stored, passed or returned.
    Converted,
    /// As an argument of the built-in function of this name.
    Builtin(&'s str),
    /// By a constructor.
    Constructed,
}

/// What uses each expression.
pub struct Contexts<'s> {
    shader: &'s Shader,
    parents: Vec<Option<ExprId>>,
    /// Types of what takes the value of a whole expression: an initialised variable, a result.
    taken: HashMap<ExprId, Type>,
}

fn is_floating(ty: &Type) -> bool {
    ty.scalar().is_some_and(|s| s.is_floating())
}

impl<'s> Contexts<'s> {
    /// Looks at all expressions.
    pub fn new(shader: &'s Shader) -> Self {
        let mut parents = vec![None; shader.arena().len()];
        for (id, expr) in shader.arena().iter() {
            expr.children().iter().for_each(|c| parents[c.index()] = Some(id));
        }
        let mut taken = HashMap::new();
        declarators(shader, |declarator| {
            let Some(initializer) = &declarator.initializer else { return };
            if let Some((_, symbol)) = shader.symbols().find(|(_, s)| s.span == Some(declarator.name.span)) {
                taken.insert(initializer.value, symbol.ty.clone());
            }
        });
        for (_, info) in shader.functions() {
            let body = info.definition.and_then(|d| match &shader.unit().items.get(d)?.kind {
                ItemKind::Function(f) => f.body.as_ref().map(|b| b.span),
                _ => None,
            });
            let Some(body) = body else { continue };
            statements(shader, |statement| match statement.kind {
                StmtKind::Return(Some(value)) if body.contains(statement.span.start) => {
                    taken.insert(value, info.return_type.clone());
                }
                _ => {}
            });
        }
        Self { shader, parents, taken }
    }

    /// How the value of an integer expression becomes a float at once; none when it does not. A sign and
    /// parentheses around it do not count.
    pub fn of(&self, id: ExprId) -> Option<Context<'s>> {
        self.look(id, false)
    }

    /// True when the value of an integer expression becomes a float, be it after more integer arithmetic.
    pub fn becomes_float(&self, id: ExprId) -> bool {
        self.look(id, true).is_some()
    }

    fn look(&self, mut id: ExprId, arithmetic: bool) -> Option<Context<'s>> {
        let shader = self.shader;
        loop {
            let Some(parent) = self.parents[id.index()] else {
                return self.taken.get(&id).filter(|t| is_floating(t)).map(|_| Context::Converted);
            };
            let result = shader.type_of(parent);
            match &shader.expr(parent).kind {
                ExprKind::Paren(_) | ExprKind::Unary { op: UnaryOp::Minus | UnaryOp::Plus, .. } => id = parent,
                ExprKind::Binary { op: BinaryOp::Add | BinaryOp::Sub | BinaryOp::Mul | BinaryOp::Div, .. } => {
                    if is_floating(result) {
                        return Some(Context::Converted);
                    }
                    if !arithmetic {
                        return None;
                    }
                    id = parent;
                }
                ExprKind::Ternary { condition, .. } if *condition != id => {
                    if is_floating(result) {
                        return Some(Context::Converted);
                    }
                    id = parent;
                }
                ExprKind::Assign { op: _, op_span: _, target, value } if *value == id => {
                    return is_floating(shader.type_of(*target)).then_some(Context::Converted);
                }
                ExprKind::Binary { left, right, .. } => {
                    let other = if *left == id { *right } else { *left };
                    return is_floating(shader.type_of(other)).then_some(Context::Converted);
                }
                ExprKind::Call { callee, args } => return self.argument(id, parent, callee, args),
                _ => return None,
            }
        }
    }

    fn argument(&self, id: ExprId, call: ExprId, callee: &'s Callee, args: &[ExprId]) -> Option<Context<'s>> {
        let shader = self.shader;
        let at = args.iter().position(|a| *a == id)?;
        match shader.callee(call)? {
            CallTarget::Constructor(ty) => is_floating(ty).then_some(Context::Constructed),
            CallTarget::User(function) => {
                let param = shader.function_info(*function).params.get(at)?;
                is_floating(&param.ty).then_some(Context::Converted)
            }
            CallTarget::Builtin(_) => {
                let Callee::Name(name) = callee else { return None };
                let all = NUMERIC.contains(&name.name.as_str()) && is_floating(shader.type_of(call));
                all.then_some(Context::Builtin(&name.name))
            }
        }
    }
}

/// Built-in functions all of whose arguments are floats when the result is one.
const NUMERIC: &[&str] = &[
    "radians",
    "degrees",
    "sin",
    "cos",
    "tan",
    "asin",
    "acos",
    "atan",
    "pow",
    "exp",
    "log",
    "exp2",
    "log2",
    "sqrt",
    "inversesqrt",
    "abs",
    "sign",
    "floor",
    "ceil",
    "fract",
    "mod",
    "min",
    "max",
    "clamp",
    "mix",
    "step",
    "smoothstep",
    "length",
    "distance",
    "dot",
    "normalize",
];

/// The text of a decimal integer literal without suffix that stands in the text itself.
pub fn integer_literal(shader: &Shader, id: ExprId) -> Option<&str> {
    let expr = shader.expr(id);
    let text = shader.text_of(id);
    let plain = !expr.from_macro && (text == "0" || !text.starts_with('0')) && text.bytes().all(|b| b.is_ascii_digit());
    (matches!(expr.kind, ExprKind::Literal(Literal::Int(_))) && plain).then_some(text)
}
