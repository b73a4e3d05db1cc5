//! naga's own GLSL reader as a front end under test: where it takes a text in another sense, that is told by its name,
//! and where it does not, nothing is.

use base::text::SourceFile;
use base::value::Batch;
use judge::verdict::{Comparison, Translations, Unread};
use program::lower::Target;
use program::{Language, Program, Translation};
use syntax::Stage;

fn program(name: &str, text: &str, target: Target) -> Program {
    let file = SourceFile::new(name, format!("#version 450\n{text}\n"));
    Program::from_source(&file, Stage::from_path(name).unwrap(), |_| Ok(target))
        .unwrap_or_else(|e| panic!("{e}\n{text}"))
}

/// Numbers from -4 to 4 for every word.
fn batch(program: &Program) -> Batch {
    let (invocation, case) = (program.invocation_record(), program.case_record());
    let mut batch = Batch::with_capacity(invocation.into(), case.into(), 1, 64);
    let mut seed = 7_u32;
    let mut word = || {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        ((seed >> 8) as f32 / (1 << 21) as f32 - 4.0).to_bits()
    };
    for _ in 0..64 {
        batch.invocations.extend((0..batch.invocation_record.words()).map(|_| word()));
        batch.cases.extend((0..batch.case_record.words()).map(|_| word()));
    }
    batch
}

/// What naga's reader makes of a text in its dialect, beside the program.
#[track_caller]
fn read(program: &Program, text: String) -> Comparison {
    let read = program.read_back(&Translation::Text(text), Language::NagaGlsl);
    let translations = Translations::new(program, vec![(Language::NagaGlsl, read)]);
    assert_eq!(translations.unread().collect::<Vec<_>>(), []);
    let mut compared = translations.compare(&batch(program)).unwrap();
    assert_eq!(compared.len(), 1);
    compared.remove(0)
}

fn dialect(program: &Program) -> String {
    let Ok(Translation::Text(text)) = program.translate(Language::NagaGlsl) else { panic!("it has no place there") };
    text
}

/// A text that both read alike, and the same with a part that naga reads otherwise.
#[track_caller]
fn rings(name: &str, text: &str, target: Target, from: &str, to: &str) {
    let program = program(name, text, target);
    let right = dialect(&program);
    let twin = read(&program, right.clone());
    assert_eq!((twin.agreed, twin.first), (64, None), "{right}");
    assert!(right.contains(from), "no `{from}` in {right}");
    let first =
        read(&program, right.replacen(from, to, 1)).first.unwrap_or_else(|| panic!("{name}: nothing was found"));
    assert!(first.to_string().starts_with("naga's GLSL reader gives the shader another meaning: `"), "{first}");
}

const VERTEX: &str = "in vec4 p; uniform mat4 m; uniform float a, b = 2.0; uniform mat2 t; out vec2 q;
    uniform Light { vec3 c; float w[2]; } light;
    void main() { q = t * p.xy * a + light.c.zy * light.w[1]; gl_Position = m * p * b; }";
const GEOMETRY: &str = "layout(triangles) in; layout(triangle_strip, max_vertices = 3) out;
    in float n[]; uniform float s; out float v;
    void main() { for (int i = 0; i < 3; ++i) { v = n[i]; gl_Position = s * gl_in[i].gl_Position; EmitVertex(); } }";
const FUNCTION: &str = "uniform vec3 k[2]; uniform float s;
    vec3 f(vec3 x, float y, inout float z) { z = z * s + k[0].y; return x * y + k[1]; }";

#[test]
fn another_meaning_of_a_stage_or_a_function_is_reported_by_nagas_name() {
    rings("a.vert", VERTEX, Target::Stage, "m * p * b", "p * m * b");
    rings("a.vert", VERTEX, Target::Stage, "light.w[1]", "light.w[0]");
    rings("a.geom", GEOMETRY, Target::Stage, "v = n[i]", "v = n[0]");
    rings("a.glsl", FUNCTION, Target::Function("f".to_owned()), "+ k[1]", "+ k[0]");
    rings("a.glsl", FUNCTION, Target::Function("f".to_owned()), "z * s", "z * z");
}

#[test]
fn what_naga_is_known_to_get_wrong_would_be_found() {
    // The right side of `&&` is run always, and an `out` parameter keeps what its argument held.
    let counted = "in float x; out float y; float n; bool b() { n += 1.0; return true; }
        void main() { n = 0.0; bool c = false; if (x > 0.0) { c = b(); } y = n; gl_Position = vec4(c ? 1.0 : 0.0); }";
    rings("a.vert", counted, Target::Stage, "if (x > 0.0) { c = b(); }", "c = x > 0.0 && b();");
    let dropped = "in float x; out float y; float k = 0.0;
        void main() { k = 3.0; y = k * x; gl_Position = vec4(x); }";
    rings(
        "a.vert",
        dropped,
        Target::Stage,
        "float k = 0.0;\n        void main() { k = 3.0;",
        "float k = sqrt(9.0 * x) * 0.0 + 3.0;\n        void main() {",
    );
}

#[test]
fn the_guards_keep_from_naga_what_it_gets_wrong() {
    for text in [
        "in float x; float n = 0.0; bool b() { n += 1.0; return true; }\nvoid main() { gl_Position = vec4(x > 0.0 && b()); }",
        "in float x; float k = sqrt(x);\nvoid main() { gl_Position = vec4(k); }",
        "in float x; void f(out float y) { }\nvoid main() { float y = x; f(y); gl_Position = vec4(y); }",
    ] {
        let program = program("a.vert", text, Target::Stage);
        assert!(program.translate(Language::NagaGlsl).is_err(), "{text}");
        let all: Vec<Language> =
            Translations::of(&program).compare(&batch(&program)).unwrap().iter().map(|c| c.language).collect();
        assert_eq!(all, Language::READABLE, "{text}");
    }
}

#[test]
fn constants_that_naga_folds_in_steps_of_binary32_are_no_other_meaning() {
    let text = "in float x; const float K = 3.14159265358979 * 17.0 / 180.0 / 3.3;
        void main() { gl_Position = vec4(x * K, x * (0.1 + 0.2) * 3.0, x * (2.0 / 3.0 * 0.7), x); }";
    rings("a.vert", text, Target::Stage, "17.0", "17.0001");
}

#[test]
fn a_text_that_naga_refuses_is_no_finding() {
    let text = "in vec4 p; void main() { gl_Position = matrixCompMult(mat4(p.x), mat4(p.y)) * p; }";
    let translations = Translations::of(&program("a.vert", text, Target::Stage));
    let unread: Vec<_> = translations.unread().collect();
    assert!(
        matches!(unread[..], [(Language::NagaGlsl, Unread::Unsupported(why))] if why.contains("a.vert:2:")),
        "{unread:?}"
    );
}
