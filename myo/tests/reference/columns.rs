//! Pages of what environments and trainings tell: observations, actions, episode summaries, metrics.

use std::fmt::Write;

use myo::env::{Column, EPISODE_COLUMNS, EnvConfig, EnvSpec, TARGET_COLUMNS, VectorEnv};
use myo::model::{Model, builtin};
use myo::train::{FIRST_COLUMNS, LAST_COLUMNS, LAYOUT_COLUMN};
use serde_json::Value;

/// Tasks whose observations are listed.
const TASKS: [&str; 2] = ["pointing", "public-display"];

/// Every entry of the observation and of the action, with its index.
pub fn observations(schema: &Value) -> String {
    let mut page = String::from(
        "# Observations and actions\n\nWhat the policy of a preset perceives and does, in order. `EnvSpec` in Rust and \
         `observation_names` and `action_names` in Python list them for any task.\n",
    );
    for task in TASKS {
        let spec = spec(task);
        write!(page, "\n## Observation of `{task}`\n\n| index | name | meaning |\n|---|---|---|\n").unwrap();
        for (index, name) in spec.observation_names.iter().enumerate() {
            let part = name.split('.').next().unwrap();
            let meaning = schema["$defs"]["Observation"]["properties"][part]["description"].as_str();
            let meaning = meaning.expect("a key of the task says what it is").split(" Default ").next().unwrap();
            writeln!(page, "| {index} | `{name}` | {meaning} |").unwrap();
        }
    }
    let spec = spec(TASKS[0]);
    page.push_str(
        "\n## Action\n\nOne number per muscle, from -1, relaxed, to 1, fully excited; the same for all tasks with this body.\n\n\
         | index | muscle |\n|---|---|\n",
    );
    for (index, name) in spec.action_names.iter().enumerate() {
        writeln!(page, "| {index} | `{name}` |").unwrap();
    }
    page
}

/// Columns of an episode summary.
pub fn episodes() -> String {
    let mut page = String::from(
        "# Episodes\n\nWhat an environment tells of an episode when it ends: the entries of `infos[\"summary\"]` in Python (with same-step \
         autoreset in `infos[\"final_info\"]`), and of a row of `StepBuffers::episode` in Rust.\n",
    );
    table(&mut page, "", &EPISODE_COLUMNS);
    page.push_str("\nAnd for every target `k`, counted from 1:\n");
    table(&mut page, "target_k_", &TARGET_COLUMNS);
    page
}

/// Columns of `metrics.csv`.
pub fn metrics() -> String {
    let mut page = String::from(
        "# Metrics\n\nThe columns of a run's `metrics.csv`, one row per update; the same under these names in its TensorBoard file and \
         in what callbacks in Python get.\n",
    );
    table(&mut page, "", &FIRST_COLUMNS);
    page.push_str("\nThen the means of the [columns of episodes](episodes.md) that ended in this update, and:\n");
    table(&mut page, "", &LAST_COLUMNS);
    page.push_str("\nWhere one user learns several layouts, for every layout `k`, counted from 1:\n");
    table(&mut page, "layout_k_", &[LAYOUT_COLUMN]);
    page
}

fn spec(task: &str) -> EnvSpec {
    let task = myo::tasks::preset(task).expect("a preset");
    let model = Model::new(&builtin(&task.model).unwrap()).unwrap();
    myo::env::CpuEnv::new(&model, &task, &EnvConfig::default()).unwrap().spec().clone()
}

fn table(page: &mut String, prefix: &str, columns: &[Column]) {
    page.push_str("\n| column | unit | meaning |\n|---|---|---|\n");
    for Column { name, unit, meaning } in columns {
        writeln!(page, "| `{prefix}{name}` | {unit} | {meaning} |").unwrap();
    }
}
