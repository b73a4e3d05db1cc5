//! Where the fields of a kernel's records lie in a module of SPIR-V: read from the module, never assumed.

use ::spirv::{BuiltIn, Decoration, StorageClass};

use super::capture::Captured;
use super::spirv::{Reflection, Type, Variable};
use crate::LaneError;
use base::value::{Field, Record};

/// Built-in outputs that are captured.
const BUILT_INS: [(&str, BuiltIn); 2] = [("gl_Position", BuiltIn::Position), ("gl_PointSize", BuiltIn::PointSize)];

fn unsupported(what: String) -> LaneError {
    LaneError::Unsupported(what)
}

/// A uniform buffer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct DescriptorBlock {
    pub set: u32,
    pub binding: u32,
    /// Size in bytes.
    pub bytes: u32,
    /// For words of a case, the byte at which each lies.
    pub places: Vec<(usize, u32)>,
}

/// How a value is laid out in a block: what stands beside the type.
#[derive(Clone, Copy, Default)]
struct MemberLayout {
    matrix_stride: u32,
    row_major: bool,
}

/// The uniform buffers of a module, filled from the records of cases. Uniforms that no instruction uses are in none.
///
/// # Errors
/// [`LaneError::Unsupported`] for resources that are no uniform buffers, and values that are laid out in a way that
/// is not known.
pub(super) fn blocks(reflection: &Reflection, case: &Record) -> Result<Vec<DescriptorBlock>, LaneError> {
    let known =
        [StorageClass::Input, StorageClass::Output, StorageClass::Uniform, StorageClass::Private].map(|s| s as u32);
    if let Some(other) = reflection.variables.iter().find(|v| !known.contains(&v.storage)) {
        return Err(unsupported(format!("the resource `{}`; uniform values alone are fed", reflection.name(other.id))));
    }
    let variables: Vec<Variable> = reflection.of_storage(StorageClass::Uniform).collect();
    let (mut blocks, mut open) = (Vec::new(), 0);
    for variable in &variables {
        let of = |what| reflection.decoration(variable.id, what).unwrap_or(0);
        let mut all = Vec::new();
        spread(reflection, variable.ty, 0, MemberLayout::default(), &mut all);
        let bytes = all.iter().max().map_or(16, |last| (last + 4).next_multiple_of(16));
        open += all.len();
        let (set, binding) = (of(Decoration::DescriptorSet), of(Decoration::Binding));
        blocks.push(DescriptorBlock { set, binding, bytes, places: Vec::new() });
    }
    for (index, field) in case.fields().iter().enumerate() {
        let found = variables.iter().enumerate().find_map(|(k, &v)| Some((k, place(reflection, v, &field.name)?)));
        let Some((block, (ty, offset, layout))) = found else { continue };
        let mut bytes = Vec::new();
        spread(reflection, ty, offset, layout, &mut bytes);
        let words = case.range(index);
        if bytes.len() != words.len() {
            return Err(unsupported(format!("uniform `{}` with {} numbers in SPIR-V", field.name, bytes.len())));
        }
        open = open.saturating_sub(bytes.len());
        blocks[block].places.extend(words.zip(bytes));
    }
    // A number that is read and not fed would be taken for one of the case.
    if open > 0 {
        return Err(unsupported(format!("{open} numbers of uniform blocks that are in no record")));
    }
    Ok(blocks)
}

/// Where the value of this name lies in a block: its type, its first byte, and what it is laid out by.
fn place(reflection: &Reflection, block: Variable, name: &str) -> Option<(u32, u32, MemberLayout)> {
    let steps: Vec<&str> = name.split(['.', '[']).map(|step| step.trim_end_matches(']')).collect();
    let instance = reflection.name(block.id);
    let steps = match steps.split_first()? {
        (first, rest) if *first == instance => rest,
        _ if instance.is_empty() => &steps[..],
        _ => return None,
    };
    let (mut ty, mut offset, mut layout) = (block.ty, 0, MemberLayout::default());
    for step in steps {
        match reflection.types.get(&ty)? {
            Type::Struct(members) => {
                let member = (0..members.len() as u32).find(|&m| reflection.member_name(ty, m) == *step)?;
                layout = layout_of(reflection, ty, member);
                offset += reflection.member_decoration(ty, member, Decoration::Offset)?;
                ty = members[member as usize];
            }
            &Type::Array { element, count } => {
                let index: u32 = step.parse().ok().filter(|&index| index < count)?;
                offset += index * reflection.decoration(ty, Decoration::ArrayStride)?;
                ty = element;
            }
            Type::Bool | Type::Number | Type::Vector { .. } | Type::Matrix { .. } | Type::Pointer { .. } => {
                return None;
            }
        }
    }
    Some((ty, offset, layout))
}

