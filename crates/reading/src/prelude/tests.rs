use super::*;

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
    assert_eq!(fits("void main() { pc_fragColor = vec4(1.0); }"), Some("three"));
    assert_eq!(fits("out vec4 pc_fragColor;\nvoid main() { pc_fragColor = vec4(1.0); }"), None);
    assert_eq!(fits("uniform mat4 a, projectionMatrix;\nvoid main() { gl_Position = projectionMatrix * p; }"), None);
    assert_eq!(fits("vec4 effect(vec4 c, Image i, vec2 t, vec2 s) { return Texel(i, t); }"), Some("love"));
    assert_eq!(fits("#version 120\nvarying highp vec4 c;"), Some("qt"));
    assert_eq!(fits("#version 300 es\nin highp vec4 c;"), None);
    assert_eq!(fits("varying highp vec4 c;"), None, "it may be of OpenGL ES");
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
