//! Precisions of expressions and variables, as GLSL ES has them (GLSL ES 3.00, 4.5), and what is `precise`.
//!
//! A qualifier belongs to a variable, and a default to what has no qualifier of its own. An operation has the highest
//! precision of its operands; where none has one (literals), it takes that of what its value goes to.

use std::collections::HashMap;

use super::ast::{
    Block, Condition, Declaration, ExprId, ExprKind, Ident, ItemKind, Param, Precision, QualifierKind, Qualifiers,
    Stmt, StmtKind, TypeKind, TypeSpecifier,
};
use super::symbols::{CallTarget, FunctionId, SymbolId, SymbolKind};
use super::types::{OpaqueKind, ScalarType, Type};
use super::{BuiltinFunction, Profile, Shader, TokenKind, TokenPlace};

/// Precisions of all that is of `float` in a shader.
#[derive(Clone, Debug, Default)]
pub struct Precisions {
    exprs: Vec<Option<Precision>>,
    stores: HashMap<ExprId, Precision>,
    symbols: HashMap<SymbolId, Precision>,
    results: HashMap<FunctionId, Precision>,
    precise: Vec<bool>,
    precise_symbols: Vec<SymbolId>,
}

/// How far precisions are from exact, for comparing them.
fn rank(precision: Precision) -> u8 {
    match precision {
        Precision::Low => 0,
        Precision::Medium => 1,
        Precision::High => 2,
    }
}

/// True for what may have less than the digits and the range of binary32.
pub fn is_lower(precision: Precision) -> bool {
    precision != Precision::High
}

fn highest(a: Option<Precision>, b: Option<Precision>) -> Option<Precision> {
    match (a, b) {
        (Some(a), Some(b)) => Some(if rank(a) >= rank(b) { a } else { b }),
        (a, b) => a.or(b),
    }
}

impl Precisions {
    /// The precisions of a shader. Those of desktop GLSL mean nothing (GLSL 4.60, 4.7) and are left out.
    pub fn of(shader: &Shader) -> Self {
        if shader.wgsl().is_some() {
            return Self::default();
        }
        Walk::new(shader, shader.has_precisions()).done()
    }

    /// The precisions as a text states them, in desktop GLSL too: those that a device may take where the text is made
    /// into `RelaxedPrecision` of SPIR-V, or into GLSL ES.
    pub fn stated(shader: &Shader) -> Self {
        if shader.wgsl().is_some() {
            return Self::default();
        }
        Walk::new(shader, true).done()
    }

    /// The precision at which an expression is computed; none where nothing lowers it.
    pub fn of_expr(&self, id: ExprId) -> Option<Precision> {
        self.exprs.get(id.index()).copied().flatten()
    }

    /// True for an expression that may be computed with less than binary32.
    pub fn is_lowered(&self, id: ExprId) -> bool {
        matches!(self.of_expr(id), Some(Precision::Low | Precision::Medium))
    }

    /// The precision of the variable that an assignment writes.
    pub fn of_store(&self, assignment: ExprId) -> Option<Precision> {
        self.stores.get(&assignment).copied()
    }

    /// The precision of a variable.
    pub fn of_symbol(&self, symbol: SymbolId) -> Option<Precision> {
        self.symbols.get(&symbol).copied()
    }

    /// The precision of what a function returns.
    pub fn of_result(&self, function: FunctionId) -> Option<Precision> {
        self.results.get(&function).copied()
    }

    /// True for an expression whose value goes to a variable that is `precise`: no operation of it is regrouped or
    /// contracted (GLSL 4.60, 4.10).
    pub fn is_precise(&self, id: ExprId) -> bool {
        self.precise.get(id.index()).copied().unwrap_or(false)
    }

    /// True when something is lower than `highp`.
    pub fn lowers(&self) -> bool {
        let low = |p: &Precision| *p != Precision::High;
        self.exprs.iter().flatten().any(low) || self.symbols.values().any(low)
    }
}

