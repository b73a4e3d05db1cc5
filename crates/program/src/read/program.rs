//! From a module and what is chosen of it to a program.

use std::sync::Arc;

use naga::valid::ShaderStages;
use naga::{Binding, Module, TypeInner};

use super::function::alone;
use super::ports::{Ports, is_fed, most};
use super::stops::{self, Stops};
use super::{Chosen, ModuleText, flat, ranges};
use crate::capture::shape_of;
use crate::front::validate_text;
use crate::lower::Role;
use crate::{Entry, Port, PortAt, Program, ProgramError};
use base::text::Span;
use base::value::Field;
use syntax::Stage;

/// The interface of an entry point.
#[derive(Default)]
struct Interface {
    inputs: Vec<Port>,
    outputs: Vec<Port>,
    built_ins: Vec<(u32, naga::BuiltIn)>,
    ranges: Vec<(String, u32)>,
}

impl ModuleText {
    /// The program of what is chosen, with values for `override` constants.
    ///
    /// # Errors
    /// [`ProgramError::Source`] for what is not there, is open, has no value or cannot be run, at its place.
    pub fn program(&self, chosen: Chosen<'_>, values: &[(String, String)]) -> Result<Program, ProgramError> {
        match chosen {
            Chosen::Point { stage, name } => {
                let mut index = self.point(stage, name)?;
                if index < self.module.entry_points.len() {
                    return self.stage(index, values);
                }
                // A compiler that writes one entry point into a module writes several modules.
                index -= self.module.entry_points.len();
                for text in &self.compiled.beside {
                    match index.checked_sub(text.module.entry_points.len()) {
                        None => return text.stage(index, values),
                        Some(rest) => index = rest,
                    }
                }
                Err(ProgramError::internal("an entry point got lost".to_owned()))
            }
            Chosen::Function(name) => self.single(name, values),
        }
    }

    fn ports(&self) -> Ports<'_> {
        let (uniforms, memory, textures, unfed) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        Ports { text: self, uniforms, memory, textures, unfed }
    }

    fn stage(&self, index: usize, values: &[(String, String)]) -> Result<Program, ProgramError> {
        let point = &self.points()[index];
        let module = self.with_values(self.only_point(index)?, values)?;
        let host = module.clone();
        let mut module = module;
        let mut ports = self.ports();
        let own = flat::apart(&mut module);
        let arguments = module.functions[own].arguments.clone();
        let mut unfed = Vec::new();
        let (own, stops) = stops::stops(&mut module, own, &mut unfed)?;
        unfed.iter().for_each(|what| ports.not_fed(what, point.span));
        flat::around(&mut module, own, stops.as_ref());
        ports.resources(&mut module);
        let info = validate_text(&self.file, &module)?;
        let role = match point.stage {
            Stage::Vertex => Role::Vertex,
            Stage::Fragment => Role::Fragment,
            _ => Role::Compute,
        };
        let mut interface = interface(&module, &role, &mut ports, point.span);
        interface.outputs.extend(stops.iter().filter_map(Stops::output));
        let numbers = ranges::numbers(&module, &arguments);
        for port in &interface.inputs {
            let PortAt::Argument(k) = port.at else { continue };
            let argument = &module.entry_points[0].function.arguments[k as usize];
            let Some(Binding::BuiltIn(built_in)) = argument.binding else { continue };
            let Some(most) = most(built_in) else { continue };
            let number = numbers.get(k as usize).copied().flatten();
            let reach = number.map(|n| ranges::reach(&module, &module.functions[own], &info[own], n, most));
            interface.ranges.push((port.field.name.clone(), reach.unwrap_or(most)));
        }
        let host_info = validate_text(&self.file, &host)?;
        let parts = (module, info, Entry::Point(0), role, point.stage);
        Ok(self.made(parts, interface, ports, Some((host, host_info)), values))
    }

    fn single(&self, name: &str, values: &[(String, String)]) -> Result<Program, ProgramError> {
        let mut module = self.with_values(self.only_function(name)?, values)?;
        module.entry_points.clear();
        let span = self.place_of("fn", name);
        let mut ports = self.ports();
        let found = alone(&mut module, name, &mut ports, span)?;
        ports.resources(&mut module);
        if found.outputs.is_empty() && ports.memory.iter().all(|memory| !memory.written) {
            ports.not_fed(&format!("`{name}`, which gives nothing back,"), span);
        }
        let info = validate_text(&self.file, &module)?;
        if !info[found.function].available_stages.contains(ShaderStages::COMPUTE) {
            ports.not_fed(&format!("`{name}`, which takes derivatives or discards,"), span);
        }
        let interface = Interface { inputs: found.inputs, outputs: found.outputs, ..Interface::default() };
        let role = Role::Function { name: name.to_owned() };
        let parts = (module, info, Entry::Function(found.function), role, Stage::Library);
        Ok(self.made(parts, interface, ports, None, values))
    }

    fn made(
        &self,
        (module, info, entry, role, stage): (Module, naga::valid::ModuleInfo, Entry, Role, Stage),
        interface: Interface,
        mut ports: Ports<'_>,
        host: Option<(Module, naga::valid::ModuleInfo)>,
        values: &[(String, String)],
    ) -> Program {
        let wide = |ty: &naga::Type| match ty.inner {
            TypeInner::Scalar(s) | TypeInner::Vector { scalar: s, .. } | TypeInner::Matrix { scalar: s, .. } => {
                !matches!((s.kind, s.width), (naga::ScalarKind::Bool, _) | (_, 4) | (naga::ScalarKind::Float, 2))
            }
            _ => false,
        };
        if ports.unfed.is_empty()
            && let Some((ty, _)) = module.types.iter().find(|(_, ty)| wide(ty))
        {
            let span = super::wgsl::span_in(&self.file, module.types.get_span(ty)).unwrap_or_default();
            ports.not_fed("a number of a size that is not run", span);
        }
        Program {
            module,
            info,
            entry,
            role,
            inputs: interface.inputs,
            uniforms: ports.uniforms,
            outputs: interface.outputs,
            built_ins: interface.built_ins,
            textures: ports.textures,
            stage_module: host.map(Arc::new),
            untranslatable: None,
            unfed: ports.unfed,
            ranges: interface.ranges,
            memory: ports.memory,
            file: self.file.clone(),
            stage,
            written: self.written,
            defines: values.to_vec(),
            instrumented: false,
            dispatch: None,
            texts: Vec::new(),
            constants: self.constants.clone(),
            manners: Arc::default(),
        }
    }
}

