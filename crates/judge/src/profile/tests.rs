use super::*;
use base::text::SourceFile;
use base::value::ulp_at;

const PI: f64 = std::f64::consts::PI;

fn profile(name: &str) -> &'static Profile {
    by_name(name).unwrap()
}

fn allowed(name: &str, op: Op, args: &[f64]) -> Allowed {
    profile(name).allowed(op, args, op.exact(args), Stage::Compute)
}

fn read(text: &str) -> Result<Profile, ProfileError> {
    parse(&SourceFile::new("p.toml", text), &|name| by_name(name).cloned())
}

#[test]
fn every_shipped_profile_has_an_entry_for_every_operation() {
    let all = [
        "vulkan-1.4",
        "vulkan-cts",
        "wgsl",
        "glsl-4.60",
        "binary32",
        "vulkan-practice",
        "llvmpipe-22.3.6",
        "softpipe-22.3.6",
        "swiftshader-subzero-5.0",
        "nvidia-h200-580.159.04",
        "nvidia-h200-opengl-580.159.04",
    ];
    assert_eq!(names().collect::<Vec<_>>(), all);
    for name in names() {
        let profile = profile(name);
        assert_eq!((profile.name.as_str(), profile.entries.len()), (name, Op::ALL.len()));
        assert!(!profile.revision.is_empty());
    }
    assert!(by_name("vulkan-1.0").is_none());
}

/// The rows of the specification's tables, as sizes at a place where they can be told apart.
#[test]
fn the_rows_of_the_vulkan_table_are_kept() {
    let ulps = |op: Op, args: &[f64]| match allowed("vulkan-1.4", op, args) {
        Allowed::Bound(bound) => bound / ulp_at(op.exact(args)),
        other => panic!("{op:?}: {other:?}"),
    };
    for (op, args, expected) in [
        (Op::Add, vec![1.0, 0.3], 1.0),
        (Op::Sub, vec![3.0, 0.3], 1.0),
        (Op::Mul, vec![1.7, 0.9], 1.0),
        (Op::Div, vec![1.0, 3.0], 2.5),
        (Op::Exp, vec![1.25], 5.5),
        (Op::Exp2, vec![-3.5], 10.0),
        (Op::Log, vec![8.0], 3.0),
        (Op::Log2, vec![7.0], 3.0),
        (Op::InverseSqrt, vec![3.0], 2.0),
        (Op::Atan, vec![3.0], 4096.0),
        (Op::Atan2, vec![3.0, -1.0], 4096.0),
        (Op::Floor, vec![3.5], 1.0),
        (Op::Ceil, vec![3.5], 1.0),
        (Op::Trunc, vec![3.5], 1.0),
        (Op::RoundEven, vec![3.5], 1.0),
        (Op::Fract, vec![3.3], 1.0),
        (Op::Min, vec![3.5, 2.0], 1.0),
        (Op::Max, vec![3.5, 2.0], 1.0),
        (Op::Abs, vec![3.5], 1.0),
        (Op::Sign, vec![3.5], 1.0),
        (Op::Step, vec![3.5, 4.0], 1.0),
        (Op::Neg, vec![3.5], 0.0),
    ] {
        assert_eq!(ulps(op, &args), expected, "{op:?}");
    }
    let absolute = |op, x| allowed("vulkan-1.4", op, &[x]);
    assert_eq!(absolute(Op::Sin, 1.0), Allowed::Bound(2f64.powi(-11)));
    assert_eq!(absolute(Op::Cos, -PI), Allowed::Bound(2f64.powi(-11)));
    assert_eq!(absolute(Op::Log, 0.5), Allowed::Bound(2f64.powi(-21)));
    assert_eq!(absolute(Op::Log2, 2.0), Allowed::Bound(2f64.powi(-21)));
}

