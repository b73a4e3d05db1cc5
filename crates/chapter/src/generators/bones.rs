//! `bones`: a skeleton with consistent roots, tips and blend matrices.

use glam::{DMat3, DMat4, DVec3};

use base::value::{Scalar, Shape};

use property::Stream;
use property::generators::matrix::{self, SIMPLER_RIGID, with_translation};
use property::generators::{Generator, Group, Options, Place, Range, RangeRule, Role, SPECIAL, View, float, word};

use super::arm::{bent, joint};
use super::posed::{self, Draws};

/// A number of bones, their roots and tips, and B_i · inverse(M_i), where M_i is the frame of the
/// bone at rest (origin at the root, y along the bone) and B_i the posed frame: turned about the
/// root and moved. Roots and tips lie in the range. Every second skeleton is a chain. Entries past
/// the number are filled too, so that a shader that reads them is found out.
///
/// Special: a bone of length zero, a bone of some thousandths of the range, all bones
/// equal, lattice points as roots and tips (which the special points of `point` meet), a rest pose
/// (all blend matrices the identity), one bone, all. At the edges also: no bone, and bones of some millionths.
pub struct Bones;

/// Where the parts of the group lie.
struct Parts {
    count: usize,
    roots: usize,
    tips: usize,
    matrices: usize,
    rows: usize,
}

fn parts(group: &Group) -> Parts {
    let [_, roots, tips, _] = group.shapes() else {
        return Parts { count: 0, roots: 1, tips: 1, matrices: 1, rows: 1 };
    };
    let tips_at = 1 + roots.words();
    Parts {
        count: roots.elements(),
        roots: 1,
        tips: tips_at,
        matrices: tips_at + tips.words(),
        rows: roots.element_words(),
    }
}

/// The frame of a bone at rest: origin at its root, y axis along it. The y axis of the world for a
/// bone of length zero.
fn rest_frame(root: DVec3, tip: DVec3) -> DMat4 {
    let y = (tip - root).try_normalize().unwrap_or(DVec3::Y);
    let x = y.any_orthonormal_vector();
    with_translation(DMat3::from_cols(x, y, x.cross(y)), root)
}

/// B · inverse(M) for a bone that is turned about its root and then moved.
fn blend_matrix(root: DVec3, tip: DVec3, pose: &DMat4) -> DMat4 {
    let rest = rest_frame(root, tip);
    let turned = rest * with_translation(DMat3::from_mat4(*pose), DVec3::ZERO);
    let posed = with_translation(DMat3::IDENTITY, pose.w_axis.truncate()) * turned;
    posed * rest.inverse()
}

/// Writes root and tip of a bone.
fn write_points(&Parts { roots, tips, rows, .. }: &Parts, bone: usize, points: [DVec3; 2], out: &mut [u32]) {
    for (at, p) in [roots, tips].into_iter().zip(points) {
        let out = &mut out[at + bone * rows..][..rows];
        for (word_out, c) in out.iter_mut().zip([p.x, p.y, p.z, 1.0]) {
            *word_out = word(c);
        }
    }
}

/// Writes bones of which none is special.
fn ordinary(range: &Range, parts: &Parts, chain: bool, stream: &mut Stream, out: &mut [u32]) {
    let (mut draws, mut bones, mut before) = (Draws::default(), posed::Bones::default(), None);
    for first in (0..parts.count).step_by(posed::ABREAST) {
        let here = posed::ABREAST.min(parts.count - first);
        (0..here).for_each(|k| draws.draw(k, chain && first + k > 0, stream));
        draws.bones(range, chain, before, &mut bones);
        for k in 0..here {
            let at = |of: &[[f64; posed::ABREAST]; 3]| DVec3::new(of[0][k], of[1][k], of[2][k]);
            write_points(parts, first + k, [at(&bones.roots), at(&bones.tips)], out);
            let matrix = &mut out[parts.matrices + (first + k) * 16..][..16];
            matrix.iter_mut().zip(&bones.matrices).for_each(|(word, column)| *word = column[k]);
            before = Some(at(&bones.tips));
        }
    }
}

