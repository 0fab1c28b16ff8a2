//! Three-dimensional and spatial algebra over [`Scalar`].
//!
//! Spatial quantities (Featherstone 2008, doi 10.1007/978-1-4899-7560-7) are expressed in world axes about one fixed
//! point O for the whole model, so they can be added without transformations.

use myo_scalar::Scalar;
use std::ops::{Add, AddAssign, Neg, Sub, SubAssign};

/// Square of a length, or of an angle (rad^2), below which there is none.
const NONE: f64 = 1e-30;

/// A vector.
#[derive(Clone, Copy, Debug)]
pub struct Vec3<S> {
    /// First component.
    pub x: S,
    /// Second component.
    pub y: S,
    /// Third component.
    pub z: S,
}

impl<S: Scalar> Vec3<S> {
    /// From components.
    #[inline(always)]
    pub fn new(x: S, y: S, z: S) -> Self {
        Self { x, y, z }
    }
    /// The zero vector.
    #[inline(always)]
    pub fn zero() -> Self {
        Self::new(S::zero(), S::zero(), S::zero())
    }
    /// The same constant in every lane.
    #[inline(always)]
    pub fn splat(c: [S::Const; 3]) -> Self {
        Self::new(S::splat(c[0]), S::splat(c[1]), S::splat(c[2]))
    }
    /// Times a number.
    #[inline(always)]
    pub fn scale(self, s: S) -> Self {
        Self::new(self.x * s, self.y * s, self.z * s)
    }
    /// `self * s + b`.
    #[inline(always)]
    pub fn mul_add(self, s: S, b: Self) -> Self {
        Self::new(self.x.mul_add(s, b.x), self.y.mul_add(s, b.y), self.z.mul_add(s, b.z))
    }
    /// Scalar product.
    #[inline(always)]
    pub fn dot(self, b: Self) -> S {
        self.x.mul_add(b.x, self.y.mul_add(b.y, self.z * b.z))
    }
    /// Vector product.
    #[inline(always)]
    pub fn cross(self, b: Self) -> Self {
        Self::new(
            self.y.mul_add(b.z, -(self.z * b.y)),
            self.z.mul_add(b.x, -(self.x * b.z)),
            self.x.mul_add(b.y, -(self.y * b.x)),
        )
    }
    /// The same direction at length one; of what is shorter than 1e-15 none that can be trusted.
    #[inline(always)]
    pub fn unit(self) -> Self {
        self.scale(self.dot(self).max(S::lit(NONE)).rsqrt())
    }
    /// `a` where the mask is true, else `b`.
    #[inline(always)]
    pub fn select(mask: S::Mask, a: Self, b: Self) -> Self {
        Self::new(S::select(mask, a.x, b.x), S::select(mask, a.y, b.y), S::select(mask, a.z, b.z))
    }
    /// Components as an array.
    #[inline(always)]
    pub fn array(self) -> [S; 3] {
        [self.x, self.y, self.z]
    }
}

impl<S: Scalar> Add for Vec3<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        Self::new(self.x + b.x, self.y + b.y, self.z + b.z)
    }
}
impl<S: Scalar> Sub for Vec3<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        Self::new(self.x - b.x, self.y - b.y, self.z - b.z)
    }
}
impl<S: Scalar> Neg for Vec3<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.x, -self.y, -self.z)
    }
}

/// A rotation by its columns: the axes of the rotated frame.
#[derive(Clone, Copy, Debug)]
pub struct Rotation<S> {
    /// Image of the x axis.
    pub x: Vec3<S>,
    /// Image of the y axis.
    pub y: Vec3<S>,
    /// Image of the z axis.
    pub z: Vec3<S>,
}

