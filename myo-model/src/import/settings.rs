//! What holds for the whole model.

use super::Import;
use crate::description::{Cone, Integrator, Options};
use myo_mjcf::{self as source, Switch};

/// An integrator, if it is simulated.
fn integrator(integrator: source::Integrator) -> Option<Integrator> {
    match integrator {
        source::Integrator::Euler => Some(Integrator::Euler),
        source::Integrator::Implicit => Some(Integrator::Implicit),
        source::Integrator::ImplicitFast => Some(Integrator::ImplicitFast),
        _ => None,
    }
}

impl Import<'_> {
    pub(super) fn settings(&mut self) -> Options {
        let mjcf = self.mjcf;
        let (option, flags, compiler) = (&mjcf.option, &mjcf.flags, &mjcf.compiler);
        let is_off = |switch: Switch| switch == Switch::Off;
        let is_on = |switch: Switch| switch == Switch::On;
        self.refuse_all(
            &option.place,
            ("option", None),
            &[
                (
                    integrator(option.integrator()).is_none(),
                    "of integrators only `Euler`, `implicit` and `implicitfast` are simulated",
                ),
                (
                    option.density() != 0.0 || option.viscosity() != 0.0,
                    "forces of a medium (`density`, `viscosity`) are not simulated",
                ),
                (
                    option.actuatorgroupdisable.as_ref().is_some_and(|groups| !groups.is_empty()),
                    "groups of actuators cannot be off (`actuatorgroupdisable`)",
                ),
            ],
        );
        self.refuse_all(
            &flags.place,
            ("flag", None),
            &[
                (is_off(flags.actuation()), "muscles cannot be off (`actuation`)"),
                (is_off(flags.clampctrl()), "controls are clamped to their range (`clampctrl`)"),
                (is_off(flags.refsafe()), "time constants of constraints are at least twice the time step (`refsafe`)"),
                (is_on(flags.overriding()), "contact parameters for all (`override`) are not simulated"),
                (is_on(flags.sleep()), "bodies do not sleep (`sleep`)"),
                (
                    is_on(flags.diagexact()),
                    "the exact diagonal of the constraint inertia (`diagexact`) is not simulated",
                ),
                (is_on(flags.ipc()), "incremental potential contact (`ipc`) is not simulated"),
            ],
        );
        self.refuse_all(
            &compiler.place,
            ("compiler", None),
            &[(
                compiler.settotalmass() > 0.0,
                "bodies are not scaled to a total mass (`settotalmass`); let MuJoCo load the model and save it with `mj_saveLastXML`",
            )],
        );
        Options {
            timestep: option.timestep(),
            gravity: if is_on(flags.gravity()) { option.gravity() } else { [0.0; 3] },
            cone: match option.cone() {
                source::Cone::Pyramidal => Cone::Pyramidal,
                source::Cone::Elliptic => Cone::Elliptic,
            },
            impratio: option.impratio(),
            integrator: integrator(option.integrator()).unwrap_or_default(),
            implicit_joint_damping: is_on(flags.eulerdamp()),
            side_rule: self.side_rule,
        }
    }

    /// Whether constraints of a kind are kept.
    pub(super) fn keeps(&self, kind: Switch) -> bool {
        kind == Switch::On && self.mjcf.flags.constraint() == Switch::On
    }
}
