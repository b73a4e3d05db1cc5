//! One name across stages, includes and host code: everything that a place means, wherever it stands.

use std::collections::{BTreeSet, HashSet};
use std::sync::Arc;

use base::text::{SourceFile, Span};
use ls_types::{DocumentHighlight, DocumentHighlightKind, Location};
use reading::HostName;
use syntax::Stage;
use syntax::interface::Storage;
use syntax::symbols::SymbolKind;

use crate::occurrences::Meaning;
use crate::unit::Unit;
use crate::workspace::{Place, Workspace};

/// A name in one of the shaders.
pub(crate) type Named = (usize, Meaning);

/// A place of a name.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Found {
    pub place: Place,
    pub declares: bool,
    pub writes: bool,
}

/// How a name is shared by the stages of a program.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Shared {
    Uniform(String),
    Attribute(String),
    /// From a stage to the next one.
    Handed(String),
    Block(String),
    Member(String, String),
}

impl Workspace {
    /// What a place means: names of shaders, and the name in host code that stands there.
    pub(crate) fn meaning_at(&self, name: &str, offset: usize) -> (Vec<Named>, Option<&HostName>) {
        let mut found = Vec::new();
        for (index, unit) in self.units().iter().enumerate().filter(|(_, u)| u.files.contains(name)) {
            let at = |span: Span| unit.place_in(name, span).is_some_and(|s| s.start <= offset && offset <= s.end);
            // Between two names, the one that begins there is meant.
            let hit = unit.occurrences().iter().filter(|o| at(o.span)).max_by_key(|o| (o.span.start, !o.declares));
            found.extend(hit.map(|o| (index, o.meaning.clone())));
        }
        let host =
            self.linked().names.iter().find(|n| {
                n.file.name() == name && n.span.start <= offset && offset <= n.span.end && !n.name.is_empty()
            });
        if let Some(host) = host {
            found.extend(self.meant_by(host));
        }
        (found, host)
    }

    /// What a name in host code means in the shaders of its program.
    pub(crate) fn meant_by(&self, host: &HostName) -> Vec<Named> {
        let in_program = |u: &Unit| host.shaders.is_empty() || host.shaders.contains(&u.name);
        let mut found = Vec::new();
        for (index, unit) in self.units().iter().enumerate().filter(|(_, u)| in_program(u)) {
            for (id, symbol) in unit.shader.symbols().filter(|(_, s)| s.name == host.name && s.span.is_some()) {
                let attribute = match symbol.kind {
                    SymbolKind::Global(Storage::Uniform) | SymbolKind::BlockMember(_) => false,
                    SymbolKind::Global(Storage::In) if unit.shader.stage() == Stage::Vertex => true,
                    _ => continue,
                };
                if host.attribute.is_none_or(|a| a == attribute) {
                    found.push((index, Meaning::Symbol(id)));
                }
            }
        }
        found
    }

    /// How a name is shared, and by which units.
    fn shared(&self, (index, meaning): &Named) -> Vec<(Shared, Vec<usize>)> {
        let units = self.units();
        let unit = &units[*index];
        let interface = unit.shader.interface();
        let by_name = |name: &String| units.iter().position(|u| u.name == *name);
        let mut found = Vec::new();
        let programs: Vec<Vec<usize>> = self
            .linked()
            .programs
            .iter()
            .filter(|p| p.contains(&unit.name))
            .map(|p| p.iter().filter_map(by_name).collect())
            .collect();
        let whole = |shared: Shared| {
            let all: BTreeSet<usize> = programs.iter().flatten().copied().collect();
            (shared, all.into_iter().collect())
        };
        let linked = |storage: Storage| matches!(storage, Storage::Uniform | Storage::Buffer);
        match meaning {
            Meaning::Symbol(id) => {
                let symbol = unit.shader.symbol(*id);
                let name = symbol.name.clone();
                match symbol.kind {
                    SymbolKind::Global(Storage::Uniform) => found.push(whole(Shared::Uniform(name))),
                    SymbolKind::BlockMember(block) => {
                        let block = &interface.blocks[block];
                        if linked(block.storage) {
                            found.push(whole(Shared::Member(block.name.name.clone(), name)));
                        }
                    }
                    SymbolKind::Global(storage @ (Storage::In | Storage::Out)) => {
                        if storage == Storage::In && unit.shader.stage() == Stage::Vertex {
                            found.push(whole(Shared::Attribute(name.clone())));
                        }
                        for program in &programs {
                            let Some(at) = program.iter().position(|u| u == index) else { continue };
                            let next = if storage == Storage::Out { Some(at + 1) } else { at.checked_sub(1) };
                            if let Some(next) = next.and_then(|n| program.get(n)) {
                                found.push((Shared::Handed(name.clone()), vec![*next]));
                            }
                        }
                    }
                    _ => {}
                }
            }
            Meaning::Block(block) => {
                let block = &interface.blocks[*block];
                if linked(block.storage) {
                    found.push(whole(Shared::Block(block.name.name.clone())));
                }
            }
            Meaning::Member(place, name) => {
                let own = |b: &&syntax::interface::Block| b.members.iter().any(|m| m.name.span == *place);
                if let Some(block) = interface.blocks.iter().find(own).filter(|b| linked(b.storage)) {
                    found.push(whole(Shared::Member(block.name.name.clone(), name.clone())));
                }
            }
            Meaning::Function(_) | Meaning::Struct(_) => {}
        }
        found
    }

