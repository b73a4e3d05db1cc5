//! What is found in texts of HLSL and Slang.

use super::*;

fn heads(text: &str) -> Vec<String> {
    let outline = Outline::read(text);
    outline.functions.iter().map(|head| format!("{} = {}", head.keeper(0), head.label(&outline))).collect()
}

#[test]
fn heads_are_found_outside_of_types_and_values() {
    let text = "struct S { float a; float get() { return a; } };\n#define F(x) { \\\n float no(int i) { \n\
                static const float t[2] = { 1.0, 2.0 };\n// float c() {}\nnamespace N { float half(float x) { return x; } }\n\
                float open(float x);\ninline float f(in float3 p, inout S s = {0}, out float q[2]) { if (x) { } }\n";
    let found = heads(text);
    assert_eq!(found.len(), 2, "{found:?}");
    assert!(found[0].ends_with("sc_0_result = N::half(sc_0_0); } = N::half"), "{found:?}");
    let wanted = "static S sc_0_1_kept; static float sc_0_2_kept[2]; static float sc_0_result; void sc_keep_0() { float3 sc_0_0; \
                  S sc_0_1; float sc_0_2[2]; sc_0_result = f(sc_0_0, sc_0_1, sc_0_2); sc_0_1_kept = sc_0_1; sc_0_2_kept = \
                  sc_0_2; } = f";
    assert_eq!(found[1], wanted);
}

#[test]
fn overloads_have_their_types_and_generics_are_unfit() {
    let text = "vector<float, 3> f(float x) { }\nfloat f(matrix<float,2,2> m, float[3] a) { }\nT g<T : IFloat>(T x) { }\n\
                func h(x : float) -> float2 { }\nfloat t(Texture2D tex) { }";
    let outline = Outline::read(text);
    let labels: Vec<String> = outline.functions.iter().map(|head| head.label(&outline)).collect();
    assert_eq!(labels, ["f(float)", "f(matrix<float,2,2>,float[3])", "g", "h", "t"]);
    let unfit: Vec<bool> = outline.functions.iter().map(|head| head.unfit.is_some()).collect();
    assert_eq!(unfit, [false, false, true, false, true]);
    assert_eq!(
        (outline.functions[0].result.as_str(), outline.functions[3].result.as_str()),
        ("vector<float,3>", "float2")
    );
    assert_eq!(
        (outline.functions[3].params[0].name.as_str(), outline.functions[3].params[0].ty.as_str()),
        ("x", "float")
    );
}

#[test]
fn outputs_are_named_by_their_semantics() {
    let text = "struct V { float2 uv : TEXCOORD0; float4 p : SV_Position; float d[2] : SV_ClipDistance; };\n\
                V vs(out float s : PSIZE) { }\nfloat4 ps(out float z : SV_Depth) : SV_Target { }";
    let outline = Outline::read(text);
    assert_eq!(outline.output("vs", &["SV_POSITION"]), Some("p"));
    assert_eq!(outline.output("vs", &["SV_CLIPDISTANCE"]), Some("d"));
    assert_eq!(outline.output("vs", &["PSIZE"]), Some("s"));
    assert_eq!(outline.output("ps", &["SV_DEPTH"]), Some("z"));
    assert_eq!(outline.output("ps", &["SV_TARGET"]), Some("return"));
    assert_eq!(outline.output("ps", &["SV_POSITION"]), None);
}

#[test]
fn stages_follow_from_attributes_and_semantics() {
    let text = "struct V { float4 p : SV_Position; };\n[shader(\"pixel\")] float4 a() : SV_Target { }\n\
                [numthreads(8, 1, 1)] void b(uint3 id : SV_DispatchThreadID) { }\nV vsMain(float3 p : POSITION) { }\n\
                V helper(float3 p) { }\nfloat4 psMain(V v) : SV_Target0 { }\nvoid main() { }\n[shader(\"mesh\")] void m() { }";
    let outline = Outline::read(text);
    let points: Vec<(&str, Option<Stage>)> =
        outline.points().map(|(head, stage)| (head.name.as_str(), stage)).collect();
    let wanted = [
        ("a", Some(Stage::Fragment)),
        ("b", Some(Stage::Compute)),
        ("vsMain", Some(Stage::Vertex)),
        ("psMain", Some(Stage::Fragment)),
        ("main", None),
        ("m", None),
    ];
    assert_eq!(points, wanted);
}
