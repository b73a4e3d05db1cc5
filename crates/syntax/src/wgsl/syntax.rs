//! What WGSL writes that GLSL's tree has no place for: attributes, types with arguments, and kinds of declarations.

use super::super::ast::{ExprId, Ident};
use base::text::Span;

/// `@name(arguments)`.
#[derive(Clone, Debug, PartialEq)]
pub struct Attribute {
    /// The name behind `@`.
    pub name: Ident,
    /// The arguments.
    pub args: Vec<ExprId>,
    /// From `@` to the last token.
    pub span: Span,
}

/// A type as written: `vec3<f32>`, `array<Light, 4>`, `Camera`.
#[derive(Clone, Debug, PartialEq)]
pub struct TypeSyntax {
    /// The name before `<`.
    pub name: Ident,
    /// What stands between `<` and `>`.
    pub args: Vec<TypeArg>,
    /// With the arguments.
    pub span: Span,
}

/// An argument of a type: a type where it reads like one, and an expression.
#[derive(Clone, Debug, PartialEq)]
pub struct TypeArg {
    /// The argument as a type.
    pub ty: Option<TypeSyntax>,
    /// The argument as an expression.
    pub expr: Option<ExprId>,
}

/// How a name is declared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DeclarationKind {
    /// `var`
    Var,
    /// `let`
    Let,
    /// `const`
    Const,
    /// `override`
    Override,
}

/// A variable, at module scope or in a function.
#[derive(Clone, Debug, PartialEq)]
pub struct VariableSyntax {
    /// How it is declared.
    pub kind: DeclarationKind,
    /// The words in `var<…>`: address space, access mode.
    pub space: Vec<Ident>,
    /// Attributes before it.
    pub attributes: Vec<Attribute>,
    /// Its name.
    pub name: Ident,
    /// Its type, where it is written.
    pub ty: Option<TypeSyntax>,
    /// Its initialiser.
    pub value: Option<ExprId>,
    /// The whole declaration, with the `;`.
    pub span: Span,
}

/// A member of a structure, or a parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct MemberSyntax {
    /// Attributes before it.
    pub attributes: Vec<Attribute>,
    /// Its name.
    pub name: Ident,
    /// Its type.
    pub ty: TypeSyntax,
}

/// A declaration at module scope.
#[derive(Clone, Debug, PartialEq)]
pub enum ModuleItem {
    /// `struct`
    Struct {
        /// The name.
        name: Ident,
        /// The members in order.
        members: Vec<MemberSyntax>,
    },
    /// `alias name = type;`
    Alias {
        /// The name.
        name: Ident,
        /// What it stands for.
        ty: TypeSyntax,
    },
    /// `var`, `const` or `override`.
    Variable(VariableSyntax),
    /// `fn`
    Function {
        /// Attributes before it.
        attributes: Vec<Attribute>,
        /// The name.
        name: Ident,
        /// The parameters.
        params: Vec<MemberSyntax>,
        /// Attributes and type of what it returns.
        returns: Option<(Vec<Attribute>, TypeSyntax)>,
        /// Index of the item with the body.
        item: usize,
    },
}

impl ModuleItem {
    /// Its attributes, and those of its members, parameters and result.
    pub fn attributes(&self) -> impl Iterator<Item = &Attribute> {
        let (own, members, result): (&[Attribute], &[MemberSyntax], &[Attribute]) = match self {
            Self::Struct { name: _, members } => (&[], members, &[]),
            Self::Alias { .. } => (&[], &[], &[]),
            Self::Variable(variable) => (&variable.attributes, &[], &[]),
            Self::Function { attributes, params, returns, .. } => {
                (attributes, params, returns.as_ref().map_or(&[], |(a, _)| a.as_slice()))
            }
        };
        own.iter().chain(members.iter().flat_map(|m| &m.attributes)).chain(result)
    }
}
