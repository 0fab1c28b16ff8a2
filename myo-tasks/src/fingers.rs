//! Steps that ask for fingers beside the one that points.

use std::collections::BTreeMap;

use myo_model::MOST_FINGERS;

use crate::expand::Builder;
use crate::flat::{self, Action, Also, Shape};
use crate::notation::Name;
use crate::quantity::Quantity;
use crate::script::Pinch;
use crate::technique::Technique;

const TOGETHER: Quantity = Quantity::between(0.001, 0.2, "m");
const APART_MAX: f64 = 0.4;
/// What points, where fingers are named.
pub(crate) const FINGERTIP: &str = "fingertip";

impl Builder {
    pub(crate) fn press_with(&mut self, fingers: &BTreeMap<String, Name>, path: &str) {
        // The fingertip points where it is asked for, else the first.
        let first = |name: &&String| *name != FINGERTIP;
        let mut order: Vec<(&String, &Name)> = fingers.iter().collect();
        order.sort_by_key(|(name, _)| first(name));
        let mut all = vec![];
        for (name, button) in order {
            let path = format!("{path}.{name}");
            let finger = if name == FINGERTIP { Some(None) } else { self.finger(name, &path).map(Some) };
            let (Some(finger), Some(object)) = (finger, self.only(&button.0, &path)) else { return };
            if !matches!(self.flat.objects[object].shape, Shape::Button(_)) {
                return self.refuse_object(&path, object, |kind| format!("is {kind}; only buttons can be pressed"));
            }
            all.push((finger, object));
        }
        let Some(&(lead, object)) = all.first() else {
            let problem = "names no finger; write what each presses, such as `{fingertip: c, thumb: e}`".into();
            return self.refuse_value(path, problem);
        };
        let steps = self.flat.steps.len();
        self.step(object, Action::Press, path);
        let also = all[1..].iter().filter_map(|&(finger, object)| Some(Also { finger: finger?, object })).collect();
        if let Some(step) = self.flat.steps.get_mut(steps) {
            (step.lead, step.also) = (lead, also);
        }
    }

    pub(crate) fn pinch(&mut self, pinch: &Pinch, path: &str) {
        let (closer_than, apart) = (pinch.closer_than, pinch.apart);
        if let Err(problem) = TOGETHER.check(closer_than) {
            return self.refuse_value(&format!("{path}.closer_than"), problem.message().to_owned());
        }
        if !(closer_than..=APART_MAX).contains(&apart) {
            let problem = format!("is {apart}; it must be from {closer_than} (`closer_than`) to {APART_MAX} m");
            return self.refuse_value(&format!("{path}.apart"), problem);
        }
        let Some(finger) = self.finger(&pinch.with, &format!("{path}.with")) else { return };
        let first = self.flat.steps.len();
        self.stay(&pinch.within, pinch.for_s, path, |kind| format!("is {kind}; take a sphere to pinch in"));
        for step in &mut self.flat.steps[first..] {
            step.pinch = Some(flat::Pinch { finger, closer_than, apart });
        }
    }

    /// Where other fingers must be.
    pub(crate) fn also(&mut self, also: &BTreeMap<String, Name>, path: &str) -> Vec<Also> {
        let mut all = vec![];
        for (name, sphere) in also {
            let path = format!("{path}.also.{name}");
            let (finger, object) = (self.finger(name, &path), self.only(&sphere.0, &path));
            let (Some(finger), Some(object)) = (finger, object) else { continue };
            if self.flat.objects[object].sphere().is_none() {
                self.refuse_object(&path, object, |kind| format!("is {kind}; fingers can be in spheres only"));
            }
            all.push(Also { finger, object });
        }
        all
    }

    /// Number of a finger among those that steps ask for; none, and an error, where it cannot be one.
    pub(crate) fn finger(&mut self, name: &str, path: &str) -> Option<usize> {
        if name.trim().is_empty() || name == FINGERTIP {
            let problem = "is no other finger; take the name of one in the landmarks of the model, such as `thumb`";
            self.refuse(path, &format!("`{name}`"), problem.into());
            return None;
        }
        let fingers = &mut self.flat.fingers;
        if let Some(known) = fingers.iter().position(|known| known == name) {
            return Some(known);
        }
        if fingers.len() == MOST_FINGERS {
            let problem =
                format!("is one more than {MOST_FINGERS} other fingers, which are all that a script can ask for");
            self.refuse(path, &format!("`{name}`"), problem);
            return None;
        }
        fingers.push(name.to_owned());
        Some(fingers.len() - 1)
    }

    /// Where something else points no finger leads.
    pub(crate) fn no_lead(&mut self, technique: &Technique) {
        let Some(step) = self.flat.steps.iter().find(|step| step.lead.is_some()) else { return };
        let problem = "points, and no finger can do so in its place (`with`); take `technique: fingertip`";
        self.refuse(&step.path.clone(), technique.name(), problem.into());
    }
}
