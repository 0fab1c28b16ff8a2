//! Whatever the checks of a model accept can be simulated: every number of a model changed, every element left out or
//! doubled. `MYO_TEST_ALL=1` tries all changes (hours), else a fixed sample of them.

mod common;

use common::{arm, draw};
use myo_dynamics::{Batch, CouplingMode, Plan, PlanError};
use myo_model::{Model, ModelDescription, builtin};
use myo_scalar::Level;
use rayon::prelude::*;
use serde_json::Value;

/// Changes tried without `MYO_TEST_ALL`.
const SAMPLE: usize = 40;
/// Stands for a number that JSON cannot write.
const MARK: f64 = 1.234_567_890_123e299;
const BODIES: usize = 8;

/// From a number to what becomes of it.
type Map = fn(f64) -> f64;

/// What becomes of a number; a text where JSON has none for it.
const NUMBERS: [(&str, Map, Option<&str>); 12] = [
    ("times -1", |x| -x, None),
    ("zero", |_| 0.0, None),
    ("a tenth", |x| 0.1 * x, None),
    ("a thousandth", |x| 1e-3 * x, None),
    ("times 10", |x| 10.0 * x, None),
    ("times 1000", |x| 1e3 * x, None),
    ("pi", |_| std::f64::consts::PI, None),
    ("minus pi", |_| -std::f64::consts::PI, None),
    ("1e308", |_| 1e308, None),
    ("1e-308", |_| 1e-308, None),
    ("NaN", |_| MARK, Some(".nan")),
    ("infinity", |_| MARK, Some("-.inf")),
];

/// A changed model file: what was done, and its text.
type Change = (String, String);

/// Places of all numbers, and of all lists with their lengths, as JSON pointers.
fn places(value: &Value, at: &str, numbers: &mut Vec<String>, lists: &mut Vec<(String, usize)>) {
    match value {
        Value::Number(_) => numbers.push(at.to_owned()),
        Value::Array(entries) => {
            lists.push((at.to_owned(), entries.len()));
            entries.iter().enumerate().for_each(|(k, entry)| places(entry, &format!("{at}/{k}"), numbers, lists));
        }
        Value::Object(entries) => {
            entries.iter().for_each(|(key, entry)| places(entry, &format!("{at}/{key}"), numbers, lists));
        }
        _ => {}
    }
}

fn changes(name: &str, description: &ModelDescription) -> Vec<Change> {
    let original = serde_json::to_value(description).unwrap();
    let (mut numbers, mut lists) = (vec![], vec![]);
    places(&original, "", &mut numbers, &mut lists);
    let mut out: Vec<Change> = vec![];
    let mut add = |what: String, value: Value, mark: Option<&str>| {
        let text = value.to_string();
        out.push((format!("{name}{what}"), mark.map_or(text.clone(), |mark| text.replace(&MARK.to_string(), mark))));
    };
    for place in &numbers {
        for (what, change, mark) in NUMBERS {
            let mut value = original.clone();
            let number = value.pointer_mut(place).unwrap();
            let (old, is_whole) = (number.as_f64().unwrap(), number.is_u64());
            if change(old) == old || is_whole {
                continue;
            }
            *number = change(old).into();
            add(format!("{place}: {what}"), value, mark);
        }
    }
    for (place, length) in &lists {
        for k in 0..*length {
            for again in [false, true] {
                let mut value = original.clone();
                let list = value.pointer_mut(place).unwrap().as_array_mut().unwrap();
                let entry = list.remove(k);
                if again {
                    list.extend([entry.clone(), entry]);
                }
                add(format!("{place}/{k}: {}", if again { "twice" } else { "left out" }), value, None);
            }
        }
    }
    out
}

/// Whether a model file is accepted; if so, its plan.
fn check(text: &str) -> Result<Plan<f64>, String> {
    let description = ModelDescription::from_yaml(text, "changed.yaml").map_err(|error| error.to_string())?;
    let model = Model::new(&description).map_err(|error| error.to_string())?;
    let plan = Plan::exact(&model, CouplingMode::Reduced).map_err(|error| error.to_string())?;
    plan.try_out().map_err(|error| error.to_string())?;
    Ok(plan)
}

