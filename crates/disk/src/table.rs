//! Reading tables of a TOML document key by key, with every problem at its place.

use std::cell::RefCell;
use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use base::nearest;
use base::text::{SourceFile, printable};

use crate::Problem;

/// A file with what was found wrong in it so far.
pub struct Reader<'a> {
    file: &'a SourceFile,
    problems: RefCell<Vec<(usize, String)>>,
}

impl<'a> Reader<'a> {
    /// A file in which nothing was found wrong yet.
    pub fn new(file: &'a SourceFile) -> Self {
        Self { file, problems: RefCell::default() }
    }

    /// Notes a problem at a byte offset.
    pub fn problem(&self, offset: usize, message: impl Into<String>) {
        // Values are quoted as they were written.
        self.problems.borrow_mut().push((offset, printable(&message.into())));
    }

    /// `file:line:column` of a byte offset.
    pub fn locate(&self, offset: usize) -> String {
        self.file.locate(offset)
    }

    /// `value` when nothing was wrong; `defect` is the message for a part that could not be read and did
    /// not say why, which is a defect here.
    pub fn finish<T>(self, value: Option<T>, defect: &str) -> Result<T, Vec<Problem>> {
        let mut problems = self.problems.into_inner();
        match value {
            Some(value) if problems.is_empty() => Ok(value),
            _ => {
                if problems.is_empty() {
                    problems.push((0, defect.to_owned()));
                }
                problems.sort_by_key(|(offset, _)| *offset);
                let problem = |(offset, message): (usize, String)| Problem { at: self.file.locate(offset), message };
                Err(problems.into_iter().map(problem).collect())
            }
        }
    }
}

/// A value with its place.
#[derive(Clone, Debug, PartialEq)]
pub struct At<T> {
    /// What the file says, converted to the type that the key has.
    pub value: T,
    /// Byte offset at which it begins.
    pub offset: usize,
}

/// One of a list of texts and tables.
pub enum Item<'a> {
    /// A text.
    Text(At<String>),
    /// A table.
    Table(Table<'a>),
}

/// A table of the document.
#[derive(Clone, Copy)]
pub struct Table<'a> {
    /// The file that it stands in.
    pub reader: &'a Reader<'a>,
    table: &'a DeTable<'a>,
    /// How people write the table: `[floors]`; empty for the top level.
    title: &'a str,
    /// Byte offset at which it begins.
    pub offset: usize,
}

impl<'a> Table<'a> {
    /// The whole document.
    pub fn root(reader: &'a Reader<'a>, table: &'a DeTable<'a>) -> Self {
        Self { reader, table, title: "", offset: 0 }
    }

    /// A table that was made from parts of a document; `offset` is where the document states it.
    pub fn inside_of(reader: &'a Reader<'a>, table: &'a DeTable<'a>, offset: usize) -> Self {
        Self { reader, table, title: "", offset }
    }

    /// The tables of a list, each with its byte offset and with the keys of this table that it lacks, but for the list.
    pub fn inheriting(&self, key: &str, title: &str) -> Vec<(DeTable<'a>, usize)> {
        let Some(value) = self.value(key) else { return Vec::new() };
        let Some(list) = value.get_ref().as_array() else {
            self.wrong(key, value.span(), &format!("a list of tables {title}"), value.get_ref());
            return Vec::new();
        };
        let mut tables = Vec::new();
        for item in list.iter() {
            let Some(own) = item.get_ref().as_table() else {
                self.wrong(key, item.span(), &format!("a list of tables {title}"), item.get_ref());
                continue;
            };
            let mut whole = own.clone();
            for (name, value) in self.table.iter().filter(|(name, _)| &**name.get_ref() != key) {
                if !whole.contains_key(&**name.get_ref()) {
                    whole.insert(name.clone(), value.clone());
                }
            }
            tables.push((whole, item.span().start));
        }
        tables
    }

