#version 150
#define CORNERS 4
layout(points) in;
layout(triangle_strip, max_vertices = CORNERS) out;
uniform mat4 projection;
uniform float size;
in Point { vec4 color; float age; } point[];
in vec3 velocity[];
out vec4 tint;
out vec2 corner;

void main() {
    for (int i = 0; i < CORNERS; ++i) {
        corner = vec2(i & 1, i >> 1);
        tint = point[0].color * (1.0 - point[0].age);
        tint.rgb += 0.01 * velocity[0];
        gl_PrimitiveID = gl_PrimitiveIDIn;
        gl_Position = projection * (gl_in[0].gl_Position + vec4((corner - 0.5) * size, 0.0, 0.0));
        EmitVertex();
    }
    EndPrimitive();
}
