//! Look-ups and feeds of scripts, each with a mistake that rings and twins that stay silent.

use base::diagnostic::Severity;
use base::text::SourceFile;

use crate::{Input, Level, Selection, Settings, run, run_with};

const VERTEX: &str =
    "attribute vec2 corner;\nuniform mat4 view;\nvoid main() { gl_Position = view * vec4(corner, 0.0, 1.0); }\n";
const FRAGMENT: &str = "precision mediump float;\nuniform vec4 tint;\nvoid main() { gl_FragColor = tint; }\n";

fn reported(files: &[(&str, &str)]) -> Vec<String> {
    let inputs: Vec<Input> = files.iter().map(|(name, text)| Input::new(SourceFile::new(*name, *text))).collect();
    run(&inputs).iter().map(|d| format!("{} {}", d.code, d.file.slice(d.span))).collect()
}

/// A script with both texts, and code behind them.
fn script(code: &str) -> String {
    format!("const vs = `{VERTEX}`;\nconst fs = `{FRAGMENT}`;\nfunction setUp(gl) {{\n{code}\n}}\n")
}

fn in_javascript(code: &str) -> Vec<String> {
    reported(&[("a.js", &script(code))])
}

#[test]
fn a_wrong_name_is_told_in_each_language() {
    let texts = |open: &str, close: &str, end: &str| {
        format!("VS = {open}\n{VERTEX}{close}{end}\nFS = {open}\n{FRAGMENT}{close}{end}\n")
    };
    let triple = "\"\"\"";
    for (name, start, code) in [
        ("a.js", texts("`", "`", ";"), "const p = make(gl, VS, FS);\nconst u = gl.getUniformLocation(p, NAME);"),
        (
            "a.ts",
            texts("`", "`", ";"),
            "const p: WebGLProgram = make(VS, FS)!;\nconst u = gl.getUniformLocation(p, NAME)!;",
        ),
        ("a.py", texts(triple, triple, ""), "p = compile_program(VS, FS)\nu = glGetUniformLocation(p, NAME)"),
        (
            "a.py",
            texts(triple, triple, ""),
            "class A:\n    def f(self):\n        self.p = Program(VS, FS)\n        self.p[NAME] = 1",
        ),
        (
            "A.java",
            texts(triple, triple, ";"),
            "void f() { int p = link(VS, FS); int u = GLES20.glGetUniformLocation(p, NAME); }",
        ),
        (
            "a.kt",
            texts(triple, triple, ""),
            "fun f() {\nval p: Int = link(VS, FS)\nval u = GLES20.glGetUniformLocation(p, NAME)\n}",
        ),
        (
            "a.rs",
            texts("r#\"", "\"#", ";"),
            "fn f(gl: &Context) { let p: Program = link(VS, FS); let u = gl.get_uniform_location(p, NAME); }",
        ),
    ] {
        let file = |uniform: &str| format!("{start}{}\n", code.replace("NAME", &format!("\"{uniform}\"")));
        assert_eq!(reported(&[(name, &file("veiw"))]), ["H003 \"veiw\""], "{}", file("veiw"));
        assert_eq!(reported(&[(name, &file("view"))]), [""; 0], "{}", file("view"));
    }
}

#[test]
fn a_location_is_followed_to_what_it_sets() {
    let program = "const program = make(gl, vs, fs);\n";
    for (feed, expected) in [
        ("const t = gl.getUniformLocation(program, 'tint');\ngl.uniform3f(t, 1, 1, 1);", "H010 uniform3f"),
        ("this.t = gl.getUniformLocation(program, 'tint');\ngl.uniform3fv(this.t, [1, 1, 1]);", "H010 uniform3fv"),
        ("gl.uniform1f(gl.getUniformLocation(program, 'tint'), 1);", "H010 uniform1f"),
        (
            "const at = { view: gl.getUniformLocation(program, 'view') };\ngl.uniformMatrix3fv(at.view, false, m);",
            "H019 uniformMatrix3fv",
        ),
        (
            "const info = { places: { tint: gl.getUniformLocation(program, 'tint') } };\ngl.uniform2f(info.places.tint, 1, 1);",
            "H010 uniform2f",
        ),
    ] {
        assert_eq!(in_javascript(&format!("{program}{feed}")), [expected], "{feed}");
    }
    for feed in [
        "const t = gl.getUniformLocation(program, 'tint');\ngl.uniform4f(t, 1, 1, 1, 1);",
        "let t = gl.getUniformLocation(program, 'tint');\nt = other;\ngl.uniform3f(t, 1, 1, 1);",
        "const a = { x: gl.getUniformLocation(program, 'tint') };\nconst b = { x: other };\ngl.uniform3f(b.x, 1, 1, 1);",
    ] {
        assert_eq!(in_javascript(&format!("{program}{feed}")), [""; 0], "{feed}");
    }
}

