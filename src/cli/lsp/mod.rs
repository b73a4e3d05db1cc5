//! `shadercheck lsp`: a language server over standard input and output.
//!
//! The main thread reads messages, applies changes to texts and answers nothing by itself: findings and requests are
//! worked out by other threads on the texts of the moment, and what is late for them is dropped.

mod commands;
mod edits;
#[cfg(feature = "run")]
mod numbers;
mod options;
mod project;
mod requests;
mod results;
mod server;
mod shown;
mod transport;
mod views;

use std::io::{BufReader, BufWriter, Write};
use std::sync::mpsc::channel;

use clap::Args;

use super::status::ExitStatus;
use commands::Finished;
use server::{Checked, Server};
use transport::Incoming;

/// Serve an editor: findings while typing, repairs, navigation, over standard input and output
///
/// The editor starts this command and speaks the Language Server Protocol with it. docs/book/src/editor.md has
/// configurations of editors.
#[derive(Args, Clone, Debug, Default)]
pub struct LspArgs {
    /// Use standard input and output, the only transport; accepted because clients pass it
    #[arg(long)]
    pub stdio: bool,
}

/// What the main thread waits for.
enum Event {
    /// Something came from the client.
    Incoming(Incoming),
    /// Files were linted.
    Checked(Checked),
    /// A request was answered.
    Answered(lsp_server::Response),
    /// A command came to its end.
    Finished(Finished),
}

/// Runs the command until the client asks it to end, or is gone.
///
/// The status is [`ExitStatus::Clean`] when the client said `shutdown` and then `exit`, and [`ExitStatus::Findings`]
/// otherwise, as the protocol wants.
///
/// # Errors
/// When `err` cannot be written to.
pub fn run(_: &LspArgs, err: &mut dyn Write) -> anyhow::Result<ExitStatus> {
    let (events, incoming) = channel();
    let (outgoing, written) = channel();
    let reader = events.clone();
    std::thread::spawn(move || transport::read_all(&mut BufReader::new(std::io::stdin()), &reader));
    let writer = std::thread::spawn(move || transport::write_all(&mut BufWriter::new(std::io::stdout()), &written));
    let clean = Server::new(events, outgoing).run(&incoming);
    // What was answered last is written, unless no one reads it.
    if clean {
        drop(writer.join());
    } else {
        writeln!(err, "note: the client went away without saying so")?;
    }
    Ok(if clean { ExitStatus::Clean } else { ExitStatus::Findings })
}
