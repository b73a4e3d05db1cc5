//! Subgroups (GL_KHR_shader_subgroup): what invocations that work side by side do with each other's values.
//!
//! naga has words for votes of all, ballots, sums, extremes and for taking values from each other. What it has no word
//! for is made of these: an operation that goes through a part of the subgroup takes the values one after the other.

use naga::{
    Barrier, BinaryOperator as B, CollectiveOperation, Direction, Expression, GatherMode, MathFunction as M,
    ScalarKind, Statement, SubgroupOperation as Op, UnaryOperator,
};

use super::function::{Fun, Val};
use super::types::{scalar, size};
use super::{Build, Expr, Result};
use base::text::Span;
use syntax::BuiltinFunction as F;
use syntax::Stage;
use syntax::ast::{BinaryOp, ExprId};
use syntax::types::{ScalarType, Type};

/// Invocations of the largest subgroup (GL_KHR_shader_subgroup: a ballot has four words).
const MOST: u32 = 128;

/// Over which invocations an operation goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Over {
    /// All.
    All,
    /// Those up to this one.
    UpTo,
    /// Those before this one.
    Before,
    /// Those of the same part of the subgroup.
    Cluster,
}

/// What a function such as `subgroupInclusiveAdd` does.
fn reduction(function: F) -> Option<(Op, Over)> {
    let rest = function.name().strip_prefix("subgroup")?;
    let forms = [("Inclusive", Over::UpTo), ("Exclusive", Over::Before), ("Clustered", Over::Cluster), ("", Over::All)];
    forms.into_iter().find_map(|(word, over)| {
        let op = match rest.strip_prefix(word)? {
            "Add" => Op::Add,
            "Mul" => Op::Mul,
            "Min" => Op::Min,
            "Max" => Op::Max,
            "And" => Op::And,
            "Or" => Op::Or,
            "Xor" => Op::Xor,
            _ => return None,
        };
        Some((op, over))
    })
}

/// Which invocations a built-in mask has bits for, by their numbers beside the own one.
pub(super) fn mask(name: &str) -> Option<BinaryOp> {
    Some(match name {
        "gl_SubgroupEqMask" => BinaryOp::Equal,
        "gl_SubgroupGeMask" => BinaryOp::GreaterEqual,
        "gl_SubgroupGtMask" => BinaryOp::Greater,
        "gl_SubgroupLeMask" => BinaryOp::LessEqual,
        "gl_SubgroupLtMask" => BinaryOp::Less,
        _ => return None,
    })
}

/// A variable that says that numbers in subgroups were taken from those in the workgroup.
pub(crate) const BY_INDEX: &str = "sc_subgroups_by_index";

impl Build<'_> {
    /// True for a number in a subgroup that naga has in workgroups of one dimension alone. In others the interpreter counts
    /// along x first, as in all; a host may not.
    pub(super) fn numbers_by_index(&self, name: &str) -> bool {
        let several = self.workgroup[1..].iter().any(|&n| n > 1);
        several && matches!(name, "gl_SubgroupInvocationID" | "gl_SubgroupID")
    }

    fn note_by_index(&mut self) {
        let known = self.module.global_variables.iter().any(|(_, v)| v.name.as_deref() == Some(BY_INDEX));
        if !known {
            let ty = self.insert(None, naga::TypeInner::Scalar(naga::Scalar::U32));
            self.variable(BY_INDEX, naga::AddressSpace::Private, ty);
        }
    }
}

