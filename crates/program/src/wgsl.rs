//! Functions in WGSL, which say what is right or are run as they are.

use naga::{ScalarKind, TypeInner};

use super::capture::shape_of;
use super::front::{NAGA, UNSUPPORTED, validate_text};
use super::{Entry, Port, PortAt, Program, ProgramError, contain};
use crate::lower::Role;
use base::diagnostic::{Diagnostic, Severity};
use base::text::{SourceFile, Span};
use base::value::Field;
use syntax::Stage;

impl Program {
    /// One function of a text in WGSL: arguments in, its value and what its pointers hold out.
    ///
    /// # Errors
    /// [`ProgramError::Source`] with the place of what is no WGSL, what no record can hold, and a function
    /// that is not there.
    pub fn from_wgsl(file: &SourceFile, name: &str) -> Result<Self, ProgramError> {
        let text = file.text();
        let reported = |span: Option<naga::Span>, code, message: String| {
            let span = span.and_then(|s| s.to_range()).map_or(Span::at(0), |r| Span::new(r.start, r.end));
            Diagnostic::new(code, Severity::Error, file, span, message)
        };
        let refused = |span, message| ProgramError::Source(vec![reported(span, UNSUPPORTED, message)]);
        let module = contain(|| naga::front::wgsl::parse_str(text))
            .map_err(|panic| refused(None, format!("the translator fails on this text: {panic}")))?
            .map_err(|error| {
                let span = error.labels().next().map(|(span, _)| span);
                ProgramError::Source(vec![reported(span, NAGA, error.message().to_owned())])
            })?;
        let Some((handle, function)) = module.functions.iter().find(|(_, f)| f.name.as_deref() == Some(name)) else {
            let known: Vec<&str> = module.functions.iter().filter_map(|(_, f)| f.name.as_deref()).collect();
            return Err(refused(None, format!("there is no function `{name}`; there are: {}", known.join(", "))));
        };
        let place = Some(module.functions.get_span(handle));
        let (mut inputs, mut outputs) = (Vec::new(), Vec::new());
        let port = |name: &str, ty, at| match shape_of(&module, ty) {
            Some(shape) => Ok(Port { field: Field { name: name.to_owned(), shape }, ty, at, backing: None }),
            None => Err(refused(place, format!("`{name}` is of a type that cannot be fed or read"))),
        };
        if let Some(result) = &function.result {
            outputs.push(port("return", result.ty, PortAt::Result)?);
        }
        for (k, argument) in (0_u32..).zip(&function.arguments) {
            let own = format!("argument {}", k + 1);
            let name = argument.name.as_deref().unwrap_or(&own);
            match module.types[argument.ty].inner {
                TypeInner::Pointer { base, .. } => {
                    inputs.push(port(name, base, PortAt::Reference(k))?);
                    outputs.push(port(name, base, PortAt::Reference(k))?);
                }
                _ => inputs.push(port(name, argument.ty, PortAt::Argument(k))?),
            }
        }
        if outputs.is_empty() {
            return Err(refused(place, format!("`{name}` gives nothing back")));
        }
        let role = Role::Function { name: name.to_owned() };
        let half = |ty: &naga::Type| match ty.inner {
            TypeInner::Scalar(s) | TypeInner::Vector { scalar: s, .. } | TypeInner::Matrix { scalar: s, .. } => {
                s.kind == ScalarKind::Float && s.width != 4
            }
            _ => false,
        };
        if let Some((ty, _)) = module.types.iter().find(|(_, ty)| half(ty)) {
            return Err(refused(Some(module.types.get_span(ty)), "only `f32` is a real number here".to_owned()));
        }
        let info = validate_text(file, &module)?;
        // Nothing feeds what lies outside of the function.
        for (global, variable) in module.global_variables.iter() {
            let fed = matches!(variable.space, naga::AddressSpace::Private | naga::AddressSpace::WorkGroup);
            if !fed && !info[handle][global].is_empty() {
                let name = variable.name.as_deref().unwrap_or("a variable");
                let message = format!("`{name}`, a resource of the stage, cannot be fed or read");
                return Err(refused(Some(module.global_variables.get_span(global)), message));
            }
        }
        let entry = Entry::Function(handle);
        let built_ins = Vec::new();
        Ok(Self {
            module,
            info,
            entry,
            role,
            inputs,
            uniforms: Vec::new(),
            outputs,
            built_ins,
            ranges: Vec::new(),
            textures: Vec::new(),
            stage_module: None,
            unfed: Vec::new(),
            memory: Vec::new(),
            file: file.clone(),
            stage: Stage::Library,
            defines: Vec::new(),
            instrumented: false,
            texts: Vec::new(),
            constants: std::sync::Arc::default(),
        })
    }
}
