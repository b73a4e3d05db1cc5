//! What can be said of a program without running it.

use std::collections::HashSet;

use super::code::{Executable, Inst};
use super::domain::Site;

impl Executable {
    /// True when it has a loop.
    pub fn has_loops(&self) -> bool {
        let mut any = false;
        each(&self.body, &mut |inst| any |= matches!(inst, Inst::Loop { .. }));
        any
    }

    /// True for a place that reads a texel.
    pub fn reads_texel(&self, at: Site) -> bool {
        let mut any = false;
        each(&self.body, &mut |inst| any |= matches!(inst, Inst::Texel { site, .. } if *site == at));
        any
    }

    /// The places of stores whose index may lie outside of its array: what such a store does to an executor, and to
    /// other invocations, is anyone's guess.
    pub fn stray_stores(&self) -> HashSet<Site> {
        let mut all = HashSet::new();
        each(&self.body, &mut |inst| {
            if let Inst::Scatter { strays, .. } = inst {
                all.extend(strays.iter().map(|stray| stray.site));
            }
        });
        all
    }
}

/// Calls `f` for each instruction, those of blocks inside of others too.
pub(super) fn each(block: &[Inst], f: &mut impl FnMut(&Inst)) {
    for inst in block {
        f(inst);
        match inst {
            Inst::If { accept, reject, .. } => [accept, reject].into_iter().for_each(|block| each(block, f)),
            Inst::Switch { cases, .. } => cases.iter().for_each(|case| each(&case.body, f)),
            Inst::Loop { body, continuing, .. } => [body, continuing].into_iter().for_each(|block| each(block, f)),
            Inst::Call { body } => each(body, f),
            // The rest holds no instructions.
            _ => {}
        }
    }
}
