//! `cargo xtask slurm-demo`: a run shared out by Slurm, with a shard that is killed on the way.

mod cluster;

use std::ffi::OsString;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail, ensure};

use crate::cargo::{cargo, status, workspace};
use cluster::{ADVICE, Cluster, missing, wait};

/// Samples of the check: some minutes on two cores.
const SAMPLES: u64 = 100_000_000;
/// Shards of the check: several for each node, so that one that starts again holds nobody up.
const SHARDS: u64 = 8;
/// Longest that a job may take.
const PATIENCE: Duration = Duration::from_secs(6 * 3600);

struct Options {
    samples: u64,
    suite: String,
    lane: String,
    builtin: String,
    program: Option<PathBuf>,
}

fn options(arguments: &[OsString]) -> Result<Options> {
    let mut options = Options {
        samples: SAMPLES,
        suite: "sphere".to_owned(),
        lane: "vulkan".to_owned(),
        builtin: "sqrt".to_owned(),
        program: None,
    };
    let mut rest = arguments.iter();
    while let Some(name) = rest.next() {
        let name = name.to_string_lossy();
        let value = rest.next().with_context(|| format!("`{name}` needs a value"))?;
        let text = value.to_string_lossy().into_owned();
        match &*name {
            "--samples" => {
                let samples = text.parse().ok().filter(|samples| *samples > 0);
                options.samples = samples.with_context(|| format!("`{text}` is no number of samples"))?;
            }
            "--suite" => options.suite = text,
            "--lane" => options.lane = text,
            "--builtin" => options.builtin = text,
            "--program" => options.program = Some(fs::canonicalize(value).with_context(|| text.clone())?),
            _ => bail!("slurm-demo has no option `{name}`; it takes --samples, --suite, --lane, --builtin, --program"),
        }
    }
    Ok(options)
}

/// A folder that goes when this does.
struct Folder(PathBuf);

impl Folder {
    fn new() -> Result<Self> {
        let path = std::env::temp_dir().join(format!("shadercheck-slurm-{}", std::process::id()));
        fs::create_dir(&path).with_context(|| format!("cannot make `{}`", path.display()))?;
        Ok(Self(path))
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        // Left behind it would be a nuisance and no fault.
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// What a run said, and how long it took.
struct Single {
    text: String,
    code: i32,
    took: Duration,
}

/// Runs the demonstration. The status is 1 when a result is not that of the single run.
pub fn run(arguments: &[OsString], messages: &mut dyn Write) -> Result<u8> {
    let options = options(arguments)?;
    let missing = missing();
    if !missing.is_empty() {
        writeln!(messages, "xtask: {} cannot be found: run `{ADVICE}` as root", missing.join(", "))?;
        return Ok(2);
    }
    let workspace = workspace()?;
    let program = match &options.program {
        Some(program) => program.clone(),
        None => {
            let built = status(cargo(["build", "--release", "--package", "shadercheck"]).current_dir(&workspace))?;
            ensure!(built == 0, "the program cannot be built");
            let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| workspace.join("target"), PathBuf::from);
            target.join("release/shadercheck")
        }
    };
    let folder = Folder::new()?;
    let cluster = Cluster::start(&folder.0)?;
    writeln!(messages, "slurm-demo: two nodes are idle; daemons {:?}, folder {}", cluster.pids(), folder.0.display())?;
    let mut demo = Demo { workspace, program, folder: &folder.0, cluster: &cluster, messages };
    let mut same = demo.check(&options)?;
    if options.builtin != "none" {
        same &= demo.sweep(&options)?;
    }
    demo.throughput(&options)?;
    drop(cluster);
    writeln!(messages, "slurm-demo: the cluster is gone; {}", if same { "all results are equal" } else { "FAILED" })?;
    Ok(u8::from(!same))
}

struct Demo<'a> {
    workspace: PathBuf,
    program: PathBuf,
    folder: &'a Path,
    cluster: &'a Cluster,
    messages: &'a mut dyn Write,
}

