//! How commands fail, and how that is told.

use std::io::{IsTerminal, Write};
use std::path::Path;
use std::process::ExitCode;

use miette::{GraphicalReportHandler, LabeledSpan, NamedSource, SourceOffset};
use myo::model::ModelError;
use myo::tasks::{LoadError, Source, SourceLocation, preset_text};

/// Result of a command.
pub type Result<T> = std::result::Result<T, Failure>;

/// Why a command ended early.
#[derive(Debug)]
pub enum Failure {
    /// One plain sentence.
    Sentence(String),
    /// Mistakes that stand somewhere in a text.
    Mistakes(Vec<Mistake>),
    /// Whoever read the output is gone, as in `myo task show ar | head -1`: nothing to complain about.
    OutputClosed,
    /// Stopped by Ctrl-C, which has been told already.
    Interrupted,
    /// The graphics card was lost in the middle of a training; why, and where the checkpoint is.
    DeviceLost(String),
}

/// Something wrong or odd at a place of a text.
#[derive(Clone, Debug)]
pub struct Mistake {
    /// One sentence.
    pub message: String,
    /// Where it stands; none when it is about the text as a whole.
    pub place: Option<SourceLocation>,
    /// The text, as far as it is known.
    pub text: Option<String>,
    /// Odd, not wrong.
    pub warning: bool,
}

impl Failure {
    /// A failure told by one sentence.
    pub fn sentence(text: impl Into<String>) -> Self {
        Self::Sentence(text.into())
    }

    /// Tells the user and returns the exit status.
    pub fn report(self) -> ExitCode {
        match self {
            Self::OutputClosed => return ExitCode::SUCCESS,
            Self::Interrupted => return ExitCode::from(130),
            Self::DeviceLost(text) => {
                complain(&format!("error: {text}"));
                return ExitCode::from(3);
            }
            Self::Sentence(text) => complain(&format!("error: {text}")),
            Self::Mistakes(mistakes) => mistakes.iter().for_each(Mistake::tell),
        }
        ExitCode::FAILURE
    }
}

impl<E: std::error::Error> From<E> for Failure {
    fn from(error: E) -> Self {
        Self::Sentence(error.to_string())
    }
}

/// Writes a line to standard error; that nobody reads it is no reason to fail.
pub fn complain(text: &str) {
    let _ = writeln!(std::io::stderr(), "{text}");
}

/// Mistakes in a task, each with its place.
pub fn task_mistakes(error: &LoadError) -> Vec<Mistake> {
    match error {
        LoadError::UnknownKey { place, .. }
        | LoadError::UnknownValue { place, .. }
        | LoadError::MissingKey { place, .. }
        | LoadError::WrongType { place, .. }
        | LoadError::Syntax { place, .. } => vec![Mistake::at(place, &error.to_string())],
        LoadError::Values { values } => {
            values.iter().map(|bad| Mistake::at(&bad.place, &bad.error.to_string())).collect()
        }
        _ => vec![Mistake { message: error.to_string(), place: None, text: None, warning: false }],
    }
}

/// Mistakes in a model file.
pub fn model_failure(error: &ModelError) -> Failure {
    match error {
        ModelError::Read { file, line, column, message } => {
            let place = SourceLocation { file: file.clone(), line: *line, column: *column };
            Failure::Mistakes(vec![Mistake::at(&place, message)])
        }
        _ => Failure::sentence(error.to_string()),
    }
}

impl Mistake {
    /// A mistake whose text is that of the preset or file named by the place. `message` may begin with the place.
    pub fn at(place: &SourceLocation, message: &str) -> Self {
        let message = message.strip_prefix(&format!("{place}: ")).unwrap_or(message);
        let text =
            preset_text(&place.file).map(String::from).or_else(|| std::fs::read_to_string(Path::new(&place.file)).ok());
        Self { message: message.to_owned(), place: Some(place.clone()), text, warning: false }
    }

    /// A mistake in a task that could be read; `path` names the value that it is about.
    pub fn in_task(source: &Source, path: &str, message: &str) -> Self {
        let (place, text) = (Some(source.place(path)), Some(source.text.clone()));
        Self { message: message.to_owned(), place, text, warning: false }
    }

