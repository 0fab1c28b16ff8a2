//! `myo eval --protocol`: simulated users asked what people were asked.

use std::path::{Path, PathBuf};

use clap::ValueEnum;
use myo::measure::bands::{Figures, Verdict, judge};
use myo::protocol::{
    FittsLaw, KeyPresses, Kinematics, MuscleDrive, Plot, Practice, ProtocolError, Recording, Scatter, Stillness,
    Strength, UserReaches, reaches, record,
};
use myo::train::session::evaluation_seed;
use myo::train::{Checkpoint, PpoConfig, write_whole};
use serde::Serialize;
use serde_json::{Value, json};

use super::backend::Options;
use super::failure::{Failure, Result, complain};
use super::interrupt::Interrupt;
use super::output::{name, print, print_json, row, table};
use super::scenario::Scenario;
use super::train::{Practising, practise};

/// Users who are asked unless another number is wanted.
pub const USERS: usize = 3;
/// Episodes of each layout that are recorded.
const EPISODES: usize = 8;
/// Of layouts that there is only one of.
const MANY_EPISODES: usize = 40;

/// What is asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Protocol {
    /// Fitts' law: how long it takes to select targets of many distances and widths
    #[value(name = "F1")]
    F1,
    /// Speeds, shapes and smoothness of these movements
    #[value(name = "K1")]
    K1,
    /// Where movements at small targets end before they are corrected
    #[value(name = "K2")]
    K2,
    /// How still the arm is held
    #[value(name = "K3")]
    K3,
    /// Activations of muscles, held and moving
    #[value(name = "K5")]
    K5,
    /// Presses of keys: force, contact time, rate
    #[value(name = "T1")]
    T1,
    /// Strength, moment arms, and the share of strength that holds the arm up
    #[value(name = "M1")]
    M1,
    /// All of them, and which figures are like people's
    #[value(name = "bands")]
    Bands,
}

/// Who is asked.
pub struct Asked<'a> {
    /// Folder of the run.
    pub folder: &'a Path,
    /// What the user learnt there, and its body.
    pub scenario: Scenario,
    /// How it learnt it.
    pub config: PpoConfig,
    /// How many users, and the seed of the first.
    pub users: (usize, u64),
    /// Control steps after which practice ends.
    pub steps: Option<u64>,
    /// What computes the physics of practice.
    pub physics: &'a Options,
}

/// Asks, and prints the answer.
pub fn run(protocol: Protocol, asked: &Asked<'_>, json: bool) -> Result<()> {
    let mut asking = Asking { asked, practised: vec![] };
    let figures = &mut Figures::new();
    match protocol {
        Protocol::M1 => {
            let found = Strength::of(&asked.scenario.model).map_err(ProtocolError::from)?;
            if json { print_json(&found) } else { print(&strength(&found)) }
        }
        Protocol::F1 => tell(asked, "F1", &asking.fitts(figures)?, (fitts, Some(FittsLaw::plot)), json),
        Protocol::K1 => tell(asked, "K1", &asking.kinematics(figures)?, (kinematics, Some(Kinematics::plot)), json),
        Protocol::K2 => tell(asked, "K2", &asking.scatter(figures)?, (scatter, Some(Scatter::plot)), json),
        Protocol::K3 => tell(asked, "K3", &asking.stillness(figures)?, (stillness, None), json),
        Protocol::K5 => tell(asked, "K5", &asking.drive(figures)?, (drive, None), json),
        Protocol::T1 => tell(asked, "T1", &asking.keys(figures)?, (keys, None), json),
        Protocol::Bands => bands(&mut asking, json),
    }
}

/// How an answer is told: as text, and as a plot if it has one.
type Telling<T> = (fn(&T) -> String, Option<fn(&T) -> Plot>);

