//! Binary64 that remembers what a program asks of its numbers: comparisons, and the built-in functions with a bend or
//! a jump, which are comparisons too.

use base::value::Scalar;
use program::interp::{
    Binary, Binary64, Class, Comparison, Domain, FromWords, Mask, Plain, SLOTS, Site, ToWords, Unary, WordSource, Words,
};

use super::question::{Question, UNASKED};

type Column = <Binary64 as Domain>::Column;

/// Answers of one slot that are remembered for each question: rounds of loops and components of vectors.
const ROUNDS: usize = 24;

/// Names one answer: the question, and the how many-th time a slot asks it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Key {
    pub site: Site,
    pub question: Question,
    pub round: usize,
}

/// How each slot answered a question in one round.
#[derive(Clone)]
pub struct Answers {
    /// See [`Question::side`]; [`UNASKED`] where a slot did not come here.
    pub sides: [i8; SLOTS],
    /// How far a slot is from another answer, where that is a distance; NaN elsewhere.
    pub gaps: [f32; SLOTS],
}

/// One question at one place.
struct AskedEdge {
    site: Site,
    question: Question,
    /// Times that each slot asked since the chunk began.
    times: [u8; SLOTS],
    rounds: Vec<Answers>,
    /// One bit for each class of arguments that was met; kept over chunks.
    met: u16,
}

/// The domain.
pub struct Watch {
    plain: Binary64,
    asked: Vec<AskedEdge>,
}

impl Watch {
    /// Remembers what is asked of numbers as `plain` computes them.
    pub fn new(plain: Binary64) -> Self {
        Self { plain, asked: Vec::new() }
    }

    /// The answers of the last chunk.
    pub fn answers(&self) -> impl Iterator<Item = (Key, &Answers)> {
        self.asked.iter().flat_map(|asked| {
            let used = usize::from(asked.times.iter().copied().max().unwrap_or(0));
            let rounds = asked.rounds.iter().take(used).enumerate();
            rounds.map(|(round, answers)| (Key { site: asked.site, question: asked.question, round }, answers))
        })
    }

    /// The answers to one question in the last chunk; `None` when no slot came there.
    pub fn answer(&self, key: Key) -> Option<&Answers> {
        let asked = self.asked.iter().find(|asked| (asked.site, asked.question) == (key.site, key.question))?;
        asked.rounds.get(key.round)
    }

    /// The classes of arguments that were met in all chunks, one bit for each, by place and question.
    pub fn met(&self) -> impl Iterator<Item = (Site, Question, u16)> {
        self.asked.iter().map(|asked| (asked.site, asked.question, asked.met))
    }

    fn note(&mut self, site: Site, question: Question, active: &Mask, side: impl Fn(usize) -> (i8, f64, u8)) {
        let at = self.asked.iter().position(|asked| (asked.site, asked.question) == (site, question));
        let at = at.unwrap_or_else(|| {
            self.asked.push(AskedEdge { site, question, times: [0; SLOTS], rounds: Vec::new(), met: 0 });
            self.asked.len() - 1
        });
        let asked = &mut self.asked[at];
        active.each(|slot| {
            let (side, gap, class) = side(slot);
            asked.met |= 1 << class;
            let round = usize::from(asked.times[slot]);
            if round == ROUNDS || !question.is_searched() {
                return;
            }
            if round == asked.rounds.len() {
                asked.rounds.push(Answers { sides: [UNASKED; SLOTS], gaps: [f32::NAN; SLOTS] });
            }
            let answers = &mut asked.rounds[round];
            (answers.sides[slot], answers.gaps[slot]) = (side, gap as f32);
            asked.times[slot] += 1;
        });
    }
}

impl Domain for Watch {
    type Column = Column;
    type Word = <Binary64 as Domain>::Word;

    fn begin(&mut self) {
        for asked in &mut self.asked {
            asked.times = [0; SLOTS];
            for round in &mut asked.rounds {
                round.sides = [UNASKED; SLOTS];
                round.gaps = [f32::NAN; SLOTS];
            }
        }
    }

    fn column(&mut self) -> Column {
        self.plain.column()
    }

    fn constant(&mut self, site: Option<Site>, value: f32, out: &mut Column) {
        self.plain.constant(site, value, out);
    }

    fn input(&mut self, source: WordSource, words: &Words, out: &mut Column) {
        self.plain.input(source, words, out);
    }

    fn unary(&mut self, site: Site, op: Unary, active: &Mask, a: &Column, out: &mut Column) {
        if let Some(question) = Question::of_unary(op) {
            let a = a.values();
            self.note(site, question, active, |slot| question.answer(a[slot], 0.0));
        }
        self.plain.unary(site, op, active, a, out);
    }

    fn binary(&mut self, site: Site, op: Binary, active: &Mask, a: &Column, b: &Column, out: &mut Column) {
        if let Some(question) = Question::of_binary(op) {
            let (a, b) = (a.values(), b.values());
            self.note(site, question, active, |slot| question.answer(a[slot], b[slot]));
        }
        self.plain.binary(site, op, active, a, b, out);
    }

    fn scale(&mut self, site: Site, a: &Column, exponent: &Words, out: &mut Column) {
        self.plain.scale(site, a, exponent, out);
    }

    fn compare(&mut self, site: Site, op: Comparison, active: &Mask, a: &Column, b: &Column, out: &mut Words) {
        let question = Question::Comparison(op);
        let (left, right) = (a.values(), b.values());
        self.note(site, question, active, |slot| question.answer(left[slot], right[slot]));
        self.plain.compare(site, op, active, a, b, out);
    }

    fn compare_words(&mut self, site: Site, op: Comparison, signed: bool, active: &Mask, a: &Words, b: &Words) {
        let question = Question::Comparison(op);
        let number = |word: u32| if signed { f64::from(word.cast_signed()) } else { f64::from(word) };
        self.note(site, question, active, |slot| question.answer(number(a[slot]), number(b[slot])));
    }

    fn classify(&mut self, site: Site, class: Class, active: &Mask, a: &Column, out: &mut Words) {
        self.plain.classify(site, class, active, a, out);
    }

    fn words_of(&mut self, site: Site, op: ToWords, active: &Mask, a: &Column, out: &mut Words) -> Mask {
        if let Some(question) = Question::of_conversion(op) {
            let a = a.values();
            self.note(site, question, active, |slot| question.answer(a[slot], 0.0));
        }
        self.plain.words_of(site, op, active, a, out)
    }

    fn reals_of(&mut self, site: Site, op: FromWords, a: &Words, out: &mut Column) {
        self.plain.reals_of(site, op, a, out);
    }

    fn copy(&mut self, from: &Column, to: &mut Column) {
        self.plain.copy(from, to);
    }

    fn merge(&mut self, mask: &Mask, from: &Column, to: &mut Column) {
        self.plain.merge(mask, from, to);
    }

    fn poison(&mut self, mask: &Mask, to: &mut Column) {
        self.plain.poison(mask, to);
    }

    fn word(&self, column: &Column, slot: usize) -> Option<Self::Word> {
        self.plain.word(column, slot)
    }

    fn exact(word: u32, scalar: Scalar) -> Self::Word {
        <Plain<f64> as Domain>::exact(word, scalar)
    }
}
