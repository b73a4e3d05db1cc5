//! When built-in functions and variables and the names of types came, and in which stages they are.

use std::collections::HashMap;
use std::sync::LazyLock;

use super::super::Stage;
use super::super::language::{Language, NEVER, Since};
use super::super::types::{OpaqueKind, ScalarType, TextureDim, Type};

/// Names, stages (`*` for all; letters as in the table of variables), first desktop version, first ES
/// version, extensions. What is in no row came with the first version.
type Row = (&'static str, &'static str, u32, u32, &'static [&'static str]);

/// The rows of each name: the table is asked for every call and every name of a shader.
type Rows = LazyLock<HashMap<&'static str, Vec<&'static Row>>>;

static FUNCTION_ROWS: Rows = LazyLock::new(|| by_name(FUNCTIONS));
static VARIABLE_ROWS: Rows = LazyLock::new(|| by_name(VARIABLES));

fn by_name(rows: &'static [Row]) -> HashMap<&'static str, Vec<&'static Row>> {
    let mut found: HashMap<&str, Vec<&Row>> = HashMap::new();
    for row in rows {
        row.0.split_whitespace().for_each(|name| found.entry(name).or_default().push(row));
    }
    found
}

/// Extensions of subgroups: each brings along what the basic one has.
const BASIC: &[&str] = &[
    "KHR_shader_subgroup_basic",
    "KHR_shader_subgroup_vote",
    "KHR_shader_subgroup_ballot",
    "KHR_shader_subgroup_arithmetic",
    "KHR_shader_subgroup_shuffle",
    "KHR_shader_subgroup_shuffle_relative",
    "KHR_shader_subgroup_rotate",
    "KHR_shader_subgroup_clustered",
    "KHR_shader_subgroup_quad",
];

/// The extension that brings functions with a scope and an order of memory, and the names of these.
const SCOPES: &[&str] = &["KHR_memory_scope_semantics"];

/// Extensions that bring types which say their size, the one that brings nothing else first.
const INT8: &[&str] = &[
    "EXT_shader_explicit_arithmetic_types_int8",
    "EXT_shader_explicit_arithmetic_types",
    "EXT_shader_8bit_storage",
    "NV_gpu_shader5",
];
const INT16: &[&str] = &[
    "EXT_shader_explicit_arithmetic_types_int16",
    "EXT_shader_explicit_arithmetic_types",
    "EXT_shader_16bit_storage",
    "AMD_gpu_shader_int16",
    "NV_gpu_shader5",
];
const INT32: &[&str] =
    &["EXT_shader_explicit_arithmetic_types_int32", "EXT_shader_explicit_arithmetic_types", "NV_gpu_shader5"];
const INT64: &[&str] = &[
    "EXT_shader_explicit_arithmetic_types_int64",
    "EXT_shader_explicit_arithmetic_types",
    "ARB_gpu_shader_int64",
    "AMD_gpu_shader_int64",
    "NV_gpu_shader5",
];
const FLOAT16: &[&str] = &[
    "EXT_shader_explicit_arithmetic_types_float16",
    "EXT_shader_explicit_arithmetic_types",
    "EXT_shader_16bit_storage",
    "AMD_gpu_shader_half_float",
    "NV_gpu_shader5",
];
const FLOAT32: &[&str] =
    &["EXT_shader_explicit_arithmetic_types_float32", "EXT_shader_explicit_arithmetic_types", "NV_gpu_shader5"];
const FLOAT64: &[&str] =
    &["EXT_shader_explicit_arithmetic_types_float64", "EXT_shader_explicit_arithmetic_types", "NV_gpu_shader5"];