fn tell<T: Serialize>(
    asked: &Asked<'_>,
    protocol: &str,
    found: &T,
    (text, plot): Telling<T>,
    json: bool,
) -> Result<()> {
    let plots = plot.map_or_else(|| Ok(vec![]), |plot| draw(asked, protocol, &plot(found)))?;
    if !json {
        let lines: String = plots.iter().map(|path| format!("plot: {}\n", path.display())).collect();
        return print(&format!("{}{lines}", text(found)));
    }
    let mut value = serde_json::to_value(found)?;
    value["protocol"] = protocol.into();
    value["plots"] = serde_json::to_value(&plots)?;
    print_json(&value)
}

/// Writes a plot beside the users who practised, as SVG and as PNG.
fn draw(asked: &Asked<'_>, protocol: &str, plot: &Plot) -> Result<Vec<PathBuf>> {
    let path = |ending: &str| asked.folder.join("protocols").join(format!("{protocol}.{ending}"));
    let files = [(path("svg"), plot.svg()?.into_bytes()), (path("png"), plot.png()?)];
    let write = |(path, contents): (PathBuf, Vec<u8>)| write_whole(&path, &contents).map(|()| path);
    Ok(files.into_iter().map(write).collect::<std::result::Result<_, _>>()?)
}

/// Users who practise what is asked of them, once.
struct Asking<'a> {
    asked: &'a Asked<'a>,
    practised: Vec<(Practice, Vec<Vec<Vec<Recording>>>)>,
}

impl Asking<'_> {
    /// Recordings of each user by layout.
    fn recordings(&mut self, practice: Practice) -> Result<&[Vec<Vec<Recording>>]> {
        if let Some(at) = self.practised.iter().position(|(other, _)| *other == practice) {
            return Ok(&self.practised[at].1);
        }
        let Asked { folder, scenario, config, users, steps, physics } = self.asked;
        let layouts = practice.layouts(&scenario.task).map_err(ProtocolError::from)?;
        let first = layouts.first().cloned().ok_or_else(|| Failure::sentence("the protocol has no task"))?;
        let (model, own_model) = (scenario.model.clone(), scenario.own_model.clone());
        let task = Scenario { task: first, layouts, model, own_model, most_success: 1.0 };
        let practising =
            Practising { scenario: &task, config: practice.learning(config), users: *users, steps: *steps, physics };
        let place = folder.join("protocols").join(practice.name());
        let trained = practise(&practising, &place, &Interrupt::listen()?)?;
        complain(&format!("recording {} users, {}", trained.len(), practice.name()));
        let episodes = if task.layouts.len() > 1 { EPISODES } else { MANY_EPISODES };
        let one = |checkpoint: &Checkpoint| {
            let seed = evaluation_seed(checkpoint.seed(), 0);
            record(&mut checkpoint.policy(), &task.model, &task.layouts, (episodes, seed))
        };
        let recordings = trained.iter().map(one).collect::<std::result::Result<Vec<_>, _>>()?;
        self.practised.push((practice, recordings));
        Ok(&self.practised[self.practised.len() - 1].1)
    }

    /// Recordings of each user, of a practice with one layout.
    fn single(&mut self, practice: Practice) -> Result<Vec<Vec<Recording>>> {
        Ok(self.recordings(practice)?.iter().map(|layouts| layouts.concat()).collect())
    }

    fn reaches(&mut self) -> Result<Vec<UserReaches>> {
        let of_user = |layouts: &Vec<Vec<Recording>>| Ok(UserReaches { reaches: reaches(layouts)?, repeats: EPISODES });
        self.recordings(Practice::Pointing)?.iter().map(of_user).collect()
    }

    fn fitts(&mut self, figures: &mut Figures) -> Result<FittsLaw> {
        let found = FittsLaw::of(&self.reaches()?)?;
        found.figures(figures)?;
        Ok(found)
    }

    fn kinematics(&mut self, figures: &mut Figures) -> Result<Kinematics> {
        let found = Kinematics::of(&self.reaches()?)?;
        found.figures(figures)?;
        Ok(found)
    }

    fn scatter(&mut self, figures: &mut Figures) -> Result<Scatter> {
        let found = Scatter::of(&self.reaches()?)?;
        found.figures(figures)?;
        Ok(found)
    }

    fn stillness(&mut self, figures: &mut Figures) -> Result<Stillness> {
        let found = Stillness::of(&self.single(Practice::Holding)?)?;
        found.figures(figures)?;
        Ok(found)
    }

    fn drive(&mut self, figures: &mut Figures) -> Result<MuscleDrive> {
        let users =
            self.single(Practice::Holding)?.into_iter().zip(self.single(Practice::Pointing)?).collect::<Vec<_>>();
        let found = MuscleDrive::of(&self.asked.scenario.model, &users)?;
        found.figures(figures)?;
        Ok(found)
    }

    fn keys(&mut self, figures: &mut Figures) -> Result<KeyPresses> {
        let users = self.single(Practice::Keys)?.into_iter().zip(self.single(Practice::Tapping)?).collect::<Vec<_>>();
        let found = KeyPresses::of(&users)?;
        found.figures(figures)?;
        Ok(found)
    }

    fn strength(&mut self, figures: &mut Figures) -> Result<Strength> {
        let found = Strength::of(&self.asked.scenario.model).map_err(ProtocolError::from)?;
        found.figures(figures)?;
        Ok(found)
    }
}

