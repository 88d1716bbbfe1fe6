#!/usr/bin/env python3
"""Numbers of scipy's filtfilt for the unit test of crates/contrapposto/src/math/lowpass.rs, on standard output.

    python3 -m venv venv && venv/bin/pip install scipy==1.17.1
    venv/bin/python scripts/filter_reference.py
"""

import numpy
import scipy.signal

i = numpy.arange(25)
signal = numpy.sin(0.5 * i) + (i % 3) / 5
for order in [2, 3, 4]:
    row = scipy.signal.filtfilt(*scipy.signal.butter(order, 0.24), signal)
    print(f"({order}, [{', '.join(repr(float(value)) for value in row)}]),")
