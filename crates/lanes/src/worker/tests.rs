//! Processes that do what they should not: each loss is told as what it is, and the next message starts a new process.

use std::time::Duration;

use super::{Program, Worker};

/// A process that runs a line of shell in place of a lane.
fn worker(script: &str) -> Worker {
    let program = Program { path: "/bin/sh".into(), arguments: vec!["-c".into(), script.into()] };
    Worker::new(Box::leak(Box::new(program)), &[("SHADERCHECK_PLANTED", "here")])
}

/// What is said of a process that is asked once.
fn loss(script: &str) -> String {
    let mut worker = worker(script);
    let sent = worker.send(&"ask", &[&[1, 2, 3]]);
    let answer = sent.and_then(|()| worker.receive::<String>(Duration::from_secs(5)));
    assert!(worker.start().is_none(), "it is not ended");
    answer.expect_err("no answer").to_string()
}

#[test]
fn a_process_that_is_killed_from_outside_is_reported_with_its_signal() {
    let said = loss("head -c 20 > /dev/null; kill -9 $$");
    assert!(said.contains("signal 9 (killed)"), "{said}");
    let said = loss("head -c 20 > /dev/null; kill -11 $$");
    assert!(said.contains("signal 11 (segmentation fault)"), "{said}");
}

#[test]
fn a_process_that_dies_at_its_start_is_reported_with_its_last_words() {
    let said = loss("head -c 20 > /dev/null; echo first >&2; echo no such library >&2; exit 7");
    assert!(said.contains("status 7") && said.ends_with("it said: no such library"), "{said}");
}

#[test]
fn garbage_is_no_answer() {
    let said = loss("echo this is no answer at all; sleep 5");
    assert!(said.starts_with("gave an answer that cannot be read"), "{said}");
}

#[test]
fn half_a_frame_is_no_answer() {
    let said = loss("head -c 20 > /dev/null; printf 'SCW1'; exit 0");
    assert!(said.contains("its answer is cut off"), "{said}");
}

#[test]
fn a_process_that_hangs_is_ended_after_its_time() {
    let mut worker = worker("sleep 60");
    worker.send(&"ask", &[]).unwrap();
    let error = worker.receive::<String>(Duration::from_millis(100)).unwrap_err().to_string();
    assert!(error.starts_with("gave no answer within"), "{error}");
    assert!(worker.start().is_none());
}

#[test]
fn a_process_that_takes_no_message_is_ended_after_its_time() {
    // More than a pipe holds.
    let words = vec![0; 1 << 20];
    let mut deaf = worker("exec sleep 60");
    let error = deaf.send_within(&"ask", &[&words], Duration::from_secs(1)).unwrap_err().to_string();
    assert_eq!(error, "took no message within 1 s");
    assert!(deaf.start().is_none());
    let mut slow = worker("sleep 0.3; cat > /dev/null");
    slow.send_within(&"ask", &[&words], Duration::from_secs(20)).unwrap();
}

#[test]
fn a_program_that_is_not_there_is_reported() {
    let program = Program { path: "/nowhere/shadercheck".into(), arguments: Vec::new() };
    let error = Worker::new(&program, &[]).send(&"ask", &[]).unwrap_err().to_string();
    assert!(error.starts_with("cannot be started"), "{error}");
}

#[test]
fn a_lost_process_is_started_again_with_its_environment() {
    // The first byte of a frame is enough of an answer to tell that the variable is there.
    let mut worker = worker("test \"$SHADERCHECK_PLANTED\" = here && exit 3; exit 4");
    for start in 1..3 {
        // The process may be gone before it has taken the message.
        let sent = worker.send(&"ask", &[]);
        let error = sent.and_then(|()| worker.receive::<String>(Duration::from_secs(5))).unwrap_err().to_string();
        assert!(error.contains("status 3"), "{error}");
        assert_eq!(worker.starts, start);
    }
}
