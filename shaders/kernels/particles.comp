#version 450
// One step of particles under gravity. The floor at y = 0 throws them back and takes a part of their speed.
layout(local_size_x = 32) in;
layout(std140, binding = 0) uniform Step { float time; };
layout(std430, binding = 1) buffer Positions { vec4 positions[]; };
layout(std430, binding = 2) buffer Velocities { vec4 velocities[]; };

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= uint(positions.length())) {
        return;
    }
    vec4 velocity = velocities[i] + time * vec4(0.0, -9.81, 0.0, 0.0);
    vec4 position = positions[i] + time * velocity;
    if (position.y < 0.0) {
        position.y = -position.y;
        velocity.y = -0.75 * velocity.y;
    }
    positions[i] = position;
    velocities[i] = velocity;
}
