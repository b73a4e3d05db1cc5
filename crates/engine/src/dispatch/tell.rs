//! What went wrong in a dispatch, in words.

use program::Written;
use program::interp::group::{Access, MemoryShape, Party, Sources, Space, Wrong, apart};
use program::interp::{Finding as Hazard, Site};

use super::host::{Contents, Length, Scenario};
use super::run::{Met, is_spread};
use super::{Dispatched, images};
use crate::InputValue;
use crate::fuzz::{Finding, FuzzFindingKind, Part, Severity, WORKGROUPS, place};
use base::value::Scalar;

impl Dispatched {
    /// An incident as a finding.
    pub(super) fn told(&self, met: &Met, command: &str) -> Finding {
        let incident = &met.incident;
        let shape = incident.memory.and_then(|k| self.executable.memories().get(k as usize));
        let sources = match incident.other {
            Some(other) => [incident.who.site, other.site],
            None => [incident.who.site; 2],
        }
        .map(|site| self.depends.of(site));
        let kind = match incident.what {
            Wrong::Outside => FuzzFindingKind::Index,
            Wrong::Race | Wrong::Unordered | Wrong::SameValue | Wrong::LostUpdate | Wrong::Relaxed => {
                FuzzFindingKind::Race
            }
            Wrong::Divergence | Wrong::Apart => FuzzFindingKind::Divergence,
            Wrong::Unwritten => FuzzFindingKind::Unset,
            Wrong::NotANumber => FuzzFindingKind::NoValue,
        };
        // How numbers of the host lie to each other is a guess.
        let worst = if is_spread(met.scenario.variant) { Severity::Warning } else { Severity::Finding };
        let severity = self.severity(met, shape, sources).max(worst);
        let mut message = self.message(met, shape);
        if (incident.what, severity) == (Wrong::Race, Severity::Warning) {
            message += &self.told_condition(incident);
        }
        message += &met.scenario.told_order();
        self.finding(kind, severity, message, Some(incident.who.site), (incident.count, &met.scenario), command)
    }

    /// A loop that went on for too long.
    pub(super) fn told_endless(&self, hazard: &Hazard, scenario: &Scenario, command: &str) -> Finding {
        let sources = self.depends.of(hazard.site);
        let severity = if sources.is_empty() { Severity::Warning } else { Severity::Note };
        let message = "this loop does not end in reasonable time".to_owned();
        let kind = FuzzFindingKind::Endless;
        self.finding(kind, severity, message, Some(hazard.site), (hazard.count, scenario), command)
    }

    /// Dispatches that were cut off, of so many: what they would have done behind that is not known. Where others came to
    /// their ends, it is the numbers of this host that are large, if it gives any.
    pub(super) fn told_cut_off(&self, count: u64, of: u64, scenario: &Scenario, command: &str) -> Finding {
        let message =
            format!("{count} dispatches went on for too long and were cut off: the rest of them is not judged");
        let severity = if count < of && !scenario.settings.is_empty() { Severity::Note } else { Severity::Warning };
        self.finding(FuzzFindingKind::Endless, severity, message, None, (count, scenario), command)
    }

    /// None of so many dispatches stored anything: the numbers that were chosen for the host kept all invocations away.
    pub(super) fn told_idle(&self, of: u64, scenario: &Scenario, command: &str) -> Finding {
        let message = format!(
            "nothing is stored in any of {of} dispatches, so that nothing of it was tested: state the numbers of its host in a \
             suite; `shadercheck init` begins one"
        );
        let first = self.uses.stores.first().copied();
        self.finding(FuzzFindingKind::NotWritten, Severity::Warning, message, first, (of, scenario), command)
    }

    /// Arrays of which no index is called outside, since nothing says how long they are.
    pub(super) fn told_unknown(&self, lengths: &[Length], scenario: &Scenario, command: &str) -> Option<Finding> {
        let memories = self.executable.memories().iter().zip(lengths);
        let unknown = memories.filter(|(shape, length)| shape.is_open() && matches!(length, Length::Unknown(_)));
        let names: Vec<String> = unknown.map(|(shape, _)| format!("`{}`", shape.name)).collect();
        let message =
            format!("no index into {} is called too large: no rule was found for its length", names.join(", "));
        let kind = FuzzFindingKind::Index;
        (!names.is_empty()).then(|| self.finding(kind, Severity::Note, message, None, (0, scenario), command))
    }

