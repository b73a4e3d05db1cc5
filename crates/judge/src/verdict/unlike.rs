//! Which samples of a program do not mean what is expected of them, without any lane.

use super::fit::open_samples;
use super::judge::{Doubt, Reason, Verdict};
use super::oracle::JudgeContext;
use super::parallel;
use super::second_pass::SecondPass;
use base::value::Batch;
use program::OutputLayout;
use program::interp::SLOTS;
use program::lane::interrupt;

/// The invocations of a batch in which the program does not mean what its reference expects, or in which nothing can be said,
/// in their order. What is expected by another program is compared in real numbers: a verdict that deviates has the two
/// values and how far binary64 may have moved them. Once the process is asked to end, nothing can be said of what is left.
pub fn unlike(context: &JudgeContext<'_>, layout: &OutputLayout, batch: &Batch) -> Vec<(usize, Verdict)> {
    let make = || (context.oracle.ideal_or_meaning(), SecondPass::new(context));
    let parts = parallel::parts(batch.invocation_count().div_ceil(SLOTS), make, |(machine, second), chunk| {
        if interrupt::asked() {
            let unknown = Verdict::Undetermined(Doubt::of(Reason::LongLoop));
            let chunk = chunk * SLOTS..(chunk * SLOTS + SLOTS).min(batch.invocation_count());
            return chunk.map(|invocation| (invocation, unknown.clone())).collect();
        }
        let open = open_samples(context, machine, batch, chunk * SLOTS);
        let verdicts = second.shader(batch, layout, None, &open);
        let found = open.into_iter().zip(verdicts).filter_map(|(invocation, verdict)| Some((invocation, verdict?)));
        found.collect::<Vec<_>>()
    });
    parts.into_iter().flatten().collect()
}
