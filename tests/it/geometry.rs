//! Geometry shaders as their authors write them, from the text to the vertices that lavapipe stores.
//! The values that are expected are worked out by hand beside each test.

use std::sync::Arc;

use base::value::{Batch, Scalar};
use lanes::{Actual, Lane, vulkan};
use program::{Port, Program};

use crate::lowering::stage;

/// Opens the lane. Without a driver these tests fail: a gate that skips its device tests proves nothing.
pub fn lane() -> Box<dyn Lane> {
    vulkan::open().expect("these tests need a Vulkan driver; `cargo xtask test` installs lavapipe")
}

/// A batch of one case. Values stand in the order of the records; those of integers are converted.
pub fn batch(program: &Program, invocations: &[Vec<f32>], case: &[f32]) -> Batch {
    let (invocation_record, case_record) = (Arc::new(program.invocation_record()), Arc::new(program.case_record()));
    let words = |record: &base::value::Record, values: &[f32]| -> Vec<u32> {
        assert_eq!(values.len(), record.words(), "{:?}", record.fields());
        let scalars = record.fields().iter().flat_map(|f| vec![f.shape.scalar; f.shape.words()]);
        let word = |(value, scalar): (&f32, Scalar)| match scalar {
            Scalar::F32 => value.to_bits(),
            Scalar::I32 => (*value as i32) as u32,
            Scalar::U32 | Scalar::Bool => *value as u32,
        };
        values.iter().zip(scalars).map(word).collect()
    };
    Batch {
        per_case: invocations.len(),
        invocations: invocations.iter().flat_map(|v| words(&invocation_record, v)).collect(),
        cases: words(&case_record, case),
        invocation_record,
        case_record,
    }
}

/// The stored outputs of one vertex; integers are converted.
pub fn values(actual: &Actual, invocation: usize, vertex: usize) -> Vec<f32> {
    let record = &actual.layout().vertex;
    let scalars = record.fields().iter().flat_map(|f| vec![f.shape.scalar; f.shape.words()]);
    let value = |(word, scalar): (&u32, Scalar)| match scalar {
        Scalar::F32 => f32::from_bits(*word),
        Scalar::I32 => *word as i32 as f32,
        Scalar::U32 | Scalar::Bool => *word as f32,
    };
    actual.vertex(invocation, vertex).iter().zip(scalars).map(value).collect()
}

/// Names of the inputs and outputs of a program, so that a test says in which order it feeds them.
fn names<'a>(program: &'a Program) -> (Vec<&'a str>, Vec<&'a str>) {
    let names = |ports: &'a [Port]| ports.iter().map(|p| p.field.name.as_str()).collect();
    (names(&program.inputs), names(&program.outputs))
}

struct Ran {
    actual: Actual,
}

impl Ran {
    /// Vertices of each strip of a primitive.
    fn strips(&self, primitive: usize) -> Vec<Vec<Vec<f32>>> {
        let mut strips = Vec::new();
        for vertex in 0..self.actual.stored(primitive) {
            let strip = self.actual.strip(primitive, vertex) as usize;
            assert!(strip == strips.len() || strip + 1 == strips.len(), "strips are numbered in order");
            if strip == strips.len() {
                strips.push(Vec::new());
            }
            strips[strip].push(values(&self.actual, primitive, vertex));
        }
        strips
    }
}

macro_rules! fixture {
    ($name:literal) => {
        stage(concat!($name, ".geom"), include_str!(concat!("../../fixtures/geometry/", $name, ".geom"))).program()
    };
}

fn run(program: &Program, primitives: &[Vec<f32>], uniforms: &[f32]) -> Ran {
    let batch = batch(program, primitives, uniforms);
    let kernel = program.compute_kernel().unwrap();
    Ran { actual: lane().prepare(&kernel, primitives.len()).unwrap().run(&batch).unwrap() }
}