/// A figure to three digits.
fn short(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    let digits = (2 - value.abs().log10().floor() as i32).clamp(0, 6) as usize;
    format!("{value:.digits$}")
}

fn interval(interval: Option<[f64; 2]>) -> String {
    interval.map_or("-".into(), |[low, high]| format!("{} to {}", short(low), short(high)))
}

fn users(count: usize) -> String {
    if count == 1 { "one user".into() } else { format!("{count} users") }
}

fn fitts(found: &FittsLaw) -> String {
    let mut rows = vec![row(["distance", "width", "ID", "movement time", "95 % interval", "not made"])];
    rows.extend(found.conditions.iter().map(|c| {
        row([
            &format!("{:.0} cm", 100.0 * c.distance_m),
            &format!("{:.1} cm", 100.0 * c.width_m),
            &format!("{:.2} bit", c.id_bit),
            &format!("{:.3} s", c.movement_time_s),
            &interval(c.movement_time_s_interval),
            &format!("{:.1} %", 100.0 * c.missed),
        ])
    }));
    let fit = &found.fitts;
    let fits = [
        row(["Fitts' law", "median", "95 % interval", "people"]),
        row(["R2", &short(fit.r2), &interval(fit.r2_interval), "at least 0.9"]),
        row(["slope, s/bit", &short(fit.slope_s_per_bit), &interval(fit.slope_s_per_bit_interval), "0.09 to 0.3"]),
        row(["intercept, s", &short(fit.intercept_s), &interval(fit.intercept_s_interval), ""]),
        row([
            "throughput, bit/s",
            &short(fit.throughput_bit_s),
            &interval(fit.throughput_bit_s_interval),
            "2.5 to 7.5",
        ]),
    ];
    let who = users(found.users);
    format!(
        "Protocol F1, Fitts' law of {who}, across a circle of 13 targets, dwell not counted\n{}\n{}",
        table(&rows),
        table(&fits)
    )
}

fn kinematics(found: &Kinematics) -> String {
    let mut rows = vec![row(["movements", "median", "95 % interval", ""])];
    rows.extend(found.rows.iter().map(|r| row([r.what, &short(r.median), &interval(r.interval), r.unit])));
    format!("Protocol K1, {} movements of {}\n{}", found.movements, users(found.users), table(&rows))
}

