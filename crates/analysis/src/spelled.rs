//! Spellings by which an expression of one shader is recognised in another.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use syntax::Shader;
use syntax::ast::{BinaryOp, ExprId, ExprKind, UnaryOp};
use syntax::symbols::{CallTarget, FunctionId, SymbolKind};
use syntax::types::{ScalarType, Type};

use crate::forms::Forms;

/// The spellings of an expression, with the values of local variables in their places.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Spelled {
    /// Two expressions with this spelling are computed by the same operations from inputs and uniforms of the same names.
    pub text: String,
    /// The same, but for the order in which products are taken: `a * (b * c)` and `(a * b) * c` are one.
    pub of_any_order: String,
    /// Whether something in it is rounded: what is only copied has the same bits everywhere.
    pub rounds: bool,
}

impl Spelled {
    /// Spells an expression; none where it has side effects, or a variable that is written more than once.
    pub fn of(shader: &Shader, forms: &Forms<'_>, id: ExprId) -> Option<Self> {
        let write = |any_order| {
            let (functions, text) = (BTreeSet::new(), String::new());
            let mut writer = Writer { shader, forms, any_order, functions, text, rounds: false };
            writer.write(id)?;
            Some((writer.text, writer.rounds))
        };
        let (text, rounds) = write(false)?;
        Some(Self { text, of_any_order: write(true)?.0, rounds })
    }
}

struct Writer<'s> {
    shader: &'s Shader,
    forms: &'s Forms<'s>,
    /// Functions whose bodies stand in the spelling already.
    functions: BTreeSet<FunctionId>,
    /// Whether a product of products is one of all their factors.
    any_order: bool,
    text: String,
    rounds: bool,
}

