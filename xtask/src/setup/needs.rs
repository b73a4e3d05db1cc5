//! What lanes and tests need beside this program, with the packages of it.

use std::path::{Path, PathBuf};

use crate::host::{Host, on_path};
use crate::{opengl, vulkan};

/// Something that a lane or a test needs.
pub struct Need {
    /// Debian's and Ubuntu's packages of it.
    pub packages: &'static [&'static str],
    /// The command of other distributions, by their package manager.
    pub elsewhere: [(&'static str, &'static str); 3],
    /// What it is, for a system without any of these package managers.
    pub what: &'static str,
    /// What does not happen without it.
    pub without: &'static str,
    /// What is said when it was installed.
    pub ready: &'static str,
    /// Whether it is there.
    pub there: fn(&dyn Host) -> bool,
}

pub const DRIVER: Need = Need {
    packages: &["mesa-vulkan-drivers", "libvulkan1"],
    elsewhere: [
        ("dnf", "sudo dnf install mesa-vulkan-drivers vulkan-loader"),
        ("pacman", "sudo pacman -S vulkan-swrast vulkan-icd-loader"),
        ("apk", "sudo apk add mesa-vulkan-swrast vulkan-loader"),
    ],
    what: "Mesa's lavapipe and the Vulkan loader",
    without: "no shader can run on the lane `vulkan`",
    ready: "Vulkan is ready",
    there: |host| vulkan::find(host).complete(),
};

pub const TRANSLATOR: Need = Need {
    packages: &["glslang-tools"],
    elsewhere: [
        ("dnf", "sudo dnf install glslang"),
        ("pacman", "sudo pacman -S glslang"),
        ("apk", "sudo apk add glslang"),
    ],
    what: "glslang",
    without: "no shader can run on the lane `vulkan-glslang`",
    ready: "glslangValidator is ready",
    there: |host| on_path(host, "glslangValidator").is_some(),
};

pub const OPENGL: Need = Need {
    packages: &opengl::PACKAGES,
    elsewhere: [
        ("dnf", "sudo dnf install mesa-libEGL mesa-dri-drivers"),
        ("pacman", "sudo pacman -S mesa libglvnd"),
        ("apk", "sudo apk add mesa-egl mesa-dri-gallium"),
    ],
    what: "Mesa's EGL and its DRI drivers",
    without: "no shader can run on the lane `opengl`",
    ready: "OpenGL is ready",
    there: opengl::is_there,
};

