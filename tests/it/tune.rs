//! `shadercheck tune`: what must be `highp` is found with its input, what need not be is lowered, and what cannot be tuned
//! is said.

use std::fs;

use serde_json::Value;

use crate::binary::{Ran, root, run_in};

/// Runs on a copy of the fixtures, so that nothing is written beside them.
fn tuned(arguments: &str) -> (Ran, tempfile::TempDir) {
    let folder = tempfile::tempdir().unwrap();
    for file in fs::read_dir(root().join("fixtures/tune")).unwrap() {
        let file = file.unwrap();
        fs::copy(file.path(), folder.path().join(file.file_name())).unwrap();
    }
    (run_in(folder.path(), &format!("tune {arguments} --samples 2048")), folder)
}

/// The declarations that must be `highp`.
fn high(report: &Value) -> Vec<&str> {
    let all = report["files"][0]["declarations"].as_array().unwrap();
    all.iter().filter(|one| one["may_be"] == "highp").map(|one| one["what"].as_str().unwrap()).collect()
}

fn declaration<'r>(report: &'r Value, what: &str) -> &'r Value {
    let all = report["files"][0]["declarations"].as_array().unwrap();
    all.iter().find(|one| one["what"] == what).unwrap_or_else(|| panic!("{what}: {report}"))
}

#[test]
fn a_squared_distance_stays_highp_and_the_rest_goes_down() {
    let report = tuned("distance.frag --format json").0.expect(1).json();
    assert_eq!(report["status"], "can be lower");
    assert!(high(&report).contains(&"squared"), "{report}");
    assert!(!high(&report).contains(&"input v_tint"), "{report}");
    assert_eq!(report["files"][0]["smallest"], true, "{report}");
    let why = &declaration(&report, "squared")["why"];
    assert!(why["message"].as_str().unwrap().contains("range of `mediump`"), "{why}");
    assert!(!why["inputs"].as_array().unwrap().is_empty(), "{why}");
}

#[test]
fn where_all_may_go_down_the_default_does() {
    let report = tuned("all.frag --format json").0.expect(1).json();
    assert!(high(&report).is_empty(), "{report}");
    let patch = report["files"][0]["patch"].as_str().unwrap();
    assert!(patch.contains("+precision mediump float;"), "{patch}");
    assert!(report["files"][0]["worst"].as_str().unwrap().parse::<f64>().unwrap() <= 1.0);
}

#[test]
fn where_none_may_nothing_is_changed() {
    let (ran, folder) = tuned("none.frag --format json --fix");
    let report = ran.expect(0).json();
    assert_eq!((report["status"].as_str(), high(&report).len()), (Some("clean"), 2), "{report}");
    let own = fs::read_to_string(root().join("fixtures/tune/none.frag")).unwrap();
    assert_eq!(fs::read_to_string(folder.path().join("none.frag")).unwrap(), own);
}

#[test]
fn what_is_too_low_is_raised() {
    let (ran, folder) = tuned("wrong.frag --format json --fix");
    let report = ran.expect(0).json();
    assert_eq!(report["status"], "too low");
    let raised = high(&report);
    assert!(raised.contains(&"texel") && !raised.contains(&"part"), "{report}");
    assert_eq!(report["files"][0]["written"], true);
    // What was written has nothing left.
    let again = run_in(folder.path(), "tune wrong.frag --samples 2048 --format json").expect(0).json();
    assert_eq!(again["status"], "clean", "{again}");
}

#[test]
fn a_sampler_of_data_is_a_cause_and_one_of_colours_is_not() {
    let report = tuned("data.frag --format json").0.expect(1).json();
    assert!(high(&report).contains(&"sampler u_heights"), "{report}");
    assert!(!high(&report).contains(&"sampler u_tint"), "{report}");
    let patch = report["files"][0]["patch"].as_str().unwrap();
    assert!(
        patch.contains("+uniform highp sampler2D u_heights;") && !patch.contains("sampler2D u_tint;\n+"),
        "{patch}"
    );
}

