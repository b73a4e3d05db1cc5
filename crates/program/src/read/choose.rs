//! What is run of a module.

use naga::compact::KeepUnused;
use naga::{
    AddressSpace, EntryPoint, Expression, Function, FunctionArgument, GlobalVariable, Handle, Module, ShaderStage,
    Statement, TypeInner,
};

use super::{ModuleText, Runnable, stage_of};
use crate::capture::{Builder, add_global};
use crate::front::{INCOMPLETE, UNSUPPORTED};
use crate::{ProgramError, contain};
use base::diagnostic::{Code, Diagnostic, Severity};
use base::did_you_mean;
use base::text::Span;
use syntax::Stage;

/// What is chosen of a module.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Chosen<'a> {
    /// An entry point: the one of this name, or the only one of this stage.
    Point {
        /// Its stage, where that is known.
        stage: Option<Stage>,
        /// Its name, where that is given.
        name: Option<&'a str>,
    },
    /// A function that is no entry point.
    Function(&'a str),
}

/// Name of the entry point around a function while what it does not use is left out.
const KEEPER: &str = "sc_keeper";

impl ModuleText {
    pub(super) fn error(&self, code: Code, span: Span, message: String, help: &str) -> ProgramError {
        let found = Diagnostic::new(code, Severity::Error, &self.file, span, message).with_help(help.to_owned());
        ProgramError::Source(vec![found.at_origin()])
    }

    /// The entry point that is chosen.
    pub(super) fn point(&self, stage: Option<Stage>, name: Option<&str>) -> Result<usize, ProgramError> {
        let points = self.points();
        let named = |points: &[&Runnable]| -> String {
            let one = |point: &&Runnable| format!("`{}` ({})", point.name, point.stage.name());
            points.iter().map(one).collect::<Vec<_>>().join(", ")
        };
        let all: Vec<&Runnable> = points.iter().collect();
        if let Some(name) = name {
            let Some(found) = points.iter().position(|point| point.name == name) else {
                let known = points.iter().map(|point| point.name.as_str());
                let hint = match points.is_empty() {
                    true => self.functions_instead(),
                    false => did_you_mean(name, known, "there are:"),
                };
                let message = format!("there is no entry point `{name}`");
                return Err(self.error(INCOMPLETE, Span::at(0), message, &hint));
            };
            let (has, span) = (points[found].stage, points[found].span);
            if let Some(stage) = stage.filter(|stage| *stage != has) {
                let message =
                    format!("`{name}` is an entry point of the {} stage, not of the {}", has.name(), stage.name());
                let help = format!("the file has {}", named(&all));
                return Err(self.error(INCOMPLETE, span, message, &help));
            }
            return Ok(found);
        }
        let fits = |point: &Runnable| stage.is_none_or(|stage| stage == point.stage);
        let found: Vec<usize> = (0..points.len()).filter(|&k| fits(&points[k])).collect();
        match found[..] {
            [only] => Ok(only),
            [] => {
                let of = stage.map_or_else(String::new, |stage| format!(" of the {} stage", stage.name()));
                let help = match points.is_empty() {
                    true => self.functions_instead(),
                    false => format!("the file has {}", named(&all)),
                };
                Err(self.error(INCOMPLETE, Span::at(0), format!("there is no entry point{of}"), &help))
            }
            [first, second, ..] => {
                let several: Vec<&Runnable> = found.iter().map(|&k| &points[k]).collect();
                let message = format!("which entry point is meant is open: there are {}", named(&several));
                let help = format!("choose one with `--entry {}`, or `entry` of a suite", points[first].name);
                Err(self.error(INCOMPLETE, points[second].span, message, &help))
            }
        }
    }

    fn functions_instead(&self) -> String {
        let functions = self.functions();
        let names: Vec<&str> = functions.iter().map(|function| function.name.as_str()).collect();
        match names.is_empty() {
            true => "the file declares no function either".to_owned(),
            false => format!("it has functions, of which one can be run: {}", names.join(", ")),
        }
    }

    /// The module with this entry point and what it uses.
    pub(super) fn only_point(&self, index: usize) -> Result<Module, ProgramError> {
        let mut module = self.module.clone();
        let point = module.entry_points.swap_remove(index);
        if stage_of(point.stage).is_none() {
            let message = format!("`{}` is an entry point of a stage that is not run", point.name);
            let help = "vertex, fragment and compute stages are";
            return Err(self.error(UNSUPPORTED, self.place_of("fn", &point.name), message, help));
        }
        module.entry_points = vec![point];
        compacted(&mut module)?;
        Ok(module)
    }

