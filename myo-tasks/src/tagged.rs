//! Reading targets and items so that mistakes inside them are reported where they stand.
//!
//! Serde's own reading of a tagged enum first collects the whole map and forgets positions. When `kind` is the first key,
//! as in every file written by hand, nothing needs to be collected. In any other order the derived reading takes over.

use std::fmt;

use serde::de::value::MapAccessDeserializer;
use serde::de::{DeserializeSeed, Error, IntoDeserializer, MapAccess, Visitor};
use serde::{Deserialize, Deserializer};

use crate::motion::{CircularMotion, DrivenMotion, LinearMotion, Motion, RandomMotion, SinesMotion, Waves};
use crate::scene::{Arc, ButtonItem, Circle, Grid, Group, Item, Keyboard, ObstacleItem, SphereItem};
use crate::slider::SliderItem;
use crate::stick::StickItem;
use crate::target::{Pointing, Pressing, Target};
use crate::technique::{Cursor, GoGo, RateCursor, Ray, Technique};

const KIND: &str = "kind";

/// Reads an enum whose variant is the word behind `kind`.
macro_rules! tagged {
    ($type:ident, $what:literal, $any_order:ident, $visitor:ident: $($kind:literal => $variant:ident($fields:ty)),*) => {
        impl<'de> Deserialize<'de> for $type {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                deserializer.deserialize_map($visitor)
            }
        }

        struct $visitor;

        impl<'de> Visitor<'de> for $visitor {
            type Value = $type;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(concat!($what, ": keys and values, `kind` first"))
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<$type, A::Error> {
                let first: Option<String> = map.next_key()?;
                if first.as_deref() != Some(KIND) {
                    let rest = MapAccessDeserializer::new(Unread { first, rest: map });
                    return $any_order::deserialize(rest).map(Into::into);
                }
                let kind: String = map.next_value()?;
                let fields = MapAccessDeserializer::new(map);
                match kind.as_str() {
                    $($kind => <$fields>::deserialize(fields).map($type::$variant),)*
                    other => Err(A::Error::unknown_variant(other, &[$($kind),*])),
                }
            }
        }

        /// The same with the derived reading.
        #[derive(Deserialize)]
        #[serde(tag = "kind", rename_all = "snake_case")]
        enum $any_order {
            $($variant($fields)),*
        }

        impl From<$any_order> for $type {
            fn from(read: $any_order) -> Self {
                match read {
                    $($any_order::$variant(fields) => Self::$variant(fields)),*
                }
            }
        }
    };
}

tagged!(Target, "a target", TargetInAnyOrder, TargetVisitor: "pointing" => Pointing(Pointing), "pressing" => Pressing(Pressing));
tagged!(Item, "an object", ItemInAnyOrder, ItemVisitor:
    "sphere" => Sphere(SphereItem), "button" => Button(ButtonItem), "slider" => Slider(SliderItem),
    "stick" => Stick(StickItem), "obstacle" => Obstacle(ObstacleItem),
    "group" => Group(Group), "grid" => Grid(Grid), "arc" => Arc(Arc), "circle" => Circle(Circle), "keyboard" => Keyboard(Keyboard));
tagged!(Motion, "a motion", MotionInAnyOrder, MotionVisitor:
    "circle" => Circle(CircularMotion), "line" => Line(LinearMotion), "waves" => Waves(Waves), "random" => Random(RandomMotion), "sines" => Sines(SinesMotion),
    "driven" => Driven(DrivenMotion));

/// A technique that is given by keys and values.
pub(crate) enum TechniqueMap {
    Fingertip(Nothing),
    Ray(Ray),
    GoGo(GoGo),
    Cursor(Cursor),
    RateCursor(RateCursor),
}

/// No keys at all.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Nothing {}

tagged!(TechniqueMap, "a technique", TechniqueInAnyOrder, TechniqueMapVisitor:
    "fingertip" => Fingertip(Nothing), "ray" => Ray(Ray), "go_go" => GoGo(GoGo), "cursor" => Cursor(Cursor),
    "rate_cursor" => RateCursor(RateCursor));

impl From<TechniqueMap> for Technique {
    fn from(map: TechniqueMap) -> Self {
        match map {
            TechniqueMap::Fingertip(Nothing {}) => Self::Fingertip,
            TechniqueMap::Ray(ray) => Self::Ray(ray),
            TechniqueMap::GoGo(go_go) => Self::GoGo(go_go),
            TechniqueMap::Cursor(cursor) => Self::Cursor(cursor),
            TechniqueMap::RateCursor(cursor) => Self::RateCursor(cursor),
        }
    }
}

/// A map whose first key has been read already.
struct Unread<A> {
    first: Option<String>,
    rest: A,
}

impl<'de, A: MapAccess<'de>> MapAccess<'de> for Unread<A> {
    type Error = A::Error;

    fn next_key_seed<K: DeserializeSeed<'de>>(&mut self, seed: K) -> Result<Option<K::Value>, A::Error> {
        match self.first.take() {
            Some(key) => seed.deserialize(key.into_deserializer()).map(Some),
            None => self.rest.next_key_seed(seed),
        }
    }

    fn next_value_seed<V: DeserializeSeed<'de>>(&mut self, seed: V) -> Result<V::Value, A::Error> {
        self.rest.next_value_seed(seed)
    }
}
