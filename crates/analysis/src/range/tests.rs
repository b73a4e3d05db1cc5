//! Ranges hold what comes out at random points, computed by a second evaluator in binary64.

use super::builtin::Call;
use super::transfer as t;
use super::value::{Evidence, Range, Sources, Value};
use super::{Observed, Stated, Visit};
use base::text::SourceFile;
use syntax::ast::{Callee, ExprKind};
use syntax::{Shader, Stage};

/// SplitMix64.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, n: usize) -> usize {
        usize::try_from(self.next() % n as u64).unwrap()
    }

    fn between(&mut self, lo: f64, hi: f64) -> f64 {
        let weight = (self.next() >> 11) as f64 / (1u64 << 53) as f64;
        // Ends come up often: that is where ranges are wrong.
        match self.below(6) {
            0 => lo,
            1 => hi,
            _ => (lo + (hi - lo) * weight).clamp(lo, hi),
        }
    }

    fn range(&mut self) -> (f64, f64) {
        const ENDS: [f64; 15] =
            [-1000.0, -7.25, -3.0, -1.5, -1.0, -0.5, -0.125, 0.0, 0.25, 0.5, 1.0, 1.75, 3.0, 12.5, 400.0];
        let (a, b) = (ENDS[self.below(ENDS.len())], ENDS[self.below(ENDS.len())]);
        (a.min(b), a.max(b))
    }
}

fn max(a: f64, b: f64) -> f64 {
    if a < b { b } else { a }
}

fn min(a: f64, b: f64) -> f64 {
    if b < a { b } else { a }
}

/// A built-in function as the specification defines it; NaN where it leaves the result undefined.
fn reference(name: &str, a: &[f64]) -> f64 {
    match (name, a) {
        ("abs", [x]) => x.abs(),
        ("sign", [x]) => match () {
            () if x.is_nan() => f64::NAN,
            () if *x > 0.0 => 1.0,
            () if *x < 0.0 => -1.0,
            () => 0.0,
        },
        ("floor", [x]) => x.floor(),
        ("ceil", [x]) => x.ceil(),
        ("trunc", [x]) => x.trunc(),
        ("round", [x]) => x.round(),
        ("roundEven", [x]) => x.round_ties_even(),
        ("fract", [x]) => x - x.floor(),
        ("mod", [x, y]) => x - y * (x / y).floor(),
        ("min", [x, y]) => min(*x, *y),
        ("max", [x, y]) => max(*x, *y),
        ("clamp", [x, lo, hi]) => min(max(*x, *lo), *hi),
        ("mix", [x, y, w]) => x * (1.0 - w) + y * w,
        ("step", [edge, x]) => f64::from(u8::from(!(x < edge))),
        ("smoothstep", [e0, e1, x]) => {
            let t = min(max((x - e0) / (e1 - e0), 0.0), 1.0);
            t * t * (3.0 - 2.0 * t)
        }
        ("sqrt", [x]) => x.sqrt(),
        ("inversesqrt", [x]) => 1.0 / x.sqrt(),
        ("exp", [x]) => x.exp(),
        ("exp2", [x]) => x.exp2(),
        ("log", [x]) => x.ln(),
        ("log2", [x]) => x.log2(),
        ("pow", [x, y]) if *x < 0.0 || (*x == 0.0 && *y <= 0.0) => f64::NAN,
        ("pow", [x, y]) => x.powf(*y),
        ("sin", [x]) => x.sin(),
        ("cos", [x]) => x.cos(),
        ("tan", [x]) => x.tan(),
        ("asin", [x]) => x.asin(),
        ("acos", [x]) => x.acos(),
        ("atan", [x]) => x.atan(),
        ("atan", [y, x]) => y.atan2(*x),
        ("tanh", [x]) => x.tanh(),
        ("radians", [x]) => x.to_radians(),
        ("degrees", [x]) => x.to_degrees(),
        ("length", [x]) => x.abs(),
        ("distance", [x, y]) => (x - y).abs(),
        ("dot", [x, y]) => x * y,
        _ => panic!("{name}"),
    }
}

