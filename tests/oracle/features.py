"""Which features of MJCF other people's models use, counted in what MuJoCo compiles: what is worth supporting.

    python -m pip download --no-deps -d wheels dm_control==1.0.50 myosuite==2.8.0 gymnasium==1.4.0 musclemimic-models==1.0.6
    cd wheels && unzip -o '*.whl' && cd ..
    python tests/oracle/features.py wheels/dm_control/suite wheels/dm_control wheels/myosuite wheels/gymnasium wheels/musclemimic_models

Prints a row per feature: in how many models of each folder, of those that MuJoCo reads, it is used. Needs mujoco==4.0.0 and numpy.
"""

import pathlib
import sys

import mujoco
import numpy as np

SENSOR, TRANSMISSION = mujoco.mjtSensor, mujoco.mjtTrn
# What the reader refuses or has refused, and how a compiled model shows it.
FEATURES = {
    "`noslip_iterations`": lambda model: model.opt.noslip_iterations > 0,
    "`implicit`": lambda model: model.opt.integrator == mujoco.mjtIntegrator.mjINT_IMPLICIT,
    "slider-crank": lambda model: (model.actuator_trntype == TRANSMISSION.mjTRN_SLIDERCRANK).any(),
    "`fluidshape`": lambda model: model.geom_fluid[:, 0].any(),
    "delays": lambda model: model.actuator_delay.any() if hasattr(model, "actuator_delay") else False,
    "flexible bodies": lambda model: model.nflex > 0,
    "plugins": lambda model: model.nplugin > 0,
}
SENSORS = {
    "rangefinder": ["RANGEFINDER"],
    "distance": ["GEOMDIST", "GEOMNORMAL", "GEOMFROMTO"],
    "contact": ["CONTACT"],
    "limits of joints": ["JOINTLIMITPOS", "JOINTLIMITVEL", "JOINTLIMITFRC"],
    "limits of tendons": ["TENDONLIMITPOS", "TENDONLIMITVEL", "TENDONLIMITFRC"],
    "force of tendons": ["TENDONACTFRC"],
    "inside a site": ["INSIDESITE"],
    "energy": ["E_POTENTIAL", "E_KINETIC"],
    "magnetometer": ["MAGNETOMETER"],
    "camera": ["CAMPROJECTION"],
    "user": ["USER"],
    "tactile": ["TACTILE"],
}


def uses_sensor(names):
    kinds = [getattr(SENSOR, f"mjSENS_{name}") for name in names]
    return lambda model: np.isin(model.sensor_type, kinds).any()


FEATURES |= {f"sensor: {name}": uses_sensor(kinds) for name, kinds in SENSORS.items()}


def count(folder):
    """Models that MuJoCo reads, how many use each feature, and how many have an `attach` in their own text."""
    read, counts = 0, dict.fromkeys([*FEATURES, "`attach`"], 0)
    for file in sorted(pathlib.Path(folder).rglob("*.xml")):
        try:
            model = mujoco.MjModel.from_xml_path(str(file))
        except (ValueError, mujoco.FatalError):
            continue
        read += 1
        for name, used in FEATURES.items():
            counts[name] += bool(used(model))
        counts["`attach`"] += "<attach" in file.read_text(errors="replace")
    return read, counts


def main():
    folders = sys.argv[1:]
    counted = [count(folder) for folder in folders]
    print("| feature |", " | ".join(f"{pathlib.Path(folder).name}, {read} models" for folder, (read, _) in zip(folders, counted)), "|")
    print("|:--|", " | ".join("--:" for _ in folders), "|")
    for name in [*FEATURES, "`attach`"]:
        print(f"| {name} |", " | ".join(str(counts[name]) for _, counts in counted), "|")


if __name__ == "__main__":
    main()
