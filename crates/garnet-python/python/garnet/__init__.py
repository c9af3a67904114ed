"""Drapes garment meshes on body meshes, on a CPU.

>>> import garnet
>>> shirt = garnet.Package("models/tshirt")
>>> target = shirt.body.posed("wave")
>>> vertices = garnet.drape(shirt, target)

Lengths are metres, y is up, vertices are float64 arrays [n, 3], faces integer arrays [m, 3] of
triangles. Threads may share all objects; none can be changed.
"""

from ._garnet import (
    Body,
    Drape,
    Garment,
    GarnetError,
    Package,
    PosedBody,
    __version__,
    drape,
    poses,
)

__all__ = [
    "Body",
    "Drape",
    "Garment",
    "GarnetError",
    "Package",
    "PosedBody",
    "__version__",
    "drape",
    "poses",
]
