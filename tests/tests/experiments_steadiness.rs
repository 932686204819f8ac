//! Experiment 16: how steady the styles are over time, from colour and motion alone: on the demo scene along its camera's
//! path, on a running fox and on a static shot with noise, without and with `steadiness`.
//!
//! `ISOPHOTE_STYLES=cartoon,ink` runs those styles alone, `ISOPHOTE_PICTURES=FOLDER` writes what they draw. With
//! `ISOPHOTE_TABLES`, which `cargo xtask experiments` sets, they are measured by frames on both sides and by estimated motion, too;
//! by frames on both sides on plain paper as well, where paper stays on the screen and things move past it, and with normals, depth
//! and ids.

use isophote_tests::device::device;
use isophote_tests::steadiness::{Entry, Row, Shot, Style, rendered_shots, table};
use isophote_tests::table::Table;

/// Styles and filters.
const STYLES: [&str; 7] =
    ["cartoon", "ink", "blueprint", "coherent", "watercolor", "oil_paint", "anisotropic_kuwahara"];

/// The most that the steady ones may have of the warping error of the same style without, and of its answer to noise.
const MOST: [f64; 2] = [0.98, 0.65];

/// Share of the gradient energy of the same style without that the steady ones keep at least: what fades in and out is fainter
/// meanwhile.
const LEAST_ENERGY: f64 = 0.94;

/// Setting of presets for sequences.
const STEADINESS: (&str, &str) = ("steadiness", "0.5");

/// Frames that real time knows beside the present one: those before, of which two count and more have motion that
/// carries marks.
const AROUND: [u32; 2] = [8, 0];

/// Frames that sequences of files know: as many after as count.
const BOTH_WAYS: [u32; 2] = [8, 2];

/// A style's frames for themselves, and steady ones.
struct Pair {
    name: &'static str,
    still: Row,
    steady: Row,
    more: Option<More>,
}

/// What is measured for the tables alone.
struct More {
    /// By frames before and after.
    both_ways: Row,
    /// The same on plain paper, for styles whose paper stays on the screen.
    plain_paper: Option<Row>,
    /// By frames before and after, with normals, depth and object numbers.
    guided: Row,
    /// By motion that is estimated.
    estimated: Row,
}

/// Settings of styles whose paper stays on the screen, while things move past it, that leave it plain.
const PLAIN_PAPER: [(&str, [(&str, &str); 2]); 2] = [
    ("blueprint", [("grid", "0"), ("paper_texture", "0")]),
    ("watercolor", [("granulation", "0"), ("dry_brush", "0")]),
];

/// The most pixels of styles of lines that jump by frames before and after.
const MOST_JUMPS: f64 = 0.003;

fn measured(shot: &Shot) -> Vec<Pair> {
    let chosen = std::env::var("ISOPHOTE_STYLES").ok();
    let is_chosen =
        |name: &str| chosen.as_ref().is_none_or(|all| all.split(',').any(|one| one.trim() == name));
    let has_tables = std::env::var_os("ISOPHOTE_TABLES").is_some();
    let styles = STYLES.into_iter().filter(|name| is_chosen(name));
    styles
        .map(|name| {
            let of = |settings: &[(&str, &str)]| Style::new(name, settings);
            let steady = || of(&[STEADINESS]).without_guides();
            let entry = |kind: &str, style: Style, around| {
                Entry::new(format!("{name} {kind}"), style.play(shot, around)).against(name)
            };
            let still = Entry::new(name, of(&[]).without_guides().play(shot, AROUND));
            let mut entries = vec![still, entry("steady", steady(), AROUND)];
            let paper =
                PLAIN_PAPER.into_iter().find(|(style, _)| *style == name).map(|(_, settings)| settings);
            if has_tables {
                entries.push(entry("both ways", steady(), BOTH_WAYS));
                entries.push(entry("estimated", steady().estimating(), AROUND));
                entries.push(entry("guided", of(&[STEADINESS]), BOTH_WAYS));
                let plain = paper.map(|[grid, grain]| of(&[STEADINESS, grid, grain]).without_guides());
                entries.extend(plain.map(|style| entry("plain paper", style, BOTH_WAYS)));
            }
            let mut rows = table(shot, entries).into_iter();
            let (Some(still), Some(steady)) = (rows.next(), rows.next()) else { panic!("two rows") };
            let more = rows.next().zip(rows.next()).zip(rows.next());
            let more = more.map(|((both_ways, estimated), guided)| More {
                both_ways,
                plain_paper: rows.next(),
                guided,
                estimated,
            });
            Pair { name, still, steady, more }
        })
        .collect()
}

