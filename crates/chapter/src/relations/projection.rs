//! The outer matrix of a vertex or geometry stage.

use property::ball::{Ball, outputs};
use property::rule::{Claims, Rule, plain};
use property::{Observed, Sample};

pub(super) static PROJECTION_LAST: Rule = Rule {
    name: "projection_last",
    statement: "the outer matrix times the position under the identity is the position",
    needs: &[],
    inputs: |sample| {
        let name = matrix_name(sample)?;
        (sample.words(name)?.len() == 16).then_some(())?;
        Some(vec![sample.clone(), plain(sample)?])
    },
    claims: projected,
};

fn matrix_name(sample: &Sample) -> Option<&'static str> {
    ["mc", "projectionMatrix"].into_iter().find(|name| sample.words(name).is_some())
}

fn projected(inputs: &[Sample], observed: &[Observed], claims: &mut Claims<'_>) {
    let matrix = matrix_name(&inputs[0]).map(|name| inputs[0].get(name)).unwrap_or_default();
    let [with, without] = [&observed[0], &observed[1]];
    claims.holds("number of vertices", with.vertices == without.vertices);
    let words = without.words.len() / without.vertices.max(1);
    for vertex in 0..without.vertices {
        let at = vertex * words;
        let position: [Ball; 4] = outputs(without, at);
        let image: [Ball; 4] = std::array::from_fn(|row| {
            (0..4).fold(Ball::from(0.0), |sum, column| sum + position[column] * matrix[4 * column + row])
        });
        claims.equal_vec("gl_Position", outputs(with, at), image);
        for word in 4..words {
            let [left, right] = [with, without].map(|o| outputs::<1>(o, at + word)[0]);
            claims.equal("an output that the matrix does not touch", left, right);
        }
    }
}
