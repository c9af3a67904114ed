#!/usr/bin/env python3
"""What a drape from Python costs more than from Rust.

    pip install crates/garnet-python
    python benches/python/call_cost.py [--package models/tshirt] [--runs 40]

Each drape is timed twice at once: by Python around the call, arrays made and all, and by the
library inside of it. The difference is what a call from Python adds; besides, it has what the
library does before and after its steps, so that it is never too small. Prints medians in
milliseconds, and the least difference, on a posed body and on an array of vertices, which the body is
fitted to first. What a call adds does not depend on the method: quick ones tell it best, on a machine
with nothing else to do. Last, what the arrays alone cost: vertices of a body in, one too few, so that
they are refused once they are read, and of the garment out. Ends with 1 if a median is more than a
millisecond.
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
    parser.add_argument("--methods", nargs="+", default=["warp", "fast"])
    parser.add_argument("--runs", type=int, default=40)
    arguments = parser.parse_args()
    package = garnet.Package(arguments.package)
    posed = package.body.posed(arguments.pose)
    vertices = posed.vertices
    worst = 0.0
    print("method      target   Python     Rust   more  least   (ms)")
    for method in arguments.methods:
        for target, name in ((posed, "posed"), (vertices, "array")):
            rows = []
            for _ in range(arguments.runs + 1):
                whole, drape = timed(lambda: keep(package, target, method))
                own = 1e3 * drape.seconds["total"]
                rows.append((whole, own, whole - own))
            medians = [statistics.median(row) for row in zip(*rows[1:])]
            worst = max(worst, medians[2])
            least = min(row[2] for row in rows)
            shown = " ".join(f"{value:8.2f}" for value in medians[:2])
            print(f"{method:11} {name:6} {shown} {medians[2]:6.2f} {least:6.2f}", flush=True)
    print(f"at most {worst:.2f} ms more")
    few = vertices[:-1]
    ways = {"in": lambda: refused(package.body.fitted, few), "out": lambda: package.vertices}
    for way, call in ways.items():
        times = [timed(call)[0] for _ in range(200)]
        print(f"arrays {way}: {statistics.median(times):.3f} ms")
    return 0 if worst <= MOST else 1


def refused(call, argument):
    """What raises a `ValueError`."""
    try:
        call(argument)
    except ValueError:
        return
    raise AssertionError("the array was not refused")


def keep(package, target, method):
    """A drape, its array made."""
    drape = package.drape(target, method=method)
    drape.vertices
    return drape


if __name__ == "__main__":
    sys.exit(main())
