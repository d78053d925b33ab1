"""A policy of one's own for `msk run` and `msk eval`: it excites all muscles a little, and more while the pelvis sinks.

    cargo run --release -- run stand --policy "process python3 examples/policy.py"

Every request is a line of JSON on standard input, every reply one on standard output; `msk help policies` describes both.
"""

import json
import sys


def offsets(channels):
    """Where the numbers of each channel begin."""
    first, found = 0, {}
    for channel in channels:
        found[channel["name"]] = first
        first += channel["size"]
    return found


def reply(answer):
    print(json.dumps(answer), flush=True)


task, height, before = None, None, None
for line in sys.stdin:
    request = json.loads(line)
    if "task" in request:
        task = request["task"]
        height = offsets(task["observation"]).get("pelvis.height")
        reply({"ready": True})
        continue
    step = request["act"]
    if step["step"] == 0:
        before = None
    sinking = 0.0
    if height is not None:
        now = step["observation"][height]
        if before is not None:
            sinking = max(0.0, before - now) / task["control_period"]
        before = now
    # -1 is rest, 1 full excitation; `sinking` is in m/s.
    level = min(-0.9 + 0.5 * sinking, 1.0)
    reply({"action": [level] * len(task["action"])})
