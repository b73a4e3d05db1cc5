//! Constants that the language knows by name.

/// Constants that the language names: limits (GLSL 4.60, 7.3), which are the least that an implementation must have, and
/// those of memory.
pub(super) fn limit(name: &str) -> Option<i32> {
    Some(match name {
        "gl_MaxVertexAttribs" | "gl_MaxVertexTextureImageUnits" | "gl_MaxTextureImageUnits" => 16,
        "gl_MaxGeometryTextureImageUnits" | "gl_MaxComputeTextureImageUnits" => 16,
        "gl_MaxVertexUniformComponents" | "gl_MaxFragmentUniformComponents" | "gl_MaxComputeUniformComponents" => 1024,
        "gl_MaxGeometryUniformComponents" | "gl_MaxGeometryTotalOutputComponents" => 1024,
        "gl_MaxVaryingFloats" | "gl_MaxVaryingComponents" => 60,
        "gl_MaxVertexOutputComponents" | "gl_MaxGeometryInputComponents" => 64,
        "gl_MaxGeometryOutputComponents" | "gl_MaxFragmentInputComponents" => 128,
        "gl_MaxCombinedTextureImageUnits" => 80,
        "gl_MaxDrawBuffers" | "gl_MaxLights" | "gl_MaxClipDistances" | "gl_MaxCullDistances" | "gl_MaxImageUnits" => 8,
        "gl_MaxCombinedClipAndCullDistances" | "gl_MaxTextureCoords" | "gl_MaxTextureUnits" => 8,
        "gl_MaxClipPlanes" | "gl_MaxFragmentImageUniforms" | "gl_MaxComputeImageUniforms" => 8,
        "gl_MaxVertexUniformVectors" => 256,
        "gl_MaxFragmentUniformVectors" => 224,
        "gl_MaxVaryingVectors" => 15,
        "gl_MaxVertexOutputVectors" => 16,
        "gl_MaxFragmentInputVectors" => 15,
        "gl_MaxGeometryOutputVertices" => 256,
        "gl_MaxSamples" => 4,
        "gl_MaxViewports" => 16,
        "gl_MinProgramTexelOffset" => -8,
        "gl_MaxProgramTexelOffset" => 7,
        // GL_KHR_memory_scope_semantics, which gives these values.
        "gl_SemanticsRelaxed" | "gl_StorageSemanticsNone" => 0,
        "gl_ScopeDevice" => 1,
        "gl_ScopeWorkgroup" | "gl_SemanticsAcquire" => 2,
        "gl_ScopeSubgroup" => 3,
        "gl_ScopeInvocation" | "gl_SemanticsRelease" => 4,
        "gl_ScopeQueueFamily" => 5,
        "gl_SemanticsAcquireRelease" => 8,
        "gl_StorageSemanticsBuffer" => 0x40,
        "gl_StorageSemanticsShared" => 0x100,
        "gl_StorageSemanticsImage" => 0x800,
        "gl_StorageSemanticsOutput" => 0x1000,
        "gl_SemanticsMakeAvailable" => 0x2000,
        "gl_SemanticsMakeVisible" => 0x4000,
        "gl_SemanticsVolatile" => 0x8000,
        _ => return None,
    })
}