    /// How bad it is: what depends on the numbers of invocations alone holds whatever a host does.
    fn severity(&self, met: &Met, shape: Option<&MemoryShape>, sources: [Sources; 2]) -> Severity {
        let incident = &met.incident;
        let storage = |sources: &Sources| {
            let memories = self.executable.memories().iter().enumerate();
            memories.into_iter().any(|(k, shape)| matches!(shape.space, Space::Storage { .. }) && sources.has(k))
        };
        // Both get to the same element whatever the numbers are: one of many runs is enough.
        let fixed = [Some(incident.who), incident.other];
        let fixed = fixed.into_iter().flatten().all(|party| self.depends.leads(party.site).is_empty());
        let certain = sources.iter().all(|sources| sources.is_empty());
        let by_contents = sources.iter().any(storage);
        // Two writes meet where indices repeat, which they may never do; who reads what another one writes waits for it.
        let meeting = self.meeting(incident);
        let mixed = meeting.mixed;
        let whatever = self.is_met_whatever(&meeting, by_contents);
        let shared = shape.is_some_and(|shape| shape.space == Space::Workgroup);
        match incident.what {
            Wrong::SameValue => Severity::Note,
            _ if met.doubtful => Severity::Note,
            // The author says that it is meant: `diagnostic(off, subgroup_uniformity)`.
            Wrong::Apart if self.program.file.text().contains("subgroup_uniformity") => Severity::Note,
            Wrong::Outside => self.severity_outside(met, shape, certain, by_contents),
            // Devices of today see `coherent` memory behind any barrier, and whoever writes the word means that.
            Wrong::Unordered if self.program.file.text().contains("coherent") => Severity::Note,
            Wrong::Unordered if certain || whatever => Severity::Finding,
            // Whoever read before the barrier has its value, on every device; the language promises it for what the barrier
            // orders.
            Wrong::Unordered if !fixed && incident.other.is_some_and(|other| other.access == Access::Read) => {
                Severity::Note
            }
            Wrong::LostUpdate => Severity::Finding,
            Wrong::Relaxed => Severity::Warning,
            // With random numbers, it is more often a whole number of the host that is guessed wrong.
            Wrong::NotANumber if self.has_matrices() => Severity::Note,
            Wrong::NotANumber if met.scenario.empty.is_some() => Severity::Warning,
            Wrong::NotANumber if matches!(met.scenario.contents, Contents::Signed | Contents::Unit) => Severity::Note,
            Wrong::Unordered | Wrong::NotANumber => Severity::Warning,
            _ if certain => Severity::Finding,
            // Where all invocations take one branch, nobody is missing.
            Wrong::Divergence | Wrong::Apart if !by_contents => Severity::Finding,
            Wrong::Race if whatever => Severity::Finding,
            Wrong::Race | Wrong::Unwritten if shared && (fixed || !by_contents) => Severity::Finding,
            Wrong::Divergence | Wrong::Apart | Wrong::Unwritten => Severity::Warning,
            Wrong::Race if shared || !by_contents || mixed => Severity::Warning,
            Wrong::Race => Severity::Note,
        }
    }

    /// True where a buffer has matrices: equal numbers make them singular, which no host does.
    fn has_matrices(&self) -> bool {
        let storage = self.executable.memories().iter().filter(|shape| matches!(shape.space, Space::Storage { .. }));
        let leaves =
            storage.flat_map(|shape| shape.fixed.iter().chain(shape.array.iter().flat_map(|array| &array.leaves)));
        leaves.into_iter().any(|leaf| leaf.scalar == Scalar::F32 && leaf.component.is_some_and(|k| k > 3))
    }

    /// An index outside of an array: whose length is fixed, or asked for, or guessed.
    fn severity_outside(&self, met: &Met, shape: Option<&MemoryShape>, certain: bool, by_contents: bool) -> Severity {
        let incident = &met.incident;
        // APIs discard stores outside of an image, and load zeros there; many kernels rely on it.
        if shape.is_some_and(|shape| shape.is_image()) {
            let other = self.guarded_by(incident, met.scenario.groups);
            return if other.is_some() { Severity::Warning } else { Severity::Note };
        }
        if met.harmless && incident.who.access == Access::Read {
            return Severity::Note;
        }
        let asked = incident.memory.is_some_and(|memory| self.uses.lengths.contains(&memory));
        let open = shape.is_some_and(|shape| shape.is_open()) && met.length.is_some();
        let led = !self.depends.leads(incident.who.site).is_empty();
        // With one workgroup, it never is: how many there are is a guess.
        let later = shape.is_some_and(|shape| shape.space == Space::Workgroup) && incident.who.group > 0;
        match (open && !asked, by_contents) {
            (false, _) if certain && later => Severity::Warning,
            (false, _) if certain => Severity::Finding,
            // A host may fill up its buffers as it fills up workgroups. Where most invocations without an element are
            // kept away, it does not. What numbers of the host have a say in may be too large for their sakes.
            (true, false)
                if met.guarded
                    && met.length.is_some_and(Length::is_by_elements)
                    && !self.is_by_settings(self.depends.aims(incident.who.site)) =>
            {
                Severity::Finding
            }
            (_, false) => Severity::Warning,
            (false, true) if !led => Severity::Warning,
            (_, true) => Severity::Note,
        }
    }

