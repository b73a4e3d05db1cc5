//! What can be written at a place: names of the shader, what its version and stage offer, components and members behind a
//! dot, and names of uniforms and attributes in strings of host code.

use base::text::{SourceFile, Span};
use ls_types::{CompletionItem, CompletionItemKind, Documentation, MarkupContent, MarkupKind};
use syntax::ast::ExprKind;
use syntax::interface::Storage;
use syntax::symbols::SymbolKind;
use syntax::types::Type;
use syntax::{Shader, Stage};

use crate::hover::{builtin, signature};
use crate::symbols::spelled;
use crate::unit::Unit;
use crate::workspace::Workspace;

/// What stands for the name that is not written yet.
const PLACEHOLDER: &str = "shadercheck_completion_";

impl Workspace {
    /// What can be written at a place.
    pub fn completion(&self, name: &str, offset: usize) -> Vec<CompletionItem> {
        let host = self
            .linked()
            .names
            .iter()
            .find(|n| n.file.name() == name && n.whole.start <= offset && offset <= n.whole.end);
        if let Some(host) = host {
            return self.names_for(host);
        }
        let Some(unit) = self.own_units(name).into_iter().find(|u| u.name == name) else { return Vec::new() };
        let file = unit.file();
        if file.is_assembled() && file.origin(Span::at(0)).0.name() != name {
            return Vec::new();
        }
        let Some(root) = self.file(name) else { return Vec::new() };
        let in_comment =
            unit.shader.comments().iter().any(|c| unit.place_in(name, c.span).is_some_and(|s| s.contains(offset)));
        if in_comment {
            return Vec::new();
        }
        let start = root.text()[..offset].trim_end_matches(|c: char| c.is_alphanumeric() || c == '_').len();
        let before = root.text()[..start].trim_end();
        if before.ends_with('.') && !before.ends_with("..") {
            return behind_dot(&unit, root, start, offset);
        }
        self.names(&unit, name, offset)
    }

    /// Names of the variables of a program.
    fn names_for(&self, host: &reading::HostName) -> Vec<CompletionItem> {
        let mut items: Vec<CompletionItem> = Vec::new();
        let units = self.units().iter().filter(|u| host.shaders.is_empty() || host.shaders.contains(&u.name));
        for unit in units {
            for v in unit.shader.interface().variables() {
                let attribute = v.storage == Storage::In && unit.shader.stage() == Stage::Vertex;
                let wanted = match v.storage {
                    Storage::Uniform => host.attribute != Some(true),
                    _ => attribute && host.attribute != Some(false),
                };
                if wanted && !items.iter().any(|i| i.label == v.name) {
                    let kind = if attribute { CompletionItemKind::FIELD } else { CompletionItemKind::VARIABLE };
                    items.push(item(&v.name, kind, spelled(&unit.shader, &v.ty)));
                }
            }
        }
        items
    }

    fn names(&self, unit: &Unit, name: &str, offset: usize) -> Vec<CompletionItem> {
        let shader = &unit.shader;
        let mut items = Vec::new();
        let function = shader
            .unit()
            .items
            .iter()
            .map(|i| i.span)
            .find(|s| unit.place_in(name, *s).is_some_and(|s| s.start < offset && offset <= s.end));
        for (_, symbol) in shader.symbols() {
            let Some(at) = symbol.span else { continue };
            let local = matches!(symbol.kind, SymbolKind::Local | SymbolKind::Param(_));
            let before = unit.place_in(name, at).is_none_or(|s| s.start < offset);
            let inside = function.is_some_and(|f| f.contains(at.start));
            if before && (!local || inside) && !symbol.name.starts_with(PLACEHOLDER) {
                items.push(item(&symbol.name, CompletionItemKind::VARIABLE, spelled(shader, &symbol.ty)));
            }
        }
        for (_, f) in shader.functions().filter(|(_, f)| f.name.name != "main") {
            items.push(item(&f.name.name, CompletionItemKind::FUNCTION, spelled(shader, &f.return_type)));
        }
        if let Some(module) = shader.wgsl() {
            items.extend(module.layouts.keys().map(|s| item(s, CompletionItemKind::STRUCT, String::new())));
            items.extend(
                syntax::wgsl::OWN_FUNCTIONS
                    .iter()
                    .map(|f| item(f, CompletionItemKind::FUNCTION, "built in".to_owned())),
            );
        } else {
            for function in shader.offered_functions() {
                let detail = shader.overloads(function).first().map(|o| signature(shader, function.name(), o));
                let mut own = item(function.name(), CompletionItemKind::FUNCTION, detail.unwrap_or_default());
                own.sort_text = Some(format!("~{}", function.name()));
                items.push(own);
            }
            for variable in shader.offered_variables() {
                items.push(item(variable.name, CompletionItemKind::CONSTANT, spelled(shader, &variable.ty)));
            }
            let words = shader.offered_words();
            items.extend(words.iter().map(|w| CompletionItem {
                sort_text: Some(format!("~{w}")),
                ..item(w, CompletionItemKind::KEYWORD, String::new())
            }));
        }
        items.sort_by(|a, b| (&a.label, &a.sort_text).cmp(&(&b.label, &b.sort_text)));
        items.dedup_by(|b, a| a.label == b.label);
        items
    }

