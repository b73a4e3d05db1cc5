//! A program made smaller while it still shows what it showed: statements, operands, types, and what nothing uses.

use std::collections::BTreeSet;

use super::operations::OPERATIONS;
use super::program::{Expression, Form, Kind, Program, Scalar, Statement, Type, Variable};

/// What came of making a program smaller.
#[derive(Clone, Debug)]
pub struct Shrunk {
    /// The smallest program that shows it.
    pub program: Program,
    /// Programs that were tried.
    pub tried: usize,
}

/// Makes a program smaller as long as `shows` says that it still shows what it showed, in `budget` trials at most.
pub fn shrink(program: Program, budget: usize, shows: &mut dyn FnMut(&Program) -> bool) -> Shrunk {
    let (mut tried, mut seen) = (1, BTreeSet::new());
    // What is wrong may be in what nothing uses, since translators read that as well.
    let tidied = tidy(program.clone());
    let dead = !shows(&tidied);
    let mut best = if dead { program } else { tidied };
    'rounds: loop {
        let size = best.weight();
        for candidate in candidates(&best) {
            let candidate = if dead { candidate } else { tidy(candidate) };
            let key = base::text::fingerprint(&format!("{candidate:?}"));
            if candidate.weight() >= best.weight() || !seen.insert(key) {
                continue;
            }
            if tried >= budget {
                break 'rounds;
            }
            tried += 1;
            if shows(&candidate) {
                best = candidate;
                // What was just made possible is tried with the rest of this round's candidates gone: they are of
                // another program.
                continue 'rounds;
            }
        }
        if best.weight() == size {
            break;
        }
    }
    Shrunk { program: best, tried }
}

impl Program {
    /// How much there is to read, literals by how plain they are.
    fn weight(&self) -> usize {
        let mut plain = 0;
        self.clone().each_mut(&mut |expression| {
            if let Kind::Literal(words) = &expression.kind {
                let Type::Value(scalar, _) = expression.ty else { return };
                plain += words.iter().map(|&word| burden(scalar, word)).sum::<usize>();
            }
        });
        let lanes = |ty: &Type| match ty {
            Type::Value(_, n) => usize::from(*n),
            Type::Matrix(n, k) => usize::from(n * k),
            Type::Array(..) | Type::Structure(_) => 4,
        };
        let types: usize =
            self.results.iter().map(|r| lanes(&r.ty)).chain(self.inputs.iter().map(|i| lanes(&i.ty))).sum();
        let form = usize::from(self.form != Form::Function);
        8 * self.size() + plain + types + form
    }
}

fn burden(scalar: Scalar, word: u32) -> usize {
    let plain: &[u32] = match scalar {
        Scalar::Float => &[0x3f80_0000, 0, 0x3f00_0000, 0x4000_0000],
        _ => &[1, 0, 2, 3],
    };
    plain.iter().position(|&p| p == word).unwrap_or(plain.len())
}

/// Programs that are simpler in one place, the boldest steps first.
fn candidates(program: &Program) -> Vec<Program> {
    let mut all = Vec::new();
    all.extend(results(program));
    all.extend(statements(program));
    all.extend(expressions(program));
    all.extend(inlined(program));
    all.extend(literals(program));
    all
}

/// Fewer results, and parts of a result in place of it.
fn results(program: &Program) -> Vec<Program> {
    let mut all = Vec::new();
    for k in 0..program.results.len() {
        if program.results.len() > 1 {
            let mut fewer = program.clone();
            fewer.results.remove(k);
            fewer.each_block_mut(&mut |block| {
                for statement in block {
                    if let Statement::Finish { results } = statement
                        && results.len() > k
                        && results.len() == program.results.len()
                    {
                        results.remove(k);
                    }
                }
            });
            all.push(fewer);
        }
        let mut inner: Vec<&Expression> = Vec::new();
        program.results[k].each(&mut |e| inner.push(e));
        for part in inner.into_iter().skip(1) {
            let fits = matches!(part.ty, Type::Value(Scalar::Float | Scalar::Int | Scalar::Uint, _));
            if fits && part.ty != program.results[k].ty {
                let mut other = without_early(program);
                other.results[k] = part.clone();
                all.push(other);
            }
        }
    }
    // What a variable of the program holds at its end, in place of a result.
    for statement in &program.body {
        if let Statement::Declare { id, value } | Statement::Exchange { id, value, .. } = statement
            && matches!(value.ty, Type::Value(Scalar::Float | Scalar::Int | Scalar::Uint, _))
            && program.results.len() == 1
        {
            let read = Expression::read(Variable::Local(*id), value.ty.clone());
            if read != program.results[0] {
                let mut other = without_early(program);
                other.results[0] = read;
                all.push(other);
            }
        }
    }
    all
}

