//! What stands for names that a text in WGSL lacks.
//!
//! Declarations stand in any order in WGSL: those that are assumed stand behind the text, whose places stay. Types follow from
//! the uses of a name. naga has the last word, and tells one error at a time: while there is one at a name that is assumed,
//! the next type is tried for it.

mod asked;
#[cfg(test)]
mod tests;
mod written;

use std::collections::HashSet;

use base::text::{SourceFile, Span};
use compose::Composed;
use program::{ModuleText, ProgramError, Written};
use syntax::ast::{Callee, ExprKind};
use syntax::types::Type;
use syntax::wgsl::{ModuleItem, TypeSyntax};
use syntax::{Shader, TokenKind};

use super::declared::{Form, Gives, MADE, Shape, Stand};
use asked::Asked;

/// Names that are assumed at most.
const MOST: usize = 96;

/// Bytes that naga reads at most: some seconds.
const MOST_READ: usize = 16 << 20;

/// Types that the name of one may stand for, the likeliest first.
const ALIASED: [&str; 7] = ["f32", "u32", "i32", "vec2f", "vec3f", "vec4f", "mat4x4f"];

/// A name, and what it may be, the likeliest first.
struct Choice {
    stand: Stand,
    options: Vec<Form>,
    /// What each member of a structure may be.
    members: Vec<Vec<Shape>>,
}

/// A text in WGSL with what stands for the names that it lacks; none where it lacks none, or is wrong with whatever stands
/// for them.
pub fn completed(composed: &Composed) -> Option<(SourceFile, Vec<Stand>)> {
    if composed.undeclared.is_empty() || composed.undeclared.len() > MOST {
        return None;
    }
    let shader = Shader::parse_wgsl(&composed.file).shader;
    let mut search = Search { file: &composed.file, passed: passed(&shader), choices: Vec::new() };
    search.declare(composed, &types_of(&shader));
    search.repair()?;
    Some((search.text(), search.choices.into_iter().map(|choice| choice.stand).collect()))
}

struct Search<'a> {
    file: &'a SourceFile,
    /// Structures that entry points take or give.
    passed: HashSet<String>,
    choices: Vec<Choice>,
}