struct Walk<'s> {
    shader: &'s Shader,
    /// Qualifiers have a meaning.
    es: bool,
    /// Defaults of `float`, of samplers by the name of their type, by scope.
    defaults: Vec<HashMap<String, Precision>>,
    by_place: HashMap<(usize, &'s str), Vec<SymbolId>>,
    /// Members of structures and blocks by the place of their name.
    members: HashMap<usize, Precision>,
    /// Initialisers with the variables that they are for.
    initial: Vec<(ExprId, SymbolId)>,
    /// Returned values with their functions.
    returned: Vec<(ExprId, FunctionId)>,
    all: Precisions,
}

impl<'s> Walk<'s> {
    fn new(shader: &'s Shader, es: bool) -> Self {
        let mut by_place: HashMap<(usize, &str), Vec<SymbolId>> = HashMap::new();
        for (id, symbol) in shader.symbols() {
            if let Some(span) = symbol.span {
                by_place.entry((span.start, symbol.name.as_str())).or_default().push(id);
            }
        }
        let count = shader.arena().len();
        Self {
            shader,
            es,
            defaults: vec![HashMap::new()],
            by_place,
            members: HashMap::new(),
            initial: Vec::new(),
            returned: Vec::new(),
            all: Precisions { exprs: vec![None; count], precise: vec![false; count], ..Precisions::default() },
        }
    }

    fn done(mut self) -> Precisions {
        self.unit();
        self.all.symbols.extend(self.built_in());
        self.expressions();
        self.all
    }

    fn declared(&self, name: &Ident) -> Vec<SymbolId> {
        self.by_place.get(&(name.span.start, name.name.as_str())).cloned().unwrap_or_default()
    }

    /// The precision of something declared with a type.
    fn precision(&self, qualifiers: &Qualifiers, ty: &Type) -> Option<Precision> {
        if !self.es {
            return None;
        }
        let mut element = ty;
        while let Type::Array(inner, _) = element {
            element = inner;
        }
        let key = match element {
            Type::Opaque(opaque) if opaque.kind == OpaqueKind::Sampler => element.to_string(),
            _ if element.scalar() == Some(ScalarType::Float) => "float".to_owned(),
            _ => return None,
        };
        if let Some((precision, _)) = qualifiers.precision() {
            return Some(precision);
        }
        let found = self.defaults.iter().rev().find_map(|scope| scope.get(&key)).copied();
        // GLSL ES 3.00, 4.5.4: a fragment stage has no default of `float`, and says so where it needs one.
        let implied = match element {
            Type::Opaque(_) => matches!(key.as_str(), "sampler2D" | "samplerCube").then_some(Precision::Low),
            _ => Some(Precision::High),
        };
        found.or(implied)
    }

    fn unit(&mut self) {
        let shader = self.shader;
        for (index, item) in shader.unit().items.iter().enumerate() {
            match &item.kind {
                ItemKind::Declaration(declaration) => self.declaration(declaration),
                ItemKind::Block(block) => {
                    let names = self.declarations_of_members(&block.members);
                    let own = names.into_iter().chain(block.instance.as_ref());
                    if block.qualifiers.list.iter().any(|q| q.kind == QualifierKind::Precise) {
                        let symbols: Vec<SymbolId> = own.flat_map(|name| self.declared(name)).collect();
                        self.all.precise_symbols.extend(symbols);
                    }
                }
                ItemKind::Precision(statement) => self.default(&statement.ty, statement.precision),
                ItemKind::Qualified(named) => self.qualified(&named.qualifiers, &named.names),
                ItemKind::Function(function) => {
                    let found =
                        shader.functions().find(|(_, f)| f.definition == Some(index) || f.prototypes.contains(&index));
                    let Some((id, info)) = found else { continue };
                    if let Some(precision) = self.precision(&function.qualifiers, &info.return_type) {
                        self.all.results.insert(id, precision);
                    }
                    self.parameters(&function.params, info);
                    if let Some(body) = &function.body {
                        self.block(body, id);
                    }
                }
                ItemKind::Empty | ItemKind::Error => {}
            }
        }
    }

