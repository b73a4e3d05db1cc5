//! Types by the numbers that OpenGL has for them.

use base::value::{Scalar, Shape};

/// The type of a component.
pub fn base(scalar: Scalar) -> u32 {
    match scalar {
        Scalar::F32 => glow::FLOAT,
        Scalar::I32 => glow::INT,
        Scalar::U32 => glow::UNSIGNED_INT,
        Scalar::Bool => glow::BOOL,
    }
}

/// The type of a value that is no array; `None` for one that OpenGL does not have.
pub fn of(shape: Shape) -> Option<u32> {
    Some(match (shape.scalar, shape.columns, shape.rows) {
        (scalar, 1, 1) => base(scalar),
        (Scalar::F32, 1, 2) => glow::FLOAT_VEC2,
        (Scalar::F32, 1, 3) => glow::FLOAT_VEC3,
        (Scalar::F32, 1, 4) => glow::FLOAT_VEC4,
        (Scalar::I32, 1, 2) => glow::INT_VEC2,
        (Scalar::I32, 1, 3) => glow::INT_VEC3,
        (Scalar::I32, 1, 4) => glow::INT_VEC4,
        (Scalar::U32, 1, 2) => glow::UNSIGNED_INT_VEC2,
        (Scalar::U32, 1, 3) => glow::UNSIGNED_INT_VEC3,
        (Scalar::U32, 1, 4) => glow::UNSIGNED_INT_VEC4,
        (Scalar::Bool, 1, 2) => glow::BOOL_VEC2,
        (Scalar::Bool, 1, 3) => glow::BOOL_VEC3,
        (Scalar::Bool, 1, 4) => glow::BOOL_VEC4,
        (Scalar::F32, 2, 2) => glow::FLOAT_MAT2,
        (Scalar::F32, 2, 3) => glow::FLOAT_MAT2x3,
        (Scalar::F32, 2, 4) => glow::FLOAT_MAT2x4,
        (Scalar::F32, 3, 2) => glow::FLOAT_MAT3x2,
        (Scalar::F32, 3, 3) => glow::FLOAT_MAT3,
        (Scalar::F32, 3, 4) => glow::FLOAT_MAT3x4,
        (Scalar::F32, 4, 2) => glow::FLOAT_MAT4x2,
        (Scalar::F32, 4, 3) => glow::FLOAT_MAT4x3,
        (Scalar::F32, 4, 4) => glow::FLOAT_MAT4,
        _ => return None,
    })
}

/// True for a sampler.
pub fn is_sampler(code: u32) -> bool {
    matches!(
        code,
        glow::SAMPLER_1D
            | glow::SAMPLER_2D
            | glow::SAMPLER_3D
            | glow::SAMPLER_CUBE
            | glow::SAMPLER_1D_SHADOW
            | glow::SAMPLER_2D_SHADOW
            | glow::SAMPLER_1D_ARRAY
            | glow::SAMPLER_2D_ARRAY
            | glow::SAMPLER_1D_ARRAY_SHADOW
            | glow::SAMPLER_2D_ARRAY_SHADOW
            | glow::SAMPLER_CUBE_SHADOW
            | glow::SAMPLER_CUBE_MAP_ARRAY
            | glow::SAMPLER_CUBE_MAP_ARRAY_SHADOW
            | glow::INT_SAMPLER_1D
            | glow::INT_SAMPLER_2D
            | glow::INT_SAMPLER_3D
            | glow::INT_SAMPLER_CUBE
            | glow::INT_SAMPLER_2D_ARRAY
            | glow::INT_SAMPLER_CUBE_MAP_ARRAY
            | glow::UNSIGNED_INT_SAMPLER_1D
            | glow::UNSIGNED_INT_SAMPLER_2D
            | glow::UNSIGNED_INT_SAMPLER_3D
            | glow::UNSIGNED_INT_SAMPLER_CUBE
            | glow::UNSIGNED_INT_SAMPLER_2D_ARRAY
            | glow::UNSIGNED_INT_SAMPLER_CUBE_MAP_ARRAY
    )
}
