//! Races and bounds of a kernel for all sizes: of two invocations that nothing is known of but that they differ, whether
//! they may touch one place with no barrier between, and of one, whether an index may leave its array.
//!
//! ```text
//! Executable ─ walk ─▶ accesses: index, conditions, last barriers ─ pairs ─▶ systems ─ number::linear ─▶ Proof
//! ```
//!
//! An index that is a sum of numbers of the invocation, of the host and of rounds of loops is known exactly, as are
//! quotients by constants. Everything else is a number of which only its range is known, so that what is said to hold
//! holds for every value of it. Nothing here is a fault: what is not verified is not decided.

mod accesses;
mod formula;
mod lengths;
mod pairs;
mod phases;
mod rounds;
#[cfg(test)]
mod tests;
mod values;
mod variables;
mod walk;
mod words;

use std::collections::{BTreeMap, BTreeSet};

use number::linear::{Polynomial, Unknown};

use super::code::Executable;
use super::domain::Site;
use super::group::{Extent, Space};
use accesses::{Seen, SeenStep, Touched};
use pairs::conflicts;
use variables::{Meaning, Why};
use walk::{Assumed, Walk};

/// Steps of the solver for a kernel.
const BUDGET: u64 = 12_000_000;

/// Accesses to one memory, each in one phase, of which pairs are looked at.
const MOST_ACCESSES: usize = 160;

/// Barriers of which each is left out for once.
const MOST_BARRIERS: usize = 6;

/// What is proved of a kernel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Proof {
    /// Of each memory that the kernel touches, in their order.
    pub memories: Vec<MemoryProof>,
    /// Axes along which one workgroup is dispatched, for the kernel does not ask for more.
    pub single: Vec<usize>,
    /// What is assumed of the numbers in indices, in words.
    pub assumptions: Vec<String>,
    /// Barriers without which the same is proved.
    pub idle: Vec<Site>,
}

/// What is proved of a memory.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MemoryProof {
    /// Its number.
    pub memory: u32,
    /// No two invocations get in each other's way.
    pub races: Result<(), Undecided>,
    /// Every index lies in its array where these conditions on its length hold, in words.
    pub bounds: Result<Vec<String>, Undecided>,
}

impl MemoryProof {
    /// True where all is verified.
    pub fn is_verified(&self) -> bool {
        self.races.is_ok() && self.bounds.is_ok()
    }
}

/// Why something is not decided.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Undecided {
    /// The reason.
    pub why: String,
    /// Where it stands.
    pub site: Option<Site>,
    /// Numbers of a host with which it may go wrong, where some were found.
    pub numbers: Option<HostNumbers>,
}

/// Numbers of a host.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct HostNumbers {
    /// Workgroups along each axis.
    pub groups: [u32; 3],
    /// Words of memories: the memory, the word, its value.
    pub words: Vec<(u32, u32, u32)>,
    /// Elements of arrays, by memory.
    pub lengths: Vec<(u32, u32)>,
}

impl Executable {
    /// Proves what it can of a kernel with workgroups of this size.
    pub fn prove(&self, size: [u32; 3]) -> Proof {
        let axes = std::array::from_fn(|axis| self.reads_global(axis) || self.named_groups()[axis] > 1);
        let mut budget = BUDGET;
        let mut judge = Judge::new(self, size, axes, Vec::new());
        let memories = judge.memories(&mut budget);
        let mut idle = Vec::new();
        // A function that is called in several places has its barriers in each of them.
        let mut barriers: BTreeMap<Option<(usize, usize)>, Vec<Site>> = BTreeMap::new();
        for site in std::mem::take(&mut judge.walk.barriers) {
            let span = self.place(site).span.to_range().map(|span| (span.start, span.end));
            barriers.entry(span).or_default().push(site);
        }
        if memories.iter().all(|own| own.races.is_ok()) && barriers.len() <= MOST_BARRIERS {
            for (span, sites) in barriers {
                let mut without = Judge::new(self, size, axes, sites.clone());
                if span.is_some() && without.memories_in_order(&mut budget) {
                    idle.extend(sites.first());
                }
            }
        }
        let assumptions = judge.walk.assumed.iter().map(|own| match own {
            Assumed::Fits => "no sum, product or number of the host in an index leaves 32 bits".to_owned(),
            Assumed::Divisor => "no number by which an index is divided is 0".to_owned(),
        });
        let single = (0..3).filter(|axis| !axes[*axis]).collect();
        Proof { memories, single, assumptions: assumptions.collect(), idle }
    }
}