fn layout_of(reflection: &Reflection, structure: u32, member: u32) -> MemberLayout {
    let of = |what| reflection.member_decoration(structure, member, what);
    MemberLayout {
        matrix_stride: of(Decoration::MatrixStride).unwrap_or(0),
        row_major: of(Decoration::RowMajor).is_some(),
    }
}

/// The bytes at which the numbers of a value begin, in the order of records.
fn spread(reflection: &Reflection, ty: u32, offset: u32, layout: MemberLayout, out: &mut Vec<u32>) {
    match reflection.types.get(&ty) {
        Some(Type::Bool | Type::Number) => out.push(offset),
        Some(&Type::Vector { count, .. }) => out.extend((0..count).map(|k| offset + 4 * k)),
        Some(&Type::Matrix { column, count }) => {
            let stride = layout.matrix_stride;
            for c in 0..count {
                let byte = |r| if layout.row_major { r * stride + 4 * c } else { c * stride + 4 * r };
                out.extend((0..reflection.words(column)).map(|r| offset + byte(r)));
            }
        }
        Some(&Type::Array { element, count }) => {
            let stride = reflection.decoration(ty, Decoration::ArrayStride).unwrap_or(0);
            for k in 0..count {
                spread(reflection, element, offset + k * stride, layout, out);
            }
        }
        Some(Type::Struct(members)) => {
            for (&member, k) in members.iter().zip(0..) {
                let start = reflection.member_decoration(ty, k, Decoration::Offset).unwrap_or(0);
                spread(reflection, member, offset + start, layout_of(reflection, ty, k), out);
            }
        }
        Some(Type::Pointer { .. }) | None => {}
    }
}

/// The location of an input; `None` for one that the module does not read.
///
/// # Errors
/// [`LaneError::Unsupported`] for an input without a location of its own.
pub(super) fn location(reflection: &Reflection, field: &Field) -> Result<Option<u32>, LaneError> {
    if let Some(variable) = reflection.find(StorageClass::Input, &field.name) {
        let location = reflection.decoration(variable.id, Decoration::Location);
        return location.map(Some).ok_or_else(|| unsupported(format!("input `{}` without a location", field.name)));
    }
    // The member of a block has the location of the block, and what members before it take.
    let member = field.name.rsplit('.').next().unwrap_or(&field.name);
    for variable in reflection.of_storage(StorageClass::Input) {
        let Some(structure) = reflection.block_of(variable) else { continue };
        let Some(Type::Struct(members)) = reflection.types.get(&structure) else { continue };
        let mut next = reflection.decoration(variable.id, Decoration::Location);
        for (&ty, k) in members.iter().zip(0..) {
            let here = reflection.member_decoration(structure, k, Decoration::Location).or(next);
            if reflection.member_name(structure, k) == member {
                return here.map(Some).ok_or_else(|| unsupported(format!("input `{}` without a location", field.name)));
            }
            next = here.map(|here| here + locations(reflection, ty));
        }
    }
    Ok(None)
}

