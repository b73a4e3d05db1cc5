//! Front end for WGSL: the tree is that of GLSL with what GLSL has no place for beside it, so that whatever looks at
//! values looks at both languages. `select` is a conditional expression, `loop` a loop of GLSL, a pointer what it points
//! to, and functions that GLSL has by another name go by that one; places are those of the author's text.

mod body;
mod builtin;
mod check;
mod directive;
mod expression;
mod layout;
mod lexer;
mod misfit;
mod parser;
mod statement;
mod syntax;
mod types;
mod types_of;

pub use builtin::{OWN as OWN_FUNCTIONS, is_builtin};
pub use layout::{Extent, Layout, Placed};
pub use syntax::{Attribute, DeclarationKind, MemberSyntax, ModuleItem, TypeArg, TypeSyntax, VariableSyntax};
pub use types::{is_sampler, is_type, plain, spelling};

use std::collections::HashMap;

use super::ast::{ExprId, Ident};
use super::fold::Const;
use super::interface::Interface;
use super::preprocess::limit::MOST_PIECES;
use super::sink::Sink;
use super::symbols::{FunctionId, SymbolId};
use super::{Profile, Shader, Stage, Token, Version, errors};
use base::diagnostic::message;
use base::text::{SourceFile, Span};

/// What a module has beside its tree.
#[derive(Clone, Debug, Default)]
pub struct Module {
    /// Declarations at module scope, in the order of the text.
    pub items: Vec<ModuleItem>,
    /// Variables of functions, by the place of their names.
    pub locals: HashMap<usize, VariableSyntax>,
    /// Functions that a pipeline can start.
    pub entry_points: Vec<EntryPoint>,
    /// Structures that host and shader can share, by name.
    pub layouts: HashMap<String, Layout>,
    /// Bytes of variables that host and shader share, by their symbols; of a runtime-sized array with one element.
    extents: HashMap<SymbolId, Extent>,
    /// True when an engine or a script puts more into the text, or takes parts away.
    pub composed: bool,
    /// True when parts are left out or filled in, and not only names are declared elsewhere.
    pub varies: bool,
    /// True when parts are filled in that are not seen here.
    pub filled: bool,
    symbols: HashMap<usize, SymbolId>,
    functions: HashMap<usize, FunctionId>,
}

/// A function that a pipeline can start.
#[derive(Clone, Debug, PartialEq)]
pub struct EntryPoint {
    /// Its name.
    pub name: Ident,
    /// The stage.
    pub stage: Stage,
    /// Index of its item.
    pub item: usize,
    /// The function.
    pub function: FunctionId,
    /// Size of a work group, where it is stated and does not depend on the pipeline.
    pub workgroup: Option<[u32; 3]>,
}

impl Module {
    /// Variables at module scope with their symbols.
    pub fn globals(&self) -> impl Iterator<Item = (&VariableSyntax, SymbolId)> {
        self.items.iter().enumerate().filter_map(|(index, item)| match item {
            ModuleItem::Variable(variable) => Some((variable, *self.symbols.get(&index)?)),
            _ => None,
        })
    }

    /// Size and alignment of a variable at module scope, where host and shader can share it.
    pub fn extent(&self, variable: SymbolId) -> Option<Extent> {
        self.extents.get(&variable).copied()
    }

    /// The function of an item.
    pub fn function(&self, item: usize) -> Option<FunctionId> {
        self.functions.get(&item).copied()
    }

    /// The members of a structure.
    pub fn members(&self, name: &str) -> Option<&[MemberSyntax]> {
        self.items.iter().find_map(|i| match i {
            ModuleItem::Struct { name: n, members } if n.name == name => Some(members.as_slice()),
            _ => None,
        })
    }

    /// The attribute of that name.
    pub fn attribute<'m>(all: &'m [Attribute], name: &str) -> Option<&'m Attribute> {
        all.iter().find(|a| a.name.name == name)
    }
}

/// True for an argument whose address is taken, `&x`: the tree has what it points to.
pub fn is_address(shader: &Shader, arg: ExprId) -> bool {
    let (text, span) = (shader.file.text(), shader.expr(arg).span);
    text[span.range()].starts_with('&') || text[..span.start].trim_end().ends_with('&')
}

/// The tokens of a text, also those of directives and of branches that are left out.
pub fn tokens(text: &str) -> Vec<Token> {
    lexer::read(text).all
}

