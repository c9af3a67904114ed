#!/usr/bin/env python3
"""What a drape from Python costs more than from Rust.

    pip install crates/garnet-python
    python benches/python/call_cost.py [--package models/tshirt] [--runs 40]

Each drape is timed twice at once: by Python around the call, arrays made and all, and by the
library inside of it. The difference is what a call from Python adds; besides, it has what the
library does before and after its steps, so that it is never too small. Prints medians in
milliseconds for each variant, on a posed body and on an array of vertices, which the body is fitted
to first. Ends with 1 if a drape costs more than a millisecond.
"""

import argparse
import statistics
import sys
import time

import garnet

MOST = 1.0


def timed(call):
    start = time.perf_counter()
    result = call()
    return 1e3 * (time.perf_counter() - start), result


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--package", default="models/tshirt")
    parser.add_argument("--pose", default="wave")
    parser.add_argument("--runs", type=int, default=40)
    arguments = parser.parse_args()
    package = garnet.Package(arguments.package)
    posed = package.body.posed(arguments.pose)
    vertices = posed.vertices
    worst = 0.0
    print("method      target   Python     Rust   more   (ms, medians)")
    for method in ("warp", "fast", "balanced", "accurate"):
        for target, name in ((posed, "posed"), (vertices, "array")):
            rows = []
            for _ in range(arguments.runs + 1):
                whole, drape = timed(lambda: keep(package, target, method))
                own = 1e3 * drape.seconds["total"]
                rows.append((whole, own, whole - own))
            medians = [statistics.median(row) for row in zip(*rows[1:])]
            worst = max(worst, medians[2])
            print(f"{method:11} {name:6} {medians[0]:8.2f} {medians[1]:8.2f} {medians[2]:6.2f}")
    print(f"at most {worst:.2f} ms more")
    return 0 if worst <= MOST else 1


def keep(package, target, method):
    """A drape, its array made."""
    drape = package.drape(target, method=method)
    drape.vertices
    return drape


if __name__ == "__main__":
    sys.exit(main())
