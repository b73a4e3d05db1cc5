//! The formats of packages: how each is made of the staged files, and how it is installed without a network.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result};
use serde_json::{Value, json};

use super::trial::step;
use super::{PROFILE, SHELLS, Staged};
use crate::folder::copy;

/// A format.
pub struct Format {
    pub name: &'static str,
    /// Programs that it needs.
    pub needs: &'static [&'static str],
    /// Makes the files of the package in a folder.
    pub make: fn(&Staged, &Path) -> Result<Vec<PathBuf>>,
    /// Installs the files into an empty folder and gives the program.
    pub install: fn(&[PathBuf], &Path) -> Result<PathBuf>,
}

/// All formats.
pub const FORMATS: &[Format] = &[
    Format { name: "archive", needs: &["tar", "gzip"], make: archive, install: install_archive },
    Format { name: "deb", needs: &["dpkg-deb"], make: deb, install: install_deb },
    Format { name: "npm", needs: &["npm"], make: npm, install: install_npm },
    Format { name: "wheel", needs: &["maturin", "python3"], make: wheel, install: install_wheel },
];

/// An archive with one folder, as installers and `cargo binstall` take it.
fn archive(staged: &Staged, out: &Path) -> Result<Vec<PathBuf>> {
    let name = format!("shadercheck-{}", staged.target);
    let folder = staged.build.join("archive");
    let inside = folder.join(&name);
    if folder.exists() {
        fs::remove_dir_all(&folder)?;
    }
    copy(&staged.folder, &inside)?;
    if cfg!(windows) {
        // A zip, by its ending, with the program at the top.
        let file = out.join(format!("{name}.zip"));
        step(tar().arg("-acf").arg(&file).arg("-C").arg(&inside).arg("."))?;
        return Ok(vec![file]);
    }
    let file = out.join(format!("{name}.tar.gz"));
    // The same bytes for the same files; the tar of macOS cannot.
    let fixed: &[&str] = &["--sort=name", "--owner=0", "--group=0", "--numeric-owner", "--mtime=@0"];
    let fixed = if cfg!(target_os = "linux") { fixed } else { &[] };
    step(tar().args(fixed).arg("-C").arg(&folder).arg("-czf").arg(&file).arg(&name))?;
    Ok(vec![file])
}

/// The tar of the system: a shell of Windows has another one, which knows no zip.
fn tar() -> Command {
    let system = std::env::var_os("SystemRoot").filter(|_| cfg!(windows));
    Command::new(system.map_or_else(|| PathBuf::from("tar"), |root| Path::new(&root).join("System32/tar.exe")))
}

fn install_archive(files: &[PathBuf], folder: &Path) -> Result<PathBuf> {
    let strip: &[&str] = if cfg!(windows) { &[] } else { &["--strip-components=1"] };
    step(tar().arg("-xf").arg(&files[0]).arg("-C").arg(folder).args(strip))?;
    Ok(folder.join(format!("shadercheck{}", std::env::consts::EXE_SUFFIX)))
}

/// The oldest glibc that has all that a program names, such as `2.28`.
fn glibc(program: &[u8]) -> Option<String> {
    let digits = |text: &[u8]| text.iter().take_while(|byte| byte.is_ascii_digit()).count();
    let versions = program.windows(8).enumerate().filter(|(_, window)| *window == b"GLIBC_2.").filter_map(|(at, _)| {
        let rest = &program[at + 8..];
        std::str::from_utf8(&rest[..digits(rest)]).ok()?.parse::<u32>().ok()
    });
    versions.max().map(|minor| format!("2.{minor}"))
}

