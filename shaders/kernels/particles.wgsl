// One step of particles under gravity. The floor at y = 0 throws them back and takes a part of their speed.
@group(0) @binding(0) var<uniform> time: f32;
@group(0) @binding(1) var<storage, read_write> positions: array<vec4f>;
@group(0) @binding(2) var<storage, read_write> velocities: array<vec4f>;

@compute @workgroup_size(32)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let i = id.x;
    if (i >= arrayLength(&positions)) {
        return;
    }
    var velocity = velocities[i] + time * vec4f(0.0, -9.81, 0.0, 0.0);
    var position = positions[i] + time * velocity;
    if (position.y < 0.0) {
        position.y = -position.y;
        velocity.y = -0.75 * velocity.y;
    }
    positions[i] = position;
    velocities[i] = velocity;
}