/// A walk through a kernel, and what follows.
struct Judge<'e> {
    walk: Walk<'e>,
    accesses: BTreeMap<u32, Vec<Seen>>,
}

impl<'e> Judge<'e> {
    fn new(executable: &'e Executable, size: [u32; 3], axes: [bool; 3], ignored: Vec<Site>) -> Self {
        let mut walk = Walk::new(executable, size, axes, ignored);
        walk.run();
        let mut accesses: BTreeMap<u32, Vec<Seen>> = BTreeMap::new();
        for seen in std::mem::take(&mut walk.accesses) {
            let own = accesses.entry(seen.memory).or_default();
            if !own.iter().any(|other| is_same(other, &seen)) {
                own.push(seen);
            }
        }
        Self { walk, accesses }
    }

    fn undecided(&self, why: String, site: Option<Site>) -> Undecided {
        Undecided { why, site, numbers: None }
    }

    fn too_much<T>(&self) -> Option<Result<T, Undecided>> {
        let why = "the kernel has more steps, or loops inside of each other, than are followed".to_owned();
        self.walk.exhausted.then(|| Err(self.undecided(why, None)))
    }

    fn memories(&mut self, budget: &mut u64) -> Vec<MemoryProof> {
        let mut all = Vec::new();
        let touched: BTreeSet<u32> = if self.walk.exhausted {
            (0..self.walk.executable.memories.len() as u32).collect()
        } else {
            self.accesses.keys().copied().collect()
        };
        for memory in touched {
            let space = self.walk.executable.memories[memory as usize].space;
            let indexed = self.accesses.get(&memory).is_some_and(|own| own.iter().any(|seen| !seen.steps.is_empty()));
            if space == Space::Uniform && !indexed {
                continue;
            }
            let races = self.too_much().unwrap_or_else(|| self.races(memory, budget));
            let bounds = self.too_much().unwrap_or_else(|| self.bounds(memory, budget));
            all.push(MemoryProof { memory, races, bounds });
        }
        all
    }

    /// True where no memory has a race.
    fn memories_in_order(&mut self, budget: &mut u64) -> bool {
        let memories: Vec<u32> = self.accesses.keys().copied().collect();
        let alone = |memory: u32| {
            // Whether a count is over, a barrier decides, though nothing races.
            let own = self.accesses.get(&memory).map_or(&[][..], |own| own);
            let has = |touched: Touched| own.iter().any(|seen| seen.touched == touched);
            !(has(Touched::Update) && has(Touched::AtomicRead))
        };
        !self.walk.exhausted
            && memories.iter().all(|memory| alone(*memory))
            && memories.into_iter().all(|memory| self.races(memory, budget).is_ok())
    }

    fn races(&mut self, memory: u32, budget: &mut u64) -> Result<(), Undecided> {
        let all = self.accesses.get(&memory).cloned().unwrap_or_default();
        if all.iter().all(|seen| matches!(seen.touched, Touched::Read | Touched::AtomicRead)) {
            return Ok(());
        }
        if all.len() > MOST_ACCESSES {
            let why = format!("it is touched in {} ways, of which {MOST_ACCESSES} are compared", all.len());
            return Err(self.undecided(why, None));
        }
        if let Some(site) = self.walk.divergent.filter(|_| !self.walk.is_shared(memory)) {
            let why = "not all invocations of a workgroup may get to the barrier there".to_owned();
            return Err(self.undecided(why, Some(site)));
        }
        for (k, a) in all.iter().enumerate() {
            for b in all[k..].iter().filter(|b| conflicts(a.touched, b.touched)) {
                for within in [true, false] {
                    if !within && !self.walk.is_shared(memory) {
                        continue;
                    }
                    if *budget == 0 {
                        return Err(self.undecided("the limit of steps was met".to_owned(), Some(a.site)));
                    }
                    if let Some(met) = self.walk.meets(a, b, within, budget) {
                        return Err(self.told_race(a, b, within, met.numbers));
                    }
                }
            }
        }
        Ok(())
    }

