//! Faults in formulas: what the shipped suites compare with is wrong, and the shaders are right.

use chapter::formula::{all, by_name};
use engine::suite::run::{FindingKind, Report};
use judge::formula::{Args, Emission, Formula, Rule};
use judge::verdict::Reference;

use super::lanes::reports_of;
use crate::support::prepared;

/// Runs a shipped suite against another rule in place of its formula.
fn against(suite: &str, rule: Rule) -> Vec<Report> {
    let mut prepared = prepared(suite);
    let right = prepared.reference.formula().unwrap();
    let Formula { name, source, inputs, outputs, .. } = *right;
    // A reference takes a formula that lives as long as the program; a few of them may.
    let wrong = Box::leak(Box::new(Formula { name, source, inputs, outputs, rule }));
    prepared.reference = Reference::new(wrong, &prepared.program).unwrap();
    reports_of(&prepared, |_| {}).into_iter().map(Result::unwrap).collect()
}

/// The outputs of the formula with this index, times `1 + 10^-4`.
fn off<const N: usize>(args: &Args<'_>, out: &mut [f64]) {
    if let Rule::Pointwise(rule) = all()[N].rule {
        rule(args, out);
    }
    out.iter_mut().for_each(|word| *word *= 1.0001);
}

/// The same for a formula that emits vertices.
fn off_vertices<const N: usize>(args: &Args<'_>, out: &mut Emission) {
    if let Rule::Emission(rule) = all()[N].rule {
        rule(args, out);
    }
    out.words.iter_mut().for_each(|word| *word *= 1.0001);
}

/// A rule for each index of a formula.
macro_rules! rules {
    ($($index:literal)*) => { [$((off::<$index> as fn(&Args<'_>, &mut [f64]), off_vertices::<$index> as fn(&Args<'_>, &mut Emission))),*] };
}

#[test]
fn one_part_in_ten_thousand_is_found_in_every_suite() {
    let rules = rules!(0 1 2 3 4 5 6 7 8 9 10 11 12 13);
    for shipped in engine::suite::shipped() {
        let formula = prepared(shipped.name).reference.formula().unwrap();
        let index = all().iter().position(|f| f.name == formula.name).unwrap();
        let (pointwise, emission) = rules[index];
        let rule = match formula.rule {
            Rule::Pointwise(_) => Rule::Pointwise(pointwise),
            Rule::Emission(_) => Rule::Emission(emission),
        };
        for report in against(shipped.name, rule) {
            let share = report.verdicts.deviated as f64 / report.verdicts.seen() as f64;
            // Shader and formula are compared in binary64: nothing but an output of 0 hides the factor.
            assert!(share > 0.9, "{}: only {share} of the samples deviate", shipped.name);
            assert_eq!(report.verdicts.shader_deviated, report.verdicts.deviated, "{}", shipped.name);
            assert_eq!(report.findings[0].kind, FindingKind::Deviation);
            let message = &report.findings[0].message;
            assert!(message.starts_with("the shader deviates from its formula: "), "{message}");
        }
    }
}

/// The sphere with the first two columns of the matrix swapped.
fn swapped_columns(args: &Args<'_>, out: &mut [f64]) {
    let formula = by_name("sphere").unwrap();
    let (parameter, matrix) = (args.vec2(0), args.mat4(1));
    let columns = [matrix.y_axis, matrix.x_axis, matrix.z_axis, matrix.w_axis];
    let words: Vec<f64> = parameter.to_array().into_iter().chain(columns.iter().flat_map(|c| c.to_array())).collect();
    if let Rule::Pointwise(rule) = formula.rule {
        rule(&Args::new(formula.inputs, &words), out);
    }
}

#[test]
fn swapped_columns_are_found() {
    for report in against("sphere", Rule::Pointwise(swapped_columns)) {
        assert!(report.verdicts.deviated > report.verdicts.agreed);
    }
}

/// The strand of hair whose last vertex is at the first one.
fn wrong_last_vertex(args: &Args<'_>, out: &mut Emission) {
    let formula = by_name("hair").unwrap();
    if let Rule::Emission(rule) = formula.rule {
        rule(args, out);
    }
    let last = out.words.len() - out.words.len() / out.strips.len();
    out.words.copy_within(..4, last);
}

#[test]
fn a_wrong_last_vertex_is_found() {
    for report in against("hair", Rule::Emission(wrong_last_vertex)) {
        assert!(report.findings[0].message.contains("of vertex 4 is "), "{}", report.findings[0].message);
    }
}

/// The sphere with w = 0 before the matrix.
fn without_w(args: &Args<'_>, out: &mut [f64]) {
    if let Rule::Pointwise(rule) = by_name("sphere").unwrap().rule {
        rule(args, out);
    }
    let w = args.mat4(1).w_axis.to_array();
    out.iter_mut().zip(w).for_each(|(word, w)| *word -= w);
}

#[test]
fn a_wrong_w_is_found() {
    for report in against("sphere", Rule::Pointwise(without_w)) {
        assert!(report.findings[0].message.contains("`gl_Position.w` is "), "{}", report.findings[0].message);
    }
}
