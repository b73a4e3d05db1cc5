//! A caller for a function in WGSL that cannot be called by itself. For one that invocations of a workgroup call together,
//! since it waits at a barrier or has memory of its workgroup, the smallest kernel is made up that calls it once for each
//! invocation; for one that reads or writes storage, a kernel of one invocation.
//!
//! Arguments are told by their names and types: numbers of invocations and workgroups are those of the kernel, places in
//! storage are those of elements that are there, and every other argument is one number of the host.

use std::collections::{HashMap, HashSet};
use std::fmt::Write as _;

use base::text::{Assembly, SourceFile, Span};
use program::{ModuleText, Written};
use syntax::Shader;
use syntax::symbols::FunctionInfo;
use syntax::wgsl::{MemberSyntax, ModuleItem, TypeSyntax, VariableSyntax};
use syntax::words::words;

/// What the name of a kernel ends with that is made up for a function.
const CALLER: &str = "_caller";

/// Number of the first binding that is made up: beyond those of any text.
const FIRST: usize = 1 << 21;

/// A kernel that calls a function.
pub(super) struct MadeCaller {
    /// The text with it.
    pub text: ModuleText,
    /// Its name.
    pub kernel: String,
    /// True for one that calls it once, in a dispatch of one invocation, for a function that reads or writes storage.
    pub alone: bool,
}

impl MadeCaller {
    /// What an input or output is called in the function: the kernel has a variable for each.
    pub fn own_name<'n>(&self, name: &'n str) -> &'n str {
        name.strip_prefix(self.kernel.as_str()).and_then(|rest| rest.strip_prefix('_')).unwrap_or(name)
    }
}

/// What the result of a function is called: no parameter has this name, which is a word of the language.
pub(super) const RETURN: &str = "return";

/// Elements that a run of one invocation has of an array that is as long as its buffer.
const ELEMENTS: u32 = program::ELEMENTS_ALONE;

/// The text with a kernel that calls a function; none where no such kernel can be made up.
pub(super) fn with_caller(text: &ModuleText, function: &str) -> Option<MadeCaller> {
    let tree = text.tree()?;
    let module = tree.wgsl()?;
    let (params, returns) = head(text, function)?;
    let (shared, stored) = (variables(&module.items, "workgroup"), variables(&module.items, "storage"));
    // Invocations of a workgroup call a function together that waits at a barrier or has memory of the workgroup.
    let together = reaches(tree, function, &|word| word.ends_with("Barrier") || shared.contains(word));
    if !together && !reaches(tree, function, &|word| stored.contains(word)) {
        return None;
    }
    let file = text.file();
    let kernel = format!("{}{CALLER}", function.trim_end_matches('_'));
    if file.text().contains(&kernel) {
        return None;
    }
    let own = tree.functions().find(|(_, own)| own.name.name == function).and_then(|(_, own)| body(tree, own));
    let places = own.map(|span| places(tree, span, if together { &shared } else { &stored })).unwrap_or_default();
    let mut caller = Caller {
        file,
        kernel: &kernel,
        alone: !together,
        places,
        declared: String::new(),
        body: String::new(),
        binding: FIRST,
    };
    let arguments: Option<Vec<String>> = params.iter().map(|param| caller.argument(param)).collect();
    let call = format!("{function}({})", arguments?.join(", "));
    caller.call(&call, returns.map(|ty| file.slice(ty.span)));
    let made = with_more(file, &caller.finish(invocations(tree, &module.items)))?;
    Some(MadeCaller { text: made, kernel, alone: !together })
}

/// The parameters of a function, and the type that it returns.
pub(super) fn head<'t>(text: &'t ModuleText, function: &str) -> Option<(&'t [MemberSyntax], Option<&'t TypeSyntax>)> {
    text.tree()?.wgsl()?.items.iter().find_map(|item| match item {
        ModuleItem::Function { name, params, returns, .. } if name.name == function => {
            Some((params.as_slice(), returns.as_ref().map(|(_, ty)| ty)))
        }
        _ => None,
    })
}

/// A module with more behind it.
pub(super) fn with_more(file: &SourceFile, more: &str) -> Option<ModuleText> {
    let (mut out, end) = (Assembly::new(), file.text().len());
    out.copy(file, Span::new(0, end));
    out.insert(more, file, end);
    ModuleText::read(&out.finish(file.name()), Written::Wgsl).ok()
}

