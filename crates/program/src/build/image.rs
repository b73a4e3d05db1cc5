//! Images that a shader reads and writes (GLSL 4.60, 8.12).

use naga::Expression;

use super::function::{Fun, Val};
use super::{Expr, Result};
use base::text::Span;
use syntax::BuiltinFunction as F;
use syntax::ast::{QualifierKind, Qualifiers};
use syntax::types::{OpaqueType, ScalarType, Type};

/// What the declaration of an image says.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct ImageLayout {
    pub format: Option<String>,
    pub reads: bool,
    pub writes: bool,
}

impl ImageLayout {
    pub(super) fn of(qualifiers: &Qualifiers) -> Self {
        use syntax::ast::MemoryQualifier as Q;
        let has = |q| qualifiers.list.iter().any(|k| k.kind == QualifierKind::Memory(q));
        let known = |name: &str| storage_format(sized_format(name, ScalarType::Uint)).is_some();
        let mut entries = qualifiers.layouts().flat_map(|(entries, _)| entries);
        let format = entries.find(|e| known(&e.key.name)).map(|e| e.key.name.clone());
        Self { format, reads: !has(Q::WriteOnly), writes: !has(Q::ReadOnly) }
    }
}

/// The format that a size stands for (GL_EXT_shader_image_load_store); other names stay as they are.
pub(super) fn sized_format(name: &str, scalar: ScalarType) -> &str {
    match (name, scalar) {
        ("size1x8", ScalarType::Int) => "r8i",
        ("size1x8", _) => "r8ui",
        ("size1x16", ScalarType::Float | ScalarType::Double) => "r16f",
        ("size1x16", ScalarType::Int) => "r16i",
        ("size1x16", _) => "r16ui",
        ("size1x32", ScalarType::Float | ScalarType::Double) => "r32f",
        ("size1x32", ScalarType::Int) => "r32i",
        ("size1x32", _) => "r32ui",
        ("size2x32", ScalarType::Float | ScalarType::Double) => "rg32f",
        ("size2x32", ScalarType::Int) => "rg32i",
        ("size2x32", _) => "rg32ui",
        ("size4x32", ScalarType::Float | ScalarType::Double) => "rgba32f",
        ("size4x32", ScalarType::Int) => "rgba32i",
        ("size4x32", _) => "rgba32ui",
        _ => name,
    }
}

/// True where images are read whose format the host alone knows (`GL_EXT_shader_image_load_formatted`).
pub(super) fn loads_any_format(shader: &syntax::Shader) -> bool {
    shader.extensions().iter().any(|extension| extension.name == "GL_EXT_shader_image_load_formatted")
}

pub(super) fn storage_format(name: &str) -> Option<naga::StorageFormat> {
    use naga::StorageFormat as F;
    Some(match name {
        "rgba32f" => F::Rgba32Float,
        "rgba16f" => F::Rgba16Float,
        "rg32f" => F::Rg32Float,
        "rg16f" => F::Rg16Float,
        "r11f_g11f_b10f" => F::Rg11b10Ufloat,
        "r32f" => F::R32Float,
        "r16f" => F::R16Float,
        "rgba16" => F::Rgba16Unorm,
        "rgb10_a2" => F::Rgb10a2Unorm,
        "rgba8" => F::Rgba8Unorm,
        "rg16" => F::Rg16Unorm,
        "rg8" => F::Rg8Unorm,
        "r16" => F::R16Unorm,
        "r8" => F::R8Unorm,
        "rgba16_snorm" => F::Rgba16Snorm,
        "rgba8_snorm" => F::Rgba8Snorm,
        "rg16_snorm" => F::Rg16Snorm,
        "rg8_snorm" => F::Rg8Snorm,
        "r16_snorm" => F::R16Snorm,
        "r8_snorm" => F::R8Snorm,
        "rgba32i" => F::Rgba32Sint,
        "rgba16i" => F::Rgba16Sint,
        "rgba8i" => F::Rgba8Sint,
        "rg32i" => F::Rg32Sint,
        "rg16i" => F::Rg16Sint,
        "rg8i" => F::Rg8Sint,
        "r32i" => F::R32Sint,
        "r16i" => F::R16Sint,
        "r8i" => F::R8Sint,
        "rgba32ui" => F::Rgba32Uint,
        "rgba16ui" => F::Rgba16Uint,
        "rgb10_a2ui" => F::Rgb10a2Uint,
        "rgba8ui" => F::Rgba8Uint,
        "rg32ui" => F::Rg32Uint,
        "rg16ui" => F::Rg16Uint,
        "rg8ui" => F::Rg8Uint,
        "r32ui" => F::R32Uint,
        "r16ui" => F::R16Uint,
        "r8ui" => F::R8Uint,
        _ => return None,
    })
}

impl Fun<'_, '_> {
    pub(super) fn image_call(
        &mut self,
        function: F,
        ty: OpaqueType,
        image: Expr,
        rest: &[Option<Val>],
        span: Span,
    ) -> Result<Option<Option<Val>>> {
        let value = |k: usize| rest.get(k).cloned().flatten();
        match function {
            F::ImageSize => Ok(Some(Some(self.size(ty, image, None)?))),
            F::ImageLoad | F::ImageStore => {
                let Some(at) = value(0) else {
                    return Err(self.build.unsupported(
                        span,
                        format!("`{function}` like this"),
                        "give it a coordinate",
                    ));
                };
                let (at, array_index) = self.texel(ty, &at)?;
                if function == F::ImageLoad {
                    let load =
                        Expression::ImageLoad { image, coordinate: at.e, array_index, sample: None, level: None };
                    return Ok(Some(Some(Val { e: self.add(load), ty: Type::Vector(ty.scalar, 4) })));
                }
                let Some(value) = value(1) else {
                    return Err(self.build.unsupported(span, "`imageStore` like this", "give it a value"));
                };
                let value = self.convert(value, &Type::Vector(ty.scalar, 4))?;
                let store = naga::Statement::ImageStore { image, coordinate: at.e, array_index, value: value.e };
                self.push(store);
                Ok(Some(None))
            }
            _ => Err(self.build.unsupported(span, format!("`{function}`"), "use a storage buffer")),
        }
    }
}
