//! Constant expressions of a shader, and which of them a literal of the module stands for: front ends fold them, and
//! what a module has is a number of binary32.

use std::collections::HashMap;
use std::sync::Arc;

use base::text::Span;
use syntax::Shader;
use syntax::ast::{ExprId, ExprKind};
use syntax::real::{Real, Reals};
use syntax::types::ScalarType;

/// The number that an author means by a constant expression, or by a component of one.
#[derive(Clone, Debug)]
pub struct Constant {
    /// The expression in the author's text; the invocation where a macro made it.
    pub span: Span,
    /// True for a literal alone.
    pub is_literal: bool,
    id: ExprId,
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

/// A literal of `float` as it is written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WrittenLiteral {
    /// Its place in the author's text, in the definition of a macro if it comes from there.
    pub span: Span,
    /// Its digits as a number.
    pub value: f64,
}

/// The constant expressions of a shader that are of `float`, operands before their users.
#[derive(Clone, Debug, Default)]
pub struct Constants {
    shader: Option<Arc<Shader>>,
    all: Vec<Constant>,
    by_span: HashMap<Span, Vec<usize>>,
    /// The shader holds the constants of the text and is not the text.
    moved: bool,
}

impl Constants {
    /// With the places of the author's text, where the shader is a text that was made of it.
    pub(crate) fn moved(mut self, author: &dyn Fn(Span) -> Span) -> Self {
        (self.by_span, self.moved) = (HashMap::new(), true);
        for (at, constant) in self.all.iter_mut().enumerate() {
            constant.span = author(constant.span);
            self.by_span.entry(constant.span).or_default().push(at);
        }
        self
    }

