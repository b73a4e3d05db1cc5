//! The compute kernel: inputs and uniforms of every case come from storage buffers.
//!
//! Uniforms become private variables that are filled from storage before the call: the body stays as it is, and every
//! invocation can have uniforms of its own.

use std::sync::Arc;

use naga::{
    AddressSpace, BinaryOperator, EntryPoint, Expression, GlobalVariable, Handle, Module, ResourceBinding, ScalarKind,
    ShaderStage, Span, Statement, StorageAccess,
};

use super::builder::{Builder, Types, add_global};
use super::feed::{Feed, Feeding};
use super::trace::Direct;
use super::words::{self, Supply, WordsAt};
use super::{ENTRY_FUNCTION, ENTRY_POINT, Kernel, binding, geometry};
use crate::lower::Role;
use crate::{Entry, Port, PortAt, Program, ProgramError, validate};

type Expr = Handle<Expression>;

/// The globals that every kernel has.
pub(super) struct Harness {
    pub types: Types,
    pub params: Handle<GlobalVariable>,
    pub outputs: Handle<GlobalVariable>,
}

impl Harness {
    pub(super) fn insert(module: &mut Module) -> Self {
        let types = Types::insert(module);
        let at = |binding| Some(ResourceBinding { group: 0, binding });
        let written = AddressSpace::Storage { access: StorageAccess::LOAD | StorageAccess::STORE };
        Self {
            params: add_global(module, "sc_params", AddressSpace::Uniform, at(binding::PARAMS), types.uvec4),
            outputs: add_global(module, "sc_outputs", written, at(binding::OUTPUTS), types.words),
            types,
        }
    }
}

/// One of the words of `sc_params`.
pub(super) fn param(b: &mut Builder, harness: &Harness, index: u32) -> Expr {
    let pointer = b.global(harness.params);
    let word = b.member(pointer, index);
    b.load(word)
}

/// Index of the canary in `sc_params`.
pub(super) const CANARY: u32 = 2;
/// Index of the sentinel in `sc_params`.
pub(super) const SENTINEL: u32 = 3;

/// Turns the program's entry point into an ordinary function and gives its handle. The function
/// may already be one.
pub(super) fn as_function(program: &Program, module: &mut Module) -> Handle<naga::Function> {
    match program.entry {
        Entry::Function(handle) => {
            module.entry_points.clear();
            handle
        }
        Entry::Point(index) => {
            let mut function = module.entry_points.swap_remove(index).function;
            module.entry_points.clear();
            for argument in &mut function.arguments {
                argument.binding = None;
            }
            if let Some(result) = &mut function.result {
                result.binding = None;
            }
            function.name = Some(ENTRY_FUNCTION.to_owned());
            module.functions.append(function, Span::UNDEFINED)
        }
    }
}

