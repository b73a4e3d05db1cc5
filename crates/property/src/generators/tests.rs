//! Every generator reaches what it claims, stays in its domain, and refuses what it cannot fill.

use glam::DVec3;

use super::testing::{SAMPLES, draw, floats, keeps_its_promises, refuses_odd_words};
use super::*;

/// Shapes and options on which the laws of all generators are tested.
fn example(name: &str) -> (Vec<Shape>, Options) {
    let bare = Options::default();
    let ranged = |lo, hi| Options { range: Some([lo, hi]), ..Options::default() };
    match name {
        "interval" => (vec![Shape::FLOAT, Shape::VEC2], ranged(0.0, 1.0)),
        "point" => (vec![Shape::VEC4, Shape::VEC3], bare),
        "vector" | "direction" => (vec![Shape::VEC3], bare),
        "simplex" => (vec![Shape::FLOAT.array_of(5)], bare),
        "raw_weights" => (vec![Shape::VEC4], bare),
        "rigid" | "affine" | "projection" => (vec![Shape::MAT4], bare),
        "nodes" => (vec![Shape::VEC3; 3], bare),
        "index" => (vec![Shape::INT], ranged(-3.0, 7.0)),
        "array" => (vec![Shape::FLOAT.array_of(24), Shape::VEC2], ranged(-4.0, 9.0)),
        "sorted" => (vec![Shape::FLOAT.array_of(16)], ranged(-3.0, 5.0)),
        "permutation" => (vec![Shape::INT.array_of(9), Shape::INT.array_of(5)], bare),
        "constant" => (vec![Shape::VEC2], Options { values: vec![0.5, 2.0], ..bare }),
        other => panic!("add an example for `{other}`"),
    }
}

fn group(name: &str) -> (&'static dyn Generator, Group) {
    let generator = by_name(name).unwrap();
    let (shapes, options) = example(name);
    (generator, Group::new(generator, &shapes, options).unwrap())
}

#[test]
fn rows_side_by_side_are_those_one_by_one() {
    for name in ["interval", "point", "vector"] {
        let (generator, group) = group(name);
        let (stride, at) = (group.words() + 3, 2);
        let whole = [std::ops::Range { start: at, end: at + group.words() }];
        for (rows, per_case, first_invocation) in [(1, 1, 0), (16, 16, 0), (100, 7, 3), (333, 1, 0), (50, 1000, 990)] {
            let [mut abreast, mut single] = [vec![9; rows * stride], vec![9; rows * stride]];
            let (spans, first_case) = (&whole[..], u64::MAX - 2);
            let (key, exact_key) = (77, 5);
            let of = |words| Rows { words, stride, spans, key, exact_key, first_case, first_invocation, per_case };
            assert!(abreast::fits(&of(&mut [])));
            generator.fill_rows(&group, of(&mut abreast));
            each_row(generator, &group, of(&mut single));
            assert_eq!(abreast, single, "{name} {rows} {per_case}");
        }
    }
}

