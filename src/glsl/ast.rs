//! Syntax tree of a shader: items, declarations, statements and expressions, all with byte spans
//! of the original text (GLSL 4.60 specification, chapter 9 "Shading Language Grammar").
//!
//! Expressions lie in an [`Arena`] and are named by [`ExprId`]; operands always come before the
//! expression that uses them. A span of something that a macro produced is the span of the
//! macro's invocation.

use crate::text::Span;

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
    /// Adds an expression; its operands must have been added before.
    pub(crate) fn add(&mut self, expr: Expr) -> ExprId {
        let depth = expr.children().iter().map(|c| self.depths[c.index()] + 1).max().unwrap_or(0);
        self.exprs.push(expr);
        self.depths.push(depth);
        // A text of 4 GiB would be needed to get past u32.
        ExprId(u32::try_from(self.exprs.len() - 1).unwrap_or(u32::MAX))
    }

    /// Levels of operands below an expression.
    pub(crate) fn depth(&self, id: ExprId) -> u32 {
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
        /// The value.
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

/// The qualifiers before a type, in the order of the text.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Qualifiers {
    /// Each with its place.
    pub list: Vec<Qualifier>,
}

/// A qualifier with its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Qualifier {
    /// Which one.
    pub kind: QualifierKind,
    /// Its place; for `layout(…)` up to the closing parenthesis.
    pub span: Span,
}

/// Qualifiers.
#[derive(Clone, Debug, PartialEq)]
pub enum QualifierKind {
    /// `layout(key = value, …)`.
    Layout(Vec<LayoutEntry>),
    /// Where the variable lives.
    Storage(StorageQualifier),
    /// `centroid`, `sample`, `patch`.
    Auxiliary(AuxiliaryQualifier),
    /// `smooth`, `flat`, `noperspective`.
    Interpolation(Interpolation),
    /// `lowp`, `mediump`, `highp`.
    Precision(Precision),
    /// `invariant`.
    Invariant,
    /// `precise`.
    Precise,
    /// `coherent`, `volatile`, `restrict`, `readonly`, `writeonly`.
    Memory(MemoryQualifier),
    /// `subroutine` or `subroutine(types)`.
    Subroutine(Vec<Ident>),
}

/// One entry of a `layout(…)`.
#[derive(Clone, Debug, PartialEq)]
pub struct LayoutEntry {
    /// The key, such as `location` or `triangles`.
    pub key: Ident,
    /// The value behind `=`.
    pub value: Option<ExprId>,
    /// Key and value together.
    pub span: Span,
}

/// Storage qualifiers as written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum StorageQualifier {
    /// `const`
    Const,
    /// `in`
    In,
    /// `out`
    Out,
    /// `inout`
    InOut,
    /// `attribute` (vertex input before 1.30)
    Attribute,
    /// `varying` (vertex output, fragment input before 1.30)
    Varying,
    /// `uniform`
    Uniform,
    /// `buffer`
    Buffer,
    /// `shared`
    Shared,
}

impl StorageQualifier {
    /// The spelling.
    pub fn text(self) -> &'static str {
        match self {
            Self::Const => "const",
            Self::In => "in",
            Self::Out => "out",
            Self::InOut => "inout",
            Self::Attribute => "attribute",
            Self::Varying => "varying",
            Self::Uniform => "uniform",
            Self::Buffer => "buffer",
            Self::Shared => "shared",
        }
    }
}

/// Auxiliary storage qualifiers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum AuxiliaryQualifier {
    /// `centroid`
    Centroid,
    /// `sample`
    Sample,
    /// `patch`
    Patch,
}

/// Interpolation qualifiers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Interpolation {
    /// `smooth`
    Smooth,
    /// `flat`
    Flat,
    /// `noperspective`
    NoPerspective,
}

/// Precision qualifiers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Precision {
    /// `lowp`
    Low,
    /// `mediump`
    Medium,
    /// `highp`
    High,
}

/// Memory qualifiers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MemoryQualifier {
    /// `coherent`
    Coherent,
    /// `volatile`
    Volatile,
    /// `restrict`
    Restrict,
    /// `readonly`
    ReadOnly,
    /// `writeonly`
    WriteOnly,
}

impl Qualifiers {
    /// From the first to the last qualifier; none when there is no qualifier.
    pub fn span(&self) -> Option<Span> {
        Some(self.list.first()?.span.to(self.list.last()?.span))
    }

    /// The storage qualifier that decides, with its place: the last one that is not `const`, or
    /// `const`.
    pub fn storage(&self) -> Option<(StorageQualifier, Span)> {
        let mut all = self.list.iter().filter_map(|q| match q.kind {
            QualifierKind::Storage(s) => Some((s, q.span)),
            _ => None,
        });
        let first = all.next()?;
        Some(all.chain([first]).find(|(s, _)| *s != StorageQualifier::Const).unwrap_or(first))
    }

    /// True when `const` is among them.
    pub fn is_const(&self) -> bool {
        self.list.iter().any(|q| q.kind == QualifierKind::Storage(StorageQualifier::Const))
    }

    /// The interpolation qualifier with its place.
    pub fn interpolation(&self) -> Option<(Interpolation, Span)> {
        self.list.iter().find_map(|q| match q.kind {
            QualifierKind::Interpolation(i) => Some((i, q.span)),
            _ => None,
        })
    }

    /// The precision qualifier with its place.
    pub fn precision(&self) -> Option<(Precision, Span)> {
        self.list.iter().find_map(|q| match q.kind {
            QualifierKind::Precision(p) => Some((p, q.span)),
            _ => None,
        })
    }

    /// Place of `invariant`.
    pub fn invariant(&self) -> Option<Span> {
        self.list.iter().find(|q| q.kind == QualifierKind::Invariant).map(|q| q.span)
    }

    /// All `layout(…)` qualifiers: entries and the place of the whole qualifier.
    pub fn layouts(&self) -> impl Iterator<Item = (&[LayoutEntry], Span)> {
        self.list.iter().filter_map(|q| match &q.kind {
            QualifierKind::Layout(entries) => Some((entries.as_slice(), q.span)),
            _ => None,
        })
    }

    /// The last layout entry with that key.
    pub fn layout_entry(&self, key: &str) -> Option<&LayoutEntry> {
        self.layouts().flat_map(|(entries, _)| entries).filter(|e| e.key.name == key).last()
    }
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
    /// The value.
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
#[derive(Clone, Debug, PartialEq)]
pub enum Condition {
    /// An expression.
    Expr(ExprId),
    /// `bool b = …`, a declaration without `;`.
    Declaration(Declaration),
}
