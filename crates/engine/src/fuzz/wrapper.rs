//! The generated function that a kernel runs: plain values in and out, structures taken apart.

use std::fmt::Write as _;

use super::slice::{Global, Slice};
use base::text::{Assembly, Edit, SourceFile, Span};
use base::value::Shape;
use syntax::Shader;
use syntax::symbols::{Direction, FunctionInfo};
use syntax::types::{ArraySize, Type};

/// Name of the generated function.
pub const NAME: &str = "sc_fuzz";
/// What `main` of a stage is called where it is run as an ordinary function.
const MAIN: &str = "sc_main";
/// Words that go in or come out at most.
pub(super) const MOST_WORDS: usize = 2048;

/// A function made ready: a text with a generated function at its end, and what its parameters are
/// called.
#[derive(Clone, Debug)]
pub struct Wrapped {
    /// The text, which leads back to the author's.
    pub file: SourceFile,
    /// Names of the inputs, in the order of the parameters.
    pub inputs: Vec<String>,
    /// Names of the outputs, in the order of the parameters.
    pub outputs: Vec<String>,
}

/// A part of a value that can be fed or captured: how it is reached, and its shape.
type Leaf = (String, Shape);

/// The parts of a value.
///
/// # Errors
/// The type that cannot be taken apart.
fn leaves(ty: &Type) -> Result<Vec<Leaf>, String> {
    if let Some(shape) = ty.shape() {
        return Ok(vec![(String::new(), shape)]);
    }
    match ty {
        Type::Struct(structure) => {
            let mut all = Vec::new();
            for field in &structure.fields {
                all.extend(leaves(&field.ty)?.into_iter().map(|(path, s)| (format!(".{}{path}", field.name), s)));
            }
            Ok(all)
        }
        Type::Array(element, ArraySize::Known(n)) => {
            let inner = leaves(element)?;
            let all = (0..*n).flat_map(|k| inner.iter().map(move |(path, s)| (format!("[{k}]{path}"), *s)));
            Ok(all.collect())
        }
        Type::Array(_, ArraySize::Unsized | ArraySize::Unknown) => Err(format!("`{ty}`, whose size is not known")),
        Type::Opaque(_) => Err(format!("`{ty}`, which only a host can give")),
        Type::Scalar(_) | Type::Vector(..) | Type::Matrix(..) => Err(format!("`{ty}`: only 32-bit numbers are fed")),
        Type::Error | Type::Void => Err(format!("`{ty}`")),
    }
}

/// True for samplers and images, and for arrays of them.
fn is_bound(ty: &Type) -> bool {
    match ty {
        Type::Opaque(_) => true,
        Type::Array(element, ArraySize::Known(_)) => is_bound(element),
        _ => false,
    }
}

/// How a part is copied: as a whole, but an array inside of a structure element by element. To naga the
/// two are types of their own, with elements that lie differently. The first versions copy no array as a whole.
fn elements(path: &str, shape: Shape, whole_arrays: bool) -> Vec<String> {
    match shape.array {
        Some(n) if !path.is_empty() || !whole_arrays => (0..n).map(|k| format!("[{k}]")).collect(),
        Some(_) | None => vec![String::new()],
    }
}

/// `float x[4]`: a declaration without the semicolon.
fn declared(ty: &str, name: &str) -> String {
    match ty.find('[') {
        Some(at) => format!("{} {name}{}", &ty[..at], &ty[at..]),
        None => format!("{ty} {name}"),
    }
}

/// The generated text under way.
#[derive(Default)]
struct WrapperText {
    params: Vec<String>,
    before: String,
    after: String,
    samplers: String,
    inputs: Vec<String>,
    outputs: Vec<String>,
    words: usize,
    /// The version copies arrays as a whole.
    whole_arrays: bool,
}

impl WrapperText {
    fn input(&mut self, variable: &str, shown: &str, leaves: &[Leaf]) {
        for (path, shape) in leaves {
            let name = format!("sc_i{}", self.inputs.len());
            // Without `in`, which the text may have defined as something else.
            self.params.push(declared(&shape.to_string(), &name));
            for at in elements(path, *shape, self.whole_arrays) {
                let _ = writeln!(self.before, "  {variable}{path}{at} = {name}{at};");
            }
            self.inputs.push(format!("{shown}{path}"));
            self.words += shape.words();
        }
    }

