//! What memory holds, and who touched each word of it.

use std::collections::HashMap;

use naga::Barrier;

use super::super::domain::Site;
use super::access::Extent;
use super::cells::{InMemory, RealCombine};
use super::epochs::Epochs;
use super::shape::{MemoryShape, Space};
use super::{Buffer, Left};

/// Something that is wrong with how invocations use memory or wait for each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Wrong {
    /// An index that leads out of its array.
    Outside,
    /// Two invocations touch one word, one of them writes, and nothing comes between.
    Race,
    /// The same with writes of equal values alone.
    SameValue,
    /// Two invocations touch one word, one of them writes, and the barrier between them orders other memories alone.
    Unordered,
    /// Two invocations load a word by atomic functions and store there what may come of it: one undoes what the other did.
    LostUpdate,
    /// A workgroup touches what another one wrote before an atomic function, and the barrier is missing that orders that write
    /// before it.
    Relaxed,
    /// A barrier that some invocations of the workgroup do not reach.
    Divergence,
    /// An operation of a subgroup that some of its invocations do not reach.
    Apart,
    /// A word of a workgroup's memory that nobody has written.
    Unwritten,
    /// A store of a NaN into a buffer.
    NotANumber,
}

/// How a word was touched.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Access {
    /// Read.
    Read,
    /// Written.
    Write,
    /// Read or written by an atomic function.
    Atomic,
}

/// What an access leaves of the word before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Effect {
    /// All of it, or what does not depend on an order: a load, a store of what is there, an exchange that tells what was.
    Kept,
    /// What an atomic function made of it.
    Updated,
    /// Nothing: a store.
    Replaced,
}

/// One of two invocations that meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Party {
    /// Number of its workgroup, counted along x first.
    pub group: u32,
    /// Number of the invocation in it, counted along x first.
    pub local: u32,
    /// Whether it loaded, stored, or used an atomic function.
    pub access: Access,
    /// The instruction in the program.
    pub site: Site,
}

/// A place at which something is wrong, with the first time that it was.
#[derive(Clone, Debug, PartialEq)]
pub struct Incident {
    /// Kind of the fault.
    pub what: Wrong,
    /// The memory; of a barrier, none.
    pub memory: Option<u32>,
    /// The word of the memory, counted from its beginning.
    pub word: Option<u32>,
    /// For an index, its value and the number of elements.
    pub index: Option<(u32, u32)>,
    /// Who came upon it; of a barrier, one that does not reach it.
    pub who: Party,
    /// The other one that touched the same word; of a barrier, one that reaches it.
    pub other: Option<Party>,
    /// Number of times that it happened.
    pub count: u64,
}

impl Incident {
    /// True for the same fault of the same places, whoever came upon it.
    pub fn is_same(&self, other: &Self) -> bool {
        let theirs = |incident: &Self| incident.other.map(|party| party.site);
        self.what == other.what
            && self.memory == other.memory
            && (self.who.site, self.who.access) == (other.who.site, other.who.access)
            && theirs(self) == theirs(other)
    }

    /// True for an index that is negative as a signed number: it is outside of an array of any length.
    pub fn is_in_front(&self) -> bool {
        self.index.is_some_and(|(index, _)| index.cast_signed() < 0)
    }
}

/// How many barriers an invocation is behind.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) struct Epoch {
    /// Barriers of its workgroup.
    pub barriers: u32,
    /// Number of its subgroup.
    pub subgroup: u32,
    /// Barriers of its subgroup.
    pub within: u32,
}

impl Epoch {
    /// True when a barrier of their subgroup comes between two invocations.
    fn is_within_subgroup(self, other: Self) -> bool {
        self.subgroup == other.subgroup && self.within != other.within
    }
}

/// Who touched a word last.
#[derive(Clone, Copy)]
struct Touched {
    party: Party,
    effect: Effect,
    epoch: Epoch,
    /// Number of the access in the dispatch.
    time: u64,
}

/// Who touched a word since it was last written.
#[derive(Clone, Copy, Default)]
struct History {
    write: Option<Touched>,
    /// The last that read it, and the last before that is another invocation.
    reads: [Option<Touched>; 2],
}

