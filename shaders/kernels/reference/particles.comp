#version 450
// One step of particles: where each would be, and what the floor makes of it.
layout(local_size_x = 1) in;
layout(std140, binding = 0) uniform Step { float time; };
layout(std430, binding = 1) buffer Positions { vec4 positions[]; };
layout(std430, binding = 2) buffer Velocities { vec4 velocities[]; };

void main() {
    for (int i = 0; i < positions.length(); i++) {
        velocities[i].y -= 9.81 * time;
        positions[i] += time * velocities[i];
        if (positions[i].y < 0.0) {
            velocities[i].y *= -0.75;
        }
        positions[i].y = abs(positions[i].y);
    }
}
