//! Runs of this program in processes of their own, for servers: each can be ended.

use std::io::{self, Read};
use std::path::Path;
use std::process::{Child, Command, Stdio};

/// Starts this program once more, in a folder if one is given. It has nothing to read, and what it prints is to be read.
///
/// # Errors
/// When the program does not find itself, or the process does not start.
pub fn start(arguments: &[String], folder: Option<&Path>) -> io::Result<Child> {
    let mut command = Command::new(std::env::current_exe()?);
    command.args(arguments).env("NO_COLOR", "1");
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    if let Some(folder) = folder {
        command.current_dir(folder);
    }
    command.spawn()
}

/// What a stream gives until it ends, up to so many bytes.
pub fn bytes_of(from: Option<impl Read>, most: u64) -> Vec<u8> {
    let mut bytes = Vec::new();
    if let Some(mut from) = from {
        // What was read so far is told.
        drop(from.by_ref().take(most).read_to_end(&mut bytes));
        drop(io::copy(&mut from, &mut io::sink()));
    }
    bytes
}