impl Search<'_> {
    fn text(&self) -> SourceFile {
        let stands: Vec<&Stand> = self.choices.iter().map(|choice| &choice.stand).collect();
        written::put(&stands, self.file, &self.passed)
    }

    fn shader(&self) -> Shader {
        Shader::parse_wgsl(&self.text()).shader
    }

    fn add(&mut self, name: &str, options: Vec<Form>) {
        let Some(form) = options.first().cloned() else { return };
        let stand = Stand { name: name.to_owned(), before_end: 0, form, precision: "" };
        self.choices.push(Choice { stand, options, members: Vec::new() });
        self.made();
    }

    /// Declares structures that are made for a name.
    fn made(&mut self) {
        let shapes = |form: &Form| -> Vec<String> {
            match form {
                Form::Structure(members) => members.iter().map(|(_, shape)| shape.ty.clone()).collect(),
                Form::Variable(_, shape) => vec![shape.ty.clone()],
                Form::Function(_, Gives::Always(ty)) => vec![ty.clone()],
                Form::Function(..) | Form::Include(_) | Form::File(..) => Vec::new(),
            }
        };
        let made = self.choices.iter().flat_map(|choice| shapes(&choice.stand.form)).filter(|ty| ty.ends_with(MADE));
        let known = |name: &String| self.choices.iter().any(|choice| choice.stand.name == *name);
        let mut new: Vec<String> = made.filter(|name| !known(name)).collect();
        new.dedup();
        for name in new {
            self.add(&name, vec![Form::Structure(Vec::new())]);
        }
    }

    /// Declares all that is lacking: types first, and functions last, when the types of their arguments are known.
    fn declare(&mut self, composed: &Composed, types: &HashSet<String>) {
        let (structures, values): (Vec<_>, Vec<_>) =
            composed.undeclared.iter().map(|lacking| lacking.name.as_str()).partition(|name| types.contains(*name));
        for name in structures {
            self.add(name, vec![Form::Structure(Vec::new())]);
        }
        self.members();
        let called = |name: &str| composed.undeclared.iter().any(|lacking| lacking.name == name && lacking.called);
        let (functions, variables): (Vec<_>, Vec<_>) = values.into_iter().partition(|name| called(name));
        for name in variables {
            let shader = self.shader();
            let options = Asked::new(&shader).variable(name);
            self.add(name, options);
            self.members();
        }
        for name in functions {
            let shader = self.shader();
            let options = Asked::new(&shader).function(name);
            self.add(name, options);
            self.members();
        }
        for choice in &mut self.choices {
            if let Form::Structure(members) = &mut choice.stand.form
                && members.is_empty()
            {
                members.push(("unused_".to_owned(), Shape::one("f32")));
                // A type of which nobody takes a member is most likely one of the language that a host chooses.
                if !self.passed.contains(&choice.stand.name) && !choice.stand.name.ends_with(MADE) {
                    let structure = choice.stand.form.clone();
                    let aliases = ALIASED.map(|ty| Form::Variable("alias", Shape::one(ty)));
                    choice.options = aliases.into_iter().chain([structure]).collect();
                    choice.stand.form = choice.options[0].clone();
                }
            }
        }
    }

    /// Gives assumed structures the members that are asked for.
    fn members(&mut self) {
        for _ in 0..MOST {
            let shader = self.shader();
            let lacking = shader.arena().iter().find_map(|(_, expr)| {
                let ExprKind::Field { base, field } = &expr.kind else { return None };
                let Type::Struct(own) = shader.type_of(*base) else { return None };
                let at = self.choices.iter().position(|choice| choice.stand.name == own.name)?;
                let Form::Structure(members) = &self.choices[at].stand.form else { return None };
                let known = members.iter().any(|(name, _)| *name == field.name);
                (!known).then(|| (at, own.name.clone(), field.name.clone()))
            });
            let Some((at, structure, member)) = lacking else { return };
            let shapes = Asked::new(&shader).member(&structure, &member);
            let Choice { stand, members: options, .. } = &mut self.choices[at];
            if let (Form::Structure(members), Some(shape)) = (&mut stand.form, shapes.first()) {
                members.push((member, shape.clone()));
                options.push(shapes);
            }
            self.made();
        }
    }

    /// Tries types until naga takes the text.
    fn repair(&mut self) -> Option<()> {
        let (mut read, mut seen) = (0, HashSet::new());
        let mut wrong = self.wrong(&mut read);
        while let Some(Wrong { at: Some(place) }) = wrong {
            if read > MOST_READ || !seen.insert(place) {
                return None;
            }
            let mut slots = self.concerned(place);
            if slots.is_empty() {
                // naga knows no place within a function for some errors.
                slots = self.choices.iter().flat_map(|choice| self.slots(&choice.stand.name)).collect();
            }
            wrong = slots.into_iter().find_map(|slot| self.other(slot, place, &seen, &mut read))?;
        }
        wrong.is_none().then_some(())
    }

    /// What is wrong with the text with another form of a name, where that is further down than an error at a place, or in
    /// another function, and was not wrong before.
    fn other(&mut self, slot: Slot, place: Span, seen: &HashSet<Span>, read: &mut usize) -> Option<Option<Wrong>> {
        let choice = &self.choices[slot.choice];
        let before = choice.stand.form.clone();
        let forms = match (slot.member, &before) {
            (None, _) => choice.options.clone(),
            (Some(member), Form::Structure(members)) => {
                let with = |shape: &Shape| {
                    let mut members = members.clone();
                    members[member].1 = shape.clone();
                    Form::Structure(members)
                };
                choice.members.get(member).into_iter().flatten().map(with).collect()
            }
            (Some(_), _) => Vec::new(),
        };
        let is_further = |found: Span| {
            // What is assumed is wrong itself.
            if found.start >= self.file.text().len() {
                return false;
            }
            let (first, last) = (found.start.min(place.start), found.start.max(place.start));
            found.start > place.start || self.file.text().get(first..last).is_none_or(|text| text.contains("fn "))
        };
        let mut result = None;
        for form in forms {
            if form == before || *read > MOST_READ {
                continue;
            }
            self.choices[slot.choice].stand.form = form;
            let wrong = self.wrong(read);
            let better = match &wrong {
                None => true,
                Some(Wrong { at: Some(found) }) => !seen.contains(found) && is_further(*found),
                Some(Wrong { at: None }) => false,
            };
            if better {
                result = Some(wrong);
                break;
            }
        }
        if result.is_none() {
            self.choices[slot.choice].stand.form = before;
        }
        result
    }

    /// What a word of the text may name.
    fn slots(&self, word: &str) -> Vec<Slot> {
        let mut found = Vec::new();
        for (choice, own) in self.choices.iter().enumerate() {
            if own.stand.name == word || written::value(&own.stand) == word {
                found.push(Slot { choice, member: None });
            }
            if let Form::Structure(members) = &own.stand.form {
                let named = members.iter().enumerate().filter(|(_, (name, _))| name == word);
                found.extend(named.map(|(member, _)| Slot { choice, member: Some(member) }));
            }
        }
        found
    }

    fn wrong(&self, read: &mut usize) -> Option<Wrong> {
        let file = self.text();
        *read += file.text().len();
        match ModuleText::read(&file, Written::Wgsl) {
            Ok(_) => None,
            Err(ProgramError::Source(found)) => Some(Wrong { at: found.first().map(|error| error.span) }),
            Err(_) => Some(Wrong { at: None }),
        }
    }

    /// Assumed names in the statement at a place, and in those that give values to what it uses; the nearest first.
    fn concerned(&self, place: Span) -> Vec<Slot> {
        let file = self.text();
        let text = file.text();
        let tokens = syntax::wgsl::tokens(text);
        let ends = |at: &usize| matches!(&text[tokens[*at].span.range()], ";" | "{" | "}");
        let words = |place: Span| -> Vec<(usize, &str)> {
            let first = tokens.partition_point(|token| token.span.start <= place.start).saturating_sub(1);
            let start = (0..first).rev().find(ends).map_or(0, |at| at + 1);
            let end = (first..tokens.len()).find(ends).unwrap_or(tokens.len());
            let words = tokens[start..end].iter().filter(|token| token.kind == TokenKind::Word);
            let mut words: Vec<_> =
                words.map(|t| (t.span.start.abs_diff(place.start), &text[t.span.range()])).collect();
            words.sort_by_key(|(distance, _)| *distance);
            words
        };
        let mut found: Vec<Slot> = Vec::new();
        let (mut open, mut done) = (vec![place], HashSet::new());
        while let Some(place) = open.pop().filter(|_| done.len() < MOST) {
            for (_, word) in words(place) {
                let slots = self.slots(word);
                if !slots.is_empty() {
                    let new: Vec<Slot> = slots.into_iter().filter(|slot| !found.contains(slot)).collect();
                    found.extend(new);
                } else if done.insert(word) {
                    // What the text calls by this name further up.
                    let named = |pair: &&[syntax::Token]| {
                        matches!(&text[pair[0].span.range()], "let" | "var" | "const")
                            && text[pair[1].span.range()] == *word
                            && pair[1].span.start < place.start
                    };
                    open.extend(tokens.windows(2).rfind(named).map(|pair| pair[1].span));
                }
            }
        }
        found
    }
}

