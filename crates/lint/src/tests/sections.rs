//! Files that hold several shaders, seen from what is reported.

use crate::{Input, run};
use base::text::SourceFile;

fn reported(text: &str) -> Vec<String> {
    let file = SourceFile::new("both.glsl", text);
    let found = run(&[Input::new(file)]);
    found.iter().map(|d| format!("{} {} {}", d.code, d.file.locate(d.span.start), d.message)).collect()
}

const BOTH: &str = "// Both stages\n#type vertex\n#version 330 core\nlayout(location = 0) in vec3 p;\nout vec3 n;\n\
    void main() { n = p; gl_Position = vec4(p, 1.0); }\n\n#type fragment\n#version 330 core\n\
    in vec3 n;\nout vec4 c;\nvoid main() { c = vec4(n, 1.0); }\n";

#[test]
fn both_shaders_are_read() {
    assert_eq!(reported(BOTH), [""; 0]);
    let wrong = BOTH.replace("vec4(n, 1.0)", "vec3(n, 1.0)");
    let found = reported(&wrong);
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(found[0].contains("both.glsl:12:19"), "{found:?}");
}

#[test]
fn other_languages_under_the_same_ending_are_left_alone() {
    let file = SourceFile::new("toon.shader", "Shader \"Toon\" { SubShader { Pass { CGPROGRAM ENDCG } } }\n");
    assert!(run(&[Input::new(file)]).is_empty());
    let file = SourceFile::new("both.shader", BOTH.replace("#type", "#shader").replace("vec4(n", "vec3(n"));
    assert_eq!(run(&[Input::new(file)]).len(), 1);
}

#[test]
fn sections_of_godot_are_shaders() {
    let text = "#[compute]\n#version 450\nlayout(local_size_x = 64) in;\nlayout(set = 0, binding = 0) buffer D { float d[]; };\n\
        void main() { uint i = gl_GlobalInvocationID.x; if (i < uint(d.length())) d[i] = vec2(1.0).x; }\n";
    assert_eq!(reported(text), [""; 0]);
    let found = reported(&text.replace("vec2(1.0).x", "vec2(1.0)"));
    assert!(found.len() == 1 && found[0].contains("both.glsl:5:"), "{found:?}");
    let both = BOTH.replace("#type vertex", "#[vertex]").replace("#type fragment", "#[fragment]");
    assert_eq!(reported(&both), [""; 0]);
    let found = reported(&both.replace("vec4(n, 1.0)", "vec3(n, 1.0)"));
    assert!(found.len() == 1 && found[0].contains("both.glsl:12:19"), "{found:?}");
}

const BRANCHES: &str = "#if defined(VERTEX)\nattribute vec4 p;\nvarying vec2 t;\nvoid main() { t = p.xy; gl_Position = p; }\n\
    #elif defined(FRAGMENT)\nvarying vec2 t;\nuniform sampler2D s;\nvoid main() { gl_FragColor = texture2D(s, t); }\n#endif\n";

#[test]
fn branches_for_the_stages_are_two_shaders() {
    assert_eq!(reported(BRANCHES), [""; 0]);
    let found = reported(&BRANCHES.replace("texture2D(s, t)", "texture2D(s, t) * (1 - t.x)"));
    assert!(found.len() == 1 && found[0].starts_with("T006 both.glsl:8:"), "{found:?}");
    let found = reported(&BRANCHES.replace("t = p.xy;", "t = p.xr;"));
    assert!(found.len() == 1 && found[0].starts_with("T009 both.glsl:4:"), "{found:?}");
    // With a version, which stays in front.
    assert_eq!(reported(&format!("#version 120\n{BRANCHES}")), [""; 0]);
    // A parameter is a uniform there.
    let parameter =
        "#pragma parameter GAIN \"Gain\" 1.0 0.0 2.0 0.1\n#ifdef PARAMETER_UNIFORM\nuniform float GAIN;\n#endif\n";
    let shader = BRANCHES.replace("varying vec2 t;\nuniform", &format!("varying vec2 t;\n{parameter}uniform"));
    assert_eq!(reported(&shader.replace("texture2D(s, t)", "GAIN * texture2D(s, t)")), [""; 0]);
}

