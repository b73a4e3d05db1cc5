//! Whether the entry of a layout is of the kind that a shader declares (WebGPU, section 10.1.2, "validating shader
//! binding").

use syntax::Shader;
use syntax::wgsl::{Module, TypeSyntax};

use super::super::interface::Resource;
use hosts::script::webgpu::Kind;

/// What an entry and a declaration say of the same thing, where they differ.
pub(super) fn difference(
    shader: &Shader,
    module: &Module,
    resource: &Resource<'_>,
    kind: &Kind,
) -> Option<(String, String)> {
    let variable = resource.variable;
    let space: Vec<&str> = variable.space.iter().map(|s| s.name.as_str()).collect();
    let there = match space.as_slice() {
        ["uniform", ..] => "a uniform buffer".to_owned(),
        ["storage"] | ["storage", "read"] => "a read-only storage buffer".to_owned(),
        ["storage", "read_write"] => "a storage buffer that is written".to_owned(),
        [] => return opaque(shader, variable.ty.as_ref()?, kind),
        _ => return None,
    };
    let here = match kind {
        Kind::Uniform(_) => "a uniform buffer".to_owned(),
        Kind::Storage(Some(true), _) => "a read-only storage buffer".to_owned(),
        Kind::Storage(Some(false), _) => "a storage buffer that is written".to_owned(),
        Kind::Storage(None, _) if space[0] == "uniform" => "a storage buffer".to_owned(),
        Kind::Storage(None, _) | Kind::Unknown => return None,
        other => described(other)?,
    };
    if here != there {
        return Some((here, there));
    }
    let (Kind::Uniform(least) | Kind::Storage(_, least)) = kind else { return None };
    let (least, size) = (least.filter(|l| *l > 0)?, module.extent(resource.symbol)?.size);
    let bytes = |n: u64| if n == 1 { "1 byte".to_owned() } else { format!("{n} bytes") };
    (least < size).then(|| (format!("a buffer of at least {}", bytes(least)), format!("a type of {}", bytes(size))))
}

/// A sampler or texture of the layout in words; none where too little of it is known.
fn described(kind: &Kind) -> Option<String> {
    Some(match kind {
        Kind::Uniform(_) => "a uniform buffer".to_owned(),
        Kind::Storage(..) => "a storage buffer".to_owned(),
        Kind::Sampler(_) => "a sampler".to_owned(),
        Kind::Texture { .. } => "a texture".to_owned(),
        Kind::StorageTexture { .. } => "a storage texture".to_owned(),
        Kind::External => "an external texture".to_owned(),
        Kind::Unknown => return None,
    })
}

fn opaque(shader: &Shader, ty: &TypeSyntax, kind: &Kind) -> Option<(String, String)> {
    let name = ty.name.name.as_str();
    let different = |here: String| Some((here, format!("`{}`", shader.file().slice(ty.span))));
    let argument = |n: usize| ty.args.get(n).and_then(|a| a.ty.as_ref()).map(|t| t.name.name.as_str());
    if let Some(rest) = name.strip_prefix("texture_storage_") {
        let Kind::StorageTexture { format, access, dimension } = kind else { return different(described(kind)?) };
        if let (Some(here), Some(there)) = (format.as_deref().filter(|f| !f.is_empty()), argument(0))
            && here != there
        {
            return different(format!("the format `{here}`"));
        }
        let asked = argument(1);
        if let (Some(here), Some(there)) = (access, asked)
            && !(*here == there || (*here == "read_write" && there == "write"))
        {
            return different(format!("the access `{here}`"));
        }
        return shaped(rest, dimension.as_deref()).and_then(different);
    }
    if name == "texture_external" {
        return match kind {
            // Browsers bind ordinary textures for them as well.
            Kind::External | Kind::Unknown | Kind::Texture { .. } => None,
            other => different(described(other)?),
        };
    }
    if let Some(rest) = name.strip_prefix("texture_") {
        let Kind::Texture { sample, dimension, multisampled } = kind else { return different(described(kind)?) };
        let depth = rest.starts_with("depth_");
        let rest = rest.strip_prefix("depth_").unwrap_or(rest);
        let many = rest.starts_with("multisampled_");
        let rest = rest.strip_prefix("multisampled_").unwrap_or(rest);
        if let Some(here) = multisampled.filter(|m| *m != many) {
            let here = if here { "a texture with several samples" } else { "a texture with one sample" };
            return different(here.to_owned());
        }
        let fits = match (depth, argument(0)) {
            (true, _) => &["depth"][..],
            // What is not filtered may be of depth.
            (false, Some("f32")) => &["float", "depth"],
            (false, Some("i32")) => &["sint"],
            (false, Some("u32")) => &["uint"],
            _ => return None,
        };
        if let Some(here) = sample.as_deref().filter(|s| !fits.contains(s)) {
            return different(format!("a texture of `{here}`"));
        }
        return shaped(rest, dimension.as_deref()).and_then(different);
    }
    let compares = match name {
        "sampler" => false,
        "sampler_comparison" => true,
        _ => return None,
    };
    match kind {
        Kind::Sampler(Some(here)) if *here != compares => {
            different(if *here { "a sampler that compares" } else { "a sampler that does not compare" }.to_owned())
        }
        Kind::Sampler(_) => None,
        other => different(described(other)?),
    }
}

/// The dimension of a layout, where it is not that of the type.
fn shaped(there: &str, here: Option<&str>) -> Option<String> {
    let there = there.replace('_', "-");
    here.filter(|h| *h != there).map(|h| format!("the dimension `{h}`"))
}
