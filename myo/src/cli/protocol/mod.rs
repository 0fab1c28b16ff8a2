//! `myo eval --protocol`: simulated users asked what people were asked.

mod people;
mod tables;

pub use people::People;

use std::path::{Path, PathBuf};

use clap::ValueEnum;
use myo::measure::bands::{Figures, judge};
use myo::protocol::{
    ChoiceReaction, EllipseLaps, Endurance, FarReaches, FittsLaw, KeyPresses, Kinematics, MuscleDrive, Plot, Practice,
    ProtocolError, Pursuit, RayPointing, Recording, Recovery, Scatter, Sizes, SteeringLaw, Stillness, Strength, Typing,
    UserReaches, WorkInTheAir, answer_path, reaches, record,
};
use myo::train::session::evaluation_seed;
use myo::train::{Checkpoint, PpoConfig, write_whole};
use serde::Serialize;
use serde_json::{Value, json};

use super::backend::Options;
use super::failure::{Failure, Result, complain};
use super::interrupt::Interrupt;
use super::model;
use super::output::{print, print_json};
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
    /// How much slower a hand is where its way is more curved, on laps of an ellipse
    #[value(name = "K4")]
    K4,
    /// Activations of muscles, held and moving
    #[value(name = "K5")]
    K5,
    /// The steering law: how long straight and round ways take that must not be left
    #[value(name = "S1")]
    S1,
    /// How well a wandering target is tracked, by how fast it wanders
    #[value(name = "S2")]
    S2,
    /// How much longer it takes to react where there are more to choose from
    #[value(name = "C1")]
    C1,
    /// How long pointing at a wall with a ray takes, by angles
    #[value(name = "I1")]
    I1,
    /// How long reaching far with a hand that grows (Go-Go) takes, and how fast it is
    #[value(name = "I2")]
    I2,
    /// Presses of keys: force, contact time, rate
    #[value(name = "T1")]
    T1,
    /// Words per minute and wrong presses on a phone's keys of four sizes
    #[value(name = "T3")]
    T3,
    /// Strength, moment arms, and the share of strength that holds the arm up
    #[value(name = "M1")]
    M1,
    /// Whether small and large people reach as far, weigh as much and are as strong as people of their size
    #[value(name = "A1")]
    A1,
    /// How long muscles hold a load
    #[value(name = "E1")]
    E1,
    /// What ten minutes of selecting in the air cost, at the height of the shoulder and of the waist
    #[value(name = "E2")]
    E2,
    /// How muscles recover from work
    #[value(name = "E3")]
    E3,
    /// All but A1, C1, E3, I1, I2, K4, S1, S2 and T3, and which figures are like people's
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
    /// Whose recordings stand beside the answers of F1 and K1.
    pub people: Vec<People>,
}

/// Asks, and prints the answer.
pub fn run(protocol: Protocol, asked: &Asked<'_>, json: bool) -> Result<()> {
    let mut asking = Asking { asked, interrupt: Interrupt::listen()?, practised: vec![] };
    let figures = &mut Figures::new();
    match protocol {
        Protocol::M1 => tell(asked, "M1", asking.strength(figures), (&tables::strength, None), json).map(drop),
        Protocol::A1 => tell(asked, "A1", asking.sizes(), (&tables::sizes, None), json).map(drop),
        Protocol::F1 => {
            let text = |found: &FittsLaw| tables::fitts(found) + &people::laws(&asked.people);
            let plot = |found: &FittsLaw| {
                let mut plot = found.plot();
                asked.people.iter().for_each(|people| people.draw(&mut plot));
                plot
            };
            let found = tell(asked, "F1", asking.fitts(figures), (&text, Some(&plot)), json)?;
            whole("there is no Fitts' law", found.unlearnt)
        }
        Protocol::K1 => {
            let text = |found: &Kinematics| tables::kinematics(found) + &people::movements(&asked.people, &found.rows);
            tell(asked, "K1", asking.kinematics(figures), (&text, Some(&Kinematics::plot)), json).map(drop)
        }
        Protocol::K2 => {
            tell(asked, "K2", asking.scatter(figures), (&tables::scatter, Some(&Scatter::plot)), json).map(drop)
        }
        Protocol::K3 => tell(asked, "K3", asking.stillness(figures), (&tables::stillness, None), json).map(drop),
        Protocol::K4 => tell(asked, "K4", asking.ellipse(), (&tables::ellipse, None), json).map(drop),
        Protocol::C1 => {
            tell(asked, "C1", asking.choosing(), (&tables::choosing, Some(&ChoiceReaction::plot)), json).map(drop)
        }
        Protocol::K5 => tell(asked, "K5", asking.drive(figures), (&tables::drive, None), json).map(drop),
        Protocol::S1 => {
            let found = tell(asked, "S1", asking.steering(), (&tables::steering, Some(&SteeringLaw::plot)), json)?;
            whole("some ways were not learnt", found.unlearnt)
        }
        Protocol::S2 => tell(asked, "S2", asking.tracking(), (&tables::tracking, Some(&Pursuit::plot)), json).map(drop),
        Protocol::I1 => {
            let found = tell(asked, "I1", asking.ray(), (&tables::ray, Some(&RayPointing::plot)), json)?;
            whole("some pairs of angles were not learnt", found.unlearnt)
        }
        Protocol::I2 => {
            let found = tell(asked, "I2", asking.far(), (&tables::far, Some(&FarReaches::plot)), json)?;
            whole("some distances were not learnt", found.unlearnt)
        }
        Protocol::T1 => tell(asked, "T1", asking.keys(figures), (&tables::keys, None), json).map(drop),
        Protocol::T3 => {
            let found = tell(asked, "T3", asking.typing(), (&tables::typing, Some(&Typing::plot)), json)?;
            whole("some keys were not learnt", found.unlearnt)
        }
        Protocol::E1 => {
            tell(asked, "E1", asking.endurance(figures), (&tables::endurance, Some(&Endurance::plot)), json).map(drop)
        }
        Protocol::E2 => tell(asked, "E2", asking.work(figures), (&tables::work, None), json).map(drop),
        Protocol::E3 => tell(asked, "E3", Ok(asking.recovery()), (&tables::recovery, None), json).map(drop),
        Protocol::Bands => bands(&mut asking, json),
    }
}

