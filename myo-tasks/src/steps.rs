//! From the script of a file to every step.

use myo_model::Nearest;
use nalgebra::Vector3;

use crate::description::Stimulus;
use crate::expand::{Builder, STEPS_MAX, join, with_article};
use crate::fingers::FINGERTIP;
use crate::flat::{Action, Cue, Object, Order, Shape, Sphere, Step};
use crate::motion::Path;
use crate::notation::Name;
use crate::quantity::Quantity;
use crate::range::Range;
use crate::script::{Drag, Drive, Dwell, Follow, Instruction, Names, React, Repeat, Steer, Swing, Track, Typing};
use crate::spoken::spoken;
use crate::target::DWELL;
use crate::technique::Technique;

/// Most steps that change places with each other: each is told from every other in one line of code.
const ORDER_MAX: usize = 32;
const WIDTH: Quantity = Quantity::between(0.002, 4.0, "m");
const SPEED: Quantity = Quantity::between(0.001, 10.0, "m/s");
const WAIT: Quantity = Quantity::between(0.0, 600.0, "s");

impl Builder {
    /// All steps; at least one.
    pub(crate) fn whole_script(&mut self, script: &[Instruction], technique: &Technique) {
        self.script(script, "script");
        if !self.errors.is_empty() {
            return;
        }
        self.flat.sort_fingers();
        if self.flat.steps.is_empty() {
            let problem = "has no step; write what is to do, such as `- press: [1, 2]`";
            return self.refuse("script", "the script", problem.into());
        }
        if self.cue.is_some() {
            self.refuse(
                "script",
                "the script",
                "ends with a wait; write what is to do after it, or leave it out".into(),
            );
        }
        if !technique.is_fingertip() {
            self.no_press(technique);
            self.no_lead(technique);
        }
        if self.flat.stimulus == Stimulus::BeforeMovement
            && let Some(step) = self.flat.steps.iter().find(|step| !step.also.is_empty())
        {
            let problem = "asks for several fingers at once, whose places are not remembered; take another `stimulus`";
            self.refuse(&step.path.clone(), "the step", problem.into());
        }
    }

    /// Only fingers can press.
    fn no_press(&mut self, technique: &Technique) {
        let Some(step) = self.flat.steps.iter().find(|step| step.dwell_s().is_none()) else { return };
        let (path, word) =
            (step.path.clone(), if matches!(step.action, Action::Drag { .. }) { "drag" } else { "press" });
        let problem = format!("cannot {word}, only fingers can; take spheres to dwell in, or `technique: fingertip`");
        self.refuse(&path, technique.name(), problem);
    }

    fn script(&mut self, script: &[Instruction], path: &str) {
        for (k, instruction) in script.iter().enumerate() {
            let path = format!("{path}[{k}]");
            match instruction {
                Instruction::Dwell(dwell) => self.dwell(dwell, &format!("{path}.dwell")),
                Instruction::Pinch(pinch) => self.pinch(pinch, &format!("{path}.pinch")),
                Instruction::Press(names) => self.press(&names.0, Action::Press, &format!("{path}.press")),
                Instruction::PressWith(fingers) => self.press_with(fingers, &format!("{path}.press_with")),
                Instruction::PressAndRelease(names) => {
                    self.press(&names.0, Action::PressAndRelease, &format!("{path}.press_and_release"));
                }
                Instruction::Drag(drag) => self.drag(drag, &format!("{path}.drag")),
                Instruction::Swing(swing) => self.swing(swing, &format!("{path}.swing")),
                Instruction::Drive(drive) => self.drive(drive, &format!("{path}.drive")),
                Instruction::Follow(Follow { target, for_s }) => {
                    self.follow(target, *for_s, Action::Follow, &format!("{path}.follow"));
                }
                Instruction::Track(Track { target, for_s }) => {
                    self.follow(target, *for_s, Action::Track, &format!("{path}.track"));
                }
                Instruction::Steer(steer) => self.steer(steer, &format!("{path}.steer")),
                Instruction::React(react) => self.react(react, &format!("{path}.react")),
                Instruction::Wait(time) => self.wait(*time, false, &format!("{path}.wait")),
                Instruction::Type(typing) => self.type_text(typing, &format!("{path}.type")),
                Instruction::RandomOrder(steps) => self.order(steps, false, &format!("{path}.random_order")),
                Instruction::AnyOrder(steps) => self.order(steps, true, &format!("{path}.any_order")),
                Instruction::Repeat(repeat) => self.repeat(repeat, &format!("{path}.repeat")),
            }
            if self.errors.iter().any(|error| error.path() == "script") {
                return;
            }
        }
    }