/// The program without its own early returns, which give as many results of other types.
fn without_early(program: &Program) -> Program {
    let mut other = program.clone();
    let own = other.helpers.len();
    let mut top = other.top_mut();
    if let Some(body) = top.get_mut(own) {
        fn go(block: &mut Vec<Statement>) {
            block.retain(|s| !matches!(s, Statement::Finish { .. }));
            block.iter_mut().flat_map(Statement::blocks_mut).for_each(go);
        }
        go(body);
    }
    other
}

/// Blocks without some of their statements, and what is inside of a statement in place of it.
fn statements(program: &Program) -> Vec<Program> {
    let mut sizes = Vec::new();
    program.clone().each_block_mut(&mut |block| sizes.push(block.len()));
    let mut all = Vec::new();
    let edited = |which: usize, edit: &dyn Fn(&mut Vec<Statement>)| {
        let (mut other, mut at) = (program.clone(), 0);
        other.each_block_mut(&mut |block| {
            if at == which {
                edit(block);
            }
            at += 1;
        });
        other
    };
    for (which, &size) in sizes.iter().enumerate() {
        let mut length = size;
        while length > 0 {
            for first in (0..size).step_by(length) {
                let end = (first + length).min(size);
                let mut gone = Vec::new();
                let other = edited(which, &|block| {
                    block.drain(first..end);
                });
                edited(which, &|_| {});
                // What was declared there is a plain value where it is still read.
                let mut copy = program.clone();
                let mut at = 0;
                copy.each_block_mut(&mut |block| {
                    if at == which {
                        gone.extend(block[first..end].iter().cloned());
                    }
                    at += 1;
                });
                all.push(gone.iter().fold(other, |other, statement| match statement {
                    Statement::Declare { id, value } | Statement::Exchange { id, value, .. } => {
                        with_variable(other, *id, &plain(&value.ty, program))
                    }
                    Statement::Total { id, .. } => with_variable(other, *id, &plain(&Type::UINT, program)),
                    _ => other,
                }));
            }
            length /= 2;
        }
        for place in 0..size {
            all.extend((0..4).filter_map(|inner| unwrapped(program, which, place, inner)));
        }
    }
    all
}

/// A statement replaced by one of its blocks.
fn unwrapped(program: &Program, which: usize, place: usize, inner: usize) -> Option<Program> {
    let (mut other, mut at, mut done) = (program.clone(), 0, None);
    other.each_block_mut(&mut |block| {
        if at == which && place < block.len() && done.is_none() {
            let counter = match &block[place] {
                Statement::For { id, .. } | Statement::Loop { id, .. } => Some(*id),
                _ => None,
            };
            let blocks = block[place].blocks_mut();
            let inside = blocks.into_iter().nth(inner).map(|inside| inside.clone());
            if let Some(mut inside) = inside {
                if counter.is_some() {
                    inside.retain(|s| !matches!(s, Statement::Break { .. } | Statement::Continue { .. }));
                }
                block.splice(place..=place, inside);
                done = Some(counter);
            }
        }
        at += 1;
    });
    done.map(|counter| match counter {
        Some(id) => with_variable(other, id, &Expression::int(0)),
        None => other,
    })
}

/// A program in which a variable is this value wherever it is read, and nowhere written.
fn with_variable(mut program: Program, id: u32, value: &Expression) -> Program {
    let variable = Variable::Local(id);
    program.each_block_mut(&mut |block| {
        block.retain(|s| s.place().is_none_or(|place| place.root() != Some(variable)));
    });
    program.each_mut(&mut |expression| {
        if expression.kind == Kind::Read(variable) {
            *expression = value.clone();
        }
    });
    program
}

/// The plainest value of a type.
fn plain(ty: &Type, program: &Program) -> Expression {
    let kind = match ty {
        Type::Value(Scalar::Float, n) => Kind::Literal(vec![1f32.to_bits(); usize::from(*n)]),
        Type::Value(_, n) => Kind::Literal(vec![1; usize::from(*n)]),
        Type::Matrix(n, k) => {
            Kind::Construct((0..*n).map(|_| plain(&Type::Value(Scalar::Float, *k), program)).collect())
        }
        Type::Array(of, n) => Kind::Construct((0..*n).map(|_| plain(of, program)).collect()),
        Type::Structure(index) => {
            Kind::Construct(program.structures[*index].iter().map(|member| plain(member, program)).collect())
        }
    };
    Expression { ty: ty.clone(), kind }
}

