//! What a first suite says about a compute stage: the guesses about its host, as expressions of sizes.

use std::fmt::Write;

use program::interp::group::{Incident, Space, Wrong};
use program::{Dispatch, HostBuffer, ProgramError};

use super::Dispatched;
use super::host::{Length, Measure};
use super::setting::{Setting, is_tag, setting};
use crate::guess::{self, GUESSED, Role, Uses};
use base::value::{Field, Scalar};
use property::pattern;
use syntax::words::words;

/// Names of sizes along x, y and z; a single one is `N`.
const NAMES: [&str; 3] = ["WIDTH", "HEIGHT", "DEPTH"];

/// Choices of a host with another number in uniforms that no name explains.
const OTHER: u64 = 2;

/// Elements of a buffer of which no rule says how long it is, at most.
const LONGEST: u64 = 1 << 12;

/// A first suite about a dispatch, in parts.
#[derive(Clone, Debug)]
pub struct Drafted {
    /// The table `[dispatch]`, in TOML.
    pub dispatch: String,
    /// The groups of inputs, in TOML.
    pub inputs: String,
    /// Inputs that these fill.
    pub count: usize,
    /// Laws that may hold: names in reports, and how a suite states them.
    pub laws: Vec<(String, String)>,
}

/// Expressions for the numbers of a dispatch.
struct Terms {
    /// Elements along each axis.
    along: [String; 3],
    /// Workgroups along each axis.
    groups: [String; 3],
    /// Number of all elements, as an expression.
    all: String,
    /// Sizes with their values; empty where everything is fixed.
    sizes: Vec<(&'static str, Vec<u32>)>,
    /// False where invocations without an element reach outside of an array.
    guarded: bool,
}

/// A group of inputs.
struct Filled {
    names: Vec<String>,
    uniform: bool,
    generator: &'static str,
    option: String,
    taken_for: String,
    /// Nobody stated it, and no number of the dispatch gives it.
    guessed: bool,
}

/// How the text uses an input.
type Used<'a> = &'a dyn Fn(&Field) -> Uses;

impl Dispatched {
    /// A first suite: sizes at which kernels go wrong, and for everything that a host gives the stage what it is taken for.
    ///
    /// # Errors
    /// As of [`program::Program::dispatched`], for what a dispatch cannot be given.
    pub fn draft(&self, used: Used<'_>) -> Result<Drafted, ProgramError> {
        if let Some(image) = self.executable.memories().iter().find(|shape| shape.is_image()) {
            let what = format!("a suite of a kernel with the storage image `{}`, which `fuzz` can run", image.name);
            return Err(ProgramError::Unsupported { what });
        }
        let buffers = self.program.buffers();
        let terms = self.terms();
        let lengths = self.lengths_of(&buffers, &terms);
        // Two elements tell a name that stands for each of them.
        let open = buffers.iter().filter(|buffer| buffer.open).map(|buffer| (buffer.name.clone(), 2)).collect();
        let program = self.program.clone().dispatched(&Dispatch { groups: [1; 3], lengths: open })?;
        let mut filled: Vec<Filled> = Vec::new();
        let mut fields: Vec<(&HostBuffer, Field)> = Vec::new();
        let (chosen, led) = (self.is_long_by_choice(), self.led());
        for port in &program.uniforms {
            let field = Field { name: pattern(&port.field.name), shape: port.field.shape };
            join(&mut filled, self.uniform(&field, &terms, chosen, used));
        }
        for port in &program.inputs {
            let Some(buffer) = buffers.iter().find(|buffer| port.global() == Some(buffer.global)) else { continue };
            let field = Field { name: pattern(&port.field.name), shape: port.field.shape };
            if fields.iter().all(|(_, own)| own.name != field.name) {
                fields.push((buffer, field));
            }
        }
        for (buffer, field) in fields.iter().filter(|(buffer, _)| buffer.read) {
            let length = lengths.iter().find(|(name, ..)| *name == buffer.name);
            let known = (length.map(|(_, text, _)| &text[..]), &terms);
            join(&mut filled, self.stored(&buffers, &led, buffer, field, used, known));
        }
        let written = |field: &Field| program.outputs.iter().any(|port| pattern(&port.field.name) == field.name);
        // What is always the same has any law.
        let varies = |field: &Field| {
            filled.iter().any(|group| group.generator != "constant" && group.names.contains(&field.name))
        };
        let laws = laws(&fields, &lengths, &written, &varies);
        let count = filled.iter().map(|group| group.names.len()).sum();
        Ok(Drafted { dispatch: dispatch(&terms, &lengths), inputs: inputs(&filled), count, laws })
    }

