//! Reading a target so that mistakes inside it are reported where they stand.
//!
//! Serde's own reading of a tagged enum first collects the whole map and forgets positions. When `kind` is the first key,
//! as in every file written by hand, nothing needs to be collected. In any other order the derived reading takes over.

use std::fmt;

use serde::de::value::MapAccessDeserializer;
use serde::de::{DeserializeSeed, Error, IntoDeserializer, MapAccess, Visitor};
use serde::{Deserialize, Deserializer};

use crate::target::{Pointing, Pressing, Target};

const KIND: &str = "kind";
const KINDS: &[&str] = &["pointing", "pressing"];

impl<'de> Deserialize<'de> for Target {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(TargetVisitor)
    }
}

struct TargetVisitor;

impl<'de> Visitor<'de> for TargetVisitor {
    type Value = Target;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a target: keys and values, `kind` first")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Target, A::Error> {
        let first: Option<String> = map.next_key()?;
        if first.as_deref() != Some(KIND) {
            return AnyOrder::deserialize(MapAccessDeserializer::new(Unread { first, rest: map })).map(Into::into);
        }
        let kind: String = map.next_value()?;
        let fields = MapAccessDeserializer::new(map);
        match kind.as_str() {
            "pointing" => Pointing::deserialize(fields).map(Target::Pointing),
            "pressing" => Pressing::deserialize(fields).map(Target::Pressing),
            other => Err(A::Error::unknown_variant(other, KINDS)),
        }
    }
}

/// [`Target`] with the derived reading.
#[derive(Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
enum AnyOrder {
    Pointing(Pointing),
    Pressing(Pressing),
}

impl From<AnyOrder> for Target {
    fn from(target: AnyOrder) -> Self {
        match target {
            AnyOrder::Pointing(sphere) => Self::Pointing(sphere),
            AnyOrder::Pressing(button) => Self::Pressing(button),
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