#[test]
fn inherited_operations_name_their_definition() {
    for (name, op, text) in [
        ("vulkan-1.4", Op::Sqrt, "1/inversesqrt(x)"),
        ("vulkan-1.4", Op::Tan, "sin(x)/cos(x)"),
        ("vulkan-1.4", Op::Asin, "atan2(x, sqrt(1 - x*x))"),
        ("vulkan-1.4", Op::Acos, "atan2(sqrt(1 - x*x), x)"),
        ("vulkan-1.4", Op::Sinh, "(exp(x) - exp(-x))*0.5"),
        ("vulkan-1.4", Op::Cosh, "(exp(x) + exp(-x))*0.5"),
        ("vulkan-1.4", Op::Tanh, "sinh(x)/cosh(x)"),
        ("vulkan-1.4", Op::Asinh, "log(x + sqrt(x*x + 1))"),
        ("vulkan-1.4", Op::Acosh, "log(x + sqrt(x*x - 1))"),
        ("vulkan-1.4", Op::Atanh, "log((1 + x)/(1 - x))*0.5"),
        ("vulkan-1.4", Op::Pow, "exp2(y*log2(x))"),
        ("vulkan-1.4", Op::Mod, "x - y*floor(x/y)"),
        ("vulkan-1.4", Op::Rem, "x - y*trunc(x/y)"),
        ("vulkan-1.4", Op::Fma, "x*y + z"),
        ("vulkan-1.4", Op::Radians, "x*(pi/180)"),
        ("vulkan-1.4", Op::Degrees, "x*(180/pi)"),
        ("vulkan-1.4", Op::Mix, "x*(1 - a) + y*a"),
        ("vulkan-1.4", Op::Length, "sqrt(dot(x, x))"),
        ("vulkan-1.4", Op::Normalize, "x*inversesqrt(dot(x, x))"),
        ("wgsl", Op::Normalize, "x/length(x)"),
        ("wgsl", Op::Fract, "x - floor(x)"),
        ("glsl-4.60", Op::Normalize, "x/length(x)"),
    ] {
        match profile(name).allowed(op, &[0.5, 0.5, 0.5], 0.5, Stage::Vertex) {
            Allowed::Inherited { definition, or: 0.0 } => assert_eq!(definition.text(), text, "{op:?}"),
            other => panic!("{name} {op:?}: {other:?}"),
        }
    }
    let or = |op, exact| profile("wgsl").allowed(op, &[0.5], exact, Stage::Compute);
    assert!(matches!(or(Op::Asin, 0.5), Allowed::Inherited { or, .. } if or == 6.81e-5));
    assert!(matches!(or(Op::Acos, 1.0), Allowed::Inherited { or, .. } if or == 6.77e-5));
    assert!(matches!(or(Op::Tanh, 0.5), Allowed::Inherited { or, .. } if or == 1e-5));
}

#[test]
fn domains_and_missing_promises_are_told_apart() {
    assert_eq!(allowed("vulkan-1.4", Op::Sin, &[3.2]), Allowed::OutsideDomain);
    assert_eq!(allowed("vulkan-1.4", Op::Div, &[1.0, 2f64.powi(127)]), Allowed::OutsideDomain);
    assert_eq!(allowed("vulkan-1.4", Op::Log2, &[-1.0]), Allowed::OutsideDomain);
    assert_eq!(allowed("vulkan-1.4", Op::Determinant, &[]), Allowed::NoPromise);
    assert_eq!(allowed("glsl-4.60", Op::Sin, &[1.0]), Allowed::NoPromise);
    assert_eq!(allowed("wgsl", Op::Atan2, &[1.0, 0.0]), Allowed::OutsideDomain);
}

#[test]
fn a_flushed_result_and_an_overflow_are_allowed() {
    let tiny = 2f64.powi(-130);
    assert_eq!(allowed("vulkan-1.4", Op::Mul, &[2f64.powi(-100), 2f64.powi(-30)]), Allowed::Bound(tiny));
    let huge = f64::from(f32::MAX);
    assert_eq!(allowed("vulkan-1.4", Op::Add, &[huge, huge]), Allowed::Bound(f64::INFINITY));
    let mut keeps = profile("vulkan-1.4").clone();
    keeps.compute = Flush::Never;
    let bound = keeps.allowed(Op::Mul, &[2f64.powi(-100), 2f64.powi(-30)], tiny, Stage::Compute);
    assert_eq!(bound, Allowed::Bound(2f64.powi(-149)));
    assert_eq!(keeps.argument_flush(tiny, Stage::Compute), 0.0);
    assert_eq!(keeps.argument_flush(tiny, Stage::Vertex), tiny);
}

#[test]
fn the_conformance_suite_accepts_up_to_one_more_gap() {
    // exp2(0.1) with 3.2 ULP: the strict text ends between two numbers.
    let x = f64::from(0.1_f32);
    let strict = accept(profile("vulkan-1.4"), Op::Exp2, &[x], Stage::Compute).unwrap();
    let suite = accept(profile("vulkan-cts"), Op::Exp2, &[x], Stage::Compute).unwrap();
    let outside = grid::up(strict.hi);
    assert!(!strict.contains(outside) && suite.contains(outside));
    assert!(!suite.contains(f64::from((outside as f32).next_up())));
    let bound = |name| match allowed(name, Op::Exp2, &[x]) {
        Allowed::Bound(bound) => bound,
        other => panic!("{other:?}"),
    };
    assert!(bound("vulkan-cts") > bound("vulkan-1.4"));
}