/// Each expression replaced by a part of it, by an input, or by a plain value of its type.
fn expressions(program: &Program) -> Vec<Program> {
    let mut nodes: Vec<Expression> = Vec::new();
    program.clone().each_mut(&mut |e| nodes.push(e.clone()));
    // The largest first: each of them takes the most away.
    let mut order: Vec<usize> = (0..nodes.len()).collect();
    order.sort_by_key(|&k| std::cmp::Reverse(nodes[k].size()));
    let mut all = Vec::new();
    for k in order {
        let node = &nodes[k];
        if node.size() == 1 && !matches!(node.kind, Kind::Read(_)) {
            continue;
        }
        let mut instead: Vec<Expression> = Vec::new();
        node.each(&mut |part| {
            if part.ty == node.ty && part != node {
                instead.push(part.clone());
            }
        });
        instead.sort_by_key(Expression::size);
        let read = program.inputs.iter().position(|input| input.ty == node.ty);
        if let (Some(index), true) = (read, node.size() > 1) {
            instead.insert(0, Expression::read(Variable::Input(index), node.ty.clone()));
        }
        instead.insert(0, plain(&node.ty, program));
        for value in instead {
            let (mut other, mut at) = (program.clone(), 0);
            other.each_mut(&mut |e| {
                if at == k {
                    *e = value.clone();
                }
                at += 1;
            });
            all.push(other);
        }
    }
    all
}

/// Values of variables in place of them, and calls replaced by what the helper gives.
fn inlined(program: &Program) -> Vec<Program> {
    let mut declared: Vec<(u32, Expression)> = Vec::new();
    program.clone().each_block_mut(&mut |block| {
        for statement in block.iter() {
            if let Statement::Declare { id, value } | Statement::Exchange { id, value, .. } = statement {
                declared.push((*id, value.clone()));
            }
        }
    });
    let mut all = Vec::new();
    for (id, value) in declared {
        let mut other = with_variable(program.clone(), id, &value);
        other.each_block_mut(&mut |block| {
            block.retain(|s| !matches!(s, Statement::Declare { id: own, .. } | Statement::Exchange { id: own, .. } if *own == id));
        });
        all.push(other);
    }
    for (index, helper) in program.helpers.iter().enumerate() {
        if helper.target.is_some() {
            continue;
        }
        let mut other = program.clone();
        other.each_mut(&mut |e| {
            if let Kind::Call(called, arguments) = &e.kind
                && *called == index
            {
                let arguments = arguments.clone();
                let mut value = helper.result.clone();
                value.each_mut(&mut |inner| {
                    if let Kind::Read(Variable::Parameter(k)) = inner.kind
                        && let Some(argument) = arguments.get(k)
                    {
                        *inner = argument.clone();
                    }
                });
                *e = value;
            }
        });
        all.push(other);
    }
    all
}

fn literals(program: &Program) -> Vec<Program> {
    let mut nodes: Vec<Expression> = Vec::new();
    program.clone().each_mut(&mut |e| nodes.push(e.clone()));
    let mut all = Vec::new();
    for (k, node) in nodes.iter().enumerate() {
        let (Kind::Literal(words), Type::Value(scalar, _)) = (&node.kind, &node.ty) else { continue };
        for place in 0..words.len() {
            for plainer in [1f32.to_bits(), 0f32.to_bits()] {
                let word = if *scalar == Scalar::Float { plainer } else { u32::from(plainer != 0) };
                let (mut other, mut at) = (program.clone(), 0);
                other.each_mut(&mut |e| {
                    if at == k
                        && let Kind::Literal(words) = &mut e.kind
                    {
                        words[place] = word;
                    }
                    at += 1;
                });
                all.push(other);
            }
        }
    }
    all
}

/// The program without what nothing uses: variables, helpers, inputs and structures; the rest is numbered anew.
pub fn tidy(mut program: Program) -> Program {
    ended(&mut program);
    loop {
        let before = program.size();
        unused_variables(&mut program);
        unused_helpers(&mut program);
        if program.size() == before {
            break;
        }
    }
    unused_inputs(&mut program);
    unused_structures(&mut program);
    program
}

/// What comes behind an end that is always reached goes.
fn ended(program: &mut Program) {
    let end = |body: &mut Vec<Statement>| {
        let at = body.iter().position(|s| matches!(s, Statement::Finish { .. }))?;
        let last = body.drain(at..).next()?;
        if let Statement::Finish { results } = last { Some(results) } else { None }
    };
    if let Some(results) = end(&mut program.body) {
        program.results = results;
    }
    for helper in program.helpers.iter_mut().filter(|helper| helper.target.is_none()) {
        if let Some(result) = end(&mut helper.body).and_then(|results| results.into_iter().next()) {
            helper.result = result;
        }
    }
}

