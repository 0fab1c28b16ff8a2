//! Protocols E1 and E3: how long muscles of a body hold a load, and how they recover.
//!
//! E1 asks the muscles of each joint, all together, for a share of all they can, until a hundredth of it is missing. E3 asks them for half a minute of half of all they can and
//! half a minute of rest by turns. Muscles that hold an arm together tire as one, so that the arm need not be moved for this.

use myo_measure::bands::{Figure, Figures};
use myo_model::Model;
use myo_muscle::{Endurance as People, Fatigue, FatigueRates, MuscleGroup, left_of};
use serde::Serialize;

use super::ProtocolError;
use super::plot::{Plot, PlotPoint, PlotSeries};
use super::pointing::set_all;

/// Shares of all that muscles can, which are held.
const LOADS: [f64; 7] = [0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8];
/// What may be missing of a load that is held.
const MISSING: f64 = 0.01;
/// The longest that a load is held (s); people hold a fifth for eleven minutes at most.
const LONGEST_S: f64 = 3600.0;
/// Seconds of work and then of rest, what is worked at, and how often.
const TURN_S: f64 = 30.0;
const WORK: f64 = 0.5;
const TURNS: usize = 10;
/// The joint that people's bands are about.
const JUDGED: MuscleGroup = MuscleGroup::Shoulder;

/// Protocol E1: how long loads are held.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Endurance {
    /// Name of the body.
    pub model: String,
    /// Joint by joint, load by load.
    pub rows: Vec<EnduranceRow>,
}

/// A load that is held.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct EnduranceRow {
    /// Which joint's muscles hold it; none for those of which no joint is known.
    pub joint: Option<MuscleGroup>,
    /// The load, as a share of all they can.
    pub load: f64,
    /// How long it is held (s); none for longer than an hour.
    pub time_s: Option<f64>,
    /// How long people hold it (s): Frey-Law and Avin 2010, doi 10.1080/00140130903389068.
    pub people_s: f64,
    /// One over the other.
    pub of_people: Option<f64>,
}

/// Protocol E3: work and rest by turns.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Recovery {
    /// Name of the body.
    pub model: String,
    /// Joint by joint.
    pub rows: Vec<RecoveryRow>,
}

/// What becomes of the muscles of a joint over ten turns of work and rest.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RecoveryRow {
    /// Which joint's; none for those of which no joint is known.
    pub joint: Option<MuscleGroup>,
    /// Share that is fatigued after the last work, and after the rest that follows it.
    pub after_work: f64,
    /// See `after_work`.
    pub after_rest: f64,
    /// The share after the last rest if rest were no better than work for what is fatigued.
    pub without_rest_factor: f64,
}

/// The joints whose muscles a body has.
fn joints(model: &Model) -> Vec<Option<MuscleGroup>> {
    let mut joints: Vec<_> = model.muscles.iter().map(|muscle| muscle.parameters.group).collect();
    joints.sort_unstable();
    joints.dedup();
    joints
}

/// How long (s) a load is held, in steps of so many seconds.
fn held_s(rates: FatigueRates, load: f64, dt: f64) -> Option<f64> {
    let tiring = Fatigue::<f64>::new(rates, 1.0, dt);
    let mut fatigued = 0.0;
    for step in 0..(LONGEST_S / dt) as u32 {
        let active = left_of(load, fatigued);
        if active < (1.0 - MISSING) * load {
            return Some(f64::from(step) * dt);
        }
        fatigued = tiring.next(fatigued, active, load);
    }
    None
}

/// Shares that are fatigued after the last work and the last rest.
fn by_turns(rates: FatigueRates, dt: f64) -> [f64; 2] {
    let tiring = Fatigue::<f64>::new(rates, 1.0, dt);
    let steps = (TURN_S / dt).round() as u32;
    let spend = |fatigued: f64, load: f64| {
        (0..steps).fold(fatigued, |fatigued, _| tiring.next(fatigued, left_of(load, fatigued), load))
    };
    (0..TURNS).fold([0.0; 2], |[_, rested], _| {
        let worked = spend(rested, WORK);
        [worked, spend(worked, 0.0)]
    })
}

impl Endurance {
    /// Asks the muscles of a body, in steps of so many seconds.
    pub fn of(model: &Model, dt: f64) -> Self {
        let row = |joint: Option<MuscleGroup>, load: f64| {
            let people_s = joint.map_or(People::POOLED, MuscleGroup::endurance).time_s(load);
            let time_s = held_s(FatigueRates::of(joint), load, dt);
            EnduranceRow { joint, load, time_s, people_s, of_people: time_s.map(|time_s| time_s / people_s) }
        };
        let rows = joints(model).into_iter().flat_map(|joint| LOADS.map(|load| row(joint, load)));
        Self { model: model.name.clone(), rows: rows.collect() }
    }

