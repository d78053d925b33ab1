"""Figures of NumPy and SciPy for the tests of standard metrics (runtime/evaluate/src/metrics/tests.rs) and of robustness.

Needs numpy and scipy: `python3 tests/oracle/metrics.py` prints them.
"""

import numpy
from scipy.interpolate import CubicSpline
from scipy.stats import pearsonr, trim_mean

values = [0.2, 0.9, 0.4, 0.7, 0.1, 0.3]
at = numpy.linspace(0, len(values) - 1, 9)
print("spline", [float(value) for value in CubicSpline(range(len(values)), values, bc_type="not-a-knot")(at)])
print("pearson", float(pearsonr(values, [1.0, 2.0, 0.0, 4.0, 3.0, 1.0]).statistic))
print("trim_mean", [float(trim_mean(part, 0.25)) for part in ([9, 1, 2, 3, 100, -50, 4], [1, 2, 3, 10], [7])])
scales, success = numpy.array([0, 0.02, 0.05, 0.08, 0.10]), numpy.array([1.0, 0.9, 0.5, 0.1, 0.0])
print("area", float(100 * numpy.trapezoid(success, scales) / (scales[-1] - scales[0])))
print("deviation", float(numpy.std([1, 2, 4, 9])))
