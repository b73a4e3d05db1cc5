//! Edges of small functions.

use super::*;
use base::text::SourceFile;
use base::value::Batch;
use program::Program;
use program::lower::Target;

/// The edges of `f`, found from samples spread over [-1, 1].
fn edges_of(body: &str) -> (Program, Oracle, Edges) {
    let text = format!("#version 330 core\n{body}\n");
    let file = SourceFile::new("f.glsl", text);
    let program =
        Program::from_source(&file, syntax::Stage::Library, |_| Ok(Target::Function("f".to_owned()))).unwrap();
    let oracle = Oracle::new(&program).unwrap();
    let (invocation, case) = (program.invocation_record(), program.case_record());
    let mut batch = Batch::with_capacity(invocation.into(), case.into(), 1, 200);
    let words = batch.invocation_record.words();
    let mut stream = property::Stream::new(3);
    batch.invocations.extend((0..200 * words).map(|_| (stream.between(-1.0, 1.0) as f32).to_bits()));
    let domain = |sample: &Sample| sample.invocation.iter().all(|&w| f32::from_bits(w).abs() <= 1.0);
    let edges = edges(&oracle, &domain, &batch, Vec::new());
    (program, oracle, edges)
}

fn first(edges: &Edges) -> Vec<f32> {
    edges.samples.iter().map(|sample| f32::from_bits(sample.invocation[0])).collect()
}

#[test]
fn a_comparison_gives_the_nearest_numbers_on_both_sides_and_the_one_between() {
    for test in ["x < 0.3125", "x <= 0.3125", "x == 0.3125", "0.3125 > x"] {
        let (_, _, edges) = edges_of(&format!("float f(float x) {{ if ({test}) return x; return 1.0; }}"));
        let found = first(&edges);
        for x in [0.3125_f32.next_down(), 0.3125, 0.3125_f32.next_up()] {
            assert!(found.contains(&x), "{test}: {x} is not among {found:?}");
        }
        assert!(edges.samples.iter().all(|sample| f32::from_bits(sample.invocation[0]).abs() <= 1.0));
        let comparison = edges.reached.iter().find(|r| r.question.is_comparison()).unwrap();
        assert_eq!(comparison.met, 0b11, "{test} came out both ways");
    }
}

#[test]
fn functions_with_bends_and_jumps_have_edges() {
    for (body, at) in [
        ("float f(float x) { return abs(x - 0.125); }", 0.125),
        ("float f(float x) { return clamp(x, -0.25, 0.75); }", 0.75),
        ("float f(float x) { return max(x, 0.5); }", 0.5),
        ("float f(float x) { return step(0.625, x); }", 0.625),
        ("float f(float x) { return floor(x * 4.0); }", 0.25),
        ("float f(float x) { return fract(x * 2.0); }", 0.5),
        ("float f(float x) { return float(int(x * 8.0)); }", 0.125),
        ("float f(float x) { return smoothstep(0.25, 0.5, x); }", 0.25),
        ("float f(float x) { return sign(x + 0.75); }", -0.75),
    ] {
        let found = first(&edges_of(body).2);
        assert!(found.contains(&at), "{body}: {found:?}");
    }
}

#[test]
fn what_lies_behind_a_narrow_branch_is_met() {
    for test in [
        "x > 0.25 && x < 0.2500001",
        "abs(x - 0.7) < 1e-6",
        "x == 0.5 && y > 0.999999",
        "fract(x * 7.0) < 1e-6 && x > 0.5",
        "length(vec2(x - 0.1, y - 0.2)) < 1e-3",
        "x * y > 0.9999",
    ] {
        let (_, _, edges) = edges_of(&format!("float f(float x, float y) {{ if ({test}) return 1.0; return 0.0; }}"));
        for reached in edges.reached.iter().filter(|reached| reached.question.is_comparison()) {
            assert_eq!(reached.met, 0b11, "{test}: {reached:?}");
        }
    }
}

#[test]
fn a_shader_without_a_question_has_no_edges_but_those_given() {
    let (_, _, edges) = edges_of("float f(float x) { return x * 2.0; }");
    assert!(edges.samples.is_empty() && edges.reached.is_empty());
}

#[test]
fn an_endless_shader_does_not_hold_the_search_up() {
    let (_, _, edges) = edges_of("float f(float x) { while (x < 2.0) { if (x > 3.0) break; } return x; }");
    assert!(edges.samples.is_empty());
}

#[test]
fn ranks_and_words_undo_each_other_and_neighbours_are_neighbours() {
    for word in [0, 1, 0x3f80_0000, 0x7f7f_ffff, 0x8000_0001, 0xbf80_0000, 0xff7f_ffff] {
        assert_eq!(ranked(rank(word, Scalar::F32), Scalar::F32), word, "{word:08x}");
        assert_eq!(ranked(rank(word, Scalar::I32), Scalar::I32), word);
        assert_eq!(ranked(rank(word, Scalar::U32), Scalar::U32), word);
    }
    let next = |x: f32| f32::from_bits(ranked(rank(x.to_bits(), Scalar::F32) + 1, Scalar::F32));
    for x in [1.0_f32, -1.0, 0.0, -f32::from_bits(1), f32::MIN_POSITIVE] {
        assert_eq!(next(x), x.next_up(), "{x}");
    }
}
