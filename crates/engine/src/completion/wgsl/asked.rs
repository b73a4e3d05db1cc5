//! What a name that nothing declares may be, by its uses.

mod uses;

use std::collections::HashMap;

use syntax::Shader;
use syntax::ast::{BinaryOp, Callee, Condition, ExprId, ExprKind, ItemKind, Literal, Stmt, StmtKind, UnaryOp};
use syntax::types::{ScalarType, Type};
use syntax::wgsl::{ModuleItem, TypeSyntax, is_address, spelling};

use super::super::declared::{Form, Gives, MADE, Param, Shape};
use super::super::search::is_swizzle;
use super::gives;

/// Types of numbers, the plainest first.
const NUMBERS: [&str; 16] = [
    "f32", "vec3f", "vec4f", "vec2f", "u32", "i32", "bool", "mat4x4f", "mat3x3f", "vec2u", "vec3u", "vec4u", "vec2i",
    "vec3i", "vec4i", "mat2x2f",
];

/// Elements of an array of which nobody states the size.
const ELEMENTS: u32 = 16;

/// Expressions around another, and variables that stand for one, that are looked at.
const DEEPEST: u32 = 12;

/// What stands around an expression that is a part of no other.
enum Around {
    Truth,
    Whole,
    /// A value of this type.
    Typed(String),
    /// The value of the variable that is named at this place.
    Variable(usize),
    /// A value that has to be known before anything runs.
    Constant,
    /// The value of a variable of the module, which has to be known as well: its type, or where it is named.
    Module(Option<String>, usize),
}

/// A text, and what stands around its expressions.
pub(super) struct Asked<'s> {
    shader: &'s Shader,
    parents: HashMap<ExprId, ExprId>,
    around: HashMap<ExprId, Around>,
}

impl<'s> Asked<'s> {
    pub(super) fn new(shader: &'s Shader) -> Self {
        let mut parents = HashMap::new();
        for (id, expr) in shader.arena().iter() {
            for child in expr.children() {
                parents.insert(child, id);
            }
        }
        let mut own = Self { shader, parents, around: HashMap::new() };
        own.items();
        own
    }

    fn items(&mut self) {
        let Some(module) = self.shader.wgsl() else { return };
        for item in &module.items {
            for argument in item.attributes().flat_map(|attribute| &attribute.args) {
                self.around.insert(*argument, Around::Constant);
            }
            let ModuleItem::Variable(variable) = item else { continue };
            self.sizes(variable.ty.as_ref());
            if let Some(value) = variable.value {
                let ty = variable.ty.as_ref().map(|ty| self.written(ty));
                self.around.insert(value, Around::Module(ty, variable.name.span.start));
            }
        }
        for local in module.locals.values() {
            self.sizes(local.ty.as_ref());
            if let (Some(value), Some(ty)) = (local.value, &local.ty) {
                self.around.insert(value, Around::Typed(self.written(ty)));
            }
        }
        for item in &module.items {
            match item {
                ModuleItem::Struct { members, .. } => members.iter().for_each(|member| self.sizes(Some(&member.ty))),
                ModuleItem::Alias { ty, .. } => self.sizes(Some(ty)),
                ModuleItem::Variable(_) | ModuleItem::Function { .. } => {}
            }
        }
        self.statements();
    }

    /// Sizes of arrays are known before anything runs.
    fn sizes(&mut self, ty: Option<&TypeSyntax>) {
        for arg in ty.into_iter().flat_map(|ty| &ty.args) {
            if let Some(size) = arg.expr {
                self.around.insert(size, Around::Constant);
            }
            self.sizes(arg.ty.as_ref());
        }
    }

