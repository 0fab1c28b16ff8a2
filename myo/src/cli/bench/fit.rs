//! `myo bench fit`: whether `myo fit` finds simulated users who are known.

use clap::Args;
use myo::fitting::{Anybody, Candidate, FittedAmong, FittedTrait, Nature, Ranked, TRAITS, others};
use myo::measure::statistics;
use myo::model::Nearest;
use myo::protocol::conditions;
use serde::Serialize;

use crate::cli::failure::{Failure, Result, complain};
use crate::cli::fit::{AnybodyArgs, anybodies};
use crate::cli::interrupt::Interrupt;
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
    /// Users who are recorded and looked for; of each delay and stature, if there are several
    #[arg(long, value_name = "N", default_value = "8", value_parser = parse::positive)]
    users: usize,

    /// Episodes of each of them for every pair of distance and width, of 13 movements each
    #[arg(long, value_name = "N", default_value = "8", value_parser = parse::positive)]
    episodes: usize,

    /// Record what these muscles do, too, as if there were electromyograms of each: `all`, or names separated by commas
    #[arg(long, value_name = "MUSCLES", value_delimiter = ',')]
    muscles: Vec<String>,

    /// Record users who learnt apart from those that are fitted, with the seed behind theirs: what one training does by chance, and another does not, misleads a fit
    #[arg(long)]
    apart: bool,

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
  myo bench fit --users 10 --apart           people are no users of ours: how far that leads astray
  myo bench fit --users 4 --apart --vision-delay-ms 40,80,120

Records simulated users whose traits are known and none of which was practised, and fits each recording. Tells of each trait how far what was found is from what it is; with several
delays or statures, the users of each are looked for among all, and how often the known one is the nearest and how often others are ruled out is told, too.

JSON: `users`, a list with `known` (in the order of `traits`), `vision_delay_ms` and `height_m` (null as told), `found` and `candidates` (as `myo fit` has them), `distance_before`, `distance_after`; `candidates`, with `nearest` (share of the users who were found to be as they are), `possible` (share who were not ruled out), `alone`
(share to whom all others were ruled out) and `wrong` (share of whom somebody else alone was possible); `traits`, a list with `key`, `median_error` (as a ratio, 1 is none), `within_10_percent` (share of
the users), `told` (share of whom the recordings tell), `within_interval` (share whose interval has the known value).";

