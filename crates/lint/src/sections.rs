//! Files that hold several shaders, which hosts cut apart: behind a line that says the stage (`#type vertex`,
//! `#[compute]` of Godot, `---FRAGMENT SHADER---`), on the two sides of a line of `$$`, or in branches for `VERTEX` and `FRAGMENT`.

use base::text::{SourceFile, Span};
use syntax::Stage;

use super::host::{Literal, marks};

/// Macros that hosts define for the vertex shader and for the fragment shader of a file.
const DEFINED: [(&str, &str); 6] = [
    ("VERTEX", "FRAGMENT"),
    ("VERTEX_SHADER", "FRAGMENT_SHADER"),
    ("_VERTEX_", "_FRAGMENT_"),
    ("VERTEX_PROGRAM", "FRAGMENT_PROGRAM"),
    ("VERT", "FRAG"),
    ("VS", "FS"),
];

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
    if !says_no_stage || marks::stage(text) != Err(marks::Mixed) {
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

#[cfg(test)]
mod tests {
    use crate::{Input, run};
    use base::text::SourceFile;

    fn reported(text: &str) -> Vec<String> {
        let file = SourceFile::new("both.glsl", text);
        let found = run(&[Input::new(file)]);
        found.iter().map(|d| format!("{} {} {}", d.code, d.file.locate(d.span.start), d.message)).collect()
    }

    const BOTH: &str = "// Both stages\n#type vertex\n#version 330 core\nlayout(location = 0) in vec3 p;\nout vec3 n;\n\
        void main() { n = p; gl_Position = vec4(p, 1.0); }\n\n#type fragment\n#version 330 core\n\
        in vec3 n;\nout vec4 c;\nvoid main() { c = vec4(n, 1.0); }\n";

    #[test]
    fn both_shaders_are_read() {
        assert_eq!(reported(BOTH), [""; 0]);
        let wrong = BOTH.replace("vec4(n, 1.0)", "vec3(n, 1.0)");
        let found = reported(&wrong);
        assert_eq!(found.len(), 1, "{found:?}");
        assert!(found[0].contains("both.glsl:12:19"), "{found:?}");
    }

    #[test]
    fn other_languages_under_the_same_ending_are_left_alone() {
        let file = SourceFile::new("toon.shader", "Shader \"Toon\" { SubShader { Pass { CGPROGRAM ENDCG } } }\n");
        assert!(run(&[Input::new(file)]).is_empty());
        let file = SourceFile::new("both.shader", BOTH.replace("#type", "#shader").replace("vec4(n", "vec3(n"));
        assert_eq!(run(&[Input::new(file)]).len(), 1);
    }

    #[test]
    fn sections_of_godot_are_shaders() {
        let text = "#[compute]\n#version 450\nlayout(local_size_x = 64) in;\nlayout(set = 0, binding = 0) buffer D { float d[]; };\n\
            void main() { uint i = gl_GlobalInvocationID.x; if (i < uint(d.length())) d[i] = vec2(1.0).x; }\n";
        assert_eq!(reported(text), [""; 0]);
        let found = reported(&text.replace("vec2(1.0).x", "vec2(1.0)"));
        assert!(found.len() == 1 && found[0].contains("both.glsl:5:"), "{found:?}");
        let both = BOTH.replace("#type vertex", "#[vertex]").replace("#type fragment", "#[fragment]");
        assert_eq!(reported(&both), [""; 0]);
        let found = reported(&both.replace("vec4(n, 1.0)", "vec3(n, 1.0)"));
        assert!(found.len() == 1 && found[0].contains("both.glsl:12:19"), "{found:?}");
    }

    const BRANCHES: &str = "#if defined(VERTEX)\nattribute vec4 p;\nvarying vec2 t;\nvoid main() { t = p.xy; gl_Position = p; }\n\
        #elif defined(FRAGMENT)\nvarying vec2 t;\nuniform sampler2D s;\nvoid main() { gl_FragColor = texture2D(s, t); }\n#endif\n";

    #[test]
    fn branches_for_the_stages_are_two_shaders() {
        assert_eq!(reported(BRANCHES), [""; 0]);
        let found = reported(&BRANCHES.replace("texture2D(s, t)", "texture2D(s, t) * (1 - t.x)"));
        assert!(found.len() == 1 && found[0].starts_with("T006 both.glsl:8:"), "{found:?}");
        let found = reported(&BRANCHES.replace("t = p.xy;", "t = p.xr;"));
        assert!(found.len() == 1 && found[0].starts_with("T009 both.glsl:4:"), "{found:?}");
        // With a version, which stays in front.
        assert_eq!(reported(&format!("#version 120\n{BRANCHES}")), [""; 0]);
        // A parameter is a uniform there.
        let parameter =
            "#pragma parameter GAIN \"Gain\" 1.0 0.0 2.0 0.1\n#ifdef PARAMETER_UNIFORM\nuniform float GAIN;\n#endif\n";
        let shader = BRANCHES.replace("varying vec2 t;\nuniform", &format!("varying vec2 t;\n{parameter}uniform"));
        assert_eq!(reported(&shader.replace("texture2D(s, t)", "GAIN * texture2D(s, t)")), [""; 0]);
    }

    #[test]
    fn a_file_with_two_versions_holds_two_shaders() {
        let both = |first: &str, between: &str| {
            format!(
                "{first}\n#version 330 core\nlayout(location = 0) in vec3 p;\nout vec3 n;\nvoid main() {{ n = p; gl_Position = vec4(p, 1.0); }}\n{between}\n\
                #version 330 core\nin vec3 n;\nout vec4 c;\nvoid main() {{ c = vec4(n, 1.0); }}\n"
            )
        };
        for (first, between) in [("#vert", "#frag"), ("//BEGIN_VS", "//BEGIN_FS"), ("@vs", "@end\n@fs"), ("", "")] {
            let text = both(first, between);
            assert_eq!(reported(&text), [""; 0], "{text}");
            let found = reported(&text.replace("vec4(n, 1.0)", "vec3(n)"));
            assert!(found.len() == 1 && found[0].starts_with("T003 "), "{text}: {found:?}");
        }
        let branches =
            "#ifdef GL_ES\n#version 300 es\n#else\n#version 330\n#endif\nvoid main() { gl_Position = vec4(1.0); }\n";
        assert!(super::sections(&SourceFile::new("one.glsl", branches)).is_empty());
    }

    #[test]
    fn other_branches_are_one_shader() {
        for text in
            [BRANCHES.replace("VERTEX", "MORPH").replace("FRAGMENT", "SKIN"), format!("#define VERTEX\n{BRANCHES}")]
        {
            let file = SourceFile::new("both.glsl", text);
            assert!(super::sections(&file).is_empty());
        }
    }

    #[test]
    fn titles_and_separators_cut_a_file() {
        let vertex = "attribute vec4 p;\nvoid main() { gl_Position = p; }\n";
        let fragment = "void main() { gl_FragColor = vec4(1.0); }\n";
        let titles = format!("/* Both */\n---VERTEX SHADER------\n{vertex}\n---FRAGMENT SHADER----\n{fragment}");
        let separated = format!("{vertex}\n$$\n{fragment}");
        for text in [titles, separated] {
            assert_eq!(reported(&text), [""; 0]);
            let found = reported(&text.replace("vec4(1.0)", "vec3(1.0)"));
            assert!(found.len() == 1 && found[0].starts_with("T003 "), "{found:?}");
        }
    }

    #[test]
    fn what_a_host_puts_in_the_place_of_a_line_is_no_error() {
        let text =
            "$HEADER$\nuniform vec2 size;\nvoid main() { gl_FragColor = frag_color * texture2D(texture0, size); }\n";
        let reported = |text: &str| {
            let found = run(&[Input::new(SourceFile::new("default.fs", text))]);
            found.iter().map(|d| format!("{} {}", d.code, d.file.locate(d.span.start))).collect::<Vec<_>>()
        };
        assert_eq!(reported(text), [""; 0]);
        assert_eq!(reported(&text.replace("size);", "size.xs);")), ["T009 default.fs:3:68"]);
        let broken = reported(&text.replace("vec2 size;", "vec2 size"));
        assert!(broken.len() == 1 && broken[0].starts_with("E001 default.fs:"), "{broken:?}");
        let half = SourceFile::new("default.fs", text.replace("$HEADER$", "$HEADER"));
        assert!(super::template(&half).is_none(), "not a whole line");
    }

    #[test]
    fn they_are_linked() {
        let apart = BOTH.replace("in vec3 n;", "in vec3 normal;").replace("vec4(n, 1.0)", "vec4(normal, 1.0)");
        let found = reported(&apart);
        assert!(found.iter().any(|f| f.starts_with("I001")), "{found:?}");
    }
}
