//! References to buffers (GL_EXT_buffer_reference): memory behind an address that the host fills in.
//!
//! Each place that an address comes from (a member of a block, a parameter, what an address is made into) gets a buffer of its
//! own, which the harness binds like any other, and what is left of the address is two words that nobody follows:
//!
//! ```text
//! layout(buffer_reference) buffer Floats { float data[]; };   layout(std430) buffer … { float data[]; } Floats_from;
//! layout(push_constant) uniform P { Floats from; } p;         layout(push_constant) uniform P { uvec2 from; } p;
//! p.from.data[i]                                              Floats_from.data[i]
//! ```
//!
//! Two addresses are never the same memory then. A text in which one variable holds several of them, as a list does that is
//! walked, stays as it is.

#[cfg(test)]
mod tests;
mod types;

use std::collections::{BTreeMap, HashMap, HashSet};

use base::text::{Assembly, SourceFile, Span};
use syntax::Shader;
use syntax::ast::{Callee, ExprId, ExprKind, InterfaceBlock, ItemKind, Qualifier, QualifierKind, TypeKind, UnaryOp};
use syntax::symbols::{SymbolId, SymbolKind};
use syntax::walk;
use types::Types;

/// A text whose references are buffers.
#[derive(Debug)]
pub struct Unfolded {
    /// The text.
    pub file: SourceFile,
    /// What to tell of it.
    pub note: String,
    /// Memory that is written has several addresses, which one buffer stands for: what is found of it may be of two.
    pub shares: bool,
}

/// Buffers that are told by name.
const MOST_TOLD: usize = 6;

/// Expressions within one another that are followed to where an address comes from.
const MOST_STEPS: usize = 32;

/// The text with a buffer for each address. None where it has no reference, or one whose buffer is not known before it runs.
pub fn unfolded(shader: &Shader) -> Option<Unfolded> {
    let types = Types::of(shader)?;
    let writes = writes(shader);
    let mut work = Work {
        shader,
        values: values(shader, &writes),
        writes,
        targets: targets(shader),
        words: shader.tokens().iter().map(|token| shader.file().slice(token.span)).collect(),
        buffers: BTreeMap::new(),
        indexed: HashSet::new(),
        accessed: HashSet::new(),
        shares: false,
        edits: BTreeMap::new(),
        types,
    };
    work.find_indexed();
    work.accesses()?;
    work.values_of_references()?;
    work.written_types()?;
    work.declarations();
    Some(work.finish())
}

/// Variables that are written as a whole, and how often.
fn writes(shader: &Shader) -> HashMap<SymbolId, usize> {
    let mut writes = HashMap::new();
    // What is written behind a reference leaves the reference as it is.
    shader
        .uses()
        .iter()
        .filter(|u| u.access.writes() && !u.partial)
        .for_each(|u| *writes.entry(u.symbol).or_default() += 1);
    writes
}

/// The one value of each local variable that gets no other: where it is declared, or behind that.
fn values(shader: &Shader, writes: &HashMap<SymbolId, usize>) -> HashMap<SymbolId, ExprId> {
    let locals = shader.symbols().filter(|(_, symbol)| symbol.kind == SymbolKind::Local);
    let by_place: HashMap<usize, SymbolId> = locals.filter_map(|(id, symbol)| Some((symbol.span?.start, id))).collect();
    let mut initial = HashMap::new();
    walk::declarators(shader, |d| {
        if let (Some(symbol), Some(value)) = (by_place.get(&d.name.span.start), &d.initializer) {
            initial.insert(*symbol, value.value);
        }
    });
    let assigned = shader.arena().iter().filter_map(|(_, expr)| match expr.kind {
        ExprKind::Assign { op: None, target, value, .. } if matches!(shader.expr(target).kind, ExprKind::Name(_)) => {
            shader.symbol_of(target).map(|symbol| (symbol, value))
        }
        _ => None,
    });
    let only: Vec<(SymbolId, ExprId)> =
        assigned.filter(|(symbol, _)| writes.get(symbol) == Some(&1) && !initial.contains_key(symbol)).collect();
    initial.retain(|symbol, _| !writes.contains_key(symbol));
    initial.extend(only);
    initial
}

