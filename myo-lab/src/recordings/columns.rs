//! The columns of a table of recordings, and one row of it.

use csv::StringRecord;
use myo_measure::Point;
use myo_model::Nearest;

use super::{FARTHEST_M, RecordingError};

/// Lengths by the ending of a column.
const LENGTHS: [(&str, f64); 3] = [("_m", 1.0), ("_cm", 1e-2), ("_mm", 1e-3)];
/// Times by the ending of a column.
const TIMES: [(&str, f64); 2] = [("_s", 1.0), ("_ms", 1e-3)];
/// What may be measured, the first that there is.
const HANDS: [&str; 3] = ["pointer_", "fingertip_", ""];
/// What targets may be called.
const TARGETS: [&str; 2] = ["target_", "object_"];
/// Beginning and endings of columns that are passed over.
const PASSED_OVER: &str = "note_";
const PASSED_ENDINGS: [&str; 5] = ["_rad", "_rad_s", "_m_s", "force_n", "_torque_nm"];
/// Names of other columns that are passed over; without a name are numbers of rows, as pandas writes them.
const PASSED_NAMES: [&str; 5] = ["step", "object", "mechanical_w", "metabolic_w", ""];
/// Ending of the columns of muscles.
const ACTIVATION: &str = "_activation";
/// Greatest activation that is believed: an electromyogram may exceed that of a greatest voluntary contraction, not by so much.
const MOST_ACTIVE: f64 = 3.0;
/// Narrowest target (m) that is believed: a smaller one is in other units.
const NARROWEST_M: f64 = 0.0005;

/// One row.
pub(super) struct Sample {
    pub line: u64,
    pub participant: String,
    layout: String,
    trial: String,
    pub time_s: f64,
    pub point: Point,
    /// Centre and width of the target, if there is one.
    pub target: Option<(Point, f64)>,
    /// Of each muscle that was recorded.
    pub activations: Vec<f64>,
    pub enters: bool,
    pub ends: bool,
    pub gives_up: bool,
}

impl Sample {
    /// Of a recording of one's own.
    pub fn of(whose: [&str; 3], time_s: f64, point: Point, target: Option<(Point, f64)>, event: &str) -> Self {
        let [participant, layout, trial] = whose.map(str::to_owned);
        let (line, enters, gives_up) = (0, event == "entered", matches!(event, "given_up" | "time_out"));
        let ends = gives_up || matches!(event, "done" | "success");
        let activations = vec![];
        Self { line, participant, layout, trial, time_s, point, target, activations, enters, ends, gives_up }
    }

    /// What rows of one trial share.
    pub fn whose(&self) -> (&str, &str, &str) {
        (&self.participant, &self.layout, &self.trial)
    }

    pub fn trial_name(&self) -> String {
        if self.layout.is_empty() {
            format!("trial {}", self.trial)
        } else {
            format!("{}, trial {}", self.layout, self.trial)
        }
    }
}

/// A column of numbers, and what makes SI of them.
#[derive(Clone)]
struct Number {
    index: usize,
    name: String,
    scale: f64,
}

/// Where in a row everything stands.
pub(super) struct Columns {
    participant: Option<usize>,
    layout: Option<usize>,
    trial: usize,
    event: Option<usize>,
    time: Number,
    hand: [Option<Number>; 3],
    target: [Option<Number>; 3],
    width: Number,
    /// Columns of activations, and the muscles.
    activations: Vec<Number>,
    pub muscles: Vec<String>,
}

impl Columns {
    /// By the names of the head line.
    pub fn of(head: &StringRecord) -> Result<Self, RecordingError> {
        let names: Vec<&str> = head.iter().collect();
        if let [one] = names[..]
            && let Some(separator) = one.chars().find(|c| ";\t".contains(*c))
        {
            return Err(RecordingError::Columns(format!(
                "the head line is `{one}`, with {separator:?} between names; values must be separated by commas"
            )));
        }
        let find = |name: &str| names.iter().position(|other| *other == name);
        let number = |stem: &str, units: &[(&str, f64)]| {
            units.iter().find_map(|(ending, scale)| {
                let name = format!("{stem}{ending}");
                Some(Number { index: find(&name)?, name, scale: *scale })
            })
        };
        let axes = |prefix: &str| ["x", "y", "z"].map(|axis| number(&format!("{prefix}{axis}"), &LENGTHS));
        let missing =
            |what: &str| RecordingError::Columns(format!("there is no column {what}; there are {}", names.join(", ")));
        let hand = HANDS.iter().map(|prefix| axes(prefix)).find(|axes| axes[0].is_some());
        let hand = hand
            .filter(|axes| axes[1].is_some())
            .ok_or_else(|| missing("`x_m` and `y_m` (or `fingertip_x_m` and `fingertip_y_m`)"))?;
        let target = TARGETS.iter().map(|prefix| axes(prefix)).find(|axes| axes[0].is_some() && axes[1].is_some());
        let target = target.ok_or_else(|| missing("`target_x_m` and `target_y_m`"))?;
        let width = TARGETS.iter().find_map(|prefix| number(&format!("{prefix}width"), &LENGTHS));
        let trial = find("trial").or_else(|| find("episode"));
        let (activations, muscles) = activations(&names)?;
        let columns = Self {
            participant: find("participant"),
            layout: find("layout"),
            trial: trial.ok_or_else(|| missing("`trial`"))?,
            event: find("event"),
            time: number("time", &TIMES).ok_or_else(|| missing("`time_s` (or `time_ms`)"))?,
            width: width.ok_or_else(|| missing("`target_width_m`"))?,
            hand,
            target,
            activations,
            muscles,
        };
        if columns.hand[2].is_some() != columns.target[2].is_some() {
            return Err(RecordingError::Columns("the hand and the target must both have a `z`, or neither".into()));
        }
        columns.refuse_unknown(&names)?;
        Ok(columns)
    }