    /// True where the stage asks for the length of a buffer.
    fn asks(&self) -> bool {
        let is_storage = |k: u32| {
            let shape = self.executable.memories().get(k as usize);
            shape.is_some_and(|shape| matches!(shape.space, Space::Storage { .. }))
        };
        self.uses.lengths.iter().any(|&k| is_storage(k))
    }

    fn terms(&self) -> Terms {
        let fixed = if self.alone || self.axes.is_empty() || self.fixed_elements().is_some() {
            self.sizes().first().copied()
        } else {
            None
        };
        if let Some(items) = fixed {
            let groups = self.groups(items).map(|n| n.to_string());
            let (along, all) = (items.map(|n| n.to_string()), items.iter().product::<u32>());
            // One workgroup may go over as many elements as there are.
            if self.alone && self.asks() {
                let sizes = vec![("N", awkward(all))];
                return Terms { along, groups, all: "N".to_owned(), sizes, guarded: true };
            }
            return Terms { along, groups, all: all.to_string(), sizes: Vec::new(), guarded: true };
        }
        let guarded = self.is_guarded();
        let name = |axis: usize| if self.axes.len() == 1 { "N" } else { NAMES[axis] };
        let sized = |axis: usize| self.axes.contains(&axis);
        let along: [String; 3] =
            std::array::from_fn(|axis| if sized(axis) { name(axis).to_owned() } else { self.size[axis].to_string() });
        let groups = std::array::from_fn(|axis| match self.size[axis] {
            _ if !sized(axis) => "1".to_owned(),
            1 => name(axis).to_owned(),
            n => format!("({} + {}) / {n}", name(axis), n - 1),
        });
        let of = |&axis: &usize| {
            let n = self.size[axis];
            let values = match (self.axes.len(), axis) {
                (_, 0) if !guarded => vec![n, 2 * n],
                _ if !guarded => vec![n],
                (1, _) => awkward(n),
                (_, 0) => vec![1, n + 1],
                (_, 1) => vec![n.saturating_sub(1).max(1), n.max(2)],
                _ => vec![n.max(2)],
            };
            (name(axis), values)
        };
        let sizes = self.axes.iter().map(of).collect();
        let all = product(&along);
        Terms { along, groups, all, sizes, guarded }
    }

    /// False where invocations without an element, which fill up the workgroups, reach outside of an array.
    fn is_guarded(&self) -> bool {
        let lengths = self.lengths();
        // What buffers hold leads outside whether or not there is an element.
        let led = |incident: &Incident| {
            let leads = self.depends.leads(incident.who.site);
            let mut all = self.executable.memories().iter().enumerate();
            all.any(|(k, shape)| matches!(shape.space, Space::Storage { .. }) && leads.has(k))
        };
        self.sizes().into_iter().all(|items| {
            let scenario = self.scenario(items, Some(&lengths), 0);
            // Where most of them are kept away, the guard is one with a fault.
            let outside = |incident: &Incident| {
                incident.what == Wrong::Outside && !led(incident) && incident.count >= scenario.surplus
            };
            scenario.surplus < 2 || !self.play(&scenario, 0).incidents.iter().any(outside)
        })
    }

