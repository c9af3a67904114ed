#!/usr/bin/env python3
"""Drapes the scene by a network of the package in PyTorch, and prints a line for each, as the other
peers do.

    python benches/peers/pytorch_network.py [--methods fast local] >> peers.jsonl

`benches/python/package_torch.py` loads the weights, and the inputs that `garnet drape
--export-inputs` writes. The time is the median of the networks alone, in memory: what PyTorch has no
part in, the warp and the neighbours, is not in it. Nothing is relaxed or untangled. Needs torch and
safetensors beside what the other peers need.
"""

import argparse
import pathlib
import subprocess
import sys
import tempfile

import numpy as np
import torch

from scene import Scene, arguments, median_time, read_vertices

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "python"))

import package_torch  # noqa: E402


def exported(options, method, folder):
    """Inputs of a network, and where the garment is in the scene if only the network moves it."""
    case, drape = folder / "case.safetensors", folder / "drape.obj"
    command = [options.garnet, "drape", options.package, "--pose", options.pose]
    command += ["--method", method, "--settle", "0", "--no-untangle"]
    command += ["--export-inputs", str(case), "-o", str(drape), "-q"]
    subprocess.run(command, check=True)
    return package_torch.read_case(case), read_vertices(drape)


def brought(places, known, there):
    """Places by the rigid transform that brings known places there (Kabsch 1976)."""
    middle, middle_there = known.mean(0), there.mean(0)
    left, _, right = np.linalg.svd((known - middle).T @ (there - middle_there))
    flip = np.diag([1, 1, np.sign(np.linalg.det(left @ right))])
    return (places - middle) @ left @ flip @ right + middle_there


def main():
    parser = arguments(argparse.ArgumentParser(description=__doc__.splitlines()[0]))
    parser.add_argument("--methods", nargs="+", default=["fast", "local"])
    parser.add_argument("--runs", type=int, default=11)
    options = parser.parse_args()
    scene = Scene(options)
    for method in options.methods:
        with tempfile.TemporaryDirectory() as folder:
            (header, case), there = exported(options, method, pathlib.Path(folder))
        model = package_torch.load(options.package, header["variant"], case)
        with torch.no_grad():
            found, seconds = median_time(lambda: model(case), options.runs)
        known = case["output.positions"].numpy().astype(float)
        places = brought(found.numpy().astype(float), known, there)
        settings = f"torch {torch.__version__}, {torch.get_num_threads()} threads, the network alone"
        scene.verdict(f"PyTorch {method}", settings, places, seconds)


if __name__ == "__main__":
    main()
