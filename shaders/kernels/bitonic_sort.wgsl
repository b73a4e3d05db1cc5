// Up to 64 keys in ascending order, by a bitonic network in one workgroup. Places behind the keys hold the largest number.
@group(0) @binding(0) var<storage, read_write> keys: array<u32>;

var<workgroup> own: array<u32, 64>;

@compute @workgroup_size(64)
fn main(@builtin(local_invocation_index) i: u32) {
    let count = arrayLength(&keys);
    own[i] = 0xffffffffu;
    if (i < count) {
        own[i] = keys[i];
    }
    workgroupBarrier();
    for (var run = 2u; run <= 64u; run <<= 1u) {
        for (var away = run >> 1u; away > 0u; away >>= 1u) {
            let other = i ^ away;
            if (other > i) {
                let rising = (i & run) == 0u;
                let a = own[i];
                let b = own[other];
                if ((a > b) == rising) {
                    own[i] = b;
                    own[other] = a;
                }
            }
            workgroupBarrier();
        }
    }
    if (i < count) {
        keys[i] = own[i];
    }
}
