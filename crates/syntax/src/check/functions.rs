//! Rules about functions (GLSL 4.60 specification, section 6.1), and about the stage as a whole.

use super::super::ast::{
    AuxiliaryQualifier, Function, ItemKind, Precision, PrecisionStatement, Qualifier, QualifierKind, Qualifiers,
    StorageQualifier, TypeKind,
};
use super::super::interface::{OutputPrimitive, Storage};
use super::super::language::Feature;
use super::super::symbols::{Direction, FunctionId, ParamInfo};
use super::super::types::{ArraySize, OpaqueType, ScalarType, Type};
use super::super::{Stage, builtin, errors};
use super::{Checker, Entry};
use base::diagnostic::{Message, message};
use base::text::Span;

impl Checker<'_> {
    /// Rules of one function head.
    pub(super) fn function_rules(&mut self, function: &Function, return_type: &Type, params: &[ParamInfo]) {
        let name = &function.name;
        let here = message!("this function", "この関数");
        if name.name == "main" && (*return_type != Type::Void || !params.is_empty()) && !return_type.is_error() {
            let message = message!("`main` is `void main()`", "`main` は `void main()` と書きます");
            self.sink.error(
                errors::FUNCTION,
                name.span,
                message,
                message!("takes and gives nothing", "引数も戻り値もない"),
            );
        }
        self.reserved_name(name, false);
        let apart = self.language.number() == 110;
        let entry = self.scopes.first().and_then(|s| s.entries.get(&name.name));
        if let Some(entry) = entry.filter(|e| !(apart && matches!(e, Entry::Variable(_)))) {
            let first = match entry {
                Entry::Variable(id) => self.out.symbols[id.index()].span,
                Entry::Structure(s) => Some(s.span),
            };
            self.redefinition(name, first);
        }
        if self.language.es() && !self.language.is_open() {
            self.builtin_redefined(function, params);
        }
        if matches!(function.return_type.kind, TypeKind::Struct(_)) {
            let message =
                message!("a structure cannot be defined in a return type", "戻り値の型の中で構造体は定義できません");
            self.sink.error(errors::FUNCTION, function.return_type.span, message, here.clone());
        }
        if matches!(return_type, Type::Array(..)) {
            self.need(Feature::ArrayValues, function.return_type.span);
            if let Type::Array(_, ArraySize::Unsized) = return_type {
                let message = message!("a returned array needs a size", "返す配列には大きさが必要です");
                self.sink.error(errors::ARRAY, function.return_type.span, message, here.clone());
            }
        }
        if return_type.contains_opaque() && !self.language.bindless() {
            let message = message!("a function cannot return `{return_type}`", "関数は `{return_type}` を返せません");
            self.sink.error(errors::VARIABLE_TYPE, function.return_type.span, message, here.clone());
        }
        for q in &function.qualifiers.list {
            let good = matches!(
                q.kind,
                QualifierKind::Precision(_)
                    | QualifierKind::Subroutine(_)
                    | QualifierKind::Precise
                    | QualifierKind::Layout(_)
            );
            if !good {
                self.qualifier(q.span, message!("it does not belong to a return type", "戻り値の型には付けられません"));
            }
        }
        if self.blocks.iter().any(|(_, block)| *block == name.name) {
            self.redefinition(name, None);
        }
        self.precision_needed(&function.qualifiers, return_type, function.return_type.span);
        for (param, info) in function.params.iter().zip(params) {
            if param.name.is_none() && function.body.is_some() && self.language.number() < 130 && !self.language.es() {
                let message =
                    message!("a parameter of a defined function needs a name", "定義する関数の引数には名前が必要です");
                self.sink.error(errors::FUNCTION, param.span, message, message!("no name", "名前がない"));
            }
            self.param_rules(param, info);
        }
    }

    fn builtin_redefined(&mut self, function: &Function, params: &[ParamInfo]) {
        let name = &function.name;
        if builtin::function_absent(&name.name, self.stage, &self.language).is_some() {
            return;
        }
        let known = builtin::functions(&name.name);
        let same = |s: &builtin::Signature| {
            s.params.len() == params.len() && s.params.iter().zip(params).all(|(a, b)| a.1 == b.ty)
        };
        let wrong = if self.language.number() >= 300 { !known.is_empty() } else { known.iter().any(same) };
        if wrong && self.language.number() >= 300 && name.name.starts_with("noise") {
            return;
        }
        if wrong {
            let text = &name.name;
            let version = self.language.name();
            let message = message!(
                "{version} does not let `{text}` be defined again",
                "{version} では `{text}` を定義し直せません"
            );
            self.sink.error(errors::REDEFINITION, name.span, message, message!("built in", "組み込み関数"));
        }
    }

    fn param_rules(&mut self, param: &super::super::ast::Param, info: &ParamInfo) {
        let here = message!("this parameter", "この引数");
        if matches!(info.ty, Type::Array(..)) && info.direction != Direction::In && !self.language.es() {
            self.need(Feature::ArrayValues, param.span);
        }
        self.precision_type(&param.qualifiers, &info.ty);
        if info.ty.is_void() {
            let message = message!("a parameter cannot be `void`", "引数は `void` にできません");
            self.sink.error(errors::VARIABLE_TYPE, param.span, message, here.clone());
        }
        if info.ty.contains_opaque() && info.direction != Direction::In && !self.language.bindless() {
            let ty = &info.ty;
            let message = message!("`{ty}` can only be an `in` parameter", "`{ty}` は `in` 引数に限られます");
            self.sink.error(errors::VARIABLE_TYPE, param.span, message, here.clone());
        }
        if matches!(param.ty.kind, TypeKind::Struct(_)) {
            let message = message!("a structure cannot be defined in a parameter", "引数の中で構造体は定義できません");
            self.sink.error(errors::FUNCTION, param.ty.span, message, here.clone());
        }
        if let Type::Array(element, _) = &info.ty
            && matches!(**element, Type::Array(..))
        {
            self.need(Feature::ArraysOfArrays, param.span);
        }
        if let Type::Array(_, ArraySize::Unsized) = info.ty {
            let message = message!("an array parameter needs a size", "配列の引数には大きさが必要です");
            self.sink.error(errors::ARRAY, param.span, message, here);
        }
        if let Some(name) = &param.name {
            self.reserved_name(name, false);
        }
        let mut constant = None;
        let mut direction = None;
        let mut precision = false;
        for q in &param.qualifiers.list {
            match &q.kind {
                QualifierKind::Storage(StorageQualifier::Const) => {
                    if constant.is_some() {
                        self.twice(q);
                    }
                    if direction.is_some() || precision {
                        self.need(Feature::MixedQualifiers, q.span);
                    }
                    constant = Some(q.span);
                }
                QualifierKind::Storage(StorageQualifier::In | StorageQualifier::Out | StorageQualifier::InOut) => {
                    if direction.is_some() {
                        self.twice(q);
                    }
                    if precision {
                        self.need(Feature::MixedQualifiers, q.span);
                    }
                    direction = Some(q.span);
                }
                QualifierKind::Storage(_)
                | QualifierKind::Layout(_)
                | QualifierKind::Auxiliary(_)
                | QualifierKind::Interpolation(_)
                | QualifierKind::Invariant
                | QualifierKind::Subroutine(_) => {
                    self.qualifier(q.span, message!("it does not belong to a parameter", "引数には付けられません"));
                }
                QualifierKind::Precision(_) => {
                    self.need(Feature::Precision, q.span);
                    precision = true;
                }
                QualifierKind::Precise | QualifierKind::Memory(_) => {}
            }
        }
        if let Some(span) = constant.filter(|_| info.direction != Direction::In) {
            self.qualifier(span, message!("an `out` parameter cannot be `const`", "`out` 引数は `const` にできません"));
        }
        self.precision_needed(&param.qualifiers, &info.ty, param.ty.span);
    }

    /// Tells a qualifier that does not belong where it stands.
    pub(super) fn qualifier(&mut self, span: Span, why: Message) {
        let text = self.sink.file.slice(span).to_owned();
        let d = self
            .sink
            .start(errors::QUALIFIER, span, message!("`{text}` cannot stand here", "`{text}` はここに書けません"))
            .with_label(message!("this qualifier", "この修飾子"));
        self.sink.push(d.with_why(why));
    }

    pub(super) fn twice(&mut self, q: &Qualifier) {
        self.qualifier(q.span, message!("one of its kind stands there already", "同じ種類の修飾子が既にあります"));
    }

    /// A name that the language keeps: `gl_…`, unless a built-in variable may be declared again.
    pub(super) fn reserved_name(&mut self, name: &super::super::ast::Ident, redeclared: bool) {
        if !super::super::language::is_builtin_name(name) || redeclared {
            return;
        }
        let text = &name.name;
        let d = self
            .sink
            .start(
                errors::RESERVED,
                name.span,
                message!("`{text}` is a name of the language", "`{text}` は言語が使う名前です"),
            )
            .with_label(message!("cannot be declared", "宣言できません"))
            .with_why(message!("names that start with `gl_` are reserved", "`gl_` で始まる名前は予約されています"))
            .with_help(message!("choose another name", "別の名前にしてください"));
        self.sink.push(d);
    }

    /// Functions that call themselves, directly or through others.
    pub(super) fn recursion(&mut self) {
        let calls = std::mem::take(&mut self.calls);
        let n = self.out.functions.len();
        let mut callees: Vec<Vec<FunctionId>> = vec![Vec::new(); n];
        for (from, to, _) in &calls {
            if !callees[from.index()].contains(to) {
                callees[from.index()].push(*to);
            }
        }
        let mut reported = vec![false; n];
        for (from, to, span) in &calls {
            if reported[from.index()] {
                continue;
            }
            let mut seen = vec![false; n];
            let mut todo = vec![*to];
            while let Some(f) = todo.pop() {
                if !std::mem::replace(&mut seen[f.index()], true) {
                    todo.extend(&callees[f.index()]);
                }
            }
            if seen[from.index()] {
                // One message for each circle.
                for f in 0..n {
                    reported[f] |= seen[f];
                }
                let name = &self.out.functions[from.index()].name.name;
                let message = message!("`{name}` calls itself", "`{name}` は自分自身を呼んでいます");
                let d = self
                    .sink
                    .start(errors::FUNCTION, *span, message)
                    .with_label(message!("leads back to `{name}`", "`{name}` に戻る呼び出し"))
                    .with_why(message!("shaders have no recursion", "シェーダで再帰はできません"));
                self.sink.push(d);
            }
        }
    }

    /// What is missing at the end: the layout of a geometry stage.
    pub(super) fn whole_stage(&mut self) {
        self.fragment_outputs();
        let partial = self.incomplete || self.unit.items.iter().any(|i| i.kind == ItemKind::Error);
        let main = self.out.functions.iter().find(|f| f.name.name == "main" && f.definition.is_some());
        let Some(main) = main.filter(|_| !partial && self.stage == Stage::Geometry) else { return };
        // With this extension the host sets the primitives.
        if self.language.is_open() {
            return;
        }
        let span = main.name.span;
        let layout = &self.out.interface.geometry;
        let mut missing = Vec::new();
        if layout.input.is_none() && self.vertices.is_none() {
            missing.push("layout(triangles) in;");
        }
        let bad = self.sink.has(errors::OUTPUT_PRIMITIVE);
        if layout.output.is_none() && !bad {
            missing.push("layout(triangle_strip) out;");
        }
        if layout.max_vertices.is_none() && !self.sink.has(errors::CONSTANT) && !self.sink.has(errors::LAYOUT) {
            missing.push("layout(max_vertices = 3) out;");
        }
        let first = missing.first().copied();
        let Some(first) = first else { return };
        let what = match first {
            "layout(triangles) in;" => message!("its input primitive", "入力プリミティブ"),
            "layout(triangle_strip) out;" => message!("its output primitive", "出力プリミティブ"),
            _ => message!("`max_vertices`", "`max_vertices`"),
        };
        use base::diagnostic::Lang;
        let message = Message::new(
            format!("this geometry shader does not say {}", what.in_lang(Lang::En)),
            format!("このジオメトリシェーダには {} の宣言がありません", what.in_lang(Lang::Ja)),
        );
        let all = missing.join(" ");
        let d = self
            .sink
            .start(errors::MISSING_LAYOUT, span, message)
            .with_label(message!("needs a layout", "layout 宣言が必要です"))
            .with_why(message!("without it the program does not link", "これがないとプログラムをリンクできません"))
            .with_help(message!("declare `{all}`", "`{all}` のように宣言してください"));
        self.sink.push(d);
    }

    pub(super) fn precision_statement(&mut self, statement: &PrecisionStatement) {
        let ty = self.named_type(&statement.ty.kind, statement.ty.name_span);
        let good = matches!(ty, Type::Error | Type::FLOAT | Type::INT) || matches!(&ty, Type::Opaque(_));
        if !good || !statement.ty.dims.is_empty() {
            let message = message!("`{ty}` has no default precision", "`{ty}` に既定の精度はありません");
            let label = message!("`float`, `int` or an opaque type", "`float`・`int`・不透明型だけです");
            self.sink.error(errors::QUALIFIER, statement.ty.span, message, label);
        }
        if ty == Type::FLOAT && matches!(statement.precision, Precision::Low | Precision::Medium | Precision::High) {
            self.float_precision = true;
        }
        if let Type::Opaque(opaque) = ty {
            self.opaque_precisions.push(opaque);
        }
    }

    /// In a fragment shader of GLSL ES a `float` has no precision by default, and no sampler but two in any stage (GLSL ES
    /// 3.00 specification, section 4.5.4).
    pub(super) fn precision_needed(&mut self, qualifiers: &Qualifiers, ty: &Type, span: Span) {
        let floats = |t: &Type| t.scalar() == Some(ScalarType::Float);
        let mut element = ty;
        while let Type::Array(inner, _) = element {
            element = inner;
        }
        let needed = self.language.es()
            && self.stage == Stage::Fragment
            && floats(element)
            && !self.float_precision
            && !self.precision_reported
            && qualifiers.precision().is_none()
            && !self.incomplete;
        if let Type::Opaque(opaque) = element {
            self.opaque_precision_needed(*opaque, qualifiers, span);
        }
        if !needed {
            return;
        }
        self.precision_reported = true;
        let d = self
            .sink
            .start(errors::PRECISION, span, message!("`{ty}` has no precision here", "`{ty}` の精度が決まっていません"))
            .with_label(message!("needs a precision", "精度が必要です"))
            .with_why(message!(
                "fragment shaders of GLSL ES have no default precision of `float`",
                "GLSL ES のフラグメントシェーダでは `float` の既定の精度がありません"
            ))
            .with_help(message!(
                "put `precision mediump float;` at the top",
                "先頭に `precision mediump float;` を書いてください"
            ));
        self.sink.push(d);
    }

    fn opaque_precision_needed(&mut self, opaque: OpaqueType, qualifiers: &Qualifiers, span: Span) {
        let needed = self.language.es()
            && self.language.number() >= 300
            && !opaque.has_default_precision()
            && !self.opaque_precisions.contains(&opaque)
            && qualifiers.precision().is_none()
            && !self.incomplete;
        if !needed {
            return;
        }
        self.opaque_precisions.push(opaque);
        let d = self
            .sink
            .start(
                errors::PRECISION,
                span,
                message!("`{opaque}` has no precision here", "`{opaque}` の精度が決まっていません"),
            )
            .with_label(message!("needs a precision", "精度が必要です"))
            .with_why(message!(
                "of all samplers and images, GLSL ES has a default precision of `sampler2D` and `samplerCube` alone",
                "GLSL ES で既定の精度があるのは `sampler2D` と `samplerCube` だけです"
            ))
            .with_help(message!(
                "put `precision mediump {opaque};` at the top",
                "先頭に `precision mediump {opaque};` を書いてください"
            ));
        self.sink.push(d);
    }

    /// Precision belongs to numbers and samplers.
    pub(super) fn precision_type(&mut self, qualifiers: &Qualifiers, ty: &Type) {
        let Some((_, span)) = qualifiers.precision() else { return };
        let mut element = ty;
        while let Type::Array(inner, _) = element {
            element = inner;
        }
        let without = matches!(element, Type::Struct(_) | Type::Void) || element.scalar() == Some(ScalarType::Bool);
        if without {
            self.qualifier(span, message!("`{ty}` has no precision", "`{ty}` に精度はありません"));
        }
    }

    /// Built-in outputs of a fragment shader exclude each other and those of the shader.
    fn fragment_outputs(&mut self) {
        if self.stage != Stage::Fragment || self.language.is_open() {
            return;
        }
        let mut written: Vec<(&str, Span)> = Vec::new();
        for u in self.out.uses.iter().filter(|u| u.access.writes()) {
            let symbol = &self.out.symbols[u.symbol.index()];
            let name = match (symbol.name.as_str(), symbol.kind) {
                ("gl_FragColor", _) => "`gl_FragColor`",
                ("gl_FragData", _) => "`gl_FragData`",
                (_, super::SymbolKind::Global(Storage::Out)) => "",
                _ => continue,
            };
            if !written.iter().any(|w| w.0 == name) {
                written.push((name, u.span));
            }
        }
        let mut builtin = written.iter().filter(|w| !w.0.is_empty());
        let Some((first, span)) = builtin.next() else { return };
        let Some((other, _)) = written.iter().find(|w| w.0 != *first) else { return };
        let other_en = if other.is_empty() { "an output of the shader" } else { other };
        let other_ja = if other.is_empty() { "シェーダの出力変数" } else { other };
        let message = Message::new(
            format!("{first} and {other_en} cannot both be written"),
            format!("{first} と {other_ja} の両方には書き込めません"),
        );
        let label = message!("one of the two is too much", "どちらか一方だけにしてください");
        self.sink.error(errors::REDECLARATION, *span, message, label);
    }

    /// `layout(triangles) out` and the like.
    pub(super) fn output_primitive(&mut self, key: &str, span: Span) {
        if OutputPrimitive::from_name(key).is_some() {
            return;
        }
        let meant = match key {
            "lines" | "lines_adjacency" => "line_strip",
            "triangles" | "triangles_adjacency" => "triangle_strip",
            _ => return,
        };
        let d = self
            .sink
            .start(
                errors::OUTPUT_PRIMITIVE,
                span,
                message!("`{key}` is no output primitive", "`{key}` は出力プリミティブではありません"),
            )
            .with_label(message!("an input primitive", "入力プリミティブの名前"))
            .with_why(message!(
                "a geometry shader gives `points`, `line_strip` or `triangle_strip`",
                "ジオメトリシェーダの出力は `points`・`line_strip`・`triangle_strip` です"
            ))
            .with_help(message!("write `{meant}`", "`{meant}` と書いてください"));
        self.sink.push(d);
    }

    /// `invariant a;` and `precise a;`: outputs only, at file scope.
    pub(super) fn invariant_rules(&mut self, names: &super::super::ast::QualifiedNames) {
        let Some(span) = names.qualifiers.invariant() else { return };
        self.need(Feature::Invariant, span);
        if !self.at_file_scope() {
            return self.qualifier(span, message!("it belongs to file scope", "関数の外に書く修飾子です"));
        }
        for name in &names.names {
            let Some(symbol) = self.variable(&name.name) else { continue };
            let symbol = &self.out.symbols[symbol.index()];
            use super::super::symbols::SymbolKind;
            let output = match symbol.kind {
                SymbolKind::Global(Storage::Out) => true,
                SymbolKind::Global(Storage::In) => self.stage != Stage::Vertex && !self.language.at_least(420, 300),
                SymbolKind::Builtin => true,
                SymbolKind::BlockMember(_) => true,
                SymbolKind::Global(_) | SymbolKind::BlockInstance(_) | SymbolKind::Param(_) | SymbolKind::Local => {
                    false
                }
            };
            if !output {
                let text = &name.name;
                let message = message!(
                    "`{text}` is no output and cannot be `invariant`",
                    "`{text}` は出力ではないので `invariant` にできません"
                );
                self.sink.error(errors::QUALIFIER, name.span, message, message!("not an output", "出力ではない"));
            } else if self.out.uses.iter().any(|u| self.out.symbols[u.symbol.index()].name == name.name) {
                let text = &name.name;
                let message = message!(
                    "`{text}` is used before it becomes `invariant`",
                    "`{text}` は `invariant` にする前に使われています"
                );
                self.sink.error(errors::QUALIFIER, name.span, message, message!("too late", "遅すぎます"));
            }
        }
    }

    /// True for `centroid`.
    pub(super) fn is_centroid(q: &Qualifier) -> bool {
        matches!(q.kind, QualifierKind::Auxiliary(AuxiliaryQualifier::Centroid))
    }
}
