//! Pipelines of a host: the functions that they start, the buffers that feed them, and their layouts.

use base::text::Span;
use syntax::Stage;

use super::layout::{PipelineLayout, pipeline_layout};
use super::modules::{self, Source};
use super::value::{Entry, Frame, Value, Values};
use super::vertex::{self, VertexBuffer};
use std::rc::Rc;

/// A stage of a pipeline.
#[derive(Debug, Clone)]
pub struct StageUse {
    /// The stage.
    pub stage: Stage,
    /// The text of the module.
    pub source: Source,
    /// The function that is started.
    pub start: Start,
    /// Place of the description.
    pub place: Span,
    /// The vertex buffers, where all are known.
    pub buffers: Option<(Vec<VertexBuffer>, Span)>,
}

/// Which function of a module is started.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Start {
    /// The one of this name.
    Named(String, Span),
    /// The only one of the stage.
    Only,
}

/// A pipeline of which all stages are known.
#[derive(Debug, Clone)]
pub struct Pipeline {
    /// Its stages.
    pub stages: Vec<StageUse>,
    /// Its layout.
    pub layout: PipelineLayout,
    /// First token of the call that makes it.
    pub(super) made_at: usize,
}

/// Methods that make pipelines.
const MAKERS: [&str; 6] = [
    "create_render_pipeline",
    "create_compute_pipeline",
    "createRenderPipeline",
    "createRenderPipelineAsync",
    "createComputePipeline",
    "createComputePipelineAsync",
];

/// True for the name of a method that makes pipelines.
pub fn is_maker(name: &str) -> bool {
    MAKERS.contains(&name)
}

/// All stages that the file describes, be their pipeline seen or not.
pub fn stages(values: &Values<'_, '_>) -> Vec<StageUse> {
    let code = values.code;
    let mut found = Vec::new();
    for open in (0..code.tokens.len()).filter(|at| code.is_mark(*at, '{') && code.property(*at, "module").is_some()) {
        let Some(stage) = stage_of(values, open) else { continue };
        for frame in values.frames(open) {
            found.extend(stage_use(values, open, stage, frame));
        }
    }
    found
}

/// The stage that an object describes: by its type in Rust, by the key that it stands under in JavaScript.
fn stage_of(values: &Values<'_, '_>, open: usize) -> Option<Stage> {
    let code = values.code;
    let before = |back: usize| open.checked_sub(back).and_then(|at| code.word(at));
    let key = || before(2).filter(|_| code.is_mark(open - 1, ':'));
    match before(1).or_else(key)? {
        "VertexState" | "vertex" => Some(Stage::Vertex),
        "FragmentState" | "fragment" => Some(Stage::Fragment),
        "ComputePipelineDescriptor" | "compute" => Some(Stage::Compute),
        _ => None,
    }
}

fn stage_use(values: &Values<'_, '_>, open: usize, stage: Stage, frame: Option<Rc<Frame>>) -> Option<StageUse> {
    let code = values.code;
    let close = code.other(open)?;
    let object = Value { tokens: open..close + 1, frame };
    let source = modules::source(values, &values.entry(open, &object, "module").value()?)?;
    let start = match values.entry(open, &object, "entry_point") {
        Entry::Value(value) if code.word(value.tokens.start) == Some("None") => Start::Only,
        Entry::Value(value) => {
            let value = values.resolve(&value)?;
            let (name, place) = code.string(&value.tokens).filter(|(name, _)| !name.contains('$'))?;
            Start::Named(name.to_owned(), place)
        }
        Entry::Absent => Start::Only,
        Entry::Unknown => return None,
    };
    let buffers = match values.entry(open, &object, "buffers") {
        Entry::Value(list) => vertex::buffers(values, &list).map(|all| (all, code.span(&list.tokens))),
        Entry::Absent => Some((Vec::new(), code.place(open))),
        Entry::Unknown => None,
    };
    let place = if open > 0 { code.place(open - 1) } else { code.place(open) };
    Some(StageUse { stage, source, start, place, buffers })
}

/// The pipelines whose stages are all known.
pub fn pipelines(values: &Values<'_, '_>) -> Vec<Pipeline> {
    let code = values.code;
    let mut found = Vec::new();
    for call in code.calls().filter(|c| code.word(c.name).is_some_and(is_maker)) {
        let method = call.name > 0 && code.is_mark(call.name - 1, '.');
        let Some(descriptor) = code.elements(call.open).into_iter().next().filter(|_| method) else { continue };
        for frame in values.frames(call.name) {
            let value = Value { tokens: descriptor.clone(), frame };
            found.extend(pipeline(values, &value, call.name));
        }
    }
    found
}

fn pipeline(values: &Values<'_, '_>, descriptor: &Value, made_at: usize) -> Option<Pipeline> {
    let (open, object) = values.object(descriptor)?;
    let mut stages = Vec::new();
    if values.code.word(made_at)?.to_ascii_lowercase().contains("compute") {
        let inner = match values.entry(open, &object, "compute") {
            Entry::Value(value) => values.object(&value)?,
            _ => (open, object.clone()),
        };
        stages.push(stage_use(values, inner.0, Stage::Compute, inner.1.frame)?);
    } else {
        let (brace, vertex) = values.object(&values.entry(open, &object, "vertex").value()?)?;
        stages.push(stage_use(values, brace, Stage::Vertex, vertex.frame)?);
        match values.entry(open, &object, "fragment") {
            Entry::Absent => {}
            Entry::Unknown => return None,
            Entry::Value(value) if values.code.word(value.tokens.start) == Some("None") => {}
            Entry::Value(value) => {
                let (brace, fragment) = values.object(&value)?;
                stages.push(stage_use(values, brace, Stage::Fragment, fragment.frame)?);
            }
        }
    }
    let layout = pipeline_layout(values, &values.entry(open, &object, "layout"));
    Some(Pipeline { stages, layout, made_at })
}
