//! What a program does with the results of atomic functions, and which workgroups its text names.

use std::collections::{HashMap, HashSet};

use naga::BuiltIn;

use super::super::code::{Constant, Executable, File, Inst, Reg, Touch, Word2};
use super::super::domain::Site;
use super::super::shape::each;
use super::access::{Combine, MemoryAccess, MemoryOp};

/// A number of a workgroup that a text names is taken for one of so many at most.
const NAMED: u32 = 64;

impl Executable {
    /// True where the program goes on with what an atomic function or an atomic load gave: with who came first.
    pub fn uses_results(&self) -> bool {
        self.results().any
    }

    /// True where it goes on with what an exchange gave, under a condition or not: locks and lists are made of these.
    pub fn uses_exchanges(&self) -> bool {
        self.results().exchanges
    }

    /// True where it goes on with what a function gave that changes a word: an exchange, a sum, a maximum.
    pub fn uses_changes(&self) -> bool {
        self.results().changes
    }

    fn results(&self) -> Results {
        let mut read: HashSet<(File, Reg)> = HashSet::new();
        let mut body = self.draft.body.clone();
        each_mut(&mut body, &mut |inst| {
            inst.registers(&mut |touch, file, reg| {
                if touch == Touch::Read {
                    read.insert((file, *reg));
                }
            });
            let condition = match inst {
                Inst::If { condition, .. } => Some(*condition),
                Inst::Switch { selector, .. } => Some(*selector),
                Inst::Loop { break_if, .. } => *break_if,
                _ => None,
            };
            read.extend(condition.map(|reg| (File::Word, reg)));
        });
        let mut results = Results::default();
        each(&self.draft.body, &mut |inst| match inst {
            Inst::Memory(MemoryAccess { op: MemoryOp::Load(_), atomic: true, .. }) => results.any = true,
            Inst::Memory(MemoryAccess { op: MemoryOp::Atomic { op, compare, before, exchanged, .. }, .. }) => {
                let used = before.is_some_and(|to| read.contains(&(to.file(), to.reg)))
                    || exchanged.is_some_and(|to| read.contains(&(File::Word, to)));
                results.any |= used;
                results.changes |= used;
                results.exchanges |= used && (compare.is_some() || *op == Combine::Exchange);
            }
            _ => {}
        });
        results
    }

    /// Workgroups along each axis that there are at least, since the text asks for one of them by its number:
    /// `if (group.x == 1)`; 1 where it names none.
    pub fn named_groups(&self) -> [u32; 3] {
        let mut named = [1; 3];
        let of = self.numbers.iter().filter(|(own, _)| *own == BuiltIn::WorkGroupId);
        let mut axes: HashMap<Reg, usize> =
            of.flat_map(|(_, all)| all.iter().enumerate().map(|(axis, register)| (register.reg, axis))).collect();
        let constants: HashMap<Reg, u32> = (self.constants.iter())
            .filter_map(|constant| match constant {
                Constant::Word { to, value } => Some((*to, *value)),
                Constant::Real { .. } => None,
            })
            .collect();
        // A front end may copy a number into a variable first.
        each(&self.draft.body, &mut |inst| match inst {
            Inst::Copy { to, from } | Inst::Store { to, from } if to.file() == File::Word => {
                if let Some(axis) = axes.get(from).copied() {
                    axes.insert(to.reg, axis);
                }
            }
            Inst::Word2 { op: Word2::Equal, a, b, .. } => {
                for (number, constant) in [(a, b), (b, a)] {
                    if let Some((axis, value)) = axes.get(number).zip(constants.get(constant))
                        && *value < NAMED
                    {
                        named[*axis] = named[*axis].max(value + 1);
                    }
                }
            }
            _ => {}
        });
        named
    }

    /// Instructions of the program, those of functions once for each call.
    pub fn length(&self) -> u64 {
        let mut count = 0;
        each(&self.body, &mut |_| count += 1);
        count
    }

    /// The only instruction that stores into a memory; `None` where there are several.
    pub fn only_store(&self, memory: u32) -> Option<Site> {
        let mut sites = Vec::new();
        each(&self.draft.body, &mut |inst| {
            if let Inst::Memory(access) = inst
                && access.memory == memory
                && !matches!(access.op, MemoryOp::Load(_))
                && !sites.contains(&access.site)
            {
                sites.push(access.site);
            }
        });
        if let [site] = sites[..] { Some(site) } else { None }
    }
}

#[derive(Default)]
struct Results {
    any: bool,
    changes: bool,
    exchanges: bool,
}

/// Calls `f` for each instruction, those of blocks inside of others too.
fn each_mut(block: &mut [Inst], f: &mut impl FnMut(&mut Inst)) {
    for inst in block {
        f(inst);
        match inst {
            Inst::If { accept, reject, .. } => [accept, reject].into_iter().for_each(|block| each_mut(block, f)),
            Inst::Switch { cases, .. } => cases.iter_mut().for_each(|case| each_mut(&mut case.body, f)),
            Inst::Loop { body, continuing, .. } => {
                [body, continuing].into_iter().for_each(|block| each_mut(block, f));
            }
            Inst::Call { body } => each_mut(body, f),
            // The rest holds no instructions.
            _ => {}
        }
    }
}
