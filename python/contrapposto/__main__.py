"""Carries out a command line of the program `contrapposto`: `python -m contrapposto demo --out out`."""

from contrapposto._program import main

main()
