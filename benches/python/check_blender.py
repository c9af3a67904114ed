"""Checks that Blender shows the files of a motion as OBJ files of its frames have it.

    pip install bpy
    garnet drape GARMENT --pose MOTION:0:N -o FOLDER
    garnet drape GARMENT --pose MOTION:0:N -o walk.pc2
    garnet drape GARMENT --pose MOTION:0:N -o walk.glb
    python check_blender.py GARMENT.obj FOLDER walk.pc2 walk.glb

Opens the garment with the PC2 as a Mesh Cache, and the GLB, in each frame, and prints the largest
distance of a vertex from that of the frame's OBJ, and the largest difference of a texture
coordinate. Ends with 1 if a distance is above 1e-5 m or a coordinate above 1e-5.
"""

import pathlib
import sys

import bpy
import numpy as np

LIMIT = 1e-5


def read_obj(path):
    """Positions, and of each corner of each face its vertex and texture coordinate."""
    vertices, texture, corners = [], [], []
    for line in pathlib.Path(path).read_text().splitlines():
        words = line.split()
        if not words:
            continue
        if words[0] == "v":
            vertices.append([float(word) for word in words[1:4]])
        elif words[0] == "vt":
            texture.append([float(word) for word in words[1:3]])
        elif words[0] == "f":
            for word in words[1:]:
                numbers = word.split("/")
                has_texture = len(numbers) > 1 and numbers[1]
                uv = texture[int(numbers[1]) - 1] if has_texture else None
                corners.append((int(numbers[0]) - 1, uv))
    return np.array(vertices), corners


def positions(thing, frame):
    """Positions of an object in a frame as Blender draws it, in its own axes."""
    bpy.context.scene.frame_set(frame)
    graph = bpy.context.evaluated_depsgraph_get()
    mesh = thing.evaluated_get(graph).to_mesh()
    found = np.empty(3 * len(mesh.vertices), dtype=np.float32)
    mesh.vertices.foreach_get("co", found)
    return found.reshape(-1, 3).astype(np.float64)


def start():
    bpy.ops.wm.read_factory_settings(use_empty=True)


def check_pc2(garment, frames, cache):
    start()
    bpy.ops.wm.obj_import(filepath=str(garment))
    thing = bpy.context.selected_objects[0]
    modifier = thing.modifiers.new("cache", "MESH_CACHE")
    modifier.cache_format = "PC2"
    modifier.filepath = str(pathlib.Path(cache).resolve())
    modifier.frame_start = 0
    worst = 0.0
    for number, (expected, _) in enumerate(frames):
        worst = max(worst, np.abs(positions(thing, number) - expected).max())
    return worst


def check_glb(garment, frames, cache):
    start()
    # The importer puts keys at seconds times frames a second.
    bpy.ops.import_scene.gltf(filepath=str(cache))
    meshes = [thing for thing in bpy.data.objects if thing.type == "MESH"]
    name = pathlib.Path(garment).stem
    thing = next((one for one in meshes if one.name.startswith(name)), meshes[0])
    keys = thing.data.shape_keys
    action = keys.animation_data.action if keys and keys.animation_data else None
    times = sorted({point.co[0] for curve in curves_of(action) for point in curve.keyframe_points}) if action else [0.0]
    assert len(times) == len(frames), f"{len(times)} keys, {len(frames)} frames"
    # Vertices at seams are there for each side: places at the start tell which is which.
    first = blender_to_file(at(thing, times[0]))
    expected, corners = frames[0]
    owner = np.array([np.abs(expected - place).sum(axis=1).argmin() for place in first])
    worst = 0.0
    for time, (expected, _) in zip(times, frames):
        found = blender_to_file(at(thing, time))
        worst = max(worst, np.abs(found - expected[owner]).max())
    return worst, check_texture(thing, owner, corners)


def curves_of(action):
    """The curves of an action: up to Blender 4.3 it has them itself, since then its layers do."""
    if not hasattr(action, "layers"):
        return list(action.fcurves)
    strips = [strip for layer in action.layers for strip in layer.strips]
    return [curve for strip in strips for bag in strip.channelbags for curve in bag.fcurves]


def at(thing, time):
    whole = int(np.floor(time + 1e-4))
    bpy.context.scene.frame_set(whole, subframe=max(0.0, min(0.9999999, time - whole)))
    graph = bpy.context.evaluated_depsgraph_get()
    mesh = thing.evaluated_get(graph).to_mesh()
    found = np.empty(3 * len(mesh.vertices), dtype=np.float32)
    mesh.vertices.foreach_get("co", found)
    return found.reshape(-1, 3).astype(np.float64)


def blender_to_file(points):
    """The importer turns y up to z up."""
    x, y, z = points.T
    return np.stack([x, z, -y], axis=1)


def check_texture(thing, owner, corners):
    wanted = {}
    for vertex, uv in corners:
        if uv is not None:
            wanted.setdefault(vertex, []).append(uv)
    if not wanted:
        return 0.0
    layer = thing.data.uv_layers[0].data
    worst = 0.0
    for loop in thing.data.loops:
        uv = np.array(layer[loop.index].uv)
        known = np.array(wanted[owner[loop.vertex_index]])
        worst = max(worst, np.abs(known - uv).max(axis=1).min())
    return worst


def main():
    garment, folder, pc2, glb = sys.argv[1:]
    frames = [read_obj(path) for path in sorted(pathlib.Path(folder).glob("*.obj"))]
    distance = check_pc2(garment, frames, pc2)
    print(f"{pc2}: {len(frames)} frames, largest distance {distance:.2e} m")
    moved, texture = check_glb(garment, frames, glb)
    print(f"{glb}: {len(frames)} frames, largest distance {moved:.2e} m, texture {texture:.2e}")
    sys.exit(int(max(distance, moved, texture) > LIMIT))


main()
