//! Operations of subgroups.

use naga::{CollectiveOperation, Direction, Expression, GatherMode, Handle, Statement, SubgroupOperation};

use super::super::code::{Inst, Register};
use super::super::group::{Fold, From, Subgroup, SubgroupOp};
use super::wide::is_wide;
use super::{Compiler, Evaluated, Frame, InterpError, unsupported};
use base::value::Scalar;

impl<'m> Compiler<'m> {
    /// A statement in which the invocations of a subgroup see each other's values.
    pub(super) fn subgroup(
        &mut self,
        frame: &mut Frame<'m>,
        statement: &Statement,
        span: naga::Span,
    ) -> Result<(), InterpError> {
        if self.subject.shared.is_empty() {
            return Err(unsupported("subgroup operations".to_owned(), span));
        }
        let (op, argument, number, result) = match *statement {
            Statement::SubgroupBallot { result, predicate } => (SubgroupOp::Ballot, predicate, None, result),
            Statement::SubgroupGather { mode, argument, result } => {
                let (from, number) = taken(mode);
                (SubgroupOp::Take(from), Some(argument), number, result)
            }
            Statement::SubgroupCollectiveOperation { op, collective_op, argument, result } => {
                let fold = folded(op);
                let op = match collective_op {
                    CollectiveOperation::Reduce => SubgroupOp::All(fold),
                    CollectiveOperation::InclusiveScan => SubgroupOp::UpTo(fold),
                    CollectiveOperation::ExclusiveScan => SubgroupOp::Before(fold),
                };
                (op, Some(argument), None, result)
            }
            _ => return Err(InterpError::internal("a statement that is no operation of a subgroup".to_owned())),
        };
        if argument.is_some_and(|handle| is_wide(self.numbers(frame, handle))) {
            return Err(unsupported("subgroup operations of 64-bit integers".to_owned(), span));
        }
        let args = match argument {
            Some(argument) => self.registers(frame, argument)?.to_vec(),
            None => vec![self.word(1, Scalar::Bool)],
        };
        let product = matches!(op, SubgroupOp::All(Fold::Multiply) | SubgroupOp::UpTo(Fold::Multiply))
            || op == SubgroupOp::Before(Fold::Multiply);
        if product && args.iter().any(|arg| arg.scalar == Scalar::F32) {
            return Err(unsupported("products of real numbers over a subgroup".to_owned(), span));
        }
        let number = number.map(|number| self.single(frame, number)).transpose()?.map(|register| register.reg);
        let to: Vec<Register> = match op {
            SubgroupOp::Ballot => (0..4).map(|_| Register { scalar: Scalar::U32, reg: self.temporary() }).collect(),
            _ => args.iter().map(|arg| Register { reg: self.temporary(), ..*arg }).collect(),
        };
        let site = self.statement_site(frame, span);
        self.push(Inst::Subgroup(Subgroup { op, args, number, to: to.clone(), site }));
        // Numbers of binary16 are rounded to such.
        let of_result = self.site(frame, result);
        let given = self.narrowed(of_result, &to);
        frame.values.insert(result, Evaluated::Registers(given.into()));
        Ok(())
    }
}

fn taken(mode: GatherMode) -> (From, Option<Handle<Expression>>) {
    match mode {
        GatherMode::BroadcastFirst => (From::First, None),
        GatherMode::Broadcast(number) | GatherMode::Shuffle(number) => (From::Number, Some(number)),
        GatherMode::ShuffleDown(by) => (From::Down, Some(by)),
        GatherMode::ShuffleUp(by) => (From::Up, Some(by)),
        GatherMode::ShuffleXor(bits) => (From::Xor, Some(bits)),
        GatherMode::QuadBroadcast(number) => (From::OfFour, Some(number)),
        GatherMode::QuadSwap(Direction::X) => (From::Swapped(1), None),
        GatherMode::QuadSwap(Direction::Y) => (From::Swapped(2), None),
        GatherMode::QuadSwap(Direction::Diagonal) => (From::Swapped(3), None),
    }
}

/// Of truth values, all is the same as and, and any as or.
fn folded(op: SubgroupOperation) -> Fold {
    match op {
        SubgroupOperation::All | SubgroupOperation::And => Fold::And,
        SubgroupOperation::Any | SubgroupOperation::Or => Fold::Or,
        SubgroupOperation::Add => Fold::Add,
        SubgroupOperation::Mul => Fold::Multiply,
        SubgroupOperation::Min => Fold::Min,
        SubgroupOperation::Max => Fold::Max,
        SubgroupOperation::Xor => Fold::Xor,
    }
}