/// Names that stand in indices into some variables.
fn places(tree: &Shader, within: Span, of: &HashSet<String>) -> HashSet<String> {
    let words =
        tree.tokens().iter().filter(|token| within.touches(token.span)).map(|token| tree.file().slice(token.span));
    let (mut found, mut depth, mut last) = (HashSet::new(), 0, "");
    for word in words {
        match word {
            "[" if depth > 0 || of.contains(last) => depth += 1,
            "]" if depth > 0 => depth -= 1,
            _ if depth > 0 => {
                found.insert(word.to_owned());
            }
            _ => {}
        }
        last = word;
    }
    found
}

/// Names of the variables of a module in an address space.
fn variables(items: &[ModuleItem], space: &str) -> HashSet<String> {
    let name = |item: &ModuleItem| match item {
        ModuleItem::Variable(own) if own.space.iter().any(|word| word.name == space) => Some(own.name.name.clone()),
        _ => None,
    };
    items.iter().filter_map(name).collect()
}

/// True where a function, or one that it calls, has such a word.
fn reaches(tree: &Shader, function: &str, is: &dyn Fn(&str) -> bool) -> bool {
    let bodies: HashMap<&str, Span> =
        tree.functions().filter_map(|(_, own)| Some((own.name.name.as_str(), body(tree, own)?))).collect();
    let (mut open, mut seen) = (vec![function], HashSet::new());
    while let Some(name) = open.pop() {
        let Some(span) = bodies.get(name).filter(|_| seen.insert(name)) else { continue };
        let within = tree.tokens().iter().filter(|token| span.touches(token.span));
        for word in within.map(|token| tree.file().slice(token.span)) {
            if is(word) {
                return true;
            }
            open.extend(bodies.get_key_value(word).map(|(name, _)| *name));
        }
    }
    false
}

/// The place of a function.
fn body(tree: &Shader, function: &FunctionInfo) -> Option<Span> {
    tree.unit().items.get(function.definition?).map(|item| item.span)
}

/// Invocations of a workgroup: as many as an array of its memory has elements, which is how such memory is used.
fn invocations(tree: &Shader, items: &[ModuleItem]) -> u32 {
    let of_array = |item: &ModuleItem| {
        let ModuleItem::Variable(own) = item else { return None };
        let ty = own.ty.as_ref().filter(|ty| is_shared(own) && ty.name.name == "array")?;
        let count = tree.fold(ty.args.get(1)?.expr?)?.as_integer()?;
        u32::try_from(count).ok().filter(|count| (1..=256).contains(count))
    };
    items.iter().find_map(of_array).unwrap_or(64)
}

/// True for memory of a workgroup.
fn is_shared(variable: &VariableSyntax) -> bool {
    variable.space.iter().any(|word| word.name == "workgroup")
}

struct Caller<'a> {
    file: &'a SourceFile,
    kernel: &'a str,
    /// It is called once.
    alone: bool,
    /// Names in indices into the memory that matters, whatever they are called: in that of the workgroup they tell its
    /// invocations apart.
    places: HashSet<String>,
    declared: String,
    body: String,
    binding: usize,
}

/// What an argument is by its name.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Number {
    Global,
    Local,
    Group,
}

fn number(name: &str) -> Option<Number> {
    let words = words(name);
    let is = |all: &[&str]| words.iter().any(|word| all.contains(&word.as_str()));
    match () {
        () if is(&["workgroup", "group", "wg", "wid", "block", "tile"]) => Some(Number::Group),
        () if is(&["local", "gi", "li", "lid", "tid", "lane", "thread"]) => Some(Number::Local),
        () if is(&["global", "id", "gid", "invocation", "index", "idx", "i"]) => Some(Number::Global),
        () => None,
    }
}

