"""What is published of each motion, and how the parts of the upper body move that nobody publishes curves of.

Each specification names its sources. Points are (per cent of the cycle, degrees or metres) of the right leg.
"""

import math

import numpy as np
from scipy.interpolate import PchipInterpolator


def through(points, cycle):
    """A curve through (per cent, value): monotone between the points, so that peaks are where they were published."""
    x, y = np.array(points, float).T
    if cycle:
        x, y = np.concatenate([x - 100, x, x + 100]), np.tile(y, 3)
    return lambda phase: PchipInterpolator(x, y)(100 * np.asarray(phase))


def arms(swing, middle, elbow, elbow_swing, spread=8.0):
    """Arms that swing against the legs: flexion middle +- swing, elbow bent by elbow +- elbow_swing; degrees."""

    def at(phase):
        out = {}
        for side, shift in (("r", 0.0), ("l", 0.5)):
            turn = 2 * math.pi * (phase + shift)
            flexion, aside = np.radians(middle - swing * np.cos(turn)), math.radians(spread)
            # Plane and elevation of an upper arm that is flexed and spread.
            out[f"elv_angle_{side}"] = np.arctan2(np.tan(flexion), math.tan(aside))
            out[f"shoulder_elv_{side}"] = np.arccos(np.cos(flexion) * math.cos(aside))
            out[f"elbow_flex_{side}"] = np.radians(elbow - elbow_swing * np.cos(turn))
        return out

    return at


def trunk(lean, rotation, bending):
    """The trunk against the pelvis: leant back by `lean`, turned and bent by cosines of the cycle; degrees."""

    def at(phase):
        turn = 2 * math.pi * phase
        return {
            "flex_extension": np.radians(lean + 0 * turn),
            "axial_rotation": np.radians(rotation * np.cos(turn)),
            "lat_bending": np.radians(bending * np.sin(turn)),
        }

    return at


def together(*parts):
    return lambda phase: {name: values for part in parts for name, values in part(phase).items()}


def both(curves):
    """Curves of the upper body that are the same on both sides: model name (sides as {s}) to points, degrees."""

    def at(phase, cycle):
        out = {}
        for name, points in curves.items():
            for side in ("l", "r") if "{s}" in name else ("",):
                out[name.replace("{s}", side)] = np.radians(through(points, cycle)(phase))
        return out

    return at


# Right leg, per cent of the cycle from the right foot's contact. Flexion, dorsiflexion and adduction positive.
WALK = {
    "name": "walk", "rows": 50, "cycle": True, "sides": "alternating", "duration": 1.1, "advances": ["root.x"],
    "sources": [
        "joint curves of adults at their own speed: D. A. Winter, Biomechanics and Motor Control of Human Movement, 4th ed., 2009, appendix A",
        "instants and peaks: J. Perry, J. M. Burnfield, Gait Analysis: Normal and Pathological Function, 2nd ed., 2010",
    ],
    "stride": 1.36, "stride_scatter": 0.01, "stance": {"heel": (-0.01, 0.33), "ball": (0.08, 0.40), "toes": (0.12, 0.60)}, "toe_off": 0.62, "lift": 0.02,
    "leg": {
        "hip_flexion": [(0, 26), (10, 22), (20, 13), (30, 3), (40, -5), (50, -11), (56, -10), (65, 4), (75, 20), (86, 29), (94, 28)],
        "knee_angle": [(0, 6), (8, 15), (14, 19), (22, 15), (32, 8), (40, 6), (48, 10), (56, 25), (62, 41), (71, 61), (80, 47), (90, 14), (97, 4)],
        "ankle_angle": [(0, 0), (7, -7), (15, -1), (30, 6), (45, 10), (52, 4), (62, -17), (72, -5), (82, 1), (93, 1)],
        "hip_adduction": [(0, 1), (15, 5), (35, 4), (50, 1), (65, -6), (80, -3), (92, 0)],
        "mtp_angle": [(0, 8), (12, 0), (32, 0), (45, 12), (56, 26), (63, 14), (75, 2), (90, 6)],
    },
    "root": {
        "height": [(0, 0.905), (12.5, 0.92), (30, 0.935), (50, 0.905), (62.5, 0.92), (80, 0.935)],
        "heading": [(0, 4), (50, -4)], "roll": [(0, 0), (15, -4), (40, 0), (50, 0), (65, 4), (90, 0)], "pitch": [(0, 4), (25, 4.5), (50, 4), (75, 4.5)],
        "y": [(0, 0), (30, -0.022), (50, 0), (80, 0.022)],
    },
    "upper": together(trunk(-2, -7, -3), arms(17, -8, 32, 11)),
}  # fmt: skip

