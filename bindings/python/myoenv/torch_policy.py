"""A policy as a module of PyTorch."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

try:
    import torch
    from torch import Tensor, nn
except ImportError:
    raise ImportError("modules need PyTorch; install it with: pip install 'myoenv[torch]'") from None


class PolicyModule(nn.Module):
    """What `Policy.to_torch` returns: observations `(..., observation_size)` to mean actions `(..., nmuscle)`.

    Made of nothing but PyTorch's own parts, so it can be trained, scripted and exported. `Policy.from_torch` is the way
    back.
    """

    def __init__(
        self, weights: Mapping[str, NDArray[np.float32]], observation_names: Sequence[str], action_names: Sequence[str]
    ) -> None:
        """From arrays as `Policy.weights` describes them."""
        super().__init__()
        self.observation_names, self.action_names = list(observation_names), list(action_names)
        shapes = [array.shape for name, array in weights.items() if name.endswith(".weight")]
        self.layers = nn.ModuleList(nn.Linear(inputs, outputs) for outputs, inputs in shapes)
        for name, array in weights.items():
            if not name.startswith("layers."):
                self.register_buffer(name, torch.zeros(array.shape))
        self.load_state_dict({name: torch.from_numpy(np.array(array)) for name, array in weights.items()})

    def forward(self, observation: Tensor) -> Tensor:
        """Mean actions."""
        x = (observation - self.observation_mean) * self.observation_inverse_std
        x = torch.maximum(torch.minimum(x, self.observation_limit), -self.observation_limit)
        last = len(self.layers) - 1
        for index, layer in enumerate(self.layers):
            x = layer(x)
            if index != last:
                x = nn.functional.silu(x)
        return torch.clamp(self.action_offset + self.action_scale * x, -1.0, 1.0)
