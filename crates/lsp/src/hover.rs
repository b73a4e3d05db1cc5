//! What is told about the name or expression at a place: type, declaration, layout, built-ins, and the numbers that an
//! expression can take.

use std::fmt::Write as _;

use analysis::range;
use base::text::Span;
use ls_types::{Hover, HoverContents, MarkupContent, MarkupKind};
use syntax::ast::{ExprId, ExprKind, Qualifiers};
use syntax::interface::{Storage, Variable};
use syntax::offered::{Availability, Overload};
use syntax::symbols::{CallTarget, Direction, SymbolId, SymbolKind};
use syntax::types::Type;
use syntax::{BuiltinFunction, Shader};

use crate::occurrences::Meaning;
use crate::symbols::spelled;
use crate::unit::Unit;
use crate::workspace::Workspace;

/// Overloads that are written out.
const MOST_OVERLOADS: usize = 6;

/// Bytes of the longest text whose numbers are followed: an answer is wanted at once.
const LONGEST_FOLLOWED: usize = 200_000;

impl Workspace {
    /// What is told about a place.
    pub fn hover(&self, name: &str, offset: usize) -> Option<Hover> {
        let file = self.file(name)?;
        for unit in self.units_of(name) {
            let at = |span: Span| {
                unit.place_in(name, span).filter(|s| s.start <= offset && offset <= s.end && !s.is_empty())
            };
            let named = unit.occurrences().iter().rev().find(|o| at(o.span).is_some());
            let innermost = |(id, e): (ExprId, &syntax::ast::Expr)| Some((at(e.span)?, id));
            let expr =
                unit.shader.arena().iter().filter_map(innermost).min_by_key(|(span, id)| (span.len(), id.index()));
            let told = named.map(|o| (o.span, self.of_meaning(unit, &o.meaning)));
            let told = told
                .or_else(|| expr.and_then(|(_, id)| Some((unit.shader.expr(id).span, of_builtin(&unit.shader, id)?))));
            let expr = expr.map(|(_, id)| id);
            let (span, mut text) = match (told, expr) {
                (Some(told), _) => told,
                (None, Some(id)) => {
                    let ty = unit.shader.type_of(id);
                    let (span, spelling) = (unit.shader.expr(id).span, spelled(&unit.shader, ty));
                    if ty.is_error() { continue } else { (span, fenced(unit, &spelling)) }
                }
                (None, None) => continue,
            };
            if let Some(numbers) = expr.and_then(|id| self.numbers(unit, id)) {
                text.push_str("\n\n");
                text.push_str(&numbers);
            }
            let range = at(span).map(|s| self.encoding.range(file, s));
            let contents = HoverContents::Markup(MarkupContent { kind: MarkupKind::Markdown, value: text });
            return Some(Hover { contents, range });
        }
        // A name in host code.
        let (start, host) = self.meaning_at(name, offset);
        let (unit, meaning) = start.first()?;
        let text = self.of_meaning(&self.units()[*unit], meaning);
        let contents = HoverContents::Markup(MarkupContent { kind: MarkupKind::Markdown, value: text });
        Some(Hover { contents, range: host.map(|h| self.encoding.range(file, h.span)) })
    }

    fn of_meaning(&self, unit: &Unit, meaning: &Meaning) -> String {
        let shader = &unit.shader;
        match meaning {
            Meaning::Symbol(id) => self.of_symbol(unit, *id),
            Meaning::Function(id) => {
                let f = shader.function_info(*id);
                let param = |p: &syntax::symbols::ParamInfo| {
                    let name = p.name.as_ref().map_or(String::new(), |n| format!(" {}", n.name));
                    format!("{}{}{name}", direction(p.direction), spelled(shader, &p.ty))
                };
                let params = f.params.iter().map(param).collect::<Vec<_>>().join(", ");
                let head = if unit.is_wgsl() {
                    format!("fn {}({params}) -> {}", f.name.name, spelled(shader, &f.return_type))
                } else {
                    format!("{} {}({params})", f.return_type, f.name.name)
                };
                format!("{}{}", fenced(unit, &head), comment_above(unit, f.name.span))
            }
            Meaning::Member(span, name) => {
                let line = shader.file().line_text(shader.file().position(span.start).line).trim().to_owned();
                let mut text = fenced(unit, &line);
                for block in &shader.interface().blocks {
                    if let Some(index) = block.members.iter().position(|m| m.name.span == *span) {
                        text.push_str(&placement(shader, block, index));
                    }
                }
                let placed = shader.wgsl().into_iter().flat_map(|m| m.layouts.iter()).find_map(|(s, layout)| {
                    let own = shader.wgsl()?.members(s)?.iter().any(|m| m.name.span == *span);
                    own.then(|| layout.members.iter().find(|m| m.name == *name)).flatten()
                });
                if let Some(p) = placed {
                    let _ = write!(text, "\n\noffset {}, {} bytes, align {}", p.offset, p.extent.size, p.extent.align);
                }
                text
            }
            Meaning::Struct(name) => fenced(unit, &format!("struct {name}")),
            Meaning::Block(index) => {
                let block = &shader.interface().blocks[*index];
                let mut text = fenced(unit, &format!("{} {}", storage(block.storage), block.name.name));
                if let (Some(packing), Some(placed)) = (shader.packing(block), shader.placements(block)) {
                    let bytes = placed.last().map_or(0, |p| p.offset + p.size);
                    let _ = write!(text, "\n\n{}, {bytes} bytes", packing.name());
                }
                text
            }
        }
    }

