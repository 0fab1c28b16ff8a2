//! Measures live retraining and what looking on costs, by the engine alone, as a page drives it:
//!
//! ```text
//! cargo run --release -p myo-studio --example live           # whichever is faster here: processor or graphics card
//! cargo run --release -p myo-studio --example live -- cpu    # the processor
//! ```
//!
//! A user learns the preset `public-display`, and then the same with one button moved by 5 cm, and by 5 cm back, and so on. Of each change
//! is told: when the first look came, when 98 % of practice episodes succeeded, when the user was as good again as before (within 1 % of success and 5 % of time of what it reached in
//! the end), and when further practice brought nothing more. Then one training goes on by turns with and without somebody who looks on.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use myo_lab::Backend;
use myo_studio::engine::Engine;
use myo_studio::protocol::{Event, Job, JobProgress, JobState, Message, Question};
use serde_json::{Value, json};

/// Moves of the button (m), one after the other.
const MOVES: [f64; 4] = [0.05, 0.0, 0.05, 0.0];
/// Turns of looking on and looking away.
const TURNS: usize = 24;

fn main() {
    let backend = match std::env::args().nth(1).as_deref() {
        Some("cpu") => Backend::Cpu,
        _ => Backend::Auto,
    };
    let folder = tempfile::tempdir().expect("a folder");
    let engine =
        Engine::open(folder.path().to_owned(), backend).unwrap_or_else(|refusal| panic!("{}", refusal.message));
    relearn(&engine);
    look_on(&engine);
}

/// The preset with its second button so far (m) to the left.
fn layout(by: f64) -> String {
    let text = myo_tasks::preset_text("public-display").expect("a preset");
    let mut task = myo_tasks::Task::from_yaml(text, "public-display").expect("a task");
    let myo_tasks::Item::Button(button) = &mut task.scene.0["upper_left"] else { panic!("a button") };
    let y = button.at.0.y.centre() + by;
    button.at.0.y = y.into();
    task.to_yaml()
}

fn relearn(engine: &Engine) {
    let begun = Instant::now();
    let id = train(engine, &layout(0.0), "plateau", true);
    let first = wait(engine, id, |job| matches!(job.state, JobState::Done { .. }));
    let progress = first.progress.clone().unwrap_or_default();
    println!(
        "first training, to the plateau: {:.1} s, {} control steps, on {}; fresh episodes: {}",
        begun.elapsed().as_secs_f64(),
        progress.env_steps,
        progress.device,
        end(&first)
    );
    let mut trained = progress.env_steps;
    // On a processor each takes minutes.
    let moves = if progress.device.starts_with("cpu") { &MOVES[..2] } else { &MOVES };
    for &by in moves {
        let begun = Instant::now();
        ask(engine, "relearn", json!({"job": id, "text": layout(by), "settings": null}));
        let mut seen: Vec<(f64, JobProgress)> = Vec::new();
        let mut looked = None;
        let done = wait(engine, id, |job| {
            let now = begun.elapsed().as_secs_f64();
            let Some(progress) = job.progress.as_ref().filter(|progress| progress.before.is_some()) else {
                return false;
            };
            // What is told of the training before does not count.
            if looked.is_none() && progress.env_steps < trained {
                looked = Some(now);
            }
            if looked.is_some() && seen.last().is_none_or(|(_, last)| last.env_steps != progress.env_steps) {
                seen.push((now, progress.clone()));
            }
            looked.is_some() && matches!(job.state, JobState::Done { .. })
        });
        tell(by, begun.elapsed().as_secs_f64(), looked, &seen, &done);
        trained = done.progress.map_or(0, |progress| progress.env_steps);
    }
}

fn tell(by: f64, total: f64, looked: Option<f64>, seen: &[(f64, JobProgress)], done: &Job) {
    let before = seen.first().and_then(|(_, progress)| progress.before.clone());
    let percent = |share: Option<f64>| share.map_or("-".into(), |share| format!("{:.1} %", 100.0 * share));
    let last = seen.last().map(|(_, progress)| progress.clone()).unwrap_or_default();
    let is_as_good = |progress: &JobProgress| {
        let success = progress.success.zip(last.success).is_some_and(|(now, end)| now >= end - 0.01);
        success && progress.episode_s.zip(last.episode_s).is_some_and(|(now, end)| now <= 1.05 * end)
    };
    let adapted = seen.iter().find(|(_, progress)| is_as_good(progress));
    let again = seen.iter().find(|(_, progress)| progress.success.is_some_and(|success| success >= 0.98));
    println!(
        "moved to {by:.2} m: first look after {:.2} s ({}), 98 % of practice succeeds after {:.1} s, as good as in the end after {:.1} s ({} steps), plateau and \
         evaluation after {total:.1} s ({} steps); fresh episodes: {}",
        looked.unwrap_or(f64::NAN),
        percent(before.and_then(|before| before.success)),
        again.map_or(f64::NAN, |(at, _)| *at),
        adapted.map_or(f64::NAN, |(at, _)| *at),
        adapted.map_or(0, |(_, progress)| progress.env_steps),
        last.env_steps,
        end(done)
    );
}

