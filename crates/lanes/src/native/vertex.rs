//! The author's vertex stage, fed by location and captured by transform feedback.

use std::ops::Range;
use std::rc::Rc;

use ash::vk;

use super::Job;
use super::capture::{self, Capture, Feed};
use super::draw::{DrawAttribute, Drawn, Draws, Pass, Setting};
use super::gpu::Gpu;
use super::interface;
use super::records::Records;
use super::spirv::Reflection;
use crate::{Actual, LaneError, Marks, Runner};
use base::value::{Batch, Scalar};
use program::{self, Count, OutputLayout};

/// Words of all captured vertices of a batch: 64 MiB.
const CAPTURED: usize = 1 << 24;
/// Most vertices of a batch that are draws of their own.
const DRAWS: usize = 1 << 14;

pub(super) struct VertexRunner {
    draws: Draws,
    layout: OutputLayout,
    /// For each word of the vertex buffer, the word of the invocation record that it holds.
    fed: Vec<usize>,
    /// Where the stage reads numbers of the draw.
    numbers: Option<DrawNumbers>,
    /// Words of records that the words of a captured vertex fill, in order.
    filled: Vec<Range<usize>>,
    sentinel: u32,
    capacity: usize,
}

/// The format of an attribute of so many components.
pub(super) fn format(scalar: Scalar, components: u8) -> vk::Format {
    let of = |formats: [vk::Format; 4]| formats[usize::from(components.clamp(1, 4)) - 1];
    match scalar {
        Scalar::F32 => of([
            vk::Format::R32_SFLOAT,
            vk::Format::R32G32_SFLOAT,
            vk::Format::R32G32B32_SFLOAT,
            vk::Format::R32G32B32A32_SFLOAT,
        ]),
        Scalar::I32 => of([
            vk::Format::R32_SINT,
            vk::Format::R32G32_SINT,
            vk::Format::R32G32B32_SINT,
            vk::Format::R32G32B32A32_SINT,
        ]),
        // GLSL has no attributes of truth values.
        Scalar::U32 | Scalar::Bool => of([
            vk::Format::R32_UINT,
            vk::Format::R32G32_UINT,
            vk::Format::R32G32B32_UINT,
            vk::Format::R32G32B32A32_UINT,
        ]),
    }
}

impl VertexRunner {
    pub fn new(
        gpu: &Rc<Gpu>,
        job: &Job,
        (attributes, drawn): (&[program::Attribute], &[program::Drawn]),
        capacity: usize,
    ) -> Result<Self, LaneError> {
        let reflection = Reflection::of(&job.module);
        let numbers = DrawNumbers::new(drawn)?;
        let (mut described, mut fed) = (Vec::new(), Vec::new());
        for (k, attribute) in attributes.iter().enumerate() {
            let Some(location) = interface::location(&reflection, &attribute.field)? else { continue };
            let start = job.invocation.range(k).start;
            if attribute.components > attribute.field.shape.rows {
                let (many, name, shape) = (attribute.components, &attribute.field.name, attribute.field.shape);
                return Err(LaneError::Unsupported(format!(
                    "{many} components for attribute `{name}` of type `{shape}`"
                )));
            }
            let format = format(attribute.field.shape.scalar, attribute.components);
            described.push(DrawAttribute { location, format, words: u32::from(attribute.components) });
            fed.extend((0..usize::from(attribute.components)).map(|c| start + c));
        }
        if described.len() != interface::located_inputs(&reflection) {
            return Err(LaneError::Unsupported("an input of the stage that is in no record".to_owned()));
        }
        let outputs = interface::outputs(&reflection, &job.captured)?;
        let (captured, filled): (Vec<_>, Vec<_>) = outputs.into_iter().unzip();
        let size: usize = filled.iter().map(Range::len).sum();
        if size == 0 {
            return Err(LaneError::Unsupported("a stage that writes no output".to_owned()));
        }
        let feed = Feed::of(&job.module);
        let sentinel = Marks::random().sentinel;
        let capture = Capture { outputs: captured, words: size as u32, sentinel, mark: None, points: false, feed };
        let module = capture::insert(&job.module, &reflection, &capture);
        let capacity = capacity.min(CAPTURED / size.max(fed.len())).max(1);
        let blocks = interface::blocks(&reflection, &job.case)?;
        let bytes: usize = blocks.iter().map(|block| block.bytes as usize + 256).sum();
        let capacity = capacity.min((4 * CAPTURED / bytes.max(1)).max(1));
        let alone = !drawn.is_empty();
        let capacity = if alone { capacity.min(DRAWS) } else { capacity };
        let (stage, topology) = (vk::ShaderStageFlags::VERTEX, vk::PrimitiveTopology::POINT_LIST);
        let most = (capacity, capacity);
        let setting = Setting { attributes: &described, topology, blocks, feed, stage, most, alone };
        let mut draws = Draws::new(gpu, setting)?;
        let pass = Pass { modules: &[(stage, &module)], words: size, most: capacity, counted: 1 };
        draws.add(&pass)?;
        Ok(Self {
            draws,
            layout: job.output.clone(),
            fed,
            numbers: alone.then_some(numbers),
            filled,
            sentinel,
            capacity,
        })
    }
}

