//! Operations that a profile defines by others: in which steps they are done, on whatever remembers them.

use super::Tape;
use super::arena::Id;
use super::model::Model;
use crate::profile::{Definition, Op};

use program::interp::{Mask, SLOTS, Site};

/// What can do the steps of a definition, each as an operation of its own.
pub(super) trait Definitions {
    /// What operations are promised to be off by.
    fn promised(&self) -> &Model<'_>;
    /// A function of one number as one step.
    fn one(&mut self, site: Site, op: Op, active: &Mask, a: Id) -> Id;
    /// A function of two numbers as one step.
    fn two(&mut self, site: Site, op: Op, active: &Mask, a: Id, b: Id) -> Id;
    /// ±a ± b; a sign of 0 leaves its number out.
    fn sum(&mut self, site: Option<Site>, op: Op, a: Id, b: Id, signs: (f64, f64)) -> Id;
    /// a·b.
    fn product(&mut self, site: Site, op: Op, a: Id, b: Id) -> Id;
    /// A number of a definition.
    fn number(&mut self, value: f64) -> Id;
    /// The node, off by `error` more.
    fn allow(&mut self, id: Id, error: f64) -> Id;
    /// The node with the step outward that a profile may take around an operation as a whole.
    fn outward(&mut self, site: Site, op: Op, id: Id) -> Id;
    /// From here on, steps are parts of a definition; to be ended by [`Definitions::leave`].
    fn enter(&mut self) {}
    /// The end of a definition.
    fn leave(&mut self) {}

    /// A function of one number, by the definition that it inherits from where it has one.
    fn function1(&mut self, site: Site, op: Op, active: &Mask, a: Id) -> Id {
        let Some((definition, or)) = self.promised().definition(op) else { return self.one(site, op, active, a) };
        self.enter();
        let id = match definition {
            Definition::SqrtByInverseSqrt => self.one(site, op, active, a),
            Definition::SinOverCos => {
                let (sin, cos) = (self.function1(site, Op::Sin, active, a), self.function1(site, Op::Cos, active, a));
                self.two(site, Op::Div, active, sin, cos)
            }
            Definition::SinhOverCosh => {
                let (sinh, cosh) =
                    (self.function1(site, Op::Sinh, active, a), self.function1(site, Op::Cosh, active, a));
                self.two(site, Op::Div, active, sinh, cosh)
            }
            Definition::AsinByAtan2 => {
                let side = self.cathetus(site, active, a);
                self.two(site, Op::Atan2, active, a, side)
            }
            Definition::AcosByAtan2 => {
                let side = self.cathetus(site, active, a);
                self.two(site, Op::Atan2, active, side, a)
            }
            Definition::SinhByExp | Definition::CoshByExp => {
                let sign = if definition == Definition::SinhByExp { -1.0 } else { 1.0 };
                let rising = self.function1(site, Op::Exp, active, a);
                let negative = self.sum(Some(site), Op::Neg, a, a, (-1.0, 0.0));
                let falling = self.function1(site, Op::Exp, active, negative);
                let both = self.sum(Some(site), Op::Add, rising, falling, (1.0, sign));
                self.scaled(site, both, 0.5)
            }
            Definition::AsinhByLog | Definition::AcoshByLog => {
                let sign = if definition == Definition::AsinhByLog { 1.0 } else { -1.0 };
                let square = self.product(site, Op::Mul, a, a);
                let one = self.number(1.0);
                let shifted = self.sum(Some(site), Op::Add, square, one, (1.0, sign));
                let root = self.function1(site, Op::Sqrt, active, shifted);
                let sum = self.sum(Some(site), Op::Add, a, root, (1.0, 1.0));
                self.function1(site, Op::Log, active, sum)
            }
            Definition::AtanhByLog => {
                let one = self.number(1.0);
                let above = self.sum(Some(site), Op::Add, one, a, (1.0, 1.0));
                let below = self.sum(Some(site), Op::Sub, one, a, (1.0, -1.0));
                let quotient = self.two(site, Op::Div, active, above, below);
                let log = self.function1(site, Op::Log, active, quotient);
                self.scaled(site, log, 0.5)
            }
            Definition::FractByFloor => {
                let floor = self.function1(site, Op::Floor, active, a);
                self.sum(Some(site), Op::Sub, a, floor, (1.0, -1.0))
            }
            Definition::RadiansByProduct => self.scaled(site, a, std::f64::consts::PI / 180.0),
            Definition::DegreesByProduct => self.scaled(site, a, 180.0 / std::f64::consts::PI),
            // Definitions of operations on two numbers or on vectors.
            Definition::PowByExp2
            | Definition::ModByFloor
            | Definition::RemByTrunc
            | Definition::MultiplyAdd
            | Definition::MixByWeights
            | Definition::SmoothStepByCubic
            | Definition::SumOfProducts
            | Definition::LengthByDot
            | Definition::DistanceByLength
            | Definition::NormalizeByInverseSqrt
            | Definition::NormalizeByLength
            | Definition::DifferenceOfProducts
            | Definition::ReflectByDot
            | Definition::RefractByDot
            | Definition::FaceForwardByDot
            | Definition::MatrixBySums => self.one(site, op, active, a),
        };
        self.leave();
        self.inherited(site, op, id, or)
    }

