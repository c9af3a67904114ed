#!/usr/bin/env python3
"""The network of garnet in PyTorch: checks that outputs agree and compares times.

    python3 benches/python/garnet_torch.py CASE --ours paper 10000 6890 [--threads N] [--runs N]

runs `cargo run --release -p garnet-lab -- torch-case paper 10000 6890 CASE`, which times
garnet and writes CASE.weights.safetensors and CASE.case.safetensors, then the same network with the same
weights in PyTorch: eager, with torch.compile (left out by --no-compile), and eager with the FeaStConv of
torch_geometric, where that is installed. For each it checks that the outputs agree and prints the median
time of a forward pass and of a training step (mean square, Adam), and how many times as long as garnet it
takes. Without --ours the two files have to be there, and no ratios are printed.

The reference values of crates/garnet-net/tests/torch.rs are made by

    cd crates/garnet-net/tests/data
    cargo run -p garnet-lab -- torch-case tiny 60 80 network
    python3 ../../../../benches/python/garnet_torch.py network --save network.torch.json

Needs torch, safetensors and numpy; nothing else in this repository needs Python.
"""

import argparse
import copy
import json
import os
import re
import statistics
import subprocess
import time

import torch
import torch.nn.functional as F
from package_torch import GarNet, leaky
from safetensors import safe_open

try:
    from torch_geometric.nn import FeaStConv
except ImportError:
    FeaStConv = None

TOLERANCE = 1e-4

# Every edge has all heads of all channels in memory: some runs are enough.
MAX_RUNS_OF_GEOMETRIC = 3


class GeometricNet(GarNet):
    """The same with the convolutions of torch_geometric."""

    def __init__(self, weights, config, case):
        super().__init__(weights, config, case)
        offsets, ring = case["ring_offsets"][0], case["ring_vertices"][0]
        row = torch.repeat_interleave(torch.arange(len(offsets) - 1), offsets[1:] - offsets[:-1])
        self.edges = torch.stack([ring.long(), row])
        self.convolutions = torch.nn.ModuleDict()
        for name in [name[:-2] for name in weights if name.endswith(".u")]:
            u, w = weights[f"{name}.u"], weights[f"{name}.w"]
            (channels, heads), out = u.shape, w.shape[1]
            layer = FeaStConv(channels, out, heads, add_self_loops=False)
            w = w.view(heads, channels, out).permute(0, 2, 1).reshape(heads * out, channels)
            layer.u.weight.data = torch.cat([u[:-3], u[-3:] * self.scale]).T.contiguous()
            layer.c.data, layer.bias.data = weights[f"{name}.c"].clone(), weights[f"{name}.b"].clone()
            layer.lin.weight.data = w.contiguous()
            self.convolutions[self.names[f"{name}.u"]] = layer

    def convolution(self, at, places, features, residual):
        layer = self.convolutions[self.names[f"{at}.u"]]
        y = layer(torch.cat([features, places], 1), self.edges)
        return leaky(y if residual is None else y + residual)


def times_of_ours(case, preset, vertices, points, threads):
    """Times garnet and lets it write the case; milliseconds of a forward pass and of a step."""
    command = ["cargo", "run", "--release", "-q", "-p", "garnet-lab", "--", "torch-case"]
    run = subprocess.run(
        command + [preset, vertices, points, case],
        env={**os.environ, "RAYON_NUM_THREADS": str(threads)},
        stdout=subprocess.PIPE,
        text=True,
        check=True,
    )
    print(run.stdout.strip())
    found = re.search(r"network ([0-9.]+) ms.*step ([0-9.]+) ms", run.stdout)
    return [float(number) for number in found.groups()]


def median(run, runs):
    run()
    times = []
    for _ in range(runs):
        start = time.perf_counter()
        run()
        times.append(1e3 * (time.perf_counter() - start))
    return statistics.median(times)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("case", help="what was given to `garnet-lab torch-case`")
    parser.add_argument("--ours", nargs=3, metavar=("PRESET", "VERTICES", "POINTS"))
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--runs", type=int, default=7)
    parser.add_argument("--no-compile", action="store_true")
    parser.add_argument("--save", help="write the translations, in double precision, and stop")
    arguments = parser.parse_args()
    torch.set_num_threads(arguments.threads)
    ours_ms = None
    if arguments.ours:
        ours_ms = times_of_ours(arguments.case, *arguments.ours, arguments.threads)

    with safe_open(f"{arguments.case}.weights.safetensors", "pt") as file:
        config = json.loads(file.metadata()["garnet"])["config"]
        weights = {name: file.get_tensor(name).float() for name in file.keys()}
    with safe_open(f"{arguments.case}.case.safetensors", "pt") as file:
        case = {name: file.get_tensor(name) for name in file.keys()}

    if arguments.save:
        double = {name: x.double() if x.is_floating_point() else x for name, x in case.items()}
        net = GarNet({name: x.double() for name, x in weights.items()}, config, double)
        with torch.no_grad():
            rows = [[float(f"{x:.9g}") for x in row] for row in net(double).tolist()]
        with open(arguments.save, "w") as file:
            json.dump({"translations": rows}, file)
            file.write("\n")
        return

    expected = case["translations"]
    net = GarNet(weights, config, case)
    forms = {"eager": net}
    if not arguments.no_compile:
        forms["torch.compile"] = torch.compile(net)
    if FeaStConv is not None:
        forms["torch_geometric"] = GeometricNet(weights, config, case)
    for name, form in forms.items():
        with torch.no_grad():
            error = ((form(case) - expected).abs().max() / expected.abs().max()).item()
        if not error <= TOLERANCE:
            raise SystemExit(f"garnet and {name} disagree: {error:.2e} is above {TOLERANCE:.0e}")
        form_of_step = copy.deepcopy(form) if name == "eager" else form
        adam = torch.optim.Adam(form_of_step.parameters(), 1e-5)

        def forward(form=form):
            with torch.no_grad():
                form(case)

        def step(form=form_of_step, adam=adam):
            adam.zero_grad()
            F.mse_loss(form(case), expected * 0.5).backward()
            adam.step()

        runs = arguments.runs
        if name == "torch_geometric":
            runs = min(runs, MAX_RUNS_OF_GEOMETRIC)
        times = [median(forward, runs), median(step, max(2, runs // 2))]
        line = (
            f"{name}, {arguments.threads} threads: forward {times[0]:.1f} ms, step {times[1]:.1f} ms, "
            f"largest difference over the largest translation {error:.1e}"
        )
        if ours_ms:
            forward_ratio, step_ratio = (theirs / ours for theirs, ours in zip(times, ours_ms))
            line += f"; of garnet's: forward {forward_ratio:.2f} x, step {step_ratio:.2f} x"
        print(line, flush=True)


if __name__ == "__main__":
    main()
