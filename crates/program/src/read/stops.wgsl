// What derivatives are made of in a module that is run: the operands of the four members of a quad, and which of them
// are known. Each function notes the operand of its member at the derivative with this number, stops the invocation
// where it is not to go further, and gives the difference between neighbours.

var<private> sc_stopped: bool;
var<private> sc_member: u32;
var<private> sc_pass: u32;
var<private> sc_at: u32;
var<private> sc_values: array<vec4<f32>, 64>;
var<private> sc_known: array<u32, 64>;

fn sc_note(value: vec4<f32>, site: u32) {
    let at = sc_at + site;
    sc_values[sc_member * 16u + at] = value;
    sc_known[sc_member * 16u + at] = 1u;
    sc_stopped = at + 1u >= sc_pass;
}

// The neighbours along an axis: bit 0 of a member is x, bit 1 is y. A neighbour that has not come by leaves no value.
fn sc_across(bit: u32, site: u32) -> vec4<f32> {
    let at = sc_at + site;
    let low = (sc_member & (3u - bit)) * 16u + at;
    let high = (sc_member | bit) * 16u + at;
    let known = (sc_known[low] == 1u) & (sc_known[high] == 1u);
    var bits = 0x7fc00000u;
    return select(vec4<f32>(bitcast<f32>(bits)), sc_values[high] - sc_values[low], known);
}

fn sc_x_1(value: f32, site: u32) -> f32 {
    sc_note(vec4<f32>(value, 0.0, 0.0, 0.0), site);
    return sc_across(1u, site).x;
}

fn sc_y_1(value: f32, site: u32) -> f32 {
    sc_note(vec4<f32>(value, 0.0, 0.0, 0.0), site);
    return sc_across(2u, site).x;
}

fn sc_width_1(value: f32, site: u32) -> f32 {
    sc_note(vec4<f32>(value, 0.0, 0.0, 0.0), site);
    return (abs(sc_across(1u, site)) + abs(sc_across(2u, site))).x;
}

fn sc_x_2(value: vec2<f32>, site: u32) -> vec2<f32> {
    sc_note(vec4<f32>(value, 0.0, 0.0), site);
    return sc_across(1u, site).xy;
}

fn sc_y_2(value: vec2<f32>, site: u32) -> vec2<f32> {
    sc_note(vec4<f32>(value, 0.0, 0.0), site);
    return sc_across(2u, site).xy;
}

fn sc_width_2(value: vec2<f32>, site: u32) -> vec2<f32> {
    sc_note(vec4<f32>(value, 0.0, 0.0), site);
    return (abs(sc_across(1u, site)) + abs(sc_across(2u, site))).xy;
}

fn sc_x_3(value: vec3<f32>, site: u32) -> vec3<f32> {
    sc_note(vec4<f32>(value, 0.0), site);
    return sc_across(1u, site).xyz;
}

fn sc_y_3(value: vec3<f32>, site: u32) -> vec3<f32> {
    sc_note(vec4<f32>(value, 0.0), site);
    return sc_across(2u, site).xyz;
}

fn sc_width_3(value: vec3<f32>, site: u32) -> vec3<f32> {
    sc_note(vec4<f32>(value, 0.0), site);
    return (abs(sc_across(1u, site)) + abs(sc_across(2u, site))).xyz;
}

fn sc_x_4(value: vec4<f32>, site: u32) -> vec4<f32> {
    sc_note(value, site);
    return sc_across(1u, site);
}

fn sc_y_4(value: vec4<f32>, site: u32) -> vec4<f32> {
    sc_note(value, site);
    return sc_across(2u, site);
}

fn sc_width_4(value: vec4<f32>, site: u32) -> vec4<f32> {
    sc_note(value, site);
    return (abs(sc_across(1u, site)) + abs(sc_across(2u, site)));
}
