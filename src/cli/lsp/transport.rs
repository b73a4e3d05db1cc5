//! Messages over standard input and output. A message that cannot be read is answered as the protocol says, and reading
//! goes on behind it.

use std::io::{BufRead, Read as _, Write};
use std::sync::mpsc::{Receiver, Sender};

use lsp_server::Message;
use serde_json::json;

use super::Event;

/// Bytes of the longest message that is read.
const MOST_BYTES: u64 = 256 << 20;

/// Bytes of a line of a header at most.
const HEADER: usize = 4096;

/// What came of an attempt to read a message.
#[derive(Debug)]
pub(super) enum Incoming {
    /// A message.
    Message(Message),
    /// Bytes that are none; why.
    Broken(String),
    /// Nothing comes any more.
    End,
}

/// Reads messages until there are no more, and hands them on.
pub(super) fn read_all(input: &mut dyn BufRead, to: &Sender<Event>) {
    loop {
        let incoming = read(input);
        let end = matches!(incoming, Incoming::End);
        if to.send(Event::Incoming(incoming)).is_err() || end {
            return;
        }
    }
}

pub(super) fn read(input: &mut dyn BufRead) -> Incoming {
    let mut length: Option<u64> = None;
    loop {
        let mut line = Vec::new();
        // A header is a line of ASCII.
        match input.take(HEADER as u64).read_until(b'\n', &mut line) {
            Err(_) => return Incoming::End,
            // A line that ends before its end is cut off.
            Ok(read) if read < HEADER && !line.ends_with(b"\n") => return Incoming::End,
            Ok(_) => {}
        }
        let line = String::from_utf8_lossy(&line);
        let line = line.trim_end();
        match (line.is_empty(), length) {
            (true, Some(length)) => return body(input, length),
            // Blank lines between messages say nothing.
            (true, None) => {}
            (false, _) => match line.split_once(':') {
                Some((key, value)) if key.trim().eq_ignore_ascii_case("content-length") => {
                    let Ok(bytes) = value.trim().parse() else {
                        return Incoming::Broken(format!("`{line}` gives no length"));
                    };
                    length = Some(bytes);
                }
                Some((key, _)) if key.trim().eq_ignore_ascii_case("content-type") => {}
                _ => return Incoming::Broken("a line that is no header of a message".to_owned()),
            },
        }
    }
}

fn body(input: &mut dyn BufRead, length: u64) -> Incoming {
    if length > MOST_BYTES {
        let skipped = std::io::copy(&mut input.take(length), &mut std::io::sink());
        return match skipped {
            Ok(read) if read == length => Incoming::Broken(format!("a message of {length} bytes")),
            _ => Incoming::End,
        };
    }
    let mut bytes = Vec::new();
    match input.take(length).read_to_end(&mut bytes) {
        Ok(read) if read as u64 == length => {}
        _ => return Incoming::End,
    }
    match serde_json::from_slice(&bytes) {
        Ok(message) => Incoming::Message(message),
        Err(error) => Incoming::Broken(error.to_string()),
    }
}

/// Writes messages until no one sends any more, or no one reads them.
pub(super) fn write_all(output: &mut dyn Write, from: &Receiver<Outgoing>) {
    for outgoing in from {
        let written = match outgoing {
            Outgoing::Message(message) => message.write(&mut &mut *output),
            // The request cannot be told: the protocol wants `null` for it.
            Outgoing::ParseError(why) => {
                let error = json!({ "code": -32700, "message": format!("cannot be read: {why}") });
                let text = json!({ "jsonrpc": "2.0", "id": null, "error": error }).to_string();
                write!(output, "Content-Length: {}\r\n\r\n{text}", text.len()).and_then(|()| output.flush())
            }
        };
        if written.is_err() {
            return;
        }
    }
}

/// What is written.
pub(super) enum Outgoing {
    /// A message.
    Message(Message),
    /// That something could not be read.
    ParseError(String),
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(bytes: &[u8]) -> Vec<String> {
        let mut input = bytes;
        let mut found = Vec::new();
        loop {
            match read(&mut input) {
                Incoming::Message(Message::Notification(n)) => found.push(n.method),
                Incoming::Message(_) => found.push("other".to_owned()),
                Incoming::Broken(_) => found.push("broken".to_owned()),
                Incoming::End => return found,
            }
        }
    }

    fn framed(text: &str) -> String {
        format!("Content-Length: {}\r\n\r\n{text}", text.len())
    }

    #[test]
    fn reading_goes_on_behind_what_is_broken() {
        let good = framed(r#"{"jsonrpc":"2.0","method":"exit"}"#);
        for broken in [
            framed("{\"method\""),
            framed("[]"),
            framed("\u{fffd}é"),
            "Content-Length: x\r\n".to_owned(),
            "what\r\n".to_owned(),
        ] {
            assert_eq!(all(format!("{good}{broken}{good}").as_bytes()), ["exit", "broken", "exit"], "{broken}");
        }
        let typed = good.replace("\r\n\r\n", "\r\nContent-Type: application/vscode-jsonrpc; charset=utf-8\r\n\r\n");
        assert_eq!(all(typed.as_bytes()), ["exit"]);
    }

    #[test]
    fn what_is_cut_off_is_the_end() {
        let good = framed(r#"{"jsonrpc":"2.0","method":"exit"}"#);
        for length in 0..good.len() {
            assert!(all(&good.as_bytes()[..length]).is_empty(), "{length}");
        }
        assert!(all(b"Content-Length: 99999999999999\r\n\r\n{}").is_empty());
    }
}
