//! What is added to a module so that its outputs can be captured. Bodies stay as the translator made them, but for
//! the count of vertices and strips beside each `EmitVertex` and `EndPrimitive`. Uniform blocks may become storage buffers.

use std::collections::HashMap;

use super::spirv::{HEADER, Reflection, Type, branches, decoration, instruction, instructions, op, storage};

/// Numbers of SPIR-V that are written here alone.
const CAPABILITY_TRANSFORM_FEEDBACK: u32 = 53;
const MODE_XFB: u32 = 11;
const MODE_OUTPUT_POINTS: u32 = 27;
const MODE_OUTPUT_LINE_STRIP: u32 = 28;
const MODE_OUTPUT_TRIANGLE_STRIP: u32 = 29;

/// Bits of a mark that hold the number of the vertex; the others hold that of the strip.
pub(super) const VERTEX_BITS: u32 = 16;

/// The buffers that uniform blocks are read from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Feed {
    /// Uniform buffers.
    Uniform,
    /// Storage buffers that are only read, with the same layout. Lavapipe writes the values of uniform buffers on which
    /// a branch depends into the shader as constants and compiles it anew whenever they change, which is for every case:
    /// 450 times for the short run of `skinning`, where a storage buffer takes one compilation.
    Storage,
}

impl Feed {
    /// What is best for a module.
    pub fn of(module: &[u32]) -> Self {
        if branches(module) { Self::Storage } else { Self::Uniform }
    }

    fn storage(self, written: u32) -> u32 {
        match self {
            Self::Storage if written == storage::UNIFORM => storage::STORAGE_BUFFER,
            Self::Uniform | Self::Storage => written,
        }
    }
}

/// An output that is captured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Captured {
    pub variable: u32,
    /// The structure and the member, for a member of a block.
    pub member: Option<(u32, u32)>,
    /// First word in a captured vertex.
    pub word: u32,
}

/// How a module is captured.
#[derive(Clone, Debug)]
pub(super) struct Capture {
    pub outputs: Vec<Captured>,
    /// Words of a captured vertex.
    pub words: u32,
    /// What outputs hold until the shader writes them.
    pub sentinel: u32,
    /// Location of an output behind the captured words with the numbers of vertex and strip, for a geometry stage.
    pub mark: Option<u32>,
    /// True to hand on emitted vertices one by one.
    pub points: bool,
    /// How uniform blocks are fed.
    pub feed: Feed,
}

/// The module with what captures it.
pub(super) fn insert(words: &[u32], reflection: &Reflection, capture: &Capture) -> Vec<u32> {
    let mut pass = Pass {
        out: words[..HEADER].to_vec(),
        next: words[3],
        known: HashMap::new(),
        reflection,
        capture,
        mark: None,
        decorated: false,
    };
    // Ids of what may be declared once are found first.
    for (opcode, operands) in instructions(words) {
        let key = match (opcode, operands) {
            (op::TYPE_INT, &[id, width, signed]) => Some((vec![opcode, width, signed], id)),
            (op::TYPE_POINTER, &[id, storage, to]) => Some((vec![opcode, storage, to], id)),
            (op::TYPE_FLOAT, &[id, width]) => Some((vec![opcode, width], id)),
            _ => None,
        };
        if let Some((key, id)) = key {
            pass.known.entry(key).or_insert(id);
        }
    }
    pass.out.extend(instruction(op::CAPABILITY, &[CAPABILITY_TRANSFORM_FEEDBACK]));
    // The entry point names the mark before it is declared.
    let mark = capture.mark.map(|location| (pass.id(), location));
    let mut declared = false;
    for (opcode, operands) in instructions(words) {
        match opcode {
            op::ENTRY_POINT => {
                let mut operands = operands.to_vec();
                operands.extend(mark.map(|(id, _)| id));
                pass.add(opcode, &operands);
                pass.add(op::EXECUTION_MODE, &[operands[1], MODE_XFB]);
            }
            op::EXECUTION_MODE if capture.points && is_strip(operands) => {
                pass.add(opcode, &[operands[0], MODE_OUTPUT_POINTS]);
            }
            op::TYPE_POINTER if operands.len() == 3 => {
                pass.decorate(mark);
                pass.add(opcode, &[operands[0], capture.feed.storage(operands[1]), operands[2]]);
            }
            19..=39 => {
                pass.decorate(mark);
                pass.add(opcode, operands);
            }
            op::VARIABLE if operands.len() == 3 && operands[2] == storage::UNIFORM => {
                pass.add(opcode, &[operands[0], operands[1], capture.feed.storage(operands[2])]);
            }
            op::VARIABLE if operands.len() == 3 && operands[2] == storage::OUTPUT => {
                let start = pass.start(operands[1]);
                pass.add(opcode, &[operands, start.as_slice()].concat());
            }
            op::FUNCTION => {
                if let (false, Some((id, _))) = (declared, mark) {
                    pass.declare(id);
                }
                declared = true;
                pass.add(opcode, operands);
            }
            op::EMIT_VERTEX | op::END_PRIMITIVE => {
                pass.count(opcode == op::EMIT_VERTEX);
                pass.add(opcode, operands);
            }
            _ => pass.add(opcode, operands),
        }
    }
    pass.out[3] = pass.next;
    pass.out
}

