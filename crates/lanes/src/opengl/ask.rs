//! From a kernel to a job: the author's texts, and what a driver is told about them.

use crate::{LaneError, buffers};
use base::value::{Field, Record};
use program::lower::Role;
use program::{Attribute, BoundBuffer, Count, Form, Kernel, Program, UniformPlace};
use syntax::interface::{Interface, Storage};
use syntax::{Profile, Shader};

use super::job::{self, Bound, CaptureKind, Job, Named, StorageBuffer, Text};
use super::{call, pass};

/// The job of a kernel.
///
/// # Errors
/// [`LaneError::Unsupported`] for what no stage of OpenGL runs, or transform feedback does not capture.
pub fn job(kernel: &Kernel) -> Result<Job, LaneError> {
    let program = &*kernel.program;
    if program.texts.is_empty() {
        return Err(unsupported("a program that is not written in GLSL"));
    }
    let shader = Shader::parse_with(&program.file, program.stage, &program.defines).shader;
    for (name, instead) in [("gl_VertexIndex", "gl_VertexID"), ("gl_InstanceIndex", "gl_InstanceID")] {
        if shader.builtin(name).is_some() {
            return Err(unsupported(format!("`{name}` of Vulkan; OpenGL has `{instead}`")));
        }
    }
    let interface = shader.interface();
    let mut texts: Vec<Text> = texts(program)?;
    let mut outputs = None;
    let mut buffers = Vec::new();
    let (stage, pass, attributes, fed) = match (&kernel.form, &program.role) {
        (Form::Vertex { attributes, .. }, Role::Vertex) => {
            let (attributes, fed) = plain(attributes, &kernel.invocation)?;
            (CaptureKind::Vertex, None, attributes, vec![fed])
        }
        (Form::Compute, Role::Vertex) => {
            let drawn = program.drawn().len();
            let (attributes, fed) = plain(&whole(&kernel.invocation, drawn)?, &kernel.invocation)?;
            (CaptureKind::Vertex, None, attributes, vec![fed])
        }
        // The vectors of its inputs are the same words in the same order, whatever the record calls them.
        (Form::Compute | Form::Vertex { .. }, Role::Function { name }) => {
            let call = call::call(&shader, name, &program.invocation_record(), &kernel.output.vertex)?;
            texts.push(call.text);
            outputs = Some(call.outputs);
            (CaptureKind::Vertex, None, call.attributes, vec![call.fed])
        }
        (Form::Geometry | Form::Compute, Role::Geometry(primitives)) => {
            if program.module.global_variables.iter().any(|(_, v)| v.name.as_deref() == Some("gl_PrimitiveIDIn")) {
                // Every primitive is a draw of its own, in which it has the number 0.
                return Err(unsupported(
                    "`gl_PrimitiveIDIn` cannot be set on this lane, where each primitive is drawn by itself",
                ));
            }
            let pass::Pass { text, attributes, fed } = pass::pass(&shader, *primitives, &kernel.invocation)?;
            (pass::kind(*primitives), Some(text), attributes, fed)
        }
        (Form::Dispatch { groups, buffers: all }, Role::Compute) => {
            buffers = storage(program, interface, all)?;
            // What is read back are words of buffers, and no outputs of a stage.
            outputs = Some(Vec::new());
            (CaptureKind::Dispatch { groups: *groups }, None, Vec::new(), Vec::new())
        }
        (_, Role::Fragment | Role::Compute) => return Err(unsupported("stages other than vertex and geometry")),
        (Form::Vertex { .. } | Form::Geometry | Form::Uniforms | Form::Constants | Form::Dispatch { .. }, _) => {
            return Err(unsupported("inputs of this kind; it feeds attributes and uniforms"));
        }
    };
    let uniforms = kernel.case.fields().iter().map(|f| uniform(interface, f)).collect::<Result<_, _>>()?;
    let named = || kernel.output.vertex.fields().iter().map(|f| output(interface, f)).collect::<Result<_, _>>();
    let outputs = outputs.map_or_else(named, Ok)?;
    let bound = |t: &program::Texture| Bound {
        name: t.name.clone(),
        kind: t.kind,
        size: t.contents.size(),
        words: t.contents.words().to_vec(),
    };
    Ok(Job {
        texts,
        stage,
        pass,
        attributes,
        fed,
        vertex: number(program, Count::Vertex),
        instance: number(program, Count::Instance),
        invocation_words: kernel.invocation.words(),
        case_words: kernel.case.words(),
        uniforms,
        outputs,
        textures: program.textures.iter().map(bound).collect(),
        buffers,
    })
}

/// The storage buffers of a dispatch, by the names of their blocks.
fn storage(program: &Program, interface: &Interface, all: &[BoundBuffer]) -> Result<Vec<StorageBuffer>, LaneError> {
    for block in &interface.blocks {
        for of_vulkan in ["set", "push_constant"] {
            if block.qualifiers.layout_entry(of_vulkan).is_some() {
                return Err(unsupported(format!("`{of_vulkan}` of Vulkan, which OpenGL lacks")));
            }
        }
    }
    let one = |about: &BoundBuffer| {
        let name = buffers::block(program, about);
        let block = interface.blocks.iter().find(|b| b.storage == Storage::Buffer && b.name.name == name);
        let block = block.ok_or_else(|| unsupported(format!("a buffer that is no block of the text: `{name}`")))?;
        if ["std430", "std140"].iter().all(|layout| block.qualifiers.layout_entry(layout).is_none()) {
            return Err(unsupported(format!(
                "the buffer `{name}`, whose layout OpenGL leaves to the driver; write `layout(std430)`"
            )));
        }
        let places = |list: &[UniformPlace]| list.iter().map(|place| (place.word, place.byte)).collect();
        Ok(StorageBuffer {
            block: name.to_owned(),
            bytes: about.bytes as usize,
            before: places(&about.before),
            after: places(&about.after),
        })
    };
    all.iter().filter(|about| !about.uniform).map(one).collect()
}