const FUNCTIONS: &[Row] = &[
    ("sinh cosh tanh asinh acosh atanh trunc round roundEven modf isnan isinf", "*", 130, 300, &["EXT_gpu_shader4"]),
    ("outerProduct transpose", "*", 120, 300, &[]),
    ("inverse", "*", 140, 300, &[]),
    ("determinant", "*", 150, 300, &[]),
    (
        "floatBitsToInt floatBitsToUint intBitsToFloat uintBitsToFloat",
        "*",
        330,
        300,
        &["ARB_shader_bit_encoding", "ARB_gpu_shader5", "MESA_shader_integer_functions"],
    ),
    ("fma", "*", 400, 320, &["ARB_gpu_shader5"]),
    ("frexp ldexp", "*", 400, 310, &["ARB_gpu_shader5", "MESA_shader_integer_functions"]),
    ("packUnorm2x16 unpackUnorm2x16", "*", 400, 300, &["ARB_gpu_shader5", "ARB_shading_language_packing"]),
    (
        "packUnorm4x8 unpackUnorm4x8 packSnorm4x8 unpackSnorm4x8",
        "*",
        400,
        310,
        &["ARB_gpu_shader5", "ARB_shading_language_packing"],
    ),
    ("packSnorm2x16 unpackSnorm2x16 packHalf2x16 unpackHalf2x16", "*", 420, 300, &["ARB_shading_language_packing"]),
    ("packDouble2x32 unpackDouble2x32", "*", 400, NEVER, &["ARB_gpu_shader_fp64"]),
    (
        "uaddCarry usubBorrow umulExtended imulExtended bitfieldExtract bitfieldInsert bitfieldReverse bitCount \
         findLSB findMSB",
        "*",
        400,
        310,
        &["ARB_gpu_shader5", "MESA_shader_integer_functions"],
    ),
    ("atomicCounter atomicCounterIncrement atomicCounterDecrement", "*", 420, 310, &["ARB_shader_atomic_counters"]),
    (
        "atomicAdd atomicMin atomicMax atomicAnd atomicOr atomicXor atomicExchange atomicCompSwap",
        "*",
        430,
        310,
        &["ARB_shader_storage_buffer_object", "ARB_compute_shader"],
    ),
    ("imageLoad imageStore", "*", 420, 310, &["ARB_shader_image_load_store"]),
    (
        "imageAtomicAdd imageAtomicMin imageAtomicMax imageAtomicAnd imageAtomicOr imageAtomicXor \
         imageAtomicExchange imageAtomicCompSwap",
        "*",
        420,
        320,
        &["ARB_shader_image_load_store"],
    ),
    ("imageSize", "*", 430, 310, &["ARB_shader_image_size"]),
    ("textureSamples imageSamples", "*", 450, NEVER, &["ARB_shader_texture_image_samples"]),
    ("dFdx dFdy fwidth", "fk", 110, 300, &["OES_standard_derivatives"]),
    ("dFdxFine dFdyFine fwidthFine dFdxCoarse dFdyCoarse fwidthCoarse", "fk", 450, NEVER, &["ARB_derivative_control"]),
    ("interpolateAtCentroid interpolateAtSample interpolateAtOffset", "f", 400, 320, &["ARB_gpu_shader5"]),
    ("noise1 noise2 noise3 noise4", "*", 110, NEVER, &[]),
    ("EmitVertex EndPrimitive", "g", 150, 320, &["OES_geometry_shader", "EXT_geometry_shader"]),
    ("EmitStreamVertex EndStreamPrimitive", "g", 400, NEVER, &["ARB_gpu_shader5"]),
    ("barrier", "ck", 400, 310, &["ARB_tessellation_shader", "ARB_compute_shader"]),
    ("memoryBarrier", "*", 420, 310, &["ARB_shader_image_load_store"]),
    ("controlBarrier", "*", NEVER, NEVER, SCOPES),
    ("atomicLoad atomicStore", "*", NEVER, NEVER, SCOPES),
    ("memoryBarrierAtomicCounter memoryBarrierBuffer memoryBarrierImage", "*", 430, 310, &["ARB_compute_shader"]),
    ("groupMemoryBarrier memoryBarrierShared", "k", 430, 310, &["ARB_compute_shader"]),
    ("anyInvocation allInvocations allInvocationsEqual", "*", 460, NEVER, &[]),
    ("anyInvocationARB allInvocationsARB allInvocationsEqualARB", "*", NEVER, NEVER, &["ARB_shader_group_vote"]),
    (
        "subgroupElect subgroupMemoryBarrier subgroupMemoryBarrierBuffer subgroupMemoryBarrierImage",
        "*",
        NEVER,
        NEVER,
        BASIC,
    ),
    ("subgroupBarrier", "*", NEVER, NEVER, BASIC),
    ("subgroupMemoryBarrierShared", "k", NEVER, NEVER, BASIC),
    ("subgroupAll subgroupAny subgroupAllEqual", "*", NEVER, NEVER, &["KHR_shader_subgroup_vote"]),
    (
        "subgroupBroadcast subgroupBroadcastFirst subgroupBallot subgroupInverseBallot subgroupBallotBitExtract \
         subgroupBallotBitCount subgroupBallotInclusiveBitCount subgroupBallotExclusiveBitCount subgroupBallotFindLSB \
         subgroupBallotFindMSB",
        "*",
        NEVER,
        NEVER,
        &["KHR_shader_subgroup_ballot"],
    ),
    ("subgroupShuffle subgroupShuffleXor", "*", NEVER, NEVER, &["KHR_shader_subgroup_shuffle"]),
    ("subgroupShuffleUp subgroupShuffleDown", "*", NEVER, NEVER, &["KHR_shader_subgroup_shuffle_relative"]),
    ("subgroupRotate subgroupClusteredRotate", "*", NEVER, NEVER, &["KHR_shader_subgroup_rotate"]),
    (
        "subgroupQuadBroadcast subgroupQuadSwapHorizontal subgroupQuadSwapVertical subgroupQuadSwapDiagonal",
        "*",
        NEVER,
        NEVER,
        &["KHR_shader_subgroup_quad"],
    ),
    (
        "subgroupAdd subgroupMul subgroupMin subgroupMax subgroupAnd subgroupOr subgroupXor subgroupInclusiveAdd \
         subgroupInclusiveMul subgroupInclusiveMin subgroupInclusiveMax subgroupInclusiveAnd subgroupInclusiveOr \
         subgroupInclusiveXor subgroupExclusiveAdd subgroupExclusiveMul subgroupExclusiveMin subgroupExclusiveMax \
         subgroupExclusiveAnd subgroupExclusiveOr subgroupExclusiveXor",
        "*",
        NEVER,
        NEVER,
        &["KHR_shader_subgroup_arithmetic"],
    ),
    (
        "subgroupClusteredAdd subgroupClusteredMul subgroupClusteredMin subgroupClusteredMax subgroupClusteredAnd \
         subgroupClusteredOr subgroupClusteredXor",
        "*",
        NEVER,
        NEVER,
        &["KHR_shader_subgroup_clustered"],
    ),
    (
        "pack16 pack32 unpack8 unpack16",
        "*",
        NEVER,
        NEVER,
        &[
            "EXT_shader_explicit_arithmetic_types",
            "EXT_shader_explicit_arithmetic_types_int8",
            "EXT_shader_explicit_arithmetic_types_int16",
        ],
    ),
    ("packFloat2x16 unpackFloat2x16", "*", NEVER, NEVER, FLOAT16),
    (
        "float16BitsToInt16 float16BitsToUint16 int16BitsToFloat16 uint16BitsToFloat16 halfBitsToInt16 halfBitsToUint16 \
         int16BitsToHalf uint16BitsToHalf",
        "*",
        NEVER,
        NEVER,
        FLOAT16,
    ),
    ("ftransform", "v", 110, NEVER, &[]),
    (
        "texture1D texture1DProj texture3D texture3DProj shadow1D shadow2D shadow1DProj shadow2DProj",
        "*",
        110,
        NEVER,
        &["OES_texture_3D"],
    ),
    (
        "texture1DLod texture1DProjLod texture3DLod texture3DProjLod shadow1DLod shadow1DProjLod shadow2DLod \
         shadow2DProjLod",
        "v",
        110,
        NEVER,
        &[],
    ),
    ("texture2DLod texture2DProjLod textureCubeLod", "v", 110, 100, &[]),
    (
        "texture1DGradARB texture2DGradARB texture3DGradARB textureCubeGradARB",
        "*",
        NEVER,
        NEVER,
        &["ARB_shader_texture_lod"],
    ),
    (
        "texture2DLodEXT textureCubeLodEXT texture2DGradEXT textureCubeGradEXT",
        "*",
        NEVER,
        NEVER,
        &["EXT_shader_texture_lod"],
    ),
    ("texture2DRect texture2DRectProj shadow2DRect shadow2DRectProj", "*", 110, NEVER, &["ARB_texture_rectangle"]),
    ("texture1DArray texture2DArray", "*", NEVER, NEVER, &["EXT_texture_array", "EXT_gpu_shader4"]),
    (
        "texture textureProj textureLod textureOffset texelFetch texelFetchOffset textureProjOffset \
         textureLodOffset textureProjLod textureProjLodOffset textureGrad textureGradOffset textureProjGrad \
         textureProjGradOffset textureSize",
        "*",
        130,
        300,
        &[],
    ),
    ("textureQueryLod", "f", 400, NEVER, &["ARB_texture_query_lod"]),
    ("textureQueryLevels", "*", 430, NEVER, &["ARB_texture_query_levels"]),
    ("textureGather textureGatherOffset", "*", 400, 310, &["ARB_texture_gather", "ARB_gpu_shader5"]),
    ("textureGatherOffsets", "*", 400, 320, &["ARB_gpu_shader5"]),
    ("subpassLoad", "f", NEVER, NEVER, &["KHR_vulkan_glsl"]),
    (
        "atomicCounterAdd atomicCounterSubtract atomicCounterMin atomicCounterMax atomicCounterAnd atomicCounterOr \
         atomicCounterXor atomicCounterExchange atomicCounterCompSwap",
        "*",
        460,
        NEVER,
        &[],
    ),
];

