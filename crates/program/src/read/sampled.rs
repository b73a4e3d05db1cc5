//! Which image is sampled with which sampler, also where a function gets both from its callers.

use std::collections::HashSet;

use naga::{Block, Expression, Function, GlobalVariable, Handle, Module, Statement};

/// An image, and what samples it where that is a variable of the module.
pub(super) type Pair = (Handle<GlobalVariable>, Option<Handle<GlobalVariable>>);

/// What a call gives for an argument: a variable of the module, or something else.
type Given = Vec<Option<Handle<GlobalVariable>>>;

/// Images with what samples them, in all functions, each once.
pub(super) fn pairs(module: &Module) -> Vec<Pair> {
    let mut found = Found { module, seen: HashSet::new(), pairs: Vec::new() };
    for (handle, function) in module.functions.iter() {
        found.look(Some(handle), function, Vec::new());
    }
    for point in &module.entry_points {
        found.look(None, &point.function, Vec::new());
    }
    found.pairs
}

struct Found<'m> {
    module: &'m Module,
    /// Functions with what they were given: naga's have no recursion.
    seen: HashSet<(Handle<Function>, Given)>,
    pairs: Vec<Pair>,
}

impl Found<'_> {
    fn look(&mut self, handle: Option<Handle<Function>>, function: &Function, given: Given) {
        if handle.is_some_and(|handle| !self.seen.insert((handle, given.clone()))) {
            return;
        }
        let variable = |expression: Handle<Expression>| match function.expressions[expression] {
            Expression::GlobalVariable(variable) => Some(variable),
            Expression::FunctionArgument(k) => given.get(k as usize).copied().flatten(),
            _ => None,
        };
        for (_, expression) in function.expressions.iter() {
            if let Expression::ImageSample { image, sampler, .. } = expression
                && let Some(image) = variable(*image)
            {
                let pair = (image, variable(*sampler));
                if !self.pairs.contains(&pair) {
                    self.pairs.push(pair);
                }
            }
        }
        let mut calls = Vec::new();
        calls_in(&function.body, &mut calls);
        for (called, arguments) in calls {
            let given: Given = arguments.iter().map(|argument| variable(*argument)).collect();
            if given.iter().any(Option::is_some) {
                self.look(Some(called), &self.module.functions[called], given);
            }
        }
    }
}

/// The calls of a block, those in the blocks of its statements included.
fn calls_in<'b>(block: &'b Block, into: &mut Vec<(Handle<Function>, &'b [Handle<Expression>])>) {
    for statement in block {
        match statement {
            Statement::Call { function, arguments, .. } => into.push((*function, arguments)),
            Statement::Block(block) => calls_in(block, into),
            Statement::If { accept, reject, .. } => {
                [accept, reject].into_iter().for_each(|block| calls_in(block, into))
            }
            Statement::Switch { cases, .. } => cases.iter().for_each(|case| calls_in(&case.body, into)),
            Statement::Loop { body, continuing, .. } => {
                [body, continuing].into_iter().for_each(|block| calls_in(block, into));
            }
            _ => {}
        }
    }
}
