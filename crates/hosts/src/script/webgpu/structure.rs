//! Structures of Rust whose bytes are copied as they are.

use std::ops::Range;

use base::text::Span;

use super::value::{Value, Values};
use crate::script::code::Code;
use crate::script::token::Token;

/// Structures inside of structures that are followed.
const DEEPEST: usize = 8;

/// A structure of the host.
#[derive(Debug)]
pub struct Structure {
    /// Its name.
    pub name: String,
    /// Place of the name.
    pub place: Span,
    /// The fields in order.
    pub fields: Vec<Field>,
}

/// A field of a structure.
#[derive(Debug)]
pub struct Field {
    /// Its name.
    pub name: String,
    /// Its place.
    pub place: Span,
    /// Its size and alignment; none for a type that is not known here.
    pub extent: Option<Extent>,
}

/// Bytes of a type of Rust.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Extent {
    /// Bytes.
    pub size: u64,
    /// Its alignment.
    pub align: u64,
    /// Its alignment where vectors of the machine hold it: glam has them for `Vec4` on some targets.
    pub most: u64,
}

impl Extent {
    fn of(size: u64, align: u64) -> Self {
        Self { size, align, most: align }
    }
}

impl Structure {
    /// The fields whose place is known, with it, and the extent of the whole where it is.
    pub fn places(&self) -> (Vec<(&Field, u64)>, Option<Extent>) {
        let (mut found, mut at, mut whole) = (Vec::new(), 0u64, Extent::of(0, 1));
        for field in &self.fields {
            let Some(extent) = field.extent else { return (found, None) };
            let start = at.next_multiple_of(extent.align);
            if start != at.next_multiple_of(extent.most) {
                return (found, None);
            }
            found.push((field, start));
            let Some(next) = start.checked_add(extent.size) else { return (found, None) };
            at = next;
            whole = Extent { size: at, align: whole.align.max(extent.align), most: whole.most.max(extent.most) };
        }
        let size = at.next_multiple_of(whole.align);
        (found, (size == at.next_multiple_of(whole.most)).then_some(Extent { size, ..whole }))
    }
}

/// How a structure comes to a buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Copied {
    /// Its bytes are taken as they are.
    Bytes,
    /// A library writes it member by member.
    Members,
    /// It is not seen that it does.
    Not,
}

/// All structures in C's layout, and those that a library writes, with how they come to a buffer.
pub fn structures(code: &Code<'_>) -> Vec<(Structure, Copied)> {
    let all = (0..code.tokens.len()).filter(|at| code.word(*at) == Some("struct"));
    all.filter_map(|at| structure(code, at, DEEPEST)).collect()
}

/// Bytes of a type that is written in these tokens.
pub fn size(values: &Values<'_, '_>, ty: Range<usize>) -> Option<u64> {
    extent(values.code, ty, DEEPEST).map(|e| e.size)
}

/// The place of a field: `offset_of!(Vertex, color)`.
pub fn offset_of(values: &Values<'_, '_>, value: &Value) -> Option<u64> {
    let code = values.code;
    let at = value.tokens.clone().find(|t| code.word(*t) == Some("offset_of"))?;
    let [ty, field] = code.elements(at + 2).try_into().ok()?;
    let (name, field) = (code.word(ty.end - 1)?, code.word(field.start)?);
    let found = named(code, name, DEEPEST)?;
    found.places().0.into_iter().find(|(f, _)| f.name == field).map(|(_, at)| at)
}

fn named(code: &Code<'_>, name: &str, depth: usize) -> Option<Structure> {
    let mut all =
        (1..code.tokens.len()).filter(|at| code.word(*at) == Some(name) && code.word(at - 1) == Some("struct"));
    let at = all.next().filter(|_| all.next().is_none())?;
    structure(code, at - 1, depth).filter(|(_, copied)| *copied != Copied::Members).map(|(s, _)| s)
}