    fn written(&self, ty: &TypeSyntax) -> String {
        let text = self.shader.file().slice(ty.span);
        // The short names are those of `spelling`.
        let short = |letter: &str| format!("{}{letter}", &text[..text.find('<').unwrap_or(text.len())]);
        match text.split_once('<').map(|(_, rest)| rest.trim_end_matches('>').trim()) {
            Some("f32") if text.starts_with("vec") || text.starts_with("mat") => short("f"),
            Some("u32") if text.starts_with("vec") => short("u"),
            Some("i32") if text.starts_with("vec") => short("i"),
            _ => text.to_owned(),
        }
    }

    fn statements(&mut self) {
        let shader = self.shader;
        for item in &shader.unit().items {
            let ItemKind::Function(function) = &item.kind else { continue };
            let info = shader.functions().find(|(_, info)| info.name.span == function.name.span);
            let returns = info.map(|(_, info)| spelling(&info.return_type)).unwrap_or_default();
            let mut open: Vec<&Stmt> = function.body.iter().flat_map(|body| &body.statements).collect();
            while let Some(stmt) = open.pop() {
                let mut put = |id: ExprId, around: Around| {
                    self.around.entry(id).or_insert(around);
                };
                match &stmt.kind {
                    StmtKind::Declaration(declaration) => {
                        for own in &declaration.declarators {
                            if let Some(value) = &own.initializer {
                                put(value.value, Around::Variable(own.name.span.start));
                            }
                        }
                    }
                    StmtKind::Return(Some(value)) => put(*value, Around::Typed(returns.clone())),
                    StmtKind::If { condition, then, otherwise } => {
                        put(*condition, Around::Truth);
                        open.push(then);
                        open.extend(otherwise.as_deref());
                    }
                    StmtKind::For { init, condition, body, .. } => {
                        if let Some(Condition::Expr(condition)) = condition {
                            put(*condition, Around::Truth);
                        }
                        open.extend([init.as_ref(), body.as_ref()]);
                    }
                    StmtKind::While { condition, body } => {
                        if let Condition::Expr(condition) = condition {
                            put(*condition, Around::Truth);
                        }
                        open.push(body);
                    }
                    StmtKind::DoWhile { body, condition } => {
                        put(*condition, Around::Truth);
                        open.push(body);
                    }
                    StmtKind::Switch { selector, body } => {
                        put(*selector, Around::Whole);
                        open.extend(&body.statements);
                    }
                    StmtKind::Case(value) => put(*value, Around::Constant),
                    StmtKind::Block(block) => open.extend(&block.statements),
                    _ => {}
                }
            }
        }
    }

    fn known(&self, id: ExprId) -> Option<String> {
        let ty = self.shader.type_of(id);
        let is_open = matches!(ty, Type::Error | Type::Void | Type::Opaque(_)) || self.is_number(id);
        (!is_open).then(|| spelling(ty))
    }

    /// True for a number without a suffix, which is of any type.
    fn is_number(&self, id: ExprId) -> bool {
        match &self.shader.expr(id).kind {
            ExprKind::Literal(Literal::Bool(_)) => false,
            ExprKind::Literal(_) => {
                let text = self.shader.text_of(id);
                text.starts_with("0x") || !text.ends_with(['u', 'i', 'f', 'h'])
            }
            ExprKind::Paren(inner) => self.is_number(*inner),
            ExprKind::Unary { operand, .. } => self.is_number(*operand),
            _ => false,
        }
    }

    /// Types that the place of an expression asks for, the likeliest first.
    fn expected(&self, id: ExprId, depth: u32) -> Vec<String> {
        if depth > DEEPEST {
            return Vec::new();
        }
        let Some(&parent) = self.parents.get(&id) else { return self.by_statement(id, depth) };
        let above = || self.expected(parent, depth + 1);
        let many = |all: &[&str]| all.iter().map(|ty| (*ty).to_owned()).collect::<Vec<_>>();
        match &self.shader.expr(parent).kind {
            ExprKind::Paren(_) => above(),
            ExprKind::Index { base, .. } if *base != id => many(&["u32", "i32"]),
            ExprKind::Field { field, .. } => swizzled(&field.name, &above()),
            ExprKind::Unary { op: UnaryOp::Not, .. } => many(&["bool"]),
            ExprKind::Unary { .. } => above(),
            ExprKind::Assign { target, value, .. } => {
                let other = if *target == id { *value } else { *target };
                self.known(other).into_iter().collect()
            }
            ExprKind::Binary { op, left, right, .. } => {
                let other = if *left == id { *right } else { *left };
                self.beside((*op, *left == id), other, &above)
            }
            ExprKind::Call { callee, args } => self.argument(callee, args, id, parent, depth),
            _ => Vec::new(),
        }
    }

