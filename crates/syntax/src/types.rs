//! Types of GLSL values (GLSL 4.60 specification, section 4.1) and their implicit conversions
//! (section 4.1.10).

use std::fmt;
use std::sync::Arc;

use super::ast::Qualifiers;
pub use super::opaque::{OpaqueKind, OpaqueType, TextureDim};
pub use super::scalar::ScalarType;
use base::text::Span;
use base::value;

/// Size of an array.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ArraySize {
    /// Known at compile time.
    Known(u32),
    /// `[]`, not (yet) known.
    Unsized,
    /// Written, but not computable here (a specialisation constant, or an error already told).
    Unknown,
}

/// A structure, or the members of a block.
#[derive(Clone, Debug, PartialEq)]
pub struct StructType {
    /// Its name; a made-up one in `<>` when it has none.
    pub name: String,
    /// The members in order.
    pub fields: Vec<StructField>,
    /// Place of the definition; empty at 0 for built-in ones.
    pub span: Span,
}

/// A member of a structure or block.
#[derive(Clone, Debug, PartialEq)]
pub struct StructField {
    /// Name by which `.name` selects it.
    pub name: String,
    /// Type with all dimensions, of the member and of its specifier.
    pub ty: Type,
    /// Place of the name.
    pub span: Span,
    /// Its own qualifiers (layout, interpolation …).
    pub qualifiers: Qualifiers,
}

/// Type of a value.
#[derive(Clone, Debug, PartialEq)]
pub enum Type {
    /// Not known, because of an error told elsewhere: agrees with everything.
    Error,
    /// `void`
    Void,
    /// `bool`, `int`, `uint`, `float`, `double`
    Scalar(ScalarType),
    /// `vec2` … `dvec4`: component type and number of components (2 to 4).
    Vector(ScalarType, u8),
    /// `matCxR`: component type (`Float` or `Double`), columns, rows.
    Matrix(ScalarType, u8, u8),
    /// A sampler, image or atomic counter.
    Opaque(OpaqueType),
    /// A structure or the contents of a block.
    Struct(Arc<StructType>),
    /// An array: element and size.
    Array(Arc<Type>, ArraySize),
}

impl Type {
    /// `bool`
    pub const BOOL: Self = Self::Scalar(ScalarType::Bool);
    /// `int`
    pub const INT: Self = Self::Scalar(ScalarType::Int);
    /// `uint`
    pub const UINT: Self = Self::Scalar(ScalarType::Uint);
    /// `float`
    pub const FLOAT: Self = Self::Scalar(ScalarType::Float);
    /// `vec2`
    pub const VEC2: Self = Self::Vector(ScalarType::Float, 2);
    /// `vec3`
    pub const VEC3: Self = Self::Vector(ScalarType::Float, 3);
    /// `vec4`
    pub const VEC4: Self = Self::Vector(ScalarType::Float, 4);
    /// `mat4`
    pub const MAT4: Self = Self::Matrix(ScalarType::Float, 4, 4);

    /// A vector of `n` components; one component is a scalar.
    pub fn vector(scalar: ScalarType, n: u8) -> Self {
        if n == 1 { Self::Scalar(scalar) } else { Self::Vector(scalar, n) }
    }

    /// An array of `self` with a known size.
    #[must_use]
    pub fn array(self, len: u32) -> Self {
        Self::Array(Arc::new(self), ArraySize::Known(len))
    }

    /// The built-in type of that name; structures are not found here.
    pub fn from_name(name: &str) -> Option<Self> {
        let digit = |s: &str| match s {
            "2" => Some(2),
            "3" => Some(3),
            "4" => Some(4),
            _ => None,
        };
        Some(match name {
            "void" => Self::Void,
            "bool" => Self::BOOL,
            "int" => Self::INT,
            "uint" => Self::UINT,
            "float" => Self::FLOAT,
            "double" => Self::Scalar(ScalarType::Double),
            _ => {
                if let Some(n) = name.strip_prefix("vec").and_then(digit) {
                    return Some(Self::Vector(ScalarType::Float, n));
                }
                let sized = ScalarType::of_sized_name(name);
                if let Some((scalar, "")) = sized {
                    return Some(Self::Scalar(scalar));
                }
                let (scalar, rest) = match name.as_bytes().first()? {
                    _ if sized.is_some() => sized?,
                    b'b' => (ScalarType::Bool, &name[1..]),
                    b'i' => (ScalarType::Int, &name[1..]),
                    b'u' => (ScalarType::Uint, &name[1..]),
                    b'd' => (ScalarType::Double, &name[1..]),
                    _ => (ScalarType::Float, name),
                };
                if let Some(n) = rest.strip_prefix("vec").and_then(digit) {
                    Self::Vector(scalar, n)
                } else if let Some(size) = rest.strip_prefix("mat").filter(|_| scalar.is_floating()) {
                    let (columns, rows) = size.split_once('x').unwrap_or((size, size));
                    Self::Matrix(scalar, digit(columns)?, digit(rows)?)
                } else {
                    return OpaqueType::from_name(name).map(Self::Opaque);
                }
            }
        })
    }

