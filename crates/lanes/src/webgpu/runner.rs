//! A kernel on a device of Dawn.

use std::time::Duration;

use naga::back::wgsl;

use super::messages::{Bound, Input, Job, Limits};
use super::remote::{Away, BATCH, FEW, Failure, Remote};
use crate::worker::{Loss, with_inputs};
use crate::{Actual, LaneError, Marks, Runner};
use base::value::Batch;
use program::texture::{Dimension, Texel, Texture};
use program::{ENTRY_POINT, Form, Kernel, OutputLayout, WORKGROUP, binding, contain, uniform_blocks};

/// Most invocations of a batch that has a dispatch for each.
const DISPATCHES: u64 = 4096;
/// Invocations among which the one that takes the process along is looked for one by one.
const FEW_INVOCATIONS: usize = 256;

pub struct WgslRunner {
    away: Away,
    layout: OutputLayout,
    capacity: usize,
}

pub(super) fn unsupported(what: impl Into<String>) -> LaneError {
    LaneError::Unsupported(what.into())
}

impl WgslRunner {
    pub fn new(remote: &Remote, kernel: &Kernel, capacity: usize) -> Result<Self, LaneError> {
        let sentinel = Marks::random().sentinel;
        let (job, texels) = job(kernel, capacity, &remote.adapter.limits, sentinel)?;
        let capacity = job.capacity;
        Ok(Self { away: remote.prepare(job, texels)?, layout: kernel.output.clone(), capacity })
    }

    /// The words of the inputs of a batch, in the order of the job.
    fn inputs<'b>(&self, batch: &'b Batch, blocks: &'b mut Vec<u32>) -> Vec<&'b [u32]> {
        let stride = self.away.job.stride;
        if stride > 0 {
            *blocks = uniform_blocks(batch, stride);
            return vec![blocks];
        }
        let one = |input: &Input| match input.binding {
            binding::INVOCATIONS => &batch.invocations[..],
            _ => &batch.cases[..],
        };
        self.away.job.inputs.iter().map(one).collect()
    }

    fn once(&mut self, batch: &Batch, limit: Duration) -> Result<Actual, Failure> {
        let marks = Marks { sentinel: self.away.job.sentinel, ..Marks::random() };
        let mut blocks = Vec::new();
        let inputs = self.inputs(batch, &mut blocks);
        let words = self.away.run(batch, &inputs, marks, limit)?;
        Actual::accept(&self.layout, words, batch.invocation_count(), marks).map_err(Failure::Message)
    }

    /// The invocation of a batch that takes the process along by itself: looked for in parts, then one by one.
    fn culprit(&mut self, batch: &Batch, count: usize) -> Result<Option<(Loss, usize)>, LaneError> {
        let mut lost = |from: usize, to: usize| match self.once(&batch.apart(from..to), FEW) {
            Ok(_) | Err(Failure::Message(LaneError::NotWritten { .. })) => Ok(None),
            Err(Failure::Lost(loss)) => Ok(Some(loss)),
            Err(Failure::Message(error)) => Err(error),
        };
        for from in (0..count).step_by(FEW_INVOCATIONS) {
            let to = (from + FEW_INVOCATIONS).min(count);
            if lost(from, to)?.is_none() {
                continue;
            }
            for at in from..to {
                if let Some(loss) = lost(at, at + 1)? {
                    return Ok(Some((loss, at)));
                }
            }
        }
        Ok(None)
    }
}

impl Runner for WgslRunner {
    fn capacity(&self) -> usize {
        self.capacity
    }

    fn run(&mut self, batch: &Batch) -> Result<Actual, LaneError> {
        let count = self.count_of(batch, "invocations")?;
        let first = match self.once(batch, BATCH) {
            Ok(actual) => return Ok(actual),
            Err(Failure::Message(error)) => return Err(error),
            Err(Failure::Lost(loss)) => loss,
        };
        // Once more in small parts, in a new process: the one that does it by itself is named.
        match self.culprit(batch, count) {
            Ok(Some((loss, at))) => Err(with_inputs(loss.error(Some(at), count, ""), batch)),
            Ok(None) => Err(first.error(None, count, "and did not when its parts ran by themselves")),
            Err(error) => Err(error),
        }
    }
}

