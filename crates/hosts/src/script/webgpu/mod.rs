//! What hosts of WebGPU say of their modules: the texts that they are made of, the functions that pipelines start, the
//! layouts of vertices and bindings, and the structures whose bytes go into buffers.
//!
//! A function is entered once for each of its calls, so that what it describes is compared with each module that it
//! is given. Descriptors have the same keys in Rust and JavaScript but for their spelling, so that one reader serves
//! both.

mod dispatch;
mod group;
mod layout;
mod modules;
mod number;
mod passes;
mod pipeline;
mod structure;
mod value;
mod vertex;

pub use dispatch::Dispatch;
pub use group::{BindGroup, Bound};
pub use layout::{GroupLayout, Kind, PipelineLayout};
pub use modules::Source;
pub use passes::Mixed;
pub use pipeline::{Pipeline, StageUse, Start};
pub use structure::{Field, Structure};
pub use vertex::{Attribute, VertexBuffer};

use base::text::Span;

use super::code::Code;
use super::language::Language;
use structure::Copied;
use value::{Value, Values};

/// What a file says.
#[derive(Debug, Default)]
pub struct WebGpu {
    /// Files in WGSL that strings name.
    pub modules: Vec<String>,
    /// True when every module that the file makes is one of these.
    pub modules_are_known: bool,
    /// Names of entry points, with their places.
    pub entry_points: Vec<(String, Span)>,
    /// Stages of pipelines whose module is known.
    pub stages: Vec<StageUse>,
    /// Pipelines of which every stage is known.
    pub pipelines: Vec<Pipeline>,
    /// Bind groups whose layout a pipeline gives.
    pub groups: Vec<BindGroup>,
    /// Dispatches of one pipeline with a count that is the number of items.
    pub dispatches: Vec<Dispatch>,
    /// Structures whose bytes are given away.
    pub structures: Vec<Structure>,
    /// Structures that a library lays out as WGSL does (`ShaderType` of encase), member by member.
    pub mirrored: Vec<Structure>,
    /// Resources of one pass that are bound in another.
    pub mixed: Vec<Mixed>,
    /// Strings that modules are made of.
    pub texts: Vec<Span>,
}

impl WebGpu {
    /// True when there is nothing to hold against modules.
    pub fn is_empty(&self) -> bool {
        self.entry_points.is_empty()
            && self.structures.is_empty()
            && self.mirrored.is_empty()
            && self.mixed.is_empty()
            && self.stages.is_empty()
    }
}

/// True for a text that may have something to say.
pub fn may_say(text: &str) -> bool {
    const WORDS: [&str; 8] = [
        "entry_point",
        "entryPoint",
        "Pod",
        "ShaderType",
        "createShaderModule",
        "create_shader_module",
        "set_bind_group",
        "setBindGroup",
    ];
    WORDS.iter().any(|word| text.contains(word))
}

/// Reads a file.
pub fn read(code: &Code<'_>) -> WebGpu {
    let mut found = WebGpu::default();
    if !matches!(code.language, Language::Rust | Language::JavaScript) {
        return found;
    }
    let text = |at: usize| code.tokens.get(at).and_then(|_| code.string(&(at..at + 1)));
    let key = if code.language == Language::Rust { "entry_point" } else { "entryPoint" };
    for at in 0..code.tokens.len() {
        if let Some((name, _)) = text(at) {
            let path = name.split('?').next().unwrap_or(name);
            if path.ends_with(".wgsl") {
                found.modules.push(path.to_owned());
            }
        }
        if code.word(at) == Some(key) && code.is_mark(at + 1, ':') {
            let some = code.word(at + 2) == Some("Some") && code.is_mark(at + 3, '(');
            // What stands behind a string may make another of it.
            let value = if some { at + 4 } else { at + 2 };
            let ends = [',', ')', '}'].iter().any(|c| code.is_mark(value + 1, *c));
            if let Some((name, place)) = text(value).filter(|(name, _)| ends && !name.contains('{')) {
                found.entry_points.push((name.to_owned(), place));
            }
        }
    }
    if code.language == Language::Rust {
        for (structure, copied) in structure::structures(code) {
            match copied {
                Copied::Bytes => found.structures.push(structure),
                Copied::Members => found.mirrored.push(structure),
                Copied::Not => {}
            }
        }
    }
    found.mixed = passes::mixed(code);
    let values = Values { code };
    found.texts = texts(&values);
    found.stages = pipeline::stages(&values);
    found.pipelines = pipeline::pipelines(&values);
    found.groups = group::groups(&values, &found.pipelines);
    found.dispatches = dispatch::dispatches(&values, &found.pipelines);
    found.modules_are_known = modules_are_known(code.file.text(), code.language);
    found
}

/// The strings of the file that modules are made of.
fn texts(values: &Values<'_, '_>) -> Vec<Span> {
    let code = values.code;
    let mut found = Vec::new();
    for call in code.calls().filter(|c| code.word(c.name).is_some_and(modules::is_maker)) {
        // With the object, so that the call is that of a method.
        let start = call.name.saturating_sub(2);
        let Some(close) = code.other(call.open) else { continue };
        for frame in values.frames(call.name) {
            if let Some(Source::String(place)) = modules::source(values, &Value { tokens: start..close + 1, frame }) {
                found.push(place);
            }
        }
    }
    found.sort_unstable();
    found.dedup();
    found
}

/// True when the text of every module that is made stands in a file that is named in its place.
fn modules_are_known(text: &str, language: Language) -> bool {
    let behind = |mark: &str, holds: &dyn Fn(&str) -> bool| {
        text.match_indices(mark).all(|(at, _)| holds(&text[at + mark.len()..]))
    };
    if language == Language::Rust {
        // Modules of other languages have entry points that no file in WGSL shows.
        if ["spirv", "ShaderSource::SpirV", "ShaderSource::Glsl", "ShaderSource::Naga"].iter().any(|w| text.contains(w))
        {
            return false;
        }
        let included = |rest: &str| {
            let rest = rest.trim_start();
            let inner = rest.find("Borrowed(").filter(|at| *at < 20).map_or(rest, |at| &rest[at + 9..]);
            inner.trim_start().starts_with("include_str!") || inner.starts_with("s)") || inner.starts_with("_)")
        };
        return behind("ShaderSource::Wgsl(", &included);
    }
    // `code: name`, where the name is that of an import.
    behind("createShaderModule(", &|rest| {
        let Some((_, value)) = rest.split_once("code") else { return false };
        let value = value.trim_start_matches([':', ' ']);
        let name: String = value.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
        let imported = |line: &str| line.contains("import") && line.contains(".wgsl") && line.contains(&name);
        !name.is_empty() && text.lines().any(imported)
    })
}
