//! How often `compare` tells two layouts apart, and how often a layout from itself.
//!
//! `myo train a.yaml --seeds 40 --out a`, the same of `b.yaml`, then
//! `cargo run --release -p myo-benches --example comparisons -- a b [--users 5] [--repeat 200]`

use std::error::Error;
use std::path::{Path, PathBuf};

use clap::Parser;
use myo::{Comparison, Group, Quantity, TrainedUser, Verdict};
use myo_scalar::{Counter, Word, philox, unit};
use myo_train::RunFolder;

/// Draws so many of the trained users of each layout, compares them as `myo compare` does, and counts the comparisons that
/// claim a difference in the time per episode, or in anything.
#[derive(Parser)]
struct Arguments {
    /// Folder that `myo train --seeds` made
    first: PathBuf,
    /// The other one
    second: PathBuf,
    /// Users of each layout in a comparison
    #[arg(long, default_value = "5")]
    users: usize,
    /// Comparisons
    #[arg(long, default_value = "200")]
    repeat: u32,
}

fn main() -> Result<(), Box<dyn Error>> {
    let args = Arguments::parse();
    let [a, b] = [group(&args.first)?, group(&args.second)?];
    for group in [&a, &b] {
        let (name, found, needed) = (&group.name, group.users.len(), 2 * args.users);
        if found < needed {
            return Err(format!("{name} has {found} trained users; comparisons of {} need {needed}", args.users).into());
        }
    }
    println!("{}", Comparison::new(&a, &b));
    for (what, one, other) in [("each other", &a, &b), ("itself", &a, &a), ("itself", &b, &b)] {
        let same = std::ptr::eq(one, other);
        let (mut time, mut anything) = (0, 0);
        for number in 0..args.repeat {
            // Nobody is compared with himself.
            let (first, rest) = drawn(one, args.users, [number, 0]);
            let second = drawn(if same { &rest } else { other }, args.users, [number, 1]).0;
            let claims = claims(&Comparison::new(&first, &second));
            time += u32::from(claims.contains(&Quantity::EpisodeLengthS));
            anything += u32::from(!claims.is_empty());
        }
        let names = if same { one.name.clone() } else { format!("{} and {}", one.name, other.name) };
        println!("{names}, from {what}: a difference in time in {time} of {}, in anything in {anything}", args.repeat);
    }
    Ok(())
}

/// All users in a folder of seeds.
fn group(folder: &Path) -> Result<Group, Box<dyn Error>> {
    let mut runs: Vec<PathBuf> =
        std::fs::read_dir(folder)?.map(|entry| Ok(entry?.path())).collect::<std::io::Result<_>>()?;
    runs.retain(|path| path.is_dir());
    runs.sort();
    let runs = runs.iter().map(|path| RunFolder::open(path)).collect::<Result<Vec<_>, _>>()?;
    Ok(Group::of_runs(folder.display().to_string(), &runs)?)
}

/// So many users, and the others; the draw has a number.
fn drawn(group: &Group, count: usize, [number, stream]: [u32; 2]) -> (Group, Group) {
    let mut users: Vec<(f64, &TrainedUser)> = (0..).map(|k| draw(number, stream, k)).zip(&group.users).collect();
    users.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    let of = |users: &[(f64, &TrainedUser)]| {
        let users = users.iter().map(|&(_, user)| user.clone()).collect();
        Group { users, ..group.clone() }
    };
    let (first, rest) = users.split_at(count);
    (of(first), of(rest))
}

/// Uniform in [0, 1).
fn draw(number: u32, stream: u32, user: u32) -> f64 {
    let [seed, step, env, stream, episode] = [1, number, user, stream, 0].map(Word::splat);
    unit::<f64>(philox::<f64>(Counter { seed: [seed; 2], env, episode, step, stream })[0])
}

/// Quantities in which a difference is claimed.
fn claims(comparison: &Comparison) -> Vec<Quantity> {
    let claimed = comparison.differences.iter().filter(|d| matches!(d.verdict, Verdict::Higher | Verdict::Lower));
    claimed.map(|difference| difference.quantity).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ten users of a layout, each a little different.
    fn layout(name: &str, seconds: f64) -> Group {
        let user = |k: u32| {
            let evaluation = serde_json::json!({
                "success": 1.0, "success_interval": null, "episodes": 1000, "targets": [],
                "final_distance_m": null, "final_distance_m_interval": null, "effort": null, "effort_interval": null,
                "episode_length_s": seconds + 0.01 * f64::from(k % 3), "episode_length_s_interval": null,
                "return": null, "return_interval": null,
            });
            TrainedUser { evaluation: serde_json::from_value(evaluation).unwrap(), trend: None }
        };
        let task = myo_tasks::preset("public-display").unwrap();
        let goal = myo_train::session::Goal { until: myo_train::session::Until::Plateau, steps: 1 };
        let run = myo::RunDescription::new(task, None, &myo::Device::Cpu, goal, None);
        Group { name: name.into(), run, ppo: Default::default(), users: (0..10).map(user).collect() }
    }

    #[test]
    fn draws_differ_and_leave_the_others() {
        let group = layout("a", 1.0);
        let seconds = |group: &Group| -> Vec<f64> {
            group.users.iter().filter_map(|user| user.evaluation.episode_length_s).collect()
        };
        let (first, rest) = drawn(&group, 4, [3, 0]);
        let mut all = [seconds(&first), seconds(&rest)].concat();
        all.sort_by(f64::total_cmp);
        let mut expected = seconds(&group);
        expected.sort_by(f64::total_cmp);
        assert_eq!((first.users.len(), all), (4, expected));
        let orders: std::collections::BTreeSet<String> =
            (0..20).map(|number| format!("{:?}", seconds(&drawn(&group, 4, [number, 0]).0))).collect();
        assert!(orders.len() > 10, "{orders:?}");
    }

    #[test]
    fn layouts_a_tenth_apart_are_told_apart_and_one_is_not_told_from_itself() {
        let (slow, fast) = (layout("slow", 1.1), layout("fast", 1.0));
        for number in 0..20 {
            let of = |group, stream| drawn(group, 5, [number, stream]).0;
            assert_eq!(claims(&Comparison::new(&of(&slow, 0), &of(&fast, 1))), [Quantity::EpisodeLengthS]);
            let (first, rest) = drawn(&slow, 5, [number, 0]);
            assert_eq!(claims(&Comparison::new(&first, &rest)), []);
        }
    }
}
