//! Rules on host code and on the shaders that it feeds.

mod attributes;
#[cfg(test)]
mod look_alikes;
mod settings;

// Rules: each in a folder with its name, with its pages.
pub(super) mod assumed_location;
pub(super) mod attrib_integer_pointer;
pub(super) mod attrib_size_mismatch;
pub(super) mod attrib_stride;
pub(super) mod attribute_lookup_of_uniform;
pub(super) mod attribute_not_fed;
pub(super) mod bind_after_link;
pub(super) mod draw_mode_vs_geometry_input;
pub(super) mod filled_array_undeclared;
pub(super) mod flag_argument;
pub(super) mod inactive_name;
pub(super) mod lookup_before_link;
pub(super) mod lookup_of_block_member;
pub(super) mod matrix_dimension;
pub(super) mod sampler_setter;
pub(super) mod shader_source_line_break;
pub(super) mod stage_mismatch;
pub(super) mod status_not_checked;
pub(super) mod strip_adjacency_drops_ends;
pub(super) mod uniform_lookup_of_attribute;
pub(super) mod uniform_setter_type;
pub(super) mod uniform_without_value;
pub(super) mod unknown_attribute_name;
pub(super) mod unknown_interface_name;
pub(super) mod unknown_uniform_name;
