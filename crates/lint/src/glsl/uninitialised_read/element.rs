//! Elements by constant index, one by one: of arrays, which the flow of data takes as one, and of types that the host
//! declares.

use std::collections::{BTreeMap, BTreeSet};

use crate::rule::Findings;
use base::diagnostic::message;
use reading::ShaderFile;
use syntax::ast::{ExprId, ExprKind};
use syntax::symbols::{SymbolId, SymbolKind};
use syntax::types::Type;
use syntax::{Const, Shader, TokenPlace};

use super::super::variable::declarator;
use analysis::forms::Forms;

/// What happens to the elements of a variable.
#[derive(Default)]
struct Elements {
    read: BTreeMap<i64, ExprId>,
    written: BTreeSet<i64>,
}

/// The elements of local variables that are used by constant index alone.
fn elements(shader: &Shader) -> BTreeMap<SymbolId, Elements> {
    let forms = Forms::new(shader);
    let mut found: BTreeMap<SymbolId, Elements> = BTreeMap::new();
    let mut other = BTreeSet::new();
    for used in shader.uses() {
        let symbol = shader.symbol(used.symbol);
        if symbol.kind != SymbolKind::Local || !matches!(symbol.ty, Type::Array(..) | Type::Error) {
            continue;
        }
        let element = forms.parent(used.expr).and_then(|parent| match shader.expr(parent).kind {
            ExprKind::Index { base, index } if analysis::numeric::bare(shader, base) == used.expr => {
                Some((parent, shader.fold(index).and_then(Const::as_integer)?))
            }
            _ => None,
        });
        let Some((id, at)) = element else {
            other.insert(used.symbol);
            continue;
        };
        // A macro of the host may write what it gets.
        let passed = forms.parent(id).is_some_and(|call| {
            matches!(shader.expr(call).kind, ExprKind::Call { .. }) && shader.callee(call).is_none()
        });
        let own = found.entry(used.symbol).or_default();
        if used.access.writes() || passed {
            own.written.insert(at);
        } else {
            own.read.entry(at).or_insert(id);
        }
    }
    found.retain(|symbol, _| !other.contains(symbol));
    found
}

/// True where the name stands in a part of the text that a macro of the host switches on.
fn elsewhere(shader: &Shader, name: &str) -> bool {
    shader.tokens().iter().any(|t| t.place != TokenPlace::Text && shader.file().slice(t.span) == name)
}

/// Reports elements that are read and written nowhere, of variables that get their other elements one by one.
pub(super) fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let known: BTreeSet<SymbolId> = file.flow().unassigned.iter().map(|read| read.symbol).collect();
    for (symbol, own) in elements(shader) {
        let info = shader.symbol(symbol);
        let empty = declarator(file, symbol).is_some_and(|d| d.initializer.is_none());
        if !empty || own.written.is_empty() || known.contains(&symbol) || elsewhere(shader, &info.name) {
            continue;
        }
        for (at, read) in own.read.iter().filter(|(at, _)| !own.written.contains(at)) {
            let name = &info.name;
            let mut found = findings
                .at(
                    &file.file,
                    shader.expr(*read).span,
                    message!(
                        "`{name}[{at}]` is read, and nothing gives it a value",
                        "`{name}[{at}]` には値が入りません"
                    ),
                )
                .with_label(message!("no value here", "ここで値がない"))
                .with_why(message!(
                    "other elements of `{name}` are written one by one, and this one is not: its value is undefined",
                    "`{name}` の他の要素は一つずつ書き込まれていますが、この要素は書き込まれず、値は未定義です"
                ))
                .with_help(message!("give `{name}[{at}]` a value", "`{name}[{at}]` に値を入れてください"));
            if let Some(span) = info.span {
                found = found.with_related(&file.file, span, message!("declared without a value", "値のない宣言"));
            }
            findings.push(found);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::testing::messages;

    fn reported(body: &str) -> Vec<String> {
        let text = format!(
            "#version 150 core\nin vec4 q;\nuniform int n;\nout vec4 c;\nvoid set(out float x) {{ x = q.x; }}\n\
             void main(void)\n{{\n  c = q;\n  {body}\n  gl_Position = q;\n}}\n"
        );
        messages("D001", "a.vert", &text)
    }

    #[test]
    fn elements_that_nothing_writes_are_reported() {
        let said = |name: &str| [format!("`{name}` is read, and nothing gives it a value")];
        assert_eq!(reported("float f[3]; f[0] = 1.0; f[2] = 2.0; c.x = f[0] + f[1] + f[2];"), said("f[1]"));
        assert_eq!(reported("vec2 f[2]; f[0].x = 1.0; c.xy = f[0] + f[1];"), said("f[1]"));
    }

    #[test]
    fn elements_with_a_value_are_not() {
        for body in [
            "float f[2]; f[0] = 1.0; f[1] = 2.0; c.x = f[0] + f[1];",
            "float f[2]; f[0] = 1.0; f[n] = 2.0; c.x = f[1];",
            "float f[2]; f[0] = 1.0; set(f[1]); c.x = f[0] + f[1];",
            "float f[2] = float[](1.0, 2.0); f[0] = 1.0; c.x = f[0] + f[1];",
            "float f[2]; f[0] = 1.0;\n#ifdef A\n  f[1] = 2.0;\n#endif\n  c.x = f[1];",
        ] {
            assert_eq!(reported(body), [""; 0], "{body}");
        }
    }
}
