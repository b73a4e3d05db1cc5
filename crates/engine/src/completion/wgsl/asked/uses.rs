//! The uses of names and of what variables hold.

use syntax::ast::{ExprId, ExprKind, Literal};
use syntax::wgsl::ModuleItem;

use super::super::super::search::is_swizzle;
use super::{Around, Asked};

/// Uses that are followed through variables at most.
const MOST_USES: usize = 256;

impl Asked<'_> {
    /// Places of the variable that is named at a place.
    pub(super) fn of_variable(&self, place: usize) -> Vec<ExprId> {
        let symbols = self.shader.symbols();
        let symbol = symbols.filter(|(_, own)| own.span.is_some_and(|span| span.start == place)).last();
        let Some((symbol, _)) = symbol else { return Vec::new() };
        let all = self.shader.arena().iter().map(|(id, _)| id);
        all.filter(|own| self.shader.symbol_of(*own) == Some(symbol)).collect()
    }

    /// Types that several uses ask for, the likeliest first.
    pub(super) fn of_uses(&self, uses: Vec<ExprId>, depth: u32) -> Vec<String> {
        let mut scores: Vec<(String, f64)> = Vec::new();
        for id in uses {
            let found = self.expected(id, depth);
            for (rank, ty) in found.into_iter().filter(|ty| !ty.is_empty() && ty != "void").enumerate() {
                let weight = 1.0 / (1.0 + f64::from(u32::try_from(rank).unwrap_or(u32::MAX)));
                match scores.iter_mut().find(|(known, _)| *known == ty) {
                    Some((_, score)) => *score += weight,
                    None => scores.push((ty, weight)),
                }
            }
        }
        scores.sort_by(|a, b| b.1.total_cmp(&a.1));
        scores.into_iter().map(|(ty, _)| ty).collect()
    }

    /// Places of a name.
    pub(super) fn uses(&self, name: &str) -> Vec<ExprId> {
        let is = |kind: &ExprKind| matches!(kind, ExprKind::Name(own) if own == name);
        self.shader.arena().iter().filter(|(_, expr)| is(&expr.kind)).map(|(id, _)| id).collect()
    }

    /// Members that are asked of expressions and are no components, and whether elements are.
    pub(super) fn parts(&self, uses: &[ExprId]) -> (Vec<String>, bool) {
        let (mut members, mut indexed) = (Vec::new(), false);
        for id in uses {
            let Some(parent) = self.parents.get(id) else {
                // What a variable holds is used where that is.
                if let Some(Around::Variable(place)) = self.around.get(id) {
                    members.extend(self.parts(&self.of_variable(*place)).0);
                }
                continue;
            };
            match &self.shader.expr(*parent).kind {
                ExprKind::Field { field, .. } if is_swizzle(&field.name) => {}
                ExprKind::Field { field, .. } => members.push(field.name.clone()),
                ExprKind::Index { base, .. } if base == id => {
                    indexed = true;
                    members.extend(self.parts(&[*parent]).0);
                }
                _ => {}
            }
        }
        (members, indexed)
    }

    /// The uses, and those of variables that hold what they give.
    pub(super) fn through(&self, uses: Vec<ExprId>) -> Vec<ExprId> {
        let (mut found, mut at) = (uses, 0);
        while let Some(&id) = found.get(at) {
            if let Some(Around::Variable(place)) = self.around.get(&id)
                && found.len() < MOST_USES
            {
                let more = self.of_variable(*place).into_iter().filter(|one| !found.contains(one));
                found.extend(more.collect::<Vec<_>>());
            }
            at += 1;
        }
        found
    }

    /// True where elements are asked for by numbers up to 3, and by nothing else.
    pub(super) fn are_components(&self, uses: &[ExprId]) -> bool {
        let number = |id: &ExprId| {
            let ExprKind::Index { base, index } = self.shader.expr(*self.parents.get(id)?).kind else { return None };
            let number = match self.shader.expr(index).kind {
                ExprKind::Literal(Literal::Int(number)) => i64::from(number),
                ExprKind::Literal(Literal::Uint(number)) => i64::from(number),
                _ => i64::MAX,
            };
            (base == *id).then_some(number)
        };
        let mut asked = uses.iter().filter_map(number).peekable();
        asked.peek().is_some() && asked.all(|number| (0..4).contains(&number))
    }

    /// Structures of the text that have all of these members.
    pub(super) fn structures(&self, members: &[String]) -> Vec<String> {
        let items = self.shader.wgsl().map(|module| module.items.as_slice()).unwrap_or_default();
        let has = |item: &ModuleItem| match item {
            ModuleItem::Struct { name, members: own } => members
                .iter()
                .all(|wanted| own.iter().any(|member| member.name.name == *wanted))
                .then(|| name.name.clone()),
            _ => None,
        };
        items.iter().filter_map(has).collect()
    }
}
