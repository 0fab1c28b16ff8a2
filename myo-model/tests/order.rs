//! The order of elements does not depend on how a file lists its bodies.

use myo_model::{Model, builtin};

#[test]
fn bodies_may_be_listed_in_any_order() {
    let mut shuffled = builtin("mobl-arms").unwrap();
    let arm = Model::new(&shuffled).unwrap();
    shuffled.bodies.reverse();
    shuffled.sites.sort_by(|a, b| b.body.cmp(&a.body));
    let names = |model: &Model| model.bodies.iter().map(|body| body.name.clone()).collect::<Vec<_>>();
    let again = Model::new(&shuffled).unwrap();
    assert_eq!(names(&again), names(&arm));
    assert_eq!(again, arm);
}
