//! The profiles that are part of the program.

use std::io::Read;
use std::sync::{Arc, LazyLock};

use flate2::read::ZlibDecoder;

use super::{Identity, Profile, parse};
use base::text::SourceFile;

/// Name and text of each promise; one that extends another comes behind it.
const PROMISES: [(&str, &str); 6] = [
    ("vulkan-1.4", include_str!("../../profiles/vulkan-1.4.toml")),
    ("vulkan-cts", include_str!("../../profiles/vulkan-cts.toml")),
    ("wgsl", include_str!("../../profiles/wgsl.toml")),
    ("glsl-4.60", include_str!("../../profiles/glsl-4.60.toml")),
    ("binary32", include_str!("../../profiles/binary32.toml")),
    // No promise, and no lane is judged by it: the default of reference data.
    ("vulkan-practice", include_str!("../../profiles/vulkan-practice.toml")),
];

static PROMISED: LazyLock<Vec<Profile>> = LazyLock::new(|| {
    let mut profiles: Vec<Profile> = Vec::new();
    for (name, text) in PROMISES {
        let profile = read(name, text, &profiles);
        profiles.push(profile);
    }
    profiles
});

/// A device that was measured. The file is long, so it is read when the device is met.
struct MeasuredDevice {
    name: &'static str,
    /// Device and driver of the measurement, as in its file.
    driver: &'static str,
    profile: LazyLock<Arc<Profile>>,
}

/// A measurement, out of what the build script made of its file.
macro_rules! measured {
    ($name:literal, $driver:literal) => {
        MeasuredDevice {
            name: $name,
            driver: $driver,
            profile: LazyLock::new(|| {
                let text = unpack(include_bytes!(concat!(env!("OUT_DIR"), "/", $name, ".toml.z")));
                Arc::new(read($name, &text, &PROMISED))
            }),
        }
    };
}

static MEASURED: [MeasuredDevice; 5] = [
    measured! { "llvmpipe-22.3.6", "llvmpipe (LLVM 15.0.6, 256 bits), llvmpipe, Mesa 22.3.6 (LLVM 15.0.6)" },
    measured! { "softpipe-22.3.6", "softpipe, OpenGL 3.3 (Core Profile) Mesa 22.3.6" },
    measured! { "swiftshader-subzero-5.0", "SwiftShader Device (Subzero), SwiftShader driver" },
    measured! { "nvidia-h200-580.159.04", "NVIDIA H200, NVIDIA, 580.159.04" },
    measured! { "nvidia-h200-opengl-580.159.04", "NVIDIA H200, OpenGL 4.6.0 NVIDIA 580.159.04" },
];

fn unpack(packed: &[u8]) -> String {
    let mut text = String::new();
    // The build script packed it, and a test reads each of them.
    ZlibDecoder::new(packed).read_to_string(&mut text).expect("a profile of the program unpacks");
    text
}

fn read(name: &str, text: &str, earlier: &[Profile]) -> Profile {
    let file = SourceFile::new(format!("{name}.toml"), text);
    let base = |wanted: &str| earlier.iter().find(|p| p.name == wanted).cloned();
    // They are part of the program, and a test reads each of them.
    parse(&file, &base).unwrap_or_else(|error| panic!("a profile of the program is wrong: {error}"))
}

/// The shipped profile of this name.
pub fn by_name(name: &str) -> Option<&'static Profile> {
    let promised = PROMISED.iter().find(|p| p.name == name);
    promised.or_else(|| MEASURED.iter().find(|m| m.name == name).map(|m| &**m.profile))
}

/// The shipped measurement of a device, by the description of device and driver that its lane gives.
/// [`Identity`] has the rule.
pub fn for_device(driver: &str) -> Option<&'static Arc<Profile>> {
    let wanted = Identity::of(driver)?;
    let fits = |m: &&MeasuredDevice| Identity::of(m.driver).is_some_and(|identity| identity.is_same(&wanted));
    MEASURED.iter().find(fits).map(|m| &*m.profile)
}

/// Names of the shipped profiles.
pub fn names() -> impl Iterator<Item = &'static str> {
    PROMISES.iter().map(|(name, _)| *name).chain(MEASURED.iter().map(|m| m.name))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_measurement_is_found_by_the_driver_that_its_file_records() {
        for device in &MEASURED {
            assert_eq!(device.profile.driver.as_deref(), Some(device.driver), "{}", device.name);
            assert_eq!(device.profile.name, device.name);
            assert_eq!(Identity::of(device.driver).unwrap().profile_name(), device.name);
            assert_eq!(for_device(device.driver).unwrap().name, device.name);
        }
    }

    #[test]
    fn a_driver_that_nobody_measured_has_no_measurement() {
        for driver in ["", "interpreter of shadercheck, strict binary32", "llvmpipe, Mesa 22.4.0", "lvp, Mesa 22.3.6"] {
            assert!(for_device(driver).is_none(), "{driver}");
        }
    }
}