fn end(job: &Job) -> String {
    match &job.state {
        JobState::Done { by, success, episode_s } => format!(
            "{:.1} % in {:.2} s (ended by {by})",
            100.0 * success.unwrap_or(f64::NAN),
            episode_s.unwrap_or(f64::NAN)
        ),
        other => format!("{other:?}"),
    }
}

/// What looking on costs: steps per second of one training, by turns watched and not.
fn look_on(engine: &Engine) {
    let id = train(engine, &layout(0.0), "off", false);
    wait(engine, id, |job| job.progress.as_ref().is_some_and(|progress| progress.env_steps > 500_000));
    let frames = Arc::new(AtomicBool::new(false));
    let ear = engine.hub().listen({
        let frames = Arc::clone(&frames);
        move || frames.store(true, Ordering::Relaxed)
    });
    let (mut rates, mut motions, mut watched_s) = ([vec![], vec![]], 0, 0.0);
    for turn in 0..TURNS {
        let watched = turn % 2;
        ask(engine, "watch", json!({"job": (watched == 1).then_some(id)}));
        std::thread::sleep(Duration::from_millis(300));
        while ear.hear().is_some() {}
        let (steps, begun) = (steps(engine, id), Instant::now());
        while begun.elapsed() < Duration::from_secs(2) {
            std::thread::sleep(Duration::from_millis(20));
            while let Some(message) = ear.hear() {
                if let Message::Motion(header, numbers) = &*message {
                    motions += numbers.len() / header.frame_size;
                }
            }
        }
        let seconds = begun.elapsed().as_secs_f64();
        watched_s += seconds * watched as f64;
        rates[watched].push((self::steps(engine, id) - steps) as f64 / seconds);
    }
    let median = |rates: &mut Vec<f64>| {
        rates.sort_by(f64::total_cmp);
        0.5 * (rates[rates.len() / 2 - 1] + rates[rates.len() / 2])
    };
    let [alone, watched] = &mut rates;
    let (alone, watched) = (median(alone), median(watched));
    println!(
        "looking on: {alone:.0} control steps/s alone, {watched:.0} watched (medians of {} turns each): {:+.1} %; {:.0} frames of \
         movement per second",
        TURNS / 2,
        100.0 * (watched / alone - 1.0),
        motions as f64 / watched_s
    );
    ask(engine, "tell", json!({"job": id, "step": "stop"}));
    wait(engine, id, |job| job.state == JobState::Stopped);
}

fn steps(engine: &Engine, id: u32) -> u64 {
    job(engine, id).and_then(|job| job.progress).map_or(0, |progress| progress.env_steps)
}

fn train(engine: &Engine, text: &str, until: &str, live: bool) -> u32 {
    let order = json!({
        "text": text, "name": "layout", "seed": 1, "users": 1, "until": until, "steps": 10_000_000_000_u64, "from": null, "live": live
    });
    ask(engine, "train", json!({"order": order}))[0].as_u64().and_then(|id| id.try_into().ok()).expect("a number")
}

fn ask(engine: &Engine, call: &str, with: Value) -> Value {
    let Message::Text(text) = engine.answer(Question { id: 1, call: call.into(), with }) else { panic!("text") };
    let reply: Value = serde_json::from_str(&text).expect("JSON");
    assert!(reply["refused"].is_null(), "{reply}");
    reply["ok"].clone()
}

fn job(engine: &Engine, id: u32) -> Option<Job> {
    let Event::Jobs { jobs } = engine.state() else { return None };
    jobs.into_iter().find(|job| job.id == id)
}

/// Looks every few milliseconds until a training is as it should be.
fn wait(engine: &Engine, id: u32, mut is: impl FnMut(&Job) -> bool) -> Job {
    loop {
        if let Some(job) = job(engine, id) {
            assert!(!matches!(job.state, JobState::Failed { .. }), "{:?}", job.state);
            if is(&job) {
                return job;
            }
        }
        std::thread::sleep(Duration::from_millis(2));
    }
}
