//! Recordings of people beside the answers of simulated users.

use std::path::{Path, PathBuf};

use myo::measure::bands::Figure;
use myo::protocol::{KinematicRow, OverUsers, Plot, PlotPoint, PlotSeries};
use myo::recordings::AimedFigures;
use serde::Serialize;

use crate::cli::failure::Result;
use crate::cli::measure::{cell, of_file, read};
use crate::cli::output::{row, table};

/// People of one file, measured as simulated users are.
#[derive(Clone, Debug, Serialize)]
pub struct People {
    /// The file.
    pub file: String,
    /// Speeds, shapes and smoothness of their movements, and Fitts' law.
    #[serde(flatten)]
    pub figures: AimedFigures,
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
        Ok(Self { file, figures })
    }

    /// Their movement times in a plot over indices of difficulty.
    pub fn draw(&self, plot: &mut Plot) {
        let times = &self.figures.times_by_index;
        let points = times.iter().map(|&at| PlotPoint { at, interval: None }).collect();
        plot.series.push(PlotSeries { name: self.file.clone(), points, line: vec![] });
        let Some(law) = &self.figures.fitts else { return };
        let [slope, from] = [law.slope_s_per_bit.median, law.intercept_s.median];
        let name = format!("{}: {:.0} ms + {:.0} ms/bit, R2 {:.2}", self.file, 1e3 * from, 1e3 * slope, law.r2.median);
        let ends = times.iter().fold([f64::INFINITY, 0.0], |[least, most], one| [one[0].min(least), one[0].max(most)]);
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

#[cfg(test)]
mod tests {
    use std::fmt::Write;

    use super::*;

    /// Somebody who goes to and fro by minimum jerk, in a time that grows with difficulty: 0.2 s and 0.1 s/bit.
    fn table() -> String {
        let mut text = "trial,time_s,x_m,y_m,target_x_m,target_y_m,target_width_m\n".to_owned();
        for (trial, (distance, width)) in [(0.1, 0.05), (0.2, 0.05), (0.3, 0.03), (0.3, 0.02)].into_iter().enumerate() {
            let took: f64 = 0.2 + 0.1 * f64::log2(distance / width + 1.0);
            let each = ((took + 0.3) / 0.005) as usize;
            for sample in 0..12 * each {
                let s = ((sample % each) as f64 * 0.005 / took).min(1.0);
                let share = s.powi(3) * (10.0 - 15.0 * s + 6.0 * s * s);
                let movement = sample / each;
                let target = if movement.is_multiple_of(2) { distance } else { 0.0 };
                // Nobody ends in the middle each time.
                let ends_at = |movement: usize| {
                    let middle = if movement.is_multiple_of(2) { distance } else { 0.0 };
                    middle + 0.2 * width * (movement as f64).sin()
                };
                let from = if movement == 0 { 0.0 } else { ends_at(movement - 1) };
                let x = from + share * (ends_at(movement) - from);
                let time_s = 0.005 * sample as f64;
                writeln!(text, "{trial},{time_s:.3},{x:.6},{:.6},{target},0,{width}", 0.005 * share).unwrap();
            }
        }
        text
    }

    #[test]
    fn people_stand_beside_users_in_plot_and_tables() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("ours.csv");
        std::fs::write(&file, table()).unwrap();
        let people = People::of(&[file]).unwrap();
        let [one] = &people[..] else { panic!("{people:?}") };
        assert_eq!((&*one.file, one.figures.participants, one.figures.movements), ("ours.csv", 1, 48));
        let mut plot = Plot { title: String::new(), axes: [String::new(), String::new()], series: vec![] };
        one.draw(&mut plot);
        let [times, law] = &plot.series[..] else { panic!("{plot:?}") };
        assert_eq!((&*times.name, times.points.len(), law.line.len()), ("ours.csv", 4, 2));
        // The hand enters a target before it stands still in it.
        let [[easy, _], [hard, _]] = law.line[..] else { panic!("{law:?}") };
        assert!((easy - f64::log2(3.0)).abs() < 1e-9 && (hard - 4.0).abs() < 1e-9, "{law:?}");
        assert!(law.name.starts_with("ours.csv: ") && law.name.contains(", R2 0.9"), "{}", law.name);
        let told = laws(&people);
        assert!(told.contains("people") && told.contains("ours.csv") && !told.contains("no Fitts"), "{told}");
        let user =
            KinematicRow { figure: Figure::Sparc, what: "smoothness, SPARC", unit: "", median: -1.5, interval: None };
        let told = movements(&people, &[user]);
        // Movements by minimum jerk have -1.40.
        let sparc: f64 = told
            .lines()
            .find(|line| line.contains("SPARC"))
            .unwrap()
            .split_whitespace()
            .last()
            .unwrap()
            .parse()
            .unwrap();
        assert!(told.contains("-1.500") && (sparc + 1.40).abs() < 0.05, "{told}");
        assert_eq!(laws(&[]) + &movements(&[], &[]), "");
    }

    #[test]
    fn tables_that_cannot_be_measured_are_refused_with_their_name() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("ours.csv");
        std::fs::write(&file, "trial,time_s\n").unwrap();
        let Err(error) = People::of(&[file]) else { panic!("no such table") };
        assert!(format!("{error:?}").contains("ours.csv"), "{error:?}");
    }
}
