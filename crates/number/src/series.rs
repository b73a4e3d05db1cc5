//! Coefficients of Taylor series, and their sums.

/// c₀ + c₁x + c₂x² + …, the even and the odd terms side by side: half as long a chain of operations.
#[inline(always)]
pub(super) fn polynomial<const N: usize>(x: f64, coefficients: &[f64; N]) -> f64 {
    let square = x * x;
    let mut sums = [coefficients[N - 2], coefficients[N - 1]];
    let mut k = N - 2;
    while k >= 2 {
        sums = [coefficients[k - 2] + square * sums[0], coefficients[k - 1] + square * sums[1]];
        k -= 2;
    }
    let tail = sums[0] + x * sums[1];
    if k == 1 { coefficients[0] + x * tail } else { tail }
}

/// sign^k/n! for n = first + k·step; the factorials to 22! are exact.
pub(super) const fn factorials<const N: usize>(first: u32, step: u32, sign: f64) -> [f64; N] {
    let mut out = [0.0; N];
    let mut k = 0;
    let mut factor = 1.0;
    while k < N {
        let n = first + k as u32 * step;
        let mut product = 1.0;
        let mut j = 2;
        while j <= n {
            product *= j as f64;
            j += 1;
        }
        out[k] = factor / product;
        factor *= sign;
        k += 1;
    }
    out
}

/// factor·sign^k/n for n = first + 2k: the series of artanh (sign 1) and arctan (sign −1).
pub(super) const fn odd_reciprocals<const N: usize>(first: u32, factor: f64, sign: f64) -> [f64; N] {
    let mut out = [0.0; N];
    let mut k = 0;
    let mut factor = factor;
    while k < N {
        out[k] = factor / (first + 2 * k as u32) as f64;
        factor *= sign;
        k += 1;
    }
    out
}

/// Coefficients of arcsin x = x + x³·(c₀ + c₁x² + …): (2n)!/(4^n·n!²·(2n + 1)) for n = k + 1.
pub(super) const fn arcsine<const N: usize>() -> [f64; N] {
    let mut out = [0.0; N];
    let mut ratio = 1.0;
    let mut k = 0;
    while k < N {
        let n = (k + 1) as f64;
        ratio *= (2.0 * n - 1.0) / (2.0 * n);
        out[k] = ratio / (2.0 * n + 1.0);
        k += 1;
    }
    out
}