/// What is special about bones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum BoneKind {
    /// One has no length.
    NoLength,
    /// All are equal.
    Equal,
    /// Their ends are lattice points.
    Lattice,
    /// They are at rest.
    Rest,
    /// One counts.
    One,
    /// All count.
    All,
    /// One is short.
    Short,
    Ordinary,
}

impl BoneKind {
    /// The special ones, which are as likely as each other.
    const SPECIAL: [Self; 7] =
        [Self::NoLength, Self::Equal, Self::Lattice, Self::Rest, Self::One, Self::All, Self::Short];
}

/// How bones are made.
struct Plan {
    kind: BoneKind,
    /// Each root is the tip before.
    chain: bool,
    /// The bone that is short.
    degenerate: usize,
}

/// Writes bones one by one; ordinary ones as well.
fn one_by_one(range: &Range, parts: &Parts, plan: Plan, stream: &mut Stream, out: &mut [u32]) {
    let Plan { kind, chain, degenerate } = plan;
    let Parts { count, roots, tips, matrices, rows } = *parts;
    let mut tip = DVec3::ZERO;
    let point = |stream: &mut Stream| match kind {
        BoneKind::Lattice => matrix::lattice(range, stream),
        _ => matrix::point(range, stream),
    };
    for bone in 0..count {
        let root = if chain && bone > 0 { tip } else { point(stream) };
        tip = match kind {
            BoneKind::NoLength if bone == degenerate => root,
            // Between the length zero and ordinary ones: a threshold on the length must not hide.
            BoneKind::Short if bone == degenerate => root + (point(stream) - root) * NEAR,
            _ => point(stream),
        };
        let blend = match kind {
            BoneKind::Rest => DMat4::IDENTITY,
            BoneKind::Lattice => {
                // Turns that map axes to axes about a lattice point keep all entries whole numbers.
                let turn = matrix::quarter_turns(stream);
                with_translation(turn, root - turn * root)
            }
            _ => blend_matrix(root, tip, &matrix::rigid(range, stream)),
        };
        write_points(parts, bone, [root, tip], out);
        matrix::write(&blend, &mut out[matrices + bone * 16..][..16]);
    }
    if kind == BoneKind::Equal {
        for bone in 1..count {
            out.copy_within(roots..roots + rows, roots + bone * rows);
            out.copy_within(tips..tips + rows, tips + bone * rows);
            out.copy_within(matrices..matrices + 16, matrices + bone * 16);
        }
    }
}

/// Length of a special bone, relative to an ordinary one.
const NEAR: f64 = 1.0 / 1024.0;

/// Lengths of bones at the edge of having none.
const SHORT: [f32; 4] = [0.0, 2e-6, 8e-6, 1.2e-5];

/// Bones that a picture shows.
const SHOWN: usize = 3;

impl Generator for Bones {
    fn name(&self) -> &str {
        "bones"
    }

    fn about(&self) -> &str {
        "a skeleton: number of bones, roots, tips (both in `range`) and blend matrices that belong together"
    }

    fn range(&self) -> RangeRule {
        RangeRule::Default(-2.0, 2.0)
    }

    fn check(&self, shapes: &[Shape], _options: &Options) -> Result<(), String> {
        let wanted = "an int, two arrays of vec3 or vec4 and an array of mat4, all of one length, in this order";
        let [count, roots, tips, matrices] = shapes else {
            return Err(format!("generator `bones` fills four inputs ({wanted}), not {}", shapes.len()));
        };
        let is_count = matches!(count.scalar, Scalar::I32 | Scalar::U32) && count.words() == 1;
        let is_points = roots.array.is_some() && roots.scalar == Scalar::F32 && roots.columns == 1 && roots.rows >= 3;
        let is_matrices = matrices.element() == Shape::MAT4 && matrices.array == roots.array;
        if is_count && is_points && roots == tips && is_matrices && roots.array != Some(0) {
            Ok(())
        } else {
            Err(format!("generator `bones` fills {wanted}; the inputs are {count}, {roots}, {tips}, {matrices}"))
        }
    }

