//! Indices as sums of products: `z * plane + y * width + 4 * x`.

use syntax::Shader;
use syntax::ast::{BinaryOp, Callee, ExprId, ExprKind, UnaryOp};
use syntax::symbols::{CallTarget, SymbolId};
use syntax::types::Type;

use crate::numeric::bare;

/// A factor of a product.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Factor {
    /// Its text, without blanks and without a macro around it.
    pub text: String,
    /// The variable that it is, or of which it is a member or component.
    pub symbol: Option<SymbolId>,
    /// The factor as it stands there.
    pub id: ExprId,
}

/// A constant number times some factors.
#[derive(Clone, Debug, PartialEq)]
pub struct Product {
    /// The constant.
    pub times: f64,
    /// The factors.
    pub factors: Vec<Factor>,
}

impl Product {
    /// The only factor, where it is a variable or a part of one.
    pub fn only(&self) -> Option<&Factor> {
        match self.factors.as_slice() {
            [one] if one.symbol.is_some() => Some(one),
            _ => None,
        }
    }

    /// The other factors, where all of `part` are among these.
    pub fn without(&self, part: &[Factor]) -> Option<Vec<&Factor>> {
        let mut rest: Vec<&Factor> = self.factors.iter().collect();
        for factor in part {
            let at = rest.iter().position(|own| own.text == factor.text)?;
            rest.remove(at);
        }
        Some(rest)
    }
}

/// An expression without what leaves its number as it is: parentheses, a conversion between integers, and a macro of the
/// host around one operand, such as `psc(width)`.
pub fn plain(shader: &Shader, id: ExprId) -> ExprId {
    let id = bare(shader, id);
    match &shader.expr(id).kind {
        ExprKind::Call { callee, args } if args.len() == 1 => {
            let through = match (callee, shader.callee(id)) {
                (Callee::Name(_), None) => true,
                (_, Some(CallTarget::Constructor(ty))) => ty.is_scalar() && ty.scalar().is_some_and(|s| s.is_integer()),
                _ => false,
            };
            if through { plain(shader, args[0]) } else { id }
        }
        _ => id,
    }
}

/// A constant that the text states, and that no pipeline replaces.
fn constant(shader: &Shader, id: ExprId) -> Option<f64> {
    let number = shader.fold(id)?.as_f64()?;
    // Specialisation constants and `override` have a value that does not count.
    let fixed = syntax::walk::expressions(shader, id).into_iter().all(|part| match &shader.expr(part).kind {
        ExprKind::Name(_) => shader.symbol_of(part).is_some_and(|s| shader.symbol(s).value.is_some()),
        _ => true,
    });
    (fixed && number != 0.0).then_some(number)
}

/// An expression as one product.
pub fn product(shader: &Shader, id: ExprId) -> Product {
    let mut found = Product { times: 1.0, factors: Vec::new() };
    multiply(shader, id, &mut found);
    found.factors.sort();
    found
}

fn multiply(shader: &Shader, id: ExprId, into: &mut Product) {
    let id = plain(shader, id);
    if let Some(number) = constant(shader, id) {
        into.times *= number;
        return;
    }
    if let ExprKind::Binary { op, left, right, .. } = shader.expr(id).kind {
        let by = |id: ExprId| constant(shader, plain(shader, id));
        match (op, by(right)) {
            (BinaryOp::Mul, _) => {
                multiply(shader, left, into);
                return multiply(shader, right, into);
            }
            (BinaryOp::Div, Some(by)) => {
                into.times /= by;
                return multiply(shader, left, into);
            }
            (BinaryOp::Shl | BinaryOp::Shr, Some(by)) if (0.0..32.0).contains(&by) => {
                into.times *= if op == BinaryOp::Shl { by.exp2() } else { (-by).exp2() };
                return multiply(shader, left, into);
            }
            _ => {}
        }
    }
    let text = shader.text_of(id).split_whitespace().collect();
    into.factors.push(Factor { text, symbol: whole(shader, id), id });
}

/// The variable of a name, and of members and components by name.
fn whole(shader: &Shader, id: ExprId) -> Option<SymbolId> {
    match &shader.expr(id).kind {
        ExprKind::Name(_) => shader.symbol_of(id),
        ExprKind::Field { base, field: _ } => whole(shader, bare(shader, *base)),
        _ => None,
    }
}

/// An expression as a sum of products.
pub fn sum(shader: &Shader, id: ExprId) -> Vec<Product> {
    let id = plain(shader, id);
    match shader.expr(id).kind {
        ExprKind::Binary { op: BinaryOp::Add, left, right, .. } => {
            let mut all = sum(shader, left);
            all.extend(sum(shader, right));
            all
        }
        ExprKind::Binary { op: BinaryOp::Sub, left, right, .. } => {
            let mut all = sum(shader, left);
            all.extend(sum(shader, right).into_iter().map(|p| Product { times: -p.times, ..p }));
            all
        }
        ExprKind::Unary { op: UnaryOp::Plus, operand, .. } => sum(shader, operand),
        _ => vec![product(shader, id)],
    }
}

/// The sums of a shader that are no part of a longer one.
pub fn sums(shader: &Shader) -> Vec<ExprId> {
    let is_sum = |id: ExprId| {
        matches!(shader.expr(id).kind, ExprKind::Binary { op: BinaryOp::Add | BinaryOp::Sub, .. })
            && !shader.expr(id).from_macro
            && !matches!(shader.type_of(id).scalar(), Some(scalar) if !scalar.is_integer())
            && !matches!(shader.type_of(id), Type::Matrix(..))
    };
    let mut inner = vec![false; shader.arena().len()];
    for (id, expr) in shader.arena().iter() {
        if is_sum(id) {
            for child in expr.children() {
                inner[bare(shader, child).index()] = true;
            }
        }
    }
    shader.arena().iter().map(|(id, _)| id).filter(|&id| is_sum(id) && !inner[id.index()]).collect()
}
