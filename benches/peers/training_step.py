"""Time of a training step of a perceptron in JAX and PyTorch, beside that of `learn/network/benches/training_step.rs`: the same sizes.

    pip install "jax==0.10.2" "torch==2.15.0"
    taskset -c 0 python benches/peers/training_step.py
    taskset -c 0 cargo bench -p msk-network --bench training_step

Forward, derivatives of a mean of squares, and a step of Adam, in single precision on one processor. Prints the least time of a step: other programs
only add to it. JAX compiles the whole step; PyTorch runs it operation by operation, as Stable-Baselines3 does.
"""

import time

import jax
import torch
from jax import numpy

SIZES = [([17, 64, 64, 6], 64), ([17, 256, 256, 6], 256), ([700, 512, 512, 512, 416], 256)]
RATE, BETAS, EPSILON = 1e-4, (0.9, 0.999), 1e-8


def in_jax(sizes: list[int], batch: int):
    keys = jax.random.split(jax.random.key(0), len(sizes))
    layers = [
        (0.1 * jax.random.normal(key, pair), numpy.zeros(pair[1]))
        for key, pair in zip(keys, zip(sizes, sizes[1:]))
    ]
    zeros = jax.tree.map(numpy.zeros_like, layers)
    data = jax.random.normal(keys[-1], (batch, sizes[0]))

    def loss(layers):
        rows = data
        for weight, bias in layers[:-1]:
            rows = numpy.tanh(rows @ weight + bias)
        return numpy.mean((rows @ layers[-1][0] + layers[-1][1]) ** 2)

    def step(state):
        layers, first, second, count = state
        gradient, count = jax.grad(loss)(layers), count + 1
        first = jax.tree.map(lambda old, new: BETAS[0] * old + (1 - BETAS[0]) * new, first, gradient)
        second = jax.tree.map(lambda old, new: BETAS[1] * old + (1 - BETAS[1]) * new**2, second, gradient)
        scales = [1 - beta**count for beta in BETAS]

        def moved(number, mean, square):
            return number - RATE * (mean / scales[0]) / (numpy.sqrt(square / scales[1]) + EPSILON)

        return jax.tree.map(moved, layers, first, second), first, second, count

    step, state = jax.jit(step, donate_argnums=0), (layers, zeros, jax.tree.map(numpy.copy, zeros), numpy.float32(0))

    def run():
        nonlocal state
        state = jax.block_until_ready(step(state))

    return run


def in_torch(sizes: list[int], batch: int):
    modules = [part for pair in zip(sizes, sizes[1:]) for part in (torch.nn.Linear(*pair), torch.nn.Tanh())]
    network = torch.nn.Sequential(*modules[:-1])
    optimizer = torch.optim.Adam(network.parameters(), lr=RATE, betas=BETAS, eps=EPSILON)
    data = torch.randn(batch, sizes[0])

    def run():
        optimizer.zero_grad()
        network(data).square().mean().backward()
        optimizer.step()

    return run


def least(run, count: int) -> float:
    for _ in range(5):
        run()
    times = []
    for _ in range(count):
        begin = time.perf_counter()
        run()
        times.append(time.perf_counter() - begin)
    return min(times)


def main() -> None:
    torch.set_num_threads(1)
    for sizes, batch in SIZES:
        times = [1e3 * least(make(sizes, batch), 65_536 // batch) for make in (in_jax, in_torch)]
        print(f"{'-'.join(map(str, sizes))}, batch {batch}: JAX {times[0]:.3f} ms, PyTorch {times[1]:.3f} ms")


if __name__ == "__main__":
    main()
