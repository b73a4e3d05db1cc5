use super::super::generators::by_name;
use super::*;
use base::value::Field;

fn group(names: &[&str], generator: &str, options: Options) -> InputGroup {
    InputGroup {
        names: names.iter().map(|&n| n.to_owned()).collect(),
        generator: crate::Own::Static(by_name(generator).unwrap()),
        options,
        at: "s.suite.toml:9:1".into(),
    }
}

fn record(fields: &[(&str, Shape)]) -> Arc<Record> {
    let field = |&(name, shape): &(&str, Shape)| Field { name: name.into(), shape };
    Arc::new(Record::new(fields.iter().map(field).collect()))
}

fn skinning() -> Plan {
    let bare = Options::default;
    let groups = [
        group(&["modelViewMatrix"], "rigid", bare()),
        group(&["projectionMatrix"], "projection", bare()),
        group(&["numberOfBones", "p0", "p1", "blendMatrix"], "bones", bare()),
        group(&["position"], "point", Options { components: Some(3), ..bare() }),
    ];
    let points = Shape::VEC4.array_of(8);
    let case = record(&[
        ("modelViewMatrix", Shape::MAT4),
        ("projectionMatrix", Shape::MAT4),
        ("numberOfBones", Shape::INT),
        ("p0", points),
        ("p1", points),
        ("blendMatrix", Shape::MAT4.array_of(8)),
    ]);
    Plan::new(&groups, record(&[("position", Shape::VEC4)]), case).unwrap()
}

fn error(groups: &[InputGroup]) -> String {
    let (invocation, case) = (record(&[("position", Shape::VEC4)]), record(&[("t", Shape::FLOAT)]));
    Plan::new(groups, invocation, case).unwrap_err().to_string()
}

#[test]
fn groups_that_do_not_fit_the_shader_are_refused() {
    let bare = Options::default;
    let unit = || Options { range: Some([0.0, 1.0]), ..Options::default() };
    let point = || group(&["position"], "point", bare());
    let t = || group(&["t"], "interval", unit());
    assert_eq!(
        error(&[group(&["positon"], "point", bare())]),
        "s.suite.toml:9:1: the shader has no input `positon`; did you mean `position`?"
    );
    assert!(error(&[point()]).starts_with("nothing fills the input `t` (float)"));
    assert!(error(&[t()]).starts_with("nothing fills the input `position` (vec4)"));
    assert_eq!(error(&[t(), t(), point()]), "s.suite.toml:9:1: the input `t` is filled already");
    assert!(error(&[group(&["t", "t"], "interval", unit())]).ends_with("filled already"));
    assert!(error(&[group(&["t", "position"], "interval", unit())]).contains("make two groups"));
    assert_eq!(
        error(&[group(&["t"], "point", bare())]),
        "s.suite.toml:9:1: generator `point` fills vec2, vec3, vec4 and arrays of them, not float (inputs: float t)"
    );
    assert!(error(&[group(&["t"], "interval", Options { components: Some(1), ..unit() })]).contains("is a uniform"));
}

#[test]
fn samples_of_a_plan_are_admitted_and_others_are_not() {
    let plan = skinning();
    for case in 0..200 {
        let mut sample = plan.sample(1, case, 3);
        assert!(plan.admits(&sample));
        assert!(plan.admits(&plan.simplest(&sample)));
        sample.set("position", &[0.0, 0.0, 0.0, 2.0]);
        assert!(!plan.admits(&sample), "the vertex fetch makes w 1");
    }
    let mut sample = plan.sample(1, 0, 0);
    sample.set("numberOfBones", &[9.0]);
    assert!(!plan.admits(&sample), "more bones than the arrays hold");
}

#[test]
fn some_vertices_of_the_skinning_lie_exactly_on_an_end_of_a_bone() {
    let plan = skinning();
    let (mut at_an_end, mut on_a_bone) = (0, 0);
    for case in 0..4096 {
        for lane in 0..16 {
            let sample = plan.sample(9, case, lane);
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