#[test]
fn correctly_rounded_results_are_the_two_neighbours_and_no_third() {
    let (a, b) = (f64::from(0.1_f32), f64::from(0.7_f32));
    let sum = (a + b) as f32;
    let at = |y: f64| accept(profile("vulkan-1.4"), Op::Add, &[a, b], Stage::Compute).unwrap().contains(y);
    let near: Vec<bool> = [sum.next_down().next_down(), sum.next_down(), sum, sum.next_up(), sum.next_up().next_up()]
        .map(|y| at(f64::from(y)))
        .to_vec();
    assert_eq!(near.iter().filter(|ok| **ok).count(), 2, "{near:?}");
    assert!(near[2] && !near[0] && !near[4]);
    // An exact value that is a number has no second neighbour.
    let exact = accept(profile("vulkan-1.4"), Op::Add, &[1.0, 1.0], Stage::Compute).unwrap();
    assert_eq!(exact, Interval::point(2.0));
}

#[test]
fn definitions_open_at_least_the_interval_of_their_last_operation() {
    let vulkan = profile("vulkan-1.4");
    for (op, args) in [
        (Op::Sqrt, vec![3.0]),
        (Op::Tan, vec![0.7]),
        (Op::Asin, vec![0.3]),
        (Op::Acos, vec![0.3]),
        (Op::Pow, vec![1.7, -16.0]),
        (Op::Tanh, vec![0.4]),
        (Op::Sinh, vec![0.4]),
        (Op::Asinh, vec![3.0]),
        (Op::Acosh, vec![3.0]),
        (Op::Atanh, vec![0.4]),
        (Op::Mod, vec![7.3, 2.0]),
        (Op::Fma, vec![0.3, 0.7, 0.1]),
    ] {
        let exact = op.exact(&args);
        let accepted = accept(vulkan, op, &args, Stage::Compute).unwrap();
        assert!(accepted.contains(exact), "{op:?}");
        let room = Sieve::new(vulkan, op, None).ulp * grid::ulp(exact);
        assert!(accepted.hi - exact >= room && exact - accepted.lo >= room, "{op:?}");
        assert!(accepted.hi - accepted.lo < 0.1, "{op:?} is not bounded usefully: {accepted:?}");
    }
    // tan at π/2 divides by what may be zero.
    assert_eq!(accept(vulkan, Op::Tan, &[1.5707964], Stage::Compute), Err(Free::OutsideDomain));
    assert_eq!(accept(profile("glsl-4.60"), Op::Tan, &[0.7], Stage::Compute), Err(Free::NoPromise));
}

#[test]
fn what_passes_a_sieve_is_accepted_and_twice_an_absolute_promise_does_not_pass() {
    let vulkan = profile("vulkan-1.4");
    for (op, x, promise) in [(Op::Sin, 1.3, 2f64.powi(-11)), (Op::Log2, 1.3, 2f64.powi(-21)), (Op::Log2, 9.0, 0.0)] {
        let sieve = Sieve::new(vulkan, op, Some(Interval { lo: x, hi: 1.1 * x }));
        assert!(sieve.abs <= promise && sieve.abs >= 0.99 * promise, "{op:?} {sieve:?}");
        let accepted = accept(vulkan, op, &[x], Stage::Compute).unwrap();
        let exact = op.exact(&[x]);
        for error in [sieve.abs, sieve.ulp * grid::ulp(exact)] {
            assert!(sieve.passes(error / grid::ulp(exact), error) && !sieve.passes(f64::NAN, f64::NAN));
            assert!(accepted.contains(exact + error) && accepted.contains(exact - error), "{op:?} {error}");
        }
        let error = 2.0 * promise.max(sieve.ulp * grid::ulp(exact));
        assert!(!sieve.passes(error / grid::ulp(exact), error) && !accepted.contains(exact + error), "{op:?}");
    }
    // The absolute promise of log2 holds in a part of its domain, the relative one in the other.
    assert_eq!(Sieve::new(vulkan, Op::Log2, None), Sieve::NONE);
}

