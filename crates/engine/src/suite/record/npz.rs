//! Recorded values as arrays of NumPy: what `numpy.savez` writes, and what `refdata` does. An array holds a whole variable
//! of one dispatch or invocation, or of several ones along its first axis.

use std::io::{Cursor, Read};

use npyz::{DType, Endianness, NpyHeader, Order, TypeChar};
use zip::ZipArchive;

use super::{Interface, RecordColumn, hint, row_of};
use crate::suite::{RecordedFile, Suite};
use base::value::{Field, Scalar, Shape};
use disk::Problem;
use judge::verdict::RecordedRow;
use property::pattern;

/// Bytes of an array that are unpacked.
const MOST: u64 = 1 << 30;

/// What a buffer holds before that is written and of which nothing is recorded: nothing should come of it.
const BEFORE: f64 = 777.25;

/// An array as it is read.
struct NpzArray {
    name: String,
    shape: Vec<u64>,
    numbers: Vec<f64>,
    /// The type of its numbers, as NumPy calls it.
    dtype: &'static str,
}

/// A variable of the shader with the columns of its words; of an array of structures, the members of one name.
struct NpzVariable {
    name: String,
    /// Shape of one of the fields that it consists of, and how many there are.
    shape: Shape,
    count: usize,
    columns: Vec<RecordColumn>,
    role: ArrayRole,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum ArrayRole {
    Invocation,
    Case,
    Output,
}

impl NpzVariable {
    /// Sizes of the array that holds it once.
    fn dimensions(&self) -> Vec<u64> {
        let mut all: Vec<u64> = (self.count > 1).then_some(self.count as u64).into_iter().collect();
        all.extend(self.shape.array.map(u64::from));
        all.extend((self.shape.columns > 1).then_some(u64::from(self.shape.columns)));
        all.extend((self.shape.rows > 1).then_some(u64::from(self.shape.rows)));
        all
    }

    /// NumPy's name of the type that it should have.
    fn dtype(&self) -> &'static str {
        match self.shape.scalar {
            Scalar::F32 => "float32",
            Scalar::I32 => "int32",
            Scalar::U32 | Scalar::Bool => "uint32",
        }
    }
}

/// The outputs that an archive gives, and its rows.
///
/// # Errors
/// Everything that is wrong in the file: arrays of another type, order or shape, names that the shader does not have, and
/// inputs that are missing.
pub fn rows_of_arrays(
    recorded: &RecordedFile,
    name: &str,
    bytes: &[u8],
    interface: &Interface<'_>,
    suite: &Suite,
) -> Result<(Vec<String>, Vec<RecordedRow>), Vec<Problem>> {
    let arrays = arrays(bytes).map_err(|all| all.into_iter().map(|what| problem(name, what)).collect::<Vec<_>>())?;
    let mut reading = NpzReading { name, suite, variables: variables(interface), problems: Vec::new() };
    let (outputs, columns, rows) = reading.rows(&arrays, interface);
    if !reading.problems.is_empty() {
        return Err(reading.problems);
    }
    let rows = rows.iter().map(|row| row_of(recorded, interface, &columns, &outputs, row)).collect();
    Ok((outputs.into_iter().map(|field| field.name).collect(), rows))
}

fn problem(name: &str, message: String) -> Problem {
    Problem { at: name.to_owned(), message }
}

/// The arrays of an archive, but for those that `refdata` adds beside values.
fn arrays(bytes: &[u8]) -> Result<Vec<NpzArray>, Vec<String>> {
    let damaged = |error: &dyn std::fmt::Display| vec![format!("it is no archive that `numpy.savez` writes: {error}")];
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(|error| damaged(&error))?;
    let (mut all, mut wrong) = (Vec::new(), Vec::new());
    let of_refdata = archive.file_names().flatten().any(|name| name == "provenance.npy");
    for at in 0..archive.len() {
        let member = archive.by_index(at).map_err(|error| damaged(&error))?;
        let name = member.name().map_err(|error| damaged(&error))?.trim_end_matches(".npy").to_owned();
        let beside =
            name == "flags" || name == "provenance" || name.starts_with("nearest.") || name.starts_with("bound.");
        if of_refdata && beside {
            continue;
        }
        let mut content = Vec::new();
        member.take(MOST).read_to_end(&mut content).map_err(|error| damaged(&error))?;
        match array(&name, &content) {
            Ok(array) => all.push(array),
            Err(why) => wrong.push(format!("the array `{name}` {why}")),
        }
    }
    if wrong.is_empty() { Ok(all) } else { Err(wrong) }
}