impl Demo<'_> {
    fn say(&mut self, text: &str) -> Result<()> {
        writeln!(self.messages, "slurm-demo: {text}")?;
        Ok(())
    }

    /// The program on this core alone. Without being bound, the threads of the driver and the process that has its device
    /// overlap with the rest, and one process takes more than a core.
    fn on_one_core(&self, core: usize, arguments: &[String]) -> Command {
        let mut command = Command::new("taskset");
        command
            .args(["--cpu-list", &core.to_string()])
            .arg(&self.program)
            .args(arguments)
            .current_dir(self.folder)
            .stdin(Stdio::null())
            .stderr(Stdio::inherit());
        command.envs([("RAYON_NUM_THREADS", "1"), ("LP_NUM_THREADS", "1"), ("NO_COLOR", "1")]);
        command
    }

    fn single(&mut self, arguments: &[String]) -> Result<Single> {
        let begin = Instant::now();
        let core = *cores()?.first().context("this process may run on no core")?;
        let output = self.on_one_core(core, arguments).output()?;
        let (took, code) = (begin.elapsed(), output.status.code().unwrap_or(-1));
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        self.say(&format!("single run on one core: status {code}, {:.1} s", took.as_secs_f64()))?;
        Ok(Single { text, code, took })
    }

    /// Submits a run. Gives its folder, and the numbers of both jobs.
    fn submit(&mut self, name: &str, shards: u64, arguments: &[String]) -> Result<(PathBuf, String, String)> {
        let folder = self.folder.join(name);
        let mut submit = Command::new(self.workspace.join("deploy/slurm/submit.sh"));
        submit.arg(shards.to_string()).arg(&folder).args(arguments).current_dir(self.folder);
        submit.env("SHADERCHECK", &self.program).env("RAYON_NUM_THREADS", "1").env("LP_NUM_THREADS", "1");
        let text = self.cluster.output_of(&mut submit)?;
        let job = |which: &str| {
            let number = text.lines().find_map(|line| line.strip_prefix(which));
            number.map(|number| number.trim().to_owned()).with_context(|| format!("submit.sh said `{text}`"))
        };
        let (array, merge) = (job("shards ")?, job("merge ")?);
        self.say(&format!("{name}: {shards} shards are job {array}, the merge is job {merge}"))?;
        Ok((folder, array, merge))
    }

    /// Waits for the end of a run. Gives the report and the state of the merge.
    fn finish(&mut self, folder: &Path, array: &str, merge: &str) -> Result<(String, String)> {
        let ended = |state: &String| ["COMPLETED", "FAILED", "CANCELLED", "TIMEOUT"].contains(&state.as_str());
        wait("the merge did not end", PATIENCE, || {
            let states = self.cluster.states(array)?;
            ensure!(!states.iter().any(|state| state == "FAILED"), "a shard failed; see {}", log(folder));
            Ok(self.cluster.states(merge)?.iter().all(ended))
        })?;
        let state = self.cluster.states(merge)?.join(" ");
        let report = fs::read_to_string(folder.join("report.txt"))
            .with_context(|| format!("the merge is {state} and left no report: {}", read(&folder.join("merge.log"))))?;
        Ok((report, state))
    }

    /// A check in shards, one of which is killed as soon as it has a checkpoint.
    fn check(&mut self, options: &Options) -> Result<bool> {
        let words = ["check", &options.suite, "--stage", "compute", "--lane", &options.lane, "--samples"];
        let mut arguments: Vec<String> = words.map(str::to_owned).to_vec();
        arguments.push(options.samples.to_string());
        self.say(&format!("shadercheck {}", arguments.join(" ")))?;
        let begin = Instant::now();
        let (folder, array, merge) = self.submit("check", SHARDS, &arguments)?;
        let checkpoint = folder.join(format!("shard-{:05}-of-{SHARDS:05}.checkpoint", 1));
        let result = checkpoint.with_extension("json");
        wait("shard 1 has no checkpoint", PATIENCE, || {
            ensure!(!result.exists(), "shard 1 was done before it had a checkpoint; take more --samples");
            Ok(checkpoint.exists())
        })?;
        self.cluster.output("scontrol", &["requeue", &format!("{array}_1")])?;
        self.say("shard 1 had a checkpoint; it was killed, and is in the queue again")?;
        let (report, state) = self.finish(&folder, &array, &merge)?;
        let took = begin.elapsed();
        self.say(&format!("merged after {:.1} s, job {state}", took.as_secs_f64()))?;
        let log = read(&folder.join("shard-1.log"));
        let resumed = log.contains("goes on from its checkpoint");
        self.say(&format!("shard 1 said: {}", log.trim().replace('\n', " | ")))?;
        if !resumed {
            self.say("shard 1 came to its end before it was killed: take more --samples")?;
        }
        let single = self.single(&arguments)?;
        self.compare(&report, &single, resumed)
    }

    /// Every binary32 number through a built-in function, in shards.
    fn sweep(&mut self, options: &Options) -> Result<bool> {
        let words = ["calibrate", "--exhaustive", "--builtin", &options.builtin, "--lane", &options.lane, "--output"];
        let profile = self.folder.join("sweep.profile.toml");
        let mut arguments: Vec<String> = words.map(str::to_owned).to_vec();
        arguments.push(profile.display().to_string());
        self.say(&format!("shadercheck {}", arguments.join(" ")))?;
        let begin = Instant::now();
        let (folder, array, merge) = self.submit("sweep", 4, &arguments)?;
        let (report, state) = self.finish(&folder, &array, &merge)?;
        self.say(&format!("merged after {:.1} s, job {state}", begin.elapsed().as_secs_f64()))?;
        let merged = read(&profile);
        fs::remove_file(&profile).context("the merge wrote no profile")?;
        let single = self.single(&arguments)?;
        let same = merged == read(&profile);
        if !same {
            self.say("the profiles differ")?;
        }
        self.compare(&report, &single, same)
    }

    fn compare(&mut self, report: &str, single: &Single, also: bool) -> Result<bool> {
        let same = report == single.text;
        for line in report.lines().filter(|line| !line.is_empty()).take(12) {
            self.say(&format!("  {line}"))?;
        }
        self.say(&format!(
            "merged report and single run (status {}): {}",
            single.code,
            if same { "equal, byte by byte" } else { "DIFFERENT" }
        ))?;
        Ok(same && also)
    }

    /// How much faster two shards at a time are than one process on one core.
    fn throughput(&mut self, options: &Options) -> Result<()> {
        let cores = cores()?;
        let [first, second, ..] = cores[..] else {
            return self.say("two shards at a time were NOT MEASURED: this process may run on one core alone");
        };
        let samples = (options.samples / 4).max(1).to_string();
        let words = ["check", &options.suite, "--stage", "compute", "--lane", &options.lane, "--samples", &samples];
        let arguments: Vec<String> = words.map(str::to_owned).to_vec();
        let single = self.single(&arguments)?;
        let begin = Instant::now();
        let mut running = Vec::new();
        for (core, shard) in [(first, "0/2"), (second, "1/2")] {
            let more = ["--shard", shard, "--shard-dir", "two"].map(str::to_owned);
            let arguments = [&arguments[..], &more].concat();
            running.push(self.on_one_core(core, &arguments).stdout(Stdio::null()).spawn()?);
        }
        for mut process in running {
            ensure!(process.wait()?.success(), "a shard failed");
        }
        let two = begin.elapsed().as_secs_f64();
        let one = single.took.as_secs_f64();
        self.say(&format!("two shards at a time, {samples} samples: {two:.1} s, {:.2} times as fast as one", one / two))
    }
}

