//! The compute kernel around the author's own text in WGSL, for a lane whose front end reads WGSL itself: nothing that
//! naga made of the text is in it. What names a stage or a uniform buffer is edited, and an entry point of our own that
//! feeds the author's function stands behind the text.

use std::fmt::Write;

use naga::{Binding, Handle, Module, Type, TypeInner};

use super::{ENTRY_POINT, WORKGROUP, shape_of};
use crate::lower::Role;
use crate::{Entry, Port, PortAt, Program};
use base::text::{Edit, EditList};
use base::value::{Scalar, Shape};
use syntax::Shader;
use syntax::wgsl::{DeclarationKind, ModuleItem};

impl Program {
    /// The text of the kernel, whose bindings are those of [`Program::compute_kernel`]. `None` for a program that is not
    /// written in WGSL, and for one that takes more than numbers or needs more around it.
    pub fn author_kernel(&self) -> Option<String> {
        let tree = self.constants.wgsl()?;
        let plain = self.textures.is_empty() && self.memory.is_empty() && !self.instrumented;
        // What stops at a derivative or is discarded is no longer the author's text.
        let stops = self.module.global_variables.iter().any(|(_, v)| v.name.as_deref() == Some("sc_stopped"));
        if !plain || stops || self.check_fed().is_err() {
            return None;
        }
        let edited = edits(tree, self)?.apply(tree.file().text()).ok()?.text;
        Some(format!("{}\n{}", edited.trim_start_matches('\u{feff}'), Harness { program: self }.text()?))
    }
}

/// Edits that leave a text without stages and without uniform buffers.
fn edits(tree: &Shader, program: &Program) -> Option<EditList> {
    let mut edits = EditList::new();
    for item in &tree.wgsl()?.items {
        match item {
            ModuleItem::Variable(variable) if variable.space.first().is_some_and(|word| word.name == "uniform") => {
                for attribute in &variable.attributes {
                    edits.push(Edit::delete(attribute.span));
                }
                edits.push(Edit::replace(variable.space[0].span, "private"));
            }
            ModuleItem::Variable(variable) if variable.kind == DeclarationKind::Override => {
                let text = tree.file().slice(variable.span);
                let at = text.find("override")?;
                for attribute in &variable.attributes {
                    edits.push(Edit::delete(attribute.span));
                }
                let start = variable.span.start + at;
                edits.push(Edit::replace(base::text::Span::new(start, start + "override".len()), "const"));
                let given = program.defines.iter().find(|(name, _)| *name == variable.name.name);
                match (given, variable.value) {
                    (Some((_, value)), Some(id)) => edits.push(Edit::replace(tree.expr(id).span, value.as_str())),
                    (Some((_, value)), None) => {
                        let end = variable.span.start + text.trim_end().trim_end_matches(';').len();
                        edits.push(Edit::insert(end, format!(" = {value}")));
                    }
                    (None, Some(_)) => {}
                    // Nothing that is run uses it.
                    (None, None) => return None,
                }
            }
            ModuleItem::Function { .. } => {
                for attribute in item.attributes() {
                    let of_stage = !matches!(attribute.name.name.as_str(), "must_use" | "diagnostic");
                    if of_stage {
                        edits.push(Edit::delete(attribute.span));
                    }
                }
            }
            _ => {}
        }
    }
    Some(edits)
}

/// The entry point that feeds the author's function.
struct Harness<'p> {
    program: &'p Program,
}

/// The text of a type.
fn type_text(module: &Module, ty: Handle<Type>) -> Option<String> {
    if let (Some(name), TypeInner::Struct { .. }) = (&module.types[ty].name, &module.types[ty].inner) {
        return Some(name.clone());
    }
    if let TypeInner::Array { base, size: naga::ArraySize::Constant(n), .. } = module.types[ty].inner {
        return Some(format!("array<{}, {n}>", type_text(module, base)?));
    }
    shape_of(module, ty).map(shape_text)
}

fn scalar_text(scalar: Scalar) -> &'static str {
    match scalar {
        Scalar::F32 => "f32",
        Scalar::I32 => "i32",
        Scalar::U32 => "u32",
        Scalar::Bool => "bool",
    }
}

