//! What a language does not have, in its own words, where its writer says nothing or writes it all the same.
//!
//! It is said before the writer runs, by the author's names: a writer stops with names of its own.

use naga::valid::{GlobalUse, ModuleInfo};
use naga::{
    AddressSpace, Binding, Block, BuiltIn, EarlyDepthTest, EntryPoint, Expression, ImageClass, Module, SampleLevel,
    Scalar, ShaderStage, Statement, StorageAccess, StorageFormat, TypeInner,
};

use super::Language;

/// What a language lacks for an entry point: `WGSL has no gl_PointCoord`. `None` when nothing is known to be missing.
pub(super) fn lacks(module: &Module, info: &ModuleInfo, stage: ShaderStage, language: Language) -> Option<String> {
    let (index, entry) = module.entry_points.iter().enumerate().find(|(_, e)| e.stage == stage)?;
    let varyings = STAND_INS.iter().filter(|name| is_varying(module, entry, name));
    let varyings: Vec<String> = varyings.map(|name| format!("no `{name}`")).collect();
    if !varyings.is_empty() {
        return Some(format!("the translator has {}", varyings.join(" and ")));
    }
    if module.global_variables.iter().any(|(_, v)| v.name.as_deref() == Some(super::build::BY_INDEX)) {
        return Some("the translator has no number in a subgroup where workgroups have several dimensions".to_owned());
    }
    let name = match language {
        Language::Wgsl => "WGSL",
        Language::GlslEs310 => "GLSL ES 3.10",
        Language::Glsl330 => "GLSL 3.30",
        Language::Msl => "MSL",
        Language::Hlsl => "HLSL",
        Language::Glsl450 | Language::SpirV | Language::NagaGlsl => return None,
    };
    let mut missing: Vec<String> = Vec::new();
    let doubles = module.types.iter().any(|(_, ty)| ty.inner.scalar().is_some_and(|s| s == Scalar::F64));
    if doubles && !matches!(language, Language::Glsl330 | Language::Hlsl) {
        missing.push("no `double`".to_owned());
    }
    let known = |built_in: &BuiltIn| built_in_missing(*built_in, language);
    missing.extend(built_ins(module, entry).iter().filter_map(known).map(|name| format!("no `{name}`")));
    if language == Language::Wgsl && stage == ShaderStage::Vertex {
        let uses = info.get_entry_point(index);
        let written = |(handle, variable): (naga::Handle<naga::GlobalVariable>, &naga::GlobalVariable)| {
            let changes = uses[handle].intersects(GlobalUse::WRITE | GlobalUse::ATOMIC);
            matches!(variable.space, AddressSpace::Storage { .. }) && changes
        };
        if module.global_variables.iter().any(written) {
            missing.push("no storage buffer that a vertex stage writes".to_owned());
        }
    }
    if language == Language::GlslEs310 {
        missing.extend(module.types.iter().filter_map(|(_, ty)| image_missing(&ty.inner)));
        let depth = built_ins(module, entry).contains(&BuiltIn::FragDepth);
        if depth && entry.early_depth_test == Some(EarlyDepthTest::Force) {
            missing.push("no `gl_FragDepth` beside `early_fragment_tests`".to_owned());
        }
    }
    missing.dedup();
    (!missing.is_empty()).then(|| format!("{name} has {}", missing.join(" and ")))
}

/// Built-in values that naga does not have. To be run they are varyings like others; in a translation nobody would set
/// or look at them.
const STAND_INS: [&str; 6] =
    ["gl_Layer", "gl_ViewportIndex", "gl_SamplePosition", "gl_HelperInvocation", "gl_ClipDistance", "gl_CullDistance"];

/// True when an entry point takes or gives this at a location.
fn is_varying(module: &Module, entry: &EntryPoint, wanted: &str) -> bool {
    let located = |name: &Option<String>, binding: &Option<Binding>| {
        name.as_deref() == Some(wanted) && matches!(binding, Some(Binding::Location { .. }))
    };
    let result = entry.function.result.as_ref().map(|result| &module.types[result.ty].inner);
    let given = match result {
        Some(TypeInner::Struct { members, .. }) => members.iter().any(|m| located(&m.name, &m.binding)),
        _ => false,
    };
    given || entry.function.arguments.iter().any(|a| located(&a.name, &a.binding))
}

/// Built-in values of an entry point.
fn built_ins(module: &Module, entry: &EntryPoint) -> Vec<BuiltIn> {
    let mut bindings: Vec<Option<&Binding>> = entry.function.arguments.iter().map(|a| a.binding.as_ref()).collect();
    if let Some(result) = &entry.function.result {
        bindings.push(result.binding.as_ref());
        if let TypeInner::Struct { members, .. } = &module.types[result.ty].inner {
            bindings.extend(members.iter().map(|member| member.binding.as_ref()));
        }
    }
    let built_in = |binding: Option<&Binding>| match binding {
        Some(Binding::BuiltIn(built_in)) => Some(*built_in),
        _ => None,
    };
    bindings.into_iter().filter_map(built_in).collect()
}

