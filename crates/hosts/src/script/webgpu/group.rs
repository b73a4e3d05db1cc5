//! Bind groups whose layout is that which a pipeline derives from its shaders.

use base::text::Span;

use super::layout::PipelineLayout;
use super::number::number;
use super::pipeline::Pipeline;
use super::value::{Entry, Value, Values};

/// A bind group with the layout of a pipeline.
#[derive(Debug)]
pub struct BindGroup {
    /// Index of the pipeline among those of the file.
    pub pipeline: usize,
    /// The number of the group.
    pub index: u64,
    /// Its bindings.
    pub bindings: Vec<Bound>,
    /// Place of the list of entries.
    pub place: Span,
}

/// A resource in a bind group.
#[derive(Debug)]
pub struct Bound {
    /// The binding.
    pub binding: u64,
    /// Place of the number.
    pub place: Span,
    /// Bytes of the buffer with the place of their number, where the whole of a buffer is bound and its size is known.
    pub size: Option<(u64, Span)>,
}

/// The bind groups of a file whose pipeline and entries are known.
pub fn groups(values: &Values<'_, '_>, pipelines: &[Pipeline]) -> Vec<BindGroup> {
    let code = values.code;
    let mut found = Vec::new();
    for call in code.calls().filter(|c| matches!(code.word(c.name), Some("createBindGroup" | "create_bind_group"))) {
        let Some(descriptor) = code.elements(call.open).into_iter().next() else { continue };
        for frame in values.frames(call.name) {
            let value = Value { tokens: descriptor.clone(), frame };
            found.extend(group(values, pipelines, &value));
        }
    }
    found
}

fn group(values: &Values<'_, '_>, pipelines: &[Pipeline], descriptor: &Value) -> Option<BindGroup> {
    let code = values.code;
    let (open, object) = values.object(descriptor)?;
    let layout = values.resolve(&values.entry(open, &object, "layout").value()?)?;
    let call = values.call(&layout.tokens)?;
    matches!(code.word(call.name)?, "getBindGroupLayout" | "get_bind_group_layout").then_some(())?;
    let [index] = code.elements(call.open).try_into().ok()?;
    let index = number(values, &Value { tokens: index, frame: layout.frame.clone() })?;
    let receiver = Value { tokens: layout.tokens.start..call.name - 1, frame: layout.frame.clone() };
    let pipeline = made_by(values, pipelines, &receiver)?;
    matches!(pipelines[pipeline].layout, PipelineLayout::Derived).then_some(())?;
    let list = values.entry(open, &object, "entries").value()?;
    let elements = values.list(&list)?;
    let bindings = elements.iter().map(|element| {
        let (open, entry) = values.object(element)?;
        let binding = values.entry(open, &entry, "binding").value()?;
        let size = whole_buffer(values, open, &entry);
        // An entry that a function of the file makes is wrong where that is called.
        let written_here = element.tokens.contains(&binding.tokens.start);
        let place = code.span(if written_here { &binding.tokens } else { &element.tokens });
        Some(Bound { binding: number(values, &binding)?, place, size })
    });
    Some(BindGroup { pipeline, index, bindings: bindings.collect::<Option<_>>()?, place: code.span(&list.tokens) })
}

/// The size of the buffer that is the whole resource of an entry.
fn whole_buffer(values: &Values<'_, '_>, open: usize, entry: &Value) -> Option<(u64, Span)> {
    let code = values.code;
    let resource = values.entry(open, entry, "resource").value()?;
    let buffer = match values.object(&resource) {
        Some((open, object)) => {
            let absent = |key: &str| matches!(values.entry(open, &object, key), Entry::Absent);
            (absent("size") && absent("offset")).then(|| values.entry(open, &object, "buffer").value())??
        }
        None => resource,
    };
    let made = values.resolve(&buffer)?;
    let call =
        values.call(&made.tokens).filter(|c| matches!(code.word(c.name), Some("createBuffer" | "create_buffer")))?;
    let descriptor = code.elements(call.open).into_iter().next()?;
    let (open, object) = values.object(&Value { tokens: descriptor, frame: made.frame })?;
    let size = values.resolve(&values.entry(open, &object, "size").value()?)?;
    Some((number(values, &size)?, code.span(&size.tokens)))
}

/// The one pipeline that an expression comes to.
pub fn made_by(values: &Values<'_, '_>, pipelines: &[Pipeline], value: &Value) -> Option<usize> {
    let value = values.resolve(value)?;
    let call = values.call(&value.tokens)?;
    let mut made = pipelines.iter().enumerate().filter(|(_, p)| p.made_at == call.name);
    // Of a call in a function that is called several times, each makes another pipeline.
    made.next().filter(|_| made.next().is_none()).map(|(index, _)| index)
}
