//! Rules of declared variables: qualifiers, types by storage and stage, initialisers, redeclared
//! built-in variables (GLSL 4.60 specification, sections 4.3 to 4.7).

use super::super::ast::{
    AuxiliaryQualifier, Declaration, Declarator, ExprKind, Ident, Interpolation, QualifierKind, Qualifiers,
    StorageQualifier,
};
use super::super::interface::Storage;
use super::super::language::Feature;
use super::super::symbols::SymbolId;
use super::super::types::{ArraySize, ScalarType, Type};
use super::super::{Stage, builtin, errors};
use super::Checker;
use super::layouts::Bearer;
use base::diagnostic::{Message, message};
use base::text::Span;

/// Built-in variables that a shader may declare again.
const REDECLARABLE: &[&str] = &[
    "gl_FragCoord",
    "gl_FragDepth",
    "gl_TexCoord",
    "gl_ClipDistance",
    "gl_CullDistance",
    "gl_Color",
    "gl_SecondaryColor",
    "gl_FrontColor",
    "gl_BackColor",
    "gl_FrontSecondaryColor",
    "gl_BackSecondaryColor",
    "gl_FogFragCoord",
    "gl_Position",
    "gl_PointSize",
    "gl_SampleMask",
    "gl_Layer",
    "gl_ViewportIndex",
    "gl_in",
    "gl_out",
    "gl_FragColor",
    "gl_FragData",
];

/// True when a component of that kind is inside.
fn has_scalar(ty: &Type, wanted: &dyn Fn(ScalarType) -> bool) -> bool {
    match ty {
        Type::Scalar(s) | Type::Vector(s, _) | Type::Matrix(s, ..) => wanted(*s),
        Type::Array(element, _) => has_scalar(element, wanted),
        Type::Struct(s) => s.fields.iter().any(|f| has_scalar(&f.ty, wanted)),
        Type::Error | Type::Void | Type::Opaque(_) => false,
    }
}

fn element(ty: &Type) -> &Type {
    match ty {
        Type::Array(inner, _) => element(inner),
        other => other,
    }
}

