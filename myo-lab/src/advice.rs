//! Why a training that leads nowhere may do so: only what was tested is claimed.

use myo_tasks::{
    Element, FlatTask, Object, Pointer, Reach, Report, Shape, Step, Task, TaskError, TaskWarning, check, places_apart,
    spread,
};
use myo_train::session::{Bottleneck, EpisodeMeans};

/// A finding explains a failure when it concerns at least this share of what fails.
const EXPLAINS: f64 = 0.5;

/// Episodes over which the way between targets is averaged.
const WAYS: u32 = 512;

/// What the tests ask the body, besides what it [reaches](Reach).
pub trait Body: Reach {
    /// The greatest speed of the fingertip (m/s) in some movements with muscles either slack or fully active.
    fn fastest_m_per_s(&self) -> f64;
}

/// What a test came to.
enum Finding {
    /// It concerns the share of the episodes that get to the target; the sentence says what was found and what helps.
    Wrong(f64, String),
    /// Nothing is wrong; what was tested, in words.
    Fine(String),
}

/// The greatest share of episodes that can succeed, as far as the check of a task can tell: those in which no sphere lies
/// out of reach, nor any button whose place is drawn. Others do not count: one that is partly out of reach can still be pressed elsewhere.
pub fn most_success(report: &Report) -> f64 {
    let reached = report.warnings.iter().filter_map(|warning| match warning {
        TaskWarning::PartlyOutOfReach { target, fraction, is_drawn: true, .. } => {
            Some((1.0 - fraction).powi((target.last - target.first + 1) as i32))
        }
        _ => None,
    });
    reached.product()
}

/// At which target so many episodes fail, and why, where a test tells: whether it can be reached, whether muscles can hold
/// the fingertip there, and whether the time suffices. One sentence; where no test finds a cause, it says so.
pub fn likely_cause(task: &Task, body: &dyn Body, recent: &EpisodeMeans) -> String {
    let Some(Bottleneck { target, success }) = recent.bottleneck() else {
        return "no target is missed by recent episodes, so there is no cause to look for".into();
    };
    let flat = task.flat().unwrap_or_default();
    if target >= flat.steps.len() {
        return "the task has fewer targets than the training".into();
    }
    let label = flat.label(target);
    let report = check(task, body);
    let object = flat.steps[target].object;
    let needs_hold = flat.steps[target].needs_hold();
    let findings = [Some(reach(&report, object)), hold(&report, object, needs_hold), time(task, &flat, body)];
    let (mut causes, mut lesser, mut fine) = (Vec::new(), Vec::new(), Vec::new());
    for finding in findings.into_iter().flatten() {
        match finding {
            Finding::Wrong(share, text) if share >= EXPLAINS * (1.0 - success) => causes.push(text),
            Finding::Wrong(_, text) => lesser.push(text),
            Finding::Fine(text) => fine.push(text),
        }
    }
    let head = format!("{label} is the bottleneck, {:.0} % of the episodes that get to it do it", 100.0 * success);
    if !causes.is_empty() {
        return format!("{head}; likely cause: {}", causes.join("; and "));
    }
    let lesser = lesser.iter().map(|text| format!("; {text}, which explains less than half of what fails"));
    format!(
        "{head}; no cause was found{}{}{}; a training with another seed shows whether it was chance",
        if fine.is_empty() { "" } else { ": " },
        fine.join(", "),
        lesser.collect::<String>()
    )
}

/// Whether an object can be reached, as the check of the task finds it.
fn reach(report: &Report, object: usize) -> Finding {
    let error = report.errors.iter().find_map(|error| match error {
        TaskError::OutOfReach { target: element, .. } | TaskError::PathOutOfReach { target: element, .. }
            if concerns(element, object) =>
        {
            Some(Finding::Wrong(1.0, error.to_string()))
        }
        _ => None,
    });
    let warning = report.warnings.iter().find_map(|warning| match warning {
        // A button that stands still can be pressed elsewhere.
        TaskWarning::PartlyOutOfReach { target: element, fraction, is_drawn: true, .. }
            if concerns(element, object) =>
        {
            Some(Finding::Wrong(*fraction, warning.to_string()))
        }
        _ => None,
    });
    error.or(warning).unwrap_or_else(|| Finding::Fine("it can be reached".into()))
}

