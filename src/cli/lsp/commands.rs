//! Code lenses, and the commands behind them: each runs this program once more, as a process of its own that can be
//! stopped, on the files as they are saved.

use std::io::Read as _;
use std::process::{Child, Command, Stdio};
use std::sync::{Arc, Mutex, PoisonError};

use lsp_server::{ErrorCode, RequestId, Response, ResponseError};
use serde_json::{Value, json};

use super::requests::{Context, error, path_of};

/// Bytes of a command's output that are handed on.
const MOST_OUTPUT: u64 = 4 << 20;

/// The commands, with what they are called to people.
pub(super) const COMMANDS: [&str; 5] =
    ["shadercheck.explain", "shadercheck.fuzz", "shadercheck.check", "shadercheck.compare", "shadercheck.translate"];

/// A command that runs.
pub(super) struct Running {
    pub request: RequestId,
    child: Arc<Mutex<Child>>,
}

impl Running {
    /// Ends the process.
    pub fn stop(&self) {
        // It may have come to its end by itself; the one who waits for it holds the lock then.
        if let Ok(mut child) = self.child.try_lock() {
            drop(child.kill());
        }
    }
}

/// A command that came to its end.
pub(super) struct Finished {
    pub token: String,
    pub response: Response,
}

/// What is asked for: the arguments of this program, and a text for its standard input if any.
pub(super) fn arguments(command: &str, given: &[Value]) -> Result<Vec<String>, ResponseError> {
    let invalid = |why: &str| error(ErrorCode::InvalidParams, format!("`{command}`: {why}"));
    let text = |index: usize| given.get(index).and_then(Value::as_str);
    if command == "shadercheck.explain" {
        let rule = text(0).ok_or_else(|| invalid("give the code of a rule"))?;
        return Ok(vec!["explain".to_owned(), "--".to_owned(), rule.to_owned()]);
    }
    if !COMMANDS.contains(&command) {
        return Err(error(ErrorCode::InvalidParams, format!("no command is called `{command}`")));
    }
    if cfg!(not(feature = "run")) {
        return Err(error(ErrorCode::RequestFailed, "this program was built without the feature `run`".to_owned()));
    }
    let path = |index: usize| {
        let uri = text(index).and_then(|t| t.parse().ok()).ok_or_else(|| invalid("give the address of a file"))?;
        path_of(&uri).ok_or_else(|| invalid("it is no file"))
    };
    let file = path(0)?;
    let mut all: Vec<String> = match command {
        "shadercheck.fuzz" => vec!["fuzz".to_owned()],
        "shadercheck.check" => vec!["check".to_owned()],
        "shadercheck.compare" => vec!["compare".to_owned()],
        _ => {
            let to = text(1).ok_or_else(|| invalid("give a language"))?;
            vec!["translate".to_owned(), format!("--to={to}")]
        }
    };
    if let Some(function) = text(1).filter(|_| command == "shadercheck.fuzz" || command == "shadercheck.compare") {
        all.push(format!("--function={function}"));
    }
    all.push("--".to_owned());
    all.push(file.clone());
    if command == "shadercheck.compare" {
        let at = all.len() - 1;
        all.insert(at, format!("HEAD:{file}"));
    }
    Ok(all)
}

/// Starts a command; `done` is called with what came of it.
pub(super) fn start(
    request: RequestId,
    arguments: &[String],
    token: String,
    done: impl FnOnce(Finished) + Send + 'static,
) -> Result<Running, ResponseError> {
    let failed = |why: std::io::Error| error(ErrorCode::RequestFailed, why.to_string());
    let program = std::env::current_exe().map_err(failed)?;
    let mut child = Command::new(program)
        .args(arguments)
        .env("NO_COLOR", "1")
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(failed)?;
    let (out, err) = (child.stdout.take(), child.stderr.take());
    let child = Arc::new(Mutex::new(child));
    let running = Running { request: request.clone(), child: child.clone() };
    std::thread::spawn(move || {
        let complaints = std::thread::spawn(move || text_of(err));
        let output = text_of(out);
        let complaints = complaints.join().unwrap_or_default();
        let status = child.lock().unwrap_or_else(PoisonError::into_inner).wait();
        let response_result = match status {
            Ok(status) if status.code().is_some() => {
                Ok(json!({ "status": status.code(), "output": output, "messages": complaints }))
            }
            Ok(_) => Err(error(ErrorCode::RequestCanceled, "the command was stopped".to_owned())),
            Err(why) => Err(error(ErrorCode::RequestFailed, why.to_string())),
        };
        done(Finished { token, response: Response { id: request, response_result } });
    });
    Ok(running)
}

fn text_of(from: Option<impl std::io::Read>) -> String {
    let mut bytes = Vec::new();
    if let Some(mut from) = from {
        // What was read so far is told.
        drop(from.by_ref().take(MOST_OUTPUT).read_to_end(&mut bytes));
        drop(std::io::copy(&mut from, &mut std::io::sink()));
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

/// The lenses of a document.
pub(super) fn lenses(name: &str, context: &Context) -> Value {
    if cfg!(not(feature = "run")) {
        return json!([]);
    }
    let Some(uri) = context.uri(name) else { return json!([]) };
    let lens = |range: &Value, title: String, command: &str, arguments: Value| json!({ "range": range, "command": { "title": title, "command": command, "arguments": arguments } });
    let mut all = Vec::new();
    let symbols = context.workspace.document_symbols(name);
    let functions =
        symbols.as_array().into_iter().flatten().filter(|s| s["kind"] == json!(ls_types::SymbolKind::FUNCTION));
    for (index, function) in functions.enumerate() {
        let (range, called) = (&function["selectionRange"], function["name"].as_str().unwrap_or(""));
        if called == "main" {
            for to in ["wgsl", "hlsl", "msl"] {
                all.push(lens(range, format!("Show as {to}"), "shadercheck.translate", json!([uri, to])));
            }
        } else if index < 200 {
            all.push(lens(range, format!("Fuzz {called}"), "shadercheck.fuzz", json!([uri, called])));
            all.push(lens(range, "Compare with HEAD".to_owned(), "shadercheck.compare", json!([uri, called])));
        }
    }
    if name.ends_with(".suite.toml") {
        let range = json!({ "start": { "line": 0, "character": 0 }, "end": { "line": 0, "character": 0 } });
        all.push(lens(&range, "Check this suite".to_owned(), "shadercheck.check", json!([uri])));
    }
    all.into()
}