#[test]
fn a_subnormal_argument_may_count_as_zero() {
    let tiny = 2f64.powi(-127);
    let twice = accept(profile("vulkan-1.4"), Op::Mul, &[tiny, 2f64.powi(20)], Stage::Vertex).unwrap();
    assert!(twice.contains(0.0) && twice.contains(2f64.powi(-107)));
    // A flushed −2^-127 may be either zero, and the angle then either half turn.
    let angle = accept(profile("vulkan-1.4"), Op::Atan2, &[-tiny, -2.0 * tiny], Stage::Vertex).unwrap();
    assert!(angle.contains(-PI) && angle.contains(PI));
    // The sign of a zero need not be kept either, but by a device that keeps subnormal numbers.
    for zero in [0.0, -0.0] {
        let angle = accept(profile("vulkan-1.4"), Op::Atan2, &[zero, -2.0], Stage::Compute).unwrap();
        assert!(angle.contains(-PI) && angle.contains(PI));
    }
    let angle = accept(profile("binary32"), Op::Atan2, &[-0.0, -2.0], Stage::Compute).unwrap();
    assert!(angle.contains(-PI) && !angle.contains(PI));
    // log2 of zero is undefined, so a flushed argument allows anything.
    assert_eq!(accept(profile("wgsl"), Op::Atan, &[tiny], Stage::Vertex).map(|i| i.contains(0.0)), Ok(true));
    assert_eq!(accept(profile("vulkan-1.4"), Op::Log2, &[tiny], Stage::Vertex), Err(Free::OutsideDomain));
}

#[test]
fn unknown_keys_are_refused_with_a_suggestion() {
    let base = "name = \"mine\"\nextends = \"vulkan-1.4\"\n";
    assert!(read(base).is_ok());
    for (line, said) in [
        ("roundin = \"either\"", "p.toml:3:1: unknown key `roundin`; did you mean `rounding`?"),
        ("rounding = \"up\"", "p.toml:3:12: `rounding` is `up`; it can be either, nearest-even"),
        ("[operations]\nsine = \"exact\"", "p.toml:4:1: unknown key `sine`; did you mean `sin`?"),
        ("[operations]\nsin = \"abs(x)\"", "p.toml:4:7: `x` is no number"),
        ("[operations]\nsin = 3", "p.toml:4:7: `sin` is a rule, a list of rules or a table"),
        ("[operations]\nsin = []", "p.toml:4:7: `sin` has no rule"),
        ("[operations]\nsin = [{ alow = \"exact\" }]", "unknown key `alow`; did you mean `allow`?"),
        ("[operations]\nsin = [{ x = \"0..1\" }]", "missing key `allow`"),
        ("[operations]\nsin = [{ allow = \"exact\", x = \"1..0\" }]", "is empty"),
        ("[operations]\nsin = { samples = 1 }", "missing key `binades` in the measurement of `sin`"),
        ("[subnormals]\ngeometry = \"may\"", "unknown key `geometry`"),
        ("name", "p.toml:3:"),
    ] {
        let error = read(&format!("{base}{line}")).unwrap_err().to_string();
        assert!(error.contains(said), "{line}:\n{error}");
    }
    let error = read("name = \"mine\"\nextends = \"vulkan-1.5\"").unwrap_err().to_string();
    assert!(error.contains("p.toml:2:11: there is no profile `vulkan-1.5` to extend"), "{error}");
}

#[test]
fn an_operation_without_an_entry_is_refused() {
    let text = include_str!("../../profiles/wgsl.toml");
    let without: String = text.lines().filter(|l| !l.starts_with("tanh")).map(|l| format!("{l}\n")).collect();
    let error = read(&without).unwrap_err();
    assert_eq!(error.0, ["p.toml:1:1: operation `tanh` has no entry; write `none` for no promise"]);
}

fn llvmpipe() -> &'static str {
    include_str!("../../profiles/llvmpipe-22.3.6.toml")
}

#[test]
fn the_measurement_of_llvmpipe_says_what_was_measured_and_on_what() {
    let measured = profile("llvmpipe-22.3.6");
    assert_eq!(Identity::of(measured.driver.as_deref().unwrap()).unwrap().version, (22, 3));
    for part in ["LLVM 15.0.6", "Mesa 22.3.6", "measured 20", "samples an operation"] {
        assert!(measured.revision.contains(part), "{part}: {}", measured.revision);
    }
    assert_eq!((measured.rounding, measured.acceptance), (Rounding::NearestEven, Acceptance::Text));
    // The vertex stage flushes, the compute stage keeps what arithmetic gives; some functions do not.
    assert_eq!((measured.compute, measured.vertex), (Flush::May, Flush::Must));
    assert_eq!((measured.contraction, measured.rearrangement), (false, true));
    for op in crate::single::measurable() {
        let Entry::Measured(table) = measured.entry(op) else { panic!("{op:?} was not measured") };
        assert!(table.samples > 1 << 24, "{op:?}: {}", table.samples);
    }
}

