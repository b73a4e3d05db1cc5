//! One function from its inputs to what was found.

use std::collections::HashMap;

use super::crossing;
use super::domain::{Domain, Standing, Within};
use super::finding::{Finding, FunctionReport, FuzzFindingKind, Part, Severity};
use super::generate::{batch_size, drawn, stream_key};
use super::guessed;
use super::lanes::OnLane;
use super::lowered::Lowered;
use super::name::{Key, Named, name, place, undefined};
use super::presumed::{described, presumed};
use super::realistic::Realistic;
use super::scan::{Look, Trouble, scan};
use super::shrinking::smallest;
use super::stage;
use super::subject::{Ready, Subject};
use super::words::{cause, message, word_of};
use crate::{InputValue, activity, dispatch};
use base::value::{Batch, Scalar};
use judge::profile::Promises;
use judge::verdict::{Fenced, Oracle, Reference, Rounds, edges};
use lanes::{Lane, LaneName, embedded, interrupt};
use program::Program;
use property::{Sample, regressions};

/// Every sixteenth sample is one that the batch has elsewhere already.
const TWIN: usize = 16;
/// Samples among which edges are sought.
const PILOT: u64 = 512;
/// Samples of inputs as far as they come on phones.
const FAR: u64 = 1 << 13;
/// One sample of so many is of the second part of a run.
const SECOND: u64 = 4;
/// Places that are told for one function; the rest is counted.
const REPORTED: usize = 8;
/// Two outputs are a number and what rounding left of it where one sample of so many shows it, and at least two do: a
/// coincidence of one is none.
const PAIRED: u64 = 1 << 12;

/// What a run is asked for.
#[derive(Clone, Debug)]
pub struct Request {
    /// Samples of each function.
    pub samples: u64,
    /// Seed of the inputs.
    pub seed: u64,
    /// Inputs that are run alone, as `name=words` parts.
    pub case: Option<String>,
    /// Notes are shrunk as findings are; without it they are told with the first sample that shows them.
    pub notes: bool,
    /// All inputs alike: none is taken for anything, and there is no second part.
    pub arbitrary: bool,
    /// A signed integer that does not fit counts as other operations on integers do, although languages let it wrap.
    pub strict_integers: bool,
    /// The first lane that runs the function is enough, unless it is at fault: the others tell then whose fault it is.
    pub first_lane: bool,
    /// The command line up to the function, for reproduction.
    pub command: String,
}

/// Trouble with one name.
struct FindingGroup {
    count: u64,
    counting: u64,
    /// One that shows it, of those that say most, and what it says.
    sample: Sample,
    named: Named,
    standing: Standing,
    /// The one with the largest error of these.
    worst: (f64, Sample),
}

/// What a run makes of samples.
#[derive(Clone, Copy)]
struct Looked<'a> {
    ready: &'a Ready,
    domain: &'a Domain,
    /// The same for inputs that nobody stated.
    presumed: &'a Domain,
    /// Samples by what inputs are taken for come first; otherwise all are alike.
    in_parts: bool,
    /// The usual size of each output word.
    sizes: &'a [f64],
}

impl Looked<'_> {
    /// The domain of a part.
    fn of(&self, part: Part) -> &Domain {
        if self.in_parts && part == Part::Arbitrary { self.presumed } else { self.domain }
    }

    fn standing(&self, part: Part, sample: &Sample) -> Standing {
        let counts = self.domain.counts(sample) && self.of(part).keeps(sample);
        match part {
            Part::Realistic if self.in_parts => Standing::Counts,
            _ if !counts => Standing::Extreme,
            Part::Arbitrary if self.in_parts => Standing::Unstated,
            Part::Realistic | Part::Arbitrary => Standing::Counts,
        }
    }

    /// What a sample may be shrunk to.
    fn within(&self, standing: Standing) -> Within<'_> {
        match standing {
            Standing::Counts if self.in_parts => Within::Realistic(&self.ready.realistic),
            Standing::Counts | Standing::Unstated => Within::Moderate,
            Standing::Extreme => Within::Laws,
        }
    }

    /// The part that something was found in, by the samples that say most.
    fn part(&self, standing: Standing) -> Part {
        if standing == Standing::Counts && (self.in_parts || self.domain.is_stated()) {
            Part::Realistic
        } else {
            Part::Arbitrary
        }
    }
}

