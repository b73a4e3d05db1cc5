//! What a file, and the workspace, declares at file scope.

use base::text::Span;
use ls_types::{SymbolKind, Uri};
use serde_json::{Value, json};
use syntax::ast::{ItemKind, TypeKind};
use syntax::types::Type;
use syntax::wgsl::ModuleItem;

use crate::unit::Unit;
use crate::workspace::Workspace;

struct Declared {
    name: String,
    detail: String,
    kind: SymbolKind,
    whole: Span,
    at: Span,
    children: Vec<Declared>,
}

fn declared(name: &str, detail: String, kind: SymbolKind, whole: Span, at: Span) -> Declared {
    Declared { name: name.to_owned(), detail, kind, whole, at, children: Vec::new() }
}

fn of_unit(unit: &Unit) -> Vec<Declared> {
    let shader = &unit.shader;
    let mut found = Vec::new();
    for (_, f) in shader.functions() {
        let item = f.definition.or(f.prototypes.first().copied()).and_then(|i| shader.unit().items.get(i));
        let params = f.params.iter().map(|p| p.ty.to_string()).collect::<Vec<_>>().join(", ");
        let detail = format!("{}({params})", f.return_type);
        let whole = item.map_or(f.name.span, |i| i.span);
        found.push(declared(&f.name.name, detail, SymbolKind::FUNCTION, whole, f.name.span));
    }
    for v in shader.interface().variables() {
        let kind = if v.qualifiers.is_const() { SymbolKind::CONSTANT } else { SymbolKind::VARIABLE };
        found.push(declared(&v.name, v.ty.to_string(), kind, v.declarator_span, v.name_span));
    }
    for block in &shader.interface().blocks {
        let mut own = declared(&block.name.name, String::new(), SymbolKind::INTERFACE, block.span, block.name.span);
        let member = |m: &syntax::interface::BlockMember| {
            declared(&m.name.name, m.ty.to_string(), SymbolKind::FIELD, m.declaration_span, m.name.span)
        };
        own.children = block.members.iter().map(member).collect();
        found.push(own);
    }
    for item in &shader.unit().items {
        if let ItemKind::Declaration(d) = &item.kind
            && let TypeKind::Struct(s) = &d.ty.kind
            && let Some(name) = &s.name
        {
            let mut own = declared(&name.name, String::new(), SymbolKind::STRUCT, s.span, name.span);
            let all = s.members.iter().flat_map(|m| m.declarators.iter().map(move |d| (m, d)));
            let detail = |m: &syntax::ast::Declaration| shader.file().slice(m.ty.span).to_owned();
            own.children =
                all.map(|(m, d)| declared(&d.name.name, detail(m), SymbolKind::FIELD, m.span, d.name.span)).collect();
            found.push(own);
        }
    }
    for item in shader.wgsl().iter().flat_map(|m| &m.items) {
        if let ModuleItem::Struct { name, members } = item {
            let whole = members.last().map_or(name.span, |m| name.span.to(m.ty.span));
            let mut own = declared(&name.name, String::new(), SymbolKind::STRUCT, whole, name.span);
            let detail = |m: &syntax::wgsl::MemberSyntax| shader.file().slice(m.ty.span).to_owned();
            own.children = members
                .iter()
                .map(|m| declared(&m.name.name, detail(m), SymbolKind::FIELD, m.name.span.to(m.ty.span), m.name.span))
                .collect();
            found.push(own);
        }
    }
    found
}

impl Workspace {
    /// The declarations of a file, as `DocumentSymbol`s in the order of the text.
    pub fn document_symbols(&self, name: &str) -> Value {
        let mut all = Vec::new();
        for unit in self.own_units(name) {
            all.extend(of_unit(&unit).iter().filter_map(|d| Some((d.at, self.document_symbol(&unit, name, d)?))));
        }
        all.sort_by_key(|(at, _)| *at);
        all.into_iter().map(|(_, symbol)| symbol).collect()
    }

    fn document_symbol(&self, unit: &Unit, name: &str, d: &Declared) -> Option<Value> {
        let file = self.file(name)?;
        let at = unit.place_in(name, d.at)?;
        let whole = unit.place_in(name, d.whole).unwrap_or(at).to(at);
        let children: Vec<Value> = d.children.iter().filter_map(|c| self.document_symbol(unit, name, c)).collect();
        Some(json!({
            "name": d.name, "detail": d.detail, "kind": d.kind, "children": children,
            "range": self.encoding.range(file, whole), "selectionRange": self.encoding.range(file, at),
        }))
    }

    /// The declarations of all files whose names hold the letters of `query` in order, at most 500.
    pub fn workspace_symbols(&self, query: &str, uri: &dyn Fn(&str) -> Option<Uri>) -> Value {
        const MOST: usize = 500;
        let query = query.to_lowercase();
        let fits = |name: &str| {
            let mut wanted = query.chars().peekable();
            for c in name.to_lowercase().chars() {
                let _: Option<char> = wanted.next_if_eq(&c);
            }
            wanted.peek().is_none()
        };
        let mut found = Vec::new();
        for unit in self.units() {
            for d in of_unit(unit).iter().filter(|d| fits(&d.name)) {
                let Some((file, span)) = unit.place(d.at) else { continue };
                let Some(uri) = uri(file.name()).filter(|_| found.len() < MOST) else { continue };
                let location = json!({ "uri": uri, "range": self.encoding.range(&file, span) });
                let symbol =
                    json!({ "name": d.name, "kind": d.kind, "location": location, "containerName": unit.name });
                // A file that several shaders include is read with each.
                if !found.iter().any(|f: &Value| f["name"] == symbol["name"] && f["location"] == symbol["location"]) {
                    found.push(symbol);
                }
            }
        }
        found.into()
    }
}

/// A type, in words for people.
pub(crate) fn spelled(shader: &syntax::Shader, ty: &Type) -> String {
    if shader.wgsl().is_some() { syntax::wgsl::spelling(ty) } else { ty.to_string() }
}
