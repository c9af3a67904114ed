#!/usr/bin/env python3
"""Drapes the scene by variants of the package, and prints a line for each, as the other peers do.

    python benches/peers/garnet_itself.py [--methods fast accurate] >> peers.jsonl

The time is the median of the drapes after the first one, from a posed body in memory.
"""

import argparse
import statistics
import time

import garnet

from scene import Scene, arguments


def main():
    parser = arguments(argparse.ArgumentParser(description=__doc__.splitlines()[0]))
    parser.add_argument("--methods", nargs="+", default=["fast", "accurate"])
    parser.add_argument("--runs", type=int, default=5)
    options = parser.parse_args()
    scene = Scene(options)
    for method in options.methods:
        times = []
        for _ in range(options.runs + 1):
            start = time.perf_counter()
            places = garnet.drape(scene.package, scene.target, method=method)
            times.append(time.perf_counter() - start)
        scene.verdict(f"garnet {method}", "as it comes", places, statistics.median(times[1:]))


if __name__ == "__main__":
    main()
