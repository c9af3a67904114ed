"""What is wrong is said by exceptions, and nothing else happens."""

import garnet
import numpy as np
import pytest
from conftest import MODELS, tube


def with_value(array, index, value):
    changed = np.array(array, dtype=float)
    changed[index] = value
    return changed


def refuses(text, function, *arguments, kind=ValueError, **options):
    with pytest.raises(kind, match=text) as caught:
        function(*arguments, **options)
    assert type(caught.value) is kind


def test_bad_arrays_are_value_errors(arm):
    vertices, faces = tube()
    refuses(r"vertices must have the shape \[n, 3\]", garnet.Garment, vertices[:, :2], faces, arm)
    refuses("vertices must have the shape", garnet.Garment, vertices.ravel(), faces, arm)
    refuses("vertices must have the shape", garnet.Garment, 7.0, faces, arm)
    refuses("vertices must be an array of numbers", garnet.Garment, "shirt", faces, arm)
    refuses("vertices must be an array of numbers", garnet.Garment, [[0, 0, 0], [1]], faces, arm)
    for value in (np.nan, np.inf):
        broken = with_value(vertices, (7, 1), value)
        refuses("not finite: .* in row 7", garnet.Garment, broken, faces, arm)
    refuses("vertices: .*coordinate", garnet.Garment, with_value(vertices, (0, 0), 1e30), faces, arm)
    refuses(r"faces must have the shape \[m, 3\]", garnet.Garment, vertices, [[0, 1, 2, 3]], arm)
    refuses("faces must be an array of integers", garnet.Garment, vertices, [[0.0, 1, 2]], arm)
    for index in (len(vertices), -1):
        refuses(rf"faces\[1\] names vertex {index}", garnet.Garment, vertices, [[0, 1, 2], [0, 1, index]], arm)
    refuses("vertices: .*faces", garnet.Garment, vertices, np.zeros((0, 3), int), arm)


def test_bad_bodies_are_value_errors(arm):
    good = dict(
        vertices=arm.vertices,
        faces=arm.faces,
        joints=arm.joints,
        parents=arm.parents,
        weights=arm.weights,
    )
    garnet.Body(**good)

    def refused(text, **changes):
        refuses(text, lambda: garnet.Body(**{**good, **changes}))

    refused("weights must have a row a vertex", weights=arm.weights[:-1])
    refused("weights: ", weights=-arm.weights)
    refused("weights: ", weights=0 * arm.weights)
    refused("parents must have the shape", parents=[-1])
    refused("joints: ", parents=[1, 0])
    refused("joints: ", parents=[-1, 5])
    refused("names of 2 joints", names=["shoulder"])


def test_bad_targets_are_value_errors(arm, shirt):
    sleeve = garnet.Garment(*tube(), arm)
    refuses("target has 3 vertices; the body has", garnet.drape, sleeve, np.zeros((3, 3)))
    refuses("target has a number that is not finite", garnet.drape, sleeve, np.nan * arm.vertices)
    refuses("target has .* vertices; the body has", garnet.drape, shirt, arm.posed([[0, 0, 0]] * 2))
    refuses("pose: .*`wav`", shirt.body.posed, "wav")
    refuses("no joint `knee`", arm.posed, {"knee": [0, 0, 0]})
    refuses("pose has 3 rows; the body has 2 joints", arm.posed, np.zeros((3, 3)))
    refuses(r"translation must have the shape \[3\]", arm.posed, {}, translation=[0, 0])


def test_bad_options_are_refused(arm, shirt):
    sleeve = garnet.Garment(*tube(), arm)
    target = arm.posed({})
    refuses("no method `fast`", garnet.drape, sleeve, target, method="fast")
    refuses("only garments of packages", garnet.drape, sleeve, target, settle=12)
    for clearance in (-0.001, 1.0, np.nan):
        refuses("clearance must be from 0", sleeve.drape, target, clearance=clearance)
    refuses("Garment or a garnet.Package", garnet.drape, "shirt", target, kind=TypeError)
    refuses("no measure `wast`", garnet.Body.built_in, wast=0.7)
    refuses("measures: ", garnet.Body.built_in, 1.0, waist=9.0)
    refuses("measures: ", garnet.Body.built_in, 7.0)


def test_the_library_refuses_by_garnet_errors(arm, shirt, tmp_path):
    kind = garnet.GarnetError
    assert issubclass(kind, Exception)
    refuses("none", garnet.Package, tmp_path / "none", kind=kind)
    refuses("none.rig.npz", garnet.Body.read, tmp_path / "none.rig.npz", kind=kind)
    refuses("fastest", garnet.drape, shirt, shirt.body.posed("wave"), method="fastest", kind=kind)
    # A garment as large as a house, and one that lies elsewhere.
    vertices, faces = tube()
    refuses("does not lie on", garnet.Garment, 100 * vertices, faces, arm, kind=kind)
    # The library of poses is for human figures.
    refuses(".", arm.posed, "wave", kind=kind)
    # GarNet is not in the module.
    names = {variant for variant in shirt.variants}
    assert "local" in names
    refuses("network", garnet.drape, shirt, shirt.body.posed("wave"), method="local", kind=kind)


def test_a_damaged_package_is_named(tmp_path):
    for path in (MODELS / "tshirt").iterdir():
        (tmp_path / path.name).symlink_to(path)
    weights = tmp_path / "falling.safetensors"
    content = weights.read_bytes()
    weights.unlink()
    weights.write_bytes(content[: len(content) // 2])
    package = garnet.Package(tmp_path)
    refuses("falling.safetensors", garnet.drape, package, package.body.posed("wave"), method="fast",
            kind=garnet.GarnetError)
    assert garnet.drape(package, package.body.posed("wave"), method="warp").shape[1] == 3
