//! Inlay hints: what the text does not say.

use base::text::Span;
use ls_types::{InlayHint, InlayHintKind, InlayHintLabel};
use syntax::ast::{ExprId, ExprKind};
use syntax::symbols::CallTarget;
use syntax::types::Type;
use syntax::wgsl::{MemberSyntax, Module};

use crate::unit::Unit;
use crate::walk::parts;
use crate::workspace::Workspace;

/// Which hints are shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hints {
    /// Where a value is converted without a constructor.
    pub conversions: bool,
    /// Where members of blocks lie in memory.
    pub offsets: bool,
}

impl Default for Hints {
    fn default() -> Self {
        Self { conversions: true, offsets: true }
    }
}

impl Workspace {
    /// The hints of a file within a span.
    pub fn hints(&self, name: &str, within: Span, wanted: Hints) -> Vec<InlayHint> {
        let Some(file) = self.file(name) else { return Vec::new() };
        let mut found: Vec<(usize, String)> = Vec::new();
        for unit in self.own_units(name) {
            let mut all = Vec::new();
            if wanted.conversions {
                all.extend(conversions(&unit));
            }
            if wanted.offsets {
                all.extend(offsets(&unit));
            }
            let place = |(at, label): (usize, String)| Some((unit.place_in(name, Span::at(at))?.start, label));
            found.extend(all.into_iter().filter_map(place));
        }
        found.retain(|(at, _)| within.start <= *at && *at <= within.end);
        found.sort();
        found.dedup();
        let hint = |(at, label): (usize, String)| InlayHint {
            position: self.encoding.position(file, at),
            label: InlayHintLabel::String(label),
            kind: Some(InlayHintKind::TYPE),
            text_edits: None,
            tooltip: None,
            padding_left: Some(true),
            padding_right: None,
            data: None,
        };
        found.into_iter().map(hint).collect()
    }
}

/// Values of one type where another one is wanted.
fn conversions(unit: &Unit) -> Vec<(usize, String)> {
    let shader = &unit.shader;
    let mut found = Vec::new();
    let mut becomes = |id: ExprId, wanted: &Type| {
        let (given, expr) = (shader.type_of(id), shader.expr(id));
        let converts = matches!((given.scalar(), wanted.scalar()), (Some(g), Some(w)) if g != w);
        // A literal says what it is, and a list is no value.
        if converts && !expr.from_macro && !matches!(expr.kind, ExprKind::List(_)) {
            found.push((
                expr.span.end,
                format!("→ {}", given.with_scalar(wanted.scalar().unwrap_or(syntax::types::ScalarType::Float))),
            ));
        }
    };
    for (id, expr) in shader.arena().iter() {
        match &expr.kind {
            ExprKind::Assign { op: _, op_span: _, target, value } => becomes(*value, shader.type_of(*target)),
            ExprKind::Binary { op, op_span: _, left, right } => {
                use syntax::ast::BinaryOp as B;
                if !matches!(
                    op,
                    B::Add
                        | B::Sub
                        | B::Mul
                        | B::Div
                        | B::Less
                        | B::Greater
                        | B::LessEqual
                        | B::GreaterEqual
                        | B::Equal
                        | B::NotEqual
                ) {
                    continue;
                }
                let (l, r) = (shader.type_of(*left).scalar(), shader.type_of(*right).scalar());
                if let (Some(l), Some(r)) = (l, r) {
                    // The wider of the two decides.
                    if l < r {
                        becomes(*left, &shader.type_of(*left).with_scalar(r))
                    } else {
                        becomes(*right, &shader.type_of(*right).with_scalar(l))
                    }
                }
            }
            ExprKind::Call { callee: _, args } => {
                if let Some(CallTarget::User(function)) = shader.callee(id) {
                    let params = &shader.function_info(*function).params;
                    args.iter().zip(params).for_each(|(arg, param)| becomes(*arg, &param.ty));
                }
            }
            _ => {}
        }
    }
    for declaration in parts(shader).declarations {
        for declarator in &declaration.declarators {
            let symbol = shader.symbols().find(|(_, s)| s.span == Some(declarator.name.span));
            if let (Some(initializer), Some((_, symbol))) = (&declarator.initializer, symbol) {
                becomes(initializer.value, &symbol.ty);
            }
        }
    }
    found
}

/// The offsets of members of blocks.
fn offsets(unit: &Unit) -> Vec<(usize, String)> {
    let shader = &unit.shader;
    let mut found = Vec::new();
    for block in &shader.interface().blocks {
        for (member, placed) in block.members.iter().zip(shader.placements(block).unwrap_or_default()) {
            found.push((member.declaration_span.end, format!("offset {}", placed.offset)));
        }
    }
    let module = shader.wgsl().into_iter();
    for (name, layout) in module.clone().flat_map(|m| m.layouts.iter()) {
        let members = module.clone().find_map(|m| m.members(name)).unwrap_or_default();
        // What goes from stage to stage lies in no memory.
        let of_interface =
            |m: &MemberSyntax| ["location", "builtin"].iter().any(|a| Module::attribute(&m.attributes, a).is_some());
        if members.iter().any(of_interface) {
            continue;
        }
        found.extend(
            members.iter().zip(&layout.members).map(|(m, placed)| (m.ty.span.end, format!("offset {}", placed.offset))),
        );
    }
    found
}
