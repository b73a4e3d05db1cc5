//! A dispatch as a suite states it: whether its invocations get in each other's way with the contents that it gives buffers.

use base::value::Batch;
use program::interp::group::{Buffer, Space, Turns, WIDTH, Wrong};
use program::{Form, Kernel, Program};

use super::Dispatched;
use super::host::{Contents, Scenario};
use super::run::Met;

/// Of a batch of dispatches, what makes their meaning open: races, and barriers that some invocations do not reach. Each is
/// told once, with its place.
///
/// `author` is the compute stage that `kernel` dispatches.
///
/// # Errors
/// What cannot be interpreted, with its place.
pub fn open_meaning(author: &Program, kernel: &Kernel, batch: &Batch) -> Result<Vec<String>, String> {
    let Form::Dispatch { groups, buffers } = &kernel.form else { return Ok(Vec::new()) };
    let Some(subject) = Dispatched::new(author) else { return Ok(Vec::new()) };
    let subject = subject?;
    let mut met: Vec<Met> = Vec::new();
    for k in 0..batch.invocation_count() {
        let mut bound = buffers.iter();
        let memories = subject.executable.memories().iter().map(|shape| {
            let own = shape.space == Space::Workgroup || shape.is_image();
            let about = if own { None } else { bound.next() };
            about.map_or_else(Buffer::default, |about| about.filled(shape, batch, k))
        });
        let buffers = memories.collect();
        let (executable, contents) = (subject.executable.clone(), Contents::Signed);
        let scenario = Scenario {
            groups: *groups,
            executable,
            buffers,
            settings: Vec::new(),
            surplus: 0,
            subgroup: WIDTH,
            turns: Turns::default(),
            contents,
            variant: 0,
            empty: None,
        };
        let outcome = subject.play(&scenario, 0);
        for incident in outcome.incidents {
            let open = matches!(incident.what, Wrong::Race | Wrong::Unordered | Wrong::Divergence | Wrong::Apart);
            if open && met.iter().all(|own| !own.incident.is_same(&incident)) {
                let scenario = scenario.clone();
                met.push(Met {
                    incident,
                    scenario,
                    length: None,
                    guarded: false,
                    harmless: false,
                    degenerate: false,
                    doubtful: false,
                });
            }
        }
    }
    let told = met.iter().map(|met| {
        let finding = subject.told(met, "");
        let at = finding.place.map_or_else(|| author.file.name().to_owned(), |place| place.at.to_string());
        format!("{at}: {}", finding.message)
    });
    Ok(told.collect())
}
