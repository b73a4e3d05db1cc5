//! `calibrate --contribute`: a measured profile for everybody.

use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use base::text::Shown;
use judge::profile::{Identity, device_name, for_device};

/// Where the project is.
const REPOSITORY: &str = env!("CARGO_PKG_REPOSITORY");

/// The file of a contribution without a given name: as the profile is called.
pub fn default_file(driver: &str) -> PathBuf {
    let name = Identity::of(driver).map_or_else(|| device_name(driver).to_lowercase(), |known| known.profile_name());
    let plain = |c: char| if c.is_ascii_alphanumeric() || ".-".contains(c) { c } else { '-' };
    PathBuf::from(format!("{}.toml", name.chars().map(plain).collect::<String>().trim_matches(['-', '.'])))
}

/// What is to be done with a profile that was written.
pub struct Contribution<'a> {
    pub file: &'a Path,
    /// Device and driver.
    pub driver: &'a str,
}

impl Contribution<'_> {
    /// The steps, for people.
    pub fn text(&self) -> String {
        let file = self.file.shown();
        let mut text = format!("The file {file} reads back as a profile.\n");
        if let Some(shipped) = self.shipped() {
            text += &format!(
                "A measurement of this device ships already, as `{shipped}`: one of more samples may replace it.\n"
            );
        }
        text += &format!(
            "To contribute it, send it to {REPOSITORY}:\n\
             - as a pull request that adds it as crates/judge/profiles/{}, and to the list in\n  \
             crates/judge/src/profile/shipped.rs the entry\n  {}\n\
             - or with an issue that has the file attached\n",
            default_file(self.driver).display(),
            self.entry(),
        );
        if Identity::of(self.driver).is_none() {
            text += &format!(
                "The description of the device, `{}`, has no version that this program knows. Say how its versions\n\
                 are numbered, and which number says that the operations may have changed.\n",
                self.driver
            );
        }
        text
    }

    /// The same for programs.
    pub fn json(&self) -> Value {
        json!({
            "file": self.file.shown().to_string(),
            "add_as": format!("crates/judge/profiles/{}", default_file(self.driver).display()),
            "entry": self.entry(),
            "repository": REPOSITORY,
            "shipped": self.shipped(),
            "recognised": Identity::of(self.driver).is_some(),
        })
    }

    fn entry(&self) -> String {
        let file = default_file(self.driver);
        let name = file.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
        format!("measured! {{ {name:?}, {:?} }},", self.driver)
    }

    fn shipped(&self) -> Option<&'static str> {
        for_device(self.driver).map(|profile| profile.name.as_str())
    }
}
