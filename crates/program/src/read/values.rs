//! Values of `override` constants (WGSL, 7.2.2).

use std::num::NonZeroU32;

use naga::{ArraySize, BinaryOperator, Expression, Handle, Literal, Module, ScalarKind, ShaderStage, Type, TypeInner};

use super::ModuleText;
use crate::front::{INCOMPLETE, VALIDATOR};
use crate::{ProgramError, contain, validate};
use base::did_you_mean;
use base::text::Span;

impl ModuleText {
    /// Names of its `override` constants without a value, each with a plain one.
    pub fn valueless(&self) -> Vec<(String, &'static str)> {
        let open = self.module.overrides.iter().filter(|(_, constant)| constant.init.is_none());
        let plain = |ty: Handle<Type>| match self.module.types[ty].inner.scalar_kind() {
            Some(ScalarKind::Bool) => "true",
            Some(ScalarKind::Sint | ScalarKind::Uint) => "64",
            _ => "1",
        };
        // Along several axes of a workgroup, 64 each are too many invocations.
        let axes: Vec<Handle<naga::Override>> = self.module.entry_points.iter().flat_map(|p| self.axes(p)).collect();
        let value = |handle, constant: &naga::Override| if axes.contains(&handle) { "8" } else { plain(constant.ty) };
        open.filter_map(|(handle, constant)| Some((constant.name.clone()?, value(handle, constant)))).collect()
    }

    /// The constants that are sizes of a workgroup, where there are several.
    fn axes(&self, point: &naga::EntryPoint) -> Vec<Handle<naga::Override>> {
        let of = |size: Handle<Expression>| match self.module.global_expressions[size] {
            Expression::Override(constant) => Some(constant),
            _ => None,
        };
        let all: Vec<_> = point.workgroup_size_overrides.iter().flatten().flatten().copied().filter_map(of).collect();
        if all.len() > 1 { all } else { Vec::new() }
    }

    /// Puts values in the place of the constants that are used: those of `values` by name or by the number of `@id`,
    /// else those of the text.
    ///
    /// # Errors
    /// A constant without a value, a value that is no number, and a name that the text does not declare.
    pub(super) fn with_values(&self, module: Module, values: &[(String, String)]) -> Result<Module, ProgramError> {
        let known = self.overrides();
        for (name, _) in values {
            let number = name.parse::<u16>().ok();
            let declared = self.module.overrides.iter().any(|(_, constant)| {
                constant.name.as_deref() == Some(name) || (constant.id.is_some() && constant.id == number)
            });
            if !declared {
                let hint = match known.is_empty() {
                    true => "the file declares none".to_owned(),
                    false => did_you_mean(name, known.iter().map(|(name, _)| name.as_str()), "there are:"),
                };
                let message = format!("there is no `override` constant `{name}`");
                return Err(self.error(INCOMPLETE, Span::at(0), message, &hint));
            }
        }
        if module.overrides.is_empty() {
            return Ok(module);
        }
        let place = |name: &str| known.iter().find(|(known, _)| known == name).map_or(Span::at(0), |(_, span)| *span);
        let mut given = naga::back::PipelineConstants::default();
        for (_, constant) in module.overrides.iter() {
            let name = constant.name.as_deref().unwrap_or("a constant");
            let number = constant.id.map(|id| id.to_string());
            let value = values.iter().find(|(key, _)| key == name || Some(key) == number.as_ref());
            let Some((_, text)) = value else {
                if constant.init.is_none() {
                    let message = format!("`{name}` is an `override` constant without a value");
                    let help = format!(
                        "state one: `defines = {{ {name} = [\"1\"] }}` in a suite, `--define {name}=1` on the command line"
                    );
                    return Err(self.error(INCOMPLETE, place(name), message, &help));
                }
                continue;
            };
            let kind = module.types[constant.ty].inner.scalar_kind().unwrap_or(ScalarKind::Float);
            let Some(value) = number_of(text, kind) else {
                let wanted = if kind == ScalarKind::Bool { "`true` or `false`" } else { "a number" };
                let message = format!("`{name}` cannot be `{text}`");
                return Err(self.error(INCOMPLETE, place(name), message, &format!("give {wanted}")));
            };
            given.insert(number.unwrap_or_else(|| name.to_owned()), value);
        }
        let mut module = module;
        size_arrays(&mut module, &given);
        let point = module.entry_points.first().map(|point| (point.stage, point.name.clone()));
        let (stage, name) = point.unwrap_or((ShaderStage::Compute, String::new()));
        let info = validate(&module)?;
        let made = contain(|| {
            let made = naga::back::pipeline_constants::process_overrides(&module, &info, Some((stage, &name)), &given);
            made.map(|(module, _)| module.into_owned()).map_err(|error| error.to_string())
        });
        made.map_err(|panic| ProgramError::internal(format!("naga panicked: {panic}")))?.map_err(|error| {
            let first = module.overrides.iter().next().and_then(|(_, constant)| constant.name.clone());
            let span = first.map_or(Span::at(0), |name| place(&name));
            self.error(
                VALIDATOR,
                span,
                format!("the values of `override` constants do not fit: {error}"),
                "choose others",
            )
        })
    }
}

