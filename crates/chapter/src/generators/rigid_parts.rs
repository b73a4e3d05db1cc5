//! `rigid_parts`: the transforms of the parts of a jointed figure.

use glam::{DMat3, DMat4, DVec3};

use base::value::Shape;

use property::Stream;
use property::generators::matrix::{self, with_translation};
use property::generators::{
    Generator, Group, Options, Place, Range, RangeRule, Rigid, Role, SPECIAL, View, every_shape, is_mat4,
};

use super::arm::{bent, joint};

/// Rigid transforms of parts that hang together: each part turns about a joint that it shares with
/// the part before it. Special: all parts equal, all the identity, each part turned back by half a
/// turn (where a connecting part collapses), parts that do not hang together.
pub struct RigidParts;

/// What is special about parts.
#[derive(Clone, Copy)]
enum PartKind {
    /// All are equal.
    Equal,
    /// All are the identity.
    Identity,
    /// Each is turned back by half a turn.
    Back,
    /// They do not hang together.
    Apart,
    Ordinary,
}

impl PartKind {
    /// The special ones, which are as likely as each other.
    const SPECIAL: [Self; 4] = [Self::Equal, Self::Identity, Self::Back, Self::Apart];
}

/// `m` turned by `turn` about a point.
fn turned_about(m: &DMat4, joint: DVec3, turn: DMat3) -> DMat4 {
    *m * with_translation(turn, joint - turn * joint)
}

impl Generator for RigidParts {
    fn name(&self) -> &str {
        "rigid_parts"
    }

    fn about(&self) -> &str {
        "rigid transforms of the parts of a figure, each turned about a joint shared with the part before; joints lie in `range`"
    }

    fn range(&self) -> RangeRule {
        RangeRule::Default(-2.0, 2.0)
    }

    fn check(&self, shapes: &[Shape], _options: &Options) -> Result<(), String> {
        every_shape(self.name(), shapes, "mat4 and arrays of mat4", is_mat4)?;
        match shapes.iter().map(|s| s.elements()).sum() {
            0 | 1 => Err("generator `rigid_parts` needs at least two mat4; use `rigid` for one".into()),
            _ => Ok(()),
        }
    }

    fn fill(&self, group: &Group, _place: Place, stream: &mut Stream, out: &mut [u32]) {
        let range = group.range();
        let special = stream.one_in(SPECIAL);
        let kind = if special { PartKind::SPECIAL[stream.below(PartKind::SPECIAL.len())] } else { PartKind::Ordinary };
        let mut m = match kind {
            PartKind::Identity => DMat4::IDENTITY,
            PartKind::Apart => matrix::special_rigid(range, stream),
            PartKind::Equal | PartKind::Back | PartKind::Ordinary => matrix::rigid(range, stream),
        };
        let half_turn = DMat3::from_diagonal(DVec3::new(-1.0, -1.0, 1.0));
        for element in group.elements() {
            matrix::write(&m, &mut out[element.clone()]);
            m = match kind {
                PartKind::Equal | PartKind::Identity => m,
                PartKind::Back => turned_about(&m, matrix::lattice(range, stream), half_turn),
                PartKind::Apart => matrix::special_rigid(range, stream),
                PartKind::Ordinary => {
                    let turn = DMat3::from_quat(matrix::rotation(stream));
                    turned_about(&m, matrix::point(range, stream), turn)
                }
            };
        }
    }

    fn admits(&self, group: &Group, words: &[u32]) -> bool {
        // A chain of parts leaves the box of its joints: only the sort of matrix is held.
        let wide = Range::new(f64::from(f32::MIN), f64::from(f32::MAX));
        group.elements().iter().all(|e| matrix::is_rigid(&matrix::read(&words[e.clone()]), &wide))
    }

    fn role(&self) -> Role {
        Role::Moves
    }

    fn arrange(&self, group: &Group, view: &View, out: &mut [u32]) {
        let parts = bent(group.range(), group.elements().len(), view.frame);
        for (element, part) in group.elements().iter().zip(parts) {
            matrix::write(&part, &mut out[element.clone()]);
        }
    }

    fn lines(&self, group: &Group, words: &[u32]) -> Vec<[[f64; 3]; 2]> {
        let parts = group.elements().len();
        let line = |(k, element): (usize, &std::ops::Range<usize>)| {
            let part = matrix::read(&words[element.clone()]);
            [k, k + 1].map(|k| part.transform_point3(joint(group.range(), k, parts)).to_array())
        };
        group.elements().iter().enumerate().map(line).collect()
    }

    fn simplest(&self, group: &Group, out: &mut [u32]) {
        for element in group.elements() {
            matrix::write(&DMat4::IDENTITY, &mut out[element.clone()]);
        }
    }

    fn simpler(&self, group: &Group, words: &[u32], k: usize, out: &mut [u32]) -> bool {
        Rigid.simpler(group, words, k, out)
    }
}
