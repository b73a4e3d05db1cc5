//! Operators, conversions, constructors and built-in functions of numbers.

use super::gives;

#[test]
fn integers_become_floats_where_they_are_wanted() {
    gives(
        "float f(float a) { return a / 2; }",
        "float a = 3; vec2 b = vec2(1, 2) + 1; float c = i; c *= 2; r = vec4(a / 2, b.y, c, f(u));",
        [1.5, 3.0, -14.0, 2.5],
    );
    gives(
        "",
        "vec3 a = ivec3(1, 2, 3); uint b = 3; int c = i / 2; r = vec4(a.y + i, b + i, c, 7 / 2);",
        [-5.0, 4_294_967_292.0, -3.0, 3.0],
    );
    gives("", "vec4 a = v; a += 1; a.xy *= ivec2(2, 3); r = a;", [4.0, 9.0, 4.0, 5.0]);
}

#[test]
fn constructors_take_what_they_need() {
    gives(
        "",
        "mat2 a = mat2(v); vec2 b = vec2(v); mat3 c = mat3(a); r = vec4(a[1], b.y, c[2][2]);",
        [3.0, 4.0, 2.0, 1.0],
    );
    gives(
        "",
        "mat2 a = mat2(mat4(v, v + 4.0, v, v)); ivec2 b = ivec2(2.7, -2.7); bvec2 c = bvec2(x, 0.0); r = vec4(a[1], b.y, c.x && !c.y);",
        [5.0, 6.0, -2.0, 1.0],
    );
    gives(
        "",
        "mat2x3 a = mat2x3(2.0); mat3 b = mat3(v.xyz, v.y, v.zw, 7, 8, 9); r = vec4(a[1].y, a[0].z, b[1].z, b[2].x);",
        [2.0, 0.0, 4.0, 7.0],
    );
    gives(
        "",
        "float a = float(v); int b = int(true); uint c = uint(-1); vec3 d = vec3(v.zw, mat2(5)); r = vec4(a, b, c == 4294967295u, d.z);",
        [1.0, 1.0, 1.0, 5.0],
    );
}

