//! The table `[dispatch]`.

use super::super::dispatch::{Count, Dispatching};
use super::super::expect::Define;
use super::{Stage, expect};
use disk::table::{At, Table};

/// How a compute stage is dispatched; none for other stages.
pub(super) fn dispatch(root: Table<'_>, stage: Option<Stage>) -> Option<Dispatching> {
    let given = root.has("dispatch");
    match stage {
        Some(Stage::Compute) if !given => {
            let message = "a compute stage needs a table [dispatch] that says how many workgroups there are and how long \
                           buffers are";
            root.reader.problem(root.offset_of("stage"), message);
            return None;
        }
        Some(other) if given && other != Stage::Compute => {
            let message = format!("[dispatch] is for a compute stage; this suite has the stage `{}`", other.name());
            root.reader.problem(root.offset_of("dispatch"), message);
            return None;
        }
        _ if !given => return None,
        _ => {}
    }
    let table = root.table("dispatch", "[dispatch]")?.only(&["sizes", "groups", "lengths"]);
    if !table.has("groups") {
        let message = "`groups` is missing: workgroups along x, y and z, such as groups = [\"(N + 63) / 64\"]";
        table.reader.problem(table.offset, message);
    }
    let groups = groups(table);
    let mut lengths = Vec::new();
    if let Some(of) = table.has("lengths").then(|| table.table("lengths", "[dispatch.lengths]")).flatten() {
        for At { value: name, offset } in of.keys() {
            match <[Count; 1]>::try_from(counts(of, name)) {
                Ok([count]) => lengths.push((name.to_owned(), count)),
                Err(_) => of.reader.problem(offset, format!("`{name}` needs one number of elements")),
            }
        }
    }
    let sizes = if table.has("sizes") { sizes(table) } else { Vec::new() };
    let at = table.reader.locate(table.offset);
    let dispatching = Dispatching { sizes, groups, lengths, inputs: Vec::new(), at };
    // Counts that have no value are told here, for the first of all sizes.
    let first = dispatching.first();
    for count in dispatching.groups.iter().chain(dispatching.lengths.iter().map(|(_, count)| count)) {
        if let Err(what) = count.value(&first) {
            table.reader.problem(table.offset, unplaced(count, what));
        }
    }
    Some(dispatching)
}

/// Workgroups along three axes at most.
pub(super) fn groups(table: Table<'_>) -> Vec<Count> {
    let all = counts(table, "groups");
    if all.len() > 3 {
        table.reader.problem(table.offset_of("groups"), "workgroups lie along three axes at most");
    }
    all
}

/// Numbers by expressions of sizes.
fn counts(table: Table<'_>, key: &str) -> Vec<Count> {
    let terms = table.terms(key).into_iter();
    terms.map(|At { value: text, offset }| Count { text, at: table.reader.locate(offset) }).collect()
}

/// Numbers of a group of inputs, such as `values = ["N"]` and `range = [0, "N - 1"]`: those for the first of all sizes, and
/// for a compute stage the expressions from which those for other sizes follow.
pub(super) fn numbers(table: Table<'_>, key: &str, dispatch: Option<&Dispatching>) -> (Vec<f64>, Vec<Count>) {
    let Some(dispatch) = dispatch.filter(|_| table.has_text_in(key)) else {
        return (table.numbers(key), Vec::new());
    };
    let (counts, first) = (counts(table, key), dispatch.first());
    let value = |count: &Count| match count.number(&first) {
        Ok(value) => value,
        Err(what) => {
            table.reader.problem(table.offset_of(key), unplaced(count, what));
            0.0
        }
    };
    (counts.iter().map(value).collect(), counts)
}

/// What is wrong with a count, for a reader that gives the place itself.
fn unplaced(count: &Count, what: String) -> String {
    what.strip_prefix(&format!("{}: ", count.at)).map_or(what.clone(), str::to_owned)
}

/// Sizes: whole numbers, or a range of which the awkward ones are taken.
fn sizes(table: Table<'_>) -> Vec<Define> {
    let Some(of) = table.table("sizes", "[dispatch.sizes]") else { return Vec::new() };
    let mut all = Vec::new();
    for At { value: name, offset } in of.keys() {
        let values: Vec<String> = if of.is_table(name) {
            let Some(range) = of.table(name, "a range of sizes") else { continue };
            let range = range.only(&["from", "to"]);
            let (from, to) = (range.whole("from", 0, MOST), range.whole("to", 1, MOST));
            let (Some(from), Some(to)) = (from, to) else {
                of.reader.problem(offset, format!("the range of `{name}` has both ends: {{ from = 1, to = 300 }}"));
                continue;
            };
            awkward(from, to).into_iter().map(|size| size.to_string()).collect()
        } else {
            of.words(name).into_iter().flatten().collect()
        };
        if let Some(odd) = values.iter().find(|value| value.parse::<u32>().is_err()) {
            of.reader.problem(offset, format!("the size `{name}` is `{odd}`, which is no whole number"));
            continue;
        }
        if !expect::is_macro(name) {
            of.reader.problem(offset, format!("`{name}` cannot be the name of a size"));
            continue;
        }
        all.push(Define { name: name.to_owned(), values: values.into_iter().map(Some).collect() });
    }
    all
}

/// Elements of a buffer at most.
const MOST: u64 = 1 << 24;

/// Sizes of a range at which kernels go wrong: its ends, those around whole workgroups, and a prime number.
fn awkward(from: u64, to: u64) -> Vec<u64> {
    let around = (5..14).map(|k| 1 << k).flat_map(|n: u64| [n - 1, n, n + 1]);
    let mut all: Vec<u64> =
        [from, to, 1, 2, 97].into_iter().chain(around).filter(|n| (from..=to).contains(n)).collect();
    all.sort_unstable();
    all.dedup();
    // The smallest and the largest ones tell most.
    if all.len() > 12 {
        all.drain(8..all.len() - 4);
    }
    all
}