    /// Of a shader.
    pub(crate) fn new(shader: Arc<Shader>) -> Self {
        let reals = Reals::new(&shader, &|_, value| value);
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
                constants.all.push(Constant { id, span: expr.span, is_literal, real: real.clone(), component });
                constants.by_span.entry(expr.span).or_default().push(at);
            }
        }
        Self { shader: Some(shader), ..constants }
    }

    /// The shader in GLSL, where there is one.
    pub(super) fn glsl(&self) -> Option<&Shader> {
        self.shader.as_deref().filter(|shader| shader.wgsl().is_none() && !self.moved)
    }

    /// The shader in WGSL, where there is one.
    pub(super) fn wgsl(&self) -> Option<&Shader> {
        self.shader.as_deref().filter(|shader| shader.wgsl().is_some())
    }

    /// Whole numbers that a host may set (`constant_id`), with the values that are written.
    pub fn specialized(&self) -> Vec<(String, u32)> {
        let Some(shader) = &self.shader else { return Vec::new() };
        let constants = shader.interface().constants.iter();
        let constants = constants.filter(|c| c.is_specialized());
        let value = |c: &syntax::interface::Variable| shader.fold(c.initializer?)?.as_integer();
        constants.filter_map(|c| Some((c.name.clone(), u32::try_from(value(c)?).ok()?))).collect()
    }

    /// Every literal once, in the order of the text.
    pub fn literals(&self) -> Vec<WrittenLiteral> {
        let Some(shader) = &self.shader else { return Vec::new() };
        let mut all: Vec<WrittenLiteral> = Vec::new();
        for constant in self.all.iter().filter(|constant| constant.is_literal) {
            let value = constant.value();
            // What a macro is given stands where it is used.
            let from_macro = shader.expr(constant.id).from_macro && !is_number(shader, constant.span, value);
            let defined =
                || shader.tokens().iter().map(|token| token.span).find(|&span| self.defines(shader, span, value));
            let span = if from_macro { defined().unwrap_or(constant.span) } else { constant.span };
            let literal = WrittenLiteral { span, value };
            if !all.contains(&literal) {
                all.push(literal);
            }
        }
        all.sort_by_key(|literal| literal.span);
        all
    }

    /// True for a token of a directive that is this number.
    fn defines(&self, shader: &Shader, span: Span, value: f64) -> bool {
        is_number(shader, span, value) && !self.by_span.contains_key(&span)
    }

    /// The constants where literals are meant to be other numbers than they are written: their places in the order of
    /// [`Constants::find`], with their values.
    pub fn meant(&self, literal: &dyn Fn(f64) -> f64) -> Vec<f64> {
        let Some(shader) = &self.shader else { return Vec::new() };
        let reals = Reals::new(shader, &|_, value| literal(value));
        let value = |c: &Constant| reals.get(c.id).and_then(|real| real.values().get(c.component).copied());
        self.all.iter().map(|constant| value(constant).unwrap_or_else(|| constant.value())).collect()
    }

    /// What a literal of the module stands for, which has this value and, where that is known, this place in the
    /// author's text; with its place among all constants.
    ///
    /// A macro may be where it is defined, and a passage of naga may give what it folds the place of an operand. So where nothing with that value stands at the place, it is looked for within it
    /// and around it, and then anywhere.
    pub fn find(&self, span: Option<Span>, value: f32) -> Option<(usize, &Constant)> {
        // A number with few digits is meant as it stands, wherever it comes from.
        let is_plain = value.to_bits() & 0xfff == 0;
        let value = f64::from(value);
        let fits = |at: &usize| {
            let constant = &self.all[*at];
            constant.real.is_near(constant.component, value)
        };
        let nearest = |all: &mut dyn Iterator<Item = usize>| self.nearest(all, value);
        let here = |span: Span| nearest(&mut self.by_span.get(&span).into_iter().flatten().copied().filter(fits));
        let touches = |a: Span, b: Span| a.start < b.end && b.start < a.end;
        let places = 0..self.all.len();
        let around = |span| nearest(&mut places.clone().filter(|&at| touches(self.all[at].span, span)).filter(fits));
        let anywhere = || nearest(&mut places.clone().filter(fits));
        let found = span.and_then(here);
        if is_plain {
            return found;
        }
        found.or_else(|| span.and_then(around)).or_else(anywhere)
    }

    /// The constant nearest to a value; of several the last, which has the others as operands. Of components of one vector
    /// that are as near, nothing tells which is meant: it is the one about which front ends differ most.
    fn nearest(&self, all: &mut dyn Iterator<Item = usize>, value: f64) -> Option<(usize, &Constant)> {
        let distance = |at: usize| (self.all[at].value() - value).abs();
        let is_surer = |a: usize, b: usize| {
            self.all[a].id == self.all[b].id && self.all[a].spread(value) < self.all[b].spread(value)
        };
        let is_better = |a: usize, b: usize| distance(a) < distance(b) || distance(a) <= distance(b) && is_surer(b, a);
        let best = all.reduce(|best, next| if is_better(best, next) { best } else { next })?;
        Some((best, &self.all[best]))
    }
}

/// True for a text that is this number.
fn is_number(shader: &Shader, span: Span, value: f64) -> bool {
    let digits = shader.file().slice(span).trim_end_matches(['f', 'F']);
    digits.starts_with(|c: char| c.is_ascii_digit() || c == '.') && digits.parse() == Ok(value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use base::text::SourceFile;
    use syntax::Stage;

    #[test]
    fn of_equal_components_the_one_that_is_open_counts() {
        // 0.5 and a little, which rounding makes a tie, beside what is 1 for everyone.
        let text = "#version 450\nvec2 f() { return round(smoothstep(vec2(-abs(atan(1e-6, 100.0)) - 0.5, 0.0), \
                    vec2(2.5, 1.0), vec2(1.0))); }\n";
        let shader = Shader::parse(&SourceFile::new("a.glsl", text), Stage::Library).shader;
        let constants = Constants::new(Arc::new(shader));
        let start = text.find("round").unwrap();
        let span = Span::new(start, text.rfind("; }").unwrap());
        let (_, constant) = constants.find(Some(span), 1.0).unwrap();
        assert!(constant.spread(1.0) >= 1.0, "{constant:?}");
    }
}
