//! Uniform buffers for languages in which places follow from types alone.
//!
//! In std140 the elements of `uniform float w[4]` stand 16 bytes apart, and a structure is as long as a multiple of 16
//! bytes. WGSL and MSL lay out by the types of members, and naga writes `array<f32, 4>`, whose elements stand 4 bytes
//! apart: the same buffer would mean other numbers, or is refused. Here the buffer gets a type whose own layout is that
//! of std140: short elements become four-component vectors of which the first components count, other gaps are filled
//! with members. The entry point begins with a copy into private variables of the shader's own types.
//!
//! What needs none of this stays as it is: nothing stands behind the last member of a buffer, and naga itself fills the
//! gaps between members of a structure in MSL.

use naga::proc::Layouter;
use naga::valid::ModuleInfo;
use naga::{
    AddressSpace, ArraySize, BinaryOperator, Block, Expression, Function, GlobalVariable, Handle, Literal,
    LocalVariable, Module, Range, Scalar, Span, Statement, StructMember, SwizzleComponent, Type, TypeInner, VectorSize,
};

use super::{ProgramError, validate};

/// Short elements of an array that are put together in one expression.
const UNROLLED: u32 = 64;
/// Other elements that are copied one by one; longer arrays are copied in a loop.
const ONE_BY_ONE: u32 = 8;

/// Name of an element that has gaps behind it.
const ELEMENT: &str = "sc_element";

/// Who fills the gaps between the members of a structure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Gaps {
    /// The writer of the language, by the places that the module states.
    Writer,
    /// Nobody: a member stands at the next place that its type allows.
    Nobody,
}

/// A module that means the same where places follow from types. `None` when the given one does already.
pub(super) fn natural(
    module: &Module,
    entry_point: usize,
    gaps: Gaps,
) -> Result<Option<(Module, ModuleInfo)>, ProgramError> {
    let mut twins = Twins { module: module.clone(), layouter: Layouter::default(), gaps, loops: false };
    let mut copies = Vec::new();
    let uniforms: Vec<_> =
        module.global_variables.iter().filter(|(_, v)| v.space == AddressSpace::Uniform).map(|(h, _)| h).collect();
    for global in uniforms {
        let own = module.global_variables[global].ty;
        let ty = twins.whole(own)?;
        if ty != own {
            let variable = &mut twins.module.global_variables[global];
            let mut buffer = variable.clone();
            buffer.ty = ty;
            *variable = GlobalVariable { space: AddressSpace::Private, binding: None, ..variable.clone() };
            copies.push((twins.module.global_variables.append(buffer, Span::UNDEFINED), global));
        }
    }
    if copies.is_empty() {
        return Ok(None);
    }
    let word = twins.loops.then(|| twins.add(TypeInner::Scalar(Scalar::U32)));
    let mut module = twins.module;
    let mut function = std::mem::take(&mut module.entry_points[entry_point].function);
    let mut body = Copies { module: &module, function: &mut function, body: Block::new(), word };
    for (from, to) in copies {
        body.variable(from, to);
    }
    let mut body = body.body;
    body.extend_block(std::mem::take(&mut function.body));
    function.body = body;
    module.entry_points[entry_point].function = function;
    let info = validate(&module)?;
    Ok(Some((module, info)))
}

/// Types whose layout is their own.
struct Twins {
    module: Module,
    layouter: Layouter,
    gaps: Gaps,
    /// True once an array is copied in a loop.
    loops: bool,
}

impl Twins {
    fn add(&mut self, inner: TypeInner) -> Handle<Type> {
        self.module.types.insert(Type { name: None, inner }, Span::UNDEFINED)
    }

    /// Size and alignment where places follow from types.
    fn layout(&mut self, ty: Handle<Type>) -> Result<(u32, u32), ProgramError> {
        let update = self.layouter.update(self.module.to_ctx());
        update.map_err(|error| ProgramError::internal(format!("a type without a layout: {error}")))?;
        Ok((self.layouter[ty].size, self.layouter[ty].alignment.round_up(1)))
    }

    /// The type of a whole buffer. A host's buffer is as long as it is; behind the last member nothing is read.
    fn whole(&mut self, ty: Handle<Type>) -> Result<Handle<Type>, ProgramError> {
        match self.module.types[ty].clone() {
            Type { name, inner: TypeInner::Struct { members, span } } => {
                self.structure(ty, name, &members, span, false)
            }
            _ => self.twin(ty),
        }
    }