impl Writer<'_> {
    fn push(&mut self, text: &str) {
        self.text.push_str(text);
    }

    fn write(&mut self, id: ExprId) -> Option<()> {
        let id = self.forms.value(id);
        let shader = self.shader;
        if let Some(value) = shader.fold(id) {
            self.push(&value.to_string());
            return Some(());
        }
        match &shader.expr(id).kind {
            ExprKind::Name(name) => {
                let symbol = shader.symbol_of(id)?;
                let written = shader.uses_of(symbol).any(|u| u.access.writes());
                let symbol = shader.symbol(symbol);
                match symbol.kind {
                    _ if written => return None,
                    SymbolKind::Local => return None,
                    // What a block or the structure of inputs is called says nothing of what is in it.
                    SymbolKind::BlockInstance(_) => {}
                    SymbolKind::Param(_) if matches!(symbol.ty, Type::Struct(_)) => {}
                    SymbolKind::BlockMember(_) => self.push(&format!(".{name}")),
                    _ => self.push(name),
                }
            }
            ExprKind::Index { base, index } => {
                self.write(*base)?;
                self.all("[", &[*index], "]")?;
            }
            ExprKind::Field { base, field } => {
                self.write(*base)?;
                self.push(&format!(".{}", field.name));
            }
            ExprKind::Unary { op: UnaryOp::Increment | UnaryOp::Decrement, .. } => return None,
            ExprKind::Unary { op, op_span: _, operand } => self.all(op.text(), &[*operand], "")?,
            ExprKind::Binary { op: BinaryOp::Mul, .. } if self.any_order => {
                self.push("*");
                self.all("(", &self.factors(id), ")")?;
            }
            ExprKind::Binary { op, op_span: _, left, right } => {
                self.rounds |= matches!(op, BinaryOp::Add | BinaryOp::Sub | BinaryOp::Mul | BinaryOp::Div)
                    && shader.type_of(id).scalar().is_none_or(ScalarType::is_floating);
                self.push(op.text());
                self.all("(", &[*left, *right], ")")?;
            }
            ExprKind::Call { args, .. } => {
                match shader.callee(id)? {
                    CallTarget::Builtin(call) => {
                        self.rounds = true;
                        self.push(call.function.name());
                    }
                    CallTarget::Constructor(ty) => self.push(&ty.to_string()),
                    CallTarget::User(function) => self.function(*function)?,
                }
                self.all("(", args, ")")?;
            }
            ExprKind::Ternary { condition, yes, no } => self.all("?(", &[*condition, *yes, *no], ")")?,
            _ => return None,
        }
        Some(())
    }

    /// The factors of a product from left to right, those of its factors in their places.
    fn factors(&self, id: ExprId) -> Vec<ExprId> {
        let mut found = Vec::new();
        let mut pending = vec![id];
        while let Some(id) = pending.pop() {
            let id = self.forms.value(id);
            match self.shader.expr(id).kind {
                ExprKind::Binary { op: BinaryOp::Mul, op_span: _, left, right } => pending.extend([right, left]),
                _ => found.push(id),
            }
        }
        found
    }

    fn all(&mut self, before: &str, ids: &[ExprId], behind: &str) -> Option<()> {
        self.push(before);
        for id in ids {
            self.write(*id)?;
            self.push(",");
        }
        self.push(behind);
        Some(())
    }

    /// A function with its body, and with those of the functions that it calls.
    fn function(&mut self, id: FunctionId) -> Option<()> {
        let shader = self.shader;
        let function = shader.function_info(id);
        self.push(&function.name.name);
        if !self.functions.insert(id) {
            return Some(());
        }
        self.rounds = true;
        let span = shader.unit().items.get(function.definition?)?.span;
        for word in shader.file().slice(span).split_whitespace() {
            let _ = write!(self.text, " {word}");
        }
        let inside = shader.arena().iter().filter(|(_, e)| span.contains(e.span.start));
        let called = inside.filter_map(|(id, _)| match shader.callee(id) {
            Some(CallTarget::User(called)) => Some(*called),
            _ => None,
        });
        called.collect::<BTreeSet<_>>().into_iter().try_for_each(|called| self.function(called))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use base::text::SourceFile;
    use syntax::Stage;

    /// The spelling of what is assigned to `gl_Position`.
    fn spelled(text: &str) -> Option<Spelled> {
        let shader = Shader::parse(&SourceFile::new("a.vert", format!("#version 330\n{text}")), Stage::Vertex).shader;
        let forms = Forms::new(&shader);
        let value = shader.arena().iter().find_map(|(_, e)| match e.kind {
            ExprKind::Assign { target, value, .. } if shader.text_of(target) == "gl_Position" => Some(value),
            _ => None,
        });
        Spelled::of(&shader, &forms, value.unwrap())
    }

    #[test]
    fn names_of_locals_and_blocks_do_not_count() {
        let plain = spelled("in vec3 p; uniform C { mat4 m; }; void main() { gl_Position = m * vec4(p, 1.0); }");
        let other =
            "in vec3 p; uniform D { mat4 m; } d; void main() { vec4 q = vec4(p, 1.0); gl_Position = (d.m * q); }";
        assert_eq!(plain, spelled(other));
        assert!(plain.unwrap().rounds);
        let (a, b) = (
            spelled("in vec3 p; uniform mat4 m, n; void main() { gl_Position = m * n * vec4(p, 1.0); }").unwrap(),
            spelled("in vec3 p; uniform mat4 m, n; void main() { vec4 q = n * vec4(p, 1.0); gl_Position = m * q; }")
                .unwrap(),
        );
        assert_ne!(a.text, b.text);
        assert_eq!(a.of_any_order, b.of_any_order);
        let turned = "in vec3 p; uniform C { mat4 m; }; void main() { gl_Position = vec4(p, 1.0) * m; }";
        assert_ne!(spelled(other), spelled(turned));
    }

    #[test]
    fn functions_count_with_what_they_call() {
        let with = |one: &str| {
            let text = format!(
                "in vec3 p; float g() {{ return {one}; }} vec3 f(vec3 a) {{ return a * g(); }}\n\
                 void main() {{ gl_Position = vec4(f(p), 1.0); }}"
            );
            spelled(&text).unwrap()
        };
        assert_eq!(with("2.0"), with("2.0"));
        assert_ne!(with("2.0"), with("3.0"));
    }

    #[test]
    fn what_is_written_twice_has_no_spelling() {
        let text = "in vec3 p; void main() { vec3 q = p; q += p; gl_Position = vec4(q, 1.0); }";
        assert_eq!(spelled(text), None);
        let copied = spelled("in vec3 p; void main() { gl_Position = vec4(p, 1.0); }").unwrap();
        assert!(!copied.rounds, "{copied:?}");
    }
}
