//! A client that says what a test wants, and no more.

use std::collections::HashMap;
use std::io::{BufRead, BufReader, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Child, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use crate::binary::command;

/// How long an answer may take on a machine that is busy.
const PATIENCE: Duration = Duration::from_secs(60);

/// A server with its workspace.
pub struct Client {
    pub child: Child,
    pub root: PathBuf,
    messages: Receiver<Value>,
    number: i64,
    /// What is shown for each file, by its address.
    pub shown: HashMap<String, Vec<Value>>,
    /// What `initialize` gave.
    pub server: Value,
}

impl Client {
    /// Starts a server on a folder.
    pub fn new(root: &Path) -> Self {
        Self::with(root, &json!({}), &["utf-16"])
    }

    /// The same with options, and with encodings that the client knows.
    pub fn with(root: &Path, options: &Value, encodings: &[&str]) -> Self {
        let mut child =
            command(root, "lsp").stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
        let mut output = BufReader::new(child.stdout.take().unwrap());
        let (sender, messages) = channel();
        std::thread::spawn(move || {
            while let Some(message) = read(&mut output) {
                if sender.send(message).is_err() {
                    return;
                }
            }
        });
        let mut client =
            Self { child, root: root.to_owned(), messages, number: 0, shown: HashMap::new(), server: Value::Null };
        let capabilities = json!({ "general": { "positionEncodings": encodings }, "window": { "workDoneProgress": true, "showDocument": { "support": true } } });
        let params = json!({ "processId": null, "rootUri": uri(root), "capabilities": capabilities, "initializationOptions": options });
        client.server = client.ask("initialize", params).unwrap();
        client.notify("initialized", json!({}));
        client
    }

    /// The address of a file.
    pub fn uri(&self, name: &str) -> String {
        uri(&self.root.join(name))
    }

    /// Writes bytes as they are.
    pub fn raw(&mut self, bytes: &[u8]) {
        let input = self.child.stdin.as_mut().unwrap();
        input.write_all(bytes).unwrap();
        input.flush().unwrap();
    }

    fn send(&mut self, mut message: Value) {
        message["jsonrpc"] = "2.0".into();
        let text = message.to_string();
        self.raw(format!("Content-Length: {}\r\n\r\n{text}", text.len()).as_bytes());
    }

    pub fn notify(&mut self, method: &str, params: Value) {
        self.send(json!({ "method": method, "params": params }));
    }

    /// Sends a request; gives its number.
    pub fn begin(&mut self, method: &str, params: Value) -> i64 {
        self.number += 1;
        self.send(json!({ "id": self.number, "method": method, "params": params }));
        self.number
    }

    /// The answer to a request, or the words of its error.
    pub fn answer(&mut self, id: i64) -> Result<Value, String> {
        let message = self.until(|m| m["id"] == json!(id) && m.get("method").is_none());
        match message.get("error") {
            None => Ok(message["result"].clone()),
            Some(error) => Err(error["message"].as_str().unwrap().to_owned()),
        }
    }

    pub fn ask(&mut self, method: &str, params: Value) -> Result<Value, String> {
        let id = self.begin(method, params);
        self.answer(id)
    }

    /// Takes messages until one is wanted.
    #[track_caller]
    pub fn until(&mut self, wanted: impl Fn(&Value) -> bool) -> Value {
        let end = Instant::now() + PATIENCE;
        loop {
            let left = end.saturating_duration_since(Instant::now());
            let message = self.messages.recv_timeout(left).expect("the server answers");
            if message["method"] == "textDocument/publishDiagnostics" {
                let uri = message["params"]["uri"].as_str().unwrap().to_owned();
                self.shown.insert(uri, message["params"]["diagnostics"].as_array().unwrap().clone());
            }
            if wanted(&message) {
                return message;
            }
        }
    }

    /// Waits until a file has findings with these codes, in the order of the text.
    #[track_caller]
    pub fn until_found(&mut self, name: &str, codes: &[&str]) {
        let uri = self.uri(name);
        let now = |shown: Option<&Vec<Value>>| -> Vec<String> {
            shown.into_iter().flatten().map(|d| d["code"].as_str().unwrap().to_owned()).collect()
        };
        while now(self.shown.get(&uri)) != codes {
            self.until(|m| m["method"] == "textDocument/publishDiagnostics");
        }
    }

    /// Opens a file with the text that it has on the disk.
    pub fn open(&mut self, name: &str) {
        let text = String::from_utf8_lossy(&std::fs::read(self.root.join(name)).unwrap()).into_owned();
        self.open_as(name, &text);
    }

    pub fn open_as(&mut self, name: &str, text: &str) {
        let document = json!({ "uri": self.uri(name), "languageId": "glsl", "version": 1, "text": text });
        self.notify("textDocument/didOpen", json!({ "textDocument": document }));
    }

    /// Replaces a range, given by two places of line and column.
    pub fn change(&mut self, name: &str, version: i64, range: [u32; 4], text: &str) {
        let [a, b, c, d] = range;
        let range = json!({ "start": { "line": a, "character": b }, "end": { "line": c, "character": d } });
        let document = json!({ "uri": self.uri(name), "version": version });
        let changes = json!([{ "range": range, "text": text }]);
        self.notify("textDocument/didChange", json!({ "textDocument": document, "contentChanges": changes }));
    }

    /// Parameters of a request about a place.
    pub fn at(&self, name: &str, line: u32, character: u32) -> Value {
        json!({ "textDocument": { "uri": self.uri(name) }, "position": { "line": line, "character": character } })
    }

    pub fn rename(&mut self, name: &str, place: [u32; 2], new: &str) -> Result<Value, String> {
        let mut params = self.at(name, place[0], place[1]);
        params["newName"] = new.into();
        self.ask("textDocument/rename", params)
    }

    /// Ends the server as the protocol wants; gives its exit status.
    pub fn end(mut self) -> Option<i32> {
        self.ask("shutdown", Value::Null).unwrap();
        self.notify("exit", Value::Null);
        self.wait()
    }

    /// Waits for the end of the process.
    pub fn wait(&mut self) -> Option<i32> {
        let end = Instant::now() + PATIENCE;
        while Instant::now() < end {
            if let Some(status) = self.child.try_wait().unwrap() {
                return status.code();
            }
            std::thread::sleep(Duration::from_millis(20));
        }
        self.child.kill().unwrap();
        panic!("the server does not end");
    }
}

impl Drop for Client {
    fn drop(&mut self) {
        drop(self.child.kill());
        drop(self.child.wait());
    }
}

/// The address of a path without characters that would be escaped.
pub fn uri(path: &Path) -> String {
    format!("file://{}", path.to_str().unwrap())
}

fn read(from: &mut impl BufRead) -> Option<Value> {
    let mut length = 0;
    loop {
        let mut line = String::new();
        if from.read_line(&mut line).ok()? == 0 {
            return None;
        }
        match line.trim().strip_prefix("Content-Length: ") {
            Some(number) => length = number.parse().ok()?,
            None if line.trim().is_empty() => break,
            None => {}
        }
    }
    let mut bytes = vec![0; length];
    from.read_exact(&mut bytes).ok()?;
    serde_json::from_slice(&bytes).ok()
}
