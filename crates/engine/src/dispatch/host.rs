//! What a host does around a dispatch: how many workgroups, how long the buffers are, what is in them.

use std::sync::Arc;

use program::Written;
use program::interp::group::{
    Bits, Buffer, Dispatch, InMemory, Leaf, MemoryShape, Outcome, Space, Turns, WIDTH, Wrong,
};
use program::interp::{Column, Executable, Number, Plain};

use super::run::is_spread;
use super::setting::{Setting, is_tag, setting};
use super::{Dispatched, images};
use base::value::Scalar;
use property::Stream;

/// Rounds of loops of one invocation, and of a whole dispatch.
const FUEL: u32 = 1 << 14;
const WORK: u64 = 1 << 22;
/// Words of a buffer while its length is sought.
const ROOM: usize = 1 << 16;
/// Numbers of a host that are tried as 0.
const MOST_EMPTIED: usize = 16;
/// How many times more workgroups than elements fill are tried.
const WIDE: u32 = 16;

/// A dispatch with everything that a host gives it.
#[derive(Clone, Debug)]
pub(super) struct Scenario {
    pub groups: [u32; 3],
    /// The stage with textures of the sizes that belong to the dispatch.
    pub executable: Arc<Executable>,
    pub buffers: Vec<Buffer>,
    /// Whole numbers that were chosen for uniforms.
    pub settings: Vec<Chosen>,
    /// Invocations that have no element: they fill up the workgroups.
    pub surplus: u64,
    /// Invocations of a subgroup.
    pub subgroup: u32,
    /// Who comes first.
    pub turns: Turns,
    /// What real numbers buffers hold before.
    pub contents: Contents,
    /// Number of the choices of the host.
    pub variant: u64,
    /// The one of `settings` that is 0 for once.
    pub empty: Option<usize>,
}

/// A whole number that was chosen for a uniform.
#[derive(Clone, Debug)]
pub(super) struct Chosen {
    pub name: String,
    pub value: u32,
    /// The memory in which it lies, and its word there.
    pub place: (u32, u32),
}

/// Real numbers that a host puts into storage buffers; those of uniform buffers are random.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Contents {
    /// Random ones between −1 and 1.
    Signed,
    /// Random ones between 0 and 1.
    Unit,
    /// One number everywhere: positions that coincide, samples without variance.
    Equal,
    /// 0 everywhere, as hosts clear buffers: sums over nothing.
    Zero,
    /// Random ones between −128 and 128: e^x of some is too large for binary32.
    Large,
}

impl Contents {
    /// Those of a variant of the choices of a host.
    fn of(variant: u64) -> Self {
        match variant {
            super::run::EQUAL => Self::Equal,
            super::run::ZERO => Self::Zero,
            super::run::EMPTY => Self::Unit,
            super::run::LARGE => Self::Large,
            n if n.is_multiple_of(2) => Self::Signed,
            _ => Self::Unit,
        }
    }

    /// What buffers hold, as a clause of a report.
    pub(super) fn told(self) -> &'static str {
        match self {
            Self::Signed => "buffers hold random numbers between -1 and 1",
            Self::Unit => "buffers hold random numbers between 0 and 1",
            Self::Equal => "buffers hold 0.5 everywhere",
            Self::Zero => "buffers hold 0 everywhere",
            Self::Large => "buffers hold random numbers between -128 and 128, and binary64 gives a number",
        }
    }
}

/// How the length of an array follows from the elements of a dispatch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Length {
    /// It is as long as this, times a ratio, plus a number.
    Grows { with: Measure, times: (u64, u64), plus: u64 },
    /// Nothing that was tried says how.
    Unknown(u64),
}

/// What a guard in a shader says of the elements of an array.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Guard {
    /// So many for each element of the dispatch.
    Times(u64),
    /// So many, whatever is dispatched.
    Elements(u64),
}

/// A number of a dispatch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Measure {
    /// All elements.
    All,
    /// Elements along one axis.
    Along(usize),
    /// Workgroups.
    Groups,
    /// Workgroups along one axis.
    GroupsAlong(usize),
    /// The number 1, whatever is dispatched.
    One,
}

impl Measure {
    fn of(self, items: [u32; 3], groups: [u32; 3]) -> u64 {
        let product = |all: [u32; 3]| all.iter().map(|&n| u64::from(n)).product();
        match self {
            Self::All => product(items),
            Self::Along(axis) => u64::from(items[axis]),
            Self::Groups => product(groups),
            Self::GroupsAlong(axis) => u64::from(groups[axis]),
            Self::One => 1,
        }
    }
}

