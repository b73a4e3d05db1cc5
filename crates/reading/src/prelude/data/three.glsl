//! title: three.js: ShaderMaterial, which declares matrices and attributes
//! uses: projectionMatrix modelViewMatrix modelMatrix viewMatrix normalMatrix cameraPosition isOrthographic pc_fragColor
//! without: #include
//! host: ShaderMaterial
//! sets: toneMappingExposure logDepthBufFC receiveShadow bindMatrix bindMatrixInverse boneTexture morphTargetBaseInfluence morphTargetInfluences
--- both
precision highp float;
precision highp int;
uniform mat4 viewMatrix;
uniform vec3 cameraPosition;
uniform bool isOrthographic;
--- vertex
uniform mat4 modelMatrix;
uniform mat4 modelViewMatrix;
uniform mat4 projectionMatrix;
uniform mat3 normalMatrix;
attribute vec3 position;
attribute vec3 normal;
attribute vec2 uv;
attribute mat4 instanceMatrix;
attribute vec3 instanceColor;
attribute vec3 color;
attribute vec4 tangent;
attribute vec2 uv1;
attribute vec2 uv2;
attribute vec2 uv3;
attribute vec4 skinIndex;
attribute vec4 skinWeight;
--- fragment
#if __VERSION__ >= 130
out highp vec4 pc_fragColor;
#else
#define pc_fragColor gl_FragColor
#endif
