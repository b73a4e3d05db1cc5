//! The texts of a workspace at one moment, and what is known across them.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::sync::{Arc, OnceLock};

use base::text::{SourceFile, Span};
use lint::{Config, Input};
use rayon::prelude::*;
use reading::{Linked, linked};
use syntax::include::Wanted;

use crate::encoding::Encoding;
use crate::unit::{Unit, UnitCache};

/// A place in a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    /// The file.
    pub file: SourceFile,
    /// The place.
    pub span: Span,
}

/// Changes of several files: the file, and what is replaced in it.
pub type Edits = BTreeMap<String, (SourceFile, Vec<(Span, String)>)>;

/// The texts of a workspace at one moment. Cheap to clone.
#[derive(Clone)]
pub struct Workspace {
    inputs: Arc<[Input]>,
    config: Arc<Config>,
    cache: Arc<UnitCache>,
    /// How columns are counted.
    pub encoding: Encoding,
    by_name: Arc<HashMap<String, usize>>,
    linked: Arc<OnceLock<Linked>>,
    units: Arc<OnceLock<Vec<Arc<Unit>>>>,
}

impl Workspace {
    /// A workspace of these texts. Its shaders are read when they are first asked for; `cache` has those that were read
    /// before.
    pub fn new(inputs: Vec<Input>, config: Config, cache: Arc<UnitCache>, encoding: Encoding) -> Self {
        let by_name = inputs.iter().enumerate().map(|(index, i)| (i.file.name().to_owned(), index)).collect();
        Self {
            inputs: inputs.into(),
            config: Arc::new(config),
            cache,
            encoding,
            by_name: Arc::new(by_name),
            linked: Arc::default(),
            units: Arc::default(),
        }
    }

    /// A text by its name.
    pub fn file(&self, name: &str) -> Option<&SourceFile> {
        self.by_name.get(name).map(|index| &self.inputs[*index].file)
    }

    /// What the project says about itself.
    pub(crate) fn config(&self) -> &Config {
        &self.config
    }

    /// Programs, and names in host code.
    pub(crate) fn linked(&self) -> &Linked {
        self.linked.get_or_init(|| linked(&self.inputs, &self.config))
    }

    pub(crate) fn units(&self) -> &[Arc<Unit>] {
        self.units.get_or_init(|| {
            let of = |input: &Input| self.cache.units(input, &mut |wanted| self.included(wanted)).to_vec();
            self.inputs.par_iter().flat_map_iter(of).collect()
        })
    }

    /// The shaders that a file is, or is a part of; those of which it is the root first.
    pub(crate) fn units_of(&self, name: &str) -> Vec<&Arc<Unit>> {
        let mut units: Vec<&Arc<Unit>> = self.units().iter().filter(|u| u.files.contains(name)).collect();
        units.sort_by_key(|u| u.name != name);
        units
    }

    /// The shaders that a file holds by itself, without reading those of other files.
    pub(crate) fn own_units(&self, name: &str) -> Vec<Arc<Unit>> {
        let Some(index) = self.by_name.get(name) else { return Vec::new() };
        self.cache.units(&self.inputs[*index], &mut |wanted| self.included(wanted)).to_vec()
    }

    /// For each file, those with which it makes a program or a text: what is found in them may change with it.
    pub fn related(&self) -> HashMap<String, BTreeSet<String>> {
        let units: HashMap<&str, &Arc<Unit>> = self.units().iter().map(|u| (u.name.as_str(), u)).collect();
        let files = |names: &[String]| -> BTreeSet<String> {
            names.iter().filter_map(|n| units.get(n.as_str())).flat_map(|u| u.files.iter().cloned()).collect()
        };
        let programs = self.linked().programs.iter().map(|p| files(p));
        let hosts = self.linked().names.iter().map(|n| {
            let mut all = files(&n.shaders);
            all.insert(n.file.name().to_owned());
            all
        });
        let mut related: HashMap<String, BTreeSet<String>> = HashMap::new();
        for set in programs.chain(hosts).chain(units.values().map(|u| u.files.clone())).filter(|set| set.len() > 1) {
            for file in &set {
                related.entry(file.clone()).or_default().extend(set.iter().cloned());
            }
        }
        related
    }

    /// The same workspace with other texts.
    pub(crate) fn with(&self, texts: &BTreeMap<String, String>) -> Self {
        let changed = |input: &Input| match texts.get(input.file.name()) {
            Some(text) => input.with_file(SourceFile::new(input.file.name(), text.as_str())),
            None => input.clone(),
        };
        let inputs = self.inputs.iter().map(changed).collect();
        // What is only tried out must not push out what is there.
        let mut with = Self::new(inputs, (*self.config).clone(), Arc::default(), self.encoding);
        with.cache = Arc::default();
        with
    }

    /// The file that an `#include` means: beside the one that asks, or the only one whose path ends so.
    fn included(&self, wanted: &Wanted) -> Option<SourceFile> {
        let from = wanted.from.name();
        let folder = from.rsplit_once('/').map_or("", |(folder, _)| folder);
        let beside = normal(&format!("{folder}/{}", wanted.path));
        if let Some(file) = self.file(&beside) {
            return Some(file.clone());
        }
        let tail = format!("/{}", normal(&wanted.path).trim_start_matches(['.', '/']));
        let mut ending = self.inputs.iter().filter(|i| i.file.name().ends_with(&tail));
        match (ending.next(), ending.next()) {
            (Some(only), None) => Some(only.file.clone()),
            _ => None,
        }
    }
}

/// A path without `.` and those `..` that can be resolved.
fn normal(path: &str) -> String {
    let mut parts: Vec<&str> = Vec::new();
    for part in path.split('/') {
        match part {
            "" | "." => {}
            ".." if parts.last().is_some_and(|p| *p != "..") => {
                parts.pop();
            }
            part => parts.push(part),
        }
    }
    let joined = parts.join("/");
    if path.starts_with('/') { format!("/{joined}") } else { joined }
}
