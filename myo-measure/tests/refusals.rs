//! Whatever is handed in: an answer made of finite numbers, or an error, and never a panic.

use myo_measure::drive::{co_contraction, group_activation};
use myo_measure::fitts::{Condition, Trial, Users};
use myo_measure::smoothness::{ldlj, sparc};
use myo_measure::steering::{Steering, Tunnel};
use myo_measure::taps::{Contact, Taps};
use myo_measure::{Drive, Edge, EndpointCloud, Hold, Line, Movement, Point, Spread, signal};

/// Numbers that are usual, and numbers that are not: a generator of Lehmer (1951) chooses.
struct Odd(u64);

impl Odd {
    /// The first ten are usual.
    const VALUES: [f64; 18] = [
        0.0,
        100.0,
        0.1,
        0.3,
        0.5,
        0.7,
        1.0,
        2.0,
        10.0,
        30.5,
        -0.0,
        -1.0,
        1e-308,
        1e50,
        1e308,
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
    ];

    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0 * 48271 % 2_147_483_647;
        (self.0 % n as u64) as usize
    }

    /// Most often the first of all values.
    fn value(&mut self, most: usize) -> f64 {
        let kinds = if self.below(most) == 0 { Self::VALUES.len() } else { 10 };
        Self::VALUES[self.below(kinds)]
    }

    fn values(&mut self, most: usize) -> Vec<f64> {
        (0..self.below(60)).map(|_| self.value(most)).collect()
    }

    fn point(&mut self, most: usize) -> Point {
        [self.value(most), self.value(most), self.value(most)]
    }

    fn points(&mut self, most: usize) -> Vec<Point> {
        (0..self.below(120)).map(|_| self.point(most)).collect()
    }

    fn edge(&mut self) -> Edge {
        if self.below(2) == 0 { Edge::Threshold } else { Edge::Sample(self.below(130)) }
    }
}

/// Whether there were numbers.
#[track_caller]
fn assert_finite<E>(numbers: Result<impl IntoIterator<Item = f64>, E>) -> bool {
    let mut numbers = numbers.into_iter().flatten().peekable();
    let some = numbers.peek().is_some();
    assert!(numbers.all(f64::is_finite));
    some
}

#[test]
fn odd_numbers_never_panic_and_never_pass_for_figures() {
    let mut odd = Odd(1);
    let mut answered = [0; 14];
    for round in 0..20_000 {
        // From numbers that are mostly odd to numbers that are mostly not.
        let answers = measure_all(&mut odd, [1, 10, 1000, 1_000_000][round % 4]);
        for (count, answer) in answered.iter_mut().zip(answers) {
            *count += u32::from(answer);
        }
    }
    // Without answers the test would say nothing.
    assert!(answered.iter().all(|&count| count > 100), "{answered:?}");
}

/// Which measures gave numbers.
fn measure_all(odd: &mut Odd, most: usize) -> [bool; 14] {
    let (rate_hz, x) = (odd.value(most), odd.values(most));
    let y: Vec<f64> = x.iter().map(|_| odd.value(most)).collect();
    let (points, muscles) = (odd.points(most), odd.below(4));
    // Times that rise, but for what is odd about them.
    let times: Vec<f64> = x.iter().enumerate().map(|(i, x)| i as f64 + 0.4 * x.clamp(-1e60, 1.0)).collect();
    let activations: Vec<f64> = x.iter().map(|x| 0.01 * x).collect();
    let taps = Taps::of(&x, rate_hz, Contact::default());
    let movement = Movement::of(&points, rate_hz, odd.edge(), odd.edge());
    let cloud = EndpointCloud::of(&points, odd.point(most), odd.point(most));
    let conditions = conditions(odd, most);
    let tunnels = [0; 4].map(|_| tunnel(odd, most));
    [
        assert_finite(signal::low_pass(&x, rate_hz, odd.value(most))),
        assert_finite(signal::band(&x, rate_hz, odd.value(most), odd.value(most))),
        assert_finite(signal::resample(&times, &y, rate_hz)),
        assert_finite(sparc(&x, rate_hz).map(|x| [x])),
        assert_finite(ldlj(&x, rate_hz).map(|x| [x])),
        assert_finite(Spread::of(&x).map(|spread| [spread.low, spread.median, spread.high, spread.mean])),
        assert_finite(Line::through(&x, &y).map(|line| [line.slope, line.intercept])),
        assert_finite(co_contraction(&x, &y).map(|x| [x])),
        assert_finite(Drive::of(&activations, muscles, rate_hz).map(|drive| [drive.mean, drive.change_per_50_ms])),
        assert_finite(group_activation(&activations, muscles, &[odd.below(3), odd.below(5)])),
        assert_finite(taps.and_then(|taps| Ok([taps.median_contact_time_s()?, taps.median_peak()?]))),
        assert_finite(movement.map(|m| [m.peak_speed, m.peak_over_mean, m.time_of_peak, m.path, m.sparc, m.ldlj])),
        assert_finite(cloud.map(|cloud| [cloud.sd_along, cloud.sd_across, cloud.axes[0], cloud.axes[2]])),
        // What seldom has an answer, of numbers without rhyme.
        assert_finite(Hold::of(&points, rate_hz).map(|hold| [hold.mean_speed, hold.drift, hold.tremor_peak_to_peak]))
            | assert_finite(Users::of(&[conditions]).map(|users| [users.slope.median, users.throughput.median]))
            | assert_finite(Steering::of(&tunnels).map(|law| [law.fit.slope])),
    ]
}

fn conditions(odd: &mut Odd, most: usize) -> Vec<Condition> {
    let trial = |odd: &mut Odd| Trial {
        movement_time_s: odd.value(most),
        start: odd.point(most),
        target: odd.point(most),
        end: odd.point(most),
    };
    let condition = |odd: &mut Odd| {
        let trials = (0..4).map(|_| trial(odd)).collect();
        Condition { distance: odd.value(most), width: odd.value(most), trials }
    };
    (0..4).map(|_| condition(odd)).collect()
}

fn tunnel(odd: &mut Odd, most: usize) -> Tunnel {
    Tunnel { length: odd.value(most), width: odd.value(most), times_s: odd.values(most), left: 1 }
}
