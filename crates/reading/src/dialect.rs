//! Marks of texts in languages that are like GLSL: another preprocessor makes GLSL of them, or they are none.

use base::diagnostic::Diagnostic;
use base::text::SourceFile;
use syntax::{Shader, errors};

/// True for an error of the grammar at a place that shows another language: what the text says by other rules than
/// those of GLSL cannot be judged by them.
pub fn is_mark(file: &SourceFile, error: &Diagnostic) -> bool {
    if error.code != errors::SYNTAX {
        return false;
    }
    // What is missing is missing behind the word before.
    let at = error.span.start;
    let at = file.text().len() - file.text()[at..].trim_start_matches([' ', '\t']).len();
    let (before, behind) = file.text().split_at(at);
    is_colour(before, behind) || is_pointer(before, behind) || is_title(before, behind) || is_semantic(before, behind)
}

/// `vec3 c = #9CF0C0;`
fn is_colour(before: &str, behind: &str) -> bool {
    let first_in_line = before.rsplit('\n').next().unwrap_or("").trim().is_empty();
    let Some(digits) = behind.strip_prefix('#').or(before.strip_suffix('#').map(|_| behind)) else { return false };
    let length = digits.find(|c: char| !c.is_ascii_hexdigit()).unwrap_or(digits.len());
    !first_in_line && [3, 4, 6, 8].contains(&length)
}

/// `const mat4* m;`, `Light* const light = …;`
fn is_pointer(before: &str, behind: &str) -> bool {
    let word = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let rest = |mark: char| behind.strip_prefix(mark).map(str::trim_start);
    let declared = rest('*').or(rest('&')).is_some_and(|rest| rest.starts_with(|c: char| c.is_ascii_alphabetic()));
    let constant = before.trim_end().ends_with('*') && behind.starts_with("const");
    (declared && before.trim_end().ends_with(word)) || constant
}

/// A line such as `[VertexShader]`, between the shaders of a file.
fn is_title(before: &str, behind: &str) -> bool {
    let line = behind.split('\n').next().unwrap_or("").trim();
    let name = line.strip_prefix('[').and_then(|line| line.strip_suffix(']'));
    let starts = before.rsplit('\n').next().unwrap_or("").trim().is_empty();
    starts && name.is_some_and(|n| !n.is_empty() && n.chars().all(|c| c.is_ascii_alphabetic() || "_ ".contains(c)))
}

/// `float4 main(float2 t) : COLOR`, `Texture2D map : register(t0)`: HLSL and Cg.
fn is_semantic(before: &str, behind: &str) -> bool {
    let Some(name) = behind.strip_prefix(':').map(str::trim_start) else { return false };
    let word = name.split(|c: char| !c.is_ascii_alphanumeric() && c != '_').next().unwrap_or("");
    let capitals = word.starts_with("SV_")
        || (word.len() > 3 && word.bytes().all(|b| b.is_ascii_uppercase() || b.is_ascii_digit()));
    let declared = before.trim_end().ends_with(|c: char| c.is_ascii_alphanumeric() || c == '_' || c == ')');
    declared && (capitals || word == "register")
}

/// Types with parameters, which extensions bring that the front end does not know: their declarations read as comparisons.
const PARAMETRISED: [&str; 8] =
    ["coopmat", "fcoopmatNV", "icoopmatNV", "ucoopmatNV", "coopvecNV", "tensorLayoutNV", "tensorViewNV", "tensorARM"];

/// Endings of the files that a host puts in.
const PARTS: [&str; 8] = [".glsl", ".glslh", ".glsli", ".inc", ".comp", ".vert", ".frag", ".hlsl"];

/// True for a text that another preprocessor takes apart, or one in a language with more types: nothing of it says what is
/// wrong in GLSL.
pub fn needs_another_reader(shader: &Shader) -> bool {
    let text = shader.file().text();
    let word = |span: base::text::Span| PARAMETRISED.contains(&shader.file().slice(span));
    let parametrised =
        || shader.tokens().iter().any(|t| word(t.span) && text[t.span.end..].trim_start().starts_with('<'));
    text.lines().map(str::trim).any(|line| is_host_include(line) || is_of_hlms(line)) || parametrised()
}

/// `@property( hlms_shadowcaster )` of Ogre's material system: branches that exclude each other stand in one text.
fn is_of_hlms(line: &str) -> bool {
    ["@property(", "@insertpiece("].iter().any(|mark| line.starts_with(mark))
}

/// `AppInclude(include/Math.glsl)`
fn is_host_include(line: &str) -> bool {
    let Some((name, rest)) = line.trim_end_matches(';').split_once('(') else { return false };
    let Some(path) = rest.strip_suffix(')') else { return false };
    let path = path.trim_matches(['"', '<', '>', '\'', ' ']);
    let plain = |c: char| c.is_ascii_alphanumeric() || "_-./\\".contains(c);
    name.starts_with(|c: char| c.is_ascii_alphabetic())
        && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
        && path.chars().all(plain)
        && PARTS.iter().any(|ending| path.len() > ending.len() && path.ends_with(ending))
}

/// True for a text in WGSL with declarations that an engine rewrites: `uniform gain: f32;`, `varying uv: vec2f;`.
pub fn declares_otherwise(text: &str) -> bool {
    const QUALIFIERS: [&str; 4] = ["uniform", "varying", "attribute", "storage"];
    let declares = |line: &str| {
        let rest = QUALIFIERS.iter().find_map(|word| line.trim_start().strip_prefix(word))?;
        let name = rest.strip_prefix([' ', '\t'])?.trim_start();
        let word = syntax::words::identifier(name);
        Some(!word.is_empty() && name[word.len()..].trim_start().starts_with(':'))
    };
    text.lines().any(|line| declares(line) == Some(true))
}

/// True for a text into which directives of a tool bring others.
pub fn imports(text: &str) -> bool {
    ["#pragma glslify", "#pragma include", "#pragma import"].iter().any(|directive| text.contains(directive))
}
