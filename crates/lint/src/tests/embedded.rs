//! Shaders in literals of C++, seen from what is reported.

use crate::{Input, run};
use base::text::SourceFile;
use hosts::HostFile;
use syntax::Stage;

fn stages(text: &str) -> Vec<(String, Stage)> {
    let host = HostFile::new(&SourceFile::new("m.cpp", text), true);
    host.embedded().iter().map(|e| (e.name.clone(), e.stage)).collect()
}

const BODY: &str = r##""#version 150 core\n" "out vec4 c;\n" "void main() { c = vec4(1.0); }\n""##;

#[test]
fn texts_are_found_with_their_stage() {
    for (text, expected) in [
        (format!("const char *fs = {BODY};"), Some("m.cpp#fs")),
        (format!("static const GLchar *const source[] = {{ {BODY} }}; void f() {{ make(GL_FRAGMENT_SHADER, source); }}"), Some("m.cpp#source")),
        (format!("void f() {{ std::string t = {BODY}; GLuint s = glCreateShader(GL_FRAGMENT_SHADER); const char *p = t.c_str(); glShaderSource(s, 1, &p, 0); }}"), Some("m.cpp#t")),
        (format!("auto fragment = std::string({BODY});"), Some("m.cpp#fragment")),
        (format!("void f() {{ GLuint s = compile(GL_FRAGMENT_SHADER, {BODY}); }}"), Some("m.cpp#1")),
        ("const char *fs = R\"(\n#version 150\nout vec4 c;\nvoid main() { c = vec4(1.0); })\";".to_owned(), Some("m.cpp#fs")),
        ("#define GLSL(x) \"#version 150\\n\" #x\nconst char *fs = GLSL(out vec4 c;\nvoid main() { c = vec4(1.0); });".to_owned(), Some("m.cpp#fs")),
        ("const char *fs = \"precision mediump float;\\n\" \"varying vec4 v;\\n\" \"void main() { gl_FragColor = v; }\\n\";".to_owned(), Some("m.cpp#fs")),
        ("#define STR(...) #__VA_ARGS__\nconst char *fs = \"#version 150\\n\" STR(out vec4 c, d;\nvoid main() { c = d = vec4(1.0); });".to_owned(), Some("m.cpp#fs")),
    ] {
        let expected: Vec<(String, Stage)> = expected.map(|n| (n.to_owned(), Stage::Fragment)).into_iter().collect();
        assert_eq!(stages(&text), expected, "{text}");
    }
}

#[test]
fn parts_and_texts_of_unknown_stage_are_left_alone() {
    for text in [
        format!("const char *source = {BODY};"),
        format!("std::string fs = header + {BODY};"),
        "const char *fs = \"#version 150\\n\" DEFINES \"void main() {}\";".to_owned(),
        "const char *fs = \"void main() { c = vec4(1.0); }\";".to_owned(),
        "const char *fs = \"#version 150\\nout vec4 c;\\n\";".to_owned(),
        "const char *fs = \"varying mediump vec4 v;\\nvoid main() { gl_FragColor = v; }\";".to_owned(),
        "const char *fs = \"#version %d\\nvoid main() {}\";".to_owned(),
        "const char *s[] = { \"#version 150\\n\", \"void main() { gl_Position = p; }\" };".to_owned(),
    ] {
        assert_eq!(stages(&text), [], "{text}");
    }
}

#[test]
fn rules_on_shaders_report_at_the_line_of_the_host_file() {
    let text = "const char *fs =\n  \"#version 150 core\\n\"\n  \"out vec4 c;\\n\"\n  \"void main() { c = vec4(3.1416); }\\n\";\n";
    let found = run(&[Input::new(SourceFile::new("m.cpp", text))]);
    let reported: Vec<String> = found.iter().map(|d| format!("{} {}", d.file.locate(d.span.start), d.code)).collect();
    assert_eq!(reported, ["m.cpp:4:27 N014"]);
    let fix = found[0].fix.as_ref().unwrap();
    assert_eq!(found[0].file.slice(fix.edits[0].span), "3.1416");
}

#[test]
fn a_text_that_breaks_off_anywhere_does_no_harm() {
    let text = "#define GLSL(v, x) \"#version \" #v \"\\n\" #x\nconst char *頂点 = GLSL(150, in vec4 p;\nvoid main() { gl_Position = p; });\n\
                const char *fs = \"#version 150 core\" \"out vec4 c; // 色\\n\" \"void main() { c = vec4(3.14); }\\n\";\n\
                const char *g = R\"x(#version 150\nvoid main() { 頂 })x\";\n\
                void f() { Shader s(\"a.vert\", \"a.frag\"); s.setVec3((\"l[\" + i + \"].m\").c_str(), v);\n\
                GLuint p = glCreateProgram(); glAttachShader(p, make(GL_VERTEX_SHADER, 頂点)); glLinkProgram(p);\n\
                glBindAttribLocation(p, 0, \"p\"); glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 2, 0); }\n";
    for (end, _) in text.char_indices() {
        for d in run(&[Input::new(SourceFile::new("m.cpp", &text[..end]))]) {
            let edits = d.fix.iter().flat_map(|f| &f.edits).map(|e| e.span);
            for span in edits.chain([d.span]) {
                assert!(d.file.text().get(span.range()).is_some(), "cut at {end}: {d:#?}");
            }
        }
    }
}

#[test]
fn a_fix_lands_in_the_literal() {
    use crate::Settings;
    use base::diagnostic::Safety;
    let text = "const char *fs = \"#version 150 core\\n\"\n  \"in int m;\\n\"\n  \"out vec4 c;\\n\" \"void main() { c = vec4(m); }\\n\";\n";
    let outcome = crate::fix::fix(&[Input::new(SourceFile::new("m.cpp", text))], &Settings::default(), Safety::Safe);
    assert_eq!(outcome.files[0].after.text(), text.replace("in int m", "flat in int m"));
}
