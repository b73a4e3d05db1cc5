//! Formulas with planted faults: which relations notice which.

use super::all;
use super::testing::{Device, broken};
use property::Sample;

fn swap(sample: &mut Sample, a: &str, b: &str) {
    let (x, y) = (sample.get(a), sample.get(b));
    sample.set(a, &y);
    sample.set(b, &x);
}

fn transpose(sample: &mut Sample, name: &str) {
    let mut values = sample.get(name);
    for matrix in values.chunks_exact_mut(16) {
        for (i, j) in [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)] {
            matrix.swap(4 * i + j, 4 * j + i);
        }
    }
    sample.set(name, &values);
}

/// Exchanges the first two columns of every matrix.
fn swap_columns(sample: &mut Sample, name: &str) {
    let mut values = sample.get(name);
    for matrix in values.chunks_exact_mut(16) {
        let (first, second) = matrix.split_at_mut(4);
        first.swap_with_slice(&mut second[..4]);
    }
    sample.set(name, &values);
}

fn scale(sample: &mut Sample, name: &str, by: f64) {
    let values: Vec<f64> = sample.get(name).iter().map(|x| x * by).collect();
    sample.set(name, &values);
}

fn normalise(sample: &mut Sample) {
    let sum: f64 = sample.get("w").iter().sum();
    scale(sample, "w", if sum == 0.0 { 0.0 } else { 1.0 / sum });
}

fn swap_weights(sample: &mut Sample) {
    let mut weights = sample.get("weight");
    weights.reverse();
    sample.set("weight", &weights);
}

fn heavy_first_bone(sample: &mut Sample) {
    let mut weights = sample.get("weight");
    weights[0] *= 1.0001;
    sample.set("weight", &weights);
}

fn last_bone_only(sample: &mut Sample) {
    let last = sample.get("numberOfBones")[0] as usize - 1;
    for (name, words) in [("p0", 4), ("p1", 4), ("blendMatrix", 16)] {
        let mut values = sample.get(name);
        values.copy_within(last * words..(last + 1) * words, 0);
        sample.set(name, &values);
    }
    sample.set("numberOfBones", &[1.0]);
}

fn last_two_nodes_swapped(sample: &mut Sample) {
    let mut nodes = sample.get("gl_Position");
    nodes[8..].rotate_left(4);
    sample.set("gl_Position", &nodes);
}

/// Moves the tip away from the root by one part in 1e4, as an unclamped parameter would.
fn long_segment(sample: &mut Sample) {
    let (root, mut tip) = (sample.get("p0"), sample.get("p1"));
    tip.iter_mut().zip(root).for_each(|(tip, root)| *tip += (*tip - root) * 1e-4);
    sample.set("p1", &tip);
}

type Planted = Vec<(Device, &'static [&'static str])>;

fn faults_of_surfaces() -> Planted {
    vec![
        (Device::after("sphere", |out| out[1] *= 1.0001), &["projection_last", "sphere_radius", "sphere_poles"]),
        (Device::after("sphere", |out| out[3] = 0.0), &["projection_last", "sphere_radius", "sphere_poles"]),
        (
            Device::before("sphere", |s| scale(s, "parameter", 1.0001)),
            &["surface_seam", "sphere_poles", "sphere_antipode"],
        ),
        (Device::before("sphere", |s| transpose(s, "mc")), &["projection_last"]),
        (Device::before("sphere", |s| swap_columns(s, "mc")), &["sphere_poles"]),
        (Device::after("cylinder", |out| out[1] *= 1.0001), &["projection_last", "cylinder_height"]),
        (Device::before("cylinder", |s| scale(s, "parameter", 1.0001)), &["surface_seam", "cylinder_height"]),
        (
            Device::before("cylinder", |s| swap_columns(s, "mc")),
            &["cylinder_radius", "cylinder_height", "cylinder_straight"],
        ),
    ]
}

fn faults_of_morphing() -> Planted {
    vec![
        (Device::before("morph", |s| swap(s, "p0", "p1")), &["morph_ends"]),
        (Device::before("morph", |s| scale(s, "t", 1.0001)), &["morph_ends", "morph_on_segment", "morph_swapped"]),
        (
            Device::after("morph", |out| out[3] = 0.0),
            &["projection_last", "morph_ends", "morph_on_segment", "morph_affine"],
        ),
        (Device::before("morph", |s| transpose(s, "mc")), &["projection_last"]),
        (Device::before("morph_targets", |s| scale(s, "w", 1.0001)), &["targets_single"]),
        (Device::before("morph_targets", |s| swap(s, "p1", "p4")), &["targets_single", "targets_permuted"]),
        (
            Device::before("morph_targets", |s| swap(s, "pn", "p1")),
            &["targets_base", "targets_single", "targets_permuted", "targets_linear"],
        ),
        (Device::before("morph_targets", normalise), &["targets_linear"]),
    ]
}