    /// What nobody knows may be a slip in the name of what is measured.
    fn refuse_unknown(&self, names: &[&str]) -> Result<(), RecordingError> {
        let numbers = [&self.time, &self.width];
        let numbers =
            numbers.into_iter().chain(self.hand.iter().chain(&self.target).flatten()).map(|number| number.index);
        let used: Vec<usize> = numbers
            .chain([self.participant, self.layout, self.event, Some(self.trial)].into_iter().flatten())
            .collect();
        let is_known = |index: usize, name: &str| {
            used.contains(&index)
                || PASSED_NAMES.contains(&name)
                || name.starts_with(PASSED_OVER)
                || name.ends_with(ACTIVATION)
                || PASSED_ENDINGS.iter().any(|ending| name.ends_with(ending))
                || HANDS.iter().any(|hand| !hand.is_empty() && name.starts_with(hand))
        };
        let Some((_, name)) = names.iter().enumerate().find(|(index, name)| !is_known(*index, name)) else {
            return Ok(());
        };
        let valid = [
            "participant",
            "trial",
            "layout",
            "time_s",
            "time_ms",
            "x_m",
            "y_m",
            "z_m",
            "x_mm",
            "y_mm",
            "z_mm",
            "target_x_m",
            "target_y_m",
            "target_z_m",
            "target_x_mm",
            "target_y_mm",
            "target_z_mm",
            "target_width_m",
            "target_width_mm",
            "event",
        ];
        let nearest = Nearest::to(name, &valid);
        Err(RecordingError::Columns(format!(
            "unknown column `{name}`; {nearest} A column of your own is passed over where its name begins with `note_`"
        )))
    }

    /// The values of a row.
    pub fn sample(&self, row: &StringRecord, line: u64) -> Result<Sample, RecordingError> {
        let text = |index: Option<usize>| index.and_then(|index| row.get(index)).unwrap_or_default().to_owned();
        let value = |number: &Number, right| value(row, line, number, right);
        let place = |axes: &[Option<Number>; 3]| {
            let mut point = [0.0; 3];
            for (x, number) in point.iter_mut().zip(axes) {
                if let Some(number) = number {
                    *x = value(number, "a length within 10 m is needed; is it in other units (`_cm`, `_mm`)?")?;
                }
            }
            Ok::<Point, RecordingError>(point)
        };
        let has_target =
            self.target.iter().flatten().all(|number| !row.get(number.index).unwrap_or_default().is_empty());
        let target = if has_target {
            let width = value(
                &self.width,
                "a width from 0.5 mm to 10 m is needed; is it in other units (`_m`, `_cm`, `_mm`)?",
            )?;
            Some((place(&self.target)?, width))
        } else {
            None
        };
        let event = text(self.event);
        if !["", "entered", "done", "given_up", "success", "time_out"].contains(&&*event) {
            let right = "known are `entered`, `done`, `given_up`, `success` and `time_out`";
            return Err(RecordingError::Value { line, column: "event".into(), value: format!("`{event}`"), right });
        }
        let [mut participant, layout] = [self.participant, self.layout].map(text);
        if participant.is_empty() {
            participant = "participant".into();
        }
        let (trial, time_s) = (text(Some(self.trial)), value(&self.time, "a time is needed")?);
        let whose = [&*participant, &*layout, &*trial];
        let active = |number| value(number, "an activation from 0 to 1 is needed; is it in percent, or not rectified?");
        let activations = self.activations.iter().map(active).collect::<Result<_, _>>()?;
        Ok(Sample { line, activations, ..Sample::of(whose, time_s, place(&self.hand)?, target, &event) })
    }
}

/// Columns of activations, and what their muscles are called.
fn activations(names: &[&str]) -> Result<(Vec<Number>, Vec<String>), RecordingError> {
    let (mut columns, mut muscles) = (vec![], vec![]);
    for (index, name) in names.iter().enumerate() {
        let Some(muscle) = name.strip_suffix(ACTIVATION).filter(|_| !name.starts_with(PASSED_OVER)) else { continue };
        if muscle.is_empty() || muscles.iter().any(|other| other == muscle) {
            return Err(RecordingError::Columns(format!(
                "column {} is called `{name}`; the muscle's own name is needed before `{ACTIVATION}`, once",
                index + 1
            )));
        }
        columns.push(Number { index, name: (*name).to_owned(), scale: 1.0 });
        muscles.push(muscle.to_owned());
    }
    Ok((columns, muscles))
}

/// A number in SI units.
fn value(row: &StringRecord, line: u64, number: &Number, right: &'static str) -> Result<f64, RecordingError> {
    let text = row.get(number.index).unwrap_or_default();
    let wrong = |value: String, right| RecordingError::Value { line, column: number.name.clone(), value, right };
    let si = number.scale
        * text.parse::<f64>().ok().filter(|x| x.is_finite()).ok_or_else(|| {
            wrong(if text.is_empty() { "empty".into() } else { format!("`{text}`") }, "a number is needed")
        })?;
    if number.name.ends_with(ACTIVATION) {
        return if (0.0..=MOST_ACTIVE).contains(&si) { Ok(si) } else { Err(wrong(text.to_owned(), right)) };
    }
    let is_width = number.name.contains("width");
    let is_time = number.name.starts_with("time");
    // A ray that meets nothing points twenty metres away.
    let farthest = if number.name.starts_with("pointer") { 2.5 * FARTHEST_M } else { FARTHEST_M };
    if !is_time && (si.abs() > farthest || is_width && si < NARROWEST_M) {
        return Err(wrong(text.to_owned(), right));
    }
    Ok(si)
}
