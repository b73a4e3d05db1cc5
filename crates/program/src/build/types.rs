//! Types of GLSL as types of naga, once as values and once as memory that the host fills.

use naga::{ArraySize as Length, Handle, Scalar, StructMember, Type as NagaType, TypeInner, VectorSize};

use super::{Build, Result};
use base::text::Span;
use syntax::types::{ArraySize, ScalarType, StructType, Type};

/// What a type is laid out for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum TypeLayout {
    /// A value, or a variable that no host sees.
    Value,
    /// A uniform: arrays in steps of 16 bytes, no `bool`.
    Uniform,
    /// A storage buffer: no `bool`.
    Storage,
}

/// naga's scalar.
pub(super) fn scalar(ty: ScalarType) -> Scalar {
    match ty {
        ScalarType::Bool => Scalar::BOOL,
        // Small whole numbers are computed with 32 bits and brought back behind each operation.
        ScalarType::Int8 | ScalarType::Int16 | ScalarType::Int => Scalar::I32,
        ScalarType::Uint8 | ScalarType::Uint16 | ScalarType::Uint => Scalar::U32,
        ScalarType::Int64 => Scalar::I64,
        ScalarType::Uint64 => Scalar::U64,
        ScalarType::Half => Scalar::F16,
        ScalarType::Float => Scalar::F32,
        ScalarType::Double => Scalar::F64,
    }
}

/// naga's number of components, for 2 to 4.
pub(super) fn size(n: u8) -> VectorSize {
    match n {
        0..=2 => VectorSize::Bi,
        3 => VectorSize::Tri,
        _ => VectorSize::Quad,
    }
}

