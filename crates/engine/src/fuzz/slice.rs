//! One function of a shader alone: everything that it does not need is left out, so that it can be run
//! whatever the rest of the file does, and what it takes from the stage becomes a plain variable.

use std::collections::BTreeSet;

use super::builtin;
use base::text::{Edit, Span};
use syntax::ast::{ExprId, ExprKind, Item, ItemKind, StmtKind, TypeKind};
use syntax::interface::{Storage, Variable};
use syntax::symbols::{CallTarget, FunctionId, SymbolId, SymbolKind};
use syntax::types::Type;
use syntax::{Shader, Stage, walk};

/// A global variable that goes in or comes out.
#[derive(Clone, Debug)]
pub struct Global {
    /// Its name in the sliced text.
    pub name: String,
    /// Its name as the author knows it.
    pub shown: String,
    /// Type with the sizes of its arrays, as the author declares it.
    pub ty: Type,
    /// Its value is used.
    pub reads: bool,
    /// It gets a value.
    pub writes: bool,
}

/// What is left of a shader for one function.
#[derive(Clone, Debug)]
pub struct Slice {
    /// Edits of the author's text; they do not overlap.
    pub edits: Vec<Edit>,
    /// Declarations that have to stand before all others.
    pub head: String,
    /// Where they stand.
    pub head_at: usize,
    /// Variables that the function reads and writes.
    pub globals: Vec<Global>,
    /// Variables whose first value follows from these, in the order of their declarations.
    pub late: Vec<LateValue>,
}

/// A global variable that is initialised with inputs: where these are parameters, it gets its value behind them.
#[derive(Clone, Debug)]
pub struct LateValue {
    /// Its name.
    pub name: String,
    /// The value in the author's text.
    pub value: Span,
    /// Edits of the value.
    pub edits: Vec<Edit>,
}

/// Leaves everything out that `root` does not need.
pub fn slice(shader: &Shader, root: FunctionId) -> Slice {
    let functions = shader.reachable(root);
    let used = shader.used_by(&functions);
    let (head, head_at) = (String::new(), head_at(shader));
    let mut slice = Slice { edits: Vec::new(), head, head_at, globals: Vec::new(), late: Vec::new() };
    let mut dropped: Vec<bool> = shader.unit().items.iter().map(|_| false).collect();
    for (index, item) in shader.unit().items.iter().enumerate() {
        dropped[index] = match &item.kind {
            ItemKind::Function(_) => !functions.iter().any(|&f| {
                let info = shader.function_info(f);
                info.definition == Some(index) || info.prototypes.contains(&index)
            }),
            ItemKind::Declaration(_) => {
                if defines_structure(shader, index) {
                    continue;
                }
                let variables: Vec<&Variable> = shader.interface().variables().filter(|v| v.item == index).collect();
                let stays = |v: &&Variable| match v.storage {
                    Storage::In | Storage::Out | Storage::Uniform | Storage::Buffer | Storage::Shared => {
                        used.contains(&v.symbol)
                    }
                    Storage::Const | Storage::Global => true,
                };
                !variables.is_empty() && !variables.iter().any(stays)
            }
            ItemKind::Block(_) => {
                !shader.interface().blocks.iter().enumerate().any(|(k, b)| b.item == index && is_used(shader, k, &used))
            }
            ItemKind::Qualified(_) => true,
            ItemKind::Precision(_) | ItemKind::Empty | ItemKind::Error => false,
        };
    }
    // A stage chooses among its subroutines; one of them alone is an ordinary function.
    let main = shader.function_info(root).name.name == "main";
    for (index, item) in shader.unit().items.iter().enumerate().filter(|(_, item)| is_subroutine(item)) {
        dropped[index] &= !main;
        if let (ItemKind::Function(function), false, false) = (&item.kind, main, dropped[index]) {
            let qualifiers = Span::new(function.head_span.start, function.return_type.span.start);
            slice.edits.push(Edit::delete(qualifiers));
        }
    }
    let spans: Vec<Span> = shader.unit().items.iter().map(|item| item.span).collect();
    for (index, item) in shader.unit().items.iter().enumerate().filter(|(k, _)| dropped[*k]) {
        // Items of one macro have one place: they go together or stay together.
        let overlaps = |s: Span| s.start < item.span.end && item.span.start < s.end;
        let shared = spans.iter().enumerate().any(|(k, s)| k != index && !dropped[k] && overlaps(*s));
        let before = slice.edits.iter().any(|e| overlaps(e.span));
        if !shared && !before {
            slice.edits.extend(without_directives(shader, item.span));
        }
    }
    let kept = |item: usize| !dropped[item];
    let found = Found { shader, root, functions: &functions };
    plain_variables(&found, &used, &kept, &mut slice);
    plain_blocks(shader, &used, &kept, &mut slice);
    built_ins(&found, &used, &mut slice);
    late_values(shader, &kept, &mut slice);
    slice.edits.sort_by_key(|e| (e.span.start, e.span.end));
    slice
}

