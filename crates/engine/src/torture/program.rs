//! A program as a tree: made by `generate`, made smaller by `shrink`, printed in GLSL and WGSL by `print`.

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};

use super::operations::OPERATIONS;

/// What a program is written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Language {
    /// GLSL 4.50.
    Glsl,
    /// WGSL.
    Wgsl,
}

impl Language {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Glsl, Self::Wgsl];

    /// `glsl` or `wgsl`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Glsl => "glsl",
            Self::Wgsl => "wgsl",
        }
    }
}

/// What a program is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Form {
    /// A function, called with arguments.
    Function,
    /// A vertex stage.
    Vertex,
    /// A fragment stage.
    Fragment,
    /// A compute stage with memory of its workgroup.
    Compute,
}

impl Form {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Function, Self::Vertex, Self::Fragment, Self::Compute];

    /// As suites name it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Function => "function",
            Self::Vertex => "vertex",
            Self::Fragment => "fragment",
            Self::Compute => "compute",
        }
    }
}

/// What a component is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Scalar {
    /// binary32.
    Float,
    /// Signed, of 32 bits.
    Int,
    /// Unsigned, of 32 bits.
    Uint,
    /// True or false.
    Bool,
}

/// A type.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Type {
    /// A number or a vector: components, 1 to 4.
    Value(Scalar, u8),
    /// Columns and rows of binary32, 2 to 4 each.
    Matrix(u8, u8),
    /// An array with this number of elements.
    Array(Box<Type>, u8),
    /// By its place in [`Program::structures`].
    Structure(usize),
}

impl Type {
    /// One number.
    pub const FLOAT: Self = Self::Value(Scalar::Float, 1);
    /// A signed number.
    pub const INT: Self = Self::Value(Scalar::Int, 1);
    /// An unsigned number.
    pub const UINT: Self = Self::Value(Scalar::Uint, 1);
    /// True or false.
    pub const BOOL: Self = Self::Value(Scalar::Bool, 1);

    /// Components of a vector; none of anything else.
    pub fn lanes(&self) -> Option<u8> {
        match self {
            Self::Value(_, n) if *n > 1 => Some(*n),
            _ => None,
        }
    }
}

/// What an expression reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Variable {
    /// An input of the program, by its place.
    Input(usize),
    /// A parameter of the helper in which it stands.
    Parameter(usize),
    /// What the pointer of a helper points to: its first parameter.
    Target,
    /// A local variable or a counter.
    Local(u32),
}

/// An expression with its type.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Expression {
    /// Its type.
    pub ty: Type,
    /// What it is.
    pub kind: Kind,
}

/// Kinds of expressions.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    /// The words of the components of a number or vector.
    Literal(Vec<u32>),
    /// The value of a variable.
    Read(Variable),
    /// A row of [`OPERATIONS`] with its arguments.
    Operation(usize, Vec<Expression>),
    /// A vector of parts, a matrix of columns, an array of elements, a structure of members.
    Construct(Vec<Expression>),
    /// A member of a structure.
    Member(Box<Expression>, usize),
    /// An element of an array or vector, or a column; the index is inside by construction.
    Element(Box<Expression>, Box<Expression>),
    /// Components of a vector.
    Swizzle(Box<Expression>, Vec<u8>),
    /// A call of a helper without a pointer.
    Call(usize, Vec<Expression>),
}

impl Expression {
    /// A literal.
    pub fn literal(scalar: Scalar, words: Vec<u32>) -> Self {
        Self { ty: Type::Value(scalar, words.len() as u8), kind: Kind::Literal(words) }
    }

    /// A signed number.
    pub fn int(value: i32) -> Self {
        Self::literal(Scalar::Int, vec![value as u32])
    }

    /// A variable of a type.
    pub fn read(variable: Variable, ty: Type) -> Self {
        Self { ty, kind: Kind::Read(variable) }
    }