fn faults_of_joints() -> Planted {
    vec![
        (Device::before("joints", |s| scale(s, "part", 0.0)), &["joints_own_part", "joints_collapse"]),
        (Device::before("joints", |s| transpose(s, "partMatrix")), &["joints_common_motion", "joints_follow"]),
        (
            Device::before("joints", |s| swap_columns(s, "partMatrix")),
            &["joints_rest", "joints_follow", "joints_collapse"],
        ),
        (
            Device::before("joints", |s| scale(s, "position", 1.0001)),
            &["joints_rest", "joints_follow", "joints_collapse"],
        ),
    ]
}

fn faults_of_blending() -> Planted {
    vec![
        (Device::before("two_bones", |s| transpose(s, "blendMatrix")), &["blend_common_motion", "two_bones_hull"]),
        (Device::before("two_bones", |s| swap_columns(s, "blendMatrix")), &["blend_rest", "blend_common_motion"]),
        (Device::before("two_bones", swap_weights), &["two_bones_hull"]),
        (Device::before("two_bones", |s| scale(s, "weight", 1.0001)), &["two_bones_hull"]),
        (Device::before("two_bones", heavy_first_bone), &["two_bones_swapped", "two_bones_hull"]),
        (
            Device::after("two_bones", |out| out[3] = 1.0),
            &["projection_last", "blend_rest", "blend_common_motion", "two_bones_hull", "two_bones_raw_weights"],
        ),
        (
            Device::after("two_bones", |out| out[0] *= 1.0001),
            &["projection_last", "blend_rest", "blend_common_motion", "two_bones_hull"],
        ),
        (Device::before("skinning", |s| swap_columns(s, "blendMatrix")), &["blend_rest", "blend_common_motion"]),
        (
            Device::before("skinning", |s| transpose(s, "blendMatrix")),
            &["blend_common_motion", "skinning_hull", "skinning_weights"],
        ),
        (
            Device::after("skinning", |out| out[3] = 1.0),
            &[
                "projection_last",
                "blend_rest",
                "blend_common_motion",
                "skinning_additive",
                "skinning_hull",
                "skinning_nearest",
            ],
        ),
        (Device::after("skinning", |out| out.iter_mut().for_each(|x| *x *= 1.0001)), &["skinning_nearest"]),
        (Device::after("skinning", |out| out[0] *= 1.0001), &["projection_last", "blend_rest", "blend_common_motion"]),
        (
            Device::before("skinning", last_bone_only),
            &["skinning_permuted", "skinning_additive", "skinning_hull", "skinning_nearest"],
        ),
    ]
}

fn faults_of_splines() -> Planted {
    vec![
        (Device::before("hermite", |s| swap(s, "p0", "p1")), &["hermite_tangents"]),
        (Device::before("hermite", |s| swap(s, "m0", "m1")), &["hermite_tangents"]),
        (
            Device::before("hermite", |s| scale(s, "m0", 1.0001)),
            &["hermite_tangents", "hermite_reversed", "hermite_collinear"],
        ),
        (Device::before("hermite", |s| scale(s, "s", 1.0001)), &["hermite_tangents", "hermite_reversed"]),
        (Device::after("hermite", |out| out[3] = 0.0), &["hermite_tangents", "hermite_affine", "hermite_collinear"]),
        (Device::before("catmull_rom", |s| swap(s, "q0", "q3")), &["spline_c1", "catmull_rom_tangents"]),
        (Device::before("catmull_rom", |s| swap(s, "q1", "q2")), &["spline_ends", "spline_c1", "catmull_rom_tangents"]),
        (
            Device::before("catmull_rom", |s| scale(s, "s", 1.0001)),
            &["spline_ends", "spline_reversed", "spline_c1", "catmull_rom_tangents", "catmull_rom_derivative"],
        ),
        (Device::after("catmull_rom", |out| out[5] *= 1.0001), &["catmull_rom_derivative"]),
        (
            Device::after("catmull_rom", |out| out[1] *= 1.0001),
            &["spline_ends", "spline_affine", "spline_collinear", "catmull_rom_tangents", "catmull_rom_derivative"],
        ),
        (Device::before("cardinal", |s| scale(s, "w", 0.0)), &["cardinal_polyline", "cardinal_tangents"]),
        (Device::before("cardinal", |s| scale(s, "w", 1.0001)), &["cardinal_polyline", "cardinal_tangents"]),
        (
            Device::before("cardinal", |s| swap(s, "q0", "q3")),
            &["spline_c1", "cardinal_is_catmull_rom", "cardinal_tangents"],
        ),
        (Device::before("kochanek_bartels", |s| scale(s, "tension", 1.0001)), &["kochanek_bartels_polyline"]),
        (Device::before("kochanek_bartels", |s| scale(s, "bias", -1.0)), &["kochanek_bartels_bias"]),
        (Device::before("kochanek_bartels", |s| scale(s, "continuity", -1.0)), &["kochanek_bartels_corner"]),
        (
            Device::before("kochanek_bartels", |s| swap(s, "bias", "continuity")),
            &["spline_reversed", "spline_c1", "kochanek_bartels_bias", "kochanek_bartels_corner"],
        ),
        (
            Device::before("kochanek_bartels", |s| swap(s, "bias", "tension")),
            &["spline_reversed", "kochanek_bartels_polyline", "kochanek_bartels_bias"],
        ),
        (
            Device::before("kochanek_bartels", |s| swap(s, "q0", "q3")),
            &["spline_c1", "kochanek_bartels_is_catmull_rom", "kochanek_bartels_bias"],
        ),
    ]
}

