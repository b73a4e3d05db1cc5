//! Inputs of a sample, as reports show them.

use serde::{Deserialize, Serialize};

use base::value::Shape;
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
        if let Some(few) = self.few() {
            return few;
        }
        let rest = self.decimal.len().saturating_sub(SHOWN);
        let shown = self.decimal[..self.decimal.len() - rest].join(", ");
        if rest == 0 { shown } else { format!("{shown}, … ({rest} more)") }
    }

    /// Of a long array that was shrunk, the few elements that are not zero: `[61] = 1.0, others 0`.
    pub fn few(&self) -> Option<String> {
        let shape: Shape = self.name.split(' ').next()?.parse().ok()?;
        shape.array.filter(|_| self.bits.len() > SHOWN)?;
        let others: Vec<usize> = (0..self.bits.len()).filter(|&k| self.bits[k] != 0).collect();
        if others.len() > SHOWN / 2 {
            return None;
        }
        let each = usize::from(shape.columns) * usize::from(shape.rows);
        let place = |k: usize| match each {
            1 => format!("[{k}]"),
            2..=4 if shape.columns == 1 => format!("[{}].{}", k / each, ["x", "y", "z", "w"][k % each]),
            _ => format!("[{}] word {}", k / each, k % each),
        };
        let listed: Vec<String> = others.iter().map(|&k| format!("{} = {}", place(k), self.decimal[k])).collect();
        Some(if listed.is_empty() { "all 0".to_owned() } else { format!("{}, others 0", listed.join(", ")) })
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
    fn of_a_long_array_few_elements_are_shown() {
        let input = |name: &str, set: &[usize], len: usize| InputValue {
            name: name.to_owned(),
            declared: String::new(),
            bits: (0..len).map(|k| u32::from(set.contains(&k))).collect(),
            decimal: (0..len).map(|k| u32::from(set.contains(&k)).to_string()).collect(),
        };
        assert_eq!(input("int[40] a", &[3, 39], 40).values(), "[3] = 1, [39] = 1, others 0");
        assert_eq!(input("vec4[10] a", &[6], 40).few().unwrap(), "[1].z = 1, others 0");
        assert_eq!(input("int[40] a", &[], 40).values(), "all 0");
        let most: Vec<usize> = (0..9).collect();
        assert_eq!(input("int[40] a", &most, 40).few(), None);
        assert_eq!(input("int[4] a", &[1], 4).values(), "0, 1, 0, 0");
    }

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
