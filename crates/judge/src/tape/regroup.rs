//! Sums and products that a device may regroup: what any order of their terms may round to.

use super::Tape;
use super::arena::{Id, NodeKind, Slots};
use super::kernels::carried_by_product;
use super::lowered::{LOWP, SMALLEST, STEP, largest};
use crate::profile::Op;
use crate::profile::grid::{MAX_FINITE, MIN_NORMAL};
use program::Grade;
use program::interp::{Mask, SLOTS, Site};

/// What one operation of a regrouped sum or product may be off by.
struct Steps {
    /// As part of its result.
    unit: f64,
    /// What is smaller may be taken for 0: 0 where nothing is.
    flush: f64,
    /// The same, whether it is or not; and what is larger may be infinite.
    least: f64,
    most: f64,
    /// Beside the part of the result, for `lowp`.
    own: f64,
}

impl Steps {
    fn new(grade: Grade, unit: f64, flushes: bool) -> Self {
        match grade {
            Grade::Full => {
                let flush = if flushes { MIN_NORMAL } else { 0.0 };
                Self { unit, flush, least: MIN_NORMAL, most: MAX_FINITE, own: 0.0 }
            }
            Grade::Medium | Grade::Half | Grade::Low => {
                let own = if grade == Grade::Low { LOWP } else { 0.0 };
                Self { unit: STEP, flush: SMALLEST, least: SMALLEST, most: largest(grade), own }
            }
        }
    }
}

