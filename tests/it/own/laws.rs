//! Laws: each is kept by a right function and broken by a wrong one, whose smallest case is told.

use super::{check, finding, suite};

/// A law, a function that keeps it, one that breaks it, a part of what is told, and the smallest case.
struct Case {
    law: &'static str,
    inputs: &'static [&'static str],
    right: &'static str,
    wrong: &'static str,
    reported: &'static str,
    smallest: &'static [&'static str],
}

const CASES: &[Case] = &[
    Case {
        law: "{ kind = \"odd\", inputs = [\"x\"] }",
        inputs: &["x"],
        right: "float f(float x) { return x * x * x - 2.0 * x; }",
        wrong: "float f(float x) { return x * x * x - 2.0 * x + (x > 1.0 ? 0.25 : 0.0); }",
        reported: "the relation `odd(x)` does not hold: changing the sign of `x` changes the sign of the output",
        smallest: &["float x = 2.0"],
    },
    Case {
        law: "{ kind = \"even\", inputs = [\"x\"], outputs = [\"return\"] }",
        inputs: &["x", "y"],
        right: "vec2 f(float x, float y) { return vec2(x * x, abs(x) + y); }",
        wrong: "vec2 f(float x, float y) { return vec2(x * x, x + y); }",
        reported: "the relation `even(x)` does not hold: changing the sign of `x` changes nothing; return.y is",
        smallest: &["float x = 1.0", "float y = 0.0"],
    },
    Case {
        law: "{ kind = \"periodic\", inputs = [\"x\"], period = 0.5 }",
        inputs: &["x"],
        right: "float f(float x) { return fract(2.0 * x) * 0.25; }",
        wrong: "float f(float x) { return fract(2.0 * x) * 0.25 + 0.001 * floor(x); }",
        reported: "the relation `periodic(x)` does not hold: 0.5 added to `x` changes nothing",
        smallest: &["float x = 0.5"],
    },
    Case {
        // The period is no binary32 number.
        law: "{ kind = \"periodic\", inputs = [\"x\"], period = 6.283185307179586 }",
        inputs: &["x"],
        right: "float f(float x) { return sin(x); }",
        wrong: "float f(float x) { return sin(1.001 * x); }",
        reported: "the relation `periodic(x)` does not hold: 6.283185307179586 added to `x` changes nothing",
        smallest: &["float x = 0.0"],
    },
    Case {
        law: "{ kind = \"monotone\", inputs = [\"x\"], direction = \"rising\" }",
        inputs: &["x", "y"],
        right: "float f(float x, float y) { return x + 0.5 * sin(x) + y; }",
        wrong: "float f(float x, float y) { return x + 1.5 * sin(2.0 * x) + y; }",
        reported: "the relation `monotone(x)` does not hold: the output does not fall where `x` grows",
        smallest: &["float x = 1.0", "float y = 0.0"],
    },
    Case {
        law: "{ kind = \"monotone\", inputs = [\"x\"], direction = \"falling\" }",
        inputs: &["x"],
        right: "float f(float x) { return exp2(-x); }",
        wrong: "float f(float x) { return exp2(-x) + (x > 1.5 ? 1.0 : 0.0); }",
        reported: "the output does not grow where `x` grows",
        smallest: &["float x = "],
    },
    Case {
        law: "{ kind = \"range\", range = [0.0, 1.0] }",
        inputs: &["x"],
        right: "float f(float x) { return smoothstep(-1.0, 1.0, x); }",
        wrong: "float f(float x) { return x > 1.0 ? 1.25 : 0.5; }",
        reported: "the relation `range` does not hold: the output lies in [0.0, 1.0]",
        smallest: &["float x = 2.0"],
    },
    Case {
        law: "{ kind = \"unit\" }",
        inputs: &["v"],
        right: "vec3 f(vec3 v) { return normalize(v + vec3(3.0, 0.0, 0.0)); }",
        wrong: "vec3 f(vec3 v) { return normalize(v + vec3(3.0, 0.0, 0.0)) * 1.0001; }",
        reported: "the relation `unit` does not hold: the output has length one; |return|² is 1.000",
        smallest: &["vec3 v = 0.0, 0.0, 0.0"],
    },
    Case {
        law: "{ kind = \"symmetric\", inputs = [\"a\", \"b\", \"c\"] }",
        inputs: &["a", "b", "c"],
        right: "float f(float a, float b, float c) { return a * b * c; }",
        wrong: "float f(float a, float b, float c) { return a * b + c; }",
        reported: "the relation `symmetric(a, b, c)` does not hold: exchanging `a`, `b`, `c` changes nothing",
        smallest: &["float a = 1.0", "float b = 0.0", "float c = 0.0"],
    },
    Case {
        law: "{ kind = \"rigid\", points = [\"p\", \"q\", \"return\"] }",
        inputs: &["p", "q", "t"],
        right: "vec3 f(vec3 p, vec3 q, float t) { return mix(p, q, t); }",
        wrong: "vec3 f(vec3 p, vec3 q, float t) { return mix(p, q * vec3(1.0, 1.0, 1.5), t); }",
        reported: "turning and shifting the inputs turns and shifts the output with them; return.",
        smallest: &["vec3 p = 0.0, 0.0, 0.0", "vec3 q = 0.0, 0.0, 0.0", "float t = 1.0"],
    },
    Case {
        // Directions turn and are not shifted; a distance stays. A cross product is kept by turns alone.
        law: "{ kind = \"rigid\", directions = [\"p\", \"q\", \"return\"] }",
        inputs: &["p", "q"],
        right: "vec3 f(vec3 p, vec3 q) { return cross(p, q); }",
        wrong: "vec3 f(vec3 p, vec3 q) { return cross(p, q) + vec3(0.0, 0.0, 0.5 * p.x); }",
        reported: "the relation `rigid(p, q, return)` does not hold",
        smallest: &["vec3 p = 1.0, 0.0, 0.0", "vec3 q = 0.0, 0.0, 0.0"],
    },
    Case {
        law: "{ kind = \"rigid\", points = [\"p\", \"q\"], mirrored = true }",
        inputs: &["p", "q"],
        right: "float f(vec3 p, vec3 q) { return distance(p, q); }",
        wrong: "float f(vec3 p, vec3 q) { return distance(p.xy, q.xy); }",
        reported: "the relation `rigid(p, q)` does not hold",
        smallest: &["vec3 p = 0.0, 0.0, 0.0", "vec3 q = "],
    },
    Case {
        law: "{ kind = \"scales\", inputs = [\"v\"], degree = 2 }",
        inputs: &["v"],
        right: "float f(vec2 v) { return dot(v, v); }",
        wrong: "float f(vec2 v) { return dot(v, v) + 0.1 * v.x; }",
        reported: "scaling `v` by k scales the output by k to the power of 2",
        smallest: &["vec2 v = 1.0, 0.0"],
    },
    Case {
        law: "{ kind = \"unordered\", inputs = [\"v\"] }",
        inputs: &["v"],
        right: "#version 150\nfloat f(float v[3]) { return v[0] + v[1] + v[2]; }",
        wrong: "#version 150\nfloat f(float v[3]) { return v[0] + v[1] + 1.001 * v[2]; }",
        reported: "the relation `unordered(v)` does not hold: the order of the elements of `v` changes nothing",
        smallest: &["float[3] v = "],
    },
    Case {
        law: "{ kind = \"prefix\", inputs = [\"v\"] }",
        inputs: &["v"],
        right: "#version 150\nfloat[3] f(float v[3]) { return float[3](v[0], v[0] + v[1], v[0] + v[1] + v[2]); }",
        wrong: "#version 150\nfloat[3] f(float v[3]) { return float[3](v[0], v[0] + v[2], v[0] + v[1] + v[2]); }",
        reported: "the first elements of the output depend on as many first ones of `v` alone; return[1] is",
        smallest: &["float[3] v = "],
    },
    Case {
        law: "{ kind = \"sorts\", inputs = [\"v\"] }",
        inputs: &["v"],
        right: "#version 150\nfloat[2] f(float v[2]) { return float[2](min(v[0], v[1]), max(v[0], v[1])); }",
        // In order, but an element is lost.
        wrong: "#version 150\nfloat[2] f(float v[2]) { return float[2](v[0], max(v[0], v[1])); }",
        reported: "the relation `sorts(v)` does not hold: the output is `v` in ascending order; return[0] is",
        smallest: &["float[2] v = "],
    },
    Case {
        law: "{ kind = \"sums\", total = 1.0, rows = 2 }",
        inputs: &["v"],
        right: "#version 150\nfloat[4] f(float v[4]) { float a = exp(v[0]), b = exp(v[1]), c = exp(v[2]), d = exp(v[3]);\n\
                return float[4](a / (a + b), b / (a + b), c / (c + d), d / (c + d)); }",
        wrong: "#version 150\nfloat[4] f(float v[4]) { float a = exp(v[0]), b = exp(v[1]), c = exp(v[2]), d = exp(v[3]);\n\
                return float[4](a / (a + b), b / (a + b), c / (c + d), d / (c + a)); }",
        reported: "the elements of each of 2 rows of the output add up to 1.0; sum of return in row 1 is",
        smallest: &["float[4] v = "],
    },
    Case {
        law: "{ kind = \"additive\", inputs = [\"v\"] }",
        inputs: &["v"],
        right: "#version 150\nfloat f(float v[3]) { return v[0] - 2.0 * v[1] + 0.5 * v[2]; }",
        wrong: "#version 150\nfloat f(float v[3]) { return v[0] - 2.0 * v[1] + 0.5 * abs(v[2]); }",
        reported: "the output of a sum of `v` is the sum of the outputs",
        smallest: &["float[3] v = "],
    },
];