const VARIABLES: &[Row] = &[
    ("gl_VertexID", "*", 130, 300, &["EXT_gpu_shader4"]),
    ("gl_InstanceID", "*", 140, 300, &["ARB_draw_instanced", "EXT_gpu_shader4"]),
    ("gl_DrawID gl_BaseVertex gl_BaseInstance", "*", 460, NEVER, &[]),
    ("gl_DrawIDARB gl_BaseVertexARB gl_BaseInstanceARB", "*", NEVER, NEVER, &["ARB_shader_draw_parameters"]),
    ("gl_ClipDistance", "*", 130, NEVER, &["EXT_clip_cull_distance", "APPLE_clip_distance"]),
    ("gl_CullDistance", "*", 450, NEVER, &["ARB_cull_distance", "EXT_clip_cull_distance"]),
    ("gl_Layer", "g", 150, 320, &[]),
    ("gl_Layer", "f", 430, 320, &["ARB_fragment_layer_viewport"]),
    ("gl_Layer", "ve", NEVER, NEVER, &["ARB_shader_viewport_layer_array", "AMD_vertex_shader_layer"]),
    ("gl_ViewportIndex", "g", 410, NEVER, &["ARB_viewport_array"]),
    ("gl_ViewportIndex", "f", 430, NEVER, &["ARB_fragment_layer_viewport"]),
    ("gl_ViewportIndex", "ve", NEVER, NEVER, &["ARB_shader_viewport_layer_array", "AMD_vertex_shader_viewport_index"]),
    ("gl_PrimitiveID", "gce", 150, 320, &[]),
    ("gl_PrimitiveID", "f", 150, 320, &["EXT_gpu_shader4", "OES_geometry_shader", "EXT_geometry_shader"]),
    ("gl_InvocationID", "g", 400, 320, &["ARB_gpu_shader5"]),
    ("gl_PointCoord", "*", 120, 100, &[]),
    ("gl_FragDepth", "*", 110, 300, &["EXT_frag_depth"]),
    ("gl_FragDepthEXT", "*", NEVER, NEVER, &["EXT_frag_depth"]),
    ("gl_FragStencilRefARB", "*", NEVER, NEVER, &["ARB_shader_stencil_export"]),
    ("gl_FragStencilRefAMD", "*", NEVER, NEVER, &["AMD_shader_stencil_export"]),
    ("gl_SampleID gl_SamplePosition", "*", 400, 320, &["ARB_sample_shading", "OES_sample_variables"]),
    ("gl_SampleMask", "*", 400, 320, &["ARB_sample_shading", "ARB_gpu_shader5", "OES_sample_variables"]),
    ("gl_SampleMaskIn", "*", 400, 320, &["ARB_gpu_shader5", "OES_sample_variables"]),
    ("gl_NumSamples", "*", 400, 320, &["ARB_sample_shading", "OES_sample_variables"]),
    ("gl_HelperInvocation", "*", 450, 310, &[]),
    ("gl_in", "g", 150, 320, &[]),
    (
        "gl_ScopeDevice gl_ScopeWorkgroup gl_ScopeSubgroup gl_ScopeInvocation gl_ScopeQueueFamily \
         gl_SemanticsRelaxed gl_SemanticsAcquire gl_SemanticsRelease gl_SemanticsAcquireRelease \
         gl_SemanticsMakeAvailable gl_SemanticsMakeVisible gl_SemanticsVolatile gl_StorageSemanticsNone \
         gl_StorageSemanticsBuffer gl_StorageSemanticsShared gl_StorageSemanticsImage gl_StorageSemanticsOutput",
        "*",
        NEVER,
        NEVER,
        SCOPES,
    ),
    ("gl_SubgroupSize gl_SubgroupInvocationID gl_NumSubgroups gl_SubgroupID", "*", NEVER, NEVER, BASIC),
    (
        "gl_SubgroupEqMask gl_SubgroupGeMask gl_SubgroupGtMask gl_SubgroupLeMask gl_SubgroupLtMask",
        "*",
        NEVER,
        NEVER,
        &["KHR_shader_subgroup_ballot"],
    ),
    ("gl_VertexIndex gl_InstanceIndex", "*", NEVER, NEVER, &["KHR_vulkan_glsl"]),
    ("gl_MaxClipDistances gl_MaxVaryingComponents", "*", 130, NEVER, &[]),
    ("gl_MinProgramTexelOffset gl_MaxProgramTexelOffset", "*", 130, 300, &[]),
    ("gl_MaxVertexUniformComponents gl_MaxVaryingFloats gl_MaxFragmentUniformComponents", "*", 110, NEVER, &[]),
    ("gl_MaxVertexUniformVectors gl_MaxFragmentUniformVectors", "*", 410, 100, &["ARB_ES2_compatibility"]),
    ("gl_MaxVaryingVectors", "*", 410, 100, &["ARB_ES2_compatibility"]),
];