/// The kernel that takes its inputs in this way.
pub(super) fn kernel(program: &Program, feed: Feed<'_>) -> Result<Kernel, ProgramError> {
    program.check_fed()?;
    if let (Role::Fragment, Entry::Point(index)) = (&program.role, program.entry)
        && !program.info.get_entry_point(index).available_stages.contains(naga::valid::ShaderStages::COMPUTE)
    {
        let what = "a fragment shader that takes derivatives, run by itself".to_owned();
        return Err(ProgramError::Unsupported { what });
    }
    let mut module = program.module.clone();
    let layout = program.output_layout();
    for port in program.inputs.iter().chain(&program.uniforms).chain(&program.outputs) {
        words::insert_parts(&mut module, port.ty);
    }
    let harness = Harness::insert(&mut module);
    let feeding = Feeding::insert(program, &mut module, &harness, feed);
    // Uniforms become private variables, filled before the call: each invocation has its own.
    for port in &program.uniforms {
        let global = match port.at {
            PortAt::Global(global) | PortAt::Member(global, _) | PortAt::Part { global, .. } => global,
            ref other => return Err(ProgramError::internal(format!("uniform at {other:?}"))),
        };
        let variable = &mut module.global_variables[global];
        variable.space = AddressSpace::Private;
        variable.binding = None;
    }
    let emission = match program.role {
        Role::Geometry(primitives) => Some(geometry::Emission::insert(program, &mut module, &harness, primitives)?),
        Role::Vertex | Role::Fragment | Role::Compute | Role::Function { .. } => None,
    };
    let function = as_function(program, &mut module);
    let direct = Direct::insert(program, &mut module, &harness);

    let mut b = Builder::new();
    let index = feeding.index(&mut b);
    let count = param(&mut b, &harness, 0);
    let inside = b.binary(BinaryOperator::Less, index, count);
    let mut failure = None;
    let mut body = |b: &mut Builder, sample: usize| {
        let mut arguments = vec![None; module.functions[function].arguments.len()];
        let case = feeding.case(b, &harness, index, sample);
        let mut unfed = case.and_then(|words| feed_ports(b, &module, &program.uniforms, words, &mut arguments));
        if unfed.is_none() {
            let invocation = feeding.invocation(b, index, sample);
            unfed = invocation.and_then(|words| feed_ports(b, &module, &program.inputs, words, &mut arguments));
        }
        if unfed.is_some() {
            failure = unfed;
            return;
        }
        // Parameters that only go out.
        let mut references = Vec::new();
        for port in &program.outputs {
            if let PortAt::Reference(k) = port.at {
                let slot = &mut arguments[k as usize];
                let local = *slot.get_or_insert_with(|| b.local(&port.field.name, port.ty));
                references.push((k, local));
            }
        }
        for &(k, _) in &program.built_ins {
            // The first invocation of a dispatch is meant.
            let ty = module.functions[function].arguments[k as usize].ty;
            arguments[k as usize] = Some(b.name(Expression::ZeroValue(ty)));
        }
        let record = scaled(b, index, layout.words());
        poison(b, &harness, program, &module);
        if let Some(direct) = &direct {
            direct.begin(b, record);
        }
        if let Some(emission) = &emission {
            emission.begin(b, record);
        }
        let Some(arguments) = arguments.into_iter().collect::<Option<Vec<_>>>() else {
            failure = Some("an argument of the entry point".to_owned());
            return;
        };
        let result = module.functions[function].result.is_some().then(|| b.name(Expression::CallResult(function)));
        b.statement(Statement::Call { function, arguments, result });
        let out = WordsAt { array: b.global(harness.outputs), base: record };
        let mark = canary(b, &harness, index);
        let first = b.element(out.array, out.base);
        b.store(first, mark);
        match &emission {
            Some(emission) => emission.end(b, out),
            None => store_outputs(b, &module, program, out, result, &references),
        }
    };
    b.when(inside, |b| feeding.each(b, index, &mut body));
    if let Some(what) = failure {
        return Err(ProgramError::Unsupported { what: format!("`{what}` cannot be fed word by word") });
    }
    let point = feeding.entry_point(b, &harness);
    module.entry_points.push(point);
    let info = validate(&module)?;
    Ok(Kernel {
        invocation: Arc::new(feeding.record(program)),
        case: Arc::new(program.case_record()),
        output: layout,
        program: Arc::new(program.clone()),
        form: feeding.form(),
        module,
        info,
    })
}

/// Gives words one after the other to ports. Gives the name of one that takes none.
fn feed_ports(
    b: &mut Builder,
    module: &Module,
    ports: &[Port],
    words: Supply<'_>,
    arguments: &mut [Option<Expr>],
) -> Option<String> {
    let mut offset = 0;
    for port in ports {
        let Some(value) = words::load(b, module, words, &mut offset, port.ty) else {
            return Some(port.field.name.clone());
        };
        match port.at {
            PortAt::Argument(k) => arguments[k as usize] = Some(value),
            PortAt::Arguments { first, count } => {
                let parts = vectors(b, module, port.ty, value);
                for (slot, part) in arguments[first as usize..][..count as usize].iter_mut().zip(parts) {
                    *slot = Some(part);
                }
            }
            PortAt::Reference(k) => {
                let local = b.local(&port.field.name, port.ty);
                b.store(local, value);
                arguments[k as usize] = Some(local);
            }
            _ => put(b, &port.at, value),
        }
    }
    None
}

/// An entry point called [`ENTRY_POINT`].
pub(super) fn entry_point(stage: ShaderStage, workgroup_size: [u32; 3], function: naga::Function) -> EntryPoint {
    EntryPoint {
        name: ENTRY_POINT.to_owned(),
        stage,
        early_depth_test: None,
        workgroup_size,
        workgroup_size_overrides: None,
        function,
        mesh_info: None,
        task_payload: None,
        incoming_ray_payload: None,
    }
}

/// `index * words`.
pub(super) fn scaled(b: &mut Builder, index: Expr, words: usize) -> Expr {
    let words = b.u32(words as u32);
    b.binary(BinaryOperator::Multiply, index, words)
}

/// The word that proves that this dispatch wrote the record of this invocation.
pub(super) fn canary(b: &mut Builder, harness: &Harness, index: Expr) -> Expr {
    let canary = param(b, harness, CANARY);
    b.binary(BinaryOperator::ExclusiveOr, canary, index)
}

