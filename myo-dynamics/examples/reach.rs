//! How much of the plane of the `pointing` task the fingertip reaches, and how long a query takes.
use myo_dynamics::{CouplingMode, Plan, ReachableSpace};
use myo_model::{Model, builtin};
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let model = Model::new(&builtin("mobl-arms")?)?;
    let space = ReachableSpace::new(&Plan::exact(&model, CouplingMode::Reduced)?.specialised());
    let points: Vec<[f64; 3]> = (0..61)
        .flat_map(|i| (0..61).map(move |j| [0.55, -0.2 + 0.01 * f64::from(i), -0.3 + 0.01 * f64::from(j)]))
        .collect();
    let start = Instant::now();
    let distances: Vec<f64> = points.iter().map(|&point| space.distance_out_of_reach(point)).collect();
    let us = start.elapsed().as_secs_f64() * 1e6 / points.len() as f64;
    let share = |within: f64| distances.iter().filter(|&&d| d <= within).count() as f64 / points.len() as f64;
    let worst = points.iter().zip(&distances).max_by(|a, b| a.1.total_cmp(b.1)).expect("points");
    println!("{us:.1} us per query; in reach {:.4}, within 0.05 m {:.4}; farthest {worst:?}", share(0.0), share(0.05));
    Ok(())
}
