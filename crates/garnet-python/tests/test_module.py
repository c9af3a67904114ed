"""The module says what it is: documentation, types, arrays."""

import ast
import importlib.resources
import inspect

import garnet
import numpy as np


def test_everything_public_is_documented():
    missing = [name for name in garnet.__all__ if not inspect.getdoc(getattr(garnet, name))]
    for kind in (garnet.Body, garnet.PosedBody, garnet.Garment, garnet.Package, garnet.Drape):
        names = [name for name in vars(kind) if not name.startswith("_")]
        missing += [name for name in names if not inspect.getdoc(getattr(kind, name))]
    assert not missing


def test_the_stubs_tell_what_there_is():
    folder = importlib.resources.files(garnet)
    assert (folder / "py.typed").is_file()
    stubs = ast.parse((folder / "_garnet.pyi").read_text())
    told = {}
    for node in stubs.body:
        if isinstance(node, ast.ClassDef):
            functions = [item for item in node.body if isinstance(item, ast.FunctionDef)]
            told[node.name] = {item.name for item in functions}
        elif isinstance(node, ast.FunctionDef):
            told[node.name] = None
    for name in garnet.__all__:
        value = getattr(garnet, name)
        if inspect.isclass(value) and value is not garnet.GarnetError:
            public = {key for key in vars(value) if not key.startswith("_")}
            assert public == told[name] - {"__new__"}, name
        elif callable(value):
            assert name in told


def test_arrays_have_the_types_that_are_said(shirt):
    body = shirt.body
    count, joints = len(body.vertices), len(body.joint_names)
    assert body.vertices.dtype == np.float64 and body.vertices.shape == (count, 3)
    assert body.faces.dtype == np.int64 and body.faces.max() < count
    assert body.weights.shape == (count, joints) and len(body.parents) == joints
    assert np.allclose(body.weights.sum(1), 1, atol=1e-5)
    assert shirt.vertices.shape[1] == 3 and shirt.faces.max() < len(shirt.vertices)
    # What is given out is a copy.
    vertices = body.vertices
    vertices[:] = 0
    assert np.abs(body.vertices).max() > 0.5


def test_arrays_come_in_any_layout(shirt):
    target = shirt.body.posed("wave").vertices
    expected = garnet.drape(shirt, target, method="fast")
    for same in (np.asfortranarray(target), target.tolist(), target[::-1][::-1]):
        assert np.array_equal(garnet.drape(shirt, same, method="fast"), expected)
    single = garnet.drape(shirt, target.astype(np.float32), method="fast")
    assert np.array_equal(single, expected)


def test_the_package_tells_its_variants(shirt):
    assert {"fast", "balanced", "accurate"} <= set(shirt.variants) | {shirt.default_variant}
    assert shirt.default_variant in shirt.variants
    assert not shirt.is_made_to_measure
    assert "wave" in garnet.poses()
    assert "5000" in repr(shirt) or "vertices" in repr(shirt)