#[test]
fn points_become_points() {
    let program = fixture!("points_to_points");
    assert_eq!(names(&program), (vec!["gl_Position", "uv", "gl_PrimitiveIDIn"], vec!["gl_Position", "id", "st"]));
    let ran = run(
        &program,
        &[vec![1., 2., 3., 1., 0.25, 0.5, 0.], vec![4., 5., 6., 2., 0.75, 1., 1.], vec![0., 0., 0., 1., 0., 0., 2.]],
        &[10., 20., 30.],
    );
    // Every point is a primitive of its own: nothing ends a strip, and all vertices bear number 0.
    assert_eq!((ran.actual.emitted(1), ran.actual.ended_strips(1)), (2, 0));
    // (4, 5, 6, 2), then (4, 5, -6, 2) + (10, 20, 30, 0); 10 * 1 and 10 * 1 + 1.
    assert_eq!(ran.strips(1), [[[4., 5., 6., 2., 10., 0.75, 1.], [14., 25., 24., 2., 11., 1., 0.75]]]);
    assert_eq!(ran.strips(0)[0][1], [11., 22., 27., 1., 1., 0.5, 0.25]);
    assert_eq!(ran.strips(2)[0][1], [10., 20., 30., 1., 21., 0., 0.]);
}

#[test]
fn lines_become_a_line_strip() {
    let program = fixture!("lines_to_line_strip");
    assert_eq!(names(&program), (vec!["gl_Position", "height"], vec!["gl_Position", "h"]));
    let ran = run(
        &program,
        &[vec![0., 0., 0., 1., 2., 4., 6., 1., 10., 20.], vec![-1., 0., 0., 1., 1., 0., 8., 3., 0., -4.]],
        &[],
    );
    assert_eq!((ran.actual.emitted(0), ran.actual.ended_strips(0)), (3, 1));
    assert_eq!(ran.strips(0), [[[0., 0., 0., 1., 10.], [1., 2., 3., 1., 16.], [2., 4., 6., 1., 20.]]]);
    assert_eq!(ran.strips(1), [[[-1., 0., 0., 1., 0.], [0., 0., 4., 2., -1.], [1., 0., 8., 3., -4.]]]);
}

#[test]
fn a_triangle_becomes_two_strips() {
    let program = fixture!("triangles_to_two_strips");
    let corners = vec![1., 0., 0., 1., 0., 1., 0., 1., 0., 0., 1., 1.];
    let other = corners.iter().map(|v| 10. * v).collect();
    let ran = run(&program, &[corners, other], &[]);
    assert_eq!((ran.actual.emitted(0), ran.actual.ended_strips(0)), (6, 2));
    assert_eq!(
        ran.strips(0),
        [
            [[1., 0., 0., 1., 1., 0., 0.], [0., 1., 0., 1., 0., 1., 0.], [0., 0., 1., 1., 0., 0., 1.]],
            // Turned round and one further along z.
            [[0., 0., 2., 1., 0., 0., 1.], [0., 1., 1., 1., 0., 1., 0.], [1., 0., 1., 1., 1., 0., 0.]],
        ]
    );
    assert_eq!(ran.strips(1)[1][0], [0., 0., 11., 10., 0., 0., 1.]);
}

#[test]
fn triangles_with_adjacency_become_points_or_nothing() {
    let program = fixture!("triangles_adjacency_to_points");
    // A right triangle with legs 4 and 2 at vertices 0, 2 and 4; its neighbours are 1, 3 and 5.
    let triangle = vec![
        0., 0., 0., 1., /* 1 */ 2., -3., 0., 1., 4., 0., 0., 1., /* 3 */ 4., 3., 3., 1., 0., 2., 0., 1.,
        /* 5 */ -3., 3., 6., 1.,
    ];
    let mut flat = triangle.clone();
    flat[17] = 0.; // The last corner on the line of the others.
    let ran = run(&program, &[triangle.clone(), flat, triangle], &[]);
    assert_eq!([0, 1, 2].map(|p| ran.actual.emitted(p)), [1, 0, 1]);
    assert_eq!(ran.strips(0), [[[1., 1., 3., 1., 4.]]]);
    assert!(ran.strips(1).is_empty());
    assert_eq!(ran.strips(2), ran.strips(0));
}

