//! Where repeats of one movement stop: size, shape and direction of the cloud.

use nalgebra::{Matrix3, SymmetricEigen, Vector3};

use crate::{Point, Result, check, point};

/// Fewest stops: three span a plane at most.
const LEAST_STOPS: usize = 4;
/// A cloud whose two longest axes differ by less than this share is round: its long axis has no direction.
const ROUND: f64 = 1e-6;

/// Stop points of repeats of one movement (Gordon et al. 1994, doi 10.1007/BF00241415, found clouds of people longest along the
/// movement, and van Beers et al. 2004, doi 10.1152/jn.00652.2003, in some directions up to twice as wide as in others).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EndpointCloud {
    /// How many there are.
    pub stops: usize,
    /// Mean in m.
    pub mean: Point,
    /// Covariance in m2, (3, 3), with one degree of freedom less than stops.
    pub covariance: [[f64; 3]; 3],
    /// Standard deviations along the axes of the cloud, in m, the longest first.
    pub axes: [f64; 3],
    /// Standard deviation along the movement in m.
    pub sd_along: f64,
    /// Standard deviation across the movement in m, per axis: root of the mean variance of the two axes across.
    pub sd_across: f64,
    /// `sd_across` as seen from the start of the movement, in degrees.
    pub direction_sd_deg: f64,
    /// Angle in degrees from 0 to 90 between the long axis and the movement; none where the cloud is round.
    pub angle_deg: Option<f64>,
    /// From the centre of the target to the mean, along the movement, in m; less than zero is short of it.
    pub overshoot: f64,
}

impl EndpointCloud {
    /// Of at least four `stops`, (n), of movements from `start` to `target`, in m: where the speed falls below 5 % of its peak.
    ///
    /// # Errors
    /// Fewer stops, numbers that are not finite, a target at the start.
    pub fn of(stops: &[Point], start: Point, target: Point) -> Result<Self> {
        check::at_least("stops", stops.len(), LEAST_STOPS)?;
        check::points("stop in m", stops)?;
        check::points("start and target in m", &[start, target])?;
        let movement = Vector3::from(point::minus(target, start));
        let distance = movement.norm();
        check::setting("distance from start to target in m", distance, "finite and greater than 0", distance > 0.0)?;
        let direction = movement / distance;
        let mean = point::centre(stops);
        let covariance = covariance(stops, mean);
        let (axes, long) = axes(covariance);
        let along = direction.dot(&(covariance * direction));
        // Rounding may leave less than nothing of a cloud without width.
        let across = (0.5 * (covariance.trace() - along)).max(0.0);
        let angle = long.dot(&direction).abs().min(1.0).acos().to_degrees();
        Ok(Self {
            stops: stops.len(),
            mean,
            covariance: covariance.transpose().into(),
            axes,
            sd_along: along.max(0.0).sqrt(),
            sd_across: across.sqrt(),
            direction_sd_deg: across.sqrt().atan2(distance).to_degrees(),
            angle_deg: (axes[0] > axes[1] * (1.0 + ROUND)).then_some(angle),
            overshoot: direction.dot(&Vector3::from(point::minus(mean, target))),
        })
    }
}

/// With one degree of freedom less than points.
pub(crate) fn covariance(points: &[Point], mean: Point) -> Matrix3<f64> {
    let off = points.iter().map(|&point| Vector3::from(point::minus(point, mean)));
    off.map(|off| off * off.transpose()).sum::<Matrix3<f64>>() / (points.len() as f64 - 1.0)
}

/// Standard deviations along the axes of a covariance, the longest first, and the direction of that.
pub(crate) fn axes(covariance: Matrix3<f64>) -> ([f64; 3], Vector3<f64>) {
    let SymmetricEigen { eigenvalues, eigenvectors } = SymmetricEigen::new(covariance);
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| eigenvalues[b].total_cmp(&eigenvalues[a]));
    let sds = order.map(|axis| eigenvalues[axis].max(0.0).sqrt());
    (sds, eigenvectors.column(order[0]).into_owned())
}
