//! Statements.

use syntax::ast::{Condition, Declaration, ExprId, Stmt, StmtKind};
use syntax::symbols::SymbolId;

use super::eval::{Jumps, Machine};
use super::start::{beginning, unknown_of};
use super::state::{State, meet_into};
use super::value::{Evidence, Sources, Value};

/// Rounds after which the ends of what still changes in a loop are given up.
const ROUNDS: usize = 2;

/// Rounds after which everything that still changes is unknown.
const MOST_ROUNDS: usize = 10;

impl<'s> Machine<'s> {
    /// The value of an index, which is recorded at the element `id` that it chooses.
    pub fn index(&mut self, id: ExprId, index: ExprId) -> Value {
        let at = self.eval(index);
        self.record(id, vec![at.clone()]);
        at
    }

    /// Runs statements in order.
    pub fn block(&mut self, statements: &'s [Stmt]) {
        for stmt in statements {
            if self.state.dead {
                return;
            }
            self.statement(stmt);
        }
    }

    fn statement(&mut self, stmt: &'s Stmt) {
        match &stmt.kind {
            StmtKind::Declaration(d) => self.declare(d),
            StmtKind::Expr(e) => drop(self.eval(*e)),
            StmtKind::Block(block) => self.block(&block.statements),
            StmtKind::If { condition, then, otherwise } => {
                let value = self.eval(*condition);
                let known = value.part(0).and_then(|r| r.single());
                let nothing = || Value::opaque(Sources::NONE);
                self.fork(
                    *condition,
                    &value,
                    known,
                    |m| {
                        m.statement(then);
                        nothing()
                    },
                    |m| {
                        if let Some(otherwise) = otherwise {
                            m.statement(otherwise);
                        }
                        nothing()
                    },
                );
            }
            StmtKind::For { init, condition, step, body, head_span: _ } => {
                self.statement(init);
                self.repeat(condition.as_ref(), *step, body);
            }
            StmtKind::While { condition, body } => self.repeat(Some(condition), None, body),
            StmtKind::DoWhile { body, condition } => {
                // The first round runs in any case; the others are those of a `while`.
                self.loops.push(Jumps::default());
                self.statement(body);
                let jumps = self.loops.pop().unwrap_or_default();
                self.resume(jumps.continues);
                if !self.state.dead {
                    self.eval(*condition);
                    self.cycle(Some(*condition), None, None, body);
                }
                self.resume(jumps.breaks);
            }
            StmtKind::Switch { selector, body } => self.switch(*selector, &body.statements),
            StmtKind::Return(value) => {
                let value = value.map(|v| self.eval(v));
                self.come_back(value);
                self.end();
            }
            StmtKind::Break => {
                let state = self.state.clone();
                let (shader, stated) = (self.shader, self.stated);
                if let Some(jumps) = self.loops.last_mut() {
                    meet_into(&mut jumps.breaks, state, |s| beginning(shader, stated, s));
                }
                self.end();
            }
            StmtKind::Continue => {
                let state = self.state.clone();
                let (shader, stated) = (self.shader, self.stated);
                if let Some(jumps) = self.loops.last_mut() {
                    meet_into(&mut jumps.continues, state, |s| beginning(shader, stated, s));
                }
                self.end();
            }
            StmtKind::Discard => {
                self.discarded = self.discarded.and(self.state.path);
                self.end();
            }
            StmtKind::Case(e) => drop(self.eval(*e)),
            StmtKind::Empty | StmtKind::Precision(_) | StmtKind::Qualified(_) | StmtKind::Default | StmtKind::Error => {
            }
        }
    }

    fn end(&mut self) {
        self.state.dead = true;
    }

    /// Goes on with what a jump brought, too.
    fn resume(&mut self, jump: Option<State>) {
        let Some(jump) = jump else { return };
        if self.state.dead {
            self.state = jump;
            return;
        }
        let mut slot = Some(std::mem::take(&mut self.state));
        let (shader, stated) = (self.shader, self.stated);
        meet_into(&mut slot, jump, |s| beginning(shader, stated, s));
        self.state = slot.unwrap_or_default();
    }

