//! The stage of a shader: by the name of its file, or by what its text uses.

use super::lexer::{Lex, lex};

/// Pipeline stage of a shader.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Stage {
    /// Vertex shader.
    Vertex,
    /// Tessellation control shader.
    TessControl,
    /// Tessellation evaluation shader.
    TessEvaluation,
    /// Geometry shader.
    Geometry,
    /// Fragment shader.
    Fragment,
    /// Compute shader.
    Compute,
    /// Functions without `main`, to be put before a shader.
    Library,
}

impl Stage {
    /// The stage that a file name says: by its last extension, or the one before `.glsl`
    /// (`a.vert.glsl`). A bare `.glsl` is a library.
    pub fn from_path(name: &str) -> Option<Self> {
        let file = name.rsplit(['/', '\\']).next().unwrap_or(name);
        let mut parts = file.rsplit('.');
        let last = parts.next()?;
        let before = parts.next()?;
        if last.eq_ignore_ascii_case("glsl") {
            // The first part of the name is no extension: `vs.glsl` is a library called `vs`. The whole
            // word for a stage is clear: `vertex.glsl`.
            let whole = ["vertex", "geometry", "fragment"].iter().any(|w| before.eq_ignore_ascii_case(w));
            let stage = if parts.next().is_some() || whole { of_extension(before) } else { None };
            return Some(stage.unwrap_or(Self::Library));
        }
        of_extension(last)
    }

    /// The stage of a text that has `main`, where the extension of its file says none: what only one stage can use
    /// comes first, then a word of the file's name (`skin_vs.glsl`, `TubeFrag.glsl`, `VertexShader.txt`), then what
    /// one stage usually uses. None for a text without `main`, and for one that uses what two stages have: it holds
    /// both.
    pub fn of_text(name: &str, text: &str) -> Option<Self> {
        let pieces = lex(text).pieces;
        let words: Vec<&str> =
            pieces.iter().filter(|p| p.lex == Lex::Word).map(|p| &text[p.span.start..p.span.end]).collect();
        if !words.contains(&"main") {
            return None;
        }
        let uses = |all: &[&str]| words.iter().any(|word| all.contains(word));
        let certain: Vec<Self> = ONLY.iter().filter(|(_, all)| uses(all)).map(|(stage, _)| *stage).collect();
        match certain[..] {
            [stage] => return Some(stage),
            [] => {}
            // An evaluation shader may read the levels that the control shader sets.
            [Self::TessControl, Self::TessEvaluation] => return Some(Self::TessEvaluation),
            _ => return None,
        }
        let mut usual = USUAL.iter().filter(|(_, all)| uses(all)).map(|(stage, _)| *stage);
        of_words(name).or_else(|| usual.next().filter(|_| usual.next().is_none()))
    }

    /// `vertex`, `geometry`, …
    pub fn name(self) -> &'static str {
        match self {
            Self::Vertex => "vertex",
            Self::TessControl => "tessellation control",
            Self::TessEvaluation => "tessellation evaluation",
            Self::Geometry => "geometry",
            Self::Fragment => "fragment",
            Self::Compute => "compute",
            Self::Library => "library",
        }
    }
}

/// Names that one stage alone has.
const ONLY: [(Stage, &[&str]); 6] = [
    (Stage::Vertex, &["attribute", "ftransform", "gl_VertexID", "gl_VertexIndex", "gl_Vertex", "gl_MultiTexCoord0"]),
    (Stage::TessControl, &["gl_TessLevelOuter"]),
    (Stage::TessEvaluation, &["gl_TessCoord"]),
    (Stage::Geometry, &["EmitVertex", "EndPrimitive", "max_vertices", "gl_PrimitiveIDIn"]),
    (
        Stage::Fragment,
        &["gl_FragColor", "gl_FragData", "gl_FragCoord", "gl_FragDepth", "gl_FrontFacing", "gl_PointCoord", "discard"],
    ),
    (Stage::Compute, &["local_size_x", "gl_GlobalInvocationID", "gl_LocalInvocationID", "gl_WorkGroupID"]),
];

/// Names that one stage has most of the time.
const USUAL: [(Stage, &[&str]); 2] =
    [(Stage::Vertex, &["gl_Position", "gl_InstanceID"]), (Stage::Fragment, &["dFdx", "dFdy", "fwidth"])];

