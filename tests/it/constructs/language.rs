//! Statements, functions, arrays, structures and initialisers.

use super::{expect, gives};

#[test]
fn the_right_side_of_a_short_circuit_runs_only_where_it_counts() {
    let globals = "int n = 0; bool step(bool b) { n++; return b; }";
    // Four calls of `step` on the left; on the right behind `true &&` and `false ||` alone.
    let body = "bool a = step(true) && step(true); bool b = step(false) && step(true);
      bool c = step(true) || step(false); bool d = step(false) || step(true);
      r = vec4(n, a && !b, c, d);";
    gives(globals, body, [6.0, 1.0, 1.0, 1.0]);
}

#[test]
fn a_conditional_computes_one_side() {
    let globals = "int n = 0; float f(float a) { n++; return a; }";
    gives(
        globals,
        "float a = x > 0.0 ? f(1.0) : f(2.0); int k = 0; int j = i < 0 ? k++ : ++k; r = vec4(a, n, k, j);",
        [1.0, 1.0, 1.0, 0.0],
    );
    gives("", "mat2 m = x > 0.0 ? mat2(1.0) : mat2(2.0); r = vec4(m[0], m[1]);", [1.0, 0.0, 0.0, 1.0]);
    gives(
        "",
        "float a[2] = i > 0 ? float[](1.0, 2.0) : float[](3.0, 4.0); r = vec4(a[0], a[1], 0, 0);",
        [3.0, 4.0, 0.0, 0.0],
    );
}

#[test]
fn globals_start_with_computed_values() {
    gives(
        "float twice = 2.0 * x; vec2 pair = vec2(twice, twice + 1.0); const float k[3] = float[3](5.0, 6.0, 7.0);",
        "r = vec4(twice, pair, k[i + 9]);",
        [7.0, 7.0, 8.0, 7.0],
    );
    gives(
        "const int N = 2 + 3; const vec3 d = vec3(N, 2, 3) * 2.0; struct S { int a; float b[2]; };
      const S s = S(4, float[2](8.0, 9.0));",
        "r = vec4(d, s.a + s.b[1]);",
        [10.0, 4.0, 6.0, 13.0],
    );
}

#[test]
fn a_switch_falls_through() {
    let body = |k: &str| {
        format!(
            "float a = 0.0; switch ({k}) {{ case 0: a += 1.0; case 1: a += 10.0; break; case 2: case 3: a += 100.0;
             default: a += 1000.0; }} r = vec4(a);"
        )
    };
    for (k, expected) in [("0", 11.0), ("1", 10.0), ("2", 1100.0), ("i + 10", 1100.0), ("9", 1000.0)] {
        gives("", &body(k), [expected; 4]);
    }
    gives(
        "",
        "float a = 0.0; for (int k = 0; k < 5; k++) { switch (k) { case 1: continue; case 3: a += 10.0; break;
      default: a += 1.0; } a += 100.0; } r = vec4(a);",
        [413.0; 4],
    );
    gives("", "uint k = u; float a = 1.0; switch (k) { case 5u: { a = 2.0; break; } } r = vec4(a);", [2.0; 4]);
}

#[test]
fn loops_of_every_kind() {
    gives(
        "",
        "int n = 0; for (int k = 0; k < 10; ++k) { if (k == 3) continue; if (k == 6) break; n += k; }
      int m = 0; while (m < 7) m += 2; int d = 0; do { d++; if (d == 2) continue; } while (d < 4);
      int e = 0; for (;;) { if (++e > 8) break; } r = vec4(n, m, d, e);",
        [12.0, 8.0, 4.0, 9.0],
    );
    gives(
        "",
        "int n = 0; int k = 3; while (bool more = k > 0) { n += k; k--; } r = vec4(n, k, 0, 0);",
        [6.0, 0.0, 0.0, 0.0],
    );
}

#[test]
fn arguments_are_copied_in_and_out() {
    let globals = "void swap(inout float a, inout float b) { float c = a; a = b; b = c; }
      void both(out int a, inout vec2 b) { a = 4; b.x += 1.0; } float half_of(float a) { a *= 0.5; return a; }";
    gives(
        globals,
        "vec4 w = v; swap(w.x, w.w); float a[2] = float[2](5.0, 6.0); swap(a[0], a[1]);
      r = vec4(w.x, w.w, a[0], half_of(w.y));",
        [4.0, 1.0, 6.0, 1.0],
    );
    gives(
        globals,
        "mat2 m = mat2(1, 2, 3, 4); float k; int j; both(j, m[1]); k = j; vec4 w = v; both(j, w.zy);
      r = vec4(m[1], w.z, w.y + k);",
        [4.0, 4.0, 4.0, 6.0],
    );
    // Both parameters are the same variable: each has its own copy.
    gives(
        "float f(inout float a, float b) { a = 10.0; return b; }",
        "float y = x; float z = f(y, y); r = vec4(y, z, 0, 0);",
        [10.0, 3.5, 0.0, 0.0],
    );
}

#[test]
fn functions_declared_before_they_are_defined_and_overloaded() {
    gives(
        "float f(float a); float f(vec2 a) { return f(a.x) + a.y; } float f(float a) { return a + 1.0; }",
        "r = vec4(f(x), f(v.xy), f(2), 0.0);",
        [4.5, 4.0, 3.0, 0.0],
    );
}

