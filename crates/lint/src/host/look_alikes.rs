//! Look-alikes of the host rules that are right, and planted faults in other shapes than the examples.

use crate::{Config, Input, Level, Selection, Settings, run_with};
use base::text::SourceFile;
use hosts::{Wrapped, Wrapper};

const VERTEX: &str = "#version 330 core\nlayout(location = 0) in vec3 position;\nlayout(location = 1) in uvec2 id;\n\
                      uniform mat4 mc;\nuniform mat3 normals[2];\nuniform bool flip;\n\
                      struct Light { vec4 place; float gain; };\nuniform Light lights[2];\n\
                      out vec4 c;\nvoid main() { c = lights[0].place * lights[1].gain + vec4(id, 0u, flip ? 1u : 0u);\n\
                      gl_Position = mc * vec4(normals[0] * position, 1.0); }\n";
const FRAGMENT: &str = "#version 330 core\nin vec4 c;\nuniform sampler2D image;\nuniform int count;\nuniform vec4 color;\n\
                        out vec4 fc;\nvoid main() { fc = c * color * texture(image, c.xy) * float(count); }\n";

fn codes_of(config: Config, body: &str) -> Vec<&'static str> {
    let host = format!("void f(const GLfloat *p) {{ Shader s(\"a.vert\", \"a.frag\"); {body} }}");
    let files = [("a.vert", VERTEX), ("a.frag", FRAGMENT), ("m.cpp", &host)];
    let inputs: Vec<Input> = files.iter().map(|(n, t)| Input::new(SourceFile::new(*n, *t))).collect();
    let selection = Selection::new(&[], &[]).unwrap().at(Level::Strict);
    let found = run_with(&inputs, &Settings { selection, config, ..Settings::default() });
    found.iter().map(|d| d.code.0).filter(|c| c.starts_with('H')).collect()
}

fn codes(body: &str) -> Vec<&'static str> {
    codes_of(Config::default(), body)
}

fn set(name: &str, call: &str) -> Vec<&'static str> {
    codes(&format!("GLint l = glGetUniformLocation(s.id, \"{name}\"); {call}"))
}

#[test]
fn setters_that_fit_are_silent() {
    for (name, call) in [
        ("mc", "glUniformMatrix4fv(l, 1, GL_FALSE, p);"),
        ("normals", "glUniformMatrix3fv(l, 2, GL_FALSE, p);"),
        ("normals[1]", "glUniformMatrix3fv(l, 1, GL_TRUE, p);"),
        ("flip", "glUniform1i(l, 1);"),
        ("flip", "glUniform1f(l, 1.0f);"),
        ("count", "glUniform1i(l, 3);"),
        ("image", "glUniform1i(l, 0);"),
        ("image", "glUniform1i(l, unit);"),
        ("color", "glUniform4fv(l, 1, p);"),
        ("color", "glUniform4fv(l, count, p);"),
        ("lights[1].gain", "glUniform1f(l, 0.5f);"),
        ("lights[0].place", "glUniform4f(l, 0, 0, 0, 1);"),
        ("color", "l = other(); glUniform3f(l, 1, 1, 1);"),
        ("color", "{ GLint l = 0; glUniform3f(l, 1, 1, 1); }"),
    ] {
        let found: Vec<_> = set(name, call).into_iter().filter(|c| *c != "H015").collect();
        assert!(found.is_empty(), "{name} {call}: {found:?}");
    }
}

#[test]
fn setters_that_do_not_fit_are_reported() {
    for (name, call, expected) in [
        ("mc", "glUniformMatrix3fv(l, 1, GL_FALSE, p);", "H019"),
        ("mc", "glUniform4fv(l, 4, p);", "H019"),
        ("mc", "glUniformMatrix4fv(l, 16, GL_FALSE, p);", "H019"),
        ("count", "glUniform1f(l, 3.0f);", "H010"),
        ("flip", "glUniform2i(l, 1, 1);", "H010"),
        ("color", "glUniform3fv(l, 1, p);", "H010"),
        ("color", "glUniform4fv(l, 4, p);", "H010"),
        ("lights[1].gain", "glUniform1i(l, 1);", "H010"),
        ("image", "glUniform1f(l, 0.0f);", "H011"),
        ("image", "glUniform1ui(l, 0);", "H011"),
        ("image", "glUniform1i(l, GL_TEXTURE3);", "H011"),
    ] {
        assert_eq!(set(name, call), [expected], "{name} {call}");
    }
}

