//! Generators of the chapter reach what they claim, stay in their domain, and refuse what they cannot fill.

use std::sync::Arc;

use base::text::SourceFile;
use base::value::{Field, Record, Shape};
use engine::catalogue;
use engine::suite::parse;
use glam::DVec3;
use property::generators::testing::{Class, draw, floats, keeps_its_promises, refuses_odd_words};
use property::generators::{Ends, Generator, Group, Options, Place, Strands, View, float, matrix};
use property::shrink::Domain;
use property::{InputGroup, Own, Picture, Plan, Stream};

use super::ALL;

/// Shapes on which generators are tested.
fn example(name: &str) -> Vec<Shape> {
    let points = Shape::VEC4.array_of(4);
    match name {
        "bones" => vec![Shape::INT, points, points, Shape::MAT4.array_of(4)],
        "rigid_parts" => vec![Shape::MAT4.array_of(3)],
        "node_run" => vec![points],
        other => panic!("add an example for `{other}`"),
    }
}

fn group(name: &str) -> (&'static dyn Generator, Group) {
    let generator = catalogue::generator(name).unwrap();
    (generator, Group::new(generator, &example(name), Options::default()).unwrap())
}

/// As [`property::generators::testing::reaches`], for the example of a generator.
fn reaches(name: &str, classes: &[(&str, usize, Class<'_>)]) {
    let (generator, group) = group(name);
    property::generators::testing::reaches(generator, &group, classes);
}

fn identity(v: &[f32]) -> bool {
    v.iter().enumerate().all(|(i, &c)| c == if i % 5 == 0 { 1.0 } else { 0.0 })
}

/// Names and shapes of inputs, with the generator that fills them together.
type Inputs<'a> = (&'a [(&'a str, Shape)], &'a str);

/// A plan with these inputs of an invocation and of a case.
fn plan(invocation: &[Inputs<'_>], case: &[Inputs<'_>]) -> Plan {
    let group = |&(inputs, generator): &Inputs<'_>| InputGroup {
        names: inputs.iter().map(|(name, _)| (*name).to_owned()).collect(),
        generator: Own::Static(catalogue::generator(generator).unwrap()),
        options: Options::default(),
        at: String::new(),
    };
    let record = |groups: &[Inputs<'_>]| {
        let field = |&(name, shape): &(&str, Shape)| Field { name: name.into(), shape };
        Arc::new(Record::new(groups.iter().flat_map(|(inputs, _)| inputs.iter().map(field)).collect()))
    };
    let groups: Vec<InputGroup> = invocation.iter().chain(case).map(group).collect();
    Plan::new(&groups, record(invocation), record(case)).unwrap()
}

fn skinning() -> Plan {
    let points = Shape::VEC4.array_of(8);
    let bones =
        [("numberOfBones", Shape::INT), ("p0", points), ("p1", points), ("blendMatrix", Shape::MAT4.array_of(8))];
    let matrix = (&[("modelViewMatrix", Shape::MAT4)][..], "rigid");
    plan(&[(&[("position", Shape::VEC4)], "point")], &[matrix, (&bones, "bones")])
}

#[test]
fn every_generator_keeps_its_promises_and_is_found_by_its_name() {
    assert!(!ALL.is_empty());
    for generator in ALL {
        keeps_its_promises(*generator, &example(generator.name()), &Options::default());
        let named = catalogue::generators().filter(|other| other.name() == generator.name());
        assert_eq!(named.count(), 1, "{}", generator.name());
    }
    let (generator, group) = group("node_run");
    refuses_odd_words(generator, &group, 0..=group.words() - 1);
}

#[test]
fn shapes_that_do_not_fit_are_refused_in_words() {
    let refuse = |name: &str, shapes: &[Shape]| {
        Group::new(catalogue::generator(name).unwrap(), shapes, Options::default()).unwrap_err()
    };
    let (v4, m4) = (Shape::VEC4.array_of(8), Shape::MAT4.array_of(8));
    assert!(refuse("bones", &[v4, v4, m4]).contains("four inputs"));
    assert!(refuse("bones", &[Shape::INT, v4, v4, Shape::MAT4.array_of(7)]).contains("all of one length"));
    assert!(refuse("bones", &[v4, Shape::INT, v4, m4]).contains("in this order"));
    assert!(refuse("rigid_parts", &[Shape::MAT4]).contains("use `rigid`"));
    assert!(refuse("node_run", &[Shape::VEC4]).contains("not vec4"));
}

#[test]
fn more_bones_than_the_arrays_hold_are_not_admitted() {
    let plan = skinning();
    let mut sample = plan.sample(1, 0, 0);
    assert!(plan.admits(&sample) && plan.admits(&plan.simplest(&sample)));
    sample.set("numberOfBones", &[9.0]);
    assert!(!plan.admits(&sample));
}

#[test]
fn strands_of_a_suite_need_a_generator_of_nodes() {
    let suite = |generator: &str| {
        let text = format!(
            "suite = \"s\"\nshader = \"s.geom\"\nstage = \"geometry\"\n[[inputs]]\nnames = [\"node\"]\n\
             generator = \"{generator}\"\n[strands]\nnodes = 8\nends = \"as-drawn\"\n"
        );
        parse(&SourceFile::new("s.suite.toml", text))
    };
    let message = suite("point").unwrap_err().to_string();
    assert!(message.contains("without an [[inputs]] group with generator = \"node_run\""), "{message}");
    let suite = suite("node_run").unwrap();
    assert_eq!(suite.strands, Some(Strands { nodes: 8, ends: Ends::AsDrawn }));
    assert_eq!(suite.inputs[0].options.strands, suite.strands);
}

#[test]
fn rigid_parts_hang_together_and_reach_the_collapse() {
    let part = |v: &[f32], k: usize| v[16 * k..16 * k + 16].to_vec();
    reaches(
        "rigid_parts",
        &[
            ("all equal", 300, &|v| part(v, 0) == part(v, 1) && part(v, 1) == part(v, 2)),
            ("all the identity", 300, &|v| (0..3).all(|k| identity(&part(v, k)))),
            // A half turn about z mirrors x and y against the part before.
            ("collapse", 300, &|v| (0..3).all(|i| v[16 + i] == -v[i] && v[20 + i] == -v[4 + i]) && v[0].abs() < 1.0),
        ],
    );
    // Two neighbours agree about their joint: M_k and M_(k+1) map some point of the box to one place,
    // which is so when M_k⁻¹ M_(k+1) has a fixed point.
    let (generator, group) = group("rigid_parts");
    let mut joined = 0;
    for sample in draw(generator, &group, 256) {
        let relative = matrix::read(&sample[..16]).inverse() * matrix::read(&sample[16..32]);
        let axis = DVec3::new(
            relative.y_axis.z - relative.z_axis.y,
            relative.z_axis.x - relative.x_axis.z,
            relative.x_axis.y - relative.y_axis.x,
        );
        // A rotation about a point moves nothing along its axis.
        joined += usize::from(relative.w_axis.truncate().dot(axis.normalize_or_zero()).abs() < 1e-4);
    }
    assert!(joined > 240, "{joined}");
}

#[test]
fn bones_reach_their_special_cases_and_turn_about_their_roots() {
    let root = |v: &[f32], i: usize| v[1 + 4 * i..4 + 4 * i].to_vec();
    let tip = |v: &[f32], i: usize| v[17 + 4 * i..20 + 4 * i].to_vec();
    let blend = |v: &[f32], i: usize| v[33 + 16 * i..49 + 16 * i].to_vec();
    let count = |v: &[f32]| v[0].to_bits() as usize;
    reaches(
        "bones",
        &[
            ("bone of length zero", 250, &|v| (0..count(v)).any(|i| root(v, i) == tip(v, i))),
            ("short bone", 100, &|v| {
                let length = |i| root(v, i).iter().zip(tip(v, i)).map(|(a, b)| (a - b).powi(2)).sum::<f32>().sqrt();
                (0..count(v)).any(|i| (3e-4..8e-3).contains(&length(i)))
            }),
            ("all bones equal", 100, &|v| {
                count(v) > 1
                    && (1..4).all(|i| root(v, i) == root(v, 0) && blend(v, i) == blend(v, 0) && !identity(&blend(v, 0)))
            }),
            ("lattice", 200, &|v| {
                (0..4).all(|i| root(v, i).iter().chain(&tip(v, i)).all(|c| [-1.0, 0.0, 1.0].contains(c)))
            }),
            ("rest pose", 200, &|v| (0..4).all(|i| identity(&blend(v, i)))),
            ("one bone", 3000, &|v| count(v) == 1),
            ("all bones", 3000, &|v| count(v) == 4),
            ("chain", 7000, &|v| (1..4).all(|i| root(v, i) == tip(v, i - 1))),
        ],
    );
    // B · M⁻¹ takes the root to where the pose has moved it: no further than the pose's translation.
    let (generator, group) = group("bones");
    for sample in draw(generator, &group, 512) {
        let v = floats(&sample);
        for i in 0..4 {
            let r = root(&v, i);
            let r = DVec3::new(r[0].into(), r[1].into(), r[2].into());
            let moved = matrix::read(&sample[33 + 16 * i..49 + 16 * i]).transform_point3(r) - r;
            assert!(moved.abs().max_element() <= 2.0 + 1e-5, "{moved}");
        }
    }
}

#[test]
fn neighbouring_primitives_share_nodes() {
    let (generator, group) = group("node_run");
    let at = |case_seed, invocation| {
        let mut out = vec![0; 16];
        generator.fill(
            &group,
            Place { case_seed, invocation, exact: false },
            &mut Stream::new(invocation as u64),
            &mut out,
        );
        out
    };
    for case in 0..200 {
        for invocation in 0..12 {
            assert_eq!(at(case, invocation)[4..], at(case, invocation + 1)[..12]);
        }
    }
    assert_ne!(at(0, 0), at(1, 0));
}

#[test]
fn strands_end_as_the_host_draws_them() {
    let generator = catalogue::generator("node_run").unwrap();
    for (ends, primitives) in [(Ends::Repeat, 7), (Ends::AsDrawn, 5)] {
        let strands = Strands { nodes: 8, ends };
        assert_eq!(strands.primitives(), primitives);
        let options = Options { strands: Some(strands), ..Options::default() };
        let group = Group::new(generator, &[Shape::VEC4.array_of(4)], options).unwrap();
        let at = |invocation| {
            let mut out = vec![0; 16];
            generator.fill(&group, Place { case_seed: 3, invocation, exact: false }, &mut Stream::new(0), &mut out);
            out.chunks(4).map(<[u32]>::to_vec).collect::<Vec<_>>()
        };
        let repeats = ends == Ends::Repeat;
        assert_eq!(at(0)[0] == at(0)[1], repeats, "the first node stands twice");
        assert_eq!(at(primitives - 1)[2] == at(primitives - 1)[3], repeats, "the last node stands twice");
        // Every segment of the strand in the repaired host, all but the outer two in the other.
        assert!((1..primitives).all(|invocation| at(invocation)[1] == at(invocation - 1)[2]));
        assert_ne!(at(primitives)[0], at(primitives - 1)[1], "a new strand begins");
    }
}

#[test]
fn node_runs_reach_special_strands() {
    let p = |v: &[f32], i: usize| DVec3::new(v[4 * i].into(), v[4 * i + 1].into(), v[4 * i + 2].into());
    let cross = |v: &[f32], i: usize| (p(v, 1) - p(v, 0)).cross(p(v, i) - p(v, 0));
    reaches(
        "node_run",
        &[
            ("all in the origin", 200, &|v| (0..4).all(|i| p(v, i) == DVec3::ZERO)),
            ("all coincident", 200, &|v| (1..4).all(|i| p(v, i) == p(v, 0)) && p(v, 0) != DVec3::ZERO),
            ("neighbours coincident", 60, &|v| p(v, 1) == p(v, 2) && p(v, 2) != p(v, 3)),
            ("collinear", 200, &|v| cross(v, 2) == DVec3::ZERO && cross(v, 3) == DVec3::ZERO && p(v, 0) != p(v, 2)),
            ("to and fro", 200, &|v| p(v, 0) == p(v, 2) && p(v, 1) == p(v, 3) && p(v, 0) != p(v, 1)),
        ],
    );
}

#[test]
fn edges_of_bones_have_none_and_all_and_bones_of_some_millionths() {
    let (generator, group) = group("bones");
    let base = draw(generator, &group, 1).remove(0);
    let edges = generator.edges(&group, &base);
    for count in [0, 1, 4] {
        assert!(edges.iter().any(|words| words[0] == count), "{count}");
    }
    let length = |words: &[u32], bone: usize| {
        let point = |at: usize| DVec3::from_array(std::array::from_fn(|c| f64::from(float(words[at + 4 * bone + c]))));
        point(1).distance(point(17))
    };
    let last = |words: &&Vec<u32>| words[0] == 4 && (1e-7..1e-5).contains(&length(words, 3)) && length(words, 0) > 0.01;
    assert!(edges.iter().any(|words| last(&words)), "the last bone alone is short");
    assert!(edges.iter().any(|words| (0..4).all(|bone| length(words, bone) == 0.0)), "all have length zero");
}

#[test]
fn some_vertices_of_the_skinning_lie_exactly_on_an_end_of_a_bone() {
    let plan = skinning();
    let (mut at_an_end, mut on_a_bone) = (0, 0);
    for case in 0..4096 {
        for invocation in 0..16 {
            let sample = plan.sample(9, case, invocation);
            let number = sample.get("numberOfBones")[0] as usize;
            let view = glam::DMat4::from_cols_slice(&sample.get("modelViewMatrix"));
            let p = view * glam::DVec4::from_slice(&sample.get("position"));
            let (roots, tips) = (sample.get("p0"), sample.get("p1"));
            for bone in 0..number {
                let root = glam::DVec4::from_slice(&roots[4 * bone..]);
                let tip = glam::DVec4::from_slice(&tips[4 * bone..]);
                let (v1, v2) = (tip - root, p - root);
                let s =
                    if v1.length_squared() > 0.0 { (v1.dot(v2) / v1.length_squared()).clamp(0.0, 1.0) } else { 0.0 };
                at_an_end += usize::from(p == root || p == tip);
                on_a_bone += usize::from(v2 == v1 * s && s > 0.0 && s < 1.0);
            }
        }
    }
    assert!(at_an_end >= 100, "{at_an_end}");
    assert!(on_a_bone >= 20, "{on_a_bone}");
}

#[test]
fn an_arm_has_its_bones() {
    let parts = [("part", Shape::MAT4.array_of(3))];
    let plan = Arc::new(plan(&[(&[("p", Shape::VEC4)], "point")], &[(&parts, "rigid_parts")]));
    let picture = Picture::of(&plan).unwrap();
    let view = View { at: [0.0, 0.0], frame: 1.0, shape: 0, strand: (0, 1), primitive: 0 };
    let sample = picture.sample(&plan.sample(1, 0, 0), &view);
    let lines = picture.lines(&sample);
    assert_eq!(lines.len(), 3);
    let apart: f64 = lines[0][1].iter().zip(lines[1][0]).map(|(a, b)| (a - b).abs()).sum();
    assert!(apart < 1e-6, "one begins where the other ends: {lines:?}");
    assert!(plan.admits(&sample));
}
