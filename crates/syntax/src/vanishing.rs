//! Sums that are 0 in real numbers whatever their variables are. In binary32 they are what a rounding left: the error of a
//! sum or product, as error-free transformations take it (Dekker 1971; Knuth, TwoSum; Kahan's summation).

mod polynomial;
mod walk;

use super::Shader;
use super::ast::ExprId;
use super::symbols::{FunctionId, SymbolId};

/// A sum that is 0 in real numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Vanishing {
    /// The sum: an addition, a subtraction, an assignment by one, or a call of `fma`.
    pub sum: ExprId,
    /// The function in which it stands.
    pub function: FunctionId,
    /// The variable that gets its value, with whatever is done to it on the way; none where it is used at once.
    pub goes_to: Option<SymbolId>,
}

impl Shader {
    /// The sums that are 0 in real numbers and whose terms are not, in the order of evaluation. Local variables are followed
    /// from their assignments on; what a loop, a branch or a call may change is taken for any number.
    pub fn vanishing(&self) -> Vec<Vanishing> {
        self.functions().flat_map(|(id, _)| walk::of_function(self, id)).collect()
    }
}
