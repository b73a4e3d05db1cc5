//! Functions that are run alone: a second text with a `main` that feeds the function and hands on what it gives. Texts of
//! one stage are linked, so the author's text stays as it is.

use std::fmt::Write as _;

use crate::LaneError;
use base::value::{Record, Scalar, Shape};
use syntax::symbols::Direction;
use syntax::{Profile, Shader};

use super::ask::unsupported;
use super::job::{Attribute, Named, Text};

/// What a text with a `main` of its own calls it: there is one in a stage.
pub const OTHER_MAIN: (&str, &str) = ("main", "sc_main");

/// A text that calls a function, and what it takes and gives.
pub struct Call {
    pub text: Text,
    pub attributes: Vec<Attribute>,
    /// Words of the record of an invocation.
    pub fed: Vec<u32>,
    pub outputs: Vec<Named>,
    /// The same text where it stands behind the author's, whose version and extensions it has.
    pub behind: String,
}

/// The call of a function of a text.
///
/// # Errors
/// [`LaneError::Unsupported`] for parameters that are no numbers, vectors, matrices or arrays of them, and for old
/// versions of GLSL that have no integers between stages.
pub fn call(shader: &Shader, name: &str, inputs: &Record, outputs: &Record) -> Result<Call, LaneError> {
    let version = shader.version();
    if version.profile == Profile::Es {
        return Err(unsupported("functions of GLSL ES"));
    }
    let old = version.number < 130;
    let (incoming, outgoing) = if old { ("attribute", "varying") } else { ("in", "out") };
    let function =
        shader.function(name).ok_or_else(|| unsupported(format!("`{name}`, which the text does not define")))?;
    let (mut declared, mut body) = (String::new(), String::new());
    let mut call = Call {
        text: Text { text: String::new(), version: version.number, es: false, before: 0, added: 0 },
        attributes: Vec::new(),
        fed: Vec::new(),
        outputs: Vec::new(),
        behind: String::new(),
    };
    let mut head = String::new();
    if let Some(span) = version.span {
        let _ = writeln!(head, "{}", shader.file().slice(span));
    }
    for extension in shader.extensions() {
        let _ = writeln!(head, "{}", shader.file().slice(extension.span));
    }
    let whole = |shape: Shape| old && shape.scalar != Scalar::F32;
    let (mut prototype, mut arguments) = (Vec::new(), Vec::new());
    for (k, parameter) in function.params.iter().enumerate() {
        let ty = &parameter.ty;
        let refused = || unsupported(format!("a parameter of type `{ty}`"));
        let shape = ty.shape().ok_or_else(refused)?;
        let own = parameter.name.as_ref().map(|n| n.name.as_str()).unwrap_or_default();
        let _ = writeln!(body, "    {};", declaration(shape, &format!("sc_v{k}")));
        if matches!(parameter.direction, Direction::In | Direction::InOut) {
            // A harness may call parameters by other names than the text; then they are in order.
            let at = inputs.index_of(own).or_else(|| {
                let before = function.params[..k].iter().filter(|p| p.direction != Direction::Out).count();
                (before < inputs.fields().len()).then_some(before)
            });
            let at = at.filter(|&at| inputs.fields()[at].shape == shape && !whole(shape));
            call.feed(inputs.range(at.ok_or_else(refused)?).start, shape, k, incoming, (&mut declared, &mut body));
        }
        let direction = match parameter.direction {
            Direction::In => "in",
            Direction::Out => "out",
            Direction::InOut => "inout",
        };
        prototype.push(format!("{direction} {ty}"));
        arguments.push(format!("sc_v{k}"));
    }
    // What comes in beside the parameters has nobody to feed it here.
    let fed: usize = function.params.iter().filter(|p| p.direction != Direction::Out).count();
    if fed != inputs.fields().len() {
        return Err(unsupported(format!("what `{name}` takes beside its parameters")));
    }
    let result = function.return_type.shape();
    let _ = writeln!(declared, "{} {name}({});", function.return_type, prototype.join(", "));
    let assigned = result.map_or_else(String::new, |shape| format!("{} = ", declaration(shape, "sc_result")));
    let _ = writeln!(body, "    {assigned}{name}({});", arguments.join(", "));
    let given: Vec<usize> =
        (0..function.params.len()).filter(|&k| function.params[k].direction != Direction::In).collect();
    for (k, field) in outputs.fields().iter().enumerate() {
        let in_order = || given.get(k).copied().filter(|&k| function.params[k].ty.shape() == Some(field.shape));
        let from = match function.params.iter().position(|p| p.name.as_ref().is_some_and(|n| n.name == field.name)) {
            Some(k) => format!("sc_v{k}"),
            None if field.name == "return" && result == Some(field.shape) => "sc_result".to_owned(),
            None if result.is_none() && outputs.fields().len() == given.len() && in_order().is_some() => {
                format!("sc_v{}", in_order().unwrap_or_default())
            }
            None => return Err(unsupported(format!("what `{name}` gives beside its parameters: `{}`", field.name))),
        };
        if whole(field.shape) {
            return Err(unsupported(format!("`{}` between stages of GLSL {}", field.shape, version.number)));
        }
        // Truth values do not leave a stage.
        let (shape, value) = match (field.shape.scalar, field.shape.array) {
            (Scalar::Bool, None) => {
                let shape = Shape { scalar: Scalar::U32, ..field.shape };
                (shape, format!("{shape}({from})"))
            }
            (Scalar::Bool, Some(_)) => return Err(unsupported(format!("the output `{}`", field.name))),
            _ => (field.shape, from),
        };
        let flat = if shape.scalar == Scalar::F32 { "" } else { "flat " };
        let to = format!("sc_out{k}");
        let _ = writeln!(declared, "{flat}{outgoing} {};", declaration(shape, &to));
        let _ = writeln!(body, "    {to} = {value};");
        call.outputs.push(Named { name: to, shape });
    }
    call.behind = format!("{declared}void main() {{\n{body}    gl_Position = vec4(0.0);\n}}\n");
    call.text.text = format!("{head}{}", call.behind);
    Ok(call)
}

/// `vec3 v[4]`
fn declaration(shape: Shape, name: &str) -> String {
    let size = shape.array.map_or_else(String::new, |n| format!("[{n}]"));
    format!("{} {name}{size}", shape.element())
}

impl Call {
    /// Feeds parameter `k` with words from `start` on: one attribute for each vector of it.
    fn feed(&mut self, start: usize, shape: Shape, k: usize, incoming: &str, text: (&mut String, &mut String)) {
        let (declared, body) = text;
        // There are no attributes of truth values.
        let scalar = if shape.scalar == Scalar::Bool { Scalar::U32 } else { shape.scalar };
        let vector = Shape::vector(scalar, shape.rows);
        let mut at = start;
        for element in 0..shape.elements() {
            let mut columns = Vec::new();
            for _ in 0..shape.columns {
                let name = format!("sc_in{}", self.attributes.len());
                let _ = writeln!(declared, "{incoming} {vector} {name};");
                self.fed.extend((at..at + usize::from(shape.rows)).map(|word| word as u32));
                at += usize::from(shape.rows);
                self.attributes.push(Attribute { name: name.clone(), scalar, components: shape.rows });
                columns.push(name);
            }
            let to = shape.array.map_or_else(|| format!("sc_v{k}"), |_| format!("sc_v{k}[{element}]"));
            let _ = writeln!(body, "    {to} = {}({});", shape.element(), columns.join(", "));
        }
    }
}
