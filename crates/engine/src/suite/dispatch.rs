//! How a suite about a compute stage dispatches it: sizes, numbers of workgroups and lengths of buffers.

use program::{Dispatch, Program, ProgramError};

use property::InputGroup;

use super::expect::{Define, Defines};

/// The table `[dispatch]`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Dispatching {
    /// Sizes with the values that they take: each combination is run.
    pub sizes: Vec<Define>,
    /// Workgroups along x, y and z; 1 along those that are left out.
    pub groups: Vec<Count>,
    /// Elements of buffers that are as long as their host makes them.
    pub lengths: Vec<(String, Count)>,
    /// Numbers of inputs that follow from sizes.
    pub inputs: Vec<SizedInput>,
    /// Where the suite says it.
    pub at: String,
}

/// Numbers of a group of inputs that follow from sizes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SizedInput {
    /// The group, by its place among those of the suite.
    pub group: usize,
    /// Its `values`; empty where they are plain numbers.
    pub values: Vec<Count>,
    /// Its `range`; empty where its ends are plain numbers.
    pub range: Vec<Count>,
}

impl Dispatching {
    /// Of the macros of a variant, those that the shader itself gets: sizes are for its host and its reference.
    pub fn of_shader(&self, chosen: &Defines) -> Defines {
        chosen.iter().filter(|(name, _)| self.sizes.iter().all(|size| size.name != *name)).cloned().collect()
    }

    /// The first of all sizes.
    pub fn first(&self) -> Defines {
        let first = |size: &Define| Some((size.name.clone(), size.values.first()?.clone()?));
        self.sizes.iter().filter_map(first).collect()
    }

    /// Gives groups of inputs the numbers that follow from these sizes. One without a value stays what it is for the first
    /// of them, which is refused where the dispatch is made.
    pub fn settle(&self, groups: &mut [InputGroup], chosen: &Defines) {
        for sized in &self.inputs {
            let numbers = |counts: &[Count]| counts.iter().map(|count| count.number(chosen).ok()).collect();
            let (values, range): (Option<Vec<f64>>, Option<Vec<f64>>) = (numbers(&sized.values), numbers(&sized.range));
            let Some(group) = groups.get_mut(sized.group) else { continue };
            if let Some(values) = values.filter(|values| !values.is_empty()) {
                group.options.values = values;
            }
            if let Some(&[lo, hi]) = range.as_deref() {
                group.options.range = Some([lo, hi]);
            }
        }
    }

    /// A program as it is dispatched with these sizes.
    ///
    /// # Errors
    /// A count that has no value, with its place; and as of [`Program::dispatched`].
    pub fn apply(&self, program: Program, chosen: &Defines) -> Result<Program, ProgramError> {
        let value = |count: &Count| count.value(chosen).map_err(|what| ProgramError::Unsupported { what });
        let mut groups = [1; 3];
        for (axis, count) in groups.iter_mut().zip(&self.groups) {
            *axis = value(count)?;
        }
        let lengths = self.lengths.iter().map(|(name, count)| Ok((name.clone(), value(count)?)));
        let lengths = lengths.collect::<Result<_, ProgramError>>()?;
        program.dispatched(&Dispatch { groups, lengths }).map_err(|error| match error {
            ProgramError::Unsupported { what } => ProgramError::Unsupported { what: format!("{}: {what}", self.at) },
            other => other,
        })
    }
}

/// A whole number by an expression of sizes: `(N + 63) / 64`. Quotients are rounded down.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Count {
    /// The expression.
    pub text: String,
    /// Where the suite says it.
    pub at: String,
}

impl Count {
    /// Its value for sizes.
    ///
    /// # Errors
    /// What is wrong with it, with its place.
    pub fn value(&self, sizes: &Defines) -> Result<u32, String> {
        let value = self.whole(sizes)?;
        let unfit = |_| format!("{}: `{}`: {value} is no number of elements or workgroups", self.at, self.text);
        u32::try_from(value).map_err(unfit)
    }

    /// Its value as a number, which may be negative.
    ///
    /// # Errors
    /// What is wrong with it, with its place.
    pub fn number(&self, sizes: &Defines) -> Result<f64, String> {
        self.whole(sizes).map(|value| value as f64)
    }

