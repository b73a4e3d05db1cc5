// How often each of 16 values occurs: counted for each workgroup first, then added to what the bins hold.
@group(0) @binding(0) var<storage, read> keys: array<u32>;
@group(0) @binding(1) var<storage, read_write> bins: array<atomic<u32>, 16>;

var<workgroup> counts: array<atomic<u32>, 16>;

@compute @workgroup_size(32)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(local_invocation_index) local: u32) {
    if (local < 16u) {
        atomicStore(&counts[local], 0u);
    }
    workgroupBarrier();
    if (id.x < arrayLength(&keys)) {
        atomicAdd(&counts[keys[id.x] & 15u], 1u);
    }
    workgroupBarrier();
    if (local < 16u) {
        atomicAdd(&bins[local], atomicLoad(&counts[local]));
    }
}
