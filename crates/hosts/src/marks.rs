//! Words that tell the stage of a shader text.

use syntax::Stage;

/// A text that has marks of more than one stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mixed;

/// The stage that the contents say; none when they say nothing.
///
/// # Errors
/// [`Mixed`] for a text that could be several stages, as with `#ifdef VERTEX`.
pub fn stage(text: &str) -> Result<Option<Stage>, Mixed> {
    let code = without_comments(text);
    let has = |words: &[&str]| words.iter().any(|w| has_word(&code, w));
    let geometry = has(&["EmitVertex", "EndPrimitive", "max_vertices", "gl_PrimitiveIDIn"]);
    let compute = has(&["local_size_x", "gl_GlobalInvocationID", "gl_LocalInvocationID"]);
    let control = has(&["gl_out"]) || (has(&["gl_InvocationID"]) && !geometry) || has_layout(&code, "vertices", "out");
    let spaced = ["isolines", "quads", "equal_spacing", "fractional_even_spacing", "fractional_odd_spacing"];
    let evaluation = has(&["gl_TessCoord"]) || spaced.iter().any(|word| has_layout(&code, word, "in"));
    let fragment = has(&[
        "gl_FragColor",
        "gl_FragData",
        "gl_FragCoord",
        "gl_FrontFacing",
        "gl_PointCoord",
        "gl_FragDepth",
        "gl_FragDepthEXT",
        "discard",
    ]);
    // The interface between stages has no locations there.
    let located = code.contains("#version 300 es");
    let fragment = fragment || (located && has_layout(&code, "location", "out"));
    let later = geometry || control || evaluation;
    let vertex = has(&["attribute", "gl_VertexID", "gl_InstanceID", "gl_Vertex", "ftransform"])
        || (has(&["gl_Position"]) && !later && !has(&["gl_in"]))
        || (located && has_layout(&code, "location", "in"));
    let all = [
        (vertex, Stage::Vertex),
        (control, Stage::TessControl),
        (evaluation, Stage::TessEvaluation),
        (geometry, Stage::Geometry),
        (fragment, Stage::Fragment),
        (compute, Stage::Compute),
    ];
    let mut said = all.into_iter().filter(|(is, _)| *is).map(|(_, stage)| stage);
    match (said.next(), said.next()) {
        (_, Some(_)) => Err(Mixed),
        (one, None) => Ok(one),
    }
}

/// True when a layout with this word stands in front of this storage.
fn has_layout(code: &str, word: &str, storage: &str) -> bool {
    code.match_indices("layout").any(|(at, _)| {
        let Some((inside, behind)) = code[at..].split_once(')') else { return false };
        let next = behind.split(|c: char| c.is_whitespace() || c == ';').find(|next| !next.is_empty());
        has_word(inside, word) && next == Some(storage)
    })
}

/// The stage of a shader's file whose ending says none: what its text has, or else a word of its name
/// (`skin_vs.glsl`, `TubeFrag.glsl`). None for a text without `main`, and for one that has marks of two stages.
pub fn stage_of_file(name: &str, text: &str) -> Option<Stage> {
    if !has_main(text) {
        return None;
    }
    let file = name.rsplit('/').next().unwrap_or(name);
    // What has no workgroup is no compute shader, whatever it is called.
    let named = || {
        let words = file.rsplit_once('.').map_or(file, |(name, _)| name);
        Stage::of_words(words).filter(|stage| *stage != Stage::Compute)
    };
    stage(text).ok()?.or_else(named)
}

/// The stage that a path says: by its ending, or for `.glsl` by a word of the name.
pub fn stage_of_path(path: &str) -> Option<Stage> {
    let file = path.rsplit(['/', '\\']).next().unwrap_or(path);
    match Stage::from_path(path)? {
        Stage::Library => Stage::of_words(file.rsplit_once('.').map_or(file, |(name, _)| name)),
        stage => Some(stage),
    }
}

/// True when `word` stands in the text, not as a part of a longer one.
pub fn has_word(text: &str, word: &str) -> bool {
    let part = |c: char| c.is_alphanumeric() || c == '_';
    text.match_indices(word).any(|(at, _)| {
        !text[..at].chars().next_back().is_some_and(part) && !text[at + word.len()..].chars().next().is_some_and(part)
    })
}

/// True when the text defines `main`.
pub fn has_main(text: &str) -> bool {
    text.match_indices("main").any(|(at, _)| {
        text[..at].trim_end().ends_with("void")
            && text[at + 4..].trim_start().starts_with('(')
            && text[at + 4..].contains('{')
    })
}

/// Marks of the entry points of a module in WGSL.
pub const ENTRY_POINTS: [&str; 3] = ["@vertex", "@fragment", "@compute"];

/// True for a module in WGSL with an entry point.
pub fn is_module(text: &str) -> bool {
    ENTRY_POINTS.iter().any(|mark| text.contains(mark)) && syntax::is_wgsl(text)
}

/// True for a part of a shader in GLSL, without comments: it is known by its functions.
pub fn is_part(code: &str) -> bool {
    let types = ["vec2", "vec3", "vec4", "mat2", "mat3", "mat4", "sampler2D"];
    types.iter().any(|word| has_word(code, word)) && defines_function(code)
}