impl Runner for VertexRunner {
    fn capacity(&self) -> usize {
        self.capacity
    }

    fn run(&mut self, batch: &Batch) -> Result<Actual, LaneError> {
        let count = self.count_of(batch, "vertices")?;
        let fed = &self.fed;
        self.draws.upload((0..count).flat_map(|i| fed.iter().map(move |&k| batch.invocation(i)[k])), batch);
        let per_case = batch.per_case;
        let draws: Vec<Drawn> = match &self.numbers {
            Some(numbers) => {
                let alone = |k: usize| -> Result<Drawn, LaneError> {
                    let numbers = Some(numbers.of(batch.invocation(k)).map_err(LaneError::Unsupported)?);
                    Ok(Drawn { case: k / per_case.max(1), first: k, count: 1, numbers })
                };
                (0..count).map(alone).collect::<Result<_, _>>()?
            }
            None if self.draws.is_uniform() => vec![Drawn { case: 0, first: 0, count, numbers: None }],
            None => {
                let drawn = |case: usize| Drawn { case, first: case * per_case, count: per_case, numbers: None };
                (0..batch.case_count()).map(drawn).collect()
            }
        };
        let marks = Marks { sentinel: self.sentinel, ..Marks::random() };
        let blank = Marks::blank(marks.sentinel);
        let counts = self.draws.run(0, &draws, false, blank)?.first().copied().unwrap_or_default();
        if counts.written < count as u64 {
            let invocation = counts.written as usize;
            let (found, expected) = (marks.sentinel, marks.canary ^ invocation as u32);
            return Err(LaneError::NotWritten { invocation, count, found, expected });
        }
        if counts.needed != count as u64 || counts.written != counts.needed {
            let (written, needed) = (counts.written, counts.needed);
            return Err(LaneError::Api(format!(
                "{count} vertices drawn, {needed} captured, {written} of them written"
            )));
        }
        if let Some(invocation) = self.draws.unwritten(0, count, blank)? {
            let (found, expected) = (blank, marks.canary ^ invocation as u32);
            return Err(LaneError::NotWritten { invocation, count, found, expected });
        }
        let mut records = Records::new(&self.layout, count, marks);
        for (invocation, captured) in self.draws.captured(0).take(count).enumerate() {
            if let Some(words) = records.vertex(invocation, 0, 0) {
                place(words, &self.filled, captured);
            }
            records.end(invocation, 1, 0);
        }
        records.accept()
    }
}

/// How a vertex is drawn so that the stage reads the numbers of its sample.
struct DrawNumbers {
    vertex: Option<program::Drawn>,
    instance: Option<program::Drawn>,
    /// What each of these draws has as 0.
    zero: Vec<program::Drawn>,
}

impl DrawNumbers {
    /// # Errors
    /// [`LaneError::Unsupported`] by name for numbers that are one and the same in a draw of one vertex.
    fn new(drawn: &[program::Drawn]) -> Result<Self, LaneError> {
        let of = |counts: [Count; 2]| -> Result<Option<program::Drawn>, LaneError> {
            let found: Vec<&program::Drawn> = drawn.iter().filter(|d| counts.contains(&d.count)).collect();
            match found[..] {
                [one, other, ..] => Err(LaneError::Unsupported(format!(
                    "`{}` and `{}` cannot be set apart on this lane, which draws one vertex at a time",
                    one.name, other.name
                ))),
                [one] => Ok(Some(one.clone())),
                [] => Ok(None),
            }
        };
        let vertex = of([Count::Vertex, Count::BaseVertex])?;
        let instance = of([Count::Instance, Count::BaseInstance])?;
        let zero = drawn.iter().filter(|d| d.count == Count::Draw).cloned().collect();
        Ok(Self { vertex, instance, zero })
    }

    /// First vertex and first instance for an invocation.
    fn of(&self, invocation: &[u32]) -> Result<(u32, u32), String> {
        self.zero.iter().try_for_each(|drawn| drawn.must_be_zero(invocation))?;
        let of = |drawn: &Option<program::Drawn>| drawn.as_ref().map_or(Ok(0), |drawn| drawn.of(invocation));
        Ok((of(&self.vertex)?, of(&self.instance)?))
    }
}

/// Puts the words of a captured vertex where the record has them.
pub(super) fn place(words: &mut [u32], filled: &[Range<usize>], captured: &[u32]) {
    let mut at = 0;
    for range in filled {
        words[range.clone()].copy_from_slice(&captured[at..][..range.len()]);
        at += range.len();
    }
}
