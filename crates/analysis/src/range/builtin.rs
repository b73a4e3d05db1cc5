//! Ranges of built-in functions and variables (GLSL 4.60 specification, chapters 7 and 8).

use super::transfer as t;
use super::value::{Evidence, Range, Sources, Value};

/// A call of a built-in function.
pub struct Call<'a> {
    /// The function.
    pub name: &'a str,
    /// Its arguments.
    pub args: &'a [Value],
    /// Components of the result; 0 when it is no scalar or vector.
    pub components: usize,
    /// True when the first two arguments are the same expression.
    pub same: bool,
    /// Mark of this call among those that make directions.
    pub mark: u128,
}

impl Call<'_> {
    fn sources(&self) -> Sources {
        self.args.iter().fold(Sources::NONE, |all, a| all.and(a.sources()))
    }

    /// The result of a function that works on each component by itself.
    fn each(&self, f: impl Fn(&[Range]) -> Range) -> Value {
        let part = |i: usize| {
            let parts: Option<Vec<Range>> = self.args.iter().map(|a| a.part(i)).collect();
            parts.map_or_else(|| Range::unknown(self.sources()), |p| f(&p))
        };
        Value::new((0..self.components).map(part).collect())
    }

    fn each1(&self, f: impl Fn(Range) -> Range) -> Value {
        self.each(|p| match p {
            [x] => f(*x),
            _ => Range::unknown(self.sources()),
        })
    }

    fn each2(&self, f: impl Fn(Range, Range) -> Range) -> Value {
        self.each(|p| match p {
            [a, b] => f(*a, *b),
            _ => Range::unknown(self.sources()),
        })
    }

    fn each3(&self, f: impl Fn(Range, Range, Range) -> Range) -> Value {
        self.each(|p| match p {
            [a, b, c] => f(*a, *b, *c),
            _ => Range::unknown(self.sources()),
        })
    }

    fn within(&self, lo: f64, hi: f64, by: Evidence) -> Value {
        let mut range = Range::of(lo, hi, by, self.sources());
        range.nan = self.args.iter().flat_map(|a| &a.parts).any(|p| p.nan);
        Value::new(vec![range; self.components])
    }

    fn unknown(&self) -> Value {
        if self.components == 0 {
            return Value::opaque(self.sources());
        }
        Value::unknown(self.components, self.sources())
    }

    /// What the call gives.
    pub fn value(&self) -> Value {
        let half_turn = std::f64::consts::FRAC_PI_2;
        match self.name {
            "abs" => self.each1(t::abs),
            "sign" => self.each1(t::sign),
            "floor" => self.each1(|x| t::stepped(x, f64::floor)),
            "ceil" => self.each1(|x| t::stepped(x, f64::ceil)),
            "trunc" => self.each1(|x| t::stepped(x, f64::trunc)),
            "round" => self.each1(|x| {
                // Halves go either way.
                let (down, up) = (t::stepped(x, |v| (v - 0.5).ceil()), t::stepped(x, |v| (v + 0.5).floor()));
                Range { hi: up.hi, hi_by: up.hi_by, ..down }
            }),
            "roundEven" => self.each1(|x| t::stepped(x, f64::round_ties_even)),
            "fract" => self.each1(t::fract),
            "mod" => self.each2(t::modulo),
            "min" => self.each2(t::min),
            "max" => self.each2(t::max),
            "clamp" => self.each3(|x, lo, hi| match (lo.single(), hi.single()) {
                (Some(lo), Some(hi)) if lo <= hi => t::cut(x, lo, hi),
                _ => t::min(t::max(x, lo), hi),
            }),
            "mix" => self.each3(t::mix),
            "step" => self.each2(step),
            "smoothstep" => self.each3(smoothstep),
            "sqrt" => self.each1(|x| t::from(x, 0.0, f64::sqrt, &[0.0, 1.0])),
            "inversesqrt" => self.each1(|x| t::div(Range::exactly(1.0), t::from(x, 0.0, f64::sqrt, &[0.0, 1.0]))),
            "exp" => self.each1(|x| t::exponential(x, f64::exp)),
            "exp2" => self.each1(|x| t::exponential(x, f64::exp2)),
            "log" => self.each1(|x| t::from(x, 0.0, f64::ln, &[0.0])),
            "log2" => self.each1(|x| t::from(x, 0.0, f64::log2, &[0.0])),
            "pow" => self.each2(t::pow),
            "sin" => self.each1(|x| t::wave(x, f64::sin, half_turn)),
            "cos" => self.each1(|x| t::wave(x, f64::cos, 0.0)),
            "asin" => self.each1(|x| t::arc(x, 1.0, true, f64::asin)),
            "acos" => self.each1(|x| t::arc(x, 1.0, false, f64::acos)),
            "atan" if self.args.len() == 1 => self.each1(|x| t::arc(x, f64::INFINITY, true, f64::atan)),
            "atan" => self.within(-3.1426, 3.1426, Evidence::Bound),
            "tanh" => self.within(-1.0, 1.0, Evidence::Bound),
            "radians" => self.each1(|x| t::mul(x, Range::exactly(std::f64::consts::PI / 180.0))),
            "degrees" => self.each1(|x| t::mul(x, Range::exactly(180.0 / std::f64::consts::PI))),
            "fma" => self.each3(|a, b, c| t::add(t::mul(a, b), c)),
            "normalize" => self.normalize(),
            "length" => Value::scalar(self.args.first().map_or_else(|| Range::unknown(self.sources()), length)),
            "distance" => self.distance(),
            "dot" => self.dot(),
            "reflect" => self.reflect(),
            "refract" if self.all_unit(2) => self.within(-1.0 - t::UNIT_SLACK, 1.0 + t::UNIT_SLACK, Evidence::Bound),
            "faceforward" => self.faceforward(),
            "fwidth" | "fwidthFine" | "fwidthCoarse" => self.within(0.0, f64::INFINITY, Evidence::Bound),
            "any" | "all" | "not" | "lessThan" | "lessThanEqual" | "greaterThan" | "greaterThanEqual" | "equal"
            | "notEqual" | "isnan" | "isinf" => self.within(0.0, 1.0, Evidence::Bound),
            "bitCount" => self.within(0.0, 32.0, Evidence::Bound),
            "unpackUnorm2x16" | "unpackUnorm4x8" => self.within(0.0, 1.0, Evidence::Nature),
            "unpackSnorm2x16" | "unpackSnorm4x8" => self.within(-1.0, 1.0, Evidence::Nature),
            _ => self.unknown(),
        }
    }

    fn all_unit(&self, n: usize) -> bool {
        self.args.iter().take(n).all(|a| a.unit)
    }

    fn normalize(&self) -> Value {
        let Some(v) = self.args.first() else { return self.unknown() };
        let nature = |x: &Range| {
            let mut r = Range::of(-1.0 - t::UNIT_SLACK, 1.0 + t::UNIT_SLACK, Evidence::Nature, v.sources());
            if x.lo >= 0.0 {
                (r.lo, r.lo_by) = (0.0, x.lo_by);
            }
            if x.hi <= 0.0 {
                (r.hi, r.hi_by) = (0.0, x.hi_by);
            }
            r.nan = v.parts.iter().all(|p| !p.excludes_zero()) || v.parts.iter().any(|p| p.nan || !p.is_finite());
            r
        };
        let singles: Option<Vec<f64>> = v.parts.iter().map(Range::single).collect();
        let parts = match singles {
            Some(s) if s.iter().any(|x| *x != 0.0) => {
                let length = s.iter().map(|x| x * x).sum::<f64>().sqrt();
                let near = |x: f64| {
                    let slack = if x == 0.0 { 0.0 } else { t::UNIT_SLACK };
                    Range::of(x / length - slack, x / length + slack, Evidence::Bound, Sources::NONE)
                };
                s.iter().map(|x| near(*x)).collect()
            }
            _ => v.parts.iter().map(nature).collect(),
        };
        Value { unit: true, made_from: v.made_from | self.mark, ..Value::new(parts) }
    }

    fn distance(&self) -> Value {
        let [a, b] = self.args else { return self.unknown() };
        let n = a.parts.len().max(b.parts.len());
        let parts: Option<Vec<Range>> = (0..n).map(|i| Some(t::sub(a.part(i)?, b.part(i)?))).collect();
        Value::scalar(parts.map_or_else(|| Range::unknown(self.sources()), |p| length(&Value::new(p))))
    }

    fn dot(&self) -> Value {
        let [a, b] = self.args else { return self.unknown() };
        let sources = self.sources();
        let made_from = a.made_from | b.made_from;
        let mut r = if self.same {
            a.parts.iter().map(|x| t::square(*x)).reduce(t::add)
        } else {
            a.parts.iter().zip(&b.parts).map(|(x, y)| t::mul(*x, *y)).reduce(t::add)
        }
        .unwrap_or_else(|| Range::unknown(sources));
        if a.parts.len() > 1 && !(a.parts.iter().chain(&b.parts).all(|p| p.single().is_some())) {
            r = r.vague();
        }
        if a.unit && b.unit {
            let one = 1.0 + t::UNIT_SLACK;
            if self.same {
                r = Range { nan: r.nan, ..Range::of(1.0 - t::UNIT_SLACK, one, Evidence::Nature, sources) };
            } else {
                // One of two directions must be free to turn while the other stays, and neither made
                // from the other as a half vector is.
                let (sa, sb) = (a.sources(), b.sources());
                let free = !(sa.within(sb) && sb.within(sa)) && (a.made_from & b.made_from) == 0;
                if r.lo < -one {
                    (r.lo, r.lo_by) = (-one, if free { Evidence::Nature } else { Evidence::Bound });
                }
                if r.hi > one {
                    (r.hi, r.hi_by) = (one, Evidence::Nature);
                }
            }
        }
        Value { made_from, ..Value::scalar(r) }
    }

    fn reflect(&self) -> Value {
        if !self.all_unit(2) {
            return self.unknown();
        }
        let made_from = self.args.iter().fold(0, |all, a| all | a.made_from);
        let one = 1.0 + t::UNIT_SLACK;
        Value { unit: true, made_from, ..self.within(-one, one, Evidence::Nature) }
    }

    fn faceforward(&self) -> Value {
        let [n, ..] = self.args else { return self.unknown() };
        let back = Value { parts: n.parts.iter().map(|p| t::neg(*p)).collect(), ..n.clone() };
        n.join(&back).depending(self.sources())
    }
}