/// What single tests need, with the names by which they are called missing.
pub const FOR_TESTS: [(&str, Need); 8] = [
    (
        "Neovim",
        Need {
            packages: &["neovim"],
            elsewhere: [
                ("dnf", "sudo dnf install neovim"),
                ("pacman", "sudo pacman -S neovim"),
                ("apk", "sudo apk add neovim"),
            ],
            what: "Neovim",
            without: "the language server is not tested with an editor",
            ready: "Neovim is ready",
            there: |host| on_path(host, "nvim").is_some(),
        },
    ),
    (
        "spirv-val",
        Need {
            packages: &["spirv-tools"],
            elsewhere: [
                ("dnf", "sudo dnf install spirv-tools"),
                ("pacman", "sudo pacman -S spirv-tools"),
                ("apk", "sudo apk add spirv-tools"),
            ],
            what: "SPIRV-Tools",
            without: "no translation is checked by it",
            ready: "spirv-val is ready",
            there: |host| on_path(host, "spirv-val").is_some(),
        },
    ),
    (
        "Chromium",
        Need {
            packages: &["chromium"],
            elsewhere: [
                ("dnf", "sudo dnf install chromium"),
                ("pacman", "sudo pacman -S chromium"),
                ("apk", "sudo apk add chromium"),
            ],
            what: "Chromium",
            without: "the page of a report is not looked at in a browser",
            ready: "Chromium is ready",
            there: |host| browser(host).is_some(),
        },
    ),
    (
        "SwiftShader",
        Need {
            packages: &["chromium-common"],
            elsewhere: [
                ("dnf", "sudo dnf install chromium-common"),
                ("pacman", "sudo pacman -S chromium"),
                ("apk", "sudo apk add chromium-swiftshader"),
            ],
            what: "the SwiftShader that comes with Chromium",
            without: "the lane `webgpu` is not tested beside a second executor",
            ready: "SwiftShader is ready",
            there: |host| host.exists(Path::new("/usr/lib/chromium/vk_swiftshader_icd.json")),
        },
    ),
    (
        "Node",
        Need {
            packages: &["nodejs", "npm"],
            elsewhere: [
                ("dnf", "sudo dnf install nodejs npm"),
                ("pacman", "sudo pacman -S nodejs npm"),
                ("apk", "sudo apk add nodejs npm"),
            ],
            what: "Node.js and npm",
            without: "the lane `webgpu` is not tested",
            ready: "Node is ready",
            there: |host| ["node", "npm"].iter().all(|name| on_path(host, name).is_some()),
        },
    ),
    (
        "Python",
        Need {
            packages: &["python3", "python3-venv"],
            elsewhere: [
                ("dnf", "sudo dnf install python3"),
                ("pacman", "sudo pacman -S python"),
                ("apk", "sudo apk add python3"),
            ],
            what: "Python 3 with its module venv",
            without: "no reference data are read by NumPy and PyArrow",
            ready: "Python is ready",
            there: python,
        },
    ),
    (
        "shellcheck",
        Need {
            packages: &["shellcheck"],
            elsewhere: [
                ("dnf", "sudo dnf install ShellCheck"),
                ("pacman", "sudo pacman -S shellcheck"),
                ("apk", "sudo apk add shellcheck"),
            ],
            what: "ShellCheck",
            without: "the scripts for CI are not checked by it",
            ready: "shellcheck is ready",
            there: |host| on_path(host, "shellcheck").is_some(),
        },
    ),
    (
        "a C++ compiler",
        Need {
            packages: &["g++"],
            elsewhere: [
                ("dnf", "sudo dnf install gcc-c++"),
                ("pacman", "sudo pacman -S gcc"),
                ("apk", "sudo apk add g++"),
            ],
            what: "a C++ compiler",
            without: "no reference data are read by the examples in C++",
            ready: "the compiler is ready",
            there: |host| ["c++", "g++", "clang++"].iter().any(|name| on_path(host, name).is_some()),
        },
    ),
];

/// Whether Python can make environments: Debian's own cannot without a package of its own.
fn python(host: &dyn Host) -> bool {
    let of_python =
        |folder: &PathBuf| folder.file_name().is_some_and(|name| name.to_string_lossy().starts_with("python3"));
    let libraries = || ["/usr/lib", "/usr/lib64"].into_iter().flat_map(|folder| host.list(Path::new(folder)));
    let complete = || libraries().filter(of_python).any(|folder| host.exists(&folder.join("ensurepip")));
    on_path(host, "python3").is_some_and(|program| !program.starts_with("/usr/bin") || complete())
}

/// Chromium or Chrome, by the first of its names.
pub fn browser(host: &dyn Host) -> Option<PathBuf> {
    ["chromium", "chromium-browser", "google-chrome"].iter().find_map(|name| on_path(host, name))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::host::fake::Fake;

    #[test]
    fn python_of_debian_needs_its_module_for_environments() {
        let debian = || Fake::default().var("PATH", "/usr/bin").file("/usr/bin/python3", "");
        assert!(!python(&debian().file("/usr/lib/python3.11/os.py", "")));
        assert!(python(&debian().file("/usr/lib/python3.11/ensurepip/__init__.py", "")));
        assert!(python(&Fake::default().var("PATH", "/opt/bin").file("/opt/bin/python3", "")));
        assert!(!python(&Fake::default()));
    }
}
