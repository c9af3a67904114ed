"""Drapes a garment of a .blend file on its body, and keeps the drape as a shape key.

    pip install bpy
    python with_bpy.py IN.blend OUT.blend --body Body --garment Garment
    python with_bpy.py --demo MODELS IN.blend       # makes a file to try it with

The body is a mesh with an armature modifier and vertex groups; the garment lies on it where the
armature is at rest. It is draped on the body as the armature poses it in the current frame, and
the shape key `draped` of the garment, with value 1, has the result. The same code runs in Blender.
"""

import argparse
import pathlib

import bpy
import numpy as np

import garnet

# Blender's z is up, garnet's y.
Y_UP = np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]], float)


def to_world(points, matrix):
    """Points [n, 3] of an object in garnet's world."""
    matrix = np.array(matrix)
    return (points @ matrix[:3, :3].T + matrix[:3, 3]) @ Y_UP.T


def to_object(points, matrix):
    """The way back."""
    matrix = np.linalg.inv(np.array(matrix))
    return points @ Y_UP @ matrix[:3, :3].T + matrix[:3, 3]


def mesh_arrays(mesh):
    """Vertices [n, 3] and triangles [m, 3] of a mesh."""
    vertices = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", vertices)
    mesh.calc_loop_triangles()
    faces = np.empty(3 * len(mesh.loop_triangles), np.int32)
    mesh.loop_triangles.foreach_get("vertices", faces)
    return vertices.reshape(-1, 3).astype(float), faces.reshape(-1, 3)


def body_of(thing, armature):
    """The body at rest: mesh, bones, weights of the vertex groups."""
    bones = list(armature.data.bones)
    numbers = {bone.name: number for number, bone in enumerate(bones)}
    joints = to_world(np.array([bone.head_local for bone in bones]), armature.matrix_world)
    parents = [numbers[bone.parent.name] if bone.parent else -1 for bone in bones]
    groups = {group.index: numbers.get(group.name) for group in thing.vertex_groups}
    weights = np.zeros((len(thing.data.vertices), len(bones)))
    for vertex in thing.data.vertices:
        for entry in vertex.groups:
            bone = groups.get(entry.group)
            if bone is not None:
                weights[vertex.index, bone] += entry.weight
    vertices, faces = mesh_arrays(thing.data)
    vertices = to_world(vertices, thing.matrix_world)
    return garnet.Body(vertices, faces, joints, parents, weights, names=list(numbers))


def posed_vertices(thing):
    """Vertices of an object as its modifiers leave them in the current frame."""
    evaluated = thing.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = evaluated.to_mesh()
    vertices, _ = mesh_arrays(mesh)
    evaluated.to_mesh_clear()
    return to_world(vertices, thing.matrix_world)


def drape(body_name, garment_name):
    thing, cloth = bpy.data.objects[body_name], bpy.data.objects[garment_name]
    armature = thing.find_armature()
    body = body_of(thing, armature)
    vertices, faces = mesh_arrays(cloth.data)
    garment = garnet.Garment(to_world(vertices, cloth.matrix_world), faces, body)
    drape = garment.drape(posed_vertices(thing))
    print(drape)
    if cloth.data.shape_keys is None:
        cloth.shape_key_add(name="Basis")
    key = cloth.shape_key_add(name="draped")
    key.data.foreach_set("co", to_object(drape.vertices, cloth.matrix_world).astype(np.float32).ravel())
    key.value = 1.0


def demo(models):
    """A scene of the demo body, its arms moved by the armature, and the tunic."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    demo = pathlib.Path(models) / "demo"
    body = garnet.Body.read(demo / "body.rig.npz")

    def added(name, data):
        thing = bpy.data.objects.new(name, data)
        bpy.context.collection.objects.link(thing)
        return thing

    def mesh_of(name, vertices, faces):
        mesh = bpy.data.meshes.new(name)
        mesh.from_pydata((vertices @ Y_UP).tolist(), [], np.asarray(faces).tolist())
        return added(name, mesh)

    armature = added("Armature", bpy.data.armatures.new("Armature"))
    bpy.context.view_layer.objects.active = armature
    bpy.ops.object.mode_set(mode="EDIT")
    bones = []
    for name, place, parent in zip(body.joint_names, body.joints @ Y_UP, body.parents):
        bone = armature.data.edit_bones.new(name)
        bone.head, bone.tail = place, place + [0, 0, 0.05]
        bones.append(bone)
    for bone, parent in zip(bones, body.parents):
        bone.parent = bones[parent] if parent >= 0 else None
    bpy.ops.object.mode_set(mode="OBJECT")
    thing = mesh_of("Body", body.vertices, body.faces)
    for name, weights in zip(body.joint_names, body.weights.T):
        group = thing.vertex_groups.new(name=name)
        for vertex in np.flatnonzero(weights):
            group.add([int(vertex)], float(weights[vertex]), "REPLACE")
    modifier = thing.modifiers.new("Armature", "ARMATURE")
    modifier.object = armature
    lines = (demo / "tunic.obj").read_text().splitlines()
    rows = [line.split() for line in lines]
    vertices = np.array([row[1:4] for row in rows if row[:1] == ["v"]], float)
    faces = [[int(word.split("/")[0]) - 1 for word in row[1:]] for row in rows if row[:1] == ["f"]]
    mesh_of("Garment", vertices, faces)
    # The arms go up by 40 degrees.
    for side, angle in (("left", -0.7), ("right", 0.7)):
        names = [name for name in body.joint_names if side in name and "shoulder" in name]
        bone = armature.pose.bones[names[0]]
        bone.rotation_mode = "XYZ"
        bone.rotation_euler = (0, 0, 0)
        rest = np.array(bone.bone.matrix_local)[:3, :3]
        about = rest.T @ np.array([0, 1, 0])
        bone.rotation_mode = "AXIS_ANGLE"
        bone.rotation_axis_angle = (angle, *about)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("files", nargs="+", metavar="FILE.blend")
    parser.add_argument("--body", default="Body")
    parser.add_argument("--garment", default="Garment")
    parser.add_argument("--demo", metavar="MODELS")
    arguments = parser.parse_args()
    if arguments.demo:
        demo(arguments.demo)
    else:
        bpy.ops.wm.open_mainfile(filepath=str(pathlib.Path(arguments.files[0]).resolve()))
        drape(arguments.body, arguments.garment)
    out = pathlib.Path(arguments.files[-1]).resolve()
    bpy.ops.wm.save_as_mainfile(filepath=str(out), check_existing=False)


if __name__ == "__main__":
    main()
