//! Programs that are run once, such as a translator: text in, bytes out, within a time and a size.

use std::io::{Read, Write as _};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::{Duration, Instant};

use super::{Loss, apart, ended, waited};

/// Bytes of a stream that are kept; more is no answer to a shader.
const MOST: u64 = 64 << 20;

/// What a program left that ended by itself, with a status of its own.
pub struct Output {
    /// Its exit status.
    pub code: i32,
    /// Its standard output.
    pub out: Vec<u8>,
    /// Its standard error.
    pub err: Vec<u8>,
}

/// Runs a program on a text for so long at most.
///
/// # Errors
/// [`Loss`] in words that continue the program's name, when it cannot be started, does not end in time, is ended by a
/// signal, or prints more than 64 MiB.
pub fn run(mut command: Command, input: &[u8], limit: Duration) -> Result<Output, Loss> {
    let begun = Instant::now();
    let child = apart(&mut command).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn();
    let mut child = child.map_err(|error| Loss::new(format!("cannot be started: {error}")))?;
    // Each pipe has a thread, since none has a time limit. They end with the pipes: what the program started in turn
    // may keep these open, and nobody waits for that.
    if let Some(mut stdin) = child.stdin.take() {
        let input = input.to_vec();
        // A program that gives up before it has read everything says why itself.
        std::thread::spawn(move || stdin.write_all(&input));
    }
    let (out, err) = (child.stdout.take().map(read), child.stderr.take().map(read));
    let left = || limit.saturating_sub(begun.elapsed());
    let result = (|| {
        let out = taken(out, left())?;
        let err = taken(err, left())?;
        Ok((status(&mut child, left()).ok_or(Why::Time)?, out, err))
    })();
    let (status, out, err) = result.map_err(|why| {
        // It is a child of this process that has not been waited for: the number is still its own.
        let _ = child.kill();
        let _ = child.wait();
        Loss::new(match why {
            Why::Time => format!("did not end within {} s", limit.as_secs_f32()),
            Why::Size => format!("printed more than {} MiB", MOST >> 20),
        })
    })?;
    match status.code() {
        // A shell says so of a program that it ran: 128 and the number of a signal, of which there are 64. Programs that
        // return negative numbers have larger ones.
        Some(code) if !(129..=192).contains(&code) => Ok(Output { code, out, err }),
        Some(code) => Err(Loss::new(format!("ended with status {code}, as a shell does after signal {}", code - 128))),
        None => Err(Loss::new(ended(status))),
    }
}

/// Why a program is ended.
enum Why {
    Time,
    Size,
}

/// The bytes of a stream, from a thread of its own.
fn read(mut stream: impl Read + Send + 'static) -> Receiver<Vec<u8>> {
    let (send, receive) = channel();
    std::thread::spawn(move || {
        let mut bytes = Vec::new();
        // What cannot be read was not said.
        let _ = stream.by_ref().take(MOST + 1).read_to_end(&mut bytes);
        let _ = send.send(bytes);
    });
    receive
}

fn taken(stream: Option<Receiver<Vec<u8>>>, left: Duration) -> Result<Vec<u8>, Why> {
    match stream.map_or(Ok(Vec::new()), |stream| waited(&stream, left)) {
        Ok(bytes) if bytes.len() as u64 > MOST => Err(Why::Size),
        Ok(bytes) => Ok(bytes),
        Err(RecvTimeoutError::Timeout | RecvTimeoutError::Disconnected) => Err(Why::Time),
    }
}

/// The status of a program that has closed its streams, and so is about to end.
fn status(child: &mut Child, left: Duration) -> Option<ExitStatus> {
    let begun = Instant::now();
    let mut step = Duration::from_micros(200);
    loop {
        if let Ok(Some(status)) = child.try_wait() {
            return Some(status);
        }
        if begun.elapsed() >= left {
            return None;
        }
        std::thread::sleep(step);
        step = (2 * step).min(Duration::from_millis(20));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(script: &str, input: &[u8]) -> Result<(i32, String), String> {
        let mut command = Command::new("/bin/sh");
        command.args(["-c", script]);
        let output = run(command, input, Duration::from_millis(1500)).map_err(|loss| loss.to_string())?;
        Ok((output.code, String::from_utf8(output.out).unwrap()))
    }

    #[test]
    fn what_a_program_prints_is_taken_whatever_it_reads() {
        assert_eq!(said("cat; exit 2", b"text"), Ok((2, "text".to_owned())));
        // More than a pipe holds, in both directions.
        let long = vec![b'x'; 1 << 20];
        assert_eq!(said("cat", &long).unwrap().1.len(), long.len());
        assert_eq!(said("echo no", &long), Ok((0, "no\n".to_owned())));
    }

    #[test]
    fn a_program_that_does_not_end_is_ended() {
        let begun = Instant::now();
        let hung = Err("did not end within 1.5 s".to_owned());
        assert_eq!(said("exec sleep 60", b""), hung);
        assert_eq!(said("exec >&- 2>&-; exec sleep 60", b""), hung);
        // It reads nothing of a text that no pipe holds.
        assert_eq!(said("exec sleep 60", &vec![b'x'; 1 << 20]), hung);
        assert!(begun.elapsed() < Duration::from_secs(20));
    }

    #[test]
    fn a_program_that_a_signal_ends_is_lost() {
        assert_eq!(said("kill -SEGV $$", b""), Err("was ended by signal 11 (segmentation fault)".to_owned()));
        let said = said("sh -c 'kill -ABRT $$'; exit $?", b"").unwrap_err();
        assert_eq!(said, "ended with status 134, as a shell does after signal 6");
    }

    #[test]
    fn a_program_that_prints_without_end_is_ended() {
        let mut command = Command::new("/bin/sh");
        command.args(["-c", "exec cat /dev/zero"]);
        let error = run(command, b"", Duration::from_secs(60)).err().unwrap().to_string();
        assert_eq!(error, "printed more than 64 MiB");
    }
}
