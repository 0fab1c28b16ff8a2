//! Output: text, tables, JSON, commands to type.

use std::borrow::Cow;
use std::io::{ErrorKind, IsTerminal, Write};
use std::path::Path;

pub use myo::progress::rounded;
use serde::Serialize;

use super::failure::{Failure, Result};

/// Writes text for people to standard output.
pub fn print(text: &str) -> Result<()> {
    write_out(&printable(text))
}

/// Writes a file to standard output, byte for byte; a terminal gets no control characters.
pub fn print_file(text: &str) -> Result<()> {
    if std::io::stdout().is_terminal() { print(text) } else { write_out(text) }
}

fn write_out(text: &str) -> Result<()> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Err(Failure::OutputClosed),
        Err(error) => Err(Failure::sentence(format!("cannot write the output: {error}"))),
        Ok(()) => Ok(()),
    }
}

/// Writes a value as indented JSON.
pub fn print_json(value: &impl Serialize) -> Result<()> {
    // Control characters up to U+001F are escaped already.
    let text = escaped(&serde_json::to_string_pretty(value)?, |c| format!("\\u{:04x}", u32::from(c))).into_owned();
    write_out(&(text + "\n"))
}

/// Text that may come from a file, with the characters escaped that a terminal would obey. Line breaks and tabs stay.
pub fn printable(text: &str) -> Cow<'_, str> {
    escaped(text, |c| c.escape_default().to_string())
}

/// The same for a name within a sentence, which must not break its line.
pub fn name(text: &str) -> String {
    printable(text).replace('\n', "\\n").replace('\t', "\\t")
}

fn escaped(text: &str, escape: impl Fn(char) -> String) -> Cow<'_, str> {
    if !text.contains(commands_terminal) {
        return Cow::Borrowed(text);
    }
    text.chars().map(|c| if commands_terminal(c) { escape(c) } else { c.to_string() }).collect()
}

/// Whether a terminal would obey a character instead of showing it: control characters, and those that change the
/// direction of writing, with which text can be made to look like other text.
pub fn commands_terminal(c: char) -> bool {
    let turns = matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    (c.is_control() && !matches!(c, '\n' | '\t')) || turns
}

/// A command of this program as it can be typed into a shell, with the name by which the program was called.
pub fn command(words: &[&str]) -> String {
    let program = std::env::args().next().unwrap_or_else(|| "myo".into());
    let words = [program.as_str()].into_iter().chain(words.iter().copied());
    words.map(shell_word).collect::<Vec<_>>().join(" ")
}

fn shell_word(word: &str) -> Cow<'_, str> {
    // It fails for a zero byte only, which no argument can contain.
    shlex::try_quote(word).unwrap_or(Cow::Borrowed(word))
}

/// A path as an argument of [`command`].
pub fn argument(path: &Path) -> String {
    let text = path.display().to_string();
    // Else it would be taken for an option.
    if text.starts_with('-') { format!("./{text}") } else { text }
}

/// Columns as wide as their widest cell, two spaces apart; the first row is the heading. Columns whose cells begin with a
/// digit or a sign are aligned to the right.
pub fn table(rows: &[Vec<String>]) -> String {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| rows.iter().filter_map(|row| Some(row.get(column)?.chars().count())).max().unwrap_or(0);
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let numeric: Vec<bool> = (0..columns).map(|column| is_numeric(rows, column)).collect();
    let line = |row: &Vec<String>| {
        let cells = row.iter().zip(&widths).zip(&numeric).map(|((cell, &width), &numeric)| match numeric {
            true => format!("{cell:>width$}"),
            false => format!("{cell:<width$}"),
        });
        format!("  {}\n", cells.collect::<Vec<_>>().join("  ").trim_end())
    };
    rows.iter().map(line).collect()
}

fn is_numeric(rows: &[Vec<String>], column: usize) -> bool {
    let number = |cell: &String| cell.is_empty() || cell.starts_with(|c: char| c.is_ascii_digit() || "+-".contains(c));
    rows.iter().skip(1).filter_map(|row| row.get(column)).all(number)
}

/// A row of a [`table`].
pub fn row<const N: usize>(cells: [&str; N]) -> Vec<String> {
    cells.map(String::from).to_vec()
}

/// A count with a comma every three digits.
pub fn grouped(count: u64) -> String {
    let digits = count.to_string();
    let groups: Vec<&str> = digits.as_bytes().rchunks(3).rev().filter_map(|g| std::str::from_utf8(g).ok()).collect();
    groups.join(",")
}

/// A duration for people: `4.2 s`, `3 min 05 s`, `2 h 10 min`.
pub fn duration(seconds: f64) -> String {
    let whole = seconds.max(0.0).round() as u64;
    match whole {
        0..60 => format!("{seconds:.1} s"),
        60..3600 => format!("{} min {:02} s", whole / 60, whole % 60),
        _ => format!("{} h {:02} min", whole / 3600, whole % 3600 / 60),
    }
}

/// A share as a percentage.
pub fn percent(share: f64) -> String {
    format!("{:.1} %", 100.0 * share)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_well() {
        assert_eq!((grouped(0), grouped(999), grouped(1_234_567)), ("0".into(), "999".into(), "1,234,567".into()));
        assert_eq!([12.0, 1234.0, 99_960.0, 4.56e6].map(rounded), ["12.0", "1.23 k", "100 k", "4.56 M"]);
        assert_eq!([4.21, 185.0, 7805.0].map(duration), ["4.2 s", "3 min 05 s", "2 h 10 min"]);
    }

    #[test]
    fn text_from_files_does_not_command_the_terminal() {
        let evil = "a\u{1b}[2J\u{9b}31m\u{7f}\r\u{202e}b\tc\nd";
        let shown = r"a\u{1b}[2J\u{9b}31m\u{7f}\r\u{202e}b";
        assert_eq!(printable(evil), format!("{shown}\tc\nd"));
        assert_eq!(name(evil), format!(r"{shown}\tc\nd"));
        assert!(matches!(printable("é ∑ 腕"), Cow::Borrowed("é ∑ 腕")));
        let json = escaped("\"\u{9b}\"", |c| format!("\\u{:04x}", u32::from(c))).into_owned();
        assert_eq!(serde_json::from_str::<String>(&json).unwrap(), "\u{9b}", "{json}");
    }

    #[test]
    fn commands_can_be_typed_as_they_are_told() {
        for word in ["runs/my run", "it's", "$(reboot)", "a;b", "", "~", "*", "a\nb", "été", "\\"] {
            let words = shlex::split(&command(&["eval", word])).unwrap();
            assert_eq!(words[1..], ["eval", word]);
        }
        assert!(command(&["eval", "runs/my-1"]).ends_with(" eval runs/my-1"), "no quotes where none are needed");
        assert_eq!([Path::new("-x"), Path::new("a/-x")].map(argument), ["./-x", "a/-x"]);
    }

    #[test]
    fn tables_align_words_left_and_numbers_right() {
        let rows = [row(["name", "n"]), row(["a", "10"]), row(["long", "9"])];
        assert_eq!(table(&rows), "  name   n\n  a     10\n  long   9\n");
    }
}