/// Whether muscles can hold the fingertip in a sphere, as the check of the task finds it.
fn hold(report: &Report, object: usize, needs_hold: bool) -> Option<Finding> {
    let found = report.warnings.iter().find_map(|warning| match warning {
        TaskWarning::CannotHold { target: element, fraction, .. } if concerns(element, object) => {
            Some(Finding::Wrong(*fraction, warning.to_string()))
        }
        _ => None,
    });
    // Where it is out of reach, or nothing has to be held, nothing was tried.
    let out_of_reach =
        |error: &TaskError| matches!(error, TaskError::OutOfReach { target: element, .. } if concerns(element, object));
    let was_tried = needs_hold && !report.errors.iter().any(out_of_reach);
    found.or_else(|| was_tried.then(|| Finding::Fine("muscles can hold the fingertip still there".into())))
}

fn concerns(element: &Element, object: usize) -> bool {
    (element.first..=element.last).contains(&object)
}

/// Whether dwells, and the ways between the targets at the arm's greatest speed, fit into the time limit.
fn time(task: &Task, flat: &FlatTask, body: &dyn Body) -> Option<Finding> {
    // How fast another pointer can be is not known.
    if flat.pointer != Pointer::Fingertip {
        return None;
    }
    let dwells_s = flat.steps.iter().map(|step| step.least_dwell_s(task.control_dt_s)).sum::<f64>();
    let (way_m, speed) = (way(flat), body.fastest_m_per_s());
    let (needed_s, limit_s) = (dwells_s + way_m / speed, task.time_limit_s);
    let figures = format!(
        "dwells of {dwells_s:.2} s and {way_m:.2} m at {speed:.0} m/s, the greatest speed of the arm in tests, take {needed_s:.2} \
         of {limit_s} s"
    );
    if needed_s > limit_s {
        // On average; a good half of the episodes cannot be done.
        return Some(Finding::Wrong(1.0, format!("time: {figures}; raise time_limit_s")));
    }
    Some(Finding::Fine(figures))
}

/// The least way (m) of the fingertip from the first object to the last, on average: from surface to surface.
fn way(flat: &FlatTask) -> f64 {
    let between = |pair: &[Step]| {
        let [from, to] = pair else { return 0.0 };
        let [a, b] = [from, to].map(|step| &flat.objects[step.object]);
        // Where the same object is asked for again there is no way.
        if from.object == to.object {
            return 0.0;
        }
        let rule = b.sphere().and_then(|sphere| sphere.apart).filter(|(previous, _)| *previous == from.object);
        let least = rule.map_or(0.0, |(_, least)| least);
        let ways = (0..WAYS).filter_map(|k| {
            let [from_x, from_y, from_z, to_x, to_y, to_z] = spread(k);
            let [start, end] = places_apart(a, b);
            let way = distance(start.at([from_x, from_y, from_z]), end.at([to_x, to_y, to_z]));
            (way >= least).then(|| (way - size(a) - size(b)).max(0.0))
        });
        let (count, sum) = ways.fold((0_u32, 0.0), |(count, sum), way| (count + 1, sum + way));
        sum / f64::from(count.max(1))
    };
    flat.steps.windows(2).map(between).sum()
}

/// How far (m) from its centre an object's step can be done.
fn size(object: &Object) -> f64 {
    match &object.shape {
        Shape::Sphere(sphere) => sphere.radius.max,
        Shape::Stick(stick) => stick.length() + stick.knob,
        Shape::Button(_) | Shape::Obstacle(_) | Shape::Slider(_) => {
            object.largest().map_or(0.0, |block| 0.5 * distance(block.size, [0.0; 3]))
        }
    }
}

