//! Built-in variables by stage (GLSL 4.60 specification, chapter 7; the older ones of GLSL 1.20).

use std::sync::Arc;

use super::super::Stage;
use super::super::ast::Qualifiers;
use super::super::types::{ArraySize, ScalarType, StructField, StructType, Type};
use base::text::Span;

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Builtin {
    pub ty: Type,
    pub read_only: bool,
}

/// Stages in which a variable exists: v(ertex), c(ontrol), e(valuation), g(eometry), f(ragment),
/// k (compute). Then the type, an array size behind a blank (`?` when it depends on the
/// implementation), and whether it may be written: r(ead) or w(rite).
const TABLE: &[(&str, &str, &str, char)] = &[
    // 7.1 special variables
    (
        "gl_VertexID gl_InstanceID gl_DrawID gl_BaseVertex gl_BaseInstance gl_VertexIndex gl_InstanceIndex \
         gl_DrawIDARB gl_BaseVertexARB gl_BaseInstanceARB",
        "v",
        "int",
        'r',
    ),
    ("gl_Position", "vge", "vec4", 'w'),
    ("gl_PointSize", "vge", "float", 'w'),
    ("gl_ClipDistance gl_CullDistance", "vge", "float ?", 'w'),
    ("gl_ClipVertex", "vge", "vec4", 'w'),
    ("gl_PrimitiveIDIn", "g", "int", 'r'),
    ("gl_InvocationID", "cg", "int", 'r'),
    ("gl_PrimitiveID", "g", "int", 'w'),
    ("gl_PrimitiveID", "cef", "int", 'r'),
    ("gl_Layer gl_ViewportIndex", "vge", "int", 'w'),
    ("gl_Layer gl_ViewportIndex", "f", "int", 'r'),
    ("gl_PatchVerticesIn", "ce", "int", 'r'),
    ("gl_TessLevelOuter", "c", "float 4", 'w'),
    ("gl_TessLevelInner", "c", "float 2", 'w'),
    ("gl_TessLevelOuter", "e", "float 4", 'r'),
    ("gl_TessLevelInner", "e", "float 2", 'r'),
    ("gl_TessCoord", "e", "vec3", 'r'),
    ("gl_FragCoord", "f", "vec4", 'r'),
    ("gl_FrontFacing gl_HelperInvocation", "f", "bool", 'r'),
    ("gl_ClipDistance gl_CullDistance", "f", "float ?", 'r'),
    ("gl_PointCoord", "f", "vec2", 'r'),
    ("gl_SampleID", "f", "int", 'r'),
    ("gl_SamplePosition", "f", "vec2", 'r'),
    ("gl_SampleMaskIn", "f", "int ?", 'r'),
    ("gl_SampleMask", "f", "int ?", 'w'),
    ("gl_FragDepth", "f", "float", 'w'),
    ("gl_FragDepthEXT", "f", "float", 'w'),
    ("gl_FragStencilRefARB gl_FragStencilRefAMD", "f", "int", 'w'),
    ("gl_FragColor", "f", "vec4", 'w'),
    ("gl_FragData", "f", "vec4 ?", 'w'),
    ("gl_NumWorkGroups gl_WorkGroupID gl_LocalInvocationID gl_GlobalInvocationID gl_WorkGroupSize", "k", "uvec3", 'r'),
    ("gl_LocalInvocationIndex", "k", "uint", 'r'),
    ("gl_NumSamples", "f", "int", 'r'),
    // GL_KHR_shader_subgroup
    ("gl_SubgroupSize gl_SubgroupInvocationID", "vcegfk", "uint", 'r'),
    ("gl_NumSubgroups gl_SubgroupID", "k", "uint", 'r'),
    (
        "gl_SubgroupEqMask gl_SubgroupGeMask gl_SubgroupGtMask gl_SubgroupLeMask gl_SubgroupLtMask",
        "vcegfk",
        "uvec4",
        'r',
    ),
    // GL_EXT_ray_tracing and GL_NV_ray_tracing: stages that are read as libraries.
    ("gl_LaunchIDEXT gl_LaunchSizeEXT gl_LaunchIDNV gl_LaunchSizeNV", "", "uvec3", 'r'),
    ("gl_InstanceCustomIndexEXT gl_GeometryIndexEXT gl_InstanceCustomIndexNV gl_RayGeometryIndexNV", "", "int", 'r'),
    (
        "gl_WorldRayOriginEXT gl_WorldRayDirectionEXT gl_ObjectRayOriginEXT gl_ObjectRayDirectionEXT \
         gl_WorldRayOriginNV gl_WorldRayDirectionNV gl_ObjectRayOriginNV gl_ObjectRayDirectionNV",
        "",
        "vec3",
        'r',
    ),
    ("gl_RayTminEXT gl_RayTmaxEXT gl_HitTEXT gl_RayTminNV gl_RayTmaxNV gl_HitTNV", "", "float", 'r'),
    ("gl_IncomingRayFlagsEXT gl_HitKindEXT gl_IncomingRayFlagsNV gl_HitKindNV", "", "uint", 'r'),
    ("gl_ObjectToWorldEXT gl_WorldToObjectEXT gl_ObjectToWorldNV gl_WorldToObjectNV", "", "mat4x3", 'r'),
    ("gl_ObjectToWorld3x4EXT gl_WorldToObject3x4EXT", "", "mat3x4", 'r'),
    // The same and GL_EXT_ray_query; constants
    (
        "gl_RayFlagsNoneEXT gl_RayFlagsOpaqueEXT gl_RayFlagsNoOpaqueEXT gl_RayFlagsTerminateOnFirstHitEXT \
         gl_RayFlagsSkipClosestHitShaderEXT gl_RayFlagsCullBackFacingTrianglesEXT \
         gl_RayFlagsCullFrontFacingTrianglesEXT gl_RayFlagsCullOpaqueEXT gl_RayFlagsCullNoOpaqueEXT \
         gl_RayFlagsSkipTrianglesEXT gl_RayFlagsSkipAABBEXT gl_HitKindFrontFacingTriangleEXT \
         gl_HitKindBackFacingTriangleEXT gl_RayQueryCommittedIntersectionNoneEXT \
         gl_RayQueryCommittedIntersectionTriangleEXT gl_RayQueryCommittedIntersectionGeneratedEXT \
         gl_RayQueryCandidateIntersectionTriangleEXT gl_RayQueryCandidateIntersectionAABBEXT",
        "vcegfk",
        "uint",
        'r',
    ),
    // GL_KHR_memory_scope_semantics; constants
    (
        "gl_ScopeDevice gl_ScopeWorkgroup gl_ScopeSubgroup gl_ScopeInvocation gl_ScopeQueueFamily \
         gl_SemanticsRelaxed gl_SemanticsAcquire gl_SemanticsRelease gl_SemanticsAcquireRelease \
         gl_SemanticsMakeAvailable gl_SemanticsMakeVisible gl_SemanticsVolatile gl_StorageSemanticsNone \
         gl_StorageSemanticsBuffer gl_StorageSemanticsShared gl_StorageSemanticsImage gl_StorageSemanticsOutput",
        "vcegfk",
        "int",
        'r',
    ),
    // The compatibility profile
    ("gl_Vertex gl_Color gl_SecondaryColor", "v", "vec4", 'r'),
    ("gl_Normal", "v", "vec3", 'r'),
    (
        "gl_MultiTexCoord0 gl_MultiTexCoord1 gl_MultiTexCoord2 gl_MultiTexCoord3 gl_MultiTexCoord4 gl_MultiTexCoord5 \
         gl_MultiTexCoord6 gl_MultiTexCoord7",
        "v",
        "vec4",
        'r',
    ),
    ("gl_FogCoord", "v", "float", 'r'),
    ("gl_FrontColor gl_BackColor gl_FrontSecondaryColor gl_BackSecondaryColor", "vge", "vec4", 'w'),
    ("gl_TexCoord", "vge", "vec4 ?", 'w'),
    ("gl_FogFragCoord", "vge", "float", 'w'),
    ("gl_Color gl_SecondaryColor", "f", "vec4", 'r'),
    ("gl_TexCoord", "f", "vec4 ?", 'r'),
    ("gl_FogFragCoord", "f", "float", 'r'),
    (
        "gl_ModelViewMatrix gl_ProjectionMatrix gl_ModelViewProjectionMatrix gl_ModelViewMatrixInverse \
         gl_ProjectionMatrixInverse gl_ModelViewProjectionMatrixInverse gl_ModelViewMatrixTranspose \
         gl_ProjectionMatrixTranspose gl_ModelViewProjectionMatrixTranspose gl_ModelViewMatrixInverseTranspose \
         gl_ProjectionMatrixInverseTranspose gl_ModelViewProjectionMatrixInverseTranspose",
        "vcegf",
        "mat4",
        'r',
    ),
    (
        "gl_TextureMatrix gl_TextureMatrixInverse gl_TextureMatrixTranspose gl_TextureMatrixInverseTranspose",
        "vcegf",
        "mat4 ?",
        'r',
    ),
    ("gl_NormalMatrix", "vcegf", "mat3", 'r'),
    ("gl_NormalScale", "vcegf", "float", 'r'),
    (
        "gl_ClipPlane gl_TextureEnvColor gl_EyePlaneS gl_EyePlaneT gl_EyePlaneR gl_EyePlaneQ gl_ObjectPlaneS \
         gl_ObjectPlaneT gl_ObjectPlaneR gl_ObjectPlaneQ",
        "vcegf",
        "vec4 ?",
        'r',
    ),
];