    /// Times over loads, and people's as lines; times longer than an hour are left out.
    pub fn plot(&self) -> Plot {
        let mut joints: Vec<_> = self.rows.iter().map(|row| row.joint).collect();
        joints.dedup();
        let series = joints.into_iter().map(|joint| {
            let rows = || self.rows.iter().filter(move |row| row.joint == joint);
            let point = |row: &EnduranceRow| Some(PlotPoint { at: [100.0 * row.load, row.time_s?], interval: None });
            PlotSeries {
                name: joint.map_or("no known joint", MuscleGroup::name).into(),
                points: rows().filter_map(point).collect(),
                line: rows().map(|row| [100.0 * row.load, row.people_s]).collect(),
            }
        });
        Plot {
            title: "How long loads are held (lines: by people)".into(),
            axes: ["load, % of strength".into(), "time, s".into()],
            series: series.collect(),
        }
    }

    /// What of it people's bands are about: the shoulder, of a body that has one.
    pub fn figures(&self, figures: &mut Figures) -> Result<(), ProtocolError> {
        let rows: Vec<_> = self.rows.iter().filter(|row| row.joint == Some(JUDGED)).collect();
        let Some(of_people) = rows.iter().map(|row| row.of_people).collect::<Option<Vec<_>>>() else { return Ok(()) };
        if of_people.is_empty() {
            return Ok(());
        }
        let longer = rows.windows(2).filter(|pair| pair[1].time_s >= pair[0].time_s).count();
        let all = [
            (Figure::EnduranceLeast, of_people.iter().copied().fold(f64::INFINITY, f64::min)),
            (Figure::EnduranceGreatest, of_people.iter().copied().fold(0.0, f64::max)),
            (Figure::EnduranceRises, longer as f64),
        ];
        set_all(figures, all)
    }
}

impl Recovery {
    /// Asks the muscles of a body, in steps of so many seconds.
    pub fn of(model: &Model, dt: f64) -> Self {
        let row = |joint: Option<MuscleGroup>| {
            let rates = FatigueRates::of(joint);
            let [after_work, after_rest] = by_turns(rates, dt);
            let [_, without_rest_factor] = by_turns(FatigueRates { rest_factor: 1.0, ..rates }, dt);
            RecoveryRow { joint, after_work, after_rest, without_rest_factor }
        };
        Self { model: model.name.clone(), rows: joints(model).into_iter().map(row).collect() }
    }
}

#[cfg(test)]
mod tests {
    use myo_measure::bands::{Verdict, judge};
    use myo_model::builtin;

    use super::*;

    fn body(name: &str) -> Model {
        Model::new(&builtin(name).unwrap()).unwrap()
    }

    #[test]
    fn loads_are_held_as_long_as_people_hold_them() {
        for dt in [0.002, 0.04, 0.1] {
            let found = Endurance::of(&body("myo-arm"), dt);
            assert_eq!(found.rows.len(), 3 * LOADS.len(), "shoulder, elbow and hand");
            let mut figures = Figures::new();
            found.figures(&mut figures).unwrap();
            let band = judge(&figures).into_iter().find(|judged| judged.band.number == 15).unwrap();
            let endurance = band.findings.iter().filter(|finding| finding.bound.figure != Figure::WaistOverShoulder);
            assert!(endurance.clone().all(|finding| finding.verdict == Verdict::Passed), "{:#?}", band.findings);
        }
    }

    /// The closed form of Xia and Frey-Law's equations: `-ln(1 - R (1 - load) / (F load)) / R`.
    #[test]
    fn the_time_is_that_of_the_equations() {
        let (rates, load, dt) = (MuscleGroup::Shoulder.rates(), 0.5, 0.002);
        let FatigueRates { fatigue_per_s: f, recovery_per_s: r, .. } = rates;
        let missing = 1.0 - (1.0 - MISSING) * load;
        let exact = -(1.0 - r * missing / (f * load)).ln() / r;
        let found = held_s(rates, load, dt).unwrap();
        assert!((found - exact).abs() < 0.01 * exact, "{found} s, not {exact}");
    }

    #[test]
    fn what_is_never_missed_is_held_for_ever() {
        // Below R / (F + R) of all they can, people's muscles recover as fast as they tire.
        let FatigueRates { fatigue_per_s: f, recovery_per_s: r, .. } = MuscleGroup::Elbow.rates();
        let least = r / (f + r);
        assert_eq!(held_s(MuscleGroup::Elbow.rates(), 0.9 * least, 0.1), None);
        assert!(held_s(MuscleGroup::Elbow.rates(), 1.3 * least, 0.1).is_some());
    }

    #[test]
    fn rest_is_better_than_work_for_what_is_fatigued() {
        let found = Recovery::of(&body("myo-arm"), 0.04);
        for row in &found.rows {
            assert!(row.after_rest < 0.7 * row.after_work, "{row:?}");
            assert!(row.after_rest < 0.5 * row.without_rest_factor, "{row:?}");
        }
        assert_eq!(found.rows.len(), 3);
    }

    #[test]
    fn a_body_without_a_shoulder_has_no_figures_and_is_asked_all_the_same() {
        let mut description = builtin("myo-arm").unwrap();
        description.muscles.iter_mut().for_each(|muscle| muscle.parameters.group = None);
        let found = Endurance::of(&Model::new(&description).unwrap(), 0.04);
        assert!(found.rows.len() == LOADS.len() && found.rows.iter().all(|row| row.joint.is_none()));
        let mut figures = Figures::new();
        found.figures(&mut figures).unwrap();
        assert_eq!(figures.get(Figure::EnduranceLeast), None);
    }
}