impl Caller<'_> {
    fn argument(&mut self, param: &MemberSyntax) -> Option<String> {
        let ty = self.file.slice(param.ty.span);
        if param.ty.name.name == "ptr" {
            return self.pointer(&param.ty, &param.name.name);
        }
        let numbers = |number: Number| match number {
            Number::Global => ("g", "g.x"),
            Number::Local => ("l", "k"),
            Number::Group => ("w", "w.x"),
        };
        let short: String = ty.chars().filter(|c| !c.is_whitespace()).collect();
        if self.alone {
            return Some(self.place(&param.name.name, &short).unwrap_or_else(|| self.plain(&param.name.name, ty)));
        }
        let own = number(&param.name.name).map(|number| match number {
            Number::Global if self.places.contains(&param.name.name) => Number::Local,
            number => number,
        });
        if let Some((all, one)) = own.map(numbers) {
            match short.as_str() {
                "u32" => return Some(one.to_owned()),
                "i32" => return Some(format!("i32({one})")),
                "vec2u" | "vec2<u32>" => return Some(format!("{all}.xy")),
                "vec3u" | "vec3<u32>" => return Some(all.to_owned()),
                "vec2i" | "vec2<i32>" => return Some(format!("vec2i({all}.xy)")),
                _ => {}
            }
        }
        Some(self.plain(&param.name.name, ty))
    }

    /// Any value; no host gives a truth value.
    fn plain(&mut self, name: &str, ty: &str) -> String {
        if ty.trim() == "bool" {
            return format!("({} % 2u == 1u)", self.input(name, "u32"));
        }
        self.input(name, ty)
    }

    /// The place of an element that is there, for an argument that is one.
    fn place(&mut self, name: &str, ty: &str) -> Option<String> {
        if number(name).is_none() && !self.places.contains(name) {
            return None;
        }
        let (wide, whole) = match ty {
            "u32" | "i32" => ("u32", format!("{ELEMENTS}u")),
            "vec2u" | "vec2<u32>" | "vec2i" | "vec2<i32>" => ("vec2u", format!("vec2u({ELEMENTS}u)")),
            "vec3u" | "vec3<u32>" | "vec3i" | "vec3<i32>" => ("vec3u", format!("vec3u({ELEMENTS}u)")),
            _ => return None,
        };
        Some(format!("{ty}({} % {whole})", self.input(name, wide)))
    }

    /// A variable of the function or of the invocation, whose address is taken.
    fn pointer(&mut self, ty: &TypeSyntax, name: &str) -> Option<String> {
        let [space, pointee, ..] = &ty.args[..] else { return None };
        let space = space.ty.as_ref()?.name.name.clone();
        let pointee = self.file.slice(pointee.ty.as_ref()?.span);
        let name = format!("{}_{name}", self.kernel);
        match space.as_str() {
            "function" => {
                let _ = write!(self.body, "var {name}: {pointee}; ");
            }
            "private" | "workgroup" => {
                let _ = writeln!(self.declared, "var<{space}> {name}: {pointee};");
            }
            _ => return None,
        }
        Some(format!("&{name}"))
    }

    fn input(&mut self, name: &str, ty: &str) -> String {
        let name = format!("{}_{name}", self.kernel);
        let binding = self.bind();
        let _ = writeln!(self.declared, "@group(0) @binding({binding}) var<uniform> {name}: {ty};");
        name
    }

    fn bind(&mut self) -> usize {
        self.binding += 1;
        self.binding
    }

    /// Calls the function. What it gives goes to a buffer, so that it counts.
    fn call(&mut self, call: &str, gives: Option<&str>) {
        let Some(ty) = gives else {
            let _ = write!(self.body, "{call};");
            return;
        };
        let (name, binding) = (format!("{}_{RETURN}", self.kernel), self.bind());
        let (ty, call) = if ty == "bool" { ("u32", format!("u32({call})")) } else { (ty, call.to_owned()) };
        if self.alone {
            let _ = writeln!(self.declared, "@group(0) @binding({binding}) var<storage, read_write> {name}: {ty};");
            let _ = write!(self.body, "{name} = {call};");
            return;
        }
        let _ = writeln!(self.declared, "@group(0) @binding({binding}) var<storage, read_write> {name}: array<{ty}>;");
        let _ = write!(self.body, "let result = {call}; if g.x < arrayLength(&{name}) {{ {name}[g.x] = result; }}");
    }

    fn finish(self, size: u32) -> String {
        if self.alone {
            return format!(
                "\n{}@compute @workgroup_size(1) fn {}() {{ {} }}\n",
                self.declared, self.kernel, self.body
            );
        }
        format!(
            "\n{}@compute @workgroup_size({size}) fn {}(@builtin(global_invocation_id) g: vec3u, \
             @builtin(local_invocation_id) l: vec3u, @builtin(local_invocation_index) k: u32, \
             @builtin(workgroup_id) w: vec3u) {{ {} }}\n",
            self.declared, self.kernel, self.body
        )
    }
}
