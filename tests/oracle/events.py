"""What TensorBoard writes and reads: the event of a test in `learn/train/src/tensorboard.rs`, and the events of a training.

    pip install tensorboard
    python3 tests/oracle/events.py              # the record of the test, by TensorBoard's own writer
    python3 tests/oracle/events.py FOLDER       # compares the events of `msk train --tensorboard --out FOLDER` with its curve
"""

import json
import math
import sys
import tempfile
from pathlib import Path

from tensorboard.backend.event_processing.event_accumulator import EventAccumulator
from tensorboard.compat.proto.event_pb2 import Event
from tensorboard.compat.proto.summary_pb2 import Summary
from tensorboard.summary.writer.record_writer import RecordWriter


def written():
    """An evaluation at step 300, as one record."""
    numbers = {"return": -1.25, "success": 0.5, "length": 60.0}
    values = [Summary.Value(tag=f"evaluation/{name}", simple_value=value) for name, value in numbers.items()]
    event = Event(wall_time=1.5, step=300, summary=Summary(value=values))
    with tempfile.TemporaryFile() as file:
        RecordWriter(file).write(event.SerializeToString(deterministic=True))
        file.seek(0)
        return file.read().hex()


def curve(folder):
    """Points of each curve as the lines of the training have them."""
    points = {}
    for line in (folder / "curve.jsonl").read_text().splitlines():
        line = json.loads(line)
        kind = "evaluation" if "evaluation" in line else "episodes"
        own = line.get("evaluation", line)
        own = {"length": own.get("steps"), **own}
        for name in ("return", "success", "length"):
            if own.get(name) is not None:
                points.setdefault(f"{kind}/{name}", []).append((line["step"], own[name]))
        for group in ("terms", "losses"):
            for name, value in line.get(group, {}).items():
                points.setdefault(f"{group}/{name}", []).append((line["step"], value))
    return points


def compare(folder):
    events = EventAccumulator(str(folder), size_guidance={"scalars": 0}).Reload()
    expected = curve(folder)
    assert set(events.Tags()["scalars"]) == set(expected), (events.Tags()["scalars"], sorted(expected))
    for name, points in expected.items():
        found = [(event.step, event.value) for event in events.Scalars(name)]
        assert len(found) == len(points), name
        for (step, value), (known, number) in zip(found, points):
            assert step == known and math.isclose(value, number, rel_tol=1e-6, abs_tol=1e-30), (name, step, value, number)
    print(f"{len(expected)} curves of {folder} agree")


if __name__ == "__main__":
    if len(sys.argv) > 1:
        compare(Path(sys.argv[1]))
    else:
        print(written())
