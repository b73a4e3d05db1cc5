//! The stage of a shader, and how names of files and other words say it.

use super::words::words;

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

/// How a stage is called.
struct Row {
    stage: Stage,
    name: &'static str,
    /// Words for it, which are endings of files as well.
    words: &'static [&'static str],
    /// Further endings of files, which are no words of it anywhere else.
    endings: &'static [&'static str],
    /// Further words, which no file ends in.
    spoken: &'static [&'static str],
    /// What a name contains that says it within a longer word.
    stems: &'static [&'static str],
}

const ROWS: [Row; 6] = [
    Row {
        stage: Stage::Vertex,
        name: "vertex",
        words: &["vertex", "vert", "vs", "vsh"],
        endings: &["vp", "vertexshader", "vshader", "glslv"],
        spoken: &["vtx"],
        stems: &["vert", "vtx"],
    },
    Row {
        stage: Stage::TessControl,
        name: "tessellation control",
        words: &["tesc", "tcs"],
        endings: &["cont"],
        spoken: &["tesscontrol", "tess_control"],
        stems: &["tesscontrol", "tess_control"],
    },
    Row {
        stage: Stage::TessEvaluation,
        name: "tessellation evaluation",
        words: &["tese", "tes"],
        endings: &["eval"],
        spoken: &["tesseval", "tess_eval", "tess_evaluation"],
        stems: &["tesseval", "tess_eval"],
    },
    Row {
        stage: Stage::Geometry,
        name: "geometry",
        words: &["geometry", "geom", "gs", "gsh"],
        endings: &["geo", "geometryshader", "gshader", "glslg"],
        spoken: &[],
        stems: &["geom"],
    },
    Row {
        stage: Stage::Fragment,
        name: "fragment",
        words: &["fragment", "frag", "fs", "fsh"],
        endings: &["fp", "fragmentshader", "fshader", "glslf"],
        spoken: &["pixel", "ps"],
        stems: &["frag", "pixel"],
    },
    Row {
        stage: Stage::Compute,
        name: "compute",
        words: &["compute", "comp", "cs", "csh"],
        endings: &[],
        spoken: &[],
        stems: &["compute"],
    },
];

/// Endings of stages of ray tracing. They are read as libraries: each function is looked at by itself, `main` as well.
const OF_RAYS: [&str; 6] = ["rgen", "rint", "rahit", "rchit", "rmiss", "rcall"];

impl Stage {
    /// The stage that a file name says: by its last extension, or the one before `.glsl`
    /// (`a.vert.glsl`). A bare `.glsl` is a library, and so is a stage of ray tracing.
    pub fn from_path(name: &str) -> Option<Self> {
        let file = name.rsplit(['/', '\\']).next().unwrap_or(name);
        let mut parts = file.rsplit('.');
        let last = parts.next()?;
        let before = parts.next()?;
        if last.eq_ignore_ascii_case("glsl") {
            // The first part of the name is no extension: `vs.glsl` is a library called `vs`. The whole
            // word for a stage is clear: `vertex.glsl`.
            let whole = ["vertex", "geometry", "fragment"].iter().any(|w| before.eq_ignore_ascii_case(w));
            let stage = if parts.next().is_some() || whole { Self::of_extension(before) } else { None };
            return Some(stage.unwrap_or(Self::Library));
        }
        Self::of_extension(last)
    }

    /// `vertex`, `geometry`, …
    pub fn name(self) -> &'static str {
        ROWS.iter().find(|row| row.stage == self).map_or("library", |row| row.name)
    }

    /// The stage that an extension says.
    fn of_extension(part: &str) -> Option<Self> {
        let part = part.to_ascii_lowercase();
        let says = |row: &&Row| row.words.iter().chain(row.endings).any(|w| *w == part);
        let stage = ROWS.iter().find(says).map(|row| row.stage);
        stage.or_else(|| OF_RAYS.contains(&part.as_str()).then_some(Self::Library))
    }

    /// The stage that one word says: `vertex`, `VERT`, `vs`.
    pub fn of_word(word: &str) -> Option<Self> {
        let word = word.to_ascii_lowercase();
        let says = |row: &&Row| row.words.iter().chain(row.spoken).any(|w| *w == word);
        ROWS.iter().find(says).map(|row| row.stage)
    }

    /// The stage that the words of a text say, when they say one.
    pub fn of_words(text: &str) -> Option<Self> {
        one(words(text).iter().filter_map(|word| Self::of_word(word)))
    }

    /// The stage that the name of a variable says, within longer words as well: `myVertexSource`, `fragcode`, `fs2`.
    pub fn of_name(name: &str) -> Option<Self> {
        let lower = name.to_ascii_lowercase();
        let words = words(name);
        let says = |row: &&Row| {
            row.stems.iter().any(|stem| lower.contains(stem))
                || words.iter().any(|word| row.words.iter().chain(row.spoken).any(|w| w == word))
        };
        one(ROWS.iter().filter(says).map(|row| row.stage))
    }
}

/// What all agree on.
fn one(mut said: impl Iterator<Item = Stage>) -> Option<Stage> {
    let first = said.next()?;
    said.all(|stage| stage == first).then_some(first)
}
