//! The server for agents: messages over standard input and output.

use std::fs;
use std::io::{BufRead as _, BufReader, Write as _};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Stdio};
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use crate::binary::command;

struct Client {
    child: Child,
    input: Option<ChildStdin>,
    output: BufReader<ChildStdout>,
}

impl Client {
    fn new(folder: &Path) -> Self {
        let mut child =
            command(folder, "mcp").stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
        let (input, output) = (child.stdin.take(), BufReader::new(child.stdout.take().unwrap()));
        Self { child, input, output }
    }

    fn send(&mut self, line: &str) {
        writeln!(self.input.as_mut().unwrap(), "{line}").unwrap();
    }

    fn read(&mut self) -> Value {
        let mut line = String::new();
        self.output.read_line(&mut line).unwrap();
        serde_json::from_str(&line).unwrap_or_else(|error| panic!("{error}: {line}"))
    }

    fn ask(&mut self, id: u32, method: &str, params: Value) -> Value {
        self.send(&json!({ "jsonrpc": "2.0", "id": id, "method": method, "params": params }).to_string());
        let answer = self.read();
        assert_eq!(answer["id"], id, "{answer}");
        answer
    }

    fn call(&mut self, id: u32, tool: &str, arguments: Value) -> Value {
        self.ask(id, "tools/call", json!({ "name": tool, "arguments": arguments }))["result"].clone()
    }

    /// The client goes away.
    fn leave(mut self) {
        drop(self.input.take());
        assert!(self.child.wait().unwrap().success());
    }
}

fn text(result: &Value) -> &str {
    result["content"][0]["text"].as_str().unwrap_or_else(|| panic!("{result}"))
}

#[test]
fn tools_are_listed_and_give_the_json_of_their_commands() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("bad.frag"), "#version 330\nout vec4 c;\nvoid main() { c = vec3(1, 1, 1, 1); }\n")
        .unwrap();
    let mut client = Client::new(folder.path());
    let params =
        json!({ "protocolVersion": "2025-03-26", "capabilities": {}, "clientInfo": { "name": "t", "version": "1" } });
    let server = client.ask(0, "initialize", params)["result"].clone();
    assert_eq!(server["protocolVersion"], "2025-03-26");
    client.send("{\"jsonrpc\":\"2.0\",\"method\":\"notifications/initialized\"}");
    let tools = client.ask(1, "tools/list", json!({}))["result"]["tools"].clone();
    let names: Vec<&str> = tools.as_array().unwrap().iter().map(|tool| tool["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["lint", "fuzz", "trace", "test", "check", "compare", "improve", "tune", "explain"]);
    // What is found is no error of the call.
    let found = client.call(2, "lint", json!({ "paths": ["."] }));
    assert_eq!(found["isError"], false);
    let findings: Value = serde_json::from_str(text(&found)).unwrap();
    assert!(findings.to_string().contains("\"T001\"") && findings.to_string().contains("bad.frag"), "{findings}");
    // A text without a file, with a race and without.
    let kernel = |barrier: &str| {
        let text = format!(
            "var<workgroup> part: array<f32, 64>;\n@group(0) @binding(0) var<storage, read_write> o: array<f32>;\n\
             @compute @workgroup_size(64) fn main(@builtin(local_invocation_index) i: u32) {{\n\
             part[i] = f32(i);\n{barrier}\no[i] = part[63u - i];\n}}\n"
        );
        json!({ "text": text, "name": "a.wgsl" })
    };
    let ran = client.call(3, "fuzz", kernel(""));
    assert!(text(&ran).contains("\"race\"") && text(&ran).contains("a.wgsl:6:"), "{ran}");
    let ran = client.call(4, "fuzz", kernel("workgroupBarrier();"));
    assert!(!text(&ran).contains("\"race\"") && ran["isError"] == false, "{ran}");
    let page = client.call(5, "explain", json!({ "code": "T001" }));
    assert!(text(&page).contains("constructor"), "{page}");
    client.leave();
}

#[test]
fn what_is_wrong_is_told_and_the_server_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let mut client = Client::new(folder.path());
    client.send("{\"jsonrpc\":");
    assert_eq!(client.read()["error"]["code"], -32700);
    client.send("{\"jsonrpc\":\"2.0\",\"id\":1}");
    assert_eq!(client.read()["error"]["code"], -32600);
    assert_eq!(client.ask(2, "resources/list", json!({}))["error"]["code"], -32601);
    let refused = client.ask(3, "tools/call", json!({ "name": "lnt" }));
    assert_eq!(refused["error"]["code"], -32602);
    assert!(refused["error"]["message"].as_str().unwrap().contains("there is no tool `lnt`"), "{refused}");
    let failed = client.call(4, "lint", json!({ "paths": ["nowhere.frag"] }));
    assert!(failed["isError"] == true && text(&failed).contains("nowhere.frag"), "{failed}");
    assert_eq!(client.ask(5, "ping", json!({}))["result"], json!({}));
    client.leave();
}

#[test]
fn a_call_that_takes_too_long_is_ended_and_so_is_one_that_is_cancelled() {
    let folder = tempfile::tempdir().unwrap();
    // As many functions as keep it busy for longer than anybody waits.
    let functions: String =
        (0..400).map(|k| format!("float f{k}(float x) {{ return sin(x * {k}.0) / cos(x); }}\n")).collect();
    fs::write(folder.path().join("long.glsl"), functions).unwrap();
    let mut client = Client::new(folder.path());
    let start = Instant::now();
    let late = client.call(1, "fuzz", json!({ "paths": ["long.glsl"], "limit": 1 }));
    assert!(late["isError"] == true && text(&late).starts_with("ended after 1 second:"), "{late}");
    let call = json!({ "name": "fuzz", "arguments": { "paths": ["long.glsl"] } });
    client.send(&json!({ "jsonrpc": "2.0", "id": 2, "method": "tools/call", "params": call }).to_string());
    client.send("{\"jsonrpc\":\"2.0\",\"method\":\"notifications/cancelled\",\"params\":{\"requestId\":2}}");
    // No answer to what was cancelled: the next one is that of the next question.
    assert_eq!(client.ask(3, "ping", json!({}))["result"], json!({}));
    assert!(start.elapsed() < Duration::from_secs(60));
    // A call goes on when the client leaves.
    client.send(&json!({ "jsonrpc": "2.0", "id": 4, "method": "tools/call", "params": call }).to_string());
    client.leave();
    if cfg!(target_os = "linux") {
        let here =
            |process: &fs::DirEntry| fs::read_link(process.path().join("cwd")).is_ok_and(|cwd| cwd == folder.path());
        let left = || fs::read_dir("/proc").unwrap().flatten().filter(here).count();
        // Workers of lanes go when they find that nobody sends them anything.
        let start = Instant::now();
        while left() > 0 {
            assert!(start.elapsed() < Duration::from_secs(30), "{} processes are left", left());
            std::thread::sleep(Duration::from_millis(50));
        }
    }
}