/// Gives arrays of the memory of a workgroup the lengths that constants say. Where one cannot be told, its array stays as
/// it is.
fn size_arrays(module: &mut Module, given: &naga::back::PipelineConstants) {
    let pending = module.types.iter().filter_map(|(handle, ty)| match ty.inner {
        TypeInner::Array { base, size: ArraySize::Pending(constant), stride } => Some((handle, base, constant, stride)),
        _ => None,
    });
    for (handle, base, constant, stride) in pending.collect::<Vec<_>>() {
        let len = whole(module, given, Expression::Override(constant));
        let Some(len) = len.and_then(|len| u32::try_from(len).ok()).and_then(NonZeroU32::new) else { continue };
        let inner = TypeInner::Array { base, size: ArraySize::Constant(len), stride };
        // Equal types have one place, and this one keeps its own.
        let name = Some(format!("array_of_{}", handle.index()));
        module.types.replace(handle, Type { name, inner });
    }
}

/// The whole number that a constant expression is, with the values that a host gives.
fn whole(module: &Module, given: &naga::back::PipelineConstants, of: Expression) -> Option<i64> {
    let at = |handle: Handle<Expression>| whole(module, given, module.global_expressions[handle].clone());
    match of {
        Expression::Literal(Literal::U32(value)) => Some(value.into()),
        Expression::Literal(Literal::I32(value)) => Some(value.into()),
        Expression::Literal(Literal::AbstractInt(value)) => Some(value),
        Expression::Constant(constant) => at(module.constants[constant].init),
        Expression::Override(constant) => {
            let constant = &module.overrides[constant];
            let key = constant.id.map(|id| id.to_string()).or_else(|| constant.name.clone());
            match key.and_then(|key| given.get(&key)) {
                Some(value) => Some(*value as i64),
                None => at(constant.init?),
            }
        }
        Expression::As { expr, kind: ScalarKind::Sint | ScalarKind::Uint, .. } => at(expr),
        Expression::Binary { op, left, right } => {
            let (left, right) = (at(left)?, at(right)?);
            match op {
                BinaryOperator::Add => left.checked_add(right),
                BinaryOperator::Subtract => left.checked_sub(right),
                BinaryOperator::Multiply => left.checked_mul(right),
                BinaryOperator::Divide => left.checked_div(right),
                BinaryOperator::Modulo => left.checked_rem(right),
                BinaryOperator::ShiftLeft => left.checked_shl(right.try_into().ok()?),
                BinaryOperator::ShiftRight => left.checked_shr(right.try_into().ok()?),
                _ => None,
            }
        }
        _ => None,
    }
}

/// A value as a host gives it: all numbers are binary64 there.
fn number_of(text: &str, kind: ScalarKind) -> Option<f64> {
    let text = text.trim();
    match (text, kind) {
        ("true", _) => Some(1.0),
        ("false", _) => Some(0.0),
        (_, ScalarKind::Float) => text.trim_end_matches(['f', 'h']).parse().ok(),
        _ => {
            let digits = text.trim_end_matches(['u', 'i']);
            let hex = digits.strip_prefix("0x").or(digits.strip_prefix("0X"));
            let whole = hex.map_or_else(|| digits.parse::<i64>().ok(), |hex| i64::from_str_radix(hex, 16).ok());
            whole.map(|value| value as f64)
        }
    }
    .filter(|value: &f64| value.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_numbers_of_their_kind() {
        assert_eq!(number_of("2.5f", ScalarKind::Float), Some(2.5));
        assert_eq!(number_of("0x10u", ScalarKind::Uint), Some(16.0));
        assert_eq!(number_of("true", ScalarKind::Bool), Some(1.0));
        assert_eq!(number_of("2.5", ScalarKind::Sint), None);
        assert_eq!(number_of("inf", ScalarKind::Float), None);
        assert_eq!(number_of("wide", ScalarKind::Float), None);
    }
}