#[test]
fn lines_with_adjacency_become_strips_and_the_last_one_may_stay_open() {
    let program = fixture!("lines_adjacency_to_line_strip");
    assert_eq!(
        names(&program),
        (vec!["gl_Position", "n", "tag", "gl_PrimitiveIDIn"], vec!["gl_Position", "tangent", "from"])
    );
    let nodes = [0., 0., 0., 1., 1., 1., 0., 1., 3., 1., 0., 1., 4., 5., 2., 1.];
    let normals = [9., 9., 9., 0., 0., 1., 0., 2., 0., 9., 9., 9.];
    let primitive = |number: f32| [&nodes[..], &normals, &[5., 6., 7., 8.], &[number]].concat();
    let ran = run(&program, &[primitive(0.), primitive(1.)], &[]);
    assert_eq!((ran.actual.emitted(1), ran.actual.stored(1), ran.actual.ended_strips(1)), (6, 6, 2));
    assert_eq!(
        ran.strips(1),
        [
            // Tangents: node 2 - node 0 and node 3 - node 1.
            [[1., 1., 0., 1., 3., 1., 0., 6.], [3., 1., 0., 1., 3., 4., 2., 7.]],
            [[1., 1., 0., 1., 0., 0., 1., 6.], [1., 1., 1., 1., 0., 0., 1., 106.]],
            [[3., 1., 0., 1., 0., 2., 0., 7.], [3., 3., 0., 1., 0., 2., 0., 107.]],
        ]
    );
    // The number of the primitive is another one; all else is equal.
    assert_eq!(ran.strips(0)[2][1], [3., 3., 0., 1., 0., 2., 0., 7.]);
}

#[test]
fn vertices_past_the_declared_number_are_counted_and_leave_the_neighbours_alone() {
    let program = fixture!("overrun");
    let counts = [2., 7., 3., 1000., 0., 3.];
    let primitives: Vec<Vec<f32>> = counts.iter().map(|&c| vec![c, 0., 0., 1., c]).collect();
    let ran = run(&program, &primitives, &[]);
    for (primitive, &count) in counts.iter().enumerate() {
        assert_eq!(ran.actual.emitted(primitive), count as u32);
        let kept = ran.strips(primitive).concat();
        // `Ran::actual` bears the canary of every primitive; the values show that no vertex strayed either.
        let expected: Vec<Vec<f32>> =
            (0..count.min(3.) as usize).map(|k| k as f32).map(|k| vec![count + k, k, k, 1. + k, k]).collect();
        assert_eq!(kept, expected, "{count}");
    }
}

#[test]
fn fewer_vertices_than_declared_are_fine() {
    let program = fixture!("over_declared");
    let ran = run(&program, &[vec![1., 2., 3., 1.], vec![4., 5., 6., 1.]], &[]);
    assert_eq!((ran.actual.emitted(1), ran.actual.stored(1), ran.actual.ended_strips(1)), (1, 1, 0));
    assert_eq!(ran.strips(1), [[[8., 10., 12., 2.]]]);
    // What is behind the last vertex was not written.
    assert!(ran.actual.vertex(1, 1).iter().all(|&w| ran.actual.is_unwritten(w)));
}

#[test]
fn a_wrong_strip_would_show() {
    // The alarm of the tests above: a shader that never ends its strip gives one strip and not two.
    let text = include_str!("../../fixtures/geometry/triangles_to_two_strips.geom").replace("EndPrimitive();", "");
    let program = stage("one_strip.geom", &text).program();
    let ran = run(&program, &[vec![0.; 12]], &[]);
    assert_eq!((ran.strips(0).len(), ran.actual.ended_strips(0)), (1, 0));
}
