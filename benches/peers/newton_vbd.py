#!/usr/bin/env python3
"""Drapes the scene by the VBD solver of NVIDIA Newton on the CPU, and prints a line.

    pip install -r benches/peers/requirements.txt crates/garnet-python
    python benches/peers/newton_vbd.py [--substeps 10] [--iterations 10] >> peers.jsonl

The fabric is that of the package: areal density, stretch in N/m, bending in N m. The body is a mesh
whose points go to their places before each substep, the triangles of Newton's tree refitted: Newton
has no bodies that bend, and so no friction with moving skin.
"""

import argparse
import contextlib
import pathlib
import re
import sys

import newton
import numpy as np
import warp as wp

from scene import MOTION_SECONDS, Scene, arguments

FRAMES_A_SECOND = 60
DISTANCE = 0.003


def main():
    parser = arguments(argparse.ArgumentParser(description=__doc__.splitlines()[0]))
    parser.add_argument("--substeps", type=int, default=10)
    parser.add_argument("--iterations", type=int, default=10)
    parser.add_argument("--self-contact", action="store_true")
    options = parser.parse_args()
    scene = Scene(options)
    # Warp tells of what it compiles, which takes minutes the first time.
    with contextlib.redirect_stdout(sys.stderr):
        drape = draped(scene, options)
    settings = f"{options.substeps} substeps of {options.iterations} iterations, {1e3 * DISTANCE:.0f} mm"
    settings += ", self contact" if options.self_contact else ""
    scene.verdict(f"Newton {newton.__version__} VBD", settings, *drape)


def draped(scene, options):
    """Places, seconds, simulated seconds, and whether the cloth is at rest."""
    wp.set_device("cpu")
    fabric = fabric_of(options.package)
    builder = newton.ModelBuilder(up_axis=newton.Axis.Y)
    builder.add_cloth_mesh(
        pos=wp.vec3(0.0, 0.0, 0.0),
        rot=wp.quat_identity(),
        scale=1.0,
        vel=wp.vec3(0.0, 0.0, 0.0),
        vertices=[wp.vec3(*point) for point in scene.package.vertices],
        indices=scene.package.faces.ravel().tolist(),
        density=fabric["density"],
        tri_ke=fabric["membrane"] / 2,
        tri_ka=fabric["membrane"] / 2,
        tri_kd=1e-3 * fabric["membrane"],
        edge_ke=fabric["bending"],
        edge_kd=1e-2 * fabric["bending"],
        particle_radius=DISTANCE,
    )
    skin = newton.Mesh(scene.body.vertices.astype(np.float32), scene.body.faces.ravel(), compute_inertia=False)
    builder.add_shape_mesh(body=-1, mesh=skin)
    builder.color(include_bending=True)
    model = builder.finalize()
    model.soft_contact_ke, model.soft_contact_kd, model.soft_contact_mu = 1e4, 1e-3, fabric["friction"]
    solver = newton.solvers.SolverVBD(
        model,
        iterations=options.iterations,
        particle_enable_self_contact=options.self_contact,
        particle_self_contact_margin=DISTANCE,
        particle_self_contact_gap=DISTANCE,
    )
    # Boxes of bodies at rest would leave out arms that are raised.
    for box, far in ((model.shape_collision_aabb_lower, -5.0), (model.shape_collision_aabb_upper, 5.0)):
        box.fill_(wp.vec3(far, far, far))
    pipeline = newton.CollisionPipeline(model, soft_contact_gap=2 * DISTANCE)
    contacts = pipeline.contacts()
    states = [model.state(), model.state()]
    control = model.control()
    mesh = skin.mesh
    last = scene.body.vertices

    def step(vertices, frame):
        nonlocal last
        for substep in range(options.substeps):
            share = (substep + 1) / options.substeps
            if frame <= MOTION_SECONDS * FRAMES_A_SECOND:
                places = last + share * (vertices - last)
                mesh.points.assign(places.astype(np.float32))
                mesh.refit()
            states[0].clear_forces()
            pipeline.collide(states[0], contacts)
            solver.step(states[0], states[1], control, contacts, 1 / FRAMES_A_SECOND / options.substeps)
            states.reverse()
        last = vertices
        return states[0].particle_q.numpy().astype(float)

    step(last, 0)  # Compiles what is run.
    states[0].particle_q.assign(scene.package.vertices.astype(np.float32))
    states[0].particle_qd.zero_()
    return scene.simulate(step, 1 / FRAMES_A_SECOND)


def fabric_of(package):
    """The fabric of a package."""
    text = (pathlib.Path(package) / "garment.toml").read_text().split("[fabric]")[1].split("[")[0]
    return {name: float(value) for name, value in re.findall(r"^(\w+) = ([\d.e-]+)$", text, re.M)}


if __name__ == "__main__":
    main()
