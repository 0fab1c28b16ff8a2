//! What a user practises before it is asked: the tasks of the protocols, done with its own body, rhythm, reward and noise.

use std::f64::consts::{PI, TAU};

use myo_tasks::{GoGo, LoadError, Pose, Ray, RayFrom, Reset, Task, Technique};
use myo_train::PpoConfig;
use serde_json::{Value, json};

use crate::advice::distance;

/// Targets on the circle of ISO 9241-411.
pub const TARGETS: usize = 13;
/// From each target to the one that is next: across the circle.
const ACROSS: usize = 6;
/// Selections of an episode; before the first one the arm hangs.
pub const SELECTIONS: usize = TARGETS + 1;
/// How long (s) the fingertip stays in a target for it to be selected.
pub(crate) const DWELL_S: f64 = 0.25;
/// Distances (m) from target to target, and widths (m).
const DISTANCES: [f64; 4] = [0.1, 0.2, 0.3, 0.4];
const WIDTHS: [f64; 4] = [0.015, 0.025, 0.05, 0.1];
/// Indices of difficulty (bit) of the pairs that are asked for.
const INDICES: [f64; 2] = [1.5, 5.0];
/// The upright plane of the circle (m before the shoulder).
pub(crate) const PLANE_X: f64 = 0.5;
/// Where people work in the air, and the middle of the upright circle there (m before and above the shoulder): with the arm stretched out, and
/// beside the trunk with the elbow bent.
pub const HEIGHTS: [(&str, [f64; 2]); 2] = [("shoulder", [0.5, 0.0]), ("waist", [0.35, -0.35])];
/// Distance and width (m) of the targets there.
const WORK: [f64; 2] = [0.2, 0.05];
/// Distance (m) from the shoulder at which the arm is held, and for how long (s).
const HOLD_AT: f64 = 0.55;
const HOLD_S: f64 = 2.0;
/// Angles (degrees) between the hanging arm and the one that is held.
pub const HOLD_DEG: [f64; 2] = [45.0, 90.0];
/// Keys, nearly flush as on glass: how many, from one to the next, width and height, how thick (m), and the force that presses them (N).
const KEYS: usize = 5;
const KEY_PITCH: f64 = 0.01;
const KEY_SIZE: [f64; 2] = [0.006, 0.009];
const KEY_DEPTH: f64 = 0.001;
const KEY_FORCE_N: f64 = 0.3;
/// The middle of the keys (m), and the size of the plate on which they lie, which no finger goes through (m).
const KEYS_AT: [f64; 3] = [0.3, 0.0, -0.3];
const PLATE_SIZE: [f64; 3] = [0.08, 0.04, 0.05];
/// From the keys to the plate below them (m): boxes may not overlap.
const PLATE_BELOW: f64 = 0.0005;
/// What is typed, on phones whose keys are so wide (m), with so much between them (m) and so far below them the case (m).
pub const TYPED: &str = "the quick brown fox";
pub const KEY_WIDTHS: [f64; 4] = [0.005, 0.007, 0.009, 0.012];
const KEY_GAP: f64 = 0.001;
const CASE_BELOW: f64 = 0.0085;
/// Ways to steer along, upright and round the same place (m): straight ones of this length, and nearly whole circles of this radius.
const WAY_AT: [f64; 3] = [0.45, 0.0, -0.1];
const STRAIGHT: f64 = 0.3;
const CIRCLE_RADIUS: f64 = 0.1;
/// Straight pieces of each.
pub const WAY_PIECES: usize = 15;
/// Widths of ways (m).
const WAY_WIDTHS: [f64; 4] = [0.02, 0.03, 0.05, 0.08];
/// Radius (m) of the spheres between which they go: passes are timed from leaving the first to the last.
pub const WAY_SPHERE: f64 = 0.01;
/// Steps before the first piece of a way: to stay at its beginning, and to be there when it begins.
pub const BEFORE_WAY: usize = 2;
/// Semi-axes of the ellipse (m), and how wide its way is (m).
const ELLIPSE: [f64; 2] = [0.1, 0.05];
const ELLIPSE_WIDTH: f64 = 0.03;
/// Straight pieces of a lap of the ellipse.
pub const LAP_PIECES: usize = 16;
/// Laps of an episode.
pub const LAPS: usize = 3;
/// How many spheres there are to choose from.
pub const CHOICES: [usize; 3] = [2, 4, 8];
/// How often one of them lights up in an episode.
pub const REACTIONS: usize = 6;
/// Spheres about the hand, how far from the middle (m), and their radius (m). Those that may light up lie opposite each other, so that to wait in the
/// middle is best.
const LAMPS: usize = 8;
const LAMPS_OFF: f64 = 0.12;
const LAMP_RADIUS: f64 = 0.03;
/// After what time one lights up (s).
const LIT_AFTER_S: [f64; 2] = [0.5, 1.5];
/// A sphere that is tracked: its place (m), its radius (m), how far it goes to either side, up and down (m), for how long (s), and the greatest
/// frequencies (Hz) of the waves it goes along, as User-in-the-Box was asked (Ikkala et al. 2022, doi 10.1145/3526113.3545689) on a smaller plane: people need not
/// walk to see it, and every arm reaches all of it.
const TRACKED_AT: [f64; 3] = [0.45, 0.0, -0.1];
pub(crate) const TRACKED_RADIUS: f64 = 0.05;
const TRACKED_BY: f64 = 0.2;
const TRACKED_S: f64 = 15.0;
pub(crate) const TRACKED_UP_TO_HZ: [f64; 4] = [0.05, 0.25, 0.5, 1.0];
/// A wall that a ray points at: how far before the shoulder it stands, and how large it is (m). On its face are what is to be pointed at.
const WALL_X: f64 = 2.0;
const WALL_SIZE: [f64; 3] = [2.0, 2.0, 0.02];
/// Angles (degrees) from target to target, and of targets, as seen from the shoulder; and how long the ray stays in one (s).
const RAY_DISTANCES_DEG: [f64; 3] = [10.0, 20.0, 40.0];
const RAY_WIDTHS_DEG: [f64; 4] = [1.0, 2.0, 4.0, 8.0];
const RAY_DWELL_S: f64 = 0.4;
/// Distances (m) that a hand that grows reaches out to straight ahead, the radius (m) of what is there, and from where near the body (m).
pub const FAR: [f64; 5] = [0.4, 0.6, 0.9, 1.3, 1.9];
const FAR_RADIUS: f64 = 0.1;
const FAR_FROM: [f64; 3] = [0.25, 0.0, -0.2];
/// How often it does so in an episode.
pub const FAR_REACHES: usize = 6;
/// What leaving a way costs.
const EXIT_COST: f64 = 2.0;
/// Least logarithm of the standard deviation of exploration.
const LOG_STD_MIN: f64 = -3.5;
/// Presses of an episode, of one key.
pub const PRESSES: usize = 20;

