//! Whether a ray meets the volume of a site.

use crate::spatial::Vec3;
use myo_model::description::Shape;

/// Directions are those of rays as far as they are longer than this.
const TINY: f64 = 1e-15;

/// Whether a ray from a point, along a direction of length one, meets a shape, all in the axes of the shape and from its middle. Rays from within do. All shapes
/// here are convex, so that a ray is inside for one stretch.
pub(super) fn is_met(shape: Shape, from: Vec3<f64>, along: Vec3<f64>) -> bool {
    let stretch = match shape {
        Shape::Sphere { radius } => ball(from, along, radius),
        Shape::Ellipsoid { radii } => {
            let scaled = |v: Vec3<f64>| Vec3::new(v.x / radii[0], v.y / radii[1], v.z / radii[2]);
            ball(scaled(from), scaled(along), 1.0)
        }
        Shape::Box { half_size } => {
            let [x, y, z] = half_size;
            let sides = [(from.x, along.x, x), (from.y, along.y, y), (from.z, along.z, z)];
            sides.into_iter().map(|(from, along, half)| slab(from, along, half)).reduce(common).flatten()
        }
        Shape::Cylinder { radius, half_length } => {
            common(tube(from, along, radius), slab(from.z, along.z, half_length))
        }
        Shape::Capsule { radius, half_length } => {
            let tube = common(tube(from, along, radius), slab(from.z, along.z, half_length));
            let end = |z: f64| ball(from - Vec3::new(0.0, 0.0, z), along, radius);
            return [tube, end(half_length), end(-half_length)].into_iter().any(is_ahead);
        }
        Shape::Plane | Shape::Mesh { .. } => None,
    };
    is_ahead(stretch)
}

/// From where to where a ray is inside of something, in lengths of its direction; nothing of one that misses it.
type Stretch = Option<[f64; 2]>;

fn is_ahead(stretch: Stretch) -> bool {
    stretch.is_some_and(|[_, end]| end >= 0.0)
}

fn common(one: Stretch, other: Stretch) -> Stretch {
    let ([a, b], [c, d]) = (one?, other?);
    let both = [a.max(c), b.min(d)];
    (both[0] <= both[1]).then_some(both)
}

/// Within a distance of the middle along one axis.
fn slab(from: f64, along: f64, half: f64) -> Stretch {
    if along.abs() < TINY {
        return (from.abs() <= half).then_some([f64::NEG_INFINITY, f64::INFINITY]);
    }
    let ends = [(-half - from) / along, (half - from) / along];
    Some([ends[0].min(ends[1]), ends[0].max(ends[1])])
}

fn ball(from: Vec3<f64>, along: Vec3<f64>, radius: f64) -> Stretch {
    roots(along.dot(along), along.dot(from), from.dot(from) - radius * radius)
}

/// A cylinder about the z axis without ends.
fn tube(from: Vec3<f64>, along: Vec3<f64>, radius: f64) -> Stretch {
    let flat = |v: Vec3<f64>| Vec3::new(v.x, v.y, 0.0);
    let (from, along) = (flat(from), flat(along));
    if along.dot(along) < TINY {
        return (from.dot(from) <= radius * radius).then_some([f64::NEG_INFINITY, f64::INFINITY]);
    }
    ball(from, along, radius)
}

/// Where `a x^2 + 2 b x + c` is not positive.
fn roots(a: f64, b: f64, c: f64) -> Stretch {
    let root = b.mul_add(b, -a * c);
    (root >= 0.0 && a >= TINY).then(|| [(-b - root.sqrt()) / a, (-b + root.sqrt()) / a])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_meet_what_is_ahead_of_them_and_around_them() {
        let shapes = [
            Shape::Sphere { radius: 0.1 },
            Shape::Capsule { radius: 0.1, half_length: 0.1 },
            Shape::Ellipsoid { radii: [0.1, 0.2, 0.3] },
            Shape::Cylinder { radius: 0.1, half_length: 0.1 },
            Shape::Box { half_size: [0.1, 0.2, 0.3] },
        ];
        let met =
            |shape, [x, y, z]: [f64; 3], [u, v, w]: [f64; 3]| is_met(shape, Vec3::new(x, y, z), Vec3::new(u, v, w));
        for shape in shapes {
            for away in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.6, 0.0, -0.8]] {
                let (there, back) = (away, away.map(|x| -x));
                assert!(met(shape, away.map(|x| 0.01 * x), there), "{shape:?} from within");
                assert!(met(shape, there, back), "{shape:?} from afar");
                assert!(!met(shape, there, there), "{shape:?} behind");
                assert!(!met(shape, [1.0, 1.0, 1.0], there), "{shape:?} beside");
            }
        }
        // Round ends reach farther than flat ones.
        let over = [0.0, 0.15, 0.15];
        assert!(met(Shape::Capsule { radius: 0.1, half_length: 0.1 }, over, [0.0, -1.0, 0.0]));
        assert!(!met(Shape::Cylinder { radius: 0.1, half_length: 0.1 }, over, [0.0, -1.0, 0.0]));
    }
}
