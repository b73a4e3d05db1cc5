//! Numbers of the table, and what a device may give for them.

use base::value::Scalar;

use super::Corner;

/// Values that are right for a case.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// Whatever comes is right.
    Any,
    /// One of these words, and of floats no other than these: zeros of both signs are one.
    OneOf(Vec<u32>),
    /// Something near one of these numbers.
    Near(Vec<f64>),
}

/// Arguments, with what is right for them.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// Words of the arguments.
    pub arguments: Vec<u32>,
    /// The right values for these arguments.
    pub values: Values,
}

impl Case {
    /// Reads `1 0.5 = 2 | 3`: arguments, and the values that are right; `~ 2 | 3` for near them, and `any`. The first of the
    /// types is that of the value.
    ///
    /// # Errors
    /// What cannot be read.
    pub fn read(text: &str, types: &[(Scalar, usize)]) -> Result<Self, String> {
        let (arguments, values) = text.split_once(['=', '~']).ok_or("there is no `=` and no `~`")?;
        let scalars: Vec<Scalar> = types[1..].iter().flat_map(|&(scalar, count)| vec![scalar; count]).collect();
        let tokens: Vec<&str> = arguments.split_whitespace().collect();
        if tokens.len() != scalars.len() {
            return Err(format!("{} arguments instead of {}", tokens.len(), scalars.len()));
        }
        let arguments = tokens.iter().zip(scalars).map(|(token, scalar)| word(token, scalar));
        let arguments: Vec<u32> = arguments.collect::<Result<_, _>>()?;
        let result = types[0].0;
        let words = values.split('|').map(|value| word(value.trim(), result));
        let values = match values.trim() {
            "any" => Values::Any,
            _ if text.contains('~') => {
                let float = |word: u32| f64::from(f32::from_bits(word));
                Values::Near(words.map(|word| word.map(float)).collect::<Result<_, _>>()?)
            }
            _ => Values::OneOf(words.collect::<Result<_, _>>()?),
        };
        Ok(Self { arguments, values })
    }

    /// NaN, or infinities, in the place of each argument of binary32, beside ones.
    pub(super) fn open(corner: Corner, types: &[(Scalar, usize)]) -> Vec<Self> {
        let special: &[f32] = match corner {
            Corner::NotANumber => &[f32::NAN],
            _ => &[f32::INFINITY, f32::NEG_INFINITY],
        };
        let mut all = Vec::new();
        for at in (1..types.len()).filter(|&at| types[at].0 == Scalar::F32) {
            for &value in special {
                let word = |k: usize, scalar: Scalar| match scalar {
                    Scalar::F32 if k == at => value.to_bits(),
                    Scalar::F32 => 1_f32.to_bits(),
                    Scalar::I32 | Scalar::U32 | Scalar::Bool => 1,
                };
                let words = |(k, &(scalar, count)): (usize, &(Scalar, usize))| vec![word(k, scalar); count];
                let arguments = types.iter().enumerate().skip(1).flat_map(words).collect();
                all.push(Self { arguments, values: Values::Any });
            }
        }
        all
    }

    /// True where a device may give a word.
    pub fn allows(&self, word: u32, scalar: Scalar) -> bool {
        let value = f64::from(f32::from_bits(word));
        match &self.values {
            Values::Any => true,
            Values::OneOf(words) if scalar == Scalar::F32 => {
                words.iter().any(|right| *right == word || f64::from(f32::from_bits(*right)) == value)
            }
            Values::OneOf(words) => words.contains(&word),
            Values::Near(numbers) => numbers.iter().any(|right| (value - right).abs() <= near(*right)),
        }
    }

    /// Words that a device may give, and words that it may not.
    pub fn samples(&self, scalar: Scalar) -> (Vec<u32>, Vec<u32>) {
        let float = |number: f64| (number as f32).to_bits();
        match &self.values {
            Values::Any if scalar == Scalar::Bool => (vec![0, 1], Vec::new()),
            Values::Any => (vec![0, 1_f32.to_bits(), 0x3eaa_aaab, 0x7fc0_0000, 0xffff_ffff], Vec::new()),
            Values::Near(numbers) => {
                let far = |number: &f64| [number + 0.25 + number.abs() / 4.0, number - 0.25 - number.abs() / 4.0];
                (numbers.iter().copied().map(float).collect(), numbers.iter().flat_map(far).map(float).collect())
            }
            Values::OneOf(words) if scalar == Scalar::F32 => {
                // A neighbour is within what is lost where sums may be regrouped.
                let beside = |&word: &u32| {
                    let value = f32::from_bits(word);
                    let few = 16.0 * (value.abs().next_up() - value.abs());
                    // Between two values that are both right all may be.
                    let near: &[f32] = if words.len() > 1 { &[] } else { &[value + few, value - few] };
                    [near, &[value + 1.0 + value.abs() / 2.0, -0.25 * value - 1.0]].concat()
                };
                // Beside 0 all numbers are subnormal: as good as 0.
                let told = |value: &f32| value.is_normal() && value.is_finite();
                let wrong = words.iter().flat_map(beside).filter(told).map(f32::to_bits);
                (words.clone(), wrong.filter(|&wrong| !self.allows(wrong, scalar)).collect())
            }
            Values::OneOf(words) if scalar == Scalar::Bool => {
                (words.clone(), (0..2).filter(|word| !words.contains(word)).collect())
            }
            Values::OneOf(words) => {
                let beside = |&word: &u32| [word.wrapping_add(1), word.wrapping_sub(1), word ^ 0x0100_0000];
                let wrong = words.iter().flat_map(beside).filter(|wrong| !words.contains(wrong));
                (words.clone(), wrong.collect())
            }
        }
    }
}

/// How far from a number what is near it may lie.
fn near(number: f64) -> f64 {
    2e-3 + 2e-3 * number.abs()
}

fn word(token: &str, scalar: Scalar) -> Result<u32, String> {
    let bad = || format!("`{token}` is no number of the type");
    if let Some(bits) = token.strip_prefix("0x") {
        return u32::from_str_radix(bits, 16).map_err(|_| bad());
    }
    Ok(match (scalar, token) {
        (Scalar::F32, "max") => f32::MAX.to_bits(),
        (Scalar::F32, "-max") => f32::MIN.to_bits(),
        (Scalar::F32, _) => token.parse::<f32>().map_err(|_| bad())?.to_bits(),
        (Scalar::Bool, "true") => 1,
        (Scalar::Bool, "false") => 0,
        (Scalar::I32, "max") => i32::MAX as u32,
        (Scalar::I32, "min") => i32::MIN as u32,
        (Scalar::U32, "max") => u32::MAX,
        (Scalar::I32, _) => token.parse::<i32>().map_err(|_| bad())? as u32,
        (Scalar::U32, _) => token.parse::<u32>().map_err(|_| bad())?,
        (Scalar::Bool, _) => return Err(bad()),
    })
}
