//! Rows of settings in which every value of every option occurs, and every pair of values of two options that stand in
//! one condition.
//!
//! Each value that a line could have instead of its own is a column of bits, one for each row. Of two columns in which a few
//! more than half of the bits are set, and not the same ones, both are set in some row, and each without the other in
//! some: *n* rows do for as many options as there are ways to choose these bits (Kleitman and Spencer, Families of
//! k-independent sets, 1973), 12 for 500 options. That neither is set is the text as it stands.

use std::collections::{BTreeSet, HashSet};

use syntax::Setting;

use super::switch::Switch;

/// A value that a switch could have: its index, and that of the value.
type Value = (usize, usize);

/// Rows of settings, each in the order of the text; the text as it stands is the one that is missing. Pairs in one condition
/// that have stood `together` in another text are left to that.
pub(super) fn rows(
    switches: &[Switch],
    pairs: &BTreeSet<(usize, usize)>,
    together: &mut HashSet<Vec<Setting>>,
) -> Vec<Vec<Setting>> {
    let columns: Vec<Value> =
        switches.iter().enumerate().flat_map(|(s, switch)| (0..switch.others.len()).map(move |v| (s, v))).collect();
    let count = rows_for(columns.len());
    let mut rows: Vec<Vec<Value>> = vec![Vec::new(); count];
    for (column, bits) in columns.iter().zip(columns_of(count)) {
        for (row, _) in rows.iter_mut().zip(bits).filter(|(_, bit)| *bit) {
            row.push(*column);
        }
    }
    // A switch has one value: which of several it has alternates.
    for (index, row) in rows.iter_mut().enumerate() {
        let all = std::mem::take(row);
        for same in all.chunk_by(|a, b| a.0 == b.0) {
            row.push(same[index % same.len()]);
        }
    }
    let setting = |&(s, v): &Value| switches[s].set(v);
    // The same option stands elsewhere in every text.
    let anywhere = |value: &Value| Setting { at: None, ..setting(value) };
    let mut missing = missing(&rows, switches, &columns, pairs);
    missing.retain(|wanted| wanted.len() == 1 || together.insert(wanted.iter().map(anywhere).collect()));
    // What is missing goes into further rows, as much as fits into each.
    while !missing.is_empty() {
        let mut row: Vec<Value> = Vec::new();
        missing.retain(|wanted| {
            let fits = wanted.iter().all(|value| !row.iter().any(|own| own.0 == value.0 && own.1 != value.1));
            if fits {
                row.extend(wanted.iter().filter(|value| !row.contains(value)).copied().collect::<Vec<_>>());
            }
            !fits
        });
        rows.push(row);
    }
    rows.retain(|row| !row.is_empty());
    let settings = |row: &Vec<Value>| {
        let mut row: Vec<Setting> = row.iter().map(setting).collect();
        row.sort();
        row
    };
    rows.iter().map(settings).collect()
}

/// Values, and pairs of values in one condition, that stand in no row together.
fn missing(
    rows: &[Vec<Value>],
    switches: &[Switch],
    columns: &[Value],
    pairs: &BTreeSet<(usize, usize)>,
) -> Vec<Vec<Value>> {
    let stands = |wanted: &[Value]| rows.iter().any(|row| wanted.iter().all(|value| row.contains(value)));
    let single = columns.iter().map(|value| vec![*value]);
    let values = |s: usize| (0..switches[s].others.len()).map(move |v| (s, v));
    let both =
        pairs.iter().flat_map(|(a, b)| values(*a).flat_map(|first| values(*b).map(move |second| vec![first, second])));
    single.chain(both).filter(|wanted| !stands(wanted)).collect()
}

/// The fewest rows that do for so many columns.
fn rows_for(columns: usize) -> usize {
    (1..).find(|rows| ways(*rows, rows / 2 + 1) >= columns).unwrap_or(columns)
}

/// In how many ways `some` of `all` are chosen.
fn ways(all: usize, some: usize) -> usize {
    (0..some).fold(1_usize, |ways, k| ways.saturating_mul(all - k) / (k + 1))
}

/// All columns of so many bits of which a few more than half are set, in the order of their numbers.
fn columns_of(rows: usize) -> impl Iterator<Item = Vec<bool>> {
    let half = u32::try_from(rows / 2 + 1).unwrap_or(0);
    let numbers = (0_u32..1 << rows.min(31)).filter(move |number| number.count_ones() == half);
    numbers.map(move |number| (0..rows).map(|bit| number >> bit & 1 == 1).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use base::text::Span;

    fn switches(values: &[usize]) -> Vec<Switch> {
        let switch = |(at, many): (usize, &usize)| Switch {
            name: format!("S{at}"),
            at: Some(at),
            span: Some(Span::at(at)),
            others: (0..*many).map(|v| Some(v.to_string())).collect(),
            listed: true,
            stated: true,
        };
        values.iter().enumerate().map(switch).collect()
    }

    #[test]
    fn five_hundred_options_take_few_rows_and_all_pairs_of_them_occur() {
        let switches = switches(&[1; 500]);
        let rows = rows(&switches, &BTreeSet::new(), &mut HashSet::new());
        assert!(rows.len() <= 12, "{} rows", rows.len());
        let has = |row: &[Setting], at: usize| row.iter().any(|s| s.at == Some(at));
        for (a, b) in [(0, 1), (17, 400), (498, 499), (250, 3)] {
            for wanted in [(true, true), (true, false), (false, true)] {
                assert!(rows.iter().any(|row| (has(row, a), has(row, b)) == wanted), "{a} {b} {wanted:?}");
            }
        }
    }

    #[test]
    fn all_values_and_the_pairs_of_one_condition_occur() {
        let switches = switches(&[3, 4, 1, 2]);
        let pairs = BTreeSet::from([(0, 1), (1, 3)]);
        let rows = rows(&switches, &pairs, &mut HashSet::new());
        let has = |row: &[Setting], s: usize, v: usize| row.contains(&switches[s].set(v));
        for (s, switch) in switches.iter().enumerate() {
            for v in 0..switch.others.len() {
                assert!(rows.iter().any(|row| has(row, s, v)), "{s} = {v}");
            }
        }
        for (a, b) in pairs {
            for (v, w) in (0..switches[a].others.len()).flat_map(|v| (0..switches[b].others.len()).map(move |w| (v, w)))
            {
                assert!(rows.iter().any(|row| has(row, a, v) && has(row, b, w)), "{a} = {v}, {b} = {w}");
            }
        }
        for row in &rows {
            let names: BTreeSet<&str> = row.iter().map(|s| s.name.as_str()).collect();
            assert_eq!(names.len(), row.len(), "one value for each option");
        }
    }
}