fn print(title: &str, pairs: &[Pair]) {
    let columns = [
        "style",
        "frames for themselves",
        "steady",
        "gradient energy kept",
        "steady by optical flow",
        "steady, a contrast",
        "jumps, % of pixels",
        "frames on both sides, a contrast",
        "jumps",
        "energy kept",
        "on plain paper, a contrast",
        "with normals, depth and ids, a contrast",
    ];
    let mut table = Table::new(16, "steadiness over time", title, &columns);
    for Pair { name, still, steady, more } in pairs {
        let of = |measure: fn(&More) -> String| more.as_ref().map_or_else(|| "–".into(), measure);
        table.row(&[
            (*name).to_owned(),
            format!("{:.2}", still.steadiness.ratio),
            format!("{:.2}", steady.steadiness.ratio),
            format!("{:.3}", steady.steadiness.energy_of_still),
            of(|more| format!("{:.2}", more.estimated.steadiness.ratio)),
            format!("{:.2}", steady.steadiness.a_contrast()),
            format!("{:.2}", 100.0 * steady.steadiness.jumps),
            of(|more| format!("{:.2}", more.both_ways.steadiness.a_contrast())),
            of(|more| format!("{:.2}", 100.0 * more.both_ways.steadiness.jumps)),
            of(|more| format!("{:.3}", more.both_ways.steadiness.energy_of_still)),
            of(|more| {
                let plain = more.plain_paper.as_ref();
                plain.map_or_else(|| "–".into(), |row| format!("{:.2}", row.steadiness.a_contrast()))
            }),
            of(|more| format!("{:.2}", more.guided.steadiness.a_contrast())),
        ]);
    }
    table.print();
}

#[test]
fn steady_styles_exaggerate_less_along_the_path_of_the_camera() {
    let Some(_) = device("the demo scene") else { return };
    let pairs = measured(&rendered_shots::demo(rendered_shots::size()).unwrap());
    print(
        "Warping error over that of the plain frames: demo scene, camera on its path, the last two frames count",
        &pairs,
    );
    for Pair { name, still, steady, .. } in &pairs {
        let [before, after] = [still.steadiness.ratio, steady.steadiness.ratio];
        assert!(after <= MOST[0] * before, "{name}: {before:.3} -> {after:.3}");
        let kept = steady.steadiness.energy_of_still;
        assert!(kept >= LEAST_ENERGY, "{name} keeps {kept:.3} of its energy");
    }
    assert_few_jumps(&pairs);
}

#[test]
fn steady_styles_exaggerate_less_on_a_running_fox() {
    let Some(_) = device("the fox") else { return };
    let Some(shot) = rendered_shots::fox(rendered_shots::size()) else {
        eprintln!("\n*** SKIPPED: no fox beside the checkout ***\n");
        return;
    };
    let pairs = measured(&shot.unwrap());
    print("Warping error over that of the plain frames: a running fox, the last two frames count", &pairs);
    for Pair { name, still, steady, .. } in &pairs {
        let [before, after] = [still.steadiness.ratio, steady.steadiness.ratio];
        // What is drawn on the paper stays there while the fox runs.
        assert!(after < before, "{name}: {before:.3} -> {after:.3}");
    }
    assert_few_jumps(&pairs);
}

/// Lines fade by frames on both sides, where these are measured.
fn assert_few_jumps(pairs: &[Pair]) {
    for Pair { name, more, .. } in pairs {
        let Some(More { both_ways, .. }) = more else { continue };
        let jumps = both_ways.steadiness.jumps;
        let has_lines = ["cartoon", "ink", "blueprint"].contains(name);
        assert!(!has_lines || jumps <= MOST_JUMPS, "{name}: {:.2} % of pixels jump", 100.0 * jumps);
    }
}

#[test]
fn steady_styles_draw_less_noise() {
    let Some(_) = device("the static shot") else { return };
    let shot = rendered_shots::demo(rendered_shots::size()).unwrap();
    let shot = Shot::noisy(&shot.frames[shot.frames.len() / 2], 6, 0.01);
    let pairs = measured(&shot);
    print("Warping error over that of the plain frames: static shot with 1 % noise", &pairs);
    for Pair { name, still, steady, .. } in &pairs {
        let [before, after] = [still.steadiness.ratio, steady.steadiness.ratio];
        assert!(after <= MOST[1] * before, "{name}: {before:.3} -> {after:.3}");
    }
}
