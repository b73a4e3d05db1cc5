//! Finds out whether a Vulkan program can run here: the loader library, and a driver whose manifest
//! the loader would read. Search order: "Loader-Driver Interface" of the Khronos Vulkan-Loader, Linux.

use std::path::{Path, PathBuf};

use crate::host::Host;

/// What of Vulkan is on a machine.
pub struct Found {
    /// `libvulkan.so.1` is where the dynamic linker looks.
    pub loader: bool,
    /// The manifest of a driver that can run here.
    pub driver: Option<PathBuf>,
    /// The variable that replaces the usual folders of manifests, when it is set.
    pub pinned_by: Option<&'static str>,
}

impl Found {
    /// Whether a program can run.
    pub fn complete(&self) -> bool {
        self.loader && self.driver.is_some()
    }
}

/// Looks for loader and driver.
pub fn find(host: &dyn Host) -> Found {
    let libraries = library_folders(host);
    let pinned_by = ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"].into_iter().find(|name| host.var(name).is_some());
    let manifests = manifests(host, pinned_by);
    Found {
        loader: libraries.iter().any(|folder| host.exists(&folder.join("libvulkan.so.1"))),
        driver: manifests.into_iter().find(|manifest| usable(host, manifest, &libraries)),
        pinned_by,
    }
}

/// The manifests that the loader would read, in its order.
fn manifests(host: &dyn Host, pinned_by: Option<&str>) -> Vec<PathBuf> {
    let mut places = paths(host, "VK_ADD_DRIVER_FILES", "");
    if let Some(name) = pinned_by {
        places = paths(host, name, "");
    } else {
        let home = |rest: &str| host.var("HOME").map(|home| format!("{home}/{rest}")).unwrap_or_default();
        let roots = [
            paths(host, "XDG_CONFIG_HOME", &home(".config")),
            paths(host, "XDG_CONFIG_DIRS", "/etc/xdg"),
            vec!["/etc".into(), "/usr/local/etc".into()],
            paths(host, "XDG_DATA_HOME", &home(".local/share")),
            paths(host, "XDG_DATA_DIRS", "/usr/local/share:/usr/share"),
        ];
        places.extend(roots.concat().into_iter().map(|root| root.join("vulkan/icd.d")));
    }
    let is_manifest = |path: &PathBuf| path.extension().is_some_and(|extension| extension == "json");
    let expand = |place: PathBuf| if is_manifest(&place) { vec![place] } else { host.list(&place) };
    places.into_iter().flat_map(expand).filter(is_manifest).collect()
}

/// The paths in a variable that lists them with colons, or in `default` when it is unset.
fn paths(host: &dyn Host, name: &str, default: &str) -> Vec<PathBuf> {
    let list = host.var(name).unwrap_or_else(|| default.into());
    list.split(':').filter(|path| !path.is_empty()).map(PathBuf::from).collect()
}

/// A driver counts when its library is there and, unless it computes on the processor, when there
/// is a device for it: distributions install the manifests of every vendor together.
fn usable(host: &dyn Host, manifest: &Path, libraries: &[PathBuf]) -> bool {
    let Some(library) = library(host, manifest) else { return false };
    let there = if library.contains('/') {
        let base = manifest.parent().unwrap_or(Path::new(""));
        host.exists(&base.join(&library))
    } else {
        libraries.iter().any(|folder| host.exists(&folder.join(&library)))
    };
    let software = ["lvp", "swiftshader"].iter().any(|name| library.contains(name));
    there && (software || has_device(host))
}

fn library(host: &dyn Host, manifest: &Path) -> Option<String> {
    let manifest: serde_json::Value = serde_json::from_str(&host.read(manifest)?).ok()?;
    Some(manifest.get("ICD")?.get("library_path")?.as_str()?.into())
}

fn has_device(host: &dyn Host) -> bool {
    let render_node = |path: &PathBuf| path.file_name().is_some_and(|n| n.to_string_lossy().starts_with("renderD"));
    host.list(Path::new("/dev/dri")).iter().any(render_node)
        || ["/dev/nvidiactl", "/dev/dxg"].iter().any(|device| host.exists(Path::new(device)))
}