    pub(crate) fn step(&mut self, object: usize, action: Action, path: &str) {
        if self.flat.steps.len() == STEPS_MAX {
            if !self.errors.iter().any(|error| error.path() == "script") {
                let problem = format!("has more than {STEPS_MAX} steps, repetitions counted");
                self.refuse("script", "the script", problem);
            }
            return;
        }
        let cue = self.cue.take();
        self.flat.steps.push(Step::new(object, action, cue, path.to_owned()));
    }

    fn dwell(&mut self, dwell: &Dwell, path: &str) {
        let first = self.flat.steps.len();
        self.stay(&dwell.within, dwell.for_s, path, |kind| {
            format!("is {kind}; the fingertip can dwell in spheres only")
        });
        let lead = dwell.with.as_ref().filter(|name| *name != FINGERTIP);
        let lead = lead.and_then(|name| self.finger(name, &format!("{path}.with")));
        let also = self.also(&dwell.also, path);
        if also.iter().any(|also| Some(also.finger) == lead) {
            let problem = "asks twice for one finger; leave it out of `also`".into();
            return self.refuse(&format!("{path}.also"), "the dwell", problem);
        }
        for step in &mut self.flat.steps[first..] {
            step.also.clone_from(&also);
            step.lead = lead;
        }
    }

    /// Steps to stay in spheres; `problem` is what is wrong with objects of another kind.
    pub(crate) fn stay(&mut self, within: &Names, for_s: f64, path: &str, problem: fn(&str) -> String) {
        if let Err(problem) = DWELL.check(for_s) {
            self.refuse(&format!("{path}.for_s"), "the dwell", problem.message().to_owned());
        }
        for name in &within.0 {
            let path_in = format!("{path}.in");
            for object in self.find(&name.0, &path_in) {
                if self.flat.objects[object].sphere().is_some() {
                    self.step(object, Action::Dwell(for_s), path);
                } else {
                    self.refuse_object(&path_in, object, problem);
                }
            }
        }
    }

    /// Steps to follow or to track moving spheres.
    fn follow(&mut self, target: &Names, for_s: f64, action: fn(f64) -> Action, path: &str) {
        if let Err(problem) = DWELL.check(for_s) {
            self.refuse(&format!("{path}.for_s"), "the time", problem.message().to_owned());
        }
        for name in &target.0 {
            let path_of = format!("{path}.target");
            for object in self.find(&name.0, &path_of) {
                match self.flat.objects[object].sphere() {
                    Some(Sphere { path: Some(Path { driven: Some(_), .. }), .. }) => {
                        self.refuse_object(&path_of, object, |_| "moves only while it is driven; `drive` it".into());
                    }
                    Some(sphere) if sphere.path.is_some() => self.step(object, action(for_s), path),
                    Some(_) => {
                        self.refuse_object(&path_of, object, |_| "does not move (`moves`); `dwell` in it".into())
                    }
                    None => self.refuse_object(&path_of, object, |kind| {
                        format!("is {kind}; only spheres that move can be followed or tracked")
                    }),
                }
            }
        }
    }

    fn drag(&mut self, drag: &Drag, path: &str) {
        for object in self.find(&drag.slider.0, &format!("{path}.slider")) {
            let Shape::Slider(slider) = &self.flat.objects[object].shape else {
                let path = format!("{path}.slider");
                return self.refuse_object(&path, object, |kind| format!("is {kind}; only sliders can be dragged"));
            };
            let ([least, most], (to, within)) = (slider.range, (drag.to, drag.within));
            let goes = format!("the values of the slider go from {least} to {most}");
            if let Some((field, problem)) = bad_goal((to, within), [least, most], &goes) {
                return self.refuse_value(&format!("{path}.{field}"), problem);
            }
            let action = Action::Drag { to: slider.share(to), within: within / (most - least) };
            self.step(object, action, path);
        }
    }

