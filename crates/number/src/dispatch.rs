//! One function over a column, in the widest vectors that the machine has. Without the feature `simd` they are those that
//! every machine has; the bits are the same.
//!
//! The loops below are ordinary ones that the compiler vectorises, once for each instruction set that
//! `pulp` finds. A function is computed in all numbers of a block; where some of them need another way,
//! that way is a second pass over the block.

use std::marker::PhantomData;

#[cfg(feature = "simd")]
use pulp::{Arch, NullaryFnOnce};

/// The one instruction set of a build without `simd`: what the compiler was told to use.
#[cfg(not(feature = "simd"))]
struct Arch;

#[cfg(not(feature = "simd"))]
impl Arch {
    fn new() -> Self {
        Self
    }

    fn dispatch<F: NullaryFnOnce>(self, f: F) -> F::Output {
        f.call()
    }
}

/// A loop that can be compiled for each instruction set.
#[cfg(not(feature = "simd"))]
trait NullaryFnOnce {
    type Output;

    fn call(self) -> Self::Output;
}

#[cfg(not(feature = "simd"))]
impl<R, F: FnOnce() -> R> NullaryFnOnce for F {
    type Output = R;

    fn call(self) -> R {
        self()
    }
}

/// Numbers that one pass takes: few enough to stay in the first cache between two passes.
const BLOCK: usize = 256;

/// A function of one number. All methods are free of branches, or the loops do not vectorise.
pub(super) trait OfOne: 'static {
    /// The value, where [`OfOne::is_rare`] does not hold.
    fn common(x: f64) -> f64;

    /// True for arguments that need [`OfOne::rare`].
    #[inline(always)]
    fn is_rare(_: f64) -> bool {
        false
    }

    /// The value for a rare argument.
    fn rare(x: f64) -> f64 {
        x
    }

    /// Writes the values for the rare arguments of a block.
    #[inline(always)]
    fn rare_block(x: &[f64], out: &mut [f64]) {
        for (out, &x) in out.iter_mut().zip(x).filter(|(_, x)| Self::is_rare(**x)) {
            *out = Self::rare(x);
        }
    }
}

/// A function of two numbers.
pub(super) trait OfTwo: 'static {
    /// The value, where [`OfTwo::is_rare`] does not hold.
    fn common(a: f64, b: f64) -> f64;

    /// True for arguments that need [`OfTwo::rare`].
    #[inline(always)]
    fn is_rare(_: f64, _: f64) -> bool {
        false
    }

    /// The value for rare arguments; called for these alone.
    fn rare(a: f64, _: f64) -> f64 {
        a
    }
}

/// A function of one number, on numbers and on columns of them.
#[derive(Clone, Copy, Debug)]
pub struct Unary {
    column: fn(&[f64], &mut [f64]),
    value: fn(f64) -> f64,
}

impl Unary {
    pub(super) const fn of<F: OfOne>() -> Self {
        Self {
            column: |x, out| Arch::new().dispatch(Column { x, out, function: PhantomData::<F> }),
            value: |x| if F::is_rare(x) { F::rare(x) } else { F::common(x) },
        }
    }

    /// Writes the function of each number of `x` to `out`.
    ///
    /// # Panics
    /// When the two are not of the same length.
    #[inline]
    pub fn column(&self, x: &[f64], out: &mut [f64]) {
        assert_eq!(x.len(), out.len(), "a column has one result for each argument");
        (self.column)(x, out);
    }

    /// The function of one number: the same bits as in a column.
    #[inline]
    pub fn value(&self, x: f64) -> f64 {
        (self.value)(x)
    }
}

/// A function of two numbers, on numbers and on columns of them.
#[derive(Clone, Copy, Debug)]
pub struct Binary {
    column: fn(&[f64], &[f64], &mut [f64]),
    value: fn(f64, f64) -> f64,
}

impl Binary {
    pub(super) const fn of<F: OfTwo>() -> Self {
        Self {
            column: |a, b, out| Arch::new().dispatch(Columns { a, b, out, function: PhantomData::<F> }),
            value: |a, b| if F::is_rare(a, b) { F::rare(a, b) } else { F::common(a, b) },
        }
    }

    /// Writes the function of each pair of numbers to `out`.
    ///
    /// # Panics
    /// When the three are not of the same length.
    #[inline]
    pub fn column(&self, a: &[f64], b: &[f64], out: &mut [f64]) {
        assert!(a.len() == out.len() && b.len() == out.len(), "a column has one result for each pair of arguments");
        (self.column)(a, b, out);
    }

    /// The function of one pair: the same bits as in a column.
    #[inline]
    pub fn value(&self, a: f64, b: f64) -> f64 {
        (self.value)(a, b)
    }
}

