//! Where the package `webgpu` of npm is: as Node would find it from the working directory.

use std::env;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

/// The folder of the package: in `node_modules` of the working directory or of a folder above, or in a folder of
/// `NODE_PATH`.
pub fn package() -> Option<PathBuf> {
    let here = env::current_dir().ok()?;
    from(&here, env::var_os("NODE_PATH").as_deref())
}

fn from(here: &Path, node_path: Option<&OsStr>) -> Option<PathBuf> {
    let above = here.ancestors().map(|folder| folder.join("node_modules"));
    // A relative folder is one of the working directory.
    let listed = node_path.into_iter().flat_map(env::split_paths).map(|folder| here.join(folder));
    above.chain(listed).map(|folder| folder.join("webgpu")).find(|folder| folder.join("package.json").is_file())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_package_is_found_above_and_in_node_path() {
        let folder = tempfile::tempdir().unwrap();
        let there = |name: &str| {
            let package = folder.path().join(name).join("webgpu");
            std::fs::create_dir_all(&package).unwrap();
            std::fs::write(package.join("package.json"), "{}").unwrap();
            package
        };
        let here = folder.path().join("a/b");
        std::fs::create_dir_all(&here).unwrap();
        assert_eq!(from(&here, Some(OsStr::new("lib"))), None);
        let global = there("a/b/lib");
        assert_eq!(from(&here, Some(OsStr::new("/nowhere:lib"))), Some(global));
        // A folder without a package is none.
        std::fs::create_dir_all(here.join("node_modules/webgpu")).unwrap();
        assert_eq!(from(&here, None), None);
        let above = there("node_modules");
        assert_eq!(from(&here, Some(OsStr::new("lib"))), Some(above));
    }
}
