//! How long a card takes to train users of many layouts, as many at once as the library takes, or so many:
//! `cargo run --release -p myo-benches --example layouts_at_once -- LAYOUTS SEEDS [AT_ONCE]`.
//!
//! Layouts are four buttons on an upright wall, spread, moved and made larger or smaller without chance. Users are trained until 95 %
//! of fresh episodes succeed. The time of the whole process is what `time` tells.

use std::error::Error;
use std::time::Instant;

use myo::gpu::{AdapterChoice, Gpu};
use myo::model::builtin;
use myo::tasks::{Item, Range, Task, preset, spread};
use myo::train::PpoConfig;
use myo::train::session::{Goal, Outcome, SessionError, Until};
use myo::{Device, User, batches, train_at_once};

/// Control steps of a training at most.
const STEPS: u64 = 20_000_000;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [layouts, seeds, rest @ ..] = &arguments[..] else {
        return Err("usage: layouts_at_once LAYOUTS SEEDS [AT_ONCE]".into());
    };
    let (layouts, seeds): (u32, u64) = (layouts.parse()?, seeds.parse()?);
    let tasks: Vec<Task> = (0..layouts).map(layout).collect();
    let model = tasks[0].embody(&builtin(&tasks[0].model)?)?;
    let device = Device::Gpu(Gpu::open(&AdapterChoice::Hardware)?);
    let users: Vec<User<'_>> = tasks.iter().flat_map(|task| (1..=seeds).map(move |seed| User { task, seed })).collect();
    let together = match rest {
        [] => batches(&model, &users)?,
        [at_once, ..] => {
            let all: Vec<usize> = (0..users.len()).collect();
            all.chunks(at_once.parse()?).map(<[usize]>::to_vec).collect()
        }
    };
    let (config, goal) = (PpoConfig::default(), Goal { until: Until::Success(0.95), steps: STEPS });
    let begun = Instant::now();
    let mut outcomes = vec![];
    for batch in together {
        let users: Vec<User<'_>> = batch.iter().map(|&k| users[k]).collect();
        outcomes.extend(train_at_once(&device, &model, &users, &config, goal, &|| true)?);
        println!("{} users after {:.1} s", outcomes.len(), begun.elapsed().as_secs_f64());
    }
    tell(outcomes)
}

/// Four buttons, their middles 10 to 30 cm apart, 3 to 6 cm wide.
fn layout(number: u32) -> Task {
    let [across, down, apart_y, apart_z, size] = spread::<5>(number);
    let mut task = preset("public-display").expect("it comes with the library");
    task.name = format!("layout-{number}");
    let places = [(1.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)];
    for (item, (right, up)) in task.scene.0.values_mut().zip(places) {
        let Item::Button(button) = item else { continue };
        let (half_y, half_z) = (0.05 + 0.1 * apart_y, 0.05 + 0.1 * apart_z);
        button.at = [0.42, -0.05 + 0.1 * across - right * half_y, -0.24 + 0.2 * down + up * half_z].into();
        let size = 0.03 + 0.03 * size;
        button.size = [size, size, 0.02].map(Range::fixed);
    }
    task
}

fn tell(outcomes: Vec<Result<Outcome, SessionError>>) -> Result<(), Box<dyn Error>> {
    let outcomes = outcomes.into_iter().collect::<Result<Vec<_>, _>>()?;
    let reached = outcomes.iter().filter(|outcome| outcome.end.name() == "until").count();
    let mut steps: Vec<u64> = outcomes.iter().map(|outcome| outcome.env_steps).collect();
    steps.sort_unstable();
    let million = |steps: u64| steps as f64 / 1e6;
    println!(
        "{reached} of {} users at 95 %, after {:.2} M control steps in the median, {:.2} M at most, {:.0} M together",
        outcomes.len(),
        million(steps[steps.len() / 2]),
        million(*steps.last().ok_or("no users")?),
        million(steps.iter().sum()),
    );
    Ok(())
}
