//! What is added to a module so that its outputs can be captured. Bodies stay as the translator made them, but for
//! the count of vertices and strips beside each `EmitVertex` and `EndPrimitive`. Uniform blocks may become storage buffers.

use std::collections::HashMap;

use ::spirv::{Capability, Decoration, ExecutionMode, Op, StorageClass};

use super::spirv::{HEADER, Reflection, Type, branches, instruction, instructions, parts};

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
            Self::Storage if written == StorageClass::Uniform as u32 => StorageClass::StorageBuffer as u32,
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
    let mut pass = CapturePass {
        out: words[..HEADER].to_vec(),
        next: words[3],
        known: HashMap::new(),
        reflection,
        capture,
        mark: None,
        decorated: false,
    };
    // Ids of what may be declared once are found first.
    for (op, operands) in instructions(words).map(parts) {
        if let (Op::TypeInt | Op::TypePointer | Op::TypeFloat, [id, rest @ ..]) = (op, operands) {
            pass.known.entry((op, rest.to_vec())).or_insert(*id);
        }
    }
    pass.add(Op::Capability, &[Capability::TransformFeedback as u32]);
    // The entry point names the mark before it is declared.
    let mark = capture.mark.map(|location| (pass.id(), location));
    let mut declared = false;
    for words in instructions(words) {
        let (op, operands) = parts(words);
        if (Op::TypeVoid..=Op::TypeForwardPointer).contains(&op) {
            pass.decorate(mark);
        }
        match (op, operands) {
            (Op::EntryPoint, &[_, function, ..]) => {
                let named: Vec<u32> = operands.iter().copied().chain(mark.map(|(id, _)| id)).collect();
                pass.add(op, &named);
                pass.add(Op::ExecutionMode, &[function, ExecutionMode::Xfb as u32]);
            }
            (Op::ExecutionMode, &[function, mode]) if capture.points && is_strip(mode) => {
                pass.add(op, &[function, ExecutionMode::OutputPoints as u32]);
            }
            (Op::TypePointer, &[id, storage, to]) => pass.add(op, &[id, capture.feed.storage(storage), to]),
            (Op::Variable, &[_, id, storage]) if storage == StorageClass::Output as u32 => {
                let start = pass.start(id);
                pass.add(op, &[operands, start.as_slice()].concat());
            }
            (Op::Variable, &[ty, id, storage]) => pass.add(op, &[ty, id, capture.feed.storage(storage)]),
            (Op::Function, _) => {
                if let (false, Some((id, _))) = (declared, mark) {
                    pass.declare(id);
                }
                declared = true;
                pass.out.extend(words);
            }
            (Op::EmitVertex | Op::EndPrimitive, _) => {
                pass.count(op == Op::EmitVertex);
                pass.out.extend(words);
            }
            _ => pass.out.extend(words),
        }
    }
    pass.out[3] = pass.next;
    pass.out
}

fn is_strip(mode: u32) -> bool {
    [ExecutionMode::OutputLineStrip, ExecutionMode::OutputTriangleStrip].iter().any(|&strip| mode == strip as u32)
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

struct CapturePass<'a> {
    out: Vec<u32>,
    next: u32,
    /// Declarations that may stand once, with their ids.
    known: HashMap<(Op, Vec<u32>), u32>,
    reflection: &'a Reflection,
    capture: &'a Capture,
    mark: Option<Mark>,
    decorated: bool,
}

impl CapturePass<'_> {
    fn id(&mut self) -> u32 {
        self.next += 1;
        self.next - 1
    }

    fn add(&mut self, op: Op, operands: &[u32]) {
        self.out.extend(instruction(op, operands));
    }

    /// The id of a type, which is declared here when it is not yet.
    fn ty(&mut self, op: Op, operands: &[u32]) -> u32 {
        let key = (op, operands.to_vec());
        if let Some(&id) = self.known.get(&key) {
            return id;
        }
        let id = self.id();
        self.add(op, &[&[id], operands].concat());
        self.known.insert(key, id);
        id
    }

    fn constant(&mut self, ty: u32, word: u32) -> u32 {
        let id = self.id();
        self.add(Op::Constant, &[ty, id, word]);
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
                    self.add(Op::MemberDecorate, &[ty, member, Decoration::Offset as u32, 4 * output.word]);
                }
                None => self.add(Op::Decorate, &[output.variable, Decoration::Offset as u32, 4 * output.word]),
            }
            if !variables.contains(&output.variable) {
                variables.push(output.variable);
            }
        }
        if let Some((id, location)) = mark {
            self.add(Op::Decorate, &[id, Decoration::Location as u32, location]);
            self.add(Op::Decorate, &[id, Decoration::Offset as u32, 4 * self.capture.words]);
            variables.push(id);
        }
        if self.capture.feed == Feed::Storage {
            for variable in self.reflection.of_storage(StorageClass::Uniform) {
                self.add(Op::Decorate, &[variable.id, Decoration::NonWritable as u32]);
            }
        }
        for id in variables {
            self.add(Op::Decorate, &[id, Decoration::XfbBuffer as u32, 0]);
            self.add(Op::Decorate, &[id, Decoration::XfbStride as u32, stride]);
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
                self.add(Op::ConstantNull, &[member, id]);
                parts.push(id);
            }
        }
        let id = self.id();
        self.add(Op::ConstantComposite, &[&[structure, id], &parts[..]].concat());
        Some(id)
    }

    fn sentinel(&mut self, ty: u32) -> Option<u32> {
        let key = (Op::ConstantComposite, vec![ty]);
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
        self.add(Op::ConstantComposite, &[vec![ty, id], vec![part; count as usize]].concat());
        self.known.insert(key, id);
        Some(id)
    }

    /// Declares the mark and what it is counted with.
    fn declare(&mut self, output: u32) {
        let uint = self.ty(Op::TypeInt, &[32, 0]);
        let private = self.ty(Op::TypePointer, &[StorageClass::Private as u32, uint]);
        let out = self.ty(Op::TypePointer, &[StorageClass::Output as u32, uint]);
        let (zero, one) = (self.constant(uint, 0), self.constant(uint, 1));
        let shift = self.constant(uint, VERTEX_BITS);
        let (vertex, strip) = (self.id(), self.id());
        self.add(Op::Variable, &[private, vertex, StorageClass::Private as u32, zero]);
        self.add(Op::Variable, &[private, strip, StorageClass::Private as u32, zero]);
        self.add(Op::Variable, &[out, output, StorageClass::Output as u32]);
        self.mark = Some(Mark { uint, output, vertex, strip, one, shift });
    }

    /// Counts a vertex, after marking it, or a strip.
    fn count(&mut self, emits: bool) {
        let Some(Mark { uint, output, vertex, strip, one, shift }) = self.mark else { return };
        let counter = if emits { vertex } else { strip };
        let (value, next) = (self.id(), self.id());
        self.add(Op::Load, &[uint, value, counter]);
        if emits {
            let (number, shifted, mark) = (self.id(), self.id(), self.id());
            self.add(Op::Load, &[uint, number, strip]);
            self.add(Op::ShiftLeftLogical, &[uint, shifted, number, shift]);
            self.add(Op::BitwiseOr, &[uint, mark, shifted, value]);
            self.add(Op::Store, &[output, mark]);
        }
        self.add(Op::IAdd, &[uint, next, value, one]);
        self.add(Op::Store, &[counter, next]);
    }
}