impl Length {
    /// True for an array with one element, or a fixed number of them, for each element of the dispatch.
    pub(super) fn is_by_elements(self) -> bool {
        matches!(self, Self::Grows { with: Measure::All, plus: 0, .. })
    }

    fn elements(self, items: [u32; 3], groups: [u32; 3]) -> u32 {
        let found = match self {
            Self::Grows { with, times: (n, d), plus } => (with.of(items, groups) * n).div_ceil(d) + plus,
            Self::Unknown(most) => most,
        };
        u32::try_from(found).unwrap_or(u32::MAX)
    }
}

impl Dispatched {
    /// Elements along each axis, small ones first; those that fill no workgroup are always among them.
    pub(super) fn sizes(&self) -> Vec<[u32; 3]> {
        if self.alone || self.axes.is_empty() {
            return vec![self.size];
        }
        if let Some(fixed) = self.fixed_elements() {
            // Along the axis that the kernel asks for.
            let (mut items, axis) = (self.size, self.axes[0]);
            let rest: u32 = items.iter().enumerate().filter(|(k, _)| *k != axis).map(|(_, count)| count).product();
            items[axis] = fixed.div_ceil(rest.max(1)).max(1);
            return vec![items];
        }
        let along = |axis: usize, k: usize| {
            let n = self.size[axis];
            let all = [1, 2, n.saturating_sub(1), n, n + 1, 2 * n - 1, 2 * n, 2 * n + n / 2 + 1];
            all[k].max(1)
        };
        let axes = &self.axes[..];
        let mut all: Vec<[u32; 3]> = match axes {
            [_] => (0..8).map(|k| [k; 3]).collect(),
            _ => vec![[0, 0, 0], [3, 3, 0], [4, 3, 0], [3, 4, 0], [5, 4, 0], [6, 3, 0], [7, 5, 1]],
        }
        .into_iter()
        .map(|pattern: [usize; 3]| {
            let mut items = self.size;
            axes.iter().zip(pattern).for_each(|(&axis, k)| items[axis] = along(axis, k));
            items
        })
        .collect();
        all.dedup();
        all
    }

    /// Elements of the longest array that hosts fill, where all of them have a fixed size. Of arrays in an array, it is that
    /// one which has the elements that invocations are numbered by.
    pub(super) fn fixed_elements(&self) -> Option<u32> {
        let storage = || self.executable.memories().iter().filter(|shape| matches!(shape.space, Space::Storage { .. }));
        if storage().any(|shape| shape.array.is_some()) {
            return None;
        }
        let elements = |shape: &MemoryShape| {
            let first = shape.fixed.iter().find(|leaf| leaf.name.contains("[]"))?;
            first.lens.first().copied()
        };
        storage().filter_map(elements).max()
    }

    pub(super) fn groups(&self, items: [u32; 3]) -> [u32; 3] {
        std::array::from_fn(|axis| items[axis].div_ceil(self.size[axis]).max(self.named[axis]))
    }

    /// How long each array is: what the shader reaches where its elements fill the workgroups, for several sizes.
    pub(super) fn lengths(&self) -> Vec<Length> {
        self.lengths_with(0)
    }

