//! Calls at which invocations meet, which stand in `main` where every invocation comes by once: `barrier` of a
//! tessellation control stage (GLSL 4.60 specification, section 8.16) and the interlock of fragments
//! (GL_ARB_fragment_shader_interlock); and subroutines (section 6.1.2).

use super::super::ast::{Function, Ident, QualifierKind, Qualifiers};
use super::super::symbols::ParamInfo;
use super::super::types::Type;
use super::super::{Stage, errors};
use super::Checker;
use base::diagnostic::{Message, message};

impl Checker<'_> {
    /// Checks the place of such a call.
    pub(super) fn meeting(&mut self, name: &Ident) {
        let text = name.name.as_str();
        let begins = text.starts_with("beginInvocationInterlock");
        let interlock = begins || text.starts_with("endInvocationInterlock");
        if !interlock && (text != "barrier" || self.stage != Stage::TessControl) {
            return;
        }
        let Some((function, _)) = self.current else { return };
        let why: Message = if self.out.functions[function.index()].name.name != "main" {
            message!("it belongs into `main`", "`main` に書く関数です")
        } else if self.around.is_branched() {
            message!(
                "not every invocation comes by in a branch or loop",
                "分岐やループの中では全ての実行が通るとは限りません"
            )
        } else if self.returned {
            message!("some invocations have returned above", "上で `return` する実行があります")
        } else if interlock && self.met.iter().any(|m| m == text) {
            message!("it is called once", "呼べるのは一度だけです")
        } else if interlock && !begins && self.met.is_empty() {
            message!("the interlock begins before it ends", "開始の前に終了しています")
        } else {
            return self.met.push(text.to_owned());
        };
        self.misplaced(text, why, name.span);
    }

    /// Rules of a subroutine and of the function that a subroutine type is.
    pub(super) fn subroutine_rules(&mut self, function: &Function, return_type: &Type, params: &[ParamInfo]) {
        let lists = function.qualifiers.list.iter().filter_map(|q| match &q.kind {
            QualifierKind::Subroutine(types) => Some((types, q)),
            _ => None,
        });
        let lists: Vec<_> = lists.collect();
        if let Some((_, second)) = lists.get(1) {
            self.twice(second);
        }
        let Some((types, q)) = lists.first() else { return };
        let name = &function.name;
        if !types.is_empty() && function.body.is_none() {
            let why = message!("a subroutine has a body", "サブルーチンには本体が必要です");
            self.qualifier(q.span, why);
        }
        for ty in *types {
            let text = &ty.name;
            if !self.subroutines.contains(text) {
                if self.first_time(text) {
                    let message =
                        message!("there is no subroutine type `{text}`", "サブルーチン型 `{text}` はありません");
                    self.sink.error(errors::UNKNOWN_TYPE, ty.span, message, message!("unknown", "未知の型"));
                }
                continue;
            }
            let Some(wanted) = self.functions.get(text).and_then(|all| all.first()).copied() else { continue };
            let wanted = &self.out.functions[wanted.index()];
            let alike = wanted.return_type == *return_type
                && wanted.params.len() == params.len()
                && wanted.params.iter().zip(params).all(|(a, b)| a.ty == b.ty && a.direction == b.direction);
            let known = |t: &Type| !t.is_error();
            let own = &name.name;
            if !alike && known(return_type) && params.iter().all(|p| known(&p.ty)) {
                let message =
                    message!("`{own}` is no `{text}`: its types differ", "`{own}` の型は `{text}` と違います");
                self.sink.error(errors::FUNCTION, name.span, message, message!("this function", "この関数"));
            }
        }
    }

    /// `subroutine` stands before a function or a uniform.
    pub(super) fn subroutine_variable(&mut self, qualifiers: &Qualifiers) {
        let uniform = qualifiers.storage().is_some_and(|(s, _)| s == super::super::ast::StorageQualifier::Uniform);
        for q in qualifiers.list.iter().filter(|q| matches!(q.kind, QualifierKind::Subroutine(_)) && !uniform) {
            self.qualifier(
                q.span,
                message!("it belongs to functions and uniforms", "関数か uniform に付ける修飾子です"),
            );
        }
    }
}