RUN = {
    "name": "run", "rows": 50, "cycle": True, "sides": "alternating", "duration": 0.7, "advances": ["root.x"],
    "sources": ["joint curves and instants at 3.2 m/s: T. F. Novacheck, The biomechanics of running, Gait and Posture 7 (1998) 77-95"],
    "stride": 2.24, "stride_scatter": 0.005, "stance": {"heel": (-0.01, 0.16), "ball": (0.03, 0.32), "toes": (0.05, 0.345)}, "toe_off": 0.36, "lift": 0.03,
    "scatter": {"ankle_angle": 3, "mtp_angle": 4},
    "leg": {
        "hip_flexion": [(0, 38), (10, 32), (20, 17), (30, 4), (38, -5), (44, -7), (55, 8), (68, 34), (80, 50), (90, 47)],
        "knee_angle": [(0, 16), (8, 34), (14, 42), (22, 36), (32, 22), (38, 18), (48, 40), (58, 72), (67, 91), (78, 70), (88, 32), (95, 13)],
        "ankle_angle": [(0, 6), (6, 4), (20, 24), (28, 14), (36, -14), (42, -24), (52, -12), (65, 2), (85, 6)],
        "hip_adduction": [(0, 4), (14, 9), (30, 3), (40, -3), (60, -5), (85, 1)],
        "mtp_angle": [(0, 6), (8, 0), (18, 2), (30, 22), (37, 16), (50, 0), (85, 4)],
    },
    "root": {
        "height": [(0, 0.89), (15, 0.845), (37, 0.905), (44, 0.915), (50, 0.89), (65, 0.845), (87, 0.905), (94, 0.915)],
        "heading": [(0, 0), (25, -7), (50, 0), (75, 7)], "roll": [(0, 0), (14, -5), (35, 2), (50, 0), (64, 5), (85, -2)], "pitch": [(0, 12), (25, 13), (50, 12), (75, 13)],
        "y": [(0, 0), (15, -0.012), (50, 0), (65, 0.012)],
    },
    "root_scatter": {"x": 0.02},
    "upper": together(trunk(-5, -14, -4), arms(32, -12, 88, 12, 12)),
}  # fmt: skip

STAIRS = {
    "name": "stairs", "rows": 50, "cycle": True, "sides": "alternating", "duration": 1.4, "advances": ["root.x", "root.height"],
    "sources": [
        "joint curves of climbing: R. Riener, M. Rabuffetti, C. Frigo, Stair ascent and descent at different inclinations, Gait and Posture 15 (2002) 32-44",
        "steps of 15 cm by 50 cm, as the task stairs has them: the stride is longer than in the source, the climb the least of the three there",
    ],
    "stride": 1.0, "stride_scatter": 0.0005, "rise": 0.30, "stance": {"heel": (-0.01, 0.42), "ball": (0.03, 0.60), "toes": (0.06, 0.63)}, "toe_off": 0.64, "lift": 0.08,
    "leg": {
        "hip_flexion": [(0, 58), (12, 52), (25, 36), (40, 18), (55, 7), (63, 8), (75, 40), (86, 62), (94, 62)],
        "knee_angle": [(0, 56), (10, 58), (22, 44), (35, 26), (48, 14), (55, 16), (63, 40), (75, 85), (85, 82), (94, 62)],
        "ankle_angle": [(0, 8), (12, 15), (28, 10), (45, 8), (54, 6), (63, -14), (75, 6), (85, 12), (94, 8)],
        "hip_adduction": [(0, 0), (15, 5), (40, 4), (55, 0), (70, -5), (88, -2)],
        "mtp_angle": [(0, 0), (35, 0), (50, 12), (60, 22), (68, 8), (80, 0)],
    },
    "root": {
        "height": [(0, 0.90), (12, 0.915), (25, 0.935), (38, 0.92), (50, 0.90), (62, 0.915), (75, 0.935), (88, 0.92)],
        "heading": [(0, 3), (50, -3)], "roll": [(0, 0), (15, -3), (35, 0), (50, 0), (65, 3), (85, 0)], "pitch": [(0, 10), (50, 10)],
        "y": [(0, 0), (30, -0.03), (50, 0), (80, 0.03)],
    },
    "scatter": {"hip_flexion": 8, "knee_angle": 8, "ankle_angle": 6}, "root_scatter": {"height": 0.06, "x": 0.06},
    "upper": together(trunk(-6, -5, -3), arms(12, -4, 35, 8)),
}  # fmt: skip

