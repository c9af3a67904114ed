#!/usr/bin/env python3
"""The networks of a garment package in PyTorch, in one file: any variant, from its weights.

    garnet drape models/tshirt BODY.obj --method fast -o shirt.obj --export-inputs fast.safetensors
    python benches/python/package_torch.py models/tshirt fast.safetensors

loads the variant that the inputs were exported for, runs it, and compares what comes out with what
garnet said: the largest difference over the largest that the network moves a vertex. It ends with 1
if that is above 1e-4.

`Regions` is what `fast`, `balanced` and `accurate` are, `Scenes` the pose-space deformation that a
GarNet starts from, `GarNet` the network of the paper. All are modules with parameters: they can be
trained on, or be taken apart. Needs torch 1.13 or newer, numpy and safetensors.
"""

import argparse
import json
import pathlib
import re
import sys

import numpy as np
import torch
import torch.nn.functional as F
from safetensors import safe_open

TOLERANCE = 1e-4

# The length unit of GarNet, in metres.
UNIT = 0.1


def read_arrays(path):
    """The text under the key `garnet` of a safetensors file, and its arrays."""
    with safe_open(path, "np") as file:
        header = json.loads(file.metadata()["garnet"])
        arrays = {name: file.get_tensor(name) for name in file.keys()}
    return header, arrays


def read_weights(path):
    """What a weight file says, and its weights as 32 bits.

    A matrix of 8 bits has a tensor `NAME.scale` beside it, a number for each of its rows, which is
    the first index.
    """
    header, arrays = read_arrays(path)
    weights = {}
    for name, value in arrays.items():
        scale = arrays.get(f"{name}.scale")
        if value.dtype == np.int8:
            value = value.astype(np.float32) * scale.reshape([-1] + [1] * (value.ndim - 1))
        elif name.endswith(".scale") and arrays.get(name[:-6], value).dtype == np.int8:
            continue
        weights[name] = torch.from_numpy(np.array(value, np.float32))
    return header, weights


class Stored(torch.nn.Module):
    """A module with the weights of a file, by their names there.

    Vertex numbers and scales of inputs are not trained: what `fixed` matches.
    """

    def __init__(self, weights, fixed=r"$^"):
        super().__init__()
        self.names = {name: name.replace(".", "__") for name in weights}
        for name, value in weights.items():
            is_trained = not re.search(fixed, name)
            parameter = torch.nn.Parameter(value.clone(), requires_grad=is_trained)
            self.register_parameter(self.names[name], parameter)

    def weight(self, name):
        return getattr(self, self.names[name])

    def has(self, name):
        return name in self.names


def rotated(quaternions, vectors):
    """Vectors [n, 3] turned by quaternions x, y, z, w [n, 4]."""
    axis, real = quaternions[:, :3], quaternions[:, 3:]
    twice = 2 * torch.cross(axis, vectors, dim=1)
    return vectors + real * twice + torch.cross(axis, twice, dim=1)


class Features:
    """What networks of regions are told of pose and shape, ten numbers a joint.

    The first six are two columns of the joint's rotation against its parent, or for the root where
    up is; the last four tell the shape of its skin.
    """

    WIDTHS = {"turn": 6, "against-hub": 6, "shape": 4, "up": 3}

    def __init__(self, header):
        self.parents, self.hub, self.all = header["parents"], header["hub"], header["all"]

    def owners(self):
        """The feature that each number belongs to."""
        widths = [self.WIDTHS[feature["aspect"]] for feature in self.all]
        return torch.repeat_interleave(torch.arange(len(widths)), torch.tensor(widths))

    def turns(self, joints):
        """Rotations of all joints in a world where the root only leans."""
        up = torch.tensor([0.0, 1.0, 0.0], dtype=joints.dtype)
        own = []
        for numbers, parent in zip(joints, self.parents):
            first, second = numbers[:3], numbers[3:6]
            if parent is None:
                # The least rotation that takes `first` to up.
                first = first / first.norm()
                axis = torch.cross(first, up, dim=0)
                zero = torch.zeros((), dtype=joints.dtype)
                x, y, z = axis
                cross = torch.stack([zero, -z, y, z, zero, -x, -y, x, zero]).view(3, 3)
                own.append(torch.eye(3, dtype=joints.dtype) + cross + cross @ cross / (1 + first @ up))
            else:
                own.append(torch.stack([first, second, torch.cross(first, second, dim=0)], 1))
        turns = []
        for joint in range(len(own)):
            turn = own[joint]
            parent = self.parents[joint]
            while parent is not None:
                turn = own[parent] @ turn
                parent = self.parents[parent]
            turns.append(turn)
        return turns

    def of(self, parameters):
        """The numbers of all features."""
        joints = parameters.view(-1, 10)
        turns = self.turns(joints)
        numbers = []
        for feature in self.all:
            joint, aspect = feature["joint"], feature["aspect"]
            if aspect == "turn":
                numbers.append(joints[joint, :6])
            elif aspect == "shape":
                numbers.append(joints[joint, 6:])
            elif aspect == "against-hub":
                numbers.append((turns[self.hub].T @ turns[joint]).T.reshape(-1)[:6])
            else:
                numbers.append(turns[joint][1])
        return torch.cat(numbers)


