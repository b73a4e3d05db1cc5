//! The ways in which a kernel gets its inputs.

use naga::{
    AddressSpace, ArraySize, BinaryOperator, Binding, BuiltIn, EntryPoint, Expression, FunctionArgument,
    FunctionResult, GlobalVariable, Handle, Module, ResourceBinding, ShaderStage, Span, Statement, StorageAccess, Type,
    TypeInner, VectorSize,
};

use super::builder::{Builder, add_global};
use super::compute::{Harness, entry_point, param, scaled};
use super::vertex::{Attribute, UniformBlock, UniformPlace};
use super::words::{Supply, WordsAt};
use super::{ENTRY_POINT, Form, WORKGROUP, binding};
use crate::Program;
use base::value::{Batch, Field, Record, Scalar, Shape};

type Expr = Handle<Expression>;

/// Where inputs come from.
#[derive(Clone, Copy, Debug)]
pub(super) enum Feed<'a> {
    /// Storage buffers.
    Storage,
    /// A uniform buffer for each invocation.
    Uniforms,
    /// Literals.
    Constants(&'a Batch),
    /// Vertex attributes, and a uniform buffer for each case.
    Attributes,
}

/// What is in the module for it.
pub(super) struct Feeding<'a> {
    feed: Feed<'a>,
    invocations: Option<Handle<GlobalVariable>>,
    cases: Option<Handle<GlobalVariable>>,
    /// A uniform array of `vec4<u32>`.
    block: Option<Handle<GlobalVariable>>,
    invocation_words: usize,
    case_words: usize,
    attributes: Vec<Attribute>,
    /// First word of each attribute, and its argument.
    arguments: Vec<(u32, u32)>,
    types: Vec<Handle<Type>>,
}

impl<'a> Feeding<'a> {
    pub(super) fn insert(program: &Program, module: &mut Module, harness: &Harness, feed: Feed<'a>) -> Self {
        let (invocation_words, case_words) = (program.invocation_record().words(), program.case_record().words());
        let mut this = Self {
            feed,
            invocations: None,
            cases: None,
            block: None,
            invocation_words,
            case_words,
            attributes: Vec::new(),
            arguments: Vec::new(),
            types: Vec::new(),
        };
        match feed {
            Feed::Storage => {
                let read = AddressSpace::Storage { access: StorageAccess::LOAD };
                let at = |binding| Some(ResourceBinding { group: 0, binding });
                // No buffer for what the program does not take: translators drop some of the unused ones and not others.
                let mut words_of = |name: &str, binding: u32, words: usize| {
                    (words > 0).then(|| add_global(module, name, read, at(binding), harness.types.words))
                };
                this.invocations = words_of("sc_invocations", binding::INVOCATIONS, invocation_words);
                this.cases = words_of("sc_cases", binding::CASES, case_words);
            }
            Feed::Constants(_) => {}
            Feed::Uniforms => {
                let at = ResourceBinding { group: 0, binding: binding::BLOCK };
                this.block = Some(block(module, harness, 1 + invocation_words + case_words, at));
            }
            Feed::Attributes => {
                if case_words > 0 {
                    this.block = Some(block(module, harness, case_words, ResourceBinding { group: 1, binding: 0 }));
                }
                let mut first = 0;
                for (k, field) in leaves(&program.invocation_record()).into_iter().enumerate() {
                    let k = k as u32;
                    this.types
                        .push(module.types.insert(Type { name: None, inner: inner(field.shape) }, Span::UNDEFINED));
                    this.arguments.push((first, k));
                    first += field.shape.words() as u32;
                    this.attributes.push(Attribute { components: field.shape.rows, field, location: k });
                }
            }
        }
        this
    }

    /// Index of the invocation.
    pub(super) fn index(&self, b: &mut Builder) -> Expr {
        match self.feed {
            Feed::Storage | Feed::Constants(_) => {
                let id = b.argument(0);
                b.member(id, 0)
            }
            Feed::Uniforms => match self.block {
                Some(block) => {
                    let array = b.global(block);
                    let vector = b.member(array, 0);
                    let word = b.member(vector, 0);
                    b.load(word)
                }
                None => b.u32(0),
            },
            Feed::Attributes => b.argument(self.attributes.len() as u32),
        }
    }