/// The word of the record of an invocation that is a number of the draw.
fn number(program: &Program, count: Count) -> Option<u32> {
    program.drawn().iter().find(|d| d.count == count).map(|d| d.word)
}

pub(super) fn unsupported(what: impl Into<String>) -> LaneError {
    LaneError::Unsupported(what.into())
}

/// The texts as a driver compiles them: nothing is changed, and macros of the host stand behind `#version`, where a
/// host puts them.
fn texts(program: &Program) -> Result<Vec<Text>, LaneError> {
    let one = |file: &base::text::SourceFile| {
        let shader = Shader::parse_with(file, program.stage, &program.defines).shader;
        let version = shader.version();
        if version.profile == Profile::Compatibility && version.number >= 150 {
            return Err(unsupported("the compatibility profile"));
        }
        // A byte order mark is not GLSL.
        let bom = if file.text().starts_with('\u{feff}') { '\u{feff}'.len_utf8() } else { 0 };
        let behind = version.span.map_or(bom, |span| {
            let rest = &file.text()[span.end..];
            span.end + rest.find('\n').map_or(rest.len(), |at| at + 1)
        });
        let (head, tail) = (&file.text()[bom..behind], &file.text()[behind..]);
        let mut defines: Vec<(&str, &str)> = program.defines.iter().map(|(n, v)| (n.as_str(), v.as_str())).collect();
        if matches!(program.role, Role::Function { .. }) && shader.function("main").is_some() {
            defines.push(call::OTHER_MAIN);
        }
        let macros: String = defines.iter().map(|(name, value)| format!("#define {name} {value}\n")).collect();
        let newline = if macros.is_empty() || head.is_empty() || head.ends_with('\n') { "" } else { "\n" };
        Ok(Text {
            text: format!("{head}{newline}{macros}{tail}"),
            version: version.number,
            es: version.profile == Profile::Es,
            before: head.lines().count() as u32,
            added: defines.len() as u32,
        })
    };
    program.texts.iter().map(one).collect()
}

/// The attributes of a record, each with all its components; behind them are so many numbers of the draw.
fn whole(record: &Record, drawn: usize) -> Result<Vec<Attribute>, LaneError> {
    let one = |(k, field): (usize, &Field)| {
        if field.shape.columns > 1 || field.shape.array.is_some() {
            return Err(unsupported(format!("attribute `{}` of type `{}`", field.name, field.shape)));
        }
        Ok(Attribute { field: field.clone(), location: k as u32, components: field.shape.rows })
    };
    let attributes = record.fields().len().saturating_sub(drawn);
    record.fields()[..attributes].iter().enumerate().map(one).collect()
}

/// Attributes of a vertex stage, and the words that they are fed with.
fn plain(attributes: &[Attribute], record: &Record) -> Result<(Vec<job::Attribute>, Vec<u32>), LaneError> {
    let (mut all, mut fed) = (Vec::new(), Vec::new());
    for (k, attribute) in attributes.iter().enumerate() {
        let field = &attribute.field;
        if field.name.starts_with("gl_") {
            return Err(unsupported(format!("`{}`, an attribute of the compatibility profile", field.name)));
        }
        if attribute.components > field.shape.rows {
            let (given, name, shape) = (attribute.components, &field.name, field.shape);
            return Err(unsupported(format!("{given} components for attribute `{name}` of type `{shape}`")));
        }
        let start = record.range(k).start as u32;
        fed.extend((0..u32::from(attribute.components)).map(|c| start + c));
        all.push(job::Attribute {
            name: field.name.clone(),
            scalar: field.shape.scalar,
            components: attribute.components,
        });
    }
    Ok((all, fed))
}

fn uniform(interface: &Interface, field: &Field) -> Result<Named, LaneError> {
    if field.name.starts_with("gl_") {
        return Err(unsupported(format!("`{}`, state of the compatibility profile", field.name)));
    }
    Ok(Named { name: gl_name(interface, Storage::Uniform, &field.name), shape: field.shape })
}

fn output(interface: &Interface, field: &Field) -> Result<Named, LaneError> {
    const KNOWN: [&str; 4] = ["gl_Position", "gl_PointSize", "gl_ClipDistance", "gl_CullDistance"];
    if field.name.starts_with("gl_") && !KNOWN.contains(&field.name.as_str()) {
        return Err(unsupported(format!("the output `{}`", field.name)));
    }
    Ok(Named { name: gl_name(interface, Storage::Out, &field.name), shape: field.shape })
}

/// The name that OpenGL has for a member of a block with an instance: that of the block comes first.
fn gl_name(interface: &Interface, storage: Storage, name: &str) -> String {
    let (root, rest) = name.split_at(name.find(['.', '[']).unwrap_or(name.len()));
    let named =
        |b: &&syntax::interface::Block| b.storage == storage && b.instance.as_ref().is_some_and(|i| i.name == root);
    match interface.blocks.iter().find(named) {
        Some(block) => format!("{}{rest}", block.name.name),
        None => name.to_owned(),
    }
}

/// The place in the author's text of a line and column of what the driver compiled.
pub fn place(program: &Program, text: usize, asked: &Text, (line, column): (u32, u32)) -> Option<String> {
    let file = program.texts.get(text)?;
    let line = match line {
        line if line <= asked.before => line,
        line if line <= asked.before + asked.added => return Some("a macro given from outside".to_owned()),
        line => line - asked.added,
    };
    let position = base::text::Position { line: line as usize, column: column.max(1) as usize };
    Some(file.locate(file.offset(position)))
}
