//! The protocol with a peer that plays Node, and the script where Node is.

use std::cell::Cell;
use std::process::Command;
use std::rc::Rc;
use std::sync::Arc;
use std::time::Duration;

use super::messages::{Adapter, Answer, Ask, Limits};
use super::remote::{Peer, Remote};
use super::runner::WgslRunner;
use super::{describe, device, node, open_at};
use crate::worker::{Loss, Process, Program as Command_, read_frame, write_frame};
use crate::{Actual, LaneError, Runner};
use base::text::SourceFile;
use base::value::Batch;
use program::Program;
use program::lower::Target;
use syntax::Stage;

const LIMITS: Limits = Limits {
    max_storage_buffer_binding_size: 1 << 27,
    max_buffer_size: 1 << 28,
    max_compute_workgroups_per_dimension: 65535,
    max_uniform_buffer_binding_size: 1 << 16,
    min_uniform_buffer_offset_alignment: 256,
};

fn adapter(limits: Limits) -> Box<Adapter> {
    Box::new(Adapter {
        vendor: "google".to_owned(),
        architecture: "swiftshader".to_owned(),
        device: "swiftshader-device-subzero-".to_owned(),
        description: "SwiftShader driver 5.0.0".to_owned(),
        version: "0.6.2".to_owned(),
        limits,
    })
}

/// What the peer does wrong.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Fault {
    None,
    /// One bit of one word of what was written.
    Bit(usize),
    /// The last record is missing.
    Short,
    /// What an earlier run wrote.
    Stale,
    /// It is gone whenever an invocation has this number.
    Crash(f32),
    /// It crashes at a number, and never when it has the invocation by itself.
    CrashAmongOthers(f32),
    /// It refuses the text.
    Refuse,
    /// It answers another question.
    Else,
}

/// A peer that knows one shader: `x * gain`.
struct Fake {
    fault: Fault,
    limits: Limits,
    /// The start that is running, and how many there were.
    start: Option<u64>,
    starts: Rc<Cell<u64>>,
    record: usize,
    before: Vec<u32>,
}

impl Process for Fake {
    fn start(&self) -> Option<u64> {
        self.start
    }

    fn stop(&mut self) {
        self.start = None;
    }
}

impl Peer for Fake {
    fn send(&mut self, _: &Ask, _: &[&[u32]]) -> Result<(), Loss> {
        Ok(())
    }

    fn ask(&mut self, ask: &Ask, words: &[&[u32]], _: Duration) -> Result<(Answer, Vec<u32>), Loss> {
        if self.start.is_none() {
            self.starts.set(self.starts.get() + 1);
            self.start = Some(self.starts.get());
        }
        // As it would come through a pipe.
        let mut bytes = Vec::new();
        write_frame(&mut bytes, ask, words).unwrap();
        let frame = read_frame::<Ask>(&mut &bytes[..]).unwrap().unwrap();
        match frame.message {
            Ask::Open { .. } => Ok((Answer::Opened(adapter(self.limits)), Vec::new())),
            Ask::Prepare(job) if self.fault == Fault::Refuse => {
                let why = "unresolved call target 'f'".to_owned();
                Ok((Answer::Refused { id: job.id, line: 1, column: 4, why }, Vec::new()))
            }
            Ask::Prepare(job) => {
                assert!(job.code.contains(&format!("fn {}(", job.entry)), "{}", job.code);
                self.record = job.record;
                Ok((Answer::Ready { id: job.id }, Vec::new()))
            }
            Ask::Run { run, .. } if self.fault == Fault::Else => Ok((Answer::Done { run: run + 1 }, Vec::new())),
            Ask::Run { run, count, per_case, canary, lengths, .. } => {
                let (invocations, cases) = frame.words.split_at(lengths[0]);
                assert_eq!((invocations.len(), cases.len()), (count, lengths[1]));
                let at = |number: f32| invocations.iter().any(|&word| f32::from_bits(word) == number);
                let crashes = match self.fault {
                    Fault::Crash(number) => at(number),
                    Fault::CrashAmongOthers(number) => at(number) && count > 1,
                    _ => false,
                };
                if crashes {
                    self.stop();
                    return Err(Loss::new("was ended by signal 11 (segmentation fault)"));
                }
                let value = |i: usize| f32::from_bits(invocations[i]) * f32::from_bits(cases[i / per_case]);
                let mut words: Vec<u32> = (0..count).flat_map(|i| [canary ^ i as u32, value(i).to_bits()]).collect();
                assert_eq!(self.record, 2);
                match self.fault {
                    Fault::Bit(word) => words[word] ^= 1 << 20,
                    Fault::Short => words.truncate(2 * count - 1),
                    Fault::Stale if !self.before.is_empty() => words = std::mem::take(&mut self.before),
                    _ => {}
                }
                self.before.clone_from(&words);
                Ok((Answer::Done { run }, words))
            }
            Ask::Drop { .. } => unreachable!("it has no answer"),
        }
    }
}