fn is_used(shader: &Shader, block: usize, used: &BTreeSet<SymbolId>) -> bool {
    used.iter().any(|&id| match shader.symbol(id).kind {
        SymbolKind::BlockMember(k) | SymbolKind::BlockInstance(k) => k == block,
        SymbolKind::Builtin | SymbolKind::Global(_) | SymbolKind::Param(_) | SymbolKind::Local => false,
    })
}

/// Takes initialisers out that need an input. In the text they come before everything else, and inputs are parameters here.
fn late_values(shader: &Shader, kept: &dyn Fn(usize) -> bool, slice: &mut Slice) {
    let text = shader.file().text();
    let fed: BTreeSet<&str> = slice.globals.iter().filter(|g| g.reads).map(|g| g.shown.as_str()).collect();
    let mut late: BTreeSet<SymbolId> = BTreeSet::new();
    let mut moved = Vec::new();
    for variable in shader.interface().variables().filter(|v| v.storage == Storage::Global && kept(v.item)) {
        let Some(initializer) = variable.initializer else { continue };
        let needs = |id: ExprId| match shader.symbol_of(id) {
            Some(symbol) => late.contains(&symbol) || fed.contains(shader.symbol(symbol).name.as_str()),
            None => matches!(shader.callee(id), Some(CallTarget::User(_))),
        };
        let value = shader.expr(initializer).span;
        // Of a variable that a macro declares the text shows only the macro.
        let shown = text.get(variable.name_span.range()) == Some(variable.name.as_str())
            && variable.name_span.end <= value.start;
        if !shown || !walk::expressions(shader, initializer).into_iter().any(needs) {
            continue;
        }
        let Some(equals) = text[variable.name_span.end..value.start].rfind('=') else { continue };
        late.insert(variable.symbol);
        moved.push((variable.name.clone(), value, Span::new(variable.name_span.end + equals, value.end)));
    }
    for (name, value, gone) in moved {
        let is_inside = |edit: &Edit| gone.start <= edit.span.start && edit.span.end <= gone.end;
        let (edits, rest) = slice.edits.drain(..).partition(is_inside);
        slice.edits = rest;
        slice.edits.push(Edit::delete(gone));
        slice.late.push(LateValue { name, value, edits });
    }
}

/// Deletes a span, but for the lines of directives in it.
fn without_directives(shader: &Shader, span: Span) -> Vec<Edit> {
    let text = shader.file().text();
    let (mut edits, mut at, mut start) = (Vec::new(), span.start, span.start);
    let mut goes_on = false;
    for line in text[span.range()].split_inclusive('\n') {
        let end = start + line.len();
        // The first part of the span may begin in the middle of a line, and is then no directive.
        let directive = goes_on || (line.trim_start().starts_with('#') && start != span.start);
        goes_on = directive && line.trim_end_matches(['\n', '\r']).ends_with('\\');
        if directive {
            if at < start {
                edits.push(Edit::replace(Span::new(at, start), "\n"));
            }
            at = end;
        }
        start = end;
    }
    if at < span.end {
        edits.push(Edit::delete(Span::new(at, span.end)));
    }
    edits
}

/// Where declarations can stand before all others: before the first item.
fn head_at(shader: &Shader) -> usize {
    shader.unit().items.iter().map(|item| item.span.start).min().unwrap_or(shader.file().text().len())
}

fn is_subroutine(item: &Item) -> bool {
    match &item.kind {
        ItemKind::Declaration(declaration) => declaration.qualifiers.is_subroutine(),
        ItemKind::Function(function) => function.qualifiers.is_subroutine(),
        ItemKind::Block(_) | ItemKind::Qualified(_) | ItemKind::Precision(_) | ItemKind::Empty | ItemKind::Error => {
            false
        }
    }
}