/// Variables of the fixed-function pipeline: neither in the core profile nor in ES.
const FIXED: &str = "gl_ClipVertex gl_Vertex gl_Color gl_SecondaryColor gl_Normal gl_MultiTexCoord0 gl_MultiTexCoord1 \
     gl_MultiTexCoord2 gl_MultiTexCoord3 gl_MultiTexCoord4 gl_MultiTexCoord5 gl_MultiTexCoord6 gl_MultiTexCoord7 \
     gl_FogCoord gl_FrontColor gl_BackColor gl_FrontSecondaryColor gl_BackSecondaryColor gl_TexCoord gl_FogFragCoord \
     gl_ModelViewMatrix gl_ProjectionMatrix gl_ModelViewProjectionMatrix gl_ModelViewMatrixInverse \
     gl_ProjectionMatrixInverse gl_ModelViewProjectionMatrixInverse gl_ModelViewMatrixTranspose \
     gl_ProjectionMatrixTranspose gl_ModelViewProjectionMatrixTranspose gl_ModelViewMatrixInverseTranspose \
     gl_ProjectionMatrixInverseTranspose gl_ModelViewProjectionMatrixInverseTranspose gl_TextureMatrix \
     gl_TextureMatrixInverse gl_TextureMatrixTranspose gl_TextureMatrixInverseTranspose gl_NormalMatrix \
     gl_NormalScale gl_ClipPlane gl_TextureEnvColor gl_EyePlaneS gl_EyePlaneT gl_EyePlaneR gl_EyePlaneQ \
     gl_ObjectPlaneS gl_ObjectPlaneT gl_ObjectPlaneR gl_ObjectPlaneQ gl_LightSource gl_FrontMaterial gl_BackMaterial \
     gl_LightModel gl_FrontLightModelProduct gl_BackLightModelProduct gl_FrontLightProduct gl_BackLightProduct gl_Fog \
     gl_Point gl_MaxLights gl_MaxClipPlanes gl_MaxTextureUnits gl_MaxTextureCoords";