#[test]
fn what_is_attached_makes_the_program() {
    let code = |name: &str| {
        format!(
            "const program = gl.createProgram();\nconst v = compile(gl, gl.VERTEX_SHADER, vs);\ngl.attachShader(program, v);\n\
             gl.attachShader(program, compile(gl, gl.FRAGMENT_SHADER, fs));\nconst a = gl.getAttribLocation(program, '{name}');"
        )
    };
    assert_eq!(in_javascript(&code("corners")), ["H004 'corners'"]);
    assert_eq!(in_javascript(&code("corner")), [""; 0]);
}

#[test]
fn files_that_are_imported_make_the_program() {
    let host = |name: &str| {
        format!(
            "import vs from './wave.vert?raw';\nimport fs from './wave.frag';\nconst program = make(gl, vs, fs);\n\
             const u = gl.getUniformLocation(program, '{name}');\n"
        )
    };
    let files = |text: &str| reported(&[("a/b.ts", text), ("a/wave.vert", VERTEX), ("a/wave.frag", FRAGMENT)]);
    assert_eq!(files(&host("tnit")), ["H003 'tnit'"]);
    assert_eq!(files(&host("tint")), [""; 0]);
}

#[test]
fn a_program_that_is_not_known_is_answered_by_no_other() {
    let look = "const u = gl.getUniformLocation(program, 'missing');";
    for code in [
        // A parameter, a member that is set elsewhere, one of several, one by name, one that is set twice.
        format!("const own = make(gl, vs, fs);\nfunction use(program) {{ {look} }}"),
        format!("const own = make(gl, vs, fs);\nconst program = programs['other'];\n{look}"),
        format!("const own = make(gl, vs, fs);\nconst program = load('phong');\n{look}"),
        format!("let program = make(gl, vs, fs);\nprogram = make(gl, other, fs2);\n{look}"),
        format!("gl.createProgram();\ngl.createProgram();\n{look}"),
    ] {
        assert_eq!(in_javascript(&code), [""; 0], "{code}");
    }
    // A name that goes on is none.
    let joined =
        "const program = make(gl, vs, fs);\nfor (let i = 0; i < 3; i++) gl.getUniformLocation(program, 'shadow_' + i);";
    assert_eq!(in_javascript(joined), [""; 0]);
    let filled = "const program = make(gl, vs, fs);\ngl.getUniformLocation(program, `shadow_${i}`);";
    assert_eq!(in_javascript(filled), [""; 0]);
    let indexed = "const program = make(gl, vs, fs);\ngl.getUniformLocation(program, `lamps[${i}].color`);";
    assert_eq!(in_javascript(indexed), ["H003 `lamps[$"]);
}

#[test]
fn objects_that_are_given_to_each_other_are_followed_so_far() {
    let code = "const gl = make(); const s = load(gl, kind); gl.shaderSource(s, text); gl.attachShader(p, s); \
                const p = gl.createProgram(); gl.use(p); gl.getUniformLocation(p, 'gain');";
    assert_eq!(in_javascript(code), ["H003 'gain'"]);
}

#[test]
fn the_values_of_an_object_are_held_against_its_shaders() {
    let material = |uniforms: &str| {
        format!("return new Material({{ uniforms: {uniforms}, vertexShader: vs, fragmentShader: fs }});")
    };
    assert_eq!(in_javascript(&material("{ view: m, tint: c }")), [""; 0]);
    assert_eq!(in_javascript(&material("{ view: m }")), ["H040 uniforms"]);
    assert_eq!(in_javascript(&material("{ view: m, tnit: c }")), ["H040 uniforms", "H003 tnit"]);
    // What is joined to it, or said elsewhere, may give the rest; a value that nothing reads does no harm.
    assert_eq!(in_javascript(&material("{ view: m, ...shared }")), [""; 0]);
    assert_eq!(in_javascript(&format!("{}\nmaterial.uniforms.tint = c;", material("{ view: m }"))), [""; 0]);
    assert_eq!(in_javascript(&material("{ view: m, tint: c, exposure: 1 }")), [""; 0]);
    assert_eq!(in_javascript(&material("shared")), [""; 0]);
}

