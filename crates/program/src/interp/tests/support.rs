//! Runs single functions of small shaders.

use std::sync::Arc;

use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use naga::{AddressSpace, BuiltIn, GlobalVariable, Handle, Module, TypeInner};

use super::super::{Binary32, Binary64, Binding, Domain, Executable, FUEL, InterpError, Meaning, Subject};
use crate::{Entry, PortAt};
use base::value::{Batch, Field, Record, Scalar, Shape};

pub(in crate::interp) fn wgsl(text: &str) -> (Module, ModuleInfo) {
    let module = naga::front::wgsl::parse_str(text).unwrap_or_else(|e| panic!("{}", e.emit_to_string(text)));
    validated(module)
}

/// The only entry point of a text, and its workgroup size.
pub(in crate::interp) fn kernel(text: &str) -> (Executable, [u32; 3]) {
    let (module, info) = wgsl(text);
    let of_host = |v: &GlobalVariable| !matches!(v.space, AddressSpace::Private | AddressSpace::Handle);
    let shared: Vec<_> = module.global_variables.iter().filter(|(_, v)| of_host(v)).map(|(handle, _)| handle).collect();
    let point = &module.entry_points[0];
    let built_in = |(k, argument): (u32, &naga::FunctionArgument)| match argument.binding {
        Some(naga::Binding::BuiltIn(built_in)) => (k, built_in),
        _ => panic!("{argument:?}"),
    };
    let built_ins: Vec<_> = (0..).zip(&point.function.arguments).map(built_in).collect();
    (entry_point((&module, &info), &shared, &built_ins).unwrap(), point.workgroup_size)
}

/// The first entry point of a module, with this memory and these built-in values of its arguments.
pub(super) fn entry_point(
    (module, info): (&Module, &ModuleInfo),
    shared: &[Handle<GlobalVariable>],
    built_ins: &[(u32, BuiltIn)],
) -> Result<Executable, InterpError> {
    Executable::compile(&Subject {
        module,
        info,
        entry: Entry::Point(0),
        inputs: &[],
        uniforms: &[],
        outputs: &[],
        built_ins,
        textures: &[],
        max_vertices: None,
        shared,
        dispatch: None,
        manners: None,
        lowered: false,
        covered: false,
    })
}

pub(super) fn glsl(text: &str) -> (Module, ModuleInfo) {
    let options = naga::front::glsl::Options::from(naga::ShaderStage::Compute);
    let text = format!("#version 450 core\nlayout(local_size_x = 1) in;\n{text}\nvoid main() {{}}\n");
    let module = naga::front::glsl::Frontend::default().parse(&options, &text);
    validated(module.unwrap_or_else(|e| panic!("{}", e.emit_to_string(&text))))
}

fn validated(module: Module) -> (Module, ModuleInfo) {
    let info = Validator::new(ValidationFlags::all(), Capabilities::all()).validate(&module);
    let info = info.unwrap_or_else(|e| panic!("{:?}", e.into_inner()));
    (module, info)
}

/// Compiles the function `f`: its arguments in, its result and what it has pointers to out.
pub(super) fn compile(shader: &(Module, ModuleInfo)) -> Result<Executable, InterpError> {
    compile_with(shader, true)
}

/// The same; what it has pointers to is only fed when asked for.
pub(super) fn compile_with((module, info): &(Module, ModuleInfo), feeds: bool) -> Result<Executable, InterpError> {
    let (handle, function) = module.functions.iter().find(|(_, f)| f.name.as_deref() == Some("f")).unwrap();
    let mut inputs = Vec::new();
    let mut outputs = Vec::new();
    if let Some(result) = &function.result {
        outputs.push(Binding { name: "return".into(), ty: result.ty, at: PortAt::Result, backing: None });
    }
    for (k, argument) in function.arguments.iter().enumerate() {
        let name = argument.name.clone().unwrap_or_default();
        let (ty, at) = match module.types[argument.ty].inner {
            TypeInner::Pointer { base, .. } => (base, PortAt::Reference(k as u32)),
            _ => (argument.ty, PortAt::Argument(k as u32)),
        };
        let binding = Binding { name, ty, at, backing: None };
        if matches!(binding.at, PortAt::Reference(_)) {
            outputs.push(binding.clone());
        }
        if feeds || matches!(binding.at, PortAt::Argument(_)) {
            inputs.push(binding);
        }
    }
    let subject = Subject {
        module,
        info,
        entry: Entry::Function(handle),
        inputs: &inputs,
        uniforms: &[],
        outputs: &outputs,
        built_ins: &[],
        textures: &[],
        max_vertices: None,
        shared: &[],
        dispatch: None,
        manners: None,
        lowered: false,
        covered: false,
    };
    Executable::compile(&subject)
}

/// A batch of rows of words.
pub(super) fn batch(rows: &[Vec<u32>]) -> Batch {
    let words = rows[0].len();
    let shape = Shape::vector(Scalar::U32, 1);
    let fields = (0..words).map(|k| Field { name: format!("w{k}"), shape }).collect();
    Batch {
        invocation_record: Arc::new(Record::new(fields)),
        case_record: Arc::default(),
        per_case: 1,
        invocations: rows.concat(),
        cases: Vec::new(),
    }
}

pub(super) fn run<D: Domain + Default>(shader: &(Module, ModuleInfo), rows: &[Vec<u32>]) -> Meaning<D::Word> {
    let executable = compile(shader).unwrap();
    executable.run::<D>(&batch(rows), FUEL).unwrap()
}

/// The results for one row, in binary64.
pub(super) fn row(shader: &(Module, ModuleInfo), row: &[u32]) -> Vec<f64> {
    run::<Binary64>(shader, &[row.to_vec()]).vertex(0, 0).to_vec()
}

/// The results for one row, as bits of strict binary32.
pub(super) fn row32(shader: &(Module, ModuleInfo), row: &[u32]) -> Vec<u32> {
    run::<Binary32>(shader, &[row.to_vec()]).vertex(0, 0).to_vec()
}

pub(super) fn floats(values: &[f32]) -> Vec<u32> {
    values.iter().map(|value| value.to_bits()).collect()
}

pub(super) fn ints(values: &[i32]) -> Vec<u32> {
    values.iter().map(|value| value.cast_unsigned()).collect()
}

#[track_caller]
pub(super) fn assert_near(found: &[f64], expected: &[f64], what: &str) {
    assert!(is_near(found, expected), "{what}: {found:?}, expected {expected:?}");
}

pub(super) fn is_near(found: &[f64], expected: &[f64]) -> bool {
    let near = |(a, b): (&f64, &f64)| a == b || (a - b).abs() <= 4e-15 * b.abs() || (a.is_nan() && b.is_nan());
    found.len() == expected.len() && found.iter().zip(expected).all(near)
}
