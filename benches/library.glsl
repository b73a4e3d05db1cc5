#version 330 core
// Fifty small functions of the kinds that shader libraries have.

const float PI = 3.14159265358979324;

struct Ray { vec3 origin; vec3 direction; };
struct Material { vec3 diffuse; vec3 specular; float shininess; };

float saturate1(float x) { return clamp(x, 0.0, 1.0); }
float remap(float x, vec2 from, vec2 to) { return to.x + (x - from.x) * (to.y - to.x) / (from.y - from.x); }
float smoother(float t) { return t * t * t * (t * (t * 6.0 - 15.0) + 10.0); }
float easeOutElastic(float t) { return pow(2.0, -10.0 * t) * sin((t - 0.075) * (2.0 * PI) / 0.3) + 1.0; }
float bias(float t, float b) { return t / ((1.0 / b - 2.0) * (1.0 - t) + 1.0); }
float gain(float t, float g) { return t < 0.5 ? bias(2.0 * t, g) * 0.5 : bias(2.0 * t - 1.0, 1.0 - g) * 0.5 + 0.5; }
float luminance(vec3 c) { return dot(c, vec3(0.2126, 0.7152, 0.0722)); }
// shadercheck: c in [0, 1]
vec3 toLinear(vec3 c) { return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), step(0.04045, c)); }
// shadercheck: c in [0, 1]
vec3 toSrgb(vec3 c) { return mix(c * 12.92, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, c)); }
vec3 reinhard(vec3 c) { return c / (1.0 + c); }
vec3 filmic(vec3 x) { return clamp((x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14), 0.0, 1.0); }
vec3 hueToRgb(float h) { return clamp(abs(fract(h + vec3(0.0, 2.0 / 3.0, 1.0 / 3.0)) * 6.0 - 3.0) - 1.0, 0.0, 1.0); }
vec3 hsvToRgb(vec3 c) { return c.z * mix(vec3(1.0), hueToRgb(c.x), c.y); }
float hash1(vec2 p) { return fract(sin(dot(p, vec2(12.9898, 78.233))) * 43758.5453); }
float valueNoise(vec2 p) {
    vec2 i = floor(p), f = fract(p);
    vec2 u = f * f * (3.0 - 2.0 * f);
    return mix(mix(hash1(i), hash1(i + vec2(1.0, 0.0)), u.x),
               mix(hash1(i + vec2(0.0, 1.0)), hash1(i + vec2(1.0, 1.0)), u.x), u.y);
}
float fbm(vec2 p) {
    float sum = 0.0, weight = 0.5;
    for (int i = 0; i < 4; i++) { sum += weight * valueNoise(p); p *= 2.0; weight *= 0.5; }
    return sum;
}
float sdSphere(vec3 p, float r) { return length(p) - r; }
float sdBox(vec3 p, vec3 b) { vec3 q = abs(p) - b; return length(max(q, 0.0)) + min(max(q.x, max(q.y, q.z)), 0.0); }
float sdTorus(vec3 p, vec2 t) { return length(vec2(length(p.xz) - t.x, p.y)) - t.y; }
float sdCapsule(vec3 p, vec3 a, vec3 b, float r) {
    vec3 pa = p - a, ba = b - a;
    return length(pa - ba * clamp(dot(pa, ba) / dot(ba, ba), 0.0, 1.0)) - r;
}
float smoothUnion(float a, float b, float k) {
    float h = clamp(0.5 + 0.5 * (b - a) / k, 0.0, 1.0);
    return mix(b, a, h) - k * h * (1.0 - h);
}
vec2 rotated(vec2 v, float a) { float s = sin(a), c = cos(a); return vec2(c * v.x - s * v.y, s * v.x + c * v.y); }
mat3 axisAngle(vec3 n, float a) {
    float s = sin(a), c = cos(a), k = 1.0 - c;
    return mat3(c + n.x * n.x * k, n.y * n.x * k + n.z * s, n.z * n.x * k - n.y * s,
                n.x * n.y * k - n.z * s, c + n.y * n.y * k, n.z * n.y * k + n.x * s,
                n.x * n.z * k + n.y * s, n.y * n.z * k - n.x * s, c + n.z * n.z * k);
}
vec4 quatMul(vec4 a, vec4 b) { return vec4(a.w * b.xyz + b.w * a.xyz + cross(a.xyz, b.xyz), a.w * b.w - dot(a.xyz, b.xyz)); }
vec3 quatRotate(vec4 q, vec3 v) { return v + 2.0 * cross(q.xyz, cross(q.xyz, v) + q.w * v); }
vec4 nlerp(vec4 a, vec4 b, float t) { return normalize(mix(a, dot(a, b) < 0.0 ? -b : b, t)); }
float lambert(vec3 n, vec3 l) { return max(dot(n, l), 0.0); }
vec3 phong(Material m, vec3 n, vec3 l, vec3 v) {
    float d = max(dot(n, l), 0.0);
    float s = pow(max(dot(reflect(-l, n), v), 0.0), m.shininess);
    return m.diffuse * d + m.specular * s;
}
float schlick(float cosine, float f0) { return f0 + (1.0 - f0) * pow(1.0 - cosine, 5.0); }
float ggx(float nh, float rough) { float a = rough * rough; float d = nh * nh * (a * a - 1.0) + 1.0; return a * a / (PI * d * d); }
float smithG(float nv, float rough) { float k = (rough + 1.0) * (rough + 1.0) / 8.0; return nv / (nv * (1.0 - k) + k); }
vec3 fresnel(vec3 f0, float c) { return f0 + (vec3(1.0) - f0) * exp2((-5.55473 * c - 6.98316) * c); }
float fog(float d, float density) { return 1.0 - exp(-d * d * density * density); }
float attenuation(float d, vec3 k) { return 1.0 / (k.x + k.y * d + k.z * d * d); }
float linearDepth(float z, float near, float far) { return 2.0 * near * far / (far + near - (2.0 * z - 1.0) * (far - near)); }
vec2 sphereHit(Ray r, vec3 center, float radius) {
    vec3 oc = r.origin - center;
    float b = dot(oc, r.direction), c = dot(oc, oc) - radius * radius, h = b * b - c;
    if (h < 0.0) return vec2(-1.0);
    h = sqrt(h);
    return vec2(-b - h, -b + h);
}
float planeHit(Ray r, vec4 plane) { return -(dot(r.origin, plane.xyz) + plane.w) / dot(r.direction, plane.xyz); }
vec3 bezier(vec3 a, vec3 b, vec3 c, float t) { return mix(mix(a, b, t), mix(b, c, t), t); }
vec3 catmull(vec3 p[4], float t) {
    return 0.5 * ((2.0 * p[1]) + (p[2] - p[0]) * t + (2.0 * p[0] - 5.0 * p[1] + 4.0 * p[2] - p[3]) * t * t
                  + (3.0 * p[1] - p[0] - 3.0 * p[2] + p[3]) * t * t * t);
}
vec3 skinned(vec3 p, mat4 bones[2], vec2 w) { return (w.x * (bones[0] * vec4(p, 1.0)) + w.y * (bones[1] * vec4(p, 1.0))).xyz; }
vec2 toPolar(vec2 p) { return vec2(length(p), atan(p.y, p.x)); }
vec3 fromSpherical(vec2 a) { return vec3(sin(a.x) * cos(a.y), cos(a.x), sin(a.x) * sin(a.y)); }
vec2 octEncode(vec3 n) { n /= abs(n.x) + abs(n.y) + abs(n.z); return n.z >= 0.0 ? n.xy : (1.0 - abs(n.yx)) * sign(n.xy); }
float gauss(float x, float s) { return exp(-0.5 * x * x / (s * s)) / (s * sqrt(2.0 * PI)); }
float blurWeights(float s) { float sum = 0.0; for (int i = -4; i <= 4; i++) sum += gauss(float(i), s); return gauss(0.0, s) / sum; }
mat4 lookAt(vec3 eye, vec3 at, vec3 up) {
    vec3 f = normalize(at - eye), s = normalize(cross(f, up)), u = cross(s, f);
    return mat4(s.x, u.x, -f.x, 0.0, s.y, u.y, -f.y, 0.0, s.z, u.z, -f.z, 0.0, -dot(s, eye), -dot(u, eye), dot(f, eye), 1.0);
}
mat4 perspective(float fovy, float aspect, float near, float far) {
    float f = 1.0 / tan(0.5 * fovy);
    return mat4(f / aspect, 0.0, 0.0, 0.0, 0.0, f, 0.0, 0.0, 0.0, 0.0, (far + near) / (near - far), -1.0,
                0.0, 0.0, 2.0 * far * near / (near - far), 0.0);
}
float checker(vec2 p) { return mod(floor(p.x) + floor(p.y), 2.0); }
int mandelbrot(vec2 c) { vec2 z = vec2(0.0); int n = 0; for (; n < 32 && dot(z, z) < 4.0; n++) z = vec2(z.x * z.x - z.y * z.y, 2.0 * z.x * z.y) + c; return n; }
vec3 barycentric(vec2 p, vec2 a, vec2 b, vec2 c) {
    vec2 v0 = b - a, v1 = c - a, v2 = p - a;
    float d = v0.x * v1.y - v1.x * v0.y;
    float v = (v2.x * v1.y - v1.x * v2.y) / d, w = (v0.x * v2.y - v2.x * v0.y) / d;
    return vec3(1.0 - v - w, v, w);
}
