#version 450
// The product of two matrices, by tiles: row by row, a has `inner` columns and b has `columns`.
layout(local_size_x = 8, local_size_y = 8) in;
layout(std140, binding = 0) uniform Shape { uint rows; uint inner; uint columns; };
layout(std430, binding = 1) readonly buffer A { float a[]; };
layout(std430, binding = 2) readonly buffer B { float b[]; };
layout(std430, binding = 3) writeonly buffer C { float c[]; };

shared float tileA[8][8];
shared float tileB[8][8];

void main() {
    uint row = gl_GlobalInvocationID.y;
    uint column = gl_GlobalInvocationID.x;
    uvec2 local = gl_LocalInvocationID.xy;
    float sum = 0.0;
    for (uint k = 0u; k < inner; k += 8u) {
        uint across = k + local.x;
        uint down = k + local.y;
        tileA[local.y][local.x] = row < rows && across < inner ? a[row * inner + across] : 0.0;
        tileB[local.y][local.x] = down < inner && column < columns ? b[down * columns + column] : 0.0;
        barrier();
        for (uint i = 0u; i < 8u; i++) {
            sum += tileA[local.y][i] * tileB[i][local.x];
        }
        barrier();
    }
    if (row < rows && column < columns) {
        c[row * columns + column] = sum;
    }
}