#[test]
fn helper_methods_are_known_by_their_shape() {
    for silent in [
        "s.setMat4(\"mc\", m);",
        "s.setInt(\"image\", 0);",
        "s.setBool(\"flip\", true);",
        "s.setFloat(\"lights[1].gain\", 1.0f);",
        "s.setVec4(\"lights[\" + std::to_string(i) + \"].place\", v);",
        "s.setUniform(\"color\", v);",
        "other.setMat4(\"world\", m);",
        "s.setFloat(name, 1.0f);",
        "s.setTitle(\"world\");",
        "setMat4(\"world\", m);",
    ] {
        assert!(codes(silent).is_empty(), "{silent}");
    }
    for (reported, expected) in [
        ("s.setMat4(\"world\", m);", "H003"),
        ("s.setUniformValue(\"colour\", v);", "H003"),
        ("s.setVec4((\"lamps[\" + std::to_string(i) + \"].place\").c_str(), v);", "H003"),
        ("s.setMat4(\"position\", m);", "H003"),
        ("s.setVec3(\"color\", v);", "H010"),
        ("s.setMat3(\"mc\", m);", "H019"),
        ("s.setFloat(\"image\", 0.0f);", "H011"),
    ] {
        assert_eq!(codes(reported), [expected], "{reported}");
    }
}

#[test]
fn names_with_an_index_are_known_by_their_beginning() {
    for (array, expected) in [("lights", &[][..]), ("lamps", &["H003"][..])] {
        for name in [
            format!("(\"{array}[\" + std::to_string(i) + \"].gain\").c_str()"),
            format!("QString(\"{array}[%1].gain\").arg(i)"),
            format!("std::format(\"{array}[{{}}].gain\", i).c_str()"),
        ] {
            let look = format!("glGetUniformLocation(s.id, {name});");
            assert_eq!(codes(&look), expected, "{look}");
        }
        let kept = format!("std::string n = \"{array}[\" + i + \"].gain\"; glGetUniformLocation(s.id, n.c_str());");
        assert_eq!(codes(&kept), expected, "{kept}");
        let printed = format!("char n[9]; snprintf(n, 9, \"{array}[%d].gain\", i); glGetUniformLocation(s.id, n);");
        assert_eq!(codes(&printed), expected, "{printed}");
    }
    for silent in [
        "std::string n = \"lam\"; n += \"ps\"; glGetUniformLocation(s.id, n.c_str());",
        "glGetUniformLocation(s.id, (prefix + \"[0]\").c_str());",
        "glGetUniformLocation(s.id, format(\"{}[0]\", name));",
        "char n[9]; sprintf(n, \"a[%d]\", i); sprintf(n, \"lights[%d]\", i); glGetUniformLocation(s.id, n);",
    ] {
        assert!(codes(silent).is_empty(), "{silent}");
    }
}

#[test]
fn wrappers_of_the_configuration_are_followed() {
    let wrapper =
        Wrapper { function: "upload".into(), kind: Wrapped::SetUniform, argument: 1, sets: Some("vec3".into()) };
    let config = || Config { wrappers: vec![wrapper.clone()], ..Config::default() };
    assert_eq!(codes_of(config(), "upload(s, \"color\", v);"), ["H010"]);
    assert_eq!(codes_of(config(), "upload(s, \"colour\", v);"), ["H003"]);
    assert!(codes("upload(s, \"colour\", v);").is_empty(), "without the configuration nothing is known");
}

#[test]
fn pointers_of_attributes() {
    // That the other attribute gets nothing is beside the point.
    let codes = |body: &str| codes(body).into_iter().filter(|c| *c != "H033").collect::<Vec<_>>();
    for silent in [
        "glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 0, 0);",
        "glVertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, 8 * sizeof(GLfloat), (void *)0);",
        "glVertexAttribPointer(0, 3, GL_INT, GL_FALSE, 12, 0);",
        "glVertexAttribIPointer(1, 2, GL_UNSIGNED_INT, 0, 0);",
        "glVertexAttribPointer(5, 4, GL_FLOAT, GL_FALSE, 0, 0);",
        "glVertexAttribPointer(place, 4, GL_FLOAT, GL_FALSE, 0, 0);",
    ] {
        assert!(codes(silent).is_empty(), "{silent}");
    }
    for (reported, expected) in [
        ("glVertexAttribPointer(0, 4, GL_FLOAT, GL_FALSE, 0, 0);", "H007"),
        ("glVertexAttribPointer(1, 2, GL_UNSIGNED_INT, GL_FALSE, 0, 0);", "H008"),
        ("glVertexAttribIPointer(0, 3, GL_INT, 0, 0);", "H008"),
        ("glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 8, 0);", "H009"),
    ] {
        assert_eq!(codes(reported), [expected], "{reported}");
    }
}

