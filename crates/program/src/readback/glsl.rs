//! GLSL that was written, read by our own front end: naga's reads 4.40 to 4.60 for Vulkan alone, and not all that its
//! writer writes.

use naga::{Binding, Module, ResourceBinding};

use crate::build;
use crate::lower::Role;
use base::diagnostic::Severity;
use base::text::SourceFile;
use syntax::ast::Qualifiers;
use syntax::{Shader, Stage};

/// A binding that nothing looks for: that of a sampler whose image is bound, and of what has neither words nor a name
/// for it.
fn apart(binding: ResourceBinding) -> ResourceBinding {
    ResourceBinding { group: u32::MAX, binding: u32::MAX - binding.binding }
}

/// The module of a text.
pub(crate) fn module(text: &str, role: &Role) -> Result<Module, String> {
    let stage = match role {
        Role::Vertex => Stage::Vertex,
        Role::Fragment => Stage::Fragment,
        Role::Compute | Role::Geometry(_) | Role::Function { .. } => Stage::Compute,
    };
    let file = SourceFile::new("the translation", text);
    let parsed = Shader::parse(&file, stage);
    if let Some(error) = parsed.diagnostics.iter().find(|d| d.severity == Severity::Error) {
        return Err(format!("{}: {}", file.locate(error.span.start), error.message));
    }
    let mut module = build::host(&parsed.shader).map_err(|error| error.to_string())?;
    bindings(&parsed.shader, &mut module);
    locations(&parsed.shader, &mut module);
    Ok(module)
}

/// Buffers and images get the bindings that the text states, or that their names tell where the version has no
/// words for them: `_group_0_binding_3_vs`.
fn bindings(shader: &Shader, module: &mut Module) {
    let interface = shader.interface();
    let written = |qualifiers: &Qualifiers| {
        let value = shader.fold(qualifiers.layout_entry("binding")?.value?)?.as_integer()?;
        u32::try_from(value).ok()
    };
    for (_, variable) in module.global_variables.iter_mut().filter(|(_, v)| v.binding.is_some()) {
        let name = variable.name.clone().unwrap_or_default();
        let block = interface.blocks.iter().find(|b| b.instance.as_ref().unwrap_or(&b.name).name == name);
        let stated = match block {
            Some(block) => written(&block.qualifiers),
            None => interface.uniforms.iter().find(|u| u.name == name).and_then(|u| written(&u.qualifiers)),
        };
        let member = block.and_then(|b| b.members.first()).map_or("", |member| member.name.name.as_str());
        let named = numbers(&name).or_else(|| numbers(member));
        variable.binding = match (stated, named) {
            _ if name.ends_with("_sampler") => variable.binding.map(apart),
            (Some(binding), named) => Some(ResourceBinding { group: named.map_or(0, |(group, _)| group), binding }),
            (None, Some((group, binding))) => Some(ResourceBinding { group, binding }),
            (None, None) => variable.binding.map(apart),
        };
    }
}

/// Group and binding of a name that ends with them and the stage.
fn numbers(name: &str) -> Option<(u32, u32)> {
    let rest = name.strip_prefix("_group_")?;
    let (group, rest) = rest.split_once("_binding_")?;
    let binding = rest.split('_').next()?;
    Some((group.parse().ok()?, binding.parse().ok()?))
}

/// Varyings get the locations that their names tell where the version has no words for them: `_vs2fs_location2`.
fn locations(shader: &Shader, module: &mut Module) {
    let interface = shader.interface();
    let stated = |name: &str| {
        let mut all = interface.inputs.iter().chain(&interface.outputs);
        all.any(|v| v.name == name && v.qualifiers.layout_entry("location").is_some())
    };
    let moved = |name: &Option<String>, binding: &mut Option<Binding>| {
        let name = name.as_deref().unwrap_or_default();
        let reported = name.rsplit_once("_location").and_then(|(_, number)| number.parse().ok());
        if let (Some(Binding::Location { location, .. }), Some(reported), false) = (binding, reported, stated(name)) {
            *location = reported;
        }
    };
    let mut results = Vec::new();
    for point in &mut module.entry_points {
        for argument in &mut point.function.arguments {
            moved(&argument.name, &mut argument.binding);
        }
        results.extend(point.function.result.as_ref().map(|result| result.ty));
    }
    for ty in results {
        let mut changed = module.types[ty].clone();
        if let naga::TypeInner::Struct { members, .. } = &mut changed.inner {
            members.iter_mut().for_each(|member| moved(&member.name, &mut member.binding));
        }
        if changed != module.types[ty] {
            module.types.replace(ty, changed);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::numbers;

    #[test]
    fn a_name_tells_group_and_binding() {
        assert_eq!(numbers("_group_2_binding_13_fs"), Some((2, 13)));
        assert_eq!(numbers("_group_2_binding"), None);
        assert_eq!(numbers("group_2_binding_1"), None);
    }
}
