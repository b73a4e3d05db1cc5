//! Shaders in strings of Python, JavaScript, TypeScript, Java, Kotlin and Rust, and the code around them that feeds them.
//!
//! The text of a string says whether it is a shader, and mostly of which stage; else the name does that it is kept
//! under. Hosts put more in front of such a text than this reader sees: engines declare attributes and uniforms, and
//! templates fill in names. What may be right with that is not reported.
//!
//! These languages are read by their tokens. Look-ups, feeds and shader texts need calls, brackets, strings and
//! assignments, which all of them share. Grammars of tree-sitter would add 0.4 MB (JavaScript, Python) to 3.4 MB
//! (Kotlin) of tables each, and 13 s of compiling C. What tokens do not show, such as which of two variables of one
//! name is meant, is unknown, and nothing is reported about it.

mod code;
pub mod filled;
mod handed;
mod host_text;
mod language;
mod lookup;
mod program;
pub mod strings;
mod table;
mod token;
pub mod webgpu;

use base::text::{SourceFile, Span};
use syntax::Stage;
use syntax::errors::Around;

use crate::{Body, Embedded, HostPrograms, Literal, Lookup, ProgramSource, ShaderRef, marks};
use code::Code;
use program::Programs;
use strings::Text;
use token::Token;

pub use handed::{Given, InFront, hands_on};
pub use host_text::{HostText, host_texts};
use language::Language;
pub use language::SCRIPT_EXTENSIONS;
pub use lookup::Field;
pub use table::Table;
pub use webgpu::WebGpu;

/// What a file has to do with shaders.
#[derive(Default)]
pub struct Script {
    /// The shaders in its strings, in the order of the text.
    pub shaders: Vec<Embedded>,
    /// The look-ups of uniforms and attributes, in the order of the text.
    pub lookups: Vec<Lookup>,
    /// The programs that it makes.
    pub programs: HostPrograms,
    /// Objects with the values of the uniforms of a program.
    pub tables: Vec<Table>,
    /// Fields of records of numbers.
    pub fields: Vec<Field>,
    /// What it says of modules in WGSL.
    pub webgpu: WebGpu,
}

impl Script {
    /// Reads a file.
    pub fn read(file: &SourceFile) -> Self {
        let text = file.text();
        let Some(language) =
            Language::of(file.name()).filter(|_| may_hold(text) || may_feed(text) || may_say_modules(text))
        else {
            return Self::default();
        };
        let code = Code::new(file, language);
        let webgpu = if webgpu::may_say(text) { webgpu::read(&code) } else { WebGpu::default() };
        let mut shaders = if may_hold(text) { shaders(&code) } else { Vec::new() };
        // Those in GLSL come first: the others are no part of programs.
        let of_programs = shaders.len();
        let mut texts = webgpu.texts.clone();
        texts.extend(strings::with_entry_points(file, &code.tokens).filter(|place| !webgpu.texts.contains(place)));
        modules(&code, &texts, &mut shaders);
        if !may_feed(text) {
            return Self { shaders, webgpu, ..Self::default() };
        }
        let programs = Programs { code: &code, shaders: &shaders[..of_programs] };
        let (tables, named) = table::find(&programs);
        let mut lookups = lookup::find(&programs);
        lookups.extend(named);
        lookups.sort_by_key(|l| l.name_span);
        let sources = lookups.iter().map(|l| &l.source).chain(tables.iter().map(|t| &t.source));
        let mut linked: Vec<Vec<ShaderRef>> = sources
            .filter_map(|source| match source {
                ProgramSource::Named(shaders) => Some(shaders.clone()),
                ProgramSource::Beside | ProgramSource::Unknown => None,
            })
            .collect();
        linked.sort_unstable();
        linked.dedup();
        let mut named: Vec<ShaderRef> = linked.iter().flatten().cloned().collect();
        named.sort_unstable();
        named.dedup();
        Self {
            programs: HostPrograms { linked, named },
            lookups,
            tables,
            shaders,
            fields: lookup::fields(&code),
            webgpu,
        }
    }
}

/// The shaders of a file, in the order of the text.
fn shaders(code: &Code<'_>) -> Vec<Embedded> {
    let file = code.file;
    let mut found: Vec<Embedded> = Vec::new();
    for text in strings::texts(file, code.language, &code.tokens) {
        let Some(stage) = stage(&text) else { continue };
        let line = file.position(text.place.start).line;
        let called = text.names.first().cloned().unwrap_or_else(|| line.to_string());
        let mut name = format!("{}#{called}", file.name());
        if found.iter().any(|f| f.name == name) {
            name = format!("{name}:{line}");
        }
        let partial = text.partial || stage == Stage::Library;
        let Text { literal, place, .. } = text;
        found.push(Embedded { name, variable: None, stage, created_as: None, literal, place, partial, wgsl: false });
    }
    found
}

/// Adds the modules in WGSL whose texts begin at these places and stand there as a whole.
fn modules(code: &Code<'_>, places: &[Span], into: &mut Vec<Embedded>) {
    let file = code.file;
    for text in strings::modules(file, &code.tokens, places) {
        let line = file.position(text.place.start).line;
        let called = text.names.first().cloned().unwrap_or_else(|| line.to_string());
        let mut name = format!("{}#{called}", file.name());
        if into.iter().any(|f| f.name == name) {
            name = format!("{name}:{line}");
        }
        let Text { literal, place, .. } = text;
        let stage = Stage::Library;
        into.push(Embedded {
            name,
            variable: None,
            stage,
            created_as: None,
            literal,
            place,
            partial: false,
            wgsl: true,
        });
    }
}