/// Variables that a program reads.
pub fn reads(program: &Program) -> BTreeSet<Variable> {
    let mut found = BTreeSet::new();
    program.clone().each_mut(&mut |e| {
        if let Kind::Read(variable) = e.kind {
            found.insert(variable);
        }
    });
    found
}

fn unused_variables(program: &mut Program) {
    let read = reads(program);
    program.each_block_mut(&mut |block| {
        block.retain(|statement| match statement {
            Statement::Declare { id, .. } | Statement::Exchange { id, .. } | Statement::Total { id, .. } => {
                read.contains(&Variable::Local(*id))
            }
            Statement::Assign { place, .. } | Statement::Change { target: place, .. } => {
                place.root().is_none_or(|root| root == Variable::Target || read.contains(&root))
            }
            Statement::If { then, otherwise, .. } => !(then.is_empty() && otherwise.is_empty()),
            Statement::For { body, .. } | Statement::Loop { body, .. } => !body.is_empty(),
            Statement::Switch { cases, otherwise, .. } => {
                !(otherwise.is_empty() && cases.iter().all(|(_, block)| block.is_empty()))
            }
            Statement::Break { .. } | Statement::Continue { .. } | Statement::Finish { .. } => true,
        });
    });
}

fn unused_helpers(program: &mut Program) {
    let mut index = program.helpers.len();
    while index > 0 {
        index -= 1;
        let mut used = false;
        program.clone().each_mut(&mut |e| used |= matches!(e.kind, Kind::Call(called, _) if called == index));
        program.each_block_mut(&mut |block| {
            used |= block.iter().any(|s| matches!(s, Statement::Change { helper, .. } if *helper == index));
        });
        if used {
            continue;
        }
        program.helpers.remove(index);
        program.each_mut(&mut |e| {
            if let Kind::Call(called, _) = &mut e.kind
                && *called > index
            {
                *called -= 1;
            }
        });
        program.each_block_mut(&mut |block| {
            for statement in block {
                if let Statement::Change { helper, .. } = statement
                    && *helper > index
                {
                    *helper -= 1;
                }
            }
        });
    }
}

/// Removes inputs that nothing reads; one stays where there would be none, as no uniform.
pub fn unused_inputs(program: &mut Program) {
    let read = reads(program);
    let kept: Vec<usize> = (0..program.inputs.len()).filter(|&k| read.contains(&Variable::Input(k))).collect();
    let none = kept.is_empty();
    let kept = if none { vec![0] } else { kept };
    let inputs = kept.iter().filter_map(|&k| program.inputs.get(k).cloned()).collect();
    program.inputs = inputs;
    if let Some(first) = program.inputs.first_mut().filter(|_| none) {
        (first.uniform, first.ty) = (false, Type::FLOAT);
    }
    program.each_mut(&mut |e| {
        if let Kind::Read(Variable::Input(index)) = &mut e.kind
            && let Some(place) = kept.iter().position(|k| k == index)
        {
            *index = place;
        }
    });
}

fn types_of(ty: &Type, found: &mut BTreeSet<usize>) {
    match ty {
        Type::Structure(index) => {
            found.insert(*index);
        }
        Type::Array(of, _) => types_of(of, found),
        Type::Value(..) | Type::Matrix(..) => {}
    }
}

fn unused_structures(program: &mut Program) {
    let mut used = BTreeSet::new();
    program.clone().each_mut(&mut |e| types_of(&e.ty, &mut used));
    for helper in &program.helpers {
        helper.target.iter().chain(&helper.parameters).for_each(|ty| types_of(ty, &mut used));
    }
    program.each_block_mut(&mut |block| {
        for place in block.iter().filter_map(Statement::place) {
            place.each(&mut |e| types_of(&e.ty, &mut used));
        }
    });
    for index in (0..program.structures.len()).rev() {
        if used.contains(&index) {
            program.structures[index].clone().iter().for_each(|ty| types_of(ty, &mut used));
        }
    }
    // Structures at the end go; others keep their numbers, which are in every type.
    while program.structures.len().checked_sub(1).is_some_and(|last| !used.contains(&last)) {
        program.structures.pop();
    }
}

/// The names of operations that a program is about: guards are none.
pub fn about(program: &Program) -> Vec<&'static str> {
    let names = program.operations();
    let guard = |name: &str| OPERATIONS.iter().any(|row| row.name == name && row.guard().is_some());
    names.into_iter().filter(|name| !guard(name)).collect()
}
