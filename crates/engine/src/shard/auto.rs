//! Which shard this process is, by the variables of what started it.

use thiserror::Error;

use super::{Shard, ShardError};

/// Variable for the number of a shard, from 0, where nothing else says it.
pub const INDEX: &str = "SHADERCHECK_SHARD_INDEX";
/// Variable for the number of shards.
pub const COUNT: &str = "SHADERCHECK_SHARD_COUNT";

/// Why the environment names no shard.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum AutoError {
    /// No variable of any kind.
    #[error(
        "nothing says which shard this is: neither {INDEX} and {COUNT} are set nor the variables of an array job of \
         Slurm, Kubernetes, AWS Batch, GitLab or Buildkite; give --shard I/N"
    )]
    Nothing,
    /// Variables of several systems.
    #[error("{} and {} both say which shard this is; give --shard I/N", .0.join(", "), .1)]
    Several(Vec<&'static str>, &'static str),
    /// A variable that should be there as well.
    #[error("{system}: {present} is set and {missing} is not{hint}")]
    Missing {
        /// Name of the job system, such as `Slurm`.
        system: &'static str,
        /// A variable that is set.
        present: &'static str,
        /// The variable that is missing.
        missing: &'static str,
        /// Advice behind the message; may be empty.
        hint: &'static str,
    },
    /// A variable that is no number.
    #[error("{name} is `{value}`, which is no whole number")]
    NoNumber {
        /// The variable.
        name: &'static str,
        /// Text of the variable.
        value: String,
    },
    /// The numbers of a Slurm array leave gaps.
    #[error(
        "Slurm: the {count} tasks of the array are not {min} to {max} in steps of {step}; set {COUNT} to the number of \
         shards, and every task takes its own number"
    )]
    Gaps {
        /// Number of tasks.
        count: u64,
        /// Smallest number of a task.
        min: u64,
        /// Largest number of a task.
        max: u64,
        /// Step between numbers.
        step: u64,
    },
    /// The numbers are there and name no shard.
    #[error("{system}: {error}")]
    Shard {
        /// Name of the job system, such as `Slurm`.
        system: &'static str,
        /// Why the two numbers are no shard.
        error: ShardError,
    },
}

/// Looks variables up; one that is empty counts as one that is not set.
type Lookup<'a> = &'a dyn Fn(&str) -> Option<String>;