    fn told_race(
        &self,
        a: &Seen,
        b: &Seen,
        within: bool,
        numbers: Option<std::collections::HashMap<Meaning, i128>>,
    ) -> Undecided {
        let whom = if within { "two invocations of a workgroup" } else { "invocations of two workgroups" };
        // The index that nothing is known of says more than that two may be equal.
        let open = |seen: &Seen| seen.steps.iter().find_map(|step| self.walk.variables.open(&step.index));
        let because = open(a).or_else(|| open(b));
        let numbers = numbers.map(|own| host_numbers(&own));
        let (why, site) = match because {
            Some((why, site)) => (self.reason(why), site.or(Some(a.site))),
            None if numbers.is_some() => {
                (format!("the indices of {whom} may be equal, with no barrier between"), Some(a.site))
            }
            None => (format!("it is not shown that the indices of {whom} differ"), Some(a.site)),
        };
        Undecided { why, site, numbers }
    }

    /// Why nothing is known of an index.
    fn reason(&self, why: Why) -> String {
        let name = |memory: u32| self.walk.executable.memories[memory as usize].name.clone();
        match why {
            Why::Data(memory) => format!("an index depends on what `{}` holds", name(memory)),
            Why::Atomic(memory) => format!("an index comes from an atomic function on `{}`", name(memory)),
            Why::Real => "an index comes of real numbers".to_owned(),
            Why::Loop => "an index changes from round to round of a loop, not by the same number each time".to_owned(),
            Why::Operation => "an index comes of an operation that is not linear".to_owned(),
            Why::Subgroup => "an index depends on the subgroup".to_owned(),
            Why::Element => "an index is read from an array or a texture of which nothing is known".to_owned(),
        }
    }

    fn bounds(&mut self, memory: u32, budget: &mut u64) -> Result<Vec<String>, Undecided> {
        let all = self.accesses.get(&memory).cloned().unwrap_or_default();
        let mut needed: BTreeSet<(Option<usize>, Polynomial)> = BTreeSet::new();
        let mut counts: BTreeSet<Unknown> = BTreeSet::new();
        for seen in &all {
            for step in &seen.steps {
                if *budget == 0 {
                    return Err(self.undecided("the limit of steps was met".to_owned(), Some(step.site)));
                }
                let found = match self.bound(seen, step, budget) {
                    Ok(found) => found,
                    Err(otherwise) => {
                        // Of nothing, there is no last one: a host that has at least one of each is likely.
                        let (own, hosts) = self.walk.with_counts(seen, step);
                        let again = if hosts.is_empty() { None } else { self.bound(&own, step, budget).ok() };
                        match again {
                            Some(found) => {
                                counts.extend(hosts);
                                found
                            }
                            None => return Err(self.told_bound(step, otherwise)),
                        }
                    }
                };
                let axis = match step.len {
                    Extent::Side(axis) => Some(axis),
                    _ => None,
                };
                needed.extend(found.map(|length| (axis, length)));
            }
        }
        // Of lengths that are numbers, the largest says it all.
        let most = |axis: Option<usize>| {
            let own = needed.iter().filter(|(other, _)| *other == axis);
            own.filter_map(|(_, length)| length.as_constant()).max()
        };
        let told =
            needed.iter().filter(|(axis, length)| length.as_constant().is_none_or(|own| Some(own) == most(*axis)));
        let counts = counts.iter().map(|unknown| format!("{} is at least 1", self.name(*unknown)));
        Ok(told.map(|(axis, length)| self.condition(memory, *axis, length)).chain(counts).collect())
    }