    fn of_symbol(&self, unit: &Unit, id: SymbolId) -> String {
        let shader = &unit.shader;
        let symbol = shader.symbol(id);
        let ty = spelled(shader, &symbol.ty);
        let variable = shader.interface().variables().find(|v| v.symbol == id);
        let kind = match symbol.kind {
            SymbolKind::Builtin | SymbolKind::Local => String::new(),
            SymbolKind::Global(_) => variable.map_or(String::new(), |v| words(shader, v)),
            SymbolKind::BlockMember(b) | SymbolKind::BlockInstance(b) => {
                format!("{} ", storage(shader.interface().blocks[b].storage))
            }
            SymbolKind::Param(d) => direction(d).to_owned(),
        };
        let mut text = fenced(
            unit,
            &if unit.is_wgsl() { format!("{}: {ty}", symbol.name) } else { format!("{kind}{ty} {}", symbol.name) },
        );
        match symbol.kind {
            SymbolKind::Builtin => text.push_str(&since(shader, &symbol.name)),
            SymbolKind::BlockMember(b) => {
                let block = &shader.interface().blocks[b];
                let _ = write!(text, "\n\nmember of `{}`", block.name.name);
                if let Some(index) = block.members.iter().position(|m| m.symbol == Some(id)) {
                    text.push_str(&placement(shader, block, index));
                }
            }
            SymbolKind::Global(_) | SymbolKind::BlockInstance(_) | SymbolKind::Param(_) | SymbolKind::Local => {}
        }
        if let Some(value) = symbol.value {
            let _ = write!(text, "\n\nvalue {}", constant(value));
        }
        if let Some((low, high)) = self.config().range_of(&symbol.name) {
            let _ = write!(text, "\n\nstated range {low} to {high}");
        }
        if let Some(span) = symbol.span {
            text.push_str(&comment_above(unit, span));
        }
        let (_, hosts) = self.family(vec![(self.index_of(unit), Meaning::Symbol(id))]);
        let places: Vec<String> = hosts.iter().map(|h| h.file.locate(h.span.start)).collect();
        if !places.is_empty() {
            let short = |p: &String| p.rsplit('/').next().unwrap_or(p).to_owned();
            let _ = write!(text, "\n\nlooked up at {}", places.iter().map(short).collect::<Vec<_>>().join(", "));
        }
        text
    }

    fn index_of(&self, unit: &Unit) -> usize {
        self.units().iter().position(|u| std::ptr::eq(&**u, unit)).unwrap_or_default()
    }

    /// The values that an expression of numbers can take.
    fn numbers(&self, unit: &Unit, id: ExprId) -> Option<String> {
        let shader = &unit.shader;
        let ty = shader.type_of(id);
        let numeric = matches!(ty, Type::Scalar(s) | Type::Vector(s, _) if *s != syntax::types::ScalarType::Bool);
        if !numeric || shader.file().text().len() > LONGEST_FOLLOWED || unit.errors > 0 {
            return None;
        }
        let parts = range::of_expression(shader, &self.config().ranges, id)?;
        let known = |r: &range::Derived| r.lo.is_finite() || r.hi.is_finite();
        if !parts.iter().any(known) {
            return None;
        }
        let end = |v: f64| {
            if v == f64::INFINITY {
                "∞".to_owned()
            } else if v == f64::NEG_INFINITY {
                "−∞".to_owned()
            } else {
                format!("{v}")
            }
        };
        let shown = |r: &range::Derived| {
            let nan = if r.nan { " or NaN" } else { "" };
            if r.lo == r.hi { format!("{}{nan}", end(r.lo)) } else { format!("[{}, {}]{nan}", end(r.lo), end(r.hi)) }
        };
        let all: Vec<String> = parts.iter().map(shown).collect();
        let same = all.iter().all(|one| *one == all[0]);
        Some(format!("range {}", if same { all[0].clone() } else { all.join(", ") }))
    }
}

