//! A throw-away Slurm cluster of two nodes on this machine: its own key, its own ports, everything in one folder.

use std::ffi::OsString;
use std::fs::{self, File, OpenOptions};
use std::io::Read;
use std::net::TcpListener;
use std::os::unix::fs::OpenOptionsExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail};

/// Programs of the packages `util-linux`, `slurm-wlm` and `munge`.
pub const PROGRAMS: [&str; 9] =
    ["taskset", "munged", "slurmctld", "slurmd", "sbatch", "squeue", "scontrol", "scancel", "sinfo"];
/// How they are installed.
pub const ADVICE: &str = "apt-get install -y --no-install-recommends slurm-wlm munge util-linux";

/// How long a daemon may take to come up, or to end.
const PATIENCE: Duration = Duration::from_secs(60);

/// Waits for the end of a process, and then ends others: by their identifiers.
const WATCH: &str = r#"
me=$1 folder=$2
shift 2
while kill -0 "$me"; do sleep 1; done
kill "$@"
sleep 5
kill -9 "$@"
rm -rf "$folder"
"#;

/// A cluster that runs; it ends with this value, its jobs first.
pub struct Cluster {
    folder: PathBuf,
    daemons: Vec<(String, Child)>,
    watch: Option<Child>,
}

/// A program of a package, also where `PATH` leaves the administrator's folders out.
fn program(name: &str) -> Option<PathBuf> {
    let path = std::env::var_os("PATH").unwrap_or_default();
    let more = ["/usr/sbin", "/sbin", "/usr/local/sbin"].map(PathBuf::from);
    std::env::split_paths(&path).chain(more).map(|folder| folder.join(name)).find(|file| file.is_file())
}

/// Programs that are not there.
pub fn missing() -> Vec<&'static str> {
    PROGRAMS.into_iter().filter(|name| program(name).is_none()).collect()
}

fn command(name: &str) -> Result<Command> {
    Ok(Command::new(program(name).with_context(|| format!("`{name}` is not installed"))?))
}

/// The output of a command that has to succeed.
fn output(command: &mut Command) -> Result<String> {
    let name = command.get_program().display().to_string();
    let output = command.stdin(Stdio::null()).output().with_context(|| format!("cannot start `{name}`"))?;
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).trim().to_owned();
    if !output.status.success() {
        bail!("`{name}` failed: {} {}", text(&output.stdout), text(&output.stderr));
    }
    Ok(text(&output.stdout))
}

/// Waits until something is so.
pub fn wait(what: &str, patience: Duration, mut holds: impl FnMut() -> Result<bool>) -> Result<()> {
    let begin = Instant::now();
    while !holds()? {
        if begin.elapsed() > patience {
            bail!("after {} s: {what}", patience.as_secs());
        }
        sleep(Duration::from_millis(100));
    }
    Ok(())
}

/// Ports that nobody listens on. All are held until all are known, so that they differ.
fn ports<const N: usize>() -> Result<[u16; N]> {
    let mut held = Vec::new();
    let mut ports = [0; N];
    for port in &mut ports {
        let listener = TcpListener::bind(("127.0.0.1", 0)).context("no port is free")?;
        *port = listener.local_addr()?.port();
        held.push(listener);
    }
    Ok(ports)
}

/// The configuration. One task runs on a node at a time.
fn configuration(folder: &Path, user: &str, host: &str, [control, first, second]: [u16; 3]) -> String {
    let folder = folder.display();
    format!(
        "ClusterName=shadercheck
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={control}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
# A job that is requeued waits for as long as its credential was good.
AuthInfo=socket={folder}/munge.socket,cred_expire=5
CryptoType=crypto/munge
MpiDefault=none
ProctrackType=proctrack/pgid
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
JobCompType=jobcomp/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=sched_interval=1,batch_sched_delay=0
ReturnToService=2
KillWait=5
MinJobAge=3600
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool.%n
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.%n.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.%n.log
NodeName=n0 NodeHostname={host} NodeAddr=127.0.0.1 Port={first} CPUs=1 State=UNKNOWN
NodeName=n1 NodeHostname={host} NodeAddr=127.0.0.1 Port={second} CPUs=1 State=UNKNOWN
PartitionName=all Nodes=n0,n1 Default=YES MaxTime=INFINITE State=UP
"
    )
}

