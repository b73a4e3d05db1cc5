//! A picture of the outputs: a grid of places, and what came out in each.

use std::ops::Range;

use super::{Measured, look, measured};
use crate::suite::run::finding;
use crate::suite::run::trial::Trial;
use crate::suite::run::{Report, Request};
use base::value::{Record, Scalar};
use judge::verdict::{Blame, Closeup, Reason, Seen, Verdict};
use lanes::LaneError;
use property::generators::View;
use property::{Picture, PictureKind, Sample};

/// Frames of a picture that moves.
const FRAMES: usize = 5;
/// Rows of a picture in which each row has a sample of its own, and strands.
const ROWS: usize = 12;
/// Cases that are told with their inputs.
const WORST: usize = 5;

/// A grid of places over time, with what came out in each.
#[derive(Clone, Debug)]
pub struct Scene {
    /// What changes along a row and from row to row.
    pub axes: [Axis; 2],
    /// Names of the frames, at least one.
    pub frames: Vec<String>,
    /// Whether neighbouring rows belong together: a surface; else each row is a curve.
    pub is_surface: bool,
    /// The output that is drawn as a position; none where no output is one.
    pub output: Option<String>,
    /// Where the position should be, frame by frame, then row by row; NaN where there should be none.
    pub expected: Vec<[f64; 3]>,
    /// Where the lane has it; NaN where it has none.
    pub actual: Vec<[f64; 3]>,
    /// What the judge says of each place.
    pub cells: Vec<Cell>,
    /// Lines beside the shape, such as bones, for each frame.
    pub lines: Vec<Vec<[[f64; 3]; 2]>>,
    /// The places with the largest errors beside their bounds, those that deviate first.
    pub worst: Vec<Worst>,
}

/// One side of the grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// Name of the input, or of its component, that changes along this side.
    pub name: String,
    /// Its ends; whole numbers count what has no value.
    pub range: [f64; 2],
    /// Number of places along this side.
    pub count: usize,
}

/// What the judge says of a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// The verdict.
    pub state: State,
    /// Largest error of its words in ULP of their variables; NaN where the lane gave no number.
    pub ulp: f64,
    /// Largest error ÷ bound; NaN where there is no bound.
    pub ratio: f64,
}

/// A verdict in a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// It agrees.
    Agrees,
    /// It deviates, and this side is to blame.
    Deviates(Blame),
    /// It is undetermined.
    Undetermined(Reason),
    /// There is no vertex here, nor should there be.
    Nothing,
}

/// A place with a large error.
#[derive(Clone, Debug)]
pub struct Worst {
    /// Its index in the scene.
    pub place: usize,
    /// Where that is, in words.
    pub at: String,
    /// The output component.
    pub component: String,
    /// All sides of it.
    pub seen: Seen,
    /// Its error in ULP of the variable.
    pub ulp: f64,
    /// Error ÷ bound.
    pub ratio: f64,
    /// The verdict on the sample.
    pub state: State,
    /// A command that runs this sample alone.
    pub reproduce: String,
}

/// Lays out a picture and looks at it on the lane.
pub(super) fn scene(trial: &mut Trial<'_>, request: &Request, report: &Report) -> Result<Option<Scene>, LaneError> {
    let prepared = trial.prepared;
    let Some(picture) = Picture::of(&prepared.plan) else { return Ok(None) };
    let frames = if picture.moves() { FRAMES } else { 1 };
    let mut grid = Grid::of(&picture.kind, frames);
    let stills: Vec<Sample> = match picture.kind {
        PictureKind::Rows(_) => (0..ROWS as u64).map(|case| prepared.plan.sample(request.seed, case, 0)).collect(),
        PictureKind::Square(_) | PictureKind::Shape | PictureKind::Strands(_) => {
            vec![(0..8).map(|case| prepared.plan.sample(request.seed, case, 0)).max_by_key(variety)]
                .into_iter()
                .flatten()
                .collect()
        }
    };
    let record = prepared.compute.output.vertex.clone();
    let position = position(&record);
    let mut scene = Scene {
        axes: grid.axes.clone(),
        frames: Vec::new(),
        is_surface: !matches!(picture.kind, PictureKind::Rows(_) | PictureKind::Strands(_)),
        output: position.as_ref().map(|(name, _)| name.clone()),
        expected: Vec::new(),
        actual: Vec::new(),
        cells: Vec::new(),
        lines: Vec::new(),
        worst: Vec::new(),
    };
    let mut best = Best::default();
    for frame in 0..frames {
        let time = frame as f64 / (frames.max(2) - 1) as f64;
        let samples: Vec<Sample> = grid
            .views(time)
            .into_iter()
            .map(|(row, view)| picture.sample(&stills[row.min(stills.len() - 1)], &view))
            .collect();
        let closeups = look(trial, &samples)?;
        let first = &samples[0];
        let reported = picture.time(first);
        scene.frames.push(
            reported
                .unwrap_or_else(|| if frames > 1 { format!("pose {} of {frames}", frame + 1) } else { String::new() }),
        );
        scene.lines.push(picture.lines(first));
        grid.settle(&closeups);
        for (closeup, sample) in closeups.iter().zip(&samples) {
            let state = state(&closeup.verdict);
            for vertex in 0..grid.per_sample {
                let place = scene.cells.len();
                let words = closeup.vertices.get(vertex);
                let (expected, actual) = words
                    .and_then(|words| Some((words, position.as_ref()?)))
                    .map_or(([f64::NAN; 3], [f64::NAN; 3]), |(words, (_, at))| points(words, at));
                scene.expected.push(expected);
                scene.actual.push(actual);
                let Some(words) = words else {
                    scene.cells.push(Cell { state: State::Nothing, ulp: 0.0, ratio: f64::NAN });
                    continue;
                };
                let cell = cell(words, &record, state);
                scene.cells.push(cell);
                best.see(SceneCandidate::new(place, frame, words, &record, cell), &grid.axes, sample);
            }
        }
    }
    scene.axes = grid.axes.clone();
    let on = (report.lane, (report.stage, report.source));
    scene.worst = best
        .taken()
        .into_iter()
        .map(|(found, sample)| found.worst(&scene, &record, finding::reproduce(request, on, &sample)))
        .collect();
    Ok(Some(scene))
}

