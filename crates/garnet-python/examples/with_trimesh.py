"""Drapes a garment on a body with trimesh, and exports both with the stretch of the cloth as colors.

    pip install trimesh pillow
    python with_trimesh.py MODELS OUT.glb

MODELS is the folder `models` of the repository. A garment and a body of one's own take the same
steps: the garment lies on the body at rest, and the target has the body's vertices in another pose.
"""

import pathlib
import sys

import numpy as np
import trimesh

import garnet


def main(models, out):
    demo = pathlib.Path(models) / "demo"
    # `process=False` and `maintain_order` keep the vertices as they are in the file.
    load = {"process": False, "maintain_order": True}
    tunic = trimesh.load_mesh(demo / "tunic.obj", **load)
    reach = trimesh.load_mesh(demo / "reach.obj", **load)

    body = garnet.Body.read(demo / "body.rig.npz")
    garment = garnet.Garment(tunic.vertices, tunic.faces, body)  # once a garment
    drape = garment.drape(reach.vertices)  # once a target
    print(drape)

    draped = trimesh.Trimesh(drape.vertices, tunic.faces, process=False)
    ratio = draped.edges_unique_length / tunic.edges_unique_length
    print(f"edges: {np.median(ratio):.3f} of their length at rest, 99 % below {np.quantile(ratio, 0.99):.2f}")
    at_vertices = np.zeros(len(draped.vertices))
    np.maximum.at(at_vertices, draped.edges_unique.ravel(), np.repeat(ratio, 2))
    draped.visual.vertex_colors = trimesh.visual.interpolate(np.clip(at_vertices, 0.9, 1.3), "viridis")
    trimesh.Scene({"body": reach, "tunic": draped}).export(out)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
