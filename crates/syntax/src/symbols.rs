//! Variables and functions of a shader, and where they are used.

use super::ast::{ExprId, Ident};
use super::builtin::BuiltinFunction;
use super::fold::Const;
use super::interface::Storage;
use super::types::Type;
use base::text::Span;

/// Names a variable of one shader: global, local, parameter, block member or built-in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct SymbolId(pub(crate) u32);

impl SymbolId {
    /// Position among the symbols.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// Names a function of one shader.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct FunctionId(pub(crate) u32);

impl FunctionId {
    /// Position among the functions.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// A variable.
#[derive(Clone, Debug, PartialEq)]
pub struct Symbol {
    /// Name in the text, or of the built-in variable.
    pub name: String,
    /// Place of the name in its declaration; none for a built-in.
    pub span: Option<Span>,
    /// Type with all dimensions, sizes folded.
    pub ty: Type,
    /// What it is.
    pub kind: SymbolKind,
    /// True when it must not be written: inputs, uniforms, constants, read-only built-ins.
    pub read_only: bool,
    /// Value of a constant, when it could be folded.
    pub value: Option<Const>,
    /// What a constant is declared as.
    pub initializer: Option<ExprId>,
}

/// Kinds of variables.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SymbolKind {
    /// Known to the language, such as `gl_Position`.
    Builtin,
    /// At file scope.
    Global(Storage),
    /// Member of a block without an instance name: index of the block in the interface.
    BlockMember(usize),
    /// Instance of a block: index of the block in the interface.
    BlockInstance(usize),
    /// Parameter of a function.
    Param(Direction),
    /// Declared in a function.
    Local,
}

/// Which way a parameter carries its value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Direction {
    /// `in`, or nothing.
    #[default]
    In,
    /// `out`
    Out,
    /// `inout`
    InOut,
}

/// What happens to a variable at a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Access {
    /// Its value is used.
    Read,
    /// It gets a value: assignment, or argument of an `out` parameter. Writing one component or
    /// element counts.
    Write,
    /// Both: `+=`, `++`, argument of an `inout` parameter.
    ReadWrite,
}

impl Access {
    /// True when the value is used.
    pub fn reads(self) -> bool {
        matches!(self, Self::Read | Self::ReadWrite)
    }

    /// True when it gets a value.
    pub fn writes(self) -> bool {
        matches!(self, Self::Write | Self::ReadWrite)
    }
}

/// One use of a variable in an expression. A declaration with an initialiser is none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Use {
    /// The variable.
    pub symbol: SymbolId,
    /// The expression that is its name.
    pub expr: ExprId,
    /// Place of the name.
    pub span: Span,
    /// True when the name came from a macro: the span is then the invocation.
    pub from_macro: bool,
    /// What happens.
    pub access: Access,
    /// True when only a member, element or component is meant.
    pub partial: bool,
    /// The function in whose body it stands; none at file scope.
    pub function: Option<FunctionId>,
}

/// A function of the shader; overloads are functions of their own.
#[derive(Clone, Debug, PartialEq)]
pub struct FunctionInfo {
    /// Its name, at the definition or, without one, at the first prototype.
    pub name: Ident,
    /// Its parameters.
    pub params: Vec<ParamInfo>,
    /// What it returns.
    pub return_type: Type,
    /// Index of the item with the body.
    pub definition: Option<usize>,
    /// Indices of the items that are prototypes.
    pub prototypes: Vec<usize>,
}

/// A parameter of a function.
#[derive(Clone, Debug, PartialEq)]
pub struct ParamInfo {
    /// Its name at the definition, if it has one.
    pub name: Option<Ident>,
    /// Type with all dimensions, sizes folded.
    pub ty: Type,
    /// Which way it carries its value.
    pub direction: Direction,
    /// Its symbol; none without a name or a body.
    pub symbol: Option<SymbolId>,
    /// The whole parameter.
    pub span: Span,
}

/// What a call means.
#[derive(Clone, Debug, PartialEq)]
pub enum CallTarget {
    /// A constructor of this type; it may be ill-formed.
    Constructor(Type),
    /// A function of the shader.
    User(FunctionId),
    /// A built-in function.
    Builtin(BuiltinCall),
}

/// A call of a built-in function, as one of its overloads.
#[derive(Clone, Debug, PartialEq)]
pub struct BuiltinCall {
    /// The function.
    pub function: BuiltinFunction,
    /// Which way each parameter carries its value.
    pub directions: Vec<Direction>,
}
