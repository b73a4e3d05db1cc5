//! Layouts of bind groups and pipelines as hosts describe them.

use base::text::Span;
use syntax::Stage;

use super::number::{bytes, number};
use super::value::{Entry, Value, Values};

/// The layout of a pipeline.
#[derive(Debug, Default, Clone)]
pub enum PipelineLayout {
    /// It is not seen.
    #[default]
    Unknown,
    /// It is derived from the shaders.
    Derived,
    /// These groups, as far as they are known.
    Groups(Vec<Option<GroupLayout>>, Span),
}

/// The layout of a bind group.
#[derive(Debug, Clone)]
pub struct GroupLayout {
    /// Place of its list of entries.
    pub place: Span,
    /// The entries.
    pub entries: Vec<LayoutEntry>,
}

/// An entry of the layout of a bind group.
#[derive(Debug, Clone)]
pub struct LayoutEntry {
    /// The binding.
    pub binding: u64,
    /// Place of the binding.
    pub place: Span,
    /// The stages that may use it, where they are known.
    pub visibility: Option<Vec<Stage>>,
    /// What is bound.
    pub kind: Kind,
}

/// What a layout says that is bound. What is not known is none.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Kind {
    /// It is not seen.
    Unknown,
    /// A uniform buffer of at least so many bytes.
    Uniform(Option<u64>),
    /// A storage buffer, read-only or not, of at least so many bytes.
    Storage(Option<bool>, Option<u64>),
    /// A sampler; true for one that compares.
    Sampler(Option<bool>),
    /// A texture that is sampled or read.
    Texture {
        /// `float`, `sint`, `uint` or `depth`.
        sample: Option<String>,
        /// `2d`, `2d-array`, `cube` and the like.
        dimension: Option<String>,
        /// True for one with several samples.
        multisampled: Option<bool>,
    },
    /// A texture that is written.
    StorageTexture {
        /// The format, as WGSL spells it.
        format: Option<String>,
        /// `read`, `write` or `read_write`.
        access: Option<&'static str>,
        /// As of a texture.
        dimension: Option<String>,
    },
    /// A frame of a video.
    External,
}

/// The layout that a pipeline is given.
pub fn pipeline_layout(values: &Values<'_, '_>, value: &Entry) -> PipelineLayout {
    let Entry::Value(value) = value else { return PipelineLayout::Unknown };
    if values.word(value) == Some("auto") || values.code.word(value.tokens.start) == Some("None") {
        return PipelineLayout::Derived;
    }
    groups(values, value).unwrap_or_default()
}

fn groups(values: &Values<'_, '_>, value: &Value) -> Option<PipelineLayout> {
    let descriptor = argument_of(values, value, &["create_pipeline_layout", "createPipelineLayout"])?;
    let list = values.field(&descriptor, "bind_group_layouts").value()?;
    let place = values.code.span(&list.tokens);
    let all = values.list(&list)?.iter().map(|v| group_layout(values, v)).collect();
    Some(PipelineLayout::Groups(all, place))
}

/// The first argument of the call of one of these methods that a value comes to.
pub fn argument_of(values: &Values<'_, '_>, value: &Value, methods: &[&str]) -> Option<Value> {
    let value = values.resolve(value)?;
    let call = values.call(&value.tokens)?;
    methods.contains(&values.code.word(call.name)?).then_some(())?;
    let tokens = values.code.elements(call.open).into_iter().next()?;
    Some(Value { tokens, frame: value.frame })
}

fn group_layout(values: &Values<'_, '_>, value: &Value) -> Option<GroupLayout> {
    let descriptor = argument_of(values, value, &["create_bind_group_layout", "createBindGroupLayout"])?;
    let list = values.field(&descriptor, "entries").value()?;
    let entries: Option<Vec<LayoutEntry>> = values.list(&list)?.iter().map(|v| entry(values, v)).collect();
    Some(GroupLayout { place: values.code.span(&list.tokens), entries: entries? })
}