fn shape_text(shape: Shape) -> String {
    let scalar = scalar_text(shape.scalar);
    match (shape.columns, shape.rows) {
        (1, 1) => scalar.to_owned(),
        (1, rows) => format!("vec{rows}<{scalar}>"),
        (columns, rows) => format!("mat{columns}x{rows}<{scalar}>"),
    }
}

/// A value of this shape from the words of an array, from a word on.
fn value_text(shape: Shape, array: &str, base: &str, offset: &mut usize) -> String {
    let mut number = || {
        let word = format!("{array}[{base} + {}u]", *offset);
        *offset += 1;
        match shape.scalar {
            Scalar::U32 => word,
            Scalar::Bool => format!("({word} != 0u)"),
            other => format!("bitcast<{}>({word})", scalar_text(other)),
        }
    };
    let mut vector = || {
        let parts: Vec<String> = (0..shape.rows).map(|_| number()).collect();
        match shape.rows {
            1 => parts.concat(),
            rows => format!("vec{rows}<{}>({})", scalar_text(shape.scalar), parts.join(", ")),
        }
    };
    let mut element = || match shape.columns {
        1 => vector(),
        columns => {
            let all: Vec<String> = (0..columns).map(|_| vector()).collect();
            format!("{}({})", shape_text(shape.element()), all.join(", "))
        }
    };
    match shape.array {
        None => element(),
        Some(n) => {
            let all: Vec<String> = (0..n).map(|_| element()).collect();
            format!("array<{}, {n}>({})", shape_text(shape.element()), all.join(", "))
        }
    }
}

/// Stores the words of a value.
fn store_text(out: &mut String, shape: Shape, value: &str, offset: &mut usize) {
    let element = shape.element();
    for k in 0..shape.elements() {
        let at = if shape.array.is_some() { format!("[{k}]") } else { String::new() };
        for column in 0..element.columns {
            let column = if element.columns > 1 { format!("[{column}]") } else { String::new() };
            for row in 0..element.rows {
                let row = if element.rows > 1 { format!("[{row}]") } else { String::new() };
                let part = format!("{value}{at}{column}{row}");
                let word = match shape.scalar {
                    Scalar::U32 => part,
                    Scalar::Bool => format!("select(0u, 1u, {part})"),
                    Scalar::F32 | Scalar::I32 => format!("bitcast<u32>({part})"),
                };
                let _ = writeln!(out, "    sc_outputs[sc_out + {}u] = {word};", *offset);
                *offset += 1;
            }
        }
    }
}

