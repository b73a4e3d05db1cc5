//! title: ISF: a shader with its inputs in JSON in front
//! uses: RENDERSIZE isf_FragNormCoord IMG_NORM_PIXEL IMG_PIXEL IMG_THIS_PIXEL IMG_THIS_NORM_PIXEL
//! states: "INPUTS" "ISFVSN" "PASSES" "CATEGORIES"
//! inputs: isf
--- both
uniform int PASSINDEX;
uniform vec2 RENDERSIZE;
uniform float TIME;
uniform float TIMEDELTA;
uniform vec4 DATE;
uniform int FRAMEINDEX;
varying vec2 isf_FragNormCoord;
varying vec2 vv_FragNormCoord;
#define IMG_SIZE(image) vec2(RENDERSIZE)
#define IMG_NORM_PIXEL(image, at) texture2D(image, at)
#define IMG_PIXEL(image, at) texture2D(image, (at) / RENDERSIZE)
#define IMG_THIS_PIXEL(image) texture2D(image, isf_FragNormCoord)
#define IMG_THIS_NORM_PIXEL(image) texture2D(image, isf_FragNormCoord)
--- vertex
attribute vec4 isf_position;
void isf_vertShaderInit() { gl_Position = isf_position; isf_FragNormCoord = isf_position.xy * 0.5 + 0.5; }