/// Variable, whether it is an array, name, members with their types.
type Structure = (&'static str, bool, &'static str, &'static [(&'static str, &'static str)]);

/// Structures of the compatibility profile: variable, array (`?`) or not, name, members.
const STRUCTS: &[Structure] = &[
    ("gl_DepthRange", false, "gl_DepthRangeParameters", &[("near", "float"), ("far", "float"), ("diff", "float")]),
    (
        "gl_LightSource",
        true,
        "gl_LightSourceParameters",
        &[
            ("ambient", "vec4"),
            ("diffuse", "vec4"),
            ("specular", "vec4"),
            ("position", "vec4"),
            ("halfVector", "vec4"),
            ("spotDirection", "vec3"),
            ("spotExponent", "float"),
            ("spotCutoff", "float"),
            ("spotCosCutoff", "float"),
            ("constantAttenuation", "float"),
            ("linearAttenuation", "float"),
            ("quadraticAttenuation", "float"),
        ],
    ),
    ("gl_FrontMaterial", false, "gl_MaterialParameters", MATERIAL),
    ("gl_BackMaterial", false, "gl_MaterialParameters", MATERIAL),
    ("gl_LightModel", false, "gl_LightModelParameters", &[("ambient", "vec4")]),
    ("gl_FrontLightModelProduct", false, "gl_LightModelProducts", &[("sceneColor", "vec4")]),
    ("gl_BackLightModelProduct", false, "gl_LightModelProducts", &[("sceneColor", "vec4")]),
    ("gl_FrontLightProduct", true, "gl_LightProducts", PRODUCTS),
    ("gl_BackLightProduct", true, "gl_LightProducts", PRODUCTS),
    (
        "gl_Fog",
        false,
        "gl_FogParameters",
        &[("color", "vec4"), ("density", "float"), ("start", "float"), ("end", "float"), ("scale", "float")],
    ),
    (
        "gl_Point",
        false,
        "gl_PointParameters",
        &[
            ("size", "float"),
            ("sizeMin", "float"),
            ("sizeMax", "float"),
            ("fadeThresholdSize", "float"),
            ("distanceConstantAttenuation", "float"),
            ("distanceLinearAttenuation", "float"),
            ("distanceQuadraticAttenuation", "float"),
        ],
    ),
];

const MATERIAL: &[(&str, &str)] =
    &[("emission", "vec4"), ("ambient", "vec4"), ("diffuse", "vec4"), ("specular", "vec4"), ("shininess", "float")];
const PRODUCTS: &[(&str, &str)] = &[("ambient", "vec4"), ("diffuse", "vec4"), ("specular", "vec4")];

/// The letter of a stage in the tables; `*` for a library.
pub(super) fn letter(stage: Stage) -> char {
    match stage {
        Stage::Vertex => 'v',
        Stage::TessControl => 'c',
        Stage::TessEvaluation => 'e',
        Stage::Geometry => 'g',
        Stage::Fragment => 'f',
        Stage::Compute => 'k',
        Stage::Library => '*',
    }
}

/// The built-in variable of that name in a stage; a library may use those of every stage. The
/// size of `gl_in` is the number of vertices of the input primitive, where that is known.
pub(crate) fn variable(name: &str, stage: Stage, vertices: Option<u32>) -> Option<Builtin> {
    if !name.starts_with("gl_") {
        return None;
    }
    let letter = letter(stage);
    let has = |letters: &str| letter == '*' || letters.contains(letter);
    if let Some((_, _, ty, access)) =
        TABLE.iter().find(|(names, stages, ..)| has(stages) && names.split_whitespace().any(|n| n == name))
    {
        let (base, size) = ty.split_once(' ').unwrap_or((ty, ""));
        let base = Type::from_name(base)?;
        let ty = match size {
            "" => base,
            // These take a size when they are declared again, or by their greatest index.
            "?" if matches!(name, "gl_ClipDistance" | "gl_CullDistance" | "gl_TexCoord") => {
                Type::Array(Arc::new(base), ArraySize::Unsized)
            }
            "?" => Type::Array(Arc::new(base), ArraySize::Unknown),
            n => base.array(n.parse().ok()?),
        };
        return Some(Builtin { ty, read_only: *access == 'r' });
    }
    if let Some((_, array, type_name, members)) = STRUCTS.iter().find(|row| row.0 == name).filter(|_| has("vcegf")) {
        let ty = structure(type_name, members);
        let ty = if *array { Type::Array(Arc::new(ty), ArraySize::Unknown) } else { ty };
        return Some(Builtin { ty, read_only: true });
    }
    let input = name == "gl_in" && has("gce");
    if input || (name == "gl_out" && has("c")) {
        let size = match vertices {
            Some(n) if input => ArraySize::Known(n),
            _ => ArraySize::Unknown,
        };
        return Some(Builtin { ty: Type::Array(Arc::new(per_vertex()), size), read_only: input });
    }
    // Implementation limits: constants whose value is not known here.
    if let Some(limit) = name.strip_prefix("gl_Max").or_else(|| name.strip_prefix("gl_Min")) {
        let vector = limit.starts_with("ComputeWorkGroup") && !limit.ends_with("Invocations");
        return Some(Builtin { ty: Type::vector(ScalarType::Int, if vector { 3 } else { 1 }), read_only: true });
    }
    None
}

/// True for a built-in variable that some stage gives, whatever others write to it.
pub fn is_given_by_a_stage(name: &str) -> bool {
    TABLE.iter().any(|(names, _, _, access)| *access == 'r' && names.split_whitespace().any(|n| n == name))
}

/// The structure of a built-in variable, by its own name such as `gl_FogParameters`.
pub(crate) fn structure_type(name: &str) -> Option<Type> {
    STRUCTS.iter().find(|row| row.2 == name).map(|row| structure(row.2, row.3))
}

fn structure(name: &str, members: &[(&str, &str)]) -> Type {
    let fields = members
        .iter()
        .map(|(name, ty)| StructField {
            name: (*name).to_owned(),
            ty: Type::from_name(ty).unwrap_or(Type::Error),
            span: Span::default(),
            qualifiers: Qualifiers::default(),
        })
        .collect();
    Type::Struct(Arc::new(StructType { name: name.to_owned(), fields, span: Span::default() }))
}

/// `gl_PerVertex`: members of `gl_in[i]`.
fn per_vertex() -> Type {
    let Type::Struct(plain) = structure(
        "gl_PerVertex",
        &[
            ("gl_Position", "vec4"),
            ("gl_PointSize", "float"),
            ("gl_ClipVertex", "vec4"),
            ("gl_FrontColor", "vec4"),
            ("gl_BackColor", "vec4"),
            ("gl_FrontSecondaryColor", "vec4"),
            ("gl_BackSecondaryColor", "vec4"),
            ("gl_FogFragCoord", "float"),
        ],
    ) else {
        return Type::Error;
    };
    let mut whole = (*plain).clone();
    for (name, ty) in [("gl_ClipDistance", Type::FLOAT), ("gl_CullDistance", Type::FLOAT), ("gl_TexCoord", Type::VEC4)]
    {
        let ty = Type::Array(Arc::new(ty), ArraySize::Unsized);
        let (span, qualifiers) = (Span::default(), Qualifiers::default());
        whole.fields.push(StructField { name: name.to_owned(), ty, span, qualifiers });
    }
    Type::Struct(Arc::new(whole))
}

/// Names of all built-in variables of a stage, for suggestions.
pub(crate) fn names(stage: Stage) -> impl Iterator<Item = &'static str> {
    let letter = letter(stage);
    let own = TABLE
        .iter()
        .filter(move |(_, stages, ..)| letter == '*' || stages.contains(letter))
        .flat_map(|(names, ..)| names.split_whitespace());
    own.chain(matches!(stage, Stage::Geometry | Stage::TessControl | Stage::TessEvaluation).then_some("gl_in"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(name: &str, stage: Stage) -> Option<String> {
        variable(name, stage, Some(4)).map(|b| format!("{} {}", b.ty, b.read_only))
    }

    #[test]
    fn variables_belong_to_stages() {
        assert_eq!(of("gl_Position", Stage::Vertex).as_deref(), Some("vec4 false"));
        assert_eq!(of("gl_Position", Stage::Fragment), None);
        assert_eq!(of("gl_FragCoord", Stage::Fragment).as_deref(), Some("vec4 true"));
        assert_eq!(of("gl_in", Stage::Geometry).as_deref(), Some("gl_PerVertex[4] true"));
        assert_eq!(of("gl_in", Stage::Vertex), None);
        assert_eq!(of("gl_PrimitiveID", Stage::Geometry).as_deref(), Some("int false"));
        assert_eq!(of("gl_PrimitiveID", Stage::Fragment).as_deref(), Some("int true"));
        assert_eq!(of("gl_FragCoord", Stage::Library).as_deref(), Some("vec4 true"));
        assert_eq!(of("gl_MaxTextureImageUnits", Stage::Vertex).as_deref(), Some("int true"));
        assert_eq!(of("gl_Positon", Stage::Vertex), None);
    }

    #[test]
    fn every_type_of_the_tables_exists() {
        for (_, _, ty, access) in TABLE {
            let base = ty.split(' ').next().unwrap();
            assert!(Type::from_name(base).is_some() && "rw".contains(*access), "{ty}");
        }
        for (.., members) in STRUCTS {
            assert!(members.iter().all(|(_, ty)| Type::from_name(ty).is_some()));
        }
    }
}