/// What is practised. Each is a training of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Practice {
    /// Across a circle of 13 targets and back (ISO 9241-411), for 15 pairs of distance and width: F1, K1, K2, K5.
    Pointing,
    /// Holding the fingertip in a sphere of 10 cm with the arm raised by 45 and by 90 degrees: K3, K5.
    Holding,
    /// Pressing five keys of 6 by 9 mm on a plate in random orders: T1.
    Keys,
    /// Pressing one key as fast as possible: T1.
    Tapping,
    /// Across the circle at the height of the shoulder, and nearer at that of the waist: E2.
    Working,
    /// Typing three words and a half on phones with keys of four sizes: T3.
    Typing,
    /// Along straight and round ways of four widths: S1.
    Steering,
    /// After a sphere that wanders about, slowly and fast: S2.
    Tracking,
    /// Three times round an ellipse of 20 by 10 cm: K4.
    Ellipse,
    /// To one of two, four or eight spheres that lights up: C1.
    Choosing,
    /// With a ray from the hand across circles on a wall, for twelve pairs of angles: I1.
    Ray,
    /// With a hand that grows (Go-Go) to things in and beyond the arm's reach: I2.
    Far,
}

impl Practice {
    /// All of them.
    pub const ALL: [Self; 12] = [
        Self::Pointing,
        Self::Holding,
        Self::Keys,
        Self::Tapping,
        Self::Working,
        Self::Typing,
        Self::Steering,
        Self::Tracking,
        Self::Ellipse,
        Self::Choosing,
        Self::Ray,
        Self::Far,
    ];

