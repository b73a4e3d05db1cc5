//! GLSL for Vulkan, which has no directive of its own: known by the words that only it has.

use super::{Extension, Token, TokenKind, TokenPlace, Version};
use base::text::{SourceFile, Span};

/// Words that OpenGL does not have, and that nobody uses as names.
const WORDS: &[&str] = &[
    "constant_id",
    "gl_InstanceIndex",
    "gl_VertexIndex",
    "input_attachment_index",
    "local_size_x_id",
    "local_size_y_id",
    "local_size_z_id",
    "push_constant",
    "subpassInput",
    "subpassInputMS",
    "subpassLoad",
];

/// The extension that stands for GLSL for Vulkan (`GL_KHR_vulkan_glsl`), when the text uses it.
pub(super) fn vulkan(file: &SourceFile, tokens: &[Token], version: &Version) -> Option<Extension> {
    if version.number < 140 {
        return None;
    }
    let active: Vec<(TokenKind, Span)> =
        tokens.iter().filter(|t| t.place == TokenPlace::Text).map(|t| (t.kind, t.span)).collect();
    let word = |at: usize| active.get(at).filter(|t| t.0 == TokenKind::Word).map(|t| file.slice(t.1));
    let sign = |at: usize| active.get(at).filter(|t| t.0 == TokenKind::Punctuation).map(|t| file.slice(t.1));
    // The body of a macro is no text yet; what stands there in a layout is nothing else.
    let in_macro = || {
        let macros = tokens.windows(3).filter(|three| three[1].place == TokenPlace::Directive);
        let text = |token: &Token| file.slice(token.span);
        let mut sets = macros.filter(|three| text(&three[1]) == "set" && text(&three[2]) == "=");
        sets.find(|three| matches!(text(&three[0]), "(" | ",")).map(|three| three[1].span.start)
    };
    let extension = |start: usize| Extension {
        name: "GL_KHR_vulkan_glsl".into(),
        behavior: "enable".into(),
        span: Span::at(start),
    };
    let found = (0..active.len()).find(|&at| match word(at) {
        Some(w) if WORDS.contains(&w) => true,
        // `layout(set = 0, …)`
        Some("set") => matches!(sign(at.wrapping_sub(1)), Some("(" | ",")) && sign(at + 1) == Some("="),
        // A texture or a sampler alone.
        Some("uniform") => {
            let ty = if matches!(word(at + 1), Some("highp" | "mediump" | "lowp")) { at + 2 } else { at + 1 };
            word(ty).is_some_and(is_separate) && word(ty + 1).is_some()
        }
        _ => false,
    });
    found.map(|found| active[found].1.start).or_else(in_macro).map(extension)
}

/// Names of the types `texture2D`, `utextureCube`, `sampler` and the like.
fn is_separate(ty: &str) -> bool {
    let texture = ty.strip_prefix(['i', 'u']).unwrap_or(ty).strip_prefix("texture");
    let shape = |rest: &str| ["1D", "2D", "3D", "Cube", "Buffer"].iter().any(|s| rest.starts_with(s));
    matches!(ty, "sampler" | "samplerShadow") || texture.is_some_and(shape)
}

#[cfg(test)]
mod tests {
    use crate::{Shader, Stage};
    use base::text::SourceFile;

    fn errors(stage: Stage, text: &str) -> Vec<String> {
        let parsed = Shader::parse(&SourceFile::new("a", text), stage);
        parsed.diagnostics.iter().map(|d| format!("{} {}", d.code, d.message)).collect()
    }

    #[test]
    fn shaders_for_vulkan_are_no_error() {
        let vertex = "#version 450\nlayout(location = 0) in vec3 pos;\n\
            layout(set = 0, binding = 0) uniform Camera { mat4 m; } camera;\n\
            layout(push_constant) uniform Push { vec4 tint; } push;\n\
            layout(constant_id = 3) const int COUNT = 4;\nlayout(location = 0) out vec4 c;\n\
            void main() { gl_Position = camera.m * vec4(pos, float(gl_VertexIndex)); c = push.tint * COUNT; }\n";
        assert_eq!(errors(Stage::Vertex, vertex), [""; 0]);
        let fragment = "#version 450\nlayout(binding = 1) uniform texture2D t;\nlayout(binding = 2) uniform sampler s;\n\
            layout(input_attachment_index = 0, binding = 3) uniform subpassInput depth;\n\
            layout(location = 0) in vec4 c;\nlayout(location = 0) out vec4 o;\n\
            void main() { o = texture(sampler2D(t, s), c.xy) + subpassLoad(depth); }\n";
        assert_eq!(errors(Stage::Fragment, fragment), [""; 0]);
        // Macros may hold the layouts.
        let hidden = "#version 450\n#define BLOCK(S, N, NAME) layout(set = S, binding = N) uniform U##N { vec4 v; } NAME;\n\
            BLOCK(0, 1, u)\nvoid main() { gl_Position = u.v; }\n";
        assert_eq!(errors(Stage::Vertex, hidden), [""; 0]);
        // The size of a workgroup alone tells as well.
        let compute = "#version 450\nlayout(local_size_x_id = 0) in;\nlayout(binding = 0) buffer B { float b[]; };\n\
            void main() { b[gl_GlobalInvocationID.x] = 0.0; }\n";
        assert_eq!(errors(Stage::Compute, compute), [""; 0]);
    }

    #[test]
    fn textures_without_a_sampler_have_texels() {
        let text = |line: &str| {
            format!(
                "#version 450\nlayout(binding = 1) uniform itexture3D t;\nlayout(binding = 2) uniform sampler s;\n\
                 layout(location = 0) out vec4 o;\nvoid main() {{ o = vec4(0); {line} }}\n"
            )
        };
        assert_eq!(errors(Stage::Fragment, &text("ivec4 a = texelFetch(t, ivec3(0), 0);")), [""; 0]);
        assert_eq!(errors(Stage::Fragment, &text("ivec4 a = texture(isampler3D(t, s), vec3(0));")), [""; 0]);
        assert_eq!(errors(Stage::Fragment, &text("ivec3 a = texelFetch(t, ivec3(0), 0);")).len(), 1);
        assert_eq!(errors(Stage::Fragment, &text("ivec4 a = texelFetch(t, ivec2(0), 0);")).len(), 1);
    }

    #[test]
    fn opengl_keeps_its_rules() {
        let samplers = "#version 450\nuniform texture2D;\nvoid main() {}\n";
        assert!(!errors(Stage::Vertex, samplers).is_empty());
        let set = "#version 330\nuniform int set;\nvoid main() { int a = set; vec3 v = vec4(1.0); }\n";
        assert_eq!(errors(Stage::Vertex, set).len(), 1);
        let constructed = "#version 330\nuniform sampler2D s;\nvoid main() { texture(sampler2D(s, s), vec2(0)); }\n";
        assert!(!errors(Stage::Vertex, constructed).is_empty());
        // What is wrong in any dialect is still told.
        let wrong = "#version 450\nlayout(set = 0, binding = 0) uniform U { vec3 a; };\n\
            void main() { gl_Position = vec4(a); vec2 b = a; }\n";
        assert_eq!(errors(Stage::Vertex, wrong).len(), 2, "{:?}", errors(Stage::Vertex, wrong));
    }
}
