#!/usr/bin/env python3
"""Writes `runtime/evaluate/src/recordings/example.c3d` with ezc3d 1.7.2 (`pip install ezc3d==1.7.2`): two markers in five frames at 100 Hz, the
second not seen in the fourth; three analog channels at 400 Hz. The tests beside it know the formulas of the numbers."""

import os

import ezc3d
import numpy as np

FRAMES, SAMPLES = 5, 4
OUT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../runtime/evaluate/src/recordings/example.c3d")

file = ezc3d.c3d()
file["parameters"]["POINT"]["RATE"]["value"] = [100]
file["parameters"]["POINT"]["LABELS"]["value"] = ("HEEL", "TOE")
file["parameters"]["ANALOG"]["RATE"]["value"] = [100 * SAMPLES]
file["parameters"]["ANALOG"]["LABELS"]["value"] = ("Soleus", "Tib. ant.", "Gastroc")
frame = np.arange(FRAMES)
places = np.ones((4, 2, FRAMES))
for marker in range(2):
    places[:3, marker] = [100 * marker + frame, 0.5 * frame - marker, 1000 - 2 * frame]
places[:3, 1, 3] = np.nan
sample = np.arange(FRAMES * SAMPLES)
file["data"]["points"] = places
file["data"]["analogs"] = np.array([[0.25 * sample - channel for channel in range(3)]])
file.write(OUT)