    /// What a shared name is in another shader.
    fn partner(unit: &Unit, shared: &Shared, from: &Unit) -> Option<Meaning> {
        let symbol = |wanted: &str, kind: &dyn Fn(SymbolKind) -> bool| {
            let found = unit.shader.symbols().find(|(_, s)| s.name == wanted && s.span.is_some() && kind(s.kind));
            found.map(|(id, _)| Meaning::Symbol(id))
        };
        match shared {
            Shared::Uniform(name) => symbol(name, &|k| k == SymbolKind::Global(Storage::Uniform)),
            Shared::Attribute(name) => {
                let vertex = unit.shader.stage() == Stage::Vertex;
                symbol(name, &|k| vertex && k == SymbolKind::Global(Storage::In))
            }
            Shared::Handed(name) => {
                let gives = from.shader.interface().output(name).is_some();
                let wanted = if gives { Storage::In } else { Storage::Out };
                symbol(name, &|k| k == SymbolKind::Global(wanted))
            }
            Shared::Block(name) => {
                unit.shader.interface().blocks.iter().position(|b| b.name.name == *name).map(Meaning::Block)
            }
            Shared::Member(block, name) => {
                let block = unit.shader.interface().blocks.iter().find(|b| b.name.name == *block)?;
                let member = block.members.iter().find(|m| m.name.name == *name)?;
                Some(match member.symbol {
                    Some(symbol) => Meaning::Symbol(symbol),
                    None => Meaning::Member(member.name.span, name.clone()),
                })
            }
        }
    }

    /// All names that go together with these: in shaders that include the same file, in other stages, in host code.
    pub(crate) fn family(&self, start: Vec<Named>) -> (HashSet<Named>, Vec<&HostName>) {
        let units = self.units();
        let mut seen: HashSet<Named> = HashSet::new();
        let mut hosts: Vec<usize> = Vec::new();
        let mut open = start;
        while let Some(named) = open.pop() {
            if !seen.insert(named.clone()) {
                continue;
            }
            let unit = &units[named.0];
            for (shared, others) in self.shared(&named) {
                let partners = others.into_iter().filter(|o| *o != named.0);
                open.extend(partners.filter_map(|o| Some((o, Self::partner(&units[o], &shared, unit)?))));
                let (name, attribute) = match &shared {
                    Shared::Uniform(name) | Shared::Member(_, name) => (name, false),
                    Shared::Attribute(name) => (name, true),
                    Shared::Handed(_) | Shared::Block(_) => continue,
                };
                for (index, host) in self.linked().names.iter().enumerate() {
                    let of_kind = host.name == *name && host.attribute.is_none_or(|a| a == attribute);
                    let own = host.shaders.contains(&unit.name) || host.shaders.is_empty();
                    if of_kind && own && !hosts.contains(&index) {
                        hosts.push(index);
                        open.extend(self.meant_by(host));
                    }
                }
            }
            // A declaration in a file that several shaders include.
            let declared: Vec<(SourceFile, Span)> = unit
                .occurrences()
                .iter()
                .filter(|o| o.declares && o.meaning == named.1)
                .filter_map(|o| unit.place(o.span))
                .collect();
            for (file, span) in declared {
                for (other, unit) in
                    units.iter().enumerate().filter(|(o, u)| *o != named.0 && u.files.contains(file.name()))
                {
                    let same = |o: &&crate::occurrences::Occurrence| {
                        o.declares && unit.place_in(file.name(), o.span) == Some(span)
                    };
                    open.extend(unit.occurrences().iter().find(same).map(|o| (other, o.meaning.clone())));
                }
            }
        }
        hosts.sort_unstable();
        (seen, hosts.into_iter().map(|h| &self.linked().names[h]).collect())
    }