    fn whole(&self, sizes: &Defines) -> Result<i64, String> {
        let told = |what: String| format!("{}: `{}`: {what}", self.at, self.text);
        let mut reader = DispatchReader { rest: &self.text, sizes, depth: 0 };
        let value = reader.sum().map_err(told)?;
        if !reader.rest.trim_start().is_empty() {
            return Err(told(format!("`{}` is not expected here", reader.rest.trim())));
        }
        Ok(value)
    }
}

/// Deepest nesting of parentheses.
const DEEPEST: usize = 64;

struct DispatchReader<'a> {
    rest: &'a str,
    sizes: &'a Defines,
    depth: usize,
}

impl DispatchReader<'_> {
    fn takes(&mut self, operators: &[char]) -> Option<char> {
        let rest = self.rest.trim_start();
        let found = rest.chars().next().filter(|c| operators.contains(c))?;
        self.rest = &rest[found.len_utf8()..];
        Some(found)
    }

    fn sum(&mut self) -> Result<i64, String> {
        let mut left = self.product()?;
        while let Some(operator) = self.takes(&['+', '-']) {
            let right = self.product()?;
            let value = if operator == '+' { left.checked_add(right) } else { left.checked_sub(right) };
            left = value.ok_or("it is too large")?;
        }
        Ok(left)
    }

    fn product(&mut self) -> Result<i64, String> {
        let mut left = self.value()?;
        while let Some(operator) = self.takes(&['*', '/', '%']) {
            let right = self.value()?;
            let value = match operator {
                '*' => left.checked_mul(right).ok_or("it is too large"),
                '/' => left.checked_div_euclid(right).ok_or("it divides by zero"),
                _ => left.checked_rem_euclid(right).ok_or("it divides by zero"),
            };
            left = value?;
        }
        Ok(left)
    }

    fn value(&mut self) -> Result<i64, String> {
        if self.takes(&['(']).is_some() {
            self.depth += 1;
            if self.depth > DEEPEST {
                return Err("its parentheses are nested too deeply".to_owned());
            }
            let inner = self.sum()?;
            self.depth -= 1;
            return self.takes(&[')']).map(|_| inner).ok_or_else(|| "a `)` is missing".to_owned());
        }
        let rest = self.rest.trim_start();
        let end = rest.find(|c: char| !c.is_ascii_alphanumeric() && c != '_').unwrap_or(rest.len());
        let (word, rest) = rest.split_at(end);
        self.rest = rest;
        if word.starts_with(|c: char| c.is_ascii_digit()) {
            return word.parse().map_err(|_| format!("`{word}` is no whole number"));
        }
        match self.sizes.iter().find(|(name, _)| name == word) {
            Some((_, value)) => value.parse().map_err(|_| format!("`{word}` is `{value}`, which is no whole number")),
            None if word.is_empty() => Err("a number or the name of a size is missing".to_owned()),
            None => Err(format!("`{word}` is no size; name it in [dispatch.sizes]")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(text: &str) -> Result<u32, String> {
        let count = Count { text: text.to_owned(), at: "a.suite.toml:3:1".to_owned() };
        count.value(&vec![("N".to_owned(), "65".to_owned()), ("M".to_owned(), "x".to_owned())])
    }

    #[test]
    fn counts_follow_from_sizes() {
        assert_eq!(value("(N + 63) / 64"), Ok(2));
        assert_eq!(value("2 * (N - 60) % 4 + 1"), Ok(3));
        assert_eq!(value("7"), Ok(7));
    }

    #[test]
    fn what_has_no_value_is_told_with_its_place() {
        for (text, expected) in [
            ("K + 1", "`K` is no size"),
            ("M", "`x`, which is no whole number"),
            ("(N", "a `)` is missing"),
            ("N N", "`N` is not expected here"),
            ("N / 0", "divides by zero"),
            ("1 - N", "-64 is no number"),
            ("", "is missing"),
            ("N * 99999999999999999999", "no whole number"),
        ] {
            let error = value(text).unwrap_err();
            assert!(error.starts_with("a.suite.toml:3:1: ") && error.contains(expected), "{text}: {error}");
        }
    }
}