fn entry(values: &Values<'_, '_>, value: &Value) -> Option<LayoutEntry> {
    let (open, object) = values.object(value)?;
    let binding = values.entry(open, &object, "binding").value()?;
    let visibility = values.entry(open, &object, "visibility").value().and_then(|v| visibility(values, &v));
    let kind = match values.entry(open, &object, "ty") {
        Entry::Value(ty) => of_rust(values, &ty),
        Entry::Absent | Entry::Unknown => of_javascript(values, open, &object),
    };
    // An array of bindings is another thing.
    let single = match values.entry(open, &object, "count") {
        Entry::Absent => true,
        Entry::Value(count) => values.code.word(count.tokens.start) == Some("None"),
        Entry::Unknown => false,
    };
    let kind = if single { kind } else { Kind::Unknown };
    // What a function makes is told where it is called.
    let here = value.tokens.contains(&open);
    let place = values.code.span(if here { &binding.tokens } else { &value.tokens });
    Some(LayoutEntry { binding: number(values, &binding)?, place, visibility, kind })
}

fn visibility(values: &Values<'_, '_>, value: &Value) -> Option<Vec<Stage>> {
    let code = values.code;
    let value = values.resolve(value).unwrap_or_else(|| value.clone());
    let mut found = Vec::new();
    for at in value.tokens.clone() {
        match code.word(at) {
            Some("VERTEX") => found.push(Stage::Vertex),
            Some("FRAGMENT") => found.push(Stage::Fragment),
            Some("COMPUTE") => found.push(Stage::Compute),
            Some("VERTEX_FRAGMENT") => found.extend([Stage::Vertex, Stage::Fragment]),
            Some("NONE" | "wgpu" | "ShaderStages" | "ShaderStage" | "GPUShaderStage" | "union" | "or") => {}
            Some(_) => return None,
            None if [':', '|', '.', '(', ')'].iter().any(|c| code.is_mark(at, *c)) => {}
            None => return None,
        }
    }
    Some(found)
}

/// `BindingType::Buffer { … }` and its siblings.
fn of_rust(values: &Values<'_, '_>, value: &Value) -> Kind {
    let code = values.code;
    let Some(value) = values.resolve(value) else { return Kind::Unknown };
    let range = value.tokens.clone();
    let Some(open) = range.clone().find(|t| code.is_mark(*t, '{') || code.is_mark(*t, '(')) else {
        return Kind::Unknown;
    };
    let of_binding_type = open >= 4 && code.word(open - 4) == Some("BindingType");
    let Some(kind) = code.word(open - 1).filter(|_| of_binding_type && code.other(open) == Some(range.end - 1)) else {
        return Kind::Unknown;
    };
    let field = |key: &str| values.entry(open, &value, key).value();
    let word = |key: &str| field(key).and_then(|v| values.word(&v)).map(str::to_owned);
    match kind {
        "Buffer" => {
            let least = field("min_binding_size").and_then(|v| bytes(values, &v));
            let Some(ty) = field("ty").map(|v| values.resolve(&v).unwrap_or(v)) else { return Kind::Unknown };
            let says = |word: &str| ty.tokens.clone().any(|t| code.word(t) == Some(word));
            match (says("Uniform"), says("Storage")) {
                (true, false) => Kind::Uniform(least),
                (false, true) => {
                    let brace = ty.tokens.clone().find(|t| code.is_mark(*t, '{'));
                    let read_only = brace.and_then(|open| truth(values, values.entry(open, &ty, "read_only")));
                    Kind::Storage(read_only, least)
                }
                _ => Kind::Unknown,
            }
        }
        "Sampler" if code.is_mark(open, '(') => {
            let inner = Value { tokens: open + 1..range.end - 1, frame: value.frame.clone() };
            match values.word(&inner) {
                Some("Filtering" | "NonFiltering") => Kind::Sampler(Some(false)),
                Some("Comparison") => Kind::Sampler(Some(true)),
                _ => Kind::Sampler(None),
            }
        }
        "Texture" => {
            let sample = field("sample_type").map(|v| values.resolve(&v).unwrap_or(v)).and_then(|v| {
                let kinds = [("Float", "float"), ("Sint", "sint"), ("Uint", "uint"), ("Depth", "depth")];
                let found = |w: &str| v.tokens.clone().any(|t| code.word(t) == Some(w));
                kinds.iter().find(|(word, _)| found(word)).map(|(_, s)| (*s).to_owned())
            });
            let dimension = word("view_dimension").and_then(|w| dimension(&w));
            Kind::Texture { sample, dimension, multisampled: truth(values, values.entry(open, &value, "multisampled")) }
        }
        "StorageTexture" => {
            let access = match word("access").as_deref() {
                Some("WriteOnly") => Some("write"),
                Some("ReadOnly") => Some("read"),
                Some("ReadWrite") => Some("read_write"),
                _ => None,
            };
            let format = word("format").map(|f| f.to_ascii_lowercase());
            Kind::StorageTexture { format, access, dimension: word("view_dimension").and_then(|w| dimension(&w)) }
        }
        "ExternalTexture" => Kind::External,
        _ => Kind::Unknown,
    }
}

