//! Deviations of the shader: literals with too few digits, operations without a value.

use std::sync::Arc;

use super::{Diagnosis, NoValue, Place, ShortLiteral};
use crate::verdict::fit::open_samples;
use crate::verdict::judge::{Deviation, Value};
use crate::verdict::oracle::JudgeContext;
use crate::verdict::rounded::CONSTANTS;
use base::value::Batch;
use program::Program;
use program::interp::{Binary64, FUEL, Machine, OutputColumn, Site, author_span};

/// How near a literal must be to a constant to stand for it: 3.1 is taken for π.
const NEAR: f64 = 2e-2;

/// What explains that the shader deviates from its formula on the one sample of a batch.
pub fn shader(context: &JudgeContext<'_>, program: &Program, batch: &Batch, deviation: &Deviation) -> Diagnosis {
    let no_value =
        deviation.value().filter(|v| !v.meaning.is_finite()).and_then(|v| no_value(context, program, batch, v));
    let written = written(context, program, batch, deviation);
    Diagnosis { literals: literals(context, program, batch), no_value, written, ..Diagnosis::default() }
}

/// Where the component that deviates gets its value.
pub(super) fn written(
    context: &JudgeContext<'_>,
    program: &Program,
    batch: &Batch,
    deviation: &Deviation,
) -> Option<Place> {
    let value = deviation.value()?;
    let mut machine = context.oracle.ideal_tape();
    machine.run_some(batch, &[0]);
    let layout = program.output_layout();
    let word = (0..layout.vertex.words()).find(|&word| layout.vertex.word_name(word) == value.component)?;
    let OutputColumn::Real(&column) = machine.output(value.vertex.unwrap_or(0), word) else { return None };
    place(context, program, machine.domain().site_of(column, 0)?)
}

/// The place of a site in the author's text.
pub(super) fn place(context: &JudgeContext<'_>, program: &Program, site: Site) -> Option<Place> {
    let span = author_span(program, &context.oracle.executable.place(site))?;
    Some(Place::of(&program.file, span))
}

fn no_value(context: &JudgeContext<'_>, program: &Program, batch: &Batch, value: &Value) -> Option<NoValue> {
    let mut machine = context.oracle.ideal_tape();
    machine.run_some(batch, &[0]);
    let layout = program.output_layout();
    let word = (0..layout.vertex.words()).find(|&word| layout.vertex.word_name(word) == value.component)?;
    let OutputColumn::Real(&column) = machine.output(value.vertex.unwrap_or(0), word) else { return None };
    let cause = machine.domain().cause(column, 0)?;
    Some(NoValue { place: cause.site.and_then(|site| place(context, program, site)), op: cause.op, args: cause.args })
}

/// Literals that make the shader fit its formula once they have all their digits.
fn literals(context: &JudgeContext<'_>, program: &Program, batch: &Batch) -> Vec<ShortLiteral> {
    let oracle = context.oracle;
    let written = |site: Site, value: f32| oracle.literals[site.index()].map_or(f64::from(value), |l| l.value);
    let mut candidates = Vec::new();
    for (site, value) in oracle.executable.literals() {
        let value = written(site, value);
        let nearest = CONSTANTS
            .iter()
            .map(|&(name, constant)| (name, constant.copysign(value)))
            .filter(|(_, constant)| (value - constant).abs() <= NEAR * constant.abs())
            .min_by(|a, b| (value - a.1).abs().total_cmp(&(value - b.1).abs()));
        if let Some((name, constant)) = nearest.filter(|(_, constant)| (value - constant).abs() > 1e-15 * value.abs()) {
            candidates.push((site, name, constant, value));
        }
    }
    let fits = |chosen: &[usize]| {
        let mut numbers = vec![f64::NAN; oracle.executable.site_count()];
        for (site, value) in oracle.executable.literals() {
            numbers[site.index()] = written(site, value);
        }
        for &k in chosen {
            numbers[candidates[k].0.index()] = candidates[k].2;
        }
        let numbers: Arc<[f64]> = numbers.into();
        let mut machine = Machine::new(&oracle.executable, Binary64::with_literals(numbers), FUEL);
        open_samples(context, &mut machine, batch, 0).is_empty()
    };
    let single = (0..candidates.len()).find(|&k| fits(&[k])).map(|k| vec![k]);
    let all: Vec<usize> = (0..candidates.len()).collect();
    let chosen = single.or_else(|| (candidates.len() > 1 && fits(&all)).then(|| needed(all, &fits)));
    let literal = |k: usize| {
        let (site, stands_for, constant, value) = candidates[k];
        Some(ShortLiteral {
            place: place(context, program, site)?,
            stands_for: stands_for.into(),
            off: (value - constant).abs(),
        })
    };
    chosen.unwrap_or_default().into_iter().filter_map(literal).collect()
}

/// Leaves out of a set that fits what it fits without.
fn needed(mut all: Vec<usize>, fits: &dyn Fn(&[usize]) -> bool) -> Vec<usize> {
    let mut k = 0;
    while k < all.len() {
        let fewer: Vec<usize> = all.iter().enumerate().filter(|(i, _)| *i != k).map(|(_, &c)| c).collect();
        if fits(&fewer) {
            all = fewer;
        } else {
            k += 1;
        }
    }
    all
}
