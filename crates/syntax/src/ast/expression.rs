//! Expressions and the arena that holds them.

use super::TypeSpecifier;
use crate::types::ScalarType;
use base::text::Span;

/// A name with its place.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Ident {
    /// The name as written.
    pub name: String,
    /// Its place; the invocation when a macro produced it.
    pub span: Span,
}

/// Names an expression of one shader.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ExprId(pub(crate) u32);

impl ExprId {
    /// Position in the arena.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// All expressions of a shader.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Arena {
    exprs: Vec<Expr>,
    depths: Vec<u32>,
}

impl Arena {
    /// Gives back the memory that nothing uses.
    pub(crate) fn shrink(&mut self) {
        self.exprs.shrink_to_fit();
        self.depths.shrink_to_fit();
    }

    /// Adds an expression; its operands must have been added before.
    pub(crate) fn add(&mut self, expr: Expr) -> ExprId {
        let depth = expr.children().iter().map(|c| self.depths[c.index()] + 1).max().unwrap_or(0);
        self.exprs.push(expr);
        self.depths.push(depth);
        // A text of 4 GiB would be needed to get past u32.
        ExprId(u32::try_from(self.exprs.len() - 1).unwrap_or(u32::MAX))
    }

    /// Puts another kind in the place of an expression; its operands must have been added before it.
    pub(crate) fn replace(&mut self, id: ExprId, kind: ExprKind) {
        self.exprs[id.index()].kind = kind;
    }

    /// Levels of operands below an expression.
    pub fn depth(&self, id: ExprId) -> u32 {
        self.depths[id.index()]
    }

    /// The expression with that name.
    pub fn get(&self, id: ExprId) -> &Expr {
        &self.exprs[id.index()]
    }

    /// All expressions, operands before their users.
    pub fn iter(&self) -> impl Iterator<Item = (ExprId, &Expr)> {
        self.exprs.iter().enumerate().map(|(i, e)| (ExprId(u32::try_from(i).unwrap_or(u32::MAX)), e))
    }

    /// Number of expressions.
    pub fn len(&self) -> usize {
        self.exprs.len()
    }

    /// True when there is none.
    pub fn is_empty(&self) -> bool {
        self.exprs.is_empty()
    }
}

/// An expression.
#[derive(Clone, Debug, PartialEq)]
pub struct Expr {
    /// What it is.
    pub kind: ExprKind,
    /// Its place, from the first to the last token.
    pub span: Span,
    /// True when any of its own tokens came from a macro: `span` then covers invocations, and
    /// must not be edited as if the text stood there.
    pub from_macro: bool,
}

/// A literal with its value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Literal {
    /// `true` or `false`.
    Bool(bool),
    /// A signed integer; hexadecimal ones above `0x7fffffff` wrap as the specification wants.
    Int(i32),
    /// An integer with the suffix `u`.
    Uint(u32),
    /// A floating-point literal; the value of its decimal digits in binary64, not yet rounded to
    /// binary32.
    Float(f64),
    /// A floating-point literal with the suffix `lf`.
    Double(f64),
    /// A floating-point literal with the suffix `hf`.
    Half(f64),
    /// An integer with the suffix `s`, `us`, `l` or `ul`: its bits, and its type.
    Sized(u64, ScalarType),
}

/// Kinds of expressions.
#[derive(Clone, Debug, PartialEq)]
pub enum ExprKind {
    /// A literal.
    Literal(Literal),
    /// The name of a variable.
    Name(String),
    /// `(inner)`.
    Paren(ExprId),
    /// `base[index]`.
    Index {
        /// What is indexed.
        base: ExprId,
        /// The index.
        index: ExprId,
    },
    /// `base.field`: a member of a structure or block, or a swizzle.
    Field {
        /// What stands before the dot.
        base: ExprId,
        /// The name behind the dot.
        field: Ident,
    },
    /// `base.method(args)`; the language has only `.length()`.
    Method {
        /// What stands before the dot.
        base: ExprId,
        /// The name behind the dot.
        method: Ident,
        /// Arguments.
        args: Vec<ExprId>,
    },
    /// A function call or a constructor.
    Call {
        /// What is called.
        callee: Callee,
        /// Arguments; `f(void)` has none.
        args: Vec<ExprId>,
    },
    /// A prefix operator.
    Unary {
        /// The operator.
        op: UnaryOp,
        /// Its place.
        op_span: Span,
        /// The operand.
        operand: ExprId,
    },
    /// `operand++` or `operand--`.
    Postfix {
        /// True for `++`.
        increment: bool,
        /// Place of the operator.
        op_span: Span,
        /// The operand.
        operand: ExprId,
    },
    /// An infix operator that assigns nothing.
    Binary {
        /// The operator.
        op: BinaryOp,
        /// Its place.
        op_span: Span,
        /// Left operand.
        left: ExprId,
        /// Right operand.
        right: ExprId,
    },
    /// `target = value` or `target op= value`.
    Assign {
        /// The operator before `=`, if any.
        op: Option<BinaryOp>,
        /// Place of the whole operator.
        op_span: Span,
        /// What is written.
        target: ExprId,
        /// The right side.
        value: ExprId,
    },
    /// `condition ? yes : no`.
    Ternary {
        /// The condition.
        condition: ExprId,
        /// The value when it is true.
        yes: ExprId,
        /// The value when it is false.
        no: ExprId,
    },
    /// `left, right`.
    Comma {
        /// Evaluated first, value dropped.
        left: ExprId,
        /// Evaluated second; the value of the whole.
        right: ExprId,
    },
    /// `{ a, b }`, an initialiser list (4.20 and later).
    List(Vec<ExprId>),
    /// Something that could not be read; a diagnostic tells what.
    Error,
}

