//! What a scene is written as, and where: for those who show it and let it be changed.

use nalgebra::Rotation3;

use crate::description::Task;
use crate::range::Range;
use crate::scene::{Frame, Item, Scene};

/// A part of a scene where it stands: an object, a group, or a generator of objects.
#[derive(Clone, Debug)]
pub struct PlacedItem<'a> {
    /// What scripts call it, such as `panel.ok`.
    pub name: String,
    /// Path in the file, such as `scene.panel.objects.ok`.
    pub path: String,
    /// What it is.
    pub item: &'a Item,
    /// The axes along which its place is written.
    pub around: Axes,
    /// Its own, in the middle of where it may be.
    pub own: Axes,
}

/// Axes in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axes {
    /// Their origin (m from the shoulder centre).
    pub origin: [f64; 3],
    /// From these axes to the world's.
    pub rotation: Rotation3<f64>,
    /// Metres per unit of what is written in them.
    pub scale: f64,
}

impl Task {
    /// Everything that the scene is written as, each group before what is in it. Tasks of version 1 have no scene;
    /// [convert](Task::converted) them. Values need not be right.
    pub fn placed_items(&self) -> Vec<PlacedItem<'_>> {
        let mut placed = Vec::new();
        add(&self.scene, ("", "scene"), Frame::world(), &mut placed);
        placed
    }
}

fn add<'a>(scene: &'a Scene, (group, path): (&str, &str), around: Frame, placed: &mut Vec<PlacedItem<'a>>) {
    for (own_name, item) in &scene.0 {
        let name = if group.is_empty() { own_name.clone() } else { format!("{group}.{own_name}") };
        let path = format!("{path}.{own_name}");
        let own = own_frame(item, around);
        placed.push(PlacedItem {
            name: name.clone(),
            path: path.clone(),
            item,
            around: around.into(),
            own: own.into(),
        });
        if let Item::Group(group) = item {
            add(&group.objects, (&name, &format!("{path}.objects")), own, placed);
        }
    }
}

fn own_frame(item: &Item, around: Frame) -> Frame {
    let placement = item.placement();
    let region = if let Item::Sphere(sphere) = item { sphere.at.0 } else { placement.at.0 };
    let at = [region.x, region.y, region.z].map(Range::centre);
    around.child(at, placement.tilt_deg, placement.turn_deg, placement.scale)
}

impl From<Frame> for Axes {
    fn from(frame: Frame) -> Self {
        Self { origin: frame.origin.into(), rotation: frame.rotation, scale: frame.scale }
    }
}

impl Item {
    /// What it is called in a file: its `kind`.
    pub const fn kind(&self) -> &'static str {
        match self {
            Self::Sphere(_) => "sphere",
            Self::Button(_) => "button",
            Self::Slider(_) => "slider",
            Self::Stick(_) => "stick",
            Self::Obstacle(_) => "obstacle",
            Self::Group(_) => "group",
            Self::Grid(_) => "grid",
            Self::Arc(_) => "arc",
            Self::Circle(_) => "circle",
            Self::Keyboard(_) => "keyboard",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Where an item stands by itself is where its objects stand once all is written out.
    #[test]
    fn items_stand_where_their_objects_do() {
        let text = "version: 2\nname: t\nscene:\n  panel:\n    kind: group\n    at: [0.4, 0.1, -0.1]\n    tilt_deg: 60\n    turn_deg: 20\n    scale: 2\n    \
                    objects:\n      ok: {kind: button, at: [0.02, 0.03, 0.01], size: [0.02, 0.02, 0.01], turn_deg: 15}\n      \
                    ball: {kind: sphere, at: [0, -0.05, 0.02], radius: 0.02}\nscript:\n  - press: panel.ok\ntime_limit_s: 3\n";
        let task = Task::from_yaml(text, "t").unwrap();
        let (items, flat) = (task.placed_items(), task.flat().unwrap());
        let names: Vec<(&str, &str)> = items.iter().map(|item| (item.item.kind(), &*item.path)).collect();
        let expected =
            [("group", "scene.panel"), ("button", "scene.panel.objects.ok"), ("sphere", "scene.panel.objects.ball")];
        assert_eq!(names, expected);
        assert_eq!(items[1].name, flat.objects[0].name);
        let block = flat.objects[0].block().unwrap();
        for (a, b) in items[1].own.origin.iter().zip(block.centre) {
            assert!((a - b).abs() < 1e-12, "{items:?}");
        }
        assert!(items[1].own.rotation.angle_to(&block.rotation) < 1e-7);
        let centre = flat.objects[1].sphere().unwrap().region;
        assert!((items[2].own.origin[2] - centre.z.centre()).abs() < 1e-12);
        assert_eq!(items[1].around, items[0].own);
    }
}