    fn message(&self, met: &Met, shape: Option<&MemoryShape>) -> String {
        let incident = &met.incident;
        let groups = met.scenario.groups;
        let name = shape.map_or("", |shape| &shape.name);
        let buffer = incident.memory.and_then(|k| met.scenario.buffers.get(k as usize));
        let place = shape.zip(incident.word).map(|(shape, word)| {
            let texel = buffer.and_then(|buffer| images::texel(shape, word, buffer));
            texel.unwrap_or_else(|| format!("`{}`", shape.place(word)))
        });
        let place = place.unwrap_or_default();
        let who = self.invocation(incident.who, groups);
        match (incident.what, incident.other) {
            (Wrong::Outside, _) => {
                let (index, len) = incident.index.unwrap_or_default();
                let does = if incident.who.access == Access::Read { "reads" } else { "writes" };
                let signed = index.cast_signed();
                let index =
                    if signed < 0 && signed > -65_536 { format!("{index} ({signed})") } else { index.to_string() };
                if shape.is_some_and(|shape| shape.is_image()) {
                    let guard = self.guarded_by(incident, groups);
                    let guard = guard.map_or_else(String::new, |other| {
                        format!(": the guard asks for the size of `{}`, which may be larger", other.name)
                    });
                    return format!(
                        "{who} {does} `{name}` at coordinate {index}, outside of its {len} texels along this axis{guard}"
                    );
                }
                if met.is_of_unknown_length(shape) {
                    return format!("{who} {does} `{name}` at index {index}, in front of its first element");
                }
                format!("{who} {does} `{name}` at index {index}, outside of its {len} elements")
            }
            (Wrong::Race, Some(other)) => {
                let ordered = if other.group == incident.who.group {
                    "with no barrier between"
                } else {
                    "and nothing orders two workgroups"
                };
                let own = did(incident.who.access);
                let theirs = did(other.access);
                let at = self.at(other.site);
                let atomic = (incident.who.access, other.access) == (Access::Atomic, Access::Atomic);
                let undone = if atomic { ": the store may undo what the other one does" } else { "" };
                format!(
                    "race on {place}: {who} {own} it, and {} {theirs} it{at}, {ordered}{undone}",
                    self.invocation(other, groups)
                )
            }
            (Wrong::Unordered, Some(other)) => {
                let (own, theirs) = (did(incident.who.access), did(other.access));
                let (at, other) = (self.at(other.site), self.invocation(other, groups));
                let barrier = self.barrier_for(shape);
                format!(
                    "race on {place}: {who} {own} it, and {other} {theirs} it{at}; the barrier between them does not order \
                     this memory, {barrier} does"
                )
            }
            (Wrong::LostUpdate, Some(other)) => format!(
                "lost update of {place}: {who} stores what comes of its load, and {} stored{} since: that is undone",
                self.invocation(other, groups),
                self.at(other.site)
            ),
            (Wrong::Relaxed, Some(other)) => format!(
                "{who} reads {place}, which {} writes{} before an atomic function: atomic functions order no other memory \
                 between workgroups, and no {} lies before it",
                self.invocation(other, groups),
                self.at(other.site),
                self.barrier_for(shape)
            ),
            (Wrong::SameValue, Some(other)) => {
                let other = self.invocation(other, groups);
                format!("{who} and {other} write the same value to {place}, with nothing between")
            }
            (Wrong::Divergence, Some(other)) => {
                format!("{who} does not reach this barrier, at which {} waits", self.invocation(other, groups))
            }
            (Wrong::NotANumber, _) => {
                if let Some(own) = met.scenario.empty.and_then(|n| met.scenario.settings.get(n)) {
                    return format!("{who} writes NaN to {place} where `{}` is 0", own.name);
                }
                let held = met.scenario.contents.told();
                format!("{who} writes NaN to {place}, though nothing that it may read is NaN or infinite: {held}")
            }
            (Wrong::Unwritten, _) => format!("{who} reads {place}, to which nobody has written"),
            (Wrong::Race | Wrong::Unordered | Wrong::SameValue | Wrong::LostUpdate | Wrong::Relaxed, None) => {
                format!("{who} meets another one at {place}")
            }
            (Wrong::Apart, Some(other)) => format!(
                "{who} does not reach this operation of its subgroup, in which {} is",
                self.invocation(other, groups)
            ),
            (Wrong::Divergence, None) => format!("{who} does not reach this barrier"),
            (Wrong::Apart, None) => format!("{who} does not reach this operation of its subgroup"),
        }
    }

