struct sc_Expectation { vec4 actual; vec4 expected; vec2 tolerance; ivec2 words; int kind; int width; int site; };
struct sc_Record { int count; sc_Expectation last; };
sc_Record sc_record;
int sc_wanted;
int sc_site;
void sc_put(int kind, int width, vec4 actual, vec4 expected, vec2 tolerance, ivec2 words) {
  if (sc_record.count == sc_wanted) {
    sc_record.last = sc_Expectation(actual, expected, tolerance, words, kind, width, sc_site);
  }
  sc_record.count++;
}
void expect(bool condition) { sc_put(1, 0, vec4(0.0), vec4(0.0), vec2(0.0), ivec2(condition ? 1 : 0, 1)); }
void expectEq(int actual, int expected) { sc_put(2, 0, vec4(0.0), vec4(0.0), vec2(0.0), ivec2(actual, expected)); }
void expectEq(bool actual, bool expected) { expectEq(actual ? 1 : 0, expected ? 1 : 0); }
#if __VERSION__ >= 130
void expectEq(uint actual, uint expected) { expectEq(int(actual), int(expected)); }
#endif
void expectWithin(float a, float b, float rel, float abs_) { sc_put(3, 1, vec4(a, 0.0, 0.0, 0.0), vec4(b, 0.0, 0.0, 0.0), vec2(rel, abs_), ivec2(0)); }
void expectWithin(vec2 a, vec2 b, float rel, float abs_) { sc_put(3, 2, vec4(a, 0.0, 0.0), vec4(b, 0.0, 0.0), vec2(rel, abs_), ivec2(0)); }
void expectWithin(vec3 a, vec3 b, float rel, float abs_) { sc_put(3, 3, vec4(a, 0.0), vec4(b, 0.0), vec2(rel, abs_), ivec2(0)); }
void expectWithin(vec4 a, vec4 b, float rel, float abs_) { sc_put(3, 4, a, b, vec2(rel, abs_), ivec2(0)); }
void expectNear(float a, float b) { expectWithin(a, b, 1e-3, 1e-6); }
void expectNear(vec2 a, vec2 b) { expectWithin(a, b, 1e-3, 1e-6); }
void expectNear(vec3 a, vec3 b) { expectWithin(a, b, 1e-3, 1e-6); }
void expectNear(vec4 a, vec4 b) { expectWithin(a, b, 1e-3, 1e-6); }
void expectUlp(float a, float b, int most) { sc_put(4, 1, vec4(a, 0.0, 0.0, 0.0), vec4(b, 0.0, 0.0, 0.0), vec2(float(most), 0.0), ivec2(0)); }
void expectUlp(vec2 a, vec2 b, int most) { sc_put(4, 2, vec4(a, 0.0, 0.0), vec4(b, 0.0, 0.0), vec2(float(most), 0.0), ivec2(0)); }
void expectUlp(vec3 a, vec3 b, int most) { sc_put(4, 3, vec4(a, 0.0), vec4(b, 0.0), vec2(float(most), 0.0), ivec2(0)); }
void expectUlp(vec4 a, vec4 b, int most) { sc_put(4, 4, a, b, vec2(float(most), 0.0), ivec2(0)); }