impl Fun<'_, '_> {
    /// A function of subgroups: `None` when it is no such function, else its value.
    pub(super) fn subgroup(&mut self, function: F, args: &[ExprId], span: Span) -> Result<Option<Option<Val>>> {
        let barrier = match function {
            F::SubgroupBarrier => Statement::ControlBarrier(Barrier::SUB_GROUP),
            F::SubgroupMemoryBarrier => Statement::MemoryBarrier(Barrier::all()),
            F::SubgroupMemoryBarrierBuffer => Statement::MemoryBarrier(Barrier::STORAGE),
            F::SubgroupMemoryBarrierShared => Statement::MemoryBarrier(Barrier::WORK_GROUP),
            F::SubgroupMemoryBarrierImage => Statement::MemoryBarrier(Barrier::TEXTURE),
            _ => return self.of_subgroup(function, args, span).map(|value| value.map(Some)),
        };
        if self.shader.stage() != Stage::Compute {
            let message = format!("`{function}` outside of a compute shader");
            return Err(self.build.unsupported(span, message, "leave it out"));
        }
        self.push(barrier);
        Ok(Some(None))
    }

    fn of_subgroup(&mut self, function: F, args: &[ExprId], span: Span) -> Result<Option<Val>> {
        let own = function.name().starts_with("subgroup") || function.name().contains("Invocation");
        if !own || function.name().starts_with("interpolate") {
            return Ok(None);
        }
        let mut values = Vec::new();
        for &arg in args {
            values.push(self.expression(arg)?);
        }
        // Numbers of invocations and sizes of clusters may be written as signed ones.
        for number in values.iter_mut().skip(1).filter(|number| number.ty.scalar() == Some(ScalarType::Int)) {
            *number = self.cast(number.clone(), ScalarType::Int, ScalarType::Uint)?;
        }
        let wide = |v: &Val| v.ty.scalar().is_some_and(|s| s.bits() == 64);
        if values.iter().any(wide) {
            let message = format!("`{function}` of numbers of 64 bits");
            return Err(self.build.unsupported(span, message, "use numbers of 32 bits"));
        }
        let value = match function {
            F::SubgroupElect => {
                let id = self.own_number(span)?;
                let first = self.gather(GatherMode::BroadcastFirst, &Val { e: id, ty: Type::UINT })?.e;
                self.truth(B::Equal, first, id)
            }
            F::SubgroupAll | F::AllInvocations | F::AllInvocationsARB => {
                self.collective(Op::All, Over::All, &values[0])?
            }
            F::SubgroupAny | F::AnyInvocation | F::AnyInvocationARB => {
                self.collective(Op::Any, Over::All, &values[0])?
            }
            F::SubgroupAllEqual | F::AllInvocationsEqual | F::AllInvocationsEqualARB => {
                let first = self.gather(GatherMode::BroadcastFirst, &values[0])?;
                let e = self.equal(&values[0], &first)?;
                self.collective(Op::All, Over::All, &Val { e, ty: Type::BOOL })?
            }
            F::SubgroupBroadcastFirst => self.gather(GatherMode::BroadcastFirst, &values[0])?,
            // naga broadcasts from invocations that are known when it compiles alone.
            F::SubgroupBroadcast | F::SubgroupShuffle => self.gather(GatherMode::Shuffle(values[1].e), &values[0])?,
            F::SubgroupShuffleXor => self.gather(GatherMode::ShuffleXor(values[1].e), &values[0])?,
            F::SubgroupShuffleUp => self.gather(GatherMode::ShuffleUp(values[1].e), &values[0])?,
            F::SubgroupShuffleDown => self.gather(GatherMode::ShuffleDown(values[1].e), &values[0])?,
            F::SubgroupQuadSwapHorizontal => self.gather(GatherMode::QuadSwap(Direction::X), &values[0])?,
            F::SubgroupQuadSwapVertical => self.gather(GatherMode::QuadSwap(Direction::Y), &values[0])?,
            F::SubgroupQuadSwapDiagonal => self.gather(GatherMode::QuadSwap(Direction::Diagonal), &values[0])?,
            F::SubgroupQuadBroadcast => {
                let id = self.own_number(span)?;
                let (three, rest) = (self.word(3), self.word(!3));
                let (base, within) = (self.bits_of(B::And, id, rest), self.bits_of(B::And, values[1].e, three));
                let number = self.bits_of(B::InclusiveOr, base, within);
                self.gather(GatherMode::Shuffle(number), &values[0])?
            }
            F::SubgroupRotate | F::SubgroupClusteredRotate => {
                let id = self.own_number(span)?;
                let whole = match values.get(2) {
                    Some(cluster) => cluster.e,
                    None => self.number_of("gl_SubgroupSize", span)?,
                };
                // Sizes are powers of two.
                let one = self.word(1);
                let mask = self.bits_of(B::Subtract, whole, one);
                let moved = self.bits_of(B::Add, id, values[1].e);
                let within = self.bits_of(B::And, moved, mask);
                let rest = self.add(Expression::Unary { op: UnaryOperator::BitwiseNot, expr: mask });
                let base = self.bits_of(B::And, id, rest);
                let number = self.bits_of(B::InclusiveOr, base, within);
                self.gather(GatherMode::Shuffle(number), &values[0])?
            }
            F::SubgroupBallot => {
                let e = self.ballot(Some(values[0].e));
                Val { e, ty: Type::Vector(ScalarType::Uint, 4) }
            }
            F::SubgroupInverseBallot => {
                let id = self.own_number(span)?;
                self.bit(values[0].e, id)
            }
            F::SubgroupBallotBitExtract => self.bit(values[0].e, values[1].e),
            F::SubgroupBallotBitCount
            | F::SubgroupBallotInclusiveBitCount
            | F::SubgroupBallotExclusiveBitCount
            | F::SubgroupBallotFindLSB
            | F::SubgroupBallotFindMSB => self.of_ballot(function, values[0].e, span)?,
            _ => {
                let Some((op, over)) = reduction(function) else { return Ok(None) };
                self.reduced(op, over, &values, span)?
            }
        };
        Ok(Some(value))
    }