PLANTED = {"heel": (-0.5, 1.5), "ball": (-0.5, 1.5), "toes": (-0.5, 1.5)}

SQUAT = {
    "name": "squat", "rows": 50, "cycle": True, "sides": "together", "duration": 4.0, "advances": [], "stride_scatter": 1e-7,
    "sources": [
        "peaks of hip, knee, ankle and trunk in a squat with thighs near level: R. F. Escamilla, Knee biomechanics of the dynamic squat exercise, Medicine and Science in Sports and Exercise 33 (2001) 127-141",
        "B. J. Schoenfeld, Squatting kinematics and kinetics and their application to exercise performance, Journal of Strength and Conditioning Research 24 (2010) 3497-3506",
    ],
    "stance": PLANTED, "toe_off": 1.0,
    "leg": {
        "hip_flexion": [(0, 3), (12, 22), (30, 75), (50, 100), (70, 75), (88, 22)],
        "knee_angle": [(0, 4), (12, 28), (30, 82), (50, 108), (70, 82), (88, 28)],
        "ankle_angle": [(0, 1), (12, 10), (30, 25), (50, 28), (70, 25), (88, 10)],
        "hip_adduction": [(0, -6), (50, -14)],
    },
    "root": {"height": [(0, 0.94), (50, 0.50)], "pitch": [(0, 0), (12, 6), (30, 20), (50, 24), (70, 20), (88, 6)], "x": [(0, 0), (50, -0.12)]},
    "root_scatter": {"height": 0.2, "x": 0.2, "pitch": math.radians(4)},
    "balance": lambda phase: 1.0,
    "upper": lambda phase: both({
        "flex_extension": [(0, 0), (50, -12)], "elv_angle_{s}": [(0, 60), (25, 82), (50, 86), (75, 82)],
        "shoulder_elv_{s}": [(0, 12), (15, 35), (50, 85), (85, 35)], "elbow_flex_{s}": [(0, 10), (50, 8)],
    })(phase, True),
}  # fmt: skip

SIT = {
    "name": "sit", "rows": 50, "cycle": False, "sides": "together", "duration": 2.0, "advances": [], "stride_scatter": 1e-7,
    "sources": [
        "order and peaks of trunk, hip and knee in sitting down: S. Nuzik, R. Lamb, A. VanSant, S. Hirt, Sit-to-stand movement pattern: a kinematic study, Physical Therapy 66 (1986) 1708-1713, taken backwards",
        "K. M. Kerr, J. A. White, D. A. Barr, R. A. B. Mollan, Analysis of the sit-stand-sit movement cycle in normal subjects, Clinical Biomechanics 12 (1997) 236-245",
    ],
    "stance": PLANTED, "toe_off": 1.0,
    "leg": {
        "hip_flexion": [(0, 3), (10, 6), (30, 42), (55, 88), (75, 100), (92, 91), (100, 90)],
        "knee_angle": [(0, 4), (10, 9), (30, 40), (55, 74), (75, 88), (92, 90), (100, 90)],
        "ankle_angle": [(0, 1), (10, 4), (30, 14), (50, 16), (75, 6), (92, 0), (100, 0)],
        "hip_adduction": [(0, -4), (100, -6)],
    },
    "root": {"height": [(0, 0.94), (10, 0.935), (50, 0.70), (80, 0.55), (100, 0.53)], "pitch": [(0, 0), (10, 4), (35, 24), (60, 32), (80, 20), (94, 2), (100, 0)], "x": [(0, 0), (50, -0.25), (100, -0.42)]},
    "root_scatter": {"height": 0.2, "x": 0.2, "pitch": math.radians(4)},
    "balance": lambda phase: float(np.clip((0.70 - phase) / 0.15, 0, 1)),
    "upper": lambda phase: both({
        "flex_extension": [(0, 0), (10, -2), (45, -16), (70, -14), (92, -1), (100, 0)], "elv_angle_{s}": [(0, 60), (45, 80), (80, 70), (100, 60)],
        "shoulder_elv_{s}": [(0, 10), (10, 12), (45, 40), (75, 30), (95, 13), (100, 12)], "elbow_flex_{s}": [(0, 10), (45, 15), (100, 30)],
    })(phase, False),
}  # fmt: skip

ALL = [WALK, RUN, STAIRS, SQUAT, SIT]
