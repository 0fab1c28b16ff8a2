//! `myo measure`: figures of movements that were recorded, of people and of simulated users.

use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

use clap::Args;
use myo::protocol::OverUsers;
use myo::recordings::{AimedFigures, FittsOfAimed, Recordings};
use serde_json::json;

use super::failure::{Failure, Result};
use super::output::{print, print_json, row, table};

/// Arguments of `myo measure`.
#[derive(Args)]
#[command(after_help = HELP)]
pub struct Measure {
    /// Tables of recordings, each a column of the answer
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,

    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

const HELP: &str = "\
Examples:
  myo measure people.csv
  myo export runs/pointing-1 --out simulated.csv
  myo measure people.csv simulated.csv             people beside a simulated user, measured in the same way

A table has a head line and a row for each sample, values separated by commas, the rows of a trial together and in order:

  participant                                 who; may be left out where there is one
  trial (or episode), layout                  which recording of theirs; layout may be left out
  time_s (or time_ms)                         when; the clock may begin anywhere
  x_m, y_m, z_m (or _cm, _mm)                 where the hand is; `fingertip_x_m` or `pointer_x_m` do as well; z may be left out
  target_x_m, target_y_m, target_z_m          centre of the target that is to be come to (or `object_x_m` and so on)
  target_width_m                              its width, of a sphere the diameter
  MUSCLE_activation                           may be left out: of a muscle of the simulated body, 0 to 1; `myo fit` compares it
  event                                       may be left out: `entered` at the last entry into the target, `done` at the end of a selection
  note_...                                    columns of your own, which are passed over, as is one without a name

Without events a selection ends where the target changes or with the trial. A movement that ended beside its target counts with where it ended, for effective throughput, too; one whose time was up
(`time_out`, or `given_up` of one among others) does not. Recordings are brought to 500 Hz and smoothed at 10 Hz; a movement lasts from 5 % of its peak
speed to the last entry into its target. Figures are medians over the medians of participants, with the 95 % confidence interval of the mean over participants. Fitts' law goes
through the means of conditions: pairs of distance and width (to 1 cm and 1 mm) of which there are four movements.

JSON: a list of objects with `file`, `participants`, `movements`, `missed`, `rows` (`figure`, `what`, `unit`, `median`, `interval`), `times_by_index` (bit and s of each condition of each person), `fitts` (`conditions`; `r2`,
`slope_s_per_bit`, `intercept_s`, `throughput_bit_s`, each with `median` and `interval`; null where there is no law) and `no_fitts` (why there is none).";

/// Runs `myo measure`.
pub fn run(args: &Measure) -> Result<()> {
    let found = args.files.iter().map(|file| measure(file)).collect::<Result<Vec<_>>>()?;
    let names: Vec<String> = args.files.iter().map(|file| file.display().to_string()).collect();
    if args.json {
        let object = |(name, figures): (&String, &AimedFigures)| {
            let mut value = json!({"file": name});
            if let (Some(all), Ok(serde_json::Value::Object(own))) =
                (value.as_object_mut(), serde_json::to_value(figures))
            {
                all.extend(own);
            }
            value
        };
        return print_json(&names.iter().zip(&found).map(object).collect::<Vec<_>>());
    }
    print(&text(&names, &found))
}

fn measure(path: &Path) -> Result<AimedFigures> {
    AimedFigures::of(&read(path)?).map_err(|error| of_file(path, &error))
}

/// The recordings in a file.
pub(super) fn read(path: &Path) -> Result<Recordings> {
    let file = File::open(path).map_err(|error| of_file(path, &format!("cannot be read: {error}")))?;
    Recordings::read(BufReader::new(file)).map_err(|error| of_file(path, &error))
}

/// What is wrong with a file of recordings.
pub(super) fn of_file(path: &Path, error: &dyn std::fmt::Display) -> Failure {
    Failure::sentence(format!("{}: {error}", path.display()))
}

fn text(names: &[String], found: &[AimedFigures]) -> String {
    let line = |what: &str, of: &dyn Fn(&AimedFigures) -> String| {
        std::iter::once(what.to_owned()).chain(found.iter().map(of)).collect::<Vec<String>>()
    };
    let mut rows = vec![row(["movements"])];
    rows[0].extend(names.iter().cloned());
    rows.push(line("participants", &|figures| figures.participants.to_string()));
    rows.push(line("movements", &|figures| figures.movements.to_string()));
    rows.push(line("targets missed", &|figures| figures.missed.to_string()));
    let mut all: Vec<(&str, &str, &str)> = vec![];
    for figure in found.iter().flat_map(|figures| &figures.rows) {
        if !all.iter().any(|(name, ..)| *name == figure.figure) {
            all.push((figure.figure, figure.what, figure.unit));
        }
    }
    for (name, what, unit) in all {
        let of = |figures: &AimedFigures| {
            let own = figures.rows.iter().find(|row| row.figure == name);
            own.map_or("-".into(), |row| cell(OverUsers { median: row.median, interval: row.interval }))
        };
        rows.push(line(&named(what, unit), &of));
    }
    type OfLaw = fn(&FittsOfAimed) -> OverUsers;
    let laws: [(&str, OfLaw); 4] = [
        ("Fitts' law, R2", |law| law.r2),
        ("Fitts' law, slope (s/bit)", |law| law.slope_s_per_bit),
        ("Fitts' law, intercept (s)", |law| law.intercept_s),
        ("effective throughput (bit/s)", |law| law.throughput_bit_s),
    ];
    for (what, of) in laws {
        rows.push(line(what, &|figures| figures.fitts.as_ref().map_or("-".into(), |law| cell(of(law)))));
    }
    let why = names.iter().zip(found).filter_map(|(name, figures)| {
        figures.no_fitts.as_ref().map(|reason| format!("{name}: there is no Fitts' law: {reason}\n"))
    });
    format!("{}{}", table(&rows), why.collect::<String>())
}

fn named(what: &str, unit: &str) -> String {
    if unit.is_empty() { what.to_owned() } else { format!("{what} ({unit})") }
}

/// A median with its interval, if there is one.
pub(super) fn cell(value: OverUsers) -> String {
    let short = |x: f64| format!("{x:.3}");
    match value.interval {
        Some([low, high]) => format!("{} ({} to {})", short(value.median), short(low), short(high)),
        None => short(value.median),
    }
}
