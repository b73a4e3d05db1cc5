//! What a text in HLSL or Slang declares, as far as its compilers have to be told: they keep what an entry point uses,
//! and ask for the stage of each.
//!
//! A reader of declarations alone. A compiler has the last word: what is taken for a function here and is none for it
//! is left out.

use std::collections::HashMap;

use super::Written;
use crate::Parameter;
use base::text::Span;
use syntax::symbols::Direction;
use syntax::wgsl::tokens;
use syntax::{Stage, Token};

/// Declarations of a text.
#[derive(Clone, Debug, Default)]
pub struct Outline {
    /// Functions with a body that stand outside of types, in the order of the text.
    pub functions: Vec<Head>,
    /// Names of `cbuffer` and `tbuffer` blocks, whose members have no name in front.
    pub blocks: Vec<String>,
    /// The members of each structure that have a semantic, with that semantic in capitals.
    structures: HashMap<String, Vec<(String, String)>>,
}

/// The head of a function.
#[derive(Clone, Debug, Default)]
pub struct Head {
    /// Its name, with those of its namespaces.
    pub name: String,
    /// The place of the name.
    pub span: Span,
    /// The type of its value.
    pub result: String,
    /// Its parameters.
    pub params: Vec<Param>,
    /// Why nothing but its caller can call it, if that is so.
    pub unfit: Option<String>,
    /// The semantic of its value.
    semantic: Option<String>,
    /// Words of each attribute in front of it.
    attributes: Vec<Vec<String>>,
    /// True where its text is one of several alternatives.
    inactive: bool,
}

/// How a parameter is passed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Way {
    /// By value.
    #[default]
    In,
    /// Its value goes back to the caller.
    Out,
    /// Both.
    InOut,
}

/// A parameter.
#[derive(Clone, Debug, Default)]
pub struct Param {
    /// Its name; empty where it has none.
    pub name: String,
    /// Its type, without the sizes of an array.
    pub ty: String,
    /// The sizes of an array, with their brackets.
    pub sizes: String,
    /// How it is passed.
    pub way: Way,
    semantic: Option<String>,
}

/// Words in front of a type that are no part of it.
const MODIFIERS: [&str; 28] = [
    "in",
    "out",
    "inout",
    "const",
    "uniform",
    "static",
    "inline",
    "export",
    "extern",
    "public",
    "internal",
    "private",
    "precise",
    "nointerpolation",
    "linear",
    "centroid",
    "noperspective",
    "sample",
    "row_major",
    "column_major",
    "globallycoherent",
    "no_diff",
    "noinline",
    "borrow",
    "triangle",
    "point",
    "line",
    "func",
];

/// Beginnings of the names of types that hold no numbers.
const RESOURCES: [&str; 21] = [
    "Texture",
    "RWTexture",
    "Sampler",
    "sampler",
    "texture",
    "Buffer",
    "RWBuffer",
    "StructuredBuffer",
    "RWStructuredBuffer",
    "ByteAddressBuffer",
    "RWByteAddressBuffer",
    "AppendStructuredBuffer",
    "ConsumeStructuredBuffer",
    "ConstantBuffer",
    "ParameterBlock",
    "RaytracingAccelerationStructure",
    "PointStream",
    "LineStream",
    "TriangleStream",
    "InputPatch",
    "OutputPatch",
];

/// Words that begin a declaration whose braces hold no statements.
const TYPES: [&str; 7] = ["struct", "class", "interface", "enum", "extension", "union", "__extension"];

impl Outline {
    /// Reads a text.
    pub fn read(text: &str) -> Self {
        let code = without_directives(text);
        let all = tokens(&code);
        let mut reader = OutlineReader { text: &code, all: &all, found: Self::default() };
        reader.scope(0, "");
        reader.found
    }

