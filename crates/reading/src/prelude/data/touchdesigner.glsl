//! title: TouchDesigner: inputs and outputs of a GLSL TOP
//! uses: TDOutputSwizzle sTD2DInputs uTD2DInfos uTDOutputInfo
--- fragment
#version 460 core
struct TDTexInfo { vec4 res; vec4 depth; };
uniform TDTexInfo uTDOutputInfo;
uniform TDTexInfo uTD2DInfos[16];
uniform sampler2D sTD2DInputs[16];
in vec3 vUV;
vec4 TDOutputSwizzle(vec4 color) { return color; }
float TDSimplexNoise(vec2 at) { return at.x; }
float TDSimplexNoise(vec3 at) { return at.x; }
float TDPerlinNoise(vec2 at) { return at.x; }
float TDPerlinNoise(vec3 at) { return at.x; }
