// The looks in the order of all lists: a line for each style or medium.
looks! {
    saturday_comic clear_line noir_panel cut_paper evening_cel faded_annual
    soft_gouache palette_knife wild_colour candlelight
    impasto old_varnish swirling_sky dry_brush grisaille
    wet_in_wet botanical_plate rough_paper grey_wash pale_memory
    combed travel_poster enamel silver_print sun_bleached
    midnight_blueprint drafting_film chalkboard kraft_plan amber_terminal
    graphite_study red_chalk blue_pencil coloured_pencils
    copperplate fineliner brush_and_ink sepia_pen
    willow_charcoal toned_paper stormy_blue
    woodcut_broadside linocut vermilion_block
    soft_pastel oil_crayons fresco
}