/// Number of inputs that the module reads by location; members of blocks count one by one. Those of compatibility
/// profiles come with the block of built-ins, whether they are read or not.
pub(super) fn located_inputs(reflection: &Reflection) -> usize {
    let parts = |variable: Variable| {
        let structure = reflection.block_of(variable);
        let Some((structure, Type::Struct(members))) = structure.and_then(|s| Some((s, reflection.types.get(&s)?)))
        else {
            return usize::from(reflection.decoration(variable.id, Decoration::BuiltIn).is_none());
        };
        let own = |k: &u32| {
            let built_in = reflection.member_decoration(structure, *k, Decoration::BuiltIn).is_some();
            !built_in && !reflection.member_name(structure, *k).starts_with("gl_")
        };
        (0..members.len() as u32).filter(own).count()
    };
    reflection.of_storage(StorageClass::Input).map(parts).sum()
}

/// True for a stage that reads the number of its primitive.
pub(super) fn reads_primitive_id(reflection: &Reflection) -> bool {
    reflection
        .of_storage(StorageClass::Input)
        .any(|v| reflection.decoration(v.id, Decoration::BuiltIn) == Some(BuiltIn::PrimitiveId as u32))
}

/// Locations that a value takes.
pub(super) fn locations(reflection: &Reflection, ty: u32) -> u32 {
    match reflection.types.get(&ty) {
        Some(&Type::Matrix { count, .. }) => count,
        Some(&Type::Array { element, count }) => count * locations(reflection, element),
        Some(Type::Struct(members)) => members.iter().map(|&m| locations(reflection, m)).sum(),
        Some(Type::Bool | Type::Number | Type::Vector { .. } | Type::Pointer { .. }) | None => 1,
    }
}

/// A location that no output has.
pub(super) fn free_location(reflection: &Reflection) -> u32 {
    let mut free = 0;
    for variable in reflection.of_storage(StorageClass::Output) {
        let mut at = reflection.decoration(variable.id, Decoration::Location);
        if let Some(Type::Struct(members)) = reflection.types.get(&variable.ty) {
            for k in 0..members.len() as u32 {
                let member = reflection.member_decoration(variable.ty, k, Decoration::Location);
                at = at.max(member);
            }
        }
        free = free.max(at.map_or(0, |at| at + locations(reflection, variable.ty)));
    }
    free
}

/// The outputs of a record that a module writes, one behind the other, with the words of the record that each fills.
/// Outputs that no instruction writes are none of them.
///
/// # Errors
/// [`LaneError::Unsupported`] for an output with another number of words.
pub(super) fn outputs(
    reflection: &Reflection,
    record: &Record,
) -> Result<Vec<(Captured, std::ops::Range<usize>)>, LaneError> {
    let (mut outputs, mut word) = (Vec::new(), 0);
    for (index, field) in record.fields().iter().enumerate() {
        let Some((variable, member, ty)) = output(reflection, &field.name) else { continue };
        let words = record.range(index);
        if reflection.words(ty) as usize != words.len() {
            return Err(unsupported(format!("output `{}` with another type in SPIR-V", field.name)));
        }
        outputs.push((Captured { variable: variable.id, member, word }, words.clone()));
        word += words.len() as u32;
    }
    Ok(outputs)
}

/// A variable, for a member of a block its number and offset, and its type.
type Placed = (Variable, Option<(u32, u32)>, u32);

fn output(reflection: &Reflection, name: &str) -> Option<Placed> {
    let built_in = BUILT_INS.iter().find(|(known, _)| *known == name).map(|(_, which)| *which as u32);
    let member_name = name.rsplit('.').next().unwrap_or(name);
    for variable in reflection.of_storage(StorageClass::Output) {
        let Some(Type::Struct(members)) = reflection.types.get(&variable.ty) else {
            let of = reflection.decoration(variable.id, Decoration::BuiltIn);
            if (built_in.is_some() && of == built_in) || (built_in.is_none() && reflection.name(variable.id) == name) {
                return Some((variable, None, variable.ty));
            }
            continue;
        };
        for (&ty, member) in members.iter().zip(0..) {
            let of = reflection.member_decoration(variable.ty, member, Decoration::BuiltIn);
            let named = of.is_none() && reflection.member_name(variable.ty, member) == member_name;
            if (built_in.is_some() && of == built_in) || (built_in.is_none() && named) {
                return Some((variable, Some((variable.ty, member)), ty));
            }
        }
    }
    None
}
