//! Pictures of what a shader does: inputs arranged so that its outputs form a surface, a family of curves
//! or a lock of strands.

use std::sync::Arc;

use base::value::{Scalar, Shape};

use super::Sample;
use super::generators::{Role, Strands, View};
use super::plan::{Plan, Planned};
use super::sample::{decode, encode};

/// What the places of a picture are.
#[derive(Clone, Debug, PartialEq)]
pub enum PictureKind {
    /// Two numbers of an invocation.
    Square([Axis; 2]),
    /// One number of an invocation; every row has another sample of the rest.
    Rows(Axis),
    /// Points of a shape, along it and around it.
    Shape,
    /// Strands of nodes.
    Strands(Strands),
}

/// A number that changes along one side of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// Name of the component, such as `parameter.x`.
    pub name: String,
    /// Both ends.
    pub range: [f64; 2],
    /// Its word in the record of an invocation.
    word: usize,
    scalar: Scalar,
}

/// The arrangement of a plan's inputs.
#[derive(Clone, Debug)]
pub struct Picture {
    plan: Arc<Plan>,
    /// What its places are.
    pub kind: PictureKind,
}

impl Picture {
    /// How the inputs of a plan are arranged; `None` when there is nothing to lay out.
    pub fn of(plan: &Arc<Plan>) -> Option<Self> {
        let has = |role: Role| plan.invocation.iter().find(|planned| planned.generator.role() == role);
        let strands = has(Role::Strand).and_then(|planned| planned.group.options().strands);
        let kind = match (strands, has(Role::Shape)) {
            (Some(strands), _) => PictureKind::Strands(strands),
            (None, Some(_)) => PictureKind::Shape,
            (None, None) => {
                let mut axes: Vec<Axis> = Vec::new();
                for planned in plan.invocation.iter().filter(|p| p.generator.role() == Role::Axis) {
                    axes.extend(axes_of(plan, planned, 0..planned.group.words()));
                }
                match (axes.len(), axes.first().cloned(), axes.last().cloned()) {
                    (1, Some(only), _) => PictureKind::Rows(only),
                    (2.., Some(first), Some(last)) => PictureKind::Square([first, last]),
                    _ => PictureKind::Square(coordinates(plan)?),
                }
            }
        };
        Some(Self { plan: plan.clone(), kind })
    }

    /// True when time changes something.
    pub fn moves(&self) -> bool {
        self.plan.case.iter().any(|planned| matches!(planned.generator.role(), Role::Axis | Role::Moves))
    }

    /// The sample in a place; what the place says nothing about is that of `still`.
    pub fn sample(&self, still: &Sample, view: &View) -> Sample {
        let mut sample = still.clone();
        // Shapes are seen as they are, and not through a projection.
        for (k, field) in still.case_record.fields().iter().enumerate() {
            if field.shape == Shape::MAT4 {
                for (i, word) in sample.case[still.case_record.range(k)].iter_mut().enumerate() {
                    *word = if i % 5 == 0 { 1.0_f32.to_bits() } else { 0 };
                }
            }
        }
        for planned in &self.plan.case {
            if matches!(planned.generator.role(), Role::Axis | Role::Moves) {
                arrange(planned, view, &mut sample.case);
            }
        }
        let set = |sample: &mut Sample, axis: &Axis, part: f64| {
            let [lo, hi] = axis.range;
            sample.invocation[axis.word] = encode(lo + (hi - lo) * part, axis.scalar);
        };
        let mut view = *view;
        match &self.kind {
            PictureKind::Square([first, last]) => {
                set(&mut sample, first, view.at[0]);
                set(&mut sample, last, view.at[1]);
            }
            PictureKind::Rows(axis) => set(&mut sample, axis, view.at[0]),
            PictureKind::Shape => {
                for planned in &self.plan.invocation {
                    match planned.generator.role() {
                        Role::Axis => {
                            for (k, axis) in axes_of(&self.plan, planned, 0..planned.group.words()).iter().enumerate() {
                                set(&mut sample, axis, view.at[k % 2]);
                            }
                        }
                        Role::Shape => {
                            arrange(planned, &view, &mut sample.invocation);
                            view.shape += planned.group.elements().len();
                        }
                        Role::Follows => arrange(planned, &view, &mut sample.invocation),
                        Role::Still | Role::Place | Role::Strand | Role::Moves => {}
                    }
                }
            }
            PictureKind::Strands(_) => {
                for planned in self.plan.invocation.iter().filter(|p| p.generator.role() == Role::Strand) {
                    arrange(planned, &view, &mut sample.invocation);
                }
            }
        }
        sample
    }

    /// Lines that belong to a sample, such as its bones.
    pub fn lines(&self, sample: &Sample) -> Vec<[[f64; 3]; 2]> {
        let of = |planned: &Planned| planned.generator.lines(&planned.group, &planned.gather(&sample.case));
        self.plan.case.iter().flat_map(of).collect()
    }

