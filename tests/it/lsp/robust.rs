//! Clients and workspaces that are not as they should be: the server goes on or ends, writes nothing and loses nothing.

use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use serde_json::json;

use super::client::Client;
use super::editing::{unchanged, workspace};

#[test]
fn broken_messages_are_answered_and_the_next_one_is_served() {
    let folder = workspace();
    let mut client = Client::new(folder.path());
    for broken in
        ["Content-Length: 9\r\n\r\n{\"broken\"", "Content-Length: 2\r\n\r\n[]", "Content-Length: many\r\n", "\u{0}\r\n"]
    {
        client.raw(broken.as_bytes());
        let answer = client.until(|m| m["error"]["code"] == -32700);
        assert!(answer["id"].is_null(), "{broken:?}");
    }
    // Well-formed, and wrong.
    for (method, params) in [
        ("textDocument/hover", json!({})),
        ("textDocument/hover", json!({ "textDocument": { "uri": 3 }, "position": {} })),
        (
            "textDocument/rename",
            json!({ "textDocument": { "uri": client.uri("gone.vert") }, "position": { "line": 0, "character": 0 } }),
        ),
        ("textDocument/codeAction", json!([])),
        ("initialize", json!({})),
        ("workspace/executeCommand", json!({ "command": "rm" })),
    ] {
        assert!(client.ask(method, params).is_err(), "{method}");
    }
    for (method, params) in [
        ("textDocument/didChange", json!({})),
        ("textDocument/didOpen", json!({ "textDocument": { "uri": "untitled:1", "text": "x" } })),
        ("textDocument/didClose", json!({ "textDocument": { "uri": "file:///nowhere/a.vert" } })),
        ("$/cancelRequest", json!({ "id": 12345 })),
        ("workspace/didChangeWorkspaceFolders", json!({ "event": 1 })),
    ] {
        client.notify(method, params);
    }
    client.open("a.vert");
    client.change("a.vert", 2, [999, 0, 9999, 9999], "\n// more\n");
    client.change("a.vert", 3, [3, 5, 2, 1], "backwards");
    let params = client.at("a.vert", 1, 14);
    assert!(client.ask("textDocument/hover", params).is_ok());
    assert_eq!(client.end(), Some(0));
    assert!(unchanged(folder.path()));
}

#[test]
fn requests_before_initialize_and_after_shutdown_are_refused() {
    let folder = workspace();
    let mut client = Client::new(folder.path());
    client.ask("shutdown", json!(null)).unwrap();
    let params = client.at("a.vert", 0, 0);
    assert!(client.ask("textDocument/hover", params).unwrap_err().contains("exit"));
    client.notify("exit", json!(null));
    assert_eq!(client.wait(), Some(0));
    let mut rude = Client::new(folder.path());
    rude.notify("exit", json!(null));
    assert_eq!(rude.wait(), Some(1), "without `shutdown`");
}

#[test]
fn a_client_that_dies_takes_the_server_with_it() {
    let folder = workspace();
    let mut client = Client::new(folder.path());
    client.open("a.frag");
    client.raw(b"Content-Length: 100\r\n\r\n{\"jsonrpc\"");
    drop(client.child.stdin.take());
    assert_eq!(client.wait(), Some(1));
    assert!(unchanged(folder.path()));
}

#[test]
fn a_run_is_stopped_by_its_client_and_with_it() {
    let folder = workspace();
    let slow = "#version 450\nfloat slow(float x) { float s = x; for (int i = 0; i < 200000; ++i) s = fract(sin(s) * 43758.5); return s; }\n";
    fs::write(folder.path().join("slow.glsl"), slow).unwrap();
    let mut client = Client::new(folder.path());
    client.open("slow.glsl");
    let params = json!({ "command": "shadercheck.fuzz", "arguments": [client.uri("slow.glsl"), "slow"] });
    let id = client.begin("workspace/executeCommand", params.clone());
    client.until(|m| m["method"] == "$/progress" && m["params"]["value"]["kind"] == "begin");
    client.notify("$/cancelRequest", json!({ "id": id }));
    assert!(client.answer(id).unwrap_err().contains("stopped"));
    // Closed in the middle of another one.
    client.begin("workspace/executeCommand", params);
    client.until(|m| m["method"] == "$/progress" && m["params"]["value"]["kind"] == "begin");
    drop(client.child.stdin.take());
    assert_eq!(client.wait(), Some(1));
    // Neither of the two runs goes on by itself.
    let end = Instant::now() + Duration::from_secs(20);
    while runs_in(folder.path()) {
        assert!(Instant::now() < end, "a run outlives its server");
        std::thread::sleep(Duration::from_millis(50));
    }
    assert_eq!(fs::read_to_string(folder.path().join("slow.glsl")).unwrap(), slow);
}

/// True while a process has a file of this folder among its arguments, where the system tells.
fn runs_in(folder: &Path) -> bool {
    let folder = folder.to_str().unwrap();
    let named = |process: fs::DirEntry| {
        fs::read(process.path().join("cmdline")).is_ok_and(|line| String::from_utf8_lossy(&line).contains(folder))
    };
    fs::read_dir("/proc").is_ok_and(|all| all.flatten().any(named))
}

