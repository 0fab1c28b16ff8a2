//! Reading an instruction of a script: a word, and what it is about. A word alone is told what it lacks.

use std::fmt;

use serde::de::{Error, MapAccess, Visitor};
use serde::{Deserialize, Deserializer};

use crate::script::Instruction;

/// Words, their variants, and what may stand behind them.
macro_rules! instructions {
    ($($word:literal => $variant:ident, $example:literal;)+) => {
        const WORDS: &[&str] = &[$($word),+];

        /// How an instruction with this word is written.
        fn example(word: &str) -> Option<&'static str> {
            match word {
                $($word => Some(concat!("- ", $word, ": ", $example)),)+
                _ => None,
            }
        }

        fn read<'de, A: MapAccess<'de>>(word: &str, map: &mut A) -> Result<Instruction, A::Error> {
            match word {
                $($word => map.next_value().map(Instruction::$variant),)+
                other => Err(A::Error::unknown_variant(other, WORDS)),
            }
        }
    };
}

instructions! {
    "dwell" => Dwell, "{in: NAME, for_s: 0.3}";
    "pinch" => Pinch, "{in: NAME}";
    "press" => Press, "NAME";
    "press_with" => PressWith, "{fingertip: NAME, thumb: NAME}";
    "press_and_release" => PressAndRelease, "NAME";
    "drag" => Drag, "{slider: NAME, to: 70, within: 2}";
    "swing" => Swing, "{stick: NAME, to_deg: 30, within_deg: 3}";
    "drive" => Drive, "{stick: NAME, vehicle: NAME, into: NAME}";
    "follow" => Follow, "{target: NAME, for_s: 3}";
    "track" => Track, "{target: NAME, for_s: 10}";
    "steer" => Steer, "{through: [NAME, NAME], width: 0.03}";
    "react" => React, "{among: NAME, after_s: [0.5, 1.5]}";
    "wait" => Wait, "0.5";
    "type" => Type, "hello";
    "random_order" => RandomOrder, "[{press: [NAME, NAME]}]";
    "any_order" => AnyOrder, "[{press: [NAME, NAME]}]";
    "repeat" => Repeat, "{times: 3, steps: [...]}";
}

impl<'de> Deserialize<'de> for Instruction {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(InstructionVisitor)
    }
}

struct InstructionVisitor;

impl<'de> Visitor<'de> for InstructionVisitor {
    type Value = Instruction;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("what is to do, such as `press: NAME`")
    }

    fn visit_str<E: Error>(self, word: &str) -> Result<Instruction, E> {
        match example(word) {
            Some(example) => Err(E::custom(format!("`{word}` stands alone; write `{example}`"))),
            None => Err(E::unknown_variant(word, WORDS)),
        }
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Instruction, A::Error> {
        let Some(word) = map.next_key::<String>()? else {
            return Err(A::Error::custom(
                "an entry of the script is empty; write what is to do, such as `- press: NAME`",
            ));
        };
        let instruction = read(&word, &mut map)?;
        match map.next_key::<String>()? {
            None => Ok(instruction),
            Some(further) => {
                let text = format!("`{word}` and `{further}` stand in one entry of the script; write `- ` before each");
                Err(A::Error::custom(text))
            }
        }
    }
}