    /// Its name, also of the folder of its runs.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Pointing => "pointing",
            Self::Holding => "holding",
            Self::Keys => "keys",
            Self::Tapping => "tapping",
            Self::Working => "working",
            Self::Typing => "typing",
            Self::Steering => "steering",
            Self::Tracking => "tracking",
            Self::Ellipse => "ellipse",
            Self::Choosing => "choosing",
            Self::Ray => "ray",
            Self::Far => "far",
        }
    }

    /// How it is learnt by users who learn otherwise with these settings: exploration may come to an end. With the usual least noise, a tenth of
    /// full control in every muscle, nobody stays in a target of 15 mm, so nobody learns to.
    pub fn learning(self, usual: &PpoConfig) -> PpoConfig {
        PpoConfig { log_std_min: usual.log_std_min.min(LOG_STD_MIN), ..usual.clone() }
    }

    /// Its tasks for the user of another task, layouts of one structure: what a user brings along (body, control step, reward, senses, fatigue,
    /// noise) is as there.
    ///
    /// # Errors
    /// What that user brings along fits no such task.
    pub fn layouts(self, user: &Task) -> Result<Vec<Task>, LoadError> {
        let of_user = |layout: Layout| layout.task(user);
        match self {
            Self::Pointing => conditions().into_iter().map(|pair| of_user(circle(pair))).collect(),
            Self::Holding => Ok(vec![of_user(holding())?]),
            Self::Keys => Ok(vec![of_user(keys())?]),
            Self::Tapping => Ok(vec![of_user(tapping())?]),
            Self::Working => HEIGHTS.into_iter().map(|(height, middle)| of_user(working(height, middle))).collect(),
            Self::Typing => KEY_WIDTHS.into_iter().map(|width| of_user(typing(width))).collect(),
            Self::Tracking => TRACKED_UP_TO_HZ.into_iter().map(|up_to_hz| of_user(tracking(up_to_hz))).collect(),
            Self::Ellipse => Ok(vec![not_to_leave(of_user(laps())?)]),
            Self::Ray => ray_pairs().into_iter().map(|pair| of_user(on_a_wall(pair)).map(with_a_ray)).collect(),
            Self::Far => FAR.into_iter().map(|distance| of_user(far(distance)).map(with_a_growing_hand)).collect(),
            Self::Choosing => CHOICES.into_iter().map(|choices| of_user(choosing(choices))).collect(),
            Self::Steering => ways().iter().map(|way| of_user(steering(way)).map(not_to_leave)).collect(),
        }
    }
}

/// With ways that are not to be left, as participants are told: it costs whom it costs nothing as much as a wrong press costs `human`.
fn not_to_leave(mut task: Task) -> Task {
    if task.reward.exit == 0.0 {
        task.reward.exit = EXIT_COST;
    }
    task
}

/// Done with a ray from the hand, as from a pointer that is held.
fn with_a_ray(task: Task) -> Task {
    Task { technique: Technique::Ray(Ray { from: RayFrom::Hand, onto: Some("wall".into()) }), ..task }
}

/// Done with a hand that grows, by the published numbers (Poupyrev et al. 1996, doi 10.1145/237091.237102).
fn with_a_growing_hand(task: Task) -> Task {
    Task { technique: Technique::GoGo(GoGo::published()), ..task }
}

/// Angles from target to target, and of targets (degrees), of each layout of [`Practice::Ray`].
pub fn ray_pairs() -> Vec<[f64; 2]> {
    RAY_DISTANCES_DEG.into_iter().flat_map(|distance| RAY_WIDTHS_DEG.map(|width| [distance, width])).collect()
}

/// Distance and width (m) of each layout of [`Practice::Pointing`].
pub fn conditions() -> Vec<[f64; 2]> {
    let all = DISTANCES.into_iter().flat_map(|distance| WIDTHS.map(|width| [distance, width]));
    let [least, most] = INDICES;
    all.filter(|&[distance, width]| (least..=most).contains(&myo_measure::fitts::index_of_difficulty(distance, width)))
        .collect()
}

/// Centres of the targets (m) in the order of their selection, for a distance (m) from each to the next.
pub fn circle_targets(distance: f64) -> [[f64; 3]; SELECTIONS] {
    let radius = 0.5 * distance / (PI / (2 * TARGETS) as f64).cos();
    std::array::from_fn(|selection| {
        let angle = TAU * ((selection * ACROSS) % TARGETS) as f64 / TARGETS as f64;
        [PLANE_X, -radius * angle.sin(), radius * angle.cos()]
    })
}