const FUNCTIONS: &[(&str, usize)] = &[
    ("abs", 1),
    ("sign", 1),
    ("floor", 1),
    ("ceil", 1),
    ("trunc", 1),
    ("round", 1),
    ("roundEven", 1),
    ("fract", 1),
    ("mod", 2),
    ("min", 2),
    ("max", 2),
    ("clamp", 3),
    ("mix", 3),
    ("step", 2),
    ("smoothstep", 3),
    ("sqrt", 1),
    ("inversesqrt", 1),
    ("exp", 1),
    ("exp2", 1),
    ("log", 1),
    ("log2", 1),
    ("pow", 2),
    ("sin", 1),
    ("cos", 1),
    ("tan", 1),
    ("asin", 1),
    ("acos", 1),
    ("atan", 1),
    ("atan", 2),
    ("tanh", 1),
    ("radians", 1),
    ("degrees", 1),
    ("length", 1),
    ("distance", 2),
    ("dot", 2),
];

/// Random points of random intervals at which a result is not inside, up to the rounding of binary64.
fn misses(of: impl Fn(&[Range]) -> Range, exact: impl Fn(&[f64]) -> f64, arguments: usize, seed: u64) -> Vec<String> {
    let mut random = Random(seed);
    let mut found = Vec::new();
    for _ in 0..400 {
        let ends: Vec<(f64, f64)> = (0..arguments).map(|_| random.range()).collect();
        let ranges: Vec<Range> =
            ends.iter().enumerate().map(|(i, e)| Range::of(e.0, e.1, Evidence::Stated, Sources::of(i))).collect();
        let result = of(&ranges);
        for _ in 0..20 {
            let point: Vec<f64> = ends.iter().map(|e| random.between(e.0, e.1)).collect();
            let value = exact(&point);
            if !holds(&result, value) {
                found.push(format!("{ends:?} at {point:?}: {value} is not in {result:?}"));
            }
        }
    }
    found
}

fn holds(range: &Range, value: f64) -> bool {
    let slack = value.abs() * 1e-12;
    range.contains(value) || range.contains(value - slack) || range.contains(value + slack)
}

#[test]
fn ranges_of_functions_hold_what_comes_out() {
    for (seed, (name, arguments)) in FUNCTIONS.iter().enumerate() {
        let of = |ranges: &[Range]| {
            let args: Vec<Value> = ranges.iter().map(|r| Value::scalar(*r)).collect();
            Call { name, args: &args, components: 1, same: false, mark: 1 }.value().parts[0]
        };
        let found = misses(of, |a| reference(name, a), *arguments, seed as u64);
        assert!(found.is_empty(), "{name}: {} misses, {}", found.len(), found[0]);
    }
}

#[test]
fn ranges_of_operators_hold_what_comes_out() {
    type Operator = (fn(Range, Range) -> Range, fn(f64, f64) -> f64);
    let operators: [Operator; 4] =
        [(t::add, |a, b| a + b), (t::sub, |a, b| a - b), (t::mul, |a, b| a * b), (t::div, |a, b| a / b)];
    for (seed, (of, exact)) in operators.into_iter().enumerate() {
        let found = misses(|r| of(r[0], r[1]), |a| exact(a[0], a[1]), 2, 100 + seed as u64);
        assert!(found.is_empty(), "operator {seed}: {}", found[0]);
    }
    let found = misses(|r| t::square(r[0]), |a| a[0] * a[0], 1, 200);
    assert!(found.is_empty(), "{}", found[0]);
    let found = misses(|r| t::neg(r[0]), |a| -a[0], 1, 201);
    assert!(found.is_empty(), "{}", found[0]);
}

#[test]
fn an_unsound_range_is_found() {
    // Each is right at the ends, or nearly everywhere.
    let ends_alone = misses(|r| t::monotone(r[0], true, f64::sin), |a| a[0].sin(), 1, 1);
    assert!(!ends_alone.is_empty());
    let no_zero = misses(|r| Range { lo: r[0].lo.abs().min(r[0].hi.abs()), ..t::abs(r[0]) }, |a| a[0].abs(), 1, 2);
    assert!(!no_zero.is_empty());
    let two_products = misses(
        |r| Range::of(r[0].lo * r[1].lo, r[0].hi * r[1].hi, Evidence::Bound, Sources::NONE),
        |a| a[0] * a[1],
        2,
        3,
    );
    assert!(!two_products.is_empty());
    let no_nan = misses(|r| Range { nan: false, ..t::from(r[0], 0.0, f64::sqrt, &[]) }, |a| a[0].sqrt(), 1, 4);
    assert!(!no_nan.is_empty());
}