    /// The type itself, where it has that layout.
    fn twin(&mut self, ty: Handle<Type>) -> Result<Handle<Type>, ProgramError> {
        match self.module.types[ty].clone() {
            Type { inner: TypeInner::Array { base, size, stride }, .. } => {
                let element = self.element(base, stride)?;
                if element == base {
                    return Ok(ty);
                }
                let short = matches!(self.module.types[element].inner, TypeInner::Vector { .. });
                let most = if short { UNROLLED } else { ONE_BY_ONE };
                self.loops |= matches!(size, ArraySize::Constant(count) if count.get() > most);
                Ok(self.add(TypeInner::Array { base: element, size, stride }))
            }
            Type { name, inner: TypeInner::Struct { members, span } } => self.structure(ty, name, &members, span, true),
            _ => Ok(ty),
        }
    }

    /// The type of a structure, filled to its end or not.
    fn structure(
        &mut self,
        own: Handle<Type>,
        name: Option<String>,
        members: &[StructMember],
        span: u32,
        filled: bool,
    ) -> Result<Handle<Type>, ProgramError> {
        let padded = self.members(members, filled.then_some(span))?;
        if padded.len() == members.len() && padded.iter().zip(members).all(|(a, b)| a.ty == b.ty) {
            return Ok(own);
        }
        let name = name.map(|name| format!("{name}_padded"));
        let inner = TypeInner::Struct { members: padded, span };
        Ok(self.module.types.insert(Type { name, inner }, Span::UNDEFINED))
    }

    /// The type of elements that stand so far apart.
    fn element(&mut self, base: Handle<Type>, stride: u32) -> Result<Handle<Type>, ProgramError> {
        let element = self.twin(base)?;
        let (size, align) = self.layout(element)?;
        if size.next_multiple_of(align) == stride {
            return Ok(element);
        }
        match self.module.types[base].inner {
            TypeInner::Scalar(scalar) | TypeInner::Vector { size: VectorSize::Bi, scalar }
                if 4 * u32::from(scalar.width) == stride =>
            {
                Ok(self.add(TypeInner::Vector { size: VectorSize::Quad, scalar }))
            }
            _ => {
                let name = Some(ELEMENT.to_owned());
                let only = StructMember { name, ty: base, binding: None, offset: 0 };
                let members = self.members(&[only], Some(stride))?;
                Ok(self.add(TypeInner::Struct { members, span: stride }))
            }
        }
    }

    /// Members at the same places, with the gaps filled where nobody else does that: those between members, and the one
    /// up to the end where it is given.
    fn members(&mut self, members: &[StructMember], end: Option<u32>) -> Result<Vec<StructMember>, ProgramError> {
        let written = self.gaps == Gaps::Writer;
        let mut all: Vec<StructMember> = Vec::new();
        let fill = |twins: &mut Self, all: &mut Vec<StructMember>, from: u32, to: u32| {
            let word = twins.add(TypeInner::Scalar(Scalar::U32));
            for offset in (from.next_multiple_of(4)..to).step_by(4) {
                all.push(StructMember { name: Some(format!("sc_gap_{offset}")), ty: word, binding: None, offset });
            }
        };
        let (mut at, mut most) = (0_u32, 4);
        for member in members {
            let ty = self.twin(member.ty)?;
            let (size, align) = self.layout(ty)?;
            if !written && at.next_multiple_of(align) != member.offset {
                fill(self, &mut all, at, member.offset);
            }
            all.push(StructMember { ty, ..member.clone() });
            at = member.offset + size;
            most = most.max(align);
        }
        if let Some(end) = end.filter(|&end| !written && at.next_multiple_of(most) != end) {
            fill(self, &mut all, at, end);
        }
        Ok(all)
    }
}

/// Statements that copy buffers. They stand before all others, so that operands that are appended to the arena of
/// expressions are computed before they are used.
struct Copies<'a> {
    module: &'a Module,
    function: &'a mut Function,
    body: Block,
    /// The type of a counter, where there are loops.
    word: Option<Handle<Type>>,
}

/// A place, and what lies there.
type Placed = (Handle<Expression>, Handle<Type>);

