//! Every shipped shader in every language: the text itself, what naga reads back from it, and what
//! the validators of Khronos say about it.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use naga::proc::Layouter;
use naga::{AddressSpace, Binding, Handle, Module, Type, TypeInner};
use program::{Language, Program, Translation, read_back};

use crate::lowering::{Case, UNIFORMS, compare_snapshot, each_shader, shipped, stage};

fn check(name: &str) {
    compare_all(&shipped(name));
}

fn compare_all(case: &Case) {
    let program = case.program();
    for language in Language::ALL {
        let name = format!("{}.{language}", case.file.name());
        match program.translate(language) {
            Ok(translation) => {
                let back = read_back(&translation, language, &program.role).unwrap();
                compare_snapshot("translate", &name, &readable(&translation, back.as_ref()));
                if let Some(back) = back {
                    assert_eq!(interface(&back), interface(&translated(&program)), "{name}");
                }
            }
            Err(error) => compare_snapshot("translate", &name, &format!("error: {error}\n")),
        }
    }
}

each_shader!(check);

#[test]
fn uniforms_keep_their_places_in_every_language() {
    compare_all(&stage("uniforms.vert", UNIFORMS));
}

/// A translation as people read it. No disassembler of SPIR-V is at hand, so a binary is shown as the
/// version and length of the module and as the WGSL of what naga reads in it. That leaves numbers of
/// identifiers out, which would differ with every change of the writer.
fn readable(translation: &Translation, back: Option<&Module>) -> String {
    match translation {
        Translation::Text(text) => text.clone(),
        Translation::Words(words) => {
            let module = back.expect("SPIR-V is read back");
            let flags = naga::valid::ValidationFlags::all();
            let info = naga::valid::Validator::new(flags, naga::valid::Capabilities::all()).validate(module).unwrap();
            let wgsl = naga::back::wgsl::write_string(module, &info, naga::back::wgsl::WriterFlags::empty()).unwrap();
            let version = words[1];
            let (major, minor) = (version >> 16 & 0xff, version >> 8 & 0xff);
            format!("SPIR-V {major}.{minor}, {} words. Read back, as WGSL:\n\n{wgsl}", words.len())
        }
    }
}

/// The module that is translated: the stage itself, or the kernel of what naga has no stage for.
fn translated(program: &Program) -> Module {
    match program.role {
        program::lower::Role::Vertex | program::lower::Role::Fragment | program::lower::Role::Compute => {
            program.module.clone()
        }
        program::lower::Role::Geometry(_) | program::lower::Role::Function { .. } => {
            program.compute_kernel().unwrap().module
        }
    }
}

/// What a host sees of a module: stages, what they take and give at which location, and buffers
/// with their size. Names are left out: GLSL knows one name for every entry point. A uniform buffer is as long as a
/// multiple of 16 bytes: naga writes what it holds as a structure in GLSL, which std140 fills to that.
fn interface(module: &Module) -> BTreeMap<String, String> {
    let mut found = BTreeMap::new();
    for entry in &module.entry_points {
        let stage = format!("{:?}", entry.stage);
        found.insert(format!("{stage} workgroup"), format!("{:?}", entry.workgroup_size));
        for argument in &entry.function.arguments {
            bound(module, &format!("{stage} in"), argument.binding.as_ref(), argument.ty, &mut found);
        }
        if let Some(result) = &entry.function.result {
            bound(module, &format!("{stage} out"), result.binding.as_ref(), result.ty, &mut found);
        }
    }
    let mut layouter = Layouter::default();
    layouter.update(module.to_ctx()).unwrap();
    for (_, global) in module.global_variables.iter() {
        let Some(binding) = global.binding else { continue };
        let space = match global.space {
            AddressSpace::Uniform => "uniform",
            AddressSpace::Storage { .. } => "storage",
            _ => "other",
        };
        let size = match global.space {
            AddressSpace::Uniform => layouter[global.ty].size.next_multiple_of(16),
            _ => layouter[global.ty].size,
        };
        found.insert(format!("{space} {}.{}", binding.group, binding.binding), format!("{size} bytes"));
    }
    found
}

fn bound(
    module: &Module,
    side: &str,
    binding: Option<&Binding>,
    ty: Handle<Type>,
    found: &mut BTreeMap<String, String>,
) {
    let mut name = String::new();
    match (binding, &module.types[ty].inner) {
        (Some(Binding::BuiltIn(built_in)), _) => write!(name, "{side} {built_in:?}").unwrap(),
        (Some(Binding::Location { location, .. }), _) => write!(name, "{side} location {location}").unwrap(),
        (None, TypeInner::Struct { members, .. }) => {
            for member in members {
                bound(module, side, member.binding.as_ref(), member.ty, found);
            }
            return;
        }
        (None, inner) => panic!("{inner:?} without binding"),
    }
    found.insert(name, format!("{:?}", module.types[ty].inner));
}

#[test]
fn a_moved_location_and_a_longer_buffer_show_in_the_interface() {
    let wgsl = |location: u32, count: u32| {
        let text = format!(
            "@group(0) @binding(1) var<uniform> u: array<vec4<f32>, {count}>;
             @vertex fn main(@location({location}) p: vec4<f32>) -> @builtin(position) vec4<f32> {{ return p * u[0]; }}"
        );
        interface(&naga::front::wgsl::parse_str(&text).unwrap())
    };
    assert_eq!(wgsl(0, 2), wgsl(0, 2));
    assert_ne!(wgsl(0, 2), wgsl(1, 2));
    assert_ne!(wgsl(0, 2), wgsl(0, 3));
}
