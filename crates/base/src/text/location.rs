//! Where something stands: a file, and a place in it.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::Position;

/// A place in a file. Its text form is `file:line:column`; results that are written down hold that.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(into = "String", from = "String")]
pub struct Location {
    /// Name of the file.
    pub file: String,
    /// Line and column, counted from 1; `None` for the file as a whole.
    pub position: Option<Position>,
}

impl fmt::Display for Location {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.file)?;
        self.position.map_or(Ok(()), |position| write!(f, ":{position}"))
    }
}

impl From<&str> for Location {
    fn from(text: &str) -> Self {
        // Names of files may have colons.
        let mut parts = text.rsplitn(3, ':');
        let mut number = || parts.next()?.parse().ok().filter(|number| *number > 0);
        let (column, line) = (number(), number());
        match (line, column, parts.next()) {
            (Some(line), Some(column), Some(file)) => {
                Self { file: file.to_owned(), position: Some(Position { line, column }) }
            }
            _ => Self { file: text.to_owned(), position: None },
        }
    }
}

impl From<String> for Location {
    fn from(text: String) -> Self {
        Self::from(&*text)
    }
}

impl From<Location> for String {
    fn from(location: Location) -> Self {
        location.to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn locations_are_read_as_they_are_written() {
        let text = "./a:b.vert:12:3";
        let location = Location::from(text);
        assert_eq!((location.file.as_str(), location.position), ("./a:b.vert", Some(Position { line: 12, column: 3 })));
        assert_eq!(location.to_string(), text);
        assert_eq!(serde_json::to_string(&location).unwrap(), format!("\"{text}\""));
        assert_eq!(serde_json::from_str::<Location>(&format!("\"{text}\"")).unwrap(), location);
    }

    #[test]
    fn without_a_line_and_a_column_it_is_a_file() {
        for text in ["a.vert", "a.vert:1", "a.vert:0:1", "a.vert:1:x", ""] {
            let location = Location::from(text);
            assert_eq!((location.file.as_str(), location.position), (text, None));
            assert_eq!(location.to_string(), text);
        }
    }
}
