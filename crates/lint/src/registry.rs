//! All rules. A rule is one folder, with its code and its pages, and one line here.

use super::rule::Rule;
use super::{glsl, host, program, suppress, wgsl};
use base::diagnostic::Code;

/// Rules on faults that other readers of WGSL let through: what these say of a text is told beside them.
pub const LET_THROUGH: [Code; 2] =
    [wgsl::non_uniform_control_flow::RULE.code, glsl::integer_varying_not_flat::RULE.code];

/// All rules, sorted by code.
pub const RULES: &[&Rule] = &[
    // D. Data flow: values that are missing, not used or lost.
    &glsl::uninitialised_read::RULE,
    &glsl::uninitialised_accumulator::RULE,
    &glsl::output_never_written::RULE,
    &glsl::output_written_on_some_paths::RULE,
    &glsl::partial_output_write::RULE,
    &glsl::unused_variable::RULE,
    &glsl::unused_uniform::RULE,
    &glsl::missing_return::RULE,
    &glsl::out_param_not_written::RULE,
    &glsl::dead_store::RULE,
    &glsl::shadowed_variable::RULE,
    &glsl::maybe_uninitialised_read::RULE,
    &glsl::unused_parameter::RULE,
    &glsl::unused_function::RULE,
    &glsl::varying_written_on_some_paths::RULE,
    &glsl::lost_in_swap::RULE,
    &glsl::same_element_each_round::RULE,
    &glsl::copy_left_as_it_was::RULE,
    &glsl::counter_of_outer_loop::RULE,
    // G. Geometry shaders.
    &glsl::max_vertices_too_small::RULE,
    &glsl::max_vertices_too_large::RULE,
    &glsl::missing_end_primitive::RULE,
    &glsl::no_emit_vertex::RULE,
    &glsl::output_stale_after_emit::RULE,
    &glsl::too_few_vertices_for_primitive::RULE,
    &glsl::geom_input_not_array::RULE,
    &glsl::missing_layout::RULE,
    &glsl::bad_output_primitive::RULE,
    &glsl::position_not_set_before_emit::RULE,
    // H. Host code.
    &host::uniform_lookup_of_attribute::RULE,
    &host::attribute_lookup_of_uniform::RULE,
    &host::unknown_uniform_name::RULE,
    &host::unknown_attribute_name::RULE,
    &host::inactive_name::RULE,
    &host::lookup_of_block_member::RULE,
    &host::attrib_size_mismatch::RULE,
    &host::attrib_integer_pointer::RULE,
    &host::attrib_stride::RULE,
    &host::uniform_setter_type::RULE,
    &host::sampler_setter::RULE,
    &host::lookup_before_link::RULE,
    &host::bind_after_link::RULE,
    &host::assumed_location::RULE,
    &host::status_not_checked::RULE,
    &host::matrix_dimension::RULE,
    &host::shader_source_line_break::RULE,
    &host::stage_mismatch::RULE,
    &host::draw_mode_vs_geometry_input::RULE,
    &host::filled_array_undeclared::RULE,
    &host::strip_adjacency_drops_ends::RULE,
    &host::unknown_interface_name::RULE,
    &host::flag_argument::RULE,
    &host::attribute_not_fed::RULE,
    &host::uniform_without_value::RULE,
    // I. The interface between the stages of a program.
    &program::input_without_producer::RULE,
    &program::interface_type_mismatch::RULE,
    &program::output_without_consumer::RULE,
    &program::interpolation_mismatch::RULE,
    &glsl::integer_varying_not_flat::RULE,
    &program::uniform_type_conflict::RULE,
    &program::geometry_bypass::RULE,
    &program::frag_output_locations::RULE,
    &program::block_drift::RULE,
    &glsl::location_twice::RULE,
    &glsl::function_without_body::RULE,
    &glsl::resource_index_not_uniform::RULE,
    &program::position_not_invariant::RULE,
    // K. Compute kernels: work groups and their memory.
    &glsl::missing_barrier::RULE,
    &glsl::unguarded_invocation::RULE,
    &glsl::guard_in_other_units::RULE,
    &glsl::rows_counted_in_workgroups::RULE,
    &glsl::bytes_as_words::RULE,
    &glsl::index_of_idle_axis::RULE,
    &glsl::strides_of_two_shapes::RULE,
    &glsl::barrier_in_divergent_flow::RULE,
    &glsl::work_group_too_large::RULE,
    &glsl::index_past_shared_array::RULE,
    // N. Numbers: domains of functions, precision, division by zero.
    &glsl::pow_negative_base::RULE,
    &glsl::pow_zero_exponent_zero::RULE,
    &glsl::pow_underflow::RULE,
    &glsl::pow_integer_exponent::RULE,
    &glsl::normalize_maybe_zero::RULE,
    &glsl::acos_asin_domain::RULE,
    &glsl::asin_acos_precision::RULE,
    &glsl::sqrt_log_domain::RULE,
    &glsl::division_by_zero::RULE,
    &glsl::one_argument_atan::RULE,
    &glsl::clamp_min_gt_max::RULE,
    &glsl::mix_t_range::RULE,
    &glsl::degrees_as_radians::RULE,
    &glsl::low_precision_pi::RULE,
    &glsl::literal_out_of_range::RULE,
    &glsl::normal_not_normalised::RULE,
    &glsl::cosine_not_clamped::RULE,
    &glsl::unnormalised_weights::RULE,
    &glsl::missing_homogeneous_divide::RULE,
    &glsl::normal_by_model_matrix::RULE,
    &glsl::catastrophic_cancellation::RULE,
    &glsl::nan_test_removed::RULE,
    &glsl::scalar_added_to_position::RULE,
    &glsl::step_does_not_guard::RULE,
    &glsl::logarithm_base::RULE,
    &glsl::direction_moved::RULE,
    &glsl::whole_vector_guard::RULE,
    &glsl::remainder_of_negative::RULE,
    &glsl::loop_beyond_array::RULE,
    &glsl::texel_edge::RULE,
    &glsl::mix_ends_swapped::RULE,
    &glsl::unsigned_wraps::RULE,
    &glsl::quotient_below_zero::RULE,
    &glsl::extreme_from_zero::RULE,
    &glsl::epsilon_without_effect::RULE,
    &glsl::factor_of_one_term::RULE,
    &glsl::index_rounded_to_size::RULE,
    &glsl::mediump_epsilon::RULE,
    &glsl::mediump_digits::RULE,
    &glsl::rounding_order::RULE,
    &glsl::mediump_square::RULE,
    &glsl::mediump_time::RULE,
    &glsl::mediump_position::RULE,
    &glsl::index_at_closed_end::RULE,
    // P. Cost.
    &glsl::inverse_in_shader::RULE,
    &glsl::matrix_chain_order::RULE,
    &glsl::scalar_matrix_vector_order::RULE,
    // T. Types and constructors.
    &glsl::constructor_too_many_args::RULE,
    &glsl::constructor_too_few_args::RULE,
    &glsl::assign_size_mismatch::RULE,
    &glsl::matrix_vector_dim::RULE,
    &glsl::integer_division_literal::RULE,
    &glsl::implicit_int_to_float::RULE,
    &glsl::float_literal_suffix::RULE,
    &glsl::scalar_swizzle::RULE,
    &glsl::swizzle_range_or_mix::RULE,
    &glsl::vector_relational_operator::RULE,
    &glsl::hlsl_name::RULE,
    &glsl::float_modulo::RULE,
    &glsl::float_equality::RULE,
    &glsl::assignment_in_condition::RULE,
    &glsl::empty_body::RULE,
    &glsl::constant_index_out_of_range::RULE,
    &glsl::ambiguous_overload_int_args::RULE,
    &glsl::write_to_read_only::RULE,
    &glsl::image_format::RULE,
    &glsl::identical_operands::RULE,
    &glsl::condition_never_varies::RULE,
    &glsl::argument_twice::RULE,
    &glsl::one_channel_of_colour::RULE,
    // V. Versions, profiles and extensions of the language.
    &glsl::missing_or_late_version::RULE,
    &glsl::feature_needs_version::RULE,
    &glsl::deprecated_in_profile::RULE,
    &glsl::reserved_identifier::RULE,
    &glsl::shadows_builtin::RULE,
    &glsl::non_constant_global_init::RULE,
    &glsl::noise_function::RULE,
    &glsl::token_paste_or_include::RULE,
    &glsl::missing_precision_es::RULE,
    &glsl::extension_not_enabled::RULE,
    &glsl::per_vertex_redeclared::RULE,
    &glsl::misspelt_macro::RULE,
    // WGSL.
    &wgsl::non_uniform_control_flow::RULE,
    &wgsl::atomic_in_read_only_storage::RULE,
    &wgsl::private_variable_never_set::RULE,
    &wgsl::pixel_centre_rounded::RULE,
    &wgsl::unused_binding::RULE,
    &wgsl::override_without_value::RULE,
    &wgsl::unknown_entry_point::RULE,
    &wgsl::structure_laid_out_differently::RULE,
    &wgsl::vertex_attribute_differs::RULE,
    &wgsl::binding_layout_differs::RULE,
    &wgsl::dispatch_counts_items::RULE,
    &wgsl::buffer_size_differs::RULE,
    &wgsl::members_differ::RULE,
    &wgsl::resource_of_another_pass::RULE,
    &wgsl::output_left_at_zero::RULE,
    // X. Comments that silence rules.
    &suppress::unused_suppression::RULE,
    &suppress::bad_suppression::RULE,
];

