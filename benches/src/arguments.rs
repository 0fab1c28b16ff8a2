//! Arguments of the programs in `examples/`.

use std::collections::VecDeque;

use crate::Failure;

/// Arguments that are not taken yet.
pub struct Arguments(VecDeque<String>);

impl Arguments {
    /// Those that the program was called with.
    pub fn read() -> Self {
        Self(std::env::args().skip(1).collect())
    }

    /// Takes a word out, wherever it stands; whether it was there.
    pub fn takes(&mut self, word: &str) -> bool {
        let before = self.0.len();
        self.0.retain(|argument| argument != word);
        self.0.len() < before
    }

    /// Takes the next word, if there is one.
    pub fn word(&mut self) -> Option<String> {
        self.0.pop_front()
    }

    /// Takes the numbers that come next, with commas or spaces between them.
    ///
    /// # Errors
    /// What begins like a number is none.
    pub fn numbers(&mut self) -> Result<Vec<usize>, Failure> {
        let mut numbers = vec![];
        while let Some(list) = self.0.pop_front_if(|next| next.starts_with(|c: char| c.is_ascii_digit())) {
            for text in list.split(',') {
                numbers.push(text.parse().map_err(|error| format!("`{text}` is not a whole number: {error}"))?);
            }
        }
        Ok(numbers)
    }

    /// Refuses what nobody took.
    ///
    /// # Errors
    /// Something is left.
    pub fn end(mut self) -> Result<(), Failure> {
        self.word().map_or(Ok(()), |word| Err(format!("what is `{word}` for? The file of this example says").into()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arguments(line: &str) -> Arguments {
        Arguments(line.split(' ').map(String::from).collect())
    }

    #[test]
    fn numbers_and_words_are_taken_in_order_and_flags_from_anywhere() {
        for line in ["64,128 ar tiles", "64 tiles 128 ar", "tiles 64 128 ar"] {
            let mut given = arguments(line);
            assert!(given.takes("tiles") && !given.takes("tiles"), "{line}");
            assert_eq!(given.numbers().unwrap(), [64, 128], "{line}");
            assert_eq!(given.numbers().unwrap(), [0_usize; 0], "{line}");
            assert_eq!(given.word().as_deref(), Some("ar"), "{line}");
            given.end().unwrap();
        }
    }

    #[test]
    fn what_is_not_understood_is_told() {
        let error = arguments("64,1e3").numbers().unwrap_err().to_string();
        assert!(error.starts_with("`1e3` is not a whole number"), "{error}");
        let error = arguments("tile").end().unwrap_err().to_string();
        assert!(error.contains("`tile`"), "{error}");
    }
}
