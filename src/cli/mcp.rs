//! `shadercheck mcp`: the commands as tools of the Model Context Protocol, over standard input and output.
//!
//! One message a line, JSON-RPC 2.0 (<https://modelcontextprotocol.io/specification/2025-06-18/basic/transports>). Each call is
//! a run of this program in a process of its own, with `--format json`: what an agent gets is what a script gets, a call
//! that is cancelled or takes too long is ended, and several go on at a time.

mod call;
mod tools;

use std::collections::HashMap;
use std::io::{BufRead, Write};
use std::sync::mpsc::{Receiver, Sender, channel};

use clap::Args;
use lsp_server::ErrorCode;
use serde_json::{Value, json};

use super::status::ExitStatus;
use call::Running;

/// Serve agents: the commands as tools of the Model Context Protocol, over standard input and output
///
/// The agent's program starts this command, in the folder of the shaders. docs/book/src/agents.md has configurations.
#[derive(Args, Clone, Debug, Default)]
pub struct McpArgs {
    /// Most seconds that a call may take that asks for no other limit
    #[arg(long, value_name = "SECONDS", default_value_t = 300, value_parser = clap::value_parser!(u64).range(1..))]
    pub limit: u64,
}

/// Versions of the protocol that this server speaks, the newest first.
const VERSIONS: [&str; 3] = ["2025-06-18", "2025-03-26", "2024-11-05"];

/// What the main thread waits for.
enum Event {
    /// A line came from the client.
    Line(String),
    /// The client is gone.
    End,
    /// A call came to its end: the key of its request, and the result.
    Done(String, Value),
}

/// Runs the command until the client is gone. Calls that go on then are ended.
///
/// # Errors
/// When `out` cannot be written to.
pub fn run(args: &McpArgs, out: &mut dyn Write) -> anyhow::Result<ExitStatus> {
    let (events, incoming) = channel();
    let reader = events.clone();
    std::thread::spawn(move || read_all(&reader));
    Server { limit: args.limit, events, running: HashMap::new() }.run(&incoming, out)?;
    Ok(ExitStatus::Clean)
}

fn read_all(events: &Sender<Event>) {
    for line in std::io::stdin().lock().lines() {
        // A line that is no UTF-8 is no JSON either.
        let line = line.unwrap_or_else(|_| "\u{fffd}".to_owned());
        if events.send(Event::Line(line)).is_err() {
            return;
        }
    }
    // Nobody waits for it where the main thread is gone.
    drop(events.send(Event::End));
}

struct Server {
    limit: u64,
    events: Sender<Event>,
    /// Calls that go on, by the key of their requests.
    running: HashMap<String, (Value, Running)>,
}

impl Server {
    fn run(mut self, incoming: &Receiver<Event>, out: &mut dyn Write) -> std::io::Result<()> {
        while let Ok(event) = incoming.recv() {
            let answer = match event {
                Event::End => break,
                Event::Done(key, result) => {
                    // One that was cancelled gets no answer.
                    self.running.remove(&key).map(|(id, _)| json!({ "jsonrpc": "2.0", "id": id, "result": result }))
                }
                Event::Line(line) if line.trim().is_empty() => None,
                Event::Line(line) => self.message(&line),
            };
            if let Some(answer) = answer {
                writeln!(out, "{answer}")?;
                out.flush()?;
            }
        }
        Ok(())
    }

    /// The answer to a message; none for a notification, and none yet for a call.
    fn message(&mut self, line: &str) -> Option<Value> {
        let message: Value = match serde_json::from_str(line) {
            Ok(message) => message,
            Err(error) => return Some(refused(&Value::Null, ErrorCode::ParseError, &format!("no JSON: {error}"))),
        };
        let id = message.get("id").filter(|id| id.is_string() || id.is_number()).cloned();
        let Some(method) = message.get("method").and_then(Value::as_str) else {
            // An answer to what nobody asked.
            let is_answer = message.get("result").is_some() || message.get("error").is_some();
            let id = id.unwrap_or_default();
            return (!is_answer).then(|| refused(&id, ErrorCode::InvalidRequest, "a message needs a `method`"));
        };
        let params = message.get("params").cloned().unwrap_or_default();
        let Some(id) = id else {
            if method == "notifications/cancelled"
                && let Some(id) = params.get("requestId")
            {
                self.running.remove(&id.to_string());
            }
            return None;
        };
        let result = match method {
            "initialize" => initialized(&params),
            "ping" => json!({}),
            "tools/list" => json!({ "tools": tools::listed() }),
            "tools/call" => match self.call(&id, &params) {
                Ok(()) => return None,
                Err(why) => return Some(refused(&id, ErrorCode::InvalidParams, &why)),
            },
            _ => return Some(refused(&id, ErrorCode::MethodNotFound, &format!("there is no method `{method}`"))),
        };
        Some(json!({ "jsonrpc": "2.0", "id": id, "result": result }))
    }

    /// Starts a call. Its result comes as an event.
    fn call(&mut self, id: &Value, params: &Value) -> Result<(), String> {
        let key = id.to_string();
        if self.running.contains_key(&key) {
            return Err(format!("a call with the id {key} goes on"));
        }
        let asked = tools::asked(params, self.limit)?;
        let (events, done) = (self.events.clone(), key.clone());
        let running = Running::start(asked, move |result| drop(events.send(Event::Done(done, result))));
        self.running.insert(key, (id.clone(), running));
        Ok(())
    }
}

fn initialized(params: &Value) -> Value {
    let wanted = params.get("protocolVersion").and_then(Value::as_str);
    let version = VERSIONS.into_iter().find(|own| Some(*own) == wanted).unwrap_or(VERSIONS[0]);
    json!({
        "protocolVersion": version,
        "capabilities": { "tools": {} },
        "serverInfo": { "name": "shadercheck", "title": "shadercheck", "version": env!("CARGO_PKG_VERSION") },
        "instructions": "Tests shaders (GLSL, WGSL, SPIR-V, HLSL) without a GPU. `lint` finds mistakes in shaders and in the \
            code that feeds them; `fuzz` runs every function and kernel on generated inputs and finds races, stray indices, \
            NaN and lost digits. Findings have a file, a line and a column.",
    })
}

fn refused(id: &Value, code: ErrorCode, message: &str) -> Value {
    json!({ "jsonrpc": "2.0", "id": id, "error": { "code": code as i32, "message": message } })
}
