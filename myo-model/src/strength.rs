//! Muscles that are weaker or stronger than those of the model, and tendons that a surgeon moved.

use std::collections::{BTreeMap, BTreeSet};

use crate::description::{Measure, ModelDescription, Muscle};
use crate::error::{Element, ElementKind, ModelError};
use myo_muscle::MuscleGroup;
use myo_nearest::Nearest;

impl ModelDescription {
    /// The same body with the active force of its muscles multiplied: all by `all`, then each by what stands under its name and under the name of its
    /// group (`shoulder`, `elbow`, `hand`).
    ///
    /// # Errors
    /// There is no muscle and no group of a name.
    pub fn with_strength(mut self, all: f64, of: &BTreeMap<String, f64>) -> Result<Self, ModelError> {
        self.know_muscles_or_groups(of.keys())?;
        for muscle in &mut self.muscles {
            let own = of.get(&muscle.name).copied().unwrap_or(1.0);
            let of_group = group(muscle).and_then(|group| of.get(group)).copied().unwrap_or(1.0);
            let gain = &mut muscle.parameters.gain;
            // Where the force is not given, it is the scale that makes it.
            *gain.force.as_mut().unwrap_or(&mut gain.scale) *= all * own * of_group;
        }
        Ok(self)
    }

    /// The same body after tendon transfers: of each pair the first muscle pulls where the second did, which pulls no more. Its fibres and tendon are
    /// as long for the new path as they were for the old one: the surgeon's tension.
    ///
    /// # Errors
    /// There is no muscle of a name, or one is moved or replaced twice.
    pub fn with_transfers(mut self, transfers: &BTreeMap<String, String>) -> Result<Self, ModelError> {
        for (k, (donor, recipient)) in transfers.iter().enumerate() {
            let earlier = transfers.iter().take(k).any(|(_, replaced)| replaced == recipient);
            if earlier || transfers.contains_key(recipient) {
                return Err(ModelError::TransferredTwice { muscle: recipient.clone() });
            }
            let (donor, recipient) = (self.muscle(donor)?, self.muscle(recipient)?);
            let target = self.muscles[recipient].clone();
            self.leave_limit(donor);
            let moved = &mut self.muscles[donor];
            moved.path = target.path;
            moved.limit = target.limit;
            moved.parameters.group = target.parameters.group;
            // Both curves go over the lengths of the new path.
            moved.parameters.length_range = target.parameters.length_range;
            self.muscles.remove(recipient);
        }
        self.leave_sensors();
        Ok(self)
    }

    /// Hands the limit of a muscle's tendon to another one that pulls the same.
    fn leave_limit(&mut self, muscle: usize) {
        let Some(limit) = self.muscles[muscle].limit.take() else { return };
        let path = self.muscles[muscle].path.clone();
        let others = self.muscles.iter_mut().enumerate().filter(|(other, _)| *other != muscle);
        if let Some((_, heir)) = others.into_iter().find(|(_, other)| other.path == path && other.limit.is_none()) {
            heir.limit = Some(limit);
        }
    }

    /// Leaves out sensors of muscles that pull no more, and of limits that these had.
    fn leave_sensors(&mut self) {
        let Self { muscles, sensors, .. } = self;
        sensors.retain(|sensor| match &sensor.measures {
            Measure::Muscle { of, quantity } => {
                let muscle = muscles.iter().find(|muscle| muscle.name == *of);
                muscle.is_some_and(|muscle| muscle.limit.is_some() || !quantity.is_of_limit())
            }
            _ => true,
        });
    }

    fn know_muscles_or_groups<'a>(&self, mut names: impl Iterator<Item = &'a String>) -> Result<(), ModelError> {
        let groups: BTreeSet<&str> = self.muscles.iter().filter_map(group).collect();
        let own: Vec<&str> = self.muscles.iter().map(|muscle| muscle.name.as_str()).collect();
        let known: Vec<&str> = groups.into_iter().chain(own).collect();
        names.find(|name| !known.contains(&name.as_str())).map_or(Ok(()), |name| Err(unknown(name, &known)))
    }

    fn muscle(&self, name: &str) -> Result<usize, ModelError> {
        let known: Vec<&str> = self.muscles.iter().map(|muscle| muscle.name.as_str()).collect();
        known.iter().position(|known| *known == name).ok_or_else(|| unknown(name, &known))
    }
}

fn unknown(name: &str, known: &[&str]) -> ModelError {
    ModelError::UnknownName {
        element: Element::new(ElementKind::Person, ""),
        wanted: ElementKind::Muscle,
        name: name.to_owned(),
        nearest: Nearest::to(name, known),
    }
}

fn group(muscle: &Muscle) -> Option<&'static str> {
    muscle.parameters.group.map(MuscleGroup::name)
}