    /// The length below which an index stays, where that is not the one that its array has; or why there is none.
    fn bound(&mut self, seen: &Seen, step: &SeenStep, budget: &mut u64) -> Result<Option<Polynomial>, &'static str> {
        if !self.walk.is_positive(seen, &step.index, budget) {
            return Err("it is not shown that an index is never below 0");
        }
        let len = self.walk.extent(seen.memory, step.len);
        if self.walk.is_below(seen, &step.index, &len, budget) {
            return Ok(None);
        }
        if Walk::is_fixed(step.len) {
            return Err("it is not shown that an index stays within its array");
        }
        self.walk.length_for(seen, step, budget).map(Some).ok_or("nothing says up to where an index goes")
    }

    fn told_bound(&self, step: &SeenStep, otherwise: &str) -> Undecided {
        let (why, site) = match self.walk.variables.open(&step.index) {
            Some((why, site)) => (self.reason(why), site),
            None => (otherwise.to_owned(), None),
        };
        self.undecided(why, site.or(Some(step.site)))
    }

    /// A condition on the length of an array, or on the texels of an image along an axis.
    fn condition(&self, memory: u32, axis: Option<usize>, length: &Polynomial) -> String {
        let name = &self.walk.executable.memories[memory as usize].name;
        let length = self.words(length);
        match axis {
            None => format!("the length of `{name}` is at least {length}"),
            Some(axis) => format!("the size of `{name}` along {} is at least {length}", ["x", "y", "z"][axis]),
        }
    }

    /// A polynomial in numbers of the host, in words.
    fn words(&self, of: &Polynomial) -> String {
        let mut text = String::new();
        // Products come before the number.
        let mut terms: Vec<_> = of.terms().collect();
        terms.sort_by_key(|(product, count)| (*count < 0, std::cmp::Reverse(product.len())));
        for (product, count) in terms {
            let mut factors: Vec<String> = product.iter().map(|unknown| self.name(*unknown)).collect();
            if count.abs() != 1 || product.is_empty() {
                factors.insert(0, count.abs().to_string());
            }
            let sign = match (text.is_empty(), count < 0) {
                (true, false) => "",
                (true, true) => "-",
                (false, false) => " + ",
                (false, true) => " - ",
            };
            text = format!("{text}{sign}{}", factors.join(" × "));
        }
        text
    }

    fn name(&self, unknown: Unknown) -> String {
        let memories = &self.walk.executable.memories;
        match self.walk.variables.get(unknown).meaning {
            Meaning::Groups(axis) => format!("workgroups along {}", ["x", "y", "z"][axis]),
            Meaning::Host(memory, word) => format!("`{}`", memories[memory as usize].place(word)),
            Meaning::Length(memory) => format!("the length of `{}`", memories[memory as usize].name),
            Meaning::Side(memory, axis) => {
                format!("the size of `{}` along {}", memories[memory as usize].name, ["x", "y", "z"][axis])
            }
            _ => match self.walk.variables.made_of(unknown) {
                Some(("/", [a, b])) => format!("({}) / ({})", self.words(a), self.words(b)),
                Some((what, [a, b])) => format!("{what}({}, {})", self.words(a), self.words(b)),
                _ => "a number".to_owned(),
            },
        }
    }
}

/// True for accesses of which one says all that the other one does.
fn is_same(a: &Seen, b: &Seen) -> bool {
    (a.site, a.touched, a.offset) == (b.site, b.touched, b.offset)
        && a.words == b.words
        && a.steps == b.steps
        && a.lasts == b.lasts
        && a.path == b.path
}

fn host_numbers(all: &std::collections::HashMap<Meaning, i128>) -> HostNumbers {
    let mut found = HostNumbers { groups: [1; 3], ..HostNumbers::default() };
    let word = |value: i128| value.rem_euclid(1 << 32) as u32;
    for (meaning, value) in all {
        match *meaning {
            Meaning::Groups(axis) => found.groups[axis] = word(*value),
            Meaning::Host(memory, at) => found.words.push((memory, at, word(*value))),
            Meaning::Length(memory) => found.lengths.push((memory, word(*value))),
            _ => {}
        }
    }
    found.words.sort_unstable();
    found.lengths.sort_unstable();
    found
}