#[test]
fn the_measurement_of_llvmpipe_bounds_operations() {
    let measured = |op: Op, args: &[f64]| allowed("llvmpipe-22.3.6", op, args);
    let half = |op: Op, args: &[f64]| Allowed::Bound(ulp_at(op.exact(args)) / 2.0);
    for (op, args) in [
        (Op::Add, vec![0.3, 1.1]),
        (Op::Sub, vec![0.3, 1.1]),
        (Op::Mul, vec![0.3, 1.1]),
        (Op::Div, vec![0.3, 1.1]),
        (Op::Sqrt, vec![0.3]),
        (Op::Fract, vec![1.3]),
    ] {
        assert_eq!(measured(op, &args), half(op, &args), "{op:?}");
    }
    for op in [Op::Floor, Op::Neg, Op::Abs, Op::Sign] {
        assert_eq!(measured(op, &[1.3]), Allowed::Bound(0.0), "{op:?}");
    }
    // Far better than the promise, and no better than what was seen.
    for (op, x, least, most) in [
        (Op::Sin, 1.3, 5e-8, 2e-7),
        (Op::Cos, 1.3, 5e-8, 2e-7),
        (Op::Asin, 0.8, 3.9e-4, 8e-4),
        (Op::Exp2, 1.3, 1e-7, 3e-6),
    ] {
        assert!(
            matches!(measured(op, &[x]), Allowed::Bound(b) if b > least && b < most),
            "{op:?}: {:?}",
            measured(op, &[x])
        );
    }
    // Operations that are made of others, and those on vectors.
    for (op, definition) in [
        (Op::Pow, Definition::PowByExp2),
        (Op::Fma, Definition::MultiplyAdd),
        (Op::Mod, Definition::ModByFloor),
        (Op::Tan, Definition::SinOverCos),
        (Op::Dot, Definition::SumOfProducts),
        (Op::Mix, Definition::MixByWeights),
        (Op::Normalize, Definition::NormalizeByInverseSqrt),
    ] {
        assert_eq!(measured(op, &[1.1, 0.2, 0.3]), Allowed::Inherited { definition, or: 0.0 }, "{op:?}");
    }
    assert_eq!(measured(Op::Determinant, &[]), Allowed::NoPromise);
    assert_eq!(measured(Op::Inverse, &[]), Allowed::NoPromise);
}

#[test]
fn a_binade_that_was_not_measured_is_outside_of_the_domain() {
    let text = llvmpipe();
    let start = text.find("[operations.exp2]").unwrap();
    let rows = start + text[start..].find("binades = [\n").unwrap() + "binades = [\n".len();
    let end = rows + text[rows..].find("\n]").unwrap();
    // The same without the row for 2 ≤ x < 4.
    let kept = |line: &&str| {
        let numbers: Vec<f64> =
            line.trim_matches([' ', '[', ']', ',']).split(", ").map_while(|n| n.parse().ok()).collect();
        !(numbers[0] == 1.0 && (numbers[1]..=numbers[2]).contains(&1.0))
    };
    let fewer: Vec<&str> = text[rows..end].lines().filter(kept).collect();
    assert_eq!(fewer.len() + 1, text[rows..end].lines().count(), "there is such a row");
    let profile = read(&format!("{}{}{}", &text[..rows], fewer.join("\n"), &text[end..])).unwrap();
    let at = |x: f64| profile.allowed(Op::Exp2, &[x], x.exp2(), Stage::Compute);
    assert_eq!(at(3.0), Allowed::OutsideDomain);
    assert!(matches!(at(0.3), Allowed::Bound(_)) && matches!(at(-3.0), Allowed::Bound(_)));
    assert!(matches!(allowed("llvmpipe-22.3.6", Op::Exp2, &[3.0]), Allowed::Bound(_)));
    // Where no value is defined, nothing was measured either.
    for (op, x) in [(Op::Log2, -2.0), (Op::Asin, 4.0), (Op::Sqrt, -1.0)] {
        let measured = profile.allowed(op, &[x], op.exact(&[x]), Stage::Compute);
        assert_eq!(measured, Allowed::OutsideDomain, "{op:?}");
    }
}

