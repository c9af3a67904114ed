"""The scene that all peers drape: a garment on its body, which goes from rest to a pose.

As in the simulator of garnet the body moves for a second, eased at both ends, and then stands. A
peer is at rest at the end of the first frame, after the motion, in which no more than one vertex of
a hundred is faster than 5 mm/s; it is given four seconds for that.
"""

import json
import os
import pathlib
import platform
import statistics
import subprocess
import tempfile
import time

import numpy as np

import garnet

ROOT = pathlib.Path(__file__).resolve().parents[2]
MOTION_SECONDS = 1.0
MOST_SECONDS = 5.0
STILL_SPEED = 0.005
MOST_MOVING = 0.01


def arguments(parser):
    """The options that all peers take."""
    parser.add_argument("--package", default=str(ROOT / "models/tshirt"))
    parser.add_argument("--pose", default="wave", help="a pose of the library")
    parser.add_argument("--garnet", default=str(ROOT / "target/release/garnet"), help="the command")
    parser.add_argument("--out", help="where the drape goes, as OBJ")
    return parser


class Scene:
    def __init__(self, options):
        self.options = options
        self.package = garnet.Package(options.package)
        self.body = self.package.body
        self.target = self.body.posed(options.pose)
        self.turns, self.shift = self.local_turns()

    def local_turns(self):
        """Axis-angles of the joints against their parents, and the shift of the root."""
        transforms = self.target.transforms
        turns = []
        for joint, parent in enumerate(self.body.parents):
            turn = transforms[joint, :3, :3]
            turns.append(axis_angle(turn if parent < 0 else transforms[parent, :3, :3].T @ turn))
        root = self.body.parents.index(-1)
        place = np.append(self.body.joints[root], 1.0)
        return np.array(turns), (transforms[root] @ place)[:3] - self.body.joints[root]

    def body_at(self, seconds):
        """Vertices of the body at a time."""
        share = np.clip(seconds / MOTION_SECONDS, 0, 1)
        share = share * share * (3 - 2 * share)
        if share == 1:
            return self.target.vertices
        return self.body.posed(share * self.turns, translation=share * self.shift).vertices

    def rest_time(self, last, now, frame_seconds):
        """Whether the cloth has come to rest between two frames."""
        speeds = np.linalg.norm(now - last, axis=1) / frame_seconds
        return np.quantile(speeds, 1 - MOST_MOVING) < STILL_SPEED

    def simulate(self, step, frame_seconds):
        """Calls `step(body vertices, time)` for each frame until the cloth is at rest.

        Gives its last places, how long all steps took, the simulated time, and whether it rests.
        What moves the body is not timed.
        """
        last, taken = self.package.vertices, 0.0
        frames = round(MOST_SECONDS / frame_seconds)
        for frame in range(1, frames + 1):
            now = frame * frame_seconds
            body = self.body_at(now)
            start = time.perf_counter()
            places = step(body, frame)
            taken += time.perf_counter() - start
            if not np.isfinite(places).all():
                return last, taken, now, False
            is_after = now > MOTION_SECONDS + frame_seconds / 2
            if is_after and self.rest_time(last, places, frame_seconds):
                return places, taken, now, True
            last = places
        return last, taken, frames * frame_seconds, False

    def simulator(self):
        """The drape of garnet's own simulator."""
        with tempfile.TemporaryDirectory() as folder:
            out = pathlib.Path(folder) / "simulated.obj"
            command = [self.options.garnet, "drape", self.options.package, "--pose", self.options.pose]
            subprocess.run([*command, "--method", "sim", "-o", str(out), "-q"], check=True)
            return read_vertices(out)

    def verdict(self, name, settings, places, seconds, simulated=None, is_at_rest=True):
        """The line of a peer, as `garnet chart --peers` reads it."""
        judged = self.package.judge(places, self.target)
        expected = self.simulator()
        distances = np.linalg.norm(places - expected, axis=1)
        if self.options.out:
            write_obj(self.options.out, places, self.package.faces)
        line = {
            "schema": "garnet.peer/1",
            "name": name,
            "settings": settings,
            "garment": self.package.name,
            "pose": self.options.pose,
            "vertices": len(places),
            "machine": f"{processor()}, {os.cpu_count()} cores",
            "seconds": seconds,
            "simulated_seconds": simulated,
            "is_at_rest": is_at_rest,
            "distance_m": float(distances.mean()),
            "largest_distance_m": float(distances.max()),
            **judged,
        }
        print(json.dumps(line), flush=True)


def median_time(call, runs):
    """What a call gives, and the median time of so many after the first one."""
    times = []
    for _ in range(runs + 1):
        start = time.perf_counter()
        found = call()
        times.append(time.perf_counter() - start)
    return found, statistics.median(times[1:])


def axis_angle(turn):
    """The axis-angle of a rotation matrix."""
    vector = np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]])
    sine, cosine = np.linalg.norm(vector) / 2, (np.trace(turn) - 1) / 2
    angle = np.arctan2(sine, cosine)
    if sine < 1e-9:
        return np.zeros(3)
    return vector / (2 * sine) * angle


def read_vertices(path):
    rows = (line.split() for line in open(path))
    return np.array([row[1:4] for row in rows if row[:1] == ["v"]], float)


def write_obj(path, vertices, faces):
    with open(path, "w") as file:
        file.writelines(f"v {x:.6f} {y:.6f} {z:.6f}\n" for x, y, z in vertices)
        file.writelines(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in faces)


def processor():
    for line in open("/proc/cpuinfo") if os.path.exists("/proc/cpuinfo") else []:
        if line.startswith("model name"):
            return line.split(":")[1].strip()
    return platform.processor()