    /// The functions of this name that may be entry points, with the stage that the text gives each.
    pub fn points(&self) -> impl Iterator<Item = (&Head, Option<Stage>)> {
        self.functions.iter().filter(|head| !head.inactive && !head.name.contains(':')).filter_map(|head| {
            let stage = self.stage(head);
            (stage.is_some() || head.name == "main").then_some((head, stage.flatten()))
        })
    }

    /// What an entry point calls the output with one of these semantics.
    pub(super) fn output(&self, point: &str, semantics: &[&str]) -> Option<&str> {
        let head = self.functions.iter().find(|head| head.name == point)?;
        let is = |semantic: &str| semantics.contains(&semantic);
        let given = head.params.iter().filter(|param| param.way != Way::In);
        let own =
            given.clone().find(|param| param.semantic.as_deref().is_some_and(is)).map(|param| param.name.as_str());
        let types = std::iter::once(head.result.as_str()).chain(given.map(|param| param.ty.as_str()));
        let mut members = types.filter_map(|ty| self.structures.get(ty)).flatten();
        let member = members.find(|(_, semantic)| is(semantic)).map(|(name, _)| name.as_str());
        own.or(member).or_else(|| head.semantic.as_deref().is_some_and(is).then_some("return"))
    }

    /// The stage of a function that is an entry point; the inner value is none for stages that are not run.
    fn stage(&self, head: &Head) -> Option<Option<Stage>> {
        let attribute = |name: &str| head.attributes.iter().find(|words| words.first().is_some_and(|w| w == name));
        if let Some(shader) = attribute("shader") {
            return Some(shader.get(1).and_then(|stage| stage_named(stage)));
        }
        if attribute("numthreads").is_some() {
            return Some(Some(Stage::Compute));
        }
        if ["maxvertexcount", "domain", "patchconstantfunc"].iter().any(|name| attribute(name).is_some()) {
            return Some(None);
        }
        let of_type = |ty: &str| self.structures.get(ty).into_iter().flatten().map(|(_, semantic)| semantic.as_str());
        let given = head.params.iter().filter(|param| param.way != Way::In);
        let given = given.flat_map(|param| param.semantic.as_deref().into_iter().chain(of_type(&param.ty)));
        let gives: Vec<&str> = head.semantic.as_deref().into_iter().chain(of_type(&head.result)).chain(given).collect();
        let is = |wanted: &str| gives.iter().any(|semantic| semantic.starts_with(wanted));
        let own = head.semantic.is_some() || head.params.iter().any(|param| param.semantic.is_some());
        // A function that only hands a structure on has its semantics as well.
        let called = |parts: &[&str]| {
            let name = head.name.to_ascii_lowercase();
            name == "main" || parts.iter().any(|part| name.starts_with(part) || name.ends_with(part))
        };
        if is("SV_TARGET") || is("SV_DEPTH") || is("COLOR") && called(&["ps", "frag", "pixel"]) {
            return (own || called(&["ps", "frag", "pixel", "fs", "main"])).then_some(Some(Stage::Fragment));
        }
        if is("SV_POSITION") || is("POSITION") && called(&["vs", "vert"]) {
            return (own || called(&["vs", "vert", "main"])).then_some(Some(Stage::Vertex));
        }
        None
    }
}

/// A stage by its name in an attribute. Those that are not run have none.
fn stage_named(name: &str) -> Option<Stage> {
    match name {
        "vertex" => Some(Stage::Vertex),
        "fragment" | "pixel" => Some(Stage::Fragment),
        "compute" => Some(Stage::Compute),
        _ => None,
    }
}

impl Head {
    /// The name, with the types of its parameters where others have the same name.
    pub fn label(&self, outline: &Outline) -> String {
        match outline.functions.iter().filter(|head| head.name == self.name).count() {
            0 | 1 => self.name.clone(),
            _ => {
                let types: Vec<String> = self.params.iter().map(|p| format!("{}{}", p.ty, p.sizes)).collect();
                format!("{}({})", self.name, types.join(","))
            }
        }
    }

