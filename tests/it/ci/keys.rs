//! What GitHub and GitLab know at each place of their files, as far as ours use it. A key that is not listed here is
//! an error, as it is for them.

use std::collections::BTreeMap;

use clap::Parser;
use serde::Deserialize;
use serde_norway::Value;

use super::runner::expressions;
use crate::binary::root;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Action {
    pub name: String,
    pub description: String,
    pub inputs: BTreeMap<String, Input>,
    pub outputs: BTreeMap<String, Output>,
    pub runs: Runs,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Input {
    pub description: String,
    /// A text: GitHub hands nothing else on.
    pub default: String,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Output {
    pub description: String,
    pub value: String,
}

#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Using {
    Composite,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Runs {
    #[expect(dead_code, reason = "only its value is looked at")]
    pub using: Using,
    pub steps: Vec<Step>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Step {
    pub name: Option<String>,
    pub id: Option<String>,
    #[serde(rename = "if")]
    pub condition: Option<String>,
    pub uses: Option<String>,
    #[serde(default)]
    pub with: BTreeMap<String, Value>,
    pub run: Option<String>,
    pub shell: Option<String>,
    #[serde(default)]
    pub env: BTreeMap<String, String>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Workflow {
    name: String,
    on: BTreeMap<Event, Option<Filter>>,
    #[serde(default)]
    #[expect(dead_code, reason = "only its type is looked at")]
    permissions: BTreeMap<Scope, Access>,
    jobs: BTreeMap<String, Job>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Event {
    Push,
    PullRequest,
    Schedule,
    WorkflowDispatch,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
struct Filter {
    #[serde(default)]
    #[expect(dead_code, reason = "only its type is looked at")]
    branches: Vec<String>,
    #[serde(default)]
    #[expect(dead_code, reason = "only its type is looked at")]
    tags: Vec<String>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Scope {
    Attestations,
    Contents,
    IdToken,
    Packages,
    SecurityEvents,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Access {
    Read,
    Write,
    None,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
struct Job {
    #[serde(rename = "if")]
    condition: Option<String>,
    runs_on: String,
    #[serde(default)]
    needs: Needs,
    #[serde(default)]
    #[expect(dead_code, reason = "only its type is looked at")]
    permissions: BTreeMap<Scope, Access>,
    #[serde(default)]
    strategy: Strategy,
    steps: Vec<Step>,
}

/// One job or a list.
#[derive(Debug, Deserialize)]
#[serde(untagged)]
enum Needs {
    One(String),
    Several(Vec<String>),
}

impl Default for Needs {
    fn default() -> Self {
        Self::Several(Vec::new())
    }
}

impl Needs {
    fn jobs(&self) -> &[String] {
        match self {
            Self::One(job) => std::slice::from_ref(job),
            Self::Several(jobs) => jobs,
        }
    }
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
struct Strategy {
    #[serde(default)]
    matrix: BTreeMap<String, Vec<Value>>,
    #[expect(dead_code, reason = "only its type is looked at")]
    fail_fast: Option<bool>,
}

impl Strategy {
    /// Whether the matrix has a value of this name for some job.
    fn has(&self, name: &str) -> bool {
        let listed = self.matrix.get("include").into_iter().flatten();
        self.matrix.contains_key(name) || listed.filter_map(Value::as_mapping).any(|one| one.contains_key(name))
    }
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Pipeline {
    shaders: GitlabJob,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct GitlabJob {
    image: String,
    variables: BTreeMap<String, String>,
    #[expect(dead_code, reason = "only its type is looked at")]
    cache: Cache,
    before_script: Vec<String>,
    script: Vec<String>,
    artifacts: Artifacts,
    #[expect(dead_code, reason = "only its type is looked at")]
    parallel: Option<u32>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(dead_code, reason = "only types are looked at")]
struct Cache {
    key: String,
    paths: Vec<String>,
}

#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
enum When {
    OnSuccess,
    OnFailure,
    Always,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Artifacts {
    when: When,
    #[expect(dead_code, reason = "only its type is looked at")]
    expire_in: String,
    paths: Vec<String>,
    reports: Reports,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Reports {
    junit: String,
    codequality: String,
}

/// Actions of others, with their inputs.
const OTHERS: &[(&str, &[&str])] = &[
    ("actions/checkout", &["ref", "path", "fetch-depth"]),
    ("actions/cache", &["path", "key", "restore-keys"]),
    ("actions/upload-artifact", &["name", "path", "if-no-files-found", "retention-days"]),
    ("actions/download-artifact", &["name", "path", "pattern", "merge-multiple"]),
    ("actions/attest-build-provenance", &["subject-path"]),
    ("github/codeql-action/upload-sarif", &["sarif_file", "category"]),
];
/// The action itself, as a workflow of somebody else names it.
const OWN: &str = "OWNER/shadercheck";

/// What is wrong with the files.
pub fn faults(action: &str, workflow: &str, gitlab: &str) -> Vec<String> {
    let mut faults = Vec::new();
    let action = match serde_norway::from_str::<Action>(action) {
        Ok(action) => Some(action),
        Err(error) => {
            faults.push(format!("action.yml: {error}"));
            None
        }
    };
    if let Some(action) = &action {
        let inputs: Vec<&str> = action.inputs.keys().map(String::as_str).collect();
        of_steps("action.yml", &action.runs.steps, Some(&inputs), None, &mut faults);
        let outputs = action.outputs.values().map(|output| output.value.as_str());
        of_expressions("action.yml", outputs, &ids(&action.runs.steps), Some(&inputs), &mut faults);
        let reported =
            action.inputs.values().map(|i| &i.description).chain(action.outputs.values().map(|o| &o.description));
        if reported.chain([&action.name, &action.description]).any(String::is_empty) {
            faults.push("action.yml: something has no description".into());
        }
    }
    match serde_norway::from_str::<Workflow>(workflow) {
        Err(error) => faults.push(format!("workflow.yml: {error}")),
        Ok(workflow) => of_workflow(&workflow, action.as_ref(), &mut faults),
    }
    match serde_norway::from_str::<Pipeline>(gitlab) {
        Err(error) => faults.push(format!(".gitlab-ci.yml: {error}")),
        Ok(pipeline) => of_gitlab(&pipeline.shaders, &mut faults),
    }
    faults
}

fn of_workflow(workflow: &Workflow, action: Option<&Action>, faults: &mut Vec<String>) {
    if workflow.name.is_empty() || workflow.on.is_empty() {
        faults.push("workflow.yml: nothing starts it".into());
    }
    for (name, job) in &workflow.jobs {
        let at = format!("workflow.yml, {name}");
        of_steps(&at, &job.steps, None, action, faults);
        of_expressions(&at, job.condition.iter().map(String::as_str), &[], None, faults);
        for needed in job.needs.jobs().iter().filter(|needed| !workflow.jobs.contains_key(*needed)) {
            faults.push(format!("{at}: there is no job `{needed}`"));
        }
        let used = job.steps.iter().flat_map(|step| step.run.iter().chain(&step.condition).chain(&step.name));
        let used = used.chain([&job.runs_on]).flat_map(|text| text.split("matrix.").skip(1));
        for name in used.filter_map(|rest| rest.split(|c: char| !c.is_alphanumeric() && c != '_').next()) {
            if !job.strategy.has(name) {
                faults.push(format!("{at}: the matrix has no `{name}`"));
            }
        }
        if job.runs_on.is_empty() {
            faults.push(format!("{at}: it runs nowhere"));
        }
    }
}

fn ids(steps: &[Step]) -> Vec<&str> {
    steps.iter().filter_map(|step| step.id.as_deref()).collect()
}

fn of_steps(at: &str, steps: &[Step], inputs: Option<&[&str]>, action: Option<&Action>, faults: &mut Vec<String>) {
    let ids = ids(steps);
    for (k, id) in ids.iter().enumerate() {
        if ids[..k].contains(id) {
            faults.push(format!("{at}: two steps are called `{id}`"));
        }
    }
    for (number, step) in steps.iter().enumerate() {
        let at = format!("{at}, step {number}");
        match (&step.run, &step.uses) {
            (Some(run), None) => {
                if inputs.is_some() && step.shell.is_none() {
                    faults.push(format!("{at}: has `run` and no shell"));
                }
                of_commands(&at, run, faults);
            }
            (None, Some(uses)) => of_use(&at, uses, step, action, faults),
            _ => faults.push(format!("{at}: it has either `run` or `uses`")),
        }
        if inputs.is_some() && step.name.is_none() {
            faults.push(format!("{at}: it has no name"));
        }
        let values: Vec<String> = step.with.values().map(shown).collect();
        let texts = step.env.values().chain(&values).chain(&step.run).map(String::as_str);
        of_expressions(&at, texts, &ids, inputs, faults);
        // A condition is an expression without the brackets.
        let condition = step.condition.iter().map(|condition| format!("${{{{ {condition} }}}}")).collect::<Vec<_>>();
        of_expressions(&at, condition.iter().map(String::as_str), &ids, inputs, faults);
    }
}

fn shown(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        other => serde_norway::to_string(other).unwrap_or_default(),
    }
}

fn of_use(at: &str, uses: &str, step: &Step, action: Option<&Action>, faults: &mut Vec<String>) {
    let Some((name, version)) = uses.split_once('@') else {
        return faults.push(format!("{at}: `{uses}` has no version"));
    };
    if version.is_empty() {
        faults.push(format!("{at}: `{uses}` has no version"));
    }
    if name == OWN {
        let known = |key: &String| action.is_none_or(|action| action.inputs.contains_key(key));
        let unknown = step.with.keys().filter(|key| !known(key));
        faults.extend(unknown.map(|key| format!("{at}: the action has no input `{key}`")));
        return;
    }
    let Some((_, known)) = OTHERS.iter().find(|(other, _)| *other == name) else {
        return faults.push(format!("{at}: `{name}` is no action that is known here"));
    };
    let unknown = step.with.keys().filter(|key| !known.contains(&key.as_str()));
    faults.extend(unknown.map(|key| format!("{at}: {name} has no input `{key}`")));
}

/// Everything that is referred to is there.
fn of_expressions<'t>(
    at: &str,
    texts: impl Iterator<Item = &'t str>,
    ids: &[&str],
    inputs: Option<&[&str]>,
    faults: &mut Vec<String>,
) {
    for name in texts.flat_map(expressions).flat_map(|expression| names(&expression)) {
        let parts: Vec<&str> = name.split('.').collect();
        match (parts.as_slice(), inputs) {
            (["inputs", input], Some(inputs)) => {
                if !inputs.contains(input) {
                    faults.push(format!("{at}: there is no input `{input}`"));
                }
            }
            (["steps", step, "outputs", _], _) => {
                if !ids.contains(step) {
                    faults.push(format!("{at}: there is no step `{step}`"));
                }
            }
            (
                ["runner", "os" | "arch" | "temp"]
                | ["strategy", "job-index" | "job-total"]
                | ["github", "ref" | "action_ref" | "action_repository" | "token"]
                | ["matrix" | "vars" | "secrets", _],
                _,
            ) => {}
            (other, _) => faults.push(format!("{at}: `{}` is not known", other.join("."))),
        }
    }
}

/// The names with points in an expression.
fn names(expression: &str) -> Vec<String> {
    let mut outside = String::new();
    for (k, part) in expression.split('\'').enumerate() {
        outside.push_str(if k % 2 == 0 { part } else { " " });
    }
    let word = |c: char| c.is_ascii_alphanumeric() || "._-".contains(c);
    outside.split(|c| !word(c)).filter(|name| name.contains('.')).map(str::to_owned).collect()
}

/// Commands of the program take their arguments.
fn of_commands(at: &str, text: &str, faults: &mut Vec<String>) {
    for line in text.lines().map(str::trim).filter(|line| line.starts_with("shadercheck ")) {
        if let Err(error) = shadercheck::cli::Cli::try_parse_from(line.split_whitespace()) {
            faults.push(format!("{at}: the program does not take `{line}`: {error}"));
        }
    }
}

fn of_gitlab(job: &GitlabJob, faults: &mut Vec<String>) {
    let mut unless = |right: bool, what: String| {
        if !right {
            faults.push(format!(".gitlab-ci.yml: {what}"));
        }
    };
    let reports = job.variables.get("REPORTS").cloned().unwrap_or_default();
    unless(!job.image.is_empty(), "no image".into());
    unless(job.artifacts.when == When::Always, "reports of a job that fails are kept".into());
    unless(job.artifacts.paths == [reports.clone()], "the folder of reports is kept".into());
    let junit = &job.artifacts.reports.junit;
    let quality = &job.artifacts.reports.codequality;
    for (named, file) in [(junit, "junit.xml"), (quality, "code-quality.json")] {
        unless(named == &format!("{reports}/{file}"), format!("`{named}` is not below the folder of reports"));
    }
    for line in job.before_script.iter().chain(&job.script) {
        let Some(script) = line.split_whitespace().next().and_then(|word| word.split_once(".shadercheck/")) else {
            continue;
        };
        unless(root().join(script.1).is_file(), format!("`{}` is not in this repository", script.1));
    }
}