    /// Notes keys that are none of `known`.
    pub fn only(self, known: &[&str]) -> Self {
        for key in self.table.keys() {
            let name: &str = key.get_ref();
            if !known.contains(&name) {
                let meant = match nearest(name, known.iter().copied()) {
                    Some(meant) => format!("did you mean `{meant}`?"),
                    None => format!("known keys are {}", known.join(", ")),
                };
                self.reader.problem(key.span().start, format!("unknown key `{name}`{}; {meant}", self.inside()));
            }
        }
        self
    }

    /// All keys, for tables whose keys are free.
    pub fn keys(&self) -> impl Iterator<Item = At<&'a str>> {
        self.table.keys().map(|key| At { value: &**key.get_ref(), offset: key.span().start })
    }

    fn inside(&self) -> String {
        if self.title.is_empty() { String::new() } else { format!(" in {}", self.title) }
    }

    fn value(&self, key: &str) -> Option<&'a Spanned<DeValue<'a>>> {
        self.table.get(key)
    }

    /// True when the key is there.
    pub fn has(&self, key: &str) -> bool {
        self.value(key).is_some()
    }

    /// Offset of a value; that of the table when the key is missing.
    pub fn offset_of(&self, key: &str) -> usize {
        self.value(key).map_or(self.offset, |v| v.span().start)
    }

    /// Notes a missing key.
    pub fn missing(&self, key: &str, example: &str) {
        self.reader.problem(self.offset, format!("missing key `{key}`{}; for example `{example}`", self.inside()));
    }

    fn wrong(&self, key: &str, span: Range<usize>, wanted: &str, found: &DeValue<'_>) {
        self.reader.problem(span.start, format!("`{key}` is {wanted}, not a value of type {}", found.type_str()));
    }

    /// A text that is not empty.
    pub fn text(&self, key: &str) -> Option<At<String>> {
        let value = self.value(key)?;
        let Some(text) = value.get_ref().as_str() else {
            self.wrong(key, value.span(), "a text", value.get_ref());
            return None;
        };
        if text.trim().is_empty() {
            self.reader.problem(value.span().start, format!("`{key}` is empty"));
            return None;
        }
        Some(At { value: text.to_owned(), offset: value.span().start })
    }

    /// A text that must be there.
    pub fn required_text(&self, key: &str, example: &str) -> Option<At<String>> {
        if !self.has(key) {
            self.missing(key, example);
        }
        self.text(key)
    }

    /// A list of texts; empty when the key is missing.
    pub fn texts(&self, key: &str) -> Vec<At<String>> {
        let Some(value) = self.value(key) else { return Vec::new() };
        let Some(list) = value.get_ref().as_array() else {
            self.wrong(key, value.span(), "a list of texts", value.get_ref());
            return Vec::new();
        };
        let mut texts: Vec<At<String>> = Vec::new();
        for item in list.iter() {
            let offset = item.span().start;
            match item.get_ref().as_str() {
                Some(text) if texts.iter().any(|t| t.value == text) => {
                    self.reader.problem(offset, format!("`{text}` stands twice in `{key}`"));
                }
                Some(text) if !text.is_empty() => texts.push(At { value: text.to_owned(), offset }),
                Some(_) => self.reader.problem(offset, format!("`{key}` holds an empty text")),
                None => self.wrong(key, item.span(), "a list of texts", item.get_ref()),
            }
        }
        texts
    }

    /// True for a key whose value is a text.
    pub fn is_text(&self, key: &str) -> bool {
        self.value(key).is_some_and(|value| value.get_ref().as_str().is_some())
    }

    /// True for a list that holds a text.
    pub fn has_text_in(&self, key: &str) -> bool {
        let list = self.value(key).and_then(|value| value.get_ref().as_array());
        list.is_some_and(|list| list.iter().any(|item| item.get_ref().as_str().is_some()))
    }

    /// A text or a whole number, or a list of them, each as its text; empty when the key is missing.
    pub fn terms(&self, key: &str) -> Vec<At<String>> {
        let Some(value) = self.value(key) else { return Vec::new() };
        let one = std::slice::from_ref(value);
        let list: Vec<&Spanned<DeValue<'_>>> = match value.get_ref().as_array() {
            Some(list) => list.iter().collect(),
            None => one.iter().collect(),
        };
        if list.is_empty() {
            self.reader.problem(value.span().start, format!("`{key}` has no values"));
        }
        let term = |item: &&Spanned<DeValue<'_>>| {
            let value = match item.get_ref() {
                DeValue::String(text) if !text.contains(['\n', '\r']) => text.to_string(),
                DeValue::Integer(n) => n.as_str().to_owned(),
                other => {
                    self.wrong(key, item.span(), "a text of one line or a whole number", other);
                    return None;
                }
            };
            Some(At { value, offset: item.span().start })
        };
        list.iter().filter_map(term).collect()
    }

    /// True for a key whose value is a table.
    pub fn is_table(&self, key: &str) -> bool {
        self.value(key).is_some_and(|value| value.get_ref().as_table().is_some())
    }

    /// `true` or `false`.
    pub fn flag(&self, key: &str) -> Option<bool> {
        let value = self.value(key)?;
        let flag = value.get_ref().as_bool();
        if flag.is_none() {
            self.wrong(key, value.span(), "true or false", value.get_ref());
        }
        flag
    }

    /// A whole number that may be negative.
    pub fn signed(&self, key: &str, least: i64, most: i64) -> Option<i64> {
        let value = self.value(key)?;
        let Some(integer) = value.get_ref().as_integer() else {
            self.wrong(key, value.span(), "a whole number", value.get_ref());
            return None;
        };
        let number = i64::from_str_radix(integer.as_str(), integer.radix()).ok();
        let number = number.filter(|n| (least..=most).contains(n));
        if number.is_none() {
            let message = format!("`{key}` is {integer}, which is not from {least} to {most}");
            self.reader.problem(value.span().start, message);
        }
        number
    }

    /// A value of a macro or a list of them: texts, numbers, `true` for 1; `None` stands for `false`.
    pub fn words(&self, key: &str) -> Vec<Option<String>> {
        let Some(value) = self.value(key) else { return Vec::new() };
        let one = std::slice::from_ref(value);
        let list: Vec<&Spanned<DeValue<'_>>> = match value.get_ref().as_array() {
            Some(list) => list.iter().collect(),
            None => one.iter().collect(),
        };
        if list.is_empty() {
            self.reader.problem(value.span().start, format!("`{key}` has no values"));
        }
        let mut words: Vec<Option<String>> = Vec::new();
        for item in list {
            let word = match item.get_ref() {
                DeValue::String(text) if !text.contains(['\n', '\r']) => Some(text.to_string()),
                DeValue::Integer(n) => Some(n.as_str().to_owned()),
                DeValue::Float(x) => Some(x.as_str().to_owned()),
                DeValue::Boolean(true) => Some("1".to_owned()),
                DeValue::Boolean(false) => None,
                DeValue::String(_) | DeValue::Datetime(_) | DeValue::Array(_) | DeValue::Table(_) => {
                    self.wrong(key, item.span(), "a text of one line, a number, true or false", item.get_ref());
                    return Vec::new();
                }
            };
            if words.contains(&word) {
                let word = word.unwrap_or_else(|| "false".to_owned());
                self.reader.problem(item.span().start, format!("`{word}` stands twice in `{key}`"));
                return Vec::new();
            }
            words.push(word);
        }
        words
    }

    /// A list of texts and tables; empty when the key is missing.
    pub fn texts_or_tables(&self, key: &str, title: &'a str) -> Vec<Item<'a>> {
        let Some(value) = self.value(key) else { return Vec::new() };
        let wanted = format!("a list of texts and tables `{title}`");
        let Some(list) = value.get_ref().as_array() else {
            self.wrong(key, value.span(), &wanted, value.get_ref());
            return Vec::new();
        };
        let mut items: Vec<Item<'a>> = Vec::new();
        for item in list.iter() {
            let offset = item.span().start;
            match item.get_ref() {
                DeValue::String(text) => {
                    let twice = |item: &Item<'a>| matches!(item, Item::Text(known) if known.value == **text);
                    if items.iter().any(twice) {
                        self.reader.problem(offset, format!("`{text}` stands twice in `{key}`"));
                    } else if text.is_empty() {
                        self.reader.problem(offset, format!("`{key}` holds an empty text"));
                    } else {
                        items.push(Item::Text(At { value: text.to_string(), offset }));
                    }
                }
                DeValue::Table(table) => items.push(Item::Table(Table { reader: self.reader, table, title, offset })),
                other => self.wrong(key, item.span(), &wanted, other),
            }
        }
        items
    }

    /// A number, whole or not.
    pub fn number(&self, key: &str) -> Option<At<f64>> {
        let value = self.value(key)?;
        let number = as_number(value.get_ref());
        if number.is_none() {
            self.wrong(key, value.span(), "a number", value.get_ref());
        }
        number.map(|number| At { value: number, offset: value.span().start })
    }

    /// Numbers; empty when the key is missing.
    pub fn numbers(&self, key: &str) -> Vec<f64> {
        let Some(value) = self.value(key) else { return Vec::new() };
        let Some(list) = value.get_ref().as_array() else {
            self.wrong(key, value.span(), "a list of numbers", value.get_ref());
            return Vec::new();
        };
        let number = |item: &Spanned<DeValue<'_>>| {
            let number = as_number(item.get_ref());
            if number.is_none() {
                self.wrong(key, item.span(), "a list of numbers", item.get_ref());
            }
            number
        };
        list.iter().filter_map(number).collect()
    }

    /// A whole number from `least` to `most`.
    pub fn whole(&self, key: &str, least: u64, most: u64) -> Option<u64> {
        let value = self.value(key)?;
        let Some(integer) = value.get_ref().as_integer() else {
            self.wrong(key, value.span(), "a whole number", value.get_ref());
            return None;
        };
        let number = i128::from_str_radix(integer.as_str(), integer.radix()).ok();
        let number = number.and_then(|n| u64::try_from(n).ok()).filter(|n| (least..=most).contains(n));
        if number.is_none() {
            let message = format!("`{key}` is {integer}, which is not from {least} to {most}");
            self.reader.problem(value.span().start, message);
        }
        number
    }

    /// A whole number that must be there.
    pub fn required_whole(&self, key: &str, least: u64, most: u64, example: &str) -> Option<u64> {
        if !self.has(key) {
            self.missing(key, example);
        }
        self.whole(key, least, most)
    }

    /// A table inside this one.
    pub fn table(&self, key: &str, title: &'a str) -> Option<Table<'a>> {
        let value = self.value(key)?;
        let Some(table) = value.get_ref().as_table() else {
            self.wrong(key, value.span(), &format!("a table `{title}`"), value.get_ref());
            return None;
        };
        Some(Table { reader: self.reader, table, title, offset: value.span().start })
    }

    /// Tables of a list; empty when the key is missing.
    pub fn tables(&self, key: &str, title: &'a str) -> Vec<Table<'a>> {
        let Some(value) = self.value(key) else { return Vec::new() };
        let Some(list) = value.get_ref().as_array() else {
            self.wrong(key, value.span(), &format!("a list of tables `{title}`"), value.get_ref());
            return Vec::new();
        };
        let table = |item: &'a Spanned<DeValue<'a>>| match item.get_ref().as_table() {
            Some(table) => Some(Table { reader: self.reader, table, title, offset: item.span().start }),
            None => {
                self.wrong(key, item.span(), &format!("a list of tables `{title}`"), item.get_ref());
                None
            }
        };
        list.iter().filter_map(table).collect()
    }
}

/// A finite or infinite number; `nan` is none.
fn as_number(value: &DeValue<'_>) -> Option<f64> {
    let number = match value {
        DeValue::Integer(n) => i128::from_str_radix(n.as_str(), n.radix()).ok().map(|n| n as f64),
        DeValue::Float(x) => x.as_str().parse::<f64>().ok(),
        DeValue::String(_) | DeValue::Boolean(_) | DeValue::Datetime(_) | DeValue::Array(_) | DeValue::Table(_) => None,
    };
    number.filter(|n| !n.is_nan())
}