impl<S: Scalar> Rotation<S> {
    /// No rotation.
    #[inline(always)]
    pub fn identity() -> Self {
        let (o, i) = (S::zero(), S::lit(1.0));
        Self { x: Vec3::new(i, o, o), y: Vec3::new(o, i, o), z: Vec3::new(o, o, i) }
    }
    /// Rotates a vector.
    #[inline(always)]
    pub fn apply(&self, v: Vec3<S>) -> Vec3<S> {
        self.x.mul_add(v.x, self.y.mul_add(v.y, self.z.scale(v.z)))
    }
    /// Rotates a vector back.
    #[inline(always)]
    pub fn apply_inverse(&self, v: Vec3<S>) -> Vec3<S> {
        Vec3::new(self.x.dot(v), self.y.dot(v), self.z.dot(v))
    }
    /// Product with a constant rotation given by columns.
    #[inline(always)]
    pub fn times(&self, c: &[[S::Const; 3]; 3]) -> Self {
        Self { x: self.apply(Vec3::splat(c[0])), y: self.apply(Vec3::splat(c[1])), z: self.apply(Vec3::splat(c[2])) }
    }
    /// This one after another one.
    #[inline(always)]
    pub fn after(&self, other: &Self) -> Self {
        Self { x: self.apply(other.x), y: self.apply(other.y), z: self.apply(other.z) }
    }
    /// Of a quaternion (w, x, y, z) of any length but none.
    #[inline(always)]
    pub fn of_quaternion(quaternion: [S; 4]) -> Self {
        let [w, x, y, z] = unit_quaternion(quaternion);
        let (one, two) = (S::lit(1.0), S::lit(2.0));
        let (xx, yy, zz) = (x * x, y * y, z * z);
        let (xy, xz, yz, wx, wy, wz) = (x * y, x * z, y * z, w * x, w * y, w * z);
        Self {
            x: Vec3::new(one - two * (yy + zz), two * (xy + wz), two * (xz - wy)),
            y: Vec3::new(two * (xy - wz), one - two * (xx + zz), two * (yz + wx)),
            z: Vec3::new(two * (xz + wy), two * (yz - wx), one - two * (xx + yy)),
        }
    }
    /// Product with a rotation about the own z axis.
    #[inline(always)]
    pub fn times_about_z(&self, sin: S, cos: S) -> Self {
        Self { x: self.x.mul_add(cos, self.y.scale(sin)), y: self.y.mul_add(cos, self.x.scale(-sin)), z: self.z }
    }
}

/// The quaternion that turns axes `from` into axes `to`, in axes `from`: its scalar part, not negative, and its vector. Of the four
/// numbers the greatest is found first, by which the others are divided (Shepperd 1978, doi 10.2514/3.55767b).
#[inline(always)]
pub fn quaternion_between<S: Scalar>(from: [Vec3<S>; 3], to: [Vec3<S>; 3]) -> (S, Vec3<S>) {
    // Of the matrix that turns: what its columns, the axes that are turned, are along those before.
    let entry = |row: usize, column: usize| from[row].dot(to[column]);
    let (xx, yy, zz) = (entry(0, 0), entry(1, 1), entry(2, 2));
    let of_axes = [(2, 1), (0, 2), (1, 0)].map(|(a, b)| entry(a, b) - entry(b, a));
    let sums = [(0, 1), (0, 2), (1, 2)].map(|(a, b)| entry(a, b) + entry(b, a));
    let [wx, wy, wz] = of_axes;
    let [xy, xz, yz] = sums;
    let one = S::lit(1.0);
    // Four times the square of each number, and four times its products with all.
    let mut best = one + xx + yy + zz;
    let mut products = [best, wx, wy, wz];
    let others = [
        (one + xx - yy - zz, [wx, one + xx - yy - zz, xy, xz]),
        (one - xx + yy - zz, [wy, xy, one - xx + yy - zz, yz]),
        (one - xx - yy + zz, [wz, xz, yz, one - xx - yy + zz]),
    ];
    for (square, row) in others {
        let is_greater = best.lt(square);
        best = S::select(is_greater, square, best);
        products = std::array::from_fn(|k| S::select(is_greater, row[k], products[k]));
    }
    let sign = S::select(products[0].lt(S::zero()), -one, one);
    let [w, x, y, z] = products.map(|product| product * sign * best.rsqrt() * S::lit(0.5));
    (w, Vec3::new(x, y, z))
}

/// A quaternion of length one.
#[inline(always)]
fn unit_quaternion<S: Scalar>(q: [S; 4]) -> [S; 4] {
    let square = q[0].mul_add(q[0], q[1].mul_add(q[1], q[2].mul_add(q[2], q[3] * q[3])));
    let inverse = square.max(S::lit(NONE)).rsqrt();
    q.map(|part| part * inverse)
}

