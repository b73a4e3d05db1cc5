//! title: LÖVE: effect and position, with the types of the engine
//! uses: Texel VaryingTexCoord VaryingColor love_PixelColor TransformProjectionMatrix love_ScreenSize extern
--- both
#define number float
#define Image sampler2D
#define ArrayImage sampler2DArray
#define CubeImage samplerCube
#define VolumeImage sampler3D
#define extern uniform
#define Texel texture2D
uniform vec4 love_ScreenSize;
uniform mat4 TransformMatrix;
uniform mat4 ProjectionMatrix;
uniform mat4 TransformProjectionMatrix;
uniform mat3 NormalMatrix;
varying vec4 VaryingTexCoord;
varying vec4 VaryingColor;
--- vertex
attribute vec4 VertexPosition;
attribute vec4 VertexTexCoord;
attribute vec4 VertexColor;
--- fragment
uniform sampler2D MainTex;
