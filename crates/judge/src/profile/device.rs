//! Which measurement belongs to which device.

/// Keys of the table `device` of a measured profile.
pub(super) const KEYS: [&str; 7] = ["lane", "driver", "date", "samples", "fma", "products_and_sums", "order"];

/// What tells apart devices whose operations differ: the name of the device, and the version of the
/// driver that translates the operations.
///
/// The rule: two descriptions are of one device when the names before the first comma or parenthesis
/// are equal, and the first two numbers behind `Mesa` are. What stands in parentheses is no part of
/// it: llvmpipe tells there the version of LLVM and the width of its vectors, and its functions are
/// made by Mesa from additions and multiplications, which are the same in any width. The third number
/// of Mesa's version counts corrections.
///
/// NVIDIA counts releases by two numbers, `580.159`. Its OpenGL has functions of its own, and is another device: on one card
/// and release, `acos` is off by 770 ULP there, and by 1.6 through Vulkan.
///
/// SwiftShader gives every build the version 5.0, and its own functions have been the same for years; what stands in
/// parentheses is the compiler behind them, which counts.
///
/// Any other description has no identity: of other drivers it is not known which number says that the operations have
/// changed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Identity {
    /// Name of the device.
    pub device: String,
    /// First two numbers of the driver's version.
    pub version: (u32, u32),
    /// The whole version, as the driver writes it; two identities with other ones may be equal in
    /// everything that counts, see [`Identity::is_same`].
    pub full_version: String,
}

impl Identity {
    /// The identity in a description of device and driver; `None` where it names none.
    pub fn of(driver: &str) -> Option<Self> {
        if let Some(compiler) = driver.strip_prefix("SwiftShader Device (").and_then(|rest| rest.split_once(')')) {
            let device = format!("swiftshader-{}", compiler.0.to_lowercase());
            return Some(Self { device, version: (5, 0), full_version: "5.0".to_owned() });
        }
        // A device may be called after its vendor too: the version is what has numbers behind it.
        let behind = |word: &str| {
            let mut versions =
                driver.match_indices(word).map(|(at, word)| &driver[at + word.len()..]).filter_map(version);
            versions.next()
        };
        if let Some((version, full_version)) = behind("NVIDIA, ") {
            return Some(Self { device: device_name(driver).to_owned(), version, full_version });
        }
        if let Some((version, full_version)) = behind("NVIDIA ").filter(|_| driver.contains(", OpenGL ")) {
            return Some(Self { device: format!("{} OpenGL", device_name(driver)), version, full_version });
        }
        let (version, full_version) = behind("Mesa ")?;
        Some(Self { device: device_name(driver).to_owned(), version, full_version })
    }

    /// True when measurements of one hold for the other.
    pub fn is_same(&self, other: &Self) -> bool {
        self.device == other.device && self.version == other.version
    }

    /// Device and version in a word, such as `llvmpipe-22.3.6`: the name of a measured profile.
    pub fn profile_name(&self) -> String {
        let words: Vec<String> = self.device.split_whitespace().map(str::to_lowercase).collect();
        format!("{}-{}", words.join("-"), self.full_version)
    }
}

/// The name of a device, without the versions behind it.
pub fn device_name(driver: &str) -> &str {
    driver.split([',', '(']).next().unwrap_or(driver).trim()
}

/// `22.3.6` at the start of a text, with its first two numbers.
fn version(text: &str) -> Option<((u32, u32), String)> {
    let full: &str = text.split(|c: char| !c.is_ascii_digit() && c != '.').next()?;
    let full = full.trim_end_matches('.');
    let mut numbers = full.split('.').map(str::parse);
    let (Some(Ok(major)), Some(Ok(minor))) = (numbers.next(), numbers.next()) else { return None };
    Some(((major, minor), full.to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    const LLVMPIPE: &str = "llvmpipe (LLVM 15.0.6, 256 bits), llvmpipe, Mesa 22.3.6 (LLVM 15.0.6)";

    fn same(a: &str, b: &str) -> bool {
        Identity::of(a).zip(Identity::of(b)).is_some_and(|(a, b)| a.is_same(&b))
    }

    #[test]
    fn name_and_version_come_out_of_the_description() {
        let identity = Identity::of(LLVMPIPE).unwrap();
        assert_eq!((identity.device.as_str(), identity.version), ("llvmpipe", (22, 3)));
        assert_eq!(identity.profile_name(), "llvmpipe-22.3.6");
        let other = Identity::of("AMD Radeon RX 580 Series (RADV POLARIS10), radv, Mesa 23.2.1-1ubuntu3").unwrap();
        assert_eq!(other.profile_name(), "amd-radeon-rx-580-series-23.2.1");
    }

    #[test]
    fn corrections_and_the_width_of_vectors_make_no_other_device() {
        assert!(same(LLVMPIPE, LLVMPIPE));
        assert!(same(LLVMPIPE, "llvmpipe (LLVM 15.0.6, 128 bits), llvmpipe, Mesa 22.3.6 (LLVM 15.0.6)"));
        assert!(same(LLVMPIPE, "llvmpipe (LLVM 14.0.0, 512 bits), llvmpipe, Mesa 22.3.1 (LLVM 14.0.0)"));
    }

    #[test]
    fn nvidia_is_known_by_card_release_and_api() {
        let vulkan = "NVIDIA H200, NVIDIA, 580.159.04";
        assert_eq!(Identity::of(vulkan).unwrap().profile_name(), "nvidia-h200-580.159.04");
        let opengl = "NVIDIA H200, OpenGL 4.6.0 NVIDIA 580.159.04";
        assert_eq!(Identity::of(opengl).unwrap().profile_name(), "nvidia-h200-opengl-580.159.04");
        assert!(!same(vulkan, opengl));
        assert!(same(vulkan, "NVIDIA H200, NVIDIA, 580.159.12"));
        assert!(!same(vulkan, "NVIDIA H200, NVIDIA, 570.86.10"));
        assert!(!same(vulkan, "NVIDIA GeForce RTX 4090, NVIDIA, 580.159.04"));
    }

    #[test]
    fn swiftshader_is_known_by_its_compiler() {
        let subzero = "SwiftShader Device (Subzero), SwiftShader driver";
        assert_eq!(Identity::of(subzero).unwrap().profile_name(), "swiftshader-subzero-5.0");
        assert!(same(subzero, "SwiftShader Device (Subzero)"));
        assert!(!same(subzero, "SwiftShader Device (LLVM 10.0.0), SwiftShader driver"));
        assert!(!same(subzero, LLVMPIPE));
    }

    #[test]
    fn another_version_and_another_name_make_another_device() {
        assert!(!same(LLVMPIPE, "llvmpipe (LLVM 15.0.6, 256 bits), llvmpipe, Mesa 22.2.6 (LLVM 15.0.6)"));
        assert!(!same(LLVMPIPE, "llvmpipe (LLVM 15.0.6, 256 bits), llvmpipe, Mesa 23.3.6 (LLVM 15.0.6)"));
        assert!(!same(LLVMPIPE, "llvmpipe (LLVM 15.0.6, 256 bits), llvmpipe, Mesa 22.30.6 (LLVM 15.0.6)"));
        assert!(!same(LLVMPIPE, "softpipe, softpipe, Mesa 22.3.6"));
        for none in
            ["llvmpipe", "llvmpipe, llvmpipe, Mesa", "llvmpipe, Mesa 22", "llvmpipe, Mesa x.y", "SwiftShader 5.0", ""]
        {
            assert_eq!(Identity::of(none), None, "{none}");
        }
    }
}