/// The built-in function that a call means.
fn of_builtin(shader: &Shader, id: ExprId) -> Option<String> {
    let ExprKind::Call { .. } = shader.expr(id).kind else { return None };
    match shader.callee(id)? {
        CallTarget::Builtin(call) => Some(builtin(shader, call.function)),
        CallTarget::Constructor(ty) => Some(format!("```glsl\n{}\n```\n\nconstructor", spelled(shader, ty))),
        CallTarget::User(_) => None,
    }
}

/// The overloads of a built-in function, and since when it is there.
pub(crate) fn builtin(shader: &Shader, function: BuiltinFunction) -> String {
    let all = shader.overloads(function);
    let shown: Vec<String> = all.iter().take(MOST_OVERLOADS).map(|o| signature(shader, function.name(), o)).collect();
    let more = all.len().saturating_sub(MOST_OVERLOADS);
    let more = if more > 0 { format!("\n// and {more} more overloads") } else { String::new() };
    format!("```glsl\n{}{more}\n```{}", shown.join("\n"), since(shader, function.name()))
}

/// A way to call a function.
pub(crate) fn signature(shader: &Shader, name: &str, overload: &Overload) -> String {
    let param = |(d, ty): &(Direction, Type)| format!("{}{}", direction(*d), spelled(shader, ty));
    let params = overload.params.iter().map(param).collect::<Vec<_>>().join(", ");
    format!("{} {name}({params})", spelled(shader, &overload.result))
}

fn since(shader: &Shader, name: &str) -> String {
    let version = if shader.wgsl().is_some() { "WGSL".to_owned() } else { shader.version().to_string() };
    let text = match shader.availability(name) {
        Availability::Here => format!("built in: {version}, {} stage", shader.stage().name()),
        Availability::OtherStage => format!("not in the {} stage", shader.stage().name()),
        Availability::Removed => format!("not in {version} any more"),
        Availability::Later { desktop, es, extensions } => {
            let number = |n: u32| format!("{}.{:02}", n / 100, n % 100);
            let versions =
                [desktop.map(|n| format!("GLSL {}", number(n))), es.map(|n| format!("GLSL ES {}", number(n)))];
            let all: Vec<String> = versions.into_iter().flatten().chain(extensions).collect();
            format!("not in {version}: since {}", all.join(", "))
        }
    };
    format!("\n\n{text}")
}

fn placement(shader: &Shader, block: &syntax::interface::Block, index: usize) -> String {
    let (Some(packing), Some(placed)) = (shader.packing(block), shader.placements(block)) else { return String::new() };
    placed
        .get(index)
        .map_or_else(String::new, |p| format!("\n\n{}: offset {}, {} bytes", packing.name(), p.offset, p.size))
}

/// The qualifiers of a variable, with the layout first.
fn words(shader: &Shader, v: &Variable) -> String {
    let text = |q: &Qualifiers| q.span().map_or(String::new(), |s| format!("{} ", shader.file().slice(s)));
    text(&v.qualifiers)
}

fn storage(storage: Storage) -> &'static str {
    match storage {
        Storage::In => "in",
        Storage::Out => "out",
        Storage::Uniform => "uniform",
        Storage::Buffer => "buffer",
        Storage::Shared => "shared",
        Storage::Const => "const",
        Storage::Global => "",
    }
}

pub(crate) fn direction(direction: Direction) -> &'static str {
    match direction {
        Direction::In => "",
        Direction::Out => "out ",
        Direction::InOut => "inout ",
    }
}

fn constant(value: syntax::Const) -> String {
    match value {
        syntax::Const::Bool(b) => b.to_string(),
        syntax::Const::Int(v) => v.to_string(),
        syntax::Const::Uint(v) => format!("{v}u"),
        syntax::Const::Float(v) => v.to_string(),
        syntax::Const::Double(v) => v.to_string(),
    }
}

fn fenced(unit: &Unit, text: &str) -> String {
    format!("```{}\n{text}\n```", if unit.is_wgsl() { "wgsl" } else { "glsl" })
}

/// What the author says of a declaration in the comments right above it.
fn comment_above(unit: &Unit, at: Span) -> String {
    let file = unit.file();
    let mut line = file.position(at.start).line;
    let mut found: Vec<&str> = Vec::new();
    while line > 1 {
        line -= 1;
        let Some(text) = file.line_text(line).trim_start().strip_prefix("//") else { break };
        found.push(text.trim_start_matches(['/', '!']).trim());
    }
    found.reverse();
    if found.is_empty() { String::new() } else { format!("\n\n{}", found.join("\n")) }
}