/// What the script needs to know of a kernel, with the texels of its textures.
fn job(kernel: &Kernel, capacity: usize, limits: &Limits, sentinel: u32) -> Result<(Job, Vec<u32>), LaneError> {
    let code = code(kernel)?;
    let (invocation, case, record) = (kernel.invocation.words(), kernel.case.words(), kernel.output.words());
    let storage = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size) / 4;
    let mut fit = (storage / record.max(invocation).max(case).max(1) as u64)
        .min(limits.max_compute_workgroups_per_dimension * u64::from(WORKGROUP));
    let mut stride = 0;
    let mut inputs = Vec::new();
    if matches!(kernel.form, Form::Uniforms) {
        let words = (1 + invocation + case).next_multiple_of(4);
        let most = limits.max_uniform_buffer_binding_size;
        if 4 * words as u64 > most {
            return Err(unsupported(format!("{} bytes of inputs in a uniform buffer; {most} fit", 4 * words)));
        }
        stride = words.next_multiple_of((limits.min_uniform_buffer_offset_alignment as usize / 4).max(1));
        fit = fit.min(limits.max_buffer_size / (4 * stride) as u64).min(DISPATCHES);
        inputs.push(Input { binding: binding::BLOCK, words, dynamic: true });
    } else {
        // A kernel has no binding for a buffer that it never reads.
        let all = [(binding::INVOCATIONS, invocation), (binding::CASES, case)];
        let read = all.into_iter().filter(|&(_, words)| words > 0);
        inputs.extend(read.map(|(binding, words)| Input { binding, words, dynamic: false }));
    }
    let mut texels = Vec::new();
    let textures = kernel.program.textures.iter().map(|texture| bound(kernel, texture, &mut texels));
    let job = Job {
        id: 0,
        code,
        entry: ENTRY_POINT.to_owned(),
        capacity: (capacity as u64).min(fit).max(1) as usize,
        workgroup: WORKGROUP,
        record,
        sentinel,
        stride,
        inputs,
        textures: textures.collect::<Result<_, _>>()?,
        dispatch: None,
    };
    Ok((job, texels))
}

/// The text of a kernel.
fn code(kernel: &Kernel) -> Result<String, LaneError> {
    let wide = |ty: &naga::Type| match ty.inner {
        naga::TypeInner::Scalar(scalar)
        | naga::TypeInner::Vector { scalar, .. }
        | naga::TypeInner::Matrix { scalar, .. } => scalar.width == 8,
        _ => false,
    };
    if kernel.module.types.iter().any(|(_, ty)| wide(ty)) {
        return Err(unsupported("numbers of 64 bits; WGSL has none"));
    }
    // Tint reads what the author wrote where it can.
    if let (Form::Compute, Some(text)) = (&kernel.form, kernel.program.author_kernel()) {
        return Ok(text);
    }
    let written = contain(|| wgsl::write_string(&kernel.module, &kernel.info, wgsl::WriterFlags::empty()));
    let written = written.map_err(|panic| unsupported(format!("naga writes no WGSL of it: {panic}")))?;
    written.map_err(|error| unsupported(format!("WGSL cannot express this shader: {error}")))
}

/// A texture of a kernel; its texels go to the end of `texels`.
fn bound(kernel: &Kernel, texture: &Texture, texels: &mut Vec<u32>) -> Result<Bound, LaneError> {
    let at = |handle| binding::of(&kernel.module, handle).ok_or_else(LaneError::unbound);
    let (dimension, view) = match (texture.kind.dimension, texture.kind.arrayed) {
        (Dimension::D1, false) => ("1d", "1d"),
        (Dimension::D2, false) => ("2d", "2d"),
        (Dimension::D2, true) => ("2d", "2d-array"),
        (Dimension::D3, false) => ("3d", "3d"),
        (Dimension::Cube, false) => ("2d", "cube"),
        (Dimension::Cube, true) => ("2d", "cube-array"),
        (Dimension::D1 | Dimension::D3, true) => return Err(unsupported(format!("layers of `{}`", texture.name))),
    };
    let texel = match texture.kind.texel {
        Texel::Float => "float",
        Texel::Int => "sint",
        Texel::Uint => "uint",
        Texel::Depth => "depth",
    };
    match texture.kind.texel {
        Texel::Float | Texel::Int | Texel::Uint => texels.extend_from_slice(texture.contents.words()),
        Texel::Depth => texels.extend(texture.contents.depths().into_iter().map(u32::from)),
    }
    Ok(Bound {
        image: at(texture.image)?,
        sampler: texture.sampler.map(at).transpose()?,
        dimension: dimension.to_owned(),
        view: view.to_owned(),
        texel: texel.to_owned(),
        size: texture.contents.size(),
    })
}
