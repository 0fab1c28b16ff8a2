//! What a muscle path is made of: names of sites, `{over: ELBOW, side: POINT}` between two of them, and `{pulley: 2}` before a branch.

#[cfg(feature = "files")]
use schemars::JsonSchema;
#[cfg(feature = "files")]
use serde::de::value::MapAccessDeserializer;
#[cfg(feature = "files")]
use serde::de::{Deserializer, Error, MapAccess, Visitor};
#[cfg(feature = "files")]
use serde::{Deserialize, Serialize};
#[cfg(feature = "files")]
use std::fmt;

/// One element of a muscle path.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "files", derive(Serialize, JsonSchema))]
#[cfg_attr(feature = "files", serde(untagged))]
pub enum PathElement {
    /// Name of a site that the path runs through.
    Site(String),
    /// What the path runs over, if it is in the way, between the sites before and after.
    Over(Over),
    /// Where the tendon divides: what follows is a branch that begins anew.
    Pulley(Pulley),
}

/// A pulley, as MuJoCo has it: of the branch behind it, up to the next one, the length counts divided by a number, and so much less than the force of the muscle pulls there.
/// Two branches behind pulleys of 2 are a tendon that divides into two, each with half of the force.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "files", derive(Serialize, Deserialize, JsonSchema))]
#[cfg_attr(feature = "files", serde(deny_unknown_fields))]
pub struct Pulley {
    /// What the length is divided by.
    pub pulley: f64,
}

/// A stretch of a muscle path that may bend round a sphere or a cylinder.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "files", derive(Serialize, Deserialize, JsonSchema))]
#[cfg_attr(feature = "files", serde(deny_unknown_fields))]
pub struct Over {
    /// Name of the sphere or cylinder, one of `wraps`.
    pub over: String,
    /// Site on the side where the path runs, however long the way round is. Without it the path takes the shorter way. A site
    /// nearer to the centre than the radius asks for a path that passes through the object and touches it from within.
    #[cfg_attr(feature = "files", serde(default, skip_serializing_if = "Option::is_none"))]
    pub side: Option<String>,
}

impl From<String> for PathElement {
    fn from(site: String) -> Self {
        Self::Site(site)
    }
}

impl From<&str> for PathElement {
    fn from(site: &str) -> Self {
        Self::Site(site.to_owned())
    }
}

/// By hand, because what is read as one of several forms loses the message of what is wrong with it.
#[cfg(feature = "files")]
impl<'de> Deserialize<'de> for PathElement {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        /// Of both kinds that are no names.
        #[derive(Deserialize)]
        #[serde(deny_unknown_fields)]
        struct Keys {
            over: Option<String>,
            side: Option<String>,
            pulley: Option<f64>,
        }
        struct Element;
        impl<'de> Visitor<'de> for Element {
            type Value = PathElement;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("the name of a site, `{over: NAME}` or `{pulley: DIVISOR}`")
            }
            fn visit_str<E>(self, site: &str) -> Result<PathElement, E> {
                Ok(site.into())
            }
            fn visit_map<M: MapAccess<'de>>(self, map: M) -> Result<PathElement, M::Error> {
                let keys = Keys::deserialize(MapAccessDeserializer::new(map))?;
                match keys {
                    Keys { over: Some(over), side, pulley: None } => Ok(PathElement::Over(Over { over, side })),
                    Keys { over: None, side: None, pulley: Some(pulley) } => Ok(PathElement::Pulley(Pulley { pulley })),
                    _ => Err(M::Error::custom("expected `over`, which may have a `side`, or `pulley`")),
                }
            }
        }
        deserializer.deserialize_any(Element)
    }
}
