//! Files that hold several shaders, which hosts cut apart: behind a line that says the stage (`#type vertex`,
//! `#[compute]` of Godot, `---FRAGMENT SHADER---`), on the two sides of a line of `$$`, or in branches for `VERTEX` and `FRAGMENT`.

use base::text::{SourceFile, Span};
use syntax::Stage;

use crate::{Literal, marks};

/// Macros that hosts define for the vertex shader and for the fragment shader of a file.
const DEFINED: [(&str, &str); 6] = [
    ("VERTEX", "FRAGMENT"),
    ("VERTEX_SHADER", "FRAGMENT_SHADER"),
    ("_VERTEX_", "_FRAGMENT_"),
    ("VERTEX_PROGRAM", "FRAGMENT_PROGRAM"),
    ("VERT", "FRAG"),
    ("VS", "FS"),
];

/// True for a macro by which hosts say the stage for which they compile a text.
pub fn says_the_stage(name: &str) -> bool {
    DEFINED.iter().any(|(vertex, fragment)| [*vertex, *fragment].contains(&name))
}

/// The shaders of such a file; none when it is one shader.
pub fn sections(file: &SourceFile) -> Vec<(Stage, Literal)> {
    [marked, versioned, separated, conditional]
        .into_iter()
        .map(|read| read(file))
        .find(|all| !all.is_empty())
        .unwrap_or_default()
}

/// Shaders behind lines that say their stage.
fn marked(file: &SourceFile) -> Vec<(Stage, Literal)> {
    let text = file.text();
    let mut found: Vec<(usize, usize, Stage)> = Vec::new();
    for (at, line) in lines(text) {
        if let Some(stage) = mark(line) {
            found.push((at, at + line.len(), stage));
        }
    }
    // What stands in front of the first shader belongs to none, or to all: only comments are clear.
    let Some(&(first, ..)) = found.first() else { return Vec::new() };
    if !marks::without_comments(&text[..first]).trim().is_empty() {
        return Vec::new();
    }
    let ends = found.iter().skip(1).map(|m| m.0).chain([text.len()]);
    found
        .iter()
        .zip(ends)
        .map(|(&(_, start, stage), end)| (stage, Literal::part(file, Span::new(start, end))))
        .collect()
}

/// Shaders that each begin with a `#version`: what stands between them says the stage, or what each uses.
fn versioned(file: &SourceFile) -> Vec<(Stage, Literal)> {
    let text = file.text();
    let commented = |at: usize| text[..at].rfind("/*").is_some_and(|open| !text[open..at].contains("*/"));
    let is_start = |(at, line): &(usize, &str)| line.trim_start().starts_with("#version") && !commented(*at);
    let starts: Vec<usize> = lines(text).filter(is_start).map(|(at, _)| at).collect();
    let ends = starts.iter().skip(1).copied().chain([text.len()]);
    let parts: Vec<Span> = starts.iter().zip(ends).map(|(&start, end)| Span::new(start, end)).collect();
    // Branches of one shader may state versions of their own.
    if parts.len() < 2 || !parts.iter().all(|part| marks::has_main(file.slice(*part))) {
        return Vec::new();
    }
    let mut end_before = 0;
    let mut read = |part: Span| {
        // Behind the last function stands what introduces the next shader.
        let end = file.slice(part).rfind('}').map_or(part.end, |at| part.start + at + 1);
        // A block that was opened in front of it is closed behind it.
        let end = closed(&text[part.start..end]).map_or(end, |at| part.start + at);
        let between = &text[end_before..part.start];
        end_before = end;
        let own = &text[part.start..end];
        let stage = Stage::of_words(between).or_else(|| marks::stage(own).ok()?).unwrap_or(Stage::Library);
        (stage, Literal::part(file, Span::new(part.start, end)))
    };
    parts.into_iter().map(&mut read).collect()
}

/// Where a text has the brace that closes what was opened in front of it.
fn closed(text: &str) -> Option<usize> {
    let (mut depth, mut at) = (0_usize, 0);
    while let Some(first) = text[at..].chars().next() {
        let rest = &text[at..];
        at += match first {
            '/' if rest.starts_with("//") => rest.find('\n').unwrap_or(rest.len()),
            '/' if rest.starts_with("/*") => rest.find("*/").map_or(rest.len(), |end| end + 2),
            '}' if depth == 0 => return Some(at),
            '{' | '}' => {
                depth = if first == '{' { depth + 1 } else { depth - 1 };
                1
            }
            _ => first.len_utf8(),
        };
    }
    None
}