#[test]
fn coordinates_that_a_vertex_stage_hands_on_stay_highp() {
    let arguments = "coordinates.vert --error 0.01 --viewport 64x64 --format json";
    let report = tuned(arguments).0.expect(1).json();
    assert!(high(&report).contains(&"output v_uv") && high(&report).contains(&"uv"), "{report}");
    assert!(!high(&report).contains(&"output v_tint"), "{report}");
    assert_eq!(declaration(&report, "output v_uv")["texels"], 2048);
    // Of small textures the error that is stated decides.
    let report = tuned(&format!("{arguments} --texture-size 64")).0.json();
    assert!(!high(&report).contains(&"output v_uv"), "{report}");
}

#[test]
fn what_cannot_be_tuned_is_said() {
    let says = |arguments: &str, text: &str| {
        let (ran, _) = tuned(arguments);
        let ran = ran.expect(2);
        assert!(ran.err.contains(text), "{arguments}: {}", ran.err);
    };
    says("distance.frag --domain v_delta=[0,inf)", "range without an end");
    says("distance.frag --domain v_delta=[2,1]", "is empty");
    says("distance.frag --target rgba9", "no format `rgba9` is known");
    says("distance.frag --error 0", "--error");
    says("distance.frag --error nothing=0.1", "there is no output `nothing`");
    says("distance.frag --entry nothing", "there is no function `nothing`");
    says("distance.frag --viewport 0x5", "width and height");
    says("position.vert", "--viewport 1920x1080");
    says("empty.frag", "nothing to tune");
}

#[test]
fn a_position_may_be_off_by_half_a_pixel() {
    let at = |viewport: &str, status: i32| {
        let ran = tuned(&format!("position.vert --viewport {viewport} --format json")).0.expect(status);
        high(&ran.json()).len()
    };
    assert_eq!(at("64x64", 1), 0, "64 pixels need seven bits");
    assert_eq!(at("7680x4320", 0), 1, "7680 pixels need more than ten");
}

#[test]
fn coordinates_of_large_textures_stay_highp() {
    // Without `#version`: GLSL ES 1.00, as browsers take it.
    let text = "precision highp float;\nvarying vec2 uv;\nvarying vec4 tint;\nuniform sampler2D image;\nvoid main() {\n  \
                vec2 at = uv + 0.25;\n  vec4 shade = tint * 0.5;\n  gl_FragColor = texture2D(image, at) * shade;\n}\n";
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("image.frag"), text).unwrap();
    let tuned = |size: u32| {
        let command = format!("tune image.frag --samples 2048 --format json --texture-size {size}");
        run_in(folder.path(), &command).expect(1).json()
    };
    let large = tuned(2048);
    assert!(high(&large).contains(&"input uv") && high(&large).contains(&"at"), "{large}");
    assert!(!high(&large).contains(&"shade") && !high(&large).contains(&"input tint"), "{large}");
    assert_eq!(declaration(&large, "at")["texels"], 2048, "{large}");
    assert!(!high(&tuned(256)).contains(&"input uv"));
    let patch = large["files"][0]["patch"].as_str().unwrap();
    assert!(!patch.contains("#version"), "{patch}");
}

/// The declarations that must be `highp` in a text of GLSL ES 1.00.
fn high_in(name: &str, text: &str, arguments: &str) -> Vec<String> {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join(name), text).unwrap();
    let ran = run_in(folder.path(), &format!("tune {name} --samples 1024 --format json {arguments}"));
    let report = ran.json();
    high(&report).into_iter().map(str::to_owned).collect()
}

#[test]
fn what_reaches_a_coordinate_through_products_and_functions_stays_highp() {
    let text = "precision highp float;\nvarying vec2 v_uv;\nvarying vec3 v_tint;\nuniform vec2 u_tiling;\n\
                uniform sampler2D u_image;\nvec2 tile(vec2 at) { vec2 moved = at; moved *= u_tiling; return moved; }\n\
                void main() {\n  vec3 shade = v_tint * 0.5;\n  \
                gl_FragColor = vec4(texture2D(u_image, tile(v_uv)).rgb * shade, 1.0);\n}\n";
    let all = high_in("tiles.frag", text, "");
    for what in ["input v_uv", "uniform u_tiling", "the result of tile", "at of tile", "moved"] {
        assert!(all.iter().any(|one| one == what), "{what}: {all:?}");
    }
    assert!(!all.iter().any(|one| one == "input v_tint" || one == "shade"), "{all:?}");
    // A texture of 256 texels that may be repeated has more texels than `mediump` tells apart; one that is not has fewer.
    assert!(high_in("tiles.frag", text, "--texture-size 256").contains(&"input v_uv".to_owned()));
    let plain = text.replace("moved *= u_tiling;", "");
    assert!(!high_in("plain.frag", &plain, "--texture-size 256").contains(&"input v_uv".to_owned()));
}

