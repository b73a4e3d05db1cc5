//! Expressions.

use std::rc::Rc;

use naga::{AddressSpace, Arena, Expression, Handle, Literal, RelationalFunction};

use super::super::code::{Inst, Register, Word2};
use super::super::domain::{Class, Site};
use super::wide::{is_wide, words};
use super::{Compiler, Evaluated, Frame, InterpError, Pointer, types, unsupported};
use crate::Manner;
use base::value::Scalar;

impl<'m> Compiler<'m> {
    /// The value of an expression, which has been emitted or needs no emission.
    pub(super) fn value(
        &mut self,
        frame: &mut Frame<'m>,
        handle: Handle<Expression>,
    ) -> Result<Evaluated, InterpError> {
        if let Some(value) = frame.values.get(&handle) {
            return Ok(value.clone());
        }
        let value = self.expression(frame, handle)?;
        frame.values.insert(handle, value.clone());
        Ok(value)
    }

    /// The scalars of an expression.
    pub(super) fn registers(
        &mut self,
        frame: &mut Frame<'m>,
        handle: Handle<Expression>,
    ) -> Result<Rc<[Register]>, InterpError> {
        match self.value(frame, handle)? {
            Evaluated::Registers(registers) => Ok(registers),
            Evaluated::Pointer(_) => Err(InterpError::internal("a pointer where a value is needed".to_owned())),
            Evaluated::Image(_) => Err(InterpError::internal("a texture where a value is needed".to_owned())),
        }
    }

    /// The only scalar of an expression.
    pub(super) fn single(
        &mut self,
        frame: &mut Frame<'m>,
        handle: Handle<Expression>,
    ) -> Result<Register, InterpError> {
        match *self.registers(frame, handle)? {
            [register] => Ok(register),
            ref registers => Err(InterpError::internal(format!("{} numbers where one is needed", registers.len()))),
        }
    }

    pub(super) fn pointer(
        &mut self,
        frame: &mut Frame<'m>,
        handle: Handle<Expression>,
    ) -> Result<Pointer, InterpError> {
        match self.value(frame, handle)? {
            Evaluated::Pointer(pointer) => Ok(pointer),
            Evaluated::Registers(_) | Evaluated::Image(_) => {
                Err(InterpError::internal("a value where a pointer is needed".to_owned()))
            }
        }
    }

