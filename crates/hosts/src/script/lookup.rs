//! Look-ups and feeds of scripts: calls that ask for a location, what is done with it, names in brackets of a program,
//! and arrays whose attributes are named.

use std::ops::Range;

use base::text::Span;

use super::code::{Call, Code};
use super::language::Language;
use super::program::Programs;
use super::token::Token;
use crate::Wrapped;
use crate::cpp::{Feeds, PRESETS, User};
use crate::{Lookup, LookupKind, Missing, ProgramSource, Setter};

/// The look-ups of a file, in the order of the text.
pub fn find(programs: &Programs<'_>) -> Vec<Lookup> {
    let code = programs.code;
    let mut found = Vec::new();
    for call in code.calls() {
        found.extend(asked(programs, call).or_else(|| by_method(programs, call)));
        found.extend(arrays(programs, call));
    }
    found.extend((0..code.tokens.len()).filter_map(|at| member(programs, at)));
    found.sort_by_key(|l: &Lookup| l.name_span);
    found
}

/// The function of OpenGL that a binding calls so: `uniform1f`, `glUniform1f`, `uniform_1_f32`, `Uniform1f`.
pub fn function_of_gl(name: &str) -> String {
    if name.strip_prefix("gl").is_some_and(|n| n.starts_with(|c: char| c.is_ascii_uppercase())) {
        return name.to_owned();
    }
    if !name.contains('_') {
        let mut letters = name.chars();
        let first = letters.next().map(|c| c.to_ascii_uppercase());
        return format!("gl{}{}", first.map_or(String::new(), String::from), letters.as_str());
    }
    let slice = name.ends_with("_slice");
    let mut made = "gl".to_owned();
    for word in name.trim_end_matches("_slice").split('_') {
        match word {
            "f32" | "f64" => made.push(if word == "f32" { 'f' } else { 'd' }),
            "i32" => made.push('i'),
            "u32" => made.push_str("ui"),
            _ => {
                let mut letters = word.chars();
                made.extend(letters.next().map(|c| c.to_ascii_uppercase()));
                made.push_str(letters.as_str());
            }
        }
    }
    if slice {
        made.push('v');
    }
    // `vertex_attrib_pointer_f32`
    made.strip_suffix("Pointerf").map_or(made.clone(), |start| format!("{start}Pointer"))
}

/// `gl.getUniformLocation(program, "name")` and the like, or with the program as the object.
fn asked(programs: &Programs<'_>, call: Call) -> Option<Lookup> {
    let code = programs.code;
    let called = code.word(call.name)?;
    let kind = LookupKind::of(&function_of_gl(called))?;
    let arguments = code.elements(call.open);
    let (name, name_span, partial) = name(code, arguments.last()?)?;
    let source = match arguments.as_slice() {
        [program, ..] if arguments.len() == kind.arity() => programs.source(program),
        [_] => programs.of_variable_alone(&code.receiver(call)?, call.name),
        _ => return None,
    };
    let users = users(code, call);
    let is = |start: &str| users.iter().any(|u| u.function.starts_with(start));
    let attribute = is("glVertexAttrib") || is("glEnableVertexAttrib");
    let null = kind == LookupKind::Uniform && called == "getUniformLocation";
    Some(Lookup {
        feeds: Feeds { attribute, uniform: is("glUniform") },
        users,
        missing: if null { Missing::Null } else { Missing::Negative },
        ..Lookup::new(kind, code.place(call.name), (name, name_span, partial), source)
    })
}

/// A setter by name of a common wrapper: `shader.setMat4("name", m)`.
fn by_method(programs: &Programs<'_>, call: Call) -> Option<Lookup> {
    let code = programs.code;
    let called = code.word(call.name)?;
    let preset = PRESETS.iter().find(|p| p.method == called)?;
    let kind = match preset.kind {
        Wrapped::UniformLocation | Wrapped::SetUniform => LookupKind::Uniform,
        Wrapped::AttributeLocation => LookupKind::Attribute,
        Wrapped::LoadProgram => return None,
    };
    let object = code.receiver(call)?;
    let found = name(code, code.elements(call.open).first()?)?;
    let source = programs.of_variable_alone(&object, call.name);
    let sets = preset.like.and_then(Setter::of_function);
    Some(Lookup { wrapped: true, sets, ..Lookup::new(kind, code.place(call.name), found, source) })
}

