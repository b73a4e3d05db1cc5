//! Texts that an editor shows beside a file, in a folder of their own that goes with the server.

use std::path::{Path, PathBuf};

use ls_types::Uri;

/// The folder, once there is a text.
#[derive(Default)]
pub(super) struct Views(Option<PathBuf>);

impl Views {
    /// Writes a text, in the place of an older one of this title; none where it cannot be written.
    pub fn write(&mut self, title: &str, ending: &str, text: &str) -> Option<Uri> {
        if self.0.is_none() {
            let folder = std::env::temp_dir().join(format!("shadercheck-lsp-{}", std::process::id()));
            // One that is there is someone else's.
            std::fs::create_dir(&folder).ok()?;
            self.0 = Some(folder);
        }
        let plain = |c: char| if c.is_alphanumeric() || "._-".contains(c) { c } else { '-' };
        let name: String = title.chars().take(80).map(plain).collect();
        let path = self.0.as_ref()?.join(format!("{name}.{ending}"));
        disk::fresh::write(&path, text.as_bytes()).ok()?;
        Uri::from_file_path(Path::new(&path))
    }
}

impl Views {
    /// True for a file of the folder: what is found in it is not the author's.
    pub fn has(&self, name: &str) -> bool {
        self.0.as_ref().is_some_and(|folder| Path::new(name).starts_with(folder))
    }
}

impl Drop for Views {
    fn drop(&mut self) {
        if let Some(folder) = &self.0 {
            // What is left lies in the folder for temporary files.
            drop(std::fs::remove_dir_all(folder));
        }
    }
}