/// The author's name of a built-in value that the language does not have.
fn built_in_missing(built_in: BuiltIn, language: Language) -> Option<&'static str> {
    let draw = match built_in {
        BuiltIn::DrawIndex => Some("gl_DrawID"),
        BuiltIn::BaseVertex => Some("gl_BaseVertex"),
        BuiltIn::BaseInstance => Some("gl_BaseInstance"),
        _ => None,
    };
    let has = match language {
        // Metal has the base of vertices and instances, HLSL of shader model 5.1 neither.
        Language::Msl => built_in != BuiltIn::DrawIndex,
        _ => false,
    };
    if draw.is_some() && !has {
        return draw;
    }
    match (language, built_in) {
        (Language::Wgsl | Language::Hlsl, BuiltIn::PointCoord) => Some("gl_PointCoord"),
        (Language::Wgsl | Language::Hlsl, BuiltIn::PointSize) => Some("gl_PointSize"),
        (Language::Wgsl | Language::Msl | Language::GlslEs310 | Language::Glsl330, BuiltIn::CullDistance) => {
            Some("gl_CullDistance")
        }
        (Language::GlslEs310, BuiltIn::ClipDistances) => Some("gl_ClipDistance"),
        _ => None,
    }
}

/// What GLSL ES 3.10 does not have of an image (4.4.7 and 4.9: thirteen formats, of which three are read and written).
fn image_missing(inner: &TypeInner) -> Option<String> {
    use StorageFormat as F;
    let TypeInner::Image { class: ImageClass::Storage { format, access }, .. } = *inner else { return None };
    let both = access.contains(StorageAccess::LOAD | StorageAccess::STORE);
    let reported = format!("{format:?}").to_lowercase();
    match format {
        F::R32Float | F::R32Sint | F::R32Uint => None,
        F::Rgba32Float
        | F::Rgba16Float
        | F::Rgba8Unorm
        | F::Rgba8Snorm
        | F::Rgba32Sint
        | F::Rgba16Sint
        | F::Rgba8Sint
        | F::Rgba32Uint
        | F::Rgba16Uint
        | F::Rgba8Uint => both.then(|| format!("no image of the format {reported} that is both read and written")),
        _ => Some(format!("no image of the format {reported}")),
    }
}

/// True for a module with derivatives, told or part of a look into a texture, in which not all invocations need to come
/// upon them together.
pub(super) fn derives_in_branches(module: &Module) -> bool {
    let derives = |(_, expression): (_, &Expression)| match expression {
        Expression::Derivative { .. } => true,
        Expression::ImageSample { level, .. } => matches!(level, SampleLevel::Auto | SampleLevel::Bias(_)),
        _ => false,
    };
    let points = module.entry_points.iter().map(|point| &point.function);
    let all = || module.functions.iter().map(|(_, function)| function).chain(points.clone());
    all().any(|function| function.expressions.iter().any(derives)) && all().any(|function| branches(&function.body))
}

fn branches(block: &Block) -> bool {
    block.iter().any(|statement| match statement {
        Statement::If { .. } | Statement::Switch { .. } | Statement::Loop { .. } => true,
        Statement::Block(inner) => branches(inner),
        _ => false,
    })
}

/// The module with the access to buffers and images that the stage makes use of; `None` when it states no more.
pub(super) fn narrowed(module: &Module, info: &ModuleInfo, stage: ShaderStage) -> Option<(Module, ModuleInfo)> {
    let index = module.entry_points.iter().position(|e| e.stage == stage)?;
    let uses = info.get_entry_point(index);
    let mut changed = module.clone();
    let mut any = false;
    for (handle, variable) in module.global_variables.iter() {
        let mut used = StorageAccess::all();
        let atomic = uses[handle].contains(GlobalUse::ATOMIC);
        used.set(StorageAccess::STORE, atomic || uses[handle].contains(GlobalUse::WRITE));
        used.set(StorageAccess::LOAD, atomic || uses[handle].contains(GlobalUse::READ));
        let mut ty = changed.types[variable.ty].clone();
        let now = &mut changed.global_variables[handle];
        match (&mut now.space, &mut ty.inner) {
            // A buffer that is only written is still one that can be read.
            (AddressSpace::Storage { access }, _) if !(*access & !used).difference(StorageAccess::LOAD).is_empty() => {
                access.remove(StorageAccess::STORE);
            }
            (AddressSpace::Handle, TypeInner::Image { class: ImageClass::Storage { access, .. }, .. })
                if !(*access & used).is_empty() && *access & used != *access =>
            {
                *access &= used;
                now.ty = changed.types.insert(ty, naga::Span::UNDEFINED);
            }
            _ => continue,
        }
        any = true;
    }
    // What a function takes keeps its type, and the module is left as it is.
    any.then(|| super::validate(&changed).ok().map(|info| (changed, info))).flatten()
}

impl crate::Program {
    /// Names of its textures, where it takes samples of any: what a filter gives is left to devices.
    pub fn sampled(&self) -> Vec<String> {
        let points = self.module.entry_points.iter().map(|point| &point.function);
        let mut all = self.module.functions.iter().map(|(_, function)| function).chain(points);
        let samples = |(_, expression): (_, &Expression)| matches!(expression, Expression::ImageSample { .. });
        if !all.any(|function| function.expressions.iter().any(samples)) {
            return Vec::new();
        }
        let mut names: Vec<String> = self.textures.iter().map(|texture| texture.name.clone()).collect();
        names.dedup();
        names
    }
}
