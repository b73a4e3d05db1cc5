// Inclusive prefix sums: blocks of 64 one after the other, each by doubling distances, with what came before carried on.
@group(0) @binding(0) var<storage, read> values: array<u32>;
@group(0) @binding(1) var<storage, read_write> sums: array<u32>;

var<workgroup> part: array<u32, 64>;

@compute @workgroup_size(64)
fn main(@builtin(local_invocation_index) local: u32) {
    let count = arrayLength(&values);
    var carried = 0u;
    for (var first = 0u; first < count; first += 64u) {
        let i = first + local;
        part[local] = 0u;
        if (i < count) {
            part[local] = values[i];
        }
        workgroupBarrier();
        for (var by = 1u; by < 64u; by <<= 1u) {
            var before = 0u;
            if (local >= by) {
                before = part[local - by];
            }
            workgroupBarrier();
            part[local] += before;
            workgroupBarrier();
        }
        if (i < count) {
            sums[i] = carried + part[local];
        }
        carried += part[63];
        workgroupBarrier();
    }
}