#[test]
fn what_a_library_gives_every_program_needs_no_value() {
    let code = |class: &str, name: &str| {
        let vertex = "attribute vec3 position;\nuniform mat4 projectionMatrix;\nuniform mat4 modelViewMatrix;\n\
            void main() { gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }\n";
        let fragment = format!(
            "precision mediump float;\nuniform vec3 {name};\nuniform float gain;\n\
             void main() {{ gl_FragColor = vec4({name} * gain, 1.0); }}\n"
        );
        format!(
            "const vs = `{vertex}`;\nconst fs = `{fragment}`;\n\
             export default new {class}({{ uniforms: {{ gain: 1 }}, vertexShader: vs, fragmentShader: fs }});\n"
        )
    };
    let found = |class: &str, name: &str| reported(&[("a.js", &code(class, name))]);
    assert_eq!(found("THREE.RawShaderMaterial", "cameraPosition"), [""; 0]);
    assert_eq!(found("THREE.RawShaderMaterial", "lampPosition"), ["H040 uniforms"]);
    assert_eq!(found("Effect", "cameraPosition"), ["H040 uniforms"], "another library does not know it");
    // The other stage shows whose text stands in front.
    let other = code("Effect", "cameraPosition");
    let declared = "attribute vec3 position;\nuniform mat4 projectionMatrix;\nuniform mat4 modelViewMatrix;\n";
    assert_eq!(reported(&[("a.js", &other.replace(declared, ""))]), [""; 0]);
}

#[test]
fn arrays_of_python_are_held_against_the_attributes() {
    let file = |code: &str| {
        format!(
            "def f(ctx):\n    p = ctx.program(vertex_shader='''{VERTEX}''', fragment_shader='''{FRAGMENT}''')\n    {code}\n"
        )
    };
    let found = |code: &str| reported(&[("a.py", &file(code))]);
    assert_eq!(found("v = ctx.vertex_array(p, [(b, '2f', 'corners')])"), ["H004 'corners'"]);
    assert_eq!(found("v = ctx.vertex_array(p, b, 'corners')"), ["H004 'corners'"]);
    assert_eq!(found("v = ctx.vertex_array(p, [(b, '2f', 'corner')])"), [""; 0]);
    assert_eq!(found("v = ctx.vertex_array(p, content)"), [""; 0]);
    assert_eq!(found("p['corner'] = data"), [""; 0], "an attribute may be set by name");
    assert_eq!(found("texts = { 'v': vertex_shader, 'f': p }\n    texts['v'] = 1"), [""; 0], "a table of texts");
}

/// What is reported in a fixture at a level, as line, column and code; no information.
fn of_fixture(name: &str, text: &str) -> Vec<String> {
    let selection = Selection::new(&[], &[]).unwrap().at(Level::Strict);
    let settings = Settings { selection, ..Settings::default() };
    let found = run_with(&[Input::new(SourceFile::new(name, text))], &settings);
    let told = found.iter().filter(|d| d.severity != Severity::Info);
    told.map(|d| format!("{} {}", d.file.locate(d.span.start), d.code)).collect()
}

macro_rules! fixture {
    ($name:literal) => {
        ($name, include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/web/", $name)))
    };
}

#[test]
fn the_mistakes_of_the_fixtures_are_found_and_their_twins_are_silent() {
    for ((name, text), expected) in [
        (fixture!("wave.js"), &["22:16 T003", "23:38 T006", "28:3 H040", "30:5 H003"][..]),
        (fixture!("wave_right.js"), &[]),
        (fixture!("triangle.js"), &["23:43 H004", "25:42 H003", "29:6 H019", "31:6 H011", "32:19 H001"]),
        (fixture!("triangle_right.js"), &[]),
        (fixture!("quad.py"), &["27:29 T003", "31:22 H003", "34:91 H004", "35:76 H007", "35:91 H007"]),
        (fixture!("quad_right.py"), &[]),
    ] {
        let found = of_fixture(name, text);
        let wanted: Vec<String> = expected.iter().map(|e| format!("{name}:{e}")).collect();
        assert_eq!(found, wanted, "{name}");
    }
}
