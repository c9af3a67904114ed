"""What the tests share: the models of the repository, and the command to compare with."""

import os
import pathlib
import shutil

import pytest

import garnet

ROOT = pathlib.Path(__file__).resolve().parents[3]
MODELS = ROOT / "models"


def read_obj(path):
    """Vertices and triangles of an OBJ whose polygons are convex."""
    vertices, faces = [], []
    for line in pathlib.Path(path).read_text().splitlines():
        words = line.split()
        if words[:1] == ["v"]:
            vertices.append([float(word) for word in words[1:4]])
        elif words[:1] == ["f"]:
            corners = [int(word.split("/")[0]) - 1 for word in words[1:]]
            faces += [[corners[0], a, b] for a, b in zip(corners[1:], corners[2:])]
    return vertices, faces


@pytest.fixture(scope="session")
def shirt():
    return garnet.Package(MODELS / "tshirt")


@pytest.fixture(scope="session")
def command():
    """The command `garnet`: that of GARNET_COMMAND, a build in target/, or that of the path."""
    named = [os.environ.get("GARNET_COMMAND")]
    built = [ROOT / "target" / profile / "garnet" for profile in ("release", "debug")]
    for path in named + built + [shutil.which("garnet")]:
        if path and pathlib.Path(path).is_file():
            return str(path)
    pytest.skip("there is no command `garnet`: build it, or name it by GARNET_COMMAND")


def capsule(radius=0.05, half=0.3, rings=25, sides=24):
    """A closed skin along y: an arm, [n, 3] and [m, 3]."""
    import numpy as np

    turns = np.linspace(0, 2 * np.pi, sides, endpoint=False)
    tilt = np.linspace(0, np.pi / 2, 7)[1:]
    heights = list(-half - radius * np.cos(tilt[:-1])) + list(np.linspace(-half, half, rings))
    radii = list(radius * np.sin(tilt[:-1])) + [radius] * rings
    heights += list(half + radius * np.cos(tilt[:-1][::-1]))
    radii += list(radius * np.sin(tilt[:-1][::-1]))
    around = np.stack([np.sin(turns), np.cos(turns)], 1)
    vertices = [[0, -half - radius, 0]]
    for height, size in zip(heights, radii):
        vertices += [[size * x, height, size * z] for x, z in around]
    vertices.append([0, half + radius, 0])
    return np.array(vertices), closed_faces(len(heights), sides)


def closed_faces(rings, sides):
    last = 1 + rings * sides
    faces = []
    for side in range(sides):
        following = (side + 1) % sides
        faces.append([0, 1 + following, 1 + side])
        for ring in range(rings - 1):
            a, b = 1 + ring * sides + side, 1 + ring * sides + following
            faces += [[a, b, b + sides], [a, b + sides, a + sides]]
        top = 1 + (rings - 1) * sides
        faces.append([last, top + side, top + following])
    return faces


def tube(radius=0.06, half=0.2, rings=31, sides=32):
    """A sleeve along y, open at its ends."""
    import numpy as np

    turns = np.linspace(0, 2 * np.pi, sides, endpoint=False)
    vertices = [
        [radius * np.sin(turn), height, radius * np.cos(turn)]
        for height in np.linspace(-half, half, rings)
        for turn in turns
    ]
    faces = []
    for ring in range(rings - 1):
        for side in range(sides):
            a, b = ring * sides + side, ring * sides + (side + 1) % sides
            faces += [[a, b, b + sides], [a, b + sides, a + sides]]
    return np.array(vertices), np.array(faces)


@pytest.fixture(scope="session")
def arm():
    """A body of two bones along y, bent at its elbow by one turn about x."""
    import numpy as np

    vertices, faces = capsule()
    forearm = np.clip(0.5 + vertices[:, 1] / 0.1, 0, 1)
    weights = np.stack([1 - forearm, forearm], 1)
    joints = [[0, -0.3, 0], [0, 0, 0]]
    return garnet.Body(vertices, faces, joints, [-1, 0], weights, names=["shoulder", "elbow"])