#[test]
fn matrices_multiply_and_everything_else_goes_by_component() {
    gives(
        "",
        "mat2 m = mat2(1, 2, 3, 4); mat2 n = mat2(5, 6, 7, 8); r = vec4(m * n[0], n[0] * m);",
        [23.0, 34.0, 17.0, 39.0],
    );
    gives(
        "",
        "mat2 m = mat2(1, 2, 3, 4); mat2 n = mat2(5, 6, 7, 8); mat2 p = m * n; m *= n; r = vec4(p[0][0], p[1][1], m == p, (-n)[0].x);",
        [23.0, 46.0, 1.0, -5.0],
    );
    gives(
        "",
        "mat2 m = mat2(1, 2, 3, 4); mat2 n = 12.0 / m + 1.0; mat2 k = n / m; r = vec4(n[0], k[1]);",
        [13.0, 7.0, 5.0 / 3.0, 1.0],
    );
    gives(
        "",
        "mat3x2 m = mat3x2(1, 2, 3, 4, 5, 6); mat2x3 t = transpose(m); mat2 p = m * t; vec2 q = m * v.xyz; r = vec4(p[0], q);",
        [35.0, 44.0, 22.0, 28.0],
    );
    gives("", "mat2 a = matrixCompMult(mat2(v), mat2(2.0)); mat2 b = outerProduct(v.xy, v.zw); mat2 c = inverse(mat2(4, 7, 2, 6));
      r = vec4(a[1][1], b[1].x, c[0][0], determinant(mat2(v)));", [8.0, 4.0, 0.6, -2.0]);
}

#[test]
fn integer_operators() {
    gives(
        "",
        "int a = 0xF0; uint b = 6u; a ^= 0xFF; a <<= 2; b |= 1u; r = vec4(a, b & 3u, i >> 1, ~i);",
        [60.0, 3.0, -4.0, 6.0],
    );
    gives(
        "",
        "ivec2 a = ivec2(7, 8) % 4; uvec2 b = uvec2(1, 2) << 3; uint c = -u; r = vec4(a.x, a.y, b.y, c == 4294967291u);",
        [3.0, 0.0, 16.0, 1.0],
    );
    gives("", "bool a = true ^^ (x > 0.0); ivec2 b = ivec2(12, 10) & 6; r = vec4(a, b, !a);", [0.0, 4.0, 2.0, 1.0]);
}

#[test]
fn comparisons_of_vectors() {
    gives(
        "",
        "bvec4 a = lessThan(v, vec4(2.5)); bvec2 b = not(a.xz); r = vec4(any(a), all(a), b.y, v == vec4(1, 2, 3, 4));",
        [1.0, 0.0, 1.0, 1.0],
    );
    gives(
        "",
        "vec4 a = mix(v, -v, greaterThanEqual(v, vec4(3))); r = vec4(a.yz, equal(ivec2(i), ivec2(-7, 1)));",
        [2.0, -3.0, 1.0, 0.0],
    );
}

#[test]
fn functions_with_several_values() {
    gives(
        "",
        "float w; float f = modf(-x, w); int e; float m = frexp(x, e); r = vec4(f, w, m, e);",
        [-0.5, -3.0, 0.875, 2.0],
    );
    gives(
        "",
        "vec2 w; vec2 f = modf(vec2(x, 1.25), w); ivec2 e; vec2 m = frexp(vec2(8.0, 0.75), e); r = vec4(f.y, w.x, m.x, e.x + e.y);",
        [0.25, 3.0, 0.5, 4.0],
    );
    gives(
        "",
        "uint c; uint a = uaddCarry(4294967295u, u, c); uint b; uint d = usubBorrow(u, 6u, b); r = vec4(a, c, d == 4294967295u, b);",
        [4.0, 1.0, 1.0, 1.0],
    );
    let product = i64::from(-7_i32) * 2_000_000_011;
    let unsigned = 4_000_000_007_u64 * 3_999_999_979;
    gives(
        "",
        &format!(
            "int h, l; imulExtended(i, 2000000011, h, l); uint a, b; umulExtended(4000000007u, 3999999979u, a, b);
      r = vec4(h == {}, l == {}, a == {}u, b == {}u);",
            product >> 32,
            product as i32,
            unsigned >> 32,
            unsigned as u32
        ),
        [1.0; 4],
    );
}

#[test]
fn bits_are_counted_packed_and_moved() {
    gives(
        "",
        "r = vec4(bitCount(0xF1), findLSB(8u), findMSB(i), bitfieldExtract(0xABC, 4, 4));",
        [5.0, 3.0, 2.0, -5.0],
    );
    gives(
        "",
        "r = vec4(bitfieldInsert(0, 5, 2, 3), bitfieldReverse(1u) == 2147483648u, floatBitsToInt(1.0) == 0x3F800000, uintBitsToFloat(0x40000000u));",
        [20.0, 1.0, 1.0, 2.0],
    );
    gives("", "uint a = packUnorm2x16(vec2(1.0, 0.0)); vec2 b = unpackHalf2x16(0x3C004000u); uint c = packSnorm4x8(vec4(1, -1, 0, 0));
      r = vec4(a, b, c == 0x817Fu);", [65535.0, 2.0, 1.0, 1.0]);
}

#[test]
fn integers_are_converted_where_the_other_kind_is_wanted() {
    // `u` is a `uint`; an `int` beside it becomes one (GLSL 4.60, 4.1.10).
    gives(
        "",
        "uint u = 1u; int k = 3; r = vec4(bitfieldInsert(u, k, 3, 5), bitfieldInsert(k, u, 0, 1), max(u, k), clamp(k, u, 2u));",
        [25.0, 3.0, 3.0, 2.0],
    );
    gives(
        "",
        "uint carry; uint low; uint high; int k = 3; uint sum = uaddCarry(4294967295u, k, carry); umulExtended(65536u, 65536, high, low);
         r = vec4(sum, carry, high, low);",
        [2.0, 1.0, 1.0, 0.0],
    );
    gives(
        "",
        "int word = 0x3C004000; r = vec4(unpackHalf2x16(word), floatBitsToUint(1) == 0x3F800000u, isnan(word));",
        [2.0, 1.0, 1.0, 0.0],
    );
}

#[test]
fn functions_of_numbers() {
    let x = 3.5_f64;
    gives(
        "",
        "r = vec4(mod(-x, 2.0), atan(-1.0, -1.0), atan(x), ldexp(x, 3));",
        [0.5, (-1.0_f64).atan2(-1.0), x.atan(), 28.0],
    );
    gives("", "r = vec4(mod(v, 3).w, clamp(v, 2, 3).x, smoothstep(1, 3, v).y, step(2, v).x);", [1.0, 2.0, 0.5, 0.0]);
    gives("", "r = vec4(max(i, 3), abs(i), sign(-x), min(u, 4u));", [3.0, 7.0, -1.0, 4.0]);
    gives("", "r = vec4(pow(x, 2.0), exp2(x), inversesqrt(4), fma(x, 2.0, 1.0));", [12.25, x.exp2(), 0.5, 8.0]);
    gives("", "r = vec4(trunc(-x), roundEven(2.5), fract(-x), degrees(radians(x)));", [-3.0, 2.0, 0.5, 3.5]);
}

#[test]
fn geometric_functions_take_numbers_too() {
    gives("", "r = vec4(length(-x), distance(x, 1), dot(x, 2.0), normalize(-x));", [3.5, 2.5, 7.0, -1.0]);
    let k: f64 = 1.0 - 0.25 * (1.0 - 0.25);
    gives(
        "",
        "r = vec4(reflect(x, 1.0), faceforward(x, 1.0, 2.0), refract(0.5, 1.0, 0.5), refract(0.1, 1.0, 2.0));",
        [-3.5, -3.5, 0.5 * 0.5 - (0.5 * 0.5 + k.sqrt()), 0.0],
    );
    gives("", "r = vec4(cross(v.xyz, v.zyx), dot(v, v)) + vec4(0, 0, 0, length(vec2(3, 4)));", [-4.0, 8.0, -4.0, 35.0]);
    gives("", "r = vec4(isnan(x), isinf(x), faceforward(v.xy, v.xy, -v.xy));", [0.0, 0.0, 1.0, 2.0]);
}
