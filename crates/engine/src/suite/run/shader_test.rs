//! A failing case as a test for piglit's `shader_runner`: the shader as its author wrote it, the inputs of the
//! case, and a comparison of the component that deviates. The target is green where it is right.

use std::fmt::Write;

use super::Prepared;
use super::finding::components;
use base::text::Span;
use base::value::{Scalar, Shape, ulp_at};
use judge::verdict::{Blame, Deviation, Value as Component};
use program::Written;
use program::lower::Role;
use property::{Sample, regressions};
use syntax::interface::Storage;
use syntax::symbols::Direction;
use syntax::{Profile, Shader};

/// The vertices of a triangle that covers the target.
const CORNERS: [[f32; 2]; 3] = [[-1.0, -1.0], [3.0, -1.0], [-1.0, 3.0]];

/// The test; `None` for what it cannot say: a deviation that is no wrong value, a stage that it has no place for, or
/// inputs that it cannot set.
pub fn shader_test(prepared: &Prepared, message: &str, deviation: &Deviation, sample: &Sample) -> Option<String> {
    let value = deviation.value()?;
    let program = &prepared.program;
    if program.written != Written::Glsl {
        return None;
    }
    let parsed = Shader::parse_with(&program.file, program.stage, &program.defines);
    let work = TestWork { prepared, shader: &parsed.shader, sample, value, deviation };
    // What another text is put in for is not here.
    if program.file.text().contains("#include") {
        return None;
    }
    let (stages, data, draw) = match &program.role {
        Role::Vertex => work.vertex()?,
        Role::Geometry(primitives) => work.geometry(primitives.input_vertices())?,
        Role::Function { name } => work.function(name)?,
        Role::Fragment | Role::Compute => return None,
    };
    let es = parsed.shader.version().profile == Profile::Es;
    let number = work.number();
    let dotted = format!("{}.{:02}", number / 100, number % 100);
    let mut text = format!("# {}: {}\n[require]\n", prepared.shader, message.lines().next().unwrap_or_default());
    if es {
        let api = if number == 100 { "2.0".to_owned() } else { format!("{}.{}", number / 100, number / 10 % 10) };
        let _ = writeln!(text, "GL ES >= {api}\nGLSL ES >= {dotted}");
    } else {
        let _ = writeln!(text, "GLSL >= {dotted}");
    }
    text.push_str(&stages);
    let _ = write!(text, "\n[vertex data]\n{data}\n[test]\nclear color 0.0 0.0 1.0 0.0\nclear\n");
    text.push_str(&work.uniforms()?);
    let _ = writeln!(text, "{draw}\nprobe all rgba 0.0 1.0 0.0 1.0");
    Some(text)
}

struct TestWork<'a> {
    prepared: &'a Prepared,
    shader: &'a Shader,
    sample: &'a Sample,
    value: &'a Component,
    deviation: &'a Deviation,
}

/// Texts of the stages, vertices, and the command that draws.
type Parts = (String, String, String);