/// Why something built in is not here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Absent {
    /// It came later, or with an extension.
    Later(Since),
    /// It exists in other stages only.
    Stage,
    /// The core profile and ES do not have it.
    Removed,
}

fn look_up(rows: &Rows, name: &str, stage: Stage, language: &Language) -> Option<Absent> {
    let letter = super::variables::letter(stage);
    let mut found = None;
    for (_, stages, desktop, es, extensions) in rows.get(name).into_iter().flatten() {
        if *stages != "*" && letter != '*' && !stages.contains(letter) {
            found = found.or(Some(Absent::Stage));
            continue;
        }
        let since = (*desktop, *es, *extensions);
        if language.since(since) {
            return None;
        }
        found = Some(Absent::Later(since));
    }
    found
}

/// Why a built-in function is not in this stage of this language; none when it is there.
pub(crate) fn function(name: &str, stage: Stage, language: &Language) -> Option<Absent> {
    if language.is_open() {
        return None;
    }
    let es3 = language.es() && language.number() >= 300;
    if es3 && matches!(name, "texture2D" | "texture2DProj" | "textureCube" | "texture2DLod" | "textureCubeLod") {
        return Some(Absent::Removed);
    }
    if name == "ftransform" && language.core() {
        return Some(Absent::Removed);
    }
    let explicit =
        name.ends_with("Lod") && (name.contains("DLod") || name.contains("Proj") || name == "textureCubeLod");
    let everywhere = language.enabled("ARB_shader_texture_lod") || (!language.es() && language.number() >= 130);
    if explicit && everywhere && (name.starts_with("texture") || name.starts_with("shadow")) && name != "textureProjLod"
    {
        return None;
    }
    look_up(&FUNCTION_ROWS, name, stage, language)
}