    /// The documentation of a built-in function that was offered in a file.
    pub fn completion_details(&self, name: &str, item: CompletionItem) -> CompletionItem {
        let function = syntax::BuiltinFunction::from_name(&item.label);
        let unit = self.own_units(name).into_iter().next();
        let (Some(function), Some(unit)) = (function, unit) else { return item };
        let value = builtin(&unit.shader, function);
        CompletionItem {
            documentation: Some(Documentation::MarkupContent(MarkupContent { kind: MarkupKind::Markdown, value })),
            ..item
        }
    }
}

fn item(label: &str, kind: CompletionItemKind, detail: String) -> CompletionItem {
    CompletionItem {
        label: label.to_owned(),
        kind: Some(kind),
        detail: Some(detail).filter(|d| !d.is_empty()),
        ..CompletionItem::default()
    }
}

/// The components or members of what stands before the dot: the text is read once more with a name there.
fn behind_dot(unit: &Unit, root: &SourceFile, start: usize, offset: usize) -> Vec<CompletionItem> {
    let text = root.text();
    let rest = &text[offset..];
    // A statement that is not finished must not take the next one with it.
    let open = rest.lines().next().unwrap_or("").trim().is_empty();
    let replaced = format!("{}{PLACEHOLDER}{}{rest}", &text[..start], if open { ";" } else { "" });
    let file = SourceFile::new(root.name(), replaced);
    let shader: Shader = if unit.is_wgsl() {
        Shader::parse_wgsl(&file).shader
    } else {
        Shader::parse_with(&file, unit.shader.stage(), unit.shader.defines()).shader
    };
    let base = shader.arena().iter().find_map(|(_, e)| match &e.kind {
        ExprKind::Field { base, field } if field.name == PLACEHOLDER => Some(*base),
        _ => None,
    });
    let Some(base) = base else { return Vec::new() };
    match shader.type_of(base) {
        Type::Struct(s) => {
            let member =
                |f: &syntax::types::StructField| item(&f.name, CompletionItemKind::FIELD, spelled(&shader, &f.ty));
            s.fields.iter().map(member).collect()
        }
        Type::Vector(scalar, n) => swizzles(&shader, *scalar, *n),
        Type::Array(..) => vec![item("length()", CompletionItemKind::METHOD, "int".to_owned())],
        _ => Vec::new(),
    }
}

/// Single components of each set, and the first components in order.
fn swizzles(shader: &Shader, scalar: syntax::types::ScalarType, n: u8) -> Vec<CompletionItem> {
    let mut items = Vec::new();
    let sets = if shader.wgsl().is_some() { &syntax::swizzle::SETS[..2] } else { &syntax::swizzle::SETS[..] };
    for set in sets {
        let letters = &set[..usize::from(n)];
        for letter in letters.chars() {
            items.push(item(&letter.to_string(), CompletionItemKind::FIELD, spelled(shader, &Type::Scalar(scalar))));
        }
        for length in 2..=n {
            let ty = Type::Vector(scalar, length);
            items.push(item(&set[..usize::from(length)], CompletionItemKind::FIELD, spelled(shader, &ty)));
        }
    }
    items
}
