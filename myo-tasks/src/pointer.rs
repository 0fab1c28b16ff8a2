//! From the technique of a file to what points.

use crate::expand::Builder;
use crate::flat::{Object, Pointer, Shape};
use crate::scene::tilted_and_turned;
use crate::technique::Technique;

impl Builder {
    /// Resolves what the technique names, and asks whether its pointer can be where the script wants it.
    pub(crate) fn technique(&mut self, technique: &Technique) {
        self.flat.pointer = match technique {
            Technique::Fingertip => Pointer::Fingertip,
            Technique::GoGo(go_go) => Pointer::GoGo { beyond_m: go_go.beyond, gain: go_go.gain },
            Technique::Ray(ray) => {
                let onto = ray.onto.as_deref().and_then(|name| self.display(name));
                Pointer::Ray { from: ray.from, onto }
            }
            Technique::Cursor(cursor) => {
                let Some(onto) = self.display(&cursor.onto) else { return };
                let rotation = tilted_and_turned(cursor.tilt_deg, cursor.turn_deg);
                Pointer::Cursor { onto, at: cursor.at, rotation, gain: cursor.gain }
            }
            Technique::RateCursor(cursor) => {
                let Some(onto) = self.display(&cursor.onto) else { return };
                let rotation = tilted_and_turned(cursor.tilt_deg, cursor.turn_deg);
                let (gain_per_s, still_m) = (cursor.gain, cursor.still);
                Pointer::RateCursor { onto, at: cursor.at, rotation, gain_per_s, still_m }
            }
        };
        if let Pointer::Ray { onto: Some(onto), .. } | Pointer::Cursor { onto, .. } | Pointer::RateCursor { onto, .. } =
            self.flat.pointer
        {
            self.spheres_on(onto, technique.name());
        }
    }

    /// The object on whose face a pointer is.
    fn display(&mut self, name: &str) -> Option<usize> {
        let path = "technique.onto";
        let objects = self.find(name, path);
        match objects[..] {
            [] => None,
            [object] if self.flat.objects[object].is_drawn() => {
                let problem = "has a range of places or sizes; a pointer needs a face that stays as it is".into();
                self.refuse_object(path, object, |_| problem);
                None
            }
            [object] if self.flat.objects[object].block().is_some() => Some(object),
            [object] => {
                let problem = |kind: &str| format!("is {kind}; a pointer needs a face, such as that of an obstacle");
                self.refuse_object(path, object, problem);
                None
            }
            _ => {
                let problem =
                    format!("stands for {} objects; name the one whose face the pointer is on", objects.len());
                self.refuse(path, &format!("`{name}`"), problem);
                None
            }
        }
    }

    /// What is to be pointed at must lie on the face that the pointer is on.
    fn spheres_on(&mut self, onto: usize, pointer: &str) {
        let Object { name: display, shape, .. } = &self.flat.objects[onto];
        let (Shape::Button(block) | Shape::Obstacle(block) | Shape::Slider(crate::Slider { block, .. })) = shape else {
            return;
        };
        let (face, normal) = (block.face_point(0.0, 0.0), block.normal());
        let above = |point: [f64; 3]| (0..3).map(|k| (point[k] - face[k]) * normal[k]).sum::<f64>();
        let wanted = self.flat.steps.iter().flat_map(|step| step.objects());
        let beside = wanted.filter_map(|index| {
            let object = &self.flat.objects[index];
            let (radius, arc) = match &object.shape {
                Shape::Sphere(sphere) => (sphere.radius.min, vec![[0.0; 3]]),
                Shape::Stick(stick) => (stick.knob, stick.arc(stick.range).collect()),
                _ => return None,
            };
            let corners = object.corners();
            let places = corners.iter().flat_map(|corner| arc.iter().map(|by| [0, 1, 2].map(|k| corner[k] + by[k])));
            let off = places.map(above).fold(0.0, |a: f64, b| a.max(b.abs()));
            (off >= radius).then_some((object, off))
        });
        let Some((object, off)) = { beside }.next() else { return };
        let problem = format!(
            "is up to {:.1} cm off the face of `{display}`, on which {pointer} points, and no wider; put it there",
            100.0 * off
        );
        let (path, name) = (object.path.clone(), format!("`{}`", object.name));
        self.refuse(&path, &name, problem);
    }
}