/// True for code that uses WebGPU, or keeps a module of WGSL for who does.
fn may_say_modules(text: &str) -> bool {
    webgpu::may_say(text) || strings::has_entry_point(text)
}

/// True for a script that has shaders, or looks up what they declare.
pub fn concerns_shaders(text: &str) -> bool {
    let looks_up = || ["getUniformLocation", "getAttribLocation"].iter().any(|word| text.contains(word));
    may_hold(text) || looks_up() || may_say_modules(text)
}

/// Words of code that feeds shaders.
fn may_feed(text: &str) -> bool {
    const WORDS: [&str; 8] =
        ["niform", "ttrib", "rogram", "vertexShader", "fragmentShader", "vertex_array", "frag", "vert"];
    WORDS.iter().any(|word| text.contains(word))
}

/// True for JavaScript and TypeScript: what they draw with is OpenGL ES.
pub fn is_of_the_web(name: &str) -> bool {
    Language::of(name) == Some(Language::JavaScript)
}

/// Words that no shader does without: most files of a project have none of them.
fn may_hold(text: &str) -> bool {
    text.contains("void main") || ["vec2", "vec3", "vec4"].iter().any(|word| text.contains(word))
}

/// Statements in strings of a file whose function its host writes, each with what it is kept under.
pub fn bodies(file: &SourceFile) -> Vec<(Option<String>, Body)> {
    let text = file.text();
    let Some(language) = Language::of(file.name()) else { return Vec::new() };
    // Most files of a project have no statements in strings.
    if !concerns_shaders(text)
        && !["gl_", "glsl", "shader", "Shader", "frag", "vert"].iter().any(|word| text.contains(word))
    {
        return Vec::new();
    }
    let (tokens, _) = token::tokens(text, language);
    let own = strings::texts(file, language, &tokens).into_iter();
    let own = own.filter(|text| !is_other(&marks::without_comments(&text.literal.text)));
    own.filter_map(|Text { literal, names, .. }| {
        let called = names.into_iter().next();
        let body = Body::of(&literal, called.as_deref().unwrap_or(""))?;
        Some((called, body))
    })
    .collect()
}

/// The text of several lines or statements that a file keeps under a name: a variable, a member, or an element.
pub fn kept_under(file: &SourceFile, name: &str) -> Option<Literal> {
    let language = Language::of(file.name())?;
    let (tokens, _) = token::tokens(file.text(), language);
    let element = |place: Span| {
        let own = |token: &Token<'_>| matches!(token, Token::String { place: own, .. } if own.start == place.start);
        let at = tokens.iter().position(own)?;
        match tokens.get(at.checked_sub(4)?..at)? {
            [Token::Mark('['), Token::String { inner, .. }, Token::Mark(']'), Token::Mark('=')] => {
                Some(file.slice(*inner))
            }
            _ => None,
        }
    };
    let is_kept = |text: &Text| text.names.first().is_some_and(|own| own == name) || element(text.place) == Some(name);
    let is_code = |text: &Text| text.literal.text.contains([';', '\n', '{']);
    let place = |token: &Token<'_>| if let Token::String { place, .. } = token { Some(*place) } else { None };
    let places: Vec<Span> = tokens.iter().filter_map(place).collect();
    // One string holds what it holds; several are read as those of GLSL.
    let whole = strings::modules(file, &tokens, &places).into_iter();
    let mut found = whole.chain(strings::texts(file, language, &tokens));
    found.find(|text| is_code(text) && is_kept(text)).map(|text| text.literal)
}

/// True for a text in another language, or one that is cut.
fn is_other(code: &str) -> bool {
    let other = ["float2", "float3", "float4", "cbuffer", "using", "import", "public", "SV_Position", "metal_stdlib"];
    // A string that is cut within a block is a piece of a longer text.
    // Data in JSON has quoted texts in it; its own braces are not those of a shader.
    code.trim_start().starts_with('{')
        || other.iter().any(|word| marks::has_word(code, word))
        || code.matches('{').count() != code.matches('}').count()
}

/// The stage of a text that is a shader or a part of one.
fn stage(text: &Text) -> Option<Stage> {
    let code = marks::without_comments(&text.literal.text);
    let has = |words: &[&str]| words.iter().any(|word| marks::has_word(&code, word));
    if is_other(&code) {
        return None;
    }
    if marks::has_main(&code) {
        let shader =
            ["gl_Position", "gl_FragColor", "gl_FragData", "gl_FragCoord", "gl_PointSize", "version", "uniform"];
        if !has(&shader) && !has(&["attribute", "varying", "precision"]) {
            return None;
        }
        return match marks::stage(&code) {
            Ok(Some(stage)) => Some(stage),
            Ok(None) => {
                // A whole vertex shader says where its vertex is.
                let is_fragment = code.trim_start().starts_with("#version") && !has(&["gl_Position"]);
                let named = text.names.iter().find_map(|name| Stage::of_name(name));
                named.or_else(|| is_fragment.then_some(Stage::Fragment))
            }
            Err(marks::Mixed) => None,
        };
    }
    marks::is_part(&code).then_some(Stage::Library)
}

/// What a string of a script leaves open: `partial` says that something is filled in, and `lacks` that the text has no
/// version, or uses names which it does not declare: what is put in front of it may state another version and extensions
/// as well, and mostly states precisions.
pub fn open(partial: bool, lacks: bool) -> Around {
    match (partial, lacks) {
        (true, _) => Around::all().difference(Around::TYPES | Around::VALUES),
        (false, true) => Around::NAMES | Around::STAGE | Around::ENABLED,
        (false, false) => Around::NAMES,
    }
}