/// An orientation (w, x, y, z) after it has turned with a velocity (rad/s, in its own axes) for a time (s).
#[inline(always)]
pub fn turned_on<S: Scalar>(quaternion: [S; 4], velocity: Vec3<S>, time: S) -> [S; 4] {
    let square = velocity.dot(velocity).max(S::lit(NONE));
    let inverse = square.rsqrt();
    let (sin, cos) = (square * inverse * time * S::lit(0.5)).sin_cos();
    let [w, x, y, z] = unit_quaternion(quaternion);
    let turn = velocity.scale(sin * inverse);
    let vector = Vec3::new(x, y, z);
    let Vec3 { x, y, z } = turn.scale(w) + vector.scale(cos) + vector.cross(turn);
    [w * cos - vector.dot(turn), x, y, z]
}

/// A frame: axes and origin (m, from O).
#[derive(Clone, Copy, Debug)]
pub struct Frame<S> {
    /// Axes.
    pub rotation: Rotation<S>,
    /// Origin.
    pub position: Vec3<S>,
}

impl<S: Scalar> Frame<S> {
    /// Position in this frame (m) of a point given from O.
    #[inline(always)]
    pub fn seen(&self, place: Vec3<S>) -> Vec3<S> {
        self.rotation.apply_inverse(place - self.position)
    }
    /// Position of a point given in this frame (m, from O).
    #[inline(always)]
    pub fn place(&self, local: Vec3<S>) -> Vec3<S> {
        let Rotation { x, y, z } = self.rotation;
        x.mul_add(local.x, y.mul_add(local.y, z.mul_add(local.z, self.position)))
    }
}

/// A spatial motion: angular part, and linear part of the point that passes through O.
#[derive(Clone, Copy, Debug)]
pub struct Motion<S> {
    /// Angular part.
    pub ang: Vec3<S>,
    /// Linear part at O.
    pub lin: Vec3<S>,
}

/// A spatial force: moment about O, and force.
#[derive(Clone, Copy, Debug)]
pub struct Wrench<S> {
    /// Moment about O.
    pub ang: Vec3<S>,
    /// Force.
    pub lin: Vec3<S>,
}

impl<S: Scalar> Motion<S> {
    /// No motion.
    #[inline(always)]
    pub fn zero() -> Self {
        Self { ang: Vec3::zero(), lin: Vec3::zero() }
    }
    /// `self * s + b`.
    #[inline(always)]
    pub fn mul_add(self, s: S, b: Self) -> Self {
        Self { ang: self.ang.mul_add(s, b.ang), lin: self.lin.mul_add(s, b.lin) }
    }
    /// Times a number.
    #[inline(always)]
    pub fn scale(self, s: S) -> Self {
        Self { ang: self.ang.scale(s), lin: self.lin.scale(s) }
    }
    /// Power of a wrench under this motion.
    #[inline(always)]
    pub fn dot(self, w: Wrench<S>) -> S {
        self.ang.dot(w.ang) + self.lin.dot(w.lin)
    }
    /// Rate of change of a motion `m` that is carried along: `self x m`.
    #[inline(always)]
    pub fn cross(self, m: Self) -> Self {
        Self { ang: self.ang.cross(m.ang), lin: self.ang.cross(m.lin) + self.lin.cross(m.ang) }
    }
    /// Velocity of the point at `p` (from O).
    #[inline(always)]
    pub fn at(self, p: Vec3<S>) -> Vec3<S> {
        self.lin + self.ang.cross(p)
    }
}
impl<S: Scalar> Sub for Motion<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        Self { ang: self.ang - b.ang, lin: self.lin - b.lin }
    }
}
impl<S: Scalar> Add for Motion<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        Self { ang: self.ang + b.ang, lin: self.lin + b.lin }
    }
}

impl<S: Scalar> Wrench<S> {
    /// No force.
    #[inline(always)]
    pub fn zero() -> Self {
        Self { ang: Vec3::zero(), lin: Vec3::zero() }
    }
    /// A force at a point (from O).
    #[inline(always)]
    pub fn at(p: Vec3<S>, force: Vec3<S>) -> Self {
        Self { ang: p.cross(force), lin: force }
    }
    /// `self * s + b`.
    #[inline(always)]
    pub fn mul_add(self, s: S, b: Self) -> Self {
        Self { ang: self.ang.mul_add(s, b.ang), lin: self.lin.mul_add(s, b.lin) }
    }
}
impl<S: Scalar> Add for Wrench<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        Self { ang: self.ang + b.ang, lin: self.lin + b.lin }
    }
}
impl<S: Scalar> Sub for Wrench<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        Self { ang: self.ang - b.ang, lin: self.lin - b.lin }
    }
}
impl<S: Scalar> AddAssign for Wrench<S> {
    #[inline(always)]
    fn add_assign(&mut self, b: Self) {
        *self = *self + b;
    }
}
impl<S: Scalar> SubAssign for Wrench<S> {
    #[inline(always)]
    fn sub_assign(&mut self, b: Self) {
        *self = *self - b;
    }
}

