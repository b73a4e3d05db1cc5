//! Inputs as an expectation sees them.

use property::Sample;

/// The inputs of one run of a shader, as numbers: exactly what the shader got.
#[derive(Clone, Copy, Debug)]
pub struct Inputs<'a> {
    pub(crate) sample: &'a Sample,
}

impl Inputs<'_> {
    /// The components of an input: matrices column by column, elements of arrays one after the other,
    /// `true` as 1.
    ///
    /// # Panics
    /// When the shader has no such input.
    #[track_caller]
    pub fn get(&self, name: &str) -> Vec<f64> {
        let values = self.sample.get(name);
        assert!(!values.is_empty(), "the shader has no input `{name}`; it has {}", self.names().join(", "));
        values
    }

    /// An input that is one number.
    ///
    /// # Panics
    /// When the shader has no such input, or it has several components.
    #[track_caller]
    pub fn number(&self, name: &str) -> f64 {
        let [value] = self.array(name);
        value
    }

    /// An input of `N` components.
    ///
    /// # Panics
    /// When the shader has no such input, or it has another number of components.
    #[track_caller]
    pub fn array<const N: usize>(&self, name: &str) -> [f64; N] {
        let values = self.get(name);
        let count = values.len();
        values.try_into().unwrap_or_else(|_| panic!("the input `{name}` has {count} components, not {N}"))
    }

    fn names(&self) -> Vec<String> {
        let records = [&self.sample.invocation_record, &self.sample.case_record];
        records.iter().flat_map(|record| record.fields()).map(|field| format!("`{}`", field.name)).collect()
    }
}
