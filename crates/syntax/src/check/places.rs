//! What several declarations of the interface say together: values of a stage, locations and components that may not
//! overlap, and what is captured (GLSL 4.60 specification, sections 4.4.1 and 4.4.2).

use super::super::ast::{AuxiliaryQualifier, Ident, LayoutEntry, QualifierKind, Qualifiers};
use super::super::fold::Const;
use super::super::interface::{Block, Interface, Storage, Variable};
use super::super::types::{ArraySize, Type};
use super::super::{Stage, errors};
use super::Checker;
use base::diagnostic::message;
use base::text::Span;

/// Locations of one declaration, and the components of each that it takes.
struct Taken {
    input: bool,
    patch: bool,
    first: i64,
    count: i64,
    components: u8,
}

/// True for what belongs to a patch and not to its vertices.
pub(super) fn is_patch(qualifiers: &Qualifiers) -> bool {
    qualifiers.list.iter().any(|q| q.kind == QualifierKind::Auxiliary(AuxiliaryQualifier::Patch))
}

/// Locations that a value of this type takes between stages; none for a size that is not known.
fn locations(ty: &Type) -> Option<i64> {
    Some(match ty {
        Type::Vector(scalar, 3 | 4) if scalar.bits() == 64 => 2,
        Type::Scalar(_) | Type::Vector(..) => 1,
        Type::Matrix(scalar, columns, rows) => i64::from(*columns) * locations(&Type::Vector(*scalar, *rows))?,
        Type::Array(element, ArraySize::Known(n)) => i64::from(*n).checked_mul(locations(element)?)?,
        Type::Struct(s) => s.fields.iter().map(|f| locations(&f.ty)).sum::<Option<i64>>()?,
        Type::Array(..) | Type::Void | Type::Error | Type::Opaque(_) => return None,
    })
}

