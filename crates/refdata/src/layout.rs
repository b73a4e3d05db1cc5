//! How the arrays of a data set follow from the interface of a shader, and what its document says of inputs.

use super::array::{Array, Per, Role, WordType};
use super::document::Domain;
use super::generate::Outputs;
use base::value::{Record, Scalar, Shape};
use engine::suite::Suite;

/// The numbers in parentheses, which are those of equations.
pub(super) fn equations(source: &str) -> Vec<u32> {
    source.split('(').skip(1).filter_map(|part| part.split(')').next()?.parse().ok()).collect()
}

/// What fills the inputs of a suite.
pub(super) fn domain(suite: &Suite) -> Vec<Domain> {
    let group = |group: &property::InputGroup| Domain {
        inputs: group.names.clone(),
        generator: group.generator.name().to_owned(),
        about: group.generator.about().to_owned(),
        range: group.options.range,
        values: group.options.values.clone(),
        components: group.options.components,
    };
    suite.inputs.iter().map(group).collect()
}

/// The arrays, in the order in which blocks are hashed.
pub(super) fn arrays(sides: [&Record; 2], outputs: &Outputs, emits: bool, bounded: bool) -> Vec<Array> {
    let mut arrays = Vec::new();
    for (record, per, prefix) in [(sides[0], Per::Sample, "input"), (sides[1], Per::Case, "case")] {
        for field in record.fields() {
            arrays.push(Array {
                name: format!("{prefix}.{}", field.name),
                role: Role::Input,
                variable: field.name.clone(),
                ty: field.shape.to_string(),
                dtype: kind(field.shape.scalar),
                per,
                shape: dimensions(field.shape),
                components: (0..field.shape.words()).map(|word| field.shape.component_name(word)).collect(),
            });
        }
    }
    let mut roles = vec![(Role::Expected, "expected"), (Role::Nearest, "nearest")];
    roles.extend(bounded.then_some((Role::Bound, "bound")));
    for (role, prefix) in roles {
        for (field, _) in &outputs.fields {
            let shape = field.shape;
            let component = |vertex: usize, word: usize| {
                let name = shape.component_name(word);
                if emits { format!("@{vertex}{name}") } else { name }
            };
            let vertices = 0..outputs.vertices;
            let (words, of_vertex) = (shape.words(), dimensions(shape));
            arrays.push(Array {
                name: format!("{prefix}.{}", field.name),
                role,
                variable: field.name.clone(),
                ty: shape.to_string(),
                dtype: match role {
                    Role::Expected => WordType::F8,
                    Role::Bound => WordType::F4,
                    Role::Input | Role::Nearest | Role::Flags => kind(shape.scalar),
                },
                per: Per::Sample,
                shape: if emits { [vec![outputs.vertices], of_vertex].concat() } else { of_vertex },
                components: vertices
                    .flat_map(|v| (0..words).map(move |w| (v, w)))
                    .map(|(v, w)| component(v, w))
                    .collect(),
            });
        }
    }
    arrays.push(Array {
        name: "flags".into(),
        role: Role::Flags,
        variable: String::new(),
        ty: String::new(),
        dtype: WordType::U2,
        per: Per::Sample,
        shape: Vec::new(),
        components: vec![String::new()],
    });
    arrays
}

fn kind(scalar: Scalar) -> WordType {
    match scalar {
        Scalar::F32 => WordType::F4,
        Scalar::I32 => WordType::I4,
        Scalar::U32 | Scalar::Bool => WordType::U4,
    }
}

/// A scalar has no dimension, a vector one, a matrix two, and an array one more in front.
fn dimensions(shape: Shape) -> Vec<usize> {
    let mut dimensions: Vec<usize> = shape.array.iter().map(|&n| n as usize).collect();
    if shape.columns > 1 {
        dimensions.push(usize::from(shape.columns));
    }
    if shape.rows > 1 {
        dimensions.push(usize::from(shape.rows));
    }
    dimensions
}