/// The rule with this code or name; letters may be small or capital, and `_` counts as `-`.
pub fn by_code(given: &str) -> Option<&'static Rule> {
    RULES.iter().copied().find(|r| r.is_called(given))
}

/// A code as people are shown it: with the name of its rule, when a rule has it.
pub fn with_name(code: &str) -> String {
    match by_code(code) {
        Some(rule) => format!("{} {}", rule.code, rule.name),
        None => code.to_owned(),
    }
}

/// Up to three rules whose codes or names look most like `given`, as [`with_name`] writes them.
pub fn nearest(given: &str) -> Vec<String> {
    let mut scored: Vec<(f64, &'static str)> = RULES
        .iter()
        .map(|r| {
            let code = strsim::normalized_damerau_levenshtein(&given.to_ascii_uppercase(), r.code.0);
            let name = given.to_ascii_lowercase().replace('_', "-");
            (code.max(strsim::normalized_damerau_levenshtein(&name, r.name)), r.code.0)
        })
        .filter(|&(score, _)| score >= 0.5)
        .collect();
    scored.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(b.1)));
    scored.into_iter().take(3).map(|(_, code)| with_name(code)).collect()
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::Input;
    use crate::tests::at_its_level;
    use base::diagnostic::{Diagnostic, Lang};
    use base::text::SourceFile;

    #[test]
    fn codes_and_names_are_unique_and_sorted() {
        assert!(RULES.windows(2).all(|w| w[0].code < w[1].code));
        let names: BTreeSet<_> = RULES.iter().map(|r| r.name).collect();
        assert_eq!(names.len(), RULES.len());
    }

    #[test]
    fn every_rule_has_all_its_parts() {
        for rule in RULES {
            let code = rule.code.0;
            let digits = code.strip_prefix(|c: char| c.is_ascii_uppercase()).unwrap_or("");
            assert!(digits.len() == 3 && digits.bytes().all(|b| b.is_ascii_digit()), "{code}");
            assert!(rule.name.contains('-'), "{code}: {}", rule.name);
            assert!(rule.name.bytes().all(|b| b.is_ascii_lowercase() || b == b'-'), "{code}: {}", rule.name);
            let pages = &rule.pages;
            let parts = |lang| [("summary", pages.summary(lang)), ("what", pages.what(lang)), ("why", pages.why(lang))];
            for (part, text) in parts(Lang::En) {
                assert!(text.len() > 20, "{code}: {part} is too short to be one");
            }
            let fix = pages.fix(Lang::En).to_lowercase();
            assert!(["safe", "unsafe", "no fix"].iter().any(|w| fix.contains(w)), "{code}: the fix states its safety");
            let japanese = |text: &str| text.chars().any(|c| ('\u{3040}'..='\u{30ff}').contains(&c));
            for (part, text) in parts(Lang::Ja).into_iter().chain([("fix", pages.fix(Lang::Ja))]) {
                assert!(japanese(&text), "{code}: {part} in Japanese");
            }
            assert!(!pages.bad().is_empty() && !pages.good().is_empty(), "{code}: no example");
        }
    }

    #[test]
    fn every_bad_example_reports_its_rule_alone_and_every_good_one_is_clean() {
        let mut wrong = Vec::new();
        for rule in RULES {
            let lint = |files: &[crate::Example]| {
                let inputs: Vec<Input> = files.iter().map(|f| Input::new(SourceFile::new(f.name, f.text))).collect();
                at_its_level(rule, &inputs)
            };
            let reported = |found: &[Diagnostic]| -> Vec<String> {
                found.iter().map(|d| format!("{} {}: {}", d.code, d.file.locate(d.span.start), d.message)).collect()
            };
            let bad = lint(&rule.pages.bad());
            match bad.as_slice() {
                [one] if one.code == rule.code => {
                    let advice = one.fix.as_ref().map(|f| &f.title).or(one.help.as_ref());
                    let words = [Some(&one.message), one.why.as_ref(), advice];
                    let complete = words.iter().all(|w| w.is_some_and(|w| !w.is_empty() && w.is_translated()));
                    let label = one.label.is_empty() || one.label.is_translated();
                    let related = one.related.iter().all(|l| l.message.is_empty() || l.message.is_translated());
                    if one.severity != rule.severity || !complete || !label || !related {
                        wrong.push(format!("{}: words or severity: {one:#?}", rule.code));
                    }
                }
                _ => wrong.push(format!("bad example of {}: {:#?}", rule.code, reported(&bad))),
            }
            let good = lint(&rule.pages.good());
            if !good.is_empty() {
                wrong.push(format!("good example of {}: {:#?}", rule.code, reported(&good)));
            }
        }
        assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    }

    #[test]
    fn the_folder_of_a_rule_has_its_name() {
        for rule in RULES {
            let folder = rule.name.replace('-', "_");
            let wings = ["glsl", "host", "program", "suppress", "wgsl"];
            let code = wings.map(|wing| std::fs::read_to_string(format!("src/{wing}/{folder}/mod.rs")).ok());
            let code = code.into_iter().flatten().next().unwrap_or_else(|| panic!("no folder {folder}"));
            assert!(code.contains(&format!("code: Code(\"{}\")", rule.code)), "{folder} is another rule");
        }
    }

    #[test]
    fn rules_are_found_by_code_and_name() {
        assert_eq!(by_code("t001").map(|r| r.code.0), Some("T001"));
        assert_eq!(by_code("low-precision-pi").map(|r| r.code.0), Some("N014"));
        assert_eq!(by_code("Low_Precision_PI").map(|r| r.code.0), Some("N014"));
        assert!(by_code("T999").is_none());
        assert_eq!(nearest("T01").first().map(String::as_str), Some("T001 constructor-too-many-args"));
        assert_eq!(nearest("low_precision_p").first().map(String::as_str), Some("N014 low-precision-pi"));
        assert!(nearest("zzzzzzzz").is_empty());
        assert_eq!((with_name("t001"), with_name("E001")), ("T001 constructor-too-many-args".into(), "E001".into()));
    }
}