/// What is written, and what stands in front of the last member or index of it.
fn targets(shader: &Shader) -> HashSet<ExprId> {
    let mut pending: Vec<ExprId> = Vec::new();
    for (_, expr) in shader.arena().iter() {
        match &expr.kind {
            ExprKind::Assign { target, .. } => pending.push(*target),
            ExprKind::Postfix { operand, .. } => pending.push(*operand),
            ExprKind::Unary { op: UnaryOp::Increment | UnaryOp::Decrement, operand, .. } => pending.push(*operand),
            ExprKind::Call { callee: Callee::Name(name), args } if name.name.starts_with("atomic") => {
                pending.extend(args.first());
            }
            _ => {}
        }
    }
    let mut all = HashSet::new();
    while let Some(id) = pending.pop() {
        if let ExprKind::Field { base, .. } | ExprKind::Index { base, .. } | ExprKind::Paren(base) =
            shader.expr(id).kind
            && all.insert(id)
        {
            pending.push(base);
        }
    }
    all
}

struct Work<'s> {
    shader: &'s Shader,
    types: Types<'s>,
    values: HashMap<SymbolId, ExprId>,
    writes: HashMap<SymbolId, usize>,
    targets: HashSet<ExprId>,
    words: HashSet<&'s str>,
    /// Names of buffers, by the type of their reference and where the address comes from.
    buffers: BTreeMap<(&'s str, String), String>,
    /// References that are taken for the first of several elements (GL_EXT_buffer_reference2).
    indexed: HashSet<&'s str>,
    /// References of which a member is taken.
    accessed: HashSet<ExprId>,
    shares: bool,
    /// What stands in the place of each span, by its start.
    edits: BTreeMap<usize, (Span, String)>,
}