/// A package for Debian and what derives from it.
fn deb(staged: &Staged, out: &Path) -> Result<Vec<PathBuf>> {
    let root = staged.build.join("deb");
    if root.exists() {
        fs::remove_dir_all(&root)?;
    }
    let doc = root.join("usr/share/doc/shadercheck");
    let put = |from: &str, to: PathBuf| -> Result<()> {
        fs::create_dir_all(to.parent().unwrap_or(&root))?;
        fs::copy(staged.folder.join(from), &to).with_context(|| format!("cannot copy {from}"))?;
        Ok(())
    };
    put("shadercheck", root.join("usr/bin/shadercheck"))?;
    for name in ["README.md", "CHANGELOG.md", "THIRD-PARTY.md", "LICENSE-MIT", "LICENSE-APACHE", "sbom.cdx.json"] {
        put(name, doc.join(name))?;
    }
    let places = [
        ("bash", "usr/share/bash-completion/completions/shadercheck"),
        ("zsh", "usr/share/zsh/vendor-completions/_shadercheck"),
        ("fish", "usr/share/fish/vendor_completions.d/shadercheck.fish"),
    ];
    for (shell, place) in places {
        let (_, file) = SHELLS.iter().find(|(name, _)| *name == shell).context("no such shell")?;
        put(&format!("completions/{file}"), root.join(place))?;
    }
    let pages = root.join("usr/share/man/man1");
    copy(&staged.folder.join("man"), &pages)?;
    for page in fs::read_dir(&pages)? {
        step(Command::new("gzip").arg("-9n").arg(page?.path()))?;
    }
    fs::write(doc.join("copyright"), COPYRIGHT)?;
    let size = fs::metadata(root.join("usr/bin/shadercheck"))?.len() / 1024;
    let architecture = match staged.target.split('-').next() {
        Some("x86_64") => "amd64",
        Some("aarch64") => "arm64",
        other => other.unwrap_or("any"),
    };
    let needs = glibc(&fs::read(root.join("usr/bin/shadercheck"))?);
    let needs = needs.map_or_else(|| "libc6".into(), |version| format!("libc6 (>= {version})"));
    let control = format!(
        "Package: shadercheck\nVersion: {}\nArchitecture: {architecture}\nMaintainer: shadercheck <noreply@invalid>\n\
         Installed-Size: {size}\nDepends: {needs}, libgcc-s1\nRecommends: mesa-vulkan-drivers, libvulkan1\n\
         Suggests: glslang-tools\nSection: devel\nPriority: optional\n\
         Description: property tests, lint and reference data for shaders\n \
         Lints GLSL and WGSL and the code that feeds them, runs shaders on many inputs\n \
         without a GPU, and compares each output with what it should be.\n",
        staged.version
    );
    fs::create_dir_all(root.join("DEBIAN"))?;
    fs::write(root.join("DEBIAN/control"), control)?;
    let file = out.join(format!("shadercheck_{}_{architecture}.deb", staged.version));
    step(Command::new("dpkg-deb").args(["--root-owner-group", "-Zxz", "--build"]).arg(&root).arg(&file))?;
    Ok(vec![file])
}

const COPYRIGHT: &str = "Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/\n\
    Upstream-Name: shadercheck\n\nFiles: *\nCopyright: the contributors of shadercheck\nLicense: MIT or Apache-2.0\n \
    See LICENSE-MIT, LICENSE-APACHE and THIRD-PARTY.md beside this file.\n";

fn install_deb(files: &[PathBuf], folder: &Path) -> Result<PathBuf> {
    // As dpkg unpacks it; installing it needs root.
    step(Command::new("dpkg-deb").arg("--extract").arg(&files[0]).arg(folder))?;
    Ok(folder.join("usr/bin/shadercheck"))
}

/// What npm calls the platform of a target: its package is `@shadercheck/cli-OS-CPU`.
fn platform(target: &str) -> Option<(&'static str, &'static str)> {
    Some(match target {
        "x86_64-unknown-linux-gnu" => ("linux", "x64"),
        "aarch64-unknown-linux-gnu" => ("linux", "arm64"),
        "x86_64-apple-darwin" => ("darwin", "x64"),
        "aarch64-apple-darwin" => ("darwin", "arm64"),
        "x86_64-pc-windows-msvc" => ("win32", "x64"),
        _ => return None,
    })
}

