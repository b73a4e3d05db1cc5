//! Accesses to shared memory since the last barrier, and which of them meet in one element.

use std::collections::{BTreeMap, HashMap};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::rc::Rc;

use base::text::Span;
use syntax::symbols::SymbolId;
use syntax::types::{ArraySize, Type};

use super::value::{Number, Term, Terms};
use super::walk::Walk;

/// What an access does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Kind {
    /// An ordinary read.
    Read,
    /// An ordinary write.
    Write,
    /// An atomic operation that reads only.
    AtomicLoad,
    /// An atomic operation that writes whatever was there.
    AtomicStore,
    /// An atomic operation whose result depends on what was there.
    AtomicUpdate,
}

/// A step on the way from a variable to the part that is meant.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Step {
    /// An element.
    Index(Number),
    /// A member, or components.
    Member(String),
}

/// Invocations that touch a part of shared memory.
#[derive(Clone, Debug)]
pub struct Access {
    /// The variable.
    pub symbol: SymbolId,
    /// The way to the part.
    pub path: Vec<Step>,
    /// What they do.
    pub kind: Kind,
    /// Which invocations do it, or may do it.
    pub lanes: Rc<[bool]>,
    /// What was decided on the way there.
    pub atoms: Vec<(Term, bool)>,
    /// Where it is written.
    pub span: Span,
}

/// Accesses since the last barrier.
#[derive(Clone, Debug, Default)]
pub struct Pending {
    all: BTreeMap<u64, Rc<Access>>,
}

/// Two accesses that no barrier parts.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Race {
    /// The variable.
    pub symbol: SymbolId,
    /// The access that comes later.
    pub later: Span,
    /// The one before.
    pub earlier: Span,
    /// What the later one does.
    pub kind: Kind,
    /// What the one before does.
    pub before: Kind,
    /// An invocation of the earlier and one of the later access that meet, where the indices are known.
    pub witness: Option<(usize, usize)>,
}

/// An access past the end of an array.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Beyond {
    /// The variable.
    pub symbol: SymbolId,
    /// Where it is written.
    pub span: Span,
    /// Number of an invocation in its group, and the index that it has.
    pub invocation: usize,
    /// Its index.
    pub index: i64,
    /// Elements of the array.
    pub elements: u32,
}

impl Walk<'_> {
    /// Looks for an invocation that comes to an access for certain and has an index past the end of an array.
    pub(super) fn note_beyond(&mut self, symbol: SymbolId, path: &[Step], span: Span) {
        if self.conditional > 0 {
            return;
        }
        let mut ty = self.shader.symbol(symbol).ty.clone();
        for step in path {
            ty = match (step, ty) {
                (Step::Index(number), Type::Array(element, size)) => {
                    let here = (0..self.lanes).filter(|lane| self.state.active[*lane] == 1);
                    let mut all = here.map(|lane| (lane, number.lane(lane)));
                    if let ArraySize::Known(elements) = size
                        && number.is_known()
                        && let Some((invocation, index)) = all.find(|(_, at)| *at < 0 || *at >= i64::from(elements))
                    {
                        self.beyond.entry(span).or_insert(Beyond { symbol, span, invocation, index, elements });
                        return;
                    }
                    element.as_ref().clone()
                }
                (Step::Member(name), Type::Struct(of)) => match of.fields.iter().find(|f| f.name == *name) {
                    Some(field) => field.ty.clone(),
                    None => return,
                },
                _ => return,
            };
        }
    }
}

impl Pending {
    /// Past a barrier.
    pub fn clear(&mut self) {
        self.all.clear();
    }

    /// With those of another way.
    pub fn join(&mut self, other: &Self) {
        self.all.extend(other.all.iter().map(|(k, v)| (*k, Rc::clone(v))));
    }

    /// Without those that happened under the opposite of what is decided here.
    pub fn assume(&mut self, atoms: &[(Term, bool)]) {
        self.all.retain(|_, access| !contradicts(&access.atoms, atoms));
    }