    fn output(&mut self, variable: &str, shown: &str, leaves: &[Leaf]) {
        for (path, shape) in leaves {
            let name = format!("sc_o{}", self.outputs.len());
            self.params.push(format!("out {}", declared(&shape.to_string(), &name)));
            for at in elements(path, *shape, self.whole_arrays) {
                let _ = writeln!(self.after, "  {name}{at} = {variable}{path}{at};");
            }
            self.outputs.push(format!("{shown}{path}"));
            self.words += shape.words();
        }
    }

    /// A global variable whose name the function's own variables must not hide.
    fn global(&mut self, global: &Global) -> Result<(), String> {
        let what = |why| format!("`{}` is of type {why}", global.shown);
        let leaves = leaves(&global.ty).map_err(what)?;
        if global.reads {
            self.input(&global.name, &global.shown, &leaves);
        }
        if global.writes {
            self.output(&global.name, &global.shown, &leaves);
        }
        Ok(())
    }
}

/// Puts a function and what it needs into a text of its own, with a generated function that calls it.
///
/// # Errors
/// Why it cannot be called, in words that go on from "not run: ".
pub fn wrap(shader: &Shader, function: &FunctionInfo, slice: &Slice) -> Result<Wrapped, String> {
    let number = shader.version().number;
    let mut text = WrapperText { whole_arrays: number != 100 && number != 110, ..WrapperText::default() };
    let is_main = function.name.name == "main";
    let called = if is_main { MAIN } else { &function.name.name };
    let mut call = String::new();
    if function.return_type != Type::Void {
        let leaves = leaves(&function.return_type).map_err(|why| format!("it returns a value of type {why}"))?;
        call = format!("{} = ", declared(&function.return_type.to_string(), "sc_r"));
        text.output("sc_r", "return", &leaves);
    }
    let mut arguments = Vec::new();
    for (k, param) in function.params.iter().enumerate() {
        let shown = param.name.as_ref().map_or_else(|| format!("argument{}", k + 1), |name| name.name.clone());
        if is_bound(&param.ty) {
            // A texture is bound, under the name of the parameter where nothing else has it.
            let taken = shader.interface().variables().any(|v| v.name == shown);
            let name = if taken || param.name.is_none() { format!("sc_t{k}") } else { shown };
            let _ = writeln!(text.samplers, "uniform {};", declared(&param.ty.to_string(), &name));
            arguments.push(name);
            continue;
        }
        let leaves = leaves(&param.ty).map_err(|why| format!("its parameter `{shown}` is of type {why}"))?;
        let variable = format!("sc_p{k}");
        let _ = writeln!(text.before, "  {};", declared(&param.ty.to_string(), &variable));
        if matches!(param.direction, Direction::In | Direction::InOut) {
            text.input(&variable, &shown, &leaves);
        }
        if matches!(param.direction, Direction::Out | Direction::InOut) {
            text.output(&variable, &shown, &leaves);
        }
        arguments.push(variable);
    }
    for global in &slice.globals {
        text.global(global)?;
    }
    if text.outputs.is_empty() {
        return Err("it gives nothing back: no value, no `out` parameter, no variable that it writes".to_owned());
    }
    if text.words > MOST_WORDS {
        return Err(format!("it takes and gives {} words; {MOST_WORDS} at most are fed", text.words));
    }
    let WrapperText { params, before, after, samplers, inputs, outputs, .. } = text;
    let call = format!("{call}{called}({});", arguments.join(", "));
    let body =
        [format!("\n{samplers}void {NAME}({}) {{\n{before}", params.join(", ")), format!("  {call}\n{after}}}\n")];
    Ok(Wrapped { file: assemble(shader, slice, function, &body), inputs, outputs })
}

/// The author's text with the edits of a slice, and the generated function behind it, with what variables start with
/// between its two parts. The version line stays where it is.
fn assemble(shader: &Shader, slice: &Slice, function: &FunctionInfo, [before, after]: &[String; 2]) -> SourceFile {
    let file = shader.file();
    let mut edits: Vec<(Span, &str)> = Vec::new();
    if !slice.head.is_empty() {
        edits.push((Span::at(slice.head_at), &slice.head));
    }
    if function.name.name == "main" {
        edits.push((function.name.span, MAIN));
    }
    edits.extend(replaced(&slice.edits));
    edits.sort_by_key(|(span, _)| (span.start, span.end));
    let mut assembly = Assembly::new();
    edited(&mut assembly, file, Span::new(0, file.text().len()), &edits);
    let here = function.name.span.start;
    assembly.insert(before, file, here);
    for late in &slice.late {
        assembly.insert(&format!("  {} = ", late.name), file, late.value.start);
        edited(&mut assembly, file, late.value, &replaced(&late.edits).collect::<Vec<_>>());
        assembly.insert(";\n", file, late.value.end);
    }
    assembly.insert(after, file, here);
    assembly.finish(file.name())
}