/// The structure that a declaration defines in place: where it ends, and its name.
fn structure_of(shader: &Shader, item: usize) -> Option<(usize, &str)> {
    let ItemKind::Declaration(declaration) = &shader.unit().items.get(item)?.kind else { return None };
    let TypeKind::Struct(structure) = &declaration.ty.kind else { return None };
    Some((structure.span.end, &structure.name.as_ref()?.name))
}

fn defines_structure(shader: &Shader, item: usize) -> bool {
    structure_of(shader, item).is_some()
}

fn accesses(shader: &Shader, used: &BTreeSet<SymbolId>, symbol: SymbolId) -> (bool, bool) {
    if !used.contains(&symbol) {
        return (false, false);
    }
    let all = || shader.uses_of(symbol);
    (all().any(|u| u.access.reads()), all().any(|u| u.access.writes()))
}

/// True for what a ray carries, by a qualifier of an extension: who traces it has written to it before.
fn is_carried(shader: &Shader, variable: &Variable) -> bool {
    let qualifiers = Span::new(variable.declaration_span.start, variable.type_span.start);
    let words = shader.file().slice(qualifiers).split(|c: char| !c.is_ascii_alphanumeric());
    words.into_iter().any(|word| word.ends_with("EXT") || word.ends_with("NV"))
}

/// What a function finds in variables that it writes.
struct Found<'s> {
    shader: &'s Shader,
    root: FunctionId,
    functions: &'s [FunctionId],
}

impl Found<'_> {
    /// True for a variable that is written in part, or on some ways alone, or after it is read: who calls the function wrote
    /// to it before. Nobody calls `main`.
    fn holds(&self, symbol: SymbolId) -> bool {
        let Self { shader, root, functions } = *self;
        if shader.function_info(root).name.name == "main" {
            return false;
        }
        match self.written(root, symbol) {
            Some(end) => shader
                .uses_of(symbol)
                .any(|one| one.function == Some(root) && one.access.reads() && one.span.start < end),
            None => functions.iter().all(|&own| self.written(own, symbol).is_none()),
        }
    }

    /// Where the first statement of a function ends, none inside of another, that gives the variable a value as a whole.
    fn written(&self, function: FunctionId, symbol: SymbolId) -> Option<usize> {
        let shader = self.shader;
        let syntax = shader.function_syntax(shader.function_info(function))?;
        syntax.body.as_ref()?.statements.iter().find_map(|stmt| {
            let StmtKind::Expr(id) = stmt.kind else { return None };
            let ExprKind::Assign { op: None, target, .. } = shader.expr(id).kind else { return None };
            (shader.symbol_of(target) == Some(symbol)).then_some(stmt.span.end)
        })
    }
}

/// Inputs, outputs and uniforms become plain variables. Samplers stay what they are.
fn plain_variables(found: &Found<'_>, used: &BTreeSet<SymbolId>, kept: &dyn Fn(usize) -> bool, slice: &mut Slice) {
    let shader = found.shader;
    for variable in shader.interface().variables().filter(|v| kept(v.item)) {
        let (mut reads, mut writes) = accesses(shader, used, variable.symbol);
        let fed = match variable.storage {
            Storage::Const | Storage::Shared | Storage::Buffer => continue,
            // A variable that starts with a value of its own takes none.
            Storage::Global => {
                reads |= writes && (is_carried(shader, variable) || found.holds(variable.symbol));
                reads &= variable.initializer.is_none();
                false
            }
            Storage::In | Storage::Uniform => {
                writes = false;
                true
            }
            // A `varying` of a text without a stage, which it only reads, comes from the stage before.
            Storage::Out if shader.stage() == Stage::Library && !writes => true,
            Storage::Out => {
                reads = writes && found.holds(variable.symbol);
                true
            }
        };
        // A `sampler` of Vulkan has no type of its own before it meets a texture.
        if variable.ty.contains_opaque() || variable.ty.is_error() {
            continue;
        }
        if fed && variable.position == 0 {
            let qualifiers = Span::new(variable.declaration_span.start, variable.type_span.start);
            if !qualifiers.is_empty() {
                slice.edits.push(Edit::delete(qualifiers));
            }
            if let Some((end, name)) = structure_of(shader, variable.item) {
                slice.edits.push(Edit::insert(end, format!("; {name}")));
            }
        }
        if reads || writes {
            let (name, shown) = (variable.name.clone(), variable.name.clone());
            slice.globals.push(Global { name, shown, ty: variable.ty.clone(), reads, writes });
        }
    }
}

