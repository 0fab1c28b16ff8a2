//! Groups and boxes whose place is drawn anew for every episode, and arcs.

use crate::common::run::{Run, refusal, task, text};
use myo_tasks::{FlatTask, Reach, Task, check};

/// A panel on the wall, somewhere to the left or right and nearer or farther, with two keys and a spot on it, and a lamp that stands
/// still.
const PANEL: &str = "  panel:\n    kind: group\n    at: [[0.4, 0.5], [-0.2, 0.1], 0]\n    tilt_deg: 90\n    objects:\n      a: {kind: button, at: [0, 0.05, 0], size: [0.03, 0.03, 0.01]}\n      b: {kind: button, at: [0, -0.05, 0], size: [0.03, 0.03, 0.01]}\n      spot: {kind: sphere, at: [0.1, 0, -0.02], radius: 0.01}\n  lamp: {kind: sphere, at: [0.5, 0.3, 0], radius: 0.02}";
const TOUR: &str = "  - press: [a, b]\n  - dwell: {in: [spot, lamp], for_s: 0.1}";

/// Where the objects of all steps are in an episode.
fn places(run: &mut Run) -> Vec<[f64; 3]> {
    let steps = run.task.steps.len();
    (0..steps)
        .map(|step| {
            run.state.phase = step as f64;
            run.goal().centre
        })
        .collect()
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[track_caller]
fn assert_near(a: [f64; 3], b: [f64; 3]) {
    assert!((0..3).all(|k| (a[k] - b[k]).abs() < 1e-12), "{a:?}, {b:?}");
}

#[test]
fn a_panel_is_drawn_as_one_and_what_is_not_on_it_stays() {
    let task = task(PANEL, TOUR);
    let (mut x, mut y) = (vec![], vec![]);
    const EPISODES: u32 = 400;
    for episode in 1..=EPISODES {
        let [a, b, spot, lamp] = places(&mut Run::episode(&task, episode))[..] else { panic!("four steps") };
        assert_near(minus(a, b), [0.0, 0.1, 0.0]);
        assert_near(minus(spot, b), [0.02, 0.05, 0.1]);
        assert_near(lamp, [0.5, 0.3, 0.0]);
        assert_eq!(a[2], 0.0);
        x.push(a[0]);
        y.push(a[1] - 0.05);
    }
    for (drawn, least, most) in [(&x, 0.4, 0.5), (&y, -0.2, 0.1)] {
        assert!(drawn.iter().all(|place| (least..=most).contains(place)));
        let mean = drawn.iter().sum::<f64>() / f64::from(EPISODES);
        // Uniform: its deviation is the width over the root of twelve; four standard errors.
        let error = (most - least) / 12_f64.sqrt() / f64::from(EPISODES).sqrt();
        assert!((mean - 0.5 * (least + most)).abs() < 4.0 * error, "{mean}");
    }
    let (mean_x, mean_y) = (0.45, -0.05);
    let together: f64 = x.iter().zip(&y).map(|(x, y)| (x - mean_x) * (y - mean_y)).sum::<f64>() / f64::from(EPISODES);
    assert!(together.abs() < 4.0 * 0.0289 * 0.0866 / 20.0, "both are drawn for themselves: {together}");
}

#[test]
fn ways_are_those_of_what_is_around() {
    let scene = "  wall:\n    kind: group\n    at: [0.5, 0, 0]\n    tilt_deg: 90\n    scale: 0.5\n    objects:\n      key: {kind: button, at: [[0, 0.2], 0, 0], size: [0.06, 0.06, 0.02]}";
    let task = task(scene, "  - press: key");
    let heights: Vec<f64> = (1..=50)
        .map(|episode| {
            let [x, y, z] = places(&mut Run::episode(&task, episode))[0];
            assert!((x - 0.5).abs() < 1e-12 && y.abs() < 1e-12, "up the wall: {x}, {y}");
            z
        })
        .collect();
    let (least, most) = heights.iter().fold((1.0_f64, 0.0_f64), |(lo, hi), &z| (lo.min(z), hi.max(z)));
    assert!((0.0..0.01).contains(&least) && (0.09..=0.1).contains(&most), "{least} to {most}, half of what is written");
    let object = &task.flat().unwrap().objects[0];
    assert!((object.places().z.max - 0.1).abs() < 1e-12 && object.places().z.min.abs() < 1e-12);
}

#[test]
fn what_is_drawn_for_itself_may_not_meet_what_it_stands_beside() {
    let said = |panel: &str| {
        let scene = format!(
            "  a: {{kind: button, at: {panel}, size: [0.03, 0.03, 0.01]}}\n  b: {{kind: obstacle, at: [0.4, 0.1, 0], size: [0.03, 0.03, 0.01]}}"
        );
        refusal(&text(&scene, "  - press: a"))
    };
    assert_eq!(said("[0.4, [0, 0.06], 0]"), "");
    // Up to 0.08 and half a width; the other begins at 0.085.
    assert_eq!(
        said("[0.4, [0, 0.08], 0]"),
        "t.yaml:5:27: a and b overlap by 10.0 mm; move one of them, or make it smaller"
    );
    assert_eq!(said("[[0.2, 0.35], [0, 0.08], 0]"), "", "never beside it");
}

#[test]
fn a_range_in_a_range_and_a_display_that_moves_are_refused() {
    let inner = PANEL.replace("at: [0, 0.05, 0]", "at: [0, [0.04, 0.05], 0]");
    assert_eq!(
        refusal(&text(&inner, TOUR)),
        "t.yaml:9:29: the place of `panel.a` is a range of places in a group whose place is drawn already; give single numbers"
    );
    let grid = "  g: {kind: grid, at: [0.4, 0, 0], rows: 1, columns: 17, pitch: 0.03, of: {kind: button, at: [0, 0, [0, 0.1]], size: [0.01, 0.01, 0.01]}}";
    assert_eq!(
        refusal(&text(grid, "  - press: 1")),
        "t.yaml:4:94: the place of `g.17` is the 17th range of places of groups, of boxes and of spheres in tilted groups, and of sizes of boxes; at most 16 are drawn"
    );
    let wall = "  wall: {kind: obstacle, at: [2, [0, 0.1], 0], tilt_deg: 90, size: [2, 2, 0.02]}\n  spot: {kind: sphere, at: [1.99, 0.2, 0.3], radius: 0.1}";
    let onto = format!(
        "{}technique: {{kind: ray, from: hand, onto: wall}}\n",
        text(wall, "  - dwell: {in: spot, for_s: 0.1}")
    );
    assert_eq!(
        refusal(&onto),
        "t.yaml:10:42: `wall` has a range of places or sizes; a pointer needs a face that stays as it is"
    );
    let lamps = format!("{PANEL}\n  c: {{kind: button, at: [0.4, 0.5, 0], size: [0.03, 0.03, 0.01]}}");
    let refused = refusal(&text(&lamps, "  - react: {among: [a, c], after_s: 1}"));
    assert!(
        refused.ends_with("`c` is not moved with `panel.a` when places are drawn; put both into one group"),
        "{refused}"
    );
}

#[test]
fn spheres_are_drawn_along_the_axes_of_the_group_that_they_are_in() {
    let wall = |more: &str| {
        format!(
            "  wall:\n    kind: group\n    at: [0.5, 0, 0]\n    tilt_deg: 60\n    turn_deg: 20\n    objects:\n      spots: {{kind: sphere, at: [[-0.1, 0.1], [-0.2, 0.2], 0.01], radius: 0.02, copies: 2{more}}}"
        )
    };
    let script = "  - dwell: {in: wall.spots, for_s: 0.1}";
    let refused = refusal(&text(&wall(""), script));
    assert!(
        refused.contains("no distance from the one before can be kept; write `min_distance_from_previous: 0`"),
        "{refused}"
    );
    let task = task(&wall(", min_distance_from_previous: 0"), script);
    let flat = task.flat().unwrap();
    let [up, left] = [[60_f64, 20.0], [0.0, 20.0]].map(|[tilt, turn]: [f64; 2]| {
        let ((s, c), (sin, cos)) = (tilt.to_radians().sin_cos(), turn.to_radians().sin_cos());
        if tilt > 0.0 { [c * cos, c * sin, s] } else { [-sin, cos, 0.0] }
    });
    let (mut most, mut apart) = ([0.0_f64; 2], 0);
    for episode in 1..200 {
        let run = Run::episode(&task, episode);
        let off = |k: usize| {
            let (at, middle) = (run.state.position[k], flat.objects[k].region().at([0.5; 3]));
            let by = [0, 1, 2].map(|axis| at[axis] - middle[axis]);
            let along = [up, left].map(|way| (0..3).map(|axis| by[axis] * way[axis]).sum::<f64>());
            // Nothing is left out of the face.
            assert_near([0, 1, 2].map(|axis| along[0] * up[axis] + along[1] * left[axis]), by);
            along
        };
        let [first, second] = [off(0), off(1)];
        apart += usize::from((first[0] - second[0]).abs() > 0.02);
        most = [0, 1].map(|k| most[k].max(first[k].abs()));
    }
    assert!(most[0] <= 0.1 && most[0] > 0.095 && most[1] <= 0.2 && most[1] > 0.19, "{most:?}");
    assert!(apart > 100, "each copy is drawn for itself: {apart}");
}

#[test]
fn sizes_of_buttons_are_drawn_axis_by_axis_and_keys_as_one() {
    let scene = "  phone: {kind: keyboard, at: [0.3, 0, -0.3], pitch: 0.01, key: [0.005, 0.009]}\n  wide:\n    kind: group\n    scale: 2\n    objects:\n      ok: {kind: button, at: [0.2, 0.1, 0], size: [[0.02, 0.04], [0.01, 0.03], 0.01]}";
    let task = task(scene, "  - press: [phone.q, phone.space, ok]");
    let flat = task.flat().unwrap();
    let (q, ok) = (&flat.objects[0], flat.objects.last().unwrap());
    assert_near(q.block().unwrap().size, [0.007, 0.007, 0.005]);
    assert_near(q.largest().unwrap().size, [0.009, 0.009, 0.005]);
    assert_near(ok.largest().unwrap().size, [0.08, 0.06, 0.02]);
    assert_eq!(flat.objects.iter().filter(|object| object.growth == q.growth).count(), 27);
    let (mut keys, mut widths, mut heights) = (vec![], vec![], vec![]);
    for episode in 1..300 {
        let mut run = Run::episode(&task, episode);
        let half_sizes = [0.0, 1.0, 2.0].map(|step| {
            run.state.phase = step;
            run.goal().button.unwrap().shape.half_size
        });
        let [[q_high, q_wide, q_deep], [bar_high, bar_wide, _], [high, wide, deep]] = half_sizes;
        assert_near([q_high, q_deep, deep], [q_wide, 0.0025, 0.01]);
        // The bar is four pitches and a key wide.
        assert_near([bar_high, bar_wide - 0.02, 0.0], [q_high, q_wide, 0.0]);
        keys.push(2.0 * q_wide);
        widths.push(2.0 * wide);
        heights.push(2.0 * high);
    }
    for (sizes, least, most) in [(&keys, 0.005, 0.009), (&widths, 0.04, 0.08), (&heights, 0.02, 0.06)] {
        let (lo, hi) = sizes.iter().fold((1.0_f64, 0.0_f64), |(lo, hi), &size| (lo.min(size), hi.max(size)));
        let slack = 0.02 * (most - least);
        assert!(least <= lo && lo < least + slack && most - slack < hi && hi <= most, "{lo} to {hi}");
    }
    let same = widths.iter().zip(&heights).filter(|(w, h)| ((*w - 0.04) - (*h - 0.02)).abs() < 1e-3).count();
    assert!(same < 40, "each axis is drawn for itself: {same}");
}

#[test]
fn boxes_may_not_meet_as_large_as_they_become_and_wrong_sizes_are_refused() {
    let said = |size: &str| {
        let scene = format!(
            "  a: {{kind: button, at: [0.4, 0, 0], size: {size}}}\n  b: {{kind: obstacle, at: [0.4, 0.05, 0], size: [0.03, 0.03, 0.01]}}"
        );
        refusal(&text(&scene, "  - press: a"))
    };
    assert_eq!(said("[[0.01, 0.07], 0.03, 0.01]"), "");
    assert!(
        said("[[0.01, 0.09], 0.03, 0.01]").contains("a and b overlap by 10.0 mm"),
        "{}",
        said("[[0.01, 0.09], 0.03, 0.01]")
    );
    assert!(said("[[0.01, 0.07], 0, 0.01]").contains("is 0 m; it must be from 0.001 to 2 m"));
    assert!(said("[[0.07, 0.01], 0.03, 0.01]").contains("goes from 0.07 m to 0.01 m; the smaller end must come first"));
    let keys = "  phone: {kind: keyboard, at: [0.3, 0, -0.3], pitch: 0.01, key: [0.005, 0.011]}";
    assert!(refusal(&text(keys, "  - type: hi")).contains("overlap by 1.0 mm"));
}

#[test]
fn a_button_must_be_in_reach_as_small_as_it_becomes() {
    let key = |size: &str| format!("  key: {{kind: button, at: [0.7, 0, 0], size: {size}}}");
    let said = |size: &str| check(&task(&key(size), "  - press: key"), &Near);
    // 10 cm out of reach, half a height of up to 20 cm before it.
    let report = said("[0.03, [0.1, 0.4], 0.01]");
    assert!(report.errors.is_empty());
    let [warning] = &report.warnings[..] else { panic!("{report:?}") };
    assert!(warning.to_string().starts_with("50.0 % of the range of key is out of reach"), "{warning}");
    assert!(said("[0.03, [0.22, 0.4], 0.01]").warnings.is_empty());
    assert_eq!(said("[0.03, [0.1, 0.15], 0.01]").errors.len(), 1);
}

/// Reaches 60 cm forward.
struct Near;

impl Reach for Near {
    fn nearest_in_reach(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        [x.min(0.6), y, z]
    }
}

#[test]
fn a_button_that_is_drawn_counts_where_none_of_its_face_is_reached() {
    let key = |at: &str| format!("  key: {{kind: button, at: {at}, size: [0.03, 0.03, 0.01], tilt_deg: 90}}");
    let said = |at: &str| {
        let report = check(&task(&key(at), "  - press: key"), &Near);
        assert!(report.errors.is_empty(), "{report:?}");
        report.warnings.iter().map(ToString::to_string).collect::<Vec<_>>()
    };
    assert_eq!(said("[[0.4, 0.5], 0, 0]"), [""; 0]);
    // Eight corners and 24 places within, of which about half are out of reach.
    let found = &said("[[0.4, 0.8], 0, 0]")[..];
    let [warning] = found else { panic!("{found:?}") };
    assert!(warning.starts_with("46.9 % of the range of key is out of reach of the model, "), "{warning}");
    assert!(
        warning.contains("most at (0.80, 0.00, 0.00) m, its face by 19.5 cm; move the range 19.7 cm to "),
        "{warning}"
    );
}

#[test]
fn what_moves_along_a_slanted_display_stays_on_it() {
    let scene = "  display: {kind: obstacle, at: [1, 0, 0], tilt_deg: 60, size: [1, 1, 0.02]}\n  tray:\n    kind: group\n    at: [1, 0, 0]\n    tilt_deg: 60\n    objects:\n      moving:\n        kind: group\n        at: [[-0.1, 0.1], 0, 0.01]\n        objects:\n          spot: {kind: sphere, radius: 0.02}";
    let text = format!(
        "{}technique: {{kind: ray, from: hand, onto: display}}\n",
        text(scene, "  - dwell: {in: spot, for_s: 0.1}")
    );
    assert_eq!(refusal(&text), "");
    let off = text.replace("[[-0.1, 0.1], 0, 0.01]", "[[-0.1, 0.1], 0, 0.05]");
    assert!(
        refusal(&off).contains("`tray.moving.spot` is up to 4.0 cm off the face of `display`"),
        "{}",
        refusal(&off)
    );
}

#[test]
fn the_rest_of_a_rate_cursor_must_be_in_reach_on_all_sides() {
    let wall = "  wall: {kind: obstacle, at: [0.5, 0, 0], tilt_deg: 90, size: [0.4, 0.4, 0.02]}\n  spot: {kind: sphere, at: [0.49, 0.1, 0.1], radius: 0.05}";
    let with = |at: &str| {
        let text = format!(
            "{}technique: {{kind: rate_cursor, onto: wall, at: {at}, gain: 3}}\n",
            text(wall, "  - dwell: {in: spot, for_s: 0.1}")
        );
        let report = check(&Task::from_yaml(&text, "t.yaml").unwrap(), &Near);
        report.errors.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
    };
    assert_eq!(with("[0.3, 0, -0.2]"), "");
    assert_eq!(
        with("[0.58, 0, -0.2]"),
        "the rest of the cursor asks for the fingertip at (0.61, 0.00, -0.20) m, which is out of reach of the model by 1.0 cm; take a \
         place from which it gets 3 cm either way, forward and across"
    );
}

#[test]
fn an_arc_goes_from_left_to_right() {
    let flat = |text: &str| -> FlatTask { task(text, "  - press: fan").flat().unwrap() };
    let key = "of: {kind: button, size: [0.02, 0.02, 0.01]}";
    let fan = flat(&format!(
        "  fan: {{kind: arc, at: [0.3, 0, -0.3], count: 3, radius: 0.1, from_deg: -90, to_deg: 90, names: [l, m, r], {key}}}"
    ));
    let at = |k: usize| fan.objects[k].region().at([0.5; 3]);
    assert_eq!(fan.objects.iter().map(|object| &*object.name).collect::<Vec<_>>(), ["fan.l", "fan.m", "fan.r"]);
    assert_near(at(0), [0.3, 0.1, -0.3]);
    assert_near(at(1), [0.4, 0.0, -0.3]);
    assert_near(at(2), [0.3, -0.1, -0.3]);
    let one = flat(&format!("  fan: {{kind: arc, count: 1, radius: 0.1, {key}}}"));
    let half = 0.1 * 0.5_f64.sqrt();
    assert_near(one.objects[0].region().at([0.5; 3]), [half, half, 0.0]);
}
