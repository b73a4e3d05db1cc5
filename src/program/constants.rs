//! Constant expressions of a shader, and which of them a literal of the module stands for: front ends fold them, and
//! what a module has is a number of binary32.

use std::collections::HashMap;
use std::sync::Arc;

use crate::glsl::Shader;
use crate::glsl::ast::ExprKind;
use crate::glsl::real::{Real, Reals};
use crate::glsl::types::ScalarType;
use crate::text::Span;

/// The number that an author means by a constant expression, or by a component of one.
#[derive(Clone, Debug)]
pub struct Constant {
    /// The expression in the author's text; the invocation where a macro made it.
    pub span: Span,
    /// True for a literal alone.
    pub is_literal: bool,
    real: Arc<Real>,
    component: usize,
}

impl Constant {
    /// The number, as near as binary64 comes to it.
    pub fn value(&self) -> f64 {
        self.real.values()[self.component]
    }

    /// How far from `value` a front end may be that folds the expression, where `value` is what one of them gives.
    pub fn spread(&self, value: f64) -> f64 {
        if self.is_literal { 0.0 } else { self.real.spread(self.component, value) }
    }
}

/// The constant expressions of a shader that are of `float`, operands before their users.
#[derive(Clone, Debug, Default)]
pub struct Constants {
    all: Vec<Constant>,
    by_span: HashMap<Span, Vec<usize>>,
}

impl Constants {
    /// Of a shader.
    pub(super) fn new(shader: &Shader) -> Self {
        let reals = Reals::new(shader, &|_, value| value);
        let mut constants = Self::default();
        for (id, expr) in shader.arena().iter() {
            let Some(real) = reals.get(id).filter(|real| real.ty().scalar() == Some(ScalarType::Float)) else {
                continue;
            };
            let is_literal = matches!(expr.kind, ExprKind::Literal(_));
            // The value of a name or in parentheses is that of another expression.
            if matches!(expr.kind, ExprKind::Name(_) | ExprKind::Paren(_)) {
                continue;
            }
            let real = Arc::new(real.clone());
            for component in 0..real.values().len() {
                let at = constants.all.len();
                constants.all.push(Constant { span: expr.span, is_literal, real: real.clone(), component });
                constants.by_span.entry(expr.span).or_default().push(at);
            }
        }
        constants
    }

    /// What a literal of the module stands for, which has this value and, where that is known, this place in the
    /// author's text.
    ///
    /// naga gives the calls of built-in functions no place, and what it makes of them that of another operand. Macros
    /// may be where they are defined. So where nothing with that value stands at the place, it is looked for within it
    /// and around it, and then anywhere.
    pub fn find(&self, span: Option<Span>, value: f32) -> Option<&Constant> {
        // A number with few digits is meant as it stands, wherever it comes from.
        let is_plain = value.to_bits() & 0xfff == 0;
        let value = f64::from(value);
        let fits = |constant: &&Constant| constant.real.is_near(constant.component, value);
        let here = |span: Span| {
            let all = self.by_span.get(&span).into_iter().flatten().map(|&at| &self.all[at]);
            nearest(all.filter(fits), value)
        };
        let touches = |a: Span, b: Span| a.start < b.end && b.start < a.end;
        let around = |span: Span| nearest(self.all.iter().filter(|c| touches(c.span, span)).filter(fits), value);
        let anywhere = || nearest(self.all.iter().filter(fits), value);
        let found = span.and_then(here);
        if is_plain {
            return found;
        }
        found.or_else(|| span.and_then(around)).or_else(anywhere)
    }
}

/// The constant nearest to a value; of several the last, which has the others as operands.
fn nearest<'c>(all: impl Iterator<Item = &'c Constant>, value: f64) -> Option<&'c Constant> {
    let distance = |constant: &Constant| (constant.value() - value).abs();
    all.fold(None, |best: Option<&Constant>, next| match best {
        Some(best) if distance(best) < distance(next) => Some(best),
        _ => Some(next),
    })
}