fn scatter(found: &Scatter) -> String {
    let mm = |metres: f64| format!("{:.1} mm", 1e3 * metres);
    let mut rows = vec![row(["distance", "SD along", "SD across", "beyond the target"])];
    rows.extend(found.rows.iter().map(|r| {
        row([&format!("{:.0} cm", 100.0 * r.distance_m), &mm(r.sd_along_m), &mm(r.sd_across_m), &mm(r.overshoot_m)])
    }));
    format!(
        "Protocol K2, end points of {} before any correction, targets of 1 cm\n{}\nalong over across {}, {} mm more along for each 10 cm, \
         across {} degrees\n",
        users(found.users),
        table(&rows),
        short(found.elongation),
        short(100.0 * found.growth_along),
        short(found.direction_deg)
    )
}

fn stillness(found: &Stillness) -> String {
    let mut rows = vec![row(["arm raised by", "mean speed", "tremor, 4 to 15 Hz", "drift"])];
    rows.extend(found.rows.iter().map(|r| {
        row([
            &format!("{} degrees", r.at_deg),
            &format!("{:.1} mm/s", 1e3 * r.mean_speed_m_s),
            &format!("{:.2} mm", 1e3 * r.tremor_m),
            &format!("{:.1} mm", 1e3 * r.drift_m),
        ])
    }));
    format!("Protocol K3, holding of {} (people: at most 20 mm/s and 0.5 mm)\n{}", users(found.users), table(&rows))
}

fn drive(found: &MuscleDrive) -> String {
    let mut rows =
        vec![row(["", "mean activation", "below 0.05", "above 0.95", "change in 50 ms", "elbow co-contraction"])];
    rows.extend(found.rows.iter().map(|r| {
        let percent = |share: f64| format!("{:.1} %", 100.0 * share);
        row([
            r.when,
            &short(r.mean),
            &percent(r.share_at_rest),
            &percent(r.share_saturated),
            &short(r.change_per_50_ms),
            &short(r.elbow_co_contraction),
        ])
    }));
    format!("Protocol K5, muscles of {}\n{}", users(found.users), table(&rows))
}

fn keys(found: &KeyPresses) -> String {
    let rows = [
        row(["presses", "median", "people"]),
        row(["peak force", &format!("{:.2} N", found.peak_force_n), "0.3 to 2 N"]),
        row(["contact time", &format!("{:.0} ms", 1e3 * found.contact_time_s), "60 to 220 ms"]),
        row(["impulse", &format!("{:.3} N s", found.impulse_n_s), ""]),
        row(["from press to press", &format!("{:.0} ms", 1e3 * found.interval_s), ""]),
        row(["one key, presses per second", &short(found.rate_hz), "at most 6.5"]),
    ];
    format!("Protocol T1, {} presses of {}\n{}", found.presses, users(found.users), table(&rows))
}

/// What a protocol found, or why it found nothing.
fn answer<T: Serialize>(answers: &mut Vec<(&str, Value)>, protocol: &'static str, found: Result<T>) -> Result<()> {
    let value = match found {
        Ok(found) => serde_json::to_value(found)?,
        Err(Failure::Sentence(reason)) => {
            complain(&format!("warning: {protocol}: {reason}"));
            json!({"error": reason})
        }
        Err(other) => return Err(other),
    };
    answers.push((protocol, value));
    Ok(())
}

