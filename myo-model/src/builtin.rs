//! Models that come with the program.

use crate::ModelDescription;
use crate::error::ModelError;
use myo_nearest::Nearest;

const MOBL_ARMS: &str = include_str!("../models/mobl-arms.yaml");
const MYO_ARM: &str = include_str!("../models/myo-arm.yaml");
const MYO_ARM_HAND: &str = include_str!("../models/myo-arm-hand.yaml");
const MYO_HAND: &str = include_str!("../models/myo-hand.yaml");

/// Bodies between the joints of shoulder and scapula that stand for no anatomy.
const PHANTOM_BODIES: [&str; 4] = ["clavphant", "scapphant", "humphant", "humphant1"];

/// Principal moments (kg m^2) that the published systems give each phantom body.
const PUBLISHED_PHANTOM_INERTIA: f64 = 1.0;

/// Names that [`builtin`] knows.
pub fn builtin_names() -> &'static [&'static str] {
    &["mobl-arms", "mobl-arms-uitb", "myo-arm", "myo-hand", "myo-arm-hand"]
}

/// Description of a built-in model.
///
/// `myo-arm` is a human arm with a wrist, whose muscles bend over its bones, and the default of tasks; `myo-hand` is a hand on a forearm that is
/// held, all of whose fingers move; `myo-arm-hand` is that arm with that hand. `mobl-arms` is an arm with straight muscles;
/// `mobl-arms-uitb` is the same with the heavy phantom bodies of the published systems, for comparison with them.
pub fn builtin(name: &str) -> Result<ModelDescription, ModelError> {
    match name {
        "mobl-arms" => mobl_arms(),
        "myo-arm" => ModelDescription::from_yaml(MYO_ARM, "myo-arm.yaml"),
        "myo-hand" => ModelDescription::from_yaml(MYO_HAND, "myo-hand.yaml"),
        "myo-arm-hand" => ModelDescription::from_yaml(MYO_ARM_HAND, "myo-arm-hand.yaml"),
        "mobl-arms-uitb" => mobl_arms().map(with_published_phantoms),
        _ => Err(ModelError::UnknownBuiltin { name: name.to_owned(), nearest: Nearest::to(name, builtin_names()) }),
    }
}

fn mobl_arms() -> Result<ModelDescription, ModelError> {
    ModelDescription::from_yaml(MOBL_ARMS, "mobl-arms.yaml")
}

fn with_published_phantoms(mut arm: ModelDescription) -> ModelDescription {
    arm.name = "mobl-arms-uitb".to_owned();
    for body in arm.bodies.iter_mut().filter(|body| PHANTOM_BODIES.contains(&body.name.as_str())) {
        body.inertia = [PUBLISHED_PHANTOM_INERTIA; 3];
    }
    arm
}
