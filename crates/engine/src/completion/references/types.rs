//! Types by the names that stand in the text: one that points to a buffer is none of the language without its extension, so
//! that nothing else knows what has it.

use std::collections::HashMap;

use syntax::Shader;
use syntax::ast::{
    BinaryOp, Callee, Condition, Declaration, ExprId, ExprKind, ItemKind, Qualifiers, StmtKind, TypeKind, TypeSpecifier,
};
use syntax::walk;

/// The name of a type, and how many indices lead from a value to one of it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Named<'s> {
    pub name: &'s str,
    pub depth: usize,
}

/// What is declared with named types.
pub(super) struct Types<'s> {
    shader: &'s Shader,
    /// Blocks whose names are types of references, with their places among the items.
    pub references: HashMap<&'s str, usize>,
    /// Every type that is written, with the qualifiers in front of it.
    pub written: Vec<(&'s TypeSpecifier, &'s Qualifiers)>,
    /// Variables, by the place of their declaration.
    variables: HashMap<usize, Named<'s>>,
    /// Members, by the structure or block and their name.
    members: HashMap<(&'s str, &'s str), Named<'s>>,
    /// Blocks without a name of their own, by the place of each member.
    pub loose: HashMap<usize, &'s str>,
    /// What functions return; empty for one of which two return different types.
    returned: HashMap<&'s str, &'s str>,
}

fn named(ty: &TypeSpecifier, more: usize) -> Option<Named<'_>> {
    match &ty.kind {
        TypeKind::Named(name) => Some(Named { name, depth: ty.dims.len() + more }),
        TypeKind::Struct(structure) => {
            structure.name.as_ref().map(|name| Named { name: &name.name, depth: ty.dims.len() + more })
        }
    }
}

impl<'s> Types<'s> {
    /// The types of a text; none where it declares no reference.
    pub fn of(shader: &'s Shader) -> Option<Self> {
        let items = &shader.unit().items;
        let references: HashMap<&str, usize> = items
            .iter()
            .enumerate()
            .filter_map(|(at, item)| match &item.kind {
                ItemKind::Block(block) => {
                    block.qualifiers.layout_entry("buffer_reference").map(|_| (block.name.name.as_str(), at))
                }
                _ => None,
            })
            .collect();
        if references.is_empty() {
            return None;
        }
        let mut types = Self {
            shader,
            references,
            written: Vec::new(),
            variables: HashMap::new(),
            members: HashMap::new(),
            loose: HashMap::new(),
            returned: HashMap::new(),
        };
        for item in items {
            match &item.kind {
                ItemKind::Declaration(declaration) => types.declaration(declaration, None),
                ItemKind::Block(block) => {
                    let name = block.name.name.as_str();
                    for member in &block.members {
                        types.declaration(member, Some(name));
                        if block.instance.is_none() {
                            types.loose.extend(member.declarators.iter().map(|d| (d.name.span.start, name)));
                        }
                    }
                    if let Some(instance) = &block.instance {
                        types.variables.insert(instance.span.start, Named { name, depth: block.dims.len() });
                    }
                }
                ItemKind::Function(function) => {
                    types.written.push((&function.return_type, &function.qualifiers));
                    if let Some(Named { name, depth: 0 }) = named(&function.return_type, 0) {
                        let known = types.returned.entry(&function.name.name).or_insert(name);
                        if *known != name {
                            *known = "";
                        }
                    }
                    for param in &function.params {
                        types.written.push((&param.ty, &param.qualifiers));
                        if let (Some(name), Some(of)) = (&param.name, named(&param.ty, param.dims.len())) {
                            types.variables.insert(name.span.start, of);
                        }
                    }
                }
                ItemKind::Qualified(_) | ItemKind::Precision(_) | ItemKind::Empty | ItemKind::Error => {}
            }
        }
        let mut local = Vec::new();
        walk::statements(shader, |stmt| match &stmt.kind {
            StmtKind::Declaration(declaration)
            | StmtKind::For { condition: Some(Condition::Declaration(declaration)), .. }
            | StmtKind::While { condition: Condition::Declaration(declaration), .. } => local.push(declaration),
            _ => {}
        });
        local.into_iter().for_each(|declaration| types.declaration(declaration, None));
        Some(types)
    }

    /// Notes what a declaration declares, as members of `owner` where there is one.
    fn declaration(&mut self, declaration: &'s Declaration, owner: Option<&'s str>) {
        self.written.push((&declaration.ty, &declaration.qualifiers));
        if let TypeKind::Struct(structure) = &declaration.ty.kind {
            let name = structure.name.as_ref().map(|name| name.name.as_str());
            structure.members.iter().for_each(|member| self.declaration(member, Some(name.unwrap_or(""))));
        }
        for declarator in &declaration.declarators {
            let Some(of) = named(&declaration.ty, declarator.dims.len()) else { continue };
            match owner {
                Some(owner) => {
                    self.members.insert((owner, &declarator.name.name), of);
                    // A block without a name of its own has its members as variables.
                    self.variables.insert(declarator.name.span.start, of);
                }
                None => {
                    self.variables.insert(declarator.name.span.start, of);
                }
            }
        }
    }

    /// The type of an expression, where it has a name that is written in the text.
    pub fn type_of(&self, id: ExprId) -> Option<Named<'s>> {
        let shader = self.shader;
        match &shader.expr(id).kind {
            ExprKind::Name(_) => self.variables.get(&self.declared(id)?).copied(),
            ExprKind::Paren(inner) => self.type_of(*inner),
            ExprKind::Index { base, .. } => {
                let of = self.type_of(*base)?;
                match of.depth {
                    // The element behind a reference (GL_EXT_buffer_reference2).
                    0 => Some(of).filter(|of| self.references.contains_key(of.name)),
                    depth => Some(Named { depth: depth - 1, ..of }),
                }
            }
            ExprKind::Field { base, field } => {
                let owner = self.type_of(*base).filter(|of| of.depth == 0)?;
                self.members.get(&(owner.name, field.name.as_str())).copied()
            }
            ExprKind::Call { callee: Callee::Name(name), .. } => {
                let known = self.references.get_key_value(name.name.as_str()).map(|(name, _)| *name);
                let of = known.or_else(|| self.returned.get(name.name.as_str()).copied()).filter(|of| !of.is_empty());
                of.map(|name| Named { name, depth: 0 })
            }
            ExprKind::Binary { op: BinaryOp::Add | BinaryOp::Sub, left, .. } => self.reference(*left),
            ExprKind::Ternary { yes, .. } => self.reference(*yes),
            _ => None,
        }
    }

    /// The same for a reference.
    pub fn reference(&self, id: ExprId) -> Option<Named<'s>> {
        self.type_of(id).filter(|of| of.depth == 0 && self.references.contains_key(of.name))
    }

    /// The place where the variable is declared that an expression names.
    pub fn declared(&self, id: ExprId) -> Option<usize> {
        self.shader.symbol(self.shader.symbol_of(id)?).span.map(|span| span.start)
    }
}