    /// The same with other choices of the host.
    pub(super) fn lengths_with(&self, variant: u64) -> Vec<Length> {
        let whole = |k: [u32; 3]| -> [u32; 3] {
            std::array::from_fn(|axis| {
                if self.alone || !self.axes.contains(&axis) { self.size[axis] } else { k[axis] * self.size[axis] }
            })
        };
        let sizes = [whole([2, 2, 1]), whole([3, 2, 1]), whole([2, 3, 2])];
        let mut reached: Vec<Vec<Option<u64>>> = vec![Vec::new(); self.executable.memories().len()];
        for items in sizes {
            let scenario = self.scenario(items, None, variant);
            let outcome = self.play(&scenario, 0);
            reached.iter_mut().zip(self.reached(&outcome)).for_each(|(all, one)| all.push(one));
        }
        let groups = sizes.map(|items| self.groups(items));
        let several = self.several(sizes, &reached);
        let one = |(k, reached): (usize, Vec<Option<u64>>)| {
            match several[k] {
                Some(Guard::Times(times)) => {
                    return Length::Grows { with: Measure::All, times: (times, 1), plus: 0 };
                }
                // A constant of the shader says how many there are, whatever is dispatched.
                Some(Guard::Elements(n)) => return Length::Grows { with: Measure::One, times: (n, 1), plus: 0 },
                None => {}
            }
            // Who asks for the length makes do with any.
            if self.uses.lengths.contains(&(k as u32)) {
                return Length::Grows { with: Measure::All, times: (1, 1), plus: 0 };
            }
            let Some(reached) = reached.into_iter().collect::<Option<Vec<u64>>>() else {
                return Length::Unknown(ROOM as u64);
            };
            // Where elements fill the workgroups, both grow alike: fewer than one for each element are some for each
            // workgroup, and so are several where an invocation knows no more than its workgroup: a row each.
            let few = (0..3).all(|n| reached[n] < Measure::All.of(sizes[n], groups[n]));
            let many = (0..3).all(|n| reached[n] > Measure::All.of(sizes[n], groups[n]));
            let first = if few || (many && !self.executable.reads_place()) {
                [Measure::Groups, Measure::All]
            } else {
                [Measure::All, Measure::Groups]
            };
            let at = |with: Measure, n: usize| with.of(sizes[n], groups[n]);
            // Several for each place along an axis are a row for each workgroup, where invocations do not ask for that place.
            let along = |axis: usize| {
                let by_rows = !self.executable.reads_place() && reached[0] > at(Measure::Along(axis), 0);
                if by_rows { Measure::GroupsAlong(axis) } else { Measure::Along(axis) }
            };
            let measures = [first[0], along(0), along(1), first[1], Measure::One];
            let varies = |with: Measure| with == Measure::One || (0..3).any(|n| at(with, n) != at(with, 0));
            for with in measures.into_iter().filter(|with| varies(*with)) {
                if (1..3).all(|n| reached[n] * at(with, 0) == reached[0] * at(with, n)) {
                    return Length::Grows { with, times: (reached[0].max(1), at(with, 0)), plus: 0 };
                }
            }
            for with in measures.into_iter().filter(|with| varies(*with)) {
                let beyond = |n: usize| reached[n].checked_sub(at(with, n));
                if let Some(plus) = beyond(0).filter(|_| (1..3).all(|n| beyond(n) == beyond(0))) {
                    return Length::Grows { with, times: (1, 1), plus };
                }
            }
            Length::Unknown(reached.into_iter().max().unwrap_or(1).max(1))
        };
        reached.into_iter().enumerate().map(one).collect()
    }

    /// Of each array, how many elements there are for one of the dispatch, where a guard in the shader says so and several
    /// dispatches, or a longer one, are to reach them: `if (i < 9 * count)`. More workgroups than the elements fill reach
    /// farther there, up to the guard.
    fn several(&self, sizes: [[u32; 3]; 3], reached: &[Vec<Option<u64>>]) -> Vec<Option<Guard>> {
        let none = vec![None; reached.len()];
        if self.alone || self.axes.is_empty() {
            return vec![None; reached.len()];
        }
        let wide = |items: [u32; 3], times: u32| {
            let mut scenario = self.scenario(items, None, 0);
            scenario.groups[self.axes[0]] *= times;
            let outcome = self.play(&scenario, 0);
            // Where it was cut off, no guard is what ended it.
            if outcome.whole { self.reached(&outcome) } else { none.clone() }
        };
        let first = wide(sizes[0], WIDE);
        let grows = |k: usize| first[k].zip(reached[k][0]).is_some_and(|(wide, own)| wide > own);
        if !(0..reached.len()).any(grows) {
            return vec![None; reached.len()];
        }
        // What grows with the workgroups has no guard.
        let wider = wide(sizes[0], WIDE + 1);
        let all = [&first, &wide(sizes[1], WIDE), &wide(sizes[2], WIDE)];
        let mut found = vec![None; reached.len()];
        for k in (0..reached.len()).filter(|&k| grows(k) && wider[k] == first[k]) {
            let parts = |n: usize| {
                let items: u64 = sizes[n].iter().map(|&n| u64::from(n)).product();
                all[n][k].map(|reach| (reach / items, reach % items))
            };
            // One more than a multiple is a guard that is off by one.
            let whole = parts(0).filter(|&(times, rest)| times > 1 && rest <= 1);
            let times = whole.filter(|_| (1..3).all(|n| parts(n) == whole)).map(|(times, _)| Guard::Times(times));
            let one = first[k].filter(|_| all.iter().all(|wide| wide[k] == first[k])).map(Guard::Elements);
            found[k] = times.or(one);
        }
        found
    }

