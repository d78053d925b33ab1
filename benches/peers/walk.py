"""The task `walk` on MuJoCo as a user of Gymnasium writes it: NumPy over `mjData`, names resolved once, one class.

It is what `compare.py` measures msk against. The model and the table of the reference come from `msk export walk --target python`,
initial states from a file; observation, reward and terminations are those of `tasks/locomotion/walk.msk`. As in the environments of
Gymnasium, a control step is one call of `mj_step`, after which derived quantities lag behind the positions by one of its ten physics
steps: a further `mj_forward` would take more time.
"""

import json
import os
import time
from pathlib import Path

import gymnasium
import mujoco
import numpy as np

FOLLOWED = {
    "hip_flexion_l": "hip_flexion_l", "hip_flexion_r": "hip_flexion_r",
    "hip_adduction_l": "hip_adduction_l", "hip_adduction_r": "hip_adduction_r",
    "hip_rotation_l": "hip_rotation_l", "hip_rotation_r": "hip_rotation_r",
    "knee_angle_l": "knee_angle_l", "knee_angle_r": "knee_angle_r",
    "ankle_angle_l": "ankle_angle_l", "ankle_angle_r": "ankle_angle_r",
    "subtalar_angle_l": "subtalar_angle_l", "subtalar_angle_r": "subtalar_angle_r",
    "mtp_angle_l": "mtp_angle_l", "mtp_angle_r": "mtp_angle_r",
    "lumbar_extension": "flex_extension", "lumbar_bending": "lat_bending", "lumbar_rotation": "axial_rotation",
    "shoulder_elevation_l": "shoulder_elv_l", "shoulder_elevation_r": "shoulder_elv_r",
    "elbow_flexion_l": "elbow_flex_l", "elbow_flexion_r": "elbow_flex_r",
}  # fmt: skip
"""Of each column of the reference that is followed, the joint of the model."""

FEET = [
    [f"{side}_{shape}" for shape in ("foot_col1", "foot_col3", "foot_col4", "bofoot_col1", "bofoot_col2")]
    for side in "lr"
]

SUBSTEPS, DT, HORIZON = 10, 0.01, 1000


class Reference:
    """The reference motion: cubics through the rows of its table, all columns at once."""

    def __init__(self, path: Path, columns: list[str]) -> None:
        table = json.loads(path.read_text())["gait"]
        self.times, self.duration = np.array(table["times"]), table["duration"]
        self.values, self.slopes = (
            np.array([table["columns"][name][key] for name in columns]).T for key in ("values", "slopes")
        )

    def at(self, phase: float) -> tuple[np.ndarray, np.ndarray]:
        """Values and rates of all columns within the cycle."""
        now = phase % 1.0 * self.duration
        row = min(int(np.searchsorted(self.times, now, side="right")) - 1, len(self.times) - 2)
        after, length = now - self.times[row], self.times[row + 1] - self.times[row]
        a, b, end = self.values[row], self.slopes[row], self.slopes[row + 1]
        rise = (self.values[row + 1] - a) / length
        c, d = (3.0 * rise - 2.0 * b - end) / length, (b + end - 2.0 * rise) / length**2
        return a + after * (b + after * (c + after * d)), b + after * (2.0 * c + 3.0 * after * d)