/// Runs `work` compiled for the widest vectors of the machine. Only what is inlined into `work` gains.
///
/// There is no fused multiplication in it that was not written as one: the result does not depend on
/// the machine.
#[inline]
pub fn map<X: Copy, Y>(x: &[X], out: &mut [Y], f: impl Fn(X) -> Y) {
    assert_eq!(x.len(), out.len(), "a column has one result for each argument");
    Arch::new().dispatch(Map { x, out, f });
}

/// [`map`] of a function of two.
#[inline]
pub fn map_pairs<A: Copy, B: Copy, Y>(a: &[A], b: &[B], out: &mut [Y], f: impl Fn(A, B) -> Y) {
    assert!(a.len() == out.len() && b.len() == out.len(), "a column has one result for each pair of arguments");
    Arch::new().dispatch(MapPairs { a, b, out, f });
}

/// Runs `work` compiled for the widest vectors of the machine: loops over several columns at once. Only
/// what is inlined into `work` gains, and a long `work` does not at all, since it is not inlined itself; as with
/// [`map`] the result does not depend on the machine.
#[inline]
pub fn wide<R>(work: impl FnOnce() -> R) -> R {
    Arch::new().dispatch(work)
}

/// Work that gains from [`wide`] however long it is: an implementation of [`Wide::run`] is marked `#[inline(always)]`, which a
/// closure cannot be.
pub trait Wide {
    /// What comes of it.
    type Output;

    /// Does it.
    fn run(self) -> Self::Output;
}

/// Does work compiled for the widest vectors of the machine; as with [`map`] the result does not depend on the machine.
#[inline]
pub fn run_wide<W: Wide>(work: W) -> W::Output {
    Arch::new().dispatch(Run(work))
}

struct Run<W>(W);

impl<W: Wide> NullaryFnOnce for Run<W> {
    type Output = W::Output;

    #[inline(always)]
    fn call(self) -> W::Output {
        self.0.run()
    }
}

/// How many numbers of a column are greater than each of some limits.
pub fn count_above<const N: usize>(x: &[f64], limits: &[f64; N]) -> [u64; N] {
    Arch::new().dispatch(CountAbove { x, limits })
}

struct Map<'a, X, Y, F> {
    x: &'a [X],
    out: &'a mut [Y],
    f: F,
}

impl<X: Copy, Y, F: Fn(X) -> Y> NullaryFnOnce for Map<'_, X, Y, F> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for (out, &x) in self.out.iter_mut().zip(self.x) {
            *out = (self.f)(x);
        }
    }
}

struct MapPairs<'a, A, B, Y, F> {
    a: &'a [A],
    b: &'a [B],
    out: &'a mut [Y],
    f: F,
}

impl<A: Copy, B: Copy, Y, F: Fn(A, B) -> Y> NullaryFnOnce for MapPairs<'_, A, B, Y, F> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for ((out, &a), &b) in self.out.iter_mut().zip(self.a).zip(self.b) {
            *out = (self.f)(a, b);
        }
    }
}

struct CountAbove<'a, const N: usize> {
    x: &'a [f64],
    limits: &'a [f64; N],
}

impl<const N: usize> NullaryFnOnce for CountAbove<'_, N> {
    type Output = [u64; N];

    #[inline(always)]
    fn call(self) -> [u64; N] {
        // Loops and no `map` of the array: that one is not always inlined, and so not vectorised.
        let mut counts = [0; N];
        for (count, &limit) in counts.iter_mut().zip(self.limits) {
            for &x in self.x {
                *count += u64::from(x > limit);
            }
        }
        counts
    }
}

struct Column<'a, F> {
    x: &'a [f64],
    out: &'a mut [f64],
    function: PhantomData<F>,
}

impl<F: OfOne> NullaryFnOnce for Column<'_, F> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for (x, out) in self.x.chunks(BLOCK).zip(self.out.chunks_mut(BLOCK)) {
            let mut rare = 0;
            for (out, &x) in out.iter_mut().zip(x) {
                *out = F::common(x);
                rare |= u64::from(F::is_rare(x));
            }
            if rare != 0 {
                F::rare_block(x, out);
            }
        }
    }
}

struct Columns<'a, F> {
    a: &'a [f64],
    b: &'a [f64],
    out: &'a mut [f64],
    function: PhantomData<F>,
}

impl<F: OfTwo> NullaryFnOnce for Columns<'_, F> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let parts = self.a.chunks(BLOCK).zip(self.b.chunks(BLOCK)).zip(self.out.chunks_mut(BLOCK));
        for ((a, b), out) in parts {
            let mut rare = 0;
            for ((out, &a), &b) in out.iter_mut().zip(a).zip(b) {
                *out = F::common(a, b);
                rare |= u64::from(F::is_rare(a, b));
            }
            if rare != 0 {
                for ((out, &a), &b) in out.iter_mut().zip(a).zip(b).filter(|((_, a), b)| F::is_rare(**a, **b)) {
                    *out = F::rare(a, b);
                }
            }
        }
    }
}