/// A way that is steered along.
#[derive(Clone, Debug)]
pub struct Way {
    /// Its shape.
    pub shape: &'static str,
    /// Corners (m), one more than there are pieces.
    pub corners: Vec<[f64; 3]>,
    /// How wide it is (m).
    pub width: f64,
}

impl Way {
    /// How long it is (m), from sphere to sphere.
    pub fn length(&self) -> f64 {
        let pieces = self.corners.windows(2).map(|ends| distance(ends[0], ends[1]));
        pieces.sum::<f64>() - 2.0 * WAY_SPHERE
    }
}

/// The ways of [`Practice::Steering`], in the order of its layouts.
pub fn ways() -> Vec<Way> {
    let [x, y, z] = WAY_AT;
    let share = |corner: usize| corner as f64 / WAY_PIECES as f64;
    let straight = |corner| [x, y + STRAIGHT * (0.5 - share(corner)), z];
    // All corners of a regular polygon; the piece that would close it is left out.
    let circle = |corner: usize| {
        let (sine, cosine) = (TAU * corner as f64 / (WAY_PIECES + 1) as f64).sin_cos();
        [x, y - CIRCLE_RADIUS * sine, z + CIRCLE_RADIUS * cosine]
    };
    let of_widths = |shape, corner: &dyn Fn(usize) -> [f64; 3]| {
        let corners: Vec<_> = (0..=WAY_PIECES).map(corner).collect();
        WAY_WIDTHS.map(|width| Way { shape, corners: corners.clone(), width })
    };
    [of_widths("straight", &straight), of_widths("circle", &circle)].concat()
}

/// What is in the world and what is done there.
pub(crate) struct Layout {
    pub name: String,
    pub scene: Value,
    pub script: Value,
    pub time_limit_s: f64,
}

impl Layout {
    pub(crate) fn task(self, user: &Task) -> Result<Task, LoadError> {
        let Self { name, scene, script, time_limit_s } = self;
        let text = json!({
            "version": 2, "name": name, "scene": scene, "script": script, "time_limit_s": time_limit_s,
        });
        let task = Task::from_yaml(&text.to_string(), &name)?;
        Ok(Task {
            model: user.model.clone(),
            user: user.user,
            body: user.body.clone(),
            perception: user.perception.clone(),
            control_dt_s: user.control_dt_s,
            reward: user.reward.clone(),
            observation: user.observation.clone(),
            noise: user.noise.clone(),
            control: user.control,
            reflex: user.reflex.clone(),
            fatigue: user.fatigue.clone(),
            reset: Reset { pose: Pose::NearZero, activation_max: 0.0, ..Reset::default() },
            ..task
        })
    }
}

fn sphere([x, y, z]: [f64; 3], radius: f64) -> Value {
    json!({"kind": "sphere", "at": [x, y, z], "radius": radius})
}

pub(crate) fn circle(pair: [f64; 2]) -> Layout {
    let [distance, width] = pair;
    circle_at(format!("{:.0} mm by {:.0} mm", 1e3 * width, 1e3 * distance), [PLANE_X, 0.0], pair)
}

fn working(height: &str, middle: [f64; 2]) -> Layout {
    circle_at(height.into(), middle, WORK)
}

/// An upright circle about a place so far (m) before and above the shoulder.
fn circle_at(name: String, [before, above]: [f64; 2], [distance, width]: [f64; 2]) -> Layout {
    let targets = circle_targets(distance).map(|[_, y, z]| [before, y, z + above]);
    let target = |selection: usize| format!("target{}", selection % TARGETS + 1);
    let scene: serde_json::Map<String, Value> =
        (0..TARGETS).map(|selection| (target(selection), sphere(targets[selection], 0.5 * width))).collect();
    let order: Vec<String> = (0..SELECTIONS).map(target).collect();
    Layout {
        name,
        scene: Value::Object(scene),
        script: json!([{"dwell": {"in": order, "for_s": DWELL_S}}]),
        time_limit_s: 24.0,
    }
}