fn is_strip(mode: &[u32]) -> bool {
    matches!(mode, [_, MODE_OUTPUT_LINE_STRIP | MODE_OUTPUT_TRIANGLE_STRIP])
}

/// Variables by which vertices and strips are counted.
#[derive(Clone, Copy)]
struct Mark {
    uint: u32,
    output: u32,
    vertex: u32,
    strip: u32,
    one: u32,
    shift: u32,
}

struct Pass<'a> {
    out: Vec<u32>,
    next: u32,
    /// Declarations that may stand once, with their ids.
    known: HashMap<Vec<u32>, u32>,
    reflection: &'a Reflection,
    capture: &'a Capture,
    mark: Option<Mark>,
    decorated: bool,
}

impl Pass<'_> {
    fn id(&mut self) -> u32 {
        self.next += 1;
        self.next - 1
    }

    fn add(&mut self, opcode: u32, operands: &[u32]) {
        self.out.extend(instruction(opcode, operands));
    }

    /// The id of a type, which is declared here when it is not yet.
    fn ty(&mut self, opcode: u32, operands: &[u32]) -> u32 {
        let key = [&[opcode], operands].concat();
        if let Some(&id) = self.known.get(&key) {
            return id;
        }
        let id = self.id();
        self.add(opcode, &[&[id], operands].concat());
        self.known.insert(key, id);
        id
    }

    fn constant(&mut self, ty: u32, word: u32) -> u32 {
        let id = self.id();
        self.add(op::CONSTANT, &[ty, id, word]);
        id
    }

    /// Says once where each output goes.
    fn decorate(&mut self, mark: Option<(u32, u32)>) {
        if std::mem::replace(&mut self.decorated, true) {
            return;
        }
        let stride = 4 * (self.capture.words + u32::from(mark.is_some()));
        let mut variables = Vec::new();
        for output in &self.capture.outputs {
            match output.member {
                Some((ty, member)) => {
                    self.add(op::MEMBER_DECORATE, &[ty, member, decoration::OFFSET, 4 * output.word]);
                }
                None => self.add(op::DECORATE, &[output.variable, decoration::OFFSET, 4 * output.word]),
            }
            if !variables.contains(&output.variable) {
                variables.push(output.variable);
            }
        }
        if let Some((id, location)) = mark {
            self.add(op::DECORATE, &[id, decoration::LOCATION, location]);
            self.add(op::DECORATE, &[id, decoration::OFFSET, 4 * self.capture.words]);
            variables.push(id);
        }
        if self.capture.feed == Feed::Storage {
            for variable in self.reflection.of_storage(storage::UNIFORM) {
                self.add(op::DECORATE, &[variable.id, decoration::NON_WRITABLE]);
            }
        }
        for id in variables {
            self.add(op::DECORATE, &[id, decoration::XFB_BUFFER, 0]);
            self.add(op::DECORATE, &[id, decoration::XFB_STRIDE, stride]);
        }
    }

    /// What a captured variable holds at first: the sentinel, and zeros in members that are not captured.
    fn start(&mut self, variable: u32) -> Option<u32> {
        let reflection = self.reflection;
        let of = |output: &&Captured| output.variable == variable;
        let first = *self.capture.outputs.iter().find(of)?;
        let ty = reflection.variables.iter().find(|v| v.id == variable)?.ty;
        let Some((structure, _)) = first.member else { return self.sentinel(ty) };
        let Some(Type::Struct(members)) = reflection.types.get(&structure) else { return None };
        let all = self.capture.outputs.iter().filter(of).filter_map(|o| o.member).map(|(_, member)| member);
        let captured: Vec<u32> = all.collect();
        let mut parts = Vec::new();
        for (&member, k) in members.iter().zip(0..) {
            if captured.contains(&k) {
                parts.push(self.sentinel(member)?);
            } else {
                let id = self.id();
                self.add(op::CONSTANT_NULL, &[member, id]);
                parts.push(id);
            }
        }
        let id = self.id();
        self.add(op::CONSTANT_COMPOSITE, &[&[structure, id], &parts[..]].concat());
        Some(id)
    }

    fn sentinel(&mut self, ty: u32) -> Option<u32> {
        let key = vec![op::CONSTANT_COMPOSITE, ty];
        if let Some(&known) = self.known.get(&key) {
            return Some(known);
        }
        let (part, count) = match *self.reflection.types.get(&ty)? {
            Type::Number => {
                let id = self.constant(ty, self.capture.sentinel);
                self.known.insert(key, id);
                return Some(id);
            }
            Type::Vector { component: part, count }
            | Type::Matrix { column: part, count }
            | Type::Array { element: part, count } => (part, count),
            Type::Bool | Type::Struct(_) | Type::Pointer { .. } => return None,
        };
        let part = self.sentinel(part)?;
        let id = self.id();
        self.add(op::CONSTANT_COMPOSITE, &[vec![ty, id], vec![part; count as usize]].concat());
        self.known.insert(key, id);
        Some(id)
    }

    /// Declares the mark and what it is counted with.
    fn declare(&mut self, output: u32) {
        let uint = self.ty(op::TYPE_INT, &[32, 0]);
        let private = self.ty(op::TYPE_POINTER, &[storage::PRIVATE, uint]);
        let out = self.ty(op::TYPE_POINTER, &[storage::OUTPUT, uint]);
        let (zero, one) = (self.constant(uint, 0), self.constant(uint, 1));
        let shift = self.constant(uint, VERTEX_BITS);
        let (vertex, strip) = (self.id(), self.id());
        self.add(op::VARIABLE, &[private, vertex, storage::PRIVATE, zero]);
        self.add(op::VARIABLE, &[private, strip, storage::PRIVATE, zero]);
        self.add(op::VARIABLE, &[out, output, storage::OUTPUT]);
        self.mark = Some(Mark { uint, output, vertex, strip, one, shift });
    }

    /// Counts a vertex, after marking it, or a strip.
    fn count(&mut self, emits: bool) {
        let Some(Mark { uint, output, vertex, strip, one, shift }) = self.mark else { return };
        let counter = if emits { vertex } else { strip };
        let (value, next) = (self.id(), self.id());
        self.add(op::LOAD, &[uint, value, counter]);
        if emits {
            let (number, shifted, mark) = (self.id(), self.id(), self.id());
            self.add(op::LOAD, &[uint, number, strip]);
            self.add(op::SHIFT_LEFT, &[uint, shifted, number, shift]);
            self.add(op::BITWISE_OR, &[uint, mark, shifted, value]);
            self.add(op::STORE, &[output, mark]);
        }
        self.add(op::I_ADD, &[uint, next, value, one]);
        self.add(op::STORE, &[counter, next]);
    }
}
