//! How attributes are read over what a class says, and which of them are names of other elements.

use crate::place::Kind;
use crate::value::{Count, Fault, Number, Value, numbers, partly};

/// How an attribute is read over what its class says.
pub(crate) trait Reading<T> {
    fn read(text: &str, before: Option<&T>, default: Option<T>) -> Result<T, Fault>;

    /// Visits the value if it is the name of another element.
    fn refer(_: &mut T, _: &mut dyn FnMut(Kind, &mut String)) {}
}

/// The attribute replaces what the class says.
pub(crate) enum Whole {}

impl<T: Value> Reading<T> for Whole {
    fn read(text: &str, _: Option<&T>, _: Option<T>) -> Result<T, Fault> {
        T::read(text)
    }
}

/// Numbers that are left out stay as the class has them, else MuJoCo's default.
pub(crate) enum Partly {}

impl<T: Number, const N: usize> Reading<[T; N]> for Partly {
    fn read(text: &str, before: Option<&[T; N]>, default: Option<[T; N]>) -> Result<[T; N], Fault> {
        partly(text, 1, before.copied().or(default))
    }
}

/// One number stands for both.
pub(crate) enum OneForBoth {}

impl Reading<[f64; 2]> for OneForBoth {
    fn read(text: &str, _: Option<&[f64; 2]>, _: Option<[f64; 2]>) -> Result<[f64; 2], Fault> {
        match numbers(text)?[..] {
            [both] => Ok([both, both]),
            [first, second] => Ok([first, second]),
            ref found => Err(Fault::Count { found: found.len(), expected: Count { least: 1, most: 2 } }),
        }
    }
}

macro_rules! references {
    ($($name:ident = $kind:ident),* $(,)?) => { $(
        #[doc = concat!("The name of a ", stringify!($kind), ".")]
        pub(crate) enum $name {}

        impl Reading<String> for $name {
            fn read(text: &str, _: Option<&String>, _: Option<String>) -> Result<String, Fault> {
                Ok(text.to_owned())
            }

            fn refer(name: &mut String, visit: &mut dyn FnMut(Kind, &mut String)) {
                visit(Kind::$kind, name);
            }
        }
    )* };
}
references! {
    ToBody = Body, ToJoint = Joint, ToGeom = Geom, ToSite = Site, ToCamera = Camera, ToMesh = Mesh,
    ToHeightField = HeightField, ToTexture = Texture, ToMaterial = Material, ToTendon = Tendon, ToActuator = Actuator,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_left_out_stay_as_they_were() {
        assert_eq!(Partly::read("5", Some(&[1.0, 2.0]), Some([0.1, 0.2])), Ok([5.0, 2.0]));
        assert_eq!(Partly::read("5", None, Some([0.1, 0.2])), Ok([5.0, 0.2]));
        assert_eq!(Partly::read("5", None, None), Ok([5.0, 0.0]));
        assert_eq!(OneForBoth::read("5", Some(&[1.0, 2.0]), None), Ok([5.0, 5.0]));
    }
}
