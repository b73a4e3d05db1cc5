//! Dispatches whose count of work groups is the number of items.

use base::text::Span;

use super::group::made_by;
use super::number::number;
use super::pipeline::Pipeline;
use super::value::{Value, Values};

/// A dispatch of a pipeline.
#[derive(Debug)]
pub struct Dispatch {
    /// Index of the pipeline among those of the file.
    pub pipeline: usize,
    /// The name of the number of items.
    pub name: String,
    /// The number.
    pub count: u64,
    /// Its place.
    pub place: Span,
}

/// The dispatches of a file whose pipeline and count are known, where the count also sizes what is stored.
pub fn dispatches(values: &Values<'_, '_>, pipelines: &[Pipeline]) -> Vec<Dispatch> {
    let code = values.code;
    let calls = code.calls().filter(|c| {
        matches!(code.word(c.name), Some("dispatchWorkgroups" | "dispatch_workgroups" | "dispatch" | "dispatch_group"))
    });
    let mut found = Vec::new();
    for call in calls {
        let Some(pass) = code.receiver(call) else { continue };
        let arguments = code.elements(call.open);
        let Some((first, others)) = arguments.split_first() else { continue };
        let one = |r: &std::ops::Range<usize>| r.len() == 1 && code.word(r.start) == Some("1");
        let Some(name) = code.word(first.start).filter(|_| first.len() == 1 && others.iter().all(one)) else {
            continue;
        };
        // The last pipeline that the pass was given in front.
        let body = code.around(call.name).into_iter().next().unwrap_or(0..code.tokens.len());
        let set = code.calls().filter(|c| {
            c.name < call.name
                && body.contains(&c.name)
                && matches!(code.word(c.name), Some("setPipeline" | "set_pipeline"))
                && code.receiver(*c).as_deref() == Some(&pass)
        });
        let Some(set) = set.last() else { continue };
        let Some(pipeline) = code.elements(set.open).into_iter().next() else { continue };
        let value = |tokens| Value { tokens, frame: None };
        let Some(pipeline) = made_by(values, pipelines, &value(pipeline)) else { continue };
        let Some(count) = number(values, &value(first.clone())).filter(|c| *c > 1) else { continue };
        if sizes_storage(values, name) {
            let place = code.span(first);
            found.push(Dispatch { pipeline, name: name.to_owned(), count, place });
        }
    }
    found
}

/// True where a number is a factor of what an array or a buffer is made with.
fn sizes_storage(values: &Values<'_, '_>, name: &str) -> bool {
    let code = values.code;
    (1..code.tokens.len()).filter(|t| code.word(*t) == Some(name)).any(|t| {
        let times = code.is_mark(t + 1, '*') || code.is_mark(t - 1, '*');
        let array = code.bracket(t).filter(|open| code.is_mark(*open, '(')).and_then(|open| code.word(open - 1));
        let sized = || (t.saturating_sub(12)..t).any(|b| code.word(b) == Some("size") && code.is_mark(b + 1, ':'));
        array.is_some_and(|word| word.ends_with("Array") || word == "with_capacity") || (times && sized())
    })
}
