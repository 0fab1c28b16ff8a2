//! What attributes say: numbers, words and lists of them.

use crate::document::Node;
use crate::error::MjcfError;
use crate::nearest::{nearest, short};
use myo_nearest::Nearest;
use std::fmt;

/// How many values an attribute takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Count {
    /// Fewest.
    pub least: usize,
    /// Most.
    pub most: usize,
}

impl fmt::Display for Count {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.least, self.most) {
            (1, 1) => f.write_str("1 is"),
            (least, most) if least == most => write!(f, "{least} are"),
            (least, most) => write!(f, "{least} to {most} are"),
        }
    }
}

/// What is wrong with the text of an attribute.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Fault {
    NotANumber(String),
    NotAnInteger(String),
    NotFinite(String),
    Count { found: usize, expected: Count },
    Keyword { text: String, nearest: Nearest },
}

impl Fault {
    pub fn keyword(text: &str, valid: &[&str]) -> Self {
        Self::Keyword { text: short(text), nearest: nearest(text, valid) }
    }

    pub fn of(self, node: &Node, attribute: &str) -> MjcfError {
        let (at, attribute) = (node.at_attribute(attribute), short(attribute));
        match self {
            Self::NotANumber(text) => MjcfError::NotANumber { at, attribute, text },
            Self::NotAnInteger(text) => MjcfError::NotAnInteger { at, attribute, text },
            Self::NotFinite(text) => MjcfError::NotFinite { at, attribute, text },
            Self::Count { found, expected } => MjcfError::WrongCount { at, attribute, found, expected },
            Self::Keyword { text, nearest } => MjcfError::UnknownKeyword { at, attribute, text, nearest },
        }
    }
}

/// A type that an attribute can have.
pub(crate) trait Value: Sized {
    fn read(text: &str) -> Result<Self, Fault>;

    /// As MJCF writes it.
    fn write(&self) -> String;

    /// Bytes that it holds beyond its own size.
    fn held(&self) -> usize {
        0
    }

    /// Whether it says nothing: an empty name or list.
    fn is_nothing(&self) -> bool {
        false
    }
}

/// A number in a list.
pub(crate) trait Number: Copy + Default + fmt::Display {
    fn number(text: &str) -> Result<Self, Fault>;
}

impl Number for f64 {
    fn number(text: &str) -> Result<Self, Fault> {
        let number: f64 = text.parse().map_err(|_| Fault::NotANumber(short(text)))?;
        if number.is_finite() { Ok(number) } else { Err(Fault::NotFinite(short(text))) }
    }
}

impl Number for i32 {
    fn number(text: &str) -> Result<Self, Fault> {
        text.parse().map_err(|_| Fault::NotAnInteger(short(text)))
    }
}

pub(crate) fn numbers<T: Number>(text: &str) -> Result<Vec<T>, Fault> {
    text.split_ascii_whitespace().map(T::number).collect()
}

fn join<T: fmt::Display>(values: &[T]) -> String {
    values.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ")
}

impl<T: Number, const N: usize> Value for [T; N] {
    fn read(text: &str) -> Result<Self, Fault> {
        partly(text, N, None)
    }

    fn write(&self) -> String {
        join(self)
    }
}

/// At least `least` numbers; those that are not there keep what they were, or zero.
pub(crate) fn partly<T: Number, const N: usize>(
    text: &str,
    least: usize,
    before: Option<[T; N]>,
) -> Result<[T; N], Fault> {
    let mut values = before.unwrap_or([T::default(); N]);
    let mut found = 0;
    for word in text.split_ascii_whitespace() {
        if let Some(value) = values.get_mut(found) {
            *value = T::number(word)?;
        }
        found += 1;
    }
    let expected = Count { least, most: N };
    if (least..=N).contains(&found) { Ok(values) } else { Err(Fault::Count { found, expected }) }
}

macro_rules! single_number {
    ($($number:ty),*) => { $(
        impl Value for $number {
            fn read(text: &str) -> Result<Self, Fault> {
                <[$number; 1]>::read(text).map(|[number]| number)
            }

            fn write(&self) -> String {
                self.to_string()
            }
        }
    )* };
}
single_number!(f64, i32);

impl<T: Number> Value for Vec<T> {
    fn read(text: &str) -> Result<Self, Fault> {
        numbers(text)
    }

    fn write(&self) -> String {
        join(self)
    }

    fn held(&self) -> usize {
        self.len() * size_of::<T>()
    }

    fn is_nothing(&self) -> bool {
        self.is_empty()
    }
}

impl Value for String {
    fn read(text: &str) -> Result<Self, Fault> {
        Ok(text.to_owned())
    }

    fn write(&self) -> String {
        self.clone()
    }

    fn held(&self) -> usize {
        self.len()
    }

    fn is_nothing(&self) -> bool {
        self.is_empty()
    }
}

impl Value for bool {
    fn read(text: &str) -> Result<Self, Fault> {
        match text {
            "true" => Ok(true),
            "false" => Ok(false),
            _ => Err(Fault::keyword(text, &["true", "false"])),
        }
    }

    fn write(&self) -> String {
        self.to_string()
    }
}

/// Declares enums of keywords: variant, word in the file, what it means.
macro_rules! keywords {
    ($(
        $(#[$doc:meta])*
        pub enum $Enum:ident { $( $(#[$variant_doc:meta])* $Variant:ident = $word:literal ),* $(,)? }
    )*) => { $(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum $Enum { $( $(#[$variant_doc])* $Variant, )* }

        impl $Enum {
            /// The word that stands in files.
            pub fn word(self) -> &'static str {
                match self { $( Self::$Variant => $word, )* }
            }
        }

        impl $crate::value::Value for $Enum {
            fn read(text: &str) -> Result<Self, $crate::value::Fault> {
                match text {
                    $( $word => Ok(Self::$Variant), )*
                    _ => Err($crate::value::Fault::keyword(text, &[$($word),*])),
                }
            }

            fn write(&self) -> String {
                self.word().to_owned()
            }
        }
    )* };
}
pub(crate) use keywords;

keywords! {
    /// A choice that may be left to MuJoCo.
    pub enum Auto {
        /// No.
        No = "false",
        /// Yes.
        Yes = "true",
        /// Whatever the rest of the element suggests.
        Auto = "auto",
    }

    /// Whether a flag is on.
    pub enum Switch {
        /// Off.
        Off = "disable",
        /// On.
        On = "enable",
    }
}

impl Auto {
    /// Whether a limit holds, for an element that gives a `range` or not.
    ///
    /// With `autolimits` of the compiler off, MuJoCo refuses a range without its flag; here it is no limit.
    pub fn decide(self, autolimits: bool, range: Option<[f64; 2]>) -> bool {
        match self {
            Self::No => false,
            Self::Yes => true,
            Self::Auto => autolimits && range.is_some_and(|range| range != [0.0, 0.0]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_finite_decimals() {
        assert_eq!(<[f64; 3]>::read(" 1 \t.5\n-2e3 "), Ok([1.0, 0.5, -2000.0]));
        assert_eq!(f64::read("0x10"), Err(Fault::NotANumber("0x10".to_owned())));
        for text in ["nan", "inf", "-Infinity", "1e999"] {
            assert_eq!(f64::read(text), Err(Fault::NotFinite(short(text))));
        }
        assert_eq!(i32::read("3.0"), Err(Fault::NotAnInteger("3.0".to_owned())));
        assert_eq!(<[f64; 3]>::read("1 2"), Err(Fault::Count { found: 2, expected: Count { least: 3, most: 3 } }));
    }
}
