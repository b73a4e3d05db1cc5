//! Which measured profile the lanes are compared with.

use std::path::Path;
use std::sync::Arc;

use anyhow::Context;

use base::did_you_mean;
use base::text::SourceFile;
use judge::profile::{self, Profile, Promises};
use lanes::Description;

/// The word that asks for no measured profile.
const NONE: &str = "none";

/// Where the measured profile comes from.
#[derive(Clone, Debug)]
pub enum Choice {
    /// The shipped measurement of each lane's device, where there is one.
    ByDevice,
    /// No measurement.
    Nothing,
    /// This one for all lanes.
    Given(Arc<Profile>),
}

impl Choice {
    /// What `--profile` asks for: `none`, the name of a shipped profile, or a file. A name goes
    /// before a file that is called so.
    ///
    /// # Errors
    /// When there is no such profile or file, or the file is no profile: with every problem at its
    /// place.
    pub fn new(argument: Option<&str>) -> anyhow::Result<Self> {
        let Some(argument) = argument else { return Ok(Self::ByDevice) };
        Ok(named(argument)?.map_or(Self::Nothing, Self::Given))
    }

    /// What the results of a lane are held against.
    pub fn promises(&self, lane: &Description) -> Promises {
        match self {
            Self::ByDevice => Promises::of_lane(lane),
            Self::Nothing => Promises::of_api(lane.api),
            Self::Given(measured) => Promises { measured: Some(measured.clone()), ..Promises::of_api(lane.api) },
        }
    }
}

/// The profile that an argument names: a shipped one or a file; none for `none`.
///
/// # Errors
/// As of [`Choice::new`].
pub fn named(argument: &str) -> anyhow::Result<Option<Arc<Profile>>> {
    if argument == NONE {
        return Ok(None);
    }
    if let Some(shipped) = profile::by_name(argument) {
        return Ok(Some(Arc::new(shipped.clone())));
    }
    let path = Path::new(argument);
    if !path.exists() && !argument.ends_with(".toml") {
        let names = || profile::names().chain([NONE]);
        let hint = did_you_mean(argument, names(), "profiles are");
        anyhow::bail!("there is no profile and no file `{argument}`; {hint}");
    }
    let text = std::fs::read_to_string(path).with_context(|| format!("cannot read the profile `{argument}`"))?;
    let base = |name: &str| profile::by_name(name).cloned();
    Ok(Some(Arc::new(profile::parse(&SourceFile::new(argument, text), &base)?)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use lanes::{Api, Stage};

    fn lane() -> Description {
        let driver = "llvmpipe (LLVM 15.0.6, 256 bits), llvmpipe, Mesa 22.3.6 (LLVM 15.0.6)".to_owned();
        Description {
            name: "soft",
            driver,
            executor: "soft".to_owned(),
            front_end: "naga".to_owned(),
            api: Api::Vulkan,
            stages: vec![Stage::Compute],
        }
    }

    fn measured(argument: Option<&str>) -> Option<String> {
        let promises = Choice::new(argument).unwrap().promises(&lane());
        assert_eq!(
            (promises.text.name.as_str(), promises.conformance.unwrap().name.as_str()),
            ("vulkan-1.4", "vulkan-cts")
        );
        promises.measured.map(|p| p.name.clone())
    }

    #[test]
    fn the_device_decides_unless_reported_otherwise() {
        assert_eq!(measured(None).as_deref(), Some("llvmpipe-22.3.6"));
        assert_eq!(measured(Some("none")), None);
        assert_eq!(measured(Some("binary32")).as_deref(), Some("binary32"));
    }

    #[test]
    fn a_file_is_read_and_a_wrong_one_is_refused_at_the_place() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mine.toml");
        let path = path.to_str().unwrap();
        std::fs::write(path, "name = \"mine\"\nextends = \"vulkan-1.4\"\n").unwrap();
        assert_eq!(measured(Some(path)).as_deref(), Some("mine"));
        std::fs::write(path, "name = \"mine\"\nextends = \"vulkan-1.4\"\nroundin = \"either\"\n").unwrap();
        let error = Choice::new(Some(path)).unwrap_err().to_string();
        assert_eq!(error, format!("{path}:3:1: unknown key `roundin`; did you mean `rounding`?"));
    }

    #[test]
    fn an_unknown_profile_is_refused_with_a_suggestion() {
        let error = |argument| Choice::new(Some(argument)).unwrap_err().to_string();
        assert_eq!(
            error("llvmpipe-22.3.7"),
            "there is no profile and no file `llvmpipe-22.3.7`; did you mean `llvmpipe-22.3.6`?"
        );
        assert!(error("gone.toml").starts_with("cannot read the profile `gone.toml`"));
    }
}