/// The folders of the dynamic linker: `LD_LIBRARY_PATH`, its configuration, and the usual ones.
/// Folders in which the dynamic linker looks.
pub fn library_folders(host: &dyn Host) -> Vec<PathBuf> {
    let mut folders = paths(host, "LD_LIBRARY_PATH", "");
    let mut configurations = vec![PathBuf::from("/etc/ld.so.conf")];
    configurations.extend(host.list(Path::new("/etc/ld.so.conf.d")));
    for text in configurations.iter().filter_map(|path| host.read(path)) {
        folders.extend(text.lines().map(str::trim).filter(|line| line.starts_with('/')).map(PathBuf::from));
    }
    for prefix in ["/usr/local/lib", "/usr/lib", "/lib"] {
        folders.push(format!("{prefix}/{}-linux-gnu", std::env::consts::ARCH).into());
        folders.push(prefix.into());
        folders.push(format!("{prefix}64").into());
    }
    folders
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::host::fake::Fake;

    const LAVAPIPE: &str = r#"{"ICD": {"api_version": "1.3.230", "library_path": "/usr/lib/libvulkan_lvp.so"}}"#;
    const INTEL: &str = r#"{"ICD": {"api_version": "1.3.230", "library_path": "libvulkan_intel.so"}}"#;

    fn lavapipe() -> Fake {
        Fake::default()
            .file("/usr/share/vulkan/icd.d/lvp_icd.x86_64.json", LAVAPIPE)
            .file("/usr/lib/libvulkan_lvp.so", "")
            .file("/usr/lib/libvulkan.so.1", "")
    }

    #[test]
    fn lavapipe_with_its_loader_is_complete() {
        let found = find(&lavapipe());
        assert!(found.complete());
        assert_eq!(found.driver.unwrap(), Path::new("/usr/share/vulkan/icd.d/lvp_icd.x86_64.json"));
    }

    #[test]
    fn an_empty_machine_has_neither() {
        let found = find(&Fake::default());
        assert!(!found.loader && found.driver.is_none() && !found.complete());
    }

    #[test]
    fn a_driver_without_the_loader_is_incomplete() {
        let mut host = lavapipe();
        host.files.remove(Path::new("/usr/lib/libvulkan.so.1"));
        let found = find(&host);
        assert!(found.driver.is_some() && !found.complete());
    }

    #[test]
    fn a_manifest_whose_library_is_gone_does_not_count() {
        let mut host = lavapipe();
        host.files.remove(Path::new("/usr/lib/libvulkan_lvp.so"));
        assert!(find(&host).driver.is_none());
    }

    #[test]
    fn a_broken_manifest_does_not_count() {
        for text in ["", "{", "[]", r#"{"ICD": {}}"#, r#"{"ICD": {"library_path": 3}}"#] {
            let host = lavapipe().file("/usr/share/vulkan/icd.d/lvp_icd.x86_64.json", text);
            assert!(find(&host).driver.is_none(), "{text}");
        }
    }

    #[test]
    fn a_hardware_driver_counts_only_beside_a_device() {
        let intel = Fake::default()
            .file("/usr/share/vulkan/icd.d/intel_icd.x86_64.json", INTEL)
            .file("/usr/lib/libvulkan_intel.so", "");
        assert!(find(&intel).driver.is_none());
        assert!(find(&intel.file("/dev/dri/renderD128", "")).driver.is_some());
    }

    #[test]
    fn a_relative_library_lies_beside_its_manifest() {
        let host = Fake::default()
            .var("VK_ICD_FILENAMES", "/opt/swiftshader/vk_swiftshader_icd.json")
            .file("/opt/swiftshader/vk_swiftshader_icd.json", r#"{"ICD": {"library_path": "./libvk_swiftshader.so"}}"#)
            .file("/opt/swiftshader/./libvk_swiftshader.so", "");
        assert!(find(&host).driver.is_some());
    }

    #[test]
    fn a_pinning_variable_hides_installed_drivers() {
        let found = find(&lavapipe().var("VK_DRIVER_FILES", "/nowhere/icd.json"));
        assert!(found.driver.is_none());
        assert_eq!(found.pinned_by, Some("VK_DRIVER_FILES"));
    }

    #[test]
    fn xdg_folders_and_the_linker_configuration_are_searched() {
        let host = Fake::default()
            .var("HOME", "/h")
            .file("/h/.local/share/vulkan/icd.d/a.json", r#"{"ICD": {"library_path": "libvulkan_lvp.so"}}"#)
            .file("/etc/ld.so.conf.d/site.conf", "# site\n/opt/vulkan/lib\n")
            .file("/opt/vulkan/lib/libvulkan_lvp.so", "")
            .file("/opt/vulkan/lib/libvulkan.so.1", "");
        assert!(find(&host).complete());
    }
}
