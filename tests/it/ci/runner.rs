//! A stand-in for a runner of GitHub: conditions, expressions, environment files, and `bash` as it is called there.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use super::keys::{Action, Step};
use crate::binary::{Ran, root};

/// An action of somebody else that would have been called.
#[derive(Debug)]
pub struct Event {
    /// Its name.
    pub uses: String,
    /// Its inputs.
    pub with: BTreeMap<String, String>,
}

/// A run of a composite action.
pub struct Runner {
    action: Action,
    workspace: PathBuf,
    files: tempfile::TempDir,
    inputs: BTreeMap<String, String>,
    outputs: BTreeMap<String, String>,
    named: Vec<String>,
    /// Actions of others, in their order.
    pub events: Vec<Event>,
    /// What all steps printed.
    pub log: String,
    /// Status of the first step that failed.
    pub status: i32,
}

/// The expressions in a text.
pub fn expressions(text: &str) -> Vec<String> {
    let parts = text.split("${{").skip(1).filter_map(|part| part.split_once("}}"));
    parts.map(|(expression, _)| expression.trim().to_owned()).collect()
}

impl Runner {
    /// Of an action that is given inputs, in a folder that was checked out.
    pub fn new(action: &str, workspace: &Path, inputs: &[(&str, &str)]) -> Self {
        let action: Action = serde_norway::from_str(action).unwrap();
        let mut all: BTreeMap<String, String> =
            action.inputs.iter().map(|(name, input)| (name.clone(), input.default.clone())).collect();
        for (name, value) in inputs {
            assert!(all.contains_key(*name), "there is no input `{name}`");
            all.insert((*name).to_owned(), (*value).to_owned());
        }
        Self {
            action,
            workspace: workspace.to_owned(),
            files: tempfile::tempdir().unwrap(),
            inputs: all,
            outputs: BTreeMap::new(),
            named: Vec::new(),
            events: Vec::new(),
            log: String::new(),
            status: 0,
        }
    }

    /// Sets an input.
    pub fn set(&mut self, input: &str, value: &str) {
        assert!(self.inputs.insert(input.to_owned(), value.to_owned()).is_some(), "there is no input `{input}`");
    }

    /// An output of a step.
    pub fn output(&self, step: &str, name: &str) -> String {
        self.outputs.get(&format!("{step}.{name}")).cloned().unwrap_or_default()
    }

    /// The summary of the job.
    pub fn summary(&self) -> String {
        fs::read_to_string(self.files.path().join("summary")).unwrap_or_default()
    }

    /// Names of the steps whose conditions hold.
    pub fn would_run(&self) -> Vec<&str> {
        self.named.iter().map(String::as_str).collect()
    }

    /// Looks at conditions alone.
    pub fn only_conditions(&mut self) {
        let steps = std::mem::take(&mut self.action.runs.steps);
        self.named = steps.iter().filter(|step| self.holds(step)).filter_map(|step| step.name.clone()).collect();
        self.action.runs.steps = steps;
    }

    /// Runs all steps; after one that fails, none is run.
    pub fn run(&mut self) {
        let steps = std::mem::take(&mut self.action.runs.steps);
        for step in &steps {
            if self.status != 0 || !self.holds(step) {
                continue;
            }
            match (&step.uses, &step.run) {
                (Some(uses), _) => {
                    let with = step.with.iter();
                    let with =
                        with.map(|(name, value)| (name.clone(), self.filled(value.as_str().unwrap_or_default())));
                    let with = with.collect();
                    self.events.push(Event { uses: uses.clone(), with });
                }
                (None, Some(run)) => self.shell(step, run),
                (None, None) => panic!("a step without anything to do"),
            }
        }
    }

    fn shell(&mut self, step: &Step, run: &str) {
        assert_eq!(step.shell.as_deref(), Some("bash"));
        let file = |name: &str| self.files.path().join(name);
        let (script, output) = (file("step.sh"), file("output"));
        fs::write(&script, run).unwrap();
        fs::write(&output, "").unwrap();
        let mut command = Command::new("bash");
        // As a runner calls it.
        command.args(["--noprofile", "--norc", "-e", "-o", "pipefail"]).arg(&script).current_dir(&self.workspace);
        command
            .env("GITHUB_ACTION_PATH", root())
            .env("GITHUB_STEP_SUMMARY", file("summary"))
            .env("GITHUB_OUTPUT", &output)
            .env("RUNNER_TEMP", file("temp"))
            .env("RUNNER_OS", "Linux")
            .env("RUNNER_ARCH", "X64")
            .env("CI", "true");
        for (name, value) in &step.env {
            command.env(name, self.filled(value));
        }
        let ran: Ran = command.output().unwrap().into();
        self.log.push_str(&ran.out);
        self.log.push_str(&ran.err);
        if ran.code != 0 {
            self.status = ran.code;
        }
        for line in fs::read_to_string(&output).unwrap().lines() {
            let (name, value) = line.split_once('=').unwrap();
            let id = step.id.as_ref().unwrap();
            self.outputs.insert(format!("{id}.{name}"), value.to_owned());
        }
    }

    /// A text with its expressions filled in.
    fn filled(&self, text: &str) -> String {
        let mut out = text.to_owned();
        for expression in expressions(text) {
            let value = self.value(&expression);
            let (before, after) = out.split_once("${{").unwrap();
            let (_, after) = after.split_once("}}").unwrap();
            out = format!("{before}{value}{after}");
        }
        out
    }

    fn value(&self, name: &str) -> String {
        let name = name.trim();
        if let Some(text) = name.strip_prefix('\'').and_then(|rest| rest.strip_suffix('\'')) {
            return text.to_owned();
        }
        match name.split('.').collect::<Vec<_>>()[..] {
            ["inputs", input] => self.inputs[input].clone(),
            ["steps", step, "outputs", output] => self.output(step, output),
            ["runner", "os"] => "Linux".to_owned(),
            _ => panic!("no value for `{name}`"),
        }
    }

    /// Whether the condition of a step holds: comparisons and `contains`, joined by `&&`.
    fn holds(&self, step: &Step) -> bool {
        let Some(condition) = &step.condition else { return true };
        condition.split("&&").map(str::trim).all(|part| {
            if let Some(inside) = part.strip_prefix("contains(").and_then(|rest| rest.strip_suffix(')')) {
                let (all, one) = inside.split_once(',').unwrap();
                return self.value(all).contains(&self.value(one));
            }
            if let Some((a, b)) = part.split_once("!=") {
                return self.value(a) != self.value(b);
            }
            let (a, b) = part.split_once("==").unwrap_or_else(|| panic!("`{part}` is no condition"));
            self.value(a) == self.value(b)
        })
    }
}
