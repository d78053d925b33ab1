"""Kinematics of our body, by MuJoCo."""

import math
import pathlib

import mujoco
import numpy as np

MODEL = pathlib.Path(__file__).resolve().parent.parent / "bodies" / "models" / "human416.xml"


class Body:
    """Kinematics of our body: poses in, ends of the feet's capsules out."""

    def __init__(self):
        self.model = mujoco.MjModel.from_xml_path(str(MODEL))
        self.data = mujoco.MjData(self.model)
        m = self.model
        self.address = {m.joint(i).name: m.jnt_qposadr[i] for i in range(m.njnt)}
        self.range = {m.joint(i).name: m.jnt_range[i] for i in range(m.njnt)}
        self.couplings = []
        for e in range(m.neq):
            if m.eq_type[e] == mujoco.mjtEq.mjEQ_JOINT:
                follower, leader = m.eq_obj1id[e], m.eq_obj2id[e]
                lead = m.jnt_qposadr[leader] if leader >= 0 else -1
                self.couplings.append((m.jnt_qposadr[follower], lead, m.eq_data[e, :5].copy()))
        # Two rounds solve followers of followers.
        self.couplings *= 2
        self.probes = {}
        for side in "rl":
            heel, ball, toes = [], [], []
            for name, rear, front in [("foot_col1", heel, ball), ("foot_col3", heel, ball), ("bofoot_col1", toes, toes), ("bofoot_col2", toes, toes)]:
                g = m.geom(f"{side}_{name}").id
                axis = np.zeros(9)
                mujoco.mju_quat2Mat(axis, m.geom_quat[g])
                arm = axis.reshape(3, 3)[:, 2] * m.geom_size[g, 1]
                ends = sorted([m.geom_pos[g] - arm, m.geom_pos[g] + arm], key=lambda end: end[0])
                for group, end in zip((rear, front), ends):
                    group.append((m.geom_bodyid[g], end, m.geom_size[g, 0]))
            self.probes[side] = {"heel": heel, "ball": ball, "toes": toes}
        self.axes = np.array([[0, 1, 0], [-1, 0, 0], [0, 0, 1]], float)  # forward, left, up of the root as columns
        self.upright = {"shoulder_elv_l": math.radians(8), "shoulder_elv_r": math.radians(8)}

    def pose(self, joints, root):
        """joints: model names to rad; root: x, y, height, heading, pitch, roll."""
        q = self.data.qpos
        q[:] = self.model.qpos0
        for name, value in {**self.upright, **joints}.items():
            q[self.address[name]] = value
        for follower, leader, c in self.couplings:
            d = q[leader] - self.model.qpos0[leader] if leader >= 0 else 0.0
            q[follower] = self.model.qpos0[follower] + c[0] + d * (c[1] + d * (c[2] + d * (c[3] + d * c[4])))
        x, y, height, heading, pitch, roll = root
        cy, sy, cp, sp, cr, sr = math.cos(heading), math.sin(heading), math.cos(pitch), math.sin(pitch), math.cos(roll), math.sin(roll)
        turn = np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]]) @ np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])
        turn = turn @ np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]]) @ self.axes.T
        quat = np.zeros(4)
        mujoco.mju_mat2Quat(quat, turn.flatten())
        q[0:3], q[3:7] = [x, y, height], quat
        mujoco.mj_kinematics(self.model, self.data)

    def points(self):
        """Lowest points of the capsules' ends: (feet, heel 2 + ball 2 + toes 4, xyz)."""
        d, out = self.data, []
        for side in "rl":
            for group in ("heel", "ball", "toes"):
                for body, end, radius in self.probes[side][group]:
                    place = d.xpos[body] + d.xmat[body].reshape(3, 3) @ end
                    out.append([place[0], place[1], place[2] - radius])
        return np.array(out)

    def com(self):
        mujoco.mj_comPos(self.model, self.data)
        return self.data.subtree_com[1].copy()
