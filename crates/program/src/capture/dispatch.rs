//! A whole dispatch for a lane: where the words of records lie in the buffers of the author's module.

use std::sync::Arc;

use naga::{AddressSpace, GlobalVariable, Handle, Module, StorageAccess, TypeInner};

use super::{Form, Kernel, UniformPlace};
use crate::dispatched::{Dispatched, offset, places};
use crate::{Port, PortAt, Program, ProgramError};

/// A buffer that is bound for a dispatch.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BoundBuffer {
    /// Its group.
    pub group: u32,
    /// Its binding in the group.
    pub binding: u32,
    /// Its size in bytes.
    pub bytes: u32,
    /// True for a uniform buffer, which holds words of the case and not of the invocation.
    pub uniform: bool,
    /// True for a storage buffer that the shader may write.
    pub writable: bool,
    /// Words of the record that it holds before, with their places.
    pub before: Vec<UniformPlace>,
    /// Words of the output record that it holds behind, with their places.
    pub after: Vec<UniformPlace>,
}

/// The kernel of a program that is a whole dispatch.
pub(super) fn kernel(program: &Program, dispatched: &Dispatched) -> Result<Kernel, ProgramError> {
    program.check_fed()?;
    let (module, info) = (*dispatched.host).clone();
    let mut buffers: Vec<(Handle<GlobalVariable>, BoundBuffer)> = Vec::new();
    let sized = &program.module;
    for (handle, variable) in sized.global_variables.iter() {
        let (uniform, writable) = match variable.space {
            AddressSpace::Uniform => (true, false),
            AddressSpace::Storage { access } => (false, access.contains(StorageAccess::STORE)),
            AddressSpace::Immediate => {
                return Err(ProgramError::Unsupported { what: "a dispatch with immediate data".to_owned() });
            }
            _ => continue,
        };
        let Some(at) = variable.binding else {
            let name = variable.name.as_deref().unwrap_or_default();
            return Err(ProgramError::Unsupported { what: format!("a dispatch with `{name}`, which has no binding") });
        };
        // A uniform buffer holds whole rows of 16 bytes.
        let row = if uniform { 16 } else { 4 };
        let bytes = end(sized, variable.ty).max(row).next_multiple_of(row);
        let (before, after) = (Vec::new(), Vec::new());
        let (group, binding) = (at.group, at.binding);
        buffers.push((handle, BoundBuffer { group, binding, bytes, uniform, writable, before, after }));
    }
    for (ports, outputs) in [(&program.uniforms, false), (&program.inputs, false), (&program.outputs, true)] {
        let mut word = 0;
        for port in ports {
            let (global, at) = place(program, port)?;
            let found = buffers.iter_mut().find(|(handle, _)| *handle == global);
            let (_, buffer) = found.ok_or_else(|| ProgramError::internal("a port without a buffer".to_owned()))?;
            let list = if outputs { &mut buffer.after } else { &mut buffer.before };
            for byte in at {
                list.push(UniformPlace { word, byte });
                word += 1;
            }
        }
    }
    Ok(Kernel {
        module,
        info,
        invocation: Arc::new(program.invocation_record()),
        case: Arc::new(program.case_record()),
        output: program.output_layout(),
        form: Form::Dispatch {
            groups: dispatched.groups,
            buffers: buffers.into_iter().map(|(_, buffer)| buffer).collect(),
        },
        program: Arc::new(program.clone()),
    })
}

/// Bytes to the end of the last member: what is behind it would count as elements of an array that has no length.
fn end(module: &Module, ty: Handle<naga::Type>) -> u32 {
    match &module.types[ty].inner {
        TypeInner::Struct { members, .. } => members.last().map_or(0, |last| last.offset + end(module, last.ty)),
        inner => inner.size(module.to_ctx()),
    }
}

/// The variable in which a port lies, with the places of its words in bytes.
fn place(program: &Program, port: &Port) -> Result<(Handle<GlobalVariable>, Vec<u32>), ProgramError> {
    let (global, path) = match port.at {
        PortAt::Global(global) => (global, vec![]),
        PortAt::Member(global, member) => (global, vec![member]),
        PortAt::Part { global, ref path } => (global, path.clone()),
        PortAt::Argument(_)
        | PortAt::Reference(_)
        | PortAt::Arguments { .. }
        | PortAt::Result
        | PortAt::ResultMember(_)
        | PortAt::Vertices { .. } => {
            return Err(ProgramError::internal(format!("`{}` of a dispatch lies in no buffer", port.field.name)));
        }
    };
    let (module, mut at) = (&program.module, Vec::new());
    let ty = module.global_variables[global].ty;
    places(module, port.ty, offset(module, ty, &path), &mut at);
    Ok((global, at))
}