impl Tape<'_> {
    /// For rearrangement: the size of all terms, and how many roundings any order of them takes.
    pub(super) fn group(&mut self, id: Id) {
        if !self.model.is_rearranged() {
            return;
        }
        let at = id as usize;
        for pool in [&mut self.arena.size, &mut self.arena.peak, &mut self.arena.least, &mut self.arena.part] {
            pool.reach(at);
        }
        // Number of terms of a sum, and roundings of the worst of them.
        let (terms, heights) = (2 * at, 2 * at + 1);
        self.arena.roundings.reach(heights);
        // What is kept as it is written is one term for what comes after.
        let meta = self.arena.nodes[at];
        let kind = if meta.is_kept() { NodeKind::Leaf } else { meta.kind };
        let steps = Steps::new(self.regrouped_at(id, kind), self.model.unit(), self.model.flushes());
        let unit = steps.unit;
        let (earlier, size) = self.arena.size.split(at);
        let (counts, height) = self.arena.roundings.split(heights);
        let mut term = [1.0; SLOTS];
        let of = |x: Id| (counts.get(2 * x as usize), counts.get(2 * x as usize + 1));
        match kind {
            NodeKind::Leaf | NodeKind::One { .. } | NodeKind::Two { .. } => {
                let (v, e) = (self.arena.value.get(at), self.arena.radius.get(at));
                number::wide(|| (0..SLOTS).for_each(|slot| size[slot] = v[slot].abs() + e[slot]));
                height.fill(0.0);
                // A comparison may be made the other way round: 1 − 1 where it gives 0, and 1 − 0 where it gives 1.
                if meta.op == Some(Op::Step) {
                    (0..SLOTS).for_each(|slot| size[slot] = size[slot].max(2.0 - v[slot]));
                    term = [2.0; SLOTS];
                }
            }
            NodeKind::Sum { a, b, signs } => {
                let ((ta, ha), (tb, hb)) = (of(a), of(b));
                let (sa, sb) = (earlier.get(a as usize), earlier.get(b as usize));
                if signs.1 == 0.0 {
                    (*size, term, *height) = (*sa, *ta, *ha);
                    // The same number at a lower precision is rounded once more.
                    let again = f64::from(u8::from(super::lowered::is_lower(meta.site)));
                    number::wide(|| height.iter_mut().for_each(|height| *height += again));
                } else {
                    number::wide(|| {
                        for slot in 0..SLOTS {
                            size[slot] = sa[slot] + sb[slot];
                            term[slot] = ta[slot] + tb[slot];
                            height[slot] = ha[slot].max(hb[slot]);
                        }
                    });
                }
            }
            NodeKind::Product { a, b } => {
                let ((ta, ha), (tb, hb)) = (of(a), of(b));
                let (sa, sb) = (earlier.get(a as usize), earlier.get(b as usize));
                number::wide(|| {
                    for slot in 0..SLOTS {
                        size[slot] = sa[slot] * sb[slot];
                        // Each factor is a sum with its own roundings; one more for the product.
                        height[slot] = ha[slot] + ta[slot] - 1.0 + hb[slot] + tb[slot] - 1.0 + 1.0;
                    }
                });
            }
            NodeKind::Select { mask, a, b } => {
                let mask = self.arena.masks[mask as usize];
                let ((ta, ha), (tb, hb)) = (of(a), of(b));
                *size = *earlier.get(b as usize);
                mask.merge(earlier.get(a as usize), size);
                term = *tb;
                mask.merge(ta, &mut term);
                *height = *hb;
                mask.merge(ha, height);
            }
        }
        *self.arena.roundings.get_mut(terms) = term;
        self.extremes(at, kind);
        self.smallest_part(at, kind);
        let still = self.is_still();
        if still {
            self.off_by_terms(at, kind);
        }
        if kind.is_polynomial() {
            let lost = self.lost_inside(kind, steps.least);
            let height = self.arena.roundings.get(heights);
            let (size, peak, part) = (self.arena.size.get(at), self.arena.peak.get(at), self.arena.part.get(at));
            let value = self.arena.value.get(at);
            let radius = self.arena.radius.get_mut(at);
            let Steps { flush, least, most, own: absolute, .. } = steps;
            let mut own = [0.0; SLOTS];
            number::wide(|| {
                for slot in 0..SLOTS {
                    let (size, term, peak) = (size[slot], term[slot], peak[slot]);
                    let count = height[slot] + term - 1.0;
                    let relative = count * unit;
                    // Each result may be flushed, and each term as an argument before that; where factors are distributed
                    // over sums, also a part of a term, and its other factors come after.
                    let after = if part[slot] < least { size.max(peak) } else { size };
                    let flushed = (count + term) * (flush + absolute) * (1.0 + after);
                    // One operation has one order: its result is rounded, whatever its terms are worth.
                    let size = if count > 1.0 { size } else { value[slot].abs() + radius[slot] };
                    // γ_n = n·u/(1 − n·u); flushed terms keep their size.
                    let error = relative / (1.0 - relative).max(0.5) * size + flushed;
                    // The terms themselves may be too large, whatever their sum is.
                    let lost = (lost[slot] != 0.0) | (peak + error > most);
                    own[slot] = if lost { f64::INFINITY } else { error };
                    radius[slot] += own[slot];
                }
            });
            *self.arena.local.get_mut(at) = own;
            self.arena.nodes[at].exact = false;
            // The whole is regrouped at once: what sums inside of it would be off by themselves is not added to that. A
            // sweep leaves it out likewise.
            if still {
                let (terms, radius) = (self.arena.terms.get(at), self.arena.radius.get_mut(at));
                number::wide(|| (0..SLOTS).for_each(|slot| radius[slot] = terms[slot] + own[slot]));
            }
        }
    }

    /// The lowest precision of a sum or product and of those that are regrouped with it: an operation on another order of
    /// their terms may have it.
    fn regrouped_at(&mut self, id: Id, kind: NodeKind) -> Grade {
        let at = id as usize;
        let own = self.arena.nodes[at].site.map_or(Grade::Full, Site::grade);
        let of = |x: Id| self.arena.grades.get(x as usize).copied().unwrap_or_default();
        let grade = match kind {
            NodeKind::Leaf | NodeKind::One { .. } | NodeKind::Two { .. } => Grade::Full,
            NodeKind::Sum { a, b, signs } => own.min(of(a)).min(if signs.1 == 0.0 { Grade::Full } else { of(b) }),
            NodeKind::Product { a, b } => own.min(of(a)).min(of(b)),
            NodeKind::Select { a, b, .. } => of(a).min(of(b)),
        };
        if self.arena.grades.len() <= at {
            self.arena.grades.resize(at + 1, Grade::Full);
        }
        self.arena.grades[at] = grade;
        grade
    }

    /// What the terms of a sum or product are off by, each by itself.
    fn off_by_terms(&mut self, at: usize, kind: NodeKind) {
        self.arena.terms.reach(at);
        let (before, off) = self.arena.terms.split(at);
        match kind {
            NodeKind::Leaf | NodeKind::One { .. } | NodeKind::Two { .. } => *off = *self.arena.radius.get(at),
            NodeKind::Sum { a, signs: (_, 0.0), .. } => *off = *before.get(a as usize),
            NodeKind::Sum { a, b, .. } => {
                let (a, b) = (before.get(a as usize), before.get(b as usize));
                number::wide(|| (0..SLOTS).for_each(|slot| off[slot] = a[slot] + b[slot]));
            }
            NodeKind::Product { a, b } => {
                let (ea, eb) = (before.get(a as usize), before.get(b as usize));
                let (x, y) = (self.arena.value.get(a as usize), self.arena.value.get(b as usize));
                for slot in 0..SLOTS {
                    let carried = carried_by_product(x[slot], ea[slot], y[slot], eb[slot]);
                    off[slot] = if carried.is_nan() { f64::INFINITY } else { carried };
                }
            }
            NodeKind::Select { mask, a, b } => {
                *off = *before.get(b as usize);
                self.arena.masks[mask as usize].merge(before.get(a as usize), off);
            }
        }
    }

    /// In which slots a sum or product inside of this one leaves the range of binary32: it is too large,
    /// or some factors of a product give one that a device may flush to zero. What a regrouped whole errs
    /// by does not say that.
    /// 1 there, and 0 elsewhere.
    fn lost_inside(&self, kind: NodeKind, smallest: f64) -> Slots {
        let parts = match kind {
            NodeKind::Sum { a, b, signs } => [a, if signs.1 == 0.0 { a } else { b }],
            NodeKind::Product { a, b } => [a, b],
            NodeKind::Select { mask, a, b } => return self.lost_of_chosen(&self.arena.masks[mask as usize], a, b),
            NodeKind::Leaf | NodeKind::One { .. } | NodeKind::Two { .. } => return [0.0; SLOTS],
        };
        let mut lost = [0.0; SLOTS];
        for part in parts.into_iter().filter(|&p| self.arena.nodes[p as usize].is_regrouped()) {
            let local = self.arena.local.get(part as usize);
            number::wide(|| {
                for slot in 0..SLOTS {
                    lost[slot] = if local[slot] == f64::INFINITY { 1.0 } else { lost[slot] };
                }
            });
        }
        if let NodeKind::Product { a, b } = kind {
            let [a, b] = [a, b].map(|x| (self.arena.value.get(x as usize), self.arena.least.get(x as usize)));
            number::wide(|| {
                for slot in 0..SLOTS {
                    let ((x, lx), (y, ly)) = ((a.0[slot].abs(), a.1[slot]), (b.0[slot].abs(), b.1[slot]));
                    // All factors together are the product itself, which may be flushed as any result.
                    let some = if (lx < x) | (ly < y) { lx * ly } else { f64::INFINITY };
                    let small = (x != 0.0) & (y != 0.0) & (lx.min(ly).min(some) < smallest);
                    lost[slot] = if small { 1.0 } else { lost[slot] };
                }
            });
        }
        lost
    }

    /// The same for what a mask chooses between.
    fn lost_of_chosen(&self, mask: &Mask, a: Id, b: Id) -> Slots {
        std::array::from_fn(|slot| {
            let chosen = if mask.has(slot) { a } else { b } as usize;
            let lost = self.arena.nodes[chosen].is_regrouped() && self.arena.local.get(chosen)[slot] == f64::INFINITY;
            f64::from(u8::from(lost))
        })
    }

    /// The largest value on any way to a sum or product, where small factors may be taken out and come
    /// last; and the smallest product of some factors of a product, infinite where it is 0.
    fn extremes(&mut self, at: usize, kind: NodeKind) {
        let size = *self.arena.size.get(at);
        let value = self.arena.value.get(at);
        let (before, peak) = self.arena.peak.split(at);
        let (earlier, least) = self.arena.least.split(at);
        number::wide(|| {
            for slot in 0..SLOTS {
                least[slot] = if value[slot] == 0.0 { f64::INFINITY } else { value[slot].abs() };
            }
        });
        match kind {
            NodeKind::Leaf | NodeKind::One { .. } | NodeKind::Two { .. } => *peak = size,
            NodeKind::Select { mask, a, b } => {
                let mask = self.arena.masks[mask as usize];
                (*peak, *least) = (*before.get(b as usize), *earlier.get(b as usize));
                mask.merge(before.get(a as usize), peak);
                mask.merge(earlier.get(a as usize), least);
            }
            NodeKind::Sum { a, b, signs } => {
                let (pa, pb) = (before.get(a as usize), before.get(b as usize));
                if signs.1 == 0.0 {
                    (*peak, *least) = (*pa, *earlier.get(a as usize));
                } else {
                    number::wide(|| (0..SLOTS).for_each(|slot| peak[slot] = pa[slot] + pb[slot]));
                }
            }
            NodeKind::Product { a, b } => {
                let (pa, pb) = (before.get(a as usize), before.get(b as usize));
                let (la, lb) = (earlier.get(a as usize), earlier.get(b as usize));
                number::wide(|| {
                    for slot in 0..SLOTS {
                        peak[slot] = pa[slot].max(pb[slot]).max(pa[slot] * pb[slot]);
                        let factors = la[slot].min(lb[slot]).min(la[slot] * lb[slot]);
                        least[slot] = if value[slot] != 0.0 { factors } else { least[slot] };
                    }
                });
            }
        }
    }

    /// The smallest product of some factors of some term, infinite where there is none but 0: distributed over a sum, a
    /// factor meets each of its terms.
    fn smallest_part(&mut self, at: usize, kind: NodeKind) {
        let value = self.arena.value.get(at);
        let (before, part) = self.arena.part.split(at);
        match kind {
            NodeKind::Leaf | NodeKind::One { .. } | NodeKind::Two { .. } => {
                number::wide(|| {
                    for slot in 0..SLOTS {
                        part[slot] = if value[slot] == 0.0 { f64::INFINITY } else { value[slot].abs() };
                    }
                });
            }
            NodeKind::Select { mask, a, b } => {
                *part = *before.get(b as usize);
                self.arena.masks[mask as usize].merge(before.get(a as usize), part);
            }
            NodeKind::Sum { a, b, signs } => {
                let other = if signs.1 == 0.0 { a } else { b };
                let (a, b) = (before.get(a as usize), before.get(other as usize));
                number::wide(|| (0..SLOTS).for_each(|slot| part[slot] = a[slot].min(b[slot])));
            }
            NodeKind::Product { a, b } => {
                let (a, b) = (before.get(a as usize), before.get(b as usize));
                number::wide(|| {
                    for slot in 0..SLOTS {
                        part[slot] = a[slot].min(b[slot]).min(a[slot] * b[slot]);
                    }
                });
            }
        }
    }
}
