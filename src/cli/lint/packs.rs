//! What the properties of a shader pack say of its programs.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// The file beside the programs of a pack: `program.world0/composite.enabled=BLOOM`.
const PROPERTIES: &str = "shaders.properties";

/// For files by name, with their paths, the options that decide whether the host compiles them.
pub(super) fn asked_before(files: &BTreeMap<String, PathBuf>) -> BTreeMap<String, Vec<String>> {
    let folders: BTreeSet<&Path> = files.values().flat_map(|path| path.ancestors().skip(1).take(3)).collect();
    let mut asked: BTreeMap<PathBuf, Vec<String>> = BTreeMap::new();
    for folder in folders {
        let Ok(text) = std::fs::read_to_string(folder.join(PROPERTIES)) else { continue };
        for (program, names) in text.lines().filter_map(enabled) {
            asked.entry(folder.join(program)).or_default().extend(names);
        }
    }
    let of = |(name, path): (&String, &PathBuf)| Some((name.clone(), asked.get(&path.with_extension(""))?.clone()));
    files.iter().filter_map(of).collect()
}

/// A program, and the options of the condition under which it is enabled.
fn enabled(line: &str) -> Option<(&str, Vec<String>)> {
    let (key, condition) = line.trim().strip_prefix("program.")?.split_once('=')?;
    let program = key.trim().strip_suffix(".enabled")?;
    let words = condition.split(|c: char| !c.is_ascii_alphanumeric() && c != '_').filter(|word| !word.is_empty());
    Some((program, words.map(str::to_owned).collect()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_program_has_the_options_of_its_condition() {
        let line = "program.world0/composite5.enabled = BLOOM && !(LOW || OFF)";
        let names = ["BLOOM", "LOW", "OFF"].map(str::to_owned).to_vec();
        assert_eq!(enabled(line), Some(("world0/composite5", names)));
        assert_eq!(enabled("program.composite.blend=off"), None);
        assert_eq!(enabled("# program.composite.enabled=A"), None);
    }
}
