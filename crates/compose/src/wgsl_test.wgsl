// The assertions of the package `wgsl_test`, in a form that decides nothing: each call writes down what it was given, and the
// one who runs the test judges it.

struct Expectation {
    actual: vec4f,
    expected: vec4f,
    // Relative and absolute, or in the first the number of ULP.
    tolerance: vec2f,
    words: vec2u,
    kind: u32,
    width: u32,
    site: u32,
}

struct Record {
    // How many assertions were reached.
    count: u32,
    // The one that was asked for.
    last: Expectation,
}

var<private> record: Record;
var<private> wanted: u32;
var<private> site: u32;

const relTol: f32 = 1e-3;
const absTol: f32 = 1e-6;

fn put(kind: u32, width: u32, actual: vec4f, expected: vec4f, tolerance: vec2f, words: vec2u) {
    if (record.count == wanted) {
        record.last = Expectation(actual, expected, tolerance, words, kind, width, site);
    }
    record.count += 1u;
}

fn expect(condition: bool) { put(1u, 0u, vec4f(), vec4f(), vec2f(), vec2u(u32(condition), 1u)); }

fn expectEq(actual: u32, expected: u32) { put(2u, 0u, vec4f(), vec4f(), vec2f(), vec2u(actual, expected)); }

fn expectWithin(actual: f32, expected: f32, rel: f32, abs_: f32) {
    put(3u, 1u, vec4f(actual, 0.0, 0.0, 0.0), vec4f(expected, 0.0, 0.0, 0.0), vec2f(rel, abs_), vec2u());
}
fn expectWithinVec2(actual: vec2f, expected: vec2f, rel: f32, abs_: f32) {
    put(3u, 2u, vec4f(actual, 0.0, 0.0), vec4f(expected, 0.0, 0.0), vec2f(rel, abs_), vec2u());
}
fn expectWithinVec3(actual: vec3f, expected: vec3f, rel: f32, abs_: f32) {
    put(3u, 3u, vec4f(actual, 0.0), vec4f(expected, 0.0), vec2f(rel, abs_), vec2u());
}
fn expectWithinVec4(actual: vec4f, expected: vec4f, rel: f32, abs_: f32) {
    put(3u, 4u, actual, expected, vec2f(rel, abs_), vec2u());
}

fn expectNear(actual: f32, expected: f32) { expectWithin(actual, expected, relTol, absTol); }
fn expectNearVec2(actual: vec2f, expected: vec2f) { expectWithinVec2(actual, expected, relTol, absTol); }
fn expectNearVec3(actual: vec3f, expected: vec3f) { expectWithinVec3(actual, expected, relTol, absTol); }
fn expectNearVec4(actual: vec4f, expected: vec4f) { expectWithinVec4(actual, expected, relTol, absTol); }

fn expectUlp(actual: f32, expected: f32, most: u32) {
    put(4u, 1u, vec4f(actual, 0.0, 0.0, 0.0), vec4f(expected, 0.0, 0.0, 0.0), vec2f(f32(most), 0.0), vec2u());
}
fn expectUlpVec2(actual: vec2f, expected: vec2f, most: u32) {
    put(4u, 2u, vec4f(actual, 0.0, 0.0), vec4f(expected, 0.0, 0.0), vec2f(f32(most), 0.0), vec2u());
}
fn expectUlpVec3(actual: vec3f, expected: vec3f, most: u32) {
    put(4u, 3u, vec4f(actual, 0.0), vec4f(expected, 0.0), vec2f(f32(most), 0.0), vec2u());
}
fn expectUlpVec4(actual: vec4f, expected: vec4f, most: u32) {
    put(4u, 4u, actual, expected, vec2f(f32(most), 0.0), vec2u());
}
