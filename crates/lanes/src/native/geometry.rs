//! The author's geometry stage behind a vertex stage that hands on what it is fed.
//!
//! It runs twice: once with the output primitive that the author wrote, and once handing on every emitted vertex as a
//! point. The second shows each `EmitVertex`, the first what the device makes of the strips.

use std::fmt::Write as _;
use std::ops::Range;
use std::rc::Rc;

use ash::vk;

use super::Job;
use super::capture::{self, Capture, Feed, VERTEX_BITS};
use super::draw::{DrawAttribute, Drawn, Draws, Pass, PrimitiveCounts, Setting};
use super::gpu::Gpu;
use super::interface;
use super::records::Records;
use super::spirv::Reflection;
use super::vertex::{format, place};
use crate::strips::{Begin, are_cut_from, joined};
use crate::{Actual, LaneError, Marks, Runner};
use base::value::{Batch, Record, Scalar};
use program::{OutputLayout, Primitives};

/// Words of all captured vertices of a batch: 64 MiB.
const CAPTURED: usize = 1 << 24;
/// Most primitives of a batch: each is a draw that is counted by itself.
const MOST: usize = 1 << 14;

/// Which pass is which.
const POINTS: usize = 0;
const STRIPS: usize = 1;

pub(super) struct GeometryRunner {
    draws: Draws,
    layout: OutputLayout,
    /// For each word of the vertex buffer of a primitive, the word of the invocation record that it holds.
    fed: Vec<usize>,
    filled: Vec<Range<usize>>,
    input: usize,
    /// Vertices of a primitive of the output: 1 to 3.
    corners: usize,
    sentinel: u32,
    capacity: usize,
}

/// The inputs of a geometry stage, and the vertex stage in front of it.
struct Front {
    attributes: Vec<DrawAttribute>,
    fed: Vec<usize>,
    text: String,
}

impl Front {
    fn new(reflection: &Reflection, record: &Record, vertices: usize) -> Result<Self, LaneError> {
        let (mut attributes, mut fed) = (Vec::new(), vec![Vec::new(); vertices]);
        let (mut heads, mut body) = (String::new(), String::new());
        let (mut next, mut located) = (0, 0);
        for (index, field) in record.fields().iter().enumerate() {
            let built_in = ["gl_Position", "gl_PointSize"].contains(&field.name.as_str());
            let element = base::value::Shape { array: None, ..field.shape };
            let out = if built_in {
                None
            } else {
                let Some(location) = interface::location(reflection, field)? else { continue };
                located += 1;
                Some(location)
            };
            if field.shape.array != Some(vertices as u32) || element.scalar == Scalar::Bool {
                return Err(LaneError::Unsupported(format!("input `{}` of type `{}`", field.name, field.shape)));
            }
            let _ = writeln!(heads, "layout(location = {next}) in {element} a{index};");
            match out {
                None => {
                    let _ = writeln!(body, "    {} = a{index};", field.name);
                }
                Some(location) => {
                    let _ = writeln!(heads, "layout(location = {location}) out {element} b{index};");
                    let _ = writeln!(body, "    b{index} = a{index};");
                }
            }
            for column in 0..u32::from(element.columns) {
                let format = format(element.scalar, element.rows);
                attributes.push(DrawAttribute { location: next + column, format, words: u32::from(element.rows) });
            }
            next += u32::from(element.columns);
            let words: Vec<usize> = record.range(index).collect();
            for (vertex, words) in words.chunks_exact(element.words()).enumerate() {
                fed[vertex].extend(words);
            }
        }
        if located != interface::located_inputs(reflection) {
            return Err(LaneError::Unsupported("an input of the stage that is in no record".to_owned()));
        }
        let text = format!("#version 450\n{heads}void main() {{\n{body}}}\n");
        Ok(Self { attributes, fed: fed.concat(), text })
    }
}

