"""Where the time of rollouts goes: actors on several nodes of a cluster on this machine collect under an agent.

python python/benches/rollouts.py --nodes 2 --rounds 5
"""

import argparse
import time

import ray
from ray.cluster_utils import Cluster

import msk.ray


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--task", default="stand")
    parser.add_argument("--policy", default="agents")
    parser.add_argument("--nodes", type=int, default=2, help="each with one processor")
    parser.add_argument("--num-envs", type=int, default=32)
    parser.add_argument("--batch-size", type=int, default=8)
    parser.add_argument("--steps", type=int, default=64)
    parser.add_argument("--rounds", type=int, default=5)
    given = parser.parse_args()
    cluster = Cluster(initialize_head=True, head_node_args={"num_cpus": 1, "include_dashboard": False})
    for _ in range(given.nodes - 1):
        cluster.add_node(num_cpus=1)
    ray.init(address=cluster.address, log_to_driver=False)
    sizes = {"num_envs": given.num_envs, "batch_size": given.batch_size, "steps": given.steps}
    with msk.ray.Collector(given.task, given.policy, **sizes) as collector:
        collector.collect()  # begins the episodes
        before, start = collector.seconds, time.perf_counter()
        for _ in range(given.rounds):
            collector.collect()
        elapsed, seconds = time.perf_counter() - start, collector.seconds
    whole, stepping, acting = (
        getattr(seconds, name) - getattr(before, name) for name in ("whole", "stepping", "acting")
    )
    steps = given.rounds * given.num_envs * given.steps
    print(f"{steps} steps in {elapsed:.1f} s, {steps / elapsed:.0f} steps per second, on {given.nodes} nodes")
    print(
        f"of the actors' time in rollouts: {100 * stepping / whole:.1f} % stepping in Rust, {100 * acting / whole:.1f} % policy, "
        f"{100 * (1 - (stepping + acting) / whole):.1f} % the rest of Python"
    )
    print(f"in rollouts: {100 * whole / (given.nodes * elapsed):.1f} % of the actors' time")
    ray.shutdown()
    cluster.shutdown()


if __name__ == "__main__":
    main()