pub(super) struct Contents<D: InMemory> {
    pub space: Space,
    /// Words as bits.
    bits: Vec<u32>,
    /// The same as numbers of the domain; empty until one is written, for buffers may be large.
    reals: Vec<D::Cell>,
    /// Words that somebody has written; empty where all are.
    written: Vec<bool>,
    /// Who touched each word; empty where nobody asks.
    history: Vec<History>,
    /// Words of which nothing is known, for a decision before them could have gone the other way; empty where there are none.
    open: Vec<bool>,
    /// Words that atomic functions on real numbers added to since they were last stored.
    sums: HashMap<usize, D::Sum>,
    /// Elements of the array at its end.
    elements: u32,
    /// Texels of an image along each axis.
    sides: [u32; 3],
    /// True for an image: what is outside of it reads as 0.
    pub is_image: bool,
    /// Words up to the last one that was touched.
    pub reach: usize,
    /// Whether anything was stored.
    pub is_changed: bool,
}

impl<D: InMemory> Contents<D> {
    pub(super) fn new(shape: &MemoryShape, buffer: Buffer, written: bool, watched: bool) -> Self {
        let Buffer { words, elements, sides } = buffer;
        let len = words.len();
        Self {
            space: shape.space,
            reals: Vec::new(),
            bits: words,
            written: vec![false; if written { 0 } else { len }],
            history: vec![History::default(); if watched { len } else { 0 }],
            open: Vec::new(),
            sums: HashMap::new(),
            elements,
            sides,
            is_image: shape.is_image(),
            reach: 0,
            is_changed: false,
        }
    }

    /// Which barriers order it.
    fn ordered_by(&self) -> Barrier {
        match self.space {
            Space::Workgroup => Barrier::WORK_GROUP,
            Space::Storage { .. } | Space::Uniform if self.is_image => Barrier::TEXTURE,
            Space::Storage { .. } | Space::Uniform => Barrier::STORAGE,
        }
    }

    /// How many elements there are, or texels along an axis.
    pub(super) fn extent(&self, extent: Extent) -> u32 {
        match extent {
            Extent::Fixed(len) => len,
            Extent::Elements => self.elements,
            Extent::Side(axis) => self.sides[axis],
        }
    }

    /// Elements from one to the next in an index: along each axis of an image, those of all axes before.
    pub(super) fn row(&self, extent: Extent) -> u64 {
        match extent {
            Extent::Fixed(_) | Extent::Elements => 1,
            Extent::Side(axis) => self.sides[..axis].iter().map(|&side| u64::from(side)).product(),
        }
    }

    pub(super) fn len(&self) -> usize {
        self.bits.len()
    }

    /// Whether it is remembered who touched its words.
    pub(super) fn is_watched(&self) -> bool {
        !self.history.is_empty()
    }

    pub(super) fn bits(&self, word: usize) -> u32 {
        self.bits[word]
    }

    pub(super) fn real(&self, word: usize) -> D::Cell {
        self.reals.get(word).copied().unwrap_or_else(|| D::cell(self.bits[word]))
    }

    pub(super) fn is_written(&self, word: usize) -> bool {
        self.written.get(word).is_none_or(|&written| written)
    }

    pub(super) fn is_open(&self, word: usize) -> bool {
        self.open.get(word).is_some_and(|&open| open)
    }

    pub(super) fn set_bits(&mut self, word: usize, bits: u32, open: bool) {
        self.stored(word);
        self.bits[word] = bits;
        if let Some(real) = self.reals.get_mut(word) {
            *real = D::cell(bits);
        }
        self.mark(word, open);
    }

    /// A word was written.
    fn mark(&mut self, word: usize, open: bool) {
        if let Some(written) = self.written.get_mut(word) {
            *written = true;
        }
        if open && self.open.is_empty() {
            self.open = vec![false; self.bits.len()];
        }
        if let Some(known) = self.open.get_mut(word) {
            *known = open;
        }
    }

    pub(super) fn set_real(&mut self, word: usize, value: D::Cell, open: bool) {
        self.stored(word);
        self.hold(word, value, open);
    }

