//! Tells the program what it was built from, for `shadercheck --version --verbose`. Nothing of it is needed to build: an
//! archive of the crate has no repository, and a line then says that the commit is not known.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

fn main() {
    let folder = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default());
    let profile = env::var("PROFILE").unwrap_or_default();
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=Cargo.lock");
    println!("cargo::rerun-if-env-changed=SHADERCHECK_COMMIT");
    println!("cargo::rustc-env=SHADERCHECK_COMMIT={}", commit(&folder, &profile));
    println!("cargo::rustc-env=SHADERCHECK_TARGET={}", env::var("TARGET").unwrap_or_default());
    println!("cargo::rustc-env=SHADERCHECK_PROFILE={profile}");
    let lock = fs::read_to_string(folder.join("Cargo.lock")).unwrap_or_default();
    for package in ["naga", "wgpu"] {
        let version = locked(&lock, package).unwrap_or("not known");
        println!("cargo::rustc-env=SHADERCHECK_{}={version}", package.to_uppercase());
    }
}

/// The commit: what the variable says, which packagers set; of an archive, what cargo noted in it; of a checkout, its head.
fn commit(folder: &Path, profile: &str) -> String {
    if let Ok(given) = env::var("SHADERCHECK_COMMIT") {
        return given;
    }
    if let Ok(noted) = fs::read_to_string(folder.join(".cargo_vcs_info.json")) {
        let hash = noted.split('"').find(|word| word.len() == 40 && word.bytes().all(|b| b.is_ascii_hexdigit()));
        return hash.unwrap_or("not known").to_owned();
    }
    // With the commit in it, every commit would compile the program again.
    if profile != "release" {
        return "not recorded in a build for development".to_owned();
    }
    let git = |arguments: &[&str]| {
        let output = Command::new("git").arg("-C").arg(folder).args(arguments).output().ok()?;
        output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
    };
    // Sources that were unpacked inside of another repository are not its commit.
    if git(&["ls-files", "--error-unmatch", "build.rs"]).is_none() {
        return "not known".to_owned();
    }
    for path in ["HEAD", "logs/HEAD"] {
        if let Some(path) = git(&["rev-parse", "--git-path", path]) {
            println!("cargo::rerun-if-changed={}", folder.join(path).display());
        }
    }
    git(&["rev-parse", "HEAD"]).unwrap_or_else(|| "not known".to_owned())
}

/// Version of a package in the lock file. Both packages are required in exactly one version.
fn locked<'l>(lock: &'l str, package: &str) -> Option<&'l str> {
    let (_, rest) = lock.split_once(&format!("name = \"{package}\"\nversion = \""))?;
    Some(rest.split_once('"')?.0)
}