impl Build<'_> {
    pub(super) fn insert(&mut self, name: Option<String>, inner: TypeInner) -> Handle<NagaType> {
        self.module.types.insert(NagaType { name, inner }, naga::Span::UNDEFINED)
    }

    /// The type of values.
    pub(super) fn value_type(&mut self, ty: &Type, span: Span) -> Result<Handle<NagaType>> {
        self.make(ty, TypeLayout::Value, span)
    }

    /// The type in a layout. Samplers inside of structures are left out: they lie elsewhere.
    pub(super) fn make(&mut self, ty: &Type, layout: TypeLayout, span: Span) -> Result<Handle<NagaType>> {
        let number = |s: ScalarType| match (s, layout) {
            (ScalarType::Bool, TypeLayout::Uniform | TypeLayout::Storage) => Scalar::U32,
            (ScalarType::Int16, TypeLayout::Uniform | TypeLayout::Storage) => Scalar::I16,
            (ScalarType::Uint16, TypeLayout::Uniform | TypeLayout::Storage) => Scalar::U16,
            _ => scalar(s),
        };
        if layout != TypeLayout::Value
            && let Some(byte) = ty.scalar().filter(|s| s.bits() == 8)
        {
            // naga has no numbers of 8 bits. Where that is told, they take the place of those of 32.
            if !self.wide_bytes {
                let message = format!("`{}` in a buffer", byte.name());
                return Err(self.unsupported(span, message, "use numbers of 16 or 32 bits, and take them apart"));
            }
            self.widened.push(ty.to_string());
        }
        let inner = match ty {
            Type::Scalar(s) => TypeInner::Scalar(number(*s)),
            Type::Vector(s, n) => TypeInner::Vector { size: size(*n), scalar: number(*s) },
            Type::Matrix(s, columns, rows) => {
                TypeInner::Matrix { columns: size(*columns), rows: size(*rows), scalar: number(*s) }
            }
            Type::Array(element, length) => {
                let base = self.make(element, layout, span)?;
                let length = match length {
                    ArraySize::Known(n) => std::num::NonZeroU32::new(*n).map(Length::Constant),
                    ArraySize::Unsized if layout == TypeLayout::Storage => Some(Length::Dynamic),
                    ArraySize::Unsized | ArraySize::Unknown => None,
                };
                let Some(size) = length else {
                    return Err(self.unsupported(
                        span,
                        "an array whose size is not known",
                        "write the size into the declaration",
                    ));
                };
                let (bytes, align) = self.layout_of(base, span)?;
                let align = if layout == TypeLayout::Uniform { align.max(16) } else { align };
                TypeInner::Array { base, size, stride: bytes.next_multiple_of(align) }
            }
            Type::Struct(s) => return self.structure(s, layout, span),
            Type::Opaque(o) => {
                let message = format!("`{o}` as a value");
                return Err(self.unsupported(span, message, "samplers and images are uniforms and parameters alone"));
            }
            Type::Void | Type::Error => {
                return Err(self.unsupported(span, format!("a value of type `{ty}`"), "give it another type"));
            }
        };
        Ok(self.insert(None, inner))
    }

    fn structure(&mut self, ty: &StructType, layout: TypeLayout, span: Span) -> Result<Handle<NagaType>> {
        let mut members = Vec::new();
        let (mut at, mut most) = (0_u32, if layout == TypeLayout::Uniform { 16 } else { 1 });
        for field in ty.fields.iter().filter(|f| !f.ty.contains_opaque() || has_data(&f.ty)) {
            if field.ty.is_error() {
                let what = format!("the member `{}`, whose type is one of an extension", field.name);
                return Err(self.unsupported(field.span, what, "give it another type"));
            }
            let member = self.make(&field.ty, layout, span)?;
            let (bytes, mut align) = self.layout_of(member, span)?;
            if layout == TypeLayout::Uniform && matches!(field.ty, Type::Array(..) | Type::Struct(_)) {
                align = align.max(16);
            }
            at = at.next_multiple_of(align);
            members.push(StructMember { name: Some(field.name.clone()), ty: member, binding: None, offset: at });
            at += bytes;
            most = most.max(align);
        }
        if members.is_empty() {
            // naga has no empty structures.
            let ty = self.insert(None, TypeInner::Scalar(Scalar::U32));
            members.push(StructMember { name: Some("sc_nothing".to_owned()), ty, binding: None, offset: 0 });
            (at, most) = (4, most.max(4));
        }
        let name: String = ty.name.chars().filter(|c| c.is_ascii_alphanumeric() || *c == '_').collect();
        let name = if name.is_empty() { "sc_structure".to_owned() } else { name };
        let inner = TypeInner::Struct { members, span: at.next_multiple_of(most) };
        Ok(self.insert(Some(name), inner))
    }

    /// Size and alignment in bytes.
    fn layout_of(&mut self, ty: Handle<NagaType>, span: Span) -> Result<(u32, u32)> {
        if let Err(error) = self.layouter.update(self.module.to_ctx()) {
            return Err(self.unsupported(span, format!("a type without a layout: {error}"), "use another type"));
        }
        let layout = self.layouter[ty];
        Ok((layout.size, layout.alignment.round_up(1)))
    }

    /// Position of a field among the members that naga sees.
    pub(super) fn member_index(ty: &StructType, name: &str) -> Option<u32> {
        let mut all = ty.fields.iter().filter(|f| !f.ty.contains_opaque() || has_data(&f.ty));
        all.position(|f| f.name == name).and_then(|k| u32::try_from(k).ok())
    }

    /// Types of the members of a structure.
    pub(super) fn members(&self, ty: Handle<NagaType>) -> Vec<Handle<NagaType>> {
        match &self.module.types[ty].inner {
            TypeInner::Struct { members, .. } => members.iter().map(|m| m.ty).collect(),
            _ => Vec::new(),
        }
    }

    /// Type of what one index of a naga type gives.
    pub(super) fn element(&mut self, ty: Handle<NagaType>) -> Handle<NagaType> {
        let inner = match self.module.types[ty].inner {
            TypeInner::Array { base, .. } | TypeInner::BindingArray { base, .. } => return base,
            TypeInner::Matrix { rows, scalar, .. } => TypeInner::Vector { size: rows, scalar },
            TypeInner::Vector { scalar, .. } => TypeInner::Scalar(scalar),
            _ => return ty,
        };
        self.insert(None, inner)
    }
}

/// True when something other than samplers is inside.
pub(super) fn has_data(ty: &Type) -> bool {
    match ty {
        Type::Opaque(_) | Type::Void | Type::Error => false,
        Type::Array(element, _) => has_data(element),
        Type::Struct(s) => s.fields.iter().any(|f| has_data(&f.ty)),
        Type::Scalar(_) | Type::Vector(..) | Type::Matrix(..) => true,
    }
}

/// True when two types are one, sizes that are not written aside.
pub(super) fn same(a: &Type, b: &Type) -> bool {
    match (a, b) {
        (Type::Array(x, m), Type::Array(y, n)) => {
            let sizes = match (m, n) {
                (ArraySize::Known(m), ArraySize::Known(n)) => m == n,
                _ => true,
            };
            sizes && same(x, y)
        }
        (Type::Struct(x), Type::Struct(y)) => {
            x.name == y.name
                && x.fields.len() == y.fields.len()
                && x.fields.iter().zip(&y.fields).all(|(f, g)| f.name == g.name && same(&f.ty, &g.ty))
        }
        _ => a == b,
    }
}

/// Number of elements of an array, columns of a matrix, components of a vector.
pub(super) fn count(ty: &Type) -> u32 {
    ty.index_count().unwrap_or(1)
}