    /// Whether anything was stored to what is left behind the dispatch.
    pub(super) fn stores_in(&self, outcome: &Outcome) -> bool {
        let memories = self.executable.memories().iter().zip(&outcome.changed);
        memories.into_iter().any(|(shape, changed)| *changed && matches!(shape.space, Space::Storage { .. }))
    }

    /// Of each array, the elements up to the last one that was touched; `None` where an index was outside.
    pub(super) fn reached(&self, outcome: &Outcome) -> Vec<Option<u64>> {
        let one = |(k, shape): (usize, &MemoryShape)| {
            let outside = outcome.incidents.iter().any(|i| i.memory == Some(k as u32) && i.index.is_some());
            let array = shape.array.as_ref().filter(|_| shape.is_open() && !outside)?;
            Some((outcome.reach[k] as u64).saturating_sub(u64::from(array.offset)).div_ceil(u64::from(array.stride)))
        };
        self.executable.memories().iter().enumerate().map(one).collect()
    }

    /// What a host does for so many elements. Without lengths, arrays are longer than they need to be.
    pub(super) fn scenario(&self, items: [u32; 3], lengths: Option<&[Length]>, variant: u64) -> Scenario {
        self.scenario_with(items, lengths, variant, None)
    }

    /// The same with every other image smaller than the dispatch: those with even or with odd numbers.
    pub(super) fn scenario_with(
        &self,
        items: [u32; 3],
        lengths: Option<&[Length]>,
        variant: u64,
        smaller: Option<usize>,
    ) -> Scenario {
        let groups = self.groups(items);
        let mut settings = Vec::new();
        let mut buffers = Vec::new();
        let key = property::mix(0x5eed + variant, items.iter().fold(0, |key, &n| property::mix(key, u64::from(n))));
        for (k, shape) in self.executable.memories().iter().enumerate() {
            let mut stream = Stream::new(property::mix(key, k as u64));
            let sides = self.sides_of(k, items, smaller);
            let elements = match (&shape.array, lengths) {
                (None, _) => 0,
                (Some(_), _) if shape.image.is_some() => sides.iter().product(),
                (Some(_), Some(lengths)) => lengths[k].elements(items, groups),
                (Some(_), None) if self.uses.lengths.contains(&(k as u32)) => items.iter().product(),
                (Some(array), None) => (ROOM / array.stride as usize) as u32,
            };
            // Nobody needs more than this to see what goes wrong.
            let elements = elements.min(1 << 20);
            let mut words = vec![0; if shape.space == Space::Workgroup { 0 } else { shape.words_with(elements) }];
            if !words.is_empty() {
                let host = Host { items, groups, variant };
                for leaf in &shape.fixed {
                    // What nobody reads, such as padding, is no choice.
                    if shape.space == Space::Uniform && !self.uses.reads(k as u32, leaf.offset) {
                        continue;
                    }
                    let packed = self.uses.packed(k as u32, leaf.offset);
                    let counted = self.uses.atomics.contains(&(k as u32));
                    let chosen = host.fixed((shape, counted), (leaf, packed), &mut stream);
                    words[leaf.offset as usize] = chosen;
                    let is_set = shape.space == Space::Uniform || (is_spread(variant) && leaf.lens.is_empty());
                    if is_set && leaf.scalar != Scalar::F32 {
                        let place = (k as u32, leaf.offset);
                        settings.push(Chosen { name: named(shape, leaf), value: chosen, place });
                    }
                }
                if let Some(array) = &shape.array {
                    // What is counted up begins with 0.
                    let filled = if self.uses.atomics.contains(&(k as u32)) { 0 } else { elements };
                    for index in 0..filled as usize {
                        for leaf in &array.leaves {
                            let at = array.offset as usize + index * array.stride as usize + leaf.offset as usize;
                            let name = if leaf.name.is_empty() { &shape.name } else { &*leaf.name };
                            let packed = self.uses.packed(k as u32, array.offset + leaf.offset);
                            let word = match packed {
                                [] => host.element(name, leaf.scalar, shape.space, &mut stream),
                                packed => host.numbers(packed, &mut stream),
                            };
                            let texels = shape.image.as_ref();
                            words[at] = texels.map_or(word, |texels| images::held(texels, leaf.offset as usize, word));
                        }
                    }
                }
                if shape.image.as_ref().is_some_and(|texels| texels.is_in_buffer()) {
                    images::write_size(&mut words, sides);
                }
            }
            buffers.push(Buffer { words, elements, sides });
        }
        let product = |all: [u32; 3]| -> u64 { all.iter().map(|&n| u64::from(n)).product() };
        let surplus = (product(groups) * product(self.size)).saturating_sub(product(items));
        let (executable, contents) = (self.executable_for(items), Contents::of(variant));
        Scenario {
            groups,
            executable,
            buffers,
            settings,
            surplus,
            subgroup: WIDTH,
            turns: Turns::default(),
            contents,
            variant,
            empty: None,
        }
    }

