#!/usr/bin/env python3
"""Golden numbers for `tests/golden.rs`: losses, gradients and parameters after Adam steps, computed with PyTorch.

    pip install torch==2.15.0 numpy
    python learn/network/tests/oracle/torch_golden.py > learn/network/tests/golden/torch.json

Inputs and initial parameters are the numbers of `number`, which the Rust side computes too.
"""
import json

import torch
from torch import nn
from torch.nn import functional as F

torch.set_default_dtype(torch.float64)
torch.set_num_threads(1)


def number(index, salt):
    """From -0.5 to 0.5, the same on both sides; products stay below 2^53."""
    return ((index * 7919 + salt * 104729) % 10007) / 10007 - 0.5


def filled(shape, salt, scale=1.0):
    count = 1
    for size in shape:
        count *= size
    return torch.tensor([scale * number(index, salt) for index in range(count)]).reshape(shape)


class Perceptron(nn.Module):
    def __init__(self, sizes, activation, layer_norm, salt):
        super().__init__()
        self.layers = nn.ModuleList([nn.Linear(a, b) for a, b in zip(sizes, sizes[1:])])
        self.norms = nn.ModuleList([nn.LayerNorm(b) for b in sizes[1:-1]] if layer_norm else [])
        self.activation = activation
        with torch.no_grad():
            for place, parameter in enumerate(self.ordered()):
                parameter.copy_(filled(parameter.shape, salt + place) + (1.0 if place in self.scales() else 0.0))

    def scales(self):
        return {4 * index + 2 for index in range(len(self.norms))}

    def ordered(self):
        """As the Rust side has them: weight, bias, scale and shift, layer after layer."""
        for index, layer in enumerate(self.layers):
            yield from (layer.weight, layer.bias)
            if index < len(self.norms):
                yield from (self.norms[index].weight, self.norms[index].bias)

    def forward(self, x):
        for index, layer in enumerate(self.layers):
            x = layer(x)
            if index + 1 < len(self.layers):
                if len(self.norms):
                    x = self.norms[index](x)
                x = self.activation(x)
        return x


def record(losses, parameters, gradients):
    flat = lambda tensors: [value for tensor in tensors for value in tensor.detach().flatten().tolist()]
    return {"losses": losses, "parameters": flat(parameters), "gradient": flat(gradients)}


def train(parameters, loss, epsilon):
    optimiser = torch.optim.Adam(parameters, lr=1e-2, eps=epsilon)
    losses, gradients = [], []
    for step in range(5):
        optimiser.zero_grad()
        value = loss()
        value.backward()
        if step == 0:
            gradients = [parameter.grad.clone() for parameter in parameters]
            norm = float(torch.sqrt(sum((gradient**2).sum() for gradient in gradients)))
        nn.utils.clip_grad_norm_(parameters, 0.5)
        optimiser.step()
        losses.append(float(value))
    return record(losses, parameters, gradients) | {"norm": norm}


def regression(activation, layer_norm):
    network = Perceptron([5, 7, 6, 3], activation, layer_norm, 1)
    x, y = filled([9, 5], 50, 4.0), filled([9, 3], 51, 4.0)
    return train(list(network.ordered()), lambda: ((network(x) - y) ** 2).mean(), 1e-8)


def proximal():
    """The loss of PPO with clipped values (Schulman et al. 2017)."""
    policy = Perceptron([5, 7, 3], torch.tanh, False, 1)
    value = Perceptron([5, 6, 1], torch.tanh, False, 11)
    log_std = nn.Parameter(filled([3], 21))
    x, actions = filled([9, 5], 50, 4.0), filled([9, 3], 51, 4.0)
    advantages, before = filled([9, 1], 52, 4.0), filled([9, 1], 53) - 5.0
    returns, old = filled([9, 1], 54, 4.0), filled([9, 1], 55)

    def loss():
        normal = torch.distributions.Normal(policy(x), log_std.exp())
        density = normal.log_prob(actions).sum(1, keepdim=True)
        ratio = (density - before).exp()
        surrogate = torch.minimum(ratio * advantages, ratio.clip(0.8, 1.2) * advantages).mean()
        found = value(x)
        clipped = old + (found - old).clip(-0.2, 0.2)
        error = 0.5 * torch.maximum((found - returns) ** 2, (clipped - returns) ** 2).mean()
        return -surrogate + 0.5 * error - 0.01 * normal.entropy().sum(1).mean()

    return train([*policy.ordered(), *value.ordered(), log_std], loss, 1e-5)


def soft():
    """The loss of SAC's actor (Haarnoja et al. 2018): only the actor is trained."""
    actor = Perceptron([5, 7, 6], torch.relu, False, 1)
    critic = Perceptron([8, 6, 1], torch.relu, False, 11)
    x, noise = filled([9, 5], 50, 4.0), filled([9, 3], 51, 6.0)

    def loss():
        mean, raw = actor(x).chunk(2, dim=1)
        log_std = raw.clip(-20, 2)
        u = mean + log_std.exp() * noise
        action = torch.tanh(u)
        density = torch.distributions.Normal(mean, log_std.exp()).log_prob(u)
        density = density - 2 * (torch.log(torch.tensor(2.0)) - u - F.softplus(-2 * u))
        return (0.2 * density.sum(1, keepdim=True) - critic(torch.cat([x, action], 1))).mean()

    return train(list(actor.ordered()), loss, 1e-8)


print(json.dumps({
    "made_with": f"torch {torch.__version__}",
    "tanh": regression(torch.tanh, False),
    "relu": regression(torch.relu, False),
    "elu": regression(F.elu, False),
    "silu": regression(F.silu, False),
    "layer_norm": regression(F.silu, True),
    "proximal": proximal(),
    "soft": soft(),
}))
