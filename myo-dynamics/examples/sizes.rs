//! Prints what the built-in arm compiles to.
use myo_dynamics::{CouplingMode, Plan};
use myo_model::{Model, builtin};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let model = Model::new(&builtin("mobl-arms")?)?;
    let exact = Plan::exact(&model, CouplingMode::Reduced)?;
    for (name, plan) in [("exact", &exact), ("specialised", &exact.specialised())] {
        let t = &plan.tendons;
        let straight: usize = t.pairs.iter().map(|p| p.segments.len()).sum();
        println!(
            "{name}: {} links, {} screws, {} bodies, {} sets, {} mass terms, {} projections; {} points, {} pairs, \
             {straight} straight, {} hinge, {} double hinge segments, {} profile segments",
            plan.links.len(),
            plan.links.len() + plan.screws.len(),
            plan.bodies.len(),
            plan.sets.len(),
            plan.mass_terms.iter().map(|m| m.rows.len()).sum::<usize>(),
            plan.projections.len(),
            t.points.len(),
            t.pairs.len(),
            t.hinge.len(),
            t.double_hinge.len(),
            t.profiles.len(),
        );
    }
    Ok(())
}
