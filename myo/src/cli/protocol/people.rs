//! Recordings of people beside the answers of simulated users.

use std::path::{Path, PathBuf};

use myo::measure::bands::Figure;
use myo::protocol::{KinematicRow, OverUsers, Plot, PlotPoint, PlotSeries};
use myo::published::Aiming;
use myo::recordings::AimedFigures;
use serde::Serialize;

use crate::cli::failure::Result;
use crate::cli::measure::{of_file, read};
use crate::cli::output::{row, table};

/// People of one file, measured as simulated users are.
#[derive(Clone, Debug, Serialize)]
pub struct People {
    /// The file.
    pub file: String,
    /// Speeds, shapes and smoothness of their movements, and Fitts' law.
    #[serde(flatten)]
    pub figures: AimedFigures,
    /// Their movement times by difficulty; nothing where there is no law.
    #[serde(skip)]
    pub aiming: Option<Aiming>,
}

/// Figures of K1 that do not go by distance and width, and their names in figures of recordings.
const SHARED: [(Figure, &str); 5] = [
    (Figure::PeakOverMean, "peak_over_mean"),
    (Figure::TimeOfPeak, "time_of_peak"),
    (Figure::Sparc, "sparc"),
    (Figure::Ldlj, "ldlj"),
    (Figure::PathOverChord, "path_over_chord"),
];

impl People {
    /// Those of some files.
    pub fn of(files: &[PathBuf]) -> Result<Vec<Self>> {
        files.iter().map(|file| Self::of_file(file)).collect()
    }

    fn of_file(path: &Path) -> Result<Self> {
        let recordings = read(path)?;
        let figures = AimedFigures::of(&recordings).map_err(|error| of_file(path, &error))?;
        let file = path.file_name().map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into());
        let aiming = Aiming::of(&file, &recordings).ok();
        Ok(Self { file, figures, aiming })
    }

    /// Their movement times in a plot over indices of difficulty.
    pub fn draw(&self, plot: &mut Plot) {
        let Some(aiming) = &self.aiming else { return };
        let point = |at| PlotPoint { at, interval: None };
        let points = aiming.conditions.iter().map(|one| point([one.id_bit, one.movement_time_s])).collect();
        plot.series.push(PlotSeries { name: self.file.clone(), points, line: vec![] });
        let law = &aiming.fitts;
        let [slope, from] = [law.slope_s_per_bit.median, law.intercept_s.median];
        let ends =
            aiming.conditions.iter().fold([f64::INFINITY, 0.0], |[a, b], one| [a.min(one.id_bit), b.max(one.id_bit)]);
        let name = format!("{}: {:.0} ms + {:.0} ms/bit, R2 {:.2}", self.file, 1e3 * from, 1e3 * slope, law.r2.median);
        let line = ends.map(|index| [index, from + slope * index]).to_vec();
        plot.series.push(PlotSeries { name, points: vec![], line });
    }
}

/// Fitts' law of people, as a table.
pub fn laws(people: &[People]) -> String {
    if people.is_empty() {
        return String::new();
    }
    let mut rows =
        vec![row(["people", "participants", "movements", "R2", "slope, s/bit", "intercept, s", "throughput, bit/s"])];
    let mut why = String::new();
    for one in people {
        let [who, movements] = [one.figures.participants, one.figures.movements].map(|count| count.to_string());
        let law = one.figures.fitts.as_ref().map_or([(); 4].map(|()| "-".to_owned()), |law| {
            [law.r2, law.slope_s_per_bit, law.intercept_s, law.throughput_bit_s].map(cell)
        });
        let [r2, slope, intercept, throughput] = &law;
        rows.push(row([&one.file, &who, &movements, r2, slope, intercept, throughput]));
        if let Some(reason) = &one.figures.no_fitts {
            why += &format!("{}: there is no Fitts' law: {reason}\n", one.file);
        }
    }
    format!("\n{}{why}", table(&rows))
}

/// What movements of people are like that K1 tells of users, too, as a table.
pub fn movements(people: &[People], users: &[KinematicRow]) -> String {
    if people.is_empty() {
        return String::new();
    }
    let mut rows = vec![row(["beside people", "users"])];
    rows[0].extend(people.iter().map(|one| one.file.clone()));
    for (figure, name) in SHARED {
        let Some(own) = users.iter().find(|row| row.figure == figure) else { continue };
        let mut line = vec![own.what.to_owned(), cell(OverUsers { median: own.median, interval: own.interval })];
        line.extend(people.iter().map(|one| {
            let theirs = one.figures.rows.iter().find(|row| row.figure == name);
            theirs.map_or("-".into(), |row| cell(OverUsers { median: row.median, interval: row.interval }))
        }));
        rows.push(line);
    }
    format!("\n{}", table(&rows))
}

fn cell(value: OverUsers) -> String {
    match value.interval {
        Some([low, high]) => format!("{:.3} ({low:.3} to {high:.3})", value.median),
        None => format!("{:.3}", value.median),
    }
}
