//! A program as text, in its language, and the suite that runs it.

use std::fmt::Write;

use super::operations::OPERATIONS;
use super::program::{Expression, Form, Helper, Kind, Language, Program, Scalar, Statement, Type, Variable};

/// Invocations of a workgroup of compute stages.
pub const GROUP: usize = 4;
/// Workgroups of a dispatch.
pub const GROUPS: usize = 2;

/// A text and the suite that runs it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Printed {
    /// File name of the text.
    pub file: String,
    /// The text.
    pub text: String,
    /// The suite file, in TOML.
    pub suite: String,
}

/// Prints a program under a name.
pub fn print(program: &Program, name: &str) -> Printed {
    let ending = match (program.language, program.form) {
        (Language::Wgsl, _) => "wgsl",
        (Language::Glsl, Form::Function) => "glsl",
        (Language::Glsl, Form::Vertex) => "vert",
        (Language::Glsl, Form::Fragment) => "frag",
        (Language::Glsl, Form::Compute) => "comp",
    };
    let file = format!("{name}.{ending}");
    let mut printer = Printer { program, text: String::new(), depth: 0, within: Within::Stage };
    printer.all();
    Printed { suite: suite(program, name, &file), text: printer.text, file }
}

/// The name of an input as suites know it.
pub fn input_name(program: &Program, index: usize) -> String {
    match program.form {
        Form::Compute if !program.inputs[index].uniform => format!("b{index}"),
        _ => format!("x{index}"),
    }
}

fn suite(program: &Program, name: &str, file: &str) -> String {
    let mut text = format!("suite = \"{name}\"\nshader = \"{file}\"\nstage = \"{}\"\n", program.form.name());
    if program.form == Form::Function {
        text.push_str("entry = \"f\"\n");
    }
    if program.form == Form::Compute {
        let _ = write!(text, "\n[dispatch]\ngroups = [{GROUPS}]\n");
    }
    let read = super::shrink::reads(program);
    for (index, input) in program.inputs.iter().enumerate() {
        // A resource that nothing reads is no part of a module.
        let resource = input.uniform || program.form == Form::Compute;
        if program.language == Language::Wgsl && resource && !read.contains(&Variable::Input(index)) {
            continue;
        }
        let (generator, range) = match input.ty {
            Type::Value(Scalar::Int | Scalar::Uint, _) => ("index", "[0.0, 100.0]"),
            _ => ("interval", "[-4.0, 4.0]"),
        };
        let name = input_name(program, index);
        let _ = write!(text, "\n[[inputs]]\nnames = [\"{name}\"]\ngenerator = \"{generator}\"\nrange = {range}\n");
    }
    text
}

/// Which function is printed.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Within {
    Stage,
    Helper,
}

struct Printer<'a> {
    program: &'a Program,
    text: String,
    depth: usize,
    within: Within,
}

