//! Expressions of real numbers, as nodes of an e-graph and as trees.

use std::fmt;

use egg::{FromOp, Id, Language, RecExpr};

/// Defines operations with the names that rules use.
macro_rules! operations {
    ($(#[$about:meta])* $of:ident { $($(#[$doc:meta])* $op:ident $name:literal,)* }) => {
        $(#[$about])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum $of {
            $($(#[$doc])* $op,)*
        }

        impl $of {
            /// The name that rules use.
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$op => $name,)*
                }
            }

            /// The operation of this name.
            pub fn by_name(name: &str) -> Option<Self> {
                match name {
                    $($name => Some(Self::$op),)*
                    _ => None,
                }
            }
        }
    };
}

operations! {
    /// A function of one number, by its name in GLSL.
    Unary {
        /// −x
        Neg "neg",
        /// |x|
        Abs "abs",
        /// √x
        Sqrt "sqrt",
        /// 1 ÷ √x
        InverseSqrt "inversesqrt",
        /// sin x
        Sin "sin",
        /// cos x
        Cos "cos",
        /// tan x
        Tan "tan",
        /// arcsin x
        Asin "asin",
        /// arccos x
        Acos "acos",
        /// arctan x
        Atan "atan",
        /// sinh x
        Sinh "sinh",
        /// cosh x
        Cosh "cosh",
        /// tanh x
        Tanh "tanh",
        /// arsinh x
        Asinh "asinh",
        /// arcosh x
        Acosh "acosh",
        /// artanh x
        Atanh "atanh",
        /// e^x
        Exp "exp",
        /// ln x
        Log "log",
        /// 2^x
        Exp2 "exp2",
        /// log2 x
        Log2 "log2",
        /// √max(x, 0): for a number that only rounding makes negative.
        SafeSqrt "safe-sqrt",
        /// arcsin of the number clamped to [−1, 1].
        SafeAsin "safe-asin",
        /// arccos of the number clamped to [−1, 1].
        SafeAcos "safe-acos",
    }
}

operations! {
    /// An operation on two numbers.
    Binary {
        /// a + b
        Add "+",
        /// a − b
        Sub "-",
        /// a · b
        Mul "*",
        /// a ÷ b
        Div "/",
        /// a^b, for a > 0
        Pow "pow",
        /// The angle of the point (second, first).
        Atan2 "atan2",
        /// The smaller one.
        Min "min",
        /// The larger one.
        Max "max",
    }
}

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
            Self::Unary(of, _) => f.write_str(of.name()),
            Self::Binary(of, _) => f.write_str(of.name()),
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
            [id] => Unary::by_name(op).map(|of| Self::Unary(of, id)),
            [a, b] => Binary::by_name(op).map(|of| Self::Binary(of, [a, b])),
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
