//! Whole numbers in binary64, which are what they are: sums and products of those that a program makes (by `floor`, from
//! integers, or written as such) are exact below 2^53, and so is what is compared with them or becomes an integer of them.
//!
//! Whole numbers among the inputs do not count: another way to compute the same may be rounded there.

use super::arena::{Id, NodeKind};
use super::{Model, Tape};
use crate::profile::Op;
use program::interp::SLOTS;

/// Below, binary64 has every whole number.
const WHOLE: f64 = (1_u64 << 53) as f64;

/// True for an operation that gives a whole number, one of its operands or the negative, or scales by a power of two: binary64
/// adds no rounding.
pub(super) fn keeps(op: Op) -> bool {
    is_whole(op) || matches!(op, Op::Neg | Op::Abs | Op::Min | Op::Max | Op::Ldexp)
}

fn is_whole(op: Op) -> bool {
    matches!(op, Op::Sign | Op::Floor | Op::Ceil | Op::Trunc | Op::RoundEven | Op::Step)
}

impl Tape<'_> {
    /// Notes that a node without arguments holds whole numbers that are exactly these.
    pub(super) fn note_whole(&mut self, id: Id) {
        if matches!(self.model, Model::Binary64) {
            self.whole.resize(self.whole.len().max(id as usize + 1), false);
            self.whole[id as usize] = true;
        }
    }

    /// Takes the rounding from a sum or product of whole numbers.
    pub(super) fn keep_whole(&mut self, id: Id) {
        if !matches!(self.model, Model::Binary64) {
            return;
        }
        let at = id as usize;
        let meta = self.arena.nodes[at];
        let whole = |id: Id| self.whole.get(id as usize).copied().unwrap_or(false);
        let [a, b] = match meta.kind {
            NodeKind::Leaf => [id, id],
            NodeKind::Sum { a, signs: (_, 0.0), .. } | NodeKind::One { a, .. } => [a, a],
            NodeKind::Sum { a, b, .. } | NodeKind::Product { a, b } | NodeKind::Two { a, b, .. } => [a, b],
            NodeKind::Select { a, b, .. } => [a, b],
        };
        let is = match (meta.kind, meta.op) {
            (NodeKind::Leaf, _) => false,
            (NodeKind::One { .. } | NodeKind::Two { .. }, Some(op)) => {
                is_whole(op) || (keeps(op) && op != Op::Ldexp && whole(a) && whole(b))
            }
            (NodeKind::One { .. } | NodeKind::Two { .. }, None) => false,
            (NodeKind::Sum { .. } | NodeKind::Product { .. } | NodeKind::Select { .. }, _) => whole(a) && whole(b),
        };
        self.whole.resize(self.whole.len().max(at + 1), false);
        self.whole[at] = is;
        if is && matches!(meta.kind, NodeKind::Sum { .. } | NodeKind::Product { .. }) {
            for slot in 0..SLOTS {
                let sure = [a, b].iter().all(|id| self.arena.radius.get(*id as usize)[slot] == 0.0);
                if sure && self.arena.value.get(at)[slot].abs() < WHOLE {
                    self.arena.local.get_mut(at)[slot] = 0.0;
                    self.arena.radius.get_mut(at)[slot] = 0.0;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::call;
    use super::*;
    use program::interp::{FUEL, Machine};

    #[test]
    fn whole_numbers_decide_what_they_decide_and_no_others_do() {
        for (body, x, open) in [
            ("return float(int(floor(x)));", 64.3, false),
            ("return float(int(floor(x) * 3.0 + 1.0));", 64.3, false),
            ("return floor(x) + 1.0 == 65.0 ? 1.0 : 2.0;", 64.3, false),
            ("return float(int(floor(clamp(x, 0.0, 1.0) * 255.0 + 0.5)) & 15);", 0.3, false),
            ("return float(int(x * 3.0));", 1.0, true),
            ("return float(int(floor(x * 3.0)));", 1.0 / 3.0, false),
            ("return float(int(sqrt(x)));", 4.0, true),
        ] {
            let (executable, batch) = call(&format!("float f(float x) {{ {body} }}"), &[x]);
            let mut machine = Machine::new(&executable, Tape::new(Model::Binary64), FUEL);
            machine.run(&batch, 0);
            assert_eq!(machine.domain().fork(0).is_some(), open, "{body}");
        }
    }
}
