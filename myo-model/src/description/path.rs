//! What a muscle path is made of: names of sites, and `{over: ELBOW, side: POINT}` between two of them.

#[cfg(feature = "files")]
use schemars::JsonSchema;
#[cfg(feature = "files")]
use serde::de::value::MapAccessDeserializer;
#[cfg(feature = "files")]
use serde::de::{Deserializer, MapAccess, Visitor};
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
        struct Element;
        impl<'de> Visitor<'de> for Element {
            type Value = PathElement;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("the name of a site, or `{over: NAME}`")
            }
            fn visit_str<E>(self, site: &str) -> Result<PathElement, E> {
                Ok(site.into())
            }
            fn visit_map<M: MapAccess<'de>>(self, map: M) -> Result<PathElement, M::Error> {
                Over::deserialize(MapAccessDeserializer::new(map)).map(PathElement::Over)
            }
        }
        deserializer.deserialize_any(Element)
    }
}