impl Harness<'_> {
    fn text(&self) -> Option<String> {
        let program = self.program;
        let layout = program.output_layout();
        let words = |ports: &[Port]| ports.iter().map(|port| port.field.shape.words()).sum::<usize>();
        let mut text = "@group(0) @binding(0) var<uniform> sc_params: vec4<u32>;\n\
             @group(0) @binding(1) var<storage, read_write> sc_outputs: array<u32>;\n\
             @group(0) @binding(2) var<storage, read> sc_invocations: array<u32>;\n\
             @group(0) @binding(3) var<storage, read> sc_cases: array<u32>;\n"
            .to_owned();
        let (inputs, cases, record) = (words(&program.inputs), words(&program.uniforms), layout.words());
        let _ = writeln!(
            text,
            "@compute @workgroup_size({WORKGROUP})\n\
             fn {ENTRY_POINT}(@builtin(global_invocation_id) sc_id: vec3<u32>) {{\n  \
             if (sc_id.x < sc_params.x) {{\n    let sc_in = sc_id.x * {inputs}u;\n    \
             let sc_case = (sc_id.x / sc_params.y) * {cases}u;\n    let sc_out = sc_id.x * {record}u;"
        );
        let mut offset = 0;
        for port in &program.uniforms {
            // The name of a part is the way to it.
            let value = value_text(port.field.shape, "sc_cases", "sc_case", &mut offset);
            let _ = writeln!(text, "    {} = {value};", port.field.name);
        }
        let (call, mut before) = match (&program.role, program.entry) {
            (Role::Function { name }, Entry::Function(_)) => self.function(name)?,
            (_, Entry::Point(index)) => self.point(index)?,
            _ => return None,
        };
        text.push_str(&std::mem::take(&mut before));
        let gives = program.outputs.iter().any(|port| is_member(port) || returned(&port.field.name).is_some());
        let _ = writeln!(text, "    {}{call};", if gives { "let sc_returned = " } else { "" });
        let _ = writeln!(text, "    sc_outputs[sc_out] = sc_params.z ^ sc_id.x;");
        let mut offset = layout.header_words();
        for port in &program.outputs {
            let name = &port.field.name;
            let value = match returned(name) {
                _ if is_member(port) => format!("sc_returned.{name}"),
                Some(rest) => format!("sc_returned{rest}"),
                None => format!("sc_{name}"),
            };
            store_text(&mut text, port.field.shape, &value, &mut offset);
        }
        text.push_str("  }\n}\n");
        Some(text)
    }

    /// The call of an entry point with its inputs.
    fn point(&self, index: usize) -> Option<(String, String)> {
        let program = self.program;
        let module = &program.stage_module.as_deref()?.0;
        let point = module.entry_points.first()?;
        let flat = &program.module.entry_points[index].function.arguments;
        let mut next = 0;
        let mut take = || {
            let at = PortAt::Argument(next);
            let argument = flat.get(next as usize)?;
            next += 1;
            let mut offset = 0;
            for port in &program.inputs {
                if port.at == at {
                    return Some(value_text(port.field.shape, "sc_invocations", "sc_in", &mut offset));
                }
                offset += port.field.shape.words();
            }
            // Built-in values of a compute stage are those of the first invocation of a dispatch.
            let built_in = matches!(argument.binding, Some(Binding::BuiltIn(_)));
            built_in.then(|| type_text(&program.module, argument.ty)).flatten().map(|ty| format!("{ty}()"))
        };
        let mut arguments = Vec::new();
        for argument in &point.function.arguments {
            arguments.push(match &module.types[argument.ty].inner {
                TypeInner::Struct { members, .. } if argument.binding.is_none() => {
                    let parts: Option<Vec<String>> = members.iter().map(|_| take()).collect();
                    format!("{}({})", type_text(module, argument.ty)?, parts?.join(", "))
                }
                _ => take()?,
            });
        }
        Some((format!("{}({})", point.name, arguments.join(", ")), String::new()))
    }

    /// The call of a function with its parameters, whose pointers are variables.
    fn function(&self, name: &str) -> Option<(String, String)> {
        let (module, program) = (&self.program.module, self.program);
        let body = format!("{name}_body");
        let find = |name: &str| module.functions.iter().find(|(_, f)| f.name.as_deref() == Some(name));
        let (_, function) = find(&body).or_else(|| find(name))?;
        let (mut arguments, mut before) = (Vec::new(), String::new());
        for argument in &function.arguments {
            let own = argument.name.as_deref()?;
            let (ty, pointer) = match module.types[argument.ty].inner {
                TypeInner::Pointer { base, space: naga::AddressSpace::Function } => (base, true),
                TypeInner::Pointer { .. } => return None,
                _ => (argument.ty, false),
            };
            let mut offset = 0;
            let mut parts = Vec::new();
            for port in &program.inputs {
                let rest = port.field.name.strip_prefix(own);
                if rest.is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '['])) {
                    let mut at = offset;
                    let value = value_text(port.field.shape, "sc_invocations", "sc_in", &mut at);
                    parts.push((port.field.name.as_str(), value));
                }
                offset += port.field.shape.words();
            }
            let value = built(module, ty, own, &parts)?;
            if pointer {
                let _ = writeln!(before, "    var sc_{own} = {value};");
                arguments.push(format!("&sc_{own}"));
            } else {
                arguments.push(value);
            }
        }
        Some((format!("{name}({})", arguments.join(", ")), before))
    }
}