class Walk(gymnasium.Env):
    """Walk forward for ten seconds as the reference walks, at its speed."""

    def __init__(self, folder: str) -> None:
        self.model = mujoco.MjModel.from_xml_path(f"{folder}/walk.xml")
        self.data = mujoco.MjData(self.model)
        self.reference = Reference(Path(folder) / "walk.json", ["root.x", "root.y", *FOLLOWED])
        with np.load(f"{folder}/states.npz") as states:
            self.states = dict(states)
        self.root = self.model.body("Full Body").id
        self.pelvis, self.torso = self.model.body("pelvis").id, self.model.body("torso").id
        self.followed = np.array([self.model.joint(name).qposadr[0] for name in FOLLOWED.values()])
        self.soles = np.array([[self.model.geom(name).id for name in foot] for foot in FEET])
        self.capsules = self.model.geom_type[self.soles] == mujoco.mjtGeom.mjGEOM_CAPSULE
        self.sizes = self.model.geom_size[self.soles]
        self.spatial = np.zeros(6)
        self.start, self.steps = 0.0, 0
        self.reset_to(0)
        self.observation_space = gymnasium.spaces.Box(-np.inf, np.inf, self.observation().shape, np.float32)
        self.action_space = gymnasium.spaces.Box(-1.0, 1.0, (self.model.nu,), np.float32)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.reset_to(self.np_random.integers(len(self.states["qpos"])))
        return self.observation(), {}

    def reset_to(self, index: int) -> None:
        mujoco.mj_resetData(self.model, self.data)
        self.data.qpos[:], self.data.qvel[:] = self.states["qpos"][index], self.states["qvel"][index]
        self.start, self.steps = self.states["phase"][index], 0
        mujoco.mj_forward(self.model, self.data)
        self.begun = self.data.xpos[self.pelvis, 0]

    def step(self, action):
        self.data.ctrl[:] = (action + 1.0) / 2.0
        mujoco.mj_step(self.model, self.data, nstep=SUBSTEPS)
        self.steps += 1
        observation = self.observation()
        terms, terminated = self.judge()
        truncated = not terminated and self.steps >= HORIZON
        info = {f"reward_{name}": value for name, value in terms.items()}
        if terminated or truncated:
            info["is_success"] = truncated and self.data.xpos[self.pelvis, 0] - self.begun > 6.0
        return observation, float(sum(terms.values())), terminated, truncated, info

    def observation(self) -> np.ndarray:
        data = self.data
        mujoco.mj_subtreeVel(self.model, data)
        mujoco.mj_objectVelocity(self.model, data, mujoco.mjtObj.mjOBJ_XBODY, self.pelvis, self.spatial, 0)
        self.pelvis_velocity = self.spatial[3:].copy()
        # Columns: forward, left and up of the pelvis.
        axes = data.xmat[self.pelvis].reshape(3, 3)[:, [0, 2, 1]] * [1.0, -1.0, 1.0]
        heading = axes[:2, 0] / np.hypot(*axes[:2, 0])
        facing = np.array([[heading[0], heading[1], 0.0], [-heading[1], heading[0], 0.0], [0.0, 0.0, 1.0]])
        self.phase = self.start + self.steps * DT / self.reference.duration
        wanted, self.rates = self.reference.at(self.phase)
        self.error = data.qpos[self.followed] - wanted[2:]
        return np.concatenate(
            [
                [data.xpos[self.pelvis, 2]],
                facing @ axes[:, 2],
                data.qpos[7:],
                self.pelvis_velocity @ axes,
                self.spatial[:3] @ axes,
                data.qvel[6:],
                [data.subtree_com[self.root, 2]],
                facing @ data.subtree_linvel[self.root],
                data.actuator_length,
                data.actuator_velocity,
                data.actuator_force,
                data.act,
                self.torso_quaternion(),
                self.clearances(),
                [np.sin(2.0 * np.pi * self.phase), np.cos(2.0 * np.pi * self.phase)],
                self.error,
            ],
            dtype=np.float32,
            casting="same_kind",
        )

    def torso_quaternion(self) -> np.ndarray:
        """Of forward, left and up, which are the body's axes x, -z and y: a quarter turn about x before its own."""
        w, x, y, z = self.data.xquat[self.torso]
        quaternion = np.sqrt(0.5) * np.array([w + x, x - w, y - z, z + y])
        return quaternion if quaternion[0] >= 0.0 else -quaternion

    def clearances(self) -> np.ndarray:
        """Of each foot's shapes the lowest point: capsules and ellipsoids above the ground at 0."""
        down = self.data.geom_xmat[self.soles][..., 6:]
        capsules = self.sizes[..., 0] + self.sizes[..., 1] * np.abs(down[..., 2])
        ellipsoids = np.linalg.norm(self.sizes * down, axis=-1)
        extent = np.where(self.capsules, capsules, ellipsoids)
        return np.min(self.data.geom_xpos[self.soles][..., 2] - extent, axis=1)

    def judge(self) -> tuple[dict[str, float], bool]:
        """Contributions of the terms, and whether the body has fallen."""
        data = self.data
        torso = data.xmat[self.torso].reshape(3, 3)
        up = data.xmat[self.pelvis].reshape(3, 3)[:, 1]
        tilt = np.arctan2(np.hypot(up[0], up[1]), up[2])
        fallen = bool(data.subtree_com[self.root, 2] < 0.5 or tilt > 0.8)
        terms = {
            "velocity": 10.0 * np.exp(-2.0 * np.sum(np.square(self.pelvis_velocity[:2] - self.rates[:2]))),
            "imitation": 3.0 * np.exp(-2.0 * np.sum(np.square(self.error))),
            "upright": 6.0 * np.exp(-10.0 * (1.0 - torso[2, 1])),
            "unbowed": 8.0 * np.exp(-20.0 * np.square(min(0.0, torso[2, 0] + 0.1))),
            "ahead": 8.0 * np.exp(-5.0 * (1.0 - torso[0, 0])),
            "alive": float(not fallen),
            "fall": -100.0 * fallen,
            "effort": -0.01 * np.mean(np.square(data.act)),
        }
        return terms, fallen

    def cpu_time(self) -> tuple[int, float]:
        """The process in which this environment lives, and the seconds of CPU time that it has taken."""
        return os.getpid(), time.process_time()
