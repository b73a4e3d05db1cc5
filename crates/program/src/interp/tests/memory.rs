//! Variables, pointers and indices of each slot's own.

use super::super::{Binary32, Binary64, FUEL, POISON};
use super::support::{assert_near, batch, compile_with, floats, glsl, ints, row, row32, run, wgsl};

#[test]
fn an_index_of_each_slot_selects_elements_of_a_variable() {
    let shader = wgsl(
        "fn f(i: i32, x: f32) -> vec4f {
        var a = array<vec2f, 4>(vec2f(1, 2), vec2f(3, 4), vec2f(5, 6), vec2f(7, 8));
        a[i] += vec2f(x);
        a[(i + 1) % 4].y = -1.0;
        return vec4f(a[i], a[(i + 1) % 4]);
    }",
    );
    let rows: Vec<Vec<u32>> = (0..300).map(|k: u32| vec![k % 4, (k as f32).to_bits()]).collect();
    let meaning = run::<Binary64>(&shader, &rows);
    for k in 0..300 {
        let (i, x) = (f64::from(k as u32 % 4), k as f64);
        let next = (i + 1.0) % 4.0;
        assert_eq!(meaning.vertex(k, 0), [1.0 + 2.0 * i + x, 2.0 + 2.0 * i + x, 1.0 + 2.0 * next, -1.0], "{k}");
    }
}

#[test]
fn matrices_and_vectors_are_indexed_twice() {
    let shader = wgsl(
        "fn f(c: i32, r: i32) -> f32 {
        var m = mat3x2f(1, 2, 3, 4, 5, 6);
        m[c][r] *= 10.0;
        return m[c][r] + m[2][1] + m[c].x;
    }",
    );
    for (c, r, expected) in [(0, 1, 20.0 + 6.0 + 1.0), (2, 1, 60.0 + 60.0 + 5.0), (1, 0, 30.0 + 6.0 + 30.0)] {
        assert_eq!(row(&shader, &ints(&[c, r])), [expected], "{c} {r}");
    }
}

#[test]
fn structures_in_arrays_keep_integers_and_numbers_apart() {
    let shader = wgsl(
        "
        struct Part { n: i32, v: vec2f, on: bool }
        fn f(i: i32) -> vec4f {
            var p: array<Part, 3>;
            for (var k = 0; k < 3; k++) { p[k] = Part(k * k, vec2f(f32(k), 0.5), k == 1); }
            let q = p[i];
            p[i].n += 1;
            return vec4f(f32(p[i].n), q.v.x, f32(q.n), f32(q.on));
        }",
    );
    assert_eq!(row(&shader, &[2]), [5.0, 2.0, 4.0, 0.0]);
    assert_eq!(row(&shader, &[1]), [2.0, 1.0, 1.0, 1.0]);
}

#[test]
fn pointers_are_passed_to_functions() {
    let shader = wgsl(
        "
        var<private> total: f32 = 100.0;
        fn add(p: ptr<function, f32>, x: f32) -> f32 { let old = *p; *p += x; total += x; return old; }
        fn f(x: f32) -> vec4f {
            var a = 1.0; var v = array<f32, 2>(5.0, 6.0);
            let old = add(&a, x);
            if x > 2.0 { _ = add(&a, 10.0); }
            return vec4f(old, a, total, v[1]);
        }",
    );
    assert_eq!(row(&shader, &floats(&[2.0])), [1.0, 3.0, 102.0, 6.0]);
    assert_eq!(row(&shader, &floats(&[3.0])), [1.0, 14.0, 113.0, 6.0]);
}

#[test]
fn private_variables_start_anew_in_each_chunk() {
    let shader = wgsl("var<private> n: i32 = 3; fn f(x: i32) -> i32 { n += x; return n; }");
    let rows: Vec<Vec<u32>> = (0..1000).map(|k| vec![k]).collect();
    let meaning = run::<Binary64>(&shader, &rows);
    assert!((0..1000).all(|k| meaning.vertex(k, 0) == [k as f64 + 3.0]));
}

#[test]
fn local_variables_start_anew_in_each_call_and_round() {
    let shader = glsl(
        "
        int count(int x) { int n = 0; for (int i = 0; i < x; ++i) { int m = 1; m += i; n += m; } return n; }
        ivec2 f(int x) { return ivec2(count(x), count(x + 1)); }",
    );
    assert_eq!(row32(&shader, &[4]), [10, 15]);
}

#[test]
fn out_and_inout_parameters_are_outputs() {
    let shader = glsl("float f(in float x, inout vec2 v, out float y) { y = x * 2.0; v.y += x; return v.x; }");
    // The word of `y` goes in as well, and is never looked at.
    let found = row(&shader, &floats(&[3.0, 10.0, 20.0, 77.0]));
    assert_near(&found, &[10.0, 10.0, 23.0, 6.0], "return, v, y");
}

#[test]
fn a_value_read_before_a_store_stays_what_it_was() {
    let shader = wgsl(
        "fn f(x: f32) -> vec3f {
        var a = x;
        let before = a;
        a = a + 1.0;
        let between = a;
        if x > 0.0 { a = 50.0; }
        return vec3f(before, between, a);
    }",
    );
    assert_eq!(row(&shader, &floats(&[2.0])), [2.0, 3.0, 50.0]);
    assert_eq!(row(&shader, &floats(&[-2.0])), [-2.0, -1.0, -1.0]);
}

#[test]
fn a_result_that_is_not_written_on_every_path_shows() {
    let shader = glsl("void f(in float x, out float y) { if (x > 0.0) y = x; }");
    let executable = compile_with(&shader, false).unwrap();
    let meaning = executable.run::<Binary64>(&batch(&[floats(&[1.0]), floats(&[-1.0])]), FUEL).unwrap();
    assert_eq!(meaning.vertex(0, 0), [1.0]);
    assert_eq!(meaning.unwritten(), [(1, 0, 0)]);
    assert!(meaning.is_written(0, 0, 0) && !meaning.is_written(1, 0, 0));
    let meaning = executable.run::<Binary32>(&batch(&[floats(&[-1.0])]), FUEL).unwrap();
    assert_eq!((meaning.vertex(0, 0), meaning.unwritten().len()), (&[POISON][..], 1));
}