pub(crate) fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use myo_tasks::{Instruction, Item, Range, Region, SphereItem, preset};

    use super::*;

    /// Reaches half a metre in every direction; holds what lies lower than this (m), and moves this fast (m/s).
    struct Doll {
        holds_below: f64,
        fastest: f64,
    }

    const ABLE: Doll = Doll { holds_below: 1.0, fastest: 10.0 };

    impl Reach for Doll {
        fn nearest_in_reach(&self, point: [f64; 3]) -> [f64; 3] {
            let share = 0.5 / distance(point, [0.0; 3]);
            if share < 1.0 { point.map(|x| x * share * (1.0 - 1e-12)) } else { point }
        }

        fn can_hold(&self, centre: [f64; 3], _: f64) -> bool {
            centre[2] < self.holds_below
        }
    }

    impl Body for Doll {
        fn fastest_m_per_s(&self) -> f64 {
            self.fastest
        }
    }

    fn cause(task: &Task, body: &dyn Body, target_success: &[f64], length: f64, final_distance: f64) -> String {
        let targets_done = target_success.iter().sum();
        let success = *target_success.last().unwrap();
        let target_success = target_success.to_vec();
        likely_cause(
            task,
            body,
            &EpisodeMeans { success, targets_done, final_distance, length, episode_return: 0.0, target_success },
        )
    }

    /// The preset with its spheres changed.
    fn typing(change: impl Fn(&mut SphereItem)) -> Task {
        let mut task = Task { control_dt_s: 0.05, ..preset("mobile-typing").unwrap() };
        let Item::Sphere(letter) = &mut task.scene.0["letter"] else { panic!("a sphere") };
        change(letter);
        task
    }

    /// The same with one sphere only.
    fn tap(change: impl Fn(&mut SphereItem)) -> Task {
        typing(|letter| {
            change(letter);
            letter.copies = None;
        })
    }

    /// The task with dwells so long.
    fn dwelling(mut task: Task, seconds: f64) -> Task {
        let Instruction::Dwell(dwell) = &mut task.script[0] else { panic!("a dwell") };
        dwell.for_s = seconds;
        task
    }

    #[test]
    fn spheres_out_of_reach_bound_the_success() {
        assert_eq!(most_success(&check(&typing(|_| {}), &ABLE)), 1.0);
        let most = most_success(&check(&tap(|letter| letter.at.0.x.max = 0.45), &ABLE));
        // x below 0.41, of 0.225 to 0.45.
        assert!((most - 0.185 / 0.225).abs() < 0.02, "{most}");
    }

    #[test]
    fn neither_dwell_nor_time_are_blamed_where_nothing_tested_is_wrong() {
        let task = dwelling(typing(|_| {}), 0.2);
        // Episodes to the last moment, a fingertip that ends near the target or far: what was once taken for a cause.
        for (length, final_distance) in [(80.0, 0.1), (80.0, 0.005), (40.0, 0.005), (40.0, 0.3)] {
            for success in [[0.9, 0.8, 0.7, 0.3, 0.2], [0.1, 0.1, 0.1, 0.1, 0.1], [0.9, 0.9, 0.9, 0.9, 0.2]] {
                let text = cause(&task, &ABLE, &success, length, final_distance);
                assert!(text.contains("is the bottleneck") && text.contains("no cause was found"), "{text}");
                assert!(
                    !text.contains("likely cause") && !text.contains("raise") && !text.contains("shorten"),
                    "{text}"
                );
                assert!(text.contains("it can be reached") && text.contains("hold the fingertip still"), "{text}");
            }
        }
        let text = cause(&task, &ABLE, &[0.9, 0.8, 0.7, 0.3, 0.2], 75.0, 0.1);
        assert!(
            text.starts_with("dwell in letter.4 is the bottleneck, 43 % of the episodes that get to it do it"),
            "{text}"
        );
    }

    #[test]
    fn a_target_out_of_reach_is_the_cause_where_it_explains_what_fails() {
        let task = tap(|letter| letter.at.0.x.max = 0.45);
        let text = cause(&task, &ABLE, &[0.75], 40.0, 0.3);
        assert!(text.contains("likely cause: 1") && text.contains("is out of reach of the model"), "{text}");
        assert!(text.contains("; move the range ") && text.contains(" back"), "{text}");
        let text = cause(&task, &ABLE, &[0.1], 40.0, 0.3);
        assert!(text.contains("no cause was found") && text.contains("which explains less than half"), "{text}");
        let task = tap(|letter| letter.at.0.x = 0.9.into());
        let text = cause(&task, &ABLE, &[0.0], 40.0, 0.3);
        assert!(text.contains("likely cause: letter is out of reach of the model"), "{text}");
    }

    #[test]
    fn what_muscles_cannot_hold_is_the_cause_and_where_they_can_is_told() {
        let high = |letter: &mut SphereItem| letter.at.0.z = Range::new(-0.3, -0.1);
        let task = dwelling(tap(high), 0.2);
        let weak = Doll { holds_below: -0.28, fastest: 10.0 };
        let text = cause(&task, &weak, &[0.1], 40.0, 0.05);
        let (_, told) = text.split_once("likely cause: muscles cannot hold the fingertip still in ").expect(&text);
        let (share, rest) = told.split_once(" % of the range of letter").expect(&text);
        let share: f64 = share.parse().unwrap();
        // 0.18 of 0.2 m, to one of 32 places.
        assert!((share - 90.0).abs() < 100.0 / 32.0, "{text}");
        assert!(rest.contains("they can ") && text.contains(" cm lower, at ("), "{text}");
        // A sphere that is done as soon as it is touched needs no hold.
        let text = cause(&tap(high), &weak, &[0.1], 40.0, 0.05);
        assert!(text.contains("no cause was found") && !text.contains("muscles"), "{text}");
    }

    #[test]
    fn time_is_blamed_only_where_dwells_and_the_fastest_movements_take_longer() {
        let shares = [0.9, 0.8, 0.7, 0.3, 0.2];
        let slow = Doll { fastest: 0.01, ..ABLE };
        let text = cause(&typing(|_| {}), &slow, &shares, 40.0, 0.1);
        assert!(text.contains("likely cause: time: dwells of ") && text.contains("raise time_limit_s"), "{text}");
        let brief = |dwell_s: f64| Task { time_limit_s: 1.0, ..dwelling(typing(|_| {}), dwell_s) };
        let text = cause(&brief(0.1), &ABLE, &shares, 20.0, 0.1);
        assert!(
            text.contains("no cause was found: it can be reached, ") && text.contains("dwells of 0.50 s"),
            "{text}"
        );
        let text = cause(&brief(0.25), &ABLE, &shares, 20.0, 0.1);
        assert!(text.contains("likely cause: time: dwells of 1.25 s"), "{text}");
    }

    #[test]
    fn the_way_is_an_average_over_the_places_of_both_targets() {
        let task = typing(|letter| {
            letter.at.0 = Region { x: Range::new(0.1, 0.4), y: 0.0.into(), z: 0.0.into() };
            letter.radius = 1e-3.into();
            letter.min_distance_from_previous = Some(0.0);
            letter.copies = Some(2);
        });
        // Two numbers between 0.1 and 0.4 differ by a third of that on average; from surface to surface it is 2 mm less, and a
        // little more where the spheres overlap.
        let way = way(&task.flat().unwrap());
        assert!((way - 0.098).abs() < 1e-3, "{way}");
    }

    #[test]
    fn a_training_that_misses_nothing_has_no_cause() {
        assert!(cause(&typing(|_| {}), &ABLE, &[1.0; 5], 20.0, 0.0).contains("no target is missed"));
    }
}
