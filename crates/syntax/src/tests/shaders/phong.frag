#version 330 core
#define MAX_LIGHTS 4
#define SQR(x) ((x) * (x))
#ifdef GL_ES
precision mediump float;
#endif

struct Light {
    vec3 position, color;
    float attenuation[3];
};

layout(std140) uniform Scene {
    mat4 view;
    vec3 eye;
    int count;
} scene;

uniform Light lights[MAX_LIGHTS];
uniform sampler2D albedo;
uniform samplerCube sky;

in VertexData {
    vec3 position;
    vec3 normal;
    vec2 uv;
} surface;

layout(location = 0) out vec4 color;

float falloff(in Light light, float d);

vec3 shade(Light light, vec3 n, vec3 base, out float specular)
{
    vec3 toLight = light.position - surface.position;
    vec3 h = normalize(normalize(toLight) + normalize(scene.eye - surface.position));
    specular = pow(max(dot(n, h), 0.0), 32.0);
    return base * light.color * max(dot(n, normalize(toLight)), 0.0) * falloff(light, length(toLight));
}

float falloff(in Light light, float d)
{
    return 1.0 / (light.attenuation[0] + light.attenuation[1] * d + light.attenuation[2] * SQR(d));
}

void main()
{
    vec3 n = normalize(surface.normal);
    vec4 base = texture(albedo, surface.uv);
    if (base.a < 0.5)
        discard;
    vec3 sum = vec3(0);
    for (int i = 0, last = min(scene.count, lights.length()); i < last; i++) {
        float specular;
        sum += shade(lights[i], n, base.rgb, specular);
        sum += SQR(specular);
    }
    sum += 0.1 * texture(sky, reflect(surface.position - scene.eye, n)).rgb;
    color = vec4(sum, base.a);
}
