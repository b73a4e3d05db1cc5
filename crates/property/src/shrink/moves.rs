//! The candidates of a sample, in a fixed order.

use std::ops::Range;

use crate::Sample;
use base::value::{Record, Scalar, Shape};

use super::Domain;

/// One way to make a sample simpler.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Move {
    /// All inputs to their simplest value.
    All,
    /// All inputs but one.
    AllBut(usize),
    /// One input.
    Input(usize),
    /// All elements of an array but one.
    ElementsBut(usize, usize),
    /// One element of an array or column of a matrix.
    Element(usize, usize),
    /// A version of a group that keeps the laws between its words.
    Lawful(usize, usize),
    /// A change of one word.
    Word(usize, Change),
}

/// A change of one word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    /// 0.
    Zero,
    /// 1.
    One,
    /// -1.
    MinusOne,
    /// The nearest whole number; for whole numbers, half.
    Round,
    /// The next whole number towards zero.
    Toward,
    /// Half the magnitude.
    Half,
    /// Twice the magnitude: small numbers come nearer to 1.
    Double,
    /// The other sign.
    Negate,
    /// This many significant bits behind the first, the rest cut off.
    Cut(u32),
    /// The same, rounded away from zero.
    CutUp(u32),
}

/// Versions of a group that are tried at most.
const LAWFUL: usize = 128;

const CHANGES: [Change; 24] = [
    Change::Zero,
    Change::One,
    Change::MinusOne,
    Change::Round,
    Change::Toward,
    Change::Cut(0),
    Change::CutUp(0),
    Change::Half,
    Change::Double,
    Change::Cut(1),
    Change::CutUp(1),
    Change::Cut(2),
    Change::CutUp(2),
    Change::Cut(3),
    Change::CutUp(3),
    Change::Cut(5),
    Change::CutUp(5),
    Change::Cut(8),
    Change::CutUp(8),
    Change::Cut(12),
    Change::CutUp(12),
    Change::Cut(17),
    Change::CutUp(17),
    Change::Negate,
];

/// All moves of samples with given records.
#[derive(Clone, Debug)]
pub struct Moves {
    inputs: Vec<Input>,
    coarse: Vec<Move>,
    fine: Vec<Move>,
}

#[derive(Clone, Debug)]
struct Input {
    /// Words in the uniforms followed by the invocation.
    words: Range<usize>,
    shape: Shape,
}

impl Input {
    /// Words of a part: an element of an array, else a column of a matrix.
    fn part(&self, index: usize) -> Range<usize> {
        let size = match self.shape.array {
            Some(_) => self.shape.element_words(),
            None => usize::from(self.shape.rows),
        };
        let from = self.words.start + index * size;
        from..from + size
    }

    fn parts(&self) -> usize {
        match self.shape.array {
            Some(_) => self.shape.elements(),
            None => usize::from(self.shape.columns),
        }
    }
}

fn inputs(sample: &Sample) -> Vec<Input> {
    let side = |record: &Record, base: usize| -> Vec<Input> {
        let place = |i| {
            let r: Range<usize> = record.range(i);
            base + r.start..base + r.end
        };
        record.fields().iter().enumerate().map(|(i, f)| Input { words: place(i), shape: f.shape }).collect()
    };
    let mut all = side(&sample.case_record, 0);
    all.extend(side(&sample.invocation_record, sample.case.len()));
    all
}

fn word_at(sample: &mut Sample, index: usize) -> &mut u32 {
    match index.checked_sub(sample.case.len()) {
        None => &mut sample.case[index],
        Some(index) => &mut sample.invocation[index],
    }
}

fn copy(from: &Sample, to: &mut Sample, words: Range<usize>) {
    for i in words {
        let value = match i.checked_sub(from.case.len()) {
            None => from.case[i],
            Some(i) => from.invocation[i],
        };
        *word_at(to, i) = value;
    }
}

/// Zeros, and the identity for square matrices.
pub fn plain(sample: &Sample) -> Sample {
    let mut plain = sample.clone();
    plain.case.fill(0);
    plain.invocation.fill(0);
    for input in inputs(sample) {
        let (columns, rows) = (usize::from(input.shape.columns), usize::from(input.shape.rows));
        if columns > 1 {
            for i in input.words.clone() {
                let at = (i - input.words.start) % input.shape.element_words();
                if at / rows == at % rows {
                    *word_at(&mut plain, i) = 1f32.to_bits();
                }
            }
        }
    }
    plain
}

impl Moves {
    /// The moves of samples with the records of this one, and of a domain with so many groups.
    pub fn new(sample: &Sample, groups: usize) -> Self {
        let inputs = inputs(sample);
        let mut coarse = vec![Move::All];
        coarse.extend((0..inputs.len()).map(Move::AllBut));
        coarse.extend((0..inputs.len()).map(Move::Input));
        coarse.extend((0..groups).flat_map(|g| (0..LAWFUL).map(move |k| Move::Lawful(g, k))));
        for (i, input) in inputs.iter().enumerate().filter(|(_, input)| input.parts() > 1) {
            coarse.extend((0..input.parts()).map(|part| Move::ElementsBut(i, part)));
            coarse.extend((0..input.parts()).map(|part| Move::Element(i, part)));
        }
        let words = sample.case.len() + sample.invocation.len();
        let fine = (0..words).flat_map(|word| CHANGES.map(|change| Move::Word(word, change))).collect();
        Self { inputs, coarse, fine }
    }

