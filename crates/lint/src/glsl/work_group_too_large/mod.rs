//! K009: a work group of more invocations than implementations take.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use analysis::kernel::kernels;
use base::diagnostic::{Code, Message, Severity, message};
use base::text::Span;
use reading::ShaderFile;
use syntax::{Profile, Shader};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("K009"),
    name: "work-group-too-large",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Any(check),
};

/// Invocations that the devices in use take: OpenGL 4.3 guarantees them (`GL_MAX_COMPUTE_WORK_GROUP_INVOCATIONS`), and
/// hardly any driver for Vulkan, Metal or Direct3D reports more.
const DEVICES: u64 = 1024;

/// Invocations along z that are guaranteed: by OpenGL (`GL_MAX_COMPUTE_WORK_GROUP_SIZE`), Vulkan
/// (`maxComputeWorkGroupSize`) and WebGPU (`maxComputeWorkgroupSizeZ`).
const ALONG_Z: u32 = 64;

/// Invocations that WebGPU guarantees (`maxComputeInvocationsPerWorkgroup`).
const WEBGPU: u64 = 256;

/// Invocations that OpenGL ES 3.1 guarantees (`GL_MAX_COMPUTE_WORK_GROUP_INVOCATIONS`).
const EMBEDDED: u64 = 128;

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    for kernel in kernels(shader) {
        let (Some(size), Some(count)) = (kernel.size, kernel.invocations()) else { continue };
        let Some((level, why)) = limit(shader, size, count) else { continue };
        let [x, y, z] = size;
        let span = place(shader).unwrap_or(shader.function_info(kernel.function).name.span);
        findings.push_at(
            level,
            findings
                .at(
                    &file.file,
                    span,
                    message!(
                        "a work group has {count} invocations here ({x} × {y} × {z})",
                        "ワークグループのインベケーションが {count} 個（{x} × {y} × {z}）あります"
                    ),
                )
                .with_label(message!("the size of a work group", "ワークグループの大きさ"))
                .with_why(why)
                .with_help(message!(
                    "take a smaller group, and more of them",
                    "グループを小さくし、数を増やしてください"
                )),
        );
    }
}

/// The limit that a work group is beyond, and how sure it is that a device refuses it.
fn limit(shader: &Shader, [_, _, z]: [u32; 3], count: u64) -> Option<(Level, Message)> {
    let wgsl = shader.wgsl().is_some();
    Some(if count > DEVICES {
        let why = message!(
            "OpenGL guarantees {DEVICES} invocations, Vulkan 128 and WebGPU {WEBGPU}; devices take {DEVICES}",
            "保証される数は OpenGL で {DEVICES}、Vulkan で 128、WebGPU で {WEBGPU} で、装置の上限は {DEVICES} です"
        );
        (Level::Default, why)
    } else if z > ALONG_Z {
        let why = message!(
            "OpenGL, Vulkan and WebGPU guarantee {ALONG_Z} invocations along z, and not all devices take more",
            "z 方向に保証されるのは OpenGL・Vulkan・WebGPU とも {ALONG_Z} 個で、それ以上を受け付けない装置があります"
        );
        (Level::Strict, why)
    } else if wgsl && count > WEBGPU {
        let why = message!(
            "WebGPU guarantees {WEBGPU} invocations: more need `maxComputeInvocationsPerWorkgroup` of the device",
            "WebGPU が保証するのは {WEBGPU} 個で、それ以上は `maxComputeInvocationsPerWorkgroup` の要求が必要です"
        );
        (Level::Strict, why)
    } else if !wgsl && shader.version().profile == Profile::Es && count > EMBEDDED {
        let why = message!(
            "OpenGL ES guarantees {EMBEDDED} invocations, and some devices take no more",
            "OpenGL ES が保証するのは {EMBEDDED} 個で、それ以上を受け付けない装置があります"
        );
        (Level::Heuristic, why)
    } else {
        return None;
    })
}

/// `layout(local_size_x = …) in` of GLSL.
fn place(shader: &Shader) -> Option<Span> {
    let sized = |key: &str| key.starts_with("local_size_");
    let mut layouts = shader.interface().stage_layouts.iter();
    let layout = layouts
        .find(|l| l.qualifiers.layouts().any(|(entries, _)| entries.iter().any(|entry| sized(&entry.key.name))))?;
    Some(layout.span)
}

#[cfg(test)]
mod tests {
    use super::super::testing::{default_count, found, strict_count};
    use super::RULE;
    use crate::wgsl;

    fn glsl(size: &str) -> [usize; 2] {
        let text = format!("#version 450\nlayout({size}) in;\nvoid main() {{}}\n");
        [default_count(RULE.code, "a.comp", &text), strict_count(RULE.code, "a.comp", &text)]
    }

    #[test]
    fn more_than_devices_take_is_reported() {
        assert_eq!(glsl("local_size_x = 64, local_size_y = 32"), [1, 1]);
        assert_eq!(glsl("local_size_x = 1025"), [1, 1]);
        assert_eq!(glsl("local_size_z = 128"), [0, 1]);
        assert_eq!(glsl("local_size_x = 32, local_size_y = 32"), [0, 0]);
        let special = "#version 450\nlayout(constant_id = 1) const uint N = 48;\nlayout(local_size_x_id = 1, local_size_y_id = 1) in;\n\
            void main() {}\n";
        assert_eq!(found("K009", "a.comp", special).len(), 1);
        assert_eq!(found("K009", "a.comp", &special.replace("48", "16")).len(), 0);
    }

    #[test]
    fn webgpu_guarantees_less() {
        let text = |n: u32| format!("@compute @workgroup_size({n}) fn main() {{}}\n");
        assert_eq!(wgsl::testing::count("K009", &text(512)), 1);
        assert_eq!(wgsl::testing::count("K009", &text(256)), 0);
    }
}