    /// Types of one operand, by the other.
    fn beside(&self, (op, left): (BinaryOp, bool), other: ExprId, above: &dyn Fn() -> Vec<String>) -> Vec<String> {
        use BinaryOp::{And, Div, Equal, Greater, GreaterEqual, Less, LessEqual, Mul, NotEqual, Or, Shl, Shr};
        if matches!(op, And | Or) {
            return vec!["bool".to_owned()];
        }
        if matches!(op, Shl | Shr) {
            return if left { above() } else { vec!["u32".to_owned()] };
        }
        let known = self.known(other);
        if matches!(op, Equal | NotEqual | Less | LessEqual | Greater | GreaterEqual) {
            let whole = self.is_number(other) && !self.shader.text_of(other).contains('.');
            let number = || if whole { vec!["u32".to_owned(), "i32".to_owned()] } else { vec!["f32".to_owned()] };
            return known.map_or_else(number, |ty| vec![ty]);
        }
        let mut all = above();
        match known {
            // A matrix has a vector, or another one, beside it.
            Some(ty) if ty.starts_with("mat") => {
                let mut chars = ty[3..4].chars();
                let size = chars.next().unwrap_or('4');
                all.push(format!("vec{size}f"));
                all.push(ty);
            }
            // A number scales a vector.
            Some(ty) if ty.starts_with("vec") && matches!(op, Mul | Div) => {
                all.insert(0, ty);
                all.push("f32".to_owned());
            }
            Some(ty) if ty == "f32" && matches!(op, Mul | Div) => all.push(ty),
            Some(ty) => all.insert(0, ty),
            None if all.is_empty() && self.is_number(other) => {
                all.push(if self.shader.text_of(other).contains('.') { "f32" } else { "u32" }.to_owned());
            }
            None => {}
        }
        all
    }

    fn argument(&self, callee: &Callee, args: &[ExprId], id: ExprId, call: ExprId, depth: u32) -> Vec<String> {
        let at = args.iter().position(|arg| *arg == id).unwrap_or(0);
        let Callee::Name(name) = callee else { return self.part(call, args, at) };
        if let Some(info) = self.shader.function(&name.name) {
            return info
                .params
                .get(at)
                .map(|param| spelling(&param.ty))
                .filter(|ty| ty != "error")
                .into_iter()
                .collect();
        }
        let one = |ty: &str| vec![ty.to_owned()];
        match (name.name.as_str(), at) {
            ("normalize" | "reflect" | "cross" | "faceForward", _) => one("vec3f"),
            ("length" | "distance" | "dot", _) => {
                let other = args.iter().find_map(|arg| self.known(*arg).filter(|_| *arg != id));
                other.map_or_else(|| one("vec3f"), |ty| vec![ty])
            }
            ("select", 2) | ("any" | "all", _) => one("bool"),
            ("mix" | "smoothstep", 2) | ("refract" | "ldexp", _) => one("f32"),
            ("transpose" | "determinant", _) => one("mat4x4f"),
            (name, _) if syntax::wgsl::is_builtin(name) => {
                let other = args.iter().find_map(|arg| self.known(*arg).filter(|_| *arg != id));
                let mut all: Vec<String> = other.into_iter().collect();
                all.extend(self.expected(call, depth + 1));
                all
            }
            (name, _) if Type::from_name(name).is_some() || name.starts_with("vec") || name.starts_with("mat") => {
                self.part(call, args, at)
            }
            _ => Vec::new(),
        }
    }

