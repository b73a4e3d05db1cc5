//! Arrays of samplers and images with a computed index, which naga has only as arrays of bindings: each call is made with
//! every texture that the index may choose.

use naga::{BinaryOperator as B, Expression};

use super::Result;
use super::function::{Fun, Val};
use super::texture::argument_of;
use syntax::ast::{ExprId, ExprKind};
use syntax::symbols::CallTarget;
use syntax::types::{ArraySize, ScalarType, Type};

/// Textures of an array that are told apart; of a longer one, or one as long as the host likes, some stand for all.
const MOST_TEXTURES: u32 = 16;
const SOME_TEXTURES: u32 = 4;

/// An index into an array of samplers that is computed.
#[derive(Clone, Copy, Debug)]
pub(super) struct ComputedIndex {
    at: ExprId,
    /// Textures among which it chooses.
    count: u32,
    /// Whether the array goes on with the same textures.
    repeats: bool,
}

impl Fun<'_, '_> {
    /// An index into an array of samplers that is not known now.
    pub(super) fn computed_index(&self, id: ExprId) -> Option<ComputedIndex> {
        match &self.shader.expr(id).kind {
            ExprKind::Index { base, index } => {
                if self.constant_index(*index).is_some() {
                    return self.computed_index(*base);
                }
                let count = match argument_of(self.build, *base)? {
                    Type::Array(_, ArraySize::Known(n)) => Some(n),
                    Type::Array(..) => None,
                    _ => return self.computed_index(*base),
                };
                let bound = count.filter(|n| *n <= MOST_TEXTURES);
                Some(ComputedIndex { at: *index, count: bound.unwrap_or(SOME_TEXTURES), repeats: bound.is_none() })
            }
            ExprKind::Field { base, .. } | ExprKind::Paren(base) => self.computed_index(*base),
            // `sampler2D(textures[i], linear)` of Vulkan.
            ExprKind::Call { args, .. }
                if matches!(self.shader.callee(id), Some(CallTarget::Constructor(Type::Opaque(_)))) =>
            {
                self.computed_index(*args.first()?)
            }
            _ => None,
        }
    }

    /// A call with each texture of an array, of which the index chooses one.
    pub(super) fn choose(
        &mut self,
        ty: &Type,
        ComputedIndex { at: index, count, repeats }: ComputedIndex,
        each: &mut dyn FnMut(&mut Self) -> Result<Option<Val>>,
    ) -> Result<Option<Val>> {
        let chosen = self.expression(index)?;
        let chosen = self.cast(chosen.clone(), chosen.ty.scalar().unwrap_or(ScalarType::Int), ScalarType::Uint)?;
        let chosen = match repeats {
            true => {
                let what = "an array of samplers with a computed index";
                self.build.stand_for(self.shader.expr(index).span, what, "use numbers as indices")?;
                let right = self.number(ScalarType::Uint, f64::from(count));
                self.add(Expression::Binary { op: B::Modulo, left: chosen.e, right })
            }
            false => chosen.e,
        };
        let result = if *ty == Type::Void { None } else { Some(self.local("sc_texel", ty)?) };
        for k in 0..count {
            let number = self.number(ScalarType::Uint, f64::from(k));
            let condition = self.add(Expression::Binary { op: B::Equal, left: chosen, right: number });
            let result = result.clone();
            self.branch(
                condition,
                |f| {
                    f.chosen.insert(index, k);
                    let value = each(f);
                    f.chosen.remove(&index);
                    match (result, value?) {
                        (Some(place), Some(value)) => f.store(&place, &value),
                        _ => Ok(()),
                    }
                },
                |_| Ok(()),
            )?;
        }
        result.map(|place| self.load(&place)).transpose()
    }
}
