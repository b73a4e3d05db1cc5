//! The stage of a shader, and how names of files say it.

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
