//! Reports of `compare`.

mod ci;
mod json;
mod text;
mod twins;

use engine::compare::{Compared, Unpaired};

pub use ci::{ci, twins as twins_ci};
pub use json::json;
pub use text::text;
pub use twins::{TwinReport, Twins, json as twins_json, text as twins_text};

/// A run of `compare`.
#[derive(Debug, Default)]
pub struct Summary {
    /// Names of the two texts.
    pub texts: [String; 2],
    /// Seed of the inputs.
    pub seed: u64,
    /// The pairs of functions, in the order of the first text.
    pub pairs: Vec<Compared>,
    /// Functions of each text that have no partner.
    pub unpaired: [Vec<Unpaired>; 2],
    /// The first error of each text of which some functions do not compile.
    pub errors: Vec<String>,
    /// The signal that ended the run before its time.
    pub interrupted: Option<u8>,
}
