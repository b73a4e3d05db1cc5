//! Finds out whether Mesa's OpenGL can run here without a window: libEGL of the system, Mesa's part of it, and its
//! drivers for the processor.

use std::path::Path;

use crate::host::Host;
use crate::vulkan::library_folders;

/// Debian's and Ubuntu's packages.
pub const PACKAGES: [&str; 3] = ["libegl1", "libegl-mesa0", "libgl1-mesa-dri"];

/// Whether a program can run.
pub fn is_there(host: &dyn Host) -> bool {
    let libraries = library_folders(host);
    let any = |names: &[&str]| names.iter().any(|name| libraries.iter().any(|folder| host.exists(&folder.join(name))));
    let drivers =
        host.var("LIBGL_DRIVERS_PATH").is_some_and(|path| host.exists(&Path::new(&path).join("swrast_dri.so")));
    // Since 24.2 the drivers are one library.
    any(&["libEGL.so.1"]) && any(&["libEGL_mesa.so.0"]) && (drivers || any(&["dri/swrast_dri.so", "libgallium_dri.so"]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::host::fake::Fake;

    #[test]
    fn all_parts_are_needed() {
        let parts = ["/usr/lib/libEGL.so.1", "/usr/lib/libEGL_mesa.so.0", "/usr/lib/dri/swrast_dri.so"];
        let without = |left_out: usize| {
            let kept = parts.iter().enumerate().filter(|(k, _)| *k != left_out);
            kept.fold(Fake::default(), |host, (_, path)| host.file(path, ""))
        };
        assert!(is_there(&without(parts.len())));
        for left_out in 0..parts.len() {
            assert!(!is_there(&without(left_out)), "{}", parts[left_out]);
        }
    }
}