    fn hold(&mut self, word: usize, value: D::Cell, open: bool) {
        if self.reals.is_empty() {
            self.reals = self.bits.iter().map(|&bits| D::cell(bits)).collect();
        }
        self.bits[word] = D::bits(value);
        self.reals[word] = value;
        self.mark(word, open);
    }

    /// A sum begins anew.
    fn stored(&mut self, word: usize) {
        if !self.sums.is_empty() {
            self.sums.remove(&word);
        }
    }

    /// An atomic function on real numbers.
    pub(super) fn combine(&mut self, domain: &D, op: RealCombine, (word, value): (usize, D::Cell), open: bool) {
        let old = self.real(word);
        let new = match op {
            RealCombine::Add | RealCombine::Subtract => {
                domain.combined(op, old, value, self.sums.entry(word).or_default())
            }
            RealCombine::Min | RealCombine::Max | RealCombine::Exchange => {
                self.stored(word);
                domain.combined(op, old, value, &mut D::Sum::default())
            }
        };
        self.hold(word, new, open);
    }

    /// What an atomic function reads of a word.
    pub(super) fn passing(&self, word: usize) -> D::Cell {
        if self.sums.contains_key(&word) { D::passing(self.real(word)) } else { self.real(word) }
    }

    /// Nothing is known of any word from now on.
    pub(super) fn open_all(&mut self) {
        self.open = vec![true; self.bits.len()];
    }

    /// What is left: bits, and what the domain knows of them.
    pub(super) fn into_parts(self) -> (Vec<u32>, Left<D::Cell>) {
        (self.bits, Left { cells: self.reals, open: self.open })
    }
}

/// A memory, and a word of it counted from its beginning.
pub(super) type Word = (u32, usize);

/// What invocations did to each other in one dispatch.
#[derive(Default)]
pub(super) struct Log {
    /// Accesses so far.
    time: u64,
    /// For each workgroup, when it last used an atomic function on memory that other workgroups see.
    atomics: HashMap<u32, u64>,
    /// For each workgroup, when it last came to a barrier or a fence that orders buffers or images.
    fences: HashMap<u32, u64>,
    /// When an invocation last looked at a word by an atomic load; by memory and word, then workgroup and invocation.
    looks: HashMap<(Word, (u32, u32)), u64>,
    /// Who stored a word last by an atomic function, when, and whether it had looked at it before.
    stores: HashMap<Word, (Party, u64, bool)>,
    incidents: Vec<Incident>,
}

impl Log {
    pub(super) fn report(&mut self, incident: Incident) {
        match self.incidents.iter_mut().find(|own| own.is_same(&incident)) {
            Some(own) => own.count += incident.count,
            None => self.incidents.push(incident),
        }
    }

    /// A workgroup came to a barrier or a fence.
    pub(super) fn fenced(&mut self, group: u32, orders: Barrier) {
        if orders.intersects(Barrier::STORAGE | Barrier::TEXTURE) {
            self.fences.insert(group, self.time);
        }
    }

    /// An invocation looks at a word by an atomic load.
    pub(super) fn looked(&mut self, word: Word, who: (u32, u32)) {
        self.looks.insert((word, who), self.time);
    }

    /// An atomic store. In the interleaving at hand, another invocation stored since this one looked; between workgroups,
    /// which run one after the other, it could have in a memory that they share. Whether the stored value comes of what was
    /// seen, the text says.
    pub(super) fn stored(&mut self, word: Word, who: Party, space: Space) {
        let look = self.looks.remove(&(word, (who.group, who.local)));
        let before = self.stores.insert(word, (who, self.time, look.is_some()));
        let (Some(look), Some((other, time, looked))) = (look, before) else { return };
        let another = (other.group, other.local) != (who.group, who.local);
        let apart = other.group != who.group;
        if another && (time >= look || (apart && looked)) && !(apart && space == Space::Workgroup) {
            self.report(Incident {
                what: Wrong::LostUpdate,
                memory: Some(word.0),
                word: u32::try_from(word.1).ok(),
                index: None,
                who,
                other: Some(other),
                count: 1,
            });
        }
    }