fn holding() -> Layout {
    let at = |degrees: f64| {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        sphere([HOLD_AT * sine, 0.0, -HOLD_AT * cosine], 0.05)
    };
    let [low, high] = HOLD_DEG.map(at);
    Layout {
        name: "holding".into(),
        scene: json!({"low": low, "high": high}),
        script: json!([{"dwell": {"in": ["low", "high"], "for_s": HOLD_S}}]),
        time_limit_s: 12.0,
    }
}

/// A key that lies level, 30 cm before and 30 cm below the shoulder, so many places to the left of the middle.
fn key(place: f64) -> Value {
    let ([width, height], [x, y, z]) = (KEY_SIZE, KEYS_AT);
    json!({
        "kind": "button", "at": [x, y + place * KEY_PITCH, z], "size": [width, height, KEY_DEPTH], "min_force_n": KEY_FORCE_N,
    })
}

/// What keys stand on.
fn plate() -> Value {
    let ([x, y, z], [.., depth]) = (KEYS_AT, PLATE_SIZE);
    json!({"kind": "obstacle", "at": [x, y, z - 0.5 * (KEY_DEPTH + depth) - PLATE_BELOW], "size": PLATE_SIZE})
}

fn keys() -> Layout {
    let name = |number: usize| format!("key{}", number + 1);
    let middle = 0.5 * (KEYS - 1) as f64;
    let mut scene: serde_json::Map<String, Value> =
        (0..KEYS).map(|number| (name(number), key(middle - number as f64))).collect();
    scene.insert("plate".into(), plate());
    let names: Vec<String> = (0..KEYS).map(name).collect();
    let round = json!({"random_order": [{"press_and_release": names}]});
    Layout {
        name: "keys".into(),
        scene: Value::Object(scene),
        script: json!([{"repeat": {"times": PRESSES / KEYS, "steps": [round]}}]),
        time_limit_s: 24.0,
    }
}

fn tapping() -> Layout {
    Layout {
        name: "tapping".into(),
        scene: json!({"key": key(0.0), "plate": plate()}),
        script: json!([{"press_and_release": vec!["key"; PRESSES]}]),
        time_limit_s: 12.0,
    }
}

/// A phone that lies level before the body.
fn typing(key: f64) -> Layout {
    let ([x, y, z], pitch) = (KEYS_AT, key + KEY_GAP);
    let phone = json!({"kind": "keyboard", "at": KEYS_AT, "pitch": pitch, "key": key, "min_force_n": 0.5});
    let case = json!({"kind": "obstacle", "at": [x, y, z - CASE_BELOW], "size": [11.0 * pitch, 6.0 * pitch, 0.01]});
    Layout {
        name: format!("keys of {:.0} mm", 1e3 * key),
        scene: json!({"phone": phone, "case": case}),
        script: json!([{"type": TYPED}]),
        time_limit_s: 20.0,
    }
}

/// To come to the sphere, and to keep to it.
fn tracking(up_to_hz: f64) -> Layout {
    let mut ball = sphere(TRACKED_AT, TRACKED_RADIUS);
    ball["moves"] = json!({"kind": "sines", "by": [0.0, TRACKED_BY, TRACKED_BY], "up_to_hz": up_to_hz});
    Layout {
        name: format!("up to {up_to_hz} Hz"),
        scene: json!({"ball": ball}),
        script: json!([
            {"follow": {"target": "ball", "for_s": 0}},
            {"track": {"target": "ball", "for_s": TRACKED_S}},
        ]),
        time_limit_s: 20.0,
    }
}

fn steering(way: &Way) -> Layout {
    let name = format!("{} of {:.0} mm", way.shape, 1e3 * way.width);
    along(name, &way.corners, &(0..way.corners.len()).collect::<Vec<_>>(), way.width)
}

/// From the top of an ellipse that stands upright, to the right, and so on.
fn laps() -> Layout {
    let ([x, y, z], [wide, high]) = (WAY_AT, ELLIPSE);
    let corner = |corner: usize| {
        let (sine, cosine) = (TAU * corner as f64 / LAP_PIECES as f64).sin_cos();
        [x, y - wide * sine, z + high * cosine]
    };
    let corners: Vec<_> = (0..LAP_PIECES).map(corner).collect();
    let through: Vec<usize> = (0..=LAPS * LAP_PIECES).map(|corner| corner % LAP_PIECES).collect();
    along("ellipse".into(), &corners, &through, ELLIPSE_WIDTH)
}

