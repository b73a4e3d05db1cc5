//! The part of the paths through a function on which it is open whether a variable has a value.
//!
//! Most variables get their value where they are declared or passed. Nothing is to be found out about them, and with every
//! call of a function there is another copy of each: without them, definite assignment stays small.

use syntax::Shader;
use syntax::symbols::SymbolKind;

use super::graph::{Block, Event, Graph, Kind, Store, Variable};

impl Graph {
    /// The same paths without the variables of functions that have a value wherever they exist. A copy of one of these is
    /// a write.
    pub fn open(&self, shader: &Shader) -> Self {
        let local = |v: &Variable| matches!(shader.symbol(v.symbol).kind, SymbolKind::Local | SymbolKind::Param(_));
        let settled: Vec<bool> = settled(self).into_iter().zip(&self.variables).map(|(s, v)| s && local(v)).collect();
        let mut place = vec![0; self.variables.len()];
        let mut variables: Vec<Variable> = Vec::new();
        for (index, variable) in self.variables.iter().enumerate().filter(|(index, _)| !settled[*index]) {
            place[index] = variables.len();
            variables.push(*variable);
        }
        let event = |event: &Event| {
            let kind = match event.kind {
                // These are about no variable.
                Kind::Emit | Kind::EndPrimitive | Kind::NoReturn { .. } => {
                    return Some(Event { variable: 0, ..*event });
                }
                _ if settled[event.variable] => return None,
                Kind::Copy { from } if settled[from] => Kind::Write { exact: true, store: Store::Passed },
                Kind::Copy { from } => Kind::Copy { from: place[from] },
                kind @ (Kind::Declare | Kind::Read { .. } | Kind::Write { .. }) => kind,
            };
            Some(Event { kind, variable: place[event.variable], ..*event })
        };
        let block =
            |block: &Block| Block { events: block.events.iter().filter_map(event).collect(), next: block.next.clone() };
        let blocks = self.blocks.iter().map(block).collect();
        Self { blocks, exit: self.exit, variables, functions: self.functions.clone() }
    }
}

/// The variables that get all of their components in the block of their declaration before anything else happens to them,
/// and those that are never declared here and begin with a write: parameters.
fn settled(graph: &Graph) -> Vec<bool> {
    let mut settled: Vec<Option<bool>> = vec![None; graph.variables.len()];
    for block in &graph.blocks {
        let mut pending: Vec<usize> = Vec::new();
        for event in &block.events {
            let variable = event.variable;
            match event.kind {
                Kind::Emit | Kind::EndPrimitive | Kind::NoReturn { .. } => {}
                Kind::Declare => pending.push(variable),
                Kind::Write { .. } if event.mask == graph.variables[variable].full => {
                    pending.retain(|p| *p != variable);
                    settled[variable] = settled[variable].or(Some(true));
                }
                Kind::Write { .. } | Kind::Read { .. } => {
                    if pending.contains(&variable) || settled[variable].is_none() {
                        settled[variable] = Some(false);
                    }
                }
                Kind::Copy { from } => {
                    for variable in [variable, from] {
                        if pending.contains(&variable) || settled[variable].is_none() {
                            settled[variable] = Some(false);
                        }
                    }
                }
            }
        }
        pending.into_iter().for_each(|variable| settled[variable] = Some(false));
    }
    settled.into_iter().map(|settled| settled == Some(true)).collect()
}