    /// The parts of it.
    pub fn parts(&self) -> Vec<&Self> {
        match &self.kind {
            Kind::Literal(_) | Kind::Read(_) => Vec::new(),
            Kind::Operation(_, all) | Kind::Construct(all) | Kind::Call(_, all) => all.iter().collect(),
            Kind::Member(of, _) | Kind::Swizzle(of, _) => vec![of],
            Kind::Element(of, index) => vec![of, index],
        }
    }

    /// The same to be changed.
    pub fn parts_mut(&mut self) -> Vec<&mut Self> {
        match &mut self.kind {
            Kind::Literal(_) | Kind::Read(_) => Vec::new(),
            Kind::Operation(_, all) | Kind::Construct(all) | Kind::Call(_, all) => all.iter_mut().collect(),
            Kind::Member(of, _) | Kind::Swizzle(of, _) => vec![of],
            Kind::Element(of, index) => vec![of, index],
        }
    }

    /// Calls `see` with this and everything in it, from outside to inside.
    pub fn each<'a>(&'a self, see: &mut dyn FnMut(&'a Self)) {
        see(self);
        self.parts().into_iter().for_each(|part| part.each(see));
    }

    /// The same to be changed; what `see` puts in place is gone through as well.
    pub fn each_mut(&mut self, see: &mut dyn FnMut(&mut Self)) {
        see(self);
        self.parts_mut().into_iter().for_each(|part| part.each_mut(see));
    }

    /// Number of nodes of its tree.
    pub fn size(&self) -> usize {
        1 + self.parts().into_iter().map(Self::size).sum::<usize>()
    }

    /// True where a compiler knows the value.
    pub fn is_constant(&self) -> bool {
        match &self.kind {
            Kind::Read(_) | Kind::Call(..) => false,
            _ => self.parts().into_iter().all(Self::is_constant),
        }
    }

    /// The variable that a place belongs to.
    pub fn root(&self) -> Option<Variable> {
        match &self.kind {
            Kind::Read(variable) => Some(*variable),
            Kind::Member(of, _) | Kind::Element(of, _) | Kind::Swizzle(of, _) => of.root(),
            Kind::Literal(_) | Kind::Operation(..) | Kind::Construct(_) | Kind::Call(..) => None,
        }
    }
}

/// Statements.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Statement {
    /// A variable with its first value.
    Declare { id: u32, value: Expression },
    /// A place gets a value.
    Assign { place: Expression, value: Expression },
    /// Two lists of statements, of which the condition chooses one.
    If { condition: Expression, then: Vec<Self>, otherwise: Vec<Self> },
    /// A loop of so many rounds with a counter from 0.
    For { id: u32, rounds: u8, body: Vec<Self> },
    /// The same, which leaves from inside of the loop.
    Loop { id: u32, rounds: u8, body: Vec<Self> },
    /// Cases by number, each for some of them; the last is the default.
    Switch { selector: Expression, cases: Vec<(Vec<i32>, Vec<Self>)>, otherwise: Vec<Self> },
    /// Leaves the loop where the condition holds.
    Break { condition: Expression },
    /// Begins the next round where the condition holds.
    Continue { condition: Expression },
    /// Gives the results and ends the function or stage.
    Finish { results: Vec<Expression> },
    /// A helper with a pointer changes a place.
    Change { helper: usize, target: Expression, arguments: Vec<Expression> },
    /// Each invocation gives its workgroup a value and takes that of the invocation `shift` places on.
    Exchange { id: u32, value: Expression, shift: u8 },
    /// The sum of what the invocations of a workgroup give, by atomic additions.
    Total { id: u32, value: Expression },
}

