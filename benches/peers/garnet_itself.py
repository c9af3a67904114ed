#!/usr/bin/env python3
"""Drapes the scene by variants of the package, and prints a line for each, as the other peers do.

    python benches/peers/garnet_itself.py [--methods fast accurate] >> peers.jsonl

The time is the median of the drapes after the first one, from a posed body in memory.
"""

import argparse

import garnet

from scene import Scene, arguments, median_time


def main():
    parser = arguments(argparse.ArgumentParser(description=__doc__.splitlines()[0]))
    parser.add_argument("--methods", nargs="+", default=["fast", "accurate"])
    parser.add_argument("--runs", type=int, default=5)
    options = parser.parse_args()
    scene = Scene(options)
    for method in options.methods:
        drape = lambda: garnet.drape(scene.package, scene.target, method=method)
        places, seconds = median_time(drape, options.runs)
        scene.verdict(f"garnet {method}", "as it comes", places, seconds)


if __name__ == "__main__":
    main()