/// Runs a function on lanes. `Err` for a case that does not fit its inputs.
///
/// # Errors
/// What is wrong with the case that was asked for.
pub fn run(
    subject: &Subject,
    domain: &Domain,
    lanes: &[(&dyn Lane, Promises)],
    request: &Request,
) -> Result<FunctionReport, String> {
    let report = run_on(subject, domain, lanes, request)?;
    if request.first_lane && report.findings.iter().any(|finding| finding.kind.is_of_a_lane()) && !interrupt::asked() {
        return run_on(subject, domain, lanes, &Request { first_lane: false, ..request.clone() });
    }
    Ok(report)
}

fn run_on(
    subject: &Subject,
    domain: &Domain,
    lanes: &[(&dyn Lane, Promises)],
    request: &Request,
) -> Result<FunctionReport, String> {
    let mut report = FunctionReport::nothing(subject);
    if let (Some(Ok(dispatched)), None) = (&subject.dispatch, &request.case) {
        let function = word_of(&subject.label);
        let command = format!("{} --function {function}", request.command);
        dispatch::run(dispatched, subject.made_up, &command, &mut report);
    }
    report.not_dispatched = subject.dispatch.as_ref().and_then(|dispatched| dispatched.as_ref().err()).cloned();
    let ready = match &subject.ready {
        Ok(ready) => ready,
        // What its invocations do together was run.
        Err(_) if report.dispatches > 0 => return Ok(report),
        Err(why) => {
            report.not_run = Some(report.not_dispatched.take().unwrap_or_else(|| why.clone()));
            return Ok(report);
        }
    };
    let _doing = activity::doing(format!("runs `{}`", subject.label));
    report.inputs = described(ready, domain);
    report.textures = ready.program.textures.iter().map(ToString::to_string).collect();
    if report.dispatches == 0 {
        report.first_of_dispatch = ready.program.first_of_dispatch();
    }
    let lowers = lanes.iter().any(|(lane, _)| embedded::lowers(*lane));
    let lowered = || lowers.then(|| Oracle::lowered(&ready.program)).transpose();
    let (oracle, lowered) = match Oracle::new(&ready.program).and_then(|oracle| Ok((oracle, lowered()?))) {
        Ok(oracles) => oracles,
        Err(error) => {
            report.not_run = Some(error.locate(&ready.program));
            return Ok(report);
        }
    };
    let reference = Reference::nothing(&ready.program);
    let case = request.case.as_ref().map(|text| given(ready, text)).transpose()?;
    let (invocation, uniforms) = (&ready.kernel.invocation, &ready.kernel.case);
    let size = batch_size(ready);
    // One sample alone, whatever is asked for.
    let alone = case.is_some() || invocation.words() + uniforms.words() == 0;
    let samples = if alone { 1 } else { request.samples };
    let capacity = size.min(samples as usize);
    let mut on: Vec<OnLane<'_>> = lanes
        .iter()
        .map(|(lane, promises)| {
            let oracle = lowered.as_ref().filter(|_| embedded::lowers(*lane)).unwrap_or(&oracle);
            OnLane::new((*lane, promises), ready, (&reference, oracle), capacity)
        })
        .collect();
    if let Some(first) = on.iter().position(OnLane::runs).filter(|_| request.first_lane) {
        on = vec![on.swap_remove(first)];
    }
    let key = stream_key(request.seed, &subject.label);
    let sizes = crossing::sizes(ready, &drawn(ready, domain, key, (0, crossing::PILOT), !domain.is_stated()));
    // Who gives a case states its inputs.
    let in_parts = !request.arbitrary && !alone && !domain.is_stated();
    if in_parts {
        let all = ready.realistic.taken_for(domain);
        report.taken_for = all.into_iter().map(|taken| taken.map(str::to_owned)).collect();
    }
    let (presumed, names) = presumed(ready, domain);
    report.presumed = if in_parts { names } else { Vec::new() };
    let looked = Looked { ready, domain, presumed: &presumed, in_parts, sizes: &sizes };
    let lowered = Lowered::new(ready);
    let mut running = FuzzRun { looked, key, case, size, on, groups: HashMap::new(), lowered, report };
    let second = if in_parts { samples / SECOND } else { 0 };
    running.samples(Part::Realistic, samples - second);
    running.samples(Part::Arbitrary, second);
    let far = running.far(samples);
    if !alone && !interrupt::asked() {
        running.edges(&oracle, samples);
    }
    let reproduce = |sample: &Sample| {
        let inputs = regressions::inputs_text(sample);
        let function = word_of(&subject.label);
        format!("{} --function {function} --seed {} --case '{inputs}'", request.command, request.seed)
    };
    Ok(running.finish(lanes, request, far, &reproduce))
}

