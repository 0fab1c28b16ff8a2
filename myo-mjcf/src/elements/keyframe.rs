//! Stored states, and what users keep in a model.

use crate::table::table;
use crate::value::Value;

table! {
    /// A stored state. Angles are in rad even where the file uses degrees, as in MuJoCo.
    pub struct Key {
        own {
            /// Its name.
            name: String;
            /// Time (s).
            time: f64 = 0.0;
            /// Positions of all joints.
            qpos: Vec<f64>;
            /// Velocities of all joints.
            qvel: Vec<f64>;
            /// Activations.
            act: Vec<f64>;
            /// Controls.
            ctrl: Vec<f64>;
            /// Positions of mocap bodies (m).
            mpos: Vec<f64>;
            /// Orientations of mocap bodies.
            mquat: Vec<f64>;
            /// Yielded parts of springs.
            plastic: Vec<f64>;
        }
    }
}

table! {
    /// Numbers of the user.
    pub struct Numeric {
        required {
            /// Their name.
            name: String;
        }
        own {
            /// How many; those that `data` lacks are 0.
            size: i32;
            /// The numbers.
            data: Vec<f64>;
        }
    }
}

table! {
    /// Text of the user.
    pub struct Text {
        required {
            /// Its name.
            name: String;
        }
        own {
            /// The text, from the attribute or from between the tags.
            data: String;
        }
    }
}

table! {
    /// A list of elements of the user.
    pub struct Tuple {
        required {
            /// Its name.
            name: String;
        }
        plus {
            /// The elements.
            elements: Vec<TupleElement>;
        }
    }
}

table! {
    /// An element of a tuple.
    pub struct TupleElement {
        required {
            /// What it is: `body`, `joint` and so on.
            objtype: String;
            /// Its name.
            objname: String;
        }
        own {
            /// A number that goes with it.
            prm: f64 = 0.0;
        }
    }
}

/// An element that is kept as it stands: its tag, and its attributes as text.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Raw {
    /// Where it stands.
    pub place: crate::Place,
    /// Its tag.
    pub tag: String,
    /// Names and values of its attributes, in their order.
    pub attributes: Vec<(String, String)>,
}

impl Raw {
    /// Numbers of an attribute, if there is one of this name and all are finite.
    pub fn numbers(&self, name: &str) -> Option<Vec<f64>> {
        let (_, text) = self.attributes.iter().find(|(attribute, _)| attribute == name)?;
        Vec::read(text).ok()
    }
}