/// How many different words a sample has: special ones, with everything in one place, show little.
fn variety(sample: &Sample) -> usize {
    let words: std::collections::BTreeSet<u32> = sample.invocation.iter().chain(&sample.case).copied().collect();
    words.len()
}

/// The places of a picture.
struct Grid {
    axes: [Axis; 2],
    /// Places that one sample gives: more than one for a geometry stage.
    per_sample: usize,
    strands: Option<usize>,
    settled: bool,
}

impl Grid {
    fn of(kind: &PictureKind, frames: usize) -> Self {
        let axis = |name: &str, range: [f64; 2], count: usize| Axis { name: name.to_owned(), range, count };
        let count = |still: usize, moving: usize| if frames > 1 { moving } else { still };
        let axes = match kind {
            PictureKind::Square([first, last]) => {
                [axis(&first.name, first.range, count(65, 33)), axis(&last.name, last.range, count(49, 25))]
            }
            PictureKind::Rows(only) => {
                [axis(&only.name, only.range, 97), axis("sample", [0.0, (ROWS - 1) as f64], ROWS)]
            }
            PictureKind::Shape => {
                [axis("along the shape", [0.0, 1.0], count(49, 37)), axis("around it", [0.0, 1.0], count(25, 21))]
            }
            PictureKind::Strands(strands) => [
                axis("segment of the strand", [0.0, strands.primitives() as f64], strands.primitives()),
                axis("strand", [0.0, (ROWS - 1) as f64], ROWS),
            ],
        };
        let strands = match kind {
            PictureKind::Strands(strands) => Some(strands.primitives()),
            PictureKind::Square(_) | PictureKind::Rows(_) | PictureKind::Shape => None,
        };
        Self { axes, per_sample: 1, strands, settled: false }
    }

    /// Every sample of a frame with its row.
    fn views(&self, frame: f64) -> Vec<(usize, View)> {
        let [columns, rows] = [&self.axes[0], &self.axes[1]].map(|axis| axis.count);
        let columns = self.strands.unwrap_or(columns);
        let part = |k: usize, n: usize| k as f64 / (n.max(2) - 1) as f64;
        let view = |row: usize, column: usize| View {
            at: [part(column, columns), part(row, rows)],
            frame,
            shape: 0,
            strand: (row, rows),
            primitive: column,
        };
        (0..rows).flat_map(|row| (0..columns).map(move |column| (row, view(row, column)))).collect()
    }

    /// Takes over how many vertices a sample gives.
    fn settle(&mut self, closeups: &[Closeup]) {
        if let (Some(primitives), false) = (self.strands, self.settled) {
            self.per_sample = closeups.iter().map(|closeup| closeup.vertices.len()).max().unwrap_or(1).max(1);
            self.axes[0].count = primitives * self.per_sample;
        }
        self.settled = true;
    }
}

/// The output that is a position: `gl_Position`, else the first vector.
fn position(record: &Record) -> Option<(String, Range<usize>)> {
    let vector = |k: &usize| {
        let shape = record.fields()[*k].shape;
        shape.scalar == Scalar::F32 && shape.columns == 1 && shape.rows > 1 && shape.array.is_none()
    };
    let found = record.index_of("gl_Position").filter(vector).or_else(|| (0..record.fields().len()).find(vector))?;
    Some((record.fields()[found].name.clone(), record.range(found)))
}

/// Where a vertex should be and where it is. Four components are those of a projective point, unless it
/// should be a direction.
fn points(words: &[Seen], at: &Range<usize>) -> ([f64; 3], [f64; 3]) {
    let words = &words[at.clone()];
    let divide = words.get(3).is_some_and(|w| w.target() != 0.0);
    let point = |of: &dyn Fn(&Seen) -> f64| {
        let w = if divide { of(&words[3]) } else { 1.0 };
        std::array::from_fn(|c| words.get(c).map_or(0.0, |seen| of(seen) / w))
    };
    (point(&|seen| seen.target()), point(&|seen| seen.actual))
}

