"""sklearn_omp.py MATRIX COLUMNS BASE [REPEATS]: CPU seconds of scikit-learn's orthogonal matching pursuit on the
equations that ranking_bench wrote: base columns projected out, then greedy choice among the effects' columns. Twice:
on all equations, and from the Gram matrix alone. No held-out strokes, no shapes linearised, no intervals. Best of
REPEATS (default 20)."""

import sys
import time
import warnings

import numpy
from sklearn.linear_model import orthogonal_mp, orthogonal_mp_gram

warnings.filterwarnings("ignore")
columns, base = int(sys.argv[2]), int(sys.argv[3])
repeats = int(sys.argv[4]) if len(sys.argv) > 4 else 20
equations = numpy.fromfile(sys.argv[1]).reshape(-1, columns)
equations = equations[numpy.isfinite(equations).all(axis=1)]


def best(run):
    seconds, result = [], None
    for _ in range(repeats):
        begin = time.process_time()
        result = run()
        seconds.append(time.process_time() - begin)
    return min(seconds), result


def projected():
    known, output, effects = equations[:, :base], equations[:, base], equations[:, base + 1 :]
    q, _ = numpy.linalg.qr(known / numpy.linalg.norm(known, axis=0))
    rest = effects - q @ (q.T @ effects)
    norm = numpy.linalg.norm(rest, axis=0)
    return rest / numpy.where(norm > 0, norm, 1), output - q @ (q.T @ output)


def matching_pursuit():
    rest, output = projected()
    return orthogonal_mp(rest, output, n_nonzero_coefs=2)


rest, output = projected()
gram, cross = rest.T @ rest, rest.T @ output
seconds, chosen = best(matching_pursuit)
print(f"sklearn.orthogonal_mp {seconds:.6f} {len(equations)} {columns} {base}")
seconds, _ = best(lambda: orthogonal_mp_gram(gram, cross, n_nonzero_coefs=2))
print(f"sklearn.orthogonal_mp_gram {seconds:.6f} {len(equations)} {columns} {base}")
print("columns", *numpy.flatnonzero(chosen))