/// The text of the vertex stage in front of a geometry stage.
///
/// # Errors
/// [`LaneError::Unsupported`] for inputs that cannot be handed on.
pub(super) fn front(module: &[u32], record: &Record, primitives: Primitives) -> Result<String, LaneError> {
    let reflection = Reflection::of(module);
    if interface::reads_primitive_id(&reflection) {
        let what = "`gl_PrimitiveIDIn` cannot be set on this lane, where each primitive is drawn by itself";
        return Err(LaneError::Unsupported(what.to_owned()));
    }
    Front::new(&reflection, record, primitives.input_vertices() as usize).map(|front| front.text)
}

/// The list of the API whose primitives have so many vertices.
fn topology(input: usize) -> vk::PrimitiveTopology {
    match input {
        1 => vk::PrimitiveTopology::POINT_LIST,
        2 => vk::PrimitiveTopology::LINE_LIST,
        3 => vk::PrimitiveTopology::TRIANGLE_LIST,
        4 => vk::PrimitiveTopology::LINE_LIST_WITH_ADJACENCY,
        _ => vk::PrimitiveTopology::TRIANGLE_LIST_WITH_ADJACENCY,
    }
}

impl GeometryRunner {
    pub fn new(
        gpu: &Rc<Gpu>,
        vertex: &[u32],
        job: &Job,
        primitives: Primitives,
        capacity: usize,
    ) -> Result<Self, LaneError> {
        let (input, corners) = (primitives.input_vertices() as usize, primitives.output.corners());
        let most = primitives.max_vertices.max(1) as usize;
        let reflection = Reflection::of(&job.module);
        let front = Front::new(&reflection, &job.invocation, input)?;
        let outputs = interface::outputs(&reflection, &job.output.vertex)?;
        let (captured, filled): (Vec<_>, Vec<_>) = outputs.into_iter().unzip();
        let size: usize = filled.iter().map(Range::len).sum::<usize>() + 1;
        let limits = &gpu.limits;
        let total = limits.max_geometry_total_output_components as usize;
        let refuse = |what: String| Err(LaneError::Unsupported(what));
        if most > limits.max_geometry_output_vertices as usize || most >> VERTEX_BITS != 0 {
            return refuse(format!("max_vertices = {most}; the device takes {}", limits.max_geometry_output_vertices));
        }
        if most * size > total {
            return refuse(format!("{most} vertices with {size} components each; the device takes {total} in all"));
        }
        let feed = Feed::of(&job.module);
        let sentinel = Marks::random().sentinel;
        let mark = Some(interface::free_location(&reflection));
        let capture = Capture { outputs: captured, words: size as u32 - 1, sentinel, mark, points: true, feed };
        let room = (most * corners).max(1);
        let blocks = interface::blocks(&reflection, &job.case)?;
        let bytes: usize = blocks.iter().map(|block| block.bytes as usize + 256).sum();
        let fit = (CAPTURED / (room * size)).min(CAPTURED / front.fed.len().max(1)).min(4 * CAPTURED / bytes.max(1));
        let capacity = capacity.min(fit).clamp(1, MOST);
        let stage = vk::ShaderStageFlags::GEOMETRY;
        let topology = topology(input);
        let setting = Setting {
            attributes: &front.attributes,
            topology,
            blocks,
            feed,
            stage,
            most: (capacity * input, capacity),
            alone: false,
        };
        let mut draws = Draws::new(gpu, setting)?;
        let passes: &[bool] = if corners == 1 { &[true] } else { &[true, false] };
        for &points in passes {
            let module = capture::insert(&job.module, &reflection, &Capture { points, ..capture.clone() });
            let modules = [(vk::ShaderStageFlags::VERTEX, vertex), (stage, &module[..])];
            let most = capacity * if points { most } else { room };
            draws.add(&Pass { modules: &modules, words: size, most, counted: capacity })?;
        }
        Ok(Self { draws, layout: job.output.clone(), fed: front.fed, filled, input, corners, sentinel, capacity })
    }
}