    /// The same as something odd.
    pub fn warning(self) -> Self {
        Self { warning: true, ..self }
    }

    /// Writes it to standard error: with the lines of the text around it to a terminal, else in one line that editors and
    /// scripts understand, `file:line:column: sentence`.
    pub fn tell(&self) {
        let drawn = std::io::stderr().is_terminal().then(|| self.drawing()).flatten();
        complain(drawn.unwrap_or_else(|| self.line()).trim_end_matches('\n'));
    }

    fn line(&self) -> String {
        let kind = if self.warning { "warning: " } else { "" };
        match &self.place {
            Some(place) => format!("{place}: {kind}{}", self.message),
            None if self.warning => format!("warning: {}", self.message),
            None => format!("error: {}", self.message),
        }
    }

    fn drawing(&self) -> Option<String> {
        let (place, text) = (self.place.as_ref()?, self.text.as_ref()?);
        let (line, column) = (usize::try_from(place.line).ok()?, usize::try_from(place.column).ok()?);
        let start = SourceOffset::from_location(text, line, column).offset();
        let length = value_length(text.get(start..)?);
        let severity = if self.warning { miette::Severity::Warning } else { miette::Severity::Error };
        let diagnostic = miette::MietteDiagnostic::new(&self.message)
            .with_severity(severity)
            .with_label(LabeledSpan::underline(start..start + length));
        let report = miette::Report::new(diagnostic).with_source_code(NamedSource::new(&place.file, text.clone()));
        let mut drawing = String::new();
        GraphicalReportHandler::new().render_report(&mut drawing, report.as_ref()).ok()?;
        Some(drawing)
    }
}

/// Bytes of the value that a text begins with: a list or group as far as its line goes, or a word.
fn value_length(text: &str) -> usize {
    let line = text.lines().next().unwrap_or_default();
    let closing = if line.starts_with(['[', '{']) { line.rfind([']', '}']) } else { None };
    closing.map_or_else(|| line.find([' ', ',', ':', ']', '}']).unwrap_or(line.len()), |last| last + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mistake_is_told_once_with_its_place() {
        let error = myo::tasks::Task::from_yaml("version: 1\nnam: x\n", "my.yaml").unwrap_err();
        let [mistake] = &task_mistakes(&error)[..] else { panic!("one mistake: {error}") };
        assert!(mistake.line().starts_with("my.yaml:2:1: unknown key `nam`"), "{}", mistake.line());
        assert_eq!(mistake.line().matches("my.yaml").count(), 1);
    }

    #[test]
    fn a_lost_device_has_a_status_of_its_own() {
        assert_eq!(Failure::DeviceLost("the GPU was lost".into()).report(), ExitCode::from(3));
    }

    #[test]
    fn a_drawing_shows_the_line_and_the_place() {
        let place = SourceLocation { file: "my.yaml".into(), line: 2, column: 1 };
        let text = Some("version: 1\nnam: x\n".into());
        let mistake = Mistake { message: "unknown key `nam`".into(), place: Some(place), text, warning: false };
        let drawing = mistake.drawing().unwrap();
        assert!(drawing.contains("unknown key `nam`") && drawing.contains("my.yaml:2:1"), "{drawing}");
    }

    #[test]
    fn values_are_underlined_whole() {
        let lengths = ["[1, 2]  # far\n3]", "dwell_s: 1", "0.3, 2]", "[1,\n2]", ""].map(value_length);
        assert_eq!(lengths, [6, 7, 3, 2, 0]);
    }

    #[test]
    fn a_place_beyond_the_text_is_no_reason_to_panic() {
        let place = SourceLocation { file: "my.yaml".into(), line: 99, column: 7 };
        let mistake = Mistake { message: "odd".into(), place: Some(place), text: Some("é".into()), warning: true };
        let _ = mistake.drawing();
        assert_eq!(mistake.line(), "my.yaml:99:7: warning: odd");
    }
}
