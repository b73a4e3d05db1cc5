//! I012: an array of samplers, images or blocks whose index differs between the invocations of a draw.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use analysis::forms::Forms;
use base::diagnostic::{Code, Severity, message};
use reading::ShaderFile;
use syntax::ast::ExprKind;
use syntax::interface::Storage;
use syntax::symbols::{Symbol, SymbolKind};
use syntax::types::Type;
use syntax::{Profile, Shader};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("I012"),
    name: "resource-index-not-uniform",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Shader(check),
};

/// Built-in inputs that invocations of one group have for themselves.
const OWN: [&str; 13] = [
    "gl_FragCoord",
    "gl_FrontFacing",
    "gl_GlobalInvocationID",
    "gl_InstanceID",
    "gl_InstanceIndex",
    "gl_InvocationID",
    "gl_LocalInvocationID",
    "gl_LocalInvocationIndex",
    "gl_PointCoord",
    "gl_PrimitiveID",
    "gl_SampleID",
    "gl_VertexID",
    "gl_VertexIndex",
];

/// True for an input that differs from one invocation to the next.
fn is_own(symbol: &Symbol) -> bool {
    match symbol.kind {
        SymbolKind::Global(Storage::In) => true,
        SymbolKind::Builtin => OWN.contains(&symbol.name.as_str()),
        _ => false,
    }
}

/// True for an input that may be the same for all invocations of a draw.
fn may_be_of_a_draw(symbol: &Symbol) -> bool {
    symbol.kind != SymbolKind::Builtin || symbol.name.starts_with("gl_Instance")
}

/// True where the language takes an index that is no constant, and no extension takes any.
fn is_asked_for(shader: &Shader) -> bool {
    let version = shader.version();
    let since = if version.profile == Profile::Es { 320 } else { 400 };
    version.number >= since && !shader.extensions().iter().any(|e| e.name == "GL_NV_gpu_shader5")
}

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    if super::has_errors(shader) || !is_asked_for(shader) {
        return;
    }
    let forms = Forms::new(shader);
    for (_, expr) in shader.arena().iter() {
        let ExprKind::Index { base, index } = expr.kind else { continue };
        let Type::Array(element, _) = shader.type_of(base) else { continue };
        let is_block = || {
            let symbol = shader.symbol_of(base).map(|id| shader.symbol(id));
            symbol.is_some_and(|s| match s.kind {
                SymbolKind::BlockInstance(block) => {
                    let storage = shader.interface().blocks.get(block).map(|block| block.storage);
                    matches!(storage, Some(Storage::Uniform | Storage::Buffer))
                }
                _ => false,
            })
        };
        if !(matches!(**element, Type::Opaque(_)) || is_block()) || is_marked(file, expr.span) {
            continue;
        }
        let own = forms.symbols(index).into_iter().map(|id| shader.symbol(id)).find(|symbol| is_own(symbol));
        let Some(own) = own.filter(|_| !expr.from_macro) else { continue };
        let (array, name) = (shader.text_of(base), &own.name);
        // An engine may give each draw one value of an input, and one instance.
        let level = if may_be_of_a_draw(own) { Level::Strict } else { Level::Default };
        findings.push_at(
            level,
            findings
                .at(
                    &file.file,
                    shader.expr(index).span,
                    message!(
                        "the index of `{array}` depends on `{name}`, which differs within a draw",
                        "`{array}` の添字は、描画の中で異なる `{name}` に依存します"
                    ),
                )
                .with_label(message!("not dynamically uniform", "動的に一様ではありません"))
                .with_why(message!(
                    "devices read one element for a group of invocations unless they are told otherwise",
                    "装置は、指定がなければインベケーションの組ごとに一つの要素を読みます"
                ))
                .with_help(message!(
                    "write `nonuniformEXT(…)` around the index (GL_EXT_nonuniform_qualifier), or take an array texture or one block with an array",
                    "添字を `nonuniformEXT(…)` で囲むか（GL_EXT_nonuniform_qualifier）、配列テクスチャ、または配列を持つ一つのブロックを使ってください"
                )),
        );
    }
}

/// True where the author says that the index is not uniform: around it, or around the element.
fn is_marked(file: &ShaderFile, span: base::text::Span) -> bool {
    let line = file.file.line_at(span.start);
    line.contains("nonuniformEXT")
}

#[cfg(test)]
mod tests {
    use super::super::testing::{default_count, strict_count};
    use super::RULE;

    fn told(declared: &str, read: &str) -> usize {
        levels(declared, read).0
    }

    /// How many findings there are at the strict level and at the default one.
    fn levels(declared: &str, read: &str) -> (usize, usize) {
        let text = format!(
            "#version 450\n#extension GL_EXT_nonuniform_qualifier : enable\nlayout(location = 0) flat in int id;\n\
             layout(location = 1) in vec2 uv;\nlayout(location = 0) out vec4 c;\nlayout(push_constant) uniform P {{ int at; }} p;\n\
             {declared}\nvoid main() {{\n  int k = id + 1;\n  {read}\n}}\n"
        );
        (strict_count(RULE.code, "a.frag", &text), default_count(RULE.code, "a.frag", &text))
    }

    #[test]
    fn what_may_be_one_value_for_a_draw_is_left_to_the_strict_level() {
        let samplers = "layout(set = 0, binding = 0) uniform sampler2D maps[8];";
        assert_eq!(levels(samplers, "c = texture(maps[id], uv);"), (1, 0));
        assert_eq!(levels(samplers, "c = texture(maps[int(gl_FragCoord.x) % 8], uv);"), (1, 1));
    }

    #[test]
    fn what_a_stage_gives_for_each_vertex_is_no_resource() {
        let text = "#version 450\nlayout(vertices = 3) out;\nlayout(location = 0) out S { vec3 h; } to[];\nvoid main() {\n  \
            to[gl_InvocationID].h = vec3(1.0);\n  gl_out[gl_InvocationID].gl_Position = gl_in[gl_InvocationID].gl_Position;\n}\n";
        assert_eq!(strict_count(RULE.code, "a.tesc", text), 0);
    }

    #[test]
    fn an_index_that_differs_within_a_draw_is_reported() {
        let samplers = "layout(set = 0, binding = 0) uniform sampler2D maps[8];";
        let block = "layout(set = 0, binding = 0) uniform Light { vec4 color; } lights[4];";
        for (declared, read, times) in [
            (samplers, "c = texture(maps[id], uv);", 1),
            (samplers, "c = texture(maps[k], uv);", 1),
            (samplers, "c = texture(maps[int(gl_FragCoord.x) % 8], uv);", 1),
            (block, "c = lights[id].color;", 1),
            (samplers, "c = texture(maps[nonuniformEXT(id)], uv);", 0),
            (samplers, "c = texture(maps[p.at], uv);", 0),
            (samplers, "c = texture(maps[3], uv);", 0),
            (block, "c = vec4(0.0); for (int i = 0; i < 4; i++) if (i == id) c = lights[i].color;", 0),
            ("layout(set = 0, binding = 0) uniform Light { vec4 color[4]; } light;", "c = light.color[id];", 0),
        ] {
            assert_eq!(told(declared, read), times, "{read}");
        }
    }
}
