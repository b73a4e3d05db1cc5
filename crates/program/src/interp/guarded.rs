//! Functions whose result is undefined for some arguments.

/// Arguments for which GLSL leaves the result of a function undefined.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Guarded {
    /// `sqrt(x)`, x < 0.
    Sqrt,
    /// `inversesqrt(x)`, x ≤ 0.
    InverseSqrt,
    /// `log(x)`, x ≤ 0.
    Log,
    /// `log2(x)`, x ≤ 0.
    Log2,
    /// `asin(x)`, |x| > 1.
    Asin,
    /// `acos(x)`, |x| > 1.
    Acos,
    /// `acosh(x)`, x < 1.
    Acosh,
    /// `atanh(x)`, |x| ≥ 1.
    Atanh,
    /// `pow(x, y)`, x < 0, or x = 0 and y ≤ 0.
    Pow,
    /// `atan(y, x)`, both 0.
    Atan2,
    /// `clamp(v, x, y)`, x > y.
    Clamp,
    /// `smoothstep(x, y, v)`, x ≥ y.
    SmoothStep,
    /// `pack2x16float(x)` and `quantizeToF16(x)` of WGSL, |x| beyond the finite numbers of binary16.
    Half,
}

impl Guarded {
    /// True when the result is undefined. Functions of one argument look at the first alone.
    #[inline]
    pub fn is_outside(self, x: f64, y: f64) -> bool {
        match self {
            Self::Sqrt => x < 0.0,
            Self::InverseSqrt | Self::Log | Self::Log2 => x <= 0.0,
            Self::Asin | Self::Acos => x.abs() > 1.0,
            Self::Acosh => x < 1.0,
            Self::Atanh => x.abs() >= 1.0,
            Self::Pow => x < 0.0 || (x == 0.0 && y <= 0.0),
            Self::Atan2 => x == 0.0 && y == 0.0,
            Self::Clamp => x > y,
            Self::SmoothStep => x >= y,
            Self::Half => x.abs() > 65504.0,
        }
    }
}