impl Cluster {
    /// Starts the daemons in a folder of their own in `around`, and waits until both nodes are idle. When this
    /// process is killed, `around` is removed.
    pub fn start(around: &Path) -> Result<Self> {
        let folder = &around.join("slurm");
        fs::create_dir(folder)?;
        let mut cluster = Self { folder: folder.to_owned(), daemons: Vec::new(), watch: None };
        for name in ["state", "spool.n0", "spool.n1"] {
            fs::create_dir(folder.join(name))?;
        }
        let mut key = [0; 1024];
        File::open("/dev/urandom")?.read_exact(&mut key)?;
        let at = folder.join("munge.key");
        let mut file = OpenOptions::new().write(true).create_new(true).mode(0o600).open(&at)?;
        std::io::Write::write_all(&mut file, &key)?;
        drop(file);
        let user = output(Command::new("id").arg("-un"))?;
        let host = output(Command::new("hostname").arg("-s"))?;
        fs::write(folder.join("slurm.conf"), configuration(folder, &user, &host, ports()?))?;

        let path = |name: &str, file: &str| {
            let mut option = OsString::from(format!("--{name}="));
            option.push(folder.join(file));
            option
        };
        let files = [
            ("key-file", "munge.key"),
            ("socket", "munge.socket"),
            ("pid-file", "munge.pid"),
            ("seed-file", "munge.seed"),
        ];
        let mut munged = command("munged")?;
        munged.args(["--foreground", "--force"]).args(files.map(|(name, file)| path(name, file)));
        munged.arg(path("log-file", "munge.log"));
        cluster.daemon("munged", munged)?;
        wait("munged made no socket", PATIENCE, || Ok(folder.join("munge.socket").exists()))?;
        let mut control = command("slurmctld")?;
        control.args(["-D", "-c"]);
        cluster.daemon("slurmctld", control)?;
        for node in ["n0", "n1"] {
            let mut slurmd = command("slurmd")?;
            slurmd.args(["-D", "-N", node]);
            cluster.daemon(&format!("slurmd.{node}"), slurmd)?;
        }
        cluster.watch = Some(cluster.watch(around)?);
        wait("the nodes are not idle; the logs are in the folder", PATIENCE, || {
            let idle = cluster.output("sinfo", &["-h", "-N", "-o", "%N %t"]).unwrap_or_default();
            Ok(idle.lines().filter(|line| line.ends_with(" idle")).count() == 2)
        })?;
        Ok(cluster)
    }

    fn daemon(&mut self, name: &str, mut command: Command) -> Result<()> {
        let log = || File::options().create(true).append(true).open(self.folder.join(format!("{name}.out")));
        command.env("SLURM_CONF", self.folder.join("slurm.conf"));
        let child = command.stdin(Stdio::null()).stdout(log()?).stderr(log()?).spawn();
        self.daemons.push((name.to_owned(), child.with_context(|| format!("cannot start {name}"))?));
        Ok(())
    }

    /// Ends the daemons, and removes a folder, when this process is killed and cannot do it.
    fn watch(&self, folder: &Path) -> Result<Child> {
        let pids = self.pids().into_iter().map(|pid| pid.to_string());
        let mut command = Command::new("sh");
        command.args(["-c", WATCH, "watch"]).arg(std::process::id().to_string()).arg(folder).args(pids);
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        command.spawn().context("cannot start sh")
    }

    /// Identifiers of the daemons.
    pub fn pids(&self) -> Vec<u32> {
        self.daemons.iter().map(|(_, child)| child.id()).collect()
    }

    /// Output of a program of Slurm.
    pub fn output(&self, name: &str, arguments: &[&str]) -> Result<String> {
        output(command(name)?.args(arguments).env("SLURM_CONF", self.folder.join("slurm.conf")))
    }

    /// Output of another program that talks to the cluster.
    pub fn output_of(&self, command: &mut Command) -> Result<String> {
        output(command.env("SLURM_CONF", self.folder.join("slurm.conf")))
    }

    /// How a job stands, such as `RUNNING` or `COMPLETED`; of an array, all of its tasks.
    pub fn states(&self, job: &str) -> Result<Vec<String>> {
        let text = self.output("scontrol", &["show", "job", job, "-o"])?;
        let state =
            |line: &str| line.split_whitespace().find_map(|word| word.strip_prefix("JobState=")).map(str::to_owned);
        Ok(text.lines().filter_map(state).collect())
    }
}

impl Drop for Cluster {
    fn drop(&mut self) {
        // Whatever fails here, the processes end below.
        let user = output(Command::new("id").arg("-un")).unwrap_or_default();
        let _ = self.output("scancel", &["--user", &user]);
        let quiet = || Ok(self.output("squeue", &["-h"]).unwrap_or_default().is_empty());
        let _ = wait("jobs go on", Duration::from_secs(20), quiet);
        let _ = self.output("scontrol", &["shutdown"]);
        for (name, child) in self.daemons.iter_mut().rev() {
            let limit = if name == "munged" { Duration::ZERO } else { Duration::from_secs(10) };
            let _ = wait("it goes on", limit, || Ok(child.try_wait()?.is_some()));
            let _ = child.kill();
            let _ = child.wait();
        }
        if let Some(watch) = &mut self.watch {
            let _ = watch.kill();
            let _ = watch.wait();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ports_differ_and_the_configuration_has_them() {
        let ports = ports::<3>().unwrap();
        assert!(ports[0] != ports[1] && ports[1] != ports[2] && ports[0] != ports[2]);
        let text = configuration(Path::new("/somewhere"), "me", "here", ports);
        for (key, port) in ["SlurmctldPort=", "Port=", "Port="].into_iter().zip(ports) {
            assert!(text.contains(&format!("{key}{port}")), "{text}");
        }
        assert!(text.contains("SlurmUser=me") && text.contains("NodeHostname=here"));
        assert!(!text.contains("/var/") && !text.contains("/etc/"), "nothing outside of the folder\n{text}");
    }

    #[test]
    fn waiting_ends() {
        let error = wait("no luck", Duration::ZERO, || Ok(false)).unwrap_err().to_string();
        assert_eq!(error, "after 0 s: no luck");
        wait("luck", Duration::ZERO, || Ok(true)).unwrap();
    }
}
