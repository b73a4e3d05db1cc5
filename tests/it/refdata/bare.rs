//! Shaders without a suite, and suites whose reference is a shader or a record.

use std::fs;

use super::{folder, generate, names};
use crate::binary::run_in;

/// A shader without a suite: each function with the domains that its comments state.
#[test]
fn a_shader_without_a_suite_gives_what_it_means_itself() {
    let folder = folder();
    let at = folder.path();
    let text = "// shadercheck: x in [0, 4]\nfloat tone(float x) { return x / (1.0 + x); }\n\
                float third(float x) { return x * 0.1; }\n";
    fs::write(at.join("tone.glsl"), text).unwrap();
    let ran = generate(at, "tone.glsl --samples 500 --format csv -o data").expect(0);
    assert_eq!(ran.out.lines().count(), 2, "{}", ran.out);
    assert_eq!(names(&at.join("data")), ["tone.glsl.third.csv", "tone.glsl.tone.csv"]);
    let text = fs::read_to_string(at.join("data/tone.glsl.tone.csv")).unwrap();
    let provenance: serde_json::Value =
        serde_json::from_str(text.lines().next().unwrap().trim_start_matches("# ")).unwrap();
    assert_eq!(provenance["expected"]["by"], "meaning");
    assert_eq!(provenance["expected"]["formula"], serde_json::Value::Null);
    let accuracy = provenance["expected"]["accuracy"].as_str().unwrap();
    assert!(accuracy.contains("no formula, and not within 1 ULP as a whole"), "{accuracy}");
    assert_eq!(provenance["domain"][0]["about"], "as stated: in [0, 4]");
    let mut seen = 0;
    for line in text.lines().skip(2) {
        let mut words = line.split(',');
        let mut next = || words.next().unwrap();
        next();
        let (x, expected): (f32, f64) = (next().parse().unwrap(), next().parse().unwrap());
        assert!((0.0..=4.0).contains(&x), "{line}");
        assert_eq!(expected, f64::from(x) / (1.0 + f64::from(x)), "{line}");
        let (nearest, bound): (f32, f64) = (next().parse().unwrap(), next().parse().unwrap());
        assert_eq!(nearest, expected as f32);
        // What binary64 does to the value is within the bound too.
        assert!((f64::from(nearest) - expected).abs() <= bound && bound < 1e-6, "{line}");
        seen += 1;
    }
    assert_eq!(seen, 500);
    run_in(at, "refdata verify data/tone.glsl.tone.csv data/tone.glsl.tone.csv").expect(0);
    // 0.1 is what its author wrote, not the nearest binary32.
    let third = fs::read_to_string(at.join("data/tone.glsl.third.csv")).unwrap();
    let line = third.lines().nth(7).unwrap();
    let words: Vec<&str> = line.split(',').collect();
    let x: f32 = words[1].parse().unwrap();
    assert_eq!(words[2].parse::<f64>().unwrap(), f64::from(x) * 0.1, "{line}");

    // The same inputs whatever the number of parts, a domain of the command line, one function, a stage.
    for part in 0..2 {
        generate(at, &format!("tone.glsl --function tone --samples 70000 -o parts --shard {part}/2")).expect(0);
    }
    generate(at, "tone.glsl --function tone --samples 70000 -o whole.npz").expect(0);
    run_in(at, "merge parts --out joined.npz").expect(0);
    assert!(fs::read(at.join("joined.npz")).unwrap() == fs::read(at.join("whole.npz")).unwrap());
    generate(at, "tone.glsl --function third --domain x=[2,3] --samples 10 --format csv -o t.csv").expect(0);
    let text = fs::read_to_string(at.join("t.csv")).unwrap();
    for line in text.lines().skip(2) {
        let x: f32 = line.split(',').nth(1).unwrap().parse().unwrap();
        assert!((2.0..=3.0).contains(&x), "{line}");
    }
    fs::write(
        at.join("a.vert"),
        "#version 330\nin vec3 p;\nuniform mat4 m;\nvoid main() { gl_Position = m * vec4(p, 1.0); }\n",
    )
    .unwrap();
    generate(at, "a.vert --samples 200 --format json -o a.json").expect(0);
    run_in(at, "refdata verify a.json a.json").expect(0);

    let reported = |args: &str| generate(at, args).expect(2).err;
    assert!(reported("tone.glsl -o x.npz").contains("2 data sets do not go into the one file"));
    assert!(reported("tone.glsl --function tne -o x").contains("did you mean `tone`?"));
    assert!(reported("tone.glsl --domain y=[0,1] -o x").contains("no function that was run has an input `y`"));
    assert!(reported("sphere --function sphere -o x").contains("are about shaders without a suite"));
    fs::write(at.join("broken.glsl"), "float f(float x) { return y; }\n").unwrap();
    assert!(reported("broken.glsl -o x").contains("`broken.glsl` does not compile"));
    fs::write(
        at.join("t.frag"),
        "#version 330\nuniform sampler2D s;\nin vec2 u;\nout vec4 c;\nvoid main() { c = texture(s, u); }\n",
    )
    .unwrap();
    assert!(reported("t.frag -o x").contains("it reads the texture"));
    fs::write(
        at.join("g.geom"),
        "#version 330\nlayout(points) in;\nlayout(points, max_vertices = 2) out;\nvoid main() { if (gl_in[0].gl_Position.x > 0.0) { gl_Position = gl_in[0].gl_Position; EmitVertex(); } }\n",
    )
    .unwrap();
    assert!(reported("g.geom -o x").contains("how many vertices it emits depends on the inputs"));
    fs::write(at.join("f.wgsl"), "fn f(x: f32) -> f32 { return x; }\n").unwrap();
    generate(at, "f.wgsl --samples 100 --format json -o w.json").expect(0);
    run_in(at, "refdata verify w.json w.json").expect(0);
}

