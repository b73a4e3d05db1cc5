//! `calibrate --against`: in what a device is worse than a profile says.

use std::path::Path;
use std::sync::Arc;

use serde_json::{Value, json};

use super::table::{arguments, float, short};
use crate::cli::check::profile::named;
use base::text::Shown;
use base::value::F32Bits;
use engine::calibrate::{State, Worsened, freer, worsened};
use judge::profile::Profile;

/// The profile to compare with.
pub struct Reference {
    /// As it was given.
    argument: String,
    profile: Arc<Profile>,
}

impl Reference {
    /// Reads a file, or takes a shipped profile by its name. `output` must be another file.
    ///
    /// # Errors
    /// When there is none, it cannot be read, or the output would replace it.
    pub fn new(argument: &str, output: Option<&Path>) -> anyhow::Result<Self> {
        let Some(profile) = named(argument)? else {
            anyhow::bail!("--against {argument} leaves nothing to compare with; name a profile or a file");
        };
        let file = |path: &Path| path.canonicalize().ok();
        if let Some(output) = output.filter(|output| file(output).is_some_and(|o| Some(o) == file(Path::new(argument))))
        {
            anyhow::bail!("-o {} would replace the profile of --against; name another file", output.shown());
        }
        Ok(Self { argument: argument.to_owned(), profile })
    }

    /// What is worse in a measurement, which makes the profile `now`.
    pub fn compared(&self, state: &State, now: &Profile) -> Comparison<'_> {
        Comparison { then: self, worsened: worsened(state, &self.profile), freer: freer(now, &self.profile) }
    }
}

/// What got worse.
pub struct Comparison<'a> {
    then: &'a Reference,
    worsened: Vec<Worsened>,
    freer: Vec<&'static str>,
}

impl Comparison<'_> {
    /// True when nothing got worse.
    pub fn is_clean(&self) -> bool {
        self.worsened.is_empty() && self.freer.is_empty()
    }

    /// One line for each operation that got worse, and what there is to say of all.
    pub fn text(&self) -> String {
        let file = &self.then.argument;
        if self.is_clean() {
            return format!("Nothing is worse than {file} says.\n");
        }
        let error = |w: &Worsened| match f32::from_bits(w.result) {
            result if result.is_finite() => format!("is off by {} ULP", short(w.error)),
            _ => format!("gives {}", F32Bits(w.result)),
        };
        let operations = self.worsened.iter().map(|w| {
            let (name, place, allowed) = (w.op.name(), arguments(w.op, &w.at), short(w.allowed));
            format!("worse: {name} {} at {place}; {file} allows {allowed} ULP there\n", error(w))
        });
        let freedoms = self.freer.iter().map(|what| format!("worse: {what}, which {file} excludes\n"));
        operations.chain(freedoms).collect()
    }

    /// The same for programs.
    pub fn json(&self) -> Value {
        let bits = |word: &u32| format!("0x{word:08x}");
        let operation = |w: &Worsened| {
            let at = || w.at.iter().take(w.op.arity().unwrap_or(0));
            json!({
                "operation": w.op.name(),
                "ulp": float(w.error),
                "allowed_ulp": float(w.allowed),
                "at": at().map(bits).collect::<Vec<_>>(),
                "at_hex_float": at().map(|word| F32Bits(*word).to_hex_float()).collect::<Vec<_>>(),
                "result": bits(&w.result),
            })
        };
        json!({
            "profile": self.then.argument,
            "driver": self.then.profile.driver,
            "worse": self.worsened.iter().map(operation).collect::<Vec<_>>(),
            "freer": self.freer,
        })
    }
}