/// Why a built-in variable or constant is not in this stage of this language.
pub(crate) fn variable(name: &str, stage: Stage, language: &Language) -> Option<Absent> {
    if language.is_open() {
        return None;
    }
    let fixed = FIXED.split_whitespace().any(|n| n == name);
    if fixed && (language.core() || language.es()) {
        return Some(Absent::Removed);
    }
    if matches!(name, "gl_FragColor" | "gl_FragData") && language.es() && language.number() >= 300 {
        return Some(Absent::Removed);
    }
    // The table of variables knows the stages.
    look_up(&VARIABLE_ROWS, name, stage, language).filter(|why| *why != Absent::Stage)
}

/// True for a member of the block `gl_PerVertex`.
pub(crate) fn in_per_vertex(name: &str) -> bool {
    matches!(name, "gl_Position" | "gl_PointSize" | "gl_ClipDistance" | "gl_CullDistance")
}

/// When a built-in type came; none for those of the first version.
pub(crate) fn type_since(name: &str) -> Option<Since> {
    if let Some((scalar, _)) = ScalarType::of_sized_name(name) {
        return Some((NEVER, NEVER, sized(scalar)));
    }
    let ty = Type::from_name(name)?;
    Some(match ty {
        Type::Scalar(ScalarType::Uint) | Type::Vector(ScalarType::Uint, _) => (130, 300, &["EXT_gpu_shader4"]),
        Type::Scalar(ScalarType::Double)
        | Type::Vector(ScalarType::Double, _)
        | Type::Matrix(ScalarType::Double, ..) => (400, NEVER, &["ARB_gpu_shader_fp64"]),
        Type::Matrix(..) if name.contains('x') => (120, 300, &[]),
        Type::Opaque(o) => match o.kind {
            OpaqueKind::AtomicCounter => (420, 310, &["ARB_shader_atomic_counters"]),
            OpaqueKind::Image => (420, 310, &["ARB_shader_image_load_store"]),
            OpaqueKind::Sampler if o.dim == TextureDim::Cube && o.arrayed => {
                (400, 320, &["ARB_texture_cube_map_array"])
            }
            OpaqueKind::Sampler if o.multisampled => (150, 310, &["ARB_texture_multisample"]),
            OpaqueKind::Sampler if o.dim == TextureDim::Buffer => (140, 320, &["EXT_gpu_shader4"]),
            OpaqueKind::Sampler if o.dim == TextureDim::Rect => {
                // Drivers of desktop GLSL have rectangles without being asked.
                (110, NEVER, &["ARB_texture_rectangle"])
            }
            OpaqueKind::Sampler if o.dim == TextureDim::D1 && (o.arrayed || o.scalar != ScalarType::Float) => {
                (130, NEVER, &["EXT_texture_array", "EXT_gpu_shader4"])
            }
            OpaqueKind::Sampler if o.dim == TextureDim::D1 => (110, NEVER, &[]),
            OpaqueKind::Sampler if o.arrayed => (130, 300, &["EXT_texture_array", "EXT_gpu_shader4"]),
            OpaqueKind::Sampler if o.scalar != ScalarType::Float || (o.shadow && o.dim == TextureDim::Cube) => {
                (130, 300, &["EXT_gpu_shader4"])
            }
            OpaqueKind::Sampler if o.shadow => (110, 300, &[]),
            OpaqueKind::Sampler if o.dim == TextureDim::D3 => (110, 300, &["OES_texture_3D"]),
            OpaqueKind::Sampler => return None,
        },
        Type::Void
        | Type::Error
        | Type::Scalar(_)
        | Type::Vector(..)
        | Type::Matrix(..)
        | Type::Struct(_)
        | Type::Array(..) => return None,
    })
}