impl GeometryRunner {
    /// Proves that what the device counted was written in this run.
    fn written(
        &mut self,
        pass: usize,
        counts: &[PrimitiveCounts],
        corners: usize,
        marks: Marks,
        blank: u32,
    ) -> Result<(), LaneError> {
        let vertices = |counts: &[PrimitiveCounts]| counts.iter().map(|c| c.written as usize * corners).sum::<usize>();
        let Some(vertex) = self.draws.unwritten(pass, vertices(counts), blank)? else { return Ok(()) };
        let invocation = (1..=counts.len()).find(|&k| vertices(&counts[..k]) > vertex).map_or(0, |k| k - 1);
        let (found, expected) = (blank, marks.canary ^ invocation as u32);
        Err(LaneError::NotWritten { invocation, count: counts.len(), found, expected })
    }
}

impl Runner for GeometryRunner {
    fn capacity(&self) -> usize {
        self.capacity
    }

    fn run(&mut self, batch: &Batch) -> Result<Actual, LaneError> {
        let count = self.count_of(batch, "primitives")?;
        let fed = &self.fed;
        self.draws.upload((0..count).flat_map(|i| fed.iter().map(move |&k| batch.invocation(i)[k])), batch);
        let input = self.input;
        let drawn = |i: usize| Drawn { case: i / batch.per_case.max(1), first: i * input, count: input, numbers: None };
        let draws: Vec<Drawn> = (0..count).map(drawn).collect();
        let marks = Marks { sentinel: self.sentinel, ..Marks::random() };
        let blank = Marks::blank(marks.sentinel);
        let points = self.draws.run(POINTS, &draws, true, blank)?;
        whole(&points)?;
        self.written(POINTS, &points, 1, marks, blank)?;
        let mut emitted: Vec<u32> = Vec::new();
        let size = self.filled.iter().map(Range::len).sum::<usize>() + 1;
        let total: u64 = points.iter().map(|c| c.written).sum();
        for captured in self.draws.captured(POINTS).take(total as usize) {
            emitted.extend(captured);
        }
        let mut emitted = emitted.chunks_exact(size);
        let strips = if self.corners > 1 { self.draws.run(STRIPS, &draws, true, blank)? } else { Vec::new() };
        whole(&strips)?;
        if self.corners > 1 {
            self.written(STRIPS, &strips, self.corners, marks, blank)?;
        }
        let (corners, filled) = (self.corners, &self.filled);
        let mut records = Records::new(&self.layout, count, marks);
        let mut primitives = (corners > 1).then(|| self.draws.captured(STRIPS));
        for invocation in 0..count {
            let vertices: Vec<&[u32]> = emitted.by_ref().take(points[invocation].written as usize).collect();
            let number = strips.get(invocation).map_or(0, |c| c.written as usize);
            let cut: Vec<&[u32]> = primitives.as_mut().map_or_else(Vec::new, |p| p.take(number * corners).collect());
            one(&mut records, invocation, corners, filled, &vertices, &cut);
        }
        records.accept()
    }
}

/// An error when primitives did not fit: there is room for what the stage may emit.
fn whole(counts: &[PrimitiveCounts]) -> Result<(), LaneError> {
    match counts.iter().position(|c| c.written != c.needed) {
        None => Ok(()),
        Some(k) => {
            let PrimitiveCounts { written, needed } = counts[k];
            Err(LaneError::Api(format!("primitive {k} gives {needed} primitives, and {written} of them are captured")))
        }
    }
}

/// The number of a captured vertex among those of its primitive, and that of its strip.
fn marked(vertex: &[u32]) -> (usize, u32) {
    let mark = vertex.last().copied().unwrap_or(u32::MAX);
    ((mark & ((1 << VERTEX_BITS) - 1)) as usize, mark >> VERTEX_BITS)
}

