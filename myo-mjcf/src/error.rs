//! What can be wrong with a model file, one variant per cause.

use crate::files::FileError;
use crate::place::{Kind, Place, Spot};
use crate::value::Count;
use myo_nearest::Nearest;

/// Why a model could not be read. Every message starts with file, line and column.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MjcfError {
    /// The main file cannot be read.
    #[error("{path}: {why}")]
    Main {
        /// The path asked for.
        path: String,
        /// What is wrong with it.
        why: FileError,
    },
    /// A file that an element names cannot be read.
    #[error("{at} file: `{path}` {why}")]
    File {
        /// The element.
        at: Box<Spot>,
        /// The path that it names.
        path: String,
        /// What is wrong with it.
        why: FileError,
    },
    /// A file includes or attaches itself, or is included twice.
    #[error("{at} file: `{path}` is included already; a file may be included once")]
    IncludedTwice {
        /// The element.
        at: Box<Spot>,
        /// The file.
        path: String,
    },
    /// The text is not XML.
    #[error("{place}: {message}")]
    Xml {
        /// Where.
        place: Place,
        /// What is wrong there.
        message: String,
    },
    /// The file declares a document type.
    #[error("{place}: document type declarations (`<!DOCTYPE`) and entities are not read; remove them")]
    DocumentType {
        /// Where it starts.
        place: Place,
    },
    /// The root is no MJCF.
    #[error("{at}: the root of {expected}")]
    Root {
        /// The root.
        at: Box<Spot>,
        /// What it should be.
        expected: &'static str,
    },
    /// The model asks for more than the limits allow.
    #[error("{at}: more than {limit} {what}; raise the limit if this is meant")]
    TooMuch {
        /// Where the limit was met.
        at: Box<Spot>,
        /// What there is too much of.
        what: &'static str,
        /// The limit.
        limit: u64,
    },
    /// MuJoCo knows no such element here.
    #[error("{at}: no such element in <{parent}>; {nearest}")]
    UnknownElement {
        /// The element.
        at: Box<Spot>,
        /// What it stands in.
        parent: String,
        /// Elements that may stand there.
        nearest: Nearest,
    },
    /// MuJoCo knows no such attribute of this element.
    #[error("{at}: no attribute `{attribute}`; {nearest}")]
    UnknownAttribute {
        /// The element.
        at: Box<Spot>,
        /// The attribute.
        attribute: String,
        /// Attributes that it may have.
        nearest: Nearest,
    },
    /// An attribute that must be there is not.
    #[error("{at}: `{attribute}` is missing")]
    Missing {
        /// The element.
        at: Box<Spot>,
        /// What it needs.
        attribute: &'static str,
    },
    /// Attributes contradict each other.
    #[error("{at}: `{first}` and `{second}` exclude each other; give one of them")]
    Exclusive {
        /// The element.
        at: Box<Spot>,
        /// One attribute.
        first: &'static str,
        /// The other.
        second: &'static str,
    },
    /// An element or attribute stands where it may not.
    #[error("{at}: {why}")]
    Misplaced {
        /// The element.
        at: Box<Spot>,
        /// Why it may not.
        why: &'static str,
    },
    /// A value is no number.
    #[error("{at} {attribute}: `{text}` is not a number")]
    NotANumber {
        /// The element.
        at: Box<Spot>,
        /// The attribute.
        attribute: String,
        /// What stands there.
        text: String,
    },
    /// A value is no whole number of 32 bits.
    #[error("{at} {attribute}: `{text}` is not a whole number between -2147483648 and 2147483647")]
    NotAnInteger {
        /// The element.
        at: Box<Spot>,
        /// The attribute.
        attribute: String,
        /// What stands there.
        text: String,
    },
    /// A number is NaN or infinite.
    #[error("{at} {attribute}: `{text}` is not finite; a finite number is needed")]
    NotFinite {
        /// The element.
        at: Box<Spot>,
        /// The attribute.
        attribute: String,
        /// What stands there.
        text: String,
    },
    /// Too few or too many values.
    #[error("{at} {attribute}: {found} values; {expected} needed")]
    WrongCount {
        /// The element.
        at: Box<Spot>,
        /// The attribute.
        attribute: String,
        /// How many there are.
        found: usize,
        /// How many there should be.
        expected: Count,
    },
    /// A value is none of the words allowed.
    #[error("{at} {attribute}: no such value `{text}`; {nearest}")]
    UnknownKeyword {
        /// The element.
        at: Box<Spot>,
        /// The attribute.
        attribute: String,
        /// What stands there.
        text: String,
        /// Words allowed.
        nearest: Nearest,
    },
    /// A value lies outside what makes sense.
    #[error("{at} {attribute}: `{text}`; it must be {expected}")]
    OutOfRange {
        /// The element.
        at: Box<Spot>,
        /// The attribute.
        attribute: &'static str,
        /// What stands there.
        text: String,
        /// What would be right.
        expected: &'static str,
    },
    /// There is no such default class.
    #[error("{at} {attribute}: no default class `{name}`; {nearest}")]
    UnknownClass {
        /// The element.
        at: Box<Spot>,
        /// The attribute.
        attribute: &'static str,
        /// The class asked for.
        name: String,
        /// Classes that exist.
        nearest: Nearest,
    },
    /// There is no such thing to attach.
    #[error("{at} {attribute}: no {kind} `{name}`; {nearest}")]
    UnknownName {
        /// The element.
        at: Box<Spot>,
        /// The attribute.
        attribute: &'static str,
        /// What was looked for.
        kind: Kind,
        /// The name asked for.
        name: String,
        /// Names that exist.
        nearest: Nearest,
    },
    /// An element stands twice where it may stand once.
    #[error("{at}: there is one already, at {first}; join the two")]
    Repeated {
        /// The second element.
        at: Box<Spot>,
        /// Where the first one stands.
        first: Place,
    },
    /// Two elements of one kind have one name.
    #[error("{at}: there is a {kind} of this name already, at {first}; names of one kind must differ")]
    DuplicateName {
        /// The second element.
        at: Box<Spot>,
        /// What both are.
        kind: Kind,
        /// Where the first one stands.
        first: Place,
    },
    /// An element refers both to what `replicate` copies and to what it does not, or to two things copied differently.
    #[error(
        "{at}: refers to {kind} `{name}`, which is copied by the <replicate> at {replicate}, and to something that is \
         not; refer to one copy by its own name, or put both into the <replicate>"
    )]
    PartlyCopied {
        /// The element.
        at: Box<Spot>,
        /// What is copied.
        kind: Kind,
        /// Its name.
        name: String,
        /// What copies it.
        replicate: Place,
    },
}