    /// True where a host sets whole numbers whose names do not say what they are.
    pub(super) fn has_open_numbers(&self) -> bool {
        let many = self.axes.len() > 1;
        self.executable.memories().iter().enumerate().any(|(k, shape)| {
            let is_host = shape.space == Space::Uniform || matches!(shape.space, Space::Storage { .. });
            let counted = self.uses.atomics.contains(&(k as u32));
            let is_open = |leaf: &Leaf| {
                let name = if leaf.name.is_empty() { &shape.name } else { &*leaf.name };
                let whole = matches!(leaf.scalar, Scalar::I32 | Scalar::U32) && leaf.lens.is_empty();
                let open = setting(name, leaf.component, many) == Setting::Open || shape.space != Space::Uniform;
                whole && open && self.uses.reads(k as u32, leaf.offset)
            };
            is_host && !counted && shape.fixed.iter().any(is_open)
        })
    }

    /// A scenario with each of its whole numbers at 0 in turn. What the program takes for a real number as well, such as what
    /// a mean divides by, is none of them: who writes that knows of it.
    pub(super) fn emptied<'s>(&'s self, whole: &'s Scenario) -> impl Iterator<Item = Scenario> + 's {
        let open = |own: &Chosen| {
            let (memory, word) = own.place;
            own.value != 0 && self.uses.packed(memory, word).is_empty() && !self.uses.is_real_too(memory, word)
        };
        let one = |(n, own): (usize, &Chosen)| {
            let mut scenario = Scenario { empty: Some(n), ..whole.clone() };
            scenario.buffers[own.place.0 as usize].words[own.place.1 as usize] = 0;
            scenario.settings[n].value = 0;
            scenario
        };
        whole.settings.iter().enumerate().filter(move |(_, own)| open(own)).take(MOST_EMPTIED).map(one)
    }

    /// Runs a scenario. Loads outside of an array give the bits of `outside`.
    pub(super) fn play(&self, scenario: &Scenario, outside: u32) -> Outcome {
        self.play_in::<f32>(scenario, outside)
    }

    /// The same in numbers of a type.
    pub(super) fn play_in<N: Number>(&self, scenario: &Scenario, outside: u32) -> Outcome
    where
        Plain<N>: InMemory<Column = Column<N>, Cell = N>,
    {
        let mut outcome = scenario.executable.dispatch::<N>(&Dispatch {
            size: self.size,
            groups: scenario.groups,
            buffers: &scenario.buffers,
            zeroed: self.zeroed,
            outside,
            fuel: FUEL,
            work: WORK,
            watched: true,
            order: 0,
            turns: scenario.turns,
            subgroup: scenario.subgroup,
        });
        // In all languages but WGSL, operations of a subgroup are those of the invocations that come to them.
        if self.program.written != Written::Wgsl {
            outcome.incidents.retain(|incident| incident.what != Wrong::Apart);
        }
        outcome
    }
}

fn named(shape: &MemoryShape, leaf: &Leaf) -> String {
    let mut name = if leaf.name.is_empty() { shape.name.clone() } else { leaf.name.to_string() };
    if let Some(k) = leaf.component {
        name += [".x", ".y", ".z", ".w"].get(k as usize).copied().unwrap_or("");
    }
    name
}

/// The choices of a host for one dispatch.
struct Host {
    items: [u32; 3],
    groups: [u32; 3],
    variant: u64,
}