#[test]
fn each_law_is_kept_by_a_right_function_and_rings_for_a_wrong_one() {
    let mut faults = Vec::new();
    for Case { law, inputs, right, wrong, reported, smallest } in CASES {
        let suite = suite(inputs, &format!("relations = [{law}]"));
        let run = |shader: &str| check(&[("f.glsl", shader), ("f.suite.toml", &suite)], &[]);
        let ran = run(right);
        if ran.code != 0 || !ran.out.contains("1 relation (") || ran.out.contains("1 relation (0)") {
            faults.push(format!("{law} is kept, and\n{}", ran.out));
        }
        let ran = run(wrong).expect(1);
        let (message, case) = finding(&ran);
        let shrunk = case.len() == smallest.len() && case.iter().zip(*smallest).all(|(c, s)| c.starts_with(s));
        if !message.contains(reported) || !shrunk {
            faults.push(format!("{law} is broken at {smallest:?}, and\n{}", ran.out));
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn laws_of_vertex_stages_are_about_their_outputs() {
    let shader = |w: &str| {
        format!(
            "#version 330\nuniform mat4 m;\nin vec4 p;\nin vec3 n;\nout vec3 normal;\n\
             void main() {{ normal = normalize({w} * n + vec3(0.0, 0.0, 4.0)); gl_Position = m * p; }}\n"
        )
    };
    let suite = "suite = \"v\"\nshader = \"a.vert\"\nstage = \"vertex\"\nsamples = 512\n\
        relations = [{ kind = \"unit\", outputs = [\"normal\"] }, { kind = \"even\", inputs = [\"n\"], outputs = [\"normal\"] }]\n\
        [[inputs]]\nnames = [\"p\"]\ngenerator = \"point\"\nrange = [-1.0, 1.0]\n\
        [[inputs]]\nnames = [\"n\"]\ngenerator = \"direction\"\n[[inputs]]\nnames = [\"m\"]\ngenerator = \"rigid\"\n";
    check(&[("a.vert", &shader("0.0")), ("a.suite.toml", suite)], &[]).expect(0);
    let ran = check(&[("a.vert", &shader("1.0")), ("a.suite.toml", suite)], &[]).expect(1);
    assert!(ran.out.contains("the relation `even(n)` does not hold") && !ran.out.contains("`unit"), "{}", ran.out);
}

#[test]
fn laws_that_fit_no_input_or_output_are_refused_with_their_place() {
    let refused = |law: &str, reported: &str| {
        let suite = suite(&["x", "v"], &format!("relations = [{law}]"));
        let shader = "vec2 f(float x, vec2 v) { return x * v; }";
        let ran = check(&[("f.glsl", shader), ("f.suite.toml", &suite)], &[]).expect(2);
        let all = format!("{}{}", ran.out, ran.err);
        assert!(all.contains(reported), "{law}\n{all}");
    };
    for (law, reported) in [
        ("{ kind = \"odd\", inputs = [\"X1\"] }", "f.suite.toml:6:14: the law `odd` names an input `X1` that"),
        ("{ kind = \"odd\", inputs = [\"xx\"] }", "did you mean `x`?"),
        ("{ kind = \"range\", range = [0.0, 1.0], outputs = [\"retrun\"] }", "did you mean `return`?"),
        ("{ kind = \"monotone\", inputs = [\"v\"], direction = \"rising\" }", "one `float` of the inputs"),
        ("{ kind = \"symmetric\", inputs = [\"x\", \"v\"] }", "exchanges inputs of one type"),
        ("{ kind = \"rigid\", points = [\"v\"] }", "moves vec3, vec4 and arrays of them"),
        ("{ kind = \"rigid\", points = [\"return\"] }", "moves"),
        ("{ kind = \"od\", inputs = [\"x\"] }", "f.suite.toml:6:23: unknown kind `od`; did you mean `odd`?"),
        ("{ kind = \"odd\", input = [\"x\"] }", "unknown key `input` in [[relations]]; did you mean `inputs`?"),
        ("{ kind = \"odd\", inputs = [] }", "`inputs` names 1 or more inputs"),
        ("{ kind = \"periodic\", inputs = [\"x\"] }", "missing key `period`"),
        ("{ kind = \"periodic\", inputs = [\"x\"], period = 0 }", "`period` is 0; it is a number that is neither"),
        ("{ kind = \"monotone\", inputs = [\"x\"], direction = \"up\" }", "unknown direction `up`"),
        ("{ kind = \"scales\", inputs = [\"x\"], degree = 0.5 }", "`degree` is a whole number"),
        ("{ kind = \"range\" }", "missing key `range`"),
        ("{ kind = \"unit\", range = [0.0, 1.0] }", "unknown key `range`"),
        ("{ kind = \"unordered\", inputs = [\"x\"] }", "is about arrays with as many elements as `x`"),
        ("{ kind = \"sorts\", inputs = [\"v\"] }", "is about an array of numbers, and `vec2 v` is none"),
        ("{ kind = \"sums\" }", "missing key `total`"),
        ("{ kind = \"sums\", total = 1.0, rows = 3, outputs = [\"return\"] }", "arrays that make 3 equal rows"),
        ("{ kind = \"additive\", inputs = [\"y\"] }", "names an input `y`"),
        ("3", "`relations` is a list of texts and tables"),
    ] {
        refused(law, reported);
    }
}
