//! Words of a host in which a program finds several numbers, each in bits of its own: `heads >> 16u` and `heads & 0xffffu`.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use super::super::code::{Constant, Executable, Field, File, Inst, Reg, Touch, Word2};
use super::access::{MemoryAccess, MemoryOp};

/// Bits of a word: so many, from the first one on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Bits {
    /// Number of the lowest bit.
    pub first: u32,
    /// How many there are.
    pub count: u32,
}

impl Bits {
    /// The largest number that has room in them.
    pub fn most(self) -> u32 {
        1_u32.checked_shl(self.count).map_or(u32::MAX, |above| above - 1)
    }
}

/// Part of a word that lies at a fixed place in a memory, or in an element of an array: the word shifted to the right, and
/// of that what a mask leaves.
#[derive(Clone, Copy, PartialEq)]
struct Part {
    word: (u32, u32),
    shift: u32,
    mask: u32,
}

impl Part {
    fn shifted(self, by: u32) -> Option<Self> {
        Some(Self { shift: self.shift + by, mask: self.mask.checked_shr(by)?, ..self })
    }

    fn masked(self, mask: u32) -> Self {
        Self { mask: self.mask & mask, ..self }
    }

    /// From the lowest of its bits to the highest; nothing is left where a mask or a shift takes all of them.
    fn bits(self) -> Option<Bits> {
        let lowest = self.mask.trailing_zeros();
        let count = (u32::BITS - self.mask.leading_zeros()).checked_sub(lowest).filter(|count| *count > 0)?;
        Some(Bits { first: self.shift + lowest, count })
    }
}

/// What a program takes words of a host for.
pub(super) struct Words {
    /// See [`super::Uses::packed`].
    pub packed: BTreeMap<(u32, u32), Vec<Bits>>,
    /// See [`super::Uses::is_real_too`].
    pub real_too: BTreeSet<(u32, u32)>,
}

/// Looks at the words, of arrays at those of the first element. Packed are those, by memory and distance from its beginning, of which each use takes some bits and no two uses overlap, with the
/// bits of each number from the lowest on. A word with a single number is none of them.
pub(super) fn words(executable: &Executable) -> Words {
    let constants = executable.constants.iter().filter_map(|constant| match constant {
        Constant::Word { to, value } => Some((*to, *value)),
        Constant::Real { .. } => None,
    });
    let mut search = Search { constants: constants.collect(), ..Search::default() };
    let mut body = executable.draft.body.clone();
    loop {
        let known = search.parts.len();
        search.used.clear();
        search.block(&mut body);
        if search.parts.len() == known {
            break;
        }
    }
    let apart = |bits: &BTreeSet<Bits>| {
        let all: Vec<&Bits> = bits.iter().collect();
        all.len() > 1 && all.windows(2).all(|two| two[0].first + two[0].count <= two[1].first)
    };
    let packed = search.used.into_iter().filter(|(_, bits)| apart(bits));
    let packed = packed.map(|(at, bits)| (at, bits.into_iter().collect())).collect();
    Words { packed, real_too: search.real_too }
}

#[derive(Default)]
struct Search {
    constants: HashMap<Reg, u32>,
    parts: HashMap<Reg, Part>,
    used: BTreeMap<(u32, u32), BTreeSet<Bits>>,
    real_too: BTreeSet<(u32, u32)>,
}

impl Search {
    fn block(&mut self, body: &mut [Inst]) {
        for inst in body {
            match inst {
                Inst::Memory(MemoryAccess { memory, offset, op: MemoryOp::Load(parts), .. }) => {
                    for (to, distance) in parts.iter().filter(|(to, _)| to.file() == File::Word) {
                        let word = (*memory, *offset + *distance);
                        self.parts.entry(to.reg).or_insert(Part { word, shift: 0, mask: u32::MAX });
                    }
                    continue;
                }
                Inst::Copy { to, from } | Inst::Store { to, from } if to.file() == File::Word => {
                    if let Some(part) = self.parts.get(from).copied() {
                        self.parts.entry(to.reg).or_insert(part);
                    }
                    continue;
                }
                _ => {}
            }
            if let Some((to, part)) = self.narrower(inst) {
                self.parts.entry(to).or_insert(part);
                continue;
            }
            if let Inst::FromWords { a, .. } = inst
                && let Some(part) = self.parts.get(a)
            {
                self.real_too.insert(part.word);
            }
            inst.registers(&mut |touch, file, reg| {
                if (touch, file) == (Touch::Read, File::Word)
                    && let Some(part) = self.parts.get(reg)
                {
                    self.used.entry(part.word).or_default().extend(part.bits());
                }
            });
            match inst {
                Inst::If { accept, reject, .. } => [accept, reject].into_iter().for_each(|body| self.block(body)),
                Inst::Switch { cases, .. } => cases.iter_mut().for_each(|case| self.block(&mut case.body)),
                Inst::Loop { body, continuing, .. } => [body, continuing].into_iter().for_each(|body| self.block(body)),
                Inst::Call { body } => self.block(body),
                _ => {}
            }
        }
    }

    /// What an instruction takes of a part of a word.
    fn narrower(&self, inst: &Inst) -> Option<(Reg, Part)> {
        let (part, constant) = (|reg: &Reg| self.parts.get(reg).copied(), |reg: &Reg| self.constants.get(reg).copied());
        match inst {
            Inst::Word2 { op: Word2::ShiftRightUnsigned | Word2::ShiftRightSigned, to, a, b, .. } => {
                Some((*to, part(a)?.shifted(constant(b)?)?))
            }
            Inst::Word2 { op: Word2::And, to, a, b, .. } => {
                let of = |a, b| Some(part(a)?.masked(constant(b)?));
                Some((*to, of(a, b).or_else(|| of(b, a))?))
            }
            Inst::Field {
                op: Field::ExtractUnsigned | Field::ExtractSigned,
                to,
                args: [value, first, count, _],
                ..
            } => {
                let bits = Bits { first: constant(first)?, count: constant(count)? };
                Some((*to, part(value)?.shifted(bits.first)?.masked(bits.most())))
            }
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_as_wide_as_their_masks() {
        let bits = |shift: u32, mask: u32| {
            let whole = Part { word: (0, 0), shift: 0, mask: u32::MAX };
            whole
                .shifted(shift)
                .and_then(|part| part.masked(mask).bits())
                .map(|bits| (bits.first, bits.count, bits.most()))
        };
        assert_eq!(bits(0, u32::MAX), Some((0, 32, u32::MAX)));
        assert_eq!(bits(16, u32::MAX), Some((16, 16, 0xffff)));
        assert_eq!(bits(4, 0xff), Some((4, 8, 0xff)));
        assert_eq!(bits(0, 0x0f00), Some((8, 4, 15)));
        assert_eq!(bits(0, 0x0f0f), Some((0, 12, 0xfff)), "with what lies between");
        assert_eq!(bits(0, 0), None);
        assert_eq!(bits(20, 0xf000_0000), None);
        assert_eq!(bits(32, u32::MAX), None, "more than a word has");
    }
}