    /// What orders a memory within a workgroup, in the author's language.
    fn barrier_for(&self, shape: Option<&MemoryShape>) -> &'static str {
        let kind = shape.map(|shape| (shape.space == Space::Workgroup, shape.is_image()));
        match (self.program.written, kind) {
            (Written::Wgsl, Some((true, _))) => "`workgroupBarrier()`",
            (Written::Wgsl, Some((_, true))) => "`textureBarrier()`",
            (Written::Wgsl, _) => "`storageBarrier()`",
            (Written::Glsl, Some((true, _))) => "`barrier()`",
            (Written::Glsl, Some((_, true))) => "`memoryBarrierImage(); barrier();`",
            (Written::Glsl, _) => "`memoryBarrierBuffer(); barrier();`",
            (Written::Hlsl, Some((true, _))) => "`GroupMemoryBarrierWithGroupSync()`",
            (Written::Hlsl, _) => "`AllMemoryBarrierWithGroupSync()`",
            (Written::SpirV | Written::SpirVAssembly | Written::Slang, _) => {
                "one with its storage class in its semantics"
            }
        }
    }

    /// The author's words for an invocation.
    fn invocation(&self, party: Party, groups: [u32; 3]) -> String {
        let shown = |all: [u32; 3], of: [u32; 3]| match of {
            [_, 1, 1] => all[0].to_string(),
            [_, _, 1] => format!("({}, {})", all[0], all[1]),
            _ => format!("({}, {}, {})", all[0], all[1], all[2]),
        };
        let local = shown(apart(party.local, self.size), self.size);
        if groups == [1; 3] {
            return format!("invocation {local}");
        }
        format!("invocation {local} of workgroup {}", shown(apart(party.group, groups), groups))
    }

    fn at(&self, site: Site) -> String {
        place(&self.program, &self.executable, Some(site)).map_or_else(String::new, |place| format!(" at {}", place.at))
    }

    pub(super) fn finding(
        &self,
        kind: FuzzFindingKind,
        severity: Severity,
        message: String,
        site: Option<Site>,
        (count, scenario): (u64, &Scenario),
        command: &str,
    ) -> Finding {
        Finding {
            kind,
            severity,
            part: Part::Realistic,
            cause: None,
            message,
            place: place(&self.program, &self.executable, site),
            lane: None,
            count,
            counting: count,
            inputs: self.inputs(scenario),
            output: None,
            meaning: None,
            found: None,
            scalar: Scalar::F32,
            condition: None,
            worst: None,
            also: Vec::new(),
            diagnosis: None,
            reproduce: Some(command.to_owned()),
            own_translator: false,
            better: None,
        }
    }

    /// What the host does in a scenario.
    fn inputs(&self, scenario: &Scenario) -> Vec<InputValue> {
        let value = |name: String, words: Vec<u32>| InputValue {
            declared: name.clone(),
            name,
            decimal: words.iter().map(u32::to_string).collect(),
            bits: words,
        };
        let trimmed = |all: [u32; 3]| {
            let len = all.iter().rposition(|&n| n > 1).map_or(1, |last| last + 1);
            all[..len].to_vec()
        };
        let mut all = vec![
            value(WORKGROUPS.to_owned(), trimmed(scenario.groups)),
            value("invocations of each".to_owned(), trimmed(self.size)),
        ];
        if self.executable.has_subgroups() {
            all.push(value("invocations of a subgroup".to_owned(), vec![scenario.subgroup]));
        }
        for (shape, buffer) in self.executable.memories().iter().zip(&scenario.buffers) {
            if let Some((name, sides)) = images::sides_shown(shape, buffer) {
                all.push(value(name, sides));
            } else if shape.array.is_some() {
                all.push(value(format!("elements of `{}`", shape.name), vec![buffer.elements]));
            }
        }
        all.extend(scenario.settings.iter().map(|own| value(own.name.clone(), vec![own.value])));
        all
    }
}

fn did(access: Access) -> &'static str {
    match access {
        Access::Read => "reads",
        Access::Write => "writes",
        Access::Atomic => "changes",
    }
}
