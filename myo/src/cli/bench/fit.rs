//! `myo bench fit`: whether `myo fit` finds simulated users who are known.

use clap::Args;
use myo::fitting::{FittedTrait, Nature, TRAITS, others};
use myo::measure::statistics;
use myo::model::Nearest;
use myo::protocol::conditions;
use serde::Serialize;

use crate::cli::failure::{Failure, Result, complain};
use crate::cli::fit::{AnybodyArgs, anybody};
use crate::cli::output::{print, print_json, row, table};
use crate::cli::parse;

/// Widest target (m) of the pairs that are recorded, and nearest, of those of protocol F1.
const WIDTH: f64 = 0.11;
/// Seeds of recordings are so far from those of fits.
const OTHER_SEED: u64 = 1000;

/// Arguments of `myo bench fit`.
#[derive(Args)]
#[command(after_help = HELP)]
pub struct FitArgs {
    /// Users who are recorded and looked for
    #[arg(long, value_name = "N", default_value = "8", value_parser = parse::positive)]
    users: usize,

    /// Episodes of each of them for every pair of distance and width, of 13 movements each
    #[arg(long, value_name = "N", default_value = "8", value_parser = parse::positive)]
    episodes: usize,

    /// Record what these muscles do, too, as if there were electromyograms of each: `all`, or names separated by commas
    #[arg(long, value_name = "MUSCLES", value_delimiter = ',')]
    muscles: Vec<String>,

    #[command(flatten)]
    anybody: AnybodyArgs,

    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

const HELP: &str = "\
Examples:
  myo bench fit --users 10
  myo bench fit --users 10 --muscles all     with what each muscle does

Records simulated users whose traits are known and none of which was practised, and fits each recording. Tells of each trait how far what was found is from what it is.

JSON: `users`, a list with `known` (in the order of `traits`) and `found` (as `myo fit` has it), `distance_before`, `distance_after`; `traits`, a list with `key`, `median_error` (as a ratio, 1 is none), `within_10_percent` (share of
the users), `told` (share of whom the recordings tell), `within_interval` (share whose interval has the known value).";

/// A user who was looked for.
#[derive(Serialize)]
struct Sought {
    known: Nature,
    found: Vec<FittedTrait>,
    distance_before: f64,
    distance_after: f64,
}

/// How well a trait is found.
#[derive(Serialize)]
struct TraitFound {
    key: &'static str,
    median_error: f64,
    within_10_percent: f64,
    told: f64,
    within_interval: f64,
}

/// Runs `myo bench fit`.
pub fn run(args: &FitArgs) -> Result<()> {
    let anybody = anybody(&args.anybody)?;
    let natures = others(args.users);
    let pairs: Vec<[f64; 2]> = conditions().into_iter().filter(|pair| pair[1] < WIDTH).collect();
    let seed = args.anybody.seed;
    let muscles = muscles(&args.muscles, &anybody.muscles())?;
    let recorded = anybody.aims(&natures, (&pairs, &muscles), (args.episodes, seed + OTHER_SEED))?;
    let mut users = vec![];
    for (number, (known, movements)) in natures.into_iter().zip(recorded).enumerate() {
        complain(&format!("user {} of {}", number + 1, args.users));
        let fitted = anybody.nearest(&format!("user {}", number + 1), &movements, &muscles, seed)?;
        let (distance_before, distance_after) = (fitted.distance_before, fitted.distance_after);
        users.push(Sought { known, found: fitted.traits, distance_before, distance_after });
    }
    let traits: Vec<TraitFound> = (0..TRAITS.len()).map(|number| TraitFound::of(number, &users)).collect();
    if args.json {
        return print_json(&serde_json::json!({"users": users, "traits": traits}));
    }
    print(&text(&users, &traits))
}

/// Numbers of muscles of these names.
fn muscles(named: &[String], all: &[String]) -> Result<Vec<usize>> {
    if named == ["all"] {
        return Ok((0..all.len()).collect());
    }
    let number = |name: &String| {
        all.iter().position(|muscle| muscle == name).ok_or_else(|| {
            let nearest = Nearest::to(name, &all.iter().map(String::as_str).collect::<Vec<_>>());
            Failure::sentence(format!("--muscles {name}: the body has no such muscle; {nearest}"))
        })
    };
    named.iter().map(number).collect()
}

impl TraitFound {
    fn of(number: usize, users: &[Sought]) -> Self {
        let each = || users.iter().map(|user| (user.known.0[number], user.found[number]));
        let share = |of: &dyn Fn((f64, FittedTrait)) -> bool| {
            each().filter(|&one| of(one)).count() as f64 / users.len().max(1) as f64
        };
        let ratio = |known: f64, found: f64| (found / known).max(known / found);
        let errors: Vec<f64> = each().map(|(known, one)| ratio(known, one.found)).collect();
        Self {
            key: TRAITS[number].key,
            median_error: statistics::median(&errors).unwrap_or(f64::NAN),
            within_10_percent: share(&|(known, one)| ratio(known, one.found) <= 1.1),
            told: share(&|(_, one)| one.is_told),
            within_interval: share(&|(known, one)| (one.interval[0]..=one.interval[1]).contains(&known)),
        }
    }
}

fn text(users: &[Sought], traits: &[TraitFound]) -> String {
    let mut head = row(["user"]);
    head.extend(TRAITS.map(|one| one.key.to_owned()));
    head.push("distance before, after".into());
    let mut rows = vec![head];
    for (number, user) in users.iter().enumerate() {
        let mut cells = vec![format!("{}", number + 1)];
        let known = user.known.0.iter().zip(&user.found);
        cells.extend(known.map(|(known, one)| {
            let mark = if one.is_told { "" } else { "?" };
            format!("{known:.3} found {:.3}{mark}", one.found)
        }));
        cells.push(format!("{:.1}, {:.1}", user.distance_before, user.distance_after));
        rows.push(cells);
    }
    let mut all = vec![row(["trait", "median error", "within 10 %", "told", "in its interval"])];
    let percent = |share: f64| format!("{:.0} %", 100.0 * share);
    all.extend(traits.iter().map(|one| {
        let error = format!("{:.1} %", 100.0 * (one.median_error - 1.0));
        row([one.key, &error, &percent(one.within_10_percent), &percent(one.told), &percent(one.within_interval)])
    }));
    format!("{}\n{}", table(&rows), table(&all))
}
