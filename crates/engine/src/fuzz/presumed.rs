//! Inputs that names say to be in [0, 1], colours and shares of light, and those of which callers say more: what goes wrong
//! beyond is what nobody asked for.

use super::domain::{Domain, InputDomain, Interval, Law};
use super::subject::Ready;
use base::value::{Field, Record, Scalar};

/// What an input is taken for that is in [0, 1] in every program.
const COLOUR: &str = "a colour";

/// Words in names of shares that are in [0, 1] in every program.
const SHARES: [&str; 11] = [
    "alpha",
    "opacity",
    "transparency",
    "roughness",
    "metallic",
    "metalness",
    "ao",
    "occlusion",
    "reflectance",
    "weight",
    "weights",
];

const UNIT: Interval = Interval { low: 0.0, high: 1.0, open_low: false, open_high: false };

/// The domain for inputs that nobody stated, and the names of those that are in [0, 1] there by their names.
pub fn presumed(ready: &Ready, domain: &Domain) -> (Domain, Vec<String>) {
    let mut taken = ready.realistic.taken_for(domain).into_iter().zip(ready.realistic.passed());
    let mut names = Vec::new();
    let mut side = |fields: &[Field], inputs: &[InputDomain]| -> Vec<InputDomain> {
        let of = |(field, input): (&Field, &InputDomain)| {
            let (taken, passed) = taken.next().unwrap_or_default();
            if input.is_stated() {
                return input.clone();
            }
            if let Some([low, high]) = passed {
                return InputDomain {
                    laws: vec![Law::Within(Interval { low, high, open_low: false, open_high: false })],
                };
            }
            if !is_unit(field, taken) {
                return input.clone();
            }
            names.push(field.name.clone());
            InputDomain { laws: vec![Law::Within(UNIT)] }
        };
        fields.iter().zip(inputs).map(of).collect()
    };
    let invocation = side(ready.kernel.invocation.fields(), &domain.invocation);
    let case = side(ready.kernel.case.fields(), &domain.case);
    (Domain { invocation, case }, names)
}

fn is_unit(field: &Field, taken: Option<&str>) -> bool {
    let plain = field.shape.scalar == Scalar::F32 && field.shape.columns == 1;
    plain && (taken == Some(COLOUR) || is_share(&field.name))
}

/// True for a name that says a share, which is in [0, 1] in every program.
pub fn is_share(name: &str) -> bool {
    syntax::words::words(name).iter().any(|word| SHARES.contains(&word.as_str()))
}

/// Each input with its laws.
pub fn described(ready: &Ready, domain: &Domain) -> Vec<(String, Vec<Law>)> {
    let side = |record: &Record, inputs: &[InputDomain]| -> Vec<(String, Vec<Law>)> {
        let all = record.fields().iter().zip(inputs);
        all.map(|(field, input)| (format!("{} {}", field.shape, field.name), input.laws.clone())).collect()
    };
    [side(&ready.kernel.invocation, &domain.invocation), side(&ready.kernel.case, &domain.case)].concat()
}
