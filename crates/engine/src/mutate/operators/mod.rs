//! Operators: each makes one kind of fault. One file each, and one line of the registry.

mod arithmetic;
mod built_in;
mod comparison;
mod condition;
mod constant;
mod constant_ulp;
mod drop_statement;
mod integer;
mod logic;
mod loop_bound;
mod matrix;
mod mix;
mod operand_order;
mod sign;
mod swap_argument;
mod swap_input;
mod swizzle;

use super::{Code, Draft};

/// A kind of fault.
#[derive(Clone, Copy, Debug)]
pub struct Operator {
    /// Name, as `--operator` takes it: lower case with `-`.
    pub name: &'static str,
    /// What it does, in a few words.
    pub about: &'static str,
    /// Proposes faults of this kind.
    pub make: fn(&Code<'_>, &mut Vec<Draft>),
}

/// One address for each operator: of a constant each use may have a copy of its own.
static OPERATORS: [Operator; 17] = [
    Operator { name: "arithmetic", about: "+ ↔ -, * ↔ /, also before =", make: arithmetic::make },
    Operator { name: "comparison", about: "< ↔ <=, > ↔ >=, == ↔ !=", make: comparison::make },
    Operator { name: "logic", about: "&& ↔ ||, ! dropped", make: logic::make },
    Operator { name: "sign", about: "a leading - dropped", make: sign::make },
    Operator { name: "condition", about: "a condition negated", make: condition::make },
    Operator { name: "loop-bound", about: "the bound of a loop moved by one", make: loop_bound::make },
    Operator { name: "drop-statement", about: "an assignment or EmitVertex dropped", make: drop_statement::make },
    Operator { name: "operand-order", about: "operands of -, / and matrix products", make: operand_order::make },
    Operator { name: "matrix", about: "rows taken for columns", make: matrix::make },
    Operator { name: "swizzle", about: "components permuted or replaced", make: swizzle::make },
    Operator { name: "swap-input", about: "another input or uniform of the type", make: swap_input::make },
    Operator { name: "swap-argument", about: "two arguments of one type swapped", make: swap_argument::make },
    Operator { name: "mix", about: "mix replaced by one of its ends", make: mix::make },
    Operator { name: "built-in", about: "a built-in replaced by a near one, or left out", make: built_in::make },
    Operator { name: "integer", about: "an integer literal moved by one", make: integer::make },
    Operator { name: "constant", about: "a literal by ±1e-4, ±1 %, ±10 %, 0, negated", make: constant::make },
    Operator { name: CONSTANT_ULP, about: "a literal moved by one ULP of binary32", make: constant_ulp::make },
];

/// All operators. Of two mutants with the same text the first operator's counts.
pub fn registry() -> &'static [Operator] {
    &OPERATORS
}

/// The operator whose mutants are no farther off than a literal that is rounded the other way. A score
/// is given without them too.
pub const CONSTANT_ULP: &str = "constant-ulp";

/// The operator with this name.
pub fn by_name(name: &str) -> Option<&'static Operator> {
    registry().iter().find(|o| o.name == name)
}

/// "`a` becomes `b`".
fn becomes(from: &str, to: &str) -> String {
    format!("`{from}` becomes `{to}`")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mutate::testing::{ALL, changes};

    #[test]
    fn names_are_unique_and_found() {
        for operator in registry() {
            assert!(std::ptr::eq(by_name(operator.name).unwrap(), operator), "{}", operator.name);
        }
        assert!(by_name("no such").is_none());
    }

    #[test]
    fn every_operator_makes_mutants_that_compile() {
        // `changes` fails on a mutant that the front end or the translator refuses.
        for operator in registry() {
            assert!(!changes(operator.name, ALL).is_empty(), "{}", operator.name);
        }
    }
}