    /// All places of what stands at a place, each once, by file and place.
    pub(crate) fn found_at(&self, name: &str, offset: usize) -> Vec<Found> {
        let (start, host) = self.meaning_at(name, offset);
        let (family, hosts) = self.family(start);
        self.places(&family, hosts.into_iter().chain(host))
    }

    pub(crate) fn places<'h>(&self, family: &HashSet<Named>, hosts: impl Iterator<Item = &'h HostName>) -> Vec<Found> {
        let mut all = Vec::new();
        for (index, meaning) in family {
            let unit = &self.units()[*index];
            for o in unit.occurrences().iter().filter(|o| o.meaning == *meaning) {
                if let Some((file, span)) = unit.place(o.span) {
                    all.push(Found { place: Place { file, span }, declares: o.declares, writes: o.writes });
                }
            }
        }
        all.extend(hosts.map(|h| Found {
            place: Place { file: h.file.clone(), span: h.span },
            declares: false,
            writes: false,
        }));
        all.sort_by(|a, b| {
            let key = |f: &Found| (f.place.span, !f.declares);
            a.place.file.name().cmp(b.place.file.name()).then_with(|| key(a).cmp(&key(b)))
        });
        all.dedup_by(|b, a| a.place.span == b.place.span && a.place.file.name() == b.place.file.name());
        all
    }

    /// Where what stands at a place is declared.
    pub fn definition(&self, name: &str, offset: usize) -> Vec<Place> {
        let all = self.found_at(name, offset);
        let declared: Vec<Place> = all.into_iter().filter(|f| f.declares).map(|f| f.place).collect();
        if !declared.is_empty() {
            return declared;
        }
        self.macro_at(name, offset).into_iter().chain(self.include_at(name, offset)).collect()
    }

    /// The `#define` of the macro that is used at a place.
    fn macro_at(&self, name: &str, offset: usize) -> Option<Place> {
        self.units_of(name).into_iter().find_map(|unit: &Arc<Unit>| {
            let at = |span: Span| unit.place_in(name, span).is_some_and(|s| s.start <= offset && offset <= s.end);
            let token = unit.shader.tokens().iter().find(|t| at(t.span))?;
            let (file, span) = unit.place(unit.file().expansion(token.span)?.definition?)?;
            Some(Place { file, span })
        })
    }

    /// The file that an `#include` at a place names.
    fn include_at(&self, name: &str, offset: usize) -> Option<Place> {
        let file = self.file(name)?;
        let line = file.line_text(file.position(offset).line).trim_start();
        let path = line.strip_prefix('#')?.trim_start().strip_prefix("include")?.trim();
        let path = path.trim_matches(['"', '<', '>']);
        let ends = format!("/{}", path.rsplit('/').next()?);
        let unit = self.units_of(name).into_iter().next()?.clone();
        let target = unit.files.iter().find(|f| f.ends_with(&ends))?;
        Some(Place { file: self.file(target)?.clone(), span: Span::at(0) })
    }

    /// All places of what stands at a place; declarations where they are asked for.
    pub fn references(&self, name: &str, offset: usize, declarations: bool) -> Vec<Place> {
        let wanted = |f: &Found| declarations || !f.declares;
        self.found_at(name, offset).into_iter().filter(wanted).map(|f| f.place).collect()
    }

    /// The places in the same file, with what happens there.
    pub fn highlights(&self, name: &str, offset: usize) -> Vec<DocumentHighlight> {
        let own = self.found_at(name, offset).into_iter().filter(|f| f.place.file.name() == name);
        let highlight = |f: Found| {
            let kind = if f.writes { DocumentHighlightKind::WRITE } else { DocumentHighlightKind::READ };
            DocumentHighlight { range: self.encoding.range(&f.place.file, f.place.span), kind: Some(kind) }
        };
        own.map(highlight).collect()
    }

    /// A place in the types of the protocol; `uri` names files there.
    pub fn location(&self, place: &Place, uri: impl Fn(&str) -> Option<ls_types::Uri>) -> Option<Location> {
        Some(Location { uri: uri(place.file.name())?, range: self.encoding.range(&place.file, place.span) })
    }
}