/// The cores that this process may run on.
fn cores() -> Result<Vec<usize>> {
    let status = fs::read_to_string("/proc/self/status").context("cannot read /proc/self/status")?;
    let list = status.lines().find_map(|line| line.strip_prefix("Cpus_allowed_list:"));
    listed(list.unwrap_or_default().trim()).context("/proc/self/status has no list of cores")
}

/// The numbers of a list such as `0-2,5`.
fn listed(list: &str) -> Option<Vec<usize>> {
    let mut all = Vec::new();
    for part in list.split(',') {
        let (first, last) = part.split_once('-').unwrap_or((part, part));
        all.extend(first.parse::<usize>().ok()?..=last.parse().ok()?);
    }
    Some(all)
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_default()
}

/// The logs of shards, one after the other.
fn log(folder: &Path) -> String {
    (0..SHARDS).map(|shard| read(&folder.join(format!("shard-{shard}.log")))).collect::<Vec<_>>().join(" | ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_of_cores_are_read() {
        assert_eq!(listed("0-2,5"), Some(vec![0, 1, 2, 5]));
        assert_eq!((listed("3"), listed(""), listed("a-1")), (Some(vec![3]), None, None));
        assert!(!cores().unwrap().is_empty());
    }

    #[test]
    fn options_are_read_and_wrong_ones_are_named() {
        let of = |words: &[&str]| options(&words.iter().map(OsString::from).collect::<Vec<_>>());
        let read = of(&["--samples", "5", "--lane", "embedded"]).unwrap();
        assert_eq!((read.samples, read.lane.as_str(), read.suite.as_str()), (5, "embedded", "sphere"));
        let error = |words: &[&str]| of(words).err().unwrap().to_string();
        assert_eq!(error(&["--samples", "0"]), "`0` is no number of samples");
        assert_eq!(error(&["--samples"]), "`--samples` needs a value");
        assert!(error(&["--sample", "1"]).starts_with("slurm-demo has no option `--sample`"));
    }
}
