//! `relations`: names of relations that come with the crate, and laws.

use super::{Names, known};
use disk::table::{At, Item, Table};
use property::law::{Law, LawKind};

/// The relations and laws of a suite, in their order.
pub(super) fn relations(root: Table<'_>, names: &Names) -> (Vec<String>, Vec<Law>) {
    let (mut named, mut laws) = (Vec::new(), Vec::new());
    for item in root.texts_or_tables("relations", "[[relations]]") {
        match item {
            Item::Text(given) => {
                named.extend(known(root, "relation", &given, names.relations.iter().map(String::as_str)));
            }
            Item::Table(table) => laws.extend(law(table)),
        }
    }
    (named, laws)
}

/// Keys of each kind, beside `kind` and `outputs`.
fn keys(kind: &str) -> &'static [&'static str] {
    match kind {
        "periodic" => &["inputs", "period"],
        "monotone" => &["inputs", "direction"],
        "range" => &["range"],
        "unit" => &[],
        "rigid" => &["points", "directions", "mirrored"],
        "scales" => &["inputs", "degree"],
        "sorts" => &["inputs", "direction"],
        "sums" => &["total", "rows"],
        // odd, even, symmetric, unordered, prefix, additive
        _ => &["inputs"],
    }
}

fn law(table: Table<'_>) -> Option<Law> {
    let given = table.required_text("kind", "kind = \"odd\"")?;
    let kind = known(table, "kind", &given, LawKind::NAMES.into_iter())?;
    let table = table.only(&[&["kind", "outputs"], keys(&kind)].concat());
    let outputs = table.texts("outputs").into_iter().map(|t| t.value).collect();
    let at = table.reader.locate(table.offset);
    let kind = match kind.as_str() {
        "odd" => LawKind::Odd { inputs: inputs(table, 1)? },
        "even" => LawKind::Even { inputs: inputs(table, 1)? },
        "periodic" => {
            let (inputs, period) = (inputs(table, 1), period(table));
            LawKind::Periodic { inputs: inputs?, period: period? }
        }
        "monotone" => {
            let (input, rising) = (input(table, &kind), rising(table));
            LawKind::Monotone { input: input?, rising: rising? }
        }
        "sorts" => {
            let (input, rising) =
                (input(table, &kind), if table.has("direction") { rising(table) } else { Some(true) });
            LawKind::Sorts { input: input?, rising: rising? }
        }
        "sums" => {
            if !table.has("total") {
                table.missing("total", "total = 1.0");
            }
            let (total, rows) = (table.number("total"), table.whole("rows", 1, MOST_ROWS));
            LawKind::Sums { total: total?.value, rows: rows.unwrap_or(1) as usize }
        }
        "unordered" => LawKind::Unordered { inputs: inputs(table, 1)? },
        "prefix" => LawKind::Prefix { inputs: inputs(table, 1)? },
        "additive" => LawKind::Additive { inputs: inputs(table, 1)? },
        "range" => {
            if !table.has("range") {
                table.missing("range", "range = [0.0, 1.0]");
            }
            LawKind::Range { range: super::range(table, table.numbers("range"))? }
        }
        "unit" => LawKind::Unit,
        "symmetric" => LawKind::Symmetric { inputs: inputs(table, 2)? },
        "rigid" => {
            let list = |key| table.texts(key).into_iter().map(|t| t.value).collect::<Vec<_>>();
            let (points, directions) = (list("points"), list("directions"));
            if !table.has("points") && !table.has("directions") {
                table.missing("points", "points = [\"p\", \"gl_Position\"]");
                return None;
            }
            LawKind::Rigid { points, directions, mirrored: table.flag("mirrored").unwrap_or(false) }
        }
        _ => {
            let inputs = inputs(table, 1);
            let degree = table.signed("degree", -8, 8);
            if !table.has("degree") {
                table.missing("degree", "degree = 1");
            }
            LawKind::Scales { inputs: inputs?, degree: degree? as i32 }
        }
    };
    Some(Law { kind, outputs, at })
}

/// Rows of an array at most.
const MOST_ROWS: u64 = 1 << 20;

/// The one input of a law.
fn input(table: Table<'_>, kind: &str) -> Option<String> {
    let mut inputs = inputs(table, 1)?;
    if inputs.len() > 1 {
        let message = format!("`inputs` of the law `{kind}` names one input; state one law for each");
        table.reader.problem(table.offset_of("inputs"), message);
    }
    Some(inputs.swap_remove(0))
}

fn inputs(table: Table<'_>, least: usize) -> Option<Vec<String>> {
    let example = if least > 1 { "inputs = [\"a\", \"b\"]" } else { "inputs = [\"x\"]" };
    if !table.has("inputs") {
        table.missing("inputs", example);
        return None;
    }
    let names: Vec<String> = table.texts("inputs").into_iter().map(|t| t.value).collect();
    if names.len() < least {
        let message = format!("`inputs` names {least} or more inputs, such as {example}");
        table.reader.problem(table.offset_of("inputs"), message);
        return None;
    }
    Some(names)
}

fn period(table: Table<'_>) -> Option<f64> {
    if !table.has("period") {
        table.missing("period", "period = 6.283185307179586");
    }
    let At { value, offset } = table.number("period")?;
    if value != 0.0 && (value as f32).is_normal() {
        return Some(value);
    }
    table.reader.problem(offset, format!("`period` is {value}; it is a number that is neither 0 nor infinite"));
    None
}

fn rising(table: Table<'_>) -> Option<bool> {
    let given = table.required_text("direction", "direction = \"rising\"")?;
    Some(known(table, "direction", &given, ["rising", "falling"].into_iter())? == "rising")
}