/// A runner on a peer with a fault, for so many invocations; and how often the peer was started.
fn runner(fault: Fault, limits: Limits, capacity: usize) -> (Result<WgslRunner, LaneError>, Program, Rc<Cell<u64>>) {
    let starts = Rc::default();
    let fake = Fake { fault, limits, start: None, starts: Rc::clone(&starts), record: 0, before: Vec::new() };
    let remote = Remote::open(Box::new(fake), "/nowhere".as_ref()).unwrap();
    let text = "#version 330\nin float x;\nuniform float gain;\nout float y;\nvoid main() { y = x * gain; }\n";
    let file = SourceFile::new("gain.frag", text);
    let program = Program::from_source(&file, Stage::Fragment, |_| Ok(Target::Stage)).unwrap();
    let kernel = program.compute_kernel().unwrap();
    (WgslRunner::new(&remote, &kernel, capacity), program, starts)
}

/// Two invocations of each case: `x` is the number of the invocation, and the gain 1, 2 and so on.
fn batch(program: &Program, cases: u16) -> Batch {
    let bits = |n: u16| f32::from(n).to_bits();
    Batch {
        invocation_record: Arc::new(program.invocation_record()),
        case_record: Arc::new(program.case_record()),
        per_case: 2,
        invocations: (0..2 * cases).map(bits).collect(),
        cases: (1..=cases).map(bits).collect(),
    }
}

fn run(fault: Fault, cases: u16) -> Result<Actual, LaneError> {
    let (runner, program, _) = runner(fault, LIMITS, 4096);
    let mut runner = runner?;
    // What comes of the first run is old in the second one.
    runner.run(&batch(&program, 2)).ok();
    runner.run(&batch(&program, cases))
}

#[test]
fn inputs_arrive_and_outputs_come_back() {
    let actual = run(Fault::None, 3).unwrap();
    let given: Vec<f32> = (0..6).map(|i| f32::from_bits(actual.vertex(i, 0)[0])).collect();
    assert_eq!(given, [0.0, 1.0, 4.0, 6.0, 12.0, 15.0]);
}

#[test]
fn what_was_not_written_by_this_run_is_no_output() {
    for (fault, at) in [(Fault::Bit(2), 1), (Fault::Short, 5), (Fault::Stale, 0)] {
        let error = run(fault, 3).unwrap_err();
        assert!(matches!(error, LaneError::NotWritten { invocation, .. } if invocation == at), "{fault:?}: {error}");
    }
    // A bit of an output is the judge's matter.
    assert_eq!(run(Fault::Bit(3), 3).unwrap().vertex(1, 0)[0], 1.0_f32.to_bits() ^ (1 << 20));
}

#[test]
fn the_invocation_that_takes_the_process_along_is_named() {
    let error = run(Fault::Crash(700.0), 1000).unwrap_err();
    let LaneError::Lost { how, invocation, count, inputs } = &error else { panic!("{error}") };
    assert_eq!((*invocation, *count), (Some(700), 2000));
    assert_eq!(inputs, &format!("gain={:08x} x={:08x}", 351.0_f32.to_bits(), 700.0_f32.to_bits()));
    assert!(how.contains("signal 11"), "{how}");
    let error = run(Fault::CrashAmongOthers(700.0), 1000).unwrap_err();
    assert!(matches!(&error, LaneError::Lost { invocation: None, .. }), "{error}");
}

