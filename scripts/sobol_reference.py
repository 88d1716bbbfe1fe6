#!/usr/bin/env python3
"""Writes the direction numbers of Joe & Kuo 2008 that scipy carries, and reference numbers of scipy for the tests of contrapposto-sweep.

Usage: sobol_reference.py table > crates/contrapposto-sweep/src/sobol_table.rs; sobol_reference.py numbers > crates/contrapposto-sweep/tests/scipy.csv
"""

import os
import sys

import numpy
import scipy
from scipy.stats import norm, qmc

DIMENSIONS = 64


def table():
    numbers = numpy.load(os.path.join(os.path.dirname(scipy.__file__), "stats", "_sobol_direction_numbers.npz"))
    print("//! Holds the primitive polynomials and first direction numbers of Joe & Kuo 2008 (SIAM J. Sci. Comput. 30:2635-2654), file")
    print("//! new-joe-kuo-6.21201, as scipy carries them; `scripts/sobol_reference.py` writes this file.")
    print()
    print("/// The polynomial of a dimension, one bit a coefficient, and its first direction numbers.")
    print("pub(crate) struct Direction {")
    print("    pub(crate) polynomial: u32,")
    print("    pub(crate) first: &'static [u32],")
    print("}")
    print()
    print("/// The dimensions after the first one.")
    print(f"pub(crate) const TABLE: [Direction; {DIMENSIONS - 1}] = [")
    for polynomial, first in zip(numbers["poly"][1:DIMENSIONS], numbers["vinit"][1:DIMENSIONS]):
        degree = int(polynomial).bit_length() - 1
        print(f"    Direction {{ polynomial: {polynomial}, first: &{[int(number) for number in first[:degree]]} }},")
    print("];")


def numbers():
    print("# scipy", scipy.__version__, "stats.qmc.Sobol(64, scramble=False): point, its 64 coordinates; then norm.ppf and norm.cdf")
    points = qmc.Sobol(DIMENSIONS, scramble=False).random(1025)
    for index in [0, 1, 2, 3, 7, 100, 511, 1024]:
        print(f"sobol,{index}," + ",".join(repr(float(x)) for x in points[index]))
    sampler = qmc.Sobol(DIMENSIONS, scramble=False)
    sampler.fast_forward(1_000_003)
    print("sobol,1000003," + ",".join(repr(float(x)) for x in sampler.random(1)[0]))
    for p in [1e-15, 1e-12, 1e-9, 1e-6, 1e-3, 0.02, 0.074, 0.076, 0.3, 0.5, 0.77, 0.924, 0.926, 0.999, 1 - 1e-9]:
        print(f"quantile,{p!r},{float(norm.ppf(p))!r}")
    for x in [-7.5, -5.0, -3.0, -1.0, -1e-3, 0.0, 0.5, 1.0, 2.0, 4.0, 6.0]:
        print(f"cumulative,{x!r},{float(norm.cdf(x))!r}")


{"table": table, "numbers": numbers}[sys.argv[1]]()