const SUITE: &str = "suite = \"tone\"\nshader = \"tone.glsl\"\nstage = \"function\"\nentry = \"tone\"\nsamples = 128\n\
                     WANTED\n[[inputs]]\nnames = [\"x\"]\ngenerator = \"interval\"\nrange = [0.5, 4.0]\n";

#[test]
fn a_suite_with_a_reference_expects_what_the_reference_means() {
    let folder = folder();
    let at = folder.path();
    // The shader is a little wrong: what is expected is not what it means.
    fs::write(at.join("tone.glsl"), "float tone(float x) { return x / (1.001 + x); }\n").unwrap();
    fs::write(at.join("right.glsl"), "float tone(float x) { return x / (1.0 + x); }\n").unwrap();
    fs::write(at.join("right.wgsl"), "fn tone(x: f32) -> f32 { return x / (1.0 + x); }\n").unwrap();
    for language in ["glsl", "wgsl"] {
        let wanted = format!("reference = {{ file = \"right.{language}\", function = \"tone\" }}\n");
        fs::write(at.join("tone.suite.toml"), SUITE.replace("WANTED\n", &wanted)).unwrap();
        let ran = generate(at, "tone.suite.toml --format csv -o t.csv").expect(0);
        // The shader is not the reference: that is told, and no bound makes up for it.
        assert!(
            ran.err.contains("for 128 of 128 samples the shader gives something else than is expected"),
            "{}",
            ran.err
        );
        let text = fs::read_to_string(at.join("t.csv")).unwrap();
        assert!(text.contains("\"by\":\"reference\"") && text.contains(&format!("right.{language}")), "{language}");
        for line in text.lines().skip(2) {
            let words: Vec<&str> = line.split(',').collect();
            let (x, expected, bound): (f32, f64, f64) =
                (words[1].parse().unwrap(), words[2].parse().unwrap(), words[4].parse().unwrap());
            let x = f64::from(x);
            assert_eq!(expected, x / (1.0 + x), "{line}");
            assert!((x / (1.001 + x) - expected).abs() > bound, "{line}");
        }
    }
    fs::write(at.join("tone.glsl"), "float tone(float x) { return x / (1.0 + x); }\n").unwrap();
    assert_eq!(generate(at, "tone.glsl --format csv -o t.csv").expect(0).err, "");
}

#[test]
fn recorded_values_become_reference_data() {
    let folder = folder();
    let at = folder.path();
    fs::write(at.join("tone.glsl"), "float tone(float x) { return x / (1.0 + x); }\n").unwrap();
    fs::write(at.join("values.csv"), "x,return\n1.0,0.5\n3.0,0.75\n0.25,0.2\n").unwrap();
    fs::write(at.join("tone.suite.toml"), SUITE.replace("WANTED\n", "recorded = \"values.csv\"\n")).unwrap();
    generate(at, "tone.suite.toml --format csv -o t.csv").expect(0);
    let text = fs::read_to_string(at.join("t.csv")).unwrap();
    assert!(text.contains("\"by\":\"recorded\"") && text.contains("as recorded in values.csv"), "{text}");
    let rows: Vec<Vec<&str>> = text.lines().skip(2).map(|line| line.split(',').collect()).collect();
    assert_eq!(
        rows.iter().map(|row| &row[1..3]).collect::<Vec<_>>(),
        [["1.0", "0.5"], ["3.0", "0.75"], ["0.25", "0.2"]]
    );
    for row in &rows {
        let bound: f64 = row[4].parse().unwrap();
        assert!(bound > 0.0 && bound < 0.1, "{row:?}");
    }
    generate(at, "tone.suite.toml --format json -o t.json").expect(0);
    run_in(at, "refdata verify t.csv t.json").expect(0);
    let reported = generate(at, "tone.suite.toml --samples 4 -o t.npz").expect(2).err;
    assert!(
        reported.contains("has 3 recorded rows, which are its samples; ask for --samples 3 or fewer"),
        "{reported}"
    );
}