/// A function under way.
struct FuzzRun<'a> {
    looked: Looked<'a>,
    /// Of the inputs.
    key: u64,
    /// The only sample, where one is given.
    case: Option<Sample>,
    /// Samples of one batch at most.
    size: usize,
    on: Vec<OnLane<'a>>,
    groups: HashMap<Key, FindingGroup>,
    lowered: Option<Lowered<'a>>,
    report: FunctionReport,
}

impl<'a> FuzzRun<'a> {
    /// What samples are in binary64 and in binary32.
    fn looks(&self, batch: &Batch) -> Vec<Look> {
        scan(&self.looked.ready.executable, &self.looked.ready.kernel.output.vertex, batch)
    }

    /// Samples of a part, from number `first` on.
    fn batch(&self, part: Part, first: u64, count: usize) -> Batch {
        let Looked { ready, in_parts, .. } = self.looked;
        let realistic = in_parts && part == Part::Realistic;
        let drawn = || drawn(ready, self.looked.of(part), self.key, (first, count), realistic);
        self.case.as_ref().map_or_else(drawn, |sample| Sample::batch(std::slice::from_ref(sample)))
    }

    /// Runs the samples of a part.
    fn samples(&mut self, part: Part, samples: u64) {
        let mut first = 0;
        while first < samples && !interrupt::asked() {
            let count = (samples - first).min(self.size as u64) as usize;
            let mut batch = self.batch(part, first, count);
            let twins = double(&mut batch, count);
            let looks = self.looks(&batch);
            // What was under way when the run was to end is not counted.
            if interrupt::asked() {
                break;
            }
            sort(self.looked, part, &batch, &looks, &mut self.groups, &mut self.report);
            if let (Some(lowered), Part::Realistic) = (&mut self.lowered, part) {
                lowered.look(&batch, &looks);
            }
            // What is undefined may differ from one invocation to the next.
            let twins = twins.into_iter().filter(|&(twin, _)| !looks[twin].undefined).collect();
            let (batch, twins) = that_end(batch, &looks, twins);
            let open = looks.iter().filter(|look| !look.rounds.end()).count() as u64;
            self.on.iter_mut().for_each(|lane| lane.leave_out(open, part));
            if open < looks.len() as u64 {
                self.on.iter_mut().for_each(|lane| lane.run(&batch, &twins, part));
            }
            first += count as u64;
            self.report.samples += count as u64;
            self.report.arbitrary += if part == Part::Arbitrary { count as u64 } else { 0 };
        }
    }

    /// What the lower precision makes of inputs as far as they come on phones.
    fn far(&self, samples: u64) -> Option<(Lowered<'a>, &'a Realistic)> {
        let Looked { ready, domain, in_parts, .. } = self.looked;
        let (far, near) = (ready.far.as_ref()?, self.lowered.as_ref()?);
        if !in_parts || interrupt::asked() {
            return None;
        }
        let records = (&ready.kernel.invocation, &ready.kernel.case);
        let batch = far.batch(records, domain, self.key, 0, samples.min(FAR) as usize);
        let looks = self.looks(&batch);
        let mut lowered = Lowered::far(ready, far.far())?;
        lowered.look(&batch, &looks);
        lowered.leave_out(near);
        Some((lowered, far))
    }