impl Statement {
    /// Its own expressions, without those of statements in it. Places are not among them, but indices in places are.
    pub fn expressions_mut(&mut self) -> Vec<&mut Expression> {
        match self {
            Self::Declare { value, .. } | Self::Exchange { value, .. } | Self::Total { value, .. } => vec![value],
            Self::Assign { place, value } => {
                let mut all = indices_mut(place);
                all.push(value);
                all
            }
            Self::If { condition, .. } | Self::Break { condition } | Self::Continue { condition } => vec![condition],
            Self::For { .. } | Self::Loop { .. } => Vec::new(),
            Self::Switch { selector, .. } => vec![selector],
            Self::Finish { results } => results.iter_mut().collect(),
            Self::Change { target, arguments, .. } => {
                let mut all = indices_mut(target);
                all.extend(arguments.iter_mut());
                all
            }
        }
    }

    /// Blocks in it.
    pub fn blocks_mut(&mut self) -> Vec<&mut Vec<Self>> {
        match self {
            Self::If { then, otherwise, .. } => vec![then, otherwise],
            Self::For { body, .. } | Self::Loop { body, .. } => vec![body],
            Self::Switch { cases, otherwise, .. } => {
                let mut all: Vec<&mut Vec<Self>> = cases.iter_mut().map(|(_, block)| block).collect();
                all.push(otherwise);
                all
            }
            Self::Declare { .. }
            | Self::Assign { .. }
            | Self::Break { .. }
            | Self::Continue { .. }
            | Self::Finish { .. }
            | Self::Change { .. }
            | Self::Exchange { .. }
            | Self::Total { .. } => Vec::new(),
        }
    }

    /// The place that it changes.
    pub fn place(&self) -> Option<&Expression> {
        match self {
            Self::Assign { place, .. } => Some(place),
            Self::Change { target, .. } => Some(target),
            _ => None,
        }
    }

    /// A word for its kind, for counts.
    pub fn word(&self) -> &'static str {
        match self {
            Self::Declare { .. } => "declare",
            Self::Assign { .. } => "assign",
            Self::If { .. } => "if",
            Self::For { .. } => "for",
            Self::Loop { .. } => "loop",
            Self::Switch { .. } => "switch",
            Self::Break { .. } => "break",
            Self::Continue { .. } => "continue",
            Self::Finish { .. } => "early return",
            Self::Change { .. } => "pointer",
            Self::Exchange { .. } => "exchange",
            Self::Total { .. } => "atomic",
        }
    }
}

/// Indices in a place.
fn indices_mut(place: &mut Expression) -> Vec<&mut Expression> {
    match &mut place.kind {
        Kind::Element(of, index) => {
            let mut all = indices_mut(of);
            all.push(index);
            all
        }
        Kind::Member(of, _) | Kind::Swizzle(of, _) => indices_mut(of),
        _ => Vec::new(),
    }
}

/// A function that the program calls.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Helper {
    /// What its pointer points to, `inout` in GLSL; such a helper gives nothing back.
    pub target: Option<Type>,
    /// Its other parameters.
    pub parameters: Vec<Type>,
    /// What it does first.
    pub body: Vec<Statement>,
    /// What it gives back, or puts into the target.
    pub result: Expression,
}

/// An input of a program or a function.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Input {
    /// Its type: a number, a vector or a matrix.
    pub ty: Type,
    /// Whether it is a uniform; never of a function.
    pub uniform: bool,
}

/// A program.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Program {
    /// What it is written in.
    pub language: Language,
    /// What it is.
    pub form: Form,
    /// Members of its structures; each names those before it alone.
    pub structures: Vec<Vec<Type>>,
    /// Its functions; each calls those before it alone.
    pub helpers: Vec<Helper>,
    /// Inputs, uniforms included.
    pub inputs: Vec<Input>,
    /// Statements before the results.
    pub body: Vec<Statement>,
    /// What comes out: one of a function.
    pub results: Vec<Expression>,
}

impl Program {
    /// The blocks at the top: those of the helpers, and the last one its own.
    pub fn top_mut(&mut self) -> Vec<&mut Vec<Statement>> {
        self.helpers.iter_mut().map(|helper| &mut helper.body).chain([&mut self.body]).collect()
    }

