//! What is wrong with packages: those that advisories are known of, and those that are locked in several versions, are in
//! `deny.toml` with a reason. The database of advisories is no package, so that what is known of it is written down here.

use std::collections::{BTreeMap, BTreeSet};

use super::{file, project};

/// Crates that are not maintained, whatever their version, with the advisory of RustSec.
const KNOWN: [(&str, &str); 16] = [
    ("adler", "RUSTSEC-2025-0056"),
    ("ansi_term", "RUSTSEC-2021-0139"),
    ("atty", "RUSTSEC-2024-0375"),
    ("backoff", "RUSTSEC-2025-0012"),
    ("bincode", "RUSTSEC-2025-0141"),
    ("derivative", "RUSTSEC-2024-0388"),
    ("encoding", "RUSTSEC-2021-0153"),
    ("fxhash", "RUSTSEC-2025-0057"),
    ("instant", "RUSTSEC-2024-0384"),
    ("mach", "RUSTSEC-2020-0168"),
    ("net2", "RUSTSEC-2020-0016"),
    ("number_prefix", "RUSTSEC-2025-0119"),
    ("paste", "RUSTSEC-2024-0436"),
    ("proc-macro-error", "RUSTSEC-2024-0370"),
    ("serde_cbor", "RUSTSEC-2021-0127"),
    ("yaml-rust", "RUSTSEC-2024-0320"),
];

/// What is wrong between the locked packages and the advisories that are accepted.
fn faults(lock: &str, deny: &str) -> Vec<String> {
    let table = |text: &str| text.parse::<toml::Table>().expect("TOML");
    let (lock, deny) = (table(lock), table(deny));
    let list = |value: Option<&toml::Value>| value.and_then(toml::Value::as_array).cloned().unwrap_or_default();
    let text = |value: &toml::Value, key: &str| value.get(key).and_then(toml::Value::as_str).unwrap_or("").to_owned();
    let packages: BTreeSet<String> = list(lock.get("package")).iter().map(|package| text(package, "name")).collect();
    let accepted = list(deny.get("advisories").and_then(|advisories| advisories.get("ignore")));
    let reason = |id: &str| accepted.iter().find(|entry| text(entry, "id") == id).map(|entry| text(entry, "reason"));
    let mut faults = Vec::new();
    for (name, id) in KNOWN.into_iter().filter(|(name, _)| packages.contains(*name)) {
        if reason(id).is_none_or(|reason| reason.is_empty()) {
            faults.push(format!("Cargo.lock has `{name}` ({id}), which deny.toml does not accept with a reason"));
        }
    }
    for id in accepted.iter().map(|entry| text(entry, "id")) {
        if !KNOWN.iter().any(|(name, known)| *known == id && packages.contains(*name)) {
            faults.push(format!("deny.toml accepts {id}, which is about no package of Cargo.lock"));
        }
    }
    faults
}

/// What is wrong between the packages that are locked in several versions and those that `deny.toml` skips.
fn doubles(lock: &str, deny: &str) -> Vec<String> {
    let table = |text: &str| text.parse::<toml::Table>().expect("TOML");
    let (lock, deny) = (table(lock), table(deny));
    let list = |value: Option<&toml::Value>| value.and_then(toml::Value::as_array).cloned().unwrap_or_default();
    let text = |value: &toml::Value, key: &str| value.get(key).and_then(toml::Value::as_str).unwrap_or("").to_owned();
    let skipped: BTreeMap<String, String> = list(deny.get("bans").and_then(|bans| bans.get("skip")))
        .iter()
        .map(|entry| (text(entry, "crate"), text(entry, "reason")))
        .collect();
    let mut locked: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for package in list(lock.get("package")) {
        locked.entry(text(&package, "name")).or_default().push(text(&package, "version"));
    }
    let several = |name: &str| locked.get(name).is_some_and(|versions| versions.len() > 1);
    let mut faults = Vec::new();
    for (name, versions) in locked.iter().filter(|(name, _)| several(name)) {
        let with_reason = |version: &&String| skipped.get(&format!("{name}@{version}")).is_some_and(|r| !r.is_empty());
        if versions.iter().filter(with_reason).count() + 1 != versions.len() {
            let versions = versions.join(", ");
            faults.push(format!("`{name}` is locked in {versions}: deny.toml gives a reason for all but one of them"));
        }
    }
    let known = |entry: &str| {
        entry.split_once('@').is_some_and(|(name, version)| several(name) && locked[name].iter().any(|v| v == version))
    };
    faults.extend(
        skipped
            .keys()
            .filter(|entry| !known(entry))
            .map(|entry| format!("deny.toml skips `{entry}`, which is no double")),
    );
    faults
}

#[test]
fn no_package_has_two_versions_without_a_reason() {
    let files = project();
    let text = |path: &str| file(&files, path).text.clone();
    assert_eq!(doubles(&text("Cargo.lock"), &text("deny.toml")), Vec::<String>::new());
}

#[test]
fn a_second_version_and_a_reason_for_none_are_reported() {
    let package = |version: &str| format!("[[package]]\nname = 'syn'\nversion = '{version}'\n");
    let two = package("1.0.0") + &package("2.0.0");
    let deny = |entries: &str| format!("[bans]\nskip = [{entries}]\n");
    assert_eq!(doubles(&two, &deny("")).len(), 1);
    assert_eq!(doubles(&two, &deny("{ crate = 'syn@1.0.0', reason = '' }")).len(), 1);
    assert_eq!(doubles(&two, &deny("{ crate = 'syn@1.0.0', reason = 'r' }")), Vec::<String>::new());
    assert_eq!(doubles(&package("2.0.0"), &deny("{ crate = 'syn@1.0.0', reason = 'r' }")).len(), 1);
}

#[test]
fn known_advisories_are_accepted_with_a_reason() {
    let files = project();
    let text = |path: &str| file(&files, path).text.clone();
    assert_eq!(faults(&text("Cargo.lock"), &text("deny.toml")), Vec::<String>::new());
}

#[test]
fn a_package_with_an_advisory_and_one_that_is_gone_are_reported() {
    let lock = "[[package]]\nname = 'atty'\nversion = '0.2.14'\n";
    let deny = |entries: &str| format!("[advisories]\nignore = [{entries}]\n");
    assert_eq!(faults(lock, &deny("")).len(), 1);
    assert_eq!(faults(lock, &deny("{ id = 'RUSTSEC-2024-0375', reason = '' }")).len(), 1);
    assert_eq!(faults(lock, &deny("{ id = 'RUSTSEC-2024-0375', reason = 'r' }")), Vec::<String>::new());
    assert_eq!(faults("", &deny("{ id = 'RUSTSEC-2024-0375', reason = 'r' }")).len(), 1);
}
