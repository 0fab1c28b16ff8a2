//! The built-in arm against the figures that were published with it.

use myo_model::model::WORLD;
use myo_model::{Model, ModelDescription, builtin, builtin_names};
use nalgebra::{Isometry3, Point3, Vector3};

fn arm(name: &str) -> Model {
    let description = builtin(name).unwrap_or_else(|error| panic!("{error}"));
    Model::new(&description).unwrap_or_else(|error| panic!("{error}"))
}

/// Pose of every body in the world with all joints at zero.
fn zero_pose(model: &Model) -> Vec<Isometry3<f64>> {
    let mut x_wb = vec![Isometry3::identity(); model.bodies.len()];
    for (index, body) in model.bodies.iter().enumerate().skip(1) {
        x_wb[index] = x_wb[body.parent] * Isometry3::from_parts(body.pos.into(), body.quat);
    }
    x_wb
}

fn site_positions(model: &Model) -> Vec<Point3<f64>> {
    let x_wb = zero_pose(model);
    model.sites.iter().map(|site| x_wb[site.body] * Point3::from(site.pos)).collect()
}

fn assert_close(found: Vector3<f64>, wanted: [f64; 3]) {
    assert!((found - Vector3::from(wanted)).amax() < 1e-6, "{found} is not {wanted:?}");
}

#[test]
fn has_the_size_of_the_published_arm() {
    for name in ["mobl-arms", "mobl-arms-uitb"] {
        let arm = arm(name);
        assert_eq!(arm.name, name);
        assert_eq!((arm.bodies.len(), arm.joints.len(), arm.couplings.len()), (18, 17, 12));
        assert_eq!((arm.sites.len(), arm.geoms.len(), arm.muscles.len()), (110, 1, 26));
    }
}

#[test]
fn the_human_arm_has_a_wrist_and_muscles_that_bend_over_bones() {
    let arm = arm("myo-arm");
    assert_eq!((arm.bodies.len(), arm.joints.len(), arm.couplings.len()), (12, 18, 11));
    assert_eq!((arm.sites.len(), arm.geoms.len(), arm.muscles.len(), arm.wraps.len()), (150, 1, 32, 19));
    let mass: f64 = arm.bodies.iter().filter(|body| body.name != "thorax").map(|body| body.mass).sum();
    assert!((4.5..4.8).contains(&mass), "{mass} kg with the shoulder girdle");
}

#[test]
fn joints_of_the_human_arm_are_damped_as_people_s() {
    let arm = builtin("myo-arm").unwrap();
    // N m s/rad, after Davidson and Charles 2017 (doi 10.1007/s10439-016-1765-5); elevation is flexion or abduction, by its plane.
    let people = [
        ("elv_angle", 0.3, 0.8),
        ("shoulder_elv", 0.383, 0.756),
        ("shoulder_rot", 0.5, 0.55),
        ("elbow_flexion", 0.6, 0.62),
    ];
    for (name, least, most) in people {
        let own = arm.joints.iter().find(|joint| joint.name == name).unwrap().damping;
        let follow = arm.couplings.iter().filter(|coupling| coupling.independent.as_deref() == Some(name));
        let along: f64 = follow
            .map(|coupling| {
                let follower = arm.joints.iter().find(|joint| joint.name == coupling.dependent).unwrap();
                follower.damping * coupling.polycoef[1].powi(2)
            })
            .sum();
        assert!((least..=most).contains(&(own + along)), "{name}: {own} + {along} N m s/rad");
    }
}

#[test]
fn weighs_the_sum_of_the_published_masses() {
    let mass: f64 = arm("mobl-arms").bodies.iter().map(|body| body.mass).sum();
    assert!((mass - 12.8025).abs() < 1e-12, "{mass} kg");
}

#[test]
fn fingertip_and_shoulder_are_in_place_in_the_zero_pose() {
    let arm = arm("mobl-arms");
    assert_close(site_positions(&arm)[arm.fingertip_site].coords, [0.034937, -0.198526, 0.285043]);
    assert_close(zero_pose(&arm)[arm.shoulder_body].translation.vector, [-0.017555, -0.17, 0.993]);
}

#[test]
fn tendons_have_the_published_lengths_in_the_zero_pose() {
    #[rustfmt::skip]
    let published = [
        ("DELT1", 0.204382404), ("DELT2", 0.232638044), ("DELT3", 0.154459508), ("SUPSP", 0.109646715),
        ("INFSP", 0.101649319), ("SUBSC", 0.109117716), ("TMIN", 0.125375292), ("TMAJ", 0.135300857),
        ("PECM1", 0.125719316), ("PECM2", 0.177509418), ("PECM3", 0.178355466), ("LAT1", 0.255254776),
        ("LAT2", 0.310196595), ("LAT3", 0.339184035), ("CORB", 0.147617956), ("TRIlong", 0.277608767),
        ("TRIlat", 0.166610488), ("TRImed", 0.154238292), ("ANC", 0.0215048599), ("SUP", 0.048901974),
        ("BIClong", 0.429683046), ("BICshort", 0.35020446), ("BRA", 0.145932359), ("BRD", 0.331037023),
        ("PT", 0.155125275), ("PQ", 0.0311454326),
    ];
    let arm = arm("mobl-arms");
    let sites = site_positions(&arm);
    assert_eq!(arm.muscles.len(), published.len());
    for (muscle, (name, length)) in arm.muscles.iter().zip(published) {
        let found: f64 = muscle.path.windows(2).map(|pair| (sites[pair[1]] - sites[pair[0]]).norm()).sum();
        assert_eq!(muscle.name, name);
        assert!((found - length).abs() < 1e-9, "{name} is {found} m long, not {length} m");
    }
}

#[test]
fn bodies_and_joints_are_in_the_order_of_the_chain() {
    let arm = arm("mobl-arms");
    assert!(arm.bodies.iter().enumerate().skip(1).all(|(index, body)| body.parent < index));
    assert!(arm.joints.windows(2).all(|pair| pair[0].body <= pair[1].body));
    assert!(arm.joints.iter().all(|joint| joint.body != WORLD && (joint.axis.norm() - 1.0).abs() < 1e-15));
}

#[test]
fn variants_differ_in_the_phantom_bodies_alone() {
    let (light, mut heavy) = (builtin("mobl-arms").unwrap(), builtin("mobl-arms-uitb").unwrap());
    let changed: Vec<_> = heavy
        .bodies
        .iter_mut()
        .zip(&light.bodies)
        .filter(|(heavy, light)| heavy != light)
        .map(|(heavy, light)| {
            assert_eq!((heavy.inertia, light.inertia), ([1.0; 3], [1e-6; 3]));
            heavy.inertia = light.inertia;
            heavy.name.clone()
        })
        .collect();
    assert_eq!(changed, ["clavphant", "scapphant", "humphant", "humphant1"]);
    heavy.name = light.name.clone();
    assert_eq!(heavy, light);
}

#[test]
fn what_is_written_reads_back_the_same() {
    for name in builtin_names() {
        let description = builtin(name).unwrap();
        let text = description.to_yaml().unwrap();
        assert_eq!(ModelDescription::from_yaml(&text, "again.yaml").unwrap(), description, "{text}");
    }
}