    /// Types of an argument of a constructor: what the others leave.
    fn part(&self, call: ExprId, args: &[ExprId], at: usize) -> Vec<String> {
        let ty = self.shader.type_of(call);
        let Some(scalar) = ty.scalar() else { return Vec::new() };
        let of = |count: u8| match count {
            1 => spelling(&Type::Scalar(scalar)),
            _ => spelling(&Type::Vector(scalar, count)),
        };
        match *ty {
            Type::Vector(_, count) if args.len() > 1 => {
                let size = |id: &ExprId| match self.shader.type_of(*id) {
                    Type::Vector(_, count) => *count,
                    _ => 1,
                };
                let others: u8 = args.iter().enumerate().filter(|(k, _)| *k != at).map(|(_, arg)| size(arg)).sum();
                vec![of(count.saturating_sub(others).max(1))]
            }
            Type::Vector(_, count) => vec![of(1), of(count)],
            Type::Scalar(ScalarType::Float) => vec!["u32".to_owned(), "f32".to_owned(), "i32".to_owned()],
            Type::Scalar(_) => vec!["f32".to_owned(), "u32".to_owned(), "i32".to_owned()],
            Type::Matrix(_, _, rows) => vec![of(rows)],
            _ => Vec::new(),
        }
    }

    fn by_statement(&self, id: ExprId, depth: u32) -> Vec<String> {
        let one = |ty: &str| vec![ty.to_owned()];
        match self.around.get(&id) {
            Some(Around::Truth) => one("bool"),
            Some(Around::Whole) => vec!["u32".to_owned(), "i32".to_owned()],
            Some(Around::Constant) => one("u32"),
            Some(Around::Typed(ty) | Around::Module(Some(ty), _)) => one(ty),
            Some(Around::Variable(place) | Around::Module(None, place)) => {
                self.of_uses(self.of_variable(*place), depth + 1)
            }
            None => Vec::new(),
        }
    }

    /// Types that uses of a name ask for: a structure of the text, or one that is made for it, where members are asked for.
    fn types(&self, name: &str, uses: &[ExprId]) -> Vec<String> {
        let (members, _) = self.parts(uses);
        let mut types = self.of_uses(uses.to_vec(), 0);
        if !members.is_empty() {
            let fitting = self.structures(&members);
            types.retain(|ty| fitting.contains(ty));
            if types.is_empty() {
                types.push(format!("{}{MADE}", name.trim_end_matches('_')));
            }
            types.extend(fitting);
        }
        if members.is_empty() {
            types.extend(NUMBERS.iter().map(|ty| (*ty).to_owned()));
            types.extend(self.structures(&[]));
        }
        let mut seen = std::collections::HashSet::new();
        types.retain(|ty| !ty.contains("error") && seen.insert(ty.clone()));
        types
    }

