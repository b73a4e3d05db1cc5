//! Repairs as a patch.

use similar::TextDiff;

use lint::fix::FixedFile;

/// The change of one file as a unified diff that `patch -p0` takes.
pub fn unified(file: &FixedFile) -> String {
    let name = file.before.name();
    TextDiff::from_lines(file.before.text(), file.after.text())
        .unified_diff()
        .context_radius(3)
        .header(name, name)
        .to_string()
}

#[cfg(test)]
mod tests {
    use super::*;
    use base::text::SourceFile;

    #[test]
    fn a_patch_has_the_changed_line_twice() {
        let before = SourceFile::new("a.vert", "一\n二\n三");
        let after = SourceFile::new("a.vert", "一\nに\n三");
        let text = unified(&FixedFile { before, after });
        assert_eq!(text, "--- a.vert\n+++ a.vert\n@@ -1,3 +1,3 @@\n 一\n-二\n+に\n 三\n\\ No newline at end of file\n");
    }
}