#[test]
fn the_order_of_linking() {
    let alone = |body: &str| {
        let host = format!("void f(GLuint v) {{ {body} }}");
        let found = crate::run(&[Input::new(SourceFile::new("m.cpp", host))]);
        found.iter().map(|d| d.code.0).collect::<Vec<_>>()
    };
    let make = "GLuint p = glCreateProgram(); glAttachShader(p, v);";
    for silent in [
        format!("{make} glBindAttribLocation(p, 0, \"a\"); glLinkProgram(p);"),
        format!("{make} glLinkProgram(p); glBindAttribLocation(p, 0, \"a\"); glLinkProgram(p);"),
        format!("{make} glLinkProgram(p); glBindAttribLocation(q, 0, \"a\");"),
        format!("{make} glLinkProgram(p); glBindAttribLocation(p, 0, \"a\"); relink(p);"),
        format!("{make} glLinkProgram(p); p = make(); glBindAttribLocation(p, 0, \"a\");"),
        format!("{make} glLinkProgram(p); glGetUniformLocation(p, \"a\");"),
        format!("{make} glLinkProgram(p); glGetUniformLocation(p, \"a\"); glLinkProgram(p);"),
        format!("{make} while (again) {{ glGetUniformLocation(p, \"a\"); }} glLinkProgram(p);"),
        "glGetUniformLocation(p, \"a\"); glLinkProgram(p);".to_owned(),
    ] {
        assert!(alone(&silent).is_empty(), "{silent}");
    }
    assert_eq!(alone(&format!("{make} glLinkProgram(p); glBindFragDataLocation(p, 0, \"a\"); use(q);")), ["H014"]);
    assert_eq!(alone(&format!("{make} glGetAttribLocation(p, \"a\"); glLinkProgram(p);")), ["H013"]);
}

#[test]
fn stages_of_files_and_constants() {
    let alone = |body: &str| {
        let found = crate::run(&[Input::new(SourceFile::new("m.cpp", format!("void f() {{ {body} }}")))]);
        found.iter().map(|d| d.code.0).collect::<Vec<_>>()
    };
    assert_eq!(alone("compile(GL_FRAGMENT_SHADER, \"a.vert\");"), ["H022"]);
    // A name that says no stage: one of several texts of a stage, or a word that says it otherwise.
    for name in ["vs.glsl", "shade_vertex.glsl", "foo-vert.glsl", "common.glsl"] {
        assert_eq!(alone(&format!("compile(GL_VERTEX_SHADER, \"{name}\");")), [""; 0], "{name}");
    }
    assert_eq!(alone("p.addShaderFromSourceFile(QOpenGLShader::Vertex, \":/a.frag\");"), ["H022"]);
    let texts = "const char *v = \"#version 150\\nin vec4 p; void main() { gl_Position = p; }\"; \
                 const char *fs = \"#version 150\\nout vec4 c; void main() { c = gl_FragCoord; }\";";
    assert_eq!(alone(&format!("{texts} make(GL_FRAGMENT_SHADER, v);")), ["H022"]);
    assert!(alone(&format!("{texts} make(GL_VERTEX_SHADER, v); make(GL_FRAGMENT_SHADER, fs);")).is_empty());
    assert!(alone(&format!("{texts} make(v, fs, GL_VERTEX_SHADER);")).is_empty());
    for silent in [
        "compile(GL_VERTEX_SHADER, \"a.vert\");",
        "p.addShaderFromSourceFile(QOpenGLShader::Fragment, \":/a.frag\");",
        "load(GL_VERTEX_SHADER, \"a.vert\", GL_FRAGMENT_SHADER, \"a.frag\");",
        "compile(GL_VERTEX_SHADER, \"a.glsl\");",
        "compile(type, \"a.vert\");",
    ] {
        assert!(alone(silent).is_empty(), "{silent}");
    }
}

#[test]
fn every_message_of_a_bad_example_is_in_both_languages() {
    for rule in crate::RULES.iter().filter(|r| r.code.0.starts_with(['H', 'I'])) {
        let inputs: Vec<Input> = rule.pages.bad().iter().map(|f| Input::new(SourceFile::new(f.name, f.text))).collect();
        let selection = Selection::new(&[rule.code.0.to_owned()], &[]).unwrap();
        for d in run_with(&inputs, &Settings { selection, ..Settings::default() }) {
            let help = d.help.iter().chain(d.why.iter()).chain(d.fix.iter().map(|f| &f.title));
            let all = help.chain([&d.message, &d.label]).chain(d.related.iter().map(|r| &r.message));
            assert!(all.into_iter().all(base::diagnostic::Message::is_translated), "{d:#?}");
        }
    }
}
