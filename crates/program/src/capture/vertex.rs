//! The vertex kernel: a real vertex stage with vertex buffers and uniform buffers that writes its
//! outputs to storage, one record per vertex index.

use std::sync::Arc;

use naga::{
    AddressSpace, BinaryOperator, Binding, BuiltIn, Expression, FunctionArgument, FunctionResult, GlobalVariable,
    Handle, Module, ResourceBinding, ShaderStage, Statement, TypeInner,
};

use super::builder::Builder;
use super::compute::{Harness, as_function, canary, entry_point, poison, scaled, store_outputs};
use super::trace::Direct;
use super::words::{self, WordsAt};
use super::{ENTRY_POINT, Form, Kernel};
use crate::layout::byte_offsets;
use crate::lower::Role;
use crate::{Count, Entry, PortAt, Program, ProgramError, validate};
use base::value::{Field, Scalar};

/// A vertex attribute as the host feeds it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Attribute {
    /// Name and shape in the shader.
    pub field: Field,
    /// Attribute location.
    pub location: u32,
    /// Components that the host feeds, 1 to 4.
    pub components: u8,
}

/// A uniform buffer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UniformBlock {
    /// Size in bytes.
    pub bytes: u32,
    /// Which words of a case go where.
    pub places: Vec<UniformPlace>,
}

/// One word of a case in a uniform buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UniformPlace {
    /// Index of the word in the case record.
    pub word: u32,
    /// Offset in the buffer, in bytes.
    pub byte: u32,
}

pub(super) fn kernel(program: &Program, components: &[u8]) -> Result<Kernel, ProgramError> {
    program.check_fed()?;
    let Role::Vertex = program.role else {
        return Err(ProgramError::Unsupported { what: "only a vertex stage runs as a vertex stage".to_owned() });
    };
    let Entry::Point(point) = program.entry else {
        return Err(ProgramError::internal("a vertex program without entry point".to_owned()));
    };
    let mut module = program.module.clone();
    for port in &program.outputs {
        words::insert_parts(&mut module, port.ty);
    }
    let harness = Harness::insert(&mut module);
    let blocks = uniform_blocks(program, &mut module)?;
    let original = module.entry_points[point].function.arguments.clone();
    let attributes = attributes(program, &original, components)?;
    let function = as_function(program, &mut module);
    let direct = Direct::insert(program, &mut module, &harness);

    let mut b = Builder::new();
    let mut arguments = original;
    let call: Vec<_> = (0..arguments.len() as u32).map(|k| b.argument(k)).collect();
    let drawn = program.drawn();
    // The draw sets the number that the shader reads, and the other one is that of the record.
    let reads_vertex = drawn.iter().any(|d| d.count == Count::Vertex);
    let counter = if reads_vertex { BuiltIn::InstanceIndex } else { BuiltIn::VertexIndex };
    let is_index = |a: &FunctionArgument| a.binding == Some(Binding::BuiltIn(counter));
    let index_at = arguments.iter().position(is_index).unwrap_or_else(|| {
        arguments.push(FunctionArgument {
            name: Some("sc_index".to_owned()),
            ty: harness.types.u32,
            binding: Some(Binding::BuiltIn(counter)),
        });
        arguments.len() - 1
    });
    let index = b.argument(index_at as u32);
    poison(&mut b, &harness, program, &module);
    if let Some(direct) = &direct {
        let record = scaled(&mut b, index, program.output_layout().words());
        direct.begin(&mut b, record);
    }
    let result = module.functions[function].result.is_some().then(|| b.name(Expression::CallResult(function)));
    b.statement(Statement::Call { function, arguments: call, result });
    let layout = program.output_layout();
    let count = super::compute::param(&mut b, &harness, 0);
    let inside = b.binary(BinaryOperator::Less, index, count);
    b.when(inside, |b| {
        let base = scaled(b, index, layout.words());
        let out = WordsAt { array: b.global(harness.outputs), base };
        let mark = canary(b, &harness, index);
        let first = b.element(out.array, out.base);
        b.store(first, mark);
        store_outputs(b, &module, program, out, result, &[]);
    });
    // Nothing is drawn: every vertex leaves at the same place.
    let zero = b.name(Expression::ZeroValue(harness.types.vec4));
    b.statement(Statement::Return { value: Some(zero) });
    let position = Binding::BuiltIn(BuiltIn::Position { invariant: false });
    let result = FunctionResult { ty: harness.types.vec4, binding: Some(position) };
    let function = b.finish(ENTRY_POINT, arguments, Some(result));
    module.entry_points.push(entry_point(ShaderStage::Vertex, [0; 3], function));
    let info = validate(&module)?;
    Ok(Kernel {
        invocation: Arc::new(program.invocation_record()),
        case: Arc::new(program.case_record()),
        output: layout,
        program: Arc::new(program.clone()),
        form: Form::Vertex { attributes, blocks, drawn },
        module,
        info,
    })
}

