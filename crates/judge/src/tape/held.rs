//! Which nodes are still wanted, on a tape that is not read backwards: those that registers hold.
//!
//! The others give their places to new ones, so that a program of a thousand operations works on a few dozen columns, which
//! stay in the caches.

use super::arena::{Id, MOST, Meta};
use super::{Column, Tape};
use program::interp::Site;

/// How many registers hold each node. Node 0 is what a register holds at the start, and stays.
#[derive(Default)]
pub(super) struct HeldNodes {
    counts: Vec<u32>,
    free: Vec<Id>,
    /// Nodes of the operation that goes on.
    fresh: Vec<Id>,
    /// Nodes of this chunk.
    made: usize,
}

impl HeldNodes {
    pub(super) fn begin(&mut self) {
        self.made = 0;
    }

    /// The place of a node that nobody needs any more.
    pub(super) fn reuse(&mut self) -> Option<Id> {
        self.free.pop()
    }

    /// True when a chunk has made as many nodes as it may: loops without end have to stop.
    pub(super) fn is_full(&self) -> bool {
        self.made >= MOST
    }

    /// Nodes that the chunk has made.
    pub(super) fn made(&self) -> usize {
        self.made
    }

    pub(super) fn make(&mut self, id: Id) {
        if self.counts.len() <= id as usize {
            self.counts.resize(id as usize + 1, 0);
        }
        self.made += 1;
        self.fresh.push(id);
    }

    /// A register goes from one node to another, at the end of an operation.
    pub(super) fn swap(&mut self, old: Id, new: Id) {
        self.counts[new as usize] += 1;
        let Self { counts, free, fresh, .. } = self;
        if old != 0 {
            counts[old as usize] -= 1;
            if counts[old as usize] == 0 {
                free.push(old);
            }
        }
        while let Some(id) = fresh.pop() {
            if id != 0 && counts[id as usize] == 0 {
                free.push(id);
            }
        }
    }
}

impl Tape<'_> {
    /// A node with columns that hold what is left from before.
    pub(super) fn node(&mut self, mut meta: Meta) -> Id {
        if self.loses_precise {
            meta.site = meta.site.map(Site::without_precise);
        }
        let Some(tangents) = &mut self.tangents else { return self.arena.push(meta) };
        let id = match tangents.held.reuse() {
            Some(id) => {
                self.arena.put(id, meta);
                id
            }
            None => self.arena.push(meta),
        };
        tangents.held.make(id);
        id
    }

    /// Puts the result of an operation into a register.
    pub(super) fn hold(&mut self, out: &mut Column, id: Id) {
        if let Some(tangents) = &mut self.tangents {
            tangents.held.swap(out.0, id);
            self.arena.forget_ways();
        }
        out.0 = id;
    }
}

#[cfg(test)]
mod tests {
    use super::super::Tape;
    use super::super::tests::{call, device};
    use program::interp::{FUEL, Machine, OutputColumn};

    #[test]
    fn a_long_loop_needs_no_more_nodes_than_registers_and_a_second_run_finds_the_same() {
        let body = "float s = 0.0; for (int i = 0; i < 300; ++i) { if (x > s) s = s * 0.5 + sin(x); else s = mix(s, x, 0.25); }";
        let (executable, batch) = call(&format!("float f(float x) {{ {body} return s; }}"), &[0.7]);
        let of = |rounds: usize| {
            let mut machine = Machine::new(&executable, Tape::new(device("vulkan-1.4", false)).with_tangents(), FUEL);
            (0..rounds).for_each(|_| {
                machine.run(&batch, 0);
            });
            let OutputColumn::Real(&column) = machine.output(0, 0) else { panic!("a real number") };
            let tape = machine.as_domain();
            (tape.values(column)[0], tape.allowance(column)[0], tape.arena.nodes.len())
        };
        let (value, allowance, nodes) = of(1);
        assert!(nodes < 40, "{nodes}");
        assert!(allowance > 0.0 && allowance.is_finite(), "{allowance}");
        assert_eq!(of(3), (value, allowance, nodes));
    }
}
