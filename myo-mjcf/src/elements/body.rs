//! Bodies and what gives them mass, sight and light.

use super::{Geom, Joint, Site};
use crate::pose::Pose;
use crate::reading::{ToBody, ToTexture};
use crate::table::table;
use crate::value::{Auto, keywords};

keywords! {
    /// Whether a body may sleep when nothing moves it.
    pub enum Sleep {
        /// MuJoCo decides.
        Auto = "auto",
        /// Never.
        Never = "never",
        /// It may.
        Allowed = "allowed",
        /// It sleeps at the start.
        Init = "init",
    }

    /// A choice that is off or left to MuJoCo.
    pub enum FalseAuto {
        /// No.
        No = "false",
        /// MuJoCo decides.
        Auto = "auto",
    }

    /// How a camera or a light follows bodies.
    pub enum Tracking {
        /// It is fixed to its body.
        Fixed = "fixed",
        /// It keeps its offset from the body in the world, and its orientation.
        Track = "track",
        /// As `track`, from the centre of mass of the body's subtree.
        TrackCom = "trackcom",
        /// It is fixed to its body and turns to the target.
        TargetBody = "targetbody",
        /// As `targetbody`, to the centre of mass of the target's subtree.
        TargetBodyCom = "targetbodycom",
    }

    /// How a camera projects.
    pub enum Projection {
        /// Perspective.
        Perspective = "perspective",
        /// Orthographic.
        Orthographic = "orthographic",
    }

    /// Kinds of lights.
    pub enum LightKind {
        /// A cone.
        Spot = "spot",
        /// Parallel rays.
        Directional = "directional",
        /// In all directions.
        Point = "point",
        /// From a picture of the surroundings.
        Image = "image",
    }
}

table! {
    /// A body, in [`Mjcf::bodies`](crate::Mjcf::bodies). The first one is the world.
    pub struct Body {
        own {
            /// Its name; the world's is `world`.
            name: String;
            /// The default class of what stands in it.
            childclass: String;
            /// Whether a user moves it (only children of the world without joints).
            mocap: bool = false;
            /// Part of its weight that is compensated.
            gravcomp: f64 = 0.0;
            /// Whether it may sleep.
            sleep: Sleep = Sleep::Auto;
            /// Whether MuJoCo may use its simpler inertia.
            simple: FalseAuto = FalseAuto::Auto;
            /// Whether MuJoCo may fuse it with its parent.
            fuse: FalseAuto = FalseAuto::Auto;
            /// Numbers of the user.
            user: Vec<f64>;
        }
        with {
            /// Where it is in its parent.
            pose: Pose;
        }
        plus {
            /// The index of its parent, which stands before it; the world is its own parent.
            parent: usize;
            /// Its mass, where the file gives it.
            inertial: Option<Inertial>;
            /// Its joints, in the order in which they move it.
            joints: Vec<Joint>;
            /// Its shapes.
            geoms: Vec<Geom>;
            /// Its sites.
            sites: Vec<Site>;
            /// Its cameras.
            cameras: Vec<Camera>;
            /// Its lights.
            lights: Vec<Light>;
        }
    }
}

table! {
    /// Mass and inertia of a body.
    pub struct Inertial {
        required {
            /// Its mass (kg).
            mass: f64;
        }
        own {
            /// Moments of inertia about the axes of its pose (kg m^2).
            diaginertia: [f64; 3] = [0.0; 3];
            /// Full inertia in the body's axes (kg m^2): xx, yy, zz, xy, xz, yz. Not turned by frames.
            fullinertia: [f64; 6];
        }
        with {
            /// The centre of mass, and the axes of `diaginertia`.
            pose: Pose;
        }
    }
}

