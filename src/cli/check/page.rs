//! The page of a run: what it needs beside the report is collected while the run goes on.

use std::path::{Path, PathBuf};

use anyhow::Context;
use serde_json::Value;

use base::text::{Shown, SourceFile};
use disk::fresh;
use engine::suite::run::{Gallery, Prepared, Promised, Report, Request, Summary, gallery, promised};
use judge::profile::Promises;
use lanes::{Lane, LaneError, Stage};
use report::html::{self, Page, Site, Subject};

/// What a page is made of, for a folder of reports.
#[derive(Default)]
pub struct Pages {
    folder: Option<PathBuf>,
    mutations: Option<Value>,
    subjects: Vec<Subject>,
    /// By entry of the run.
    galleries: Vec<Option<Gallery>>,
    /// Why something is not shown.
    pub notes: Vec<String>,
    /// The first file that could not be written.
    pub failed: Option<anyhow::Error>,
}

impl Pages {
    /// For a folder, if there is one; `mutations` is a file that `mutate --format json` printed.
    ///
    /// # Errors
    /// When that file cannot be read, or is something else.
    pub fn new(folder: Option<&Path>, mutations: Option<&Path>) -> anyhow::Result<Self> {
        let mutations = match mutations {
            Some(path) => {
                let shown = path.shown();
                let text = std::fs::read_to_string(path).with_context(|| format!("cannot read `{shown}`"))?;
                let value: Value = serde_json::from_str(&text).with_context(|| format!("`{shown}` is no JSON"))?;
                anyhow::ensure!(
                    value["suites"].as_array().is_some_and(|suites| suites.iter().all(|s| s["mutants"].is_array())),
                    "`{shown}` holds no results of `shadercheck mutate --format json`"
                );
                Some(value)
            }
            None => None,
        };
        Ok(Self { folder: folder.map(Path::to_owned), mutations, ..Self::default() })
    }

    /// Keeps why a file could not be written: what was found is reported before that ends the run.
    pub fn attempt(&mut self, written: anyhow::Result<()>) {
        if let Err(error) = written {
            self.failed.get_or_insert(error);
        }
    }

    /// Takes over what a suite is about.
    pub fn suite(&mut self, name: &str, title: &str, shader: &SourceFile, prepared: Option<&Prepared>) {
        self.subjects.push(Subject {
            name: name.to_owned(),
            title: title.to_owned(),
            against: prepared.map_or("formula", |prepared| prepared.reference.noun()).to_owned(),
            shader: shader.clone(),
        });
    }

    /// Looks at a suite that ran. A page without a picture is better than none: what the lane cannot do is noted.
    pub fn look(&mut self, prepared: &Prepared, lane: &dyn Lane, stage: Stage, request: &Request, report: &Report) {
        if self.folder.is_none() {
            return;
        }
        let looked: Result<Option<Gallery>, LaneError> = gallery(prepared, lane, stage, request, report);
        self.galleries.push(looked.unwrap_or_else(|error| {
            self.notes.push(format!("no picture of {} on {}/{stage}: {error}", report.suite, report.lane));
            None
        }));
    }

    /// Goes on to an entry of the run; what was not looked at has no picture.
    pub fn next(&mut self, entries: usize) {
        self.galleries.resize_with(entries, || None);
    }

    /// Writes the page with its charts.
    ///
    /// # Errors
    /// When a file cannot be written.
    pub fn write(&self, folder: &Path, summary: &Summary, promises: &[Promises]) -> anyhow::Result<()> {
        let promises: Vec<(String, Vec<Promised>)> = summary
            .lanes
            .iter()
            .zip(promises)
            .map(|(used, promises)| (used.description.name.to_owned(), promised(promises)))
            .collect();
        let (subjects, galleries) = (&self.subjects[..], &self.galleries[..]);
        let page = Page { summary, subjects, galleries, promises: &promises, mutations: self.mutations.as_ref() };
        let site = html::write(&page).map_err(anyhow::Error::msg).context("cannot draw the page")?;
        write_site(folder, site)
    }
}

/// Writes the files of a page into a folder, which is made.
///
/// # Errors
/// When a file cannot be written.
pub(in crate::cli) fn write_site(folder: &Path, site: Site) -> anyhow::Result<()> {
    let plots = folder.join("plots");
    std::fs::create_dir_all(&plots).with_context(|| format!("cannot make the folder `{}`", plots.shown()))?;
    let index = std::iter::once((folder.join("index.html"), site.index.into_bytes()));
    for (path, bytes) in index.chain(site.plots.into_iter().map(|(name, bytes)| (plots.join(name), bytes))) {
        fresh::write(&path, &bytes).with_context(|| format!("cannot write `{}`", path.shown()))?;
    }
    Ok(())
}