/// The stage that an extension says.
fn of_extension(part: &str) -> Option<Stage> {
    Some(match part.to_ascii_lowercase().as_str() {
        "vert" | "vs" | "vsh" | "vp" | "vertex" | "vertexshader" | "vshader" | "glslv" => Stage::Vertex,
        "tesc" | "tcs" | "cont" => Stage::TessControl,
        "tese" | "tes" | "eval" => Stage::TessEvaluation,
        "geom" | "gs" | "gsh" | "geo" | "geometry" | "geometryshader" | "gshader" | "glslg" => Stage::Geometry,
        "frag" | "fs" | "fsh" | "fp" | "fragment" | "fragmentshader" | "fshader" | "glslf" => Stage::Fragment,
        "comp" | "cs" | "compute" => Stage::Compute,
        _ => return None,
    })
}

/// The stage that a word of a file's name says: the last word, or the first one.
fn of_words(name: &str) -> Option<Stage> {
    let file = name.rsplit(['/', '\\']).next().unwrap_or(name);
    let stem = file.split('.').next().unwrap_or(file);
    let words: Vec<String> = words(stem).filter(|w| !matches!(&**w, "shader" | "program" | "source" | "src")).collect();
    let of = |word: &String| {
        Some(match word.as_str() {
            "frg" | "pixel" | "ps" => Stage::Fragment,
            "vtx" | "vrt" => Stage::Vertex,
            // Words of other trades.
            "cont" | "eval" | "vp" | "fp" | "geo" => return None,
            word => of_extension(word)?,
        })
    };
    words.last().and_then(of).or_else(|| words.first().and_then(of))
}

/// The words of a name in lower case: `tubeFrag_v2` has `tube`, `frag` and `v2`; `modelFS` has `model` and `fs`.
fn words(stem: &str) -> impl Iterator<Item = String> {
    let mut all: Vec<String> = vec![String::new()];
    let mut before = ' ';
    for c in stem.chars() {
        if !c.is_alphanumeric() || (c.is_uppercase() && !before.is_uppercase()) {
            all.push(String::new());
        }
        if c.is_alphanumeric()
            && let Some(last) = all.last_mut()
        {
            last.extend(c.to_lowercase());
        }
        before = c;
    }
    all.into_iter().filter(|word| !word.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_word_of_the_name_says_the_stage() {
        for (name, stage) in [
            ("a/test_vs.glsl", Some(Stage::Vertex)),
            ("TubeFrag.glsl", Some(Stage::Fragment)),
            ("x_fragment.txt", Some(Stage::Fragment)),
            ("modelFS.glsl", Some(Stage::Fragment)),
            ("GrassVertex.glsl", Some(Stage::Vertex)),
            ("vert_sky.glsl", Some(Stage::Vertex)),
            ("FragmentShader.glsl", Some(Stage::Fragment)),
            ("divert.glsl", None),
            ("canvas.glsl", None),
            ("offs.glsl", None),
        ] {
            assert_eq!(Stage::of_text(name, "void main() {}"), stage, "{name}");
        }
        assert_eq!(Stage::of_text("noise_vs.glsl", "float f() { return 1.0; }"), None, "it has no main");
    }

    #[test]
    fn what_one_stage_alone_has_goes_before_the_name() {
        let of = |text: &str| Stage::of_text("blur_vs.glsl", text);
        assert_eq!(of("void main() { gl_FragColor = vec4(1.0); }"), Some(Stage::Fragment));
        assert_eq!(
            of("layout(max_vertices = 3) out; void main() { gl_Position = p; EmitVertex(); }"),
            Some(Stage::Geometry)
        );
        assert_eq!(of("layout(local_size_x = 8) in; void main() {}"), Some(Stage::Compute));
        assert_eq!(of("// gl_FragColor\nvoid main() { }"), Some(Stage::Vertex), "a comment is no use");
        let both = "#ifdef V\nattribute vec3 p; void main() {}\n#else\nvoid main() { gl_FragColor = c; }\n#endif";
        assert_eq!(of(both), None, "two stages in one file");
        let usual = Stage::of_text("blur.glsl", "void main() { gl_Position = p; }");
        assert_eq!(usual, Some(Stage::Vertex));
    }
}
