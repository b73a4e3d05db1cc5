use super::*;
use crate::{Config, Input, Settings, run, run_with};

fn reported(name: &str, text: &str) -> Vec<String> {
    let found = run(&[Input::new(SourceFile::new(name, text))]);
    found.iter().map(|d| format!("{} {}", d.code, d.file.locate(d.span.start))).collect()
}

#[test]
fn each_prelude_is_glsl_and_has_a_title() {
    for prelude in PRELUDES {
        assert!(prelude.title() != prelude.name, "{}", prelude.name);
        for (stage, body) in [(Stage::Vertex, "gl_Position = vec4(0.0);"), (Stage::Fragment, "")] {
            let main = if prelude.name == "shadertoy" {
                "void mainImage(out vec4 c, in vec2 p) { c = vec4(p, iTime, 1.0); }".to_owned()
            } else {
                format!("void main() {{ {body} }}")
            };
            let text = Literal::part(&SourceFile::new("a", main.as_str()), Span::new(0, main.len()));
            let Some(all) = around(&text, stage, Wanted::Named(prelude)) else { continue };
            let parsed = syntax::Shader::parse(&SourceFile::new("a", all.literal.text.as_str()), stage);
            let errors: Vec<String> = parsed.diagnostics.iter().map(|d| d.message.to_string()).collect();
            // A precision is of a version of OpenGL ES, which this host does not state itself.
            let told = errors.iter().filter(|e| !e.contains("precision") && !e.contains("mainImage"));
            assert!(told.count() == 0, "{} {stage:?}: {errors:?}", prelude.name);
        }
    }
    let names: Vec<&str> = PRELUDES.iter().map(|p| p.name).collect();
    assert!(names.is_sorted());
}

#[test]
fn a_text_is_recognised_by_what_it_uses_and_does_not_declare() {
    let fits = |text: &str| PRELUDES.iter().find(|p| p.fits(text)).map(|p| p.name);
    assert_eq!(fits("void mainImage( out vec4 c, in vec2 p ) { c = vec4(iTime); }"), Some("shadertoy"));
    assert_eq!(fits("void mainImage(out vec4 c, in vec2 p) {}\nvoid main() { mainImage(c, p); }"), None);
    assert_eq!(fits("void main() { gl_Position = projectionMatrix * vec4(position, 1.0); }"), Some("three"));
    assert_eq!(fits("uniform mat4 a, projectionMatrix;\nvoid main() { gl_Position = projectionMatrix * p; }"), None);
    assert_eq!(fits("vec4 effect(vec4 c, Image i, vec2 t, vec2 s) { return Texel(i, t); }"), Some("love"));
    assert_eq!(fits("#version 120\nvarying highp vec4 c;"), Some("qt"));
    assert_eq!(fits("#version 300 es\nin highp vec4 c;"), None);
    assert_eq!(fits("varying highp vec4 c;"), None, "it may be of OpenGL ES");
}

#[test]
fn words_of_precision_stand_for_nothing_where_host_code_is_of_qt() {
    let shader = SourceFile::new("a.frag", "#version 120\nvarying highp vec4 c;\nvoid main() { gl_FragColor = c; }\n");
    let host = |class: &str| SourceFile::new("a.cpp", format!("void f() {{ {class} shader; }}"));
    let codes = |class: &str| {
        let found = run(&[Input::new(shader.clone()), Input::new(host(class))]);
        found.iter().map(|d| d.code.0).collect::<Vec<_>>()
    };
    assert_eq!(codes("QOpenGLShaderProgram"), [""; 0]);
    assert_eq!(codes("ShaderProgram"), ["V002"]);
}

#[test]
fn what_the_host_declares_is_known_and_a_slip_in_it_is_told() {
    let toy = |name: &str| {
        format!(
            "void mainImage(out vec4 color, in vec2 at) {{\n  color = vec4(at / iResolution.xy, {name}, 1.0);\n}}\n"
        )
    };
    assert_eq!(reported("image.frag", &toy("iTime")), [""; 0]);
    assert_eq!(reported("image.frag", &format!("#define NOW iTime\n{}", toy("NOW"))), [""; 0], "a macro for it");
    assert_eq!(reported("image.frag", &toy("iTimme")), ["E020 image.frag:2:37"]);
    assert_eq!(reported("image.frag", &toy("iResolution.w")), ["T009 image.frag:2:49"]);
    let three = |name: &str| {
        format!(
            "const vs = `\nvoid main() {{\n  gl_Position = projectionMatrix * modelViewMatrix * vec4({name}, 1.0);\n}}\n`;\n"
        )
    };
    assert_eq!(reported("a.js", &three("position + normal")), [""; 0]);
    assert_eq!(reported("a.js", &three("position + uv")), ["E031 a.js:3:68"]);
    let own = three("position").replace("void main", "attribute vec3 position;\nvoid main");
    assert_eq!(reported("a.js", &own), [""; 0], "what a text declares itself is left out");
    let block =
        "uniform Model {\n\tmat4\tmodelViewMatrix;\n\tmat3\tnormalMatrix;\n};\nattribute vec3 position;\nvoid main";
    assert_eq!(reported("a.js", &three("position").replace("void main", block)), [""; 0], "in a block as well");
}

#[test]
fn a_prelude_is_asked_for_and_refused_by_name() {
    let toy = "float f() { return iResolution.w; }\n";
    let with = |prelude: Wanted| {
        let settings = Settings { config: Config { prelude, ..Config::default() }, ..Settings::default() };
        let found = run_with(&[Input::new(SourceFile::new("a.glsl", toy))], &settings);
        found.iter().map(|d| d.code.0).collect::<Vec<_>>()
    };
    let named = Wanted::named("shadertoy").unwrap();
    assert_eq!(with(named), ["T009"]);
    assert_eq!(with(Wanted::Nothing), [""; 0]);
    assert_eq!(with(Wanted::Recognised), [""; 0]);
    assert!(Wanted::named("shadertoi").is_none());
}

#[test]
fn what_stands_around_does_not_move_places_or_count_as_the_authors() {
    let file = SourceFile::new(
        "a.frag",
        "#version 330 core\nvoid mainImage(out vec4 c, in vec2 p) {\n  c = vec4(iTime);\n}\n",
    );
    let (whole, _) = behind(&file, Stage::Library, Wanted::Recognised);
    assert!(whole.text().starts_with("#version 330 core\nprecision"), "{}", whole.text());
    assert!(whole.text().contains("void main()"));
    let at = whole.text().find("c = vec4").unwrap();
    assert_eq!(whole.locate(at).to_string(), "a.frag:3:3");
    assert_eq!(behind(&file, Stage::Fragment, Wanted::Nothing).0.text(), file.text());
}