/// A symmetric 3 x 3 matrix.
#[derive(Clone, Copy, Debug)]
pub struct Symmetric<S> {
    /// Diagonal: xx, yy, zz.
    pub diagonal: Vec3<S>,
    /// Beside the diagonal: yz, xz, xy.
    pub off: Vec3<S>,
}

impl<S: Scalar> Symmetric<S> {
    /// Times a vector.
    #[inline(always)]
    pub fn apply(&self, v: Vec3<S>) -> Vec3<S> {
        let (d, o) = (self.diagonal, self.off);
        Vec3::new(
            d.x.mul_add(v.x, o.z.mul_add(v.y, o.y * v.z)),
            o.z.mul_add(v.x, d.y.mul_add(v.y, o.x * v.z)),
            o.y.mul_add(v.x, o.x.mul_add(v.y, d.z * v.z)),
        )
    }
    /// The same about every axis.
    #[inline(always)]
    pub fn isotropic(x: S) -> Self {
        Self { diagonal: Vec3::new(x, x, x), off: Vec3::zero() }
    }
    /// `self + a a^T`.
    #[inline(always)]
    pub fn plus_square(&self, a: Vec3<S>) -> Self {
        let (d, o) = (self.diagonal, self.off);
        Self {
            diagonal: Vec3::new(a.x.mul_add(a.x, d.x), a.y.mul_add(a.y, d.y), a.z.mul_add(a.z, d.z)),
            off: Vec3::new(a.y.mul_add(a.z, o.x), a.x.mul_add(a.z, o.y), a.x.mul_add(a.y, o.z)),
        }
    }
}

/// Spatial inertia about O: mass, first moment of mass, second moment.
#[derive(Clone, Copy, Debug)]
pub struct Inertia<S> {
    /// Mass (kg).
    pub mass: S,
    /// Mass times centre of mass (kg m).
    pub first: Vec3<S>,
    /// Rotational inertia about O (kg m^2).
    pub second: Symmetric<S>,
}

impl<S: Scalar> Inertia<S> {
    /// Of nothing.
    #[inline(always)]
    pub fn zero() -> Self {
        Self { mass: S::zero(), first: Vec3::zero(), second: Symmetric::isotropic(S::zero()) }
    }
    /// Of a body with centre of mass `c` (from O) and inertia `about_com` in world axes.
    #[inline(always)]
    pub fn new(mass: S, c: Vec3<S>, about_com: Symmetric<S>) -> Self {
        let first = c.scale(mass);
        // Parallel axes: I + m (c.c 1 - c c^T)
        let square = Vec3::new(first.x * c.x, first.y * c.y, first.z * c.z);
        let (d, o) = (about_com.diagonal, about_com.off);
        Self {
            mass,
            first,
            second: Symmetric {
                diagonal: Vec3::new(d.x + square.y + square.z, d.y + square.x + square.z, d.z + square.x + square.y),
                off: Vec3::new(
                    (-first.y).mul_add(c.z, o.x),
                    (-first.x).mul_add(c.z, o.y),
                    (-first.x).mul_add(c.y, o.z),
                ),
            },
        }
    }
    /// The wrench that gives this body a spatial acceleration: `I m`.
    #[inline(always)]
    pub fn apply(&self, m: Motion<S>) -> Wrench<S> {
        Wrench {
            ang: self.second.apply(m.ang) + self.first.cross(m.lin),
            lin: m.lin.scale(self.mass) - self.first.cross(m.ang),
        }
    }
}
impl<S: Scalar> Add for Inertia<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        Self {
            mass: self.mass + b.mass,
            first: self.first + b.first,
            second: Symmetric {
                diagonal: self.second.diagonal + b.second.diagonal,
                off: self.second.off + b.second.off,
            },
        }
    }
}