/// A user who was looked for.
#[derive(Serialize)]
struct Sought {
    known: Nature,
    #[serde(flatten)]
    candidate: Candidate,
    found: Vec<FittedTrait>,
    candidates: Vec<Ranked>,
    distance_before: Option<f64>,
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

/// How well the known delay and stature are found, as shares of the users.
#[derive(Clone, Copy, Serialize)]
struct CandidatesFound {
    nearest: f64,
    possible: f64,
    alone: f64,
    wrong: f64,
}

/// Runs `myo bench fit`.
pub fn run(args: &FitArgs) -> Result<()> {
    let AnybodyArgs { seed, trainings, .. } = args.anybody;
    let interrupt = Interrupt::listen()?;
    let fitted = anybodies(&args.anybody, (trainings, seed), &interrupt)?;
    let next = (1, seed.wrapping_add(trainings as u64));
    let apart = args.apart.then(|| anybodies(&args.anybody, next, &interrupt)).transpose()?;
    let mut users = vec![];
    for (candidate, anybody) in apart.as_ref().unwrap_or(&fitted) {
        users.extend(sought(args, &fitted, (*candidate, anybody))?);
    }
    let traits: Vec<TraitFound> = (0..TRAITS.len()).map(|number| TraitFound::of(number, &users)).collect();
    let candidates = CandidatesFound::of(&users);
    if args.json {
        return print_json(&serde_json::json!({"users": users, "candidates": candidates, "traits": traits}));
    }
    print(&text(&users, (fitted.len() > 1).then_some(candidates), &traits))
}

/// Users of one delay and stature, recorded and looked for among all.
fn sought(args: &FitArgs, all: &[(Candidate, Anybody)], known: (Candidate, &Anybody)) -> Result<Vec<Sought>> {
    let (candidate, anybody) = known;
    let natures = others(args.users);
    let pairs: Vec<[f64; 2]> = conditions().into_iter().filter(|pair| pair[1] < WIDTH).collect();
    let seed = args.anybody.seed;
    let muscles = muscles(&args.muscles, &anybody.muscles())?;
    let recorded = anybody.aims(&natures, (&pairs, &muscles), (args.episodes, seed + OTHER_SEED))?;
    let mut users = vec![];
    for (number, (known, movements)) in natures.into_iter().zip(recorded).enumerate() {
        let who = format!("user {}{}", number + 1, candidate.suffix());
        complain(&format!("{who}, of {}", args.users));
        let fitted = all.iter().map(|(candidate, one)| (*candidate, one.nearest(&who, &movements, &muscles, seed)));
        let FittedAmong { fitted, candidates } = FittedAmong::nearest(fitted.collect())?;
        let (distance_before, distance_after) = (fitted.distance_before, fitted.distance_after);
        users.push(Sought { known, candidate, found: fitted.traits, candidates, distance_before, distance_after });
    }
    Ok(users)
}

impl CandidatesFound {
    fn of(users: &[Sought]) -> Self {
        let share = |of: &dyn Fn(&Sought) -> bool| {
            users.iter().filter(|&user| of(user)).count() as f64 / users.len().max(1) as f64
        };
        let is_known = |user: &Sought, one: &Ranked| one.candidate == user.candidate;
        let is_alone = |user: &Sought| user.candidates.iter().filter(|one| one.is_possible).count() == 1;
        let is_nearest = |user: &Sought| user.candidates.first().is_some_and(|first| is_known(user, first));
        Self {
            nearest: share(&is_nearest),
            possible: share(&|user| user.candidates.iter().any(|one| is_known(user, one) && one.is_possible)),
            alone: share(&|user| is_nearest(user) && is_alone(user)),
            wrong: share(&|user| !is_nearest(user) && is_alone(user)),
        }
    }
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

fn text(users: &[Sought], among: Option<CandidatesFound>, traits: &[TraitFound]) -> String {
    let mut head = row(["user"]);
    head.extend(TRAITS.map(|one| one.key.to_owned()));
    head.push("distance before, after".into());
    head.push(among.map_or("", |_| "found among").into());
    let mut rows = vec![head];
    for (number, user) in users.iter().enumerate() {
        let mut cells = vec![format!("{}{}", number + 1, user.candidate.suffix())];
        let known = user.known.0.iter().zip(&user.found);
        cells.extend(known.map(|(known, one)| {
            let mark = if one.is_told { "" } else { "?" };
            format!("{known:.3} found {:.3}{mark}", one.found)
        }));
        let before = user.distance_before.map_or_else(|| "-".into(), |distance| format!("{distance:.1}"));
        cells.push(format!("{before}, {:.1}", user.distance_after));
        if among.is_some() {
            let found = user.candidates.iter().filter(|one| one.is_possible);
            cells.push(found.map(|one| one.candidate.suffix()).collect::<Vec<_>>().join(" or "));
        }
        rows.push(cells);
    }
    let mut all = vec![row(["trait", "median error", "within 10 %", "told", "in its interval"])];
    let percent = |share: f64| format!("{:.0} %", 100.0 * share);
    all.extend(traits.iter().map(|one| {
        let error = format!("{:.1} %", 100.0 * (one.median_error - 1.0));
        row([one.key, &error, &percent(one.within_10_percent), &percent(one.told), &percent(one.within_interval)])
    }));
    let among = among.map_or_else(String::new, |CandidatesFound { nearest, possible, alone, wrong }| {
        let [nearest, possible, alone, wrong] = [nearest, possible, alone, wrong].map(percent);
        format!("delay and stature: nearest {nearest}, not ruled out {possible}, all others ruled out {alone}, somebody else alone {wrong}\n\n")
    });
    format!("{}\n{among}{}", table(&rows), table(&all))
}