/// The way to a part of what a function returns, by the name of the output.
fn returned(name: &str) -> Option<&str> {
    name.strip_prefix("return").filter(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
}

/// True for an output that is a member of what an entry point returns.
fn is_member(port: &Port) -> bool {
    matches!(port.at, PortAt::ResultMember(_))
}

/// A value put together of its parts by their names; zero where nothing is given.
fn built(module: &Module, ty: Handle<Type>, name: &str, parts: &[(&str, String)]) -> Option<String> {
    if let Some((_, value)) = parts.iter().find(|(own, _)| *own == name) {
        return Some(value.clone());
    }
    let text = type_text(module, ty)?;
    let inner: Vec<(Handle<Type>, String)> = match &module.types[ty].inner {
        TypeInner::Struct { members, .. } => {
            let named = |m: &naga::StructMember| Some((m.ty, format!("{name}.{}", m.name.as_ref()?)));
            members.iter().map(named).collect::<Option<Vec<_>>>()?
        }
        TypeInner::Array { base, size: naga::ArraySize::Constant(n), .. } => {
            (0..n.get()).map(|k| (*base, format!("{name}[{k}]"))).collect()
        }
        _ => return Some(format!("{text}()")),
    };
    let all: Option<Vec<String>> = inner.iter().map(|(ty, name)| built(module, *ty, name, parts)).collect();
    Some(format!("{text}({})", all?.join(", ")))
}

#[cfg(test)]
mod tests {
    use crate::{Chosen, ModuleText, Written};
    use base::text::SourceFile;

    fn kernel(text: &str, chosen: Chosen<'_>, values: &[(String, String)]) -> Option<String> {
        let read = ModuleText::read(&SourceFile::new("a.wgsl", text), Written::Wgsl).unwrap();
        let text = read.program(chosen, values).unwrap().author_kernel()?;
        // It is a whole text, whoever reads it.
        let module =
            naga::front::wgsl::parse_str(&text).unwrap_or_else(|e| panic!("{}\n{text}", e.emit_to_string(&text)));
        crate::validate(&module).unwrap();
        Some(text)
    }

    const TEXT: &str = "struct Camera { view: mat4x4f, eyes: array<vec4f, 2> }\n\
        @group(1) @binding(2) var<uniform> camera: Camera;\n@id(3) override gain: f32;\noverride bias = 1.0;\n\
        struct In { @location(0) p: vec3f, @location(1) part: i32 }\n\
        struct Out { @builtin(position) clip: vec4f, @location(0) @interpolate(flat) part: i32 }\n\
        @vertex fn main(in: In, @builtin(vertex_index) k: u32) -> Out {\n\
        return Out(camera.view * vec4f(in.p * gain + bias, f32(k)) + camera.eyes[1], in.part); }\n\
        struct Ray { o: vec3f, d: vec3f }\n\
        fn step(r: Ray, far: bool, t: ptr<function, f32>) -> Ray { *t += 1.0; return r; }\n";

    #[test]
    fn the_authors_text_stands_in_it() {
        let values = [("gain".to_owned(), "2.5".to_owned())];
        let chosen = Chosen::Point { stage: None, name: Some("main") };
        let text = kernel(TEXT, chosen, &values).unwrap();
        assert!(text.contains("const gain: f32 = 2.5;") && text.contains("var<private> camera: Camera;"), "{text}");
        assert!(text.contains("camera.view * vec4f(in.p * gain + bias, f32(k))"), "{text}");
        assert!(!text.contains("@vertex") && !text.contains("@id"), "{text}");
        let text =
            kernel(TEXT.replace("override gain: f32", "override gain = 1.0").as_str(), Chosen::Function("step"), &[]);
        assert!(text.unwrap().contains("step(Ray("));
    }

    #[test]
    fn what_needs_more_around_it_is_left_to_the_writer() {
        let text = "@fragment fn main(@location(0) x: f32) -> @location(0) f32 { return dpdx(x); }\n";
        assert_eq!(kernel(text, Chosen::Point { stage: None, name: None }, &[]), None);
    }
}