/// A block with an instance becomes a structure with a variable, one without its members.
fn plain_blocks(shader: &Shader, used: &BTreeSet<SymbolId>, kept: &dyn Fn(usize) -> bool, slice: &mut Slice) {
    for (index, block) in shader.interface().blocks.iter().enumerate().filter(|(_, b)| kept(b.item)) {
        let fed = match block.storage {
            Storage::In | Storage::Uniform => true,
            Storage::Out => false,
            Storage::Buffer | Storage::Shared | Storage::Const | Storage::Global => continue,
        };
        if !is_used(shader, index, used) || block.ty.contains_opaque() {
            continue;
        }
        let mut declarations: Vec<Span> = Vec::new();
        for member in block.members.iter() {
            let qualifiers = Span::new(member.declaration_span.start, member.type_span.start);
            if !qualifiers.is_empty() && !declarations.contains(&qualifiers) {
                slice.edits.push(Edit::delete(qualifiers));
                declarations.push(qualifiers);
            }
        }
        let mut global = |name: &str, ty: &Type| {
            let (name, ty) = (name.to_owned(), ty.clone());
            slice.globals.push(Global { shown: name.clone(), name, ty, reads: fed, writes: !fed });
        };
        match &block.instance {
            Some(instance) => {
                global(&instance.name, &block.ty);
                slice.edits.push(Edit::replace(Span::new(block.span.start, block.name.span.start), "struct "));
                slice.edits.push(Edit::insert(instance.span.start, format!("; {} ", block.name.name)));
            }
            None => {
                block.members.iter().for_each(|member| global(&member.name.name, &member.ty));
                slice.edits.push(Edit::delete(Span::new(block.span.start, block.body_span.start + 1)));
                slice.edits.push(Edit::delete(Span::new(block.body_span.end - 1, block.span.end)));
            }
        }
    }
}

/// Gives a name of the language another one, wherever it stands.
fn renamed(shader: &Shader, from: &str, to: &str, slice: &mut Slice) {
    for token in shader.tokens().iter().filter(|t| shader.file().slice(t.span) == from) {
        let gone = slice.edits.iter().any(|e| e.span.start < token.span.end && token.span.start < e.span.end);
        if !gone {
            slice.edits.push(Edit::replace(token.span, to.to_owned()));
        }
    }
}

/// Variables of the stage that the language knows become plain ones under other names.
fn built_ins(found: &Found<'_>, used: &BTreeSet<SymbolId>, slice: &mut Slice) {
    let Found { shader, functions, .. } = *found;
    for (id, symbol) in shader.symbols().filter(|(_, s)| s.kind == SymbolKind::Builtin) {
        // A constant of the text.
        if let Some([x, y, z]) =
            shader.workgroup_size().filter(|_| symbol.name == "gl_WorkGroupSize" && used.contains(&id))
        {
            slice.head.push_str(&format!("const uvec3 sc_gl_WorkGroupSize = uvec3({x}, {y}, {z});\n"));
            renamed(shader, &symbol.name, "sc_gl_WorkGroupSize", slice);
            continue;
        }
        let Some(known) = builtin::by_name(&symbol.name).filter(|_| used.contains(&id)) else { continue };
        let uses = || shader.uses_of(id).filter(|u| u.function.is_none_or(|f| functions.contains(&f)));
        let (reads, writes) = (uses().any(|u| u.access.reads()), uses().any(|u| u.access.writes()));
        let name = format!("sc_{}", symbol.name);
        slice.head.push_str(&builtin::declaration(known, &name));
        renamed(shader, &symbol.name, &name, slice);
        let ty = builtin::type_of(known);
        // Of an array of the language, a stage may leave elements alone.
        let reads = if writes && known.output { found.holds(id) || known.array.is_some() } else { reads };
        slice.globals.push(Global { name, shown: symbol.name.clone(), ty, reads, writes });
    }
}