/// A name in brackets behind a program: `program['name']`.
fn member(programs: &Programs<'_>, at: usize) -> Option<Lookup> {
    let code = programs.code;
    let open = at.checked_sub(1).filter(|open| code.is_mark(*open, '['))?;
    let Token::String { .. } = code.tokens[at] else { return None };
    (code.other(open)? == at + 1).then_some(())?;
    let (variable, _) = code.chain(open.checked_sub(1)?)?;
    // A table of shaders has names of its own.
    let makes = |at: usize| code.word(at).is_some_and(|w| w.contains("rogram")) && code.is_mark(at + 1, '(');
    let mut values = code.writes.iter().filter(|w| w.target == variable).map(|w| w.value.clone());
    values.any(|mut value| value.any(makes)).then_some(())?;
    let (text, place) = code.string(&(at..at + 1))?;
    let is_name = |c: char| c.is_alphanumeric() || "_[].".contains(c);
    (!text.is_empty() && text.chars().all(is_name)).then_some(())?;
    let source = programs.of_variable_alone(&variable, at);
    let name = (text.to_owned(), place, false);
    let lookup = Lookup::new(LookupKind::Name, place, name, source);
    Some(Lookup { wrapped: true, missing: Missing::Refused, ..lookup })
}

/// Attributes that `vertex_array(program, [(buffer, "3f 2f", "position", "uv")])` names.
fn arrays(programs: &Programs<'_>, call: Call) -> Vec<Lookup> {
    let code = programs.code;
    if !matches!(code.word(call.name), Some("vertex_array" | "simple_vertex_array")) {
        return Vec::new();
    }
    let arguments = code.elements(call.open);
    let Some((program, rest)) = arguments.split_first() else { return Vec::new() };
    let source = programs.source(program);
    if source == ProgramSource::Unknown {
        return Vec::new();
    }
    let mut found = Vec::new();
    let mut named = |elements: &[Range<usize>]| {
        // `(buffer, "3f 2f", "position", "uv")`, or without a format.
        let strings: Vec<(&str, Span)> = elements.iter().filter_map(|e| code.string(e)).collect();
        let format = strings.first().filter(|(text, _)| is_format(text));
        let sizes: Vec<&str> =
            format.map(|f| f.0.split_whitespace().filter(|s| !s.contains('x')).collect()).unwrap_or_default();
        for (index, (text, place)) in strings.iter().skip(usize::from(format.is_some())).enumerate() {
            let name = ((*text).to_owned(), *place, false);
            let lookup = Lookup::new(LookupKind::Attribute, *place, name, source.clone());
            let size = sizes.get(index).and_then(|s| s.split('f').next()?.parse().ok()).filter(|n| (1..=4).contains(n));
            found.push(Lookup { wrapped: true, missing: Missing::Refused, given: size, ..lookup });
        }
    };
    match rest {
        [list] if code.is_mark(list.start, '[') => {
            for tuple in code.elements(list.start).iter().filter(|t| code.is_mark(t.start, '(')) {
                named(&code.elements(tuple.start));
            }
        }
        [buffer, names @ ..] if !code.is_mark(buffer.start, '[') => {
            let plain: Vec<Range<usize>> = names.iter().filter(|n| code.string(n).is_some()).cloned().collect();
            named(&plain);
        }
        _ => {}
    }
    found
}

/// A field of a record of numbers: `('position', np.float32, 3)`.
pub struct Field {
    /// Its name.
    pub name: String,
    /// Place of the tuple.
    pub place: Span,
    /// Numbers in it.
    pub size: usize,
}

/// The fields of floats in records of numpy.
pub fn fields(code: &Code<'_>) -> Vec<Field> {
    if code.language != Language::Python {
        return Vec::new();
    }
    let field = |open: usize| {
        let elements = code.elements(open);
        let [name, kind, size] = elements.as_slice() else { return None };
        let (name, _) = code.string(name)?;
        code.file.slice(code.span(kind)).contains("float32").then_some(())?;
        let size = code.file.slice(code.span(size)).trim_matches(['(', ')', ',']).parse().ok()?;
        let place = code.place(open).to(code.place(code.other(open)?));
        Some(Field { name: name.to_owned(), place, size })
    };
    (0..code.tokens.len()).filter(|at| code.is_mark(*at, '(')).filter_map(field).collect()
}

