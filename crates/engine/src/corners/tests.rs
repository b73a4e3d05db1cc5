//! Of the table itself.

use std::collections::BTreeSet;

use judge::profile::Op;
use syntax::BuiltinFunction;

use super::*;

#[test]
fn every_row_is_read_and_its_languages_have_texts_and_sections() {
    let mut names = BTreeSet::new();
    for row in rows() {
        assert!(names.insert(row.name), "{} stands twice", row.name);
        assert!(Language::ALL.iter().any(|&language| row.text(language).is_some()), "{}", row.name);
        for language in Language::ALL.into_iter().filter(|&language| row.text(language).is_some()) {
            assert!(!row.section(language).is_empty(), "{} in {language}", row.name);
            let cases = row.cases(language);
            for (corner, case) in cases {
                let (right, wrong) = case.samples(row.types()[0].0);
                assert!(right.iter().all(|&word| case.allows(word, row.types()[0].0)), "{}: {corner:?}", row.name);
                let both = case.values == Values::OneOf(vec![1, 0]) && row.types()[0].0 == Scalar::Bool;
                assert!(wrong.is_empty() == (case.values == Values::Any || both), "{}: {corner:?} {case:?}", row.name);
            }
        }
    }
}

#[test]
fn rows_on_numbers_say_what_becomes_of_zeros_and_of_subnormal_ones() {
    for row in rows() {
        let has = |corner: Corner| row.cells.iter().any(|cell| cell.corner == corner);
        let types = row.types();
        if types[1..].iter().any(|(scalar, _)| *scalar == Scalar::F32) {
            assert!(has(Corner::Zero) && has(Corner::Subnormal), "{}", row.name);
        }
        if types.len() == 3 && types[1] == types[2] && types[1].0 == Scalar::F32 {
            assert!(has(Corner::Equal), "{}: equal operands", row.name);
        }
    }
}

#[test]
fn every_name_leads_to_a_row_and_every_row_has_a_name() {
    let mut named: BTreeSet<&str> = BTreeSet::new();
    named.extend(BuiltinFunction::ALL.iter().flat_map(|&function| of_function(function)).copied());
    named.extend(Op::ALL.iter().flat_map(|&op| of_operation(op)).copied());
    // naga has no list of its own.
    use naga::{BinaryOperator as B, MathFunction as M, UnaryOperator as U};
    let math = [
        M::QuantizeToF16,
        M::CountTrailingZeros,
        M::CountLeadingZeros,
        M::ExtractBits,
        M::InsertBits,
        M::FirstLeadingBit,
        M::Dot4I8Packed,
        M::Dot4U8Packed,
        M::Pack4xI8,
        M::Pack4xU8,
        M::Pack4xI8Clamp,
        M::Pack4xU8Clamp,
        M::Unpack4xI8,
        M::Unpack4xU8,
    ];
    named.extend(math.iter().flat_map(|&function| of_math(function)).copied());
    let binary = [
        B::Add,
        B::Subtract,
        B::Multiply,
        B::Divide,
        B::Modulo,
        B::And,
        B::ExclusiveOr,
        B::InclusiveOr,
        B::ShiftLeft,
        B::ShiftRight,
    ];
    named.extend(binary.iter().flat_map(|&operator| of_binary(operator)).copied());
    named.extend([U::Negate, U::BitwiseNot].iter().flat_map(|&operator| of_unary(operator)).copied());
    let rows: BTreeSet<&str> = rows().map(|row| row.name).collect();
    assert_eq!(named, rows);
}

#[test]
fn what_cannot_be_read_is_told() {
    let types = [(Scalar::F32, 1), (Scalar::F32, 1)];
    for text in ["1", "1 2 = 3", "one = 1", "1 = one"] {
        assert!(Case::read(text, &types).is_err(), "{text}");
    }
    assert_eq!(Case::read("1 = any", &types).unwrap().values, Values::Any);
    assert_eq!(Case::read("1 ~ 2 | 3", &types).unwrap().values, Values::Near(vec![2.0, 3.0]));
    assert_eq!(Case::read("1 = 0x40000000", &types).unwrap().values, Values::OneOf(vec![2_f32.to_bits()]));
}