    fn swing(&mut self, swing: &Swing, path: &str) {
        for object in self.find(&swing.stick.0, &format!("{path}.stick")) {
            let Shape::Stick(stick) = &self.flat.objects[object].shape else {
                let path = format!("{path}.stick");
                return self.refuse_object(&path, object, |kind| format!("is {kind}; only sticks can be swung"));
            };
            let ([least, most], (to, within)) =
                ([stick.range.min, stick.range.max].map(in_degrees), (swing.to_deg, swing.within_deg));
            if stick.springs_back_s.is_some() && swing.to_deg.abs() > swing.within_deg {
                let problem = "springs back to 0 degrees when it is left; leave `springs_back_s` out".into();
                return self.refuse_object(&format!("{path}.stick"), object, |_| problem);
            }
            let goes = format!("the stick swings from {least} to {most} degrees");
            if let Some((field, problem)) = bad_goal((to, within), [least, most], &goes) {
                return self.refuse_value(&format!("{path}.{field}_deg"), problem);
            }
            self.step(object, Action::Swing { to: to.to_radians(), within: within.to_radians() }, path);
        }
    }

    fn drive(&mut self, drive: &Drive, path: &str) {
        if let Err(problem) = SPEED.check(drive.slower_than) {
            return self.refuse(&format!("{path}.slower_than"), "the speed", problem.message().to_owned());
        }
        let names = [("stick", &drive.stick), ("vehicle", &drive.vehicle), ("into", &drive.into)];
        let [stick, vehicle, into] = names.map(|(field, name)| self.only(&name.0, &format!("{path}.{field}")));
        let (Some(stick), Some(vehicle), Some(into)) = (stick, vehicle, into) else { return };
        if !matches!(self.flat.objects[stick].shape, Shape::Stick(_)) {
            let path = format!("{path}.stick");
            return self.refuse_object(&path, stick, |kind| format!("is {kind}; only sticks drive something"));
        }
        let Some(Sphere { path: Some(Path { driven: Some(driven), .. }), .. }) = self.flat.objects[vehicle].sphere()
        else {
            let problem = "cannot be driven; take a sphere with `moves: {kind: driven, by: [0, 1, 0]}`".into();
            return self.refuse_object(&format!("{path}.vehicle"), vehicle, |_| problem);
        };
        let place = self.flat.objects[into].sphere().filter(|sphere| sphere.path.is_none());
        let Some(place) = place else {
            let problem = "is no place to stop in; take a sphere that stands still".into();
            return self.refuse_object(&format!("{path}.into"), into, |_| problem);
        };
        let beside = farthest_beside([&self.flat.objects[vehicle], &self.flat.objects[into]], driven.by);
        if beside >= place.radius.min {
            let name = self.name(vehicle);
            let problem = format!(
                "may be {beside:.3} m beside the way of `{name}`, more than its radius, {:.3} m; put it on the way, or make it larger",
                place.radius.min
            );
            return self.refuse_object(&format!("{path}.into"), into, |_| problem);
        }
        self.step(stick, Action::Drive { vehicle, into, slower_than: drive.slower_than }, path);
    }

    /// The object of this name, which must be one alone.
    pub(crate) fn only(&mut self, name: &str, path: &str) -> Option<usize> {
        let found = self.find(name, path);
        if found.len() > 1 {
            let problem = format!("is {} objects; name one of them", found.len());
            self.refuse(path, &format!("`{name}`"), problem);
        }
        (found.len() == 1).then(|| found[0])
    }

    fn steer(&mut self, steer: &Steer, path: &str) {
        if let Err(problem) = WIDTH.check(steer.width) {
            return self.refuse(&format!("{path}.width"), "the width", problem.message().to_owned());
        }
        let path_through = format!("{path}.through");
        let mut through: Vec<usize> = vec![];
        for name in &steer.through.0 {
            through.extend(self.find(&name.0, &path_through));
        }
        if !self.errors.is_empty() {
            return;
        }
        let still = |object: &Object| object.sphere().is_some_and(|sphere| sphere.path.is_none());
        if let Some(&other) = through.iter().find(|&&object| !still(&self.flat.objects[object])) {
            return match self.flat.objects[other].sphere() {
                Some(_) => {
                    self.refuse_object(&path_through, other, |_| "moves; a way leads along what stands still".into())
                }
                None => self.refuse_object(&path_through, other, |kind| {
                    format!("is {kind}; a way leads from sphere to sphere")
                }),
            };
        }
        if through.len() < 2 {
            let problem = "is one sphere; a way needs another to lead to".into();
            return self.refuse(&path_through, &spoken(&path_through), problem);
        }
        self.step(through[0], Action::Dwell(0.0), path);
        for pair in through.windows(2) {
            if pair[0] == pair[1] {
                let problem = "comes twice in a row, and a way has a length".into();
                let subject = format!("`{}`", self.name(pair[0]));
                return self.refuse(&path_through, &subject, problem);
            }
            self.step(pair[1], Action::Steer { from: pair[0], width: steer.width }, path);
        }
    }

