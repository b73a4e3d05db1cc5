//! Declarations that stand for those that a text lacks.

use std::cmp::Reverse;
use std::fmt::Write as _;

use base::text::{Assembly, SourceFile, Span};
use syntax::types::{ScalarType, Type};

/// What the name of a structure ends with that a variable or a member needs, and that nothing names.
pub(super) const MADE: &str = "_type";

/// A declaration that stands for one that a text lacks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Stand {
    /// The name that nothing declares.
    pub name: String,
    /// Bytes from its place to the end of the text: what a version puts in front of a text does not move it.
    pub(super) before_end: usize,
    pub(super) form: Form,
    /// What goes in front of types of numbers: a precision, in OpenGL ES.
    pub(super) precision: &'static str,
}

/// What a name is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Form {
    /// A structure, with the members that are asked for.
    Structure(Vec<(String, Shape)>),
    /// A variable: `uniform`, `out`, or nothing for one that is written and read.
    Variable(&'static str, Shape),
    /// A function: parameters of each overload, and what all of them give.
    Function(Vec<Vec<Param>>, Gives),
    /// A line that asks for a file which is not there, with its bytes: it is left out.
    Include(usize),
    /// Another file of the project, and the functions that it defines.
    File(SourceFile, Vec<String>),
}

/// A type, and how many elements an array of it has.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Shape {
    pub ty: String,
    pub count: Option<u32>,
}

/// A parameter.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Param {
    pub ty: String,
    /// It has no value before the call, so that it gets one.
    pub out: bool,
}

/// The type of what a function gives.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Gives {
    /// That of its first argument.
    First,
    /// Always this one.
    Always(String),
}

impl Shape {
    pub(super) fn one(ty: impl Into<String>) -> Self {
        Self { ty: ty.into(), count: None }
    }

    fn dims(&self) -> String {
        self.count.map_or_else(String::new, |count| format!("[{count}]"))
    }
}

impl Stand {
    /// What it is, in words: `vec3`, `float[16]`, `a structure`, `vec3 of a call`.
    pub fn what(&self) -> String {
        match &self.form {
            Form::Structure(_) => "a structure".to_owned(),
            Form::Include(_) => "nothing".to_owned(),
            Form::File(..) => "a file".to_owned(),
            Form::Variable(_, shape) if shape.ty.ends_with(MADE) => format!("a structure{}", shape.dims()),
            Form::Variable(_, shape) => format!("`{}{}`", shape.ty, shape.dims()),
            Form::Function(overloads, gives) => match (gives, overloads.first().and_then(|first| first.first())) {
                (Gives::Always(ty), _) if ty == "void" => "a function".to_owned(),
                (Gives::Always(ty), _) if ty.ends_with(MADE) => "a function that gives a structure".to_owned(),
                (Gives::Always(ty), _) => format!("a function that gives `{ty}`"),
                (Gives::First, param) => {
                    format!("a function that gives `{}`", param.map_or("float", |param| param.ty.as_str()))
                }
            },
        }
    }

    /// True for a constant, whose value is as good as any.
    pub(super) fn is_constant(&self) -> bool {
        matches!(self.form, Form::Variable("const", _))
    }

    /// True for the name of an input that it brings.
    pub(super) fn holds(&self, input: &str) -> bool {
        let given =
            || input.strip_prefix(self.name.trim_end_matches('_')).is_some_and(|rest| rest.starts_with("_value"));
        match self.form {
            Form::Variable(..) => input == self.name,
            Form::Function(..) => given(),
            Form::Structure(_) | Form::Include(_) | Form::File(..) => false,
        }
    }

    /// True where it stands for a function.
    pub(super) fn is_function(&self) -> bool {
        matches!(self.form, Form::Function(..))
    }

    /// True for a function that comes with it.
    pub(super) fn brings(&self, function: &str) -> bool {
        match &self.form {
            Form::File(_, functions) => functions.iter().any(|own| own == function),
            _ => self.name == function,
        }
    }

    /// The name of an input that holds what a function gives.
    fn value(&self, text: &str, more: &str) -> String {
        let mut name = format!("{}_value{more}", self.name.trim_end_matches('_'));
        while text.contains(&name) {
            name.push('0');
        }
        name
    }