    pub(super) fn expression(
        &mut self,
        frame: &mut Frame<'m>,
        handle: Handle<Expression>,
    ) -> Result<Evaluated, InterpError> {
        let span = frame.function.expressions.get_span(handle);
        let refuse = |what: &str| Err(unsupported(what.to_owned(), span));
        let site = self.site(frame, handle);
        // Whole numbers of 16 bits are loaded, stored and converted; operations keep 32 bits.
        let numbers = self.numbers(frame, handle);
        let short = numbers.is_some_and(|s| s.width == 2 && s != naga::Scalar::F16);
        let passes = |expression: &Expression| {
            use Expression as E;
            matches!(
                expression,
                E::Load { .. } | E::As { convert: Some(_), .. } | E::Access { .. } | E::AccessIndex { .. }
            ) || matches!(expression, E::Compose { .. } | E::Splat { .. } | E::Swizzle { .. } | E::GlobalVariable(_))
        };
        if short && !passes(&frame.function.expressions[handle]) {
            return refuse("16-bit integers");
        }
        let registers: Vec<Register> = match frame.function.expressions[handle] {
            Expression::Literal(literal) => self.literal(literal, Some(site), span)?,
            Expression::Constant(constant) => self.constant_expression(self.module.constants[constant].init)?,
            Expression::Override(value) => {
                let value = &self.module.overrides[value];
                match value.init {
                    Some(init) => self.constant_expression(init)?,
                    None => return refuse("pipeline constants without a value"),
                }
            }
            Expression::ZeroValue(ty) => self.zero_value(ty, span)?,
            Expression::Compose { ref components, .. } => {
                let mut all = Vec::new();
                for &component in components {
                    all.extend(self.registers(frame, component)?.iter().copied());
                }
                all
            }
            Expression::Access { base, index } => return self.element(frame, site, base, index),
            Expression::AccessIndex { base, index } => return self.part(frame, base, index),
            Expression::Splat { size, value } => self.registers(frame, value)?.repeat(size as usize),
            Expression::Swizzle { size, vector, pattern } => {
                let vector = self.registers(frame, vector)?;
                let words = words(numbers);
                let component = |&of: &naga::SwizzleComponent| &vector[of as usize * words..(of as usize + 1) * words];
                pattern[..size as usize].iter().flat_map(component).copied().collect()
            }
            Expression::FunctionArgument(index) => {
                let argument = frame.arguments.get(index as usize).cloned();
                return argument.ok_or_else(|| InterpError::internal(format!("there is no argument {index}")));
            }
            // Textures and samplers are looked at where they are used.
            Expression::GlobalVariable(global)
                if self.module.global_variables[global].space == AddressSpace::Handle =>
            {
                return Ok(Evaluated::Image(global));
            }
            Expression::GlobalVariable(global) if self.subject.shared.contains(&global) => {
                return Ok(self.shared(global));
            }
            Expression::GlobalVariable(global) => {
                let constant = self.module.global_variables[global].space == AddressSpace::Uniform;
                return Ok(Self::whole(self.global(global)?, constant));
            }
            Expression::LocalVariable(local) => {
                let registers = frame.locals.get(&local).cloned();
                let registers =
                    registers.ok_or_else(|| InterpError::internal("a variable of another function".to_owned()))?;
                return Ok(Self::whole(registers, false));
            }
            Expression::Load { pointer } => self.loaded(frame, site, pointer, span)?,
            Expression::Unary { op, expr } => self.unary_operator(frame, site, op, expr)?,
            Expression::Binary { op, left, right } => self.binary_operator(frame, site, op, left, right)?,
            Expression::Select { condition, accept, reject } => {
                let condition = self.registers(frame, condition)?;
                let (accept, reject) = (self.registers(frame, accept)?, self.registers(frame, reject)?);
                let words = words(numbers);
                let condition = |k: usize| if condition.len() == 1 { condition[0] } else { condition[k / words] };
                let pairs = accept.iter().zip(reject.iter()).enumerate();
                pairs.map(|(k, (&accept, &reject))| self.select(condition(k), accept, reject)).collect()
            }
            Expression::Relational { fun, argument } => self.relational(frame, site, fun, argument)?,
            Expression::Math { fun, arg, arg1, arg2, arg3 } => {
                let mut args = Vec::new();
                for handle in [Some(arg), arg1, arg2, arg3].into_iter().flatten() {
                    args.push(self.registers(frame, handle)?);
                }
                let inner = frame.info[arg].ty.inner_with(&self.module.types).clone();
                if is_wide(inner.scalar()) {
                    self.wide_function(site, fun, &args, &inner, span)?
                } else {
                    self.math(site, fun, &args, &inner, span)?
                }
            }
            Expression::As { expr, kind, convert } => self.cast(frame, site, expr, kind, convert)?,
            Expression::CallResult(_) => return Err(InterpError::internal("the result of a later call".to_owned())),
            // What a texture unit computes has nothing to do with the precision of a sampler: its results have.
            Expression::ImageSample { .. } => {
                let texels = self.image_sample(frame, site.done(Manner::default()), handle, span)?;
                self.narrowed(site, &texels)
            }
            Expression::ImageLoad { .. } => {
                let texels = self.image_load(frame, site.done(Manner::default()), handle, span)?;
                self.narrowed(site, &texels)
            }
            Expression::ImageQuery { image, query } => self.image_query(frame, site, image, query, span)?,
            Expression::Derivative { .. } => return refuse("derivatives between fragments"),
            Expression::AtomicResult { .. } | Expression::WorkGroupUniformLoadResult { .. } => {
                return Err(InterpError::internal("the result of a later statement".to_owned()));
            }
            Expression::ArrayLength(array) => vec![self.array_length(frame, array, span)?],
            Expression::RayQueryVertexPositions { .. }
            | Expression::RayQueryProceedResult
            | Expression::RayQueryGetIntersection { .. } => return refuse("ray queries"),
            Expression::SubgroupBallotResult | Expression::SubgroupOperationResult { .. } => {
                return Err(InterpError::internal("the result of a later statement".to_owned()));
            }
            Expression::CooperativeLoad { .. } | Expression::CooperativeMultiplyAdd { .. } => {
                return refuse("cooperative matrices");
            }
        };
        Ok(Evaluated::Registers(registers.into()))
    }

    /// What a pointer leads to.
    fn loaded(
        &mut self,
        frame: &mut Frame<'m>,
        site: Site,
        pointer: Handle<Expression>,
        span: naga::Span,
    ) -> Result<Vec<Register>, InterpError> {
        let inner = self.pointee(frame, pointer);
        let place = self.pointer(frame, pointer)?;
        let loaded = if place.memory.is_some() {
            self.load_shared(site, &place, &inner).map_err(|what| unsupported(what, span))?
        } else {
            let len = types::count(self.module, &inner).map_err(|what| unsupported(what, span))?;
            self.load(frame, site, &place, len)?
        };
        Ok(self.narrowed(site, &loaded))
    }