impl Checker<'_> {
    /// Checks the interface when all of it is declared.
    pub(super) fn whole_interface(&mut self) {
        let interface = std::mem::take(&mut self.out.interface);
        self.stage_values(&interface);
        // A library may hold several stages.
        if self.stage != Stage::Library {
            self.locations(&interface);
        }
        if self.stage == Stage::Compute {
            self.compute_rules(&interface);
        }
        self.captured(&interface);
        self.out.interface = interface;
    }

    pub(super) fn entry_number(&self, qualifiers: &Qualifiers, key: &str) -> Option<i64> {
        self.value_of(qualifiers.layout_entry(key)?.value?).and_then(Const::as_integer)
    }

    /// Declarations of a stage must agree; of one declaration the last value counts.
    fn stage_values(&mut self, interface: &Interface) {
        const KEYS: [&str; 6] =
            ["vertices", "invocations", "local_size_x", "local_size_y", "local_size_z", "max_vertices"];
        for key in KEYS {
            let mut first: Option<i64> = None;
            for layout in &interface.stage_layouts {
                let (Some(entry), Some(value)) =
                    (layout.qualifiers.layout_entry(key), self.entry_number(&layout.qualifiers, key))
                else {
                    continue;
                };
                match first {
                    Some(old) if old != value => {
                        let message = message!("another `{key}` than above", "上と異なる `{key}` です");
                        self.sink.error(errors::LAYOUT, entry.span, message, message!("second one", "二つ目"));
                    }
                    _ => first = Some(value),
                }
            }
        }
    }

    fn compute_rules(&mut self, interface: &Interface) {
        for v in interface.inputs.iter().chain(&interface.outputs).filter(|v| !v.name.starts_with("gl_")) {
            let message =
                message!("a compute shader has no inputs and outputs", "コンピュートシェーダに入出力変数はありません");
            self.sink.error(errors::QUALIFIER, v.name_span, message, message!("declared here", "ここで宣言"));
        }
        let size = |q: &Qualifiers| {
            ["local_size_x", "local_size_y", "local_size_z"].iter().any(|k| q.layout_entry(k).is_some())
        };
        let declared = interface.stage_layouts.iter().find(|l| size(&l.qualifiers)).map(|l| l.span.start);
        let used = self.out.uses.iter().find(|u| self.out.symbols[u.symbol.index()].name == "gl_WorkGroupSize");
        if let Some(span) = used.map(|u| u.span)
            && declared.is_none_or(|at| span.start < at)
            && !self.language.is_open()
        {
            let message = message!(
                "`gl_WorkGroupSize` is used before the size is declared",
                "`gl_WorkGroupSize` が大きさの宣言の前に使われています"
            );
            self.sink.error(errors::LAYOUT, span, message, message!("not known here", "ここでは決まっていません"));
        }
    }

    /// The type of one vertex of an input or output.
    fn of_vertex<'t>(&self, ty: &'t Type, input: bool, patch: bool) -> &'t Type {
        let over_vertices = match self.stage {
            Stage::Geometry => input,
            Stage::TessControl => !patch,
            Stage::TessEvaluation => input && !patch,
            _ => false,
        };
        match ty {
            Type::Array(element, _) if over_vertices => element,
            other => other,
        }
    }

    fn locations(&mut self, interface: &Interface) {
        let mut taken: Vec<Taken> = Vec::new();
        let mut blocks = interface.blocks.iter().filter(|b| matches!(b.storage, Storage::In | Storage::Out)).peekable();
        let mut variables: Vec<_> = interface.inputs.iter().map(|v| (v, true)).collect();
        variables.extend(interface.outputs.iter().map(|v| (v, false)));
        variables.sort_by_key(|(v, _)| v.name_span.start);
        for (v, input) in variables {
            while let Some(block) = blocks.next_if(|b| b.span.start < v.name_span.start) {
                self.block_locations(block, &mut taken);
            }
            self.variable_location(v, input, &mut taken);
        }
        for block in blocks {
            self.block_locations(block, &mut taken);
        }
    }

    fn variable_location(&mut self, v: &Variable, input: bool, taken: &mut Vec<Taken>) {
        let first = self.entry_number(&v.qualifiers, "location");
        let patch = is_patch(&v.qualifiers);
        let ty = self.of_vertex(&v.ty, input, patch);
        for key in ["component", "index"] {
            if let (Some(entry), None) = (v.qualifiers.layout_entry(key), v.qualifiers.layout_entry("location")) {
                self.layout_error(
                    entry,
                    message!("it needs a `location` beside it", "`location` と共に書く必要があります"),
                );
            }
        }
        let components = self.components(&v.qualifiers, ty);
        // Attributes may share a location where one is read, outputs of a fragment stage have indices as well.
        let alias = if input { self.stage == Stage::Vertex } else { self.stage == Stage::Fragment };
        if let (Some(first), Some(count), false) = (first, locations(ty), alias) {
            // `layout(location = 2) out vec4 a, b;` stands at one place for all: the language leaves it open.
            if v.position == 0 {
                self.take(Taken { input, patch, first, count, components }, &v.name, v.name_span, taken);
            }
        }
    }

    /// The components of a location that a declaration takes, as bits; rules of `component`.
    fn components(&mut self, qualifiers: &Qualifiers, ty: &Type) -> u8 {
        let mut ty = ty;
        while let Type::Array(element, _) = ty {
            ty = element;
        }
        let double = ty.scalar().is_some_and(|s| s.bits() == 64);
        let width = match ty {
            Type::Scalar(_) | Type::Vector(..) => ty.components().unwrap_or(4) * if double { 2 } else { 1 },
            _ => 4,
        };
        let Some(entry) = qualifiers.layout_entry("component") else {
            return u8::try_from((1u32 << width.min(4)) - 1).unwrap_or(15);
        };
        if ty.is_error() {
            return 15;
        }
        let Some(at) = self.entry_number(qualifiers, "component").and_then(|n| usize::try_from(n).ok()) else {
            return 15;
        };
        let plain = matches!(ty, Type::Scalar(_) | Type::Vector(..)) && width <= 4;
        if !plain {
            self.layout_error(entry, message!("`{ty}` takes whole locations", "`{ty}` はロケーション全体を使います"));
        } else if at + width > 4 {
            self.layout_error(
                entry,
                message!("`{ty}` does not fit behind component {at}", "`{ty}` は成分 {at} から先に収まりません"),
            );
        } else if double && at % 2 != 0 {
            self.layout_error(
                entry,
                message!("a `double` begins at component 0 or 2", "`double` は成分 0 か 2 から始まります"),
            );
        } else {
            return u8::try_from(((1u32 << width) - 1) << at).unwrap_or(15);
        }
        15
    }

    fn block_locations(&mut self, block: &Block, taken: &mut Vec<Taken>) {
        let input = block.storage == Storage::In;
        let patch = is_patch(&block.qualifiers);
        if block.name.name.starts_with("gl_") || block.members.is_empty() {
            return;
        }
        let whole = self.entry_number(&block.qualifiers, "location");
        let stated = |q: &Qualifiers| q.layout_entry("location").is_some();
        if let (false, Some(entry)) = (
            stated(&block.qualifiers) || block.members.iter().all(|m| stated(&m.qualifiers)),
            block.members.iter().find_map(|m| m.qualifiers.layout_entry("location")),
        ) {
            let why = message!(
                "all members of the block need one then, or the block itself",
                "ブロック自身か全てのメンバーに必要です"
            );
            self.layout_error(entry, why);
            return;
        }
        if matches!(self.of_vertex(&block.ty, input, patch), Type::Array(..)) {
            if let Some(entry) = block.members.iter().find_map(|m| m.qualifiers.layout_entry("location")) {
                self.layout_error(
                    entry,
                    message!(
                        "members of an array of blocks have no locations of their own",
                        "ブロックの配列のメンバーには書けません"
                    ),
                );
            }
            return;
        }
        let mut next = whole;
        for member in &block.members {
            let first = self.entry_number(&member.qualifiers, "location").or(next);
            let (Some(first), Some(count)) = (first, locations(&member.ty)) else { return };
            let components = self.components(&member.qualifiers, &member.ty);
            self.take(Taken { input, patch, first, count, components }, &member.name.name, member.name.span, taken);
            next = first.checked_add(count);
        }
    }

    fn take(&mut self, new: Taken, name: &str, span: Span, taken: &mut Vec<Taken>) {
        let same = |old: &&Taken| {
            old.input == new.input
                && old.patch == new.patch
                && old.components & new.components != 0
                && old.first < new.first + new.count
                && new.first < old.first + old.count
        };
        if let Some(old) = taken.iter().find(same) {
            let at = old.first.max(new.first);
            let message = message!(
                "location {at} of `{name}` is taken already",
                "`{name}` のロケーション {at} は既に使われています"
            );
            self.sink.error(
                errors::LAYOUT,
                span,
                message,
                message!("a second variable there", "同じ場所の二つ目の変数"),
            );
        }
        taken.push(new);
    }

    /// Inputs of a control or evaluation stage and outputs of a control stage hold one element for each vertex.
    pub(super) fn patch_array(&mut self, name: &Ident, ty: &Type, storage: Storage, qualifiers: &Qualifiers) {
        let wanted = match self.stage {
            Stage::TessControl => matches!(storage, Storage::In | Storage::Out),
            Stage::TessEvaluation => storage == Storage::In,
            _ => false,
        };
        if !wanted || is_patch(qualifiers) || ty.is_error() {
            return;
        }
        let text = &name.name;
        let Type::Array(_, size) = ty else {
            let message = message!(
                "`{text}` has no element for each vertex of the patch",
                "`{text}` がパッチの頂点ごとの配列ではありません"
            );
            let d =
                self.sink.start(errors::ARRAY, name.span, message).with_label(message!("not an array", "配列ではない"));
            return self.sink.push(d.with_help(message!(
                "write `{text}[]`, or `patch` before it",
                "`{text}[]` と書くか、前に `patch` を付けてください"
            )));
        };
        let vertices = |l: &super::super::interface::StageLayout| self.entry_number(&l.qualifiers, "vertices");
        let given = self.out.interface.stage_layouts.iter().find_map(vertices);
        if let (Storage::Out, ArraySize::Known(n), Some(given)) = (storage, size, given)
            && i64::from(*n) != given
        {
            let message = message!(
                "`{text}` has {n} elements, but {given} vertices are written",
                "`{text}` の要素は {n} 個ですが、頂点は {given} 個です"
            );
            self.sink.error(errors::ARRAY, name.span, message, message!("size of the output", "出力の大きさ"));
        }
    }

    /// A value that names a limit, with what is added to it: `gl_MaxClipDistances + 1`.
    pub(super) fn beyond_limit(&self, id: super::ExprId, limit: &str) -> Option<i64> {
        use super::super::ast::{BinaryOp, ExprKind};
        match &self.arena.get(id).kind {
            ExprKind::Name(name) => (name == limit).then_some(0),
            ExprKind::Paren(inner) => self.beyond_limit(*inner, limit),
            ExprKind::Binary { op: BinaryOp::Add, left, right, .. } => {
                Some(self.beyond_limit(*left, limit)? + self.value_of(*right)?.as_integer()?)
            }
            _ => None,
        }
    }

    /// Tells a layout value that is as great as a limit of which the last value is one less.
    pub(super) fn below_limit(&mut self, entry: &LayoutEntry) {
        let limit = match entry.key.name.as_str() {
            "xfb_buffer" => "gl_MaxTransformFeedbackBuffers",
            "stream" => "gl_MaxVertexStreams",
            _ => return,
        };
        if entry.value.and_then(|v| self.beyond_limit(v, limit)).is_some_and(|n| n >= 0) {
            self.layout_error(entry, message!("its value is below `{limit}`", "値は `{limit}` 未満です"));
        }
    }
}

/// The limit of a built-in array.
pub(super) fn limit_of(name: &str) -> Option<&'static str> {
    Some(match name {
        "gl_ClipDistance" => "gl_MaxClipDistances",
        "gl_CullDistance" => "gl_MaxCullDistances",
        "gl_TexCoord" => "gl_MaxTextureCoords",
        "gl_FragData" => "gl_MaxDrawBuffers",
        _ => return None,
    })
}
