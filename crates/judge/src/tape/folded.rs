//! Pairs of operations on the way to another kind of number and back, as they are where a compiler leaves both out: a number
//! that becomes a binary16 or an integer and a number again keeps the digits that it should have lost.

use super::Tape;
use super::arena::Id;
use program::interp::{FromWords, Mask, Site, ToWords, Words};

/// A pair that is left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fold {
    /// To binary16 and back.
    Half,
    /// To a signed integer and back.
    Signed,
    /// To an unsigned integer and back.
    Unsigned,
}

impl Fold {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Half, Self::Signed, Self::Unsigned];

    fn there(self) -> ToWords {
        match self {
            Self::Half => ToWords::HalfBits,
            Self::Signed => ToWords::Signed,
            Self::Unsigned => ToWords::Unsigned,
        }
    }

    fn back(self) -> FromWords {
        match self {
            Self::Half => FromWords::HalfBits,
            Self::Signed => FromWords::Signed,
            Self::Unsigned => FromWords::Unsigned,
        }
    }
}

/// What is left out of a chunk.
pub(super) struct Folding {
    fold: Fold,
    /// Words that numbers became, with the numbers and where.
    made: Vec<(Words, Id, Site)>,
    /// Where the first pair stands: the way there, and the way back; the same where one operation is both.
    met: Option<[Site; 2]>,
}

impl Folding {
    pub(super) fn begin(&mut self) {
        self.made.clear();
        self.met = None;
    }
}

impl Tape<'_> {
    /// A tape on which a pair is left out wherever its second half gets what the first one gave.
    #[must_use]
    pub fn folding(self, fold: Fold) -> Self {
        Self { folding: Some(Folding { fold, made: Vec::new(), met: None }), ..self }
    }

    /// Where the first pair stands that was left out of the last run: the way there, and the way back.
    pub fn folded(&self) -> Option<[Site; 2]> {
        self.folding.as_ref()?.met
    }

    /// Notes what became of a number.
    pub(super) fn note_words(&mut self, site: Site, op: ToWords, id: Id, words: &Words) {
        if let Some(folding) = &mut self.folding
            && folding.fold.there() == op
        {
            folding.made.push((*words, id, site));
        }
    }

    /// The number of a word, or in its place the one that the word was made of.
    pub(super) fn unrounded(&mut self, site: Site, op: FromWords, words: &Words, id: Id) -> Id {
        let Some(folding) = self.folding.as_ref().filter(|folding| folding.fold.back() == op) else { return id };
        // The way there gives 16 bits, and the way back takes the lower ones.
        let kept = if op == FromWords::HalfBits { 0xffff } else { u32::MAX };
        let same = |made: &Words| Mask::where_(|slot| made[slot] & kept == words[slot] & kept);
        let found: Vec<(Mask, Id, Site)> = folding
            .made
            .iter()
            .map(|(made, of, there)| (same(made), *of, *there))
            .filter(|(m, ..)| !m.is_empty())
            .collect();
        let mut id = id;
        for (mask, of, there) in found {
            id = if mask.is_full() { of } else { self.select(&mask, of, id) };
            if let Some(folding) = &mut self.folding {
                folding.met.get_or_insert([there, site]);
            }
        }
        id
    }

    /// True where the rounding to binary16 is left out, which is noted.
    pub(super) fn leaves_half_out(&mut self, site: Site) -> bool {
        let Some(folding) = self.folding.as_mut().filter(|folding| folding.fold == Fold::Half) else { return false };
        folding.met.get_or_insert([site, site]);
        true
    }
}

#[cfg(test)]
mod tests {
    use super::super::Model;
    use super::super::tests::call;
    use super::*;
    use program::interp::{FUEL, Machine, OutputColumn};

    /// Value of a function without a pair, and whether there was one.
    fn without(fold: Fold, body: &str, x: f32) -> (f64, bool) {
        let (executable, batch) = call(&format!("float f(float x) {{ {body} }}"), &[x]);
        let mut machine = Machine::new(&executable, Tape::new(Model::Binary64).folding(fold), FUEL);
        machine.run(&batch, 0);
        let OutputColumn::Real(&column) = machine.output(0, 0) else { panic!("a real number") };
        (machine.as_domain().values(column)[0], machine.as_domain().folded().is_some())
    }

    #[test]
    fn a_number_that_comes_back_keeps_its_digits() {
        assert_eq!(without(Fold::Signed, "return float(int(x)) * 2.0;", 3.75), (7.5, true));
        assert_eq!(without(Fold::Unsigned, "uint u = uint(x); return float(u);", 3.75), (3.75, true));
        // Another pair, and a word that is another number.
        assert_eq!(without(Fold::Unsigned, "return float(int(x)) * 2.0;", 3.75), (6.0, false));
        assert_eq!(without(Fold::Signed, "return float(int(x) + 1);", 3.75), (4.0, false));
    }
}
