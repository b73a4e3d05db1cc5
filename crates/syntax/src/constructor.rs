//! How many components a constructor needs and gets (GLSL 4.60 specification, section 5.4).

use super::types::Type;

/// Whether the arguments of a constructor give what it needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fit {
    /// They give exactly the components that it needs.
    Fits,
    /// The argument at this position, and all behind it, are left over.
    TooMany {
        /// Position of the first argument that gives nothing, from 0.
        first_extra: usize,
    },
    /// Components are missing.
    TooFew {
        /// Components that are given.
        given: usize,
    },
    /// Not counted in components: structures, arrays, or arguments of unknown type.
    Unknown,
}

/// A constructor call as a sum of components.
#[derive(Clone, Debug, PartialEq)]
pub struct Constructor {
    /// The type that is built.
    pub ty: Type,
    /// Components that it needs.
    pub needs: usize,
    /// Components of each argument; none for an argument without components.
    pub given: Vec<Option<usize>>,
    /// Whether that fits.
    pub fit: Fit,
}

/// Components of a scalar, vector or matrix; members or elements of a structure or array; 0 when
/// nothing can be built.
pub fn constructor_needs(ty: &Type) -> usize {
    match ty {
        Type::Scalar(_) | Type::Vector(..) | Type::Matrix(..) => ty.components().unwrap_or(0),
        Type::Struct(s) => s.fields.len(),
        Type::Array(..) => ty.index_count().and_then(|n| usize::try_from(n).ok()).unwrap_or(0),
        Type::Error | Type::Void | Type::Opaque(_) => 0,
    }
}

impl Constructor {
    /// Counts the components of `args`.
    pub fn new(ty: &Type, args: &[Type]) -> Self {
        let needs = constructor_needs(ty);
        let given: Vec<_> = args.iter().map(Type::components).collect();
        let fit = fit(ty, needs, args, &given);
        Self { ty: ty.clone(), needs, given, fit }
    }
}

fn fit(ty: &Type, needs: usize, args: &[Type], given: &[Option<usize>]) -> Fit {
    if ty.components().is_none() {
        return Fit::Unknown;
    }
    if let ([Type::Scalar(_)], _) | ([Type::Matrix(..)], Type::Matrix(..)) = (args, ty) {
        // One scalar fills a vector or the diagonal; a matrix is cut or filled from the identity.
        return Fit::Fits;
    }
    let mut sum = 0;
    for (i, components) in given.iter().enumerate() {
        if sum >= needs {
            return Fit::TooMany { first_extra: i };
        }
        let Some(components) = components else { return Fit::Unknown };
        sum += components;
    }
    if sum < needs { Fit::TooFew { given: sum } } else { Fit::Fits }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(ty: &str, args: &[&str]) -> Fit {
        let ty = Type::from_name(ty).unwrap();
        let args: Vec<_> = args.iter().map(|a| Type::from_name(a).unwrap()).collect();
        Constructor::new(&ty, &args).fit
    }

    #[test]
    fn components_are_counted_argument_by_argument() {
        assert_eq!(of("vec4", &["vec3", "float"]), Fit::Fits);
        assert_eq!(of("vec3", &["float", "float", "float", "float"]), Fit::TooMany { first_extra: 3 });
        assert_eq!(of("vec3", &["vec4", "float"]), Fit::TooMany { first_extra: 1 });
        assert_eq!(of("vec4", &["vec3"]), Fit::TooFew { given: 3 });
        assert_eq!(of("vec3", &[]), Fit::TooFew { given: 0 });
        // The last argument may be longer than needed.
        assert_eq!(of("vec3", &["vec4"]), Fit::Fits);
        assert_eq!(of("vec3", &["float", "vec4"]), Fit::Fits);
        assert_eq!(of("float", &["vec3"]), Fit::Fits);
    }

    #[test]
    fn one_scalar_and_one_matrix_are_special() {
        assert_eq!(of("vec4", &["float"]), Fit::Fits);
        assert_eq!(of("mat4", &["float"]), Fit::Fits);
        assert_eq!(of("mat4", &["mat3"]), Fit::Fits);
        assert_eq!(of("mat4", &["vec4", "vec4", "vec4", "vec4"]), Fit::Fits);
        assert_eq!(of("mat2", &["vec4", "vec4"]), Fit::TooMany { first_extra: 1 });
        assert_eq!(of("mat4", &["vec4"]), Fit::TooFew { given: 4 });
    }
}
