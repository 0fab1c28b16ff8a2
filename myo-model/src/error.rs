//! What can be wrong with a model, one variant per cause.

use std::fmt;

use myo_nearest::Nearest;

/// Why a model could not be read or compiled.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ModelError {
    /// No built-in model has this name.
    #[error("there is no built-in model `{name}`; {nearest}")]
    UnknownBuiltin {
        /// The name asked for.
        name: String,
        /// Names that exist.
        nearest: Nearest,
    },
    /// The text is not YAML, or not a model, or a value lies outside its range.
    #[error("{file}:{line}:{column}: {message}")]
    Read {
        /// Name of the file, as given by the caller.
        file: String,
        /// Line, from 1.
        line: u64,
        /// Column, from 1.
        column: u64,
        /// What is wrong there.
        message: String,
    },
    /// The description cannot be written as text.
    #[error("the model cannot be written as YAML: {message}")]
    Write {
        /// What the writer said.
        message: String,
    },
    /// The file format has another version.
    #[error("the model has format version {found}, but this program reads version {supported}")]
    FormatVersion {
        /// Version in the description.
        found: u32,
        /// Version of this program.
        supported: u32,
    },
    /// An element has no name.
    #[error("{kind} number {position} has an empty name; every element needs one")]
    EmptyName {
        /// Kind of element.
        kind: ElementKind,
        /// Position in its list, from 1.
        position: usize,
    },
    /// More fingers than tasks can ask for at once.
    #[error(
        "landmarks: `fingers` names {count} fingers beside the fingertip; at most {most} are followed, leave out the others"
    )]
    TooManyFingers {
        /// How many there are.
        count: usize,
        /// How many there may be.
        most: usize,
    },
    /// Two fingers with one tip.
    #[error("landmarks: site `{site}` is the tip of `{one}` and of `{other}`; every finger has its own")]
    SharedTip {
        /// The site.
        site: String,
        /// A finger, or `fingertip`.
        one: String,
        /// Another.
        other: String,
    },
    /// A finger with the name of what points anyway.
    #[error(
        "landmarks: a finger is named `{name}`, which tasks take for what points; choose another name, such as `thumb`"
    )]
    ReservedFinger {
        /// The name.
        name: String,
    },
    /// A body took the name of the fixed root.
    #[error("a body is named `world`, which is reserved for the fixed root; choose another name")]
    ReservedName,
    /// What is seen of a body is not there.
    #[error("{element}: points and triangles cannot be read: {what}")]
    BadLook {
        /// The element.
        element: Element,
        /// What is wrong.
        what: String,
    },
    /// A convex mesh is none.
    #[error("{element}: {what}")]
    BadHull {
        /// The element.
        element: Element,
        /// What is wrong.
        what: String,
    },
    /// A shape is a convex mesh that is not there.
    #[error("{element}: its shape is hull {hull}, counted from 0, of {count}")]
    NoHull {
        /// The geom.
        element: Element,
        /// The number of the hull.
        hull: usize,
        /// How many there are.
        count: usize,
    },
    /// Two elements of one kind share a name.
    #[error("{element} is declared twice; names of one kind must differ")]
    DuplicateName {
        /// The element.
        element: Element,
    },
    /// An element refers to a name that does not exist.
    #[error("{element}: unknown {wanted} `{name}`; {nearest}")]
    UnknownName {
        /// The element that refers to it.
        element: Element,
        /// What kind of element was looked for.
        wanted: ElementKind,
        /// The name that was not found.
        name: String,
        /// Names that exist.
        nearest: Nearest,
    },
    /// A number is NaN or infinite.
    #[error("{element}: `{field}` is {value}; a finite number is needed")]
    NotFinite {
        /// The element.
        element: Element,
        /// The field.
        field: &'static str,
        /// The value found.
        value: f64,
    },
    /// A number lies outside what makes sense.
    #[error("{element}: `{field}` is {value}{unit}; it must be {expected}")]
    OutOfRange {
        /// The element.
        element: Element,
        /// The field.
        field: &'static str,
        /// The value found.
        value: f64,
        /// Unit with a leading space, or empty.
        unit: &'static str,
        /// What would be right.
        expected: &'static str,
    },
    /// A pair of bounds is empty or the wrong way round.
    #[error("{element}: `{field}` runs from {lower} to {upper}{unit}; the first must be below the second")]
    InvertedRange {
        /// The element.
        element: Element,
        /// The field.
        field: &'static str,
        /// The first bound.
        lower: f64,
        /// The second bound.
        upper: f64,
        /// Unit with a leading space, or empty.
        unit: &'static str,
    },
    /// A direction has no length.
    #[error("{element}: `{field}` has length zero; a direction is needed")]
    ZeroLength {
        /// The element.
        element: Element,
        /// The field.
        field: &'static str,
    },
    /// Principal moments that no distribution of mass has.
    #[error(
        "{element}: principal moments {} {} {} kg m^2 belong to no solid; each must be at most the sum of the others",
        .moments[0], .moments[1], .moments[2]
    )]
    ImpossibleInertia {
        /// The body.
        element: Element,
        /// Principal moments.
        moments: [f64; 3],
    },
    /// A body that moves has no mass or no inertia.
    #[error("{element} moves but has no {quantity}; give it some, or weld it to a body that has")]
    Massless {
        /// The body.
        element: Element,
        /// `mass` or `inertia`.
        quantity: &'static str,
    },
    /// A joint is asked to move the fixed root.
    #[error("{element} is on `world`, which stands still; name the body that moves")]
    JointOnWorld {
        /// The joint.
        element: Element,
    },
    /// A joint has what joints of its kind have not.
    #[error("{element} is a {kind} joint, which has no `{field}`; leave it out")]
    NotOfKind {
        /// The joint.
        element: Element,
        /// Its kind.
        kind: &'static str,
        /// The field.
        field: &'static str,
    },
    /// A body that hangs on another one was to move freely.
    #[error("{element} is a free joint, but its body hangs on `{parent}`; only bodies on `world` move freely")]
    FreeBelow {
        /// The joint.
        element: Element,
        /// What its body hangs on.
        parent: String,
    },
    /// A joint that takes all freedom, or all turning, and then another one.
    #[error(
        "{element} follows the {kind} joint `{first}` of the same body, which leaves it nothing to do; drop one of them"
    )]
    Superfluous {
        /// The later joint.
        element: Element,
        /// Name of the earlier one.
        first: String,
        /// Its kind.
        kind: &'static str,
    },
    /// A coupling of joints that more than one number tells the position of.
    #[error("{element}: joint `{joint}` is a {kind} joint; only hinges and slides follow and lead")]
    CouplesMany {
        /// The coupling.
        element: Element,
        /// The joint.
        joint: String,
        /// Its kind.
        kind: &'static str,
    },
    /// Bodies are each other's parents.
    #[error("{element} is its own ancestor; every chain of parents must end at `world`")]
    BodyCycle {
        /// One body of the cycle.
        element: Element,
    },
    /// A joint is asked to follow two others.
    #[error("{element} is the dependent joint of two couplings; at most one is allowed")]
    CoupledTwice {
        /// The joint.
        element: Element,
    },
    /// A joint follows a joint that follows another (or itself).
    #[error("{element} follows joint `{leader}`, which is itself a dependent joint; couple it to a free joint")]
    CouplingChain {
        /// The dependent joint.
        element: Element,
        /// The joint it follows.
        leader: String,
    },
    /// A shape is asked not to pass through itself.
    #[error("a contact names geom `{geom}` twice; it takes two to touch")]
    TouchesItself {
        /// The geom.
        geom: String,
    },
    /// A body is asked to hold itself.
    #[error("a connection names body `{body}` twice; it holds two together")]
    HeldToItself {
        /// The body.
        body: String,
    },
    /// What a muscle runs over does not stand between two sites.
    #[error("{element}: its path {place} `{{over: {wrap}}}`; a site must stand before it and after it")]
    LooseWrap {
        /// The muscle.
        element: Element,
        /// What it runs over.
        wrap: String,
        /// Where that stands: a verb for the path.
        place: &'static str,
    },
    /// A path is asked to bend round two things at once.
    #[error("{element}: `{{over: {first}}}` and `{{over: {second}}}` follow each other; put a site between them")]
    WrapsInRow {
        /// The muscle.
        element: Element,
        /// What it runs over first.
        first: String,
        /// What it runs over then.
        second: String,
    },
    /// A model that is nobody's body was to become somebody's.
    #[error(
        "the model `{model}` does not tell whose body it is (`anthropometry`), so that it cannot be made as large as somebody else; leave out sex, \
         height and mass, or take the model `myo-arm`"
    )]
    NoAnthropometry {
        /// The model.
        model: String,
    },
    /// A body is in two segments of an arm.
    #[error("body `{body}` is named twice in `anthropometry`; each belongs to one segment")]
    InTwoSegments {
        /// The body.
        body: String,
    },
    /// A sensor measures what its element does not have.
    #[error("{element}: {why}")]
    NothingToMeasure {
        /// The sensor.
        element: Element,
        /// What is not there.
        why: &'static str,
    },
    /// A muscle has no force to scale.
    #[error(
        "{element} does not tell its peak isometric `force`, so that its model cannot be made as large as somebody else; give `gain` and `bias` of \
         every muscle a force"
    )]
    NoForce {
        /// The muscle.
        element: Element,
    },
    /// A tendon transfer of what another one takes.
    #[error("muscle `{muscle}` is moved or replaced by two tendon transfers; each muscle may be in one")]
    TransferredTwice {
        /// The muscle.
        muscle: String,
    },
    /// A muscle has nothing to pull between.
    #[error("{element}: {branch} has {sites} site(s); at least 2 are needed")]
    ShortPath {
        /// The muscle.
        element: Element,
        /// What is short.
        branch: &'static str,
        /// Number of sites.
        sites: usize,
    },
}

