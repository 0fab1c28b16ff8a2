//! The page that tells what was found.

use std::fmt::Write;

use myo_measure::bands::{BANDS, Figure};
use myo_train::statistics::Sample;

use super::{Aiming, AimingWidth, Made, PUBLISHED_R2, Published, PublishedTraining, TRAININGS, TrainedTo};
use crate::protocol::OverUsers;

const HEAD: &str = "\
# The experiments of the published system

MyoInteract (Bhattarai et al. 2026, [arXiv 2602.15245](https://arxiv.org/abs/2602.15245)) reports two tables, steps and time until users have learnt, and three figures of how they move: \
Fitts' law, positions and velocities. Here they are with users of Myo. `published.json` beside this page holds what was found; page and figures are made of it by the command that found it.
";

const TABLES: &str = "
## How long users learn

Means and standard deviations over users. Published figures are from an RTX 5090, and from the authors' machine for User-in-the-Box.

| task | | users | control steps | time |
|---|---|---|---|---|
";

const ABOUT_TABLES: &str = "
What is alike: body (`mobl-arms-uitb`), targets, dwells and forces, 20 decisions a second, physics every 2 ms. What is not: the reward and the learner; and the end. Ours is reached when the policy without \
its exploration succeeds in 95 % of 1,000 fresh episodes, theirs when the reward curve looked flat to its authors, at 95 % success or more. A user at 95 % is half-learned: the rows tell how long one \
waits for an answer to \"can it be done\", and not which learns sooner. The replication of the paper is not released: \
`pointing-replication` is made of what it says of it and of User-in-the-Box's own files (targets, dwell, reward, four seconds for each target, actions that change activations), with the learner's settings as everywhere here; and an \
episode succeeds when none of its ten targets was missed.
";

const FIGURES: &str = "
## How users move
";

const ABOUT_FIGURES: &str = "
*Method.* Targets of six widths, evenly from the smallest to the largest of the training, at places of the training (at least 30 cm from each to the next). The policy acts without its exploration, the task's noise is on; control runs at the \
rate of the training (the paper trained at 20 Hz and evaluated at 100 Hz). The fingertip, or what points, is recorded every 2 ms and smoothed at 10 Hz. Movement time runs from 5 % of the peak speed to the last entry into the target: reaction and \
dwell are not in it. The shape of a movement is that from 5 % to 5 % of its peak speed, or to the last entry where that is later. Index of difficulty: log2(D/W + 1), W the diameter, D from centre to centre. Conditions are the six widths by three groups of distances with equally many movements; the law goes through the means of \
the conditions of each user, and the table tells the middle user [95 % confidence interval of the mean over users]; the line in the figure goes through the means over users. Effective throughput as in ISO 9241-411. Positions are projections onto the line from where the movement began to the \
centre of the target, velocities the speed along it; both are means over movements at even shares of their duration. The paper gives neither its formula of difficulty nor what it did with the dwell, \
and its range of difficulty is not known, so R² is the one figure that can be held against it, and it hangs on that range. `fastest` is an optimiser of speed, as the published users are, and no person. What people do is from the bands of [People and simulated users](../people.md), which names the sources.
";

impl Published {
    /// As Markdown; figures are expected beside it as SVG.
    pub fn page(&self) -> String {
        let mut page = HEAD.to_owned();
        if !self.trainings.is_empty() {
            page += TABLES;
            for preset in presets(&self.trainings) {
                TRAININGS.iter().filter(|row| row.preset == preset).for_each(|row| page += &published_row(row));
                page += &own_row(&self.trainings, preset);
            }
            page += ABOUT_TABLES;
            page += &made(&self.made, "tables");
        }
        if !self.aiming.is_empty() {
            page += FIGURES;
            page += &self.figures();
            page += ABOUT_FIGURES;
            page += &made(&self.made, "figures");
        }
        page
    }

    fn figures(&self) -> String {
        let names: Vec<&str> = self.aiming.iter().map(|one| &*one.name).collect();
        let mut text = format!(
            "\n| | {} | MyoInteract | people |\n|---|{}---|---|\n",
            names.join(" | "),
            "---|".repeat(names.len())
        );
        for (what, of, published, people) in rows() {
            let cells: Vec<String> = self.aiming.iter().map(of).collect();
            let _ = writeln!(text, "| {what} | {} | {published} | {people} |", cells.join(" | "));
        }
        for (stem, plot) in self.plots() {
            let _ = write!(text, "\n![{}]({stem}.svg)\n", plot.title);
        }
        text
    }
}

type Row = (&'static str, fn(&Aiming) -> String, String, String);

/// What is told of how users aim.
fn rows() -> Vec<Row> {
    let [default, replication] = PUBLISHED_R2;
    let none = String::new;
    vec![
        ("users", |one| one.users.to_string(), none(), none()),
        ("movements, targets missed", |one| format!("{}, {}", one.movements, one.missed), none(), none()),
        (
            "R² of Fitts' law, means of conditions",
            |one| over(one.fitts.r2),
            format!("{default:.2} (default), {replication:.2} (replication)"),
            people(Figure::FitR2),
        ),
        ("R² through single movements", |one| format!("{:.2}", one.r2_of_movements), none(), none()),
        ("slope, s/bit", |one| over(one.fitts.slope_s_per_bit), none(), people(Figure::FitSlope)),
        ("intercept, s", |one| over(one.fitts.intercept_s), none(), none()),
        ("effective throughput, bit/s", |one| over(one.fitts.throughput_bit_s), none(), people(Figure::Throughput)),
        ("range of difficulty, bit", ids, "not told".into(), none()),
        (
            "peak speed, narrowest and widest targets, m/s",
            |one| of_ends(one, |width| width.peak_speed_m_s),
            none(),
            people(Figure::PeakSpeed30),
        ),
        (
            "time of the peak, share of the duration",
            |one| of_ends(one, |width| width.time_of_peak),
            "bell-shaped".into(),
            people(Figure::TimeOfPeak),
        ),
    ]
}

/// The middle user, and the interval of the mean where there are several.
fn over(of: OverUsers) -> String {
    let interval = of.interval.map_or_else(String::new, |[low, high]| format!(" [{low:.2}, {high:.2}]"));
    format!("{:.2}{interval}", of.median)
}

fn ids(one: &Aiming) -> String {
    let all = || one.conditions.iter().map(|condition| condition.id_bit);
    format!("{:.1} to {:.1}", all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max))
}

/// A figure of the narrowest and the widest targets.
fn of_ends(one: &Aiming, of: fn(&AimingWidth) -> f64) -> String {
    match (one.widths.first(), one.widths.last()) {
        (Some(narrow), Some(wide)) => format!("{:.2}, {:.2}", of(narrow), of(wide)),
        _ => "-".into(),
    }
}

/// What people do, by the band that is about a figure.
fn people(figure: Figure) -> String {
    let bound = BANDS.iter().flat_map(|band| band.bounds).find(|bound| bound.figure == figure);
    let distance = if figure == Figure::PeakSpeed30 { ", over 30 cm" } else { "" };
    bound.map_or_else(String::new, |bound| format!("{bound}{distance}"))
}

/// Presets in the order in which they were trained.
fn presets(trainings: &[TrainedTo]) -> Vec<&str> {
    let mut names: Vec<&str> = vec![];
    for training in trainings {
        if !names.contains(&&*training.task) {
            names.push(&training.task);
        }
    }
    names
}

fn published_row(row: &PublishedTraining) -> String {
    let PublishedTraining { system, preset, runs, env_steps: [steps, steps_sd], wall_s: [time, time_sd] } = *row;
    let [steps, steps_sd] = [steps, steps_sd].map(|steps| format!("{:.1}", 1e-6 * steps));
    format!("| `{preset}` | {system} | {runs} | {steps} ± {steps_sd} M | {} |\n", times(time, time_sd))
}

fn own_row(trainings: &[TrainedTo], preset: &str) -> String {
    let mine: Vec<&TrainedTo> = trainings.iter().filter(|training| training.task == preset).collect();
    let over = |of: fn(&TrainedTo) -> f64| Sample::of(&mine.iter().map(|training| of(training)).collect::<Vec<_>>());
    let (Some(first), Some(steps), Some(time)) =
        (mine.first(), over(|one| one.env_steps as f64), over(|one| one.wall_s))
    else {
        return String::new();
    };
    let failed = match mine.iter().filter(|training| !training.reached).count() {
        0 => String::new(),
        some => format!(", {some} of whom did not come to it"),
    };
    format!(
        "| `{preset}` | **Myo**, `{}`, user `{}`, to {:.0} %{failed} | {} | **{:.1} ± {:.1} M** | **{}** |\n",
        first.body,
        first.user,
        100.0 * first.goal,
        mine.len(),
        1e-6 * steps.mean,
        1e-6 * steps.sd,
        times(time.mean, time.sd)
    )
}

/// A time and its standard deviation in the unit that suits it.
fn times(time: f64, sd: f64) -> String {
    let (unit, name) = match time {
        _ if time >= 2.0 * 3600.0 => (3600.0, "h"),
        _ if time >= 120.0 => (60.0, "min"),
        _ => (1.0, "s"),
    };
    format!("{:.1} ± {:.1} {name}", time / unit, sd / unit)
}

/// How something was made.
fn made(all: &[Made], what: &str) -> String {
    let Some(made) = all.iter().find(|made| made.what == what) else { return String::new() };
    let Made { command, machine, device, date, version, wall_s, .. } = made;
    format!("\n`{command}`: {machine}, {device}, {date}, myo {version}; {:.1} min.\n", wall_s / 60.0)
}
