//! The same comparison with one block of both sides in memory: for rows that come in the order of the samples.

use thiserror::Error;

use super::order::Order;
use super::outputs::Outputs;
use super::{Element, Finding, Judge, Report, Rule, VerifyError};
use crate::bytes::Bytes;
use crate::document::Document;
use crate::read::{Dataset, ReadError, Sequence, Windows};

/// Why a comparison ended.
#[derive(Debug, Error)]
pub enum StreamError {
    /// The reference cannot be read.
    #[error("{0}")]
    Reference(ReadError),
    /// The outputs cannot be read.
    #[error("{0}")]
    Actual(ReadError),
    /// There is nothing to compare.
    #[error("{0}")]
    Verify(VerifyError),
}

/// Rows that are looked at together behind the last sample.
const REST: usize = 1 << 16;

/// Compares outputs with a reference block by block. Nothing is found where rows are not in the order of the
/// samples, or something is wrong with the columns: [`verify`](super::verify) tells it then, and `each` has seen
/// elements in vain.
///
/// # Errors
/// [`StreamError`] when a side cannot be read, or there is nothing to compare.
pub fn stream(
    blocks: &mut dyn Sequence,
    actual: &mut dyn Windows,
    rule: Rule,
    each: &mut dyn FnMut(&Element),
) -> Result<Option<Report>, StreamError> {
    let document = blocks.document().clone();
    let mut judge = Judge::new(&document, rule).map_err(StreamError::Verify)?;
    let (mut by, mut rows, mut missing) = ("place", 0_u64, (0_u64, 0_u64));
    while let Some(block) = blocks.next().map_err(StreamError::Reference)? {
        let window = actual.next(block.rows).map_err(StreamError::Actual)?;
        let part = Document { first: block.first, rows: block.rows as u64, ..document.clone() };
        let part = Dataset { document: part, arrays: block.arrays.into_iter().map(Bytes::into_vec).collect() };
        let Ok(outputs) = Outputs::find(&part.document, &window) else { return Ok(None) };
        let Ok(order) = Order::find(&part, &window, outputs.rows) else { return Ok(None) };
        let in_place = |(k, row): (usize, &Option<usize>)| *row == (k < outputs.rows).then_some(k);
        if !order.rows.iter().enumerate().all(in_place) {
            return Ok(None);
        }
        judge.look((&part, &window), &outputs, 0..block.rows, &order.rows, each);
        by = order.by;
        rows += outputs.rows as u64;
        let open = (block.rows - outputs.rows) as u64;
        if missing.0 == 0 {
            missing.1 = block.first + outputs.rows as u64;
        }
        missing.0 += open;
    }
    let mut extra = 0;
    loop {
        let window = actual.next(REST).map_err(StreamError::Actual)?;
        let Ok(outputs) = Outputs::find(&document, &window) else { return Ok(None) };
        if outputs.rows == 0 {
            break;
        }
        extra += outputs.rows as u64;
    }
    // Whose rows these are has to be looked for.
    if extra > 0 && by != "place" {
        return Ok(None);
    }
    let findings = [
        (missing.0 > 0).then_some(Finding::MissingSamples(missing.0, missing.1)),
        (extra > 0).then_some(Finding::ExtraRows(extra, rows)),
    ];
    Ok(Some(judge.report(by, rows + extra, findings.into_iter().flatten().collect())))
}