    fn parameters(&mut self, params: &[Param], info: &super::symbols::FunctionInfo) {
        for (param, known) in params.iter().zip(&info.params) {
            let Some(symbol) = known.symbol else { continue };
            if let Some(precision) = self.precision(&param.qualifiers, &known.ty) {
                self.all.symbols.insert(symbol, precision);
            }
            if is_precise(&param.qualifiers) {
                self.all.precise_symbols.push(symbol);
            }
        }
    }

    fn default(&mut self, ty: &TypeSpecifier, precision: Precision) {
        if let (TypeKind::Named(name), Some(scope)) = (&ty.kind, self.defaults.last_mut()) {
            scope.insert(name.clone(), precision);
        }
    }

    /// `precise a;` for what is declared already.
    fn qualified(&mut self, qualifiers: &Qualifiers, names: &[Ident]) {
        if !is_precise(qualifiers) {
            return;
        }
        for name in names {
            let found = self.shader.symbols().filter(|(_, s)| s.name == name.name).map(|(id, _)| id);
            self.all.precise_symbols.extend(found.collect::<Vec<_>>());
        }
    }

    /// Notes the members of a structure or block; gives their names.
    fn declarations_of_members(&mut self, members: &'s [Declaration]) -> Vec<&'s Ident> {
        let mut names = Vec::new();
        for member in members {
            let ty = match &member.ty.kind {
                TypeKind::Named(name) => Type::from_name(name).unwrap_or(Type::Error),
                TypeKind::Struct(_) => Type::Error,
            };
            for declarator in &member.declarators {
                if let Some(precision) = self.precision(&member.qualifiers, &ty) {
                    self.members.insert(declarator.name.span.start, precision);
                    for symbol in self.declared(&declarator.name) {
                        self.all.symbols.insert(symbol, precision);
                    }
                }
                names.push(&declarator.name);
            }
        }
        names
    }

    fn declaration(&mut self, declaration: &'s Declaration) {
        if let TypeKind::Struct(s) = &declaration.ty.kind {
            self.declarations_of_members(&s.members);
        }
        for declarator in &declaration.declarators {
            for symbol in self.declared(&declarator.name) {
                let ty = self.shader.symbol(symbol).ty.clone();
                if let Some(precision) = self.precision(&declaration.qualifiers, &ty) {
                    self.all.symbols.insert(symbol, precision);
                }
                if is_precise(&declaration.qualifiers) {
                    self.all.precise_symbols.push(symbol);
                }
                if let Some(initializer) = &declarator.initializer {
                    self.initial.push((initializer.value, symbol));
                }
            }
        }
    }

    fn block(&mut self, block: &'s Block, function: FunctionId) {
        self.defaults.push(HashMap::new());
        block.statements.iter().for_each(|statement| self.statement(statement, function));
        self.defaults.pop();
    }

    fn statement(&mut self, statement: &'s Stmt, function: FunctionId) {
        match &statement.kind {
            StmtKind::Declaration(declaration) => self.declaration(declaration),
            StmtKind::Precision(precision) => self.default(&precision.ty, precision.precision),
            StmtKind::Qualified(named) => self.qualified(&named.qualifiers, &named.names),
            StmtKind::Block(block) | StmtKind::Switch { body: block, .. } => self.block(block, function),
            StmtKind::If { then, otherwise, .. } => {
                self.statement(then, function);
                otherwise.iter().for_each(|other| self.statement(other, function));
            }
            StmtKind::For { init, condition, body, .. } => {
                self.statement(init, function);
                if let Some(Condition::Declaration(declaration)) = condition {
                    self.declaration(declaration);
                }
                self.statement(body, function);
            }
            StmtKind::While { condition, body } => {
                if let Condition::Declaration(declaration) = condition {
                    self.declaration(declaration);
                }
                self.statement(body, function);
            }
            StmtKind::DoWhile { body, .. } => self.statement(body, function),
            StmtKind::Return(Some(value)) => self.returned.push((*value, function)),
            StmtKind::Return(None)
            | StmtKind::Empty
            | StmtKind::Expr(_)
            | StmtKind::Case(_)
            | StmtKind::Default
            | StmtKind::Break
            | StmtKind::Continue
            | StmtKind::Discard
            | StmtKind::Error => {}
        }
    }

    /// Precisions of built-in variables (GLSL ES 1.00, 7; 3.00, 7).
    fn built_in(&self) -> Vec<(SymbolId, Precision)> {
        let version = self.shader.version();
        let first = version.number == 100 || version.span.is_none();
        let of = |name: &str| match name {
            "gl_FragColor" | "gl_FragData" | "gl_PointCoord" => Precision::Medium,
            // What has `highp` in fragment stages has it for the place of the fragment too, whatever GLSL ES 1.00 says.
            "gl_FragCoord" if first && self.defaults[0].get("float") != Some(&Precision::High) => Precision::Medium,
            "gl_PointSize" if first => Precision::Medium,
            _ => Precision::High,
        };
        let floats = |ty: &Type| ty.scalar() == Some(ScalarType::Float) || matches!(ty, Type::Array(..));
        let all = self.shader.symbols().filter(|(_, s)| self.es && s.kind == SymbolKind::Builtin && floats(&s.ty));
        all.map(|(id, symbol)| (id, of(&symbol.name))).collect()
    }

    fn expressions(&mut self) {
        let shader = self.shader;
        // Operands come before their users.
        for (id, _) in shader.arena().iter() {
            self.all.exprs[id.index()] = if self.es { self.upwards(id) } else { None };
        }
        // What flows into something precise is computed so as well, in its own function (GLSL 4.60, 4.10).
        loop {
            self.downwards();
            let mut found: Vec<SymbolId> = Vec::new();
            for (id, _) in shader.arena().iter().filter(|(id, _)| self.all.precise[id.index()]) {
                let symbol = shader.symbol_of(id).filter(|&symbol| shader.symbol(symbol).kind == SymbolKind::Local);
                found.extend(symbol.filter(|symbol| !self.all.precise_symbols.contains(symbol)));
            }
            if found.is_empty() {
                break;
            }
            found.sort_unstable();
            found.dedup();
            self.all.precise_symbols.extend(found);
        }
    }

    fn known(&self, id: ExprId) -> Option<Precision> {
        self.all.exprs[id.index()]
    }

    fn upwards(&mut self, id: ExprId) -> Option<Precision> {
        let shader = self.shader;
        match &shader.expr(id).kind {
            ExprKind::Literal(_) | ExprKind::Error | ExprKind::Method { .. } => None,
            ExprKind::Name(_) => self.all.symbols.get(&shader.symbol_of(id)?).copied(),
            ExprKind::Paren(inner) => self.known(*inner),
            ExprKind::Index { base, .. } => self.known(*base),
            ExprKind::Field { base, field } => match shader.type_of(*base) {
                Type::Struct(s) => {
                    let member = s.fields.iter().find(|f| f.name == field.name)?;
                    self.members.get(&member.span.start).copied()
                }
                _ => self.known(*base),
            },
            ExprKind::Call { args, .. } => match shader.callee(id)? {
                CallTarget::Constructor(_) => self.of_all(args),
                CallTarget::User(function) => self.all.results.get(function).copied(),
                CallTarget::Builtin(call) => match call.function {
                    BuiltinFunction::UintBitsToFloat | BuiltinFunction::IntBitsToFloat => Some(Precision::High),
                    _ => match args.first() {
                        Some(first) if matches!(shader.type_of(*first), Type::Opaque(_)) => self.known(*first),
                        _ => self.of_all(args),
                    },
                },
            },
            ExprKind::Unary { operand, .. } | ExprKind::Postfix { operand, .. } => self.known(*operand),
            ExprKind::Binary { left, right, .. } => highest(self.known(*left), self.known(*right)),
            ExprKind::Assign { op, target, value, .. } => {
                let own = self.known(*target);
                if let Some(own) = own {
                    self.all.stores.insert(id, own);
                }
                if op.is_some() { highest(own, self.known(*value)) } else { own }
            }
            ExprKind::Ternary { yes, no, .. } => highest(self.known(*yes), self.known(*no)),
            ExprKind::Comma { right, .. } => self.known(*right),
            ExprKind::List(items) => self.of_all(&items.clone()),
        }
    }

    fn of_all(&self, args: &[ExprId]) -> Option<Precision> {
        args.iter().fold(None, |all, &arg| highest(all, self.known(arg)))
    }

    /// What has no precision of its own takes that of what its value goes to; what goes to something precise is so.
    fn downwards(&mut self) {
        let shader = self.shader;
        let mut wanted: Vec<(ExprId, Option<Precision>, bool)> = Vec::new();
        let is_precise = |all: &Precisions, symbol: SymbolId| all.precise_symbols.contains(&symbol);
        for &(value, symbol) in &self.initial {
            wanted.push((value, self.all.symbols.get(&symbol).copied(), is_precise(&self.all, symbol)));
        }
        for &(value, function) in &self.returned {
            wanted.push((value, self.all.results.get(&function).copied(), false));
        }
        for (value, precision, precise) in wanted {
            self.want(value, precision, precise);
        }
        let ids: Vec<ExprId> = shader.arena().iter().map(|(id, _)| id).collect();
        for &id in ids.iter().rev() {
            let (own, precise) = (self.known(id), self.all.precise[id.index()]);
            match &shader.expr(id).kind {
                ExprKind::Assign { target, value, op, .. } => {
                    let precise = precise || self.root(*target).is_some_and(|root| is_precise(&self.all, root));
                    self.all.precise[id.index()] |= precise && op.is_some();
                    self.want(*value, own, precise);
                }
                ExprKind::Call { args, .. } => match shader.callee(id) {
                    Some(CallTarget::User(function)) => {
                        let params: Vec<Option<SymbolId>> =
                            shader.function_info(*function).params.iter().map(|p| p.symbol).collect();
                        for (&arg, symbol) in args.iter().zip(params) {
                            let precision = symbol.and_then(|s| self.all.symbols.get(&s).copied());
                            self.want(arg, precision, symbol.is_some_and(|s| is_precise(&self.all, s)));
                        }
                    }
                    // The coordinates of a texture have nothing to do with the precision of its texels.
                    Some(CallTarget::Builtin(_))
                        if args.first().is_some_and(|a| matches!(shader.type_of(*a), Type::Opaque(_))) => {}
                    _ => args.clone().into_iter().for_each(|arg| self.want(arg, own, precise)),
                },
                ExprKind::Index { base, .. } => self.want(*base, own, precise),
                ExprKind::Ternary { yes, no, .. } => {
                    [*yes, *no].into_iter().for_each(|side| self.want(side, own, precise))
                }
                ExprKind::Comma { right, .. } => self.want(*right, own, precise),
                _ => shader.expr(id).children().into_iter().for_each(|child| self.want(child, own, precise)),
            }
        }
    }

    fn want(&mut self, id: ExprId, precision: Option<Precision>, precise: bool) {
        let own = &mut self.all.exprs[id.index()];
        *own = own.or(precision);
        self.all.precise[id.index()] |= precise;
    }

    /// The variable that a place belongs to.
    fn root(&self, id: ExprId) -> Option<SymbolId> {
        match &self.shader.expr(id).kind {
            ExprKind::Name(_) => self.shader.symbol_of(id),
            ExprKind::Paren(inner) => self.root(*inner),
            ExprKind::Index { base, .. } | ExprKind::Field { base, .. } => self.root(*base),
            _ => None,
        }
    }
}

fn is_precise(qualifiers: &Qualifiers) -> bool {
    qualifiers.list.iter().any(|q| q.kind == QualifierKind::Precise)
}

impl Shader {
    /// True when the qualifiers `lowp` and `mediump` of this text mean anything: in GLSL ES, and in a text that states
    /// no version and writes one, which is for browsers and phones.
    pub fn has_precisions(&self) -> bool {
        let words = ["precision", "lowp", "mediump", "highp"];
        let written = || {
            let text = self.tokens.iter().filter(|t| t.kind == TokenKind::Word && t.place == TokenPlace::Text);
            text.into_iter().any(|t| words.contains(&self.file.slice(t.span)))
        };
        let unversioned = self.version.span.is_none() && self.version.number == 110;
        self.wgsl.is_none() && (self.version.profile == Profile::Es || (unversioned && written()))
    }
}