#[test]
fn a_process_that_was_lost_is_started_again_with_its_kernel() {
    let (runner, program, starts) = runner(Fault::Crash(5.0), LIMITS, 4096);
    let mut runner = runner.unwrap();
    assert!(runner.run(&batch(&program, 3)).is_err());
    // Lost with all of them, with a few, and with the one.
    assert_eq!(starts.get(), 3);
    assert!(runner.run(&batch(&program, 2)).is_ok());
    assert_eq!(starts.get(), 4);
}

#[test]
fn a_text_that_tint_refuses_is_reported_with_its_line() {
    let error = runner(Fault::Refuse, LIMITS, 16).0.err().unwrap().to_string();
    assert!(error.contains("Tint refuses the WGSL of this kernel at 1:4: unresolved call target 'f': `"), "{error}");
}

#[test]
fn an_answer_to_something_else_ends_the_process() {
    let error = run(Fault::Else, 2).unwrap_err().to_string();
    assert!(error.contains("an answer to something else"), "{error}");
}

#[test]
fn a_batch_is_no_larger_than_the_device_permits() {
    let capacity = |limits| runner(Fault::None, limits, 1 << 20).0.unwrap().capacity();
    assert_eq!(capacity(LIMITS), 1 << 20);
    // Two words for each record.
    assert_eq!(capacity(Limits { max_storage_buffer_binding_size: 800, ..LIMITS }), 100);
    assert_eq!(capacity(Limits { max_buffer_size: 80, ..LIMITS }), 10);
    assert_eq!(capacity(Limits { max_compute_workgroups_per_dimension: 3, ..LIMITS }), 192);
}

#[test]
fn devices_are_known_by_the_names_of_their_drivers() {
    assert_eq!(device("swiftshader-device-subzero-"), "SwiftShader Device (Subzero)");
    assert_eq!(device("swiftshader-device-llvm-16.0-"), "SwiftShader Device (Llvm-16.0)");
    assert_eq!(device("llvmpipe--llvm-19.1.7--256-bits-"), "llvmpipe");
    assert_eq!(device("nvidia-h100"), "nvidia-h100");
    assert_eq!(device(""), "");
    let lane = describe(&adapter(LIMITS));
    assert_eq!(lane.driver, "SwiftShader Device (Subzero), SwiftShader driver 5.0.0, Dawn of webgpu 0.6.2");
    assert_eq!(lane.group(), ("subzero", "Tint"));
}

#[test]
fn what_is_missing_is_reported_with_the_command_that_brings_it() {
    let program = Command_ { path: "/nowhere/node".into(), arguments: Vec::new() };
    let missing = open_at("/nowhere".as_ref(), &program).err().unwrap();
    assert!(missing.why.starts_with("`node` cannot be started"), "{missing}");
    assert!(missing.remedy.contains("apt-get install nodejs"), "{missing}");
}

/// The script itself, with packages that are none: it needs Node, and no driver.
#[test]
fn the_script_speaks_the_protocol() {
    if Command::new("node").arg("--version").output().is_err() {
        return test_record::not_run("there is no `node`: the script of the lane `webgpu`");
    }
    let missing = |index: &str| {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("package.json"), r#"{"type": "module", "main": "index.js"}"#).unwrap();
        std::fs::write(folder.path().join("index.js"), index).unwrap();
        open_at(folder.path(), &node()).err().unwrap()
    };
    let broken = missing("export const create = ;");
    assert!(broken.why.starts_with("the package cannot be loaded: "), "{broken}");
    let none =
        missing("export const globals = {}; export const create = () => ({ requestAdapter: async () => null });");
    assert!(none.why.contains("none of the Vulkan drivers") && none.remedy.contains("chromium-common"), "{none}");
    let throws = missing("export const globals = {}; export function create() { throw new Error('no\\nluck'); }");
    assert!(throws.why.contains("killed") && throws.why.ends_with("it said: no luck"), "{throws}");
}