    /// For each buffer that is as long as its host makes it, its elements, and whether that is a guess without a rule.
    fn lengths_of(&self, buffers: &[HostBuffer], terms: &Terms) -> Vec<(String, String, bool)> {
        let found = self.lengths();
        let alone = if self.alone && self.asks() { self.grows_alone() } else { Vec::new() };
        let found = found.into_iter().enumerate().map(|(k, length)| match alone.contains(&k) {
            true => Length::Grows { with: Measure::All, times: (1, 1), plus: 0 },
            false => length,
        });
        let storage = self.executable.memories().iter().zip(found);
        let storage = storage.filter(|(shape, _)| matches!(shape.space, Space::Storage { .. }));
        let open = buffers.iter().zip(storage).filter(|(buffer, _)| buffer.open);
        open.map(|(buffer, (_, length))| match length {
            Length::Grows { with, times: (n, d), plus } => {
                let measure = match with {
                    Measure::All => terms.all.clone(),
                    Measure::Along(axis) => terms.along[axis].clone(),
                    Measure::Groups => product(&terms.groups),
                    Measure::GroupsAlong(axis) => terms.groups[axis].clone(),
                    Measure::One => "1".to_owned(),
                };
                (buffer.name.clone(), scaled(measure, n, d, plus), false)
            }
            Length::Unknown(most) => (buffer.name.clone(), most.min(LONGEST).to_string(), true),
        })
        .collect()
    }

    /// Where one workgroup goes over as many elements as a buffer has, the others of which it reaches as many.
    fn grows_alone(&self) -> Vec<usize> {
        let reached = [2, 3].map(|times| {
            let n = times * self.size.iter().product::<u32>();
            let mut scenario = self.scenario([n, 1, 1], None, 0);
            scenario.groups = [1; 3];
            (u64::from(n), self.reached(&self.play(&scenario, 0)))
        });
        let all = 0..self.executable.memories().len();
        all.filter(|&k| reached.iter().all(|(n, reached)| reached[k] == Some(*n))).collect()
    }

    /// Of each memory, the elements of the shortest array into which what it holds leads, where that leads outside.
    fn led(&self) -> Vec<Option<u32>> {
        let mut least = vec![None; self.executable.memories().len()];
        let lengths = self.lengths();
        for items in self.sizes() {
            let outcome = self.play(&self.scenario(items, Some(&lengths), 0), 0);
            for incident in outcome.incidents {
                let Some((_, len)) = incident.index else { continue };
                let sources = self.depends.leads(incident.who.site);
                for (_, least) in least.iter_mut().enumerate().filter(|(k, _)| sources.has(*k)) {
                    *least = Some(least.map_or(len, |own: u32| own.min(len)));
                }
            }
        }
        least
    }

    /// True where the length of a buffer follows from a number of the host that no name explains.
    fn is_long_by_choice(&self) -> bool {
        self.lengths() != self.lengths_with(OTHER)
    }