    fn fill(&self, group: &Group, place: Place, stream: &mut Stream, out: &mut [u32]) {
        let parts = parts(group);
        let count = parts.count;
        let range = group.range();
        let kind = match stream.one_in(SPECIAL) {
            _ if place.exact => BoneKind::Lattice,
            true => BoneKind::SPECIAL[stream.below(BoneKind::SPECIAL.len())],
            false => BoneKind::Ordinary,
        };
        out[0] = match kind {
            BoneKind::One => 1,
            BoneKind::All => count,
            _ => 1 + stream.below(count),
        } as u32;
        let chain = stream.bits() & 1 == 0;
        let degenerate = stream.below(out[0] as usize);
        match kind {
            BoneKind::One | BoneKind::All | BoneKind::Ordinary => ordinary(range, &parts, chain, stream, out),
            BoneKind::NoLength | BoneKind::Equal | BoneKind::Lattice | BoneKind::Rest | BoneKind::Short => {
                one_by_one(range, &parts, Plan { kind, chain, degenerate }, stream, out);
            }
        }
    }

    fn admits(&self, group: &Group, words: &[u32]) -> bool {
        let Parts { count, roots, matrices, rows, .. } = parts(group);
        // A turn about a root moves the origin by up to twice its distance, and the pose adds its own.
        let wide = Range::new(f64::from(f32::MIN), f64::from(f32::MAX));
        let is_point = |p: &[u32]| {
            p[..3].iter().all(|&c| group.range().contains(float(c))) && p.get(3).is_none_or(|&w| float(w) == 1.0)
        };
        words[0] <= count as u32
            && words[roots..matrices].chunks_exact(rows).all(is_point)
            && words[matrices..].chunks_exact(16).all(|m| matrix::is_rigid(&matrix::read(m), &wide))
    }

    /// No bone, one, all; the last bone of length zero and of some millionths; all bones short; all alike; zeros with a
    /// sign.
    fn edges(&self, group: &Group, base: &[u32]) -> Vec<Vec<u32>> {
        let parts = parts(group);
        let Parts { count, roots, tips, matrices, rows } = parts;
        let with = |number: usize, change: &dyn Fn(&mut [u32])| {
            let mut words = base.to_vec();
            words[0] = number as u32;
            change(&mut words);
            words
        };
        // The tip of a bone beside its root, along one axis.
        let short = |words: &mut [u32], bone: usize, by: f32| {
            words.copy_within(roots + bone * rows..roots + (bone + 1) * rows, tips + bone * rows);
            let at = tips + bone * rows + bone % 3;
            let inside = group.range().contains(float(words[at]) + by);
            words[at] = (float(words[at]) + if inside { by } else { -by }).to_bits();
        };
        let mut all = vec![with(0, &|_| {}), with(1, &|_| {}), with(count, &|_| {})];
        for by in SHORT {
            all.push(with(count, &|words| short(words, count - 1, by)));
            all.push(with(1, &|words| short(words, 0, by)));
            all.push(with(count, &|words| (0..count).for_each(|bone| short(words, bone, by))));
        }
        all.push(with(count, &|words| {
            for bone in 1..count {
                words.copy_within(roots..roots + rows, roots + bone * rows);
                words.copy_within(tips..tips + rows, tips + bone * rows);
                words.copy_within(matrices..matrices + 16, matrices + bone * 16);
            }
        }));
        for c in 0..3 {
            all.push(with(count, &|words| {
                for bone in 0..count {
                    words[roots + bone * rows + c] = (-0.0_f32).to_bits();
                }
            }));
        }
        all.retain(|words| self.admits(group, words));
        all
    }