    /// A sum or the like. Values of `bool` are taken as numbers.
    fn reduced(&mut self, op: Op, over: Over, values: &[Val], span: Span) -> Result<Val> {
        let value = &values[0];
        let kind = value.ty.scalar().unwrap_or(ScalarType::Uint);
        if kind == ScalarType::Bool {
            let number = self.cast(value.clone(), kind, ScalarType::Uint)?;
            let all = [std::slice::from_ref(&number), &values[1..]].concat();
            let result = self.reduced(op, over, &all, span)?;
            return self.cast(result, ScalarType::Uint, kind);
        }
        let product = op == Op::Mul && kind.is_floating();
        let known = match over {
            Over::All => true,
            Over::UpTo | Over::Before => matches!(op, Op::Add | Op::Mul),
            Over::Cluster => false,
        };
        if known && !product {
            let result = self.collective(op, over, value)?;
            return self.wrapped(result);
        }
        self.one_by_one(op, over, value, values.get(1).map(|v| v.e), span)
    }

    /// An operation that takes values one after the other.
    fn one_by_one(&mut self, op: Op, over: Over, value: &Val, cluster: Option<Expr>, span: Span) -> Result<Val> {
        let id = self.own_number(span)?;
        let here = self.ballot(None);
        let count = match cluster {
            Some(cluster) => cluster,
            None => self.number_of("gl_SubgroupSize", span)?,
        };
        let one = self.word(1);
        let first = match over {
            Over::Cluster => {
                let mask = self.bits_of(B::Subtract, count, one);
                let rest = self.add(Expression::Unary { op: UnaryOperator::BitwiseNot, expr: mask });
                self.bits_of(B::And, id, rest)
            }
            Over::All | Over::UpTo | Over::Before => self.word(0),
        };
        let (result, step, any) = (
            self.local("sc_reduced", &value.ty)?,
            self.local("sc_step", &Type::UINT)?,
            self.local("sc_any", &Type::BOOL)?,
        );
        let (neutral, zero, none) = (self.neutral(op, &value.ty)?, self.word(0), self.number(ScalarType::Bool, 0.0));
        self.store(&result, &neutral)?;
        self.store(&step, &Val { e: zero, ty: Type::UINT })?;
        self.store(&any, &Val { e: none, ty: Type::BOOL })?;
        let (body, ()) = self.block(|f| {
            let k = f.load(&step)?.e;
            let done = f.truth(B::GreaterEqual, k, count).e;
            f.branch(
                done,
                |f| {
                    f.push(Statement::Break);
                    Ok(())
                },
                |_| Ok(()),
            )?;
            let number = f.bits_of(B::Add, first, k);
            let taken = f.gather(GatherMode::Shuffle(number), value)?;
            let mut counts = f.bit(here, number).e;
            let before = match over {
                Over::UpTo => Some(f.truth(B::LessEqual, number, id).e),
                Over::Before => Some(f.truth(B::Less, number, id).e),
                Over::All | Over::Cluster => None,
            };
            if let Some(before) = before {
                counts = f.add(Expression::Binary { op: B::LogicalAnd, left: counts, right: before });
            }
            f.branch(
                counts,
                |f| {
                    let (so_far, begun) = (f.load(&result)?, f.load(&any)?.e);
                    let both = f.combined(op, &so_far, &taken)?;
                    f.branch(begun, |f| f.store(&result, &both), |f| f.store(&result, &taken))?;
                    let yes = f.number(ScalarType::Bool, 1.0);
                    f.store(&any, &Val { e: yes, ty: Type::BOOL })
                },
                |_| Ok(()),
            )
        })?;
        let (continuing, ()) = self.block(|f| {
            let k = f.load(&step)?.e;
            let one = f.word(1);
            let e = f.bits_of(B::Add, k, one);
            f.store(&step, &Val { e, ty: Type::UINT })
        })?;
        self.push(Statement::Loop { body, continuing, break_if: None });
        self.load(&result)
    }

