//! Names that no text has to declare: keywords, types, values and functions of WGSL (sections 2.1, 6 and 17 of its
//! specification), and what naga and wgpu have besides.

use std::collections::HashSet;
use std::sync::LazyLock;

/// True for a name of the language.
pub(crate) fn is_predeclared(name: &str) -> bool {
    static NAMES: LazyLock<HashSet<&str>> = LazyLock::new(|| {
        [KEYWORDS, TYPES, VALUES, FUNCTIONS, EXTENSIONS].iter().flat_map(|list| list.split_whitespace()).collect()
    });
    NAMES.contains(name) || is_vector_or_matrix(name)
}

/// The types and functions of the language, but for vectors and matrices.
pub(crate) fn types_and_functions() -> impl Iterator<Item = &'static str> {
    [TYPES, FUNCTIONS].into_iter().flat_map(str::split_whitespace)
}

/// True for a word of the grammar.
pub(crate) fn is_keyword(word: &str) -> bool {
    KEYWORDS.split_whitespace().any(|keyword| keyword == word)
}

/// `vec3`, `vec3f`, `mat4x2`, `mat4x2h` and their like.
fn is_vector_or_matrix(name: &str) -> bool {
    let size = |c: char| matches!(c, '2' | '3' | '4');
    if let Some(rest) = name.strip_prefix("vec").and_then(|rest| rest.strip_prefix(size)) {
        return matches!(rest, "" | "f" | "h" | "i" | "u");
    }
    let columns = name.strip_prefix("mat").and_then(|rest| rest.strip_prefix(size));
    let rest = columns.and_then(|rest| rest.strip_prefix('x')).and_then(|rest| rest.strip_prefix(size));
    rest.is_some_and(|rest| matches!(rest, "" | "f" | "h"))
}

const KEYWORDS: &str = "alias break case const const_assert continue continuing default diagnostic discard else enable \
    false fn for if let loop override requires return struct switch true var while static_assert type virtual _";

const TYPES: &str = "bool f16 f32 f64 i16 u16 i32 u32 i64 u64 array atomic ptr sampler sampler_comparison \
    texture_1d texture_2d texture_2d_array texture_3d texture_cube texture_cube_array texture_multisampled_2d \
    texture_multisampled_2d_array texture_depth_2d texture_depth_2d_array texture_depth_cube texture_depth_cube_array \
    texture_depth_multisampled_2d texture_external texture_storage_1d texture_storage_2d texture_storage_2d_array \
    texture_storage_3d";

const VALUES: &str = "function private workgroup uniform storage read write read_write handle immediate push_constant \
    r8unorm r8snorm r8uint r8sint r16unorm r16snorm r16uint r16sint r16float rg8unorm rg8snorm rg8uint rg8sint rg16unorm \
    rg16snorm rg16uint rg16sint rg16float r32uint r32sint r32float r64uint rgba8unorm rgba8snorm rgba8uint rgba8sint \
    bgra8unorm rgba16unorm rgba16snorm rgba16uint rgba16sint rgba16float rg32uint rg32sint rg32float rgba32uint \
    rgba32sint rgba32float rgb10a2unorm rgb10a2uint rg11b10ufloat rg11b10float";

const FUNCTIONS: &str = "bitcast all any select arrayLength abs acos acosh asin asinh atan atanh atan2 ceil clamp cos cosh \
    countLeadingZeros countOneBits countTrailingZeros cross degrees determinant distance dot dot4U8Packed dot4I8Packed exp \
    exp2 extractBits faceForward firstLeadingBit firstTrailingBit floor fma fract frexp insertBits inverseSqrt ldexp length \
    log log2 max min mix modf normalize outerProduct pow quantizeToF16 radians reflect refract reverseBits round saturate \
    sign sin sinh smoothstep sqrt step tan tanh transpose trunc inverse dpdx dpdxCoarse dpdxFine dpdy dpdyCoarse dpdyFine \
    fwidth fwidthCoarse fwidthFine textureDimensions textureGather textureGatherCompare textureLoad textureNumLayers \
    textureNumLevels textureNumSamples textureSample textureSampleBias textureSampleCompare textureSampleCompareLevel \
    textureSampleGrad textureSampleLevel textureSampleBaseClampToEdge textureStore atomicLoad atomicStore atomicAdd atomicSub \
    atomicMax atomicMin atomicAnd atomicOr atomicXor atomicExchange atomicCompareExchangeWeak pack4x8snorm pack4x8unorm \
    pack4xI8 pack4xU8 pack4xI8Clamp pack4xU8Clamp pack2x16snorm pack2x16unorm pack2x16float unpack4x8snorm unpack4x8unorm \
    unpack4xI8 unpack4xU8 unpack2x16snorm unpack2x16unorm unpack2x16float storageBarrier textureBarrier workgroupBarrier \
    workgroupUniformLoad subgroupAdd subgroupExclusiveAdd subgroupInclusiveAdd subgroupAll subgroupAnd subgroupAny \
    subgroupBallot subgroupBroadcast subgroupBroadcastFirst subgroupElect subgroupMax subgroupMin subgroupMul \
    subgroupExclusiveMul subgroupInclusiveMul subgroupOr subgroupShuffle subgroupShuffleDown subgroupShuffleUp \
    subgroupShuffleXor subgroupXor quadBroadcast quadSwapDiagonal quadSwapX quadSwapY";

const EXTENSIONS: &str = "binding_array acceleration_structure ray_query vertex_return RayDesc RayIntersection \
    rayQueryInitialize rayQueryProceed rayQueryGenerateIntersection rayQueryConfirmIntersection rayQueryTerminate \
    rayQueryGetCommittedIntersection rayQueryGetCandidateIntersection getCommittedHitVertexPositions \
    getCandidateHitVertexPositions traceRay RAY_FLAG_NONE RAY_FLAG_FORCE_OPAQUE RAY_FLAG_FORCE_NO_OPAQUE \
    RAY_FLAG_TERMINATE_ON_FIRST_HIT RAY_FLAG_SKIP_CLOSEST_HIT_SHADER RAY_FLAG_CULL_BACK_FACING \
    RAY_FLAG_CULL_FRONT_FACING RAY_FLAG_CULL_OPAQUE RAY_FLAG_CULL_NO_OPAQUE RAY_FLAG_SKIP_TRIANGLES RAY_FLAG_SKIP_AABBS \
    RAY_QUERY_INTERSECTION_NONE RAY_QUERY_INTERSECTION_TRIANGLE RAY_QUERY_INTERSECTION_GENERATED \
    RAY_QUERY_INTERSECTION_AABB textureAtomicAdd textureAtomicAnd textureAtomicMax textureAtomicMin textureAtomicOr \
    textureAtomicXor subgroupBarrier coop_mat8x8 coop_mat16x16 coopLoad coopLoadT coopStore coopStoreT coopMultiplyAdd \
    subgroup_matrix_left subgroup_matrix_right subgroup_matrix_result subgroupMatrixLoad subgroupMatrixStore \
    subgroupMatrixMultiply subgroupMatrixMultiplyAccumulate";

#[cfg(test)]
mod tests {
    use super::is_predeclared;

    #[test]
    fn names_of_the_language_are_known_and_others_are_not() {
        let known = ["vec3f", "vec2", "mat4x3h", "textureSample", "rgba8unorm", "fn", "RAY_FLAG_NONE"];
        assert!(known.iter().all(|name| is_predeclared(name)));
        let others = ["vec5", "vec3x", "mat4", "mat4x5", "Camera", "texture2D", "mod"];
        assert!(others.iter().all(|name| !is_predeclared(name)));
    }
}
