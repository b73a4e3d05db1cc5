//! Functions on vectors and matrices, by their definitions in GLSL 4.60, 8.5 and 8.6.

use naga::{MathFunction, TypeInner};

use super::super::code::{Register, Word2};
use super::super::domain::{Binary, Comparison, Site, Unary};
use super::Compiler;
use super::math::Args;
use base::value::Scalar;

impl Compiler<'_> {
    /// `None` for other functions and for types that have no such function.
    pub(super) fn geometric(
        &mut self,
        site: Site,
        fun: MathFunction,
        args: &Args,
        first: &TypeInner,
    ) -> Option<Vec<Register>> {
        let matrix = match *first {
            TypeInner::Matrix { columns, rows, .. } => Some((columns as usize, rows as usize)),
            _ => None,
        };
        let arg = |k: usize| args.get(k).map(|registers| &**registers);
        match fun {
            MathFunction::Dot => Some(vec![self.dot(site, arg(0)?, arg(1)?)?]),
            MathFunction::Outer => {
                // naga's type of a product that is not square is that of its transpose: it has no
                // meaning on which its back ends agree.
                let (column, row) = (arg(0)?, arg(1).filter(|row| row.len() == args[0].len())?);
                let products = row.iter().flat_map(|&r| column.iter().map(move |&c| (c, r)));
                Some(products.map(|(c, r)| self.real2(site, Binary::Multiply, c, r)).collect())
            }
            MathFunction::Cross => {
                let (a, b) = (arg(0)?, arg(1)?);
                let term = |this: &mut Self, i: usize, j: usize| {
                    let left = this.real2(site, Binary::Multiply, a[i], b[j]);
                    let right = this.real2(site, Binary::Multiply, b[i], a[j]);
                    this.real2(site, Binary::Subtract, left, right)
                };
                Some(vec![term(self, 1, 2), term(self, 2, 0), term(self, 0, 1)])
            }
            MathFunction::Distance => {
                let between: Vec<Register> =
                    arg(0)?.iter().zip(arg(1)?).map(|(&a, &b)| self.real2(site, Binary::Subtract, a, b)).collect();
                Some(vec![self.length(site, &between)?])
            }
            MathFunction::Length => Some(vec![self.length(site, arg(0)?)?]),
            MathFunction::Normalize => {
                // Vulkan: x · inversesqrt(dot(x, x)); WGSL: x / length(x).
                let x = arg(0)?;
                let square = self.dot(site, x, x)?;
                let scale = self.real1(site, Unary::NormalScale, square);
                Some(x.iter().map(|&x| self.real2(site, Binary::Multiply, x, scale)).collect())
            }
            MathFunction::FaceForward => {
                let (normal, incident, reference) = (arg(0)?, arg(1)?, arg(2)?);
                let dot = self.dot(site, reference, incident)?;
                let zero = self.real(0.0, None);
                let keeps = self.compare(site, Comparison::Less, dot, zero);
                let turned: Vec<Register> = normal.iter().map(|&n| self.real1(site, Unary::Negate, n)).collect();
                Some(normal.iter().zip(turned).map(|(&n, turned)| self.select(keeps, n, turned)).collect())
            }
            MathFunction::Reflect => {
                // I − 2·dot(N, I)·N
                let (incident, normal) = (arg(0)?, arg(1)?);
                let dot = self.dot(site, normal, incident)?;
                let two = self.real(2.0, None);
                let twice = self.real2(site, Binary::Multiply, two, dot);
                let step = |(&i, &n): (&Register, &Register)| {
                    let along = self.real2(site, Binary::Multiply, twice, n);
                    self.real2(site, Binary::Subtract, i, along)
                };
                Some(incident.iter().zip(normal).map(step).collect())
            }
            MathFunction::Refract => self.refract(site, arg(0)?, arg(1)?, *arg(2)?.first()?),
            MathFunction::Transpose => {
                let ((columns, rows), m) = (matrix?, arg(0)?);
                Some((0..rows).flat_map(|r| (0..columns).map(move |c| m[c * rows + r])).collect())
            }
            MathFunction::Determinant => {
                let (n, _) = matrix.filter(|(columns, rows)| columns == rows)?;
                let determinant = self.determinant(site, n, arg(0)?);
                Some(vec![self.real1(site, Unary::Determinant, determinant)])
            }
            MathFunction::Inverse => {
                let (n, _) = matrix.filter(|(columns, rows)| columns == rows)?;
                let inverse = self.inverse(site, n, arg(0)?);
                Some(inverse.into_iter().map(|x| self.real1(site, Unary::Inverse, x)).collect())
            }
            _ => None,
        }
    }

    /// The sum of products, from the first to the last.
    fn dot(&mut self, site: Site, a: &[Register], b: &[Register]) -> Option<Register> {
        let mut sum: Option<Register> = None;
        for (&a, &b) in a.iter().zip(b) {
            let (term, total) = match a.scalar {
                Scalar::F32 => {
                    let term = self.real2(site, Binary::Multiply, a, b);
                    (term, sum.map(|sum| self.real2(site, Binary::Add, sum, term)))
                }
                Scalar::I32 | Scalar::U32 => {
                    let (multiply, add) = match a.scalar {
                        Scalar::I32 => (Word2::MultiplySigned, Word2::AddSigned),
                        _ => (Word2::MultiplyUnsigned, Word2::AddUnsigned),
                    };
                    let term = self.word2(site, multiply, a, b, a.scalar);
                    (term, sum.map(|sum| self.word2(site, add, sum, term, a.scalar)))
                }
                Scalar::Bool => return None,
            };
            sum = Some(total.unwrap_or(term));
        }
        sum
    }

    fn length(&mut self, site: Site, x: &[Register]) -> Option<Register> {
        let square = self.dot(site, x, x)?;
        Some(self.real1(site, Unary::Sqrt, square))
    }

    /// k = 1 − η²·(1 − dot(N, I)²); 0 where k < 0, else η·I − (η·dot(N, I) + √k)·N.
    fn refract(
        &mut self,
        site: Site,
        incident: &[Register],
        normal: &[Register],
        eta: Register,
    ) -> Option<Vec<Register>> {
        let (zero, one) = (self.real(0.0, None), self.real(1.0, None));
        let dot = self.dot(site, normal, incident)?;
        let square = self.real2(site, Binary::Multiply, dot, dot);
        let rest = self.real2(site, Binary::Subtract, one, square);
        let eta2 = self.real2(site, Binary::Multiply, eta, eta);
        let bent = self.real2(site, Binary::Multiply, eta2, rest);
        let k = self.real2(site, Binary::Subtract, one, bent);
        let reflected = self.compare(site, Comparison::Less, k, zero);
        let root = self.real1(site, Unary::Sqrt, k);
        let along = self.real2(site, Binary::Multiply, eta, dot);
        let factor = self.real2(site, Binary::Add, along, root);
        let component = |(&i, &n): (&Register, &Register)| {
            let forward = self.real2(site, Binary::Multiply, eta, i);
            let sideways = self.real2(site, Binary::Multiply, factor, n);
            let refracted = self.real2(site, Binary::Subtract, forward, sideways);
            self.select(reflected, zero, refracted)
        };
        Some(incident.iter().zip(normal).map(component).collect())
    }

    /// By the first column, then the first columns of what is left.
    fn determinant(&mut self, site: Site, n: usize, m: &[Register]) -> Register {
        let mut sum = None;
        for row in 0..n {
            let term = if n == 1 {
                m[0]
            } else {
                let minor = minor(n, m, row, 0);
                let minor = self.determinant(site, n - 1, &minor);
                self.real2(site, Binary::Multiply, m[row], minor)
            };
            let op = if row % 2 == 0 { Binary::Add } else { Binary::Subtract };
            sum = Some(sum.map_or(term, |sum| self.real2(site, op, sum, term)));
        }
        // A matrix has at least one row.
        sum.unwrap_or(m[0])
    }

    /// The adjugate over the determinant.
    fn inverse(&mut self, site: Site, n: usize, m: &[Register]) -> Vec<Register> {
        let determinant = self.determinant(site, n, m);
        let mut all = Vec::with_capacity(n * n);
        for column in 0..n {
            for row in 0..n {
                let minor = minor(n, m, column, row);
                let mut cofactor = self.determinant(site, n - 1, &minor);
                if (row + column) % 2 == 1 {
                    cofactor = self.real1(site, Unary::Negate, cofactor);
                }
                all.push(self.real2(site, Binary::Divide, cofactor, determinant));
            }
        }
        all
    }
}

/// The matrix without a row and a column.
fn minor(n: usize, m: &[Register], row: usize, column: usize) -> Vec<Register> {
    let kept = |k: &usize| k % n != row && k / n != column;
    (0..n * n).filter(kept).map(|k| m[k]).collect()
}
