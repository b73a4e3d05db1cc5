use super::super::generators::by_name;
use super::*;

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

fn moved_points() -> Plan {
    let bare = Options::default;
    let groups = [
        group(&["modelViewMatrix"], "rigid", bare()),
        group(&["projectionMatrix"], "projection", bare()),
        group(&["count"], "index", Options { range: Some([0.0, 8.0]), ..bare() }),
        group(&["position"], "point", Options { components: Some(3), ..bare() }),
    ];
    let case = record(&[("modelViewMatrix", Shape::MAT4), ("projectionMatrix", Shape::MAT4), ("count", Shape::INT)]);
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
fn a_name_with_empty_brackets_stands_for_each_index() {
    let names = ["boids[0].at", "boids[11].at", "boids[0].path", "boids[x].at"];
    let fields = names.map(|name| Field { name: name.into(), shape: Shape::FLOAT });
    let of = |name: &str| group(&[name], "point", Options::default()).over(fields.iter()).names;
    assert_eq!(of("boids[].at"), ["boids[0].at", "boids[11].at"]);
    assert_eq!(pattern("boids[11].at"), "boids[].at");
    assert_eq!(of("boids[0].path"), ["boids[0].path"]);
    // What stands for nothing is refused by its name.
    assert_eq!(of("boids[].speed"), ["boids[].speed"]);
}

#[test]
fn samples_of_a_plan_are_admitted_and_others_are_not() {
    let plan = moved_points();
    for case in 0..200 {
        let mut sample = plan.sample(1, case, 3);
        assert!(plan.admits(&sample));
        assert!(plan.admits(&plan.simplest(&sample)));
        sample.set("position", &[0.0, 0.0, 0.0, 2.0]);
        assert!(!plan.admits(&sample), "the vertex fetch makes w 1");
    }
    let mut sample = plan.sample(1, 0, 0);
    sample.set("count", &[9.0]);
    assert!(!plan.admits(&sample), "beyond the range of its group");
}
