//! What functions that set uniforms take.

use syntax::types::{ArraySize, ScalarType, Type};

/// What a `glUniform` function sets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Setter {
    /// Component type.
    pub scalar: ScalarType,
    /// Columns of a matrix, 1 otherwise.
    pub columns: u8,
    /// Components of a vector or rows of a matrix.
    pub rows: u8,
    /// True for a `Matrix` function.
    pub matrix: bool,
    /// True for a function with a count and a pointer.
    pub vector: bool,
}

impl Setter {
    /// What `glUniform3fv`, `glProgramUniformMatrix4x3fv` and the like set.
    pub fn of_function(name: &str) -> Option<Self> {
        let rest = name.strip_prefix("glProgramUniform").or_else(|| name.strip_prefix("glUniform"))?;
        let digit = |c: Option<char>| c.and_then(|c| c.to_digit(10)).and_then(|d| u8::try_from(d).ok());
        if let Some(size) = rest.strip_prefix("Matrix") {
            let (size, scalar) = if let Some(s) = size.strip_suffix("fv") {
                (s, ScalarType::Float)
            } else {
                (size.strip_suffix("dv")?, ScalarType::Double)
            };
            let columns = digit(size.chars().next())?;
            let rows = if size.len() == 3 { digit(size.chars().last())? } else { columns };
            return Some(Self { scalar, columns, rows, matrix: true, vector: true });
        }
        let rows = digit(rest.chars().next()).filter(|n| (1..=4).contains(n))?;
        let kind = &rest[1..];
        let (kind, vector) = kind.strip_suffix('v').map_or((kind, false), |k| (k, true));
        let scalar = match kind {
            "f" => ScalarType::Float,
            "i" => ScalarType::Int,
            "ui" => ScalarType::Uint,
            "d" => ScalarType::Double,
            _ => return None,
        };
        Some(Self { scalar, columns: 1, rows, matrix: false, vector })
    }

    /// What sets a value of this GLSL type.
    pub fn of_type(name: &str) -> Option<Self> {
        Some(match Type::from_name(name)? {
            Type::Scalar(scalar) => Self { scalar, columns: 1, rows: 1, matrix: false, vector: false },
            Type::Vector(scalar, rows) => Self { scalar, columns: 1, rows, matrix: false, vector: true },
            Type::Matrix(scalar, columns, rows) => Self { scalar, columns, rows, matrix: true, vector: true },
            Type::Error | Type::Void | Type::Opaque(_) | Type::Struct(_) | Type::Array(..) => return None,
        })
    }

    /// The GLSL type of what it sets.
    pub fn type_name(self) -> Option<String> {
        let ty = match (self.matrix, self.rows) {
            (true, rows) => Type::Matrix(self.scalar, self.columns, rows),
            (false, 1) => Type::Scalar(self.scalar),
            (false, rows) => Type::Vector(self.scalar, rows),
        };
        let name = ty.to_string();
        Self::of_type(&name).map(|_| name)
    }

    /// True when a uniform of this type may be set so. Of an array the element counts.
    pub fn fits(self, ty: &Type) -> bool {
        let scalar = |s: ScalarType| match s {
            ScalarType::Bool => self.scalar != ScalarType::Double,
            // Functions of extensions, of which nothing is known here.
            _ if s.is_sized() => true,
            _ => s == self.scalar,
        };
        match ty {
            Type::Scalar(s) => !self.matrix && self.rows == 1 && scalar(*s),
            Type::Vector(s, n) => !self.matrix && self.rows == *n && scalar(*s),
            Type::Matrix(s, c, r) => self.matrix && (self.columns, self.rows) == (*c, *r) && scalar(*s),
            Type::Array(element, _) => self.fits(element),
            Type::Opaque(_) => !self.matrix && self.rows == 1 && self.scalar == ScalarType::Int,
            Type::Error | Type::Void | Type::Struct(_) => true,
        }
    }

