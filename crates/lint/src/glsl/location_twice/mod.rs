//! I010: two variables of a stage at one location.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use reading::ShaderFile;
use syntax::interface::{Storage, Variable};
use syntax::types::{ArraySize, ScalarType, Type};
use syntax::{Const, Shader, Stage};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("I010"),
    name: "location-twice",
    severity: Severity::Error,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Shader(check),
};

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    if !file.is_sound() {
        return;
    }
    let interface = shader.interface();
    for variables in [&interface.inputs, &interface.outputs, &interface.uniforms] {
        let placed: Vec<(&Variable, i64, i64)> = variables.iter().filter_map(|v| place(shader, v)).collect();
        for (at, (second, start, _)) in placed.iter().enumerate() {
            let taken = |(_, first, end): &&(&Variable, i64, i64)| (first..end).contains(&start);
            let Some((first, ..)) = placed[..at].iter().find(taken) else { continue };
            let (a, b) = (&first.name, &second.name);
            findings.push(
                findings
                    .at(
                        &file.file,
                        second.name_span,
                        message!("`{b}` has the location {start} of `{a}`", "`{b}` の location {start} は `{a}` のものです"),
                    )
                    .with_label(message!("the same location", "同じ location"))
                    .with_related(&file.file, first.name_span, message!("`{a}` is here", "`{a}` はここです"))
                    .with_why(message!(
                        "two variables of one interface cannot share a location: the program does not link, or one gets \
                         the values of the other",
                        "一つのインタフェースの二つの変数は location を共有できません。リンクできないか、一方が他方の値になります"
                    ))
                    .with_help(message!("give `{b}` another location", "`{b}` に別の location を付けてください")),
            );
        }
    }
}

/// The locations of a variable that shares none by design, and is used: attributes may have one in common when no
/// path reads both.
fn place<'v>(shader: &Shader, variable: &'v Variable) -> Option<(&'v Variable, i64, i64)> {
    let entry = |key: &str| variable.qualifiers.layout_entry(key);
    let location = entry("location")?.value.and_then(|e| shader.fold(e)).and_then(Const::as_integer)?;
    let shares = ["component", "index"].iter().any(|key| entry(key).is_some());
    // The outer array of a stage that takes several vertices is no part of the interface.
    let whole = match shader.stage() {
        Stage::Vertex => true,
        Stage::Fragment => variable.storage != Storage::In || !matches!(variable.ty, Type::Array(..)),
        _ => variable.storage == Storage::Uniform,
    };
    let size = if whole { size(&variable.ty, variable.storage)? } else { 1 };
    let used = shader.uses_of(variable.symbol).next().is_some();
    (used && !shares).then_some((variable, location, location + size))
}

/// How many locations a type takes.
fn size(ty: &Type, storage: Storage) -> Option<i64> {
    Some(match ty {
        Type::Array(element, ArraySize::Known(n)) => size(element, storage)? * i64::from(*n),
        Type::Struct(inner) => inner.fields.iter().map(|f| size(&f.ty, storage)).sum::<Option<i64>>()?,
        Type::Matrix(_, columns, _) if storage != Storage::Uniform => i64::from(*columns),
        Type::Vector(ScalarType::Double, n) if *n > 2 && storage != Storage::Uniform => return None,
        Type::Scalar(_) | Type::Vector(..) | Type::Matrix(..) | Type::Opaque(_) => 1,
        Type::Array(..) | Type::Error | Type::Void => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::super::testing::messages;

    #[test]
    fn a_location_belongs_to_one_variable() {
        let vertex = |declared: &str, used: &str| {
            let text = format!("#version 450 core\n{declared}\nvoid main() {{ gl_Position = {used}; }}\n");
            messages("I010", "a.vert", &text)
        };
        let told = ["`b` has the location 0 of `a`"];
        let two = "layout(location = 0) in vec4 a;\nlayout(location = 0) in vec4 b;";
        assert_eq!(vertex(two, "a + b"), told);
        assert_eq!(vertex(two, "a"), [""; 0], "the other is not read");
        let matrix = "layout(location = 2) in mat4 m;\nlayout(location = 5) in vec4 b;";
        assert_eq!(vertex(matrix, "m * b"), ["`b` has the location 5 of `m`"]);
        let uniforms = "layout(location = 0) uniform mat4 m;\nlayout(location = 1) uniform vec4 b;";
        assert_eq!(vertex(uniforms, "m * b"), [""; 0]);
        let parts = "layout(location = 0, component = 0) in vec2 a;\nlayout(location = 0, component = 2) in vec2 b;";
        assert_eq!(vertex(parts, "vec4(a, b)"), [""; 0]);
        let other = "layout(location = 0) in vec4 a;\nlayout(location = 0) out vec4 b;";
        assert_eq!(vertex(other, "b = a"), [""; 0], "inputs and outputs are two interfaces");
    }

    #[test]
    fn outputs_of_a_fragment_stage_count_too() {
        let text = "#version 330 core\nlayout(location = 0) out vec4 a;\nlayout(location = 0) out vec4 b;\nvoid main() { a = vec4(1.0); b = a; }\n";
        assert_eq!(messages("I010", "a.frag", text), ["`b` has the location 0 of `a`"]);
        let dual = text.replace("location = 0) out vec4 b", "location = 0, index = 1) out vec4 b");
        assert_eq!(messages("I010", "a.frag", &dual), [""; 0]);
    }
}