    /// What a variable may be.
    pub(super) fn variable(&self, name: &str) -> Vec<Form> {
        let uses = self.uses(name);
        let handles = self.handles(&uses);
        if !handles.is_empty() {
            return handles.iter().map(|ty| Form::Variable("handle", Shape::one(*ty))).collect();
        }
        let constant = uses.iter().any(|id| {
            let root = std::iter::successors(Some(*id), |id| self.parents.get(id).copied()).last();
            root.is_some_and(|root| matches!(self.around.get(&root), Some(Around::Constant | Around::Module(..))))
        });
        if constant || uses.is_empty() {
            let mut types = self.of_uses(uses, 0);
            types.retain(|ty| NUMBERS.contains(&ty.as_str()) && !ty.starts_with("mat"));
            types.extend(["u32", "i32", "f32", "vec2f", "vec3f", "vec4f"].map(str::to_owned));
            return types.into_iter().map(|ty| Form::Variable("const", Shape::one(ty))).collect();
        }
        let (_, indexed) = self.parts(&uses);
        let written = uses.iter().any(|id| self.is_written(*id));
        let mut forms = Vec::new();
        if indexed {
            let elements: Vec<ExprId> = uses.iter().filter_map(|id| self.parents.get(id).copied()).collect();
            for ty in self.types(name, &elements) {
                let space = match (written, ty.as_str()) {
                    (true, _) => "private",
                    // Elements of uniform arrays are 16 bytes apart: numbers are those of a vector.
                    (false, "f32" | "u32" | "i32") => {
                        forms.push(Form::Variable("uniform", Shape::one(format!("vec4{}", &ty[..1]))));
                        continue;
                    }
                    (false, _) => "uniform",
                };
                forms.push(Form::Variable(space, Shape { ty, count: Some(ELEMENTS) }));
            }
        }
        for ty in self.types(name, &uses) {
            let space = match (written, ty.as_str()) {
                (true, _) => "private",
                (false, "bool") => "override",
                (false, _) => "uniform",
            };
            forms.push(Form::Variable(space, Shape::one(ty)));
        }
        forms
    }

    fn is_written(&self, mut id: ExprId) -> bool {
        while let Some(parent) = self.parents.get(&id) {
            match &self.shader.expr(*parent).kind {
                ExprKind::Assign { target, .. } => return *target == id,
                ExprKind::Index { base, .. } | ExprKind::Field { base, .. } if *base == id => id = *parent,
                ExprKind::Paren(_) => id = *parent,
                _ => return false,
            }
        }
        false
    }