/// The length of a vector.
pub fn length(v: &Value) -> Range {
    if v.unit {
        let slack = t::UNIT_SLACK;
        return Range::of(1.0 - slack, 1.0 + slack, Evidence::Nature, v.sources());
    }
    let squares = v.parts.iter().map(|x| t::square(*x)).reduce(t::add);
    let sum = squares.unwrap_or_else(|| Range::unknown(v.sources()));
    let lowest =
        v.parts.iter().map(|x| t::square(*x)).map(|s| if s.lo == 0.0 { s.lo_by } else { Evidence::Bound }).min();
    let mut r = t::from(sum, 0.0, f64::sqrt, &[0.0, 1.0]);
    if r.lo == 0.0 {
        r.lo_by = lowest.unwrap_or_default();
    }
    r
}

fn step(edge: Range, x: Range) -> Range {
    let sources = edge.sources.and(x.sources);
    if !edge.nan && !x.nan {
        if x.lo >= edge.hi {
            return Range { sources, ..Range::exactly(1.0) };
        }
        if x.hi < edge.lo {
            return Range { sources, ..Range::exactly(0.0) };
        }
    }
    t::stepwise(sources, false)
}

fn smoothstep(low: Range, high: Range, x: Range) -> Range {
    let sources = low.sources.and(high.sources).and(x.sources);
    // With edges that meet the quotient inside may be NaN.
    let mut r = t::stepwise(sources, x.nan || low.nan || high.nan || low.hi >= high.lo);
    if low.hi < high.lo && x.is_finite() {
        if x.lo > low.hi {
            r.lo_by = Evidence::Bound;
        }
        if x.hi < high.lo {
            r.hi_by = Evidence::Bound;
        }
    }
    r
}

/// Range of a built-in variable, in every component; none where nothing is known.
pub fn variable(name: &str, component: usize) -> Option<(f64, f64, Evidence)> {
    let infinity = f64::INFINITY;
    Some(match (name, component) {
        ("gl_FragCoord", 0 | 1) => (0.5, infinity, Evidence::Stated),
        ("gl_FragCoord", 2) | ("gl_PointCoord" | "gl_TessCoord" | "gl_SamplePosition", _) => {
            (0.0, 1.0, Evidence::Nature)
        }
        (
            "gl_VertexID"
            | "gl_InstanceID"
            | "gl_PrimitiveID"
            | "gl_PrimitiveIDIn"
            | "gl_InvocationID"
            | "gl_SampleID"
            | "gl_WorkGroupID"
            | "gl_LocalInvocationID"
            | "gl_GlobalInvocationID"
            | "gl_LocalInvocationIndex",
            _,
        ) => (0.0, infinity, Evidence::Stated),
        ("gl_FrontFacing" | "gl_HelperInvocation", _) => (0.0, 1.0, Evidence::Bound),
        _ => return None,
    })
}