    fn react(&mut self, react: &React, path: &str) {
        let path_among = format!("{path}.among");
        let mut among: Vec<usize> = vec![];
        for name in &react.among.0 {
            among.extend(self.find(&name.0, &path_among));
        }
        let Some(&first) = among.first() else { return };
        let kind = |object: usize| self.flat.objects[object].kind();
        if let Some(&other) = among.iter().find(|&&object| kind(object) != kind(first)) {
            let problem = format!(
                "is {}, and `{}` is {}; take objects of one kind",
                with_article(kind(other)),
                self.name(first),
                with_article(kind(first))
            );
            return self.refuse(&path_among, &format!("`{}`", self.name(other)), problem);
        }
        let draw = |object: usize| self.flat.objects[object].shift.map(|shift| shift.number);
        if let Some(&other) = among.iter().find(|&&object| draw(object) != draw(first)) {
            let problem =
                format!("is not moved with `{}` when places are drawn; put both into one group", self.name(first));
            return self.refuse(&path_among, &format!("`{}`", self.name(other)), problem);
        }
        if among.len() < 2 {
            let problem = format!(
                "is one object, so there is no choice; write `wait`, and what to do with `{}`",
                self.name(first)
            );
            return self.refuse_value(&path_among, problem);
        }
        let action = match (&self.flat.objects[first].shape, react.for_s) {
            (Shape::Button(_), None) => Action::Press,
            (Shape::Sphere(_), Some(for_s)) => match DWELL.check(for_s) {
                Ok(()) => Action::Dwell(for_s),
                Err(problem) => {
                    return self.refuse(&format!("{path}.for_s"), "the dwell", problem.message().to_owned());
                }
            },
            (Shape::Button(_), Some(_)) => {
                let problem = "is for spheres; buttons are done when they are pressed".into();
                return self.refuse_value(&format!("{path}.for_s"), problem);
            }
            (Shape::Sphere(_), None) => {
                return self.refuse(path, "the reaction", "needs `for_s`, how long to stay in the sphere".into());
            }
            (Shape::Slider(_) | Shape::Stick(_) | Shape::Obstacle(_), _) => {
                return self.refuse_object(&path_among, first, |kind| {
                    format!("is {kind}; only buttons and spheres can light up")
                });
            }
        };
        self.wait(react.after_s, true, &format!("{path}.after_s"));
        let steps = self.flat.steps.len();
        self.step(first, action, path);
        if let Some(step) = self.flat.steps.get_mut(steps) {
            step.among = among;
        }
    }

    /// A time that passes before the next step counts; waits in a row are added up.
    fn wait(&mut self, time: Range, hidden: bool, path: &str) {
        if let Err(problem) = WAIT.range_rule()(&time, &()) {
            return self.refuse(path, "the time to wait", problem.message().to_owned());
        }
        let before = self.cue.take().map_or(Range::fixed(0.0), |cue| cue.after_s);
        let after_s = Range::new(before.min + time.min, before.max + time.max);
        self.cue = Some(Cue { after_s, hidden });
    }

    fn name(&self, object: usize) -> &str {
        &self.flat.objects[object].name
    }

    /// Refuses a value, which its path tells in words.
    pub(crate) fn refuse_value(&mut self, path: &str, problem: String) {
        self.refuse(path, &spoken(path), problem);
    }

    /// Refuses an object for what it is.
    pub(crate) fn refuse_object(&mut self, path: &str, object: usize, problem: impl FnOnce(&str) -> String) {
        let Object { name, .. } = &self.flat.objects[object];
        let (subject, kind) = (format!("`{name}`"), with_article(self.flat.objects[object].kind()));
        self.refuse(path, &subject, problem(&kind));
    }

    fn press(&mut self, names: &[Name], action: Action, path: &str) {
        for (k, name) in names.iter().enumerate() {
            let path = if names.len() == 1 { path.to_owned() } else { format!("{path}[{k}]") };
            for object in self.find(&name.0, &path) {
                self.press_one(object, action, &path);
            }
        }
    }