    /// Adds an access, and returns those before it that it meets.
    pub fn add(&mut self, access: Access, terms: &Terms) -> Vec<Race> {
        let races = self.all.values().filter_map(|before| race(before, &access, terms)).collect();
        let mut hasher = DefaultHasher::new();
        (access.symbol, &access.path, access.kind, &access.lanes, &access.atoms).hash(&mut hasher);
        (access.span.start, access.span.end).hash(&mut hasher);
        self.all.insert(hasher.finish(), Rc::new(access));
        races
    }
}

fn contradicts(a: &[(Term, bool)], b: &[(Term, bool)]) -> bool {
    a.iter().any(|(term, truth)| b.contains(&(*term, !*truth)))
}

/// Which of the two reads, where two accesses need a barrier between them: false for the one before.
fn reader(before: Kind, after: Kind) -> Option<bool> {
    match (before, after) {
        (Kind::Write, Kind::Read)
        | (Kind::AtomicUpdate, Kind::Read)
        | (Kind::Write | Kind::AtomicStore, Kind::AtomicUpdate) => Some(true),
        (Kind::Read, Kind::Write) => Some(false),
        _ => None,
    }
}

fn race(before: &Access, after: &Access, terms: &Terms) -> Option<Race> {
    if before.symbol != after.symbol || contradicts(&before.atoms, &after.atoms) {
        return None;
    }
    let later_reads = reader(before.kind, after.kind)?;
    let mut indices = Vec::new();
    let mut open = false;
    for pair in before.path.iter().zip(&after.path) {
        match pair {
            (Step::Member(a), Step::Member(b)) if a == b => {}
            (Step::Index(a), Step::Index(b)) => {
                let comparable = a.terms == b.terms && a.terms.iter().all(|t| terms.origin(t.0).uniform);
                match comparable {
                    true => indices.push((a, b)),
                    // An index that varies in a way that is not known may be the invocation's own.
                    false if a.terms == b.terms => return None,
                    false => {
                        let (known, unknown) = if later_reads { (a, b) } else { (b, a) };
                        let origin = terms.origin_of(unknown);
                        // Invocations that begin more than one element apart have a part of the array each.
                        let apart = |lane: usize| lane == 0 || known.lane(lane).abs_diff(known.lane(lane - 1)) > 1;
                        let between = |lane: usize| unknown.lane(lane).wrapping_sub(known.lane(lane));
                        let parts = (0..before.lanes.len()).all(|lane| between(lane) == between(0) && apart(lane));
                        open = known.is_known() && known.single().is_none() && origin.data && !origin.uniform && !parts;
                        if !open {
                            return None;
                        }
                    }
                }
            }
            _ => return None,
        }
    }
    let race = Race {
        symbol: before.symbol,
        later: after.span,
        earlier: before.span,
        kind: after.kind,
        before: before.kind,
        witness: None,
    };
    // Two invocations take two lanes.
    let others = |lane: usize| (0..after.lanes.len()).any(|other| other != lane && after.lanes[other]);
    if !(0..before.lanes.len()).any(|lane| before.lanes[lane] && others(lane)) {
        return None;
    }
    if open {
        return Some(race);
    }
    let (writes, reads) = if later_reads { (before, after) } else { (after, before) };
    let at = |lane: usize, writes: bool| -> Vec<i64> {
        indices.iter().map(|(a, b)| if writes == later_reads { a.lane(lane) } else { b.lane(lane) }).collect()
    };
    let mut writers: HashMap<Vec<i64>, Vec<usize>> = HashMap::new();
    for lane in (0..writes.lanes.len()).filter(|l| writes.lanes[*l]) {
        writers.entry(at(lane, true)).or_default().push(lane);
    }
    for lane in (0..reads.lanes.len()).filter(|l| reads.lanes[*l]) {
        let place = at(lane, false);
        if let Some(writers) = writers.get(&place)
            // Who writes the element as well knows what is there: all write the same, or the kernel has another fault.
            && !writers.contains(&lane)
            && let Some(writer) = writers.first()
        {
            let witness = if later_reads { (*writer, lane) } else { (lane, *writer) };
            return Some(Race { witness: Some(witness), ..race });
        }
    }
    None
}
