//! The profiles that are part of the program.

use std::sync::LazyLock;

use super::{Profile, parse};
use crate::text::SourceFile;

/// Name and text of each; one that extends another comes behind it.
const TEXTS: [(&str, &str); 4] = [
    ("vulkan-1.4", include_str!("../../../fixtures/profiles/vulkan-1.4.toml")),
    ("vulkan-cts", include_str!("../../../fixtures/profiles/vulkan-cts.toml")),
    ("wgsl", include_str!("../../../fixtures/profiles/wgsl.toml")),
    ("glsl-4.60", include_str!("../../../fixtures/profiles/glsl-4.60.toml")),
];

static PROFILES: LazyLock<Vec<Profile>> = LazyLock::new(|| {
    let mut profiles: Vec<Profile> = Vec::new();
    for (name, text) in TEXTS {
        let file = SourceFile::new(format!("{name}.toml"), text);
        let base = |wanted: &str| profiles.iter().find(|p| p.name == wanted).cloned();
        // They are part of the program, and a test reads each of them.
        let profile = parse(&file, &base).unwrap_or_else(|error| panic!("a profile of the program is wrong: {error}"));
        profiles.push(profile);
    }
    profiles
});

/// The shipped profile of this name.
pub fn by_name(name: &str) -> Option<&'static Profile> {
    PROFILES.iter().find(|p| p.name == name)
}

/// Names of the shipped profiles.
pub fn names() -> impl Iterator<Item = &'static str> {
    TEXTS.iter().map(|(name, _)| *name)
}