/// True for a format of buffers: `3f 2f`, `3f4 2x4/i`.
fn is_format(text: &str) -> bool {
    let part = |part: &str| {
        part.starts_with(|c: char| c.is_ascii_digit() || "fiux".contains(c))
            && part.chars().all(|c| c.is_ascii_digit() || "fiuxvr/".contains(c))
    };
    !text.is_empty() && text.split_whitespace().all(part)
}

/// A name in a string, or the beginning of one that goes on with an index or a member.
fn name(code: &Code<'_>, argument: &Range<usize>) -> Option<(String, Span, bool)> {
    let whole = |text: &str| !text.is_empty() && !text.contains(['$', '%', '{', ' ']);
    if let Some((text, place)) = code.string(argument).filter(|(text, _)| whole(text)) {
        return Some((text.to_owned(), place, false));
    }
    let Some(Token::String { inner, .. }) = code.tokens.get(argument.start) else { return None };
    let text = code.file.slice(*inner);
    let end = text.find(['$', '%', '{']).unwrap_or(text.len());
    let begins = &text[..end];
    let goes_on = begins.contains(['[', '.']) && !begins.contains(['\\', ' ']);
    goes_on.then(|| (begins.to_owned(), Span::new(inner.start, inner.start + end), true))
}

/// The calls that get the location that a call gives: directly, through a variable that has no other value, or through
/// a member of an object of locations.
fn users(code: &Code<'_>, call: Call) -> Vec<User> {
    let Some(close) = code.other(call.open) else { return Vec::new() };
    let start = match code.receiver(call) {
        Some(_) => code.chain(call.name).map_or(call.name, |(_, start)| start),
        None => call.name,
    };
    let value = start..close + 1;
    if let Some(open) = code.bracket(start).filter(|open| code.is_mark(*open, '('))
        && let Some(name) = open.checked_sub(1).filter(|name| code.word(*name).is_some())
    {
        return user(code, Call { name, open }, |a| a.start <= start && close < a.end).into_iter().collect();
    }
    let kept = match code.kept_in(&value) {
        Some(write) => {
            let mut all = code.writes.iter().filter(|w| w.target == write.target);
            all.next().filter(|_| all.next().is_none()).map(|w| w.target.clone())
        }
        None => member_of_locations(code, start),
    };
    let Some(kept) = kept else { return Vec::new() };
    let tail = format!(".{kept}");
    let is_kept =
        |a: &Range<usize>| code.variable(a).is_some_and(|v| v == kept || (kept.contains('.') && v.ends_with(&tail)));
    code.calls().filter_map(|c| user(code, c, is_kept)).collect()
}

/// `locations: { color: gl.getUniformLocation(…) }` is read as `locations.color`.
fn member_of_locations(code: &Code<'_>, start: usize) -> Option<String> {
    let key_of = |first: usize| {
        let colon = first.checked_sub(1).filter(|at| code.is_mark(*at, ':'))?;
        code.word(colon.checked_sub(1)?).map(|word| (word, colon - 1))
    };
    let (key, at) = key_of(start)?;
    let open = code.bracket(at).filter(|open| code.is_mark(*open, '{'))?;
    let object = match key_of(open) {
        Some((object, _)) => object.to_owned(),
        None => code.writes.iter().find(|w| w.value.start == open)?.target.clone(),
    };
    // Two objects of that form in a file are not told apart.
    let same = |at: usize| {
        code.word(at) == Some(key)
            && code.is_mark(at + 1, ':')
            && code.bracket(at).is_some_and(|o| code.is_mark(o, '{'))
    };
    let once = (0..code.tokens.len()).filter(|at| same(*at)).count() == 1;
    once.then(|| format!("{}.{key}", object.rsplit('.').next().unwrap_or(&object)))
}

fn user(code: &Code<'_>, call: Call, is_location: impl Fn(&Range<usize>) -> bool) -> Option<User> {
    let called = code.word(call.name)?;
    let function = function_of_gl(called);
    let takes = ["glUniform", "glVertexAttrib", "glEnableVertexAttrib", "glProgramUniform"];
    takes.iter().any(|start| function.starts_with(start)).then_some(())?;
    let arguments = code.elements(call.open);
    let position = arguments.iter().position(is_location)?;
    // A location comes first, or behind the program.
    (position <= 1).then_some(())?;
    let arguments = arguments.iter().map(|a| code.span(a)).collect();
    Some(User { function, function_span: code.place(call.name), arguments, position })
}
