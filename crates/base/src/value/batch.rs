//! Records of words and batches of cases.

use std::ops::Range;
use std::sync::Arc;

use super::{Scalar, Shape};

/// A named value in a record.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Field {
    /// Name in the shader, such as `mc`.
    pub name: String,
    /// Shape of the value.
    pub shape: Shape,
}

/// The words of several named values side by side, without padding.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Record {
    fields: Vec<Field>,
    offsets: Vec<usize>,
    words: usize,
}

impl Record {
    /// A record of these fields, in this order.
    pub fn new(fields: Vec<Field>) -> Self {
        let mut words = 0;
        let offsets = fields
            .iter()
            .map(|field| {
                let at = words;
                words += field.shape.words();
                at
            })
            .collect();
        Self { fields, offsets, words }
    }

    /// The fields in order.
    pub fn fields(&self) -> &[Field] {
        &self.fields
    }

    /// Words of the whole record.
    pub fn words(&self) -> usize {
        self.words
    }

    /// Index of a field.
    pub fn index_of(&self, name: &str) -> Option<usize> {
        self.fields.iter().position(|f| f.name == name)
    }

    /// Words `from..to` of the field with this index.
    pub fn range(&self, index: usize) -> Range<usize> {
        let at = self.offsets[index];
        at..at + self.fields[index].shape.words()
    }

    /// Type of one word.
    pub fn scalar_of(&self, word: usize) -> Scalar {
        self.fields[self.offsets.partition_point(|&at| at <= word) - 1].shape.scalar
    }

    /// Name of one word: `gl_Position.y`, `mc[3][0]`.
    pub fn word_name(&self, word: usize) -> String {
        let index = self.offsets.partition_point(|&at| at <= word) - 1;
        let field = &self.fields[index];
        format!("{}{}", field.name, field.shape.component_name(word - self.offsets[index]))
    }
}

/// Inputs of many cases. A case is one set of uniforms with its invocations: the vertices of a
/// vertex stage, the primitives of a geometry stage, the calls of a function. All cases of a batch
/// have the same number of invocations.
#[derive(Clone, Debug)]
pub struct Batch {
    /// What one invocation gets: attributes, the inputs of a primitive, or arguments.
    pub invocation_record: Arc<Record>,
    /// What one case gets: the uniforms.
    pub case_record: Arc<Record>,
    /// Invocations of one case; at least 1.
    pub per_case: usize,
    /// Words of all invocations, one record after the other.
    pub invocations: Vec<u32>,
    /// Words of all cases, one record after the other.
    pub cases: Vec<u32>,
}

impl Batch {
    /// An empty batch with room for `cases` cases.
    pub fn with_capacity(invocation: Arc<Record>, case: Arc<Record>, per_case: usize, cases: usize) -> Self {
        let per_case = per_case.max(1);
        Self {
            invocations: Vec::with_capacity(invocation.words() * per_case * cases),
            cases: Vec::with_capacity(case.words() * cases),
            invocation_record: invocation,
            case_record: case,
            per_case,
        }
    }

    /// Number of invocations of all cases, given the number of cases. A record without words still
    /// has invocations, so the count cannot be read off the columns alone.
    pub fn invocation_count(&self) -> usize {
        match (self.invocation_record.words(), self.case_record.words()) {
            (0, 0) => self.per_case,
            (0, words) => self.cases.len() / words * self.per_case,
            (words, _) => self.invocations.len() / words,
        }
    }

    /// Number of cases.
    pub fn case_count(&self) -> usize {
        self.invocation_count() / self.per_case
    }

    /// Words of one invocation.
    pub fn invocation(&self, index: usize) -> &[u32] {
        let words = self.invocation_record.words();
        &self.invocations[index * words..][..words]
    }

    /// Words of the uniforms of a case.
    pub fn case(&self, index: usize) -> &[u32] {
        let words = self.case_record.words();
        &self.cases[index * words..][..words]
    }

    /// Words of the uniforms that an invocation sees.
    pub fn case_of(&self, invocation: usize) -> &[u32] {
        self.case(invocation / self.per_case)
    }

    /// Some of its invocations in this order, each a case of its own.
    #[must_use]
    pub fn apart(&self, invocations: impl ExactSizeIterator<Item = usize>) -> Self {
        let (invocation, case) = (self.invocation_record.clone(), self.case_record.clone());
        let mut apart = Self::with_capacity(invocation, case, 1, invocations.len());
        for at in invocations {
            apart.invocations.extend_from_slice(self.invocation(at));
            apart.cases.extend_from_slice(self.case_of(at));
        }
        apart
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_named_by_field_and_component() {
        let field = |name: &str, shape| Field { name: name.into(), shape };
        let record = Record::new(vec![field("gl_Position", Shape::VEC4), field("mc", Shape::MAT4)]);
        assert_eq!(record.words(), 20);
        assert_eq!(record.word_name(1), "gl_Position.y");
        assert_eq!(record.word_name(4 + 12), "mc[3][0]");
        assert_eq!(record.range(1), 4..20);
    }
}