    /// Its parameters in the words of all languages.
    pub fn parameters(&self) -> Vec<Parameter> {
        let one = |param: &Param| {
            let element = Written::shape_named(&param.ty).map_or_else(|| param.ty.clone(), |shape| shape.to_string());
            let direction = match param.way {
                Way::In => Direction::In,
                Way::Out => Direction::Out,
                Way::InOut => Direction::InOut,
            };
            Parameter { ty: format!("{element}{}", param.sizes), direction }
        };
        self.params.iter().map(one).collect()
    }

    /// A function in one line that calls this one with anything and keeps what comes back, so that a compiler keeps it.
    pub fn keeper(&self, k: usize) -> String {
        let names: Vec<String> = (0..self.params.len()).map(|n| format!("sc_{k}_{n}")).collect();
        let (mut line, mut body, mut after) = (String::new(), String::new(), String::new());
        for (param, name) in self.params.iter().zip(&names) {
            let (ty, sizes) = (&param.ty, &param.sizes);
            body += &format!("{ty} {name}{sizes}; ");
            if param.way != Way::In {
                line += &format!("static {ty} {name}_kept{sizes}; ");
                after += &format!(" {name}_kept = {name};");
            }
        }
        let mut call = format!("{}({});", self.name, names.join(", "));
        if self.result != "void" {
            line += &format!("static {} sc_{k}_result; ", self.result);
            call = format!("sc_{k}_result = {call}");
        }
        format!("{line}void sc_keep_{k}() {{ {body}{call}{after} }}")
    }
}

/// The text with blanks in the place of directives, and of the lines that continue them.
fn without_directives(text: &str) -> String {
    let (mut code, mut goes_on) = (String::with_capacity(text.len()), false);
    for line in text.split_inclusive('\n') {
        if goes_on || line.trim_start().starts_with('#') {
            goes_on = line.trim_end().ends_with('\\');
            // Bytes count: places are those of the text.
            code.extend(line.bytes().map(|byte| if byte == b'\n' { '\n' } else { ' ' }));
        } else {
            code.push_str(line);
        }
    }
    code
}

struct OutlineReader<'a> {
    text: &'a str,
    all: &'a [Token],
    found: Outline,
}