/// An expression over `a`, `b`, `c` and, in a loop, `x`.
enum Tree {
    Number(f64),
    Input(usize),
    Operator(char, Box<Tree>, Box<Tree>),
    Call(&'static str, Vec<Tree>),
    Choice(&'static str, Box<[Tree; 4]>),
}

const NAMES: [&str; 4] = ["a", "b", "c", "x"];

impl Tree {
    fn random(random: &mut Random, depth: usize, inputs: usize) -> Self {
        let below = |random: &mut Random| Box::new(Self::random(random, depth.saturating_sub(1), inputs));
        match random.below(if depth == 0 { 2 } else { 9 }) {
            0 => Self::Number((random.below(41) as f64 - 20.0) / 4.0),
            1 | 2 => Self::Input(random.below(inputs)),
            3..=5 => {
                let (op, left) = (['+', '-', '*', '/'][random.below(4)], below(random));
                Self::Operator(op, left, below(random))
            }
            6 | 7 => {
                let (name, n) = FUNCTIONS[random.below(FUNCTIONS.len())];
                Self::Call(name, (0..n).map(|_| *below(random)).collect())
            }
            _ => {
                let op = ["<", "<=", ">", ">=", "==", "!="][random.below(6)];
                let (l, r) = (below(random), below(random));
                // What is compared comes up again in the branches, where it is narrowed.
                let yes = if random.below(2) == 0 { l.copy() } else { *below(random) };
                let no = if random.below(2) == 0 { r.copy() } else { *below(random) };
                Self::Choice(op, Box::new([*l, *r, yes, no]))
            }
        }
    }

    fn copy(&self) -> Self {
        match self {
            Self::Number(v) => Self::Number(*v),
            Self::Input(i) => Self::Input(*i),
            Self::Operator(op, l, r) => Self::Operator(*op, Box::new(l.copy()), Box::new(r.copy())),
            Self::Call(name, args) => Self::Call(name, args.iter().map(Self::copy).collect()),
            Self::Choice(op, all) => Self::Choice(op, Box::new([0, 1, 2, 3].map(|i| all[i].copy()))),
        }
    }

    fn text(&self) -> String {
        match self {
            Self::Number(v) => format!("({v:?})"),
            Self::Input(i) => NAMES[*i].to_owned(),
            Self::Operator(op, l, r) => format!("({} {op} {})", l.text(), r.text()),
            Self::Call(name, args) => {
                format!("{name}({})", args.iter().map(Self::text).collect::<Vec<_>>().join(", "))
            }
            Self::Choice(op, all) => {
                let [l, r, yes, no] = all.each_ref().map(Self::text);
                format!("({l} {op} {r} ? {yes} : {no})")
            }
        }
    }

    fn value(&self, at: &[f64]) -> f64 {
        match self {
            Self::Number(v) => *v,
            Self::Input(i) => at[*i],
            Self::Operator(op, l, r) => {
                let (l, r) = (l.value(at), r.value(at));
                match op {
                    '+' => l + r,
                    '-' => l - r,
                    '*' => l * r,
                    _ => l / r,
                }
            }
            Self::Call(name, args) => reference(name, &args.iter().map(|a| a.value(at)).collect::<Vec<_>>()),
            Self::Choice(op, all) => {
                let [l, r, yes, no] = all.as_ref();
                let (l, r) = (l.value(at), r.value(at));
                let holds = match *op {
                    "<" => l < r,
                    "<=" => l <= r,
                    ">" => l > r,
                    ">=" => l >= r,
                    "==" => l == r,
                    _ => l != r,
                };
                if holds { yes.value(at) } else { no.value(at) }
            }
        }
    }
}

/// The range of the argument of the only `fwidth` of a fragment shader with inputs in these ranges.
fn observed(before: &str, argument: &str, ends: &[(f64, f64)]) -> Range {
    let text = format!(
        "#version 330 core\nuniform float a;\nuniform float b;\nuniform float c;\nout vec4 color;\nvoid main()\n{{\n  \
         float x = 0.0;\n  {before}\n  color = vec4(fwidth({argument}));\n}}\n"
    );
    let parsed = Shader::parse(&SourceFile::new("a.frag", text.as_str()), Stage::Fragment);
    assert!(parsed.diagnostics.is_empty(), "{:#?}\n{text}", parsed.diagnostics);
    let ranges = ends.iter().zip(NAMES).map(|(e, n)| Stated { name: n.to_owned(), min: e.0, max: e.1 });
    let stated: Vec<Stated> = ranges.collect();
    let shader = parsed.shader;
    let seen = Observed::new(&shader, &stated);
    let probe = shader.arena().iter().find_map(|(id, e)| match &e.kind {
        ExprKind::Call { callee: Callee::Name(name), args: _ } if name.name == "fwidth" => Some(id),
        _ => None,
    });
    let part = |v: &Visit| v.operands[0].parts[0];
    let all = seen.visits(probe.unwrap()).iter().map(part).reduce(Range::join);
    all.unwrap_or_else(|| panic!("never reached:\n{text}"))
}

#[test]
fn ranges_of_expressions_hold_what_comes_out() {
    let mut random = Random(7);
    let mut bounded = 0;
    for _ in 0..3000 {
        let tree = Tree::random(&mut random, 3, 3);
        let ends: Vec<(f64, f64)> = (0..3).map(|_| random.range()).collect();
        let range = observed("", &tree.text(), &ends);
        bounded += usize::from(range.lo.is_finite() || range.hi.is_finite());
        for _ in 0..20 {
            let point: Vec<f64> = ends.iter().map(|e| random.between(e.0, e.1)).collect();
            let value = tree.value(&point);
            assert!(holds(&range, value), "{} for {ends:?} at {point:?}: {value} is not in {range:?}", tree.text());
        }
    }
    assert!(bounded > 1500, "something is known of {bounded} of 3000");
}

#[test]
fn ranges_behind_branches_and_loops_hold_what_comes_out() {
    let mut random = Random(11);
    for round in 0..1000 {
        let first = Tree::random(&mut random, 2, 3);
        let next = Tree::random(&mut random, 2, 4);
        let limit = Tree::random(&mut random, 1, 3);
        let ends: Vec<(f64, f64)> = (0..3).map(|_| random.range()).collect();
        let (f, n, l) = (first.text(), next.text(), limit.text());
        let (before, kind) = match round % 4 {
            0 => (format!("x = {f}; for (int i = 0; i < 3; ++i) {{ x = {n}; }}"), 0),
            1 => (format!("x = {f}; if (x < {l}) {{ x = {n}; }}"), 1),
            2 => (format!("x = {f}; for (int i = 0; i < 3; ++i) {{ if (x > {l}) break; x = {n}; }}"), 2),
            _ => (format!("x = {f}; if (x >= {l} && a > b || c == 0.5) x = {n}; else x -= {l};"), 3),
        };
        let range = observed(&before, "x", &ends);
        for _ in 0..20 {
            let mut at: Vec<f64> = ends.iter().map(|e| random.between(e.0, e.1)).collect();
            let mut x = first.value(&at);
            at.push(x);
            let limit = limit.value(&at);
            match kind {
                0 => (0..3).for_each(|_| at[3] = next.value(&at)),
                1 if x < limit => at[3] = next.value(&at),
                2 => {
                    for _ in 0..3 {
                        if at[3] > limit {
                            break;
                        }
                        at[3] = next.value(&at);
                    }
                }
                3 if (x >= limit && at[0] > at[1]) || at[2] == 0.5 => at[3] = next.value(&at),
                3 => at[3] = x - limit,
                _ => {}
            }
            x = at[3];
            assert!(holds(&range, x), "{before} for {ends:?} at {at:?}: {x} is not in {range:?}");
        }
    }
}

#[test]
fn conditions_and_loops_narrow_what_they_compare() {
    let unknown: [(f64, f64); 0] = [];
    let of = |before: &str, argument: &str| {
        let r = observed(before, argument, &unknown);
        (r.lo, r.hi)
    };
    let infinity = f64::INFINITY;
    assert_eq!(of("", "sin(a) * 0.5 + 0.5"), (0.0, 1.0));
    assert_eq!(of("for (int i = 0; i < 8; ++i) { x = float(i); }", "x"), (0.0, 7.0));
    assert_eq!(of("x = a; if (x < 2.0) x = 2.0; if (x > 3.0) x = 3.0;", "x"), (2.0, 3.0));
    assert_eq!(of("if (a <= 1.0) discard;", "floor(a)"), (1.0, infinity));
    assert_eq!(of("if (!(a >= 0.0 && a <= 4.0)) return;", "a"), (0.0, 4.0));
    assert_eq!(of("x = a; x *= a;", "x").0, -infinity, "a product of two names is not known to be a square");
    assert_eq!(of("", "a * a").0, 0.0);
    assert_eq!(of("if (a > 2.0) { x = 1.0; } else { x = 3.0; }", "x"), (1.0, 3.0));
}