    /// √(1 − x²).
    fn cathetus(&mut self, site: Site, active: &Mask, a: Id) -> Id {
        let square = self.product(site, Op::Mul, a, a);
        let one = self.number(1.0);
        let rest = self.sum(Some(site), Op::Sub, one, square, (1.0, -1.0));
        self.function1(site, Op::Sqrt, active, rest)
    }

    /// A function of two numbers, by the definition that it inherits from where it has one.
    fn function2(&mut self, site: Site, op: Op, active: &Mask, a: Id, b: Id) -> Id {
        let Some((definition, or)) = self.promised().definition(op) else { return self.two(site, op, active, a, b) };
        self.enter();
        let id = match definition {
            Definition::RemByTrunc | Definition::ModByFloor => {
                let whole = if definition == Definition::RemByTrunc { Op::Trunc } else { Op::Floor };
                let quotient = self.two(site, Op::Div, active, a, b);
                let whole = self.function1(site, whole, active, quotient);
                let product = self.product(site, Op::Mul, b, whole);
                self.sum(Some(site), Op::Sub, a, product, (1.0, -1.0))
            }
            _ => self.two(site, op, active, a, b),
        };
        self.leave();
        self.inherited(site, op, id, or)
    }

    /// The result of an operation by its definition: what is allowed in any case, and the step outward
    /// that a profile may take around the operation as a whole, after those of the definition.
    fn inherited(&mut self, site: Site, op: Op, id: Id, or: f64) -> Id {
        let id = self.allow(id, or);
        if self.promised().is_outward() { self.outward(site, op, id) } else { id }
    }

    /// 1/√x as the factor of `normalize`: 1/length where the profile defines it so.
    fn normal_scale(&mut self, site: Site, active: &Mask, a: Id) -> Id {
        match self.promised().definition(Op::Normalize) {
            Some((Definition::NormalizeByLength, _)) => {
                self.enter();
                let length = self.function1(site, Op::Sqrt, active, a);
                let one = self.number(1.0);
                // x/length(x) is rounded once, x·(1/length(x)) twice: the bound covers both.
                let scale = self.two(site, Op::Div, active, one, length);
                self.leave();
                scale
            }
            _ => self.one(site, Op::InverseSqrt, active, a),
        }
    }

    /// The product with a constant, which the device has as the nearest binary32 number.
    fn scaled(&mut self, site: Site, a: Id, factor: f64) -> Id {
        let id = self.number(factor);
        let id = self.allow(id, (f64::from(factor as f32) - factor).abs());
        self.product(site, Op::Mul, a, id)
    }
}

impl Definitions for Tape<'_> {
    fn promised(&self) -> &Model<'_> {
        self.model()
    }

    fn one(&mut self, site: Site, op: Op, active: &Mask, a: Id) -> Id {
        Tape::one(self, site, op, active, a)
    }

    fn two(&mut self, site: Site, op: Op, active: &Mask, a: Id, b: Id) -> Id {
        Tape::two(self, site, op, active, a, b)
    }

    fn sum(&mut self, site: Option<Site>, op: Op, a: Id, b: Id, signs: (f64, f64)) -> Id {
        Tape::sum(self, site, op, a, b, signs)
    }

    fn product(&mut self, site: Site, op: Op, a: Id, b: Id) -> Id {
        Tape::product(self, site, op, a, b)
    }

    fn number(&mut self, value: f64) -> Id {
        self.leaf(|v| v.fill(value))
    }

    fn allow(&mut self, id: Id, error: f64) -> Id {
        if error > 0.0 { self.identity(None, None, id, &[error; SLOTS]) } else { id }
    }

    fn outward(&mut self, site: Site, op: Op, id: Id) -> Id {
        let step = self.step_outward(id);
        let none = step.iter().all(|step| *step == 0.0);
        if none { id } else { self.identity(Some(site), Some(op), id, &step) }
    }

    fn enter(&mut self) {
        Tape::enter(self);
    }

    fn leave(&mut self) {
        Tape::leave(self);
    }
}
