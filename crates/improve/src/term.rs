//! Expressions of real numbers, as nodes of an e-graph and as trees.

use std::fmt;

use egg::{FromOp, Id, Language, RecExpr};

/// A function of one number, by its name in GLSL.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Unary {
    /// −x
    Neg,
    /// |x|
    Abs,
    /// √x
    Sqrt,
    /// 1 ÷ √x
    InverseSqrt,
    /// sin x
    Sin,
    /// cos x
    Cos,
    /// tan x
    Tan,
    /// arcsin x
    Asin,
    /// arccos x
    Acos,
    /// arctan x
    Atan,
    /// sinh x
    Sinh,
    /// cosh x
    Cosh,
    /// tanh x
    Tanh,
    /// arsinh x
    Asinh,
    /// arcosh x
    Acosh,
    /// artanh x
    Atanh,
    /// e^x
    Exp,
    /// ln x
    Log,
    /// 2^x
    Exp2,
    /// log2 x
    Log2,
    /// √max(x, 0): for a number that only rounding makes negative.
    SafeSqrt,
    /// arcsin of the number clamped to [−1, 1].
    SafeAsin,
    /// arccos of the number clamped to [−1, 1].
    SafeAcos,
}

use Unary as U;

/// All functions of one number, with the names that rules use.
pub const UNARY: [(Unary, &str); 23] = [
    (U::Neg, "neg"),
    (U::Abs, "abs"),
    (U::Sqrt, "sqrt"),
    (U::InverseSqrt, "inversesqrt"),
    (U::Sin, "sin"),
    (U::Cos, "cos"),
    (U::Tan, "tan"),
    (U::Asin, "asin"),
    (U::Acos, "acos"),
    (U::Atan, "atan"),
    (U::Sinh, "sinh"),
    (U::Cosh, "cosh"),
    (U::Tanh, "tanh"),
    (U::Asinh, "asinh"),
    (U::Acosh, "acosh"),
    (U::Atanh, "atanh"),
    (U::Exp, "exp"),
    (U::Log, "log"),
    (U::Exp2, "exp2"),
    (U::Log2, "log2"),
    (U::SafeSqrt, "safe-sqrt"),
    (U::SafeAsin, "safe-asin"),
    (U::SafeAcos, "safe-acos"),
];

/// An operation on two numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Binary {
    /// a + b
    Add,
    /// a − b
    Sub,
    /// a · b
    Mul,
    /// a ÷ b
    Div,
    /// a^b, for a > 0
    Pow,
    /// The angle of the point (second, first).
    Atan2,
    /// The smaller one.
    Min,
    /// The larger one.
    Max,
}

/// All operations on two numbers, with the names that rules use.
pub const BINARY: [(Binary, &str); 8] = [
    (Binary::Add, "+"),
    (Binary::Sub, "-"),
    (Binary::Mul, "*"),
    (Binary::Div, "/"),
    (Binary::Pow, "pow"),
    (Binary::Atan2, "atan2"),
    (Binary::Min, "min"),
    (Binary::Max, "max"),
];

/// A constant, by its bits: equal constants are one node.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Constant(u64);

impl Constant {
    /// −0 is 0, since the numbers are real.
    pub fn new(value: f64) -> Self {
        Self(if value == 0.0 { 0 } else { value.to_bits() })
    }

    /// The number.
    pub fn value(self) -> f64 {
        f64::from_bits(self.0)
    }
}

/// A node: an operation with its operands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Node {
    /// A number of binary64, exactly.
    Number(Constant),
    /// π
    Pi,
    /// An input, by its index.
    Leaf(u32),
    /// A function of one number.
    Unary(Unary, Id),
    /// An operation on two.
    Binary(Binary, [Id; 2]),
}

/// An expression: nodes, each behind its operands, the last of them the root.
pub type Term = RecExpr<Node>;

impl Node {
    /// A number.
    pub fn number(value: f64) -> Self {
        Self::Number(Constant::new(value))
    }
}

impl Language for Node {
    type Discriminant = Self;

    fn discriminant(&self) -> Self {
        (*self).map_children(|_| Id::from(0))
    }

    fn matches(&self, other: &Self) -> bool {
        self.discriminant() == other.discriminant()
    }

    fn children(&self) -> &[Id] {
        match self {
            Self::Number(_) | Self::Pi | Self::Leaf(_) => &[],
            Self::Unary(_, id) => std::slice::from_ref(id),
            Self::Binary(_, ids) => ids,
        }
    }

    fn children_mut(&mut self) -> &mut [Id] {
        match self {
            Self::Number(_) | Self::Pi | Self::Leaf(_) => &mut [],
            Self::Unary(_, id) => std::slice::from_mut(id),
            Self::Binary(_, ids) => ids,
        }
    }
}

impl fmt::Display for Node {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(c) => write!(f, "{}", c.value()),
            Self::Pi => f.write_str("pi"),
            Self::Leaf(k) => write!(f, "x{k}"),
            Self::Unary(of, _) => f.write_str(UNARY.iter().find(|(u, _)| u == of).map_or("", |(_, name)| name)),
            Self::Binary(of, _) => f.write_str(BINARY.iter().find(|(b, _)| b == of).map_or("", |(_, name)| name)),
        }
    }
}

impl FromOp for Node {
    type Error = String;

    fn from_op(op: &str, children: Vec<Id>) -> Result<Self, String> {
        let found = match children[..] {
            [] if op == "pi" => Some(Self::Pi),
            [] => match op.strip_prefix('x').and_then(|number| number.parse().ok()) {
                Some(leaf) => Some(Self::Leaf(leaf)),
                None => op.parse::<f64>().ok().filter(|c| c.is_finite()).map(Self::number),
            },
            [id] => UNARY.iter().find(|(_, name)| *name == op).map(|(of, _)| Self::Unary(*of, id)),
            [a, b] => BINARY.iter().find(|(_, name)| *name == op).map(|(of, _)| Self::Binary(*of, [a, b])),
            _ => None,
        };
        found.ok_or_else(|| format!("`{op}` is no operation on {} numbers", children.len()))
    }
}

/// The part of a term that ends at one of its nodes, as a term of its own.
pub fn rooted(nodes: &Term, root: Id) -> Term {
    nodes[root].build_recexpr(|id| nodes[id])
}

/// Reads a term as rules write it: `(- 1 (cos x0))`.
///
/// # Errors
/// What cannot be read.
pub fn parse(text: &str) -> Result<Term, String> {
    text.parse().map_err(|error: egg::RecExprParseError<String>| error.to_string())
}