    /// What a uniform is filled with.
    fn uniform(&self, field: &Field, terms: &Terms, chosen: bool, used: Used<'_>) -> Filled {
        let names = vec![field.name.clone()];
        let many = self.axes.len() > 1;
        let last = field.name.rsplit('.').next().unwrap_or(&field.name);
        let counted = || words(&field.name).iter().any(|word| ["count", "num", "number"].contains(&word.as_str()));
        let whole = match field.shape.scalar {
            Scalar::I32 | Scalar::U32 => field.shape.array.is_none(),
            // Hosts put counts among floats as well.
            Scalar::F32 => field.shape.words() == 1 && counted(),
            Scalar::Bool => false,
        };
        let components: Vec<Option<u32>> = match field.shape.words() {
            1 => vec![None],
            words => (0..words as u32).map(Some).collect(),
        };
        let expression = |component: &Option<u32>| {
            Some(match setting(&field.name, *component, many) {
                // What is called padding and nothing else is as good as 0 to begin with.
                _ if words(last).iter().all(|word| ["pad", "padding"].contains(&word.as_str())) => "0".to_owned(),
                Setting::Zero => "0".to_owned(),
                Setting::Groups => product(&terms.groups),
                Setting::Along(axis) => terms.along.get(axis).cloned().unwrap_or_else(|| "1".to_owned()),
                Setting::All => terms.all.clone(),
                Setting::Open => return None,
            })
        };
        let values: Option<Vec<String>> = components.iter().map(expression).collect();
        if let Some(values) = values.filter(|_| whole && !field.name.contains("[]")) {
            let values: Vec<String> = values.iter().map(|value| toml(value)).collect();
            let option = format!("values = [{}]\n", values.join(", "));
            let taken_for = "a number of the dispatch".to_owned();
            return Filled { names, uniform: true, generator: "constant", option, taken_for, guessed: false };
        }
        if whole && chosen {
            let taken_for = "a number that the lengths of buffers follow from; say which one the host gives".to_owned();
            return Filled {
                names,
                uniform: true,
                generator: "constant",
                option: "values = [1]\n".to_owned(),
                taken_for,
                guessed: true,
            };
        }
        let guess = guess::with_uses(field, Role::Uniform, &used(field));
        let option = guess.range.map_or_else(String::new, |[lo, hi]| format!("range = [{lo:?}, {hi:?}]\n"));
        let taken_for = guess.taken_for.to_owned();
        Filled { names, uniform: true, generator: guess.generator, option, taken_for, guessed: true }
    }