    /// True when the component type, or one inside, is such.
    pub fn has_scalar(&self, is: &impl Fn(ScalarType) -> bool) -> bool {
        match self {
            Self::Scalar(s) | Self::Vector(s, _) | Self::Matrix(s, _, _) => is(*s),
            Self::Array(element, _) => element.has_scalar(is),
            Self::Struct(s) => s.fields.iter().any(|f| f.ty.has_scalar(is)),
            Self::Error | Self::Void | Self::Opaque(_) => false,
        }
    }

    /// Component type of a scalar, vector or matrix.
    pub fn scalar(&self) -> Option<ScalarType> {
        match self {
            Self::Scalar(s) | Self::Vector(s, _) | Self::Matrix(s, _, _) => Some(*s),
            Self::Error | Self::Void | Self::Opaque(_) | Self::Struct(_) | Self::Array(..) => None,
        }
    }

    /// True for `void`, and for arrays of it.
    pub fn is_void(&self) -> bool {
        match self {
            Self::Void => true,
            Self::Array(element, _) => element.is_void(),
            Self::Error | Self::Scalar(_) | Self::Vector(..) | Self::Matrix(..) | Self::Opaque(_) | Self::Struct(_) => {
                false
            }
        }
    }

    /// Number of components of a scalar, vector or matrix.
    pub fn components(&self) -> Option<usize> {
        match self {
            Self::Scalar(_) => Some(1),
            Self::Vector(_, n) => Some(usize::from(*n)),
            Self::Matrix(_, c, r) => Some(usize::from(*c) * usize::from(*r)),
            Self::Error | Self::Void | Self::Opaque(_) | Self::Struct(_) | Self::Array(..) => None,
        }
    }

    /// The same size with another component type; only scalars, vectors and matrices change.
    #[must_use]
    pub fn with_scalar(&self, scalar: ScalarType) -> Self {
        match self {
            Self::Scalar(_) => Self::Scalar(scalar),
            Self::Vector(_, n) => Self::Vector(scalar, *n),
            Self::Matrix(_, c, r) => Self::Matrix(scalar, *c, *r),
            Self::Error | Self::Void | Self::Opaque(_) | Self::Struct(_) | Self::Array(..) => self.clone(),
        }
    }

    /// True for the unknown type, and for arrays of it.
    pub fn is_error(&self) -> bool {
        match self {
            Self::Error => true,
            Self::Array(element, _) => element.is_error(),
            Self::Void | Self::Scalar(_) | Self::Vector(..) | Self::Matrix(..) | Self::Opaque(_) | Self::Struct(_) => {
                false
            }
        }
    }

    /// True for a scalar.
    pub fn is_scalar(&self) -> bool {
        matches!(self, Self::Scalar(_))
    }

    /// True when a sampler, image or atomic counter is inside.
    pub fn contains_opaque(&self) -> bool {
        match self {
            Self::Opaque(_) => true,
            Self::Array(element, _) => element.contains_opaque(),
            Self::Struct(s) => s.fields.iter().any(|f| f.ty.contains_opaque()),
            Self::Error | Self::Void | Self::Scalar(_) | Self::Vector(..) | Self::Matrix(..) => false,
        }
    }

    /// What one index yields: the element of an array, a column of a matrix, a component of a
    /// vector.
    pub fn indexed(&self) -> Option<Self> {
        match self {
            Self::Array(element, _) => Some(element.as_ref().clone()),
            Self::Matrix(s, _, rows) => Some(Self::Vector(*s, *rows)),
            Self::Vector(s, _) => Some(Self::Scalar(*s)),
            Self::Error => Some(Self::Error),
            Self::Void | Self::Scalar(_) | Self::Opaque(_) | Self::Struct(_) => None,
        }
    }