    /// The module with this function and what it uses.
    pub(super) fn only_function(&self, name: &str) -> Result<Module, ProgramError> {
        if let Some((_, span, why)) = self.compiled.left_out.iter().find(|(own, ..)| own == name) {
            let help = "run a function or an entry point that calls it";
            return Err(self.error(UNSUPPORTED, *span, format!("`{name}` is not run by itself: {why}"), help));
        }
        let named = |(_, function): &(Handle<Function>, &Function)| function.name.as_deref() == Some(name);
        let Some((handle, _)) = self.module.functions.iter().find(named) else {
            let (functions, points) = (self.functions(), self.points());
            let known = functions.iter().chain(&points).map(|function| function.name.as_str());
            let hint = did_you_mean(name, known, "there are:");
            let message = match points.iter().any(|point| point.name == name) {
                true => format!("`{name}` is an entry point and no function by itself"),
                false => format!("there is no function `{name}`; {hint}"),
            };
            return Err(self.error(INCOMPLETE, Span::at(0), message, "name a function of the file"));
        };
        let mut module = self.module.clone();
        let keeper = self.keeper(&mut module, handle, name)?;
        module.entry_points = vec![keeper];
        compacted(&mut module)?;
        Ok(module)
    }

    /// An entry point that calls the function with anything.
    fn keeper(&self, module: &mut Module, handle: Handle<Function>, name: &str) -> Result<EntryPoint, ProgramError> {
        let (arguments, result) = {
            let function = &module.functions[handle];
            (function.arguments.clone(), function.result.is_some())
        };
        let mut b = Builder::new();
        let mut passed = Vec::new();
        for argument in &arguments {
            passed.push(match module.types[argument.ty].inner {
                TypeInner::Pointer { base, space: AddressSpace::Function } => b.local("sc_kept", base),
                TypeInner::Pointer { base, space: AddressSpace::Private } => {
                    let global: Handle<GlobalVariable> =
                        add_global(module, "sc_kept", AddressSpace::Private, None, base);
                    b.global(global)
                }
                TypeInner::Pointer { space, .. } => {
                    return Err(self.unfit(name, argument, &format!("points to {}", space_name(space))));
                }
                TypeInner::Image { .. } => return Err(self.unfit(name, argument, "is a texture")),
                TypeInner::Sampler { .. } => return Err(self.unfit(name, argument, "is a sampler")),
                _ => b.name(Expression::ZeroValue(argument.ty)),
            });
        }
        let value = result.then(|| b.name(Expression::CallResult(handle)));
        b.statement(Statement::Call { function: handle, arguments: passed, result: value });
        b.statement(Statement::Return { value: None });
        Ok(EntryPoint {
            name: KEEPER.to_owned(),
            stage: ShaderStage::Compute,
            early_depth_test: None,
            workgroup_size: [1; 3],
            workgroup_size_overrides: None,
            function: b.finish(KEEPER, Vec::new(), None),
            mesh_info: None,
            task_payload: None,
            incoming_ray_payload: None,
        })
    }

    fn unfit(&self, name: &str, argument: &FunctionArgument, why: &str) -> ProgramError {
        let parameter = argument.name.as_deref().unwrap_or("a parameter");
        let message = format!("`{parameter}` of `{name}` {why}, which only its caller can give");
        let help = "run the entry point that calls it";
        self.error(UNSUPPORTED, self.place_of("fn", name), message, help)
    }
}

/// An address space in words.
pub(super) fn space_name(space: AddressSpace) -> &'static str {
    match space {
        AddressSpace::Function => "a variable of a function",
        AddressSpace::Private => "a private variable",
        AddressSpace::WorkGroup => "memory of a workgroup",
        AddressSpace::Uniform => "a uniform buffer",
        AddressSpace::Storage { .. } => "a storage buffer",
        AddressSpace::Handle => "a texture or sampler",
        AddressSpace::Immediate => "immediate data",
        AddressSpace::TaskPayload => "a task payload",
        AddressSpace::RayPayload | AddressSpace::IncomingRayPayload => "a ray payload",
    }
}

/// Leaves out what no entry point uses.
pub(super) fn compacted(module: &mut Module) -> Result<(), ProgramError> {
    contain(|| naga::compact::compact(module, KeepUnused::No))
        .map_err(|panic| ProgramError::internal(format!("naga panicked: {panic}")))
}
