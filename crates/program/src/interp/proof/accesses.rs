//! Accesses to memory that invocations share: where they lead, and what is read.

use std::rc::Rc;

use number::linear::Polynomial;

use super::super::code::{File, Register};
use super::super::domain::Site;
use super::super::group::{Combine, Extent, MemoryAccess, MemoryOp, Space};
use super::phases::Lasts;
use super::values::Value;
use super::variables::{Fact, HALF, Meaning, Scope, WORD, Why};
use super::walk::Walk;
use crate::Written;

/// How a place is touched.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) enum Touched {
    Read,
    Write,
    AtomicRead,
    AtomicWrite,
    Update,
}

/// An index on the way to a place.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct SeenStep {
    pub index: Polynomial,
    pub stride: u32,
    pub len: Extent,
    pub site: Site,
}

/// An access.
#[derive(Clone, Debug)]
pub(super) struct Seen {
    pub memory: u32,
    pub offset: u32,
    pub steps: Vec<SeenStep>,
    /// Words behind the place.
    pub words: Vec<u32>,
    pub touched: Touched,
    pub path: Rc<Vec<Fact>>,
    /// The barriers before.
    pub lasts: Rc<Lasts>,
    pub site: Site,
}

impl Walk<'_> {
    /// A number of elements or texels.
    pub(super) fn extent(&mut self, memory: u32, of: Extent) -> Polynomial {
        match of {
            Extent::Fixed(len) => Polynomial::constant(i128::from(len)),
            Extent::Elements => {
                let least = i128::from(self.executable.written == Written::Wgsl);
                self.named(Meaning::Length(memory), Scope::Dispatch, (Some(least), Some(HALF - 1)))
            }
            Extent::Side(axis) => self.named(Meaning::Side(memory, axis), Scope::Dispatch, (Some(0), Some(HALF - 1))),
        }
    }

    pub(super) fn access(&mut self, access: &MemoryAccess) {
        let mut steps = Vec::new();
        for step in &access.steps {
            let index = self.number(step.reg);
            steps.push(SeenStep { index, stride: step.stride, len: step.len, site: step.site });
        }
        let touched = match (&access.op, access.atomic) {
            (MemoryOp::Load(_), false) => Touched::Read,
            (MemoryOp::Store(_), false) => Touched::Write,
            (MemoryOp::Load(_), true) => Touched::AtomicRead,
            (MemoryOp::Store(_), true) => Touched::AtomicWrite,
            (MemoryOp::Atomic { op: Combine::Exchange, compare: None, before: None, .. }, _) => Touched::AtomicWrite,
            (MemoryOp::Atomic { .. }, _) => Touched::Update,
        };
        let words = match &access.op {
            MemoryOp::Load(parts) | MemoryOp::Store(parts) => parts.iter().map(|(_, at)| *at).collect(),
            MemoryOp::Atomic { .. } => vec![0],
        };
        if self.silent == 0 {
            let shape = &self.executable.memories[access.memory as usize];
            // In the order of the kinds of memory that barriers order.
            let kind = match shape.space {
                Space::Workgroup => 0,
                _ if shape.is_image() => 2,
                _ => 1,
            };
            let (path, lasts) = (Rc::new(self.state.path.clone()), Rc::clone(&self.state.phases.of[kind]));
            let (memory, offset, site) = (access.memory, access.offset, access.site);
            let steps = steps.clone();
            self.accesses.push(Seen { memory, offset, steps, words, touched, path, lasts, site });
        }
        match &access.op {
            MemoryOp::Load(parts) => {
                let parts: Vec<(Register, u32)> =
                    parts.iter().filter(|(to, _)| to.file() == File::Word).copied().collect();
                for (to, at) in parts {
                    let value = self.loaded(access, &steps, to, at);
                    self.set(to.reg, value);
                }
            }
            MemoryOp::Store(_) => {}
            MemoryOp::Atomic { before, exchanged, .. } => {
                let why = Why::Atomic(access.memory);
                for reg in before.iter().filter(|to| to.file() == File::Word).map(|to| to.reg).chain(*exchanged) {
                    let value = self.open(why, Some(access.site), Scope::Invocation);
                    self.set(reg, value);
                }
            }
        }
    }

    /// What is read from memory: a number of the host where nothing writes it.
    fn loaded(&mut self, access: &MemoryAccess, steps: &[SeenStep], to: Register, at: u32) -> Value {
        use base::value::Scalar;
        let interval = match to.scalar {
            Scalar::Bool => (Some(0), Some(1)),
            Scalar::I32 => (Some(-HALF), Some(HALF - 1)),
            Scalar::U32 | Scalar::F32 => (Some(0), Some(WORD - 1)),
        };
        let shape = &self.executable.memories[access.memory as usize];
        let fixed = shape.space != Space::Workgroup && !shape.is_image() && !self.written.contains(&access.memory);
        let why = if access.atomic { Why::Atomic(access.memory) } else { Why::Data(access.memory) };
        let meaning = Meaning::Open(why, Some(access.site));
        let first = Polynomial::constant(i128::from(access.offset + at));
        let place = steps.iter().fold(first, |all, step| all.plus_times(&step.index, i128::from(step.stride)));
        let unknown = match place.as_constant().and_then(|place| u32::try_from(place).ok()) {
            _ if !fixed => self.variables.fresh(meaning, Scope::Invocation, interval),
            Some(word) => self.variables.named(Meaning::Host(access.memory, word), Scope::Dispatch, interval),
            None => {
                let (unknown, new) =
                    self.variables.derived(&format!("load {} {:?}", access.memory, to.scalar), &[&place], interval);
                if new {
                    let own = self.variables.get_mut(unknown);
                    (own.meaning, own.wide) = (meaning, true);
                }
                unknown
            }
        };
        Value::Number(Polynomial::unknown(unknown))
    }
}
