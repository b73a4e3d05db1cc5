//! What a block of a document is written in.

use syntax::Stage;

use crate::cpp::is_shader_name;
use crate::marks;

/// What a block holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// GLSL, with the stage that the document tells.
    Shader(Option<Stage>),
    /// C or C++ that calls OpenGL.
    Host,
    /// Anything else.
    Other,
}

const SHADER_WORDS: [&str; 27] = [
    "glsl",
    "opengl",
    "glslang",
    "shader",
    "vert",
    "frag",
    "geom",
    "comp",
    "tesc",
    "tese",
    "vs",
    "fs",
    "gs",
    "vsh",
    "fsh",
    "vertex",
    "fragment",
    "geometry",
    "compute",
    "vertexshader",
    "fragmentshader",
    "glslvertex",
    "glslfragment",
    "glsles",
    "webgl",
    "x-vertex",
    "x-fragment",
];
const HOST_WORDS: [&str; 12] =
    ["c", "cpp", "c++", "cc", "cxx", "h", "hpp", "c/c++", "h++", "objc", "cplusplus", "arduino"];
const NEUTRAL_WORDS: [&str; 8] = ["", "text", "txt", "plain", "plaintext", "code", "none", "source"];

/// True for a word that names a language, so far as it matters here.
pub fn is_language(word: &str) -> bool {
    const OTHERS: [&str; 14] = [
        "js",
        "javascript",
        "typescript",
        "ts",
        "python",
        "py",
        "java",
        "rust",
        "html",
        "hlsl",
        "wgsl",
        "csharp",
        "bash",
        "json",
    ];
    let neutral = NEUTRAL_WORDS.contains(&word) && !word.is_empty();
    SHADER_WORDS.contains(&word) || HOST_WORDS.contains(&word) || neutral || OTHERS.contains(&word)
}

/// The words of the line of a fence: `glsl`, `{.glsl}`, `glsl:a.vert`, `cpp title="a.cpp"`.
fn words(tag: &str) -> impl Iterator<Item = &str> {
    tag.split(|c: char| c.is_whitespace() || "{}[]():=,;\"'`".contains(c))
        .map(|w| w.trim_start_matches('.'))
        .map(|w| w.strip_prefix("language-").unwrap_or(w))
        .filter(|w| !w.is_empty())
}

/// The file that the line of a fence names.
pub fn file_name(tag: &str) -> Option<&str> {
    words(tag).find(|w| is_shader_name(w))
}

/// What a block holds, by what the document says of it and by its text.
pub fn kind(tag: &str, text: &str) -> Kind {
    let lower = tag.to_ascii_lowercase();
    let first = words(&lower).next().unwrap_or("");
    let first = if is_shader_name(first) { "glsl" } else { first };
    let named = file_name(&lower).and_then(Stage::from_path);
    if SHADER_WORDS.contains(&first) {
        // One word for all that belongs to OpenGL.
        if ["opengl", "webgl", "shader"].contains(&first) && !is_shader(text) {
            return if is_host(text) { Kind::Host } else { Kind::Other };
        }
        let stage = words(&lower).take(2).find_map(|w| Stage::of_name(w).filter(|_| !is_shader_name(w)));
        return Kind::Shader(named.or(stage));
    }
    let neutral = NEUTRAL_WORDS.contains(&first);
    if !neutral && !HOST_WORDS.contains(&first) {
        return Kind::Other;
    }
    if is_shader(text) {
        return Kind::Shader(named);
    }
    let host = if neutral { is_host(text) && is_like_c(text) } else { is_host(text) };
    if host { Kind::Host } else { Kind::Other }
}

/// Words that a statement of GLSL at file level begins with.
const FIRST_WORDS: [&str; 40] = [
    "uniform",
    "in",
    "out",
    "attribute",
    "varying",
    "layout",
    "precision",
    "const",
    "flat",
    "smooth",
    "centroid",
    "invariant",
    "struct",
    "void",
    "float",
    "int",
    "bool",
    "uint",
    "vec2",
    "vec3",
    "vec4",
    "mat2",
    "mat3",
    "mat4",
    "ivec2",
    "ivec3",
    "ivec4",
    "uvec2",
    "uvec3",
    "uvec4",
    "bvec2",
    "bvec3",
    "bvec4",
    "sampler2D",
    "highp",
    "mediump",
    "lowp",
    "buffer",
    "shared",
    "noperspective",
];

/// True for a text that is GLSL at file level and nothing else.
fn is_shader(text: &str) -> bool {
    let code = marks::without_comments(text);
    let mut lines = code.lines().map(str::trim).filter(|l| !l.is_empty());
    let Some(first) = lines.clone().next() else { return false };
    let word = |line: &str| line.split(|c: char| !c.is_alphanumeric() && c != '_').next().unwrap_or("").to_owned();
    if !first.starts_with('#') && !FIRST_WORDS.contains(&word(first).as_str()) {
        return false;
    }
    let foreign = ["\"", "'", "`", "->", "::", "=>", "float4", "int main", "function ", "template", "class "];
    let plain = lines.clone().filter(|l| !l.starts_with('#')).all(|l| !foreign.iter().any(|f| l.contains(f)));
    let is_version = |rest: &str| rest.trim_start().starts_with(|c: char| c.is_ascii_digit());
    let version = lines.clone().any(|l| l.strip_prefix("#version").is_some_and(is_version));
    let own = |l: &str| {
        let word = word(l);
        // `attribute[k] = …` is a statement about something else.
        let declares = l[word.len()..].starts_with(char::is_whitespace) && (l.contains(';') || l.contains('{'));
        let layout = word == "layout" && l["layout".len()..].trim_start().starts_with('(');
        layout || (declares && ["uniform", "in", "out", "attribute", "varying", "precision"].contains(&word.as_str()))
    };
    let words = ["gl_Position", "gl_Frag", "gl_in", "vec2(", "vec3(", "vec4(", "mat3(", "mat4("];
    let built_in = || words.iter().any(|w| code.contains(w));
    plain && !is_host(&code) && (version || lines.any(own) || (marks::has_main(&code) && built_in()))
}

/// True for a text that calls OpenGL, or has variables of its types.
fn is_host(text: &str) -> bool {
    let types = ["GLfloat", "GLuint", "GLint", "GLsizei", "GLchar", "GLushort", "GLubyte"];
    is_call_of_gl(text) || types.iter().any(|t| marks::has_word(text, t))
}

fn is_call_of_gl(text: &str) -> bool {
    text.match_indices("gl").any(|(at, _)| {
        let before = text[..at].chars().next_back();
        let name = text[at + 2..].find(|c: char| !c.is_ascii_alphanumeric()).unwrap_or(text.len() - at - 2);
        text.as_bytes().get(at + 2).is_some_and(u8::is_ascii_uppercase)
            && !before.is_some_and(|c| c.is_alphanumeric() || c == '_' || c == '.')
            && text[at + 2 + name..].trim_start().starts_with('(')
    })
}

/// False for a text of another language that calls OpenGL.
fn is_like_c(text: &str) -> bool {
    let foreign = ["import ", "def ", "function ", "let ", "var ", "=>", "fn ", "func ", ":=", "#!/", "$ "];
    let code = marks::without_comments(text);
    let is_foreign = |line: &str| foreign.iter().any(|f| line.starts_with(f) || (f.contains('=') && line.contains(f)));
    !code.lines().map(str::trim_start).any(is_foreign)
}
