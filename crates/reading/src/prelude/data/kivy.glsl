//! title: Kivy: what stands for $HEADER$
//! hook: $HEADER$
--- vertex
attribute vec2 vPosition;
attribute vec2 vTexCoords0;
uniform mat4 modelview_mat;
uniform mat4 projection_mat;
uniform vec4 color;
uniform float opacity;
varying vec4 frag_color;
varying vec2 tex_coord0;
--- fragment
varying vec4 frag_color;
varying vec2 tex_coord0;
uniform sampler2D texture0;
uniform mat4 frag_modelview_mat;
