//! Generators: named distributions of inputs, one a file and one line in [`all`]. Crates with content add their own.
//!
//! A generator fills the words of a *group* of inputs for one sample. About one sample in eight is
//! special: values where arithmetic has its edges, and structures (coincident nodes, a bone of
//! length zero, a corner of the simplex) where formulas have theirs.

use serde::{Deserialize, Serialize};
use std::fmt;

use base::value::{Scalar, Shape};

use super::stream::{Stream, mix};

mod abreast;
mod affine;
mod arrange;
mod array;
mod constant;
mod direction;
mod drawn;
mod edges;
mod group;
mod index;
mod interval;
pub mod matrix;
mod nodes;
mod permutation;
mod point;
mod projection;
mod range;
mod raw_weights;
mod rigid;
mod simplex;
mod sorted;
pub mod spatial;
pub mod testing;
mod vector;

pub use arrange::{Role, View};
pub use drawn::Drawn;
pub use group::Group;
pub use nodes::Nodes;
pub use range::Range;
pub use rigid::Rigid;

/// One sample in this many is special.
pub const SPECIAL: usize = 8;

/// One case in this many is exact: see [`Place::exact`].
pub const EXACT: u64 = 32;

/// The generators of this crate, in the order of the manual.
pub fn all() -> &'static [&'static dyn Generator] {
    &[
        &interval::Interval,
        &point::Point,
        &vector::Vector,
        &direction::Direction,
        &simplex::Simplex,
        &raw_weights::RawWeights,
        &rigid::Rigid,
        &affine::Affine,
        &projection::Projection,
        &nodes::Nodes,
        &index::Index,
        &array::Array,
        &sorted::Sorted,
        &permutation::Permutation,
        &constant::Constant,
    ]
}

/// The generator of fixed values.
pub static CONSTANT: constant::Constant = constant::Constant;

/// The generator of this crate called `name`.
pub fn by_name(name: &str) -> Option<&'static dyn Generator> {
    all().iter().copied().find(|g| g.name() == name)
}

/// Whether a generator takes a `range`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RangeRule {
    /// It has to be given.
    Required,
    /// This one when none is given.
    Default(f64, f64),
    /// The generator has no use for one.
    None,
}

/// How the host ends the strands that it draws as strips with adjacency.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Ends {
    /// The end nodes are repeated: a strand of m nodes gives m - 1 segments.
    Repeat,
    /// Nothing is added: a strand of m nodes gives m - 3 segments.
    AsDrawn,
}

/// Strands of nodes, drawn as `GL_LINE_STRIP_ADJACENCY`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Strands {
    /// Nodes of one strand.
    pub nodes: usize,
    /// What happens at the ends.
    pub ends: Ends,
}

impl Strands {
    /// Primitives that one strand gives.
    pub fn primitives(&self) -> usize {
        match self.ends {
            Ends::Repeat => self.nodes.saturating_sub(1),
            Ends::AsDrawn => self.nodes.saturating_sub(3),
        }
    }

    /// Index of the node that primitive `primitive` of a strand sees in place `corner` (0 to 3).
    pub fn node(&self, primitive: usize, corner: usize) -> usize {
        match self.ends {
            Ends::Repeat => (primitive + corner).saturating_sub(1).min(self.nodes.saturating_sub(1)),
            Ends::AsDrawn => primitive + corner,
        }
    }
}

/// What a suite says about a group beside its names and generator.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Options {
    /// `range`: what it bounds is for the generator to say.
    pub range: Option<[f64; 2]>,
    /// `values`: for the generator `constant`.
    pub values: Vec<f64>,
    /// `components`: how many floats the host feeds for each attribute; the vertex fetch fills the
    /// rest from (0, 0, 0, 1).
    pub components: Option<u8>,
    /// Strands of the suite.
    pub strands: Option<Strands>,
}

/// Where a sample stands.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// A number of its own for every case (and group).
    pub case_seed: u64,
    /// Index of the invocation in its case; 0 for uniforms.
    pub invocation: usize,
    /// True in one case of [`EXACT`]: all groups of the case prefer whole numbers and turns that map
    /// axes to axes, so that exact coincidences between groups (a vertex on a bone) come about.
    pub exact: bool,
}

/// A distribution of the values of a group of inputs.
pub trait Generator: Send + Sync {
    /// Name, as suites write it: lower case with `_`.
    fn name(&self) -> &str;

    /// What it makes, as one sentence without a full stop.
    fn about(&self) -> &str;

    /// Whether it takes a range.
    fn range(&self) -> RangeRule;

    /// Whether it takes `values`.
    fn takes_values(&self) -> bool {
        false
    }

    /// Whether it can leave components to the vertex fetch.
    fn takes_components(&self) -> bool {
        false
    }

    /// Refuses names and shapes that it cannot fill.
    ///
    /// # Errors
    /// What is wrong and what would be right, without a place.
    fn check(&self, shapes: &[Shape], options: &Options) -> Result<(), String>;

    /// Writes one sample. `out` holds the words of all names, one after the other.
    fn fill(&self, group: &Group, place: Place, stream: &mut Stream, out: &mut [u32]);

