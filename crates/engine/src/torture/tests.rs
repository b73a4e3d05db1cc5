use std::collections::BTreeMap;

use super::*;
use crate::adversary::{Adversary, Fault, Strategy};
use crate::session::Join;
use crate::suite::run::Peer;
use judge::profile::{Op, Promises, by_name};
use lanes::Stage;

const ANY: Wish = Wish { language: None };

#[test]
fn a_seed_and_a_number_give_one_program() {
    for index in 0..50 {
        assert_eq!(generate(7, index, ANY), generate(7, index, ANY));
    }
    assert_ne!(generate(7, 0, ANY), generate(8, 0, ANY));
}

#[test]
fn every_kind_of_construct_is_reached() {
    let mut counts: BTreeMap<(Language, String), usize> = BTreeMap::new();
    for index in 0..3000 {
        let program = generate(1, index, ANY);
        for kind in program.kinds() {
            *counts.entry((program.language, kind)).or_default() += 1;
        }
    }
    let mut missing = Vec::new();
    for language in Language::ALL {
        let constructs = [
            "function",
            "vertex",
            "fragment",
            "compute",
            "uniform",
            "declare",
            "assign",
            "assign a part",
            "if",
            "for",
            "loop",
            "switch",
            "break",
            "continue",
            "early return",
            "pointer",
            "pointer to a part",
            "exchange",
            "atomic",
            "literal",
            "read",
            "construct vector",
            "construct matrix",
            "construct array",
            "construct structure",
            "member",
            "element",
            "swizzle",
            "call",
        ];
        let rows = OPERATIONS.iter().filter(|row| row.template(language).is_some()).map(|row| row.name);
        for kind in constructs.into_iter().chain(rows) {
            if counts.get(&(language, kind.to_owned())).copied().unwrap_or(0) < 2 {
                missing.push(format!("{}: {kind}", language.name()));
            }
        }
    }
    assert_eq!(missing, Vec::<String>::new());
}

#[test]
fn programs_are_taken_by_our_own_front_ends() {
    let mut refused = Vec::new();
    for index in 0..400 {
        let program = generate(2, index, ANY);
        let outcome = trial(&program, &[], &Asked::default(), false, &BTreeMap::new());
        if let Some((who, why)) = outcome.refused.first() {
            refused.push(format!("{index}: {who}: {why}\n{}", print(&program, NAME).text));
        }
    }
    assert!(
        refused.is_empty(),
        "{} refused\n{}",
        refused.len(),
        refused.iter().take(5).cloned().collect::<Vec<_>>().join("\n")
    );
}

/// What programs show on one device that errs as far as Vulkan allows, with a fault or without.
fn on_a_device(fault: Option<Fault>, programs: u64) -> Found {
    let vulkan = by_name("vulkan-1.4").unwrap();
    let promises = Promises { text: vulkan, conformance: None, measured: None };
    let mut device = Adversary::lane(vulkan, Stage::Compute, Strategy::Extreme, 1, false);
    if let Some(fault) = fault {
        device = device.with_fault(fault);
    }
    let peers = [Peer { lane: &device, promises: &promises }];
    let (mut found, asked) = (Found::default(), Asked { samples: 16, ..Asked::default() });
    (0..programs).for_each(|index| assert!(found.program(index, &peers, &asked)));
    found
}

#[test]
fn a_wrong_built_in_is_found_made_small_and_told_once() {
    let found = on_a_device(Some(Fault { op: Op::Sin, factor: 4.0 }), 150);
    let built_in: Vec<&Cause> = found.causes.iter().filter(|cause| cause.key.contains("built-in")).collect();
    let [cause] = built_in[..] else { panic!("{:#?}", found.causes) };
    assert!(cause.key.contains("built-in sin"), "{cause:#?}");
    let text = cause.folder.text();
    assert!(text.contains("sin(") && text.lines().count() <= 6, "{text}");
    let (_, report) = cause.folder.files.iter().find(|(name, _)| name == "report.md").unwrap();
    assert!(report.contains(text.trim()) && report.contains("**Actual.**"), "{report}");
    assert!(report.contains("x0") && report.contains("--case '"), "{report}");
}

#[test]
fn a_device_without_a_fault_is_silent() {
    let found = on_a_device(None, 150);
    // A device that errs as far as it may takes the other side of a jump (`frexp`, `faceforward`), which no built-in is
    // blamed for.
    let built_in: Vec<&Cause> = found.causes.iter().filter(|cause| cause.key.contains("built-in")).collect();
    assert!(built_in.is_empty(), "{built_in:#?}");
    assert!(found.agreed > 1000 && found.vacuous < 50, "{found:#?}");
}

#[test]
fn parts_together_are_the_whole() {
    let fault = Some(Fault { op: Op::Sin, factor: 4.0 });
    let vulkan = by_name("vulkan-1.4").unwrap();
    let promises = Promises { text: vulkan, conformance: None, measured: None };
    let device = Adversary::lane(vulkan, Stage::Compute, Strategy::Extreme, 1, false);
    let device = fault.map_or(device.clone(), |fault| device.with_fault(fault));
    let peers = [Peer { lane: &device, promises: &promises }];
    let asked = Asked { samples: 16, ..Asked::default() };
    let part = |index: u64| {
        let mut found = Found::default();
        (0..60).filter(|k| k % 2 == index).for_each(|k| assert!(found.program(k, &peers, &asked)));
        found
    };
    let whole = on_a_device(fault, 60);
    for order in [[0, 1], [1, 0]] {
        let mut joined = part(order[0]);
        joined.join(part(order[1])).unwrap();
        assert_eq!((joined.programs, joined.agreed, joined.lanes.clone()), (60, whole.agreed, whole.lanes.clone()));
        let told = |found: &Found| found.causes.iter().map(|c| (c.key.clone(), c.count, c.program)).collect::<Vec<_>>();
        assert_eq!(told(&joined), told(&whole));
    }
}

#[test]
fn what_shows_in_code_that_nothing_uses_is_kept_while_it_shows() {
    // Translators read dead code as well: of such a fault the smallest program still has the code.
    let program = generate(4242, 92, ANY);
    let called = |program: &Program| print(program, "repro").text.contains("h1(&v2[");
    assert!(called(&program) && !called(&super::shrink::tidy(program.clone())), "it is dead code");
    let small = super::shrink::shrink(program.clone(), 400, &mut |candidate| called(candidate));
    assert!(called(&small.program), "{}", print(&small.program, "repro").text);
    assert!(small.program.size() < program.size());
}