impl<'a> OutlineReader<'a> {
    fn word(&self, at: usize) -> &'a str {
        self.all.get(at).map_or("", |token| &self.text[token.span.range()])
    }

    fn is_name(&self, at: usize) -> bool {
        self.word(at).starts_with(|c: char| c.is_alphabetic() || c == '_')
    }

    /// The token behind the bracket that closes the one at `at`.
    fn behind(&self, at: usize) -> usize {
        let mut depth = 0_usize;
        for k in at..self.all.len() {
            match self.word(k) {
                "(" | "[" | "{" => depth += 1,
                ")" | "]" | "}" => depth = depth.saturating_sub(1),
                _ => {}
            }
            if depth == 0 {
                return k + 1;
            }
        }
        self.all.len()
    }

    /// The token behind the `>` of the `<` at `at`; `at` itself where none is near.
    fn behind_angle(&self, at: usize) -> usize {
        let mut depth = 0_isize;
        for k in at..self.all.len().min(at + 64) {
            match self.word(k) {
                "<" => depth += 1,
                ">" => depth -= 1,
                ">>" => depth -= 2,
                ";" | "{" | "}" => return at,
                _ => {}
            }
            if depth <= 0 {
                return k + 1;
            }
        }
        at
    }

    /// Reads declarations up to the brace that closes the scope; the token behind it.
    fn scope(&mut self, mut at: usize, within: &str) -> usize {
        let mut start = at;
        while at < self.all.len() {
            match self.word(at) {
                "}" => return at + 1,
                ";" => (at, start) = (at + 1, at + 1),
                "(" | "[" => at = self.behind(at),
                "{" => {
                    let first = self.past_attributes(start);
                    if self.word(first) == "namespace" {
                        let inner: String = (first + 1..at).map(|k| self.word(k)).collect();
                        at = self.scope(at + 1, &format!("{within}{inner}::"));
                        start = at;
                        continue;
                    }
                    let end = self.behind(at);
                    if self.declared(start, at, end, within) {
                        start = end;
                    }
                    at = end;
                }
                _ => at += 1,
            }
        }
        at
    }

    fn past_attributes(&self, mut at: usize) -> usize {
        while self.word(at) == "[" {
            at = self.behind(at);
        }
        at
    }

    /// What stands in front of a brace; true where the brace ends the declaration.
    fn declared(&mut self, start: usize, brace: usize, end: usize, within: &str) -> bool {
        let first = self.past_attributes(start);
        let words = || (first..brace).map(|k| self.word(k));
        if words().any(|word| TYPES.contains(&word)) && words().all(|word| word != "(") {
            let name = (first..brace).find(|&k| TYPES.contains(&self.word(k))).map(|k| self.word(k + 1));
            let follows = |k: usize| self.word(k) == ":" && self.is_name(k + 1);
            let member = |k: usize| {
                let sized = (brace..k).rev().find(|&k| !matches!(self.word(k), "[" | "]") && self.word(k + 1) != "]");
                let own = if self.word(k - 1) == "]" { sized.unwrap_or(k) } else { k - 1 };
                (self.word(own).to_owned(), self.word(k + 1).to_ascii_uppercase())
            };
            let members = (brace..end).filter(|&k| follows(k)).map(member).collect();
            self.found.structures.insert(name.unwrap_or_default().to_owned(), members);
            return true;
        }
        if let Some(k) = (first..brace).find(|&k| matches!(self.word(k), "cbuffer" | "tbuffer")) {
            self.found.blocks.push(self.word(k + 1).to_owned());
            return true;
        }
        // A value in braces belongs to a variable.
        if words().any(|word| word == "=") && words().all(|word| word != "operator") {
            let depth_of_equals = self.outside(first, brace, "=");
            if depth_of_equals {
                return false;
            }
        }
        let Some(head) = self.head(start, first, brace, within) else { return true };
        self.found.functions.push(head);
        true
    }

    /// True where a word stands outside of all brackets.
    fn outside(&self, mut at: usize, end: usize, wanted: &str) -> bool {
        while at < end {
            match self.word(at) {
                word if word == wanted => return true,
                "(" | "[" => at = self.behind(at),
                _ => at += 1,
            }
        }
        false
    }

    fn head(&self, start: usize, first: usize, brace: usize, within: &str) -> Option<Head> {
        let mut head = Head::default();
        let mut at = start;
        while at < first {
            let end = self.behind(at);
            // `[[vk::location(0)]]` has two brackets.
            let words = (at..end).filter(|&k| self.is_name(k)).map(|k| self.word(k).to_owned());
            head.attributes.push(words.collect());
            at = end;
        }
        let mut open = (first..brace).find(|&k| matches!(self.word(k), "(" | "<"))?;
        let mut name = open.checked_sub(1).filter(|&k| k >= first)?;
        // A type with parameters stands in front of the name: `vector<float, 3> f(`.
        while self.word(open) == "<" {
            let behind = self.behind_angle(open);
            if behind == open {
                return None;
            }
            if self.word(behind) == "(" {
                head.unfit = Some("it is generic: its caller chooses the types".to_owned());
                open = behind;
            } else {
                open = (behind..brace).find(|&k| matches!(self.word(k), "(" | "<"))?;
                name = open - 1;
            }
        }
        if self.word(open) != "(" || !self.is_name(name) || name == first && self.word(first) != "__init" {
            return None;
        }
        if matches!(self.word(name), "if" | "for" | "while" | "switch" | "operator" | "__init" | "__subscript") {
            return None;
        }
        let close = self.behind(open);
        let modern = (first..name).any(|k| self.word(k) == "func");
        let types: Vec<&str> = (first..name).map(|k| self.word(k)).filter(|word| !MODIFIERS.contains(word)).collect();
        head.result = joined(&types);
        if let Some(arrow) = (close..brace).find(|&k| self.word(k) == "->") {
            head.result =
                joined(&(arrow + 1..brace).map(|k| self.word(k)).take_while(|w| *w != "where").collect::<Vec<_>>());
        } else if modern {
            head.result = "void".to_owned();
        }
        head.semantic = (self.word(close) == ":").then(|| self.word(close + 1).to_ascii_uppercase());
        head.name = format!("{within}{}", self.word(name));
        head.span = self.all[name].span;
        head.inactive = self.all[name].place == syntax::TokenPlace::Inactive;
        head.params = self.params(open + 1, close - 1, modern);
        if head.unfit.is_none() {
            let resource = |ty: &str| RESOURCES.iter().any(|known| ty.starts_with(known));
            let unfit = head.params.iter().find(|param| resource(&param.ty));
            head.unfit =
                unfit.map(|param| format!("`{}` is a `{}`, which only its caller can give", param.name, param.ty));
        }
        Some(head)
    }

    fn params(&self, from: usize, to: usize, modern: bool) -> Vec<Param> {
        let (mut all, mut start, mut at) = (Vec::new(), from, from);
        while at <= to {
            match self.word(at) {
                _ if at == to => {}
                "(" | "[" | "{" => {
                    at = self.behind(at);
                    continue;
                }
                "<" => {
                    at = self.behind_angle(at).max(at + 1);
                    continue;
                }
                "," => {}
                _ => {
                    at += 1;
                    continue;
                }
            }
            all.extend(self.param(start, at, modern));
            (start, at) = (at + 1, at + 1);
        }
        all
    }

    fn param(&self, from: usize, to: usize, modern: bool) -> Option<Param> {
        let from = self.past_attributes(from);
        let mut words: Vec<&str> = (from..to).map(|k| self.word(k)).take_while(|word| *word != "=").collect();
        let mut param = Param::default();
        if modern {
            let colon = words.iter().position(|word| *word == ":")?;
            words.rotate_left(colon + 1);
            words.pop();
        } else if let Some(colon) = words.iter().position(|word| *word == ":") {
            param.semantic = words.get(colon + 1).map(|word| word.to_ascii_uppercase());
            words.truncate(colon);
        }
        param.way = match (words.contains(&"in"), words.contains(&"out"), words.contains(&"inout")) {
            (_, _, true) | (true, true, _) => Way::InOut,
            (_, true, _) => Way::Out,
            _ => Way::In,
        };
        words.retain(|word| !MODIFIERS.contains(word));
        // Sizes stand behind the name, or in Slang behind the type.
        let named = words.iter().rposition(|word| word.starts_with(|c: char| c.is_alphabetic() || c == '_'));
        let sized = words.iter().position(|word| *word == "[");
        match (words[..] == ["void"], named) {
            (true, _) => return None,
            (_, Some(0)) if sized.is_none() => {}
            (_, Some(_)) => {
                let last = match sized {
                    Some(sized) if sized + 1 < words.len() && words.last() == Some(&"]") => sized - 1,
                    _ => words.len() - 1,
                };
                param.sizes = words[last + 1..].concat();
                words.truncate(last + 1);
                param.name = words.pop().unwrap_or_default().to_owned();
            }
            (_, None) => return None,
        }
        param.ty = joined(&words);
        Some(param)
    }
}

/// Words of a type, with blanks where two names meet.
fn joined(words: &[&str]) -> String {
    let mut text = String::new();
    for word in words {
        let name = |c: Option<char>| c.is_some_and(|c| c.is_alphanumeric() || c == '_');
        if name(text.chars().last()) && name(word.chars().next()) {
            text.push(' ');
        }
        text.push_str(word);
    }
    text
}

#[cfg(test)]
mod tests;