/// True when a line begins with the head of a function of GLSL.
fn defines_function(code: &str) -> bool {
    let types = ["void", "bool", "int", "uint", "float", "vec2", "vec3", "vec4", "mat2", "mat3", "mat4"];
    code.match_indices('{').any(|(at, _)| {
        let head = code[..at].trim_end().rsplit([';', '}', '{', '\n']).next().unwrap_or("").trim();
        let Some((before, arguments)) = head.split_once('(') else { return false };
        let words: Vec<&str> = before.split_whitespace().collect();
        let [ty, name] = words[..] else { return false };
        let named = name.chars().all(|c| c.is_alphanumeric() || c == '_');
        types.contains(&ty) && named && arguments.ends_with(')') && !arguments.contains(['=', '.'])
    })
}

/// The text with a blank for each comment.
pub fn without_comments(text: &str) -> String {
    let mut code = String::new();
    let mut rest = text;
    // From one slash to the next: a search for either mark would read the rest of the text again and again.
    let opens =
        |rest: &str| rest.match_indices('/').map(|(at, _)| at).find(|at| rest[at + 1..].starts_with(['/', '*']));
    while let Some(at) = opens(rest) {
        code.push_str(&rest[..at]);
        let line = rest[at..].starts_with("//");
        let end = if line { "\n" } else { "*/" };
        let Some(length) = rest[at + 2..].find(end) else { return code };
        rest = &rest[at + 2 + length + if line { 0 } else { 2 }..];
        code.push(' ');
    }
    code + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_word_of_a_files_name_tells_the_stage() {
        for (name, expected) in [
            ("a/test_vs.glsl", Some(Stage::Vertex)),
            ("TubeFrag.glsl", Some(Stage::Fragment)),
            ("modelFS.glsl", Some(Stage::Fragment)),
            ("GrassVertex.glsl", Some(Stage::Vertex)),
            ("Grass.Vertex.glsl", Some(Stage::Vertex)),
            ("vert_sky.glsl", Some(Stage::Vertex)),
            ("VertexShader.glsl", Some(Stage::Vertex)),
            ("invert.glsl", None),
            ("VarianceCompute.glsl", None),
            ("canvas.glsl", None),
            ("vs_and_fs.glsl", None),
        ] {
            assert_eq!(stage_of_file(name, "void main() {}"), expected, "{name}");
        }
        assert_eq!(stage_of_file("noise_vs.glsl", "float f() { return 1.0; }"), None, "it has no main");
        let other = stage_of_file("blur_vs.glsl", "void main() { gl_FragColor = vec4(1.0); }");
        assert_eq!(other, Some(Stage::Fragment), "the text goes before the name");
        let both = "#ifdef V\nvoid main() { gl_Position = x; }\n#else\nvoid main() { gl_FragColor = x; }\n#endif";
        assert_eq!(stage_of_file("a_vs.glsl", both), None, "two stages in one file");
    }

    #[test]
    fn contents_tell_the_stage() {
        for (text, expected) in [
            ("void main() { gl_Position = vec4(0.0); }", Ok(Some(Stage::Vertex))),
            ("attribute vec4 a; void main() { gl_Position = a; }", Ok(Some(Stage::Vertex))),
            ("void main() { gl_Position = gl_in[0].gl_Position; EmitVertex(); }", Ok(Some(Stage::Geometry))),
            ("out vec4 c; void main() { c = gl_FragCoord; } // gl_Position", Ok(Some(Stage::Fragment))),
            ("layout(local_size_x = 1) in; void main() { }", Ok(Some(Stage::Compute))),
            ("void main() { gl_Position = gl_TessCoord.xyzz; }", Ok(Some(Stage::TessEvaluation))),
            ("out vec4 c; void main() { c = vec4(1.0); }", Ok(None)),
            ("layout(vertices = 3) out; void main() { gl_TessLevelOuter[0] = 1.0; }", Ok(Some(Stage::TessControl))),
            (
                "layout(quads, cw) in; void main() { gl_Position = gl_in[0].gl_Position; }",
                Ok(Some(Stage::TessEvaluation)),
            ),
            ("layout(points) in; out vec4 vertices; void main() { }", Ok(None)),
            (
                "#version 300 es\nlayout (location = 0) out vec4 c; void main() { c = vec4(1.0); }",
                Ok(Some(Stage::Fragment)),
            ),
            (
                "#version 300 es\nlayout(location = 0) in vec4 p; out vec4 q; void main() { q = p; }",
                Ok(Some(Stage::Vertex)),
            ),
            ("#version 330\nlayout(location = 0) out vec4 c; void main() { c = vec4(1.0); }", Ok(None)),
            (
                "#ifdef V\nvoid main() { gl_Position = x; }\n#else\nvoid main() { gl_FragColor = x; }\n#endif",
                Err(Mixed),
            ),
        ] {
            assert_eq!(stage(text), expected, "{text}");
        }
    }

    #[test]
    fn names_tell_the_stage() {
        for (name, expected) in [
            ("vertexShaderSource", Some(Stage::Vertex)),
            ("vs", Some(Stage::Vertex)),
            ("g_fsSource", Some(Stage::Fragment)),
            ("FS_SOURCE", Some(Stage::Fragment)),
            ("vs2", Some(Stage::Vertex)),
            ("geometryShader", Some(Stage::Geometry)),
            ("source", None),
            ("vertexAndFragment", None),
        ] {
            assert_eq!(Stage::of_name(name), expected, "{name}");
        }
    }

    #[test]
    fn words_are_whole() {
        assert!(has_word("in vec2 a;", "in") && !has_word("int a;", "in"));
        assert!(has_main("void main(void)\n{}") && !has_main("void domain() {}") && !has_main("void main();"));
    }
}
