//! Scenes, opened by a reader of glTF that is not ours.

use engine::catalogue;
use gltf::Gltf;
use gltf::animation::util::ReadOutputs;
use gltf::mesh::Mode;

use super::*;

fn open(formula: &str) -> (Gltf, Vec<u8>) {
    let scene = catalogue::scenes().find(|scene| scene.formula == formula).unwrap();
    let bytes = (scene.glb)(600, json!({ "version": "2.0", "generator": "a test" }));
    let file = Gltf::from_slice(&bytes).unwrap_or_else(|error| panic!("{formula}: {error}"));
    let blob = file.blob.clone().expect("a binary chunk");
    (file, blob)
}

fn positions(file: &Gltf, blob: &[u8]) -> Vec<[f32; 3]> {
    let mut all = Vec::new();
    for primitive in file.meshes().flat_map(|mesh| mesh.primitives()) {
        let reader = primitive.reader(|_| Some(blob));
        all.extend(reader.read_positions().expect("positions"));
    }
    all
}

#[test]
fn every_scene_opens() {
    assert_eq!(ALL.len(), 9);
    for formula in ALL.iter().map(|scene| scene.formula) {
        let (file, blob) = open(formula);
        let points = positions(&file, &blob);
        assert!(points.len() > 300 && points.len() < 1300, "{formula}: {}", points.len());
        assert!(points.iter().flatten().all(|x| x.is_finite()), "{formula}");
        assert_eq!(file.document.as_json().asset.generator.as_deref(), Some("a test"));
        assert!(catalogue::formula(formula).is_some(), "{formula}");
    }
}

#[test]
fn triangles_of_surfaces_face_outward() {
    for formula in ["sphere", "cylinder"] {
        let (file, blob) = open(formula);
        let primitive = file.meshes().next().unwrap().primitives().next().unwrap();
        let reader = primitive.reader(|_| Some(&blob[..]));
        let points: Vec<glam::Vec3> = reader.read_positions().unwrap().map(glam::Vec3::from).collect();
        let indices: Vec<u32> = reader.read_indices().unwrap().into_u32().collect();
        for corner in indices.chunks_exact(3).map(|c| [0, 1, 2].map(|k| points[c[k] as usize])) {
            let [a, b, c] = corner;
            let centre = (a + b + c) / 3.0;
            let out = if formula == "cylinder" { centre * glam::Vec3::new(1.0, 0.0, 1.0) } else { centre };
            // At the poles of a sphere triangles have no area.
            assert!((b - a).cross(c - a).dot(out) >= -1e-7, "{formula}: {corner:?}");
        }
        let normals: Vec<[f32; 3]> = reader.read_normals().unwrap().collect();
        assert!(normals.iter().all(|n| (glam::Vec3::from(*n).length() - 1.0).abs() < 1e-6));
    }
}

#[test]
fn the_arm_has_a_skin_that_follows_its_bones() {
    let (file, blob) = open("skinning");
    let skin = file.skins().next().unwrap();
    assert_eq!(skin.joints().count(), 2);
    let matrices: Vec<[[f32; 4]; 4]> = skin.reader(|_| Some(&blob[..])).read_inverse_bind_matrices().unwrap().collect();
    // Each takes the root of its bone to the origin.
    assert_eq!((matrices[0][3], matrices[1][3]), ([0.0, 1.0, 0.0, 1.0], [0.0, 0.0, 0.0, 1.0]));
    let primitive = file.meshes().next().unwrap().primitives().next().unwrap();
    let reader = primitive.reader(|_| Some(&blob[..]));
    let weights: Vec<[f32; 4]> = reader.read_weights(0).unwrap().into_f32().collect();
    let points: Vec<[f32; 3]> = reader.read_positions().unwrap().collect();
    for (point, weights) in points.iter().zip(&weights) {
        assert_eq!(weights.iter().sum::<f32>(), 1.0);
        // A vertex beside the elbow belongs to both bones, one at an end to the bone beside it.
        match point[1] {
            0.0 => assert_eq!(weights[..2], [0.5, 0.5]),
            y if y.abs() == 1.0 => assert!(weights[usize::from(y > 0.0)] > 0.99, "{point:?}: {weights:?}"),
            _ => {}
        }
    }
    let (rigid, blob) = open("joints");
    let primitive = rigid.meshes().next().unwrap().primitives().next().unwrap();
    let weights: Vec<[f32; 4]> = primitive.reader(|_| Some(&blob[..])).read_weights(0).unwrap().into_f32().collect();
    assert!(weights.iter().flatten().all(|&w| w == 0.0 || w == 1.0));
}

#[test]
fn what_the_host_animates_is_an_animation() {
    let (file, blob) = open("morph_targets");
    let channel = file.animations().next().unwrap().channels().next().unwrap();
    let reader = channel.reader(|_| Some(&blob[..]));
    let times: Vec<f32> = reader.read_inputs().unwrap().collect();
    let Some(ReadOutputs::MorphTargetWeights(weights)) = reader.read_outputs() else { panic!("weights") };
    let weights: Vec<f32> = weights.into_f32().collect();
    assert_eq!((times.len(), weights.len()), (9, 36));
    assert_eq!(weights[4..8], [1.0, 0.0, 0.0, 0.0]);

    let (file, blob) = open("catmull_rom");
    let channel = file.animations().next().unwrap().channels().next().unwrap();
    let Some(ReadOutputs::Translations(frames)) = channel.reader(|_| Some(&blob[..])).read_outputs() else {
        panic!("translations")
    };
    let frames: Vec<[f32; 3]> = frames.collect();
    // The cubic of glTF at half a second is a point of the curve.
    let at = |k: usize| frames[k];
    let half = |c: usize| 0.5 * at(1)[c] + 0.125 * at(2)[c] + 0.5 * at(4)[c] - 0.125 * at(3)[c];
    let middle = [half(0), half(1), half(2)];
    let near = positions(&file, &blob).into_iter().any(|p| (0..3).all(|c| (p[c] - middle[c]).abs() < 1e-5));
    assert!(near, "{middle:?} is no point of the curve");
}

#[test]
fn strands_are_strips_of_lines() {
    let (file, blob) = open("hair");
    let mesh = file.meshes().next().unwrap();
    assert!(mesh.primitives().count() > 10);
    for primitive in mesh.primitives() {
        assert_eq!(primitive.mode(), Mode::LineStrip);
        assert_eq!(primitive.reader(|_| Some(&blob[..])).read_positions().unwrap().count(), 45);
    }
}
