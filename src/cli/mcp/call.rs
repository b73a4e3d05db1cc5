//! A call of a tool: a run of this program in a process of its own.

use std::io::Read;
use std::process::{Child, ExitStatus};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use anyhow::Context as _;
use base::text::counted;
use serde_json::{Value, json};
use tempfile::TempDir;

use super::super::process;
use super::tools::Asked;

/// Most bytes of a report: whoever asked reads all of it.
const MOST: u64 = 1 << 20;

/// Time between two looks at whether a run came to its end.
const PAUSE: Duration = Duration::from_millis(20);

/// A call that goes on. It is ended when this is dropped.
pub struct Running {
    end: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Drop for Running {
    fn drop(&mut self) {
        drop(self.end.take());
        // Its process is gone then. Who panics has told so.
        if let Some(thread) = self.thread.take() {
            drop(thread.join());
        }
    }
}

impl Running {
    /// Starts a call; `done` gets its result, unless it is ended before.
    pub fn start(asked: Asked, done: impl FnOnce(Value) + Send + 'static) -> Self {
        let (end, ended) = channel();
        let thread = std::thread::spawn(move || match run(&asked, &ended) {
            Ok(None) => {}
            Ok(Some(result)) => done(result),
            Err(error) => done(result(vec![format!("{error:#}")], true)),
        });
        Self { end: Some(end), thread: Some(thread) }
    }
}

/// Runs the command to its end. None where it was ended before.
fn run(asked: &Asked, ended: &Receiver<()>) -> anyhow::Result<Option<Value>> {
    let folder = asked.file.as_ref().map(|(name, text)| written(name, text)).transpose()?;
    let folder = folder.as_ref().map(TempDir::path);
    let mut child = process::start(&asked.arguments, folder).context("the run does not start")?;
    let (out, err) = (listen(child.stdout.take()), listen(child.stderr.take()));
    let status = match wait(&mut child, asked.limit, ended)? {
        Waited::Whole(status) => status,
        Waited::Late => {
            let why = format!(
                "ended after {}: ask for less of it at once, or state a larger `limit`",
                counted(asked.limit, "second")
            );
            return Ok(Some(result(vec![why], true)));
        }
        Waited::Ended => return Ok(None),
    };
    let (out, err) = (heard(out), heard(err));
    // What is wrong with the call itself is told on standard error.
    let failed = !matches!(status.code(), Some(0 | 1));
    if out.len() as u64 > MOST {
        let why = format!("the report has more than {MOST} bytes: name fewer paths");
        return Ok(Some(result(vec![why], true)));
    }
    let said = if status.code().is_some() { String::new() } else { format!("the run was ended: {status}") };
    let texts = if failed { vec![err, said, out] } else { vec![out, err] };
    Ok(Some(result(texts, failed)))
}

/// The text in a file of a folder of its own.
fn written(name: &str, text: &str) -> anyhow::Result<TempDir> {
    let folder = tempfile::tempdir().context("no folder for the text")?;
    disk::fresh::write(&folder.path().join(name), text.as_bytes())
        .with_context(|| format!("{name} cannot be written"))?;
    Ok(folder)
}

enum Waited {
    Whole(ExitStatus),
    Late,
    Ended,
}

fn wait(child: &mut Child, limit: u64, ended: &Receiver<()>) -> anyhow::Result<Waited> {
    let start = Instant::now();
    loop {
        if let Some(status) = child.try_wait().context("the run cannot be waited for")? {
            return Ok(Waited::Whole(status));
        }
        let late = start.elapsed() > Duration::from_secs(limit);
        if late || ended.recv_timeout(PAUSE) != Err(RecvTimeoutError::Timeout) {
            child.kill().and_then(|()| child.wait()).context("the run cannot be ended")?;
            return Ok(if late { Waited::Late } else { Waited::Ended });
        }
    }
}

/// Reads a stream to its end, beside the other.
fn listen(stream: Option<impl Read + Send + 'static>) -> JoinHandle<Vec<u8>> {
    std::thread::spawn(move || process::bytes_of(stream, MOST + 1))
}

fn heard(stream: JoinHandle<Vec<u8>>) -> String {
    String::from_utf8_lossy(&stream.join().unwrap_or_default()).into_owned()
}

/// The result of a call, as texts of which none is empty.
fn result(texts: Vec<String>, failed: bool) -> Value {
    let texts = texts.into_iter().filter(|text| !text.trim().is_empty());
    let content: Vec<Value> = texts.map(|text| json!({ "type": "text", "text": text })).collect();
    json!({ "content": content, "isError": failed })
}