    fn combined(&mut self, op: Op, a: &Val, b: &Val) -> Result<Val> {
        let op = match op {
            Op::Add => BinaryOp::Add,
            Op::Mul => BinaryOp::Mul,
            Op::And | Op::All => BinaryOp::BitAnd,
            Op::Or | Op::Any => BinaryOp::BitOr,
            Op::Xor => BinaryOp::BitXor,
            Op::Min | Op::Max => {
                let fun = if op == Op::Min { M::Min } else { M::Max };
                return Ok(Val { e: self.math(fun, &[a.e, b.e]), ty: a.ty.clone() });
            }
        };
        self.binary(op, a.clone(), b.clone())
    }

    /// What changes nothing: the value of nobody (GL_KHR_shader_subgroup_arithmetic).
    fn neutral(&mut self, op: Op, ty: &Type) -> Result<Val> {
        let kind = ty.scalar().unwrap_or(ScalarType::Uint);
        let least = if kind.is_signed() { (1u32 << (kind.bits() - 1)).wrapping_neg() } else { 0 };
        let most = (u64::from(u32::MAX) >> (32 - kind.bits() + u32::from(kind.is_signed()))) as u32;
        let bits = match op {
            Op::Add | Op::Or | Op::Any | Op::Xor => 0,
            Op::Mul if kind.is_floating() => 1.0_f32.to_bits(),
            Op::Mul => 1,
            Op::Min if kind.is_floating() => f32::INFINITY.to_bits(),
            Op::Max if kind.is_floating() => f32::NEG_INFINITY.to_bits(),
            Op::Min => most,
            Op::Max => least,
            Op::And | Op::All if kind.is_unsigned() => most,
            Op::And | Op::All => u32::MAX,
        };
        let mut e = self.word(bits);
        if let Type::Vector(_, n) = ty {
            e = self.add(Expression::Splat { size: size(*n), value: e });
        }
        if kind.is_floating() {
            e = self.add(Expression::As { expr: e, kind: ScalarKind::Float, convert: None });
            return self.cast(Val { e, ty: ty.with_scalar(ScalarType::Float) }, ScalarType::Float, kind);
        }
        if kind.is_signed() {
            e = self.add(Expression::As { expr: e, kind: ScalarKind::Sint, convert: None });
        }
        Ok(Val { e, ty: ty.clone() })
    }

