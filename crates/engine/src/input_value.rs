//! Inputs of a sample, as reports show them.

use serde::{Deserialize, Serialize};

use program::Program;
use property::{Sample, regressions};

/// Values of an input that are shown; a command has all of them.
const SHOWN: usize = 16;

/// One input of a case.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct InputValue {
    /// Name, with the type before it as GLSL writes it, whatever the text is written in.
    pub name: String,
    /// The same as the author's language declares it: `vec3 x`, `x: vec3f`.
    #[serde(default)]
    pub declared: String,
    /// The words.
    pub bits: Vec<u32>,
    /// The values in decimal, in the order of the words.
    pub decimal: Vec<String>,
}

impl InputValue {
    /// The inputs of a sample, uniforms last, as they are declared in the text of a program.
    pub fn all(sample: &Sample, program: &Program) -> Vec<Self> {
        let mut inputs = Vec::new();
        for (record, words) in [(&sample.invocation_record, &sample.invocation), (&sample.case_record, &sample.case)] {
            for (k, field) in record.fields().iter().enumerate() {
                let bits = words[record.range(k)].to_vec();
                let decimal = bits.iter().map(|&w| regressions::decimal(w, field.shape.scalar)).collect();
                let name = format!("{} {}", field.shape, field.name);
                inputs.push(Self { name, declared: program.declaration(field), bits, decimal });
            }
        }
        inputs
    }

    /// How reports name it.
    pub fn shown(&self) -> &str {
        // What an older version wrote has only the name.
        if self.declared.is_empty() { &self.name } else { &self.declared }
    }

    /// Its values, of which a long one has the first few and the number of the others; an identity matrix is called so.
    pub fn values(&self) -> String {
        if self.is_identity() {
            return "identity".to_owned();
        }
        let rest = self.decimal.len().saturating_sub(SHOWN);
        let shown = self.decimal[..self.decimal.len() - rest].join(", ");
        if rest == 0 { shown } else { format!("{shown}, … ({rest} more)") }
    }

    /// The name without its type.
    pub fn plain_name(&self) -> &str {
        self.name.rsplit(' ').next().unwrap_or(&self.name)
    }

    /// True for the words of an identity matrix.
    pub fn is_identity(&self) -> bool {
        let size = match self.bits.len() {
            4 => 2,
            9 => 3,
            16 => 4,
            _ => return false,
        };
        let one = |k: usize| if k.is_multiple_of(size + 1) { 1.0_f32.to_bits() } else { 0 };
        self.name.starts_with("mat") && self.bits.iter().enumerate().all(|(k, &b)| b == one(k))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_identity_is_called_so() {
        let one = 1.0_f32.to_bits();
        let bits: Vec<u32> = (0..16).map(|k| if k % 5 == 0 { one } else { 0 }).collect();
        let input = |name: &str, bits: &[u32]| InputValue {
            name: name.to_owned(),
            declared: String::new(),
            bits: bits.to_vec(),
            decimal: Vec::new(),
        };
        assert!(input("mat4 mc", &bits).is_identity());
        assert!(!input("float[16] w", &bits).is_identity());
        // -0 is another word than 0.
        let mut signed = bits;
        signed[1] = 0x8000_0000;
        assert!(!input("mat4 mc", &signed).is_identity());
    }
}
