"""scipy_states.py FILE: CPU seconds scipy takes to fit the two tanks of the log that states_bench wrote (t, u, y): free run
by solve_ivp from one step of the input to the next, differences for the Jacobian, least_squares within the same ranges from
the same start."""

import sys
import time

import numpy
from scipy.integrate import solve_ivp
from scipy.optimize import least_squares

t, u, y = numpy.loadtxt(sys.argv[1], delimiter=",", skiprows=1, unpack=True)
edges = numpy.concatenate(([0], 1 + numpy.flatnonzero(numpy.diff(u)), [len(t) - 1]))


def simulate(parameters):
    k1, k2, pump, h_1, h_2 = parameters
    level = numpy.array([h_1, h_2])
    out = numpy.empty_like(y)
    out[0] = h_2
    for first, last in zip(edges[:-1], edges[1:]):
        if last <= first:
            continue

        def rate(_, h, inflow=pump * u[first]):
            out_1 = k1 * numpy.sqrt(max(h[0], 0.0))
            return [inflow - out_1, out_1 - k2 * numpy.sqrt(max(h[1], 0.0))]

        run = solve_ivp(rate, (t[first], t[last]), level, t_eval=t[first + 1 : last + 1], rtol=1e-5, atol=1e-6)
        out[first + 1 : last + 1] = run.y[1]
        level = run.y[:, -1]
    return out


begin = time.process_time()
fit = least_squares(
    lambda p: simulate(p) - y,
    [0.2, 0.2, 0.2, 4.0, y[0]],
    bounds=([0.005, 0.005, 0.005, 0, 0], [1, 1, 1, 100, 100]),
    x_scale=[0.1, 0.1, 0.1, 1, 1],
    ftol=1e-7,
)
seconds = time.process_time() - begin
print(f"scipy_fit {seconds:.6f} k1 {fit.x[0]:.6f} k2 {fit.x[1]:.6f} pump {fit.x[2]:.6f} runs {fit.nfev + 5 * fit.njev}")