impl Printer<'_> {
    fn glsl(&self) -> bool {
        self.program.language == Language::Glsl
    }

    /// True for a program of GLSL 3.30, which older drivers take as well.
    fn is_plain(&self) -> bool {
        let newer = ["fma", "ldexp", "bit", "pack", "unpack", "find", "select of ints"];
        let mut nested = false;
        self.program.clone().each_mut(&mut |e| {
            nested |= matches!(&e.ty, Type::Array(of, _) if !matches!(**of, Type::Value(..) | Type::Matrix(..)));
        });
        let operations = self.program.operations();
        let is_newer = |name: &&str| newer.iter().any(|word| name.starts_with(word)) && !name.starts_with("bits of");
        self.program.form != Form::Compute && !nested && !operations.iter().any(is_newer)
    }

    fn line(&mut self, text: &str) {
        (0..self.depth).for_each(|_| self.text.push_str("    "));
        self.text.push_str(text);
        self.text.push('\n');
    }

    fn block(&mut self, head: &str, inside: impl FnOnce(&mut Self)) {
        self.line(&format!("{head} {{"));
        self.depth += 1;
        inside(self);
        self.depth -= 1;
        self.line("}");
    }

    fn ty(&self, ty: &Type) -> String {
        let (glsl, name) = (self.glsl(), |scalar: Scalar| match scalar {
            Scalar::Float => ("float", "vec", "f32"),
            Scalar::Int => ("int", "ivec", "i32"),
            Scalar::Uint => ("uint", "uvec", "u32"),
            Scalar::Bool => ("bool", "bvec", "bool"),
        });
        match ty {
            Type::Value(scalar, 1) if glsl => name(*scalar).0.to_owned(),
            Type::Value(scalar, n) if glsl => format!("{}{n}", name(*scalar).1),
            Type::Value(scalar, 1) => name(*scalar).2.to_owned(),
            Type::Value(scalar, n) => format!("vec{n}<{}>", name(*scalar).2),
            Type::Matrix(n, k) if glsl && n == k => format!("mat{n}"),
            Type::Matrix(n, k) if glsl => format!("mat{n}x{k}"),
            Type::Matrix(n, k) => format!("mat{n}x{k}<f32>"),
            Type::Array(of, n) if glsl => {
                // The size of the outermost array comes first.
                let (mut sizes, mut element) = (format!("[{n}]"), &**of);
                while let Type::Array(inner, m) = element {
                    sizes += &format!("[{m}]");
                    element = &**inner;
                }
                format!("{}{sizes}", self.ty(element))
            }
            Type::Array(of, n) => format!("array<{}, {n}>", self.ty(of)),
            Type::Structure(index) => format!("S{index}"),
        }
    }

    /// `float x` or `x: f32`.
    fn declared(&self, name: &str, ty: &Type) -> String {
        if self.glsl() { format!("{} {name}", self.ty(ty)) } else { format!("{name}: {}", self.ty(ty)) }
    }

    fn variable(&self, variable: Variable) -> String {
        match variable {
            Variable::Input(index) => match (self.program.form, self.program.inputs.get(index)) {
                (Form::Compute, Some(input)) if !input.uniform => format!("b{index}[at]"),
                _ => format!("x{index}"),
            },
            Variable::Parameter(index) => format!("p{index}"),
            Variable::Target if self.glsl() => "t".to_owned(),
            Variable::Target => "(*t)".to_owned(),
            Variable::Local(id) => format!("v{id}"),
        }
    }

    fn literal(&self, scalar: Scalar, word: u32) -> String {
        match scalar {
            Scalar::Bool => if word == 0 { "false" } else { "true" }.to_owned(),
            Scalar::Uint => format!("{word}u"),
            Scalar::Int if word == 1 << 31 && self.glsl() => "(-2147483647 - 1)".to_owned(),
            Scalar::Int if word == 1 << 31 => "i32(-2147483648)".to_owned(),
            Scalar::Int if (word as i32) < 0 => format!("({})", word as i32),
            Scalar::Int => (word as i32).to_string(),
            Scalar::Float => {
                let value = f32::from_bits(word);
                let text = format!("{value:?}");
                if value.is_sign_negative() { format!("({text})") } else { text }
            }
        }
    }

    fn expression(&self, expression: &Expression) -> String {
        let list = |all: &[Expression]| all.iter().map(|e| self.expression(e)).collect::<Vec<_>>().join(", ");
        match &expression.kind {
            Kind::Literal(words) => {
                let Type::Value(scalar, n) = expression.ty else { return String::new() };
                let parts: Vec<String> = words.iter().map(|&word| self.literal(scalar, word)).collect();
                match (n, scalar) {
                    // A number alone would have no type of its own.
                    (1, Scalar::Int) if !self.glsl() && !parts[0].starts_with('i') => format!("i32({})", parts[0]),
                    (1, Scalar::Float) if !self.glsl() => format!("f32({})", parts[0]),
                    (1, _) => parts[0].clone(),
                    _ => format!("{}({})", self.ty(&expression.ty), parts.join(", ")),
                }
            }
            Kind::Read(variable) => self.variable(*variable),
            Kind::Operation(row, arguments) => self.operation(*row, arguments, &expression.ty),
            Kind::Construct(parts) => format!("{}({})", self.ty(&expression.ty), list(parts)),
            Kind::Member(of, index) => format!("{}.m{index}", self.expression(of)),
            Kind::Element(of, index) => format!("{}[{}]", self.expression(of), self.expression(index)),
            Kind::Swizzle(of, parts) => {
                let letters: String = parts.iter().map(|&p| ['x', 'y', 'z', 'w'][usize::from(p & 3)]).collect();
                format!("{}.{letters}", self.expression(of))
            }
            Kind::Call(helper, arguments) => format!("h{helper}({})", list(arguments)),
        }
    }

    fn operation(&self, row: usize, arguments: &[Expression], ty: &Type) -> String {
        let template = OPERATIONS[row].template(self.program.language).unwrap_or("");
        let mut text = String::new();
        let mut rest = template.chars().peekable();
        while let Some(c) = rest.next() {
            match (c, rest.peek().copied()) {
                ('#', Some(digit)) => {
                    rest.next();
                    let index = digit.to_digit(10).unwrap_or(0) as usize;
                    text.push_str(&arguments.get(index).map(|e| self.expression(e)).unwrap_or_default());
                }
                ('@', Some(_)) => {
                    rest.next();
                    text.push_str(&self.ty(ty));
                }
                _ => text.push(c),
            }
        }
        text
    }

    fn statements(&mut self, block: &[Statement]) {
        block.iter().for_each(|statement| self.statement(statement));
    }

    fn statement(&mut self, statement: &Statement) {
        match statement {
            Statement::Declare { id, value } => {
                let declared = self.declared(&format!("v{id}"), &value.ty);
                let var = if self.glsl() { "" } else { "var " };
                let value = self.expression(value);
                self.line(&format!("{var}{declared} = {value};"));
            }
            Statement::Assign { place, value } => {
                let line = format!("{} = {};", self.expression(place), self.expression(value));
                self.line(&line);
            }
            Statement::If { condition, then, otherwise } => {
                let condition = self.expression(condition);
                self.block(&format!("if ({condition})"), |p| p.statements(then));
                if !otherwise.is_empty() {
                    self.text.truncate(self.text.trim_end().len());
                    self.text.push_str(" else {\n");
                    self.depth += 1;
                    self.statements(otherwise);
                    self.depth -= 1;
                    self.line("}");
                }
            }
            Statement::For { id, rounds, body } => {
                let head = match self.glsl() {
                    true => format!("for (int v{id} = 0; v{id} < {rounds}; ++v{id})"),
                    false => format!("for (var v{id}: i32 = 0; v{id} < {rounds}; v{id}++)"),
                };
                self.block(&head, |p| p.statements(body));
            }
            Statement::Loop { id, rounds, body } if self.glsl() => {
                self.line(&format!("int v{id} = -1;"));
                self.block("while (true)", |p| {
                    p.line(&format!("++v{id};"));
                    p.line(&format!("if (v{id} >= {rounds}) break;"));
                    p.statements(body);
                });
            }
            Statement::Loop { id, rounds, body } => {
                self.line(&format!("var v{id}: i32 = 0;"));
                self.block("loop", |p| {
                    p.line(&format!("if (v{id} >= {rounds}) {{ break; }}"));
                    p.statements(body);
                    p.line(&format!("continuing {{ v{id}++; }}"));
                });
            }
            Statement::Switch { selector, cases, otherwise } => {
                let selector = self.expression(selector);
                self.block(&format!("switch ({selector})"), |p| {
                    for (numbers, block) in cases {
                        p.case(numbers, block);
                    }
                    p.case(&[], otherwise);
                });
            }
            Statement::Break { condition } => self.jump(condition, "break;"),
            Statement::Continue { condition } => self.jump(condition, "continue;"),
            Statement::Finish { results } => self.finish(results, true),
            Statement::Change { helper, target, arguments } => {
                let place = self.expression(target);
                let place = match (self.glsl(), &target.kind) {
                    (true, _) => place,
                    // What a pointer points to is handed on by the pointer.
                    (false, Kind::Read(Variable::Target)) => "t".to_owned(),
                    (false, _) => format!("&{place}"),
                };
                let arguments = arguments.iter().map(|e| self.expression(e));
                let all: Vec<String> = [place].into_iter().chain(arguments).collect();
                self.line(&format!("h{helper}({});", all.join(", ")));
            }
            Statement::Exchange { id, value, shift } => {
                let (declared, value) = (self.declared(&format!("v{id}"), &value.ty), self.expression(value));
                let barrier = if self.glsl() { "memoryBarrierShared(); barrier();" } else { "workgroupBarrier();" };
                let (var, four) = if self.glsl() { ("", format!("{GROUP}u")) } else { ("var ", format!("{GROUP}u")) };
                self.line(&format!("m{id}[local] = {value};"));
                self.line(barrier);
                self.line(&format!("{var}{declared} = m{id}[(local + {shift}u) % {four}];"));
                self.line(barrier);
            }
            Statement::Total { id, value } => {
                let value = self.expression(value);
                let (lines, declared) = match self.glsl() {
                    true => (
                        [
                            format!("if (local == 0u) {{ m{id} = 0u; }}"),
                            "memoryBarrierShared(); barrier();".to_owned(),
                            format!("atomicAdd(m{id}, {value});"),
                            "memoryBarrierShared(); barrier();".to_owned(),
                        ],
                        format!("uint v{id} = m{id};"),
                    ),
                    false => (
                        [
                            format!("if (local == 0u) {{ atomicStore(&m{id}, 0u); }}"),
                            "workgroupBarrier();".to_owned(),
                            format!("atomicAdd(&m{id}, {value});"),
                            "workgroupBarrier();".to_owned(),
                        ],
                        format!("var v{id}: u32 = atomicLoad(&m{id});"),
                    ),
                };
                lines.iter().chain([&declared]).for_each(|line| self.line(line));
            }
        }
    }

    fn case(&mut self, numbers: &[i32], block: &[Statement]) {
        let head = match (self.glsl(), numbers) {
            (_, []) => "default:".to_owned(),
            (true, numbers) => numbers.iter().map(|n| format!("case {n}:")).collect::<Vec<_>>().join(" "),
            (false, numbers) => {
                format!("case {}:", numbers.iter().map(i32::to_string).collect::<Vec<_>>().join(", "))
            }
        };
        self.block(&head, |p| {
            p.statements(block);
            let ends = matches!(block.last(), Some(Statement::Finish { .. }));
            if p.glsl() && !ends {
                p.line("break;");
            }
        });
    }

    fn jump(&mut self, condition: &Expression, word: &str) {
        let condition = self.expression(condition);
        self.line(&format!("if ({condition}) {{ {word} }}"));
    }

    /// Gives the results, and ends the stage where something comes behind.
    fn finish(&mut self, results: &[Expression], early: bool) {
        let values: Vec<String> = results.iter().map(|result| self.expression(result)).collect();
        if self.within == Within::Helper || self.program.form == Form::Function {
            self.line(&format!("return {};", values.first().cloned().unwrap_or_default()));
            return;
        }
        let stage = matches!(self.program.form, Form::Vertex | Form::Fragment);
        if !self.glsl() && stage {
            // The position is a result as well.
            let position = (self.program.form == Form::Vertex).then(|| "vec4<f32>(0.0)".to_owned());
            let all: Vec<String> = values.into_iter().chain(position).collect();
            self.line(&format!("return Out({});", all.join(", ")));
            return;
        }
        for (index, value) in values.iter().enumerate() {
            let at = if self.program.form == Form::Compute { "[at]" } else { "" };
            self.line(&format!("o{index}{at} = {value};"));
        }
        if self.program.form == Form::Vertex {
            self.line("gl_Position = vec4(0.0);");
        }
        if early {
            self.line("return;");
        }
    }

    fn helper(&mut self, index: usize, helper: &Helper) {
        let target = helper.target.as_ref().map(|ty| match self.glsl() {
            true => format!("inout {}", self.declared("t", ty)),
            false => format!("t: ptr<function, {}>", self.ty(ty)),
        });
        let own = helper.parameters.iter().enumerate().map(|(k, ty)| self.declared(&format!("p{k}"), ty));
        let parameters: Vec<String> = target.into_iter().chain(own).collect();
        let parameters = parameters.join(", ");
        let result = helper.target.is_none().then(|| self.ty(&helper.result.ty));
        let head = match (self.glsl(), result) {
            (true, result) => format!("{} h{index}({parameters})", result.unwrap_or_else(|| "void".to_owned())),
            (false, Some(result)) => format!("fn h{index}({parameters}) -> {result}"),
            (false, None) => format!("fn h{index}({parameters})"),
        };
        self.within = Within::Helper;
        self.block(&head, |p| {
            p.statements(&helper.body);
            let value = p.expression(&helper.result);
            match helper.target {
                None => p.line(&format!("return {value};")),
                Some(_) => {
                    let target = p.variable(Variable::Target);
                    p.line(&format!("{target} = {value};"));
                }
            }
        });
        self.within = Within::Stage;
    }

    fn all(&mut self) {
        if self.glsl() {
            let version = if self.is_plain() { 330 } else { 450 };
            self.line(&format!("#version {version}"));
        }
        if self.program.form == Form::Compute && self.glsl() {
            self.line(&format!("layout(local_size_x = {GROUP}) in;"));
        }
        for (index, members) in self.program.structures.iter().enumerate() {
            let members: Vec<String> =
                members.iter().enumerate().map(|(k, ty)| self.declared(&format!("m{k}"), ty)).collect();
            let line = match self.glsl() {
                true => format!("struct S{index} {{ {}; }};", members.join("; ")),
                false => format!("struct S{index} {{ {} }}", members.join(", ")),
            };
            self.line(&line);
        }
        self.interface();
        self.memory();
        for (index, helper) in self.program.helpers.iter().enumerate() {
            self.helper(index, helper);
        }
        let head = self.head();
        let (body, results) = (&self.program.body, &self.program.results);
        self.block(&head, |p| {
            if p.program.form == Form::Compute && p.glsl() {
                p.line("uint at = gl_GlobalInvocationID.x;");
                p.line("uint local = gl_LocalInvocationIndex;");
            } else if p.program.form == Form::Compute {
                p.line("let at = global.x;");
            }
            p.statements(body);
            p.finish(results, false);
        });
    }

    /// Memory of a workgroup, for each statement that needs some.
    fn memory(&mut self) {
        let mut lines = Vec::new();
        self.program.clone().each_block_mut(&mut |block| {
            for statement in block.iter() {
                match (statement, self.glsl()) {
                    (Statement::Exchange { id, value, .. }, true) => {
                        lines.push(format!("shared {} m{id}[{GROUP}];", self.ty(&value.ty)));
                    }
                    (Statement::Exchange { id, value, .. }, false) => {
                        lines.push(format!("var<workgroup> m{id}: array<{}, {GROUP}>;", self.ty(&value.ty)));
                    }
                    (Statement::Total { id, .. }, true) => lines.push(format!("shared uint m{id};")),
                    (Statement::Total { id, .. }, false) => {
                        lines.push(format!("var<workgroup> m{id}: atomic<u32>;"));
                    }
                    _ => {}
                }
            }
        });
        lines.iter().for_each(|line| self.line(line));
    }

    fn interface(&mut self) {
        let (form, glsl) = (self.program.form, self.glsl());
        if form == Form::Function {
            return;
        }
        let all = GROUP * GROUPS;
        let mut binding = 0;
        let mut location = 0;
        for (index, input) in self.program.inputs.iter().enumerate() {
            let ty = self.ty(&input.ty);
            let line = match (input.uniform, form, glsl) {
                (true, Form::Compute, true) => {
                    format!("layout(std140, binding = {binding}) uniform U{index} {{ {ty} x{index}; }};")
                }
                (true, _, true) => format!("uniform {ty} x{index};"),
                (true, _, false) => format!("@group(0) @binding({binding}) var<uniform> x{index}: {ty};"),
                (false, Form::Compute, true) => {
                    format!("layout(std430, binding = {binding}) readonly buffer B{index} {{ {ty} b{index}[{all}]; }};")
                }
                (false, Form::Compute, false) => {
                    format!("@group(0) @binding({binding}) var<storage, read> b{index}: array<{ty}, {all}>;")
                }
                (false, _, true) => {
                    let flat = form == Form::Fragment && is_whole(&input.ty);
                    // GLSL 3.30 has locations of attributes, and of the outputs of fragments alone.
                    let located = if self.is_plain() && form == Form::Fragment {
                        String::new()
                    } else {
                        format!("layout(location = {location}) ")
                    };
                    format!("{located}{}in {ty} x{index};", if flat { "flat " } else { "" })
                }
                // Parameters of the entry point.
                (false, _, false) => continue,
            };
            if input.uniform || form == Form::Compute {
                binding += 1;
            } else {
                location += 1;
            }
            self.line(&line);
        }
        let results = self.program.results.iter().enumerate();
        let types: Vec<(usize, String, bool)> = results.map(|(k, r)| (k, self.ty(&r.ty), is_whole(&r.ty))).collect();
        if form == Form::Compute {
            for (k, ty, _) in &types {
                let binding = binding + k;
                let line = match glsl {
                    true => format!("layout(std430, binding = {binding}) buffer R{k} {{ {ty} o{k}[{all}]; }};"),
                    false => {
                        format!("@group(0) @binding({binding}) var<storage, read_write> o{k}: array<{ty}, {all}>;")
                    }
                };
                self.line(&line);
            }
        } else if glsl {
            for (k, ty, whole) in &types {
                let flat = if form == Form::Vertex && *whole { "flat " } else { "" };
                let located = if self.is_plain() && form == Form::Vertex {
                    String::new()
                } else {
                    format!("layout(location = {k}) ")
                };
                self.line(&format!("{located}{flat}out {ty} o{k};"));
            }
        } else {
            self.block("struct Out", |p| {
                for (k, ty, whole) in &types {
                    let flat = if form == Form::Vertex && *whole { "@interpolate(flat) " } else { "" };
                    p.line(&format!("@location({k}) {flat}o{k}: {ty},"));
                }
                if form == Form::Vertex {
                    p.line("@builtin(position) position: vec4<f32>,");
                }
            });
        }
    }

    fn head(&self) -> String {
        let parameters = |attribute: &dyn Fn(usize, &Type) -> String| {
            let own = self.program.inputs.iter().enumerate().filter(|(_, input)| !input.uniform);
            let all: Vec<String> = own
                .enumerate()
                .map(|(place, (k, input))| {
                    format!("{}{}", attribute(place, &input.ty), self.declared(&format!("x{k}"), &input.ty))
                })
                .collect();
            all.join(", ")
        };
        match (self.program.form, self.glsl()) {
            (Form::Function, glsl) => {
                let parameters = parameters(&|_, _| String::new());
                let result = self.program.results.first().map(|result| self.ty(&result.ty)).unwrap_or_default();
                if glsl { format!("{result} f({parameters})") } else { format!("fn f({parameters}) -> {result}") }
            }
            (_, true) => "void main()".to_owned(),
            (Form::Compute, false) => format!(
                "@compute @workgroup_size({GROUP})\nfn main(@builtin(global_invocation_id) global: vec3<u32>, \
                 @builtin(local_invocation_index) local: u32)"
            ),
            (form, false) => {
                let located = |place: usize, ty: &Type| {
                    let flat = if form == Form::Fragment && is_whole(ty) { " @interpolate(flat)" } else { "" };
                    format!("@location({place}){flat} ")
                };
                format!("@{}\nfn main({}) -> Out", form.name(), parameters(&located))
            }
        }
    }
}

/// True for what is not interpolated.
fn is_whole(ty: &Type) -> bool {
    matches!(ty, Type::Value(Scalar::Int | Scalar::Uint, _))
}
