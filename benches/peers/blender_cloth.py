#!/usr/bin/env python3
"""Drapes the scene by the cloth of Blender, as its preset for cotton has it, and prints a line.

    pip install -r benches/peers/requirements.txt crates/garnet-python
    python benches/peers/blender_cloth.py [--quality 5] [--collision-quality 2] [--self-collisions] >> peers.jsonl

The preset is changed where it could not work: cloth and body keep 3 mm instead of 15 and 20 mm,
which is what the garment has from the skin. 24 frames a second, as scenes of Blender have.
"""

import argparse
import pathlib
import struct
import tempfile

import bpy
import numpy as np

from scene import MOTION_SECONDS, Scene, arguments

FRAMES_A_SECOND = 24
DISTANCE = 0.003

# Blender's z is up, garnet's y.
Y_UP = np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]], float)


def main():
    parser = arguments(argparse.ArgumentParser(description=__doc__.splitlines()[0]))
    parser.add_argument("--quality", type=int, default=5, help="steps a frame; the preset has 5")
    parser.add_argument("--collision-quality", type=int, default=2, help="the preset has 2")
    parser.add_argument("--self-collisions", action="store_true")
    options = parser.parse_args()
    scene = Scene(options)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.context.scene.render.fps = FRAMES_A_SECOND
    bpy.context.scene.frame_start, bpy.context.scene.frame_end = 1, 1000

    body = mesh_of("Body", scene.body.vertices, scene.body.faces)
    motion = body.modifiers.new("Motion", "MESH_CACHE")
    motion.cache_format, motion.filepath, motion.frame_start = "PC2", write_motion(scene), 1
    body.modifiers.new("Collision", "COLLISION")
    body.collision.thickness_outer = DISTANCE
    garment = mesh_of("Garment", scene.package.vertices, scene.package.faces)
    cloth = garment.modifiers.new("Cloth", "CLOTH")
    cotton(cloth.settings)
    cloth.settings.quality = options.quality
    cloth.collision_settings.collision_quality = options.collision_quality
    cloth.collision_settings.distance_min = DISTANCE
    cloth.collision_settings.use_self_collision = options.self_collisions
    cloth.collision_settings.self_distance_min = DISTANCE
    cloth.point_cache.frame_end = 1000
    bpy.context.scene.frame_set(1)
    places_of(garment)

    def step(_, frame):
        bpy.context.scene.frame_set(1 + frame)
        return places_of(garment)

    places, seconds, simulated, is_at_rest = scene.simulate(step, 1 / FRAMES_A_SECOND)
    settings = f"cotton, quality {options.quality} and {options.collision_quality}, "
    settings += f"{1e3 * DISTANCE:.0f} mm"
    settings += ", self collisions" if options.self_collisions else ""
    name = f"Blender {bpy.app.version_string} cloth"
    scene.verdict(name, settings, places, seconds, simulated, is_at_rest)


def cotton(settings):
    """The preset Cotton."""
    settings.mass = 0.3
    settings.air_damping = 1.0
    settings.tension_stiffness = settings.compression_stiffness = settings.shear_stiffness = 15
    settings.bending_stiffness = 0.5
    settings.tension_damping = settings.compression_damping = settings.shear_damping = 5
    settings.bending_damping = 0.5


def write_motion(scene):
    """The body on its way, as PC2."""
    frames = round(MOTION_SECONDS * FRAMES_A_SECOND) + 1
    path = pathlib.Path(tempfile.mkdtemp()) / "body.pc2"
    with open(path, "wb") as file:
        file.write(struct.pack("<12siiffi", b"POINTCACHE2", 1, len(scene.body.vertices), 0, 1, frames))
        for frame in range(frames):
            file.write((scene.body_at(frame / FRAMES_A_SECOND) @ Y_UP).astype("<f4").tobytes())
    return str(path)


def mesh_of(name, vertices, faces):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata((vertices @ Y_UP).tolist(), [], faces.tolist())
    thing = bpy.data.objects.new(name, mesh)
    bpy.context.collection.objects.link(thing)
    return thing


def places_of(thing):
    """Where the cloth is in the current frame."""
    evaluated = thing.evaluated_get(bpy.context.evaluated_depsgraph_get())
    places = np.empty(3 * len(evaluated.data.vertices), np.float32)
    evaluated.data.vertices.foreach_get("co", places)
    return places.reshape(-1, 3).astype(float) @ Y_UP.T


if __name__ == "__main__":
    main()
