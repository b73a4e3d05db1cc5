//! A function in WGSL that takes textures or samplers, without them: another function is made up that gives it variables of
//! the module, and takes the rest.

use base::text::{Assembly, Span};
use program::{ModuleText, Written};
use syntax::wgsl::{MemberSyntax, ModuleItem};

use super::called::MadeCaller;

/// What the name of a function ends with that is made up.
const BOUND: &str = "_bound";

/// Number of the first binding that is made up: beyond those of any text, and of a kernel that is made up.
const FIRST: usize = 1 << 22;

/// The text with a function that calls another one with textures of the module; none for a function that takes none.
pub(super) fn with_textures(text: &ModuleText, function: &str) -> Option<MadeCaller> {
    let module = text.tree()?.wgsl()?;
    let file = text.file();
    let (params, returns) = module.items.iter().find_map(|item| match item {
        ModuleItem::Function { name, params, returns, .. } if name.name == function => Some((params, returns)),
        _ => None,
    })?;
    let kernel = format!("{}{BOUND}", function.trim_end_matches('_'));
    if !params.iter().any(is_opaque) || file.text().contains(&kernel) {
        return None;
    }
    let (mut declared, mut taken, mut given) = (String::new(), Vec::new(), Vec::new());
    for (k, param) in params.iter().enumerate() {
        let (name, ty) = (&param.name.name, file.slice(param.ty.span));
        if is_opaque(param) {
            declared += &format!("@group(0) @binding({}) var {kernel}_{name}: {ty};\n", FIRST + k);
            given.push(format!("{kernel}_{name}"));
        } else {
            taken.push(format!("{name}: {ty}"));
            given.push(name.clone());
        }
    }
    let call = format!("{function}({})", given.join(", "));
    let (gives, call) = match returns {
        Some((_, ty)) => (format!(" -> {}", file.slice(ty.span)), format!("return {call};")),
        None => (String::new(), format!("{call};")),
    };
    let bound = format!("\n{declared}fn {kernel}({}){gives} {{ {call} }}\n", taken.join(", "));
    let (mut out, end) = (Assembly::new(), file.text().len());
    out.copy(file, Span::new(0, end));
    out.insert(&bound, file, end);
    let text = ModuleText::read(&out.finish(file.name()), Written::Wgsl).ok()?;
    Some(MadeCaller { text, kernel, alone: true })
}

/// True for a parameter that only a binding gives.
fn is_opaque(param: &MemberSyntax) -> bool {
    let name = param.ty.name.name.as_str();
    name.starts_with("texture_") || name.starts_with("sampler")
}