    /// Runs what lies beside the edges of a few samples.
    fn edges(&mut self, oracle: &Oracle, samples: u64) {
        let in_parts = self.looked.in_parts;
        let pilot = self.batch(Part::Realistic, 0, samples.min(PILOT) as usize);
        // What holds beside an edge alone needs an input that is met by chance.
        let part = if in_parts { Part::Arbitrary } else { Part::Realistic };
        let domain = self.looked.of(part);
        let found = edges(oracle, &|sample: &Sample| domain.keeps(sample), &pilot, Vec::new()).samples;
        self.report.edges = found.len() as u64;
        if found.is_empty() {
            return;
        }
        let batch = Sample::batch(&found);
        let mut looks = self.looks(&batch);
        let (kept, _) = that_end(batch.clone(), &looks, Vec::new());
        // Beside a jump rounding takes the other side, whatever the function.
        let moved = looks.iter_mut().filter(|look| look.trouble == Some(Trouble::Moved));
        moved.for_each(|look| *look = Look::default());
        looks.iter_mut().for_each(|look| look.error = 0.0);
        sort(self.looked, part, &batch, &looks, &mut self.groups, &mut self.report);
        if looks.iter().any(|look| look.rounds.end()) {
            self.on.iter_mut().for_each(|lane| lane.run_edges(&kept, part));
        }
    }

    /// What was found.
    fn finish(
        self,
        lanes: &[(&dyn Lane, Promises)],
        request: &Request,
        far: Option<(Lowered<'a>, &'a Realistic)>,
        reproduce: &dyn Fn(&Sample) -> String,
    ) -> FunctionReport {
        let Self { looked, on, mut groups, lowered, mut report, .. } = self;
        let fenced: Vec<(LaneName, Fenced)> = on.iter().filter_map(OnLane::fenced).collect();
        for (lane, fenced) in &fenced {
            report.findings.push(at_failure(looked, lane, fenced, &mut groups, reproduce));
        }
        for lane in on {
            let (lane, findings) = lane.finish(looked.domain, reproduce);
            report.lanes.push(lane);
            report.findings.extend(findings);
        }
        own_translator(lanes, &looked.ready.program, &mut report);
        add_findings(looked, groups, request, reproduce, &mut report);
        let part = looked.part(Standing::Counts);
        if let Some(lowered) = lowered.filter(|_| !interrupt::asked()) {
            let within = looked.within(Standing::Counts);
            report.findings.extend(lowered.findings(looked.domain, within, part, reproduce));
        }
        if let Some((lowered, far)) = far.filter(|_| !interrupt::asked()) {
            report.findings.extend(lowered.findings(looked.domain, Within::Realistic(far), part, reproduce));
        }
        report.findings.sort_by_key(|f| (f.severity, f.kind));
        report
    }
}

/// Makes notes of deviations that come from the translator which this tool puts between a text and a driver, where a lane that
/// does without it is right: no driver is at fault, and no shader.
fn own_translator(lanes: &[(&dyn Lane, Promises)], program: &Program, report: &mut FunctionReport) {
    let FunctionReport { lanes: given, findings, .. } = report;
    let of = |lane: &dyn Lane| given.iter().find(|report| report.lane == lane.description().name);
    let all = lanes.iter().filter_map(|(lane, _)| Some((*lane, of(*lane)?)));
    let Some((right, front_end)) = stage::another(all, program) else { return };
    for finding in findings.iter_mut().filter(|finding| finding.own_translator) {
        finding.severity = Severity::Note;
        finding.message = format!(
            "{}; `{right}` gets the text by {front_end} and is right, so that the translator of this lane is at fault",
            finding.message
        );
    }
}

/// The sample of `--case`.
///
/// # Errors
/// What is wrong with it.
pub fn given(ready: &Ready, text: &str) -> Result<Sample, String> {
    let file = base::text::SourceFile::new("--case", format!("case {text}"));
    let parsed = regressions::parse(&file).map_err(|e| e.to_string())?;
    let first = parsed.first().ok_or("--case is empty; give inputs such as `t=3f000000`")?;
    first.to_sample(&ready.kernel.invocation, &ready.kernel.case).map_err(|e| e.to_string())
}

/// Puts copies of samples into a batch; gives the pairs.
fn double(batch: &mut Batch, count: usize) -> Vec<(usize, usize)> {
    let (words, case_words) = (batch.invocation_record.words(), batch.case_record.words());
    let mut twins = Vec::new();
    for copy in (TWIN - 1..count).step_by(TWIN) {
        // From the other half: another work group, and another thread of most devices.
        let mut from = (copy + count / 2) % count;
        if from % TWIN == TWIN - 1 {
            from -= 1;
        }
        batch.invocations.copy_within(from * words..(from + 1) * words, copy * words);
        batch.cases.copy_within(from * case_words..(from + 1) * case_words, copy * case_words);
        twins.push((from, copy));
    }
    twins
}

