//! Files of recorded values: CSV with a line of names, JSON with a list of objects, or arrays of NumPy.

mod npz;

use std::sync::Arc;

use serde_json::Value;

use super::expect::{RecordedFile, hint};
use base::text::SourceFile;
use base::value::{Field, Record, Scalar};
use disk::Problem;
use judge::verdict::RecordedRow;
use property::Sample;

pub use npz::rows_of_arrays;

/// A column of a record: which word of which side it gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum RecordColumn {
    Invocation(usize),
    Case(usize),
    Output(usize),
}

/// The interface that a record is about.
pub struct Interface<'a> {
    /// What one invocation takes.
    pub invocation: &'a Arc<Record>,
    /// What one case takes.
    pub case: &'a Arc<Record>,
    /// What one invocation gives.
    pub output: &'a Record,
}

/// The outputs that a record gives, and its rows.
///
/// # Errors
/// Everything that is wrong in the file, each with its place: names that the shader does not have,
/// inputs that are missing, values that are no numbers.
pub fn rows(
    recorded: &RecordedFile,
    text: &SourceFile,
    interface: &Interface<'_>,
) -> Result<(Vec<String>, Vec<RecordedRow>), Vec<Problem>> {
    let mut reading = RecordReading { file: text, interface, problems: Vec::new() };
    let (columns, values) = if text.name().ends_with(".json") { reading.json() } else { reading.csv() };
    let outputs = reading.outputs(&columns);
    if !reading.problems.is_empty() {
        return Err(reading.problems);
    }
    let rows = values.into_iter().map(|row| row_of(recorded, interface, &columns, &outputs, &row)).collect();
    Ok((outputs.into_iter().map(|field| field.name).collect(), rows))
}

struct RecordReading<'a> {
    file: &'a SourceFile,
    interface: &'a Interface<'a>,
    problems: Vec<Problem>,
}

type Rows = Vec<Vec<f64>>;

/// A record, and what one of its words is as a column.
type Side<'r> = (&'r Record, fn(usize) -> RecordColumn);