pub(super) fn read(file: &SourceFile) -> super::Parsed {
    let mut sink = Sink::new(file);
    let pieces = lexer::read(file.text());
    directive::tell_slips(&pieces.directives, &mut sink);
    // A literal beside a name that is filled in may be a part of one.
    let filled = pieces.filled || file.text().contains("#{");
    let mut tokens = pieces.active.as_slice();
    if let Some(beyond) = tokens.get(MOST_PIECES) {
        let text = message!(
            "the text has more than {MOST_PIECES} tokens",
            "テキストのトークンが {MOST_PIECES} 個を超えています"
        );
        sink.error(errors::TOO_DEEP, beyond.span, text, message!("read up to here", "ここまで読みました"));
        tokens = &tokens[..MOST_PIECES];
    }
    let parsed = parser::Parser::new(file.text(), tokens, (pieces.composed, filled), &mut sink).run();
    let parser::Parsed { unit, mut arena, items, locals, constructed, addresses, suffixed } = parsed;
    let mut checker = check::Checker::new(&items, &locals, &constructed, &addresses, &mut arena);
    checker.suffixed = suffixed;
    let found = check::check(&unit, checker);
    let check::Found {
        types,
        values,
        names,
        calls,
        symbols,
        functions,
        uses,
        unknown,
        beyond,
        mut misfits,
        too_large,
        globals,
        signatures,
    } = found;
    for (span, why) in too_large {
        sink.error(errors::TOO_DEEP, span, why, "use an array, or fewer levels");
    }
    for (index, value, count) in beyond {
        let last = count.saturating_sub(1);
        let d = sink
            .start(
                errors::INDEX_RANGE,
                arena.get(index).span,
                message!("there is no element {value}", "{value} 番の要素はありません"),
            )
            .with_label(message!("this index", "この添字"))
            .with_why(message!("the elements are 0 to {last}", "要素は 0 から {last} です"))
            .with_help(message!("use an index inside the range", "範囲内の添字にしてください"));
        sink.push(d);
    }
    // Of several declarations of one name, or of several texts, each has its own types.
    let mut declared: Vec<&str> = items.iter().map(|item| check::name_of(item).name.as_str()).collect();
    let count = declared.len();
    declared.sort_unstable();
    declared.dedup();
    if pieces.varies || filled || declared.len() < count {
        misfits.clear();
    }
    for misfit::Misfit { code, place, what, label } in misfits {
        sink.error(code, place, what, label);
    }
    let structures = items.iter().filter_map(|i| match i {
        ModuleItem::Struct { name, .. } => Some(name.name.clone()),
        _ => None,
    });
    let mut layouts =
        layout::Layouts { items: &items, values: &values, text: file.text(), done: HashMap::new(), depth: 0 };
    let placed: HashMap<String, Layout> =
        structures.filter_map(|name| layouts.structure(&name).map(|l| (name, l))).collect();
    let sized = items.iter().enumerate().filter_map(|(index, item)| match item {
        ModuleItem::Variable(VariableSyntax { ty: Some(ty), .. }) => Some((*globals.get(&index)?, layouts.extent(ty)?)),
        _ => None,
    });
    let extents = sized.collect();
    let entry_points = items
        .iter()
        .enumerate()
        .filter_map(|(index, item)| entry_point(item, *signatures.get(&index)?, index, &values))
        .collect();
    let module = Module {
        layouts: placed,
        extents,
        entry_points,
        composed: pieces.composed,
        varies: pieces.varies,
        filled: pieces.filled,
        symbols: globals,
        functions: signatures,
        items,
        locals,
    };
    let shader = Shader {
        file: sink.file.clone(),
        stage: Stage::Library,
        version: Version { number: 460, profile: Profile::Core, span: None },
        extensions: Vec::new(),
        comments: pieces.comments,
        tokens: pieces.all,
        holes: Vec::new(),
        unit,
        arena,
        types,
        values,
        names,
        calls,
        symbols,
        functions,
        uses,
        unknown,
        lacking: Vec::new(),
        absent: 0,
        interface: Interface::default(),
        defines: Vec::new(),
        wgsl: Some(Box::new(module)),
    };
    super::Parsed { shader, diagnostics: sink.finish() }
}

fn entry_point(item: &ModuleItem, function: FunctionId, index: usize, values: &[Option<Const>]) -> Option<EntryPoint> {
    let ModuleItem::Function { attributes, name, .. } = item else { return None };
    let stage = attributes.iter().find_map(|a| match a.name.name.as_str() {
        "vertex" => Some(Stage::Vertex),
        "fragment" => Some(Stage::Fragment),
        "compute" => Some(Stage::Compute),
        _ => None,
    })?;
    let size = |id: &ExprId| {
        let value = values.get(id.index()).copied().flatten()?.as_integer()?;
        u32::try_from(value).ok()
    };
    let workgroup = Module::attribute(attributes, "workgroup_size").and_then(|a| {
        let mut sizes = [1; 3];
        for (slot, arg) in sizes.iter_mut().zip(&a.args) {
            *slot = size(arg)?;
        }
        Some(sizes)
    });
    Some(EntryPoint { name: name.clone(), stage, item: index, function, workgroup })
}

/// Place of nothing, for what the text does not write.
pub(super) fn nowhere(at: Span) -> Span {
    Span::at(at.end)
}

#[cfg(test)]
mod tests;