/// What the flat entry point of a module takes and gives.
fn interface(module: &Module, role: &Role, ports: &mut Ports<'_>, span: Span) -> Interface {
    let function = &module.entry_points[0].function;
    let mut found = Interface::default();
    // Numbers of the draw stand behind all attributes.
    let mut drawn = Vec::new();
    for (k, argument) in (0_u32..).zip(&function.arguments) {
        let name = argument.name.clone().unwrap_or_else(|| format!("argument {}", k + 1));
        let Some(binding) = &argument.binding else { continue };
        if let (Role::Compute, Binding::BuiltIn(built_in)) = (role, binding) {
            found.built_ins.push((k, *built_in));
            continue;
        }
        let Some(shape) = shape_of(module, argument.ty) else {
            ports.not_fed(&format!("`{name}`"), span);
            continue;
        };
        let at = PortAt::Argument(k);
        let port = Port { field: Field { name: name.clone(), shape }, ty: argument.ty, at, backing: None };
        match binding {
            Binding::BuiltIn(built_in) if most(*built_in).is_some() => drawn.push(port),
            _ if is_fed(binding) => found.inputs.push(port),
            _ => ports
                .not_fed(&format!("`{name}`, a built-in value of the {} stage,", ports.text.points_stage(role)), span),
        }
    }
    found.inputs.append(&mut drawn);
    if let Some(result) = &function.result {
        let (text, point) = (ports.text, module.entry_points[0].name.as_str());
        let mut out = |name: &str, ty, at| match shape_of(module, ty) {
            Some(shape) => {
                found.outputs.push(Port { field: Field { name: name.to_owned(), shape }, ty, at, backing: None });
            }
            None => ports.not_fed(&format!("`{name}`"), span),
        };
        match &module.types[result.ty].inner {
            TypeInner::Struct { members, .. } if result.binding.is_none() => {
                for (k, member) in (0_u32..).zip(members) {
                    let own = format!("member {}", k + 1);
                    let name = member.name.as_deref().or_else(|| text.output(point, member.binding.as_ref()));
                    out(name.unwrap_or(&own), member.ty, PortAt::ResultMember(k));
                }
            }
            _ => out("return", result.ty, PortAt::Result),
        }
    }
    apart(&mut found.inputs);
    found
}

/// Names that several inputs share get numbers.
fn apart(ports: &mut [Port]) {
    for k in 1..ports.len() {
        let (before, rest) = ports.split_at_mut(k);
        let name = rest[0].field.name.clone();
        let same = |name: &str| before.iter().any(|port| port.field.name == name);
        if same(&name) {
            let free = (2..).map(|n| format!("{name}_{n}")).find(|name| !same(name));
            rest[0].field.name = free.unwrap_or(name);
        }
    }
}

impl ModuleText {
    fn points_stage(&self, role: &Role) -> &'static str {
        match role {
            Role::Vertex => "vertex",
            Role::Fragment => "fragment",
            Role::Compute | Role::Geometry(_) | Role::Function { .. } => "compute",
        }
    }
}