/// A form that may be another one: that of a name, or of a member of a structure.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Slot {
    choice: usize,
    member: Option<usize>,
}

/// Where naga finds the first error.
struct Wrong {
    at: Option<Span>,
}

/// The types that entry points of a stage with inputs or outputs take or give.
fn passed(shader: &Shader) -> HashSet<String> {
    let items = shader.wgsl().map(|module| module.items.as_slice()).unwrap_or_default();
    let of_entry = |item: &ModuleItem| match item {
        ModuleItem::Function { attributes, params, returns, .. }
            if attributes.iter().any(|own| matches!(own.name.name.as_str(), "vertex" | "fragment")) =>
        {
            let types = params.iter().map(|param| &param.ty).chain(returns.iter().map(|(_, ty)| ty));
            types.map(|ty| ty.name.name.clone()).collect()
        }
        _ => Vec::new(),
    };
    items.iter().flat_map(of_entry).collect()
}

/// Names that stand where a type does.
fn types_of(shader: &Shader) -> HashSet<String> {
    let Some(module) = shader.wgsl() else { return HashSet::new() };
    let mut open: Vec<&TypeSyntax> = Vec::new();
    for item in &module.items {
        match item {
            ModuleItem::Struct { members, .. } => open.extend(members.iter().map(|member| &member.ty)),
            ModuleItem::Alias { ty, .. } => open.push(ty),
            ModuleItem::Variable(variable) => open.extend(&variable.ty),
            ModuleItem::Function { params, returns, .. } => {
                open.extend(params.iter().map(|param| &param.ty));
                open.extend(returns.iter().map(|(_, ty)| ty));
            }
        }
    }
    open.extend(module.locals.values().filter_map(|local| local.ty.as_ref()));
    let mut found = HashSet::new();
    while let Some(ty) = open.pop() {
        found.insert(ty.name.name.clone());
        open.extend(ty.args.iter().filter_map(|arg| arg.ty.as_ref()));
    }
    // A call of a name with a capital makes a structure.
    let made = |name: &str| name.starts_with(char::is_uppercase) && name.contains(char::is_lowercase);
    for (_, expr) in shader.arena().iter() {
        if let ExprKind::Call { callee: Callee::Name(own), .. } = &expr.kind
            && made(&own.name)
        {
            found.insert(own.name.clone());
        }
    }
    found
}

/// What a function gives, always of one type.
fn gives(ty: &str) -> Gives {
    Gives::Always(ty.to_owned())
}