#[test]
fn a_corrupt_measurement_is_refused_at_the_place() {
    let text = llvmpipe();
    assert!(read(text).is_ok());
    let row = text.lines().find(|line| line.starts_with("    [1, ")).unwrap();
    for (from, to, said) in [
        ("extends = \"vulkan-1.4\"", "extends = \"vulkan-9\"", ":5:11: there is no profile `vulkan-9` to extend"),
        ("vertex = \"must\"", "vertex = \"perhaps\"", "`vertex` is `perhaps`; it can be must, may, never"),
        ("exhaustive = false", "exhaustive = 0", "`exhaustive` is true or false"),
        ("margin = 2.0", "margin = 0.5", "`margin` is a factor on errors, and at least 1"),
        ("margin = 2.0", "margin = nan", "`margin` is not a finite number"),
        ("definition = \"inherits(", "definition = \"ulp(", "no number"),
        ("definition = \"inherits(x*y + z)\"", "definition = \"exact\"", "`definition` is a formula"),
        ("[operations.exp2]", "[operations.expp]", "unknown key `expp`; did you mean `exp`?"),
        (row, "    [1, 0, 0],", "a row of `binades` has 18 numbers"),
        (row, "    [1, 0.5, 3, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0],", "two exponents from -127 to 128"),
        (row, "    [1, 0, 0, 7, 0.5, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0],", "do not add up to its samples"),
    ] {
        assert!(text.contains(from), "{from}");
        let error = read(&text.replacen(from, to, 1)).unwrap_err().to_string();
        assert!(error.starts_with("p.toml:") && error.contains(said), "{to}: {error}");
    }
    // Cut off anywhere: no measurement comes out of a part of a file.
    for part in [1, 5, 9] {
        let cut = text.len() / 10 * part;
        let error = read(&text[..cut]).unwrap_err().to_string();
        assert!(error.starts_with("p.toml:"), "{error}");
    }
}

#[test]
fn strict_binary32_is_what_its_text_says() {
    let strict = profile("binary32");
    assert_eq!((strict.rounding, strict.contraction, strict.rearrangement), (Rounding::NearestEven, false, false));
    assert_eq!((strict.compute, strict.vertex), (Flush::Never, Flush::Never));
    let ulps = |op: Op, args: &[f64]| match allowed("binary32", op, args) {
        Allowed::Bound(bound) => bound / ulp_at(op.exact(args)),
        other => panic!("{op:?}: {other:?}"),
    };
    for op in Op::ALL.into_iter().filter(|op| op.arity().is_some() && !matches!(op, Op::Mod | Op::Fma)) {
        let args = if op == Op::Acosh { [1.3, 0.7] } else { [0.3, 0.7] };
        assert!(ulps(op, &args) <= 0.5 + 2f64.powi(-20) * 1.1, "{op:?}: {}", ulps(op, &args));
    }
    assert_eq!((ulps(Op::Add, &[0.3, 0.7]), ulps(Op::Neg, &[0.3])), (0.5, 0.0));
    // A subnormal result is not flushed, and rounds on the finest grid.
    assert_eq!(allowed("binary32", Op::Mul, &[2f64.powi(-100), 2f64.powi(-30)]), Allowed::Bound(2f64.powi(-150)));
    assert_eq!(strict.argument_flush(1e-40, Stage::Vertex), 0.0);
    for op in [Op::Determinant, Op::Inverse] {
        assert!(names().all(|name| allowed(name, op, &[]) == Allowed::NoPromise), "{op:?}");
    }
}

#[test]
fn an_infinite_error_at_an_infinite_value_accepts_anything() {
    let at = |x: f64| accept(profile("vulkan-1.4"), Op::Exp, &[x], Stage::Compute);
    assert_eq!(at(f64::INFINITY), Err(Free::OutsideDomain));
    assert!(at(80.0).is_ok());
}

#[test]
fn a_known_exact_value_is_judged_by_the_rule_of_its_operation() {
    let near = |op, x: f64| accept_near(profile("vulkan-1.4"), op, &[x], x, Stage::Compute);
    assert_eq!(near(Op::Convert, 16_777_217.0), Ok(Interval { lo: 16_777_216.0, hi: 16_777_218.0 }));
    assert_eq!(near(Op::Ldexp, 12.0), Ok(Interval::point(12.0)));
    assert_eq!(near(Op::Determinant, 1.0), Err(Free::NoPromise));
    assert_eq!(near(Op::Convert, f64::NAN), Err(Free::OutsideDomain));
}
