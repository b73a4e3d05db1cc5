//! title: deck.gl: projection, picking and hooks
//! uses: DECKGL_FILTER_COLOR DECKGL_FILTER_GL_POSITION DECKGL_FILTER_SIZE project_position_to_clipspace project_size_to_pixel
--- both
struct VertexGeometry {
  vec3 worldPosition;
  vec3 worldPositionAlt;
  vec4 position;
  vec3 normal;
  vec2 uv;
  vec3 pickingColor;
};
struct FragmentGeometry { vec2 uv; };
--- vertex
VertexGeometry geometry;
void DECKGL_FILTER_SIZE(inout vec3 size, VertexGeometry at) {}
void DECKGL_FILTER_GL_POSITION(inout vec4 position, VertexGeometry at) {}
void DECKGL_FILTER_COLOR(inout vec4 color, VertexGeometry at) {}
vec4 project_position_to_clipspace(vec3 position, vec3 position64, vec3 offset, out vec4 common_position) {
  common_position = vec4(position + position64 + offset, 1.0);
  return common_position;
}
vec4 project_position_to_clipspace(vec3 position, vec3 position64, vec3 offset) {
  return vec4(position + position64 + offset, 1.0);
}
vec3 project_position(vec3 position) { return position; }
vec4 project_position(vec4 position) { return position; }
vec3 project_position(vec3 position, vec3 position64) { return position + position64; }
vec2 project_position(vec2 position) { return position; }
vec4 project_common_position_to_clipspace(vec4 position) { return position; }
float project_size(float meters) { return meters; }
vec2 project_size(vec2 meters) { return meters; }
vec3 project_size(vec3 meters) { return meters; }
float project_size_to_pixel(float meters) { return meters; }
float project_size_to_pixel(float size, int unit) { return size; }
float project_pixel_size(float pixels) { return pixels; }
vec2 project_pixel_size(vec2 pixels) { return pixels; }
vec2 project_pixel_size_to_clipspace(vec2 pixels) { return pixels; }
vec3 project_normal(vec3 normal) { return normal; }
--- fragment
FragmentGeometry geometry;
void DECKGL_FILTER_COLOR(inout vec4 color, FragmentGeometry at) {}