fn replaced(edits: &[Edit]) -> impl Iterator<Item = (Span, &str)> {
    edits.iter().map(|edit| (edit.span, edit.replacement.as_str()))
}

/// Copies a part of a text with edits, which are in order; of those that overlap the first counts.
fn edited(assembly: &mut Assembly, file: &SourceFile, part: Span, edits: &[(Span, &str)]) {
    let mut at = part.start;
    for (span, replacement) in edits.iter().filter(|(span, _)| part.start <= span.start) {
        if span.start < at {
            continue;
        }
        assembly.copy(file, Span::new(at, span.start));
        assembly.insert(replacement, file, span.start);
        at = span.end;
    }
    assembly.copy(file, Span::new(at, part.end));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fuzz::slice::slice;
    use syntax::Stage;

    fn wrapped(name: &str, text: &str, function: &str) -> Result<Wrapped, String> {
        let parsed = Shader::parse(&SourceFile::new(name, text), Stage::from_path(name).unwrap());
        assert!(parsed.diagnostics.is_empty(), "{:?}", parsed.diagnostics);
        let (id, info) = parsed.shader.functions().find(|(_, f)| f.name.name == function).unwrap();
        wrap(&parsed.shader, info, &slice(&parsed.shader, id))
    }

    #[test]
    fn structures_are_taken_apart_and_what_is_not_needed_is_left_out() {
        let text = "#version 330\nstruct S { vec3 p; float w[2]; };\nuniform sampler2D tex;\nuniform float k;\n\
                    float other(vec2 c) { return texture(tex, c).x; }\nS f(S s, inout float x) { x += k; s.w[0] = x; return s; }\n";
        let all = wrapped("a.glsl", text, "f").unwrap();
        assert_eq!(all.inputs, ["s.p", "s.w", "x", "k"]);
        assert_eq!(all.outputs, ["return.p", "return.w", "x"]);
        let text = all.file.text();
        assert!(!text.contains("texture") && !text.contains("sampler2D") && !text.contains("uniform"), "{text}");
        let at = text.find("S f(S s").unwrap();
        assert_eq!(all.file.locate(at), "a.glsl:6:1");
        let bound = wrapped("a.glsl", "vec4 f(sampler2D t) { return vec4(0.0); }", "f").unwrap();
        assert!(bound.file.text().contains("uniform sampler2D t;") && bound.file.text().contains("f(t)"));
    }

    #[test]
    fn a_variable_that_starts_with_an_input_gets_its_value_behind_it() {
        let text = "#version 330\nuniform vec2 size;\nfloat two = 2.0;\nfloat wide = size.x * two, half_ = wide / gl_FragCoord.x;\n\
                    float f(float x) { return x / half_; }\nout float o;\nvoid main() { o = f(1.0); }\n";
        let all = wrapped("a.frag", text, "f").unwrap();
        let text = all.file.text();
        assert!(text.contains("float two = 2.0;\nfloat wide , half_ ;"), "{text}");
        assert!(
            text.contains("  wide = size.x * two;\n  half_ = wide / sc_gl_FragCoord.x;\n  float sc_r = f("),
            "{text}"
        );
        let at = text.find("size.x * two;").unwrap();
        assert_eq!(all.file.locate(at), "a.frag:4:14");
    }

    #[test]
    fn what_a_global_variable_starts_with_brings_all_functions_that_it_calls() {
        let text = "float two() { return 2.0; }\nfloat four() { return two() * two(); }\nfloat other() { return 1.0; }\n\
                    float size = four();\nfloat f(float x) { return x * size; }\n";
        let all = wrapped("a.glsl", text, "f").unwrap();
        let text = all.file.text();
        assert!(text.contains("float two()") && text.contains("float four()") && !text.contains("other"), "{text}");
    }

    #[test]
    fn a_stage_is_a_function_of_its_interface() {
        let text = "#version 330\nin VS { vec3 n; } fs_in;\nin vec2 uv, st;\nlayout(location = 0) out vec4 color;\n\
                    uniform Block { mat4 m; float k; };\nvoid main() { color = vec4(fs_in.n, uv.x * k) * gl_FragCoord.x; }\n";
        let all = wrapped("a.frag", text, "main").unwrap();
        assert_eq!(all.inputs, ["uv", "fs_in.n", "m", "k", "gl_FragCoord"]);
        assert_eq!(all.outputs, ["color"]);
    }
}