    /// What changes with time in a sample, such as `t = 0.25`; `None` where that is more than one number.
    pub fn time(&self, sample: &Sample) -> Option<String> {
        let mut moving =
            self.plan.case.iter().filter(|planned| matches!(planned.generator.role(), Role::Axis | Role::Moves));
        let (planned, None) = (moving.next()?, moving.next()) else { return None };
        let [span] = &planned.spans[..] else { return None };
        let record = self.plan.case_record();
        (span.len() == 1).then(|| {
            let value = decode(sample.case[span.start], record.scalar_of(span.start));
            format!("{} = {value}", record.word_name(span.start))
        })
    }
}

fn arrange(planned: &Planned, view: &View, record: &mut [u32]) {
    let mut words = planned.gather(record);
    planned.generator.arrange(&planned.group, view, &mut words);
    planned.group.fetch(&mut words);
    planned.scatter(&words, record);
}

/// Some words of a group of an invocation as axes, but for those that the vertex fetch fills.
fn axes_of(plan: &Plan, planned: &Planned, which: std::ops::Range<usize>) -> Vec<Axis> {
    let record = plan.invocation_record();
    let words: Vec<usize> = planned.spans.iter().cloned().flatten().collect();
    let range = [f64::from(planned.group.range().lo()), f64::from(planned.group.range().hi())];
    let axis =
        |k: usize| Axis { name: record.word_name(words[k]), range, word: words[k], scalar: record.scalar_of(words[k]) };
    which.filter(|&k| !planned.group.is_fetched(k)).map(axis).collect()
}

/// The first two coordinates of the last point among the inputs of an invocation.
fn coordinates(plan: &Plan) -> Option<[Axis; 2]> {
    let planned = plan.invocation.iter().rfind(|planned| planned.generator.role() == Role::Place)?;
    let element = planned.group.elements().last()?.clone();
    let axes = axes_of(plan, planned, element.start..element.start + 2);
    axes.try_into().ok()
}

#[cfg(test)]
mod tests {
    use super::super::generators::{Options, by_name};
    use super::super::shrink::Domain;
    use super::super::{InputGroup, Own};
    use super::*;
    use base::value::{Field, Record};

    fn plan(invocation: &[(&str, Shape, &str)], case: &[(&str, Shape, &str)]) -> Arc<Plan> {
        let record = |list: &[(&str, Shape, &str)]| {
            let field = |&(name, shape, _): &(&str, Shape, &str)| Field { name: name.into(), shape };
            Arc::new(Record::new(list.iter().map(field).collect()))
        };
        let group = |&(name, _, generator): &(&str, Shape, &str)| InputGroup {
            names: vec![name.to_owned()],
            generator: Own::Static(by_name(generator).unwrap()),
            options: Options { range: (generator == "interval").then_some([0.0, 2.0]), ..Options::default() },
            at: String::new(),
        };
        let groups: Vec<InputGroup> = invocation.iter().chain(case).map(group).collect();
        Arc::new(Plan::new(&groups, record(invocation), record(case)).unwrap())
    }

    fn view(at: [f64; 2], frame: f64) -> View {
        View { at, frame, shape: 0, strand: (0, 1), primitive: 0 }
    }

    #[test]
    fn two_numbers_span_a_square_and_one_is_a_row() {
        let square = Picture::of(&plan(&[("st", Shape::VEC2, "interval")], &[("mc", Shape::MAT4, "projection")]));
        let square = square.unwrap();
        let PictureKind::Square([s, t]) = &square.kind else { panic!("{:?}", square.kind) };
        assert_eq!((s.name.as_str(), t.name.as_str(), s.range), ("st.x", "st.y", [0.0, 2.0]));
        let sample = square.sample(&square.plan.sample(1, 0, 0), &view([0.25, 1.0], 0.0));
        assert_eq!(sample.get("st"), [0.5, 2.0]);
        assert_eq!(sample.get("mc")[..6], [1.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
        assert!(!square.moves());
        let row = Picture::of(&plan(&[("q", Shape::VEC4.array_of(4), "nodes"), ("s", Shape::FLOAT, "interval")], &[]))
            .unwrap();
        assert!(matches!(&row.kind, PictureKind::Rows(axis) if axis.name == "s"));
        let place = Picture::of(&plan(&[("q", Shape::VEC3.array_of(2), "nodes")], &[])).unwrap();
        assert!(matches!(&place.kind, PictureKind::Square([x, y]) if x.name == "q[1].x" && y.name == "q[1].y"));
        assert!(Picture::of(&plan(&[("w", Shape::VEC2, "simplex")], &[])).is_none());
    }

    #[test]
    fn points_lie_on_shapes_of_their_own_and_what_moves_moves() {
        let plan = plan(
            &[("p0", Shape::VEC4, "point"), ("p1", Shape::VEC4, "point"), ("w", Shape::VEC2, "simplex")],
            &[("t", Shape::FLOAT, "interval"), ("mc", Shape::MAT4, "affine")],
        );
        let picture = Picture::of(&plan).unwrap();
        assert!(picture.kind == PictureKind::Shape && picture.moves());
        let still = plan.sample(1, 0, 0);
        let sample = picture.sample(&still, &view([0.5, 0.25], 0.5));
        assert_ne!(sample.get("p0"), sample.get("p1"));
        assert_eq!(sample.get("w"), [0.5, 0.5]);
        assert_eq!(picture.time(&sample).as_deref(), Some("t = 1"));
        assert!(plan.admits(&sample), "pictures are made of ordinary inputs");
    }
}
