//! Types of one component (GLSL 4.60 specification, section 4.1; GL_EXT_shader_explicit_arithmetic_types).

/// Type of one component.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum ScalarType {
    /// `bool`
    Bool,
    /// `int8_t`
    Int8,
    /// `uint8_t`
    Uint8,
    /// `int16_t`
    Int16,
    /// `uint16_t`
    Uint16,
    /// `int`
    Int,
    /// `uint`
    Uint,
    /// `int64_t`
    Int64,
    /// `uint64_t`
    Uint64,
    /// `float16_t`
    Half,
    /// `float`
    Float,
    /// `double`
    Double,
}

impl ScalarType {
    /// The spelling.
    pub fn name(self) -> &'static str {
        match self {
            Self::Bool => "bool",
            Self::Int8 => "int8_t",
            Self::Uint8 => "uint8_t",
            Self::Int16 => "int16_t",
            Self::Uint16 => "uint16_t",
            Self::Int => "int",
            Self::Uint => "uint",
            Self::Int64 => "int64_t",
            Self::Uint64 => "uint64_t",
            Self::Half => "float16_t",
            Self::Float => "float",
            Self::Double => "double",
        }
    }

    /// The letter before `vec`.
    pub fn prefix(self) -> &'static str {
        match self {
            Self::Bool => "b",
            Self::Int8 => "i8",
            Self::Uint8 => "u8",
            Self::Int16 => "i16",
            Self::Uint16 => "u16",
            Self::Int => "i",
            Self::Uint => "u",
            Self::Int64 => "i64",
            Self::Uint64 => "u64",
            Self::Half => "f16",
            Self::Float => "",
            Self::Double => "d",
        }
    }

    /// True for whole numbers.
    pub fn is_integer(self) -> bool {
        self.is_signed() || self.is_unsigned()
    }

    /// True for whole numbers with a sign.
    pub fn is_signed(self) -> bool {
        matches!(self, Self::Int8 | Self::Int16 | Self::Int | Self::Int64)
    }

    /// True for whole numbers without a sign.
    pub fn is_unsigned(self) -> bool {
        matches!(self, Self::Uint8 | Self::Uint16 | Self::Uint | Self::Uint64)
    }

    /// True for `float16_t`, `float` and `double`.
    pub fn is_floating(self) -> bool {
        matches!(self, Self::Half | Self::Float | Self::Double)
    }

    /// Bits of a number; 32 for `bool`, as buffers hold it.
    pub fn bits(self) -> u32 {
        match self {
            Self::Int8 | Self::Uint8 => 8,
            Self::Int16 | Self::Uint16 | Self::Half => 16,
            Self::Bool | Self::Int | Self::Uint | Self::Float => 32,
            Self::Int64 | Self::Uint64 | Self::Double => 64,
        }
    }

    /// True for whole numbers of 8 or 16 bits.
    pub fn is_small_integer(self) -> bool {
        self.is_integer() && self.bits() < 32
    }

    /// True for what only an extension brings: whole numbers that have not 32 bits, and `float16_t`.
    pub fn is_sized(self) -> bool {
        self == Self::Half || self.is_integer() && self.bits() != 32
    }

    /// The type of a name that says how many bits it has (GL_EXT_shader_explicit_arithmetic_types). Those of 32 bits, and
    /// `float64_t`, are types that have another name.
    fn sized(kind: &str, bits: &str) -> Option<Self> {
        Some(match (kind, bits) {
            ("i", "8") => Self::Int8,
            ("u", "8") => Self::Uint8,
            ("i", "16") => Self::Int16,
            ("u", "16") => Self::Uint16,
            ("i", "32") => Self::Int,
            ("u", "32") => Self::Uint,
            ("i", "64") => Self::Int64,
            ("u", "64") => Self::Uint64,
            ("f", "16") => Self::Half,
            ("f", "32") => Self::Float,
            ("f", "64") => Self::Double,
            _ => return None,
        })
    }

    /// The scalar of a name that says its size, and how the name goes on: nothing for `int16_t`, `vec4` for `u8vec4`.
    pub(crate) fn of_sized_name(name: &str) -> Option<(Self, &str)> {
        let long = [("uint", "u"), ("int", "i"), ("float", "f")];
        if let Some(rest) = name.strip_suffix("_t") {
            return long.into_iter().find_map(|(word, kind)| Some((Self::sized(kind, rest.strip_prefix(word)?)?, "")));
        }
        let kind = name.get(..1).filter(|kind| ["i", "u", "f"].contains(kind))?;
        let digits = name[1..].bytes().take_while(u8::is_ascii_digit).count();
        let (bits, rest) = name[1..].split_at(digits);
        let scalar = Self::sized(kind, bits)?;
        (rest.starts_with("vec") || (rest.starts_with("mat") && scalar.is_floating())).then_some((scalar, rest))
    }
}