/// Lines with where they start.
fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    text.split_inclusive('\n').scan(0, |at, line| {
        let start = *at;
        *at += line.len();
        Some((start, line))
    })
}

/// The stage that a line says.
fn mark(line: &str) -> Option<Stage> {
    let line = line.trim();
    let (stage, rest) = match line.strip_prefix("---") {
        Some(title) => {
            let mut words = title.trim_matches('-').split_whitespace();
            (words.next()?, words.next().filter(|w| !w.eq_ignore_ascii_case("shader")))
        }
        None => {
            let line = line.strip_prefix(['#', '@'])?;
            let inside = line.strip_prefix('[').and_then(|line| line.strip_suffix(']'));
            let mut words = inside.unwrap_or(line).split_whitespace();
            match words.next()? {
                "type" | "shader" | "stage" => (words.next()?, words.next()),
                word => (word, words.next()),
            }
        }
    };
    rest.is_none().then_some(())?;
    Stage::of_word(stage)
}

/// A vertex shader in front of a line of `$$`, and a fragment shader behind it.
fn separated(file: &SourceFile) -> Vec<(Stage, Literal)> {
    let text = file.text();
    let mut between = lines(text).filter(|(_, line)| line.trim() == "$$");
    let (Some((at, line)), None) = (between.next(), between.next()) else { return Vec::new() };
    let parts = [Span::new(0, at), Span::new(at + line.len(), text.len())];
    if !parts.iter().all(|part| marks::has_main(file.slice(*part))) {
        return Vec::new();
    }
    [Stage::Vertex, Stage::Fragment].into_iter().zip(parts.map(|part| Literal::part(file, part))).collect()
}

/// Shaders in branches of one text: the text as it is with the macro of each stage.
fn conditional(file: &SourceFile) -> Vec<(Stage, Literal)> {
    let text = file.text();
    let says_no_stage = Stage::from_path(file.name()).is_none_or(|s| s == Stage::Library);
    // Two stages show what both have, or a `main` each.
    let halves = text.find("main").map(|at| text.split_at(at + "main".len()));
    let several = || halves.is_some_and(|(_, behind)| marks::has_main(behind));
    if !says_no_stage || (marks::stage(text) != Err(marks::Mixed) && !several()) {
        return Vec::new();
    }
    let directives: Vec<&str> = text.lines().filter_map(|l| l.trim_start().strip_prefix('#')).map(str::trim).collect();
    let starts = |words: &[&str], name: &str| {
        directives.iter().any(|d| words.iter().any(|w| d.starts_with(w)) && marks::has_word(d, name))
    };
    let tested = |name: &str| starts(&["if", "elif"], name) && !starts(&["define"], name);
    let Some((vertex, fragment)) = DEFINED.into_iter().find(|(v, f)| tested(v) && tested(f)) else { return Vec::new() };
    // Hosts with parameters in pragmas give them as uniforms.
    let parameters = if starts(&["pragma"], "parameter") { "#define PARAMETER_UNIFORM\n" } else { "" };
    let version = lines(text).find(|(_, line)| line.trim_start().starts_with("#version"));
    let at = version.map_or(0, |(at, line)| at + line.len());
    let with = |stage: Stage, name: &str| {
        let mut literal = Literal::part(file, Span::new(0, at));
        literal.made(&format!("#define {name}\n{parameters}"), Span::at(at));
        literal.add_part(file, Span::new(at, text.len()));
        (stage, literal)
    };
    vec![with(Stage::Vertex, vertex), with(Stage::Fragment, fragment)]
}

/// The shader of a file in which a host replaces lines such as `$HEADER$`, with blanks for them; none without such.
pub fn template(file: &SourceFile) -> Option<Literal> {
    let text = file.text();
    let is_hook = |line: &str| {
        let name = line.trim().strip_prefix('$').and_then(|name| name.strip_suffix('$'));
        name.is_some_and(|name| !name.is_empty() && name.chars().all(|c| c.is_ascii_uppercase() || c == '_'))
    };
    let hooks: Vec<Span> = lines(text)
        .filter(|(_, line)| is_hook(line))
        .map(|(at, line)| Span::new(at, at + line.trim_end().len()))
        .collect();
    let mut literal = Literal::part(file, Span::new(0, text.len()));
    hooks.iter().for_each(|hook| literal.blank(*hook));
    (!hooks.is_empty()).then_some(literal)
}