/// A system, the variable that tells it, and how its variables are read.
type System = (&'static str, &'static str, fn(Lookup<'_>) -> Result<Shard, AutoError>);

/// The systems: a name, the variable that tells them, and how they are read.
const SYSTEMS: [System; 6] = [
    ("Slurm", "SLURM_ARRAY_TASK_ID", slurm),
    ("Kubernetes", "JOB_COMPLETION_INDEX", kubernetes),
    ("AWS Batch", "AWS_BATCH_JOB_ARRAY_INDEX", aws),
    ("GitLab", "CI_NODE_INDEX", gitlab),
    ("Buildkite", "BUILDKITE_PARALLEL_JOB", buildkite),
    ("environment", INDEX, own),
];

/// The shard that the environment names.
///
/// | System | Number | Of how many |
/// |---|---|---|
/// | Slurm array jobs | `SLURM_ARRAY_TASK_ID`, by `_MIN` and `_STEP` | `SLURM_ARRAY_TASK_COUNT` |
/// | Kubernetes Indexed Jobs | `JOB_COMPLETION_INDEX` | `SHADERCHECK_SHARD_COUNT`, which the manifest sets |
/// | AWS Batch array jobs | `AWS_BATCH_JOB_ARRAY_INDEX` | `AWS_BATCH_JOB_ARRAY_SIZE`, or `SHADERCHECK_SHARD_COUNT` |
/// | GitLab `parallel` | `CI_NODE_INDEX`, from 1 | `CI_NODE_TOTAL` |
/// | Buildkite `parallelism` | `BUILDKITE_PARALLEL_JOB` | `BUILDKITE_PARALLEL_JOB_COUNT` |
/// | everything else, such as a matrix on GitHub | `SHADERCHECK_SHARD_INDEX`, from 0 | `SHADERCHECK_SHARD_COUNT` |
///
/// With `SHADERCHECK_SHARD_COUNT` a task of a Slurm array takes its own number as the number of the shard: some
/// of the tasks can then be run again alone.
///
/// # Errors
/// [`AutoError`] when no system or several can be told, or its variables name no shard.
pub fn detect(get: &dyn Fn(&str) -> Option<String>) -> Result<Shard, AutoError> {
    let get = |name: &str| get(name).filter(|value| !value.is_empty());
    let set = |name: &str| get(name).is_some();
    let present: Vec<_> = SYSTEMS.iter().filter(|(_, variable, _)| set(variable)).collect();
    match present[..] {
        [] if set(COUNT) => {
            Err(AutoError::Missing { system: "environment", present: COUNT, missing: INDEX, hint: "; set both" })
        }
        [] => Err(AutoError::Nothing),
        [(_, _, read)] => read(&get),
        [ref some @ .., (_, last, _)] => Err(AutoError::Several(some.iter().map(|(_, v, _)| *v).collect(), last)),
    }
}

fn number(get: Lookup<'_>, name: &'static str) -> Result<Option<u64>, AutoError> {
    let Some(value) = get(name) else { return Ok(None) };
    value.trim().parse().map(Some).map_err(|_| AutoError::NoNumber { name, value })
}

/// A variable that has to be there beside another one.
fn beside(
    get: Lookup<'_>,
    system: &'static str,
    present: &'static str,
    missing: &'static str,
    hint: &'static str,
) -> Result<u64, AutoError> {
    number(get, missing)?.ok_or(AutoError::Missing { system, present, missing, hint })
}

fn shard(system: &'static str, index: u64, count: u64) -> Result<Shard, AutoError> {
    Shard::new(index, count).map_err(|error| AutoError::Shard { system, error })
}

fn slurm(get: Lookup<'_>) -> Result<Shard, AutoError> {
    const ID: &str = "SLURM_ARRAY_TASK_ID";
    let of = |name| beside(get, "Slurm", ID, name, "");
    let id = of(ID)?;
    if let Some(count) = number(get, COUNT)? {
        return shard("Slurm", id, count);
    }
    let (min, max, count) = (of("SLURM_ARRAY_TASK_MIN")?, of("SLURM_ARRAY_TASK_MAX")?, of("SLURM_ARRAY_TASK_COUNT")?);
    let step = number(get, "SLURM_ARRAY_TASK_STEP")?.unwrap_or(1).max(1);
    // Numbers that are listed one by one, as those of some tasks that are run again.
    let even = max >= min && (max - min) / step + 1 == count && (id.wrapping_sub(min)).is_multiple_of(step);
    if !even || id < min {
        return Err(AutoError::Gaps { count, min, max, step });
    }
    shard("Slurm", (id - min) / step, count)
}

fn kubernetes(get: Lookup<'_>) -> Result<Shard, AutoError> {
    const INDEX: &str = "JOB_COMPLETION_INDEX";
    const HINT: &str = "; set it in the manifest to the `completions` of the job";
    let index = beside(get, "Kubernetes", INDEX, INDEX, "")?;
    shard("Kubernetes", index, beside(get, "Kubernetes", INDEX, COUNT, HINT)?)
}

fn aws(get: Lookup<'_>) -> Result<Shard, AutoError> {
    const INDEX: &str = "AWS_BATCH_JOB_ARRAY_INDEX";
    const SIZE: &str = "AWS_BATCH_JOB_ARRAY_SIZE";
    let index = beside(get, "AWS Batch", INDEX, INDEX, "")?;
    let size = match number(get, COUNT)? {
        Some(size) => size,
        None => beside(get, "AWS Batch", INDEX, SIZE, "; set SHADERCHECK_SHARD_COUNT to the size of the array")?,
    };
    shard("AWS Batch", index, size)
}

fn gitlab(get: Lookup<'_>) -> Result<Shard, AutoError> {
    const INDEX: &str = "CI_NODE_INDEX";
    let index = beside(get, "GitLab", INDEX, INDEX, "")?;
    let count = beside(get, "GitLab", INDEX, "CI_NODE_TOTAL", "")?;
    // Counted from 1: 0 becomes a number that no run has.
    shard("GitLab", index.wrapping_sub(1), count)
}

fn buildkite(get: Lookup<'_>) -> Result<Shard, AutoError> {
    const JOB: &str = "BUILDKITE_PARALLEL_JOB";
    let index = beside(get, "Buildkite", JOB, JOB, "")?;
    shard("Buildkite", index, beside(get, "Buildkite", JOB, "BUILDKITE_PARALLEL_JOB_COUNT", "")?)
}

fn own(get: Lookup<'_>) -> Result<Shard, AutoError> {
    let index = beside(get, "environment", INDEX, INDEX, "")?;
    shard("environment", index, beside(get, "environment", INDEX, COUNT, "; set both")?)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(variables: &[(&str, &str)]) -> Result<Shard, AutoError> {
        detect(&|name| variables.iter().find(|(n, _)| *n == name).map(|(_, v)| (*v).to_owned()))
    }

    fn slurm_of(id: &str, min: &str, max: &str, step: &str, count: &str) -> Result<Shard, AutoError> {
        of(&[
            ("SLURM_ARRAY_TASK_ID", id),
            ("SLURM_ARRAY_TASK_MIN", min),
            ("SLURM_ARRAY_TASK_MAX", max),
            ("SLURM_ARRAY_TASK_STEP", step),
            ("SLURM_ARRAY_TASK_COUNT", count),
        ])
    }

    #[test]
    fn every_system_names_its_shard() {
        let third_of_eight = Ok(Shard::new(2, 8).unwrap());
        assert_eq!(slurm_of("2", "0", "7", "1", "8"), third_of_eight);
        // --array=1-15:2
        assert_eq!(slurm_of("5", "1", "15", "2", "8"), third_of_eight);
        assert_eq!(of(&[("SLURM_ARRAY_TASK_ID", "2"), (COUNT, "8")]), third_of_eight);
        assert_eq!(of(&[("JOB_COMPLETION_INDEX", "2"), (COUNT, "8")]), third_of_eight);
        assert_eq!(of(&[("AWS_BATCH_JOB_ARRAY_INDEX", "2"), ("AWS_BATCH_JOB_ARRAY_SIZE", "8")]), third_of_eight);
        assert_eq!(of(&[("AWS_BATCH_JOB_ARRAY_INDEX", "2"), (COUNT, "8")]), third_of_eight);
        assert_eq!(of(&[("CI_NODE_INDEX", "3"), ("CI_NODE_TOTAL", "8")]), third_of_eight);
        assert_eq!(of(&[("BUILDKITE_PARALLEL_JOB", "2"), ("BUILDKITE_PARALLEL_JOB_COUNT", "8")]), third_of_eight);
        assert_eq!(of(&[(INDEX, "2"), (COUNT, "8")]), third_of_eight);
        // What is set and empty is not set.
        assert_eq!(of(&[(INDEX, "2"), (COUNT, "8"), ("CI_NODE_INDEX", "")]), third_of_eight);
    }

    #[test]
    fn none_and_several_are_refused() {
        assert_eq!(of(&[]), Err(AutoError::Nothing));
        let two = of(&[("SLURM_ARRAY_TASK_ID", "0"), ("CI_NODE_INDEX", "1")]).unwrap_err();
        assert_eq!(
            two.to_string(),
            "SLURM_ARRAY_TASK_ID and CI_NODE_INDEX both say which shard this is; give --shard I/N"
        );
        let error = of(&[(COUNT, "4")]).unwrap_err().to_string();
        assert_eq!(error, format!("environment: {COUNT} is set and {INDEX} is not; set both"));
    }

    #[test]
    fn what_names_no_shard_is_reported() {
        let error = |variables: &[(&str, &str)]| of(variables).unwrap_err().to_string();
        assert_eq!(
            error(&[("JOB_COMPLETION_INDEX", "1")]),
            format!(
                "Kubernetes: JOB_COMPLETION_INDEX is set and {COUNT} is not; set it in the manifest to the \
                 `completions` of the job"
            )
        );
        assert!(
            error(&[("JOB_COMPLETION_INDEX", "4"), (COUNT, "4")]).starts_with("Kubernetes: there is no shard 4 of 4")
        );
        assert!(error(&[("CI_NODE_INDEX", "0"), ("CI_NODE_TOTAL", "4")]).starts_with("GitLab: there is no shard"));
        assert_eq!(
            error(&[("CI_NODE_INDEX", "one"), ("CI_NODE_TOTAL", "4")]),
            "CI_NODE_INDEX is `one`, which is no whole number"
        );
        let gaps = slurm_of("3", "3", "7", "1", "2").unwrap_err().to_string();
        assert!(gaps.starts_with("Slurm: the 2 tasks of the array are not 3 to 7 in steps of 1"), "{gaps}");
        assert!(slurm_of("4", "1", "15", "2", "8").is_err(), "between two tasks");
    }
}
