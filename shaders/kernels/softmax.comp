#version 450
// exp(x) of each number of a row, divided by the sum of them. The largest of the row is taken out, so that nothing
// overflows. A workgroup has a row.
layout(local_size_x = 32) in;
layout(std430, binding = 0) readonly buffer Values { float values[]; };
layout(std430, binding = 1) writeonly buffer Shares { float shares[]; };

shared float part[32];

void main() {
    uint local = gl_LocalInvocationIndex;
    uint columns = uint(values.length()) / gl_NumWorkGroups.x;
    uint row = gl_WorkGroupID.x * columns;

    float largest = -3.4e38;
    for (uint k = local; k < columns; k += 32u) {
        largest = max(largest, values[row + k]);
    }
    part[local] = largest;
    barrier();
    for (uint width = 16u; width > 0u; width >>= 1) {
        if (local < width) {
            part[local] = max(part[local], part[local + width]);
        }
        barrier();
    }
    largest = part[0];
    barrier();

    float sum = 0.0;
    for (uint k = local; k < columns; k += 32u) {
        sum += exp(values[row + k] - largest);
    }
    part[local] = sum;
    barrier();
    for (uint width = 16u; width > 0u; width >>= 1) {
        if (local < width) {
            part[local] += part[local + width];
        }
        barrier();
    }
    for (uint k = local; k < columns; k += 32u) {
        shares[row + k] = exp(values[row + k] - largest) / part[0];
    }
}