/// A structure in C's layout or one that a library writes, and how it comes to a buffer.
fn structure(code: &Code<'_>, at: usize, depth: usize) -> Option<(Structure, Copied)> {
    let depth = depth.checked_sub(1)?;
    let name = code.word(at + 1)?;
    let open = (code.is_mark(at + 2, '{')).then_some(at + 2)?;
    let mut start = at;
    if start > 0 && code.is_mark(start - 1, ')') {
        start = code.other(start - 1)?;
    }
    if start > 0 && code.word(start - 1) == Some("pub") {
        start -= 1;
    }
    // Attributes in front: `#[repr(C)]`, `#[derive(…)]`.
    let mut attributes: Vec<Range<usize>> = Vec::new();
    while start > 1 && code.is_mark(start - 1, ']') {
        let bracket = code.other(start - 1)?;
        attributes.push(bracket..start);
        start = bracket.checked_sub(1).filter(|hash| code.is_mark(*hash, '#'))?;
    }
    let has = |word: &str| attributes.iter().any(|r| r.clone().any(|t| code.word(t) == Some(word)));
    let text = code.file.text();
    let copied = match has("Pod") || text.contains(&format!("Pod for {name} ")) {
        _ if has("ShaderType") => Copied::Members,
        true => Copied::Bytes,
        false => Copied::Not,
    };
    let other = ["align", "packed", "cfg"].into_iter().any(has);
    if other || !(has("C") || copied == Copied::Members) {
        return None;
    }
    let mut fields = Vec::new();
    for element in code.elements(open) {
        let colon = element.clone().find(|t| code.is_mark(*t, ':') && code.bracket(*t) == Some(open))?;
        let name = code.word(colon.checked_sub(1)?)?;
        if element.clone().any(|t| code.is_mark(t, '#')) {
            return None;
        }
        let ty = colon + 1..element.end;
        fields.push(Field { name: name.to_owned(), place: code.place(colon - 1), extent: extent(code, ty, depth) });
    }
    Some((Structure { name: name.to_owned(), place: code.place(at + 1), fields }, copied))
}

/// Bytes and alignment of a type: numbers, arrays of them, structures of the file, and vectors of libraries.
fn extent(code: &Code<'_>, ty: Range<usize>, depth: usize) -> Option<Extent> {
    let depth = depth.checked_sub(1)?;
    if let Some(Token::Mark('[')) = code.tokens.get(ty.start) {
        let close = code.other(ty.start).filter(|close| close + 1 == ty.end)?;
        let semicolon = (ty.start..close).find(|t| code.is_mark(*t, ';') && code.bracket(*t) == Some(ty.start))?;
        let element = extent(code, ty.start + 1..semicolon, depth)?;
        let values = Values { code };
        let count = super::number::number(&values, &Value { tokens: semicolon + 1..close, frame: None })?;
        return Some(Extent { size: element.size.checked_mul(count)?, ..element });
    }
    // The last word of a path, in front of its arguments.
    let angle = ty.clone().find(|t| code.is_mark(*t, '<')).unwrap_or(ty.end);
    let path = |t: usize| code.word(t).is_some() || code.is_mark(t, ':');
    let name = code.word(angle.checked_sub(1)?).filter(|_| (ty.start..angle).all(path) && angle > ty.start)?;
    if angle < ty.end {
        let float = ty.end == angle + 3 && code.word(angle + 1) == Some("f32") && code.is_mark(angle + 2, '>');
        return generic(code, name).filter(|_| float);
    }
    let simple = match name {
        "f32" | "u32" | "i32" => Some(Extent::of(4, 4)),
        "u8" | "i8" => Some(Extent::of(1, 1)),
        "u16" | "i16" => Some(Extent::of(2, 2)),
        "u64" | "i64" | "f64" => Some(Extent::of(8, 8)),
        _ => None,
    };
    if simple.is_some() {
        return simple;
    }
    let declares =
        |word: &str| (1..code.tokens.len()).any(|t| code.word(t) == Some(name) && code.word(t - 1) == Some(word));
    if declares("struct") {
        let whole = named(code, name, depth)?;
        return whole.places().1;
    }
    if declares("type") || declares("enum") || declares("union") {
        return None;
    }
    vector(code, name)
}

/// True where a file speaks of a library.
fn uses(code: &Code<'_>, libraries: &[&str]) -> bool {
    let text = code.file.text();
    libraries.iter().any(|l| text.contains(&format!("{l}::")))
}

/// `Vector3<f32>` of cgmath and nalgebra.
fn generic(code: &Code<'_>, name: &str) -> Option<Extent> {
    let numbers = match name {
        "Vector2" | "Point2" => 2,
        "Vector3" | "Point3" => 3,
        "Vector4" | "Point4" | "Matrix2" | "Quaternion" => 4,
        "Matrix3" => 9,
        "Matrix4" => 16,
        _ => return None,
    };
    uses(code, &["cgmath", "nalgebra", "na", "mint"]).then(|| Extent::of(numbers * 4, 4))
}

/// `Vec3` of glam and those with the same types.
fn vector(code: &Code<'_>, name: &str) -> Option<Extent> {
    if !uses(code, &["glam", "bevy", "bevy_math", "macaw", "nalgebra_glm", "ultraviolet"]) {
        return None;
    }
    let wide = |size| Some(Extent { size, align: 4, most: 16 });
    match name {
        "Vec2" | "IVec2" | "UVec2" => Some(Extent::of(8, 4)),
        "Vec3" | "IVec3" | "UVec3" => Some(Extent::of(12, 4)),
        "IVec4" | "UVec4" => Some(Extent::of(16, 4)),
        "Mat3" if uses(code, &["glam", "bevy", "bevy_math", "macaw"]) => Some(Extent::of(36, 4)),
        "Vec4" | "Quat" | "Mat2" => wide(16),
        "Mat4" => wide(64),
        _ => None,
    }
}