impl<'s> Work<'s> {
    fn text(&self, span: Span) -> &'s str {
        self.shader.file().slice(span)
    }

    fn block(&self, reference: &str) -> Option<&'s InterfaceBlock> {
        match &self.shader.unit().items.get(*self.types.references.get(reference)?)?.kind {
            ItemKind::Block(block) => Some(block),
            _ => None,
        }
    }

    fn find_indexed(&mut self) {
        for (_, expr) in self.shader.arena().iter() {
            if let ExprKind::Index { base, .. } = expr.kind
                && let Some(of) = self.types.reference(base)
            {
                self.indexed.insert(of.name);
            }
        }
    }

    /// Puts the name of a buffer in the place of each reference of which a member is taken.
    fn accesses(&mut self) -> Option<()> {
        let shader = self.shader;
        // What stands around others comes last in the arena, and first here: its edit covers theirs.
        let all: Vec<ExprId> = shader.arena().iter().map(|(id, _)| id).collect();
        for id in all.into_iter().rev() {
            let ExprKind::Field { base, .. } = shader.expr(id).kind else { continue };
            let Some(of) = self.types.reference(base) else { continue };
            let (whole, indexed) = (shader.expr(base), self.indexed.contains(of.name));
            if self.is_covered(whole.span) {
                continue;
            }
            self.accessed.insert(base);
            let (reference, index) = self.element(base);
            let name = self.buffer(of.name, reference)?;
            self.shares |= self.targets.contains(&id) && self.varies(reference, 0);
            if whole.from_macro || shader.expr(reference).from_macro {
                return None;
            }
            match (indexed, index) {
                (false, _) => self.edit(whole.span, name),
                (true, None) => self.edit(whole.span, format!("{name}.all[0]")),
                // The index stays where it is, with what stands in it.
                (true, Some(_)) => self.edit(shader.expr(reference).span, format!("{name}.all")),
            }
        }
        Some(())
    }

    /// A reference without the index behind it, and the index.
    fn element(&mut self, id: ExprId) -> (ExprId, Option<ExprId>) {
        match self.shader.expr(id).kind {
            ExprKind::Paren(inner) if !matches!(self.shader.expr(inner).kind, ExprKind::Index { .. }) => (id, None),
            ExprKind::Paren(inner) => {
                self.accessed.insert(inner);
                self.element(inner)
            }
            ExprKind::Index { base, index } if self.types.reference(base).is_some() => (base, Some(index)),
            _ => (id, None),
        }
    }

    /// The buffer that a reference points to.
    fn buffer(&mut self, ty: &'s str, reference: ExprId) -> Option<String> {
        let (from, hint) = self.origin(reference, 0)?;
        if let Some(name) = self.buffers.get(&(ty, from.clone())) {
            return Some(name.clone());
        }
        let base = format!("{ty}_{hint}");
        let taken =
            |name: &String| self.words.contains(name.as_str()) || self.buffers.values().any(|known| known == name);
        let name = (1..).map(|k| if k == 1 { base.clone() } else { format!("{base}{k}") }).find(|name| !taken(name))?;
        self.buffers.insert((ty, from), name.clone());
        Some(name)
    }

    /// Where an address comes from, in words that are the same for the same place, and a name for it.
    fn origin(&self, id: ExprId, steps: usize) -> Option<(String, String)> {
        if steps > MOST_STEPS {
            return None;
        }
        let shader = self.shader;
        let expr = shader.expr(id);
        match &expr.kind {
            ExprKind::Paren(inner) => self.origin(*inner, steps + 1),
            ExprKind::Name(name) => {
                let symbol = shader.symbol_of(id)?;
                if let Some(value) = self.values.get(&symbol) {
                    return self.origin(*value, steps + 1);
                }
                let place = self.types.declared(id)?;
                if let Some(block) = self.types.loose.get(&place) {
                    return Some((format!("{block}.{name}"), name.clone()));
                }
                // A parameter has the address of its callers.
                let written = self.writes.contains_key(&symbol);
                (!written).then(|| (format!("{name} at {place}"), name.clone()))
            }
            ExprKind::Field { base, field } => {
                let owner = self.types.type_of(*base)?;
                Some((format!("{}.{}", owner.name, field.name), field.name.clone()))
            }
            ExprKind::Index { base, index } => {
                let (from, hint) = self.origin(*base, steps + 1)?;
                if self.types.reference(*base).is_some() {
                    return Some((from, hint));
                }
                let number = shader.fold(*index).and_then(syntax::Const::as_integer);
                Some((format!("{from}[{}]", number.map_or_else(String::new, |n| n.to_string())), hint))
            }
            ExprKind::Call { args, .. } => {
                let text: String = self.text(expr.span).split_whitespace().collect();
                // An address that is a reference of another type.
                let one = args.first().filter(|arg| args.len() == 1 && self.types.reference(**arg).is_some());
                let named = one.and_then(|arg| self.origin(*arg, steps + 1));
                Some(named.unwrap_or_else(|| (text, "address".to_owned())))
            }
            _ => None,
        }
    }

    /// True for an address that need not be the same in two invocations, as far as the text shows.
    fn varies(&self, id: ExprId, steps: usize) -> bool {
        let shader = self.shader;
        if steps > MOST_STEPS {
            return true;
        }
        match &shader.expr(id).kind {
            ExprKind::Name(_) => {
                let Some(symbol) = shader.symbol_of(id) else { return true };
                if let Some(value) = self.values.get(&symbol) {
                    return self.varies(*value, steps + 1);
                }
                matches!(shader.symbol(symbol).kind, SymbolKind::Local)
            }
            ExprKind::Index { base, index } if self.types.reference(*base).is_none() => {
                shader.fold(*index).is_none() || self.varies(*base, steps + 1)
            }
            ExprKind::Index { base, .. } => self.varies(*base, steps + 1),
            _ => shader.expr(id).children().into_iter().any(|child| self.varies(child, steps + 1)),
        }
    }

    /// Puts words in the place of references that are made and handed on.
    fn values_of_references(&mut self) -> Option<()> {
        let shader = self.shader;
        let all: Vec<ExprId> = shader.arena().iter().map(|(id, _)| id).collect();
        for id in all.into_iter().rev() {
            let expr = shader.expr(id);
            let Some(of) = self.types.reference(id) else { continue };
            if self.accessed.contains(&id) {
                continue;
            }
            let replaced = match &expr.kind {
                ExprKind::Call { callee: Callee::Name(name), .. } => name.name == of.name,
                ExprKind::Binary { .. } => true,
                ExprKind::Index { base, .. } => self.types.reference(*base).is_some(),
                _ => false,
            };
            if replaced && !self.is_covered(expr.span) {
                if expr.from_macro {
                    return None;
                }
                self.edit(expr.span, "uvec2(1u)".to_owned());
            }
        }
        Some(())
    }

    /// Two words in the place of each type that is a reference.
    fn written_types(&mut self) -> Option<()> {
        let written = std::mem::take(&mut self.types.written);
        for (ty, qualifiers) in written {
            let name = self.text(ty.name_span);
            if let TypeKind::Named(own) = &ty.kind
                && self.types.references.contains_key(own.as_str())
            {
                // A macro has the name.
                if name != own {
                    return None;
                }
                self.edit(ty.name_span, "uvec2".to_owned());
                // What is said of the memory is no qualifier of words.
                for memory in qualifiers.list.iter().filter(|q| matches!(q.kind, QualifierKind::Memory(_))) {
                    self.edit(memory.span, String::new());
                }
            }
        }
        Some(())
    }

    /// The buffers in the place of the types.
    fn declarations(&mut self) {
        let items = &self.shader.unit().items;
        let blocks: Vec<(&str, usize)> = self.types.references.iter().map(|(name, at)| (*name, *at)).collect();
        for (name, at) in blocks {
            let Some(block) = self.block(name) else { continue };
            let body = self.edited(block.body_span);
            let mut out = String::new();
            if self.indexed.contains(name) {
                out.push_str(&format!("struct {name}_element {body}; "));
            }
            for ((ty, _), buffer) in self.buffers.iter().filter(|((ty, _), _)| *ty == name) {
                let qualifiers = self.qualifiers(&block.qualifiers.list);
                let body = if self.indexed.contains(ty) { format!("{{ {ty}_element all[]; }}") } else { body.clone() };
                out.push_str(&format!("{qualifiers} sc_{buffer} {body} {buffer}; "));
            }
            let span = items[at].span;
            self.edits.retain(|_, (inner, _)| !(span.start <= inner.start && inner.end <= span.end));
            self.edits.insert(span.start, (span, out));
        }
        // `layout(buffer_reference) buffer Node;` in front of the block itself.
        for item in items {
            if let ItemKind::Qualified(names) = &item.kind
                && names.names.is_empty()
                && names.qualifiers.layout_entry("buffer_reference").is_some()
            {
                self.edits.insert(item.span.start, (item.span, String::new()));
            }
        }
    }

    /// Qualifiers of a block without those of a reference.
    fn qualifiers(&self, list: &[Qualifier]) -> String {
        let one = |qualifier: &Qualifier| match &qualifier.kind {
            QualifierKind::Layout(entries) => {
                let kept: Vec<&str> = entries
                    .iter()
                    .filter(|entry| !entry.key.name.starts_with("buffer_reference"))
                    .map(|entry| self.text(entry.span))
                    .collect();
                if kept.is_empty() { String::new() } else { format!("layout({})", kept.join(", ")) }
            }
            _ => self.text(qualifier.span).to_owned(),
        };
        list.iter().map(one).collect::<Vec<_>>().join(" ")
    }

    fn is_covered(&self, span: Span) -> bool {
        self.edits.values().any(|(known, _)| known.start <= span.start && span.end <= known.end)
    }

    fn edit(&mut self, span: Span, text: String) {
        if !self.is_covered(span) {
            self.edits.insert(span.start, (span, text));
        }
    }

    /// A part of the text with the edits inside of it.
    fn edited(&self, part: Span) -> String {
        let (mut out, mut done) = (String::new(), part.start);
        for (span, text) in self.edits.range(part.start..part.end).map(|(_, edit)| edit) {
            out.push_str(self.text(Span::new(done, span.start)));
            out.push_str(text);
            done = span.end;
        }
        out.push_str(self.text(Span::new(done, part.end)));
        out
    }

    fn finish(self) -> Unfolded {
        let file = self.shader.file();
        let (mut out, mut done) = (Assembly::new(), 0);
        for (span, text) in self.edits.values() {
            out.copy(file, Span::new(done, span.start));
            out.replace(text, file, *span);
            done = span.end;
        }
        out.copy(file, Span::new(done, file.text().len()));
        let shares = if self.shares { "; addresses that an index chooses lead to one" } else { "" };
        let names: Vec<String> = self.buffers.values().map(|name| format!("`{name}`")).collect();
        let (first, more) = names.split_at(names.len().min(MOST_TOLD));
        let more = if more.is_empty() { String::new() } else { format!(" and {} more", more.len()) };
        let note = format!("each address of a buffer leads to memory of its own: {}{more}{shares}", first.join(", "));
        Unfolded { file: out.finish(file.name()), note, shares: self.shares }
    }
}