fn attributes(
    program: &Program,
    arguments: &[FunctionArgument],
    components: &[u8],
) -> Result<Vec<Attribute>, ProgramError> {
    let mut attributes = Vec::new();
    for (i, port) in program.inputs.iter().enumerate() {
        if matches!(port.at, PortAt::Arguments { .. }) {
            let what =
                format!("attribute `{}` of type `{}` as one vertex attribute", port.field.name, port.field.shape);
            return Err(ProgramError::Unsupported { what });
        }
        let k = match port.at {
            PortAt::Argument(k) => k,
            PortAt::Part { .. } => {
                let what = format!("`{}`, which is memory, as a vertex attribute", port.field.name);
                return Err(ProgramError::Unsupported { what });
            }
            ref other => return Err(ProgramError::internal(format!("attribute at {other:?}"))),
        };
        let location = match arguments[k as usize].binding {
            Some(Binding::Location { location, .. }) => location,
            // Numbers of the draw stand behind all attributes.
            Some(Binding::BuiltIn(_)) => continue,
            None => return Err(ProgramError::internal(format!("attribute `{}` has no location", port.field.name))),
        };
        let shape = port.field.shape;
        if shape.array.is_some() || shape.columns > 1 || shape.scalar == Scalar::Bool {
            let what = format!("attribute `{}` of type `{shape}` as one vertex attribute", port.field.name);
            return Err(ProgramError::Unsupported { what });
        }
        let fed = components.get(i).copied().unwrap_or(shape.rows).clamp(1, 4);
        attributes.push(Attribute { field: port.field.clone(), location, components: fed });
    }
    Ok(attributes)
}

/// Moves the uniform variables to group 1, one binding each, and says where each word goes.
fn uniform_blocks(program: &Program, module: &mut Module) -> Result<Vec<UniformBlock>, ProgramError> {
    let mut layouter = naga::proc::Layouter::default();
    layouter.update(module.to_ctx()).map_err(|e| ProgramError::internal(e.to_string()))?;
    let mut blocks: Vec<(Handle<GlobalVariable>, UniformBlock)> = Vec::new();
    let mut word = 0;
    for port in &program.uniforms {
        let (global, start) = match port.at {
            PortAt::Global(global) => (global, 0),
            PortAt::Member(global, member) => {
                let TypeInner::Struct { ref members, .. } = module.types[module.global_variables[global].ty].inner
                else {
                    return Err(ProgramError::internal("a member of a uniform that is no block".to_owned()));
                };
                (global, members[member as usize].offset)
            }
            PortAt::Part { global, ref path } => (global, offset_of(module, module.global_variables[global].ty, path)),
            ref other => return Err(ProgramError::internal(format!("uniform at {other:?}"))),
        };
        let at = blocks.iter().position(|(g, _)| *g == global).unwrap_or_else(|| {
            let ty = module.global_variables[global].ty;
            let bytes = layouter[ty].size.next_multiple_of(16);
            blocks.push((global, UniformBlock { bytes, places: Vec::new() }));
            blocks.len() - 1
        });
        let mut bytes = Vec::new();
        byte_offsets(module, port.ty, start, &mut bytes);
        blocks[at].1.places.extend((word..).zip(&bytes).map(|(word, &byte)| UniformPlace { word, byte }));
        word += bytes.len() as u32;
    }
    for (k, (global, _)) in blocks.iter().enumerate() {
        let variable = &mut module.global_variables[*global];
        variable.space = AddressSpace::Uniform;
        variable.binding = Some(ResourceBinding { group: 1, binding: k as u32 });
    }
    Ok(blocks.into_iter().map(|(_, block)| block).collect())
}

/// Where a part of a variable begins, in bytes.
fn offset_of(module: &Module, ty: Handle<naga::Type>, path: &[u32]) -> u32 {
    let Some((&index, rest)) = path.split_first() else { return 0 };
    match &module.types[ty].inner {
        TypeInner::Struct { members, .. } => {
            let member = &members[index as usize];
            member.offset + offset_of(module, member.ty, rest)
        }
        TypeInner::Array { base, stride, .. } => index * stride + offset_of(module, *base, rest),
        // Parts smaller than a vector or matrix are not fed by themselves.
        _ => 0,
    }
}