    /// The words of the uniforms; `None` when there are none.
    pub(super) fn case(&self, b: &mut Builder, harness: &Harness, index: Expr, sample: usize) -> Option<Supply<'a>> {
        if self.case_words == 0 {
            return None;
        }
        Some(match self.feed {
            Feed::Storage => {
                let per_case = param(b, harness, 1);
                let case = b.binary(BinaryOperator::Divide, index, per_case);
                let array = b.global(self.cases?);
                Supply::Storage(WordsAt { array, base: scaled(b, case, self.case_words) })
            }
            Feed::Constants(batch) => Supply::Literals(batch.case_of(sample)),
            Feed::Uniforms => Supply::Block { array: b.global(self.block?), first: (1 + self.invocation_words) as u32 },
            Feed::Attributes => Supply::Block { array: b.global(self.block?), first: 0 },
        })
    }

    /// The words of the inputs; `None` when there are none.
    pub(super) fn invocation(&self, b: &mut Builder, index: Expr, sample: usize) -> Option<Supply<'_>> {
        if self.invocation_words == 0 {
            return None;
        }
        Some(match self.feed {
            Feed::Storage => {
                let base = scaled(b, index, self.invocation_words);
                Supply::Storage(WordsAt { array: b.global(self.invocations?), base })
            }
            Feed::Constants(batch) => Supply::Literals(batch.invocation(sample)),
            Feed::Uniforms => Supply::Block { array: b.global(self.block?), first: 1 },
            Feed::Attributes => Supply::Arguments(&self.arguments),
        })
    }

    /// Runs `body` once for each sample whose inputs are in the module: once where none are.
    pub(super) fn each(&self, b: &mut Builder, index: Expr, body: &mut impl FnMut(&mut Builder, usize)) {
        let Feed::Constants(batch) = self.feed else { return body(b, 0) };
        for sample in 0..batch.invocation_count() {
            let number = b.u32(sample as u32);
            let this = b.binary(BinaryOperator::Equal, index, number);
            b.when(this, |b| body(b, sample));
        }
    }

    /// Ends the entry point.
    pub(super) fn entry_point(&self, mut b: Builder, harness: &Harness) -> EntryPoint {
        let Feed::Attributes = self.feed else {
            let argument = FunctionArgument {
                name: Some("id".to_owned()),
                ty: harness.types.uvec3,
                binding: Some(Binding::BuiltIn(BuiltIn::GlobalInvocationId)),
            };
            let size = if matches!(self.feed, Feed::Uniforms) { 1 } else { WORKGROUP };
            return entry_point(ShaderStage::Compute, [size, 1, 1], b.finish(ENTRY_POINT, vec![argument], None));
        };
        let attribute = |(attribute, ty): (&Attribute, &Handle<Type>)| FunctionArgument {
            name: Some(format!("sc_in{}", attribute.location)),
            ty: *ty,
            binding: Some(Binding::Location {
                location: attribute.location,
                interpolation: None,
                sampling: None,
                blend_src: None,
                per_primitive: false,
            }),
        };
        let mut arguments: Vec<_> = self.attributes.iter().zip(&self.types).map(attribute).collect();
        arguments.push(FunctionArgument {
            name: Some("sc_index".to_owned()),
            ty: harness.types.u32,
            binding: Some(Binding::BuiltIn(BuiltIn::VertexIndex)),
        });
        // Nothing is drawn: every vertex leaves at the same place.
        let zero = b.name(Expression::ZeroValue(harness.types.vec4));
        b.statement(Statement::Return { value: Some(zero) });
        let position = Binding::BuiltIn(BuiltIn::Position { invariant: false });
        let result = FunctionResult { ty: harness.types.vec4, binding: Some(position) };
        entry_point(ShaderStage::Vertex, [0; 3], b.finish(ENTRY_POINT, arguments, Some(result)))
    }

    /// What one invocation gets: where attributes are fed, each vector by itself.
    pub(super) fn record(&self, program: &Program) -> Record {
        match self.feed {
            Feed::Attributes => Record::new(self.attributes.iter().map(|a| a.field.clone()).collect()),
            Feed::Storage | Feed::Uniforms | Feed::Constants(_) => program.invocation_record(),
        }
    }

    /// How the kernel runs.
    pub(super) fn form(&self) -> Form {
        match self.feed {
            Feed::Storage => Form::Compute,
            Feed::Uniforms => Form::Uniforms,
            Feed::Constants(_) => Form::Constants,
            Feed::Attributes => {
                let places = (0..self.case_words as u32).map(|word| UniformPlace { word, byte: 4 * word }).collect();
                let bytes = 4 * self.case_words.next_multiple_of(4) as u32;
                let blocks = if self.case_words > 0 { vec![UniformBlock { bytes, places }] } else { Vec::new() };
                Form::Vertex { attributes: self.attributes.clone(), blocks, drawn: Vec::new() }
            }
        }
    }
}

/// A uniform array of `vec4<u32>` with room for so many words.
fn block(module: &mut Module, harness: &Harness, words: usize, at: ResourceBinding) -> Handle<GlobalVariable> {
    let count = std::num::NonZeroU32::new(words.div_ceil(4) as u32).unwrap_or(std::num::NonZeroU32::MIN);
    let inner = TypeInner::Array { base: harness.types.uvec4, size: ArraySize::Constant(count), stride: 16 };
    let ty = module.types.insert(Type { name: None, inner }, Span::UNDEFINED);
    add_global(module, "sc_block", AddressSpace::Uniform, Some(at), ty)
}

/// The numbers and vectors of a record: matrices column by column, arrays element by element.
fn leaves(record: &Record) -> Vec<Field> {
    let mut all = Vec::new();
    for field in record.fields() {
        let shape = field.shape;
        let count = shape.elements() * usize::from(shape.columns);
        for k in 0..count {
            let name = if count == 1 { field.name.clone() } else { format!("{}[{k}]", field.name) };
            all.push(Field { name, shape: Shape::vector(shape.scalar, shape.rows) });
        }
    }
    all
}

/// The type of an attribute.
fn inner(shape: Shape) -> TypeInner {
    let scalar = match shape.scalar {
        Scalar::F32 => naga::Scalar::F32,
        Scalar::I32 => naga::Scalar::I32,
        // There are no attributes of truth values.
        Scalar::U32 | Scalar::Bool => naga::Scalar::U32,
    };
    let size = match shape.rows {
        1 => return TypeInner::Scalar(scalar),
        2 => VectorSize::Bi,
        3 => VectorSize::Tri,
        _ => VectorSize::Quad,
    };
    TypeInner::Vector { size, scalar }
}
