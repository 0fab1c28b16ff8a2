"""Every preset under Gymnasium's names: `myo/Pointing-v0`, `myo/PublicDisplay-v0`, ..."""

from gymnasium.envs.registration import register, registry

from myoenv._native import preset_names


def env_id(preset: str) -> str:
    """The name of a preset in Gymnasium: `myo/PublicDisplay-v0` for `public-display`."""
    return f"myo/{''.join(word.capitalize() for word in preset.split('-'))}-v0"


def register_envs() -> None:
    """Registers all presets; importing `myoenv` calls it. A second call does nothing."""
    for preset in preset_names():
        if env_id(preset) not in registry:
            register(
                id=env_id(preset),
                entry_point="myoenv.single:MyoEnv",
                vector_entry_point="myoenv.vector:MyoVectorEnv",
                kwargs={"task": preset},
            )