/// Sorts samples in trouble by its name.
fn sort(
    looked: Looked<'_>,
    part: Part,
    batch: &Batch,
    looks: &[Look],
    groups: &mut HashMap<Key, FindingGroup>,
    report: &mut FunctionReport,
) {
    let open: Vec<(usize, Look)> =
        looks.iter().copied().enumerate().filter(|(_, look)| look.trouble.is_some()).collect();
    for (invocation, look) in looks.iter().enumerate() {
        if look.error > report.max_error && looked.standing(part, &Sample::of(batch, invocation)) == Standing::Counts {
            report.max_error = look.error;
        }
    }
    for ((invocation, look), named) in open.iter().zip(name(looked.ready, looked.sizes, batch, &open)) {
        let Some(named) = named else { continue };
        let sample = Sample::of(batch, *invocation);
        let standing = looked.standing(part, &sample);
        let group = groups.entry(named.key()).or_insert_with(|| FindingGroup {
            count: 0,
            counting: 0,
            sample: sample.clone(),
            named: named.clone(),
            standing,
            worst: (look.error, sample.clone()),
        });
        group.count += 1;
        group.counting += u64::from(standing == Standing::Counts);
        let first = standing < group.standing;
        if first || (standing == group.standing && look.error > group.worst.0) {
            group.worst = (look.error, sample.clone());
        }
        if first {
            (group.sample, group.named, group.standing) = (sample, named, standing);
        }
    }
}

/// The samples that would hold no device up, those of long loops behind the others; with the pairs among them.
fn that_end(batch: Batch, looks: &[Look], twins: Vec<(usize, usize)>) -> (Batch, Vec<(usize, usize)>) {
    if looks.iter().all(|look| look.rounds == Rounds::Few) {
        return (batch, twins);
    }
    let rounds: Vec<Rounds> = looks.iter().map(|look| look.rounds).collect();
    let order = Rounds::order(&rounds);
    let mut moved = vec![None; looks.len()];
    order.iter().enumerate().for_each(|(to, &from)| moved[from] = Some(to));
    let twins = twins.into_iter().filter_map(|(a, b)| moved[a].zip(moved[b]));
    (batch.apart(order.iter().copied()), twins.collect())
}

/// A failure of a lane where the function's behaviour is undefined; it stands for the group of the same operation.
fn at_failure(
    looked: Looked<'_>,
    lane: &LaneName,
    fenced: &Fenced,
    groups: &mut HashMap<Key, FindingGroup>,
    reproduce: &dyn Fn(&Sample) -> String,
) -> Finding {
    let named = undefined(&fenced.because);
    let alone = FindingGroup {
        count: 1,
        counting: u64::from(looked.domain.counts(&fenced.sample)),
        sample: fenced.sample.clone(),
        named: named.clone(),
        standing: Standing::Counts,
        worst: (0.0, fenced.sample.clone()),
    };
    let group = groups.remove(&named.key()).unwrap_or(alone);
    let finding = finding(looked, Severity::Finding, &named, &fenced.sample, &group, reproduce);
    Finding { lane: Some(lane), message: format!("{}; {}", finding.message, fenced.error.at_undefined()), ..finding }
}

