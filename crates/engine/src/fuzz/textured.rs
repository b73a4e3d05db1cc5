//! A function in WGSL that takes textures or samplers, without them: another function is made up that gives it variables of
//! the module, and takes the rest.

use program::ModuleText;
use syntax::wgsl::MemberSyntax;

use super::called::{MadeCaller, head, with_more};

/// What the name of a function ends with that is made up.
const BOUND: &str = "_bound";

/// Number of the first binding that is made up: beyond those of any text, and of a kernel that is made up.
const FIRST: usize = 1 << 22;

/// The text with a function that calls another one with textures of the module; none for a function that takes none.
pub(super) fn with_textures(text: &ModuleText, function: &str) -> Option<MadeCaller> {
    let file = text.file();
    let (params, returns) = head(text, function)?;
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
        Some(ty) => (format!(" -> {}", file.slice(ty.span)), format!("return {call};")),
        None => (String::new(), format!("{call};")),
    };
    let bound = format!("\n{declared}fn {kernel}({}){gives} {{ {call} }}\n", taken.join(", "));
    Some(MadeCaller { text: with_more(file, &bound)?, kernel, alone: true })
}

/// True for a parameter that only a binding gives.
fn is_opaque(param: &MemberSyntax) -> bool {
    let name = param.ty.name.name.as_str();
    name.starts_with("texture_") || name.starts_with("sampler")
}
