//! The tables of expected values notice when an instruction is wrong.

use std::collections::BTreeMap;

use super::super::domain::{Binary, Unary};
use super::functions::{Row, check, rows};
use super::operators;
use crate::interp::code::{Inst, Word2};

/// Calls `f` for each instruction, blocks included.
fn each(body: &mut Vec<Inst>, f: &mut impl FnMut(&mut Inst)) {
    for inst in body {
        f(inst);
        match inst {
            Inst::If { accept, reject, .. } => {
                each(accept, f);
                each(reject, f);
            }
            Inst::Call { body } => each(body, f),
            Inst::Loop { body, continuing, .. } => {
                each(body, f);
                each(continuing, f);
            }
            _ => {}
        }
    }
}

/// True when some row fails with the fault.
fn noticed(rows: &[Row], fault: impl Fn(&mut Inst) + Copy) -> bool {
    rows.iter().any(|row| check(row, |body| each(body, &mut { fault })).is_some())
}

#[test]
fn a_swapped_operand_order_is_noticed() {
    let rows: Vec<Row> = rows().into_iter().chain(operators::rows()).collect();
    for wrong in Binary::ALL {
        let swaps = matches!(wrong, Binary::Add | Binary::Multiply | Binary::Min | Binary::Max);
        let caught = noticed(&rows, |inst| {
            if let Inst::Real2 { op, a, b, .. } = inst
                && *op == wrong
            {
                std::mem::swap(a, b);
            }
        });
        assert_eq!(caught, !swaps, "{wrong:?}");
    }
    use Word2::*;
    for wrong in [
        SubtractSigned,
        SubtractUnsigned,
        DivideSigned,
        DivideUnsigned,
        RemainderSigned,
        RemainderUnsigned,
        ShiftLeft,
        ShiftRightSigned,
        ShiftRightUnsigned,
        LessSigned,
        LessUnsigned,
        LessEqualSigned,
        LessEqualUnsigned,
    ] {
        let caught = noticed(&rows, |inst| {
            if let Inst::Word2 { op, a, b, .. } = inst
                && *op == wrong
            {
                std::mem::swap(a, b);
            }
        });
        assert!(caught, "{wrong:?}");
    }
}

#[test]
fn a_wrong_entry_of_the_table_is_noticed() {
    let rows: Vec<Row> = rows().into_iter().chain(operators::rows()).collect();
    let mut missed = Vec::new();
    // WGSL has no `inverse`: a test of its own multiplies with one.
    for right in Unary::ALL.into_iter().filter(|op| *op != Unary::Inverse) {
        for wrong in Unary::ALL.into_iter().filter(|wrong| !wrong.equals(right)) {
            let caught = noticed(&rows, |inst| match inst {
                Inst::Real1 { op, .. } if *op == right => *op = wrong,
                _ => {}
            });
            if !caught {
                missed.push(format!("{wrong:?} for {right:?}"));
            }
        }
    }
    for right in Binary::ALL {
        for wrong in Binary::ALL.into_iter().filter(|wrong| *wrong != right) {
            let caught = noticed(&rows, |inst| match inst {
                Inst::Real2 { op, .. } if *op == right => *op = wrong,
                _ => {}
            });
            if !caught {
                missed.push(format!("{wrong:?} for {right:?}"));
            }
        }
    }
    assert_eq!(missed, Vec::<String>::new());
}

/// Instructions on two real numbers that differ.
fn pairs(body: &mut Vec<Inst>, f: &mut impl FnMut(usize, &mut u32, &mut u32)) {
    let mut place = 0;
    each(body, &mut |inst| {
        if let Inst::Real2 { a, b, .. } = inst
            && a != b
        {
            f(place, a, b);
            place += 1;
        }
    });
}

#[test]
fn an_operand_taken_twice_is_noticed_in_every_function() {
    // By function: operands caught, and all of them.
    let mut sums: BTreeMap<String, (usize, usize)> = BTreeMap::new();
    for row in rows() {
        let total = std::cell::Cell::new(0);
        check(&row, |body| pairs(body, &mut |_, _, _| total.set(total.get() + 1)));
        let mut caught = 0;
        for place in 0..total.get() {
            let first = check(&row, |body| {
                pairs(body, &mut |k, a, b| {
                    if k == place {
                        *a = *b;
                    }
                });
            });
            let second = check(&row, |body| {
                pairs(body, &mut |k, a, b| {
                    if k == place {
                        *b = *a;
                    }
                });
            });
            caught += usize::from(first.is_some() || second.is_some());
        }
        let sum = sums.entry(format!("{:?}", row.fun)).or_default();
        *sum = (sum.0 + caught, sum.1 + total.get());
    }
    for (fun, (caught, total)) in sums {
        // Some operands do not matter at the values of the rows: bounds that do not bind, zeros.
        assert!(2 * caught >= total, "{fun}: {caught} of {total}");
    }
}