class Regions(Stored):
    """Where cloth is on its way, told by a small network for each region of the garment."""

    def __init__(self, header, weights):
        super().__init__(weights, r"^(center|mirror|images)$|\.(vertices|scales)$")
        self.features = Features(header["features"])
        self.owners = self.features.owners()
        self.count = sum(name.endswith(".vertices") for name in weights)

    def side(self, numbers):
        """Offsets [vertex, 3] that the regions tell of one side."""
        offsets = torch.zeros_like(self.weight("mean"))
        for region in range(self.count):
            at = f"region.{region}"
            scales = self.weight(f"{at}.scales")[self.owners]
            kept = scales > 0
            x = (scales * (numbers - self.weight("center")))[kept]
            depth = 0
            while self.has(f"{at}.{depth}.weight"):
                x = F.silu(x) if depth > 0 else x
                x = x @ self.weight(f"{at}.{depth}.weight") + self.weight(f"{at}.{depth}.bias")
                depth += 1
            moved = torch.tensordot(x, self.weight(f"{at}.shapes"), 1)
            offsets = offsets.index_add(0, self.weight(f"{at}.vertices").long(), moved)
        return offsets

    def offsets(self, parameters):
        """Offsets from the warp in the frames of the skin [vertex, 3], in metres."""
        offsets = self.weight("mean") + self.side(self.features.of(parameters))
        if self.has("mirror"):
            exchange = self.weight("mirror")
            mirrored = exchange[:, 1] * parameters[exchange[:, 0].long()]
            left = self.side(self.features.of(mirrored))
            images = self.weight("images")
            corners, shares = images[:, :3].long(), images[:, 3:]
            image = (shares[..., None] * left[corners]).sum(1)
            offsets = offsets + image * torch.tensor([-1.0, 1.0, 1.0])
        return offsets

    def forward(self, case):
        offsets = self.offsets(case["input.parameters"][0])
        return case["input.warped"] + rotated(case["input.rotations"], offsets)


class Scenes(Regions):
    """A pose-space deformation: drapes of the training, by how alike poses and shapes are."""

    def __init__(self, header, weights):
        Stored.__init__(self, weights, r"^(centers|mirror|parity|scales)$")

    def sums(self, parameters):
        # Large weights cancel each other: summed in another order than garnet does, one after the
        # other in 32 bits, the cloth is tenths of a millimetre elsewhere.
        scales = self.weight("scales")
        place = (scales * parameters)[scales > 0]
        squared = sum((self.weight("centers") - place).square().unbind(1))
        distance = (3 * squared.double()).sqrt()
        alike = ((1 + distance) * torch.exp(-distance)).float()
        return sum((alike[:, None] * self.weight("weights")).unbind(0))

    def offsets(self, parameters):
        shares = self.sums(parameters)
        if self.has("mirror"):
            exchange = self.weight("mirror")
            mirrored = exchange[:, 1] * parameters[exchange[:, 0].long()]
            shares = shares + self.weight("parity") * self.sums(mirrored)
        return self.weight("mean") + torch.tensordot(shares, self.weight("shapes"), 1)


def leaky(x):
    return F.leaky_relu(x, 0.1)


class GarNet(Stored):
    """The figure of the paper, with the weights under the names of the file."""

    def __init__(self, weights, config, case):
        super().__init__(weights)
        self.config = config
        self.scale = UNIT / config["mean_edge_length"]
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


class Started(torch.nn.Module):
    """A GarNet on the pose-space deformation that it starts from, if it starts from one."""

    def __init__(self, start, network):
        super().__init__()
        self.start, self.network = start, network

    def forward(self, case):
        places = case["start"] if self.start is None else self.start(case)
        frames = case["frames"].view(-1, 3, 3)
        moved = UNIT * self.network(case)[:, :, None]
        return places + (frames @ moved)[:, :, 0]


def deformation(path):
    """A pose-space deformation of either kind."""
    header, weights = read_weights(path)
    return (Regions if header.get("features") else Scenes)(header, weights)


def load(folder, variant, case):
    """The module of a variant of a package: what is given as a case gives positions, in metres."""
    folder = pathlib.Path(folder)
    path = folder / weights_of(folder / "garment.toml", variant)
    header, weights = read_weights(path)
    if header["schema"].startswith("garnet-pose-space/"):
        return deformation(path)
    config = header["config"]
    start = config["start"]
    at = path.with_name(f"{start}.safetensors")
    start = deformation(at) if header.get("pose_space") else None
    return Started(start, GarNet(weights, config, case))


def weights_of(manifest, variant):
    """The file of a variant, by its name or an older one."""
    for block in pathlib.Path(manifest).read_text().split("[[variant]]")[1:]:
        names = re.findall(r'^(?:name|aliases) = (.*)$', block, re.M)
        if f'"{variant}"' in " ".join(names):
            return re.search(r'^weights = "(.*)"$', block, re.M).group(1)
    sys.exit(f"{manifest} has no variant `{variant}`")


def read_case(path):
    """What a variant is told, and what garnet says, as tensors."""
    header, arrays = read_arrays(path)
    return header, {name: torch.from_numpy(np.array(value)) for name, value in arrays.items()}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("package", help="folder of the package")
    parser.add_argument("case", nargs="+", help="what `garnet drape --export-inputs` wrote")
    arguments = parser.parse_args()
    worst = 0.0
    for path in arguments.case:
        header, case = read_case(path)
        model = load(arguments.package, header["variant"], case)
        with torch.no_grad():
            found = model(case)
        expected = case["output.positions"]
        moved = (expected - case["input.warped"]).norm(dim=1).max().item()
        apart = (found - expected).norm(dim=1).max().item()
        worst = max(worst, apart / moved)
        print(
            f"{header['variant']} at {header['moment']}: {len(found)} vertices moved by up to "
            f"{1e3 * moved:.1f} mm, {1e3 * apart:.1e} mm apart, {apart / moved:.1e} of that"
        )
    return 0 if worst <= TOLERANCE else 1


if __name__ == "__main__":
    sys.exit(main())