    pub(super) fn into_incidents(self) -> Vec<Incident> {
        self.incidents
    }

    /// Notes an access, and whether it meets another one. Atomic functions may come in any order; an atomic store undoes those
    /// that came before it.
    pub(super) fn touch<D: InMemory>(
        &mut self,
        memory: (u32, &mut Contents<D>),
        word: usize,
        party: Party,
        (epochs, epoch): (&Epochs, Epoch),
        effect: Effect,
    ) {
        let (index, contents) = memory;
        contents.reach = contents.reach.max(word + 1);
        contents.is_changed |= party.access != Access::Read;
        if !contents.is_watched() {
            return;
        }
        self.time += 1;
        let now = Touched { party, effect, epoch, time: self.time };
        let shared = contents.space != Space::Workgroup;
        if shared && party.access == Access::Atomic {
            self.atomics.insert(party.group, self.time);
        }
        if contents.space == Space::Uniform {
            return;
        }
        let kind = contents.ordered_by();
        let history = &mut contents.history[word];
        let mut relaxed = None;
        let mut meets = |before: &Option<Touched>| {
            before.filter(|before| {
                let undoes = matches!(
                    (before.effect, effect),
                    (Effect::Updated, Effect::Replaced) | (Effect::Replaced, Effect::Updated)
                );
                let both = before.party.access == Access::Atomic && party.access == Access::Atomic && !undoes;
                let same = before.party.group == party.group;
                let own = same && before.party.local == party.local;
                let ordered =
                    same && (epochs.order(before.epoch.barriers, kind) || before.epoch.is_within_subgroup(epoch));
                if own || both || ordered {
                    return false;
                }
                let passed_on = !same && self.is_passed_on(before, party.group);
                let fenced = || self.fences.get(&before.party.group).is_some_and(|&time| time >= before.time);
                if passed_on && before.party.access == Access::Write && party.access == Access::Read && !fenced() {
                    relaxed = Some(before.party);
                }
                !passed_on
            })
        };
        let writes = party.access != Access::Read;
        let mut met = meets(&history.write);
        if writes {
            met = met.or_else(|| history.reads.iter().find_map(&mut meets));
        }
        if let Some(other) = relaxed {
            self.report(Incident {
                what: Wrong::Relaxed,
                memory: Some(index),
                word: u32::try_from(word).ok(),
                index: None,
                who: party,
                other: Some(other),
                count: 1,
            });
        }
        if let Some(before) = met {
            let plain = before.party.access == Access::Write && party.access == Access::Write;
            let apart = before.party.group == party.group && before.epoch.barriers != epoch.barriers;
            let what = match plain && effect == Effect::Kept {
                true => Wrong::SameValue,
                false if apart => Wrong::Unordered,
                false => Wrong::Race,
            };
            let incident = Incident {
                what,
                memory: Some(index),
                word: u32::try_from(word).ok(),
                index: None,
                who: party,
                other: Some(before.party),
                count: 1,
            };
            self.report(incident);
        }
        let history = &mut contents.history[word];
        if writes {
            // Whoever stores and then adds has stored all the same.
            let stored = history.write.filter(|before| {
                (before.effect, effect) == (Effect::Replaced, Effect::Updated)
                    && (before.party.group, before.party.local) == (party.group, party.local)
                    && (before.party.access, before.epoch) == (party.access, epoch)
            });
            *history = History { write: Some(stored.unwrap_or(now)), reads: [None; 2] };
        } else {
            let same = |read: &Touched| (read.party.group, read.party.local) == (party.group, party.local);
            if history.reads[0].as_ref().is_some_and(|read| !same(read)) {
                history.reads[1] = history.reads[0];
            }
            history.reads[0] = Some(now);
        }
    }

    /// Whether a workgroup can know of what another one did before: that one used an atomic function behind it, and
    /// this one did later. Which function passes on what, only its author knows.
    fn is_passed_on(&self, before: &Touched, group: u32) -> bool {
        let after = self.atomics.get(&before.party.group).is_some_and(|&time| time > before.time);
        after && self.atomics.get(&group).is_some_and(|&time| time > before.time)
    }
}