/// What a call names.
#[derive(Clone, Debug, PartialEq)]
pub enum Callee {
    /// A function, or a structure's constructor when the name is a structure: resolved by the
    /// checker, see `Shader::callee`.
    Name(Ident),
    /// A constructor of a built-in type or of an array.
    Type(TypeSpecifier),
}

/// Prefix operators.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum UnaryOp {
    /// `+`
    Plus,
    /// `-`
    Minus,
    /// `!`
    Not,
    /// `~`
    Complement,
    /// `++`
    Increment,
    /// `--`
    Decrement,
}

impl UnaryOp {
    /// The spelling.
    pub fn text(self) -> &'static str {
        match self {
            Self::Plus => "+",
            Self::Minus => "-",
            Self::Not => "!",
            Self::Complement => "~",
            Self::Increment => "++",
            Self::Decrement => "--",
        }
    }
}

/// Infix operators that assign nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum BinaryOp {
    /// `+`
    Add,
    /// `-`
    Sub,
    /// `*`
    Mul,
    /// `/`
    Div,
    /// `%`
    Rem,
    /// `<<`
    Shl,
    /// `>>`
    Shr,
    /// `<`
    Less,
    /// `>`
    Greater,
    /// `<=`
    LessEqual,
    /// `>=`
    GreaterEqual,
    /// `==`
    Equal,
    /// `!=`
    NotEqual,
    /// `&`
    BitAnd,
    /// `^`
    BitXor,
    /// `|`
    BitOr,
    /// `&&`
    And,
    /// `^^`
    Xor,
    /// `||`
    Or,
}

impl BinaryOp {
    /// The spelling.
    pub fn text(self) -> &'static str {
        match self {
            Self::Add => "+",
            Self::Sub => "-",
            Self::Mul => "*",
            Self::Div => "/",
            Self::Rem => "%",
            Self::Shl => "<<",
            Self::Shr => ">>",
            Self::Less => "<",
            Self::Greater => ">",
            Self::LessEqual => "<=",
            Self::GreaterEqual => ">=",
            Self::Equal => "==",
            Self::NotEqual => "!=",
            Self::BitAnd => "&",
            Self::BitXor => "^",
            Self::BitOr => "|",
            Self::And => "&&",
            Self::Xor => "^^",
            Self::Or => "||",
        }
    }
}

impl Expr {
    /// Direct operands, in the order of the text.
    pub fn children(&self) -> Vec<ExprId> {
        match &self.kind {
            ExprKind::Literal(_) | ExprKind::Name(_) | ExprKind::Error => Vec::new(),
            ExprKind::Paren(inner) => vec![*inner],
            ExprKind::Index { base, index } => vec![*base, *index],
            ExprKind::Field { base, field: _ } => vec![*base],
            ExprKind::Method { base, method: _, args } => [&[*base], args.as_slice()].concat(),
            ExprKind::Call { callee: Callee::Name(_), args } => args.clone(),
            ExprKind::Call { callee: Callee::Type(ty), args } => {
                let mut all: Vec<ExprId> = ty.dims.iter().filter_map(|d| d.size).collect();
                all.extend(args);
                all
            }
            ExprKind::Unary { op: _, op_span: _, operand }
            | ExprKind::Postfix { increment: _, op_span: _, operand } => {
                vec![*operand]
            }
            ExprKind::Binary { op: _, op_span: _, left, right } | ExprKind::Comma { left, right } => {
                vec![*left, *right]
            }
            ExprKind::Assign { op: _, op_span: _, target, value } => vec![*target, *value],
            ExprKind::Ternary { condition, yes, no } => vec![*condition, *yes, *no],
            ExprKind::List(items) => items.clone(),
        }
    }
}