fn array(name: &str, content: &[u8]) -> Result<NpzArray, String> {
    let mut rest = content;
    let header = NpyHeader::from_reader(&mut rest).map_err(|error| format!("cannot be read: {error}"))?;
    let DType::Plain(ty) = header.dtype() else {
        return Err("has records; write one array for each of their members".to_owned());
    };
    let last = name.rsplit('.').next().unwrap_or(name);
    let (dtype, size) = match (ty.type_char(), ty.size_field()) {
        (TypeChar::Float, 4) => ("float32", 4),
        (TypeChar::Float, 8) => ("float64", 8),
        (TypeChar::Int, 4) => ("int32", 4),
        (TypeChar::Uint, 4) => ("uint32", 4),
        (TypeChar::Int | TypeChar::Uint | TypeChar::Bool, _) => {
            return Err(format!("is of type `{ty}`; write {last}.astype(numpy.int32) or {last}.astype(numpy.uint32)"));
        }
        _ => return Err(format!("is of type `{ty}`; write {last}.astype(numpy.float32) or of float64")),
    };
    if ty.endianness() == Endianness::Big {
        let little = ty.to_string().replace('>', "<");
        return Err(format!("has the highest byte of each number first (`{ty}`); write {last}.astype(\"{little}\")"));
    }
    let shape = header.shape().to_vec();
    if header.order() == Order::Fortran && shape.iter().filter(|&&n| n > 1).count() > 1 {
        return Err(format!("is stored column by column; write numpy.ascontiguousarray({last})"));
    }
    let wanted = shape.iter().try_fold(size, |all: u64, &n| all.checked_mul(n));
    if wanted != Some(rest.len() as u64) {
        return Err(format!("has {} bytes, and its shape says otherwise: the file is cut off or damaged", rest.len()));
    }
    let numbers = match dtype {
        "float64" => rest.as_chunks().0.iter().map(|b| f64::from_le_bytes(*b)).collect(),
        "float32" => rest.as_chunks().0.iter().map(|b| f64::from(f32::from_le_bytes(*b))).collect(),
        "int32" => rest.as_chunks().0.iter().map(|b| f64::from(i32::from_le_bytes(*b))).collect(),
        _ => rest.as_chunks().0.iter().map(|b| f64::from(u32::from_le_bytes(*b))).collect(),
    };
    Ok(NpzArray { name: name.to_owned(), shape, numbers, dtype })
}

/// The variables of a shader.
fn variables(interface: &Interface<'_>) -> Vec<NpzVariable> {
    let mut all: Vec<NpzVariable> = Vec::new();
    type Numbered = fn(usize) -> RecordColumn;
    let sides: [(_, Numbered, _); 3] = [
        (&**interface.invocation, RecordColumn::Invocation, ArrayRole::Invocation),
        (&**interface.case, RecordColumn::Case, ArrayRole::Case),
        (interface.output, RecordColumn::Output, ArrayRole::Output),
    ];
    for (record, column, role) in sides {
        for (k, field) in record.fields().iter().enumerate() {
            let name = pattern(&field.name);
            let columns = record.range(k).map(column);
            // Members of structures come one after the other.
            match all.iter_mut().find(|own| own.role == role && own.name == name) {
                Some(own) => {
                    own.columns.extend(columns);
                    own.count += 1;
                }
                None => all.push(NpzVariable { name, shape: field.shape, count: 1, columns: columns.collect(), role }),
            }
        }
    }
    all
}

struct NpzReading<'a> {
    name: &'a str,
    suite: &'a Suite,
    variables: Vec<NpzVariable>,
    problems: Vec<Problem>,
}

