#!/usr/bin/env python3
"""Numbers of scipy's filtfilt and splines for tests of crates/contrapposto (src/math/lowpass.rs, tests/dynamics.rs), on standard output.

    python3 -m venv venv && venv/bin/pip install scipy==1.17.1
    venv/bin/python scripts/filter_reference.py
"""

import numpy
import scipy.interpolate
import scipy.signal

i = numpy.arange(25)
signal = numpy.sin(0.5 * i) + (i % 3) / 5
for order in [2, 3, 4]:
    row = scipy.signal.filtfilt(*scipy.signal.butter(order, 0.24), signal)
    print(f"({order}, [{', '.join(repr(float(value)) for value in row)}]),")

# Value, speed and acceleration of a natural quintic spline through the filtered signal at 100 Hz, for crates/contrapposto/tests/dynamics.rs.
filtered = scipy.signal.filtfilt(*scipy.signal.butter(2, 0.24), signal)
ends = [(3, 0.0), (4, 0.0)]
spline = scipy.interpolate.make_interp_spline(i / 100, filtered, k=5, bc_type=(ends, ends))
for at in range(0, 25, 4):
    print(f"({at}, [{', '.join(repr(float(spline(at / 100, order))) for order in range(3))}]),")
