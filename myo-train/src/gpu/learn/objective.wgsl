// The clipped objective of PPO for one sample, as in gaussian.rs.
struct Objective {
    // Of the loss by the logarithm of the ratio, times the weight of the sample.
    slope: f32,
    loss: f32,
    divergence: f32,
    cut: f32,
}

const HALF_LN_TAU = 0.9189385;

// Logarithm of the density of `actions` numbers, from the sums of their squared z and of the logarithms of their standard
// deviations.
fn log_density(actions: u32, squares: f32, log_stds: f32) -> f32 {
    return -log_stds - f32(actions) * HALF_LN_TAU - 0.5 * squares;
}

fn objective(log_ratio: f32, advantage: f32, weight: f32, clip: f32) -> Objective {
    if weight <= 0.0 { return Objective(0.0, 0.0, 0.0, 0.0); }
    // Held where the exponential would overflow.
    let ratio = exp(clamp(log_ratio, -87.0, 88.0));
    let free = ratio * advantage;
    let held = clamp(ratio, 1.0 - clip, 1.0 + clip) * advantage;
    let cut = held < free;
    let slope = select(-free * weight, 0.0, cut);
    return Objective(slope, -select(free, held, cut), ratio - 1.0 - log_ratio, select(0.0, 1.0, cut));
}

// How far the mean of an action lies beyond where it has an effect.
fn beyond(mean: f32, least: f32, most: f32) -> f32 {
    return mean - clamp(mean, least, most);
}
