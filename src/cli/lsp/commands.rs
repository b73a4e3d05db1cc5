//! Code lenses, and the commands behind them: each runs this program once more, as a process of its own that can be
//! stopped, on the files as they are saved.

use std::process::Child;
use std::sync::{Arc, Mutex, PoisonError};

use lsp_server::{ErrorCode, RequestId, Response, ResponseError};
use serde_json::{Value, json};

use super::super::process;
use super::requests::{Context, error, path_of};
use super::results::{Results, read};

/// Bytes of a command's output that are handed on.
const MOST_OUTPUT: u64 = 4 << 20;

/// The commands, with what they are called to people.
pub(super) const COMMANDS: [&str; 6] = [
    "shadercheck.explain",
    "shadercheck.fuzz",
    "shadercheck.check",
    "shadercheck.compare",
    "shadercheck.improve",
    "shadercheck.translate",
];

/// Languages that a shader is shown in.
const LANGUAGES: [(&str, &str); 4] = [("spirv", "SPIR-V"), ("wgsl", "WGSL"), ("hlsl", "HLSL"), ("msl", "MSL")];

/// A command that runs.
pub(super) struct Running {
    pub request: RequestId,
    /// The change after which it began.
    pub revision: u64,
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
    /// What the view is called.
    pub title: String,
    /// What it found; none of one that was stopped.
    pub results: Option<Results>,
}

/// What is asked for.
#[derive(Clone, Debug)]
pub(super) struct Asked {
    pub command: String,
    /// What a view of it is called.
    pub title: String,
    /// The language of a translation.
    to: Option<String>,
    /// The arguments of this program.
    arguments: Vec<String>,
}

/// Reads what is asked for.
pub(super) fn asked(command: &str, given: &[Value]) -> Result<Asked, ResponseError> {
    let text = |index: usize| given.get(index).and_then(Value::as_str);
    let name = text(0).and_then(|uri| uri.rsplit('/').next()).unwrap_or("");
    let verb = command.rsplit('.').next().unwrap_or("");
    let to = text(1).filter(|_| command == "shadercheck.translate").map(str::to_owned);
    let title = match text(1) {
        Some(function) if to.is_none() => format!("{verb} {function}"),
        _ => format!("{verb} {name}"),
    };
    Ok(Asked { arguments: arguments(command, given)?, command: command.to_owned(), title, to })
}

fn arguments(command: &str, given: &[Value]) -> Result<Vec<String>, ResponseError> {
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
        "shadercheck.translate" => {
            let to = text(1).ok_or_else(|| invalid("give a language"))?;
            let entry = text(2).map(|entry| format!("--entry={entry}"));
            ["translate".to_owned(), format!("--to={to}")].into_iter().chain(entry).collect()
        }
        _ => vec![command.trim_start_matches("shadercheck.").to_owned(), "--format=json".to_owned()],
    };
    if let Some(function) = text(1).filter(|_| !["shadercheck.translate", "shadercheck.check"].contains(&command)) {
        all.push(format!("--function={function}"));
    }
    all.push("--".to_owned());
    // Of one line: every expression, however little it loses.
    match given.get(2).and_then(Value::as_u64).filter(|_| command == "shadercheck.improve") {
        Some(line) => all.push(format!("{file}:{line}")),
        None => all.push(file.clone()),
    }
    if command == "shadercheck.compare" {
        let at = all.len() - 1;
        all.insert(at, format!("HEAD:{file}"));
    }
    Ok(all)
}

/// Starts a command; `done` is called with what came of it.
pub(super) fn start(
    (request, revision): (RequestId, u64),
    asked: Asked,
    token: String,
    done: impl FnOnce(Finished) + Send + 'static,
) -> Result<Running, ResponseError> {
    let failed = |why: std::io::Error| error(ErrorCode::RequestFailed, why.to_string());
    let mut child = process::start(&asked.arguments, None).map_err(failed)?;
    let (out, err) = (child.stdout.take(), child.stderr.take());
    let child = Arc::new(Mutex::new(child));
    let running = Running { request: request.clone(), revision, child: child.clone() };
    std::thread::spawn(move || {
        let complaints =
            std::thread::spawn(move || String::from_utf8_lossy(&process::bytes_of(err, MOST_OUTPUT)).into_owned());
        let output = process::bytes_of(out, MOST_OUTPUT);
        let output = if asked.to.as_deref() == Some("spirv") {
            listed(&output)
        } else {
            String::from_utf8_lossy(&output).into_owned()
        };
        let complaints = complaints.join().unwrap_or_default();
        let status = child.lock().unwrap_or_else(PoisonError::into_inner).wait();
        let mut results = None;
        let response_result = match status {
            Ok(status) if status.code().is_some() => {
                let mut found = read(&asked.command, asked.to.as_deref(), &output);
                if found.text.is_empty() {
                    (found.text, found.ending) = (complaints.clone(), "md");
                }
                let text = found.text.clone();
                results = Some(found);
                Ok(json!({ "status": status.code(), "output": text, "messages": complaints }))
            }
            Ok(_) => Err(error(ErrorCode::RequestCanceled, "the command was stopped".to_owned())),
            Err(why) => Err(error(ErrorCode::RequestFailed, why.to_string())),
        };
        let response = Response { id: request, response_result };
        done(Finished { token, response, title: asked.title, results });
    });
    Ok(running)
}

/// The instructions of a module.
#[cfg(feature = "run")]
fn listed(module: &[u8]) -> String {
    program::listing("module", module).map_or_else(|why| why, |file| file.text().to_owned())
}

/// The linter alone translates nothing.
#[cfg(not(feature = "run"))]
fn listed(_: &[u8]) -> String {
    String::new()
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
            for (to, called) in LANGUAGES {
                all.push(lens(range, format!("Show as {called}"), "shadercheck.translate", json!([uri, to])));
            }
        } else if index < 200 {
            all.push(lens(range, format!("Fuzz {called}"), "shadercheck.fuzz", json!([uri, called])));
            all.push(lens(range, "Compare with HEAD".to_owned(), "shadercheck.compare", json!([uri, called])));
            all.push(lens(range, "Improve".to_owned(), "shadercheck.improve", json!([uri, called])));
        }
    }
    if name.ends_with(".suite.toml") {
        let range = json!({ "start": { "line": 0, "character": 0 }, "end": { "line": 0, "character": 0 } });
        all.push(lens(&range, "Check this suite".to_owned(), "shadercheck.check", json!([uri])));
    }
    all.into()
}
