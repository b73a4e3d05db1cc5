//! I002: an input whose type is not that of its output.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use reading::Project;

use syntax::Shader;
use syntax::types::Type;

use reading::program::Program;
use reading::program::link::{agree, input_type, is_built_in, output_type, producer};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("I002"),
    name: "interface-type-mismatch",
    severity: Severity::Error,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Program(check),
};

fn check(program: &Program<'_>, _project: &Project, findings: &mut Findings<'_>) {
    for (from, to) in program.links() {
        for input in to.shader.interface().inputs.iter().filter(|v| !is_built_in(&v.name)) {
            let Some(output) = producer(from, to, input) else { continue };
            let wanted = output_type(from, &output.ty, &output.qualifiers);
            let (Some(wanted), Some(got)) = (wanted, input_type(to, &input.ty, &input.qualifiers)) else { continue };
            if agree(wanted, got) || (is_vulkan(&from.shader) || is_vulkan(&to.shader)) && drops_components(wanted, got)
            {
                continue;
            }
            let (name, had, has, place) = (&input.name, output.ty.to_string(), input.ty.to_string(), from.file.name());
            findings.push(
                findings
                    .at(
                        &to.file,
                        input.name_span,
                        message!(
                            "`{name}` is `{has}` here, and `{had}` in the stage before",
                            "`{name}` はここでは `{has}`、前のステージでは `{had}` です"
                        ),
                    )
                    .with_label(message!("read as `{has}`", "`{has}` として読まれます"))
                    .with_related(
                        &from.file,
                        output.name_span,
                        message!("written as `{had}` here", "ここで `{had}` として書かれます"),
                    )
                    .with_why(message!(
                        "an output and the input that it goes to have to be of one type; the program does not link",
                        "出力とそれを受け取る入力は同じ型でなければならず、プログラムはリンクできません"
                    ))
                    .with_help(message!(
                        "declare `{name}` with the same type here and in {place}",
                        "`{name}` をここと {place} で同じ型に宣言してください"
                    )),
            );
        }
    }
}

fn is_vulkan(shader: &Shader) -> bool {
    shader.extensions().iter().any(|extension| extension.name == "GL_KHR_vulkan_glsl")
}

/// True for a vector that a shorter one takes the first components of, as Vulkan 1.3 has it: section "Interface Matching",
/// with `maintenance4`.
fn drops_components(output: &Type, input: &Type) -> bool {
    let vector = |ty: &Type| ty.is_scalar() || matches!(ty, Type::Vector(..));
    vector(output) && vector(input) && output.scalar() == input.scalar() && output.components() > input.components()
}