    /// Number of moves, coarse and fine.
    pub fn len(&self) -> usize {
        self.coarse.len() + self.fine.len()
    }

    /// Never true: there is always the move of all inputs.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The move with this index, coarse ones first.
    pub fn at(&self, index: usize) -> Move {
        match index.checked_sub(self.coarse.len()) {
            None => self.coarse[index],
            Some(index) => self.fine[index],
        }
    }

    /// All candidates, the fine ones only when asked for.
    pub(super) fn candidates(
        &self,
        sample: &Sample,
        base: &Sample,
        domain: &dyn Domain,
        fine: bool,
        add: &mut dyn FnMut(Sample),
    ) {
        let last = if fine { self.len() } else { self.coarse.len() };
        let mut index = 0;
        while index < last {
            let chosen = self.at(index);
            index += 1;
            match (self.apply(chosen, sample, base, domain), chosen) {
                (Some(candidate), _) => add(candidate),
                // No version of this number: none of a higher one.
                (None, Move::Lawful(_, k)) => index += LAWFUL - 1 - k,
                (None, _) => {}
            }
        }
    }

    /// The candidate of a move; `None` when it would not differ. `base` is the domain's simplest
    /// sample.
    pub fn apply(&self, chosen: Move, sample: &Sample, base: &Sample, domain: &dyn Domain) -> Option<Sample> {
        if let Move::Lawful(group, k) = chosen {
            return domain.simpler(sample, group, k);
        }
        let mut candidate = sample.clone();
        match chosen {
            Move::Lawful(..) => {}
            Move::All => {
                candidate.case.copy_from_slice(&base.case);
                candidate.invocation.copy_from_slice(&base.invocation);
            }
            Move::AllBut(kept) => {
                for (_, input) in self.inputs.iter().enumerate().filter(|(i, _)| *i != kept) {
                    copy(base, &mut candidate, input.words.clone());
                }
            }
            Move::Input(i) => copy(base, &mut candidate, self.inputs[i].words.clone()),
            Move::ElementsBut(i, kept) => {
                for part in (0..self.inputs[i].parts()).filter(|part| *part != kept) {
                    copy(base, &mut candidate, self.inputs[i].part(part));
                }
            }
            Move::Element(i, part) => copy(base, &mut candidate, self.inputs[i].part(part)),
            Move::Word(word, change) => {
                let input = self.inputs.iter().find(|input| input.words.contains(&word))?;
                let at = word_at(&mut candidate, word);
                *at = changed(*at, input.shape.scalar, change)?;
            }
        }
        (candidate != *sample).then_some(candidate)
    }
}

/// A word after a change; `None` when the change means nothing for it.
fn changed(word: u32, scalar: Scalar, change: Change) -> Option<u32> {
    match scalar {
        Scalar::F32 => changed_float(f32::from_bits(word), change).map(f32::to_bits),
        Scalar::I32 => changed_int(i64::from(word as i32), change).map(|v| v as i32 as u32),
        Scalar::U32 => changed_int(i64::from(word), change).filter(|&v| v >= 0).map(|v| v as u32),
        Scalar::Bool => (change == Change::Zero).then_some(0),
    }
}

fn changed_int(value: i64, change: Change) -> Option<i64> {
    match change {
        Change::Zero => Some(0),
        Change::One => Some(1),
        Change::MinusOne => Some(-1),
        Change::Round | Change::Half => Some(value / 2),
        Change::Toward => Some(value - value.signum()),
        Change::Negate => Some(-value),
        // Three quarters: between half and the next.
        Change::Cut(0) => Some(value - value / 4),
        Change::Cut(_) | Change::CutUp(_) | Change::Double => None,
    }
}

fn changed_float(value: f32, change: Change) -> Option<f32> {
    match change {
        Change::Zero => return Some(0.0),
        Change::One => return Some(1.0),
        Change::MinusOne => return Some(-1.0),
        _ if !value.is_finite() || value == 0.0 => return None,
        _ => {}
    }
    let bits = value.to_bits();
    let cut = |keep: u32| bits & !(0x007f_ffff >> keep);
    Some(match change {
        Change::Zero | Change::One | Change::MinusOne => return None,
        Change::Round => value.round(),
        Change::Toward => {
            let next = value - value.signum();
            if value.abs() > 1.0 { next.trunc() } else { return None }
        }
        Change::Half => value * 0.5,
        Change::Double => value * 2.0,
        Change::Negate => -value,
        Change::Cut(keep) => f32::from_bits(cut(keep)),
        // Away from zero: the carry runs into the exponent, which is right.
        Change::CutUp(keep) if cut(keep) != bits => {
            let up = f32::from_bits(cut(keep).wrapping_add(1 << (23 - keep)));
            if up.is_finite() { up } else { return None }
        }
        Change::CutUp(_) => return None,
    })
}