    /// Textures and samplers, by the functions that take them.
    fn handles(&self, uses: &[ExprId]) -> Vec<&'static str> {
        for id in uses {
            let Some(parent) = self.parents.get(id) else { continue };
            let ExprKind::Call { callee: Callee::Name(name), args } = &self.shader.expr(*parent).kind else { continue };
            let compared = name.name.contains("Compare");
            match (name.name.as_str(), args.iter().position(|arg| arg == id)) {
                (name, Some(1)) if name.starts_with("textureSample") || name.starts_with("textureGather") => {
                    return vec![if compared { "sampler_comparison" } else { "sampler" }];
                }
                ("textureStore", Some(0)) => {
                    return vec!["texture_storage_2d<rgba8unorm, write>", "texture_storage_3d<rgba16float, write>"];
                }
                (name, Some(0)) if name.starts_with("texture") && compared => {
                    return vec!["texture_depth_2d", "texture_depth_2d_array", "texture_depth_cube"];
                }
                (name, Some(0)) if name.starts_with("texture") => {
                    return vec![
                        "texture_2d<f32>",
                        "texture_2d_array<f32>",
                        "texture_cube<f32>",
                        "texture_3d<f32>",
                        "texture_depth_2d",
                        "texture_2d<u32>",
                        "texture_multisampled_2d<f32>",
                    ];
                }
                _ => {}
            }
        }
        Vec::new()
    }

    /// What a member of an assumed structure may be.
    pub(super) fn member(&self, structure: &str, member: &str) -> Vec<Shape> {
        let is = |id: &ExprId| match &self.shader.expr(*id).kind {
            ExprKind::Field { base, field } => {
                field.name == member && matches!(self.shader.type_of(*base), Type::Struct(own) if own.name == structure)
            }
            _ => false,
        };
        let uses: Vec<ExprId> = self.shader.arena().iter().map(|(id, _)| id).filter(is).collect();
        let uses = self.through(uses);
        let (members, indexed) = self.parts(&uses);
        let elements: Vec<ExprId> = uses.iter().filter_map(|id| self.parents.get(id).copied()).collect();
        let called = format!("{}_{member}", structure.trim_end_matches(MADE));
        let mut types = self.types(&called, if indexed { &elements } else { &uses });
        let components = self.are_components(&uses);
        // What is named so has that type where nothing else is known.
        if members.is_empty() && self.of_uses(uses, 0).is_empty() {
            let usual = match member {
                "position" | "clip_position" | "world_position" | "color" | "colour" => Some("vec4f"),
                "world_normal" | "normal" => Some("vec3f"),
                "uv" => Some("vec2f"),
                "instance_index" | "vertex_index" => Some("u32"),
                _ => None,
            };
            types.splice(0..0, usual.map(str::to_owned));
        }
        let one = |count: Option<u32>| types.iter().map(move |ty| Shape { ty: ty.clone(), count });
        if !indexed {
            return one(None).collect();
        }
        // `viewport[2]` is a component: an array in a uniform has no numbers beside each other.
        let vector = match types.first().map(String::as_str) {
            Some(number @ ("f32" | "u32" | "i32")) if components => Some(Shape::one(format!("vec4{}", &number[..1]))),
            _ => None,
        };
        vector.into_iter().chain(one(Some(ELEMENTS))).chain(one(None)).collect()
    }

    /// What a function may be, by its arguments and by what is done with what it gives.
    pub(super) fn function(&self, name: &str) -> Vec<Form> {
        let mut calls: Vec<(ExprId, &Vec<ExprId>)> = Vec::new();
        for (id, expr) in self.shader.arena().iter() {
            if let ExprKind::Call { callee: Callee::Name(own), args } = &expr.kind
                && own.name == name
            {
                calls.push((id, args));
            }
        }
        let Some((_, first)) = calls.first() else { return Vec::new() };
        let param = |k: usize| {
            let mut args = calls.iter().filter_map(|(_, args)| args.get(k).copied());
            let typed = args.clone().find_map(|arg| self.passed(arg)).or_else(|| {
                let ty = self.shader.type_of(args.next()?);
                (!ty.is_error()).then(|| spelling(ty))
            });
            let pointer = first.get(k).is_some_and(|arg| is_address(self.shader, *arg));
            Param { ty: typed.unwrap_or_else(|| "f32".to_owned()), out: pointer }
        };
        let params: Vec<Param> = (0..first.len()).map(param).collect();
        let ids: Vec<ExprId> = calls.iter().map(|(id, _)| *id).collect();
        let alone = |id: &ExprId| !self.parents.contains_key(id) && !self.around.contains_key(id);
        let mut types: Vec<Gives> = Vec::new();
        if ids.iter().all(alone) {
            types.push(gives("void"));
        }
        if self.of_uses(ids.clone(), 0).is_empty() && params.len() == 1 && !params[0].ty.starts_with("texture") {
            types.push(gives(&params[0].ty));
        }
        types.extend(self.types(name, &ids).iter().map(|ty| gives(ty)));
        types.push(gives("void"));
        types.into_iter().map(|gives| Form::Function(vec![params.clone()], gives)).collect()
    }

    /// The type of an argument, as its variable states it where that is a texture or a sampler.
    fn passed(&self, arg: ExprId) -> Option<String> {
        if let Type::Opaque(_) = self.shader.type_of(arg) {
            let symbol = self.shader.symbol_of(arg)?;
            let (variable, _) = self.shader.wgsl()?.globals().find(|(_, own)| *own == symbol)?;
            return variable.ty.as_ref().map(|ty| self.shader.file().slice(ty.span).to_owned());
        }
        self.known(arg)
    }
}

/// Types that have these components, where they are to be of one of some types.
fn swizzled(field: &str, wanted: &[String]) -> Vec<String> {
    if !is_swizzle(field) {
        return Vec::new();
    }
    let least = field.chars().filter_map(syntax::swizzle::component).max().unwrap_or(0) + 1;
    let letter = wanted.first().map_or('f', |ty| match ty.as_str() {
        "u32" => 'u',
        "i32" => 'i',
        ty => ty.chars().last().filter(|c| ty.starts_with("vec") && "uif".contains(*c)).unwrap_or('f'),
    });
    (least.max(2)..=4).map(|count| format!("vec{count}{letter}")).collect()
}
