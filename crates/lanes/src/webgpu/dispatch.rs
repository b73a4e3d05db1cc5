//! Whole dispatches of a compute stage on a device of Dawn: the author's own text where it is WGSL.

use naga::back::wgsl;

use super::messages::{Dispatching, Job, Storage};
use super::remote::{Away, BATCH, FEW, Failure, Remote};
use super::runner::unsupported;
use crate::worker::{Loss, with_inputs};
use crate::{Actual, LaneError, Marks, Runner, buffers};
use base::value::Batch;
use program::{BoundBuffer, Kernel, OutputLayout, Program, Written, contain};

/// Dispatches of one run at most.
const MOST: usize = 64;

pub struct DispatchRunner {
    away: Away,
    layout: OutputLayout,
    buffers: Vec<BoundBuffer>,
    capacity: usize,
}

/// True where Tint reads what the author wrote.
pub fn reads_author(program: &Program) -> bool {
    // Values of `override` constants are in the module that naga has.
    program.dispatch.is_some() && program.written == Written::Wgsl && program.defines.is_empty()
}

/// The text of a stage that is dispatched.
fn code(kernel: &Kernel) -> Result<String, LaneError> {
    if reads_author(&kernel.program) {
        return Ok(kernel.program.file.text().to_owned());
    }
    let written = contain(|| wgsl::write_string(&kernel.module, &kernel.info, wgsl::WriterFlags::empty()));
    let written = written.map_err(|panic| unsupported(format!("naga writes no WGSL of it: {panic}")))?;
    written.map_err(|error| unsupported(format!("WGSL cannot express this shader: {error}")))
}

impl DispatchRunner {
    pub fn new(
        remote: &Remote,
        kernel: &Kernel,
        (groups, all): ([u32; 3], &[BoundBuffer]),
        capacity: usize,
    ) -> Result<Self, LaneError> {
        if !kernel.program.textures.is_empty() {
            return Err(unsupported("textures in a whole dispatch"));
        }
        let limits = &remote.adapter.limits;
        for (axis, &count) in ["x", "y", "z"].iter().zip(&groups) {
            let most = limits.max_compute_workgroups_per_dimension;
            if u64::from(count) > most {
                return Err(unsupported(format!("{count} workgroups along {axis}; the device has {most}")));
            }
        }
        for about in all {
            let most = match about.uniform {
                true => limits.max_uniform_buffer_binding_size,
                false => limits.max_storage_buffer_binding_size,
            };
            if u64::from(about.bytes) > most {
                return Err(unsupported(format!("a buffer of {} bytes; the device has {most}", about.bytes)));
            }
        }
        let read: usize = all.iter().filter(|about| !about.after.is_empty()).map(buffers::words).sum();
        let fit = usize::try_from(limits.max_buffer_size / 4).unwrap_or(usize::MAX) / read.max(1);
        let capacity = capacity.min(MOST).min(fit).max(1);
        let storage = |about: &BoundBuffer| Storage {
            group: about.group,
            binding: about.binding,
            bytes: about.bytes,
            words: buffers::words(about),
            uniform: about.uniform,
            writable: about.writable,
            read: !about.after.is_empty(),
        };
        let point = kernel.module.entry_points.first().map(|point| point.name.clone());
        let job = Job {
            id: 0,
            code: code(kernel)?,
            entry: point.unwrap_or_default(),
            capacity,
            workgroup: 1,
            record: read,
            sentinel: Marks::random().sentinel,
            stride: 0,
            inputs: Vec::new(),
            textures: Vec::new(),
            dispatch: Some(Dispatching { groups, buffers: all.iter().map(storage).collect() }),
        };
        let away = remote.prepare(job, Vec::new()).map_err(|error| match error {
            // What a device has no room for is no fault of the stage.
            LaneError::Api(why) if why.contains("exceeds the maximum") || why.contains("limit") => unsupported(why),
            other => other,
        })?;
        Ok(Self { away, layout: kernel.output.clone(), buffers: all.to_vec(), capacity })
    }

    fn once(&mut self, batch: &Batch, limit: std::time::Duration) -> Result<Actual, Failure> {
        let marks = Marks { sentinel: self.away.job.sentinel, ..Marks::random() };
        let count = batch.invocation_count();
        let contents: Vec<Vec<u32>> = self
            .buffers
            .iter()
            .map(|about| {
                let mut words = vec![0; buffers::words(about) * count];
                for (k, own) in words.chunks_exact_mut(buffers::words(about)).enumerate() {
                    buffers::before(about, batch, k, marks.sentinel, own);
                }
                words
            })
            .collect();
        let inputs: Vec<&[u32]> = contents.iter().map(Vec::as_slice).collect();
        let found = self.away.run(batch, &inputs, marks, limit)?;
        let (size, header, read) = (self.layout.words(), self.layout.header_words(), self.away.job.record);
        if found.len() != read * count {
            let message = format!("{} words came back of {count} dispatches", found.len());
            return Err(Failure::Message(LaneError::Api(message)));
        }
        let mut words = vec![marks.sentinel; size * count];
        for (k, (record, mut found)) in words.chunks_exact_mut(size).zip(found.chunks_exact(read.max(1))).enumerate() {
            // A dispatch that came back has run: its buffers hold what it left there.
            record[0] = marks.canary ^ k as u32;
            for about in self.buffers.iter().filter(|about| !about.after.is_empty()) {
                let (own, rest) = found.split_at(buffers::words(about));
                buffers::after(about, own, marks.sentinel, &mut record[header..]).map_err(Failure::Message)?;
                found = rest;
            }
        }
        Actual::accept(&self.layout, words, count, marks).map_err(Failure::Message)
    }

    /// The dispatch of a batch that takes the process along by itself.
    fn culprit(&mut self, batch: &Batch, count: usize) -> Result<Option<(Loss, usize)>, LaneError> {
        for at in 0..count {
            match self.once(&batch.apart(at..at + 1), FEW) {
                Ok(_) => {}
                Err(Failure::Lost(loss)) => return Ok(Some((loss, at))),
                Err(Failure::Message(error)) => return Err(error),
            }
        }
        Ok(None)
    }
}

impl Runner for DispatchRunner {
    fn capacity(&self) -> usize {
        self.capacity
    }

    fn run(&mut self, batch: &Batch) -> Result<Actual, LaneError> {
        let count = self.count_of(batch, "dispatches")?;
        let first = match self.once(batch, BATCH) {
            Ok(actual) => return Ok(actual),
            Err(Failure::Message(error)) => return Err(error),
            Err(Failure::Lost(loss)) => loss,
        };
        match self.culprit(batch, count)? {
            Some((loss, at)) => Err(with_inputs(loss.error(Some(at), count, ""), batch)),
            None => Err(first.error(None, count, "and did not when each dispatch ran by itself")),
        }
    }
}