/// Kinds of named elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ElementKind {
    /// The `options` block.
    Options,
    /// The `landmarks` block.
    Landmarks,
    /// The `anthropometry` block.
    Anthropometry,
    /// What makes a body that of a person.
    Person,
    /// A rigid body.
    Body,
    /// A joint.
    Joint,
    /// A coupling, named by its dependent joint.
    Coupling,
    /// A connection, named by its two bodies.
    Connection,
    /// A site.
    Site,
    /// A collision shape.
    Geom,
    /// A contact, named by its two geoms.
    Contact,
    /// What muscles run over.
    Wrap,
    /// A muscle.
    Muscle,
    /// What is seen of a body, by its number.
    Look,
    /// A convex mesh, by its number.
    Hull,
    /// What is measured.
    Sensor,
}

impl fmt::Display for ElementKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Options => "options",
            Self::Landmarks => "landmarks",
            Self::Anthropometry => "anthropometry",
            Self::Person => "the body of the user",
            Self::Body => "body",
            Self::Joint => "joint",
            Self::Coupling => "coupling of joint",
            Self::Connection => "connection",
            Self::Site => "site",
            Self::Geom => "geom",
            Self::Contact => "contact",
            Self::Wrap => "wrap",
            Self::Muscle => "muscle",
            Self::Look => "look",
            Self::Hull => "hull",
            Self::Sensor => "sensor",
        })
    }
}

/// An element that an error is about.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Element {
    /// Kind of element.
    pub kind: ElementKind,
    /// Its name; empty for `options` and `landmarks`.
    pub name: String,
}

impl Element {
    pub(crate) fn new(kind: ElementKind, name: &str) -> Self {
        Self { kind, name: name.to_owned() }
    }
}

impl fmt::Display for Element {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.name.as_str() {
            "" => write!(f, "{}", self.kind),
            name => write!(f, "{} `{name}`", self.kind),
        }
    }
}