    /// Notes that the running function comes back here.
    pub fn come_back(&mut self, value: Option<Value>) {
        if self.state.dead {
            return;
        }
        let state = self.state.clone();
        let (shader, stated) = (self.shader, self.stated);
        let Some(frame) = self.frames.last_mut() else { return };
        if let Some(value) = value {
            // Which of several values comes back depends on the way.
            let value = if state.path.within(frame.path) { value } else { value.depending(state.path) };
            frame.value = Some(match frame.value.take() {
                Some(before) => before.join(&value),
                None => value,
            });
        }
        meet_into(&mut frame.returned, state, |s| beginning(shader, stated, s));
    }

    /// Declares variables, in a function or at file scope.
    pub fn declare(&mut self, declaration: &'s Declaration) {
        for d in &declaration.declarators {
            let value = d.initializer.as_ref().map(|i| self.eval(i.value));
            let Some(&symbol) = self.declared.get(&d.name.span.start) else { continue };
            let info = self.shader.symbol(symbol);
            self.state.forget(symbol, &self.keys);
            if let Some(frame) = self.frames.last_mut() {
                frame.locals.insert(symbol);
            }
            match value {
                Some(value) if info.value.is_none() => {
                    let value = if value.parts.is_empty() { unknown_of(&info.ty, value.sources()) } else { value };
                    self.state.vars.insert(symbol, value);
                }
                _ => {
                    self.state.vars.remove(&symbol);
                }
            }
        }
    }

    fn repeat(&mut self, condition: Option<&'s Condition>, step: Option<ExprId>, body: &'s Stmt) {
        match condition {
            Some(Condition::Expr(e)) => self.cycle(Some(*e), None, step, body),
            Some(Condition::Declaration(d)) => self.cycle(None, Some(d), step, body),
            None => self.cycle(None, None, step, body),
        }
    }

    /// Runs a loop until nothing changes, then once more for the record.
    fn cycle(
        &mut self,
        condition: Option<ExprId>,
        declared: Option<&'s Declaration>,
        step: Option<ExprId>,
        body: &'s Stmt,
    ) {
        let recording = std::mem::replace(&mut self.recording, false);
        let mut head = self.state.clone();
        head.facts.clear();
        let start = head.vars.clone();
        let first = head.clone();
        for round in 0.. {
            let (after, _) = self.round(&head, condition, declared, step, body);
            if after.dead {
                break;
            }
            let next = self.widen(&head, &after, round);
            if next == head {
                break;
            }
            head = next;
        }
        // What was given up too early comes back in a round from there.
        let (after, _) = self.round(&head, condition, declared, step, body);
        if !after.dead {
            head = self.widen(&first, &after, 0);
        }
        self.recording = recording;
        let (_, breaks) = self.round(&head, condition, declared, step, body);
        // The loop ends where the condition is false, or at a `break`. What changes in it is then mostly
        // not what it was at first.
        self.state = head;
        for (symbol, value) in &mut self.state.vars {
            if start.get(symbol) != Some(value) {
                *value = std::mem::replace(value, Value::opaque(Sources::NONE)).vague();
            }
        }
        match condition {
            Some(c) => {
                let value = self.look(c);
                if value.part(0).and_then(|r| r.single()) == Some(1.0) {
                    self.end();
                } else {
                    let before = self.state.path;
                    self.assume(c, false);
                    self.state.path = before;
                }
            }
            None if declared.is_none() => self.end(),
            None => {}
        }
        self.resume(breaks);
    }

