"""Types of the native module; `help(garnet)` has the whole documentation."""

from collections.abc import Mapping, Sequence
from os import PathLike
from typing import Literal, TypeAlias, TypedDict

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats: TypeAlias = NDArray[np.float64]
Integers: TypeAlias = NDArray[np.int64]
Pose: TypeAlias = str | Mapping[str, ArrayLike] | ArrayLike
Warp: TypeAlias = Literal["auto", "warp", "dqs", "lbs"]

__version__: str

class GarnetError(Exception):
    """What the library refuses: a file that cannot be read, a garment off its body."""

class Report(TypedDict):
    inside_before: int
    inside: int
    trapped: int
    trapped_inside: int
    crossing_faces: int
    crossing_faces_trapped: int
    moved: int
    deepest: float
    deepest_before: float
    max_displacement: float
    min_distance: float

class Verdict(TypedDict):
    inside: int
    deepest: float
    trapped: int
    crossing_faces: int
    stretch_p50: float
    stretch_p99: float
    stretch_max: float

class Seconds(TypedDict):
    fit: float
    warp: float
    predict: float
    relax: float
    untangle: float
    total: float

class Body:
    """A body at rest, with its skeleton and weights."""

    def __new__(
        cls,
        vertices: ArrayLike,
        faces: ArrayLike,
        joints: ArrayLike,
        parents: ArrayLike,
        weights: ArrayLike,
        *,
        names: Sequence[str] | None = None,
    ) -> Body: ...
    @classmethod
    def read(cls, path: str | PathLike[str]) -> Body:
        """Reads a rig that has its rest mesh: `*.rig.npz`, GLB, glTF or VRM."""
    @classmethod
    def built_in(cls, sex: float = 0.5, *, bmi: float | None = None, **measures: float) -> Body:
        """The built-in body of a sex (0 male, 1 female) and some measures, in metres."""
    def posed(self, pose: Pose, *, translation: ArrayLike | None = None) -> PosedBody:
        """This body in a pose: a name of the library, or axis-angles of the joints."""
    def fitted(self, vertices: ArrayLike) -> PosedBody:
        """The pose and shape in which this body has its vertices at given places."""
    @property
    def vertices(self) -> Floats: ...
    @property
    def faces(self) -> Integers: ...
    @property
    def joints(self) -> Floats: ...
    @property
    def parents(self) -> list[int]: ...
    @property
    def joint_names(self) -> list[str]: ...
    @property
    def weights(self) -> Floats: ...

class PosedBody:
    """A body in a pose, and perhaps another shape."""

    @property
    def vertices(self) -> Floats: ...
    @property
    def transforms(self) -> Floats: ...
    @property
    def body(self) -> Body: ...

class Drape:
    """A draped garment, and how it came about."""

    @property
    def vertices(self) -> Floats: ...
    @property
    def trapped(self) -> NDArray[np.bool_]: ...
    @property
    def report(self) -> Report | None: ...
    @property
    def seconds(self) -> Seconds: ...
    @property
    def predicted(self) -> str | None: ...
    @property
    def beyond(self) -> str | None: ...
    @property
    def fallback(self) -> str | None: ...

class Garment:
    """A garment that lies on a body at rest, bound to it."""

    def __new__(cls, vertices: ArrayLike, faces: ArrayLike, body: Body) -> Garment: ...
    def drape(
        self,
        target: PosedBody | ArrayLike,
        *,
        method: Warp | None = None,
        clearance: float | None = None,
        untangle: bool = True,
    ) -> Drape:
        """Drapes the garment on a body in a pose, or on its vertices."""
    def judge(self, vertices: ArrayLike, target: PosedBody | ArrayLike) -> Verdict:
        """What is wrong with the garment at some vertices, whoever draped it."""
    @property
    def vertices(self) -> Floats: ...
    @property
    def faces(self) -> Integers: ...
    @property
    def body(self) -> Body: ...

class Package:
    """A garment on its body, with trained variants and its simulation."""

    def __new__(cls, folder: str | PathLike[str]) -> Package: ...
    @property
    def sizes(self) -> list[str]: ...
    def in_size(self, size: str) -> Package:
        """The same package with its garment in another of its sizes."""
    def drape(
        self,
        target: PosedBody | ArrayLike,
        *,
        method: str | None = None,
        clearance: float | None = None,
        untangle: bool = True,
        settle: int | None = None,
    ) -> Drape:
        """Drapes the garment by a variant on a body in a pose, or on its vertices."""
    def judge(self, vertices: ArrayLike, target: PosedBody | ArrayLike) -> Verdict:
        """What is wrong with the garment at some vertices, whoever draped it."""
    @property
    def name(self) -> str: ...
    @property
    def variants(self) -> list[str]: ...
    @property
    def default_variant(self) -> str | None: ...
    @property
    def is_made_to_measure(self) -> bool: ...
    @property
    def vertices(self) -> Floats: ...
    @property
    def faces(self) -> Integers: ...
    @property
    def body(self) -> Body: ...

def drape(
    garment: Garment | Package,
    target: PosedBody | ArrayLike,
    *,
    method: str | None = None,
    clearance: float | None = None,
    untangle: bool = True,
    settle: int | None = None,
) -> Floats:
    """Drapes a garment, or that of a package, and gives its vertices alone."""

def poses() -> list[str]:
    """The names of the poses of the library."""
