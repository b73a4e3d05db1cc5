//! Lets temporaries share registers: the fewer columns, the more of them stay in the cache.

use std::collections::HashMap;

use super::code::{File, Inst, Reg, TEMPORARY, Touch};

/// Replaces temporaries by registers from `first` on. Gives the number of registers of each file.
pub(super) fn allocate(body: &mut [Inst], first: (u32, u32)) -> (u32, u32) {
    let mut lives = Lives::default();
    lives.scan(body);
    let mut pools = Pools { next: [first.0, first.1], ..Pools::default() };
    let mut at = 0;
    rename(body, &mut at, &lives.last, &mut pools);
    (pools.next[0], pools.next[1])
}

type Key = (File, Reg);

/// The last place at which each temporary is read. Places are numbered in the order of the text.
#[derive(Default)]
struct Lives {
    at: usize,
    born: HashMap<Key, usize>,
    last: HashMap<Key, usize>,
    /// Places where the loops around this one begin.
    loops: Vec<usize>,
    /// For each loop around this one, temporaries from outside that it reads: they live to its end,
    /// since the next round reads them again.
    carried: Vec<Vec<Key>>,
}

impl Lives {
    fn touch(&mut self, touch: Touch, key: Key) {
        if key.1 < TEMPORARY {
            return;
        }
        self.last.insert(key, self.at);
        match touch {
            Touch::Write => {
                self.born.entry(key).or_insert(self.at);
            }
            Touch::Read => {
                let born = self.born.get(&key).copied().unwrap_or(0);
                // The outermost loop that began after the birth.
                if let Some(k) = self.loops.iter().position(|&start| start > born) {
                    self.carried[k].push(key);
                }
            }
        }
    }

    fn scan(&mut self, body: &mut [Inst]) {
        for inst in body {
            self.at += 1;
            inst.registers(&mut |touch, file, reg| self.touch(touch, (file, *reg)));
            match inst {
                Inst::If { accept, reject, .. } => {
                    self.scan(accept);
                    self.scan(reject);
                }
                Inst::Switch { cases, .. } => cases.iter_mut().for_each(|case| self.scan(&mut case.body)),
                Inst::Loop { body, continuing, break_if, .. } => {
                    self.loops.push(self.at);
                    self.carried.push(Vec::new());
                    self.scan(body);
                    self.scan(continuing);
                    self.at += 1;
                    if let Some(reg) = break_if {
                        self.touch(Touch::Read, (File::Word, *reg));
                    }
                    self.loops.pop();
                    for key in self.carried.pop().unwrap_or_default() {
                        self.last.insert(key, self.at);
                    }
                }
                Inst::Call { body } => self.scan(body),
                _ => {}
            }
        }
    }
}

#[derive(Default)]
struct Pools {
    next: [u32; 2],
    free: [Vec<Reg>; 2],
    given: HashMap<Key, Reg>,
    /// Temporaries by the place after which nothing reads them.
    ends: HashMap<usize, Vec<Key>>,
}

fn index(file: File) -> usize {
    match file {
        File::Real => 0,
        File::Word => 1,
    }
}

impl Pools {
    fn get(&mut self, key: Key, last: usize) -> Reg {
        if let Some(&reg) = self.given.get(&key) {
            return reg;
        }
        let k = index(key.0);
        let reg = self.free[k].pop().unwrap_or_else(|| {
            self.next[k] += 1;
            self.next[k] - 1
        });
        self.given.insert(key, reg);
        self.ends.entry(last).or_default().push(key);
        reg
    }

    /// Takes back what ends at this place, only after all registers of its instruction are known: an
    /// instruction never writes what it reads.
    fn release(&mut self, at: usize) {
        for key in self.ends.remove(&at).unwrap_or_default() {
            if let Some(reg) = self.given.remove(&key) {
                self.free[index(key.0)].push(reg);
            }
        }
    }
}

fn rename(body: &mut [Inst], at: &mut usize, last: &HashMap<Key, usize>, pools: &mut Pools) {
    for inst in body {
        *at += 1;
        inst.registers(&mut |_, file, reg| {
            if *reg >= TEMPORARY {
                let key = (file, *reg);
                *reg = pools.get(key, last.get(&key).copied().unwrap_or(usize::MAX));
            }
        });
        pools.release(*at);
        match inst {
            Inst::If { accept, reject, .. } => {
                rename(accept, at, last, pools);
                rename(reject, at, last, pools);
            }
            Inst::Switch { cases, .. } => {
                cases.iter_mut().for_each(|case| rename(&mut case.body, at, last, pools));
            }
            Inst::Loop { body, continuing, break_if, .. } => {
                rename(body, at, last, pools);
                rename(continuing, at, last, pools);
                *at += 1;
                if let Some(reg) = break_if.as_mut().filter(|reg| **reg >= TEMPORARY) {
                    let key = (File::Word, *reg);
                    *reg = pools.get(key, last.get(&key).copied().unwrap_or(usize::MAX));
                }
                pools.release(*at);
            }
            Inst::Call { body } => rename(body, at, last, pools),
            _ => {}
        }
    }
}
