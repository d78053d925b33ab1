#!/usr/bin/env python3
"""Writes small recordings in the layouts of data sets for the tests of `runtime/evaluate/src/recordings/`, which know the formulas of their
numbers. Needs `pip install ezc3d==1.7.2 mat-io==1.0.2 openpyxl==3.1.5 scipy==1.17.1`.

* `example.c3d` by ezc3d: two markers in five frames at 100 Hz, the second not seen in the fourth; three analog channels at 400 Hz;
* `gait120/processed.mat` by mat-io: two trials of a movement in the layout of Gait120, with tables, and a third that is not available;
* `gait120/converted.mat` by SciPy: the same with structures in place of tables;
* `van_hooren/channels.xlsx` by openpyxl: channels of two participants, in the layout of Van Hooren and Meijer.
"""

import os

import ezc3d
import matio
import numpy as np
import openpyxl
import pandas as pd
import scipy.io

FRAMES, SAMPLES, POINTS = 5, 4, 101
OUT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../runtime/evaluate/src/recordings")


def path(name):
    os.makedirs(os.path.dirname(os.path.join(OUT, name)), exist_ok=True)
    return os.path.join(OUT, name)


def write_c3d():
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
    file.write(path("example.c3d"))


def movement(table):
    """Cycles 1 and 2 in the first trial, 6 in the third; the second is not available."""

    def step(number):
        part = np.arange(POINTS) / (POINTS - 1)
        return {"EMGs_interpolated": table({"VastusLateralis": number + part, "GastrocnemuisMedialis": number * (1 - part)})}

    def trial(*numbers):
        steps = {f"Step{place + 1:02}": step(number) for place, number in enumerate(numbers)}
        return {"MVCs": np.ones((1, 2)), "nSteps": np.uint8(len(numbers)), **steps}

    available = {"nTrials": np.uint8(3), "AvailableTrialIdx": np.array([[1, 3]], np.uint8)}
    return {**available, "Trial01": trial(1, 2), "Trial02": trial(100), "Trial03": trial(6)}


def write_gait120():
    matio.save_to_mat(path("gait120/processed.mat"), {"LevelWalking": movement(pd.DataFrame)}, version="v7")
    columns = lambda table: {name: values.reshape(-1, 1) for name, values in table.items()}
    scipy.io.savemat(path("gait120/converted.mat"), {"LevelWalking": movement(columns)}, long_field_names=True, do_compression=True)


def write_channels():
    book = openpyxl.Workbook()
    book.active.title = "Read me"
    sheet = book.create_sheet("Corresponding analogue channel")
    sheet.append(["Subject", "Condition", "Tibialis", "Sol", "Vastus"])
    sheet.append([1, "3.00 m/s", 3, 5, 4])
    sheet.append([1, "5.00 m/s", 3, 4, 5])
    sheet.append([2, "3.00 m/s", 3, None, 4])
    sheet.append([2, "5.00 m/s", 3, None, 4])
    book.save(path("van_hooren/channels.xlsx"))


if __name__ == "__main__":
    write_c3d()
    write_gait120()
    write_channels()