impl Checker<'_> {
    /// Qualifiers of a declaration at file scope, in a function, or of a member: which, how often, and in
    /// which order.
    pub(super) fn qualifier_rules(&mut self, qualifiers: &Qualifiers) {
        let mut seen: Vec<u8> = Vec::new();
        let mut storage: Option<StorageQualifier> = None;
        let mut last = 0;
        for q in &qualifiers.list {
            let (rank, single) = match &q.kind {
                // The grammar before 4.20 has `layout` in front of what says where a variable lives.
                QualifierKind::Layout(_) if last >= 4 => {
                    self.need(Feature::MixedQualifiers, q.span);
                    continue;
                }
                QualifierKind::Layout(_) | QualifierKind::Memory(_) | QualifierKind::Subroutine(_) => continue,
                QualifierKind::Precise => (0, true),
                QualifierKind::Invariant => (1, true),
                QualifierKind::Interpolation(_) => (2, true),
                QualifierKind::Auxiliary(_) => (3, true),
                QualifierKind::Storage(_) => (4, false),
                QualifierKind::Precision(_) => (5, true),
            };
            if rank < last && !self.language.has(Feature::MixedQualifiers) {
                self.need(Feature::MixedQualifiers, q.span);
            }
            last = last.max(rank);
            if single && seen.contains(&rank) {
                self.twice(q);
            }
            seen.push(rank);
            match &q.kind {
                QualifierKind::Storage(s) => {
                    if storage.is_some() {
                        self.twice(q);
                    }
                    storage = Some(*s);
                }
                QualifierKind::Interpolation(_) => {
                    self.need(Feature::Interpolation, q.span);
                }
                QualifierKind::Precision(_) => {
                    self.need(Feature::Precision, q.span);
                }
                _ if Self::is_centroid(q) => {
                    self.need(Feature::Centroid, q.span);
                }
                _ => {}
            }
        }
    }

    /// Rules of the qualifiers of variables and blocks of the interface.
    pub(super) fn storage_rules(&mut self, qualifiers: &Qualifiers, storage: Storage) {
        let word = qualifiers.storage();
        let stage = self.stage;
        if let Some((word, span)) = word {
            match word {
                StorageQualifier::Attribute if !matches!(stage, Stage::Vertex | Stage::Library) => {
                    self.qualifier(
                        span,
                        message!("only vertex shaders have attributes", "attribute は頂点シェーダだけのものです"),
                    );
                }
                StorageQualifier::Attribute | StorageQualifier::Varying
                    if self.language.es() && self.language.number() >= 300 =>
                {
                    self.qualifier(
                        span,
                        message!("GLSL ES 3.00 has `in` and `out` instead", "GLSL ES 3.00 では `in`・`out` を使います"),
                    );
                }
                StorageQualifier::In | StorageQualifier::Out => {
                    self.need(Feature::InOutStorage, span);
                }
                StorageQualifier::InOut => {
                    self.qualifier(span, message!("it belongs to parameters", "引数に付ける修飾子です"));
                }
                StorageQualifier::Buffer
                | StorageQualifier::Shared
                | StorageQualifier::Const
                | StorageQualifier::Uniform => {}
                StorageQualifier::Attribute | StorageQualifier::Varying => {}
            }
        }
        let linked = match storage {
            Storage::In => stage != Stage::Vertex,
            Storage::Out => stage != Stage::Fragment,
            _ => false,
        };
        for q in &qualifiers.list {
            match &q.kind {
                QualifierKind::Interpolation(_) if !linked && stage != Stage::Library => {
                    self.qualifier(
                        q.span,
                        message!(
                            "it belongs to values that go from stage to stage",
                            "ステージ間で渡す値に付ける修飾子です"
                        ),
                    );
                }
                QualifierKind::Interpolation(_)
                    if matches!(word, Some((StorageQualifier::Varying | StorageQualifier::Attribute, _)))
                        && !self.language.is_open() =>
                {
                    self.qualifier(q.span, message!("it does not go with `varying`", "`varying` とは併用できません"));
                }
                QualifierKind::Auxiliary(AuxiliaryQualifier::Centroid | AuxiliaryQualifier::Sample)
                    if !linked && stage != Stage::Library =>
                {
                    self.qualifier(
                        q.span,
                        message!(
                            "it belongs to values that go from stage to stage",
                            "ステージ間で渡す値に付ける修飾子です"
                        ),
                    );
                }
                QualifierKind::Auxiliary(AuxiliaryQualifier::Patch)
                    if !matches!(
                        (stage, storage),
                        (Stage::TessControl, Storage::Out) | (Stage::TessEvaluation, Storage::In) | (Stage::Library, _)
                    ) =>
                {
                    self.qualifier(
                        q.span,
                        message!(
                            "only tessellation stages have patches",
                            "パッチはテッセレーションのステージだけのものです"
                        ),
                    );
                }
                QualifierKind::Invariant => {
                    self.need(Feature::Invariant, q.span);
                    let old_input =
                        storage == Storage::In && stage != Stage::Vertex && !self.language.at_least(420, 300);
                    if storage != Storage::Out && !old_input {
                        self.qualifier(q.span, message!("it belongs to outputs", "出力に付ける修飾子です"));
                    }
                }
                _ => {}
            }
        }
    }

    /// The type of a global variable, or of a member of an input or output block, by its storage.
    pub(super) fn storage_type(&mut self, ty: &Type, storage: Storage, qualifiers: &Qualifiers, span: Span) {
        if ty.is_error() {
            return;
        }
        if ty.contains_opaque() && self.language.bindless() {
            return;
        }
        if ty.contains_opaque() && storage != Storage::Uniform {
            let message =
                message!("`{ty}` can only be a uniform or a parameter", "`{ty}` は uniform か引数に限られます");
            return self.sink.error(errors::VARIABLE_TYPE, span, message, message!("declared here", "ここで宣言"));
        }
        let why = match (storage, self.stage) {
            (Storage::In, Stage::Vertex) => self.attribute_type(ty),
            (Storage::Out, Stage::Fragment) => self.fragment_output(ty),
            (Storage::In | Storage::Out, Stage::Library) => None,
            (Storage::In, Stage::Fragment) => self.varying_type(ty, qualifiers, span),
            (Storage::In | Storage::Out, _) => self.varying_type(ty, &Qualifiers::default(), span),
            _ => None,
        };
        if let Some(why) = why {
            let message =
                message!("`{ty}` cannot be the type of this variable", "この変数の型を `{ty}` にはできません");
            let d =
                self.sink.start(errors::VARIABLE_TYPE, span, message).with_label(message!("of this type", "この型"));
            self.sink.push(d.with_why(why));
        }
    }

    fn attribute_type(&mut self, ty: &Type) -> Option<Message> {
        let integers = self.language.at_least(130, 300) || self.language.is_open();
        match element(ty) {
            Type::Struct(_) => return Some(message!("an attribute is no structure", "頂点属性を構造体にはできません")),
            _ if has_scalar(ty, &|s| s == ScalarType::Bool) => {
                return Some(message!("an attribute is no `bool`", "頂点属性を `bool` にはできません"));
            }
            _ => {}
        }
        if !integers && has_scalar(ty, &ScalarType::is_integer) {
            let version = self.language.name();
            return Some(message!(
                "attributes of {version} hold floats only",
                "{version} の頂点属性は浮動小数点数だけです"
            ));
        }
        if has_scalar(ty, &|s| s == ScalarType::Double) && !self.language.has(Feature::DoubleInputs) {
            return Some(message!(
                "attributes of `double` came with GLSL 4.10",
                "`double` の頂点属性は GLSL 4.10 からです"
            ));
        }
        let arrays = self.language.at_least(150, u32::MAX) || self.language.is_open();
        (matches!(ty, Type::Array(..)) && !arrays)
            .then(|| message!("arrays of attributes came with GLSL 1.50", "頂点属性の配列は GLSL 1.50 からです"))
    }

    fn fragment_output(&mut self, ty: &Type) -> Option<Message> {
        match element(ty) {
            Type::Struct(_) | Type::Matrix(..) => {
                Some(message!("a fragment output is a scalar or vector", "フラグメント出力はスカラかベクトルです"))
            }
            _ if has_scalar(ty, &|s| matches!(s, ScalarType::Bool | ScalarType::Double)) => {
                Some(message!("a fragment output holds floats or integers", "フラグメント出力は浮動小数点数か整数です"))
            }
            _ => None,
        }
    }

    fn varying_type(&mut self, ty: &Type, qualifiers: &Qualifiers, span: Span) -> Option<Message> {
        if has_scalar(ty, &|s| s == ScalarType::Bool) {
            return Some(message!("`bool` does not go from stage to stage", "`bool` はステージ間で渡せません"));
        }
        let modern = self.language.at_least(130, 300) || self.language.is_open();
        let integer = |s: ScalarType| s.is_integer() || s == ScalarType::Double;
        if !modern && has_scalar(ty, &integer) {
            let version = self.language.name();
            return Some(message!(
                "varyings of {version} hold floats only",
                "{version} の varying は浮動小数点数だけです"
            ));
        }
        if matches!(element(ty), Type::Struct(_)) && !self.language.at_least(150, 300) && !self.language.is_open() {
            return Some(message!(
                "structures between stages came with GLSL 1.50",
                "ステージ間の構造体は GLSL 1.50 からです"
            ));
        }
        let flat = qualifiers.interpolation().is_some_and(|(i, _)| i == Interpolation::Flat);
        let input = qualifiers.storage().is_some_and(|(s, _)| s != StorageQualifier::Out);
        if modern && self.stage == Stage::Fragment && input && !flat && has_scalar(ty, &integer) {
            let d = self
                .sink
                .start(
                    errors::NOT_FLAT,
                    span,
                    message!(
                        "a `{ty}` input of a fragment shader must be `flat`",
                        "フラグメントシェーダの `{ty}` 入力には `flat` が必要です"
                    ),
                )
                .with_label(message!("cannot be interpolated", "補間できません"))
                .with_why(message!("integers and doubles have no values in between", "整数と double は補間されません"))
                .with_help(message!("put `flat` before `in`", "`in` の前に `flat` を書いてください"));
            self.sink.push(d);
        }
        None
    }

    /// The initialiser of a global variable, or that one is missing.
    pub(super) fn initialiser_rules(&mut self, declarator: &Declarator, storage: Storage, ty: &Type, constant: bool) {
        let name = &declarator.name.name;
        let Some(initializer) = &declarator.initializer else {
            if constant && !ty.is_error() {
                let message = message!("the constant `{name}` has no value", "定数 `{name}` に値がありません");
                let label = message!("needs `= …`", "`= …` が必要です");
                self.sink.error(errors::INITIALISER, declarator.name.span, message, label);
            }
            return;
        };
        let span = self.arena.get(initializer.value).span;
        let zero = matches!(&self.arena.get(initializer.value).kind, ExprKind::List(items) if items.is_empty());
        match storage {
            Storage::Shared if zero && self.language.enabled("EXT_null_initializer") => return,
            Storage::In | Storage::Out | Storage::Buffer | Storage::Shared => {
                let message = message!("`{name}` cannot have an initialiser", "`{name}` に初期化子は書けません");
                let label = message!("not allowed here", "ここには書けません");
                return self.sink.error(errors::INITIALISER, span, message, label);
            }
            Storage::Uniform => {
                self.need(Feature::UniformInitializers, span);
            }
            Storage::Const | Storage::Global => {}
        }
        if super::expression::has_array(ty) {
            self.need(Feature::ArrayValues, span);
        }
        // From 4.20 on a local constant may get its value when the shader runs (GLSL 4.60, 4.3.3).
        let constant = constant && (self.at_file_scope() || !self.language.has(Feature::LocalConstants));
        let global = storage == Storage::Uniform || (self.at_file_scope() && (self.language.es()));
        if (constant || global) && !self.is_constant(initializer.value) && !ty.is_error() {
            let message = message!(
                "the initialiser of `{name}` must be constant",
                "`{name}` の初期化子は定数でなければなりません"
            );
            let label = message!("not known when the shader is compiled", "コンパイル時に決まりません");
            self.sink.error(errors::INITIALISER, span, message, label);
        }
    }

    /// Qualifiers of a local variable.
    pub(super) fn local_qualifiers(&mut self, declaration: &Declaration) {
        self.qualifier_rules(&declaration.qualifiers);
        self.layout_rules(&declaration.qualifiers, Bearer::Nothing, None);
        for q in &declaration.qualifiers.list {
            let good = matches!(
                q.kind,
                QualifierKind::Storage(StorageQualifier::Const)
                    | QualifierKind::Precision(_)
                    | QualifierKind::Precise
                    | QualifierKind::Layout(_)
                    | QualifierKind::Memory(_)
            );
            if !good {
                self.qualifier(q.span, message!("it belongs to file scope", "関数の外に書く修飾子です"));
            }
        }
    }

    /// A built-in variable that is declared again; true when that is allowed.
    pub(super) fn redeclared_builtin(&mut self, name: &Ident, ty: &Type, storage: Option<Storage>) -> bool {
        if !REDECLARABLE.contains(&name.name.as_str()) || !self.at_file_scope() {
            return false;
        }
        let Some(known) = builtin::variable(&name.name, self.stage, self.vertices) else { return false };
        if self.language.is_open() {
            return true;
        }
        if builtin::variable_absent(&name.name, self.stage, &self.language).is_some() {
            return false;
        }
        if matches!(name.name.as_str(), "gl_Position" | "gl_PointSize" | "gl_FragColor" | "gl_FragData")
            && !self.language.at_least(410, 300)
            && !self.language.enabled("ARB_separate_shader_objects")
            && !self.language.enabled("EXT_separate_shader_objects")
        {
            return false;
        }
        if self.per_vertex.contains_key(&Storage::Out)
            && builtin::in_per_vertex(&name.name)
            && storage == Some(Storage::Out)
        {
            let text = &name.name;
            let message = message!(
                "`{text}` is declared again behind a block of `gl_PerVertex`",
                "`gl_PerVertex` ブロックの後で `{text}` が再宣言されています"
            );
            self.sink.error(
                errors::REDECLARATION,
                name.span,
                message,
                message!("belongs into the block", "ブロックの中に書きます"),
            );
        }
        if let Type::Array(_, ArraySize::Known(n)) = ty {
            self.builtin_limit(&name.name, i64::from(*n), name.span);
        }
        if element(&known.ty) != element(ty) && !ty.is_error() {
            let (text, wanted) = (&name.name, known.ty.to_string());
            let message = message!(
                "`{text}` is declared as `{ty}`, but is `{wanted}`",
                "`{text}` の型は `{wanted}` で、`{ty}` ではありません"
            );
            self.sink.error(errors::REDECLARATION, name.span, message, message!("another type", "型が違います"));
        }
        let wanted = if known.read_only { Storage::In } else { Storage::Out };
        let varying = self.language.es() || self.language.number() < 130;
        let depth = name.name == "gl_FragDepth" || name.name == "gl_TexCoord";
        let coordinate = matches!(name.name.as_str(), "gl_FragCoord" | "gl_FragDepth");
        if storage.is_none_or(|s| s != wanted)
            && !(varying && coordinate && storage.is_none())
            && !(depth && storage == Some(Storage::Out))
        {
            let text = &name.name;
            let word = if wanted == Storage::In { "in" } else { "out" };
            let message =
                message!("`{text}` must be declared with `{word}`", "`{text}` は `{word}` で宣言しなければなりません");
            self.sink.error(errors::REDECLARATION, name.span, message, message!("another storage", "記憶域が違います"));
        }
        true
    }

    /// A variable that is declared again, with a size or other qualifiers.
    pub(super) fn resized(&mut self, old: SymbolId, name: &Ident, ty: &Type) {
        let text = &name.name;
        let used = |c: &Self| c.out.uses.iter().any(|u| u.symbol == old);
        let first = !self.scopes.first().is_some_and(|s| s.entries.contains_key(text));
        if text == "gl_FragCoord" && first && used(self) {
            let message =
                message!("`{text}` is used before it is declared again", "`{text}` は再宣言の前に使われています");
            self.sink.error(errors::REDECLARATION, name.span, message, message!("too late", "遅すぎます"));
        }
        let Type::Array(_, ArraySize::Known(n)) = ty else { return };
        let reached = self.most_index.get(&old).copied().unwrap_or(-1);
        if reached >= i64::from(*n) {
            let message = message!(
                "`{text}` gets {n} elements, but element {reached} is used above",
                "`{text}` の要素は {n} 個ですが、上で {reached} 番が使われています"
            );
            self.sink.error(errors::ARRAY, name.span, message, message!("too small", "小さすぎます"));
        }
    }

    /// At most eight clip distances and texture coordinates.
    pub(super) fn builtin_limit(&mut self, name: &str, elements: i64, span: Span) {
        let limit = match name {
            "gl_ClipDistance" | "gl_CullDistance" | "gl_TexCoord" => 8,
            _ => return,
        };
        if elements > limit {
            let message = message!("`{name}` has at most {limit} elements", "`{name}` の要素は {limit} 個までです");
            self.sink.error(errors::ARRAY, span, message, message!("beyond the limit", "上限を超えています"));
        }
    }

    /// A size of a built-in array that is greater than its limit.
    pub(super) fn limited_size(&mut self, name: &str, dims: &[super::super::ast::ArrayDim]) {
        let (Some(limit), Some(size)) = (super::places::limit_of(name), dims.first().and_then(|d| d.size)) else {
            return;
        };
        if self.beyond_limit(size, limit).is_some_and(|more| more > 0) {
            let message = message!("`{name}` has at most `{limit}` elements", "`{name}` の要素は `{limit}` 個までです");
            let span = self.arena.get(size).span;
            self.sink.error(errors::ARRAY, span, message, message!("beyond the limit", "上限を超えています"));
        }
    }

    /// An array at file scope or in a function: nested dimensions and sizes that must be there.
    pub(super) fn array_rules(&mut self, ty: &Type, span: Span, initialised: bool, unsized_allowed: bool) {
        let Type::Array(inner, size) = ty else { return };
        if matches!(inner.as_ref(), Type::Array(..)) {
            self.need(Feature::ArraysOfArrays, span);
            if let Type::Array(_, ArraySize::Unsized) = inner.as_ref()
                && !initialised
            {
                let message = message!(
                    "only the outermost dimension may be left open",
                    "大きさを省けるのは一番外側の次元だけです"
                );
                self.sink.error(errors::ARRAY, span, message, message!("no size", "大きさがない"));
            }
        }
        if *size == ArraySize::Unsized && !initialised && !unsized_allowed {
            let message = message!("this array needs a size", "この配列には大きさが必要です");
            self.sink.error(errors::ARRAY, span, message, message!("no size", "大きさがない"));
        }
    }
}
