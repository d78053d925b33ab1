"""Figures of NumPy and SciPy for the tests of standard metrics (runtime/evaluate/src/metrics/tests.rs), of statistics, of robustness, and of
the filters of electromyograms (runtime/evaluate/src/recordings/filter.rs).

Needs numpy and scipy: `python3 tests/oracle/metrics.py` prints them.
"""

import numpy
from scipy.interpolate import CubicSpline
from scipy.signal import butter, sosfiltfilt
from scipy.stats import binomtest, pearsonr, trim_mean

values = [0.2, 0.9, 0.4, 0.7, 0.1, 0.3]
at = numpy.linspace(0, len(values) - 1, 9)
print("spline", [float(value) for value in CubicSpline(range(len(values)), values, bc_type="not-a-knot")(at)])
print("pearson", float(pearsonr(values, [1.0, 2.0, 0.0, 4.0, 3.0, 1.0]).statistic))
print("trim_mean", [float(trim_mean(part, 0.25)) for part in ([9, 1, 2, 3, 100, -50, 4], [1, 2, 3, 10], [7])])
scales, success = numpy.array([0, 0.02, 0.05, 0.08, 0.10]), numpy.array([1.0, 0.9, 0.5, 0.1, 0.0])
print("area", float(100 * numpy.trapezoid(success, scales) / (scales[-1] - scales[0])))
print("deviation", float(numpy.std([1, 2, 4, 9])))

# Wilson's interval.
for successes, trials in ((0, 30), (1, 50), (27, 30), (50, 50)):
    interval = binomtest(successes, trials).proportion_ci(0.95, method="wilson")
    print("wilson", successes, trials, [float(bound) for bound in interval])

# Filters without delay: every tenth sample.
signal = numpy.array([place * place % 17 - 0.05 * place for place in range(60)])
for corner, kind in ((6, "lowpass"), (20, "highpass")):
    print("filter", kind, [float(value) for value in sosfiltfilt(butter(4, corner, kind, fs=100, output="sos"), signal)[::10]])

# The envelope of three cycles of 60, 70 and 80 samples against a human one: resampled to 101 points, averaged, scaled to 0..1, shifted.
cycles = [numpy.sin(numpy.linspace(0, 2 * numpy.pi, count)) ** 3 + 0.01 * count for count in (60, 70, 80)]
human = numpy.cos(numpy.linspace(0, 2 * numpy.pi, 40)) ** 3 + 0.2 * numpy.sin(numpy.linspace(0, 4 * numpy.pi, 40))
resample = lambda values: CubicSpline(range(len(values)), values, bc_type="not-a-knot")(numpy.linspace(0, len(values) - 1, 101))
scale = lambda values: (values - values.min()) / (values.max() - values.min())
curves = numpy.array([resample(cycle) for cycle in cycles])
simulated, human = scale(curves.mean(axis=0)), scale(resample(human))
r = [pearsonr(numpy.roll(simulated[:-1], shift), human[:-1]).statistic for shift in range(100)]
deviation = curves.std(axis=0) / numpy.ptp(curves.mean(axis=0))
print("envelope", int(numpy.argmax(r)), float(max(r)), float(deviation[0]), float(simulated[30]))