/// As [`super::testing::reaches`], for the example of a generator.
fn reaches(name: &str, classes: &[(&str, usize, super::testing::Class<'_>)]) {
    let (generator, group) = group(name);
    super::testing::reaches(generator, &group, classes);
}

#[test]
fn every_generator_keeps_its_promises_and_has_a_name_of_its_own() {
    for (i, generator) in all().iter().enumerate() {
        assert!(all()[..i].iter().all(|g| g.name() != generator.name()));
        let (shapes, options) = example(generator.name());
        keeps_its_promises(*generator, &shapes, &options);
    }
    assert!(by_name("nothing").is_none());
}

#[test]
fn words_that_no_sample_has_are_not_admitted() {
    for generator in all().iter().filter(|g| g.name() != "index") {
        let (_, group) = group(generator.name());
        refuses_odd_words(*generator, &group, 0..=group.words() - 1);
    }
    let (generator, group) = group("index");
    assert!(!generator.admits(&group, &[8]) && generator.admits(&group, &[-3i32 as u32]));
}

#[test]
fn interval_reaches_its_edges() {
    reaches(
        "interval",
        &[
            ("lower end", 150, &|v| v[0].to_bits() == 0),
            ("upper end", 150, &|v| v[1] == 1.0),
            ("negative zero", 30, &|v| v[0].to_bits() == 1 << 31),
            ("below the upper end", 30, &|v| v[2] == 1f32.next_down()),
            ("power of two", 100, &|v| v[0] != 0.0 && v[0] < 1.0 && v[0].to_bits() & 0x7f_ffff == 0),
            ("beside a power of two", 100, &|v| v[0] < 1.0 && matches!(v[0].to_bits() & 0x7f_ffff, 1 | 0x7f_ffff)),
            ("small", 500, &|v| v[0] != 0.0 && v[0] < 1e-3),
        ],
    );
}

#[test]
fn about_one_sample_in_eight_is_special() {
    let (generator, group) = group("vector");
    let plain = |v: &Vec<f32>| v.iter().all(|&c| c.abs() != 2.0 && c != 0.0 && c.abs() != 1.0) && v[0] != v[1];
    let samples: Vec<_> = draw(generator, &group, SAMPLES).iter().map(|s| floats(s)).collect();
    let special = samples.iter().filter(|v| !plain(v)).count();
    assert!((SAMPLES / 12..SAMPLES / 7).contains(&special), "{special}");
}

#[test]
fn point_and_vector_reach_their_structures() {
    let third = |v: &[f32]| v[..3].to_vec();
    reaches(
        "point",
        &[
            ("origin", 200, &|v| v[..3] == [0.0; 3] && v[4..] == [0.0; 3]),
            ("lattice", 200, &|v| v[..3].iter().all(|c| [-1.0, 0.0, 1.0].contains(c))),
            ("on an axis", 200, &|v| v[..3].iter().filter(|&&c| c == 0.0).count() == 2),
            ("diagonal", 200, &|v| v[0] == v[1] && v[1] == v[2] && v[0] != 0.0),
            ("corner", 200, &|v| v[..3].iter().all(|c| c.abs() == 2.0)),
            ("coincident", 200, &|v| third(v) == v[4..7] && v[0] != 0.0),
        ],
    );
    reaches(
        "vector",
        &[
            ("zero", 200, &|v| v == [0.0; 3]),
            ("unit axis", 40, &|v| {
                v.iter().map(|c| c.abs()).sum::<f32>() == 1.0 && v.contains(&0.0) && v.iter().any(|c| c.abs() == 1.0)
            }),
        ],
    );
    let (generator, group) = group("point");
    assert!(draw(generator, &group, 100).iter().all(|s| float(s[3]) == 1.0));
}

#[test]
fn directions_reach_all_six_axes() {
    let classes: Vec<_> = (0..6).map(|k| move |v: &[f32]| v[k % 3] == if k < 3 { 1.0 } else { -1.0 }).collect();
    for class in &classes {
        reaches("direction", &[("axis", 100, class)]);
    }
    let (generator, group) = group("direction");
    let mean = draw(generator, &group, SAMPLES).iter().map(|s| f64::from(float(s[0]))).sum::<f64>() / SAMPLES as f64;
    assert!(mean.abs() < 0.02, "{mean}");
}

#[test]
fn simplex_weights_add_up_exactly_in_binary32_in_any_order() {
    let (generator, group) = group("simplex");
    for sample in draw(generator, &group, 4096) {
        let v = floats(&sample);
        assert_eq!(v.iter().sum::<f32>(), 1.0);
        assert_eq!(v.iter().rev().sum::<f32>(), 1.0);
    }
    reaches(
        "simplex",
        &[
            ("corner", 300, &|v| v.contains(&1.0)),
            ("last corner", 50, &|v| v[4] == 1.0),
            ("edge", 300, &|v| v.iter().filter(|&&w| w == 0.0).count() == 3),
            ("midpoint of an edge", 200, &|v| v.contains(&0.5) && v.iter().filter(|&&w| w == 0.5).count() == 2),
            ("equal", 200, &|v| v[1] == v[2] && v[2] == v[3] && v[1] != 0.0),
            ("corner just missed", 200, &|v| v.contains(&1f32.next_down())),
        ],
    );
}

#[test]
fn raw_weights_reach_single_and_equal_weights() {
    reaches(
        "raw_weights",
        &[
            ("single", 300, &|v| v.iter().filter(|&&w| w == 0.0).count() == 3),
            ("equal", 300, &|v| v[0] == v[1] && v[1] == v[2] && v[2] == v[3]),
        ],
    );
    let (generator, group) = group("raw_weights");
    assert!(draw(generator, &group, SAMPLES).iter().all(|s| floats(s).iter().any(|&w| w > 0.0)));
}

fn identity(v: &[f32]) -> bool {
    v.iter().enumerate().all(|(i, &c)| c == if i % 5 == 0 { 1.0 } else { 0.0 })
}

fn axes_to_axes(v: &[f32]) -> bool {
    v[..12].iter().all(|c| [0.0, 1.0, -1.0].contains(c))
}

#[test]
fn transforms_reach_their_special_cases() {
    let translation = |v: &[f32]| v[12..15].iter().any(|&c| c != 0.0);
    reaches(
        "rigid",
        &[
            ("identity", 300, &identity),
            ("translation", 200, &|v| identity(&[&v[..12], &[0.0, 0.0, 0.0, 1.0]].concat()) && translation(v)),
            ("turn of axes", 200, &|v| axes_to_axes(v) && !translation(v) && v[0] != 1.0),
            ("turn of axes, moved", 100, &|v| axes_to_axes(v) && translation(v) && v[0] != 1.0),
            ("tiny rotation", 100, &|v| v[1] != 0.0 && v[1].abs() < 3e-3 && !translation(v)),
        ],
    );
    reaches(
        "affine",
        &[
            ("identity", 200, &identity),
            ("powers of two", 200, &|v| v[1..5] == [0.0; 4] && [0.5, 2.0].contains(&v[0])),
            ("mirror", 100, &|v| v[1..5] == [0.0; 4] && v[0] == -1.0),
            ("shear", 100, &|v| v[0] == 1.0 && v[4].abs() == 1.0),
        ],
    );
    reaches(
        "projection",
        &[
            ("identity", 300, &identity),
            ("perspective alone", 300, &|v| v[11] == -1.0 && v[15] == 0.0),
            ("parallel", 2000, &|v| v[3] == 0.0 && v[7] == 0.0 && v[11] == 0.0 && !identity(v)),
        ],
    );
}

#[test]
fn nodes_reach_coincidence_lines_and_points_on_a_segment() {
    let p = |v: &[f32], i: usize| DVec3::new(v[3 * i].into(), v[3 * i + 1].into(), v[3 * i + 2].into());
    let collinear = |v: &[f32]| (p(v, 1) - p(v, 0)).cross(p(v, 2) - p(v, 0)) == DVec3::ZERO;
    let all_same = |v: &[f32]| p(v, 0) == p(v, 1) && p(v, 1) == p(v, 2);
    reaches(
        "nodes",
        &[
            ("all coincident", 200, &all_same),
            ("first two coincident", 100, &|v| {
                p(v, 0) == p(v, 1) && !collinear(v) || p(v, 0) == p(v, 1) && p(v, 1) != p(v, 2)
            }),
            ("first two near each other", 100, &|v| (3e-4..8e-3).contains(&p(v, 0).distance(p(v, 1)))),
            ("last two coincident", 100, &|v| p(v, 1) == p(v, 2) && p(v, 0) != p(v, 1)),
            ("collinear, exactly", 300, &|v| collinear(v) && p(v, 0) != p(v, 1) && p(v, 1) != p(v, 2)),
            ("last in the middle of the segment", 50, &|v| p(v, 2) * 2.0 == p(v, 0) + p(v, 1) && p(v, 0) != p(v, 1)),
            ("last at the start", 40, &|v| p(v, 2) == p(v, 0) && p(v, 0) != p(v, 1)),
        ],
    );
}

#[test]
fn indices_reach_every_number_and_the_ends_most() {
    let (generator, group) = group("index");
    let mut counts = [0; 11];
    for sample in draw(generator, &group, SAMPLES) {
        counts[(sample[0] as i32 + 3) as usize] += 1;
    }
    assert!(counts.iter().all(|&c| c > 1000), "{counts:?}");
    assert!(counts[0] > counts[5] * 3 / 2 && counts[10] > counts[5] * 3 / 2, "{counts:?}");
}

#[test]
fn constants_are_encoded_by_the_type_of_the_input() {
    let generator = by_name("constant").unwrap();
    let options = Options { values: vec![3.0], ..Options::default() };
    let group = Group::new(generator, &[Shape::INT, Shape::FLOAT], options).unwrap();
    assert_eq!(draw(generator, &group, 2), [[3, 3f32.to_bits()], [3, 3f32.to_bits()]]);
}

#[test]
fn components_left_out_are_filled_by_the_vertex_fetch() {
    let generator = by_name("point").unwrap();
    let with = |components, shape| {
        let options = Options { components: Some(components), range: Some([1.0, 2.0]), ..Options::default() };
        Group::new(generator, &[shape], options)
    };
    let group = with(2, Shape::VEC4).unwrap();
    for sample in draw(generator, &group, 256) {
        assert_eq!(floats(&sample)[2..], [0.0, 1.0]);
        assert!(generator.admits(&group, &sample));
    }
    assert_eq!(with(4, Shape::VEC3).unwrap_err(), "4 components do not feed a vec3, which has 3");
    assert!(with(0, Shape::VEC3).is_err());
    assert!(with(3, Shape::VEC4.array_of(2)).is_err());
}

#[test]
fn shapes_that_do_not_fit_are_refused_in_words() {
    let refuse = |name: &str, shapes: &[Shape]| {
        let generator = by_name(name).unwrap();
        let (_, options) = example(name);
        Group::new(generator, shapes, options).unwrap_err()
    };
    assert_eq!(
        refuse("point", &[Shape::FLOAT]),
        "generator `point` fills vec2, vec3, vec4 and arrays of them, not float"
    );
    assert_eq!(refuse("rigid", &[Shape::VEC4]), "generator `rigid` fills mat4 and arrays of mat4, not vec4");
    assert!(refuse("interval", &[Shape::INT]).ends_with("not int"));
    assert!(refuse("simplex", &[Shape::FLOAT]).contains("at least two"));
    assert!(refuse("simplex", &[Shape::FLOAT.array_of(65)]).contains("not 65"));
    assert!(refuse("nodes", &[Shape::VEC3]).contains("use `point`"));
    assert!(refuse("nodes", &[Shape::VEC3, Shape::VEC4]).contains("same number"));
    assert!(refuse("index", &[Shape::vector(Scalar::U32, 1)]).contains("does not fit uint"));
    assert!(refuse("constant", &[Shape::VEC3]).contains("1 or 3 numbers, not 2"));
    assert!(refuse("constant", &[Shape::vector(Scalar::I32, 2)]).contains("0.5 cannot be held"));
}

#[test]
fn ranges_that_make_no_sense_are_refused() {
    let with = |name: &str, range| {
        let generator = by_name(name).unwrap();
        let (shapes, options) = example(name);
        Group::new(generator, &shapes, Options { range, ..options }).map(|_| ()).unwrap_err()
    };
    assert!(with("interval", None).contains("needs a `range"));
    assert!(with("interval", Some([1.0, 0.0])).contains("lo <= hi"));
    assert!(with("interval", Some([0.0, 1e39])).contains("finite"));
    assert!(with("interval", Some([f64::NAN, 1.0])).contains("lo <= hi"));
    assert!(with("direction", Some([0.0, 1.0])).contains("takes no `range`"));
    assert!(with("raw_weights", Some([-1.0, 1.0])).contains("0 <= lo"));
    assert!(with("index", Some([0.5, 1.0])).contains("whole numbers"));
}

#[test]
fn edges_reach_the_ends_zeros_and_coincident_points() {
    let floats = |name: &str| -> Vec<Vec<f32>> {
        let (generator, group) = group(name);
        let base = draw(generator, &group, 1).remove(0);
        generator.edges(&group, &base).iter().map(|words| words.iter().map(|&w| float(w)).collect()).collect()
    };
    let interval = floats("interval");
    for value in [0.0, 1.0, 5e-5, 1.0 - 5e-5, 0.5 + 5e-5, 1.0_f32.next_down(), 3e-6] {
        assert!(interval.iter().any(|v| v[0].to_bits() == value.to_bits()), "{value}");
    }
    assert!(interval.iter().any(|v| v[0].to_bits() == 1 << 31), "negative zero");
    for pair in [[0.0, 1.0], [1.0, 0.0], [1.0, 1.0]] {
        assert!(interval.iter().any(|v| v[0] == pair[0] && v[1..] == [pair[1]; 2]), "{pair:?}");
    }
    let nodes = floats("nodes");
    assert!(nodes.iter().any(|v| v[..3] == v[3..6]), "coincident points");
    let apart = |v: &[f32]| (0..3).map(|c| (v[c] - v[3 + c]).abs()).sum::<f32>();
    assert!(nodes.iter().any(|v| (1e-7..1e-5).contains(&apart(v))), "nearly coincident points");
}
