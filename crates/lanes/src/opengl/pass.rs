//! The vertex stage in front of a geometry stage: it hands its attributes on as they are.

use std::fmt::Write as _;

use crate::LaneError;
use base::value::{Record, Scalar, Shape};
use program::lower::Primitives;
use syntax::Shader;
use syntax::ast::{AuxiliaryQualifier, Interpolation, QualifierKind, Qualifiers};
use syntax::interface::{Block, InputPrimitive, OutputPrimitive, Storage};

use super::ask::unsupported;
use super::job::{Attribute, CaptureKind, Input, Output};

/// A vertex stage that is not the author's, and what it is fed with.
pub struct Pass {
    pub text: String,
    pub attributes: Vec<Attribute>,
    /// For each vertex of a primitive, words of the record of an invocation.
    pub fed: Vec<Vec<u32>>,
}

pub fn kind(primitives: Primitives) -> CaptureKind {
    CaptureKind::Geometry {
        input: match primitives.input {
            InputPrimitive::Points => Input::Points,
            InputPrimitive::Lines => Input::Lines,
            InputPrimitive::LinesAdjacency => Input::LinesAdjacency,
            InputPrimitive::Triangles => Input::Triangles,
            InputPrimitive::TrianglesAdjacency => Input::TrianglesAdjacency,
        },
        output: match primitives.output {
            OutputPrimitive::Points => Output::Points,
            OutputPrimitive::LineStrip => Output::Lines,
            OutputPrimitive::TriangleStrip => Output::Triangles,
        },
        max_vertices: primitives.max_vertices,
    }
}

/// The stage in front of this geometry stage.
///
/// # Errors
/// [`LaneError::Unsupported`] for inputs that are no numbers of each vertex.
pub fn pass(shader: &Shader, primitives: Primitives, record: &Record) -> Result<Pass, LaneError> {
    let vertices = primitives.input_vertices();
    let mut text = String::new();
    // The version of the stage behind, and its extensions: what declares its inputs may need them.
    let directives = shader.version().span.into_iter().chain(shader.extensions().iter().map(|e| e.span));
    for span in directives {
        let _ = writeln!(text, "{}", shader.file().slice(span));
    }
    let mut blocks: Vec<&Block> = Vec::new();
    let (mut declared, mut body) = (String::new(), String::new());
    let mut pass = Pass { text: String::new(), attributes: Vec::new(), fed: vec![Vec::new(); vertices as usize] };
    for (k, field) in record.fields().iter().enumerate() {
        let refused = || unsupported(format!("the input `{}` of a geometry stage", field.name));
        let element = field.shape.element();
        if field.shape.array != Some(vertices) || element.scalar == Scalar::Bool {
            return Err(refused());
        }
        let target = match shader.interface().input(&field.name) {
            _ if matches!(field.name.as_str(), "gl_Position" | "gl_PointSize") => field.name.clone(),
            Some(variable) => {
                let _ = writeln!(declared, "{}out {element} {};", head(shader, &variable.qualifiers)?, variable.name);
                variable.name.clone()
            }
            None => {
                let (block, member) = member_of(shader, &field.name).ok_or_else(refused)?;
                if !blocks.iter().any(|b| std::ptr::eq(*b, block)) {
                    blocks.push(block);
                }
                format!("{}.{member}", instance(block))
            }
        };
        let start = record.range(k).start;
        let mut columns = Vec::new();
        for column in 0..usize::from(element.columns) {
            let name = format!("sc_in{}", pass.attributes.len());
            let vector = Shape::vector(element.scalar, element.rows);
            let _ = writeln!(text, "in {vector} {name};");
            for (vertex, fed) in pass.fed.iter_mut().enumerate() {
                let first = start + vertex * element.element_words() + column * usize::from(element.rows);
                fed.extend((0..usize::from(element.rows)).map(|row| (first + row) as u32));
            }
            pass.attributes.push(Attribute { name: name.clone(), scalar: element.scalar, components: element.rows });
            columns.push(name);
        }
        let value = if element.columns > 1 { format!("{element}({})", columns.join(", ")) } else { columns.concat() };
        let _ = writeln!(body, "    {target} = {value};");
    }
    for block in blocks {
        let _ = write!(declared, "{}out {} {{ ", head(shader, &block.qualifiers)?, block.name.name);
        for member in &block.members {
            let _ = write!(declared, "{}{} {}; ", head(shader, &member.qualifiers)?, member.ty, member.name.name);
        }
        let _ = writeln!(declared, "}} {};", instance(block));
    }
    pass.text = format!("{text}{declared}void main() {{\n{body}}}\n");
    Ok(pass)
}

/// Name of the instance in the vertex stage; blocks of two stages are matched by the name of the block.
fn instance(block: &Block) -> String {
    format!("sc_{}", block.name.name)
}

/// The block and the member that a field of the record stands for.
fn member_of<'s>(shader: &'s Shader, name: &str) -> Option<(&'s Block, String)> {
    let (root, member) = match name.split_once('.') {
        Some((root, member)) => (Some(root), member),
        None => (None, name),
    };
    let of = |b: &&Block| {
        b.storage == Storage::In
            && b.name.name != "gl_PerVertex"
            && b.instance.as_ref().map(|i| i.name.as_str()) == root
            && b.members.iter().any(|m| m.name.name == member)
    };
    shader.interface().blocks.iter().find(of).map(|b| (b, member.to_owned()))
}

/// What stands before `out`: stages are matched by location where there is one, and old versions want the same
/// interpolation on both sides.
fn head(shader: &Shader, qualifiers: &Qualifiers) -> Result<String, LaneError> {
    let mut text = String::new();
    for key in ["location", "component"] {
        if let Some(entry) = qualifiers.layout_entry(key) {
            let value = entry.value.and_then(|v| shader.fold(v)).and_then(|c| c.as_integer());
            let value = value.ok_or_else(|| unsupported(format!("`{key}` without a number")))?;
            let _ = write!(text, "layout({key} = {value}) ");
        }
    }
    if let Some((interpolation, _)) = qualifiers.interpolation() {
        text.push_str(match interpolation {
            Interpolation::Smooth => "smooth ",
            Interpolation::Flat => "flat ",
            Interpolation::NoPerspective => "noperspective ",
        });
    }
    for qualifier in &qualifiers.list {
        match qualifier.kind {
            QualifierKind::Auxiliary(AuxiliaryQualifier::Centroid) => text.push_str("centroid "),
            QualifierKind::Auxiliary(AuxiliaryQualifier::Sample) => text.push_str("sample "),
            QualifierKind::Auxiliary(AuxiliaryQualifier::Patch)
            | QualifierKind::Layout(_)
            | QualifierKind::Storage(_)
            | QualifierKind::Interpolation(_)
            | QualifierKind::Precision(_)
            | QualifierKind::Invariant
            | QualifierKind::Precise
            | QualifierKind::Memory(_)
            | QualifierKind::Subroutine(_) => {}
        }
    }
    Ok(text)
}