    fn press_one(&mut self, object: usize, action: Action, path: &str) {
        if matches!(self.flat.objects[object].shape, Shape::Button(_)) {
            self.step(object, action, path);
        } else {
            self.refuse_object(path, object, |kind| format!("is {kind}; only buttons can be pressed"));
        }
    }

    fn type_text(&mut self, typing: &Typing, path: &str) {
        let keyboard = match (&typing.on, &self.keyboards[..]) {
            (Some(name), _) => name.clone(),
            (None, [only]) => only.clone(),
            (None, []) => {
                let problem =
                    "needs a keyboard in the scene, such as `keyboard: {kind: keyboard, pitch: 0.01, key: 0.009}`";
                return self.refuse(path, "typing", problem.into());
            }
            (None, several) => {
                let names: Vec<_> = several.iter().map(|name| format!("`{name}`")).collect();
                let problem = format!("must say on which keyboard (`on`): {}", names.join(" or "));
                return self.refuse(path, "typing", problem);
            }
        };
        let Some(full) = self.resolve(&keyboard).map(|(name, _)| name) else {
            self.find(&keyboard, &format!("{path}.on"));
            return;
        };
        if typing.text.is_empty() {
            return self.refuse(path, "the text", "is empty".into());
        }
        for letter in typing.text.chars() {
            let key = if letter == ' ' { "space".into() } else { letter.to_lowercase().to_string() };
            match self.named.get(&join(&full, &key)).map(|objects| objects[..].to_vec()) {
                Some(objects) => objects.into_iter().for_each(|object| self.press_one(object, Action::Press, path)),
                None => {
                    let problem = format!("has no key for {letter:?} of the text {:?}", typing.text);
                    return self.refuse(path, &format!("`{full}`"), problem);
                }
            }
        }
    }

    fn repeat(&mut self, repeat: &Repeat, path: &str) {
        if !(1..=STEPS_MAX as u32).contains(&repeat.times) {
            let problem = format!("is {}; it must be from 1 to {STEPS_MAX}", repeat.times);
            return self.refuse_value(&format!("{path}.times"), problem);
        }
        if repeat.steps.is_empty() {
            return self.refuse_value(&format!("{path}.steps"), "has no step".into());
        }
        for _ in 0..repeat.times {
            self.script(&repeat.steps, &format!("{path}.steps"));
            if !self.errors.is_empty() {
                return;
            }
        }
    }

    /// Steps that change places with each other.
    fn order(&mut self, steps: &[Instruction], is_any: bool, path: &str) {
        let (subject, first) = (spoken(path), self.flat.steps.len());
        if self.is_ordered {
            let problem = "stands in another order; write them one after the other";
            return self.refuse(path, &subject, problem.into());
        }
        if self.cue.is_some() {
            let problem = "comes after a wait, which belongs to one step; write `wait` before a step in it";
            return self.refuse(path, &subject, problem.into());
        }
        self.is_ordered = true;
        self.script(steps, path);
        self.is_ordered = false;
        if !self.errors.is_empty() {
            return;
        }
        if self.cue.is_some() {
            return self.refuse(
                path,
                &subject,
                "ends with a wait; write what is to do after it, or leave it out".into(),
            );
        }
        let count = self.flat.steps.len() - first;
        if !(2..=ORDER_MAX).contains(&count) {
            let steps = if count == 1 { "1 step".into() } else { format!("{count} steps") };
            return self.refuse(path, &subject, format!("has {steps}; it must be from 2 to {ORDER_MAX}"));
        }
        let is_steer = |step: &&Step| matches!(step.action, Action::Steer { .. });
        if let Some(at) = self.flat.steps[first..].iter().find(is_steer).map(|step| step.path.clone()) {
            let problem = "has a way, whose parts come one after the other; write it outside";
            return self.refuse(&at, &subject, problem.into());
        }
        if is_any {
            self.only_free_steps(first, path);
        }
        self.flat.orders.push(Order { first, count, is_any });
    }

    /// Steps that the user may take in any order, from step `first` on, are those that are told by where the pointer is.
    fn only_free_steps(&mut self, first: usize, path: &str) {
        if let Some(step) = self.flat.steps[first..].iter().find(|step| !step.also.is_empty()) {
            let problem = "asks for several fingers at once, of which none tells by where it is which step is meant; write it outside";
            let (at, subject) = (step.path.clone(), spoken(path));
            return self.refuse(&at, &subject, problem.into());
        }
        let is_free = |step: &Step| {
            step.cue.is_none() && matches!(step.action, Action::Dwell(_) | Action::Press | Action::PressAndRelease)
        };
        let Some(step) = self.flat.steps[first..].iter().find(|step| !is_free(step)) else { return };
        let (at, subject) = (step.path.clone(), spoken(path));
        let problem = "has a step that is waited for, dragged, swung or followed, which nothing but its order tells from others; take \
                       `dwell`, `press` and `press_and_release` alone, or `random_order`";
        self.refuse(&at, &subject, problem.into());
    }

