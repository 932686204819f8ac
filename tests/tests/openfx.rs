//! The OpenFX face in the host of `isophote_tests::ofx`: every effect, generated from the registry.
//!
//! Each trial has a copy of the library to itself, since a plugin knows one host.

#![allow(unsafe_code, reason = "calls through the C table, and reading foreign layouts")]

mod aspect;
mod card;
mod clips;
mod colours;
mod controls;
mod describe;
mod draft;
mod film;
mod look_files;
mod looks;
mod materials;
mod memory;
mod preferences;
mod quirks;
mod reference;
mod regions;
mod render;
mod scale;
mod time;
mod vectors;

use isophote_tests::ofx::plugin::{Binary, Lent};
use isophote_tests::trials::Trials;
use reference::{Expected, expected};

/// Tests by their names.
macro_rules! named {
    ($($module:ident::$test:ident,)*) => {
        &[$((concat!("openfx::", stringify!($module), "::", stringify!($test)), $module::$test)),*]
    };
}

/// A test of the binary, by its name.
type OfTheBinary = (&'static str, fn(&Binary));

/// A test of an effect, by its name.
type OfAnEffect = (&'static str, fn(&Binary, Expected));

/// Tests of the binary, whatever its effects.
const OF_THE_BINARY: &[OfTheBinary] = named! {
    regions::a_bounding_box_shows_the_marks_of_the_project,
    card::frames_on_threads_share_a_card_and_stand_purges,
    card::cards_are_counted_and_one_that_is_not_there_is_told_of,
    card::the_card_and_its_precision_are_grey_on_the_cpu,
    card::tiles_on_a_card_are_parts_of_the_frame,
    card::a_host_that_wants_to_stop_is_heard_while_a_card_computes,
    clips::an_output_that_nobody_takes_is_rendered,
    clips::pixels_that_cannot_be_read_are_told_of,
    clips::a_mask_may_be_any_part_of_its_picture,
    clips::an_inverted_mask_shows_the_effect_beside_its_picture,
    preferences::lengths_are_meant_at_1080_lines,
    colours::other_spaces_are_changed_once,
    colours::the_same_picture_comes_of_every_space,
    colours::neighbours_and_tiles_have_the_colours_of_the_frame,
    colours::what_is_no_colour_is_not_changed,
    controls::tiles_are_supported_as_saved_values_say,
    controls::another_time_is_no_edit,
    controls::what_motion_comes_from_decides_about_tiles_and_controls,
    controls::hosts_without_a_window_are_not_told_of_controls,
    describe::every_node_that_can_be_an_effect_is_one,
    describe::the_working_space_follows_the_host,
    describe::hosts_that_manage_colours_are_asked_for_the_working_space,
    describe::half_floats_are_offered_to_hosts_that_have_them,
    describe::a_host_without_a_needed_suite_is_told,
    looks::hosts_that_tell_of_no_edits_have_no_choice_of_looks,
    looks::an_edit_makes_a_look_custom,
    looks::a_look_is_undone_by_its_choice_in_hosts_that_break_steps,
    looks::the_effect_for_looks_shows_all_that_ships,
    looks::the_effect_for_looks_is_mixed_and_steadied,
    looks::lengths_of_looks_are_those_of_apply,
    looks::tiles_are_supported_as_the_look_allows,
    looks::projects_are_told_of_files_and_clips_that_are_gone,
    look_files::files_are_shown_and_faults_of_theirs_told,
    look_files::rules_for_things_follow_their_numbers,
    look_files::rules_for_things_follow_their_names,
    look_files::files_are_read_again_when_they_change_or_the_user_asks,
    quirks::a_scale_counts_wherever_the_host_says_it,
    regions::a_host_without_tiles_may_give_parts_all_the_same,
    regions::regions_shrink_with_the_scale,
    render::the_colour_space_that_a_host_names_counts,
    render::a_host_that_returns_before_its_threads_gets_the_same_pixels,
    render::unknown_depths_are_refused,
    time::frames_beyond_a_cut_count_for_nothing,
    time::frames_at_once_on_threads_are_the_same,
    time::neighbours_are_given_back_before_the_next_is_taken,
    time::frames_may_cover_less_than_others,
    time::fields_are_steadied_by_their_own_lines,
    time::frames_that_a_host_lacks_count_for_nothing,
    time::hosts_of_single_frames_show_stills_and_say_so_once,
    time::hosts_that_call_every_clip_connected_are_estimated_for,
    vectors::every_convention_means_the_same,
    vectors::unknown_vectors_leave_the_frame_alone,
    vectors::vectors_are_in_pixels_of_the_full_size,
};

/// Tests of every effect.
const OF_EVERY_EFFECT: &[OfAnEffect] = named! {
    aspect::oblong_pixels_show_what_square_ones_show,
    aspect::guides_have_oblong_pixels_too,
    aspect::alpha_and_masks_are_those_of_the_hosts_pixels,
    card::every_effect_equals_the_c_table_on_a_device,
    clips::guides_and_masks_of_unknown_formats_count_as_none,
    draft::drafts_look_like_the_frame_and_their_tiles_are_parts_of_them,
    preferences::marks_that_move_by_themselves_vary_from_frame_to_frame,
    controls::what_is_grey_has_no_effect,
    controls::controls_become_usable_with_what_they_need,
    describe::descriptors_say_what_the_standard_asks_for,
    describe::clips_are_source_and_output_and_in_general_a_mask_and_guides,
    describe::controls_are_the_parameters_of_the_nodes,
    describe::describing_is_the_same_every_time_and_stands_refused_properties,
    looks::looks_of_a_style_come_first_in_its_page,
    looks::choosing_a_look_sets_the_controls_in_one_step,
    materials::materials_of_any_size_are_tiled,
    memory::an_8k_frame_fits_into_4_gib,
    quirks::rows_may_run_downwards_be_padded_and_begin_anywhere,
    quirks::hosts_that_lack_what_can_be_lacked_get_their_pictures,
    quirks::fields_are_rendered_from_their_own_lines,
    regions::a_source_without_bounds_has_no_seams,
    regions::tiles_from_their_regions_of_interest_equal_the_full_frame,
    regions::the_mask_is_needed_where_it_is_used_and_the_result_covers_the_source,
    render::every_effect_equals_the_c_table_in_every_context_depth_and_component,
    render::spaces_and_relations_to_alpha_equal_the_c_table,
    render::the_alpha_of_the_source_stays_unless_it_is_processed,
    render::light_beyond_coverage_survives,
    render::lines_are_shown_alone_or_over_the_source,
    render::guides_enter_in_the_general_context,
    render::object_numbers_and_painted_flow_enter_in_the_general_context,
    render::a_mask_decides_where_the_effect_shows,
    render::identity_is_what_is_rendered,
    render::a_missing_source_is_transparent_black_and_a_missing_output_a_failure,
    render::the_threads_of_the_host_give_the_same_pixels,
    render::twelve_renders_on_four_threads_are_the_same,
    render::a_host_that_wants_to_stop_is_heard,
    scale::half_size_looks_like_full_size_made_smaller,
    time::frames_are_those_of_the_librarys_sequences,
    time::frames_are_asked_for_as_the_values_say,
    time::any_order_and_any_tile_gives_the_same_bits,
};

/// Adds the trials of this file.
pub fn add(trials: &mut Trials) {
    for (name, test) in OF_THE_BINARY {
        trials.add_plain(name, || test(&Lent::new()));
    }
    for effect in expected() {
        for (name, test) in OF_EVERY_EFFECT {
            trials.add(name, effect.node.id, move || test(&Lent::new(), effect));
        }
        trials.add("openfx::memory::an_8k_frame_is_rendered_in_4_gib", effect.node.id, move || {
            memory::an_8k_frame_is_rendered_in_4_gib(&Lent::new(), effect);
        });
        // A minute and more for each effect.
        trials.ignore_last();
    }
}