fn state(verdict: &Verdict) -> State {
    match verdict {
        Verdict::Agree(_) => State::Agrees,
        Verdict::Deviate(deviation) => State::Deviates(deviation.blame),
        Verdict::Undetermined(doubt) => State::Undetermined(doubt.reason),
    }
}

fn cell(words: &[Seen], record: &Record, state: State) -> Cell {
    let mut cell = Cell { state, ulp: 0.0, ratio: 0.0 };
    for word in measured(words, record) {
        // NaN is the largest of all, in both: a lane without a number, and no bound to divide by.
        cell.ulp = if cell.ulp.is_nan() || word.error.is_nan() { f64::NAN } else { cell.ulp.max(word.error) };
        let ratio = word.ratio();
        cell.ratio = if cell.ratio.is_nan() || ratio.is_nan() { f64::NAN } else { cell.ratio.max(ratio) };
    }
    cell
}

/// A place that may be among the worst.
struct SceneCandidate {
    place: usize,
    frame: usize,
    seen: Option<(Measured, Seen)>,
    state: State,
    rank: (u8, f64),
}

impl SceneCandidate {
    fn new(place: usize, frame: usize, words: &[Seen], record: &Record, cell: Cell) -> Self {
        let weight = |word: &Measured| if word.ratio().is_nan() { -1.0 } else { word.ratio() };
        let worst = measured(words, record).max_by(|a, b| weight(a).total_cmp(&weight(b)));
        let kind = match cell.state {
            State::Deviates(_) => 2,
            State::Agrees => 1,
            State::Undetermined(_) | State::Nothing => 0,
        };
        let rank = (kind, worst.as_ref().map_or(-1.0, weight));
        Self { place, frame, seen: worst.map(|word| (word, words[word.word])), state: cell.state, rank }
    }

    fn is_worse_than(&self, other: &Self) -> bool {
        self.rank.0 > other.rank.0 || (self.rank.0 == other.rank.0 && self.rank.1 > other.rank.1)
    }

    fn worst(self, scene: &Scene, record: &Record, reproduce: String) -> Worst {
        let columns = scene.axes[0].count;
        let (row, column) = (self.place / columns % scene.axes[1].count, self.place % columns);
        let on = |axis: &Axis, k: usize| {
            let part = k as f64 / (axis.count.max(2) - 1) as f64;
            let value = axis.range[0] + (axis.range[1] - axis.range[0]) * part;
            format!("{} {}", axis.name, (value * 1e4).round() / 1e4)
        };
        let mut at = format!("{}, {}", on(&scene.axes[0], column), on(&scene.axes[1], row));
        if scene.frames.len() > 1 {
            at = format!("{at}, {}", scene.frames[self.frame]);
        }
        let (word, seen) = match self.seen {
            Some((word, seen)) => (Some(word), seen),
            None => (None, Seen::NOTHING),
        };
        Worst {
            place: self.place,
            at,
            component: word.map_or_else(|| "shape".to_owned(), |word| record.word_name(word.word)),
            seen,
            ulp: word.map_or(f64::NAN, |word| word.error),
            ratio: word.map_or(f64::NAN, |word| word.ratio()),
            state: self.state,
            reproduce,
        }
    }
}

/// The worst place of each part of a picture: neighbours are mostly the same case.
#[derive(Default)]
struct Best {
    parts: std::collections::BTreeMap<(usize, usize, usize), (SceneCandidate, Sample)>,
}

/// Parts of a side.
const PARTS: usize = 5;

impl Best {
    /// Keeps a place if it is the worst of its part. What deviates is worse than what agrees; places that
    /// are inconclusive, and those without an error, are none of the worst.
    fn see(&mut self, new: SceneCandidate, [across, up]: &[Axis; 2], sample: &Sample) {
        if new.rank.0 == 0 || (new.rank.0 < 2 && new.rank.1 <= 0.0) {
            return;
        }
        let (row, column) = (new.place / across.count % up.count.max(1), new.place % across.count.max(1));
        let part = (new.frame, row * PARTS / up.count.max(1), column * PARTS / across.count.max(1));
        let worse = self.parts.get(&part).is_none_or(|(old, _)| new.is_worse_than(old));
        if worse {
            self.parts.insert(part, (new, sample.clone()));
        }
    }

    fn taken(self) -> Vec<(SceneCandidate, Sample)> {
        let mut all: Vec<(SceneCandidate, Sample)> = self.parts.into_values().collect();
        // Of equals the first stays first.
        all.sort_by(|(a, _), (b, _)| b.rank.0.cmp(&a.rank.0).then(b.rank.1.total_cmp(&a.rank.1)));
        all.truncate(WORST);
        all
    }
}
