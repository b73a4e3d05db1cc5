//! Pointers: loads, stores and indices.

use std::rc::Rc;

use naga::{Expression, Handle, TypeInner};

use super::super::code::{Choice, Inst, Register, Stray, Word2};
use super::super::domain::Site;
use super::{Compiler, Evaluated, Frame, Index, InterpError, Pointer, types, unsupported};
use base::value::Scalar;

/// Places among which one load or store can choose.
const MAX_CHOICES: usize = 1 << 12;

impl<'m> Compiler<'m> {
    pub(super) fn load(
        &mut self,
        frame: &Frame<'m>,
        site: Site,
        pointer: &Pointer,
        len: usize,
    ) -> Result<Vec<Register>, InterpError> {
        if pointer.indices.is_empty() {
            let registers = pointer.variable.get(pointer.offset..pointer.offset + len);
            let registers = registers.ok_or_else(|| InterpError::internal("a load behind its variable".to_owned()))?;
            if pointer.constant {
                return Ok(registers.to_vec());
            }
            let mut loaded = Vec::with_capacity(len);
            for &register in registers {
                let reg = match self.known.get(&super::key(register)) {
                    Some(&reg) => reg,
                    None => {
                        if let Some(&kind) = self.unset.get(&super::key(register))
                            && !self.assigned.contains(&super::key(register))
                        {
                            self.push(Inst::Read { from: register, kind, site });
                        }
                        let to = Register { reg: self.temporary(), ..register };
                        self.push(Inst::Copy { to, from: register.reg });
                        self.known.insert(super::key(register), to.reg);
                        to.reg
                    }
                };
                loaded.push(Register { reg, ..register });
            }
            return Ok(loaded);
        }
        let (index, choices) = self.choices(frame, pointer, len)?;
        let choices: Vec<Choice> = choices
            .into_iter()
            .map(|of| {
                let scalar = of[0].scalar;
                Choice {
                    one: Register { scalar, reg: self.temporary() },
                    of: of.iter().map(|register| register.reg).collect(),
                }
            })
            .collect();
        let loaded = choices.iter().map(|choice| choice.one).collect();
        let unset =
            pointer.variable.iter().any(|register| self.unset.contains_key(&super::key(*register))).then_some(site);
        let strays = pointer.indices.iter().map(|step| step.stray).collect();
        self.push(Inst::Gather { index, choices, strays, unset });
        Ok(loaded)
    }

    pub(super) fn store(
        &mut self,
        frame: &Frame<'m>,
        pointer: &Pointer,
        value: &[Register],
    ) -> Result<(), InterpError> {
        if pointer.indices.is_empty() {
            let registers = pointer.variable.get(pointer.offset..pointer.offset + value.len());
            let registers = registers.ok_or_else(|| InterpError::internal("a store behind its variable".to_owned()))?;
            for (&to, from) in registers.to_vec().iter().zip(value) {
                self.push(Inst::Store { to, from: from.reg });
                // Whoever gets here by this way reads what was just written.
                self.known.insert(super::key(to), from.reg);
                self.assigned.insert(super::key(to));
            }
            return Ok(());
        }
        let (index, choices) = self.choices(frame, pointer, value.len())?;
        let choices: Vec<Choice> = choices
            .into_iter()
            .zip(value)
            .map(|(of, one)| {
                of.iter().for_each(|register| {
                    self.known.remove(&super::key(*register));
                });
                Choice { one: *one, of: of.iter().map(|register| register.reg).collect() }
            })
            .collect();
        let strays = pointer.indices.iter().map(|step| step.stray).collect();
        self.push(Inst::Scatter { index, choices, strays });
        Ok(())
    }

    /// One index for all dynamic ones, and for each scalar of the value the places that it selects among.
    fn choices(
        &mut self,
        frame: &Frame<'m>,
        pointer: &Pointer,
        len: usize,
    ) -> Result<(u32, Vec<Vec<Register>>), InterpError> {
        let site = Site::new(0);
        let mut offsets = vec![0];
        let mut index: Option<u32> = None;
        for step in &pointer.indices {
            if offsets.len() * step.len > MAX_CHOICES {
                return Err(unsupported(format!("an index into more than {MAX_CHOICES} places"), frame.span));
            }
            offsets =
                offsets.iter().flat_map(|&at| (0..step.len).map(move |k| at + k * step.stride)).collect::<Vec<_>>();
            index = Some(match index {
                None => step.reg,
                Some(outer) => {
                    let len = self.word(step.len as u32, Scalar::U32).reg;
                    let (product, sum) = (self.temporary(), self.temporary());
                    self.push(Inst::Word2 { op: Word2::MultiplyUnsigned, to: product, a: outer, b: len, site });
                    self.push(Inst::Word2 { op: Word2::AddUnsigned, to: sum, a: product, b: step.reg, site });
                    sum
                }
            });
        }
        let behind = || InterpError::internal("an index behind its variable".to_owned());
        let choices = (0..len)
            .map(|k| {
                let places = offsets.iter().map(|at| pointer.variable.get(pointer.offset + at + k).copied());
                places.collect::<Option<Vec<Register>>>().filter(|of| !of.is_empty()).ok_or_else(behind)
            })
            .collect::<Result<Vec<_>, _>>()?;
        Ok((index.ok_or_else(behind)?, choices))
    }

