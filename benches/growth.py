"""How the cost of a physics step grows: with muscles, objects, rows, and episodes in flight.

    cargo build --release -p msk-physics --example speed --example together
    pip install matplotlib
    python benches/growth.py [--rounds 3] [--seconds 1]

Writes `benches/growth.csv` and draws `docs/growth.svg` from it; with `--draw` it only draws, with `--crawling` it measures a crawling
body alone and keeps the other rows. All else is the protocol *falling* of the examples. On one thread, in microseconds of CPU time per step;
the median of the rounds.
"""

import argparse
import csv
import json
import pathlib
import statistics
import subprocess
import tempfile
from xml.etree import ElementTree

ROOT = pathlib.Path(__file__).parents[1]
MODEL = ROOT / "bodies/models/human416.xml"
TABLE, PICTURE = ROOT / "benches/growth.csv", ROOT / "docs/growth.svg"


def with_muscles(count):
    """The body with so many of its muscles, spread evenly over the list."""
    tree = ElementTree.parse(MODEL)
    actuators, tendons = tree.getroot().find("actuator"), tree.getroot().find("tendon")
    muscles = list(actuators)
    kept = {round(index * (len(muscles) - 1) / (count - 1)) for index in range(count)}
    kept_tendons = {muscles[index].get("tendon") for index in kept}
    for index, muscle in enumerate(muscles):
        if index not in kept:
            actuators.remove(muscle)
    for tendon in list(tendons):
        if tendon.get("name") not in kept_tendons:
            tendons.remove(tendon)
    return ElementTree.tostring(tree.getroot(), encoding="unicode")


def with_boxes(count):
    """The body among boxes that lie on the ground, a metre and more away."""
    tree = ElementTree.parse(MODEL)
    world = tree.getroot().find("worldbody")
    for index in range(count):
        place = f"{2 + index % 8} {1 + index // 8} 0.1"
        body = ElementTree.SubElement(world, "body", name=f"box_{index}", pos=place)
        ElementTree.SubElement(body, "freejoint")
        ElementTree.SubElement(body, "geom", type="box", size="0.1 0.1 0.1", mass="2", contype="1", conaffinity="1")
    return ElementTree.tostring(tree.getroot(), encoding="unicode")


def run(programs, name, path, seconds, *more, protocol="falling"):
    command = [str(programs / name), str(path), protocol, str(seconds), *map(str, more)]
    return json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)


def measure(programs, rounds, seconds):
    """Rows of the table: what grows, its size, one at a time or in lanes, microseconds per step."""
    rows = []

    def add(what, size, way, path, name, *more):
        reports = [run(programs, name, path, seconds, *more) for _ in range(rounds)]
        rows.append((what, size, way, 1e6 / statistics.median(report["steps_per_second"] for report in reports)))
        print(*rows[-1], flush=True)
        return reports[-1]

    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "model.xml"
        for what, sizes, make in [
            ("muscles", [16, 52, 104, 208, 312, 416], with_muscles),
            ("boxes", [0, 1, 2, 4, 8, 16, 32], with_boxes),
        ]:
            for size in sizes:
                path.write_text(make(size))
                add(what, size, "one at a time", path, "speed")
                add(what, size, "eight lanes", path, "together", 8)
    for size in [1, 2, 4, 8, 16, 64, 256, 1024, 4096]:
        # Every episode shall take part in some steps.
        add("episodes", size, "eight lanes", MODEL, "together", size)
    for size, time in run(programs, "speed", MODEL, 4 * seconds)["us_by_rows"].items():
        rows.append(("rows", int(size), "one at a time", time))
    return rows


def measure_crawling(programs, rounds, seconds):
    """Rows of a body on hands, knees and feet; its size is the mean number of constraint rows."""

    def reports(name, *more):
        return [run(programs, name, MODEL, seconds, *more, protocol="crawling") for _ in range(rounds)]

    alone, lanes = reports("speed"), reports("together", 8)
    size = round(alone[-1]["rows"]["mean"])
    print("crawling:", json.dumps(alone[-1]), flush=True)

    def time(reports):
        return 1e6 / statistics.median(report["steps_per_second"] for report in reports)

    return [("crawling", size, "one at a time", time(alone)), ("crawling", size, "eight lanes", time(lanes))]


def read_table():
    with TABLE.open(newline="") as file:
        return [
            (row["what"], int(row["size"]), row["way"], float(row["microseconds_per_step"]))
            for row in csv.DictReader(file)
        ]


def draw(rows):
    import matplotlib

    matplotlib.use("svg")
    matplotlib.rcParams["svg.hashsalt"] = "growth"
    from matplotlib import pyplot

    titles = {
        "muscles": "muscles",
        "rows": "constraint rows (contacts, limits, couplings)",
        "boxes": "boxes on the ground, each with four contacts",
        "episodes": "episodes in flight, one thread",
    }
    figure, axes = pyplot.subplots(2, 2, figsize=(10, 7), layout="constrained")
    for axis, (what, title) in zip(axes.flat, titles.items(), strict=True):
        for way, colour in [("one at a time", "#b5651d"), ("eight lanes", "#1f6f8b")]:
            points = sorted((size, time) for kind, size, manner, time in rows if (kind, manner) == (what, way))
            if points:
                axis.plot(*zip(*points, strict=True), "o-", color=colour, label=way)
            crawling = [(size, time) for kind, size, manner, time in rows if (kind, manner) == ("crawling", way)]
            if what == "rows" and crawling:
                axis.plot(*zip(*crawling, strict=True), "s", color=colour, markersize=9, label=f"crawling, {way}")
        if what == "episodes":
            axis.set_xscale("log", base=2)
        axis.set_xlabel(title)
        axis.set_ylabel("microseconds per step")
        axis.set_ylim(bottom=0)
        axis.grid(alpha=0.3)
        axis.legend()
    figure.savefig(PICTURE, metadata={"Date": None})


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--programs", type=pathlib.Path, default=ROOT / "target/release/examples")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--seconds", type=float, default=1.0)
    parser.add_argument("--draw", action="store_true", help="measure nothing")
    parser.add_argument("--crawling", action="store_true", help="measure a crawling body alone")
    arguments = parser.parse_args()
    if not arguments.draw:
        rows = [row for row in read_table() if row[0] != "crawling"] if arguments.crawling else None
        rows = rows or measure(arguments.programs, arguments.rounds, arguments.seconds)
        rows += measure_crawling(arguments.programs, arguments.rounds, arguments.seconds)
        with TABLE.open("w", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(("what", "size", "way", "microseconds_per_step"))
            writer.writerows((what, size, way, f"{time:.1f}") for what, size, way, time in rows)
    draw(read_table())


if __name__ == "__main__":
    main()
