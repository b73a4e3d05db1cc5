//! What a module asks of its host: inputs of vertices, and the resources that an entry point uses.

use std::collections::BTreeSet;

use base::text::Span;
use syntax::ast::{ExprId, Ident};
use syntax::symbols::{CallTarget, FunctionId, SymbolId};
use syntax::types::{ScalarType, Type};
use syntax::wgsl::{EntryPoint, Module, VariableSyntax};
use syntax::{Shader, Stage};

use analysis::entry::inputs;
use hosts::HostFile;
use hosts::paths::{folder, normalise};
use hosts::script::webgpu::{Pipeline, Source, StageUse, Start};
use reading::{Project, ShaderFile};

/// The module that a host means, where all of it is seen.
pub(super) fn module_of<'p>(
    project: &'p Project,
    host: &HostFile,
    source: &Source,
) -> Option<(&'p ShaderFile, &'p Module)> {
    let file = match source {
        Source::File(path) => beside(project, host.file.name(), path)?,
        Source::String(place) => project.module_at(host, *place)?,
    };
    let module = file.shader.wgsl().filter(|m| !m.composed && !m.items.is_empty() && file.is_sound())?;
    Some((file, module))
}

/// The entry point that a stage starts, where its module has it.
pub(super) fn started<'m>(module: &'m Module, stage: &StageUse) -> Option<&'m EntryPoint> {
    let mut all = module.entry_points.iter().filter(|e| e.stage == stage.stage);
    match &stage.start {
        Start::Named(name, _) => all.find(|e| e.name.name == *name),
        Start::Only => all.next().filter(|_| all.next().is_none()),
    }
}

/// The file that a path means which is written in a host file: from its folder, or as the end of one path alone.
pub(super) fn beside<'p>(project: &'p Project, host: &str, path: &str) -> Option<&'p ShaderFile> {
    let wanted = normalise(&format!("{}/{path}", folder(host)));
    let mut all = project.shader_files();
    if let Some((_, file)) = all.find(|(p, _)| *p == wanted.trim_start_matches('/') || *p == wanted) {
        return Some(file);
    }
    let end = format!("/{}", path.trim_start_matches(['.', '/', '@', '~']));
    let mut found = project.shader_files().filter(|(p, _)| p.ends_with(&end) || **p == end[1..]);
    found.next().filter(|_| found.next().is_none()).map(|(_, file)| file)
}

/// The number that an attribute has as its argument.
fn argument(shader: &Shader, id: ExprId) -> Option<u64> {
    shader.fold(id)?.as_integer().and_then(|v| u64::try_from(v).ok())
}

/// An input of a vertex entry point that a buffer feeds.
pub(super) struct VertexInput<'m> {
    pub location: u64,
    pub scalar: ScalarType,
    pub name: &'m Ident,
}

/// The inputs of a vertex entry point that have a location; none where one is not known.
pub(super) fn vertex_inputs<'m>(
    shader: &Shader,
    module: &'m Module,
    entry: &EntryPoint,
) -> Option<Vec<VertexInput<'m>>> {
    let mut found = Vec::new();
    for input in inputs(shader, module, entry.item) {
        let Some(attribute) = Module::attribute(input.attributes, "location") else {
            Module::attribute(input.attributes, "builtin")?;
            continue;
        };
        let location = argument(shader, *attribute.args.first()?)?;
        let ty = &shader.symbol(input.param).ty;
        let ty = match (ty, input.member) {
            (Type::Struct(structure), Some(member)) => &structure.fields.iter().find(|m| m.name == member)?.ty,
            (ty, None) => ty,
            _ => return None,
        };
        let (Type::Scalar(scalar) | Type::Vector(scalar, _)) = *ty else { return None };
        found.push(VertexInput { location, scalar, name: input.name });
    }
    Some(found)
}

/// A variable that a bind group provides.
#[derive(Clone, Copy)]
pub(super) struct Resource<'m> {
    pub variable: &'m VariableSyntax,
    pub symbol: SymbolId,
    pub group: u64,
    pub binding: u64,
}

impl Resource<'_> {
    pub fn place(&self) -> Span {
        self.variable.name.span
    }
}

/// The resources that an entry point uses; none where a group or binding is not known.
pub(super) fn resources<'m>(shader: &Shader, module: &'m Module, entry: &EntryPoint) -> Option<Vec<Resource<'m>>> {
    let reached = reached(shader, entry.function);
    let mut found = Vec::new();
    for (variable, symbol) in module.globals() {
        let Some(binding) = Module::attribute(&variable.attributes, "binding") else { continue };
        let used = shader.uses_of(symbol).any(|u| u.function.is_none_or(|f| reached.contains(&f)));
        if !used {
            continue;
        }
        let group = Module::attribute(&variable.attributes, "group")?;
        let (group, binding) = (argument(shader, *group.args.first()?)?, argument(shader, *binding.args.first()?)?);
        found.push(Resource { variable, symbol, group, binding });
    }
    Some(found)
}

/// A resource that a stage of a pipeline uses.
pub(super) struct Used<'p> {
    pub stage: Stage,
    pub file: &'p ShaderFile,
    pub module: &'p Module,
    pub resource: Resource<'p>,
}

/// What all stages of a pipeline use; none where one of them is not seen.
pub(super) fn used<'p>(project: &'p Project, host: &HostFile, pipeline: &Pipeline) -> Option<Vec<Used<'p>>> {
    let mut found = Vec::new();
    for stage in &pipeline.stages {
        let (file, module) = module_of(project, host, &stage.source)?;
        let entry = started(module, stage)?;
        let all = resources(&file.shader, module, entry)?;
        found.extend(all.into_iter().map(|resource| Used { stage: stage.stage, file, module, resource }));
    }
    Some(found)
}

/// The functions that an entry point calls, itself included.
fn reached(shader: &Shader, entry: FunctionId) -> BTreeSet<FunctionId> {
    let bodies: Vec<(FunctionId, Span)> =
        shader.functions().filter_map(|(id, f)| Some((id, shader.unit().items.get(f.definition?)?.span))).collect();
    let calls: Vec<(FunctionId, FunctionId)> = shader
        .arena()
        .iter()
        .filter_map(|(id, expr)| match shader.callee(id) {
            Some(CallTarget::User(called)) => {
                let caller = bodies.iter().find(|(_, span)| span.contains(expr.span.start))?;
                Some((caller.0, *called))
            }
            _ => None,
        })
        .collect();
    let mut found = BTreeSet::from([entry]);
    loop {
        let before = found.len();
        let next: Vec<FunctionId> = calls.iter().filter(|(by, _)| found.contains(by)).map(|(_, of)| *of).collect();
        found.extend(next);
        if found.len() == before {
            return found;
        }
    }
}
