//! `shadercheck lanes`: what can run shaders here, and why what cannot, cannot.

use std::io::Write;

use clap::Args;

use crate::bound::profile::Rulings;
use crate::cli::status::ExitStatus;
use crate::lane;

/// Arguments of `shadercheck lanes`: none.
#[derive(Args, Clone, Debug, Default)]
pub struct LanesArgs {}

/// Runs the command. The status is [`ExitStatus::Clean`] even when no lane can be had: that is an
/// answer.
///
/// # Errors
/// When `out` cannot be written to.
pub fn run(_args: &LanesArgs, out: &mut dyn Write) -> anyhow::Result<ExitStatus> {
    for candidate in lane::registry() {
        match (candidate.open)() {
            Ok(lane) => {
                let description = lane.description();
                let stages: Vec<&str> = description.stages.iter().map(|s| s.name()).collect();
                writeln!(out, "{:<10} available    {} ({})", candidate.name, description.driver, stages.join(", "))?;
                let rulings = Rulings::of_lane(description);
                let promises: Vec<&str> = rulings.promises().map(|p| p.name.as_str()).collect();
                let measured = rulings.measured.as_ref().map_or("none", |p| p.name.as_str());
                let api = description.api.name();
                writeln!(out, "{:<10} API {api}: promises {}; measured profile: {measured}", "", promises.join(", "))?;
            }
            Err(missing) => writeln!(out, "{:<10} unavailable  {missing} ({})", candidate.name, candidate.about)?,
        }
    }
    Ok(ExitStatus::Clean)
}
