"""Drapes from arrays are those of the command, on built-in bodies, on bodies made of arrays."""

import re
import subprocess
import threading
import time
import warnings

import garnet
import numpy as np
import pytest
from conftest import MODELS, read_obj, tube

# Coordinates of drapes, in metres.
SAME = 1e-6


def command_drape(command, arguments, folder):
    """Vertices that the command writes."""
    out = folder / "drape.obj"
    arguments = [command, "drape", *map(str, arguments), "-o", str(out), "-q"]
    subprocess.run(arguments, check=True)
    return np.array(read_obj(out)[0])


@pytest.mark.parametrize("method", ["fast", "accurate", "warp"])
def test_a_drape_on_an_array_is_that_of_the_command(shirt, command, tmp_path, method):
    reach = MODELS / "demo/reach.obj"
    expected = command_drape(command, [MODELS / "tshirt", reach, "--method", method], tmp_path)
    found = garnet.drape(shirt, np.array(read_obj(reach)[0]), method=method)
    assert found.dtype == np.float64 and found.shape == expected.shape
    assert np.abs(found - expected).max() <= SAME


def test_a_drape_on_a_pose_is_that_of_the_command(shirt, command, tmp_path):
    expected = command_drape(command, [MODELS / "tshirt", "--pose", "wave"], tmp_path)
    drape = shirt.drape(shirt.body.posed("wave"))
    assert np.abs(drape.vertices - expected).max() <= SAME
    assert drape.report["inside"] == 0
    assert drape.predicted is not None and drape.fallback is None
    assert drape.trapped.shape == (len(expected),)


def test_the_version_is_that_of_the_command(command):
    text = subprocess.run([command, "--version"], check=True, capture_output=True, text=True)
    assert re.search(r"\d+\.\d+\.\d+", text.stdout).group() == garnet.__version__


def test_a_built_in_body_of_another_shape_wears_the_shirt(shirt):
    woman = garnet.Body.built_in(1.0, stature=1.68, waist=0.78)
    heights = woman.vertices[:, 1]
    assert abs(heights.max() - heights.min() - 1.68) < 0.01
    target = woman.posed("wave")
    drape = shirt.drape(target, method="fast")
    assert drape.report["inside"] == 0
    # The vertices alone say the same.
    again = garnet.drape(shirt, target.vertices, method="fast")
    assert np.array_equal(drape.vertices, again)


def test_garments_made_to_measure_tell_that_they_are_not_cut():
    jeans = garnet.Package(MODELS / "jeans")
    man = garnet.Body.built_in(0.0, stature=1.92)
    with pytest.warns(UserWarning, match="made to measure"):
        garnet.drape(jeans, man.posed("squat"), method="warp")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        garnet.drape(jeans, jeans.body.posed("squat"), method="warp")


def test_a_garment_of_arrays_is_draped(arm):
    vertices, faces = tube()
    sleeve = garnet.Garment(vertices, faces, arm)
    assert sleeve.vertices.shape == vertices.shape and np.array_equal(sleeve.faces, faces)
    bent = arm.posed({"elbow": [1.2, 0, 0]})
    drape = sleeve.drape(bent)
    assert drape.report["inside"] == 0
    # All cloth stays as near to the bent arm as a sleeve is.
    distance = np.linalg.norm(drape.vertices[:, None] - bent.vertices[None], axis=2).min(1)
    assert distance.max() < 0.05
    # At rest, and moved, the garment is where it was, and moved.
    moved = arm.posed(np.zeros((2, 3)), translation=[0.5, 0, 0])
    assert np.abs(garnet.drape(sleeve, moved) - vertices - [0.5, 0, 0]).max() < 1e-5


def test_options_do_what_they_say(arm):
    sleeve = garnet.Garment(*tube(radius=0.053), arm)
    bent = arm.posed({"elbow": [1.2, 0, 0]})
    wide = sleeve.drape(bent, clearance=0.006)
    assert wide.report["min_distance"] > 0.0055
    left = sleeve.drape(bent, untangle=False)
    assert left.report is None and left.trapped.size == 0
    linear = sleeve.drape(bent, untangle=False, method="lbs")
    assert np.abs(linear.vertices - left.vertices).max() > 1e-4


