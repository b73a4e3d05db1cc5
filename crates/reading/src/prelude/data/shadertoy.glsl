//! title: Shadertoy: an image or buffer shader with mainImage
//! defines: mainImage
--- fragment
#version 300 es
precision highp float;
precision highp int;
precision highp sampler2D;
uniform vec3 iResolution;
uniform float iTime;
uniform float iGlobalTime;
uniform float iTimeDelta;
uniform float iFrameRate;
uniform int iFrame;
uniform float iChannelTime[4];
uniform vec3 iChannelResolution[4];
uniform vec4 iMouse;
uniform vec4 iDate;
uniform float iSampleRate;
uniform sampler2D iChannel0;
uniform sampler2D iChannel1;
uniform sampler2D iChannel2;
uniform sampler2D iChannel3;
out vec4 shadertoy_out_color;
--- behind fragment
void main() {
  vec4 shadertoy_color = vec4(0.0, 0.0, 0.0, 1.0);
  mainImage(shadertoy_color, gl_FragCoord.xy);
  shadertoy_out_color = vec4(shadertoy_color.xyz, 1.0);
}
