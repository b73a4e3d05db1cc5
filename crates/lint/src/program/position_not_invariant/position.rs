//! Where a vertex stage computes its position, and whether that is promised to be the same in every program.

use base::text::{Edit, SourceFile, Span};
use hosts::paths::stem;
use reading::ShaderFile;
use syntax::ast::{ExprId, ExprKind, ItemKind, StmtKind};
use syntax::symbols::{CallTarget, SymbolKind};
use syntax::types::Type;
use syntax::wgsl::{Attribute, EntryPoint, Module, ModuleItem};
use syntax::words::words;
use syntax::{Stage, walk};

use analysis::entry::root;
use analysis::forms::Forms;
use analysis::numeric::bare;
use analysis::spelled::Spelled;

/// The position that a vertex stage computes.
pub(super) struct Position<'p> {
    pub shader: &'p ShaderFile,
    /// Where it is computed.
    pub place: Span,
    /// How, as it is recognised in other shaders; none where it is not written once and from what does not change.
    pub spelled: Option<Spelled>,
    /// Whether it is that of a pass before others, by the name of its file or entry point.
    pub is_of_prepass: bool,
    /// Whether the text promises the same value in every program, or may do so.
    pub is_pinned: bool,
    /// The promise to add, where the file itself can have it.
    pub pin: Option<Edit>,
}

impl<'p> Position<'p> {
    /// The positions of a file: one in GLSL, one for each vertex entry point in WGSL.
    pub fn all_of(shader: &'p ShaderFile) -> Vec<Self> {
        let sound = shader.is_sound() && shader.template.is_none();
        match shader.shader.wgsl() {
            _ if !sound => Vec::new(),
            None => of_glsl(shader).into_iter().collect(),
            Some(module) => {
                let entries = module.entry_points.iter().filter(|entry| entry.stage == Stage::Vertex);
                entries.filter_map(|entry| of_entry_point(shader, module, entry)).collect()
            }
        }
    }

    /// The text that computes it.
    pub fn file(&self) -> &'p SourceFile {
        &self.shader.file
    }
}

/// True for `depth_prepass`, `zPrePass`: what is drawn again afterwards, where the depth is as it was.
fn is_prepass(name: &str) -> bool {
    let words = words(name);
    words.iter().any(|word| word == "prepass") || words.windows(2).any(|pair| pair == ["pre", "pass"])
}

/// True for a file that is a pass before others by its name, or has an entry point that is.
pub(super) fn has_prepass(file: &ShaderFile) -> bool {
    let entries = file.shader.wgsl().into_iter().flat_map(|module| &module.entry_points);
    is_prepass(stem(file.file.name())) || entries.into_iter().any(|entry| is_prepass(&entry.name.name))
}

fn of_glsl(file: &ShaderFile) -> Option<Position<'_>> {
    let shader = &file.shader;
    if shader.stage() != Stage::Vertex {
        return None;
    }
    let is_position = |id: ExprId| {
        let variable = root(shader, id).map(|(symbol, _)| shader.symbol(symbol).name.as_str());
        variable == Some("gl_Position")
    };
    let writes = shader.arena().iter().filter_map(|(_, expr)| match expr.kind {
        ExprKind::Assign { op, target, value, .. } if is_position(target) => Some((op, target, value, expr)),
        _ => None,
    });
    let writes: Vec<_> = writes.collect();
    let spelled = match &writes[..] {
        [(None, target, value, _)] if matches!(shader.expr(bare(shader, *target)).kind, ExprKind::Name(_)) => {
            Spelled::of(shader, &Forms::new(shader), *value)
        }
        _ => None,
    };
    let place = writes.last()?.3.span;
    // A macro or a pragma may promise it, too.
    let text = shader.file().text();
    let is_pinned = ["invariant", "precise"].iter().any(|word| text.contains(word));
    let items = shader.unit().items.iter();
    let first =
        items.filter(|item| !matches!(item.kind, ItemKind::Precision(_) | ItemKind::Empty)).map(|item| item.span);
    let front = first.min_by_key(|span| span.start).filter(|span| file.is_written(*span));
    let has_word = shader.version().number != 110;
    let pin = front.filter(|_| has_word).map(|span| Edit::insert(span.start, "invariant gl_Position;\n".to_owned()));
    let is_of_prepass = is_prepass(stem(file.file.name()));
    Some(Position { shader: file, place, spelled, is_of_prepass, is_pinned, pin })
}

fn of_entry_point<'p>(file: &'p ShaderFile, module: &'p Module, entry: &EntryPoint) -> Option<Position<'p>> {
    let shader = &file.shader;
    let ModuleItem::Function { returns: Some((own, ty)), .. } = module.items.get(entry.item)? else { return None };
    let of_position = |attributes: &'p [Attribute]| {
        let attribute = Module::attribute(attributes, "builtin")?;
        (shader.text_of(*attribute.args.first()?) == "position").then_some(attribute)
    };
    let body = shader.unit().items.get(shader.function_info(entry.function).definition?)?.span;
    let inside = |id: &ExprId| body.contains(shader.expr(*id).span.start);
    let mut returned = Vec::new();
    walk::statements(shader, |statement| {
        if let StmtKind::Return(Some(value)) = statement.kind
            && inside(&value)
        {
            returned.push(value);
        }
    });
    let (attributes, builtin, values) = match of_position(own) {
        Some(builtin) => (own.as_slice(), builtin, returned),
        None => {
            let members = module.members(&ty.name.name)?;
            let at = members.iter().position(|member| of_position(&member.attributes).is_some())?;
            let name = members[at].name.name.as_str();
            let is_output = |of: &Type| matches!(of, Type::Struct(structure) if structure.name == ty.name.name);
            let assigned = shader.arena().iter().filter(|(id, _)| inside(id)).filter_map(|(_, expr)| {
                let ExprKind::Assign { op: None, target, value, .. } = expr.kind else { return None };
                let (symbol, members) = root(shader, target)?;
                let symbol = shader.symbol(symbol);
                (symbol.kind == SymbolKind::Local && is_output(&symbol.ty) && members == [name]).then_some(value)
            });
            let forms = Forms::new(shader);
            let constructed = returned.iter().filter_map(|value| {
                let value = forms.value(*value);
                let ExprKind::Call { args, .. } = &shader.expr(value).kind else { return None };
                matches!(shader.callee(value)?, CallTarget::Constructor(_)).then(|| args.get(at).copied())?
            });
            let values = assigned.chain(constructed).collect();
            (members[at].attributes.as_slice(), of_position(&members[at].attributes)?, values)
        }
    };
    let spelled = match values[..] {
        [value] => Spelled::of(shader, &Forms::new(shader), value),
        _ => None,
    };
    let is_pinned = Module::attribute(attributes, "invariant").is_some();
    let pin = file.is_written(builtin.span).then(|| Edit::insert(builtin.span.start, "@invariant ".to_owned()));
    let place = values.last().map_or(builtin.span, |value| shader.expr(*value).span);
    let is_of_prepass = is_prepass(&entry.name.name) || is_prepass(stem(file.file.name()));
    Some(Position { shader: file, place, spelled, is_of_prepass, is_pinned, pin })
}