    /// The button that takes back wrong presses.
    pub(crate) fn correction(&mut self, name: Option<&Name>, technique: &Technique) {
        let Some(Name(name)) = name else { return };
        let subject = format!("the correction `{name}`");
        match self.find(name, "correction")[..] {
            [] => {}
            [object] if !matches!(self.flat.objects[object].shape, Shape::Button(_)) => {
                self.refuse_object("correction", object, |kind| {
                    format!("is {kind}; a button takes wrong presses back")
                });
            }
            [_] if !technique.is_fingertip() => {
                let problem = format!("cannot be pressed by {}; leave it out", technique.name());
                self.refuse("correction", &subject, problem);
            }
            [object] => self.flat.correction = Some(object),
            ref several => {
                let problem = format!("stands for {} objects; name one button", several.len());
                self.refuse("correction", &subject, problem);
            }
        }
    }

    /// Full name and objects that a name in the script stands for: the full name, or the end of only one.
    fn resolve(&self, name: &str) -> Option<(String, Vec<usize>)> {
        if let Some(objects) = self.named.get(name) {
            return Some((name.to_owned(), objects.clone()));
        }
        let end = format!(".{name}");
        let mut found = self.named.iter().filter(|(full, _)| full.ends_with(&end));
        match (found.next(), found.next()) {
            (Some((full, objects)), None) => Some((full.clone(), objects.clone())),
            _ => None,
        }
    }

    /// Objects that a name stands for; none, and an error, where it is not clear which.
    pub(crate) fn find(&mut self, name: &str, path: &str) -> Vec<usize> {
        if let Some((_, objects)) = self.resolve(name) {
            return objects;
        }
        let end = format!(".{name}");
        let mut several: Vec<&str> =
            self.named.keys().map(String::as_str).filter(|full| full.ends_with(&end)).collect();
        several.sort_unstable();
        let problem = if several.is_empty() {
            let mut names: Vec<&str> = self.named.keys().map(String::as_str).collect();
            names.sort_unstable();
            format!("is no object of the scene; {}", Nearest::to(name, &names))
        } else {
            let names: Vec<String> = several.iter().map(|name| format!("`{name}`")).collect();
            format!("may stand for {}; write which", names.join(" or "))
        };
        self.refuse(path, &format!("`{name}`"), problem);
        vec![]
    }
}

/// What is wrong with where a handle or a knob is to be left, and how far off that it may be: the field, and the rest of the sentence.
fn bad_goal((to, within): (f64, f64), [least, most]: [f64; 2], goes: &str) -> Option<(&'static str, String)> {
    if !(least..=most).contains(&to) {
        return Some(("to", format!("is {to}; {goes}")));
    }
    let is_right = within > 0.0 && within < most - least;
    (!is_right).then(|| ("within", format!("is {within}; it must be more than 0, and less than {}", most - least)))
}

/// Degrees without what binary fractions leave at the end.
fn in_degrees(radians: f64) -> f64 {
    (radians.to_degrees() * 1e9).round() / 1e9
}

/// How far (m) a place may be beside the way of a vehicle that goes so far (m) to either side, wherever an episode draws both.
fn farthest_beside([vehicle, place]: [&Object; 2], by: [f64; 3]) -> f64 {
    let by = Vector3::from(by);
    let beside = |from: [f64; 3], to: [f64; 3]| {
        let off = Vector3::from(to) - Vector3::from(from);
        (off - by * (off.dot(&by) / by.norm_squared()).clamp(-1.0, 1.0)).norm()
    };
    // What is moved as one keeps its distance.
    let corners = |object: &Object| {
        if vehicle.shift == place.shift { object.region().corners().to_vec() } else { object.corners() }
    };
    let (from, to) = (corners(vehicle), corners(place));
    let ways = from.iter().flat_map(|from| to.iter().map(|to| (*from, *to)));
    ways.map(|(from, to)| beside(from, to)).fold(0.0, f64::max)
}
