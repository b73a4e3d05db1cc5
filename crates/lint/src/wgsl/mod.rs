//! Rules on what WGSL alone has.

mod interface;

// Rules: each in a folder with its name, with its pages.
pub(super) mod atomic_in_read_only_storage;
pub(super) mod binding_layout_differs;
pub(super) mod buffer_size_differs;
pub(super) mod dispatch_counts_items;
pub(super) mod members_differ;
pub(super) mod non_uniform_control_flow;
pub(super) mod output_left_at_zero;
pub(super) mod override_without_value;
pub(super) mod pixel_centre_rounded;
pub(super) mod private_variable_never_set;
pub(super) mod resource_of_another_pass;
pub(super) mod structure_laid_out_differently;
pub(super) mod unknown_entry_point;
pub(super) mod unused_binding;
pub(super) mod vertex_attribute_differs;

#[cfg(test)]
pub(crate) mod testing {
    use crate::{Input, Level, Selection, Settings, run_with};
    use base::diagnostic::Diagnostic;
    use base::text::SourceFile;

    /// What a rule says of a module at the strictest level.
    pub fn found(code: &str, text: &str) -> Vec<Diagnostic> {
        let settings = Settings { selection: Selection::default().at(Level::Heuristic), ..Settings::default() };
        let found = run_with(&[Input::new(SourceFile::new("a.wgsl", text))], &settings);
        assert!(found.iter().all(|d| !d.code.0.starts_with('E')), "{found:#?}\n{text}");
        found.into_iter().filter(|d| d.code.0 == code).collect()
    }

    /// How often.
    pub fn count(code: &str, text: &str) -> usize {
        found(code, text).len()
    }
}