impl RecordReading<'_> {
    fn problem(&mut self, at: String, message: String) {
        self.problems.push(Problem { at, message });
    }

    fn csv(&mut self) -> (Vec<RecordColumn>, Rows) {
        let mut columns: Vec<RecordColumn> = Vec::new();
        let mut rows = Vec::new();
        let mut named = false;
        for line in 1..=self.file.line_count() {
            let text = self.file.line_text(line);
            if text.trim().is_empty() || text.trim_start().starts_with('#') {
                continue;
            }
            let mut at = 1;
            let mut cells = Vec::new();
            for cell in text.split(',') {
                let blanks = cell.chars().take_while(|c| c.is_whitespace()).count();
                cells.push((format!("{}:{line}:{}", self.file.name(), at + blanks), cell.trim().trim_matches('"')));
                at += cell.chars().count() + 1;
            }
            if !named {
                named = true;
                columns = cells.iter().filter_map(|(at, name)| self.column(at, name)).collect();
                self.twice(&columns);
                continue;
            }
            if cells.len() != columns.len() {
                let message = format!("{} values stand here, and there are {} names", cells.len(), columns.len());
                // Names that were refused have been told; the numbers of values do not fit them.
                if self.problems.is_empty() {
                    self.problem(format!("{}:{line}:1", self.file.name()), message);
                }
                continue;
            }
            rows.push(cells.iter().zip(&columns).map(|((at, cell), &column)| self.number(at, cell, column)).collect());
        }
        if !named {
            self.problem(format!("{}:1:1", self.file.name()), "there is no line of names, such as `x,return`".into());
        }
        (columns, rows)
    }

    fn json(&mut self) -> (Vec<RecordColumn>, Rows) {
        let list: Vec<serde_json::Map<String, Value>> = match serde_json::from_str(self.file.text()) {
            Ok(list) => list,
            Err(error) => {
                let at = format!("{}:{}:{}", self.file.name(), error.line().max(1), error.column().max(1));
                self.problem(at, format!("not a list of objects such as [{{\"x\": 1.0, \"return\": 2.0}}]: {error}"));
                return (Vec::new(), Vec::new());
            }
        };
        let (file, text) = (self.file, self.file.text());
        let starts = objects(text);
        let place = |object: usize, name: &str| {
            let start = starts.get(object).copied().unwrap_or_default();
            let within = if name.is_empty() { None } else { text[start..].find(&format!("\"{name}\"")) };
            file.locate(start + within.unwrap_or_default())
        };
        let mut columns: Vec<RecordColumn> = Vec::new();
        let mut rows = Vec::new();
        for (k, object) in list.iter().enumerate() {
            let mut row: Vec<(RecordColumn, f64)> = Vec::new();
            for (name, value) in object {
                let mut words = Vec::new();
                let at = place(k, name);
                if !flatten(value, &mut words) {
                    let message = format!("object {}: `{name}` is a number or a list of numbers", k + 1);
                    self.problem(at, message);
                    continue;
                }
                let Some((field, first)) = self.field(&at, name) else { continue };
                if field.shape.words() != words.len() {
                    let (wanted, given) = (field.shape.words(), words.len());
                    let message = format!("object {}: `{name}` has {wanted} components, not {given}", k + 1);
                    self.problem(at, message);
                    continue;
                }
                row.extend(words.into_iter().enumerate().map(|(word, value)| (shifted(first, word), value)));
            }
            if k == 0 {
                columns = row.iter().map(|(column, _)| *column).collect();
            }
            let value = |column: &RecordColumn| row.iter().find(|(c, _)| c == column).map(|(_, value)| *value);
            match columns.iter().map(value).collect::<Option<Vec<f64>>>() {
                Some(values) if row.len() == columns.len() => rows.push(values),
                _ if self.problems.is_empty() => {
                    self.problem(place(k, ""), format!("object {} has other names than the first", k + 1));
                }
                Some(_) | None => {}
            }
        }
        (columns, rows)
    }

    /// A column by the name of a component: `x`, `p.y`, `mc[3][0]`; `out p.y` for what is also an input.
    fn column(&mut self, at: &str, name: &str) -> Option<RecordColumn> {
        let Interface { invocation, case, output } = self.interface;
        let find = |record: &Record, name: &str| (0..record.words()).find(|&word| record.word_name(word) == name);
        let (output_only, name) = match name.strip_prefix("out ") {
            Some(name) => (true, name.trim()),
            None => (false, name),
        };
        let input = || {
            find(invocation, name).map(RecordColumn::Invocation).or_else(|| find(case, name).map(RecordColumn::Case))
        };
        let found = if output_only { None } else { input() };
        let found = found.or_else(|| find(output, name).map(RecordColumn::Output));
        if found.is_none() {
            let records: [&Record; 3] = [invocation, case, output];
            let names: Vec<String> =
                records.iter().flat_map(|record| (0..record.words()).map(|word| record.word_name(word))).collect();
            let hint = hint(name, names.iter().map(String::as_str));
            self.problem(at.to_owned(), format!("the shader has no input or output `{name}`; {hint}"));
        }
        found
    }

    /// A whole variable by name, with the column of its first word.
    fn field(&mut self, at: &str, name: &str) -> Option<(Field, RecordColumn)> {
        let Interface { invocation, case, output } = self.interface;
        let (output_only, name) = match name.strip_prefix("out ") {
            Some(name) => (true, name.trim()),
            None => (false, name),
        };
        let sides: [Side<'_>; 3] =
            [(invocation, RecordColumn::Invocation), (case, RecordColumn::Case), (output, RecordColumn::Output)];
        let found = sides.iter().skip(if output_only { 2 } else { 0 }).find_map(|(record, column)| {
            let index = record.index_of(name)?;
            Some((record.fields()[index].clone(), column(record.range(index).start)))
        });
        if found.is_none() {
            let names = || sides.iter().flat_map(|(record, _)| record.fields()).map(|f| f.name.as_str());
            let hint = hint(name, names());
            self.problem(at.to_owned(), format!("the shader has no input or output `{name}`; {hint}"));
        }
        found
    }

    fn twice(&mut self, columns: &[RecordColumn]) {
        let twice = (1..columns.len()).find(|&k| columns[..k].contains(&columns[k]));
        if let Some(k) = twice {
            self.problem(format!("{}:1:1", self.file.name()), format!("column {} stands there twice", k + 1));
        }
    }

    /// A decimal number, or the bits of a word as `0x3f800000`.
    fn number(&mut self, at: &str, cell: &str, column: RecordColumn) -> f64 {
        let bits = cell.strip_prefix("0x").map(|digits| u32::from_str_radix(digits, 16).ok());
        let Interface { invocation, case, output } = self.interface;
        let scalar = match column {
            RecordColumn::Invocation(word) => invocation.scalar_of(word),
            RecordColumn::Case(word) => case.scalar_of(word),
            RecordColumn::Output(word) => output.scalar_of(word),
        };
        let value = match (bits, cell) {
            (Some(bits), _) => bits.map(|bits| property::decode(bits, scalar)),
            (None, "true") => Some(1.0),
            (None, "false") => Some(0.0),
            (None, text) => text.parse().ok(),
        };
        value.unwrap_or_else(|| {
            self.problem(at.to_owned(), format!("`{cell}` is no number; write 0.5, or bits such as 0x3f000000"));
            f64::NAN
        })
    }

    /// The outputs that the columns give; every input has to be there, and every component.
    fn outputs(&mut self, columns: &[RecordColumn]) -> Vec<Field> {
        if !self.problems.is_empty() {
            return Vec::new();
        }
        let Interface { invocation, case, output } = self.interface;
        let at = format!("{}:1:1", self.file.name());
        let sides: [Side<'_>; 2] = [(invocation, RecordColumn::Invocation), (case, RecordColumn::Case)];
        for (record, column) in sides {
            if let Some(word) = (0..record.words()).find(|&word| !columns.contains(&column(word))) {
                self.problem(at.clone(), format!("the input `{}` is missing", record.word_name(word)));
            }
        }
        let mut fields = Vec::new();
        for (k, field) in output.fields().iter().enumerate() {
            let missing: Vec<usize> =
                output.range(k).filter(|&word| !columns.contains(&RecordColumn::Output(word))).collect();
            if missing.is_empty() {
                fields.push(field.clone());
            } else if missing.len() < field.shape.words() {
                let name = output.word_name(missing[0]);
                self.problem(at.clone(), format!("`{name}` is missing; give all components of an output"));
            }
        }
        if fields.is_empty() && self.problems.is_empty() {
            let names: Vec<String> = output.fields().iter().map(|f| format!("`{}`", f.name)).collect();
            self.problem(at, format!("no output is recorded; the shader has {}", names.join(", ")));
        }
        fields
    }
}

fn shifted(first: RecordColumn, by: usize) -> RecordColumn {
    match first {
        RecordColumn::Invocation(word) => RecordColumn::Invocation(word + by),
        RecordColumn::Case(word) => RecordColumn::Case(word + by),
        RecordColumn::Output(word) => RecordColumn::Output(word + by),
    }
}

/// Where the objects of a list of objects begin. The text is known to be one.
fn objects(text: &str) -> Vec<usize> {
    let (mut depth, mut in_text, mut escaped) = (0_usize, false, false);
    let mut starts = Vec::new();
    for (at, byte) in text.bytes().enumerate() {
        match byte {
            _ if escaped => escaped = false,
            b'\\' if in_text => escaped = true,
            b'"' => in_text = !in_text,
            _ if in_text => {}
            b'{' | b'[' => {
                if depth == 1 {
                    starts.push(at);
                }
                depth += 1;
            }
            b'}' | b']' => depth = depth.saturating_sub(1),
            _ => {}
        }
    }
    starts
}

/// The numbers of a value one after the other; false where something is no number.
fn flatten(value: &Value, words: &mut Vec<f64>) -> bool {
    match value {
        Value::Number(number) => {
            words.push(number.as_f64().unwrap_or(f64::NAN));
            true
        }
        Value::Bool(flag) => {
            words.push(f64::from(u8::from(*flag)));
            true
        }
        Value::Array(list) => list.iter().all(|item| flatten(item, words)),
        Value::Null | Value::String(_) | Value::Object(_) => false,
    }
}

fn row_of(
    recorded: &RecordedFile,
    interface: &Interface<'_>,
    columns: &[RecordColumn],
    outputs: &[Field],
    values: &[f64],
) -> RecordedRow {
    let Interface { invocation, case, output } = interface;
    let mut sample = Sample {
        invocation_record: (*invocation).clone(),
        case_record: (*case).clone(),
        invocation: vec![0; invocation.words()],
        case: vec![0; case.words()],
    };
    let mut given = vec![f64::NAN; output.words()];
    for (&column, &value) in columns.iter().zip(values) {
        match column {
            RecordColumn::Invocation(word) => {
                sample.invocation[word] = property::encode(value, invocation.scalar_of(word));
            }
            RecordColumn::Case(word) => sample.case[word] = property::encode(value, case.scalar_of(word)),
            RecordColumn::Output(word) => given[word] = value,
        }
    }
    let (mut words, mut slack) = (Vec::new(), Vec::new());
    for field in outputs {
        let values = output.index_of(&field.name).map(|k| given[output.range(k)].to_vec()).unwrap_or_default();
        let largest = values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        let off = match field.shape.scalar {
            Scalar::F32 => recorded.relative_error * largest + recorded.absolute_error,
            Scalar::I32 | Scalar::U32 | Scalar::Bool => 0.0,
        };
        slack.extend(std::iter::repeat_n(off, values.len()));
        words.extend(values);
    }
    RecordedRow { sample, outputs: words, slack }
}