/// To stay at the first of these corners (m), and to go through them in this order.
fn along(name: String, corners: &[[f64; 3]], through: &[usize], width: f64) -> Layout {
    let called = |corner: usize| format!("corner{}", corner + 1);
    // As near to one another as they are.
    let corner = |at| {
        let mut corner = sphere(at, WAY_SPHERE);
        corner["min_distance_from_previous"] = 0.into();
        corner
    };
    let spheres = corners.iter().enumerate().map(|(number, &at)| (called(number), corner(at)));
    let through: Vec<String> = through.iter().map(|&corner| called(corner)).collect();
    Layout {
        name,
        scene: Value::Object(spheres.collect()),
        script: json!([
            {"dwell": {"in": through[0], "for_s": DWELL_S}},
            {"steer": {"through": through, "width": width}},
        ]),
        time_limit_s: 15.0,
    }
}

/// Spheres on an upright circle, of which those that may light up are named as often as makes eight: layouts of one structure.
fn choosing(choices: usize) -> Layout {
    let [x, y, z] = WAY_AT;
    let lamp = |number: usize| format!("lamp{}", number + 1);
    let at = |number: usize| {
        let (sine, cosine) = (TAU * number as f64 / LAMPS as f64).sin_cos();
        [x, y - LAMPS_OFF * sine, z + LAMPS_OFF * cosine]
    };
    let mut scene: serde_json::Map<String, Value> =
        (0..LAMPS).map(|number| (lamp(number), sphere(at(number), LAMP_RADIUS))).collect();
    scene.insert("middle".into(), sphere(WAY_AT, LAMP_RADIUS));
    let among: Vec<String> = (0..LAMPS).map(|k| lamp(k % choices * (LAMPS / choices))).collect();
    Layout {
        name: format!("one of {choices}"),
        scene: Value::Object(scene),
        script: json!([{"repeat": {"times": REACTIONS, "steps": [
            {"dwell": {"in": "middle", "for_s": DWELL_S}},
            {"react": {"among": among, "after_s": LIT_AFTER_S, "for_s": DWELL_S}},
        ]}}]),
        time_limit_s: 24.0,
    }
}

/// A circle of targets on the face of a wall, as far apart and as wide as these angles (degrees) as seen from the shoulder.
fn on_a_wall([distance, width]: [f64; 2]) -> Layout {
    let face = WALL_X - 0.5 * WALL_SIZE[2];
    // Of all directions from the shoulder that are so far off straight ahead, those that come after each other are `distance` apart.
    let turn = TAU * ACROSS as f64 / TARGETS as f64;
    let off = ((0.5 * distance.to_radians()).sin() / (0.5 * turn).sin()).asin();
    let (radius, size) = (face * off.tan(), face / off.cos() * (0.5 * width.to_radians()).tan());
    let name = |number: usize| format!("target{}", number % TARGETS + 1);
    let at = |number: usize| {
        let (sine, cosine) = (turn * number as f64).sin_cos();
        json!({"kind": "sphere", "at": [face, -radius * sine, radius * cosine], "radius": size, "min_distance_from_previous": 0})
    };
    let mut scene: serde_json::Map<String, Value> = (0..TARGETS).map(|number| (name(number), at(number))).collect();
    scene.insert("wall".into(), json!({"kind": "obstacle", "at": [WALL_X, 0, 0], "tilt_deg": 90, "size": WALL_SIZE}));
    let order: Vec<String> = (0..SELECTIONS).map(name).collect();
    Layout {
        name: format!("{distance} by {width} degrees"),
        scene: Value::Object(scene),
        script: json!([{"dwell": {"in": order, "for_s": RAY_DWELL_S}}]),
        time_limit_s: 30.0,
    }
}

/// From near the body to something straight ahead and back.
fn far(distance: f64) -> Layout {
    let mut thing = sphere([distance, 0.0, 0.0], FAR_RADIUS);
    thing["min_distance_from_previous"] = json!(0);
    Layout {
        name: format!("{distance} m"),
        scene: json!({"near": sphere(FAR_FROM, 0.05), "thing": thing}),
        script: json!([{"repeat": {"times": FAR_REACHES, "steps": [{"dwell": {"in": ["near", "thing"], "for_s": DWELL_S}}]}}]),
        time_limit_s: 24.0,
    }
}
