"""pandas_read.py LOG [REPEATS]: CPU seconds pandas takes to read the CSV file and nothing else, best of REPEATS."""

import sys
import time

import pandas

best = float("inf")
for _ in range(int(sys.argv[2]) if len(sys.argv) > 2 else 5):
    start = time.process_time()
    rows = len(pandas.read_csv(sys.argv[1]))
    best = min(best, time.process_time() - start)
print(f"pandas.read_csv {best:.4f} {rows}")