    /// A part of a pointer or value with a known index.
    pub(super) fn part(
        &mut self,
        frame: &mut Frame<'m>,
        base: Handle<Expression>,
        index: u32,
    ) -> Result<Evaluated, InterpError> {
        let value = self.value(frame, base)?;
        let inner = self.pointee(frame, base);
        if let Evaluated::Pointer(pointer @ Pointer { memory: Some(_), .. }) = &value {
            return self.shared_part(frame, pointer, base, &inner, index);
        }
        let part = types::part(self.module, &inner, index);
        let (at, len) = part.ok_or_else(|| unsupported("this kind of access".to_owned(), frame.span))?;
        Ok(match value {
            Evaluated::Registers(registers) => Evaluated::Registers(registers[at..at + len].into()),
            Evaluated::Pointer(pointer) => Evaluated::Pointer(Pointer { offset: pointer.offset + at, ..pointer }),
            Evaluated::Image(_) => return Err(unsupported("this kind of access".to_owned(), frame.span)),
        })
    }

    /// A part of a pointer or value with an index of each slot's own.
    pub(super) fn element(
        &mut self,
        frame: &mut Frame<'m>,
        site: Site,
        base: Handle<Expression>,
        index: Handle<Expression>,
    ) -> Result<Evaluated, InterpError> {
        let value = self.value(frame, base)?;
        let index = self.single(frame, index)?.reg;
        let inner = self.pointee(frame, base);
        if let Evaluated::Pointer(pointer @ Pointer { memory: Some(_), .. }) = &value {
            return Self::shared_element(self.module, frame, pointer, &inner, index, site);
        }
        let elements = types::elements(self.module, &inner);
        let (stride, len) = elements.ok_or_else(|| unsupported("this kind of access".to_owned(), frame.span))?;
        if let Some(at) = self.number(index).map(|at| at as usize).filter(|&at| at < len) {
            return Ok(match value {
                Evaluated::Registers(registers) => {
                    Evaluated::Registers(registers[at * stride..(at + 1) * stride].into())
                }
                Evaluated::Pointer(pointer) => {
                    Evaluated::Pointer(Pointer { offset: pointer.offset + at * stride, ..pointer })
                }
                Evaluated::Image(image) => Evaluated::Image(image),
            });
        }
        let b = self.word(len as u32, Scalar::U32).reg;
        let reg = self.temporary();
        self.push(Inst::Word2 { op: Word2::Index, to: reg, a: index, b, site });
        let stray = Stray { reg: index, len: len as u32, site };
        let step = Index { reg, stride, len, stray };
        Ok(match value {
            Evaluated::Registers(variable) => {
                let pointer = Pointer { variable, constant: true, offset: 0, indices: vec![step], memory: None };
                Evaluated::Registers(self.load(frame, site, &pointer, stride)?.into())
            }
            Evaluated::Pointer(mut pointer) => {
                pointer.indices.push(step);
                Evaluated::Pointer(pointer)
            }
            Evaluated::Image(image) => Evaluated::Image(image),
        })
    }

    /// The type of the numbers that a value is made of; none for a structure or an array.
    pub(super) fn numbers(&self, frame: &Frame<'m>, handle: Handle<Expression>) -> Option<naga::Scalar> {
        frame.info[handle].ty.inner_with(&self.module.types).scalar()
    }

    /// The type of an expression, or of what it points to.
    pub(super) fn pointee(&self, frame: &Frame<'m>, handle: Handle<Expression>) -> TypeInner {
        match *frame.info[handle].ty.inner_with(&self.module.types) {
            TypeInner::Pointer { base, .. } => self.module.types[base].inner.clone(),
            TypeInner::ValuePointer { size: Some(size), scalar, .. } => TypeInner::Vector { size, scalar },
            TypeInner::ValuePointer { size: None, scalar, .. } => TypeInner::Scalar(scalar),
            ref inner => inner.clone(),
        }
    }

    pub(super) fn whole(variable: Rc<[Register]>, constant: bool) -> Evaluated {
        Evaluated::Pointer(Pointer { variable, constant, offset: 0, indices: Vec::new(), memory: None })
    }
}
