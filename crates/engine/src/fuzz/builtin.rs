//! Variables that the language knows in a stage, as plain inputs and outputs.

use std::sync::Arc;

use syntax::types::{ArraySize, ScalarType, Type};

/// A variable of a stage.
#[derive(Clone, Copy, Debug)]
pub struct Known {
    name: &'static str,
    /// The type, as GLSL writes it, without array dimensions.
    ty: &'static str,
    /// Number of elements, for an array.
    pub array: Option<u32>,
    /// True for what the stage gives.
    pub output: bool,
}

const fn input(name: &'static str, ty: &'static str) -> Known {
    Known { name, ty, array: None, output: false }
}

const fn output(name: &'static str, ty: &'static str) -> Known {
    Known { name, ty, array: None, output: true }
}

/// Those that a function can be given, or that it can give. What is not here is refused by name when a
/// function that uses it is run.
const ALL: &[Known] = &[
    output("gl_Position", "vec4"),
    output("gl_PointSize", "float"),
    output("gl_FragColor", "vec4"),
    Known { name: "gl_FragData", ty: "vec4", array: Some(8), output: true },
    output("gl_FragDepth", "float"),
    output("gl_FragDepthEXT", "float"),
    input("gl_FragCoord", "vec4"),
    input("gl_PointCoord", "vec2"),
    input("gl_FrontFacing", "bool"),
    input("gl_VertexID", "int"),
    input("gl_InstanceID", "int"),
    input("gl_PrimitiveID", "int"),
    input("gl_GlobalInvocationID", "uvec3"),
    input("gl_LocalInvocationID", "uvec3"),
    input("gl_WorkGroupID", "uvec3"),
    input("gl_NumWorkGroups", "uvec3"),
    input("gl_LocalInvocationIndex", "uint"),
    input("gl_LaunchIDEXT", "uvec3"),
    input("gl_LaunchSizeEXT", "uvec3"),
    input("gl_InstanceCustomIndexEXT", "int"),
    input("gl_GeometryIndexEXT", "int"),
    input("gl_WorldRayOriginEXT", "vec3"),
    input("gl_WorldRayDirectionEXT", "vec3"),
    input("gl_ObjectRayOriginEXT", "vec3"),
    input("gl_ObjectRayDirectionEXT", "vec3"),
    input("gl_RayTminEXT", "float"),
    input("gl_RayTmaxEXT", "float"),
    input("gl_HitTEXT", "float"),
    input("gl_HitKindEXT", "uint"),
    input("gl_IncomingRayFlagsEXT", "uint"),
    input("gl_ObjectToWorldEXT", "mat4x3"),
    input("gl_WorldToObjectEXT", "mat4x3"),
    input("gl_ObjectToWorld3x4EXT", "mat3x4"),
    input("gl_WorldToObject3x4EXT", "mat3x4"),
    input("gl_Vertex", "vec4"),
    input("gl_Normal", "vec3"),
    input("gl_Color", "vec4"),
    input("gl_SecondaryColor", "vec4"),
    input("gl_FogCoord", "float"),
    input("gl_MultiTexCoord0", "vec4"),
    input("gl_MultiTexCoord1", "vec4"),
    input("gl_MultiTexCoord2", "vec4"),
    input("gl_MultiTexCoord3", "vec4"),
    input("gl_ModelViewMatrix", "mat4"),
    input("gl_ProjectionMatrix", "mat4"),
    input("gl_ModelViewProjectionMatrix", "mat4"),
    input("gl_NormalMatrix", "mat3"),
    input("gl_ModelViewMatrixInverse", "mat4"),
    output("gl_FrontColor", "vec4"),
    output("gl_BackColor", "vec4"),
    output("gl_FogFragCoord", "float"),
    // What a control stage gives is what an evaluation stage reads.
    Known { name: "gl_TessLevelOuter", ty: "float", array: Some(4), output: true },
    Known { name: "gl_TessLevelInner", ty: "float", array: Some(2), output: true },
    // What a vertex stage gives is what a fragment stage reads.
    Known { name: "gl_TexCoord", ty: "vec4", array: Some(8), output: true },
];

/// The variable of that name.
pub fn by_name(name: &str) -> Option<Known> {
    ALL.iter().copied().find(|known| known.name == name)
}

/// A declaration under another name.
pub fn declaration(known: Known, name: &str) -> String {
    let dims = known.array.map_or_else(String::new, |n| format!("[{n}]"));
    format!("{} {name}{dims};\n", known.ty)
}

/// Type of a variable: an array where the table says how many elements there are.
pub fn type_of(known: Known) -> Type {
    let element = Type::from_name(known.ty).unwrap_or(Type::Scalar(ScalarType::Float));
    match known.array {
        Some(n) => Type::Array(Arc::new(element), ArraySize::Known(n)),
        None => element,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_type_is_one_that_can_be_fed() {
        for known in ALL.iter().copied() {
            assert!(Type::from_name(known.ty).is_some_and(|ty| ty.shape().is_some()), "{}", known.name);
            assert_eq!(ALL.iter().filter(|other| other.name == known.name).count(), 1, "{}", known.name);
        }
        assert_eq!(declaration(by_name("gl_FragData").unwrap(), "a"), "vec4 a[8];\n");
    }
}