impl Host {
    /// A number of a buffer that is no element of an array without a length. Atomic functions count from 0.
    fn fixed(
        &self,
        (shape, counted): (&MemoryShape, bool),
        (leaf, packed): (&Leaf, &[Bits]),
        stream: &mut Stream,
    ) -> u32 {
        let name = if leaf.name.is_empty() { &shape.name } else { &*leaf.name };
        match leaf.scalar {
            Scalar::F32 => self.element(name, Scalar::F32, shape.space, stream),
            Scalar::Bool => (self.variant % 2) as u32,
            Scalar::I32 | Scalar::U32 => {
                // An array is data, as one without a fixed length is; a number alone is a setting.
                if !leaf.lens.is_empty() && matches!(shape.space, Space::Storage { .. }) {
                    return match packed {
                        _ if counted => 0,
                        [] => self.element(name, leaf.scalar, shape.space, stream),
                        packed => self.numbers(packed, stream),
                    };
                }
                // What is written is counted up from 0.
                if matches!(shape.space, Space::Storage { writes: true }) {
                    return if is_spread(self.variant) && !counted { self.spread(stream) } else { 0 };
                }
                match packed {
                    [] if is_spread(self.variant) && self.count(name, leaf.component).is_none() => self.spread(stream),
                    [] => self.count(name, leaf.component).unwrap_or([1, 0, 2, 3][(self.variant % 4) as usize]),
                    packed => self.packed(name, packed),
                }
            }
        }
    }

    /// Whole numbers in the bits of one word of a uniform. Elements lie along as many axes as there are numbers; of others,
    /// none is 0 at first, since some are divided by.
    fn packed(&self, name: &str, packed: &[Bits]) -> u32 {
        let extents = matches!(setting(name, None, true), Setting::Along(_) | Setting::All);
        let number = |k: usize, bits: &Bits| match (extents, self.variant) {
            (true, _) => self.items.get(k).copied().unwrap_or(1).min(bits.most()),
            (false, 1) if bits.count == 1 => 0,
            (false, 1) => 2,
            (false, _) => 1,
        };
        packed.iter().enumerate().fold(0, |word, (k, bits)| word | number(k, bits) << bits.first)
    }

    /// A whole number of which nothing is known, and which is seldom that of another.
    fn spread(&self, stream: &mut Stream) -> u32 {
        let most = self.items.iter().copied().max().unwrap_or(1).clamp(4, 64);
        1 + stream.below(most as usize) as u32
    }

    /// A whole number of a uniform, by its name; none where that says nothing.
    fn count(&self, name: &str, component: Option<u32>) -> Option<u32> {
        let many = self.items.iter().filter(|&&n| n > 1).count() > 1;
        Some(match setting(name, component, many) {
            Setting::Zero => 0,
            Setting::Groups => self.groups.iter().product(),
            Setting::Along(axis) => self.items.get(axis).copied().unwrap_or(1),
            Setting::All => self.items.iter().product(),
            Setting::Open => return None,
        })
    }

    /// Random numbers in the bits of one word of an array.
    fn numbers(&self, packed: &[Bits], stream: &mut Stream) -> u32 {
        let below = self.items.iter().product::<u32>().max(4);
        let mut number = |bits: &Bits| stream.below(below.min(bits.most().saturating_add(1)) as usize) as u32;
        packed.iter().fold(0, |word, bits| word | number(bits) << bits.first)
    }

    /// A number in a memory.
    fn element(&self, name: &str, scalar: Scalar, space: Space, stream: &mut Stream) -> u32 {
        let all: u32 = self.items.iter().product();
        match scalar {
            Scalar::F32 => {
                let unit = stream.unit();
                let value = match Contents::of(self.variant) {
                    Contents::Signed => 2.0 * unit - 1.0,
                    Contents::Equal if space != Space::Uniform => 0.5,
                    Contents::Zero if space != Space::Uniform => 0.0,
                    Contents::Large if space != Space::Uniform => 256.0 * unit - 128.0,
                    Contents::Unit | Contents::Equal | Contents::Zero | Contents::Large => unit,
                };
                (value as f32).to_bits()
            }
            Scalar::Bool => stream.below(2) as u32,
            Scalar::I32 | Scalar::U32 => {
                let most = if is_tag(name) { 4 } else { all.max(1) };
                stream.below(most as usize) as u32
            }
        }
    }
}