    /// True when the words could be a sample: what `fill` writes is admitted, and so is what a
    /// shrunk sample may contain.
    fn admits(&self, group: &Group, words: &[u32]) -> bool;

    /// Writes the plainest sample, which is admitted.
    fn simplest(&self, group: &Group, out: &mut [u32]);

    /// Writes the plainer version number `k` of `words` over `out`, a copy of them. False when there
    /// is no such version. Values that keep a law between words (unit length, a sum of one) can only
    /// be made plainer together.
    fn simpler(&self, _group: &Group, _words: &[u32], _k: usize, _out: &mut [u32]) -> bool {
        false
    }

    /// Samples at the edges of the group, made from an ordinary one, `base`: ends of ranges and what lies beside them,
    /// zeros with either sign, coincident points. All are admitted. They come beside those of `fill`, which leaves the
    /// bits of these as they are.
    fn edges(&self, group: &Group, base: &[u32]) -> Vec<Vec<u32>> {
        edges::of(self, group, base)
    }

    /// What it is in a picture.
    fn role(&self) -> Role {
        Role::Still
    }

    /// Writes what a picture shows in a place, over a sample; see [`Role`].
    fn arrange(&self, _group: &Group, _view: &View, _out: &mut [u32]) {}

    /// Lines to be drawn beside what a shader makes of the words, such as bones.
    fn lines(&self, _group: &Group, _words: &[u32]) -> Vec<[[f64; 3]; 2]> {
        Vec::new()
    }

    /// Fills many rows: [`Generator::fill`] for each, without a virtual call for each.
    fn fill_rows(&self, group: &Group, rows: Rows<'_>) {
        each_row(self, group, rows);
    }
}

/// Fills rows one by one.
fn each_row<G: Generator + ?Sized>(generator: &G, group: &Group, rows: Rows<'_>) {
    let Rows { words, stride, spans, key, exact_key, first_case, first_invocation, per_case } = rows;
    let (mut case, mut invocation) = (first_case, first_invocation);
    let mut case_seed = mix(key, case);
    let is_exact = |case| mix(exact_key, case).is_multiple_of(EXACT);
    let mut exact = is_exact(case);
    let direct = match spans {
        [only] => Some(only.clone()),
        _ => None,
    };
    let mut scratch = vec![0; group.words()];
    for row in words.chunks_exact_mut(stride) {
        let place = Place { case_seed, invocation, exact };
        let mut stream = Stream::new(mix(case_seed, invocation as u64));
        if let Some(span) = &direct {
            let out = &mut row[span.clone()];
            generator.fill(group, place, &mut stream, out);
            group.fetch(out);
        } else {
            generator.fill(group, place, &mut stream, &mut scratch);
            group.fetch(&mut scratch);
            let mut at = 0;
            for span in spans {
                row[span.clone()].copy_from_slice(&scratch[at..at + span.len()]);
                at += span.len();
            }
        }
        invocation += 1;
        if invocation == per_case {
            (invocation, case) = (0, case.wrapping_add(1));
            case_seed = mix(key, case);
            exact = is_exact(case);
        }
    }
}

impl fmt::Debug for dyn Generator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Rows of a batch to be filled by [`Generator::fill_rows`].
pub struct Rows<'a> {
    /// Whole records, one after the other.
    pub words: &'a mut [u32],
    /// Words of one record; at least 1.
    pub stride: usize,
    /// Where the group's names lie in a record; neighbours joined, in the order of the names.
    pub spans: &'a [std::ops::Range<usize>],
    /// Seed of the group.
    pub key: u64,
    /// Seed that says which cases are exact: the same for all groups.
    pub exact_key: u64,
    /// Case of the first row.
    pub first_case: u64,
    /// Invocation of the first row in its case.
    pub first_invocation: usize,
    /// Rows of one case.
    pub per_case: usize,
}

/// A number rounded to binary32, as the bits of that.
#[inline]
pub fn word(value: f64) -> u32 {
    (value as f32).to_bits()
}

/// The binary32 number with these bits.
#[inline]
pub fn float(word: u32) -> f32 {
    f32::from_bits(word)
}

/// Refuses shapes for which `fits` is false.
///
/// # Errors
/// A message that names the first such shape, the generator, and what it fills instead: `wanted`.
pub fn every_shape(name: &str, shapes: &[Shape], wanted: &str, fits: impl Fn(&Shape) -> bool) -> Result<(), String> {
    match shapes.iter().find(|s| !fits(s)) {
        None => Ok(()),
        Some(shape) => Err(format!("generator `{name}` fills {wanted}, not {shape}")),
    }
}

/// True for `vec2`, `vec3`, `vec4` and arrays of them.
pub fn is_vector(shape: &Shape) -> bool {
    shape.scalar == Scalar::F32 && shape.columns == 1 && shape.rows >= 2
}

/// True for `mat4` and arrays of it.
pub fn is_mat4(shape: &Shape) -> bool {
    shape.element() == Shape::MAT4
}

#[cfg(test)]
mod tests;