/// Shrinks one sample of each group and adds its finding.
fn add_findings(
    looked: Looked<'_>,
    groups: HashMap<Key, FindingGroup>,
    request: &Request,
    reproduce: &dyn Fn(&Sample) -> String,
    report: &mut FunctionReport,
) {
    let Looked { ready, domain, .. } = looked;
    let stated = domain.is_stated();
    let mut groups: Vec<(Key, FindingGroup)> = groups.into_iter().collect();
    let severity = |key: &Key, group: &FindingGroup| {
        let severity = match key.0 {
            // GLSL 4.60, 4.1.3; WGSL, 8.7; `OpIAdd` of SPIR-V, which HLSL and Slang become: the lower 32 bits are kept.
            FuzzFindingKind::IntegerOverflow if !request.strict_integers => Severity::Note,
            // The angle of a point that may be the centre: a place where programs come.
            FuzzFindingKind::Undefined if !stated && group.named.is_angle_of_nothing() => {
                FuzzFindingKind::NoValue.severity(group.standing, stated).max(Severity::Warning)
            }
            _ if group.named.is_outside_of_texture(ready) => Severity::Note,
            kind => kind.severity(group.standing, stated),
        };
        let looking = (looked.sizes, looked.in_parts);
        let guessed = || guessed::are_needed(ready, domain, looking, &group.sample, key);
        if severity == Severity::Finding && request.case.is_none() && guessed() { Severity::Warning } else { severity }
    };
    let severities: HashMap<Key, Severity> = groups.iter().map(|(key, group)| (*key, severity(key, group))).collect();
    let severity = |key: &Key| severities.get(key).copied().unwrap_or(Severity::Note);
    groups.sort_by_key(|(key, group)| {
        (severity(key), key.0, std::cmp::Reverse(group.counting), key.2.map(|s| s.index()), key.1.map(|op| op.name()))
    });
    let by_chance = |group: &FindingGroup| {
        let paired = group.named.kind == FuzzFindingKind::RoundingOrder && group.named.pair.is_some();
        paired && request.case.is_none() && group.count < (report.samples / PAIRED).max(2)
    };
    groups.retain(|(_, group)| !by_chance(group));
    for (index, (key, group)) in groups.into_iter().enumerate() {
        let severity = severity(&key);
        // Digits that are lost on one way to the outputs are one finding, with all places.
        let ill_conditioned = key.0 == FuzzFindingKind::IllConditioned;
        let same = |f: &&mut Finding| f.kind == key.0 && f.severity == severity && f.lane.is_none();
        if let Some(first) = report.findings.iter_mut().filter(|_| ill_conditioned).find(same) {
            first.count += group.count;
            first.counting += group.counting;
            let there = place(&ready.program, &ready.executable, group.named.site);
            first.also.extend(there.map(|there| (there, group.count)));
            continue;
        }
        let shrunk = request.case.is_none()
            && index < REPORTED
            && !interrupt::asked()
            && (request.notes || severity != Severity::Note);
        let found = (group.sample.clone(), Some(group.named.clone()));
        let (sample, named) = if shrunk {
            let domain = if group.standing == Standing::Counts { domain } else { looked.of(Part::Arbitrary) };
            smallest((ready, looked.sizes), domain, found, key, looked.within(group.standing))
        } else {
            found
        };
        let Some(named) = named else { continue };
        let mut finding = finding(looked, severity, &named, &sample, &group, reproduce);
        if named.kind == FuzzFindingKind::IllConditioned && request.case.is_none() {
            finding.worst = Some((group.worst.0, InputValue::all(&group.worst.1, &ready.program)));
        }
        report.findings.push(finding);
    }
}

fn finding(
    looked: Looked<'_>,
    severity: Severity,
    named: &Named,
    sample: &Sample,
    group: &FindingGroup,
    reproduce: &dyn Fn(&Sample) -> String,
) -> Finding {
    let ready = looked.ready;
    let record = &ready.kernel.output.vertex;
    let (vertex, word) = named.place;
    let output = record.word_name(word);
    let shown = if ready.kernel.output.max_vertices.is_some() {
        format!("{output}` of vertex {vertex}")
    } else {
        format!("{output}`")
    };
    let real = matches!(
        named.kind,
        FuzzFindingKind::NoValue
            | FuzzFindingKind::Infinite
            | FuzzFindingKind::Overflow
            | FuzzFindingKind::Underflow
            | FuzzFindingKind::Lost
            | FuzzFindingKind::IllConditioned
            | FuzzFindingKind::ZeroCrossing
            | FuzzFindingKind::RoundingOrder
            | FuzzFindingKind::TooLarge
    );
    let there = place(&ready.program, &ready.executable, named.site);
    let wrote = there.as_ref().map(|place| place.text.as_str());
    Finding {
        kind: named.kind,
        severity,
        part: looked.part(group.standing),
        cause: Some(cause(named, wrote)),
        message: message(named, &shown, wrote, &ready.program),
        place: there,
        lane: None,
        count: group.count,
        counting: group.counting,
        inputs: InputValue::all(sample, &ready.program),
        output: real.then_some(output),
        meaning: real.then_some(named.meaning),
        found: real.then_some(named.strict.to_bits()),
        scalar: Scalar::F32,
        condition: (named.kind == FuzzFindingKind::IllConditioned && named.condition.is_finite())
            .then_some(named.condition),
        worst: None,
        also: Vec::new(),
        diagnosis: None,
        reproduce: Some(reproduce(sample)),
        own_translator: false,
        better: None,
    }
}
