"""PyTorch: one gradient step of PPO with Adam on the published networks, the samples already on the device.

Forward, clipped objective, squared error of the values, entropy, backward, shortening of the gradient, Adam: what Myo's
learner does in a gradient step. Eager and, on a card, as CUDA graph; in full 32 bits and, on a card, with TF32.
"""

import math
from itertools import pairwise

import torch
from common import best_and_median, emit, settings
from torch import nn

s = settings()
device = torch.device("cuda" if torch.cuda.is_available() else "cpu")
if "threads" in s:
    torch.set_num_threads(s["threads"])


def network(inputs: int, hidden: list[int], outputs: int) -> nn.Sequential:
    """Hidden layers with SiLU, a linear last one."""
    widths = [inputs, *hidden]
    layers = [part for a, b in pairwise(widths) for part in (nn.Linear(a, b), nn.SiLU())]
    return nn.Sequential(*layers, nn.Linear(widths[-1], outputs)).to(device)


class Learner:
    """Networks, samples and optimizer."""

    def __init__(self, batch: int, graphs: bool) -> None:
        torch.manual_seed(s["seed"])
        n = s["networks"]
        self.policy = network(n["observations"], n["policy"], n["actions"])
        self.value = network(n["observations"], n["value"], 1)
        self.log_std = nn.Parameter(torch.full((n["actions"],), -0.7, device=device))
        self.parameters = [*self.policy.parameters(), *self.value.parameters(), self.log_std]
        fast = {"capturable": True, "fused": True} if graphs else {"fused": device.type == "cuda"}
        self.adam = torch.optim.Adam(self.parameters, lr=1e-4, eps=1e-5, **fast)
        self.observation = torch.rand(batch, n["observations"], device=device) * 2 - 1
        self.action = torch.rand(batch, n["actions"], device=device) * 2 - 1
        self.log_prob = torch.full((batch,), -24.0, device=device)
        self.advantage = torch.randn(batch, device=device)
        self.returns = torch.randn(batch, device=device)

    def loss(self) -> torch.Tensor:
        """PPO's."""
        z = (self.action - self.policy(self.observation)) * torch.exp(-self.log_std)
        log_prob = (-0.5 * z * z - self.log_std - 0.5 * math.log(2 * math.pi)).sum(1)
        ratio = torch.exp(log_prob - self.log_prob)
        clipped = ratio.clamp(0.8, 1.2)
        gain = torch.minimum(ratio * self.advantage, clipped * self.advantage).mean()
        error = (self.value(self.observation).squeeze(1) - self.returns).square().mean()
        return -gain + 0.5 * error - 0.002 * self.log_std.sum()

    def step(self) -> None:
        """One gradient step."""
        self.adam.zero_grad(set_to_none=False)
        self.loss().backward()
        nn.utils.clip_grad_norm_(self.parameters, 1.0, foreach=True)
        self.adam.step()

    def graph(self) -> torch.cuda.CUDAGraph:
        """A gradient step, recorded."""
        aside = torch.cuda.Stream()
        aside.wait_stream(torch.cuda.current_stream())
        with torch.cuda.stream(aside):
            for _ in range(3):
                self.step()
        torch.cuda.current_stream().wait_stream(aside)
        graph = torch.cuda.CUDAGraph()
        with torch.cuda.graph(graph):
            self.step()
        return graph


def measure(batch: int, way: str, precision: str) -> None:
    """A row."""
    torch.set_float32_matmul_precision("high" if precision == "TF32" else "highest")
    learner = Learner(batch, way == "CUDA graph")
    step = learner.graph().replay if way == "CUDA graph" else learner.step
    wait = torch.cuda.synchronize if device.type == "cuda" else lambda: None
    best, median = best_and_median(step, wait, s["seconds"])
    assert all(torch.isfinite(p).all() for p in learner.parameters)
    name = torch.cuda.get_device_name() if device.type == "cuda" else f"{torch.get_num_threads()} threads"
    emit(
        what="gradient step",
        system=f"PyTorch, {way}, {precision}",
        version=torch.__version__,
        device=name,
        samples=batch,
        gradient_step_s=best,
        gradient_step_s_median=median,
    )


for batch in s["batches"]:
    for way in ["eager", "CUDA graph"] if device.type == "cuda" else ["eager"]:
        for precision in ["32 bits", "TF32"] if device.type == "cuda" else ["32 bits"]:
            measure(batch, way, precision)