    /// Number of elements that an index may reach, where it is known.
    pub fn index_count(&self) -> Option<u32> {
        match self {
            Self::Array(_, ArraySize::Known(n)) => Some(*n),
            Self::Matrix(_, columns, _) => Some(u32::from(*columns)),
            Self::Vector(_, n) => Some(u32::from(*n)),
            Self::Array(_, ArraySize::Unsized | ArraySize::Unknown)
            | Self::Error
            | Self::Void
            | Self::Scalar(_)
            | Self::Opaque(_)
            | Self::Struct(_) => None,
        }
    }

    /// The shape as a value that the host can feed or read: numeric types of 32-bit words, `float16_t`, and
    /// arrays of them with a known size. None for `double`, whole numbers of other sizes, structures, opaque types and
    /// arrays of arrays.
    pub fn shape(&self) -> Option<value::Shape> {
        let scalar = |s: ScalarType| match s {
            ScalarType::Bool => Some(value::Scalar::Bool),
            ScalarType::Int => Some(value::Scalar::I32),
            ScalarType::Uint => Some(value::Scalar::U32),
            ScalarType::Half | ScalarType::Float => Some(value::Scalar::F32),
            ScalarType::Int8 | ScalarType::Uint8 | ScalarType::Int16 | ScalarType::Uint16 => None,
            ScalarType::Int64 | ScalarType::Uint64 | ScalarType::Double => None,
        };
        let half = self.scalar() == Some(ScalarType::Half);
        match self {
            Self::Scalar(s) => Some(value::Shape { half, ..value::Shape::vector(scalar(*s)?, 1) }),
            Self::Vector(s, n) => Some(value::Shape { half, ..value::Shape::vector(scalar(*s)?, *n) }),
            Self::Matrix(s, columns, rows) => {
                Some(value::Shape { scalar: scalar(*s)?, columns: *columns, rows: *rows, array: None, half })
            }
            Self::Array(element, ArraySize::Known(n)) => {
                let shape = element.shape()?;
                shape.array.is_none().then(|| shape.array_of(*n))
            }
            Self::Array(_, ArraySize::Unsized | ArraySize::Unknown)
            | Self::Error
            | Self::Void
            | Self::Opaque(_)
            | Self::Struct(_) => None,
        }
    }
}

impl fmt::Display for Type {
    /// The GLSL spelling; `unknown` for [`Type::Error`].
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Error => f.write_str("unknown"),
            Self::Void => f.write_str("void"),
            Self::Scalar(s) => f.write_str(s.name()),
            Self::Vector(s, n) => write!(f, "{}vec{n}", s.prefix()),
            Self::Matrix(s, c, r) if c == r => write!(f, "{}mat{c}", s.prefix()),
            Self::Matrix(s, c, r) => write!(f, "{}mat{c}x{r}", s.prefix()),
            Self::Opaque(o) => write!(f, "{o}"),
            Self::Struct(s) => f.write_str(&s.name),
            Self::Array(..) => {
                // The outermost dimension is written first.
                let mut dims = String::new();
                let mut element = self;
                while let Self::Array(inner, size) = element {
                    match size {
                        ArraySize::Known(n) => dims.push_str(&format!("[{n}]")),
                        ArraySize::Unsized | ArraySize::Unknown => dims.push_str("[]"),
                    }
                    element = inner;
                }
                write!(f, "{element}{dims}")
            }
        }
    }
}

/// Which implicit conversions a version of the language has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Conversions {
    /// `int` to `uint` (4.00).
    pub int_to_uint: bool,
    /// Everything to `double` (4.00).
    pub to_double: bool,
}

impl Conversions {
    /// True when a value of the component type `from` may stand where `to` is wanted. Integers to
    /// `float` are allowed in every version: the oldest ones forbid it, but nearly every driver
    /// accepts it, so that telling it is left to the lint rules.
    pub fn scalar(self, from: ScalarType, to: ScalarType) -> bool {
        match (from, to) {
            _ if from == to => true,
            (ScalarType::Int | ScalarType::Uint, ScalarType::Float) => true,
            (ScalarType::Int, ScalarType::Uint) => self.int_to_uint,
            (ScalarType::Int | ScalarType::Uint | ScalarType::Float, ScalarType::Double) => self.to_double,
            // GL_EXT_shader_explicit_arithmetic_types: to what holds more, and from a sign to none.
            (ScalarType::Half, ScalarType::Float) => true,
            (ScalarType::Half, ScalarType::Double) => self.to_double,
            (ScalarType::Int64 | ScalarType::Uint64, ScalarType::Double) => self.to_double,
            _ if from.is_integer() && to.is_integer() && (from.is_sized() || to.is_sized()) => {
                from.bits() < to.bits() || from.bits() == to.bits() && from.is_signed()
            }
            _ => from.is_small_integer() && to.is_floating(),
        }
    }

