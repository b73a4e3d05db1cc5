//! An arm in a picture: parts along the x axis of the shapes, which bend at the joints between them.

use glam::{DMat3, DMat4, DVec3};

use property::generators::Range;
use property::generators::matrix::with_translation;

/// The joint number `k` of an arm of `parts` parts along the x axis of the shapes.
pub fn joint(range: &Range, k: usize, parts: usize) -> DVec3 {
    let (center, half) = range.middle();
    DVec3::new(center + 0.92 * half * (2.0 * k as f64 / parts as f64 - 1.0), center, center)
}

/// The transforms of the parts of an arm that bends at its joints as time goes on.
pub fn bent(range: &Range, parts: usize, frame: f64) -> Vec<DMat4> {
    let mut all = vec![DMat4::IDENTITY; parts];
    for k in 1..parts {
        let (turn, joint) = (DMat3::from_rotation_z(frame * 1.6 / (parts - 1) as f64), joint(range, k, parts));
        all[k] = all[k - 1] * with_translation(turn, joint - turn * joint);
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_arm_is_straight_at_first_and_holds_together() {
        let range = Range::new(-2.0, 2.0);
        assert!(bent(&range, 3, 0.0).iter().all(|m| *m == DMat4::IDENTITY));
        let arm = bent(&range, 3, 1.0);
        for k in 1..3 {
            let joint = joint(&range, k, 3);
            assert!(arm[k].transform_point3(joint).distance(arm[k - 1].transform_point3(joint)) < 1e-12);
        }
    }
}
