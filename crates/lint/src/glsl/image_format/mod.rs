//! T019: an image without a format, or a format where no image is.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use base::text::Span;
use reading::ShaderFile;
use syntax::Profile;
use syntax::ast::{QualifierKind, Qualifiers};
use syntax::interface::Variable;
use syntax::types::{OpaqueKind, Type};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("T019"),
    name: "image-format",
    severity: Severity::Error,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Shader(check),
};

/// Formats of images (GLSL 4.60, 4.4.6.2), and sizes that stand for them (`GL_EXT_shader_image_load_store`).
const FORMATS: [&str; 44] = [
    "size1x8",
    "size1x16",
    "size1x32",
    "size2x32",
    "size4x32",
    "rgba32f",
    "rgba16f",
    "rg32f",
    "rg16f",
    "r11f_g11f_b10f",
    "r32f",
    "r16f",
    "rgba16",
    "rgb10_a2",
    "rgba8",
    "rg16",
    "rg8",
    "r16",
    "r8",
    "rgba16_snorm",
    "rgba8_snorm",
    "rg16_snorm",
    "rg8_snorm",
    "r16_snorm",
    "r8_snorm",
    "rgba32i",
    "rgba16i",
    "rgba8i",
    "rg32i",
    "rg16i",
    "rg8i",
    "r32i",
    "r16i",
    "r8i",
    "rgba32ui",
    "rgba16ui",
    "rgb10_a2ui",
    "rgba8ui",
    "rg32ui",
    "rg16ui",
    "rg8ui",
    "r32ui",
    "r16ui",
    "r8ui",
];

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    if !file.is_sound() {
        return;
    }
    let formatted =
        shader.extensions().iter().any(|e| ["GL_EXT_shader_image_load_formatted", "all"].contains(&e.name.as_str()));
    for variable in &shader.interface().uniforms {
        let mut ty = &variable.ty;
        while let Type::Array(element, _) = ty {
            ty = element;
        }
        let image = matches!(ty, Type::Opaque(o) if matches!(o.kind, OpaqueKind::Image));
        match (image, format(&variable.qualifiers)) {
            (false, Some((name, place))) => {
                let (ty, variable) = (ty.to_string(), &variable.name);
                findings.push(
                    findings
                        .at(
                            &file.file,
                            place,
                            message!(
                                "`{name}` is a format of images, and `{variable}` is `{ty}`",
                                "`{name}` は画像の形式ですが、`{variable}` は `{ty}` です"
                            ),
                        )
                        .with_label(message!("not allowed here", "ここには書けません"))
                        .with_why(message!(
                            "only images have a format in the shader; a sampler takes that of its texture",
                            "シェーダで形式を持つのは画像だけです。サンプラの形式はテクスチャのものです"
                        ))
                        .with_help(message!(
                            "leave `{name}` out, or declare an image",
                            "`{name}` を消すか、画像として宣言してください"
                        )),
                );
            }
            // Without one an image can only be written to. GLSL ES wants it even then.
            (true, None) if !formatted && (!is_written_only(variable) || shader.version().profile == Profile::Es) => {
                let name = &variable.name;
                findings.push(
                    findings
                        .at(
                            &file.file,
                            variable.name_span,
                            message!("the image `{name}` has no format", "画像 `{name}` に形式がありません"),
                        )
                        .with_label(message!("which texels?", "どの形式の画素？"))
                        .with_why(message!(
                            "an image that is not `writeonly` needs a format: reading converts from it",
                            "`writeonly` でない画像には形式が要ります。読み出しはその形式から変換します"
                        ))
                        .with_help(message!(
                            "write `layout(rgba8)` or the format that the host binds, or `writeonly`",
                            "`layout(rgba8)` のようにホストが結び付ける形式を書くか、`writeonly` と書いてください"
                        )),
                );
            }
            _ => {}
        }
    }
}

fn format(qualifiers: &Qualifiers) -> Option<(&'static str, Span)> {
    // Names of layouts are read in any case, up to GLSL 4.60.
    let as_written = |f: &str| [f.to_owned(), f.to_uppercase()].iter().find_map(|f| qualifiers.layout_entry(f));
    FORMATS.iter().find_map(|f| as_written(f).map(|e| (*f, e.key.span)))
}

fn is_written_only(variable: &Variable) -> bool {
    use syntax::ast::MemoryQualifier;
    variable.qualifiers.list.iter().any(|q| matches!(q.kind, QualifierKind::Memory(MemoryQualifier::WriteOnly)))
}

#[cfg(test)]
mod tests {
    use super::super::testing::messages;

    #[test]
    fn images_have_formats_and_samplers_have_none() {
        let reported = |declared: &str, used: &str| {
            let text = format!(
                "#version 430\nlayout(local_size_x = 1) in;\n{declared}\nbuffer B {{ vec4 v; }};\nvoid main() {{ {used}; }}\n"
            );
            messages("T019", "a.comp", &text)
        };
        let read = "v = imageLoad(i, ivec2(0))";
        assert_eq!(reported("uniform image2D i;", read), ["the image `i` has no format"]);
        assert_eq!(reported("layout(rgba8) uniform image2D i;", read), [""; 0]);
        assert_eq!(reported("layout(RGBA8) uniform image2D i;", read), [""; 0]);
        assert_eq!(reported("writeonly uniform image2D i;", "imageStore(i, ivec2(0), v)"), [""; 0]);
        let sampled = "v = texture(s, vec2(0.0))";
        assert_eq!(
            reported("layout(rgba8) uniform sampler2D s;", sampled),
            ["`rgba8` is a format of images, and `s` is `sampler2D`"]
        );
        assert_eq!(reported("layout(binding = 0) uniform sampler2D s;", sampled), [""; 0]);
    }
}