#[test]
fn a_file_that_is_saved_in_another_encoding_keeps_what_the_editor_has() {
    let folder = workspace();
    let mut client = Client::new(folder.path());
    client.open("main.cpp");
    client.until_found("main.cpp", &[]);
    let host = fs::read_to_string(folder.path().join("main.cpp")).unwrap();
    let wrong = host.replace("\"tint\"", "\"taint\"");
    let bytes = [b"// \x8b\x85\x82\xcc\x90\x46\n".as_slice(), wrong.as_bytes()].concat();
    // The editor writes its text in Shift_JIS, and goes on with it.
    client.change("main.cpp", 2, [0, 0, 0, 0], "// 球の色\n");
    client.change("main.cpp", 3, [4, 39, 4, 43], "taint");
    fs::write(folder.path().join("main.cpp"), &bytes).unwrap();
    client.notify("textDocument/didSave", json!({ "textDocument": { "uri": client.uri("main.cpp") } }));
    client.until_found("main.cpp", &["H003"]);
    let uri = client.uri("main.cpp");
    assert_eq!(client.shown[&uri][0]["range"]["start"], json!({ "line": 4, "character": 38 }));
    // Closed, the file on the disk counts; it is read in its encoding.
    client.notify("textDocument/didClose", json!({ "textDocument": { "uri": uri } }));
    client.ask("workspace/symbol", json!({ "query": "" })).unwrap();
    let refused = {
        client.open("a.vert");
        client.rename("a.vert", [1, 14], "camera").unwrap_err()
    };
    assert!(refused.contains("Shift_JIS"), "{refused}");
    assert_eq!(client.end(), Some(0));
    assert_eq!(fs::read(folder.path().join("main.cpp")).unwrap(), bytes);
}

#[test]
fn a_file_in_another_encoding_is_not_renamed_in_until_it_is_open() {
    let folder = workspace();
    let host = fs::read_to_string(folder.path().join("main.cpp")).unwrap();
    // 球の色 in Shift_JIS.
    let bytes = [b"// \x8b\x85\x82\xcc\x90\x46\n".as_slice(), host.as_bytes()].concat();
    fs::write(folder.path().join("main.cpp"), &bytes).unwrap();
    let mut client = Client::new(folder.path());
    client.open("a.vert");
    let refused = client.rename("a.vert", [1, 14], "camera").unwrap_err();
    assert!(refused.contains("main.cpp") && refused.contains("Shift_JIS"), "{refused}");
    client.open_as("main.cpp", &format!("// 球の色\n{host}"));
    assert!(client.rename("a.vert", [1, 14], "camera").is_ok());
    assert_eq!(client.end(), Some(0));
    assert_eq!(fs::read(folder.path().join("main.cpp")).unwrap(), bytes);
}

#[test]
fn nothing_outside_of_the_workspace_is_changed() {
    let outside = workspace();
    let folder = tempfile::tempdir().unwrap();
    let inside = folder.path().join("inside");
    fs::create_dir(&inside).unwrap();
    let beyond = outside.path().join("a.vert");
    let host = fs::read_to_string(outside.path().join("main.cpp")).unwrap();
    fs::write(inside.join("main.cpp"), host.replace("a.vert", beyond.to_str().unwrap())).unwrap();
    fs::copy(outside.path().join("a.frag"), inside.join("a.frag")).unwrap();
    #[cfg(unix)]
    std::os::unix::fs::symlink(outside.path(), inside.join("linked")).unwrap();
    #[cfg(unix)]
    std::os::unix::fs::symlink(&beyond, inside.join("link.vert")).unwrap();
    let mut client = Client::new(&inside);
    client.open("main.cpp");
    let refused = client.rename("main.cpp", [4, 47], "camera").unwrap_err();
    assert!(refused.contains("outside of the workspace"), "{refused}");
    let symbols = client.ask("workspace/symbol", json!({ "query": "" })).unwrap();
    assert!(!symbols.to_string().contains("link"), "{symbols}");
    assert_eq!(client.end(), Some(0));
    assert!(unchanged(outside.path()));
}

#[test]
fn of_a_workspace_of_fifty_thousand_files_a_part_is_read() {
    let folder = workspace();
    for group in 0..50 {
        let inner = folder.path().join(format!("zz{group}"));
        fs::create_dir(&inner).unwrap();
        (0..1000).for_each(|n| fs::write(inner.join(format!("{n}.frag")), "void f() {}\n").unwrap());
    }
    let wrong = "#version 330 core\nout vec4 c;\nvoid main()\n{\n  c = vec4(1.0, 2.0, 3.0);\n}\n";
    let late = "zz9/999.frag";
    fs::write(folder.path().join(late), wrong).unwrap();
    let mut client = Client::new(folder.path());
    client.until(|m| m["method"] == "window/showMessage" && m["params"]["message"].as_str().unwrap().contains("large"));
    client.open(late);
    client.until_found(late, &["T002"]);
    assert_eq!(client.end(), Some(0));
}