    /// True when a value of type `from` may stand where `to` is wanted: equal types, or equal
    /// sizes with convertible components. Unknown types agree with everything.
    pub fn allow(self, from: &Type, to: &Type) -> bool {
        match (from, to) {
            (Type::Error, _) | (_, Type::Error) => true,
            (Type::Scalar(a), Type::Scalar(b)) => self.scalar(*a, *b),
            (Type::Vector(a, n), Type::Vector(b, m)) => n == m && self.scalar(*a, *b),
            (Type::Matrix(a, c, r), Type::Matrix(b, d, s)) => (c, r) == (d, s) && self.scalar(*a, *b),
            (Type::Array(a, n), Type::Array(b, m)) => {
                let sizes = match (n, m) {
                    (ArraySize::Known(n), ArraySize::Known(m)) => n == m,
                    _ => true,
                };
                sizes
                    && (a == b || a.is_error() || b.is_error() || (matches!(**a, Type::Array(..)) && self.allow(a, b)))
            }
            _ => from == to,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spellings_read_back() {
        for name in [
            "void",
            "bool",
            "int",
            "uint",
            "float",
            "double",
            "vec2",
            "bvec3",
            "ivec4",
            "uvec2",
            "dvec3",
            "mat4",
            "mat2x3",
            "dmat4x2",
            "sampler2D",
            "isampler2DMSArray",
            "usamplerCube",
            "sampler2DRectShadow",
            "samplerCubeArrayShadow",
            "image2D",
            "iimage3D",
            "uimageBuffer",
            "atomic_uint",
            "float16_t",
            "f16vec3",
            "f16mat2x4",
            "int8_t",
            "u8vec4",
            "uint16_t",
            "i16vec2",
            "int64_t",
            "u64vec2",
        ] {
            assert_eq!(Type::from_name(name).map(|t| t.to_string()).as_deref(), Some(name));
        }
        for (name, same) in [("float32_t", "float"), ("i32vec2", "ivec2"), ("uint32_t", "uint"), ("f64mat2", "dmat2")] {
            assert_eq!(Type::from_name(name), Type::from_name(same), "{name}");
        }
        for name in ["int24_t", "f8vec2", "u16mat2", "uint_t", "f16", "float16", "i16", "f16vec5"] {
            assert_eq!(Type::from_name(name), None, "{name}");
        }
        for name in ["vec5", "imat3", "mat1", "sampler3DArray", "isampler2DShadow", "image2DShadow", "vec", "", "u"] {
            assert_eq!(Type::from_name(name), None, "{name}");
        }
        let nested = Type::FLOAT.array(3).array(2);
        assert_eq!(nested.to_string(), "float[2][3]");
    }

    #[test]
    fn only_arrays_of_words_have_a_shape() {
        assert_eq!(Type::MAT4.array(8).shape().map(|s| s.to_string()).as_deref(), Some("mat4[8]"));
        assert_eq!(Type::FLOAT.array(3).array(2).shape(), None);
        assert_eq!(Type::Vector(ScalarType::Double, 2).shape(), None);
    }

    #[test]
    fn conversions_follow_the_version() {
        let old = Conversions { int_to_uint: false, to_double: false };
        let new = Conversions { int_to_uint: true, to_double: true };
        assert!(old.allow(&Type::INT, &Type::FLOAT));
        assert!(!old.allow(&Type::INT, &Type::UINT) && new.allow(&Type::INT, &Type::UINT));
        assert!(!new.allow(&Type::FLOAT, &Type::INT) && !new.allow(&Type::BOOL, &Type::INT));
        assert!(!new.allow(&Type::VEC3, &Type::VEC4));
        assert!(!new.allow(&Type::INT.array(2), &Type::FLOAT.array(2)), "arrays do not convert");
        let sized = |from: &str, to: &str| new.allow(&Type::from_name(from).unwrap(), &Type::from_name(to).unwrap());
        assert!(sized("float16_t", "float") && sized("u8vec2", "ivec2") && sized("int16_t", "uint16_t"));
        assert!(sized("uint8_t", "float16_t") && sized("int", "int64_t") && !sized("uint", "float16_t"));
        assert!(!sized("float", "float16_t") && !sized("int", "int16_t") && !sized("uint16_t", "int16_t"));
    }
}