/// All protocols, and what comes of their figures.
fn bands(asking: &mut Asking<'_>, json: bool) -> Result<()> {
    let (figures, answers) = (&mut Figures::new(), &mut vec![]);
    answer(answers, "M1", asking.strength(figures))?;
    answer(answers, "F1", asking.fitts(figures))?;
    answer(answers, "K1", asking.kinematics(figures))?;
    answer(answers, "K2", asking.scatter(figures))?;
    answer(answers, "K3", asking.stillness(figures))?;
    answer(answers, "K5", asking.drive(figures))?;
    answer(answers, "T1", asking.keys(figures))?;
    let judged = judge(figures);
    if json {
        let finding = |f: &myo::measure::bands::Finding| {
            json!({
                "figure": format!("{:?}", f.bound.figure), "value": f.value, "should_be": f.bound.to_string(),
                "verdict": word(f.verdict), "judged": f.bound.judged,
            })
        };
        let bands: Vec<Value> = (judged.iter())
            .map(|judgement| {
                json!({
                    "number": judgement.band.number, "what": judgement.band.what, "verdict": word(judgement.verdict),
                    "figures": judgement.findings.iter().map(finding).collect::<Vec<_>>(),
                })
            })
            .collect();
        let mut value = json!({"protocol": "bands", "users": asking.asked.users.0, "bands": bands});
        for (protocol, found) in std::mem::take(answers) {
            value[protocol] = found;
        }
        return print_json(&value);
    }
    let mut rows = vec![row(["band", "", "figure", "value", "people", ""])];
    for judgement in &judged {
        for (at, f) in judgement.findings.iter().enumerate() {
            let (number, what) =
                if at == 0 { (judgement.band.number.to_string(), judgement.band.what) } else { (String::new(), "") };
            let value = f.value.map_or("-".into(), short);
            rows.push(row([
                &number,
                what,
                &format!("{:?}", f.bound.figure),
                &value,
                &f.bound.to_string(),
                word(f.verdict),
            ]));
        }
    }
    let passed = judged.iter().filter(|judgement| judgement.verdict == Verdict::Passed).count();
    let failed = judged.iter().filter(|judgement| judgement.verdict == Verdict::Failed).count();
    print(&format!(
        "Figures of {}, medians, beside people's\n{}\n{passed} bands passed, {failed} failed\n",
        users(asking.asked.users.0),
        table(&rows)
    ))
}

fn word(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Passed => "passed",
        Verdict::Failed => "failed",
        Verdict::NotMeasured => "not_measured",
        Verdict::Reported => "reported",
    }
}

/// Protocol M1 for people.
fn strength(found: &Strength) -> String {
    let verdict = |passes| if passes { "pass" } else { "FAIL" }.to_owned();
    let head = |cells: &[&str]| cells.iter().map(ToString::to_string).collect::<Vec<_>>();
    let mut strengths = vec![head(&["strength", "at", "this body", "people", ""])];
    strengths.extend(found.strength.iter().map(|row| {
        let [from, to] = row.people_n_m;
        let people = if from == to { format!("{from}") } else { format!("{from} to {to}") };
        vec![row.what.into(), format!("{}", row.at_deg), format!("{:.1}", row.torque_n_m), people, verdict(row.passes)]
    }));
    let mut holding = vec![head(&["arm straight", "at", "gravity", "strength", "share", ""])];
    holding.extend(found.holding.iter().map(|row| {
        let torques = [row.gravity_n_m, row.strength_n_m].map(|torque| format!("{torque:.1}"));
        let [gravity, strength] = torques;
        let share = format!("{:.2}", row.share);
        vec![row.way.into(), format!("{}", row.at_deg), gravity, strength, share, verdict(row.passes)]
    }));
    let mut arms = vec![head(&["moment arm at the elbow", "at", "this body", "people"])];
    arms.extend(found.moment_arms.iter().map(|row| {
        vec![
            row.muscle.into(),
            format!("{}", row.at_deg),
            format!("{:.2}", row.body_cm),
            format!("{:.2}", row.people_cm),
        ]
    }));
    let changes = match &found.sign_changes[..] {
        [] => "No muscle that was looked at changes sides.\n".to_owned(),
        changes => changes
            .iter()
            .map(|change| {
                format!("{} changes sides at {} degrees of {}: FAIL\n", change.muscle, change.at_deg, change.joint)
            })
            .collect(),
    };
    format!(
        "Protocol M1, strength of {} (N m, degrees)\n{}\nShare of strength that holds the arm up (people: 0.12 to 0.35)\n{}\n\
         Moment arms (cm)\n{}\n{changes}",
        name(&found.model),
        table(&strengths),
        table(&holding),
        table(&arms)
    )
}