    fn typed(&self, ty: &str) -> String {
        let has_precision = match Type::from_name(ty) {
            Some(ty) => ty.scalar() != Some(ScalarType::Bool),
            // The others have a name of the text.
            None => ty.contains("sampler"),
        };
        if has_precision { format!("{}{ty}", self.precision) } else { ty.to_owned() }
    }

    /// The declaration, in GLSL.
    fn declaration(&self, text: &str) -> String {
        let name = &self.name;
        match &self.form {
            Form::Include(len) => " ".repeat(*len),
            Form::File(file, _) => format!("{}\n", file.text()),
            Form::Structure(members) if members.is_empty() => format!("struct {name} {{ int unused_; }};\n"),
            Form::Structure(members) => {
                let member =
                    |(name, shape): &(String, Shape)| format!("{} {name}{};", self.typed(&shape.ty), shape.dims());
                let members: Vec<String> = members.iter().map(member).collect();
                format!("struct {name} {{ {} }};\n", members.join(" "))
            }
            Form::Variable(storage, shape) => {
                format!("{storage} {} {name}{};\n", self.typed(&shape.ty), shape.dims())
            }
            Form::Function(overloads, gives) => {
                let mut out = String::new();
                for (k, params) in overloads.iter().enumerate() {
                    self.overload(&mut out, text, (k, params), gives);
                }
                out
            }
        }
    }

    fn overload(&self, out: &mut String, text: &str, (k, params): (usize, &[Param]), gives: &Gives) {
        let gives = match gives {
            Gives::Always(ty) => ty.as_str(),
            Gives::First => params.first().map_or("float", |param| param.ty.as_str()),
        };
        let more = if k == 0 { String::new() } else { k.to_string() };
        let (mut heads, mut body) = (Vec::new(), String::new());
        for (at, param) in params.iter().enumerate() {
            let ty = self.typed(&param.ty);
            if param.out {
                let input = self.value(text, &format!("{more}_{at}"));
                let _ = writeln!(out, "uniform {ty} {input};");
                let _ = write!(body, "a{at} = {input}; ");
            }
            heads.push(format!("{}{ty} a{at}", if param.out { "out " } else { "" }));
        }
        if gives != "void" {
            let input = self.value(text, &more);
            let _ = writeln!(out, "uniform {} {input};", self.typed(gives));
            let _ = write!(body, "return {input}{}; ", after_arguments(params, gives, &Type::from_name));
        }
        let gives = if gives == "void" { gives.to_owned() } else { self.typed(gives) };
        let _ = writeln!(out, "{gives} {}({}) {{ {body}}}", self.name, heads.join(", "));
    }

    /// The types that it needs.
    fn needs(&self) -> Vec<&str> {
        match &self.form {
            Form::Include(_) | Form::File(..) => Vec::new(),
            Form::Structure(members) => members.iter().map(|(_, shape)| shape.ty.as_str()).collect(),
            Form::Variable(_, shape) => vec![&shape.ty],
            Form::Function(overloads, gives) => {
                let gives = if let Gives::Always(ty) = gives { Some(ty.as_str()) } else { None };
                overloads.iter().flatten().map(|param| param.ty.as_str()).chain(gives).collect()
            }
        }
    }
}

/// What lets an argument without a value leave none in a sum of real numbers, as nearly every function does. `of_name` reads
/// the names of types.
pub(super) fn after_arguments(params: &[Param], gives: &str, of_name: &dyn Fn(&str) -> Option<Type>) -> String {
    let reals = |ty: &str| match of_name(ty) {
        Some(Type::Scalar(ScalarType::Float)) => vec![""],
        Some(Type::Vector(ScalarType::Float, count)) => [".x", ".y", ".z", ".w"][..usize::from(count)].to_vec(),
        _ => Vec::new(),
    };
    if reals(gives).is_empty() {
        return String::new();
    }
    let of = |(at, param): (usize, &Param)| {
        reals(&param.ty).into_iter().map(move |part| format!(" + 0.0 * a{at}{part}")).collect::<String>()
    };
    params.iter().enumerate().filter(|(_, param)| !param.out).map(of).collect()
}

/// What stands in a text, by its place.
struct Put<'s> {
    /// Bytes from its place to the end of the text.
    before_end: usize,
    text: String,
    /// The file whose text it is, between two line breaks.
    of: Option<&'s SourceFile>,
    /// Bytes of the text that it stands for: as many as it has.
    covers: usize,
}

