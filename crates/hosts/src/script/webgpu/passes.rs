//! Resources of one pass that are bound in another: parts of a function that were copied and changed in all places but one.

use std::collections::HashSet;

use base::text::Span;

use syntax::words::parts;

use crate::script::code::{Call, Code};

/// A resource that belongs to the pass before.
#[derive(Debug)]
pub struct Mixed {
    /// Its place.
    pub place: Span,
    /// Its place in the pass that it belongs to.
    pub before: Span,
    /// The word of the names of the pass that it stands in.
    pub own: String,
    /// The word of the names of the other pass.
    pub other: String,
    /// The name that is meant, if names are kept.
    pub meant: String,
}

/// The pipeline that a pass is given, and the resources that follow, with their words.
struct Stretch<'c> {
    receiver: String,
    body: usize,
    pipeline: Vec<&'c str>,
    resources: Vec<std::ops::Range<usize>>,
}

/// The one word in which two names differ.
fn changed<'c>(a: &[&'c str], b: &[&'c str]) -> Option<(&'c str, &'c str)> {
    let mut all = a.iter().zip(b).filter(|(x, y)| !x.eq_ignore_ascii_case(y)).map(|(x, y)| (*x, *y));
    let one = all.next().filter(|_| a.len() == b.len() && a.len() > 1)?;
    all.next().is_none().then_some(one)
}

/// `to` with the case of `like`.
fn in_case(to: &str, like: &str) -> String {
    let small = to.to_ascii_lowercase();
    match like.chars().next() {
        Some(c) if c.is_ascii_uppercase() && small.is_char_boundary(1) => small[..1].to_ascii_uppercase() + &small[1..],
        _ => small,
    }
}

fn stretches<'c>(code: &Code<'c>) -> Vec<Stretch<'c>> {
    let mut found: Vec<Stretch<'c>> = Vec::new();
    for call @ Call { name, open } in code.calls() {
        let Some(receiver) = code.receiver(call) else { continue };
        let body = code.around(name).first().map_or(0, |b| b.start);
        let arguments = code.elements(open);
        match code.word(name) {
            Some("set_pipeline" | "setPipeline") => {
                let last = arguments.first().and_then(|a| a.clone().rev().find_map(|t| code.word(t)));
                let pipeline = last.map(|name| parts(name).collect()).unwrap_or_default();
                found.push(Stretch { receiver, body, pipeline, resources: Vec::new() });
            }
            Some(
                "set_bind_group" | "setBindGroup" | "set_vertex_buffer" | "setVertexBuffer" | "set_index_buffer"
                | "setIndexBuffer",
            ) => {
                let own = found.iter_mut().rfind(|s| s.receiver == receiver && s.body == body);
                if let Some(own) = own {
                    own.resources.extend(arguments);
                }
            }
            _ => {}
        }
    }
    found
}

/// Resources whose name has the word of the pass before, which binds the same, where the name with the own word exists.
pub fn mixed(code: &Code<'_>) -> Vec<Mixed> {
    let all = stretches(code);
    let known: HashSet<&str> = (0..code.tokens.len()).filter_map(|t| code.word(t)).collect();
    let text = |range: &std::ops::Range<usize>| code.file.slice(code.span(range));
    let mut found = Vec::new();
    for (index, second) in all.iter().enumerate() {
        let first = all[..index].iter().rfind(|f| f.receiver == second.receiver && f.body == second.body);
        let Some((first, (other, own))) = first.and_then(|f| Some((f, changed(&f.pipeline, &second.pipeline)?))) else {
            continue;
        };
        for resource in &second.resources {
            let Some(before) = first.resources.iter().find(|r| text(r) == text(resource)) else { continue };
            let meant = resource.clone().filter_map(|t| code.word(t)).find_map(|name| {
                let part = parts(name).find(|w| w.eq_ignore_ascii_case(other))?;
                let meant = name.replacen(part, &in_case(own, part), 1);
                known.contains(meant.as_str()).then_some(meant)
            });
            if let Some(meant) = meant {
                let (own, other) = (own.to_ascii_lowercase(), other.to_ascii_lowercase());
                found.push(Mixed { place: code.span(resource), before: code.span(before), own, other, meant });
            }
        }
    }
    found
}