#[test]
fn arrays_are_values() {
    gives(
        "float[2] twice(float a[2]) { return float[2](2.0 * a[0], 2.0 * a[1]); }",
        "float a[] = float[](1.0, 2.0); float b[2] = twice(a); b[1] += float(a.length()); bool same = a == b;
         a = b; r = vec4(b[0], b[1], same, a == b);",
        [2.0, 6.0, 0.0, 1.0],
    );
    gives(
        "",
        "float a[2][3]; for (int p = 0; p < 2; p++) for (int q = 0; q < 3; q++) a[p][q] = float(10 * p + q);
      r = vec4(a[1][2], a[0][1], a.length(), a[0].length());",
        [12.0, 1.0, 2.0, 3.0],
    );
    gives(
        "",
        "int a[3] = { 1, 2, 3 }; vec2 b[2] = { { 1.0, 2.0 }, { 3, 4 } }; r = vec4(a[2], b[1], a[1]);",
        [3.0, 3.0, 4.0, 2.0],
    );
    gives("", "float a[]; a[2] = 5.0; a[0] = 1.0; r = vec4(a[2], a[0], a[1] * 0.0, 0);", [5.0, 1.0, 0.0, 0.0]);
}

#[test]
fn sizes_are_constant_expressions() {
    gives("const vec2 half_size = vec2(1.5, 2.0);",
        "float a[int(dot(half_size, vec2(2.0)))]; float b[length(vec2(3.0, 4.0)) > 4.0 ? 2 : 9];
         float c[int(mod(7.0, 4.0))]; const int n = 3; float d[n * 2]; r = vec4(a.length(), b.length(), c.length(), d.length());",
        [7.0, 2.0, 3.0, 6.0]);
}

#[test]
fn structures_are_values() {
    let globals = "struct P { vec2 a; float b; }; struct Q { P p[2]; int n; };";
    gives(
        globals,
        "Q q = Q(P[2](P(vec2(1, 2), 3.0), P(vec2(4), 5.0)), 6); Q s = q; s.p[1].a.y = 7.0; P t = s.p[i + 8];
      r = vec4(q == s, q != s, t.a.y, s.p[0].b + float(s.n));",
        [0.0, 1.0, 7.0, 9.0],
    );
}

#[test]
fn swizzles_are_read_and_written() {
    gives(
        "",
        "vec4 w = v; w.yx = w.zw; w.stp += 1.0; w.wzyx.x *= 2.0; float s = x; r = vec4(w.xy, s.xx.y, w.w);",
        [5.0, 4.0, 3.5, 8.0],
    );
    gives(
        "",
        "vec4 w = v; w[i + 9] = 9.0; mat3 m = mat3(1.0); m[1].zx = vec2(5.0, 6.0); m[2][i + 8] = 7.0;
      r = vec4(w.z, m[1].x, m[1][2], m[2].y);",
        [9.0, 6.0, 5.0, 7.0],
    );
    gives("", "r = vec4((v + 1.0)[1], (v * 2.0).zyx[i + 7], v.wz[1], vec2(1, 2).y);", [3.0, 6.0, 3.0, 2.0]);
}

#[test]
fn increments_give_the_old_or_the_new_value() {
    gives(
        "",
        "int k = 5; int a = k++; int b = --k; vec2 p = v.xy; vec2 q = p++; uint w = u; w--; r = vec4(a, b + k, p.y + q.x, w);",
        [5.0, 10.0, 4.0, 4.0],
    );
}

#[test]
fn comma_and_nested_assignment() {
    gives(
        "",
        "float a, b; a = b = x; int k = (a += 1.0, i + 1); r = vec4(a, b, k, (a = 2.0) + a);",
        [4.5, 3.5, -6.0, 4.0],
    );
}

#[test]
fn a_name_hides_another_in_its_own_block() {
    gives(
        "float a = 1.0;",
        "float b = a; float a = 2.0; { float a = 3.0; b += a; } for (int a = 0; a < 2; a++) b += 10.0;
      r = vec4(a, b, 0, 0);",
        [2.0, 24.0, 0.0, 0.0],
    );
}

#[test]
fn what_macros_write_is_run() {
    gives(
        "#define SQUARE(a) ((a) * (a))\n#define NAME(a) half_##a\n#if __VERSION__ >= 450\nfloat NAME(way) = 0.5;\n#else\nfloat NAME(way) = 9.0;\n#endif",
        "r = vec4(SQUARE(x + 1.0), half_way, __VERSION__, __LINE__ > 0);",
        [20.25, 0.5, 450.0, 1.0],
    );
    // The variables of both functions stand in one place.
    gives(
        "#define SUM(T) T sum(T a) { T b = a + a; T c = b * b; return c; }\nSUM(float) SUM(vec2)",
        "r = vec4(sum(x), sum(v.xy), 0.0);",
        [49.0, 4.0, 16.0, 0.0],
    );
}

#[test]
fn a_way_through_a_function_without_return_is_allowed() {
    // What is given there is undefined, and the way is not gone.
    let text = "#version 330\nin vec4 p; float f(float a) { if (a > 0.0) return a + 1.0; }
      float g(int k) { switch (k) { case 1: return 10.0; case 2: return 20.0; } }
      void main() { gl_Position = vec4(f(p.x), g(int(p.y)), g(1), f(4.0)); }";
    expect("t.vert", text, &[1.0, 2.0, 0.0, 0.0], &[], &[2.0, 20.0, 10.0, 5.0]);
}

#[test]
fn local_constants_with_values_of_the_run() {
    gives(
        "float twice(const float a) { const float b = a * 2.0; return b; }",
        "const float half_of = x * 0.5; const vec2 p = v.xy + half_of; r = vec4(p, twice(half_of), half_of);",
        [2.75, 3.75, 3.5, 1.75],
    );
}