/// The declarations with their places, the first place first; a structure stands before what needs it.
fn in_order<'s>(stands: &'s [Stand], text: &str) -> Vec<Put<'s>> {
    let mut at: Vec<usize> = stands.iter().map(|stand| stand.before_end).collect();
    for _ in stands {
        for k in 0..stands.len() {
            for need in stands[k].needs() {
                if let Some(own) = stands.iter().position(|stand| stand.name == need) {
                    at[own] = at[own].max(at[k]);
                }
            }
        }
    }
    let rank = |form: &Form| match form {
        // What a file brings may need what the text lacks.
        Form::Structure(_) | Form::Include(_) => 0,
        Form::File(..) => 3,
        Form::Variable(..) => 1,
        Form::Function(..) => 2,
    };
    let mut order: Vec<usize> = (0..stands.len()).collect();
    // Members come behind the structure that has them.
    order.sort_by_key(|&k| (Reverse(at[k]), rank(&stands[k].form), Reverse(k)));
    let put = |k: usize| {
        let (before_end, declaration) = (at[k], stands[k].declaration(text));
        // Behind a line comment, there is no declaration.
        let own_line = format!("\n{declaration}");
        match &stands[k].form {
            Form::Include(covers) => Put { before_end, text: declaration, of: None, covers: *covers },
            Form::File(file, _) => Put { before_end, text: own_line, of: Some(file), covers: 0 },
            _ => Put { before_end, text: own_line, of: None, covers: 0 },
        }
    };
    order.into_iter().map(put).collect()
}

/// The text with declarations, each in its place.
pub(super) fn put(stands: &[Stand], file: &SourceFile) -> SourceFile {
    if stands.is_empty() {
        return file.clone();
    }
    let (mut out, mut done, end) = (Assembly::new(), 0, file.text().len());
    for Put { before_end, text, of, covers } in in_order(stands, file.text()) {
        let place = end.saturating_sub(before_end).max(done);
        out.copy(file, Span::new(done, place));
        match of {
            Some(sibling) => {
                out.insert("\n", file, place);
                out.copy(sibling, Span::new(0, sibling.text().len()));
                out.insert("\n", file, place);
            }
            None => out.replace(&text, file, Span::new(place, place + covers)),
        }
        done = place + covers;
    }
    out.copy(file, Span::new(done, end));
    out.finish(file.name())
}

/// The place in a text, in bytes before its end, that a place in what [`put`] makes of it comes from.
pub(super) fn back(stands: &[Stand], text: &str, before_end: usize) -> usize {
    let mut added = 0;
    for Put { before_end: at, text, .. } in in_order(stands, text).iter().rev().filter(|put| put.covers == 0) {
        if before_end <= at + added {
            break;
        }
        added += text.len();
        if before_end < at + added {
            return *at;
        }
    }
    before_end - added
}

/// Names that are told at most.
const MOST_TOLD: usize = 6;

/// What to tell of declarations that are assumed, and of files that are not there.
pub fn declared_notes(stands: &[Stand]) -> Vec<String> {
    let list = |all: &[String]| {
        let (first, more) = all.split_at(all.len().min(MOST_TOLD));
        let more = if more.is_empty() { String::new() } else { format!(" and {} more", more.len()) };
        format!("{}{more}", first.join(", "))
    };
    let (files, stands): (Vec<&Stand>, Vec<&Stand>) =
        stands.iter().partition(|stand| matches!(stand.form, Form::File(..)));
    let (includes, names): (Vec<&Stand>, Vec<&Stand>) =
        stands.into_iter().partition(|stand| matches!(stand.form, Form::Include(_)));
    let named = names.iter().filter(|stand| !stand.name.ends_with(MADE));
    let told: Vec<String> = named.map(|stand| format!("`{}` as {}", stand.name, stand.what())).collect();
    let lines: Vec<String> = includes.iter().map(|stand| format!("`{}`", stand.name)).collect();
    let mut notes: Vec<String> =
        files.iter().map(|stand| format!("functions that are missing are taken from {}", stand.name)).collect();
    if !lines.is_empty() {
        notes.push(format!("not found, and left out: {}; name the folder with `-I FOLDER`", list(&lines)));
    }
    if !told.is_empty() {
        let are = if told.len() == 1 { "a name that nothing declares is" } else { "names that nothing declares are" };
        notes.push(format!("{are} taken for inputs of any value: {}", list(&told)));
    }
    notes
}
