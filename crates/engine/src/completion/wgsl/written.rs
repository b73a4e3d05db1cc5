//! Declarations in WGSL.

use std::collections::HashSet;
use std::fmt::Write as _;

use base::text::{Assembly, SourceFile, Span};
use syntax::types::Type;
use syntax::wgsl::plain;

use super::super::declared::{Form, Gives, Param, Shape, Stand, after_arguments};

/// Number of the first binding that is assumed: beyond those of any text.
const FIRST: usize = 1 << 20;

/// The name of an input that holds what a function gives.
pub(super) fn value(stand: &Stand) -> String {
    format!("{}_value", stand.name.trim_end_matches('_'))
}

/// The text with declarations behind it; `passed` are the structures that entry points take or give.
pub(super) fn put(stands: &[&Stand], file: &SourceFile, passed: &HashSet<String>) -> SourceFile {
    let (mut out, end) = (Assembly::new(), file.text().len());
    out.copy(file, Span::new(0, end));
    let mut all = String::from("\n");
    for (k, stand) in stands.iter().enumerate() {
        declaration(&mut all, stand, FIRST + k, passed.contains(&stand.name));
    }
    out.insert(&all, file, end);
    out.finish(file.name())
}

fn typed(shape: &Shape) -> String {
    match shape.count {
        Some(count) => format!("array<{}, {count}>", shape.ty),
        None => shape.ty.clone(),
    }
}

fn declaration(out: &mut String, stand: &Stand, binding: usize, passed: bool) {
    let name = &stand.name;
    let bound = |space: &str| format!("@group(0) @binding({binding}) var{space} ");
    let _ = match &stand.form {
        // Only texts of GLSL have lines for the preprocessor here, and files in them.
        Form::Include(_) | Form::File(..) => Ok(()),
        Form::Structure(members) => {
            let mut places = 0;
            let member = |(name, shape): &(String, Shape)| {
                let place = if passed { attribute(name, shape, &mut places) } else { String::new() };
                format!("{place}{name}: {}", typed(shape))
            };
            let members: Vec<String> = members.iter().map(member).collect();
            writeln!(out, "struct {name} {{ {} }}", members.join(", "))
        }
        Form::Variable("const", shape) => writeln!(out, "const {name}: {} = {};", shape.ty, constant(&shape.ty)),
        Form::Variable("alias", shape) => writeln!(out, "alias {name} = {};", shape.ty),
        Form::Variable("override", shape) => writeln!(out, "override {name}: {} = {};", shape.ty, constant(&shape.ty)),
        Form::Variable("handle", shape) => writeln!(out, "{}{name}: {};", bound(""), shape.ty),
        Form::Variable(space @ ("private" | "workgroup"), shape) => {
            writeln!(out, "var<{space}> {name}: {};", typed(shape))
        }
        Form::Variable(space, shape) => writeln!(out, "{}{name}: {};", bound(&format!("<{space}>")), typed(shape)),
        Form::Function(overloads, gives) => {
            let params = overloads.first().map(Vec::as_slice).unwrap_or_default();
            function(out, stand, params, gives, &bound("<uniform>"))
        }
    };
}

fn function(out: &mut String, stand: &Stand, params: &[Param], gives: &Gives, bound: &str) -> std::fmt::Result {
    let gives = match gives {
        Gives::Always(ty) => ty.as_str(),
        Gives::First => params.first().map_or("f32", |param| param.ty.as_str()),
    };
    let head = |(k, param): (usize, &Param)| match param.out {
        true => format!("a{k}: ptr<function, {}>", param.ty),
        false => format!("a{k}: {}", param.ty),
    };
    let head: Vec<String> = params.iter().enumerate().map(head).collect();
    let (name, head, input) = (&stand.name, head.join(", "), value(stand));
    match gives {
        "void" => writeln!(out, "fn {name}({head}) {{}}"),
        // No host can give a truth value.
        "bool" => {
            writeln!(out, "{bound}{input}: u32;\nfn {name}({head}) -> bool {{ return {input} % 2u == 1u; }}")
        }
        _ => {
            let after = after_arguments(params, gives, &real);
            writeln!(out, "{bound}{input}: {gives};\nfn {name}({head}) -> {gives} {{ return {input}{after}; }}")
        }
    }
}

/// The type of that name; none for half floats, which stand in no sum with others.
fn real(name: &str) -> Option<Type> {
    plain(name).filter(|_| name != "f16" && !name.ends_with('h'))
}

fn constant(ty: &str) -> String {
    match ty {
        "bool" => "true".to_owned(),
        "u32" => "16u".to_owned(),
        "i32" => "16".to_owned(),
        ty if ty.starts_with("vec") => format!("{ty}(1)"),
        _ => "1.0".to_owned(),
    }
}

/// The place of a member of what goes from stage to stage: a position, or a number.
fn attribute(name: &str, shape: &Shape, places: &mut u32) -> String {
    if shape.count.is_some() {
        return String::new();
    }
    let builtin = match (name, shape.ty.as_str()) {
        ("instance_index", "u32") => Some("instance_index"),
        ("vertex_index", "u32") => Some("vertex_index"),
        ("is_front" | "front_facing", "bool") => Some("front_facing"),
        ("position" | "clip_position" | "frag_coord", "vec4f") => Some("position"),
        _ => None,
    };
    if let Some(builtin) = builtin {
        return format!("@builtin({builtin}) ");
    }
    let number = *places;
    *places += 1;
    let flat = if shape.ty.ends_with('u') || shape.ty.ends_with('i') || ["u32", "i32"].contains(&shape.ty.as_str()) {
        "@interpolate(flat) "
    } else {
        ""
    };
    format!("@location({number}) {flat}")
}