    /// Calls `see` with every block, from outside to inside.
    pub fn each_block_mut(&mut self, see: &mut dyn FnMut(&mut Vec<Statement>)) {
        fn go(block: &mut Vec<Statement>, see: &mut dyn FnMut(&mut Vec<Statement>)) {
            see(block);
            block.iter_mut().flat_map(Statement::blocks_mut).for_each(|inner| go(inner, see));
        }
        self.top_mut().into_iter().for_each(|block| go(block, see));
    }

    /// Calls `see` with every expression that is no statement's place, and what is in it. In a fixed order: of the
    /// blocks, then the results.
    pub fn each_mut(&mut self, see: &mut dyn FnMut(&mut Expression)) {
        self.each_block_mut(&mut |block| {
            block.iter_mut().flat_map(Statement::expressions_mut).for_each(|e| e.each_mut(see));
        });
        self.helpers.iter_mut().for_each(|helper| helper.result.each_mut(see));
        self.results.iter_mut().for_each(|result| result.each_mut(see));
    }

    /// Kinds of statements, expressions and types in it, and the names of its operations.
    pub fn kinds(&self) -> BTreeSet<String> {
        let mut found = BTreeSet::from([self.form.name().to_owned(), self.language.name().to_owned()]);
        let mut copy = self.clone();
        copy.each_block_mut(&mut |block| {
            found.extend(block.iter().map(|s| s.word().to_owned()));
            let at_element = |place: &Expression| matches!(place.kind, Kind::Element(..) | Kind::Member(..));
            for statement in block.iter() {
                match statement {
                    Statement::Change { target, .. } if at_element(target) => {
                        found.insert("pointer to a part".to_owned());
                    }
                    Statement::Assign { place, .. } if at_element(place) => {
                        found.insert("assign a part".to_owned());
                    }
                    _ => {}
                }
            }
        });
        copy.each_mut(&mut |expression| {
            found.insert(match (&expression.kind, &expression.ty) {
                (Kind::Literal(_), _) => "literal".to_owned(),
                (Kind::Read(_), _) => "read".to_owned(),
                (Kind::Operation(row, _), _) => OPERATIONS[*row].name.to_owned(),
                (Kind::Construct(_), Type::Value(..)) => "construct vector".to_owned(),
                (Kind::Construct(_), Type::Matrix(..)) => "construct matrix".to_owned(),
                (Kind::Construct(_), Type::Array(..)) => "construct array".to_owned(),
                (Kind::Construct(_), Type::Structure(_)) => "construct structure".to_owned(),
                (Kind::Member(..), _) => "member".to_owned(),
                (Kind::Element(..), _) => "element".to_owned(),
                (Kind::Swizzle(..), _) => "swizzle".to_owned(),
                (Kind::Call(..), _) => "call".to_owned(),
            });
        });
        found.extend(self.inputs.iter().filter(|i| i.uniform).map(|_| "uniform".to_owned()));
        found
    }

    /// The names of its operations.
    pub fn operations(&self) -> BTreeSet<&'static str> {
        let mut found = BTreeSet::new();
        self.clone().each_mut(&mut |expression| {
            if let Kind::Operation(row, _) = &expression.kind {
                found.insert(OPERATIONS[*row].name);
            }
        });
        found
    }

    /// True where a float is computed of constants alone by an operation that rounds. Readers of translations fold these in
    /// steps of their own, which is no fault of a translation.
    pub fn folds(&self) -> bool {
        let mut found = false;
        self.clone().each_mut(&mut |e| {
            if let (Kind::Operation(row, _), Type::Value(Scalar::Float, _) | Type::Matrix(..)) = (&e.kind, &e.ty) {
                found |= OPERATIONS[*row].rounds() && e.is_constant();
            }
        });
        found
    }

    /// Statements and nodes of expressions.
    pub fn size(&self) -> usize {
        let (mut size, mut copy) = (self.inputs.len() + self.helpers.len() + self.structures.len(), self.clone());
        copy.each_block_mut(&mut |block| size += block.len());
        copy.each_mut(&mut |_| size += 1);
        size
    }
}
