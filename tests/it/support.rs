//! What several tests build: suites with a part changed, short runs of them, and devices with a fault planted between the
//! device and what is accepted from it.

use std::cell::Cell;
use std::ops::ControlFlow;
use std::rc::Rc;

use base::text::SourceFile;
use base::value::Batch;
use engine::shard::Shard;
use engine::suite::run::{DEFAULT_SEED, Part, Prepared, Report, Request, Share, prepare, run, run_part};
use engine::suite::{Suite, find, parse};
use judge::profile::Promises;
use lanes::{Actual, Api, Description, Lane, LaneError, Marks, Runner, Stage};
use program::{Kernel, OutputLayout};

/// A shipped suite, made ready.
pub fn prepared(suite: &str) -> Prepared {
    changed(suite, |suite| suite, str::to_owned)
}

/// A shipped suite with another text in the place of a part of its shader.
pub fn replaced(suite: &str, from: &str, to: &str) -> Prepared {
    let replace = |text: &str| {
        assert!(text.contains(from), "{suite}: {from}");
        text.replacen(from, to, 1)
    };
    changed(suite, |suite| suite, replace)
}

/// A shipped suite with changes of the suite and of the text of its shader.
pub fn changed(name: &str, suite: impl FnOnce(Suite) -> Suite, text: impl FnOnce(&str) -> String) -> Prepared {
    let shipped = find(name).unwrap();
    let parsed = parse(&SourceFile::new(shipped.path, shipped.toml)).unwrap();
    let shader = SourceFile::new(shipped.shader_name, text(shipped.shader_text));
    prepare(&suite(parsed), &shader).unwrap_or_else(|error| panic!("{name}: {error}\n{}", shader.text()))
}

/// What is asked of a short run; as many samples as the suite says for `None`.
pub fn request(prepared: &Prepared, samples: Option<u64>, promises: Promises) -> Request {
    Request {
        samples,
        seed: DEFAULT_SEED,
        quick: true,
        replay: Vec::new(),
        replay_only: false,
        promises,
        arguments: prepared.suite.name.clone(),
    }
}

/// A run in the compute stage as a whole, to be joined with those of other lanes.
pub fn part(prepared: &Prepared, lane: &dyn Lane, request: &Request) -> Result<Part, LaneError> {
    let mut save = |_: &_| ControlFlow::Continue(());
    let share = Share { shard: Shard::WHOLE, resume: None, save: &mut save, partial: false };
    Ok(run_part(prepared, lane, (Stage::Compute, None), request, share, &mut |_| {})?.unwrap())
}

/// A short run in the compute stage.
pub fn report(prepared: &Prepared, lane: &dyn Lane, samples: Option<u64>, promises: Promises) -> Report {
    run(prepared, lane, Stage::Compute, &request(prepared, samples, promises), &mut |_| {}).unwrap()
}

/// What one dispatch left in the output buffer.
pub struct Dispatch<'a> {
    pub batch: &'a Batch,
    pub layout: OutputLayout,
    pub words: Vec<u32>,
    pub marks: Marks,
    /// Invocations.
    pub count: usize,
    /// Number of this dispatch of its runner, from 0.
    pub number: usize,
    /// The same among all dispatches of the suite's shader on the lane.
    pub of_lane: usize,
    /// The words of the runner's dispatch before.
    pub before: Vec<u32>,
}

impl Dispatch<'_> {
    /// Record of an invocation.
    pub fn record(&mut self, invocation: usize) -> &mut [u32] {
        let size = self.layout.words();
        &mut self.words[invocation * size..][..size]
    }

    /// Outputs of an invocation, from the first one on.
    pub fn out(&mut self, invocation: usize) -> &mut [u32] {
        let first = self.layout.header_words() + usize::from(self.layout.max_vertices.is_some());
        &mut self.record(invocation)[first..]
    }

    /// Changes the first output of each invocation for which `wrong` is true.
    pub fn each(&mut self, wrong: impl Fn(&Self, usize) -> bool, change: impl Fn(f32) -> f32) {
        for k in (0..self.count).filter(|&k| wrong(self, k)).collect::<Vec<_>>() {
            let word = &mut self.out(k)[0];
            *word = change(f32::from_bits(*word)).to_bits();
        }
    }
}