impl NpzReading<'_> {
    fn problem(&mut self, message: String) {
        self.problems.push(problem(self.name, message));
    }

    /// The recorded outputs, the columns, and the rows of their values.
    fn rows(
        &mut self,
        arrays: &[NpzArray],
        interface: &Interface<'_>,
    ) -> (Vec<Field>, Vec<RecordColumn>, Vec<Vec<f64>>) {
        let none = || (Vec::new(), Vec::new(), Vec::new());
        let mut found: Vec<(usize, &NpzArray, usize)> = Vec::new();
        for array in arrays {
            let Some(variable) = self.variable(array) else { continue };
            if found.iter().any(|(own, ..)| *own == variable) {
                self.problem(format!("the array `{}` gives a variable that another array gives as well", array.name));
            } else if let Some(rows) = self.rows_of(variable, array) {
                found.push((variable, array, rows));
            }
        }
        if !self.problems.is_empty() {
            return none();
        }
        let count = found.iter().map(|(.., rows)| *rows).max().unwrap_or(0);
        let per_case = self.suite.per_case.max(1);
        for &(variable, array, rows) in &found {
            let of_cases = self.variables[variable].role == ArrayRole::Case && rows == count.div_ceil(per_case);
            let once = rows == 1 && self.variables[variable].role != ArrayRole::Output;
            if rows != count && !of_cases && !once {
                self.problem(format!(
                    "the array `{}` holds {rows} dispatches, and others hold {count}: each holds as many, or one input for all",
                    array.name
                ));
            }
        }
        let (mut columns, mut rows) = (Vec::new(), vec![Vec::new(); count]);
        for &(variable, array, own) in &found {
            let NpzVariable { columns: own_columns, .. } = &self.variables[variable];
            let words = own_columns.len();
            columns.extend_from_slice(own_columns);
            for (k, row) in rows.iter_mut().enumerate() {
                let from = match own {
                    1 => 0,
                    own if own == count => k,
                    _ => k / per_case,
                };
                row.extend_from_slice(&array.numbers[from * words..][..words]);
            }
        }
        for (column, value) in self.filled(&found.iter().map(|(own, ..)| *own).collect::<Vec<_>>(), interface) {
            columns.push(column);
            rows.iter_mut().for_each(|row| row.push(value));
        }
        let given = |k: usize| interface.output.range(k).all(|word| columns.contains(&RecordColumn::Output(word)));
        let fields = interface.output.fields().iter().enumerate();
        let recorded = found.iter().any(|(own, ..)| self.variables[*own].role == ArrayRole::Output);
        let outputs: Vec<Field> = match recorded {
            true => fields.filter(|(k, _)| given(*k)).map(|(_, field)| field.clone()).collect(),
            false => Vec::new(),
        };
        if outputs.is_empty() && self.problems.is_empty() {
            let all = self.variables.iter().filter(|own| own.role == ArrayRole::Output);
            let names: Vec<String> = all.map(|own| format!("`expected.{}`", own.name)).collect();
            self.problem(format!("no output is recorded; add an array {}", names.join(" or ")));
        }
        (outputs, columns, rows)
    }

    /// The variable that an array gives.
    fn variable(&mut self, array: &NpzArray) -> Option<usize> {
        let name = &array.name[..];
        let apart = |prefix: &str| name.strip_prefix(prefix).map(str::to_owned);
        let output = apart("expected.").or_else(|| apart("out "));
        let input = apart("input.").or_else(|| apart("case."));
        let find = |name: &str, output: bool| {
            self.variables.iter().position(|own| own.name == name && (own.role == ArrayRole::Output) == output)
        };
        let found = match (&output, &input) {
            (Some(name), _) => find(name, true),
            (None, Some(name)) => find(name, false),
            (None, None) => find(name, false).or_else(|| find(name, true)),
        };
        if found.is_none() {
            let hint = hint(name, self.variables.iter().map(|own| &own.name[..]));
            self.problem(format!("the shader has no input or output for the array `{name}`; {hint}"));
        }
        found
    }

    /// How many dispatches an array holds.
    fn rows_of(&mut self, variable: usize, array: &NpzArray) -> Option<usize> {
        let own = &self.variables[variable];
        let (words, total) = (own.columns.len(), array.numbers.len());
        // What is expected may be computed in float64, whole numbers too.
        let exact = own.role == ArrayRole::Output && array.numbers.iter().all(|n| n.fract() == 0.0);
        let whole = (array.dtype != "float32" && array.dtype != "float64") || exact;
        let unfit = match own.shape.scalar {
            Scalar::F32 if own.role != ArrayRole::Output => {
                let other = |&&n: &&f64| !n.is_nan() && f64::from(n as f32) != n;
                array.numbers.iter().find(other).map(|n| {
                    format!(
                        "holds {n}, which is no float32; compute the reference for {}.astype(numpy.float32)",
                        own.name
                    )
                })
            }
            Scalar::F32 => None,
            Scalar::I32 | Scalar::U32 | Scalar::Bool if !whole => {
                let (dtype, ty, wanted) = (array.dtype, own.shape, own.dtype());
                Some(format!(
                    "is of type {dtype}, and the shader has `{ty}`; write {}.astype(numpy.{wanted})",
                    own.name
                ))
            }
            scalar => {
                let [lo, hi] = match scalar {
                    Scalar::I32 => [f64::from(i32::MIN), f64::from(i32::MAX)],
                    Scalar::Bool => [0.0, 1.0],
                    _ => [0.0, f64::from(u32::MAX)],
                };
                let outside = array.numbers.iter().find(|&&n| !(lo..=hi).contains(&n));
                outside.map(|n| format!("holds {n}, which `{}` does not", own.shape))
            }
        };
        if let Some(why) = unfit {
            self.problem(format!("the array `{}` {why}", array.name));
            return None;
        }
        if total == words && total > 0 {
            return Some(1);
        }
        let rows = array.shape.first().copied().and_then(|n| usize::try_from(n).ok()).unwrap_or(0);
        if rows > 0 && rows.checked_mul(words) == Some(total) {
            return Some(rows);
        }
        let shown = |all: &[u64]| {
            let all: Vec<String> = all.iter().map(u64::to_string).collect();
            if all.is_empty() { "one number".to_owned() } else { format!("[{}]", all.join(", ")) }
        };
        let (given, wanted) = (shown(&array.shape), shown(&own.dimensions()));
        let sizes: Vec<String> = self.suite.chosen.iter().map(|(name, value)| format!("{name} = {value}")).collect();
        let with = if sizes.is_empty() { String::new() } else { format!(" with {}", sizes.join(", ")) };
        let several = match self.suite.chosen.first() {
            Some((name, _)) if !self.name.contains(|c: char| c.is_ascii_digit()) => {
                format!("; a file for each size is named like \"values_{{{name}}}.npz\"")
            }
            _ => String::new(),
        };
        let (name, of) = (&array.name, &own.name);
        let axis = "several dispatches lie along an axis in front";
        self.problem(format!(
            "the array `{name}` has the shape {given}; `{of}` has {wanted}{with}, and {axis}{several}"
        ));
        None
    }

    /// Values of the words of inputs that no array gives.
    fn filled(&mut self, found: &[usize], interface: &Interface<'_>) -> Vec<(RecordColumn, f64)> {
        let mut all = Vec::new();
        let mut missing = Vec::new();
        for (k, own) in self.variables.iter().enumerate() {
            if found.contains(&k) || own.role == ArrayRole::Output {
                continue;
            }
            let constant = self.suite.inputs.iter().filter(|group| group.generator.name() == "constant");
            let stated =
                constant.filter_map(|group| Some((group, group.names.iter().position(|name| *name == own.name)?)));
            // Values of a group are those of its words, one variable after the other; the first one stands for the rest.
            if let Some((group, at)) = stated.into_iter().next() {
                let words = |name: &String| {
                    self.variables.iter().find(|own| own.name == *name).map_or(0, |own| own.columns.len())
                };
                let first: usize = group.names[..at].iter().map(words).sum();
                let values = &group.options.values;
                let value = |k: usize| values.get(first + k).or(values.first()).copied().unwrap_or_default();
                all.extend(own.columns.iter().enumerate().map(|(k, &column)| (column, value(k))));
                continue;
            }
            let written = interface.output.fields().iter().any(|field| pattern(&field.name) == own.name);
            if written {
                let before = if own.shape.scalar == Scalar::F32 { BEFORE } else { BEFORE.floor() };
                all.extend(own.columns.iter().map(|&column| (column, before)));
                continue;
            }
            missing.push((own.name.clone(), own.dtype(), own.dimensions()));
        }
        for (name, dtype, dimensions) in missing {
            self.problem(format!(
                "the array `{name}` of an input is missing; add one of {dtype} with the shape {dimensions:?}, or fill it \
                 by an [[inputs]] group with generator = \"constant\""
            ));
        }
        all
    }
}

#[cfg(test)]
mod tests;
