//! Vertex buffers as pipelines describe them.

use base::text::Span;
use syntax::types::ScalarType;

use super::number::{bytes, number};
use super::structure;
use super::value::{Entry, Value, Values};

/// A vertex buffer.
#[derive(Debug, Clone)]
pub struct VertexBuffer {
    /// Bytes from one vertex to the next, where they are known.
    pub stride: Option<(u64, Span)>,
    /// The attributes.
    pub attributes: Vec<Attribute>,
}

/// An attribute of a vertex.
#[derive(Debug, Clone)]
pub struct Attribute {
    /// The location that the shader reads it at.
    pub location: u64,
    /// Its format.
    pub format: Format,
    /// Bytes from the start of the vertex, where they are known.
    pub offset: Option<u64>,
    /// Its place.
    pub place: Span,
}

/// The format of an attribute.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Format {
    /// The name as written.
    pub name: String,
    /// What a shader reads it as.
    pub scalar: ScalarType,
    /// Bytes.
    pub size: u64,
}

impl Format {
    /// The format of that name, as Rust or JavaScript spell it.
    pub fn named(name: &str) -> Option<Self> {
        let lower = name.to_ascii_lowercase().replace('-', "");
        let of = |scalar, size| Some(Self { name: name.to_owned(), scalar, size });
        if lower.starts_with("unorm1010102") || lower == "unorm8x4bgra" {
            return of(ScalarType::Float, 4);
        }
        let (kind, rest) = ["float", "unorm", "snorm", "uint", "sint"]
            .iter()
            .find_map(|k| lower.strip_prefix(k).map(|rest| (*k, rest)))?;
        let (bits, count) = rest.split_once('x').unwrap_or((rest, "1"));
        let (bits, count): (u64, u64) = (bits.parse().ok()?, count.parse().ok()?);
        if ![8, 16, 32, 64].contains(&bits) || !(1..=4).contains(&count) {
            return None;
        }
        let scalar = match kind {
            _ if bits == 64 => return None,
            "uint" => ScalarType::Uint,
            "sint" => ScalarType::Int,
            _ => ScalarType::Float,
        };
        of(scalar, bits / 8 * count)
    }
}

/// The buffers of a list; none where not all attributes are known.
pub fn buffers(values: &Values<'_, '_>, list: &Value) -> Option<Vec<VertexBuffer>> {
    values.list(list)?.iter().map(|element| buffer(values, element)).collect()
}

fn buffer(values: &Values<'_, '_>, value: &Value) -> Option<VertexBuffer> {
    let code = values.code;
    let (open, object) = values.object(value)?;
    let stride = values.entry(open, &object, "array_stride").value();
    let stride = stride.and_then(|v| Some((bytes(values, &v)?, code.span(&v.tokens))));
    let attributes = attributes(values, &values.entry(open, &object, "attributes").value()?)?;
    Some(VertexBuffer { stride, attributes })
}

fn attributes(values: &Values<'_, '_>, value: &Value) -> Option<Vec<Attribute>> {
    let code = values.code;
    if let Some(list) = values.list(value) {
        return list.iter().map(|element| attribute(values, element)).collect();
    }
    // `vertex_attr_array![0 => Float32x3, …]`
    let value = values.resolve(value)?;
    let close = value.tokens.end.checked_sub(1)?;
    let open = code.other(close).filter(|open| value.tokens.contains(open))?;
    let is_macro = open >= 2 && code.is_mark(open - 1, '!') && code.word(open - 2) == Some("vertex_attr_array");
    is_macro.then_some(())?;
    let (mut found, mut offset) = (Vec::new(), Some(0u64));
    for element in code.elements(open) {
        let arrow = element.clone().find(|t| code.is_mark(*t, '=') && code.is_mark(*t + 1, '>'))?;
        let part = |tokens| Value { tokens, frame: value.frame.clone() };
        let location = number(values, &part(element.start..arrow))?;
        let format = Format::named(code.word(element.end - 1)?)?;
        let size = format.size;
        found.push(Attribute { location, format, offset, place: code.span(&element) });
        offset = offset.and_then(|at| at.checked_add(size));
    }
    Some(found)
}

fn attribute(values: &Values<'_, '_>, value: &Value) -> Option<Attribute> {
    let code = values.code;
    let (open, object) = values.object(value)?;
    let Entry::Value(location) = values.entry(open, &object, "shader_location") else { return None };
    let format = values.entry(open, &object, "format").value()?;
    let offset = values
        .entry(open, &object, "offset")
        .value()
        .and_then(|v| bytes(values, &v).or_else(|| structure::offset_of(values, &v)));
    Some(Attribute {
        location: number(values, &location)?,
        format: Format::named(values.word(&format)?)?,
        offset,
        place: code.span(&location.tokens),
    })
}