#[test]
fn a_file_with_two_versions_holds_two_shaders() {
    let both = |first: &str, between: &str| {
        format!(
            "{first}\n#version 330 core\nlayout(location = 0) in vec3 p;\nout vec3 n;\nvoid main() {{ n = p; gl_Position = vec4(p, 1.0); }}\n{between}\n\
            #version 330 core\nin vec3 n;\nout vec4 c;\nvoid main() {{ c = vec4(n, 1.0); }}\n"
        )
    };
    for (first, between) in [("#vert", "#frag"), ("//BEGIN_VS", "//BEGIN_FS"), ("@vs", "@end\n@fs"), ("", "")] {
        let text = both(first, between);
        assert_eq!(reported(&text), [""; 0], "{text}");
        let found = reported(&text.replace("vec4(n, 1.0)", "vec3(n)"));
        assert!(found.len() == 1 && found[0].starts_with("T003 "), "{text}: {found:?}");
    }
    let branches =
        "#ifdef GL_ES\n#version 300 es\n#else\n#version 330\n#endif\nvoid main() { gl_Position = vec4(1.0); }\n";
    assert!(hosts::sections::sections(&SourceFile::new("one.glsl", branches)).is_empty());
}

#[test]
fn other_branches_are_one_shader() {
    for text in [BRANCHES.replace("VERTEX", "MORPH").replace("FRAGMENT", "SKIN"), format!("#define VERTEX\n{BRANCHES}")]
    {
        let file = SourceFile::new("both.glsl", text);
        assert!(hosts::sections::sections(&file).is_empty());
    }
}

#[test]
fn titles_and_separators_cut_a_file() {
    let vertex = "attribute vec4 p;\nvoid main() { gl_Position = p; }\n";
    let fragment = "void main() { gl_FragColor = vec4(1.0); }\n";
    let titles = format!("/* Both */\n---VERTEX SHADER------\n{vertex}\n---FRAGMENT SHADER----\n{fragment}");
    let separated = format!("{vertex}\n$$\n{fragment}");
    for text in [titles, separated] {
        assert_eq!(reported(&text), [""; 0]);
        let found = reported(&text.replace("vec4(1.0)", "vec3(1.0)"));
        assert!(found.len() == 1 && found[0].starts_with("T003 "), "{found:?}");
    }
}

#[test]
fn what_a_host_puts_in_the_place_of_a_line_is_no_error() {
    let text = "$HEADER$\nuniform vec2 size;\nvoid main() { gl_FragColor = frag_color * texture2D(texture0, size); }\n";
    let reported = |text: &str| {
        let found = run(&[Input::new(SourceFile::new("default.fs", text))]);
        found.iter().map(|d| format!("{} {}", d.code, d.file.locate(d.span.start))).collect::<Vec<_>>()
    };
    assert_eq!(reported(text), [""; 0]);
    assert_eq!(reported(&text.replace("size);", "size.xs);")), ["T009 default.fs:3:68"]);
    let broken = reported(&text.replace("vec2 size;", "vec2 size"));
    assert!(broken.len() == 1 && broken[0].starts_with("E001 default.fs:"), "{broken:?}");
    let half = SourceFile::new("default.fs", text.replace("$HEADER$", "$HEADER"));
    assert!(hosts::sections::template(&half).is_none(), "not a whole line");
}

#[test]
fn they_are_linked() {
    let apart = BOTH.replace("in vec3 n;", "in vec3 normal;").replace("vec4(n, 1.0)", "vec4(normal, 1.0)");
    let found = reported(&apart);
    assert!(found.iter().any(|f| f.starts_with("I001")), "{found:?}");
}

#[test]
fn two_functions_main_in_branches_are_two_stages() {
    let text = "#version 330\n#if defined VERTEX_SHADER\nin vec3 p;\nout vec2 uv;\nvoid main() { uv = p.xy; gl_Position = vec4(p, 1.0); }\n\
        #elif defined FRAGMENT_SHADER\nout vec4 tint;\nin vec2 uv;\nvoid main() { tint = vec4(uv, 0.0, 1.0); }\n#endif\n";
    assert_eq!(reported(text), [""; 0]);
    let found = reported(&text.replace("vec4(uv, 0.0, 1.0)", "vec3(uv, 0.0)"));
    assert!(found.len() == 1 && found[0].contains("both.glsl:9:"), "{found:?}");
}