/// Writes a value to where a port lies in global variables.
fn put(b: &mut Builder, at: &PortAt, value: Expr) {
    match *at {
        PortAt::Part { global, ref path } => {
            let pointer = reach(b, global, path);
            b.store(pointer, value);
        }
        PortAt::Global(global) => {
            let pointer = b.global(global);
            b.store(pointer, value);
        }
        PortAt::Member(global, member) => {
            let pointer = b.global(global);
            let pointer = b.member(pointer, member);
            b.store(pointer, value);
        }
        PortAt::Vertices { global, member, count } => {
            for k in 0..count {
                let element = b.member(value, k);
                let pointer = b.global(global);
                let vertex = b.member(pointer, k);
                let pointer = b.member(vertex, member);
                b.store(pointer, element);
            }
        }
        // Arguments and results are handled where the call is made.
        PortAt::Argument(_)
        | PortAt::Arguments { .. }
        | PortAt::Reference(_)
        | PortAt::Result
        | PortAt::ResultMember(_) => {}
    }
}

/// A pointer to a part of a global variable.
fn reach(b: &mut Builder, global: Handle<GlobalVariable>, path: &[u32]) -> Expr {
    path.iter().fold(b.global(global), |pointer, &k| b.member(pointer, k))
}

/// The vectors and numbers of a value, in order.
fn vectors(b: &mut Builder, module: &Module, ty: Handle<naga::Type>, value: Expr) -> Vec<Expr> {
    use naga::TypeInner;
    let (count, part) = match module.types[ty].inner {
        TypeInner::Matrix { columns, .. } => return (0..columns as u32).map(|k| b.member(value, k)).collect(),
        TypeInner::Array { base, size: naga::ArraySize::Constant(len), .. } => (len.get(), base),
        _ => return vec![value],
    };
    let elements: Vec<Expr> = (0..count).map(|k| b.member(value, k)).collect();
    elements.into_iter().flat_map(|element| vectors(b, module, part, element)).collect()
}

/// Fills the global variables that stand for outputs with the sentinel, so that an output that the
/// shader does not write shows.
pub(super) fn poison(b: &mut Builder, harness: &Harness, program: &Program, module: &Module) {
    for port in program.outputs.iter().filter(|port| !Direct::writes(port)) {
        let (global, path) = match &port.at {
            PortAt::Global(global) => (Some(*global), Vec::new()),
            PortAt::Member(global, member) => (Some(*global), vec![*member]),
            PortAt::Part { global, path } => (Some(*global), path.clone()),
            _ => (port.backing, Vec::new()),
        };
        let Some(global) = global else { continue };
        let word = param(b, harness, SENTINEL);
        if let Some(value) = filled(b, module, port.ty, word) {
            let pointer = reach(b, global, &path);
            b.store(pointer, value);
        }
    }
}

/// A value of type `ty` whose words are all `word`.
fn filled(b: &mut Builder, module: &Module, ty: Handle<naga::Type>, word: Expr) -> Option<Expr> {
    use naga::TypeInner;
    let part = |inner| module.types.get(&naga::Type { name: None, inner });
    let (count, part) = match module.types[ty].inner {
        TypeInner::Scalar(scalar) => {
            return Some(match scalar.kind {
                ScalarKind::Uint => word,
                ScalarKind::Bool => return None,
                kind => b.bitcast(word, kind),
            });
        }
        TypeInner::Vector { size, scalar } => (size as u32, part(TypeInner::Scalar(scalar))?),
        TypeInner::Matrix { columns, rows, scalar } => {
            (columns as u32, part(TypeInner::Vector { size: rows, scalar })?)
        }
        TypeInner::Array { base, size: naga::ArraySize::Constant(len), .. } => (len.get(), base),
        _ => return None,
    };
    let value = filled(b, module, part, word)?;
    Some(b.compute(Expression::Compose { ty, components: vec![value; count as usize] }))
}

/// Stores the outputs of a pointwise program behind the canary.
pub(super) fn store_outputs(
    b: &mut Builder,
    module: &Module,
    program: &Program,
    out: WordsAt,
    result: Option<Expr>,
    references: &[(u32, Expr)],
) {
    let mut offset = 1;
    for port in &program.outputs {
        let value = match (&port.at, result) {
            (PortAt::Result, Some(result)) => result,
            (PortAt::ResultMember(k), Some(result)) => b.member(result, *k),
            (PortAt::Reference(k), _) => {
                let Some(&(_, local)) = references.iter().find(|(at, _)| at == k) else { continue };
                b.load(local)
            }
            (PortAt::Global(global), _) if !Direct::writes(port) => {
                let pointer = b.global(*global);
                b.load(pointer)
            }
            (PortAt::Member(global, member), _) => {
                let pointer = reach(b, *global, &[*member]);
                b.load(pointer)
            }
            (PortAt::Part { global, path }, _) => {
                let pointer = reach(b, *global, path);
                b.load(pointer)
            }
            // A trace stands there already. `Program` places outputs nowhere else; a slot left out is
            // found by the sentinel.
            _ => {
                offset += port.field.shape.words() as u32;
                continue;
            }
        };
        words::store(b, module, out, &mut offset, port.ty, value);
    }
}
