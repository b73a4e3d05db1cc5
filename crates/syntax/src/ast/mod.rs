//! Syntax tree of a shader: items, declarations, statements and expressions, all with byte spans
//! of the original text (GLSL 4.60 specification, chapter 9 "Shading Language Grammar").
//!
//! Expressions lie in an [`Arena`] and are named by [`ExprId`]; operands always come before the
//! expression that uses them. A span of something that a macro produced is the span of the
//! macro's invocation.

mod expression;
mod qualifier;

use base::text::Span;
pub use expression::{Arena, BinaryOp, Callee, Expr, ExprId, ExprKind, Ident, Literal, UnaryOp};
pub use qualifier::{
    AuxiliaryQualifier, Interpolation, LayoutEntry, MemoryQualifier, Precision, Qualifier, QualifierKind, Qualifiers,
    StorageQualifier,
};

/// One `[size]` or `[]`.
#[derive(Clone, Debug, PartialEq)]
pub struct ArrayDim {
    /// From `[` to `]`.
    pub span: Span,
    /// The size, when one is written.
    pub size: Option<ExprId>,
}

/// A type as written, with the array dimensions that stand right behind it.
#[derive(Clone, Debug, PartialEq)]
pub struct TypeSpecifier {
    /// What it names.
    pub kind: TypeKind,
    /// Place of the name or structure, without array dimensions.
    pub name_span: Span,
    /// Dimensions behind the type (`float[3] a`), outermost first.
    pub dims: Vec<ArrayDim>,
    /// Place including the dimensions.
    pub span: Span,
}

/// What a type specifier names.
#[derive(Clone, Debug, PartialEq)]
pub enum TypeKind {
    /// A built-in type or a structure, by name; `void` too.
    Named(String),
    /// A structure defined in place.
    Struct(StructSpecifier),
}

/// `struct Name { members }`.
#[derive(Clone, Debug, PartialEq)]
pub struct StructSpecifier {
    /// The name, if it has one.
    pub name: Option<Ident>,
    /// Declarations of the members.
    pub members: Vec<Declaration>,
    /// From `struct` to `}`.
    pub span: Span,
}

/// `qualifiers type a, b[2] = …;`: variables, or a structure without variables.
#[derive(Clone, Debug, PartialEq)]
pub struct Declaration {
    /// Qualifiers before the type.
    pub qualifiers: Qualifiers,
    /// The type.
    pub ty: TypeSpecifier,
    /// The variables; none in `struct S { … };`.
    pub declarators: Vec<Declarator>,
    /// Whole statement, with the `;` when there is one (a condition has none).
    pub span: Span,
    /// Place of the `;`.
    pub semicolon: Option<Span>,
}

/// One variable of a declaration: `p1[8] = …`.
#[derive(Clone, Debug, PartialEq)]
pub struct Declarator {
    /// The name.
    pub name: Ident,
    /// Dimensions behind the name, outermost first.
    pub dims: Vec<ArrayDim>,
    /// The initialiser.
    pub initializer: Option<Initializer>,
    /// Name, dimensions and initialiser; without the comma.
    pub span: Span,
}

/// `= value`.
#[derive(Clone, Debug, PartialEq)]
pub struct Initializer {
    /// Place of `=`.
    pub equals: Span,
    /// The expression behind `=`, or the list in `{ }`.
    pub value: ExprId,
}

/// The whole shader.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Unit {
    /// Items in the order of the text.
    pub items: Vec<Item>,
}

/// Something at file scope.
#[derive(Clone, Debug, PartialEq)]
pub struct Item {
    /// What it is.
    pub kind: ItemKind,
    /// Its place, with the `;`.
    pub span: Span,
}

/// Kinds of items.
#[derive(Clone, Debug, PartialEq)]
pub enum ItemKind {
    /// Variables or a structure.
    Declaration(Declaration),
    /// A function with its body, or a prototype.
    Function(Function),
    /// `uniform Name { … } instance;`
    Block(InterfaceBlock),
    /// `layout(triangles) in;`, `invariant gl_Position;`, `precise a, b;`
    Qualified(QualifiedNames),
    /// `precision highp float;`
    Precision(PrecisionStatement),
    /// A lone `;`.
    Empty,
    /// Text that could not be read.
    Error,
}

/// Qualifiers applied to the stage or to names that exist already.
#[derive(Clone, Debug, PartialEq)]
pub struct QualifiedNames {
    /// The qualifiers.
    pub qualifiers: Qualifiers,
    /// The names; none in `layout(triangles) in;`.
    pub names: Vec<Ident>,
}

