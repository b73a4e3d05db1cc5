//! Objects that hold a program: both shaders with the values of their uniforms, as `ShaderMaterial` of three.js, regl
//! and effects take them.

use std::collections::BTreeSet;
use std::ops::Range;

use base::text::Span;

use super::program::Programs;
use crate::{Lookup, LookupKind, Missing, ProgramSource};

/// The values of the uniforms of one program.
pub struct Table {
    /// The shaders.
    pub source: ProgramSource,
    /// Place of the key or of the object.
    pub place: Span,
    /// The names that get a value.
    pub names: BTreeSet<String>,
    /// True where a name without a value is an error of its own, and may get one from outside.
    pub nested: bool,
}

/// Keys of vertex and fragment shaders.
const KEYS: [(&str, &str); 4] =
    [("vertexShader", "fragmentShader"), ("vert", "frag"), ("vertex", "fragment"), ("vs", "fs")];

/// The tables of a file, and the look-ups of their names.
pub fn find(programs: &Programs<'_>) -> (Vec<Table>, Vec<Lookup>) {
    let code = programs.code;
    let (mut tables, mut lookups) = (Vec::new(), Vec::new());
    for open in (0..code.tokens.len()).filter(|at| code.is_mark(*at, '{')) {
        // Most braces hold no shader: a look at the keys is cheaper than one at the entries.
        let Some((vertex, fragment)) =
            KEYS.into_iter().find_map(|(v, f)| Some((code.property(open, v)?, code.property(open, f)?)))
        else {
            continue;
        };
        let mut refs = programs.refs(&vertex);
        refs.append(&mut programs.refs(&fragment));
        let source = programs.named(refs);
        if source == ProgramSource::Unknown {
            continue;
        }
        let nested = code.property(open, "frag").is_some();
        for (key, kind) in [("uniforms", LookupKind::Uniform), ("attributes", LookupKind::Attribute)] {
            // Elsewhere the keys of attributes are names of buffers.
            let Some(value) = code.property(open, key).filter(|_| nested || kind == LookupKind::Uniform) else {
                continue;
            };
            let Some((object, closed)) = object(programs, &value) else { continue };
            let mut names = BTreeSet::new();
            for (at, _) in code.properties(object) {
                let (Some(name), place) = (code.key(at), code.place(at)) else { continue };
                let quoted = code.word(at).is_none();
                let inner = if quoted { Span::new(place.start + 1, place.end - 1) } else { place };
                names.insert(name.split(['.', '[']).next().unwrap_or(name).to_owned());
                let lookup = Lookup::new(kind, place, (name.to_owned(), inner, false), source.clone());
                lookups.push(Lookup { wrapped: true, missing: Missing::Ignored, quoted, ..lookup });
            }
            if closed && kind == LookupKind::Uniform {
                let key = if code.is_mark(value.start - 1, ':') { value.start - 2 } else { value.start };
                tables.push(Table { source: source.clone(), place: code.place(key), names, nested });
            }
        }
    }
    (tables, lookups)
}

/// The braces of the object that a value is, and whether nothing is joined to it.
fn object(programs: &Programs<'_>, value: &Range<usize>) -> Option<(usize, bool)> {
    let code = programs.code;
    let mut value = value.clone();
    if let Some(variable) = code.variable(&value) {
        let mut writes = code.writes.iter().filter(|w| w.target == variable);
        let only = writes.next().filter(|_| writes.next().is_none())?;
        value = only.value.clone();
    }
    let open = value.start;
    let close = code.other(open).filter(|_| code.is_mark(open, '{'))?;
    // `{…} as Uniforms`
    let whole = close + 1 >= value.end || code.word(close + 1) == Some("as");
    let entries = code.elements(open).len() == code.properties(open).len();
    whole.then_some((open, entries))
}
