//! Simulated users, recorded as people are.

use myo_measure::Point;
use myo_model::Model;
use myo_tasks::Task;
use myo_train::Policy;

use super::columns::Sample;
use super::{Gathered, RecordingError, Recordings};
use crate::trajectories::{Trajectories, Values, trajectories};

impl Recordings {
    /// What the user of a policy does in `episodes` episodes of each layout, as [`trajectories`](crate::trajectories()) would write it down: the
    /// hand is what points.
    ///
    /// # Errors
    /// The policy does not fit the layouts, or these cannot be simulated.
    pub fn of_user(
        name: &str,
        policy: &mut Policy,
        model: &Model,
        layouts: &[Task],
        asked: (usize, u64),
    ) -> Result<Self, RecordingError> {
        let muscles: Vec<String> = model.muscles.iter().map(|muscle| muscle.name.clone()).collect();
        let mut found = Gathered::of(muscles);
        trajectories(policy, model, layouts, asked, |some| add(&mut found, name, &some).map(|()| true))?;
        found.whole()
    }
}

/// Puts the rows of trajectories behind what was gathered.
fn add(found: &mut Gathered, name: &str, some: &Trajectories) -> Result<(), RecordingError> {
    let hand = if some.number("pointer_x_m").is_some() { "pointer" } else { "fingertip" };
    let [hand, object] = [hand, "object"].map(|of| ["x", "y", "z"].map(|axis| some.number(&format!("{of}_{axis}_m"))));
    let [times, widths] = ["time_s", "object_width_m"].map(|column| some.number(column));
    let activations = found.muscles.iter().map(|muscle| some.number(&format!("{muscle}_activation")));
    let activations: Vec<Option<&[f64]>> = activations.collect();
    let [layouts, events] = ["layout", "event"].map(|column| some.text(column));
    let place = |axes: [Option<&[f64]>; 3], row: usize| -> Point { axes.map(|axis| axis.map_or(0.0, |x| x[row])) };
    let text = |all: Option<&[String]>, row: usize| all.map_or_else(String::new, |all| all[row].clone());
    for row in 0..some.rows() {
        let episode = some.whole("episode").map_or_else(String::new, |all| all[row].to_string());
        let width = widths.map_or(f64::NAN, |x| x[row]);
        let target = width.is_finite().then(|| (place(object, row), width));
        let (layout, time_s) = (text(layouts, row), times.map_or(0.0, |x| x[row]));
        let mut sample = Sample::of([name, &layout, &episode], time_s, place(hand, row), target, &text(events, row));
        sample.activations = activations.iter().map(|muscle| muscle.map_or(0.0, |all| all[row])).collect();
        found.add(sample)?;
    }
    Ok(())
}

impl Trajectories {
    fn column(&self, name: &str) -> Option<&Values> {
        self.columns.iter().find(|column| column.name == name).map(|column| &column.values)
    }

    fn number(&self, name: &str) -> Option<&[f64]> {
        match self.column(name)? {
            Values::Number(all) => Some(all),
            _ => None,
        }
    }

    fn text(&self, name: &str) -> Option<&[String]> {
        match self.column(name)? {
            Values::Text(all) => Some(all),
            _ => None,
        }
    }

    fn whole(&self, name: &str) -> Option<&[u32]> {
        match self.column(name)? {
            Values::Whole(all) => Some(all),
            _ => None,
        }
    }
}