/// `precision highp float;`
#[derive(Clone, Debug, PartialEq)]
pub struct PrecisionStatement {
    /// The precision.
    pub precision: Precision,
    /// The type.
    pub ty: TypeSpecifier,
}

/// `qualifiers Name { members } instance[dims];`
#[derive(Clone, Debug, PartialEq)]
pub struct InterfaceBlock {
    /// Qualifiers before the name.
    pub qualifiers: Qualifiers,
    /// Name of the block.
    pub name: Ident,
    /// Declarations of the members.
    pub members: Vec<Declaration>,
    /// From `{` to `}`.
    pub body_span: Span,
    /// Name of the instance, if any: members are in scope by themselves without it.
    pub instance: Option<Ident>,
    /// Dimensions of the instance.
    pub dims: Vec<ArrayDim>,
    /// Place of the `;`.
    pub semicolon: Option<Span>,
}

/// A function or prototype.
#[derive(Clone, Debug, PartialEq)]
pub struct Function {
    /// Qualifiers before the return type.
    pub qualifiers: Qualifiers,
    /// The return type.
    pub return_type: TypeSpecifier,
    /// The name.
    pub name: Ident,
    /// The parameters; none for `(void)`.
    pub params: Vec<Param>,
    /// From `(` to `)`.
    pub params_span: Span,
    /// The head: from the first qualifier or the return type to `)`.
    pub head_span: Span,
    /// The body; none in a prototype.
    pub body: Option<Block>,
}

/// A parameter of a function.
#[derive(Clone, Debug, PartialEq)]
pub struct Param {
    /// Qualifiers.
    pub qualifiers: Qualifiers,
    /// The type.
    pub ty: TypeSpecifier,
    /// The name, if any.
    pub name: Option<Ident>,
    /// Dimensions behind the name.
    pub dims: Vec<ArrayDim>,
    /// The whole parameter, without the comma.
    pub span: Span,
}

/// `{ statements }`.
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    /// The statements.
    pub statements: Vec<Stmt>,
    /// From `{` to `}`.
    pub span: Span,
}

/// A statement.
#[derive(Clone, Debug, PartialEq)]
pub struct Stmt {
    /// What it is.
    pub kind: StmtKind,
    /// Its place, with the `;`.
    pub span: Span,
}

/// Kinds of statements.
#[derive(Clone, Debug, PartialEq)]
pub enum StmtKind {
    /// A lone `;`.
    Empty,
    /// Local variables or a structure.
    Declaration(Declaration),
    /// `precision highp float;`
    Precision(PrecisionStatement),
    /// `invariant a;` or `precise a;`
    Qualified(QualifiedNames),
    /// An expression.
    Expr(ExprId),
    /// A block of its own.
    Block(Block),
    /// `if (condition) then else otherwise`.
    If {
        /// The condition.
        condition: ExprId,
        /// When it is true.
        then: Box<Stmt>,
        /// When it is false.
        otherwise: Option<Box<Stmt>>,
    },
    /// `for (init; condition; step) body`.
    For {
        /// First part: a declaration, an expression or nothing.
        init: Box<Stmt>,
        /// Second part.
        condition: Option<Condition>,
        /// Third part.
        step: Option<ExprId>,
        /// The body.
        body: Box<Stmt>,
        /// From `for` to `)`.
        head_span: Span,
    },
    /// `while (condition) body`.
    While {
        /// The condition.
        condition: Condition,
        /// The body.
        body: Box<Stmt>,
    },
    /// `do body while (condition);`
    DoWhile {
        /// The body.
        body: Box<Stmt>,
        /// The condition.
        condition: ExprId,
    },
    /// `switch (selector) { … }`; labels are statements of the body.
    Switch {
        /// The selector.
        selector: ExprId,
        /// Labels and statements.
        body: Block,
    },
    /// `case value:`
    Case(ExprId),
    /// `default:`
    Default,
    /// `return;` or `return value;`
    Return(Option<ExprId>),
    /// `break;`
    Break,
    /// `continue;`
    Continue,
    /// `discard;`
    Discard,
    /// Text that could not be read.
    Error,
}

/// The condition of a loop.
#[expect(clippy::large_enum_variant, reason = "there is one for each loop of a shader: a box would save nothing")]
#[derive(Clone, Debug, PartialEq)]
pub enum Condition {
    /// An expression.
    Expr(ExprId),
    /// `bool b = …`, a declaration without `;`.
    Declaration(Declaration),
}