/// Fails where a user has not learnt all that was asked, after what was learnt has been told.
fn whole(lacks: &str, unlearnt: Option<String>) -> Result<()> {
    unlearnt.map_or(Ok(()), |what| Err(Failure::sentence(format!("{lacks}: {what}"))))
}

/// How an answer is told: as text, and as a plot if it has one.
type Telling<'a, T> = (&'a dyn Fn(&T) -> String, Option<&'a dyn Fn(&T) -> Plot>);

/// Prints and keeps what was found. Where nothing was, what an earlier user answered is forgotten: it is no answer of this one.
fn tell<T: Serialize>(
    asked: &Asked<'_>,
    protocol: &str,
    found: Result<T>,
    (text, plot): Telling<'_, T>,
    json: bool,
) -> Result<T> {
    if let Err(Failure::Sentence(_)) = &found {
        forget(asked, protocol)?;
    }
    let found = found?;
    make_folder(asked, protocol)?;
    let plots = plot.map_or_else(|| Ok(vec![]), |plot| draw(asked, protocol, &plot(&found)))?;
    let text = text(&found);
    keep(asked, protocol, &text)?;
    if !json {
        let lines: String = plots.iter().map(|path| format!("plot: {}\n", path.display())).collect();
        print(&format!("{text}{lines}"))?;
        return Ok(found);
    }
    let mut value = serde_json::to_value(&found)?;
    value["protocol"] = protocol.into();
    value["plots"] = serde_json::to_value(&plots)?;
    if !asked.people.is_empty() {
        value["people"] = serde_json::to_value(&asked.people)?;
    }
    print_json(&value)?;
    Ok(found)
}

/// Writes a plot beside the users who practised, as SVG and as PNG.
fn draw(asked: &Asked<'_>, protocol: &str, plot: &Plot) -> Result<Vec<PathBuf>> {
    let path = |ending: &str| answer_path(asked.folder, protocol, ending);
    let files = [(path("svg"), plot.svg()?.into_bytes()), (path("png"), plot.png()?)];
    let write = |(path, contents): (PathBuf, Vec<u8>)| write_whole(&path, &contents).map(|()| path);
    Ok(files.into_iter().map(write).collect::<std::result::Result<_, _>>()?)
}

/// Writes an answer beside the users who practised, where the studio and reports find it.
fn keep(asked: &Asked<'_>, protocol: &str, text: &str) -> Result<()> {
    Ok(write_whole(&answer_path(asked.folder, protocol, "txt"), text.as_bytes())?)
}

/// Makes the folder of answers, which those that need no practice are the first to come to.
fn make_folder(asked: &Asked<'_>, protocol: &str) -> Result<()> {
    let path = answer_path(asked.folder, protocol, "txt");
    let Some(folder) = path.parent() else { return Ok(()) };
    std::fs::create_dir_all(folder)
        .map_err(|error| Failure::sentence(format!("cannot make {}: {error}", folder.display())))
}

/// Removes an earlier answer and its plot.
fn forget(asked: &Asked<'_>, protocol: &str) -> Result<()> {
    for path in ["txt", "svg", "png"].map(|ending| answer_path(asked.folder, protocol, ending)) {
        match std::fs::remove_file(&path) {
            Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
                return Err(Failure::sentence(format!("cannot remove {}: {error}", path.display())));
            }
            _ => {}
        }
    }
    Ok(())
}

/// Users who practise what is asked of them, once.
struct Asking<'a> {
    asked: &'a Asked<'a>,
    interrupt: Interrupt,
    practised: Vec<(Practice, Vec<Vec<Vec<Recording>>>)>,
}