#[test]
fn coordinates_are_followed_into_outputs_that_names_do_not_tell() {
    let text = "precision highp float;\nattribute vec4 a_position;\nattribute vec2 a_texCoord;\nattribute vec3 a_tint;\n\
                uniform vec2 u_scale;\nvarying vec2 v_where;\nvarying vec3 v_tint;\nvoid main() {\n  \
                v_where = a_texCoord * u_scale;\n  v_tint = a_tint;\n  gl_Position = a_position;\n}\n";
    let all = high_in("tiles.vert", text, "--error 0.01 --viewport 64x64");
    for what in ["output v_where", "uniform u_scale", "input a_texCoord"] {
        assert!(all.iter().any(|one| one == what), "{what}: {all:?}");
    }
    assert!(!all.iter().any(|one| one == "output v_tint"), "{all:?}");
}

#[test]
fn highp_of_an_author_stays_until_a_range_is_stated() {
    let text = "precision mediump float;\nvarying highp vec2 v_place;\nvarying highp vec3 v_color;\nvoid main() {\n  \
                highp vec2 near = v_place * 0.25;\n  gl_FragColor = vec4(v_color, clamp(near.x, 0.0, 1.0));\n}\n";
    let all = high_in("place.frag", text, "");
    assert!(all.contains(&"input v_place".to_owned()) && all.contains(&"near".to_owned()), "{all:?}");
    assert!(!all.contains(&"input v_color".to_owned()), "{all:?}");
    let stated = high_in("place.frag", text, "--domain v_place=[0,1]");
    assert!(stated.is_empty(), "{stated:?}");
}

#[test]
fn a_position_of_unknown_size_is_never_lowered() {
    let text = "precision mediump float;\nuniform vec2 u_screen_size;\nattribute vec2 a_pos;\nvoid main() {\n  \
                gl_Position = vec4(2.0 * a_pos / u_screen_size - 1.0, 0.0, 1.0);\n}\n";
    assert!(high_in("screen.vert", text, "--viewport 64x64").contains(&"input a_pos".to_owned()));
    let stated = high_in("screen.vert", text, "--viewport 64x64 --domain a_pos=[0,1] --domain u_screen_size=[1,2]");
    assert!(!stated.contains(&"input a_pos".to_owned()), "{stated:?}");
}

#[test]
fn shaders_in_host_code_and_behind_a_mark_are_tuned_in_their_file() {
    let domain = "--domain v_at=[-300,300] --format json";
    for (name, written) in [("Line.java", "highp float far"), ("line.glsl", "highp float far")] {
        let (ran, folder) = tuned(&format!("{name} {domain} --fix"));
        let report = ran.expect(0).json();
        let all = report["files"].as_array().unwrap();
        let fragment = all.last().unwrap();
        let declarations = fragment["declarations"].as_array().unwrap();
        let far = declarations.iter().find(|one| one["what"] == "far").unwrap_or_else(|| panic!("{name}: {report}"));
        assert_eq!(far["may_be"], "highp", "{name}: {report}");
        let text = fs::read_to_string(folder.path().join(name)).unwrap();
        let own = fs::read_to_string(root().join("fixtures/tune").join(name)).unwrap();
        let changed = text.contains(written) || text.contains("precision highp float;");
        assert!(changed && text != own, "{name}: {text}");
        assert_eq!(text.lines().count(), own.lines().count(), "{name}: nothing else is changed: {text}");
    }
}

#[test]
fn a_text_that_asks_for_opengl_es_is_tuned_as_a_phone_reads_it() {
    let report = tuned("line.glsl --domain v_at=[-300,300] --format json").0.expect(1).json();
    let files = report["files"].as_array().unwrap();
    let at = files.last().unwrap()["declarations"].as_array().unwrap();
    assert!(at.iter().any(|one| one["now"] == "mediump"), "{report}");
}