impl Copies<'_> {
    fn variable(&mut self, from: Handle<GlobalVariable>, to: Handle<GlobalVariable>) {
        let ty = |handle: Handle<GlobalVariable>| self.module.global_variables[handle].ty;
        let (source, target) = (ty(from), ty(to));
        let from = self.name(Expression::GlobalVariable(from));
        let to = self.name(Expression::GlobalVariable(to));
        self.copy((from, source), (to, target));
    }

    fn copy(&mut self, (from, source): Placed, (to, target): Placed) {
        let module = self.module;
        let value = match (&module.types[target].inner, &module.types[source].inner) {
            _ if source == target => self.compute(Expression::Load { pointer: from }),
            (_, TypeInner::Struct { members, .. }) if members[0].name.as_deref() == Some(ELEMENT) => {
                let part = self.compute(Expression::AccessIndex { base: from, index: 0 });
                return self.copy((part, members[0].ty), (to, target));
            }
            (TypeInner::Struct { members, .. }, TypeInner::Struct { members: padded, .. }) => {
                for (index, member) in (0..).zip(members) {
                    let there = padded.iter().position(|p| p.offset == member.offset).unwrap_or(0);
                    let there = u32::try_from(there).unwrap_or(0);
                    let part = self.compute(Expression::AccessIndex { base: from, index: there });
                    let pointer = self.compute(Expression::AccessIndex { base: to, index });
                    self.copy((part, padded[there as usize].ty), (pointer, member.ty));
                }
                return;
            }
            (
                &TypeInner::Array { base, size: ArraySize::Constant(count), .. },
                &TypeInner::Array { base: element, .. },
            ) => {
                let count = count.get();
                match self.short(base, element) {
                    Some(components) if count <= UNROLLED => {
                        let parts = (0..count).map(|index| {
                            let pointer = self.compute(Expression::AccessIndex { base: from, index });
                            self.first(pointer, components)
                        });
                        let components = parts.collect();
                        self.compute(Expression::Compose { ty: target, components })
                    }
                    _ => {
                        self.elements((from, element), (to, base), count);
                        return;
                    }
                }
            }
            _ => {
                let components = self.short(target, source).unwrap_or(1);
                self.first(from, components)
            }
        };
        self.body.push(Statement::Store { pointer: to, value }, Span::UNDEFINED);
    }

    /// Components of a number or vector that is kept in a longer vector.
    fn short(&self, own: Handle<Type>, kept: Handle<Type>) -> Option<u32> {
        match (&self.module.types[own].inner, &self.module.types[kept].inner) {
            (TypeInner::Scalar(_), TypeInner::Vector { .. }) => Some(1),
            (TypeInner::Vector { size: VectorSize::Bi, .. }, TypeInner::Vector { size: VectorSize::Quad, .. }) => {
                Some(2)
            }
            _ => None,
        }
    }

    /// Copies an array, element by element.
    fn elements(&mut self, (from, source): Placed, (to, target): Placed, count: u32) {
        let Some(word) = self.word.filter(|_| count > ONE_BY_ONE) else {
            for index in 0..count {
                let part = self.compute(Expression::AccessIndex { base: from, index });
                let pointer = self.compute(Expression::AccessIndex { base: to, index });
                self.copy((part, source), (pointer, target));
            }
            return;
        };
        let variable = LocalVariable { name: Some("sc_index".to_owned()), ty: word, init: None };
        let counter = self.function.local_variables.append(variable, Span::UNDEFINED);
        let counter = self.name(Expression::LocalVariable(counter));
        let zero = self.name(Expression::Literal(Literal::U32(0)));
        self.body.push(Statement::Store { pointer: counter, value: zero }, Span::UNDEFINED);
        let before = std::mem::take(&mut self.body);
        let index = self.compute(Expression::Load { pointer: counter });
        let end = self.name(Expression::Literal(Literal::U32(count)));
        let condition = self.compute(Expression::Binary { op: BinaryOperator::GreaterEqual, left: index, right: end });
        let accept = Block::from_vec(vec![Statement::Break]);
        self.body.push(Statement::If { condition, accept, reject: Block::new() }, Span::UNDEFINED);
        let part = self.compute(Expression::Access { base: from, index });
        let pointer = self.compute(Expression::Access { base: to, index });
        self.copy((part, source), (pointer, target));
        let one = self.name(Expression::Literal(Literal::U32(1)));
        let next = self.compute(Expression::Binary { op: BinaryOperator::Add, left: index, right: one });
        self.body.push(Statement::Store { pointer: counter, value: next }, Span::UNDEFINED);
        let body = std::mem::replace(&mut self.body, before);
        self.body.push(Statement::Loop { body, continuing: Block::new(), break_if: None }, Span::UNDEFINED);
    }

    /// The first components of a vector.
    fn first(&mut self, pointer: Handle<Expression>, components: u32) -> Handle<Expression> {
        if components == 1 {
            let pointer = self.compute(Expression::AccessIndex { base: pointer, index: 0 });
            return self.compute(Expression::Load { pointer });
        }
        use SwizzleComponent::{X, Y};
        let vector = self.compute(Expression::Load { pointer });
        self.compute(Expression::Swizzle { size: VectorSize::Bi, vector, pattern: [X, Y, X, Y] })
    }

    fn name(&mut self, expression: Expression) -> Handle<Expression> {
        self.function.expressions.append(expression, Span::UNDEFINED)
    }

    fn compute(&mut self, expression: Expression) -> Handle<Expression> {
        let handle = self.name(expression);
        self.body.push(Statement::Emit(Range::new_from_bounds(handle, handle)), Span::UNDEFINED);
        handle
    }
}
