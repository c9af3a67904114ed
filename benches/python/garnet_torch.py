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
from safetensors import safe_open

try:
    from torch_geometric.nn import FeaStConv
except ImportError:
    FeaStConv = None

TOLERANCE = 1e-4

# Every edge has all heads of all channels in memory: some runs are enough.
MAX_RUNS_OF_GEOMETRIC = 3


def leaky(x):
    return F.leaky_relu(x, 0.1)


class Net(torch.nn.Module):
    """The figure of the paper, with the weights under the names of the file."""

    def __init__(self, weights, config, case):
        super().__init__()
        self.names = {name: name.replace(".", "__") for name in weights}
        for name, value in weights.items():
            self.register_parameter(self.names[name], torch.nn.Parameter(value.clone()))
        self.config = config
        self.scale = 0.1 / config["mean_edge_length"]
        offsets, ring = case["ring_offsets"][0], case["ring_vertices"][0]
        degree = offsets[1:] - offsets[:-1]
        count = len(degree)
        row = torch.repeat_interleave(torch.arange(count), degree)
        column = torch.arange(len(ring)) - offsets[:-1][row]
        # Neighbors padded to the longest ring, with shares of zero: the fastest eager form measured.
        self.ring = torch.arange(count)[:, None].repeat(1, int(degree.max()))
        self.ring[row, column] = ring
        dtype = case["vertices"].dtype
        self.share = torch.zeros(count, int(degree.max()), 1, dtype=dtype)
        self.share[row, column] = 1 / degree[row][:, None].to(dtype)

    def weight(self, name):
        return getattr(self, self.names[name])

    def has(self, name):
        return name in self.names

    def linear(self, at, parts):
        rows = max(part.shape[0] for part in parts)
        x = torch.cat([part.expand(rows, -1) for part in parts], 1)
        return x @ self.weight(f"{at}.weight") + self.weight(f"{at}.bias")

    def mlp(self, at, parts):
        number = 0
        while self.has(f"{at}.layers.{number}.weight"):
            parts = [leaky(self.linear(f"{at}.layers.{number}", parts))]
            number += 1
        return parts[0]

    def stn(self, at, points):
        pooled = self.mlp(f"{at}.points", [points]).max(0, keepdim=True)[0]
        row = self.linear(f"{at}.matrix", [self.mlp(f"{at}.head", [pooled])])
        return points @ (row.view(3, 3) + torch.eye(3, dtype=row.dtype))

    def convolution(self, at, places, features, residual):
        x = torch.cat([features, places], 1)
        u = self.weight(f"{at}.u")
        u = torch.cat([u[:-3], u[-3:] * self.scale])
        xu = x @ u
        q = torch.softmax(xu[self.ring] - xu[:, None] + self.weight(f"{at}.c"), 2) * self.share
        z = torch.bmm(q.transpose(1, 2), x[self.ring]).reshape(len(x), -1)
        y = z @ self.weight(f"{at}.w") + self.weight(f"{at}.b")
        return leaky(y if residual is None else y + residual)

    def block(self, at, places, features):
        shortcut = features
        if self.has(f"{at}.shortcut.weight"):
            shortcut = self.linear(f"{at}.shortcut", [features])
        last = self.config["garment"]["convolutions"] - 1
        for number in range(last + 1):
            residual = shortcut if number == last else None
            features = self.convolution(f"{at}.convolutions.{number}", places, features, residual)
        return features

    def forward(self, case):
        near = []
        if self.has("body.global.weight"):
            turned = self.stn("body.stn", case["body_points"])
            inputs = [turned] + [case[name] for name in ["body_normals"] if name in case]
            points = self.mlp("body.second", [self.mlp("body.first", inputs)] + inputs)
            body = leaky(self.linear("body.global", [points])).max(0, keepdim=True)[0]
            if "nearest" in case:
                kept = points[case["averaged"]].mean(1)
                near = [kept[case["nearest"]].max(1)[0]]
        else:
            body = self.mlp("parameters", [case["parameters"]])
        places = case["vertices"]
        parts = [self.stn("garment.stn", places)]
        parts += [case[name] for name in ["features"] if name in case]
        points = self.mlp("garment.points", parts)
        features = leaky(self.linear("garment.input", [points, body]))
        stages = [points, features]
        number = 0
        while self.has(f"garment.blocks.{number}.convolutions.0.w"):
            features = self.block(f"garment.blocks.{number}", places, features)
            stages.append(features)
            number += 1
        whole = leaky(self.linear("garment.global", [features])).max(0, keepdim=True)[0]
        fused = self.mlp("fusion.hidden", stages + near + [body, whole])
        return self.linear("fusion.translation", [fused])


class GeometricNet(Net):
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
        net = Net({name: x.double() for name, x in weights.items()}, config, double)
        with torch.no_grad():
            rows = [[float(f"{x:.9g}") for x in row] for row in net(double).tolist()]
        with open(arguments.save, "w") as file:
            json.dump({"translations": rows}, file)
            file.write("\n")
        return

    expected = case["translations"]
    net = Net(weights, config, case)
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
