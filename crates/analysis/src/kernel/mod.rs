//! Compute kernels as their work groups run them: every invocation of one group at a time, statement by statement, with
//! the numbers that follow from the place of an invocation in the group. What follows from data is not known, and both
//! ways of a condition on it are walked.

mod bound;
mod builtins;
mod eval;
mod guard;
mod shared;
mod split;
mod sum;
mod value;
mod walk;

pub use bound::{Bound, bounds};
pub use guard::{indexed_arrays, unguarded_store};
pub use shared::{Beyond, Kind, Race};
pub use split::{Split, Splits};
pub use sum::{Factor, Product, plain, product, sum, sums};

use std::collections::{BTreeMap, BTreeSet};

use syntax::ast::{Block, ExprId};
use syntax::symbols::{FunctionId, SymbolId};
use syntax::{Shader, Stage};

use crate::entry;

/// Invocations of a work group that are followed.
const MOST_LANES: u32 = 1024;

/// Invocations in each direction of a group whose size the text does not state.
const ASSUMED: [u32; 3] = [64, 1, 1];

/// An entry point of a kernel.
pub struct Kernel {
    /// Its function.
    pub function: FunctionId,
    /// The size of its work groups, as far as the text states it.
    pub size: Option<[u32; 3]>,
    /// Parameters and members of parameters with built-in values: of WGSL alone.
    inputs: Vec<(SymbolId, Option<String>, String)>,
}

impl Kernel {
    /// Invocations of a work group, as far as the text states its size.
    pub fn invocations(&self) -> Option<u64> {
        self.size.map(|size| size.iter().fold(1_u64, |all, n| all.saturating_mul(u64::from(*n))))
    }

    /// The axis of a built-in value that an expression is, by the names of the value in WGSL and in GLSL.
    pub fn axis_of(&self, shader: &Shader, id: ExprId, wgsl: &str, glsl: &str) -> Option<usize> {
        use syntax::ast::ExprKind;
        let ExprKind::Field { base, field } = &shader.expr(id).kind else { return None };
        let axis = ["x", "y", "z"].iter().position(|axis| *axis == field.name)?;
        let (symbol, members) = entry::root(shader, *base)?;
        let is = |(own, member, name): &(SymbolId, Option<String>, String)| {
            *own == symbol && member.as_deref() == members.first().copied() && name == wgsl
        };
        (self.inputs.iter().any(is) || shader.builtin(glsl) == Some(symbol)).then_some(axis)
    }
}

/// The kernels of a shader.
pub fn kernels(shader: &Shader) -> Vec<Kernel> {
    if let Some(module) = shader.wgsl() {
        let compute = module.entry_points.iter().filter(|e| e.stage == Stage::Compute);
        return compute
            .map(|entry| {
                let inputs = entry::inputs(shader, module, entry.item);
                let inputs = inputs.iter().filter_map(|i| {
                    let name = entry::builtin_value(shader, i.attributes)?;
                    Some((i.param, i.member.map(str::to_owned), name.to_owned()))
                });
                Kernel { function: entry.function, size: entry.workgroup, inputs: inputs.collect() }
            })
            .collect();
    }
    let main = shader.functions().find(|(_, f)| f.name.name == "main" && f.definition.is_some());
    let main = main.filter(|_| shader.stage() == Stage::Compute);
    main.map(|(function, _)| Kernel { function, size: shader.workgroup_size(), inputs: Vec::new() })
        .into_iter()
        .collect()
}

/// The body of a function.
fn body(shader: &Shader, function: FunctionId) -> Option<&Block> {
    shader.function_syntax(shader.function_info(function))?.body.as_ref()
}

/// Accesses to shared memory in the kernels of a shader that meet in one element with no barrier between them: the first
/// of each variable and kind.
pub fn races(shader: &Shader) -> Vec<Race> {
    let mut found = BTreeSet::new();
    for kernel in kernels(shader) {
        let size = kernel.size.unwrap_or(ASSUMED);
        let in_group =
            |group| walk::Walk::run_in(shader, &kernel, size, group).map(|walk| walk.found).unwrap_or_default();
        let any = in_group(None);
        if any.is_empty() {
            continue;
        }
        // What any work group does, the first or the second one does. There, conditions on the place in the dispatch are known.
        let is_known = |race: &Race| {
            let places = |race: &Race| (race.symbol, race.later, race.earlier);
            any.iter().any(|own| places(own) == places(race))
        };
        found.extend([0, 1].into_iter().flat_map(|group| in_group(Some(group))).filter(is_known));
    }
    let mut first: BTreeMap<(SymbolId, bool), Race> = BTreeMap::new();
    for race in found {
        let key = (race.symbol, race.kind == Kind::Write);
        // One with a witness says more.
        match first.get(&key) {
            Some(old) if old.witness.is_some() || race.witness.is_none() => {}
            _ => {
                first.insert(key, race);
            }
        }
    }
    first.into_values().collect()
}

/// Accesses of a kernel to shared memory whose index is shown to be past the end of an array: the first of each place.
pub fn beyond(shader: &Shader, kernel: &Kernel) -> Vec<Beyond> {
    let walk = kernel.size.and_then(|size| walk::Walk::run(shader, kernel, size));
    walk.map(|walk| walk.beyond.into_values().collect()).unwrap_or_default()
}

/// What is known of the conditions of a kernel; nothing where the size of its work groups is not stated.
pub fn splits(shader: &Shader, kernel: &Kernel) -> Splits {
    let walk = kernel.size.and_then(|size| walk::Walk::run(shader, kernel, size));
    walk.map(|walk| walk.splits).unwrap_or_default()
}

/// The variable of an expression and the indices and members on the way to its part.
fn place(shader: &Shader, id: ExprId) -> Option<(SymbolId, Vec<Part>)> {
    use syntax::ast::ExprKind;
    match &shader.expr(id).kind {
        ExprKind::Name(_) => Some((shader.symbol_of(id)?, Vec::new())),
        ExprKind::Paren(inner) => place(shader, *inner),
        ExprKind::Index { base, index } => {
            let (symbol, mut parts) = place(shader, *base)?;
            parts.push(Part::Index(*index));
            Some((symbol, parts))
        }
        ExprKind::Field { base, field } => {
            let (symbol, mut parts) = place(shader, *base)?;
            parts.push(Part::Member(field.name.clone()));
            Some((symbol, parts))
        }
        _ => None,
    }
}

/// A step on the way to a part, as written.
enum Part {
    Index(ExprId),
    Member(String),
}