    fn role(&self) -> Role {
        Role::Moves
    }

    fn arrange(&self, group: &Group, view: &View, out: &mut [u32]) {
        let Parts { count, roots, tips, matrices, rows } = parts(group);
        let shown = count.min(SHOWN);
        let blend = bent(group.range(), shown, view.frame);
        out[0] = shown as u32;
        for bone in 0..count {
            // Those that do not count are like the last.
            let k = bone.min(shown - 1);
            for (at, k) in [(roots, k), (tips, k + 1)] {
                let p = joint(group.range(), k, shown);
                let out = &mut out[at + bone * rows..][..rows];
                for (word_out, c) in out.iter_mut().zip([p.x, p.y, p.z, 1.0]) {
                    *word_out = word(c);
                }
            }
            matrix::write(&blend[k], &mut out[matrices + bone * 16..][..16]);
        }
    }

    fn lines(&self, group: &Group, words: &[u32]) -> Vec<[[f64; 3]; 2]> {
        let Parts { count, roots, tips, matrices, rows } = parts(group);
        let point = |at: usize| DVec3::from_array(std::array::from_fn(|c| f64::from(float(words[at + c]))));
        let line = |bone: usize| {
            let blend = matrix::read(&words[matrices + bone * 16..][..16]);
            [roots, tips].map(|at| blend.transform_point3(point(at + bone * rows)).to_array())
        };
        (0..(words[0] as usize).min(count)).map(line).collect()
    }

    fn simplest(&self, group: &Group, out: &mut [u32]) {
        let Parts { count, roots, tips, matrices, rows } = parts(group);
        let origin = group.range().clamp(0.0).to_bits();
        out[0] = 1;
        out[roots..matrices].fill(origin);
        for bone in 0..count {
            out[tips + bone * rows + 1] = group.range().clamp(1.0).to_bits();
            if rows == 4 {
                out[roots + bone * rows + 3] = word(1.0);
                out[tips + bone * rows + 3] = word(1.0);
            }
            matrix::write(&DMat4::IDENTITY, &mut out[matrices + bone * 16..][..16]);
        }
    }

    fn simpler(&self, group: &Group, words: &[u32], k: usize, out: &mut [u32]) -> bool {
        let Parts { count, matrices, .. } = parts(group);
        let bone = k / SIMPLER_RIGID;
        if bone >= count {
            return false;
        }
        let at = matrices + bone * 16..matrices + bone * 16 + 16;
        let wide = Range::new(f64::from(f32::MIN), f64::from(f32::MAX));
        if let Some(m) = matrix::simpler_rigid(&matrix::read(&words[at.clone()]), &wide, k % SIMPLER_RIGID) {
            matrix::write(&m, &mut out[at]);
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bones_side_by_side_are_those_one_by_one() {
        // Fewer than there is room for, more, and points of three components.
        for (count, rows) in [(1, 4), (3, 4), (8, 4), (11, 3)] {
            let parts = Parts { count, roots: 1, tips: 1 + count * rows, matrices: 1 + 2 * count * rows, rows };
            for seed in 0..500 {
                let [mut ours, mut single] =
                    [vec![7; parts.matrices + 16 * count], vec![7; parts.matrices + 16 * count]];
                let chain = seed % 2 == 0;
                let range = [Range::new(-2.0, 2.0), Range::new(1.0, 1.5)][seed as usize / 2 % 2];
                let [mut first, mut second] = [Stream::new(seed), Stream::new(seed)];
                ordinary(&range, &parts, chain, &mut first, &mut ours);
                let plan = Plan { kind: BoneKind::Ordinary, chain, degenerate: 0 };
                one_by_one(&range, &parts, plan, &mut second, &mut single);
                assert_eq!(ours, single, "{count} {seed}");
                assert_eq!(first.bits(), second.bits());
                // Each word was written, but for the number of bones.
                assert!(ours[0] == 7 && ours[1..].iter().all(|&word| word != 7));
            }
        }
    }
}