    /// The function that sets a uniform of this type in the same way, by pointer or by values.
    pub fn function_for(self, ty: &Type) -> Option<String> {
        let letter = |s: ScalarType| match s {
            ScalarType::Float => "f",
            ScalarType::Int | ScalarType::Bool => "i",
            ScalarType::Uint => "ui",
            ScalarType::Double => "d",
            // By another extension.
            ScalarType::Half => "f16NV",
            _ if s.is_unsigned() => "ui64ARB",
            _ => "i64ARB",
        };
        let pointer = if self.vector { "v" } else { "" };
        match ty {
            Type::Scalar(s) => Some(format!("glUniform1{}{pointer}", letter(*s))),
            Type::Vector(s, n) => Some(format!("glUniform{n}{}{pointer}", letter(*s))),
            Type::Matrix(s, c, r) if c == r => Some(format!("glUniformMatrix{c}{}v", letter(*s))),
            Type::Matrix(s, c, r) => Some(format!("glUniformMatrix{c}x{r}{}v", letter(*s))),
            Type::Array(element, _) => Self { vector: true, ..self }.function_for(element),
            Type::Opaque(_) => Some(format!("glUniform1i{pointer}")),
            Type::Error | Type::Void | Type::Struct(_) => None,
        }
    }
}

/// The type that a name of a uniform means: `lights[1].color` of `lights`, whose type is `ty`. None when
/// the name does not lead to a value.
pub fn member<'t>(ty: &'t Type, name: &str) -> Option<&'t Type> {
    let mut ty = ty;
    let end = name.find(['.', '[']).unwrap_or(name.len());
    let mut rest = &name[end..];
    while !rest.is_empty() {
        if let Some(index) = rest.strip_prefix('[') {
            let (index, after) = index.split_once(']')?;
            let index: u32 = index.parse().ok()?;
            let Type::Array(element, size) = ty else { return None };
            if matches!(size, ArraySize::Known(n) if index >= *n) {
                return None;
            }
            (ty, rest) = (element, after);
        } else {
            let field = rest.strip_prefix('.')?;
            let end = field.find(['.', '[']).unwrap_or(field.len());
            let Type::Struct(inner) = ty else { return None };
            ty = &inner.fields.iter().find(|f| f.name == field[..end])?.ty;
            rest = &field[end..];
        }
    }
    Some(ty)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn functions_and_types_fit_as_the_specification_says() {
        for (function, ty, fits) in [
            ("glUniform3f", "vec3", true),
            ("glUniform3fv", "vec3", true),
            ("glUniform3f", "vec4", false),
            ("glUniform1f", "int", false),
            ("glUniform1i", "int", true),
            ("glUniform1i", "uint", false),
            ("glUniform1ui", "uint", true),
            ("glUniform1f", "bool", true),
            ("glUniform1i", "sampler2D", true),
            ("glUniform1f", "sampler2D", false),
            ("glUniformMatrix4fv", "mat4", true),
            ("glUniformMatrix3fv", "mat4", false),
            ("glUniformMatrix2x3fv", "mat2x3", true),
            ("glProgramUniform4fv", "vec4", true),
        ] {
            let setter = Setter::of_function(function).unwrap();
            assert_eq!(setter.fits(&Type::from_name(ty).unwrap()), fits, "{function} {ty}");
        }
        assert!(Setter::of_function("glUniformBlockBinding").is_none());
        assert!(Setter::of_function("glUniform5f").is_none());
        let setter = Setter::of_function("glUniform3fv").unwrap();
        assert_eq!(setter.function_for(&Type::VEC4).as_deref(), Some("glUniform4fv"));
    }

    #[test]
    fn names_lead_to_members() {
        let ty = Type::VEC3.array(2);
        assert_eq!(member(&ty, "a[1]"), Some(&Type::VEC3));
        assert_eq!(member(&ty, "a"), Some(&ty));
        assert_eq!(member(&ty, "a[2]"), None);
        assert_eq!(member(&Type::VEC3, "a.x"), None);
    }
}
