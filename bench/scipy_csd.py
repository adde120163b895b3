"""scipy_csd.py FILE [REPEATS]: CPU seconds scipy takes for cross spectrum and coherence of the noise that frf_bench
wrote (command, then response, doubles), with the same window, overlap and segments. No variances, no model. Best of
REPEATS (default 20)."""

import sys
import time

import numpy
import scipy.signal

command, response = numpy.fromfile(sys.argv[1]).reshape(2, -1)
seconds = []
for _ in range(int(sys.argv[2]) if len(sys.argv) > 2 else 20):
    begin = time.process_time()
    scipy.signal.csd(command, response, 1000, nperseg=4096)
    scipy.signal.coherence(command, response, 1000, nperseg=4096)
    seconds.append(time.process_time() - begin)
print(f"scipy.signal.csd+coherence {min(seconds):.6f}")