fn truth(values: &Values<'_, '_>, entry: Entry) -> Option<bool> {
    match values.word(&entry.value()?) {
        Some("true") => Some(true),
        Some("false") => Some(false),
        _ => None,
    }
}

/// `D2Array` of Rust as JavaScript has it.
fn dimension(word: &str) -> Option<String> {
    Some(
        match word {
            "D1" => "1d",
            "D2" => "2d",
            "D2Array" => "2d-array",
            "D3" => "3d",
            "Cube" => "cube",
            "CubeArray" => "cube-array",
            "1d" | "2d" | "2d-array" | "3d" | "cube" | "cube-array" => word,
            _ => return None,
        }
        .to_owned(),
    )
}

/// `{ buffer: { type: 'uniform' } }` and its siblings.
fn of_javascript(values: &Values<'_, '_>, open: usize, object: &Value) -> Kind {
    let part = |key: &str| values.entry(open, object, key).value();
    // What is not said has a default.
    let text = |of: &Value, key: &str, default: &'static str| match values.field(of, key) {
        Entry::Absent => Some(default.to_owned()),
        Entry::Unknown => None,
        Entry::Value(v) => values.word(&v).map(str::to_owned),
    };
    let read = |of: &Value, known: &[&str]| values.object(of).is_some() && !values.says_more(of, known);
    if let Some(buffer) = part("buffer") {
        if !read(&buffer, &["type", "hasDynamicOffset", "minBindingSize"]) {
            return Kind::Unknown;
        }
        let least = values.field(&buffer, "min_binding_size").value().and_then(|v| number(values, &v));
        return match text(&buffer, "type", "uniform").as_deref() {
            Some("uniform") => Kind::Uniform(least),
            Some("storage") => Kind::Storage(Some(false), least),
            Some("read-only-storage") => Kind::Storage(Some(true), least),
            _ => Kind::Unknown,
        };
    }
    if let Some(sampler) = part("sampler") {
        let ty = text(&sampler, "type", "filtering");
        return Kind::Sampler(ty.filter(|_| read(&sampler, &["type"])).map(|t| t == "comparison"));
    }
    if let Some(texture) = part("texture") {
        if !read(&texture, &["sampleType", "viewDimension", "multisampled"]) {
            return Kind::Unknown;
        }
        let multisampled = match values.field(&texture, "multisampled") {
            Entry::Absent => Some(false),
            entry => truth(values, entry),
        };
        let sample = text(&texture, "sample_type", "float").map(|s| s.replace("unfilterable-", ""));
        let dimension = text(&texture, "view_dimension", "2d").and_then(|w| dimension(&w));
        return Kind::Texture { sample, dimension, multisampled };
    }
    if let Some(texture) = part("storage_texture") {
        if !read(&texture, &["access", "format", "viewDimension"]) {
            return Kind::Unknown;
        }
        let access = match text(&texture, "access", "write-only").as_deref() {
            Some("write-only") => Some("write"),
            Some("read-only") => Some("read"),
            Some("read-write") => Some("read_write"),
            _ => None,
        };
        let dimension = text(&texture, "view_dimension", "2d").and_then(|w| dimension(&w));
        return Kind::StorageTexture { format: text(&texture, "format", ""), access, dimension };
    }
    if part("external_texture").is_some() { Kind::External } else { Kind::Unknown }
}