    fn literal(
        &mut self,
        literal: Literal,
        site: Option<Site>,
        span: naga::Span,
    ) -> Result<Vec<Register>, InterpError> {
        let wide = |what: &str| Err(unsupported(what.to_owned(), span));
        let register = match literal {
            Literal::F32(value) => self.real(value, site),
            Literal::U32(value) => self.word(value, Scalar::U32),
            Literal::I32(value) => self.word(value.cast_unsigned(), Scalar::I32),
            Literal::Bool(value) => self.word(u32::from(value), Scalar::Bool),
            Literal::F64(_) => return wide("64-bit floats"),
            Literal::F16(value) => self.real(value.to_f32(), site),
            Literal::U16(_) | Literal::I16(_) => return wide("16-bit integers"),
            Literal::U64(value) => return Ok(self.wide_number(value)),
            Literal::I64(value) => return Ok(self.wide_number(value.cast_unsigned())),
            Literal::AbstractInt(_) | Literal::AbstractFloat(_) => return wide("numbers of abstract type"),
        };
        Ok(vec![register])
    }

    fn zero_value(&mut self, ty: Handle<naga::Type>, span: naga::Span) -> Result<Vec<Register>, InterpError> {
        let scalars = types::scalars(self.module, &self.module.types[ty].inner);
        let scalars = scalars.map_err(|what| unsupported(what, span))?;
        Ok(scalars.into_iter().map(|scalar| self.zero(scalar)).collect())
    }

    /// The scalars of an expression of the module, which is constant.
    pub(super) fn constant_expression(&mut self, handle: Handle<Expression>) -> Result<Vec<Register>, InterpError> {
        let arena: &Arena<Expression> = &self.module.global_expressions;
        let span = arena.get_span(handle);
        Ok(match arena[handle] {
            Expression::Literal(literal) => {
                let site = self.constant_site(handle, span);
                self.literal(literal, Some(site), span)?
            }
            Expression::Constant(constant) => self.constant_expression(self.module.constants[constant].init)?,
            Expression::ZeroValue(ty) => self.zero_value(ty, span)?,
            Expression::Compose { ref components, .. } => {
                let mut all = Vec::new();
                for &component in components {
                    all.extend(self.constant_expression(component)?);
                }
                all
            }
            Expression::Splat { size, value } => {
                let registers = self.constant_expression(value)?;
                std::iter::repeat_n(registers, size as usize).flatten().collect()
            }
            Expression::Swizzle { size, vector, pattern } => {
                let vector = self.constant_expression(vector)?;
                // Which halves belong together the registers do not say.
                if vector.len() > 4 {
                    return Err(unsupported("constants of 64-bit integers".to_owned(), span));
                }
                pattern[..size as usize].iter().map(|&component| vector[component as usize]).collect()
            }
            Expression::Override(value) => match self.module.overrides[value].init {
                Some(init) => self.constant_expression(init)?,
                None => return Err(unsupported("pipeline constants without a value".to_owned(), span)),
            },
            // naga evaluates all other constant expressions itself.
            ref other => return Err(unsupported(format!("constants computed by {}", name_of(other)), span)),
        })
    }

    pub(super) fn select(&mut self, condition: Register, accept: Register, reject: Register) -> Register {
        if let Some(known) = self.number(condition.reg) {
            return if known != 0 { accept } else { reject };
        }
        let to = Register { reg: self.temporary(), ..accept };
        self.push(Inst::Select { to, condition: condition.reg, accept: accept.reg, reject: reject.reg });
        to
    }

    fn relational(
        &mut self,
        frame: &mut Frame<'m>,
        site: Site,
        fun: RelationalFunction,
        argument: Handle<Expression>,
    ) -> Result<Vec<Register>, InterpError> {
        let registers = self.registers(frame, argument)?;
        let fold = |this: &mut Self, op: Word2| {
            let mut registers = registers.iter().copied();
            let first = registers.next();
            first
                .map(|first| registers.fold(first, |a, b| this.word2(site, op, a, b, Scalar::Bool)))
                .into_iter()
                .collect()
        };
        let classify = |this: &mut Self, class: Class| {
            let mut all = Vec::new();
            for register in registers.iter() {
                let to = this.temporary();
                this.push(Inst::Classify { class, to, a: register.reg, site });
                all.push(Register { scalar: Scalar::Bool, reg: to });
            }
            all
        };
        Ok(match fun {
            RelationalFunction::All => fold(self, Word2::And),
            RelationalFunction::Any => fold(self, Word2::Or),
            RelationalFunction::IsNan => classify(self, Class::Nan),
            RelationalFunction::IsInf => classify(self, Class::Infinite),
        })
    }
}

fn name_of(expression: &Expression) -> String {
    let text = format!("{expression:?}");
    let end = text.find(|c: char| !c.is_alphanumeric()).unwrap_or(text.len());
    format!("`{}`", &text[..end])
}