impl Asking<'_> {
    /// Recordings of each user by layout.
    fn recordings(&mut self, practice: Practice) -> Result<&[Vec<Vec<Recording>>]> {
        if let Some(at) = self.practised.iter().position(|(other, _)| *other == practice) {
            return Ok(&self.practised[at].1);
        }
        let Asked { folder, scenario, config, users, steps, physics, people: _ } = self.asked;
        let layouts = practice.layouts(&scenario.task).map_err(ProtocolError::from)?;
        let first = layouts.first().cloned().ok_or_else(|| Failure::sentence("the protocol has no task"))?;
        let (model, own_model) = (scenario.model.clone(), scenario.own_model.clone());
        let task = Scenario { task: first, layouts, model, own_model, most_success: 1.0 };
        let practising =
            Practising { scenario: &task, config: practice.learning(config), users: *users, steps: *steps, physics };
        let place = folder.join("protocols").join(practice.name());
        let trained = practise(&practising, &place, &self.interrupt)?;
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

    fn typing(&mut self) -> Result<Typing> {
        Ok(Typing::of(self.recordings(Practice::Typing)?)?)
    }

    fn steering(&mut self) -> Result<SteeringLaw> {
        Ok(SteeringLaw::of(self.recordings(Practice::Steering)?)?)
    }

    fn tracking(&mut self) -> Result<Pursuit> {
        Ok(Pursuit::of(self.recordings(Practice::Tracking)?)?)
    }

    fn ellipse(&mut self) -> Result<EllipseLaps> {
        Ok(EllipseLaps::of(&self.single(Practice::Ellipse)?)?)
    }

    fn choosing(&mut self) -> Result<ChoiceReaction> {
        Ok(ChoiceReaction::of(self.recordings(Practice::Choosing)?)?)
    }

    fn ray(&mut self) -> Result<RayPointing> {
        Ok(RayPointing::of(self.recordings(Practice::Ray)?)?)
    }

    fn far(&mut self) -> Result<FarReaches> {
        let layouts = Practice::Far.layouts(&self.asked.scenario.task).map_err(ProtocolError::from)?;
        let task = layouts.first().ok_or_else(|| Failure::sentence("the protocol has no task"))?;
        Ok(FarReaches::of(task, self.recordings(Practice::Far)?)?)
    }

    fn endurance(&self, figures: &mut Figures) -> Result<Endurance> {
        let Scenario { model, task, .. } = &self.asked.scenario;
        let found = Endurance::of(model, task.control_dt_s);
        found.figures(figures)?;
        Ok(found)
    }

    fn sizes(&self) -> Result<Sizes> {
        let Scenario { own_model, task, .. } = &self.asked.scenario;
        let model = own_model.clone().map_or_else(|| model::describe(&task.model), Ok)?;
        Ok(Sizes::of(&model).map_err(ProtocolError::from)?)
    }

    fn recovery(&self) -> Recovery {
        let Scenario { model, task, .. } = &self.asked.scenario;
        Recovery::of(model, task.control_dt_s)
    }

    fn work(&mut self, figures: &mut Figures) -> Result<WorkInTheAir> {
        let model = self.asked.scenario.model.clone();
        // Before anybody practises for nothing.
        WorkInTheAir::check(&model)?;
        let found = WorkInTheAir::of(&model, self.recordings(Practice::Working)?)?;
        found.figures(figures)?;
        Ok(found)
    }

    fn strength(&mut self, figures: &mut Figures) -> Result<Strength> {
        let found = Strength::of(&self.asked.scenario.model).map_err(ProtocolError::from)?;
        found.figures(figures)?;
        Ok(found)
    }
}

/// What a protocol found, or why it found nothing.
fn answer<T: Serialize>(protocol: &str, found: Result<T>) -> Result<Value> {
    match found {
        Ok(found) => Ok(serde_json::to_value(found)?),
        Err(Failure::Sentence(reason)) => {
            complain(&format!("warning: {protocol}: {reason}"));
            Ok(json!({"error": reason}))
        }
        Err(other) => Err(other),
    }
}

/// All protocols, and what comes of their figures.
fn bands(asking: &mut Asking<'_>, json: bool) -> Result<()> {
    let mut figures = Figures::new();
    let answers = [
        ("M1", answer("M1", asking.strength(&mut figures))?),
        ("F1", answer("F1", asking.fitts(&mut figures))?),
        ("K1", answer("K1", asking.kinematics(&mut figures))?),
        ("K2", answer("K2", asking.scatter(&mut figures))?),
        ("K3", answer("K3", asking.stillness(&mut figures))?),
        ("K5", answer("K5", asking.drive(&mut figures))?),
        ("T1", answer("T1", asking.keys(&mut figures))?),
        ("E1", answer("E1", asking.endurance(&mut figures))?),
        ("E2", answer("E2", asking.work(&mut figures))?),
    ];
    let (judged, users) = (judge(&figures), asking.asked.users.0);
    let text = tables::bands(users, &judged);
    make_folder(asking.asked, "bands")?;
    keep(asking.asked, "bands", &text)?;
    if !json {
        return print(&text);
    }
    let mut value = json!({"protocol": "bands", "users": users, "bands": judged});
    for (protocol, found) in answers {
        value[protocol] = found;
    }
    print_json(&value)
}