type Plant = Rc<dyn Fn(&mut Dispatch<'_>)>;

/// A lane with a fault in what it gives for the suite's shader. Kernels with other outputs, which look into a failure,
/// have none: it would not be the one that was planted.
pub struct Planted {
    lane: Box<dyn Lane>,
    pub description: Description,
    layout: OutputLayout,
    plant: Option<Plant>,
    takes: fn(&Kernel) -> bool,
    capacity: usize,
    crashes: bool,
    dispatches: Rc<Cell<usize>>,
}

impl Planted {
    /// A lane without a fault, for a suite.
    pub fn new(lane: Box<dyn Lane>, prepared: &Prepared) -> Self {
        Self {
            description: lane.description().clone(),
            lane,
            layout: prepared.program.output_layout(),
            plant: None,
            takes: |_| true,
            capacity: usize::MAX,
            crashes: false,
            dispatches: Rc::default(),
        }
    }

    /// The same with a fault in each dispatch.
    pub fn with(self, plant: impl Fn(&mut Dispatch<'_>) + 'static) -> Self {
        Self { plant: Some(Rc::new(plant)), ..self }
    }

    /// The fault in these kernels alone.
    pub fn only(self, takes: fn(&Kernel) -> bool) -> Self {
        Self { takes, ..self }
    }

    /// Dispatches of at most so many invocations.
    pub fn in_batches_of(self, capacity: usize) -> Self {
        Self { capacity, ..self }
    }

    /// A lane that crashes on whatever it runs.
    pub fn crashing(self) -> Self {
        Self { crashes: true, ..self }
    }

    /// The lane under another name, with other parts.
    pub fn called(mut self, name: &'static str, executor: &str, front_end: &str, api: Api) -> Self {
        self.description = Description {
            name,
            driver: format!("{executor} 1.0"),
            executor: executor.to_owned(),
            front_end: front_end.to_owned(),
            api,
            stages: vec![Stage::Compute],
        };
        self
    }

    /// Dispatches of the suite's shader so far.
    pub fn dispatches(&self) -> usize {
        self.dispatches.get()
    }
}

impl Lane for Planted {
    fn description(&self) -> &Description {
        &self.description
    }

    fn calls_functions(&self) -> bool {
        self.lane.calls_functions()
    }

    fn prepare(&self, kernel: &Kernel, capacity: usize) -> Result<Box<dyn Runner>, LaneError> {
        if self.crashes {
            return Ok(Box::new(Crashing));
        }
        let runner = self.lane.prepare(kernel, capacity)?;
        let Some(plant) = self.plant.clone().filter(|_| kernel.output == self.layout && (self.takes)(kernel)) else {
            return Ok(runner);
        };
        let (layout, dispatches) = (kernel.output.clone(), Rc::clone(&self.dispatches));
        Ok(Box::new(PlantedRunner {
            runner,
            plant,
            layout,
            capacity: self.capacity,
            number: 0,
            dispatches,
            before: Vec::new(),
        }))
    }
}

struct PlantedRunner {
    runner: Box<dyn Runner>,
    plant: Plant,
    layout: OutputLayout,
    capacity: usize,
    number: usize,
    dispatches: Rc<Cell<usize>>,
    before: Vec<u32>,
}

impl Runner for PlantedRunner {
    fn capacity(&self) -> usize {
        self.runner.capacity().min(self.capacity)
    }

    fn run(&mut self, batch: &Batch) -> Result<Actual, LaneError> {
        let actual = self.runner.run(batch)?;
        let marks = Marks::random();
        let words = raw(&actual, &self.layout, marks);
        let before = std::mem::replace(&mut self.before, words.clone());
        let of_lane = self.dispatches.replace(self.dispatches.get() + 1);
        let (count, number, layout) = (actual.count(), self.number, self.layout.clone());
        self.number += 1;
        let mut dispatch = Dispatch { batch, layout, words, marks, count, number, of_lane, before };
        (self.plant)(&mut dispatch);
        Actual::accept(&self.layout, dispatch.words, count, marks)
    }
}

struct Crashing;

impl Runner for Crashing {
    fn capacity(&self) -> usize {
        1 << 16
    }

    fn run(&mut self, batch: &Batch) -> Result<Actual, LaneError> {
        let count = batch.invocation_count();
        Err(LaneError::Lost { how: "crashed".to_owned(), invocation: None, count, inputs: String::new() })
    }
}

/// The output buffer from which `actual` was read, with other marks.
fn raw(actual: &Actual, layout: &OutputLayout, marks: Marks) -> Vec<u32> {
    let mut words = Vec::with_capacity(actual.count() * layout.words());
    for invocation in 0..actual.count() {
        words.push(marks.canary ^ invocation as u32);
        if layout.max_vertices.is_some() {
            words.extend([actual.emitted(invocation), actual.ended_strips(invocation)]);
        }
        for vertex in 0..actual.stored(invocation) {
            if layout.max_vertices.is_some() {
                words.push(actual.strip(invocation, vertex));
            }
            let value = |&word: &u32| if actual.is_unwritten(word) { marks.sentinel } else { word };
            words.extend(actual.vertex(invocation, vertex).iter().map(value));
        }
        words.resize((invocation + 1) * layout.words(), marks.sentinel);
    }
    words
}
