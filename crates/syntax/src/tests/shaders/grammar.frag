#version 430 core
#extension GL_ARB_arrays_of_arrays : enable
layout(early_fragment_tests) in;
layout(origin_upper_left) in vec4 gl_FragCoord;
precision highp float;

struct Pair { vec2 a, b; struct Inner { int k[2]; } inner; };
struct { float x; } nameless;

layout(std430, binding = 1) readonly buffer Data { uint n; float items[]; };
layout(binding = 0, rgba8) uniform writeonly image2D target;
layout(binding = 2) uniform usampler2DArray ids;
flat in int kind;
noperspective centroid in vec2 uv;
layout(location = 0, index = 0) out vec4 colors[2];
invariant gl_FragDepth;
out float gl_FragDepth;

const float table[] = float[](1.0, 2.0, 4.0);
const float grid[2][3] = float[2][3](float[3](1., 2., 3.), float[](4., 5., 6.));
const int rows = grid.length(), last = table.length() - 1;
const Pair pairs[1] = { { vec2(1), { 2.0, 3.0 }, { { 1, 2 } } } };

void swap(inout float a, inout float b) { float c = a; a = b; b = c; }
float sum(const in float[3] values) {
    float s = 0.0;
    for (int i = 0; i < values.length(); ++i) s += values[i];
    return s;
}
vec2 pick(int); vec2 pick(float x);
vec2 pick(int i) { return pairs[0].a * float(i); }
vec2 pick(float x) { return vec2(x); }

void main(void)
{
    ;
    int k = 0, m = 0x1F, o = 017;
    uint bits = 7u << 2, mask = ~bits & 0xFFu | 1u ^ 2u;
    bool both = k < m && !(o >= k) || k == m ^^ k != o;
    double d = 1.5lf;
    vec4 c = both ? vec4(uv, 0, 1) : vec4(0.5);
    c.xy = c.yx, c.b *= 2.0;
    c[3] += table[last] + grid[rows - 1][0];
    mat3x2 m32 = mat3x2(1, 2, 3, 4, 5, 6);
    mat2 product = m32 * transpose(m32);
    product[1].x = -product[0][1];
    float[2] ab = float[2](1.0, 2.0);
    swap(ab[0], ab[1]);
    while (k < 3) { k++; if (k == 2) continue; --m; }
    do { m -= 1; } while (m > 0);
    for (;;) { break; }
    switch (kind) {
    case 0:
    case 1:
        c += sum(table);
        break;
    default: {
        c.rg += pick(2) + pick(0.5);
    }
    }
    if (mask % 3u == 0u) { discard; } else if (isnan(c.x)) return;
    else c.a = 1.0;
    ivec3 size = textureSize(ids, 0);
    c += vec4(texelFetch(ids, size - 1, 0)) * float(n) + items[0] + float(d) + nameless.x;
    imageStore(target, ivec2(gl_FragCoord.xy), c);
    gl_FragDepth = gl_FragCoord.z;
    colors[0] = colors[1] = (c, c);
    { int k = o; k <<= 2; k >>= 1; k &= 3; k |= 4; k ^= 1; k %= 3; }
}