impl TestWork<'_> {
    /// The version that the shader states; a library that states none works in most.
    fn number(&self) -> u32 {
        let version = self.shader.version();
        if version.span.is_some() { version.number } else { 330 }
    }

    /// The first line of every stage.
    fn version_line(&self) -> String {
        match self.shader.version().span {
            Some(span) => format!("{}\n", self.shader.file().slice(span)),
            None => "#version 330\n".to_owned(),
        }
    }

    /// The keyword of an input and of an output of a vertex stage, and of an input of a fragment stage.
    fn keywords(&self) -> [&'static str; 3] {
        let old = match self.shader.version().profile {
            Profile::Es => self.number() < 300,
            Profile::Core | Profile::Compatibility => self.number() < 130,
        };
        if old { ["attribute", "varying", "varying"] } else { ["in", "out", "in"] }
    }

    /// The author's text without its version line and without what `cut` names, with the macros of the run.
    fn author(&self, cut: &[Span]) -> String {
        let mut text = self.shader.file().text().trim_start_matches('\u{feff}').to_owned();
        let skipped = self.shader.file().text().len() - text.len();
        for span in cut.iter().chain(self.shader.version().span.as_ref()) {
            let range = span.start.saturating_sub(skipped)..span.end.saturating_sub(skipped);
            // Lines stay where they are.
            let blank: String = text[range.clone()].chars().map(|c| if c == '\n' { '\n' } else { ' ' }).collect();
            text.replace_range(range, &blank);
        }
        let defines = self.shader.defines().iter().map(|(name, value)| format!("#define {name} {value}\n"));
        format!("{}{}", defines.collect::<String>(), text)
    }

    /// The precision that a text without one lacks.
    fn precision(&self) -> &'static str {
        if self.shader.version().profile == Profile::Es { "precision highp float;\nprecision highp int;\n" } else { "" }
    }

    /// The fragment stage hands on what the stage before has found.
    fn fragment(&self) -> String {
        let [_, _, input] = self.keywords();
        let (declared, output) =
            if input == "varying" { ("", "gl_FragColor") } else { ("out vec4 sc_fragment;\n", "sc_fragment") };
        format!(
            "\n[fragment shader]\n{}{}{input} vec4 sc_color;\n{declared}void main() {{\n  {output} = sc_color;\n}}\n",
            self.version_line(),
            self.precision(),
        )
    }

    /// What is declared for the comparison.
    fn declared(&self) -> String {
        let ty = type_name(self.value.scalar);
        let bound = if self.value.scalar == Scalar::F32 { "uniform float sc_bound;\n" } else { "" };
        format!("uniform {ty} sc_expected;\n{bound}uniform float sc_never;\n")
    }

    /// A statement that sets the color by the component under this name.
    fn compared(&self, component: &str) -> String {
        let right = match self.value.scalar {
            Scalar::F32 => format!("abs({component} - sc_expected) <= sc_bound"),
            Scalar::I32 | Scalar::U32 | Scalar::Bool => format!("{component} == sc_expected"),
        };
        format!("sc_color = {right} ? vec4(0.0, 1.0, 0.0, 1.0) : vec4(1.0, 0.0, 0.0, 1.0);")
    }

    /// Statements that make every one of these inputs count: those that a compiler drops cannot be set.
    fn kept<'n>(&self, names: impl Iterator<Item = (&'n str, Shape)>) -> String {
        let mut text = String::from("  if (sc_never > 0.5) {\n");
        for (name, shape) in names {
            let last = shape.elements() * shape.element_words() - 1;
            let _ = writeln!(text, "    sc_color += vec4(float({name}{}));", shape.component_name(last));
        }
        text.push_str("  }\n");
        text
    }

    /// Uniforms of the shader.
    fn globals(&self) -> impl Iterator<Item = (&str, Shape)> {
        self.sample.case_record.fields().iter().map(|f| (f.name.as_str(), f.shape))
    }

    fn vertex(&self) -> Option<Parts> {
        // The runner draws one triangle, whose vertices have numbers of their own.
        if !self.prepared.program.drawn().is_empty() {
            return None;
        }
        let [attribute, output, _] = self.keywords();
        let inputs = &self.sample.invocation_record;
        let names = inputs.fields().iter().map(|f| (f.name.as_str(), f.shape)).chain(self.globals());
        let stage = format!(
            "\n[vertex shader]\n{}#define main sc_main\n{}\n#undef main\n{attribute} vec2 sc_vertex;\n{output} vec4 sc_color;\n{}\
             void main() {{\n  sc_main();\n  {}\n{}  gl_Position = vec4(sc_vertex, 0.0, 1.0);\n}}\n{}",
            self.version_line(),
            self.author(&[]),
            self.declared(),
            self.compared(&self.value.component),
            self.kept(names),
            self.fragment(),
        );
        // Each vertex of the triangle has the attributes of the case.
        let fed = components(&self.prepared.suite, &self.prepared.program);
        let mut header = "sc_vertex/float/2".to_owned();
        let mut row = String::new();
        for (k, (field, fed)) in inputs.fields().iter().zip(fed).enumerate() {
            if field.shape.columns > 1 || field.shape.array.is_some() || field.shape.scalar == Scalar::Bool {
                return None;
            }
            let _ = write!(header, " {}/{}/{fed}", field.name, type_name(field.shape.scalar));
            for word in self.sample.invocation[inputs.range(k)].iter().take(usize::from(fed)) {
                let _ = write!(row, " {}", number(*word, field.shape.scalar));
            }
        }
        let rows = CORNERS.map(|[x, y]| format!("{x:?} {y:?}{row}\n")).concat();
        Some((stage, format!("{header}\n{rows}"), "draw arrays GL_TRIANGLES 0 3".to_owned()))
    }

    fn function(&self, name: &str) -> Option<Parts> {
        let [attribute, output, _] = self.keywords();
        let function = self.shader.function(name)?;
        let record = &self.sample.invocation_record;
        let shape = |name: &str| record.index_of(name).map(|k| record.fields()[k].shape);
        let (mut declared, mut before, mut passed, mut kept) = (String::new(), String::new(), Vec::new(), Vec::new());
        for param in &function.params {
            let name = &param.name.as_ref()?.name;
            let own = format!("sc_in_{name}");
            if param.direction != Direction::Out {
                let shape = shape(name)?;
                let _ = writeln!(declared, "uniform {};", declaration(shape, &own));
                kept.push((own.clone(), shape));
            }
            if param.direction == Direction::In {
                passed.push(own);
                continue;
            }
            let shape = param.ty.shape()?;
            let first = if param.direction == Direction::InOut { format!(" = {own}") } else { String::new() };
            let _ = writeln!(before, "  {}{first};", declaration(shape, &format!("sc_out_{name}")));
            passed.push(format!("sc_out_{name}"));
        }
        let component = match self.value.component.strip_prefix("return") {
            Some(rest) if rest.is_empty() || rest.starts_with(['.', '[']) => format!("sc_return{rest}"),
            _ => format!("sc_out_{}", self.value.component),
        };
        let call = format!("{name}({})", passed.join(", "));
        let call = match function.return_type.shape() {
            Some(shape) => format!("{} = {call}", declaration(shape, "sc_return")),
            None if function.return_type == syntax::types::Type::Void => call,
            None => return None,
        };
        let names = kept.iter().map(|(name, shape)| (name.as_str(), *shape)).chain(self.globals());
        let stage = format!(
            "\n[vertex shader]\n{}#define main sc_main\n{}{}\n#undef main\n{attribute} vec2 sc_vertex;\n{output} vec4 sc_color;\n{}{declared}\
             void main() {{\n{before}  {call};\n  {}\n{}  gl_Position = vec4(sc_vertex, 0.0, 1.0);\n}}\n{}",
            self.version_line(),
            self.precision(),
            self.author(&[]),
            self.declared(),
            self.compared(&component),
            self.kept(names),
            self.fragment(),
        );
        let rows = CORNERS.map(|[x, y]| format!("{x:?} {y:?}\n")).concat();
        Some((stage, format!("sc_vertex/float/2\n{rows}"), "draw arrays GL_TRIANGLES 0 3".to_owned()))
    }

    /// The vertices that the author emits are looked at, and a triangle is drawn in their place.
    fn geometry(&self, count: u32) -> Option<Parts> {
        let interface = self.shader.interface();
        let (mut header, mut rows) = (String::new(), vec![String::new(); count as usize]);
        let (mut declared, mut handed) = (String::new(), String::new());
        let record = &self.sample.invocation_record;
        for (k, field) in record.fields().iter().enumerate() {
            let element = field.shape.element();
            let plain = field.name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
            if !plain || field.shape.array != Some(count) || element.columns > 1 || element.scalar == Scalar::Bool {
                return None;
            }
            let own = format!("sc_in{k}");
            let _ = writeln!(declared, "in {};", declaration(element, &own));
            if !field.name.starts_with("gl_") {
                let flat = if element.scalar == Scalar::F32 { "" } else { "flat " };
                let _ = writeln!(declared, "{flat}out {};", declaration(element, &field.name));
            }
            let _ = writeln!(handed, "  {} = {own};", field.name);
            let _ =
                write!(header, "{}{own}/{}/{}", if k > 0 { " " } else { "" }, type_name(element.scalar), element.rows);
            for (row, words) in
                rows.iter_mut().zip(self.sample.invocation[record.range(k)].chunks(element.element_words()))
            {
                for word in words {
                    let _ = write!(row, "{} ", number(*word, element.scalar));
                }
            }
        }
        let out = |l: &&syntax::interface::StageLayout| l.storage == Some(Storage::Out);
        let cut: Vec<Span> = interface.stage_layouts.iter().filter(out).map(|l| l.span).collect();
        // In this text an emission looks at the outputs; the last lines emit for themselves.
        let corners = CORNERS.map(|[x, y]| {
            format!("  sc_color = sc_found;\n  gl_Position = vec4({x:?}, {y:?}, 0.0, 1.0);\n  EmitVertex();\n")
        });
        let found = self.compared(&self.value.component).replace("sc_color", "sc_found");
        let kept = self.kept(self.globals()).replace("sc_color", "sc_found");
        let stage = format!(
            "\n[vertex shader]\n{version}{declared}void main() {{\n{handed}}}\n\
             \n[geometry shader]\n{version}#define main sc_main\n#define EmitVertex sc_emit\n#define EndPrimitive sc_end\n\
             void sc_emit();\nvoid sc_end();\nint sc_count;\nvec4 sc_found;\n{author}\n#undef main\n#undef EmitVertex\n#undef EndPrimitive\n\
             layout(triangle_strip, max_vertices = 3) out;\nout vec4 sc_color;\n{uniforms}void sc_end() {{}}\n\
             void sc_emit() {{\n  if (sc_count == {vertex}) {{\n    {found}\n  }}\n  sc_count++;\n}}\n\
             void main() {{\n  sc_count = 0;\n  sc_found = vec4(1.0, 0.0, 0.0, 1.0);\n  sc_main();\n{kept}{corners}}}\n{fragment}",
            version = self.version_line(),
            author = self.author(&cut),
            uniforms = self.declared(),
            vertex = self.value.vertex?,
            corners = corners.concat(),
            fragment = self.fragment(),
        );
        let kind = match count {
            1 => "GL_POINTS",
            2 => "GL_LINES",
            3 => "GL_TRIANGLES",
            4 => "GL_LINES_ADJACENCY",
            _ => "GL_TRIANGLES_ADJACENCY",
        };
        let rows: String = rows.iter().map(|row| format!("{}\n", row.trim_end())).collect();
        Some((stage, format!("{header}\n{rows}"), format!("draw arrays {kind} 0 {count}")))
    }

    /// The commands that set the inputs of the case and what is expected.
    fn uniforms(&self) -> Option<String> {
        let mut text = String::new();
        let mut set = |name: &str, shape: Shape, words: &[u32]| {
            let element = shape.element();
            for (k, words) in words.chunks(element.element_words()).enumerate() {
                let at = if shape.array.is_some() { format!("[{k}]") } else { String::new() };
                let values: Vec<String> = words.iter().map(|w| number(*w, shape.scalar)).collect();
                let _ = writeln!(text, "uniform {} {name}{at} {}", set_as(element), values.join(" "));
            }
        };
        let case = &self.sample.case_record;
        for (k, field) in case.fields().iter().enumerate() {
            set(&field.name, field.shape, &self.sample.case[case.range(k)]);
        }
        if let Role::Function { .. } = self.prepared.program.role {
            let record = &self.sample.invocation_record;
            for (k, field) in record.fields().iter().enumerate() {
                set(&format!("sc_in_{}", field.name), field.shape, &self.sample.invocation[record.range(k)]);
            }
        }
        let target = self.deviation.target(self.value);
        let scalar = Shape::vector(self.value.scalar, 1);
        let word = match self.value.scalar {
            Scalar::F32 => (target as f32).to_bits(),
            Scalar::I32 => (target as i32).cast_unsigned(),
            Scalar::U32 | Scalar::Bool => target as u32,
        };
        set("sc_expected", scalar, &[word]);
        if self.value.scalar == Scalar::F32 {
            if !target.is_finite() {
                return None;
            }
            // What is expected is rounded to binary32, and so is the difference.
            // A shader that is wrong is judged in real numbers; here it runs in binary32, and is held against a
            // quarter of what it is off by.
            let off = match self.deviation.blame {
                Blame::Shader => (self.value.meaning - target).abs() / 4.0,
                Blame::Lane => 0.0,
            };
            let off = if off.is_finite() { off } else { 0.0 };
            let bound = self.value.bound.max(off) + ulp_at(target);
            set("sc_bound", scalar, &[(bound as f32).to_bits()]);
        }
        set("sc_never", Shape::FLOAT, &[0]);
        Some(text)
    }
}