table! {
    /// A camera.
    pub struct Camera {
        own {
            /// Its name.
            name: String;
            /// The default class.
            class: String;
            /// The name of the body it looks at.
            target: String as ToBody;
        }
        classed {
            /// How it projects.
            projection: Projection = Projection::Perspective;
            /// Whether it is orthographic (before MuJoCo 3.5).
            orthographic: bool = false;
            /// Vertical field of view (degrees, whatever the compiler says; length if orthographic).
            fovy: f64 = 45.0;
            /// Distance between the eyes (m).
            ipd: f64 = 0.068;
            /// Pixels: width, height.
            resolution: [i32; 2] = [1, 1];
            /// What it renders, as words.
            output: String;
            /// How it follows bodies.
            mode: Tracking = Tracking::Fixed;
            /// Focal lengths (m).
            focal: [f64; 2];
            /// Focal lengths (pixels).
            focalpixel: [f64; 2];
            /// Offset of the principal point (m).
            principal: [f64; 2];
            /// Offset of the principal point (pixels).
            principalpixel: [f64; 2];
            /// Size of the sensor (m).
            sensorsize: [f64; 2];
            /// Numbers of the user.
            user: Vec<f64>;
        }
        with {
            /// Where it is in its body; it looks along -z.
            pose: Pose;
        }
    }
}

table! {
    /// A light.
    pub struct Light {
        own {
            /// Its name.
            name: String;
            /// The default class.
            class: String;
            /// The name of the body it points at.
            target: String as ToBody;
            /// The name of the texture of an image light.
            texture: String as ToTexture;
        }
        classed {
            /// Whether its rays are parallel (the older way to say it).
            directional: bool;
            /// What it is.
            kind "type": LightKind = LightKind::Spot;
            /// Whether it casts shadows.
            castshadow: bool = true;
            /// Whether it is on.
            active: bool = true;
            /// Where it is in its body (m).
            pos: [f64; 3] = [0.0; 3];
            /// Where it shines.
            dir: [f64; 3] = [0.0, 0.0, -1.0];
            /// Radius of the bulb (m).
            bulbradius: f64 = 0.02;
            /// Intensity (candela).
            intensity: f64 = 0.0;
            /// How far it reaches (m).
            range: f64 = 10.0;
            /// Attenuation: constant, linear, quadratic.
            attenuation: [f64; 3] = [1.0, 0.0, 0.0];
            /// Half angle of a spot (degrees).
            cutoff: f64 = 45.0;
            /// Softness of a spot's edge.
            softness: f64 = 0.2;
            /// Falloff of a spot.
            exponent: f64 = 10.0;
            /// Ambient colour.
            ambient: [f64; 3] = [0.0; 3];
            /// Diffuse colour.
            diffuse: [f64; 3] = [0.7; 3];
            /// Specular colour.
            specular: [f64; 3] = [0.3; 3];
            /// How it follows bodies.
            mode: Tracking = Tracking::Fixed;
        }
    }
}

table! {
    /// What a `freejoint` may say.
    pub(crate) struct FreeJoint {
        own {
            /// Its name.
            name: String;
            /// A group, for what is seen.
            group: i32;
            /// Whether MuJoCo aligns the body's axes with its inertia.
            align: Auto;
        }
    }
}

table! {
    /// What a `frame` may say beside its pose.
    pub(crate) struct FrameNames {
        own {
            /// Its name.
            name: String;
            /// The default class of what stands in it.
            childclass: String;
        }
    }
}

table! {
    /// What a `replicate` may say.
    pub(crate) struct Replicate {
        required {
            /// How many copies.
            count: i32;
        }
        own {
            /// From one copy to the next (m).
            offset: [f64; 3];
            /// Turn from one copy to the next, in the compiler's angles.
            euler: [f64; 3];
            /// Stands between name and number.
            sep: String;
            /// The default class of what stands in it.
            childclass: String;
        }
    }
}

table! {
    /// What an `attach` may say.
    pub(crate) struct Attach {
        required {
            /// Stands before names.
            prefix: String;
        }
        own {
            /// The name of the model.
            model: String;
            /// The body of it that is wanted.
            body: String;
            /// The frame of it that is wanted.
            frame: String;
        }
    }
}
