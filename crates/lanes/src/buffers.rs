//! The buffers of a whole dispatch as words: what they hold before and behind it, and the canary behind each of them.

use crate::LaneError;
use base::value::Batch;
use program::{BoundBuffer, Program};

/// Words behind a buffer that nobody may write.
pub const BEHIND: usize = 64;

/// Words of a buffer with its canary.
pub fn words(about: &BoundBuffer) -> usize {
    about.bytes as usize / 4 + BEHIND
}

/// What a buffer holds before a dispatch of a batch. What nothing feeds, and what lies behind it, holds the sentinel.
pub fn before(about: &BoundBuffer, batch: &Batch, dispatch: usize, sentinel: u32, words: &mut [u32]) {
    words.fill(sentinel);
    let record = if about.uniform { batch.case_of(dispatch) } else { batch.invocation(dispatch) };
    for place in &about.before {
        words[place.byte as usize / 4] = record[place.word as usize];
    }
}

/// Takes what a buffer holds behind a dispatch into the words of its output record.
///
/// # Errors
/// [`LaneError::Api`] where something was written behind the buffer.
pub fn after(about: &BoundBuffer, words: &[u32], sentinel: u32, record: &mut [u32]) -> Result<(), LaneError> {
    for place in &about.after {
        record[place.word as usize] = words[place.byte as usize / 4];
    }
    match words[about.bytes as usize / 4..].iter().position(|&word| word != sentinel) {
        Some(at) => Err(LaneError::Api(format!(
            "the dispatch wrote {} bytes behind the end of the buffer at binding {} of group {}, which has {} bytes",
            4 * at,
            about.binding,
            about.group,
            about.bytes
        ))),
        None => Ok(()),
    }
}

/// The name of the block of GLSL that a buffer is; empty for one that is no block.
pub fn block<'p>(program: &'p Program, about: &BoundBuffer) -> &'p str {
    let at = |v: &&naga::GlobalVariable| {
        v.binding.as_ref().is_some_and(|at| (at.group, at.binding) == (about.group, about.binding))
    };
    let variable = program.module.global_variables.iter().map(|(_, variable)| variable).find(at);
    let name = variable.and_then(|v| program.module.types[v.ty].name.as_deref()).unwrap_or_default();
    // The type of a block with atomic members has a name of its own.
    name.strip_suffix("_atomic").unwrap_or(name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use base::value::{Field, Record, Shape};
    use program::UniformPlace;

    #[test]
    fn a_write_behind_a_buffer_is_an_error() {
        let about = BoundBuffer {
            group: 0,
            binding: 2,
            bytes: 16,
            uniform: false,
            writable: true,
            before: vec![UniformPlace { word: 1, byte: 4 }],
            after: vec![UniformPlace { word: 0, byte: 4 }],
        };
        let record = Record::new(vec![Field { name: "x".into(), shape: Shape::VEC2 }]);
        let batch = Batch {
            invocation_record: record.into(),
            case_record: Record::new(Vec::new()).into(),
            per_case: 1,
            invocations: vec![5, 6],
            cases: Vec::new(),
        };
        let mut content = vec![0; words(&about)];
        before(&about, &batch, 0, 9, &mut content);
        assert_eq!(content[..4], [9, 6, 9, 9]);
        let mut output = [0];
        after(&about, &content, 9, &mut output).unwrap();
        assert_eq!(output, [6]);
        content[5] = 1;
        let error = after(&about, &content, 9, &mut output).unwrap_err().to_string();
        assert!(error.contains("wrote 4 bytes behind the end of the buffer at binding 2"), "{error}");
    }
}