/// Puts together the record of one input primitive from its emitted vertices and the primitives that were cut from
/// their strips, `corners` vertices each.
fn one(
    records: &mut Records<'_>,
    invocation: usize,
    corners: usize,
    filled: &[Range<usize>],
    vertices: &[&[u32]],
    cut: &[&[u32]],
) {
    let numbers: Vec<u32> = vertices.iter().map(|v| marked(v).1).collect();
    let captured = cut.len() / corners;
    let in_order = vertices.iter().enumerate().all(|(k, v)| marked(v).0 == k);
    let is = |(primitive, corner): (usize, usize), vertex: usize| cut[primitive * corners + corner] == vertices[vertex];
    let agrees = corners == 1 || are_cut_from(corners, &numbers, captured, is);
    // Where the two passes do not tell the same, the strips of the device count: they are what a host gets.
    let found: Vec<(&[u32], u32)> = if in_order && agrees {
        vertices.iter().copied().zip(numbers).collect()
    } else {
        let at = |(primitive, corner): (usize, usize)| cut[primitive * corners + corner];
        let same = |a, b| marked(at(a)).0 == marked(at(b)).0;
        joined(corners, captured, Begin::Any, same).into_iter().map(|(corner, strip)| (at(corner), strip)).collect()
    };
    for (vertex, (words, strip)) in found.iter().enumerate() {
        if let Some(record) = records.vertex(invocation, vertex, *strip) {
            place(record, filled, words);
        }
    }
    let ended = found.last().map_or(0, |(_, strip)| strip + 1);
    records.end(invocation, found.len() as u32, ended);
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use base::value::{Field, Shape};

    fn record(vertices: &[[u32; 2]], cut: &[[u32; 2]]) -> Vec<(u32, u32)> {
        let vertex = Record::new(vec![Field { name: "d".into(), shape: Shape::FLOAT }]);
        let layout = OutputLayout { vertex: Arc::new(vertex), max_vertices: Some(6) };
        let mut records = Records::new(&layout, 1, Marks::random());
        let refs = |from: &[[u32; 2]]| from.iter().map(|v| v.to_vec()).collect::<Vec<_>>();
        let (vertices, cut) = (refs(vertices), refs(cut));
        let (vertices, cut): (Vec<&[u32]>, Vec<&[u32]>) =
            (vertices.iter().map(Vec::as_slice).collect(), cut.iter().map(Vec::as_slice).collect());
        one(&mut records, 0, 2, std::slice::from_ref(&(0..1)), &vertices, &cut);
        let actual = records.accept().unwrap();
        (0..actual.stored(0)).map(|v| (actual.vertex(0, v)[0], actual.strip(0, v))).collect()
    }

    /// A captured vertex: its value, and its mark.
    fn v(value: u32, number: u32, strip: u32) -> [u32; 2] {
        [value, number | strip << VERTEX_BITS]
    }

    #[test]
    fn vertices_keep_the_strips_that_the_shader_counted() {
        // Equal vertices: only the marks tell that there are two strips, and a vertex alone is in no line.
        let emitted = [v(7, 0, 0), v(7, 1, 0), v(7, 2, 1), v(7, 3, 1), v(9, 4, 2)];
        let lines = [v(7, 0, 0), v(7, 1, 0), v(7, 2, 1), v(7, 3, 1)];
        assert_eq!(record(&emitted, &lines), [(7, 0), (7, 0), (7, 1), (7, 1), (9, 2)]);
    }

    #[test]
    fn a_line_that_the_device_drops_or_adds_shows_in_the_record() {
        let emitted = [v(1, 0, 0), v(2, 1, 0), v(3, 2, 0)];
        assert_eq!(record(&emitted, &[v(1, 0, 0), v(2, 1, 0)]), [(1, 0), (2, 0)]);
        let joined = [v(1, 0, 0), v(2, 1, 0), v(2, 1, 0), v(3, 2, 0)];
        assert_eq!(record(&emitted, &joined), [(1, 0), (2, 0), (3, 0)]);
        let apart = [v(1, 0, 0), v(2, 1, 1), v(3, 2, 1)];
        assert_eq!(record(&apart, &joined), [(1, 0), (2, 0), (3, 0)]);
    }
}