/// `vec3 name`, `float name[4]`.
fn declaration(shape: Shape, name: &str) -> String {
    let array = shape.array.map_or_else(String::new, |n| format!("[{n}]"));
    format!("{} {name}{array}", shape.element())
}

/// The type of a number, as files of vertices name it.
fn type_name(scalar: Scalar) -> &'static str {
    match scalar {
        Scalar::F32 => "float",
        Scalar::I32 => "int",
        Scalar::U32 => "uint",
        Scalar::Bool => "bool",
    }
}

/// The type as which a uniform is set: truth values are integers, and matrices name both sizes.
fn set_as(shape: Shape) -> String {
    match (shape.scalar, shape.columns) {
        (Scalar::Bool, _) => Shape { scalar: Scalar::I32, ..shape }.to_string(),
        (_, 1) => shape.to_string(),
        (_, columns) => format!("mat{columns}x{}", shape.rows),
    }
}

/// A number in decimal that gives these bits again; bits where no decimal does.
fn number(word: u32, scalar: Scalar) -> String {
    if scalar == Scalar::F32 && !f32::from_bits(word).is_finite() {
        return format!("0x{word:08x}");
    }
    if scalar == Scalar::Bool {
        return u32::from(word != 0).to_string();
    }
    regressions::decimal(word, scalar)
}