def test_a_fit_finds_what_a_pose_made(arm):
    bent = arm.posed({"elbow": [0.7, 0, 0]})
    sleeve = garnet.Garment(*tube(), arm)
    apart = np.abs(garnet.drape(sleeve, bent) - garnet.drape(sleeve, bent.vertices))
    assert apart.max() < 1e-4


def test_a_body_read_from_a_file_is_one_of_its_arrays():
    read = garnet.Body.read(MODELS / "demo/body.rig.npz")
    made = garnet.Body(
        read.vertices,
        read.faces,
        read.joints,
        read.parents,
        read.weights,
        names=read.joint_names,
    )
    # Weights are scaled to sum 1 anew.
    assert np.abs(made.posed("wave").vertices - read.posed("wave").vertices).max() < 1e-6
    vertices, faces = read_obj(MODELS / "demo/tunic.obj")
    one, other = (garnet.Garment(vertices, faces, body) for body in (read, made))
    expected = garnet.drape(one, read.posed("wave"))
    assert np.abs(garnet.drape(other, made.posed("wave")) - expected).max() < 1e-4
    # A pose of another body is taken by its vertices.
    assert np.abs(garnet.drape(other, read.posed("wave")) - expected).max() < 1e-3


def test_a_pose_is_named_as_the_command_names_it(shirt):
    walk = f"{MODELS}/demo/walk.bvh"
    first, later = (shirt.body.posed(f"{walk}:{frame}").vertices for frame in (0, 6))
    assert np.abs(first - later).max() > 0.05
    with pytest.raises(ValueError, match="stands for 3 poses"):
        shirt.body.posed(f"{walk}:0:3")


def test_transforms_pose_the_joints(shirt):
    posed = shirt.body.posed("wave")
    transforms = posed.transforms
    count = len(shirt.body.joints)
    assert transforms.shape == (count, 4, 4)
    turns = transforms[:, :3, :3]
    assert np.allclose(turns @ turns.transpose(0, 2, 1), np.eye(3), atol=1e-5)
    # Each joint is where its own transform and that of its parent take it.
    joints = np.concatenate([shirt.body.joints, np.ones((count, 1))], 1)
    for joint, parent in enumerate(shirt.body.parents):
        if parent >= 0:
            places = [(transforms[of] @ joints[joint])[:3] for of in (joint, parent)]
            assert np.abs(places[0] - places[1]).max() < 1e-5


def test_a_judge_sees_what_is_wrong(shirt):
    target = shirt.body.posed("wave")
    drape = shirt.drape(target, method="fast")
    verdict = shirt.judge(drape.vertices, target)
    assert verdict["inside"] == 0 and verdict["crossing_faces"] == drape.report["crossing_faces"]
    assert 0.9 < verdict["stretch_p50"] < 1.1 < verdict["stretch_max"] + 0.5
    # The garment of the body at rest is not on the one that waves.
    wrong = shirt.judge(shirt.vertices, target)
    assert wrong["inside"] > 50 and wrong["deepest"] > 0.005
    assert abs(wrong["stretch_p50"] - 1) < 1e-6 and abs(wrong["stretch_max"] - 1) < 1e-6
    twice = shirt.judge(2 * shirt.vertices, target)
    assert abs(twice["stretch_p99"] - 2) < 1e-5


def test_threads_drape_side_by_side(shirt):
    targets = [shirt.body.posed(name) for name in ("wave", "sit")]
    expected = [garnet.drape(shirt, target) for target in targets]
    found = [None, None]

    def drape(number):
        for _ in range(3):
            found[number] = garnet.drape(shirt, targets[number])

    threads = [threading.Thread(target=drape, args=(number,)) for number in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for one, other in zip(found, expected):
        assert np.array_equal(one, other)


def test_the_interpreter_is_let_go_while_draping(shirt):
    target = shirt.body.posed("wave")
    garnet.drape(shirt, target)
    is_done = threading.Event()

    def drape():
        for _ in range(5):
            garnet.drape(shirt, target)
        is_done.set()

    thread = threading.Thread(target=drape)
    longest, last = 0.0, time.perf_counter()
    thread.start()
    start = last
    while not is_done.is_set():
        time.sleep(0.001)
        now = time.perf_counter()
        longest, last = max(longest, now - last), now
    thread.join()
    # With the interpreter held, nothing would run for a fifth of the time.
    assert longest < 0.15 * (last - start)
