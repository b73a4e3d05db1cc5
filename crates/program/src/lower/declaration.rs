//! Declarations of global variables, rewritten one declarator at a time.

use super::Lowering;
use base::text::{Edit, Span};
use base::value::Shape;
use syntax::interface;

impl Lowering<'_> {
    /// The shape of a variable; `None` with a refusal for what is no number, vector, matrix or array of them.
    pub(super) fn shape_of(&mut self, variable: &interface::Variable, kind: &str) -> Option<Shape> {
        let shape = variable.ty.shape();
        if shape.is_none() {
            self.refuse(variable.name_span, format!("{kind} `{}` of type `{}`", variable.name, variable.ty));
        }
        shape
    }

    /// False, with a refusal, when the declaration does not stand in the text as such.
    pub(super) fn is_editable(&mut self, variable: &interface::Variable) -> bool {
        let plain = self.slice(variable.name_span) == variable.name;
        if !plain {
            self.refuse(variable.name_span, format!("`{}` is declared through a macro", variable.name));
        }
        plain
    }

    /// Rewrites the declarators of one declaration, given in order: `head` for each one stands in
    /// place of the qualifiers, and each gets a declaration of its own. The type stays as written.
    pub(super) fn split(&mut self, variables: &[&interface::Variable], mut head: impl FnMut(usize) -> String) {
        let Some(first) = variables.first() else { return };
        let qualifiers = Span::new(first.declaration_span.start, first.type_span.start);
        let ty = self.slice(first.type_span).to_owned();
        self.edits.push(Edit::replace(qualifiers, head(0)));
        for (k, pair) in variables.windows(2).enumerate() {
            let between = Span::new(pair[0].declarator_span.end, pair[1].declarator_span.start);
            self.edits.push(Edit::replace(between, format!("; {}{ty} ", head(k + 1))));
        }
    }

    /// Removes the initialiser of a variable.
    pub(super) fn drop_initializer(&mut self, variable: &interface::Variable) {
        let end = variable.dims.iter().map(|d| d.span.end).fold(variable.name_span.end, usize::max);
        if variable.declarator_span.end > end {
            self.edits.push(Edit::delete(Span::new(end, variable.declarator_span.end)));
        }
    }
}

/// Groups variables by declaration, keeping the order of the text.
pub(super) fn by_declaration(variables: &[interface::Variable]) -> Vec<Vec<&interface::Variable>> {
    let mut groups: Vec<Vec<&interface::Variable>> = Vec::new();
    for variable in variables {
        match groups.last_mut() {
            Some(group) if group[0].item == variable.item => group.push(variable),
            _ => groups.push(vec![variable]),
        }
    }
    groups
}
