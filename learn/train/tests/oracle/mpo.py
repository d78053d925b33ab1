#!/usr/bin/env python3
"""Golden numbers for a test of `learn/train/src/mpo/steps.rs`: the step M of MPO over all samples, with PyTorch.

    pip install torch==2.15.0
    python learn/train/tests/oracle/mpo.py > learn/train/tests/golden/mpo.json

Inputs are the numbers of `number`, which the Rust side computes too.
"""
import json

import torch
from torch.distributions import Normal, kl_divergence

torch.set_default_dtype(torch.float64)
ROWS, ENTRIES, SAMPLES = 4, 3, 5


def number(index, salt):
    return ((index * 7919 + salt * 104729) % 10007) / 10007 - 0.5


def filled(shape, salt, scale=1.0, shift=0.0):
    count = torch.Size(shape).numel()
    return torch.tensor([scale * number(index, salt) + shift for index in range(count)]).reshape(shape)


mean = filled([ROWS, ENTRIES], 1, 1.6).requires_grad_()
std = filled([ROWS, ENTRIES], 2, 0.8, 0.6).requires_grad_()
old = Normal(filled([ROWS, ENTRIES], 3, 1.6), filled([ROWS, ENTRIES], 4, 0.8, 0.6))
actions = filled([ROWS, SAMPLES, ENTRIES], 5, 3.0)
q = filled([ROWS, SAMPLES], 6, 4.0)
costs = -(actions - actions.clip(-1, 1)).norm(dim=-1)
weights = torch.softmax(q / 0.7, 1) + torch.softmax(costs / 1.5, 1)
bounds = [filled([ENTRIES], 7, 1.0, 1.0), filled([ENTRIES], 8, 1.0, 5.0)]

# Equation 8 of arXiv 1812.02256: the mean with the old deviation, and the deviation with the old mean.
moved, widened = Normal(mean, old.scale), Normal(old.loc, std)
likelihood = [
    (weights * density.log_prob(actions.transpose(0, 1)).transpose(0, 1).sum(-1)).sum(1) for density in (moved, widened)
]
divergences = [kl_divergence(old, density) for density in (moved, widened)]
penalty = sum((bound * divergence).sum(1) for bound, divergence in zip(bounds, divergences))
loss = (penalty - likelihood[0] - likelihood[1]).mean()
loss.backward()
print(json.dumps({
    "made_with": f"torch {torch.__version__}",
    "divergences": [divergence.mean(0).tolist() for divergence in divergences],
    "mean": mean.grad.flatten().tolist(),
    "std": std.grad.flatten().tolist(),
}))
