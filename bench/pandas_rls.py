"""pandas_rls.py LOG [ROWS]: CPU seconds for the usual script: pandas reads the log, numpy runs one recursive
least-squares estimator with four parameters over the differenced balance of the die cushion. On the first ROWS rows
(default 50 000); no quality checks, no other regressors, nothing stored."""

import sys
import time

import numpy
import pandas

limit = int(sys.argv[2]) if len(sys.argv) > 2 else 50_000
start = time.process_time()
log = pandas.read_csv(sys.argv[1], nrows=limit)
rate = 1.0 / numpy.diff(log["t"].to_numpy(), prepend=log["t"].iloc[0] - 0.002)
root = numpy.sqrt(numpy.maximum(log["p_A"].to_numpy(), 0.0))
spool, position = log["y_v"].to_numpy(), log["z"].to_numpy()
pressure_rate = numpy.diff(log["p_A"].to_numpy(), prepend=log["p_A"].iloc[0]) * rate
regressors = numpy.stack([root * spool / 1e3, pressure_rate / 1e8, position * pressure_rate / 1e7, root / 1e4], axis=1)
output = 0.0125 * numpy.diff(position, prepend=position[0]) * rate * 1e3

forgetting = 0.998
theta, p = numpy.zeros(4), 500.0 * numpy.eye(4)
for u, y in zip(regressors, output):
    pu = p @ u
    gain = pu / (forgetting + u @ pu)
    theta = theta + gain * (y - u @ theta)
    p = (p - numpy.outer(gain, pu)) / forgetting
    p = 0.5 * (p + p.T)
print(f"pandas+numpy-rls {time.process_time() - start:.4f} {len(log)}")