    fn collective(&mut self, op: Op, over: Over, value: &Val) -> Result<Val> {
        let ty = self.ty(&value.ty)?;
        let collective_op = match over {
            Over::All | Over::Cluster => CollectiveOperation::Reduce,
            Over::UpTo => CollectiveOperation::InclusiveScan,
            Over::Before => CollectiveOperation::ExclusiveScan,
        };
        let result = self.add(Expression::SubgroupOperationResult { ty });
        self.push(Statement::SubgroupCollectiveOperation { op, collective_op, argument: value.e, result });
        Ok(Val { e: result, ty: value.ty.clone() })
    }

    /// The value of another invocation. naga passes numbers on alone.
    fn gather(&mut self, mode: GatherMode, value: &Val) -> Result<Val> {
        if value.ty.scalar() == Some(ScalarType::Bool) {
            let number = self.cast(value.clone(), ScalarType::Bool, ScalarType::Uint)?;
            let taken = self.gather(mode, &number)?;
            return self.cast(taken, ScalarType::Uint, ScalarType::Bool);
        }
        let ty = self.ty(&value.ty)?;
        let result = self.add(Expression::SubgroupOperationResult { ty });
        self.push(Statement::SubgroupGather { mode, argument: value.e, result });
        Ok(Val { e: result, ty: value.ty.clone() })
    }

    /// Bits of the invocations for which something holds, or of all that are here.
    fn ballot(&mut self, predicate: Option<Expr>) -> Expr {
        let result = self.add(Expression::SubgroupBallotResult);
        self.push(Statement::SubgroupBallot { result, predicate });
        result
    }

    /// Whether an invocation has its bit in a ballot.
    fn bit(&mut self, ballot: Expr, number: Expr) -> Val {
        let (five, three, mask) = (self.word(5), self.word(MOST / 32 - 1), self.word(31));
        let word = self.add(Expression::Binary { op: B::ShiftRight, left: number, right: five });
        let index = self.bits_of(B::And, word, three);
        let word = self.add(Expression::Access { base: ballot, index });
        let place = self.bits_of(B::And, number, mask);
        let moved = self.add(Expression::Binary { op: B::ShiftRight, left: word, right: place });
        let (one, zero) = (self.word(1), self.word(0));
        let bit = self.bits_of(B::And, moved, one);
        self.truth(B::NotEqual, bit, zero)
    }

    /// Functions of the bits of a ballot, those of invocations that there are.
    fn of_ballot(&mut self, function: F, ballot: Expr, span: Span) -> Result<Val> {
        let within = match function {
            F::SubgroupBallotInclusiveBitCount => self.mask(BinaryOp::LessEqual, span)?,
            F::SubgroupBallotExclusiveBitCount => self.mask(BinaryOp::Less, span)?,
            _ => {
                let size = self.number_of("gl_SubgroupSize", span)?;
                self.below(size)?
            }
        };
        let bits = self.add(Expression::Binary { op: B::And, left: ballot, right: within.e });
        let mut result = self.word(0);
        if matches!(function, F::SubgroupBallotFindLSB | F::SubgroupBallotFindMSB) {
            // The last word with a bit that is looked at has the last word.
            let last = function == F::SubgroupBallotFindMSB;
            result = self.word(u32::MAX);
            for k in 0..MOST / 32 {
                let k = if last { k } else { MOST / 32 - 1 - k };
                let word = self.part(bits, k);
                let at = self.math(if last { M::FirstLeadingBit } else { M::FirstTrailingBit }, &[word]);
                let (base, zero) = (self.word(32 * k), self.word(0));
                let at = self.bits_of(B::Add, at, base);
                let any = self.truth(B::NotEqual, word, zero).e;
                result = self.add(Expression::Select { condition: any, accept: at, reject: result });
            }
        } else {
            for k in 0..MOST / 32 {
                let word = self.part(bits, k);
                let count = self.math(M::CountOneBits, &[word]);
                result = self.bits_of(B::Add, result, count);
            }
        }
        Ok(Val { e: result, ty: Type::UINT })
    }

