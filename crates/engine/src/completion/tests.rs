//! What stands for declarations that a text lacks.

use base::text::SourceFile;
use syntax::{Parsed, Shader, Stage};

use super::{Completed, completed, declared_notes, errors};

fn parsed(file: &SourceFile, with: &Completed) -> Parsed {
    let stage = if file.text().contains("main") { Stage::Fragment } else { Stage::Library };
    Shader::parse_with(&with.put(file), stage, &with.macros())
}

/// What each name is taken for.
fn of(text: &str) -> Option<Vec<String>> {
    let file = SourceFile::new("a.frag", text);
    let found = completed(&|with| parsed(&file, with), &mut |_| Vec::new(), &mut |_| Vec::new())?;
    let read = parsed(&file, &found);
    assert_eq!(errors(&read), 0, "{}", read.shader.file().text());
    Some(found.declared.iter().map(|stand| format!("{} {}", stand.name, stand.what().replace('`', ""))).collect())
}

#[test]
fn what_is_used_and_nowhere_declared_gets_the_plainest_type_that_fits() {
    for (text, expected) in [
        (
            "#version 330 core\nin vec2 uv;\nout vec4 color;\nvoid main() {\n  Light l = lights[0];\n\
             vec3 n = normalize(getNormal(uv));\n  float d = max(dot(n, l.direction), 0.0) * intensity;\n\
             color = vec4(l.color * d + texture(albedoMap, uv).rgb, 1.0);\n}\n\
             float falloff(float x) { return pow(x - 1.0, gamma); }\n",
            &[
                "Light a structure",
                "lights Light[16]",
                "intensity float",
                "albedoMap sampler2D",
                "gamma float",
                "getNormal a function that gives vec3",
            ][..],
        ),
        // What has no value before a call gets one by it.
        (
            "#version 330\nin vec3 n; out vec4 c;\nvoid main() { vec3 diffuse, specular;\n\
             lighting(n, material.shininess, diffuse, specular);\n\
             c = vec4(diffuse * material.albedo.rgb + specular, 1.0); }\n",
            &["material_type a structure", "material a structure", "lighting a function that gives vec3"],
        ),
        // A structure within another one.
        (
            "float f(Ray r) { return length(r.origin - r.limit.near.xyz) * r.limit.far; }\n",
            &["Ray a structure", "Ray_limit_type a structure"],
        ),
        (
            "vec3 sum() { vec3 s = vec3(0.0); for (int i = 0; i < count; ++i) s += lights[i].color * weights[i];\n\
             return s; }\n",
            &["count int", "lights_type a structure", "lights a structure[16]", "weights float[16]"],
        ),
        ("vec4 f(vec3 p) { return mvp * vec4(p, 1.0); }\n", &["mvp mat4"]),
        // Of each type that it gets, it gives one.
        ("vec3 f(vec3 p, float q) { return saturate(p) * saturate(q); }\n", &["saturate a function that gives vec3"]),
        (
            "#version 330\nvoid main() { fragColor = texture(tex, uv); }\n",
            &["tex sampler2D", "uv vec2", "fragColor vec4"],
        ),
        // One that is made of values, and is not asked for its members.
        ("Hit f(float x) { return Hit(vec3(x), vec3(x), 2); }\n", &["Hit a structure"]),
        // One that is made of values, of which some are asked for.
        ("float f(vec3 x) { Hit h = Hit(x, 2.0, x); return h.distance + h.at.x; }\n", &["Hit a structure"]),
        // A macro of the file that is not there.
        (
            "@import ./head;\nSET_PRECISION;\nfloat f(float x) { return x * scale; }\n",
            &["@import ./head; nothing", "scale float"],
        ),
        // What mathematics has a name for is that number.
        ("float f(float x) { return x * TWO_PI / scale; }\n", &["scale float"]),
        // A file that is not there.
        (
            "#include \"light.glsl\"\nfloat f(vec3 n) { return dot(n, light.way) / PI; }\n",
            &["#include \"light.glsl\" nothing", "light_type a structure", "light a structure"],
        ),
    ] {
        assert_eq!(of(text).as_deref().unwrap_or_default(), expected, "{text}");
    }
}

#[test]
fn what_is_wrong_otherwise_stays_wrong() {
    for (text, name) in [
        ("float f(float x) { return x * vec2(scale); }\n", "scale"),
        ("#version 330\nout vec4 c;\nvoid main() { c = vec3(tint); }\n", "tint"),
        ("float f(float x) { return shade(x) + vec3(1.0).q2; }\n", "shade"),
    ] {
        let file = SourceFile::new("a.frag", text);
        let found = completed(&|with| parsed(&file, with), &mut |_| Vec::new(), &mut |_| Vec::new()).unwrap();
        let names: Vec<&str> = found.declared.iter().map(|stand| stand.name.as_str()).collect();
        assert_eq!((names, errors(&parsed(&file, &found))), (vec![name], 1), "{text}");
    }
    assert_eq!(of("float f(float x) { return x; }\n"), None);
}

#[test]
fn declarations_lead_to_their_uses_and_move_no_line() {
    let text =
        "float one(float x) { return x; }\n\n// shadercheck: x in [0, 1]\nfloat two(float x) { return scale * x; }\n";
    let file = SourceFile::new("a.frag", text);
    let found = completed(&|with| parsed(&file, with), &mut |_| Vec::new(), &mut |_| Vec::new()).unwrap();
    let put = found.put(&file);
    for word in ["float two", "scale * x"] {
        let (at, own) = (put.text().find(word).unwrap(), text.find(word).unwrap());
        assert_eq!(put.locate(at), file.locate(own), "{}", put.text());
    }
    // A comment stays in front of its function.
    assert!(put.text().contains("// shadercheck: x in [0, 1]\nfloat two"), "{}", put.text());
    assert_eq!(
        declared_notes(&found.declared),
        ["a name that nothing declares is taken for inputs of any value: `scale` as `float`"]
    );
}

#[test]
fn what_an_error_of_the_text_asks_for_is_a_number_that_conditions_name() {
    let assumed = |guard: &str| {
        let text = format!(
            "#version 330\n{guard}\n#error \"state the phase\"\n#endif\nout vec4 c;\nvoid main() {{\n\
             #if PHASE == 2\nc = vec4(1.0);\n#elif PHASE == 3\nc = vec4(0.5);\n#endif\n}}\n"
        );
        let file = SourceFile::new("a.frag", text);
        completed(&|with| parsed(&file, with), &mut |_| Vec::new(), &mut |_| Vec::new()).map(|found| found.assumed)
    };
    let two = Some(vec![("PHASE".to_owned(), "2".to_owned())]);
    for guard in ["#ifndef PHASE", "#if !defined(PHASE)", "#if !defined PHASE"] {
        assert_eq!(assumed(guard), two, "{guard}");
    }
    // Nothing that is defined takes these away.
    for guard in ["#ifdef __LINE__", "#if 1", "#ifndef PHASE\n#else"] {
        assert_ne!(assumed(guard), two, "{guard}");
    }
}
