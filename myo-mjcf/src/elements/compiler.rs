//! How files are read, and what MuJoCo computes when it compiles them.

use crate::table::table;
use crate::value::{Auto, Fault, Value, keywords};

keywords! {
    /// The unit of angles in a file.
    pub enum AngleUnit {
        /// rad.
        Radian = "radian",
        /// Degrees.
        Degree = "degree",
    }

    /// Coordinates of a file; `global` is refused.
    pub enum Coordinates {
        /// In the parent.
        Local = "local",
        /// In the world, which MuJoCo has not read since 2.3.4.
        Global = "global",
    }

    /// What MuJoCo does when a model and one that it attaches disagree.
    pub enum Conflict {
        /// It warns.
        Warning = "warning",
        /// It merges them.
        Merge = "merge",
        /// It gives up.
        Error = "error",
    }

    /// Which actuators get a computed length range.
    pub enum LengthRangeMode {
        /// None.
        None = "none",
        /// Muscles.
        Muscle = "muscle",
        /// Muscles and those of the user.
        MuscleUser = "muscleuser",
        /// All.
        All = "all",
    }
}

/// The order of three turns: axes that turn with the body in lower case, fixed ones in upper case.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EulerSequence(pub [char; 3]);

impl Value for EulerSequence {
    fn read(text: &str) -> Result<Self, Fault> {
        let axes: Vec<char> = text.chars().filter(|axis| "xyzXYZ".contains(*axis)).collect();
        match axes[..] {
            [first, second, third] if text.len() == 3 => Ok(Self([first, second, third])),
            _ => Err(Fault::keyword(text, &["xyz", "XYZ", "zyx", "ZYX"])),
        }
    }

    fn write(&self) -> String {
        self.0.iter().collect()
    }
}

table! {
    /// How a file is read. Of several `compiler` elements the last one to say something wins, for the whole file.
    pub struct Compiler {
        own {
            /// Whether a range alone makes a limit.
            autolimits: bool = true;
            /// Least mass of a body (kg).
            boundmass: f64 = 0.0;
            /// Least moment of inertia of a body (kg m^2).
            boundinertia: f64 = 0.0;
            /// Mass of the whole model (kg), to which bodies are scaled; negative is as it is.
            settotalmass: f64 = -1.0;
            /// Whether impossible moments of inertia become their mean.
            balanceinertia: bool = false;
            /// Whether files are looked for by their name alone.
            strippath: bool = false;
            /// Coordinates.
            coordinate: Coordinates = Coordinates::Local;
            /// The unit of angles in the file.
            angle: AngleUnit = AngleUnit::Degree;
            /// Whether shapes are fitted to the bounding box of a mesh, not its inertia.
            fitaabb: bool = false;
            /// The order of Euler angles.
            eulerseq: EulerSequence = EulerSequence(['x', 'y', 'z']);
            /// The folder of meshes and height fields.
            meshdir: String;
            /// The folder of textures.
            texturedir: String;
            /// The folder of both.
            assetdir: String;
            /// Whether shapes that touch nothing are left out.
            discardvisual: bool = false;
            /// Whether MuJoCo compiles in several threads.
            usethread: bool = true;
            /// Whether bodies without joints are fused with their parents.
            fusestatic: bool = false;
            /// Whether mass comes from geoms.
            inertiafromgeom: Auto = Auto::Auto;
            /// Groups of geoms that count for mass: first, last.
            inertiagrouprange: [i32; 2] = [0, 5];
            /// Whether MuJoCo saves computed inertia.
            saveinertial: bool = false;
            /// Whether bodies with a free joint are aligned with their inertia.
            alignfree: bool = false;
            /// What happens when attached models disagree.
            conflict: Conflict = Conflict::Warning;
            /// What MuJoCo saves by reference, as words.
            passthrough: String;
            /// Whether MuJoCo saves compiled values.
            savecompiled: bool = false;
            /// Whether MuJoCo saves quaternions and rad.
            savecanonical: bool = false;
            /// Whether meshes get convex hulls (before MuJoCo 3.2.4).
            convexhull: bool = true;
            /// Whether inertia of meshes is exact (before MuJoCo 3.2.4).
            exactmeshinertia: bool = false;
        }
    }
}

impl Compiler {
    /// The folder of meshes and height fields, below that of the main file.
    pub fn mesh_folder(&self) -> &str {
        self.meshdir.as_deref().or(self.assetdir.as_deref()).unwrap_or_default()
    }

    /// The folder of textures, below that of the main file.
    pub fn texture_folder(&self) -> &str {
        self.texturedir.as_deref().or(self.assetdir.as_deref()).unwrap_or_default()
    }

    /// An angle of the file in rad.
    pub fn radians(&self, angle: f64) -> f64 {
        match self.angle() {
            AngleUnit::Radian => angle,
            // In this order MuJoCo gets the same bits.
            AngleUnit::Degree => angle / 180.0 * std::f64::consts::PI,
        }
    }
}

table! {
    /// How length ranges of actuators are computed.
    pub struct LengthRange {
        own {
            /// Of which actuators.
            mode: LengthRangeMode = LengthRangeMode::Muscle;
            /// Whether one that the file gives stays.
            useexisting: bool = true;
            /// Whether joint and tendon limits are taken for it.
            uselimit: bool = false;
            /// Acceleration by which actuators are pulled.
            accel: f64 = 20.0;
            /// Greatest force (N), 0 is any.
            maxforce: f64 = 0.0;
            /// Time constant of velocity reduction (s).
            timeconst: f64 = 1.0;
            /// Time step (s).
            timestep: f64 = 0.01;
            /// Time of simulation (s).
            inttotal: f64 = 10.0;
            /// Time at the end over which the range is taken (s).
            interval: f64 = 2.0;
            /// Greatest change of length in that time, relative to the range.
            tolrange: f64 = 0.05;
        }
    }
}