    /// One of the built-in masks.
    pub(super) fn mask(&mut self, op: BinaryOp, span: Span) -> Result<Val> {
        let id = self.own_number(span)?;
        let one = self.word(1);
        let next = self.bits_of(B::Add, id, one);
        let (below, up_to) = (self.below(id)?, self.below(next)?);
        let size = self.number_of("gl_SubgroupSize", span)?;
        let all = self.below(size)?;
        let without = |f: &mut Self, part: Expr| {
            let e = f.add(Expression::Binary { op: B::ExclusiveOr, left: all.e, right: part });
            Val { e, ty: Type::Vector(ScalarType::Uint, 4) }
        };
        Ok(match op {
            BinaryOp::Less => below,
            BinaryOp::LessEqual => up_to,
            BinaryOp::GreaterEqual => without(self, below.e),
            BinaryOp::Greater => without(self, up_to.e),
            _ => {
                let e = self.add(Expression::Binary { op: B::ExclusiveOr, left: up_to.e, right: below.e });
                Val { e, ty: below.ty }
            }
        })
    }

    /// Bits of the first so many invocations.
    fn below(&mut self, count: Expr) -> Result<Val> {
        let mut words = Vec::new();
        for k in 0..MOST / 32 {
            let (first, full, ones, zero) = (self.word(32 * k), self.word(32), self.word(u32::MAX), self.word(0));
            // How many bits of this word: those of `count` that lie behind its first one.
            let capped = self.math(M::Max, &[count, first]);
            let rest = self.bits_of(B::Subtract, capped, first);
            let some = self.math(M::Min, &[rest, full]);
            let places = self.bits_of(B::Subtract, full, some);
            let mask = self.word(31);
            let places = self.bits_of(B::And, places, mask);
            let moved = self.add(Expression::Binary { op: B::ShiftRight, left: ones, right: places });
            // All bits are as far as none of them: a shift goes up to 31 places.
            let none = self.truth(B::Equal, some, zero).e;
            words.push(self.add(Expression::Select { condition: none, accept: zero, reject: moved }));
        }
        self.compose(&Type::Vector(ScalarType::Uint, 4), words)
    }

    fn own_number(&mut self, span: Span) -> Result<Expr> {
        self.number_of("gl_SubgroupInvocationID", span)
    }

    /// A built-in number.
    pub(super) fn number_of(&mut self, name: &str, span: Span) -> Result<Expr> {
        if !self.build.numbers_by_index(name) {
            return self.state(name, span).map(|value| value.e);
        }
        let (index, width) = (self.state("gl_LocalInvocationIndex", span)?.e, self.state("gl_SubgroupSize", span)?.e);
        let op = if name == "gl_SubgroupID" { B::Divide } else { B::Modulo };
        self.build.note_by_index();
        Ok(self.bits_of(op, index, width))
    }

    fn bits_of(&mut self, op: B, left: Expr, right: Expr) -> Expr {
        self.add(Expression::Binary { op, left, right })
    }

    fn truth(&mut self, op: B, left: Expr, right: Expr) -> Val {
        Val { e: self.add(Expression::Binary { op, left, right }), ty: Type::BOOL }
    }

    /// A whole number of 8 or 16 bits that was computed with 32, as it is kept.
    pub(super) fn wrapped(&mut self, value: Val) -> Result<Val> {
        let Some(kind) = value.ty.scalar().filter(|kind| kind.is_small_integer()) else { return Ok(value) };
        let e = if kind.is_signed() {
            let (zero, bits) = (self.word(0), self.word(kind.bits()));
            self.math(M::ExtractBits, &[value.e, zero, bits])
        } else {
            let mut mask = self.word((1 << kind.bits()) - 1);
            if let Type::Vector(_, n) = value.ty {
                mask = self.add(Expression::Splat { size: size(n), value: mask });
            }
            self.add(Expression::Binary { op: B::And, left: value.e, right: mask })
        };
        debug_assert_eq!(scalar(kind).width, 4, "small numbers are computed with 32 bits");
        Ok(Val { e, ty: value.ty })
    }
}