/// A package that starts the program, and one with the binary of this platform, of which npm takes the one that fits.
fn npm(staged: &Staged, out: &Path) -> Result<Vec<PathBuf>> {
    let (os, cpu) = platform(&staged.target).with_context(|| format!("npm has no name for {}", staged.target))?;
    let folder = staged.build.join("npm");
    if folder.exists() {
        fs::remove_dir_all(&folder)?;
    }
    let (main, own) = (folder.join("shadercheck"), folder.join(format!("cli-{os}-{cpu}")));
    copy(&staged.workspace.join("deploy/npm"), &main)?;
    fs::create_dir_all(&own)?;
    let manifest = main.join("package.json");
    let mut json: Value = serde_json::from_str(&fs::read_to_string(&manifest)?).context("deploy/npm/package.json")?;
    json["version"] = staged.version.as_str().into();
    for version in json["optionalDependencies"].as_object_mut().into_iter().flat_map(|all| all.values_mut()) {
        *version = staged.version.as_str().into();
    }
    fs::write(&manifest, format!("{json:#}\n"))?;
    let name = format!("shadercheck{}", std::env::consts::EXE_SUFFIX);
    let own_json = json!({
        "name": format!("@shadercheck/cli-{os}-{cpu}"), "version": staged.version, "os": [os], "cpu": [cpu],
        "description": format!("The program shadercheck for {os} on {cpu}"), "license": json["license"], "files": ["*"],
    });
    fs::write(own.join("package.json"), format!("{own_json:#}\n"))?;
    for file in [name.as_str(), "LICENSE-MIT", "LICENSE-APACHE", "THIRD-PARTY.md"] {
        fs::copy(staged.folder.join(file), own.join(file)).with_context(|| format!("cannot copy {file}"))?;
    }
    for file in ["LICENSE-MIT", "LICENSE-APACHE"] {
        fs::copy(staged.folder.join(file), main.join(file))?;
    }
    for package in [&main, &own] {
        step(Command::new("npm").args(["pack", "--silent", "--pack-destination"]).arg(out).arg(package))?;
    }
    let version = &staged.version;
    Ok(vec![
        out.join(format!("shadercheck-{version}.tgz")),
        out.join(format!("shadercheck-cli-{os}-{cpu}-{version}.tgz")),
    ])
}

fn install_npm(files: &[PathBuf], folder: &Path) -> Result<PathBuf> {
    fs::write(folder.join("package.json"), "{ \"private\": true }\n")?;
    // Both at once: nothing is asked of the registry. The packages of other platforms are left out.
    let quiet = ["install", "--offline", "--no-audit", "--no-fund", "--silent"];
    step(Command::new("npm").args(quiet).args(files).current_dir(folder))?;
    Ok(folder.join("node_modules/.bin/shadercheck"))
}

/// A wheel with the program and a module that reads reference data.
fn wheel(staged: &Staged, out: &Path) -> Result<Vec<PathBuf>> {
    let folder = staged.build.join("wheel");
    if folder.exists() {
        fs::remove_dir_all(&folder)?;
    }
    let mut command = Command::new("maturin");
    command.args(["build", "--profile", PROFILE, "--locked", "--quiet", "--out"]).arg(&folder).args(&staged.features);
    step(command.current_dir(&staged.workspace).env("CARGO_TARGET_DIR", &staged.build))?;
    let mut made = Vec::new();
    for entry in fs::read_dir(&folder)? {
        let entry = entry?;
        let to = out.join(entry.file_name());
        fs::copy(entry.path(), &to)?;
        made.push(to);
    }
    Ok(made)
}

fn install_wheel(files: &[PathBuf], folder: &Path) -> Result<PathBuf> {
    step(Command::new("python3").args(["-m", "venv", "--without-pip"]).arg(folder.join("venv")))?;
    let python = folder.join("venv/bin/python");
    // The pip of the machine installs into the environment; a pip in each would take most of the time.
    step(
        Command::new("python3")
            .args(["-m", "pip", "--python"])
            .arg(&python)
            .args(["install", "--quiet", "--no-index", "--no-deps", "--disable-pip-version-check"])
            .arg(&files[0]),
    )?;
    Ok(folder.join("venv/bin/shadercheck"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_version_of_glibc_that_is_named_is_needed() {
        assert_eq!(glibc(b"\0GLIBC_2.9\0GLIBC_2.28\0GLIBC_2.3.4\0GLIBC_PRIVATE\0").as_deref(), Some("2.28"));
        assert_eq!(glibc(b"static"), None);
    }

    #[test]
    fn every_platform_of_the_npm_package_is_one_that_is_built() {
        let json: Value = serde_json::from_str(include_str!("../../../deploy/npm/package.json")).unwrap();
        let listed: Vec<&String> = json["optionalDependencies"].as_object().unwrap().keys().collect();
        let release = include_str!("../../../.github/workflows/release.yml");
        let targets: Vec<&str> = release.split([' ', ',']).filter(|word| platform(word).is_some()).collect();
        assert_eq!((listed.len(), targets.len()), (5, 5), "{release}");
        for target in targets {
            let (os, cpu) = platform(target).unwrap();
            assert!(listed.contains(&&format!("@shadercheck/cli-{os}-{cpu}")), "{target}");
        }
    }
}