/// A thousand control steps of other controls than the check's own.
fn stays_finite(plan: &Plan<f64>) -> bool {
    let mut batch = Batch::new(&plan.specialised(), BODIES, Level::current());
    (0..1000).all(|control| {
        for body in 0..BODIES {
            let ctrl: Vec<f32> =
                (0..plan.nmuscle()).map(|k| draw(1_000_000 + control * 8 + body as u32, k) as f32).collect();
            batch.set_ctrl(body, &ctrl);
        }
        batch.step(25);
        let numbers = |body| [batch.qpos(body), batch.qvel(body), batch.act(body)].concat();
        (0..BODIES).all(|body| numbers(body).iter().all(|x| x.is_finite()))
    })
}

#[test]
fn what_the_checks_accept_can_be_simulated() {
    let gadget = ModelDescription::from_yaml(include_str!("../examples/gadget.yaml"), "gadget.yaml").unwrap();
    let mut all = changes("mobl-arms", &builtin("mobl-arms").unwrap());
    all.extend(changes("gadget", &gadget));
    let wraps = ModelDescription::from_yaml(include_str!("../examples/wraps.yaml"), "wraps.yaml").unwrap();
    all.extend(changes("wraps", &wraps));
    assert!(all.len() > 10_000, "{}", all.len());
    let every = if std::env::var("MYO_TEST_ALL").is_ok_and(|x| x == "1") { 1 } else { all.len().div_ceil(SAMPLE) };
    let tried: Vec<&Change> = all.iter().step_by(every).collect();
    let outcomes: Vec<Result<(), &str>> = tried
        .par_iter()
        .map(|(what, text)| match check(text) {
            Ok(plan) if stays_finite(&plan) => Ok(()),
            Ok(_) => panic!("{what}: accepted, and then not finite"),
            Err(message) => {
                assert!(message.len() > 20, "{what}: {message}");
                Err(what.as_str())
            }
        })
        .collect();
    let accepted = outcomes.iter().filter(|outcome| outcome.is_ok()).count();
    // Both happen, or this test says nothing.
    assert!(accepted > tried.len() / 10, "{accepted} of {} accepted", tried.len());
    assert!(accepted < tried.len() * 9 / 10, "{accepted} of {} accepted", tried.len());
}

#[test]
fn the_models_that_come_along_are_accepted() {
    for name in ["mobl-arms", "mobl-arms-uitb"] {
        Plan::exact(&arm(name), CouplingMode::Reduced).unwrap().try_out().unwrap();
    }
}

/// Refused by the plan, in words.
fn refusal(edit: impl FnOnce(&mut ModelDescription)) -> PlanError {
    let mut description = builtin("mobl-arms").unwrap();
    edit(&mut description);
    let model = Model::new(&description).unwrap();
    Plan::exact(&model, CouplingMode::Reduced).and_then(|plan| plan.try_out()).unwrap_err()
}

#[test]
fn models_that_run_away_are_refused_by_name() {
    let refused = refusal(|arm| arm.joints[15].damping = 500.0).to_string();
    assert!(refused.starts_with("joint 'elbow_flexion': a damping of 500 at an inertia of 0.185"), "{refused}");
    assert!(refused.contains("`options.implicit_joint_damping` to true, or the damping to at most 92.9"), "{refused}");
    let refused = refusal(|arm| arm.joints[15].stiffness = 1e6).to_string();
    assert!(refused.starts_with("joint 'elbow_flexion': a stiffness of 1000000"), "{refused}");
    assert_eq!(refusal(|arm| arm.muscles.clear()), PlanError::NoMuscles);
    let held = refusal(|arm| {
        arm.couplings = (arm.joints.iter())
            .map(|joint| myo_model::description::Coupling {
                dependent: joint.name.clone(),
                independent: None,
                polycoef: [0.0; 5],
                softness: Default::default(),
            })
            .collect();
    });
    assert_eq!(held, PlanError::NothingMoves);
    // Every number alone is within its bounds.
    let refused = refusal(|arm| {
        arm.muscles.iter_mut().for_each(|muscle| muscle.parameters.gain.force = Some(9e5));
        for joint in &mut arm.joints {
            (joint.armature, joint.damping, joint.stiffness) = (0.0, 0.0, 0.0);
        }
    });
    assert!(matches!(refused, PlanError::Unstable { .. }), "{refused}");
    // With implicit damping the same damping is fine.
    let mut description = builtin("mobl-arms").unwrap();
    description.joints[15].damping = 500.0;
    description.options.implicit_joint_damping = true;
    let plan = Plan::exact(&Model::new(&description).unwrap(), CouplingMode::Reduced).unwrap();
    assert_eq!(plan.try_out(), Ok(()));
}
