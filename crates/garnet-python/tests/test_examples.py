"""The examples run, where their libraries are."""

import pathlib
import subprocess
import sys

import numpy as np
import pytest
from conftest import MODELS, ROOT, read_obj

import garnet

EXAMPLES = ROOT / "crates/garnet-python/examples"


def run(name, *arguments):
    command = [sys.executable, str(EXAMPLES / name), *map(str, arguments)]
    run = subprocess.run(command, capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    return run.stdout


def test_a_drape_goes_through_trimesh(tmp_path):
    trimesh = pytest.importorskip("trimesh")
    pytest.importorskip("PIL")
    out = tmp_path / "draped.glb"
    assert "0 inside the body" in run("with_trimesh.py", MODELS, out)
    scene = trimesh.load(out)
    assert set(scene.geometry) == {"body", "tunic"}
    vertices, faces = read_obj(MODELS / "demo/tunic.obj")
    body = garnet.Body.read(MODELS / "demo/body.rig.npz")
    tunic = garnet.Garment(vertices, faces, body)
    expected = garnet.drape(tunic, read_obj(MODELS / "demo/reach.obj")[0])
    found = scene.geometry["tunic"].vertices
    # Quads may be cut along their other diagonals.
    assert len(found) == len(expected)
    assert np.abs(np.sort(found, 0) - np.sort(expected, 0)).max() < 1e-3


def test_a_drape_becomes_a_shape_key(tmp_path):
    pytest.importorskip("bpy")
    start, out = tmp_path / "in.blend", tmp_path / "out.blend"
    run("with_bpy.py", "--demo", MODELS, start)
    assert "0 inside the body" in run("with_bpy.py", start, out)
    code = f"""
import bpy
bpy.ops.wm.open_mainfile(filepath={str(out)!r})
cloth = bpy.data.objects["Garment"]
evaluated = cloth.evaluated_get(bpy.context.evaluated_depsgraph_get())
pairs = zip(cloth.data.vertices, evaluated.data.vertices, cloth.data.shape_keys.key_blocks["draped"].data)
moved = [((b.co - a.co).length, (b.co - key.co).length) for a, b, key in pairs]
print("moved", max(row[0] for row in moved), max(row[1] for row in moved))
"""
    script = pathlib.Path(tmp_path / "look.py")
    script.write_text(code)
    result = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, check=True)
    line = next(line for line in result.stdout.splitlines() if line.startswith("moved"))
    farthest, apart = map(float, line.split()[1:])
    # The arms went up, and the sleeves with them; what is shown is the key.
    assert farthest > 0.05 and apart < 1e-6