/// True for the name of a type that says its size, such as `float16_t`.
pub(crate) fn is_sized_name(name: &str) -> bool {
    ScalarType::of_sized_name(name).is_some()
}

/// True for what only extensions bring that need a later version than a text has which states none: types that say their
/// size, and what KHR has for Vulkan.
pub(crate) fn is_late(name: &str) -> bool {
    let late = |e: &str| e.starts_with("KHR_") || e.starts_with("EXT_shader_explicit_arithmetic_types");
    let rows = [&FUNCTION_ROWS, &VARIABLE_ROWS].into_iter().filter_map(|rows| rows.get(name)).flatten();
    let mut rows = rows.map(|row| row.2 == NEVER && row.3 == NEVER && row.4.iter().any(|e| late(e)));
    is_sized_name(name) || rows.any(|late| late)
}

/// The extensions that bring atomic functions on 64 bits.
pub(crate) const WIDE_ATOMICS: Since = (NEVER, NEVER, &["EXT_shader_atomic_int64", "NV_shader_atomic_int64"]);

/// True when the language has a type that only extensions bring.
pub(crate) fn has_scalar(scalar: ScalarType, language: &Language) -> bool {
    language.since((NEVER, NEVER, sized(scalar)))
}

/// The extensions that bring the names which say a size for a type.
fn sized(scalar: ScalarType) -> &'static [&'static str] {
    match scalar {
        ScalarType::Int8 | ScalarType::Uint8 => INT8,
        ScalarType::Int16 | ScalarType::Uint16 => INT16,
        ScalarType::Bool | ScalarType::Int | ScalarType::Uint => INT32,
        ScalarType::Int64 | ScalarType::Uint64 => INT64,
        ScalarType::Half => FLOAT16,
        ScalarType::Float => FLOAT32,
        ScalarType::Double => FLOAT64,
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::{Profile, Version};
    use super::*;

    fn language(number: u32, profile: Profile) -> Language {
        Language::new(&Version { number, profile, span: None }, &[])
    }

    #[test]
    fn functions_and_variables_have_their_version_and_stage() {
        let old = language(120, Profile::Compatibility);
        let core = language(330, Profile::Core);
        assert!(matches!(function("texture", Stage::Vertex, &old), Some(Absent::Later((130, 300, _)))));
        assert_eq!(function("texture", Stage::Vertex, &core), None);
        assert_eq!(function("dFdx", Stage::Vertex, &core), Some(Absent::Stage));
        assert_eq!(function("texture2DLod", Stage::Fragment, &old), Some(Absent::Stage));
        assert_eq!(function("texture2DLod", Stage::Fragment, &core), None);
        assert_eq!(variable("gl_Vertex", Stage::Vertex, &core), Some(Absent::Removed));
        assert_eq!(variable("gl_Vertex", Stage::Vertex, &old), None);
        assert!(matches!(variable("gl_Layer", Stage::Fragment, &core), Some(Absent::Later((430, ..)))));
        assert_eq!(variable("gl_Layer", Stage::Geometry, &core), None);
        let tessellated = language(410, Profile::Core);
        assert_eq!(variable("gl_in", Stage::TessEvaluation, &tessellated), None);
        assert_eq!(variable("gl_InvocationID", Stage::TessControl, &tessellated), None);
    }

    #[test]
    fn every_named_function_and_variable_exists() {
        for (names, ..) in FUNCTIONS {
            for name in names.split_whitespace() {
                assert!(!super::super::functions(name).is_empty(), "{name}");
            }
        }
        for name in VARIABLES.iter().flat_map(|r| r.0.split_whitespace()).chain(FIXED.split_whitespace()) {
            assert!(super::super::variable(name, Stage::Library, None).is_some(), "{name}");
        }
    }

    #[test]
    fn types_have_their_version() {
        assert_eq!(type_since("vec4"), None);
        assert_eq!(type_since("mat3"), None);
        assert!(matches!(type_since("mat2x3"), Some((120, 300, _))));
        assert!(matches!(type_since("usampler2D"), Some((130, 300, _))));
        assert!(matches!(type_since("samplerCubeArray"), Some((400, 320, _))));
        assert_eq!(type_since("sampler2D"), None);
        assert!(matches!(
            type_since("f16vec2"),
            Some((NEVER, NEVER, ["EXT_shader_explicit_arithmetic_types_float16", ..]))
        ));
        assert!(matches!(
            type_since("uint32_t"),
            Some((NEVER, NEVER, ["EXT_shader_explicit_arithmetic_types_int32", ..]))
        ));
        assert!(matches!(type_since("sampler2DShadow"), Some((110, 300, _))));
    }
}