fn faults_of_hair() -> Planted {
    vec![
        (
            Device::after("hair", |out| out[0] *= 1.0001),
            &[
                "projection_last",
                "hair_strip",
                "hair_tangent",
                "hair_view",
                "hair_light",
                "hair_affine",
                "hair_collinear",
            ],
        ),
        (
            Device::after("hair", |out| out[3] = 0.0),
            &["projection_last", "hair_strip", "hair_affine", "hair_collinear"],
        ),
        (Device::after("hair", |out| out[4] = -out[4]), &["hair_view"]),
        (Device::after("hair", |out| out[7] *= 1.0001), &["hair_unit", "hair_light"]),
        (Device::after("hair", |out| out[7..10].iter_mut().for_each(|x| *x = -*x)), &["hair_light"]),
        (Device::after("hair", |out| out[10..].iter_mut().for_each(|x| *x = -*x)), &["hair_tangent"]),
        (Device::after("hair", |out| out[10..].iter_mut().for_each(|x| *x *= 1.0001)), &["hair_unit", "hair_tangent"]),
        (Device::before("hair", |s| transpose(s, "mc")), &["projection_last"]),
        (Device::before("hair", last_two_nodes_swapped), &["hair_strip", "hair_reversed", "hair_c1"]),
    ]
}

fn faults_of_distances_and_weights() -> Planted {
    vec![
        (
            Device::after("segment_distance", |out| out[0] *= 1.0001),
            &["segment_cases", "segment_no_farther", "segment_lipschitz", "segment_degenerate"],
        ),
        (
            Device::after("segment_distance", |out| out[0] = -out[0]),
            &["segment_not_negative", "segment_cases", "segment_split", "segment_degenerate"],
        ),
        (
            Device::before("segment_distance", |s| swap(s, "p", "p0")),
            &[
                "segment_zero_on_it",
                "segment_cases",
                "segment_swapped",
                "segment_no_farther",
                "segment_split",
                "segment_degenerate",
            ],
        ),
        (
            Device::before("segment_distance", long_segment),
            &[
                "segment_zero_on_it",
                "segment_cases",
                "segment_swapped",
                "segment_no_farther",
                "segment_split",
                "segment_rigid",
            ],
        ),
        (
            Device::after("bone_weight", |out| out[0] *= 1.0001),
            &["weight_one_at_zero", "weight_range", "weight_squares"],
        ),
        (Device::before("bone_weight", |s| scale(s, "c", -1.0)), &["weight_range", "weight_falls"]),
        (Device::before("bone_weight", |s| swap(s, "c", "d")), &["weight_squares"]),
        (Device::after("bone_weight", |out| out[0] = 0.0), &["weight_one_at_zero", "weight_range"]),
    ]
}

#[test]
fn faults_of_surfaces_are_found() {
    are_found(&faults_of_surfaces());
}

#[test]
fn faults_of_morphing_are_found() {
    are_found(&faults_of_morphing());
}

#[test]
fn faults_of_joints_are_found() {
    are_found(&faults_of_joints());
}

#[test]
fn faults_of_blending_are_found() {
    are_found(&faults_of_blending());
}

#[test]
fn faults_of_splines_are_found() {
    are_found(&faults_of_splines());
}

#[test]
fn faults_of_hair_are_found() {
    are_found(&faults_of_hair());
}

#[test]
fn faults_of_distances_and_weights_are_found() {
    are_found(&faults_of_distances_and_weights());
}

fn are_found(faults: &Planted) {
    for (i, (device, relations)) in faults.iter().enumerate() {
        assert_eq!(broken(device), *relations, "fault {i}, of {}", device.formula.name);
    }
}

#[test]
fn every_relation_is_broken_by_a_planted_fault() {
    let families = [
        faults_of_surfaces,
        faults_of_morphing,
        faults_of_joints,
        faults_of_blending,
        faults_of_splines,
        faults_of_hair,
        faults_of_distances_and_weights,
    ];
    let found: Vec<&str> = families.iter().flat_map(|faults| faults()).flat_map(|(_, names)| names).copied().collect();
    for relation in all() {
        assert!(found.contains(&relation.name()), "{}", relation.name());
    }
}

#[test]
fn a_change_that_the_mathematics_does_not_see_breaks_nothing() {
    // The distance does not tell a bone's root from its tip.
    for device in [
        Device::before("skinning", |s| swap(s, "p1", "p0")),
        Device::before("segment_distance", |s| swap(s, "p1", "p0")),
    ] {
        assert!(broken(&device).is_empty(), "{}", device.formula.name);
    }
}