    /// One round: the state at the end of the body, and that of the `break`s.
    fn round(
        &mut self,
        head: &State,
        condition: Option<ExprId>,
        declared: Option<&'s Declaration>,
        step: Option<ExprId>,
        body: &'s Stmt,
    ) -> (State, Option<State>) {
        self.state = head.clone();
        if let Some(c) = condition {
            let value = self.eval(c);
            if value.part(0).and_then(|r| r.single()) == Some(0.0) {
                self.end();
                return (self.state.clone(), None);
            }
            self.assume(c, true);
        }
        if let Some(d) = declared {
            self.declare(d);
        }
        self.loops.push(Jumps::default());
        self.statement(body);
        let jumps = self.loops.pop().unwrap_or_default();
        self.resume(jumps.continues);
        if !self.state.dead
            && let Some(step) = step
        {
            self.eval(step);
        }
        (std::mem::take(&mut self.state), jumps.breaks)
    }

    /// What holds at the head of a loop, before the first round or after another one.
    fn widen(&self, head: &State, after: &State, round: usize) -> State {
        let mut next = head.clone();
        // Ways out of earlier rounds depend on conditions of those rounds.
        next.ended = head.ended.and(after.ended);
        next.path = head.path.and(after.ended);
        for (symbol, value) in &after.vars {
            let before = head.vars.get(symbol).cloned().unwrap_or_else(|| self.beginning(*symbol));
            if before == *value {
                continue;
            }
            let joined = self.widened(*symbol, &before, value, round);
            if joined == before {
                continue;
            }
            let given_up = round + 1 >= MOST_ROUNDS;
            let joined = if given_up { unknown_of(&self.shader.symbol(*symbol).ty, Sources::ALL) } else { joined };
            next.vars.insert(*symbol, joined);
        }
        next
    }

    fn widened(&self, symbol: SymbolId, before: &Value, value: &Value, round: usize) -> Value {
        // What changes from round to round moves with the round.
        let mut joined = before.join(value).depending(Sources::of(symbol.index()));
        if round >= ROUNDS {
            for (part, old) in joined.parts.iter_mut().zip(&before.parts) {
                if part.lo < old.lo {
                    (part.lo, part.lo_by) = (f64::NEG_INFINITY, Evidence::Bound);
                }
                if part.hi > old.hi {
                    (part.hi, part.hi_by) = (f64::INFINITY, Evidence::Bound);
                }
            }
        }
        // Of more than the first round it is not known whether it comes.
        for (part, old) in joined.parts.iter_mut().zip(&before.parts) {
            if part.lo != old.lo {
                part.lo_by = Evidence::Bound;
            }
            if part.hi != old.hi {
                part.hi_by = Evidence::Bound;
            }
        }
        joined
    }

    /// Every label may be the first one, and each part may fall through to the next.
    fn switch(&mut self, selector: ExprId, statements: &'s [Stmt]) {
        let value = self.eval(selector);
        let on = value.sources();
        let before = self.state.clone();
        let (shader, stated) = (self.shader, self.stated);
        let begin = |s| beginning(shader, stated, s);
        self.loops.push(Jumps::default());
        let entered = State { path: before.path.and(on), ..before.clone() };
        self.state = State { dead: true, ..entered.clone() };
        let mut default = false;
        for stmt in statements {
            if matches!(stmt.kind, StmtKind::Case(_) | StmtKind::Default) {
                default |= matches!(stmt.kind, StmtKind::Default);
                let through = std::mem::take(&mut self.state);
                self.state = through.meet(entered.clone(), entered.path, on, begin);
                self.state.dead = false;
            }
            if !self.state.dead {
                self.statement(stmt);
            }
        }
        let jumps = self.loops.pop().unwrap_or_default();
        // A `continue` inside belongs to the loop around.
        if let (Some(outer), Some(state)) = (self.loops.last_mut(), jumps.continues) {
            meet_into(&mut outer.continues, state, begin);
        }
        self.resume(jumps.breaks);
        if !default {
            self.resume(Some(before.clone()));
        }
        if !self.state.dead {
            self.state.path = before.path.and(self.state.ended);
            for (symbol, value) in &mut self.state.vars {
                if before.vars.get(symbol) != Some(value) {
                    *value = value.clone().depending(on);
                }
            }
        }
    }
}