    /// What a part of a storage buffer holds before.
    fn stored(
        &self,
        buffers: &[HostBuffer],
        led: &[Option<u32>],
        buffer: &HostBuffer,
        field: &Field,
        used: Used<'_>,
        (length, terms): (Option<&str>, &Terms),
    ) -> Filled {
        let filled = |generator, option: String, taken_for: &str| Filled {
            names: vec![field.name.clone()],
            uniform: false,
            generator,
            option,
            taken_for: taken_for.to_owned(),
            guessed: generator != "constant",
        };
        let range = |lo: &str, hi: &str| format!("range = [{}, {}]\n", toml(lo), toml(hi));
        if field.shape.scalar == Scalar::F32 {
            let element = Field { name: field.name.replace("[]", ""), shape: field.shape.element() };
            let guess = guess::with_uses(&element, Role::Parameter, &used(field));
            if element.shape.columns > 1 && field.shape.array.is_none() {
                let option = guess.range.map_or_else(String::new, |[lo, hi]| format!("range = [{lo:?}, {hi:?}]\n"));
                return filled(guess.generator, option, guess.taken_for);
            }
            let [lo, hi] = guess.range.filter(|_| guess.generator == "interval").unwrap_or([-1.0, 1.0]);
            return filled("array", format!("range = [{lo:?}, {hi:?}]\n"), guess.taken_for);
        }
        let counted = self.executable.memories().iter().enumerate();
        let storage = counted.filter(|(_, shape)| matches!(shape.space, Space::Storage { .. }));
        let own = buffers.iter().zip(storage).find(|(of, _)| of.global == buffer.global).map(|(_, (k, _))| k);
        if own.is_some_and(|k| self.uses.atomics.contains(&(k as u32))) {
            return filled("constant", "values = [0]\n".to_owned(), "what is counted up from 0");
        }
        let words = words(&field.name);
        let is = |any: &[&str]| words.iter().any(|word| any.contains(&word.as_str()));
        let alone = field.shape.array.is_some() && field.shape.element_words() == 1;
        if alone && length == Some(&terms.all) && is(&["indices", "index", "order", "permutation", "perm", "ids"]) {
            return filled("permutation", String::new(), "an order of the elements");
        }
        if field.shape.scalar == Scalar::Bool {
            return filled("array", range("0", "1"), "a switch");
        }
        if is_tag(&field.name) {
            return filled("array", range("0", "3"), "a kind");
        }
        if let Some(len) = own.and_then(|k| led[k]) {
            return filled("array", range("0", &len.saturating_sub(1).to_string()), "indices");
        }
        match terms.all.parse::<u32>() {
            Ok(all) => filled("array", range("0", &all.saturating_sub(1).to_string()), "numbers of elements"),
            Err(_) => filled("array", range("0", &format!("{} - 1", terms.all)), "numbers of elements"),
        }
    }
}

/// Sizes at which kernels with workgroups of `n` go wrong.
fn awkward(n: u32) -> Vec<u32> {
    let mut all = if n > 1 { vec![1, n - 1, n, n + 1] } else { vec![1, 2, 3, 7] };
    all.dedup();
    all
}

/// The product of expressions.
fn product(factors: &[String; 3]) -> String {
    let other: Vec<&String> = factors.iter().filter(|factor| *factor != "1").collect();
    let several = other.len() > 1;
    let grouped =
        |factor: &&String| if several && factor.contains(' ') { format!("({factor})") } else { (*factor).clone() };
    let all: Vec<String> = other.iter().map(grouped).collect();
    if all.is_empty() { "1".to_owned() } else { all.join(" * ") }
}

/// An expression times a ratio, rounded up, plus a number.
fn scaled(measure: String, n: u64, d: u64, plus: u64) -> String {
    let (mut a, mut b) = (n, d);
    while b > 0 {
        (a, b) = (b, a % b);
    }
    let (n, d) = (n / a.max(1), d / a.max(1));
    let grouped = if measure.contains(['+', '-', '/']) { format!("({measure})") } else { measure.clone() };
    let mut text = match (n, &measure[..]) {
        (1, _) => measure.clone(),
        (n, "1") => n.to_string(),
        (n, _) => format!("{n} * {grouped}"),
    };
    if d > 1 {
        text = format!("({text} + {}) / {d}", d - 1);
    }
    if plus > 0 { format!("{text} + {plus}") } else { text }
}

/// A number or an expression as TOML has it.
fn toml(expression: &str) -> String {
    if expression.chars().all(|c| c.is_ascii_digit()) { expression.to_owned() } else { format!("{expression:?}") }
}

fn dispatch(terms: &Terms, lengths: &[(String, String, bool)]) -> String {
    let mut text = "\n[dispatch]\n".to_owned();
    let axes = terms.groups.iter().rposition(|count| count != "1").map_or(1, |last| last + 1);
    let groups: Vec<String> = terms.groups[..axes].iter().map(|count| toml(count)).collect();
    let _ = writeln!(text, "groups = [{}]", groups.join(", "));
    for (name, ..) in lengths.iter().filter(|(.., open)| *open) {
        let _ = writeln!(text, "# No rule was found for the length of `{name}`; say how long its host makes it.");
    }
    if !lengths.is_empty() {
        let lengths: Vec<String> =
            lengths.iter().map(|(name, length, _)| format!("{} = {}", key(name), toml(length))).collect();
        let _ = writeln!(text, "lengths = {{ {} }}", lengths.join(", "));
    }
    if !terms.guarded {
        text.push_str(
            "# Nothing keeps away the invocations that fill up the last workgroup: at other sizes than these, indices \
             lead\n# outside. With a guard such as `if (i >= n) return;`, add sizes that fill none.\n",
        );
    }
    if !terms.sizes.is_empty() {
        let sizes: Vec<String> = terms.sizes.iter().map(|(name, values)| format!("{name} = {values:?}")).collect();
        let _ = writeln!(text, "sizes = {{ {} }}", sizes.join(", "));
    }
    text
}

/// A key of TOML.
fn key(name: &str) -> String {
    let bare = !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-');
    if bare { name.to_owned() } else { format!("{name:?}") }
}

/// Adds an input to those that are filled alike.
fn join(all: &mut Vec<Filled>, one: Filled) {
    let names = |group: &Filled| group.names.contains(&one.names[0]);
    if all.iter().any(names) {
        return;
    }
    let alike = |group: &&mut Filled| {
        (group.uniform, group.generator, &group.option, &group.taken_for)
            == (one.uniform, one.generator, &one.option, &one.taken_for)
            && matches!(one.generator, "array" | "interval" | "index" | "constant")
            // Values of a vector are those of its components.
            && one.option.matches(',').count() <= 1
            && (one.generator != "constant" || !one.option.contains(','))
            && group.guessed == one.guessed
    };
    match all.iter_mut().find(alike) {
        Some(group) => group.names.extend(one.names),
        None => all.push(one),
    }
}

fn inputs(filled: &[Filled]) -> String {
    let mut text = String::new();
    for group in filled {
        let names: Vec<String> = group.names.iter().map(|name| format!("{name:?}")).collect();
        let _ = write!(text, "\n[[inputs]] # taken for {}\n", group.taken_for);
        let _ = write!(text, "names = [{}]\ngenerator = {:?}\n{}", names.join(", "), group.generator, group.option);
        if group.guessed {
            text.push_str(GUESSED);
        }
    }
    text
}

/// Which fields are meant.
type Which<'a> = &'a dyn Fn(&Field) -> bool;

/// Laws about whole arrays of numbers.
fn laws(
    fields: &[(&HostBuffer, Field)],
    lengths: &[(String, String, bool)],
    written: Which<'_>,
    varies: Which<'_>,
) -> Vec<(String, String)> {
    let numbers = |field: &Field| field.shape.array.is_some() && field.shape.element_words() == 1;
    let length = |buffer: &HostBuffer| lengths.iter().find(|(name, ..)| *name == buffer.name).map(|(_, text, _)| text);
    let arrays: Vec<&(&HostBuffer, Field)> = fields.iter().filter(|(_, field)| numbers(field)).collect();
    let mut all: Vec<(String, String)> = Vec::new();
    let mut state = |kind: &str, input: &str, law: String| {
        let name = format!("{kind}({input})");
        if all.len() < MOST_LAWS && all.iter().all(|(_, other)| *other != law) {
            all.push((name, law));
        }
    };
    for (buffer, output) in arrays.iter().filter(|(_, field)| written(field)) {
        let out = &output.name;
        for (of, input) in arrays.iter().filter(|(_, field)| varies(field)) {
            let (name, same) = (&input.name, length(of) == length(buffer) && length(of).is_some());
            let both = format!("inputs = [{name:?}], outputs = [{out:?}]");
            if same && input.shape.scalar == output.shape.scalar {
                state("sorts", name, format!("{{ kind = \"sorts\", {both} }}"));
            }
            if same {
                state("prefix", name, format!("{{ kind = \"prefix\", {both} }}"));
            }
            state("unordered", name, format!("{{ kind = \"unordered\", {both} }}"));
            if [input, output].iter().all(|field| field.shape.scalar == Scalar::F32) {
                state("additive", name, format!("{{ kind = \"additive\", {both} }}"));
            }
        }
        if output.shape.scalar == Scalar::F32 {
            state("range", out, format!("{{ kind = \"range\", range = [0.0, 1.0], outputs = [{out:?}] }}"));
        }
    }
    all
}

/// Laws that are tried.
const MOST_LAWS: usize = 16;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn expressions_are_as_a_person_writes_them() {
        assert_eq!(scaled("N".into(), 64, 64, 0), "N");
        assert_eq!(scaled("N".into(), 128, 64, 1), "2 * N + 1");
        assert_eq!(scaled("(N + 63) / 64".into(), 2, 1, 0), "2 * ((N + 63) / 64)");
        assert_eq!(scaled("N".into(), 1, 4, 0), "(N + 3) / 4");
        assert_eq!(scaled("1".into(), 16, 1, 0), "16");
        assert_eq!(product(&["(N + 7) / 8".into(), "1".into(), "1".into()]), "(N + 7) / 8");
        assert_eq!(product(&["WIDTH".into(), "HEIGHT".into(), "1".into()]), "WIDTH * HEIGHT");
    }
}
