"""Points as arrays: of meshes, in files, through transforms. All in double; Blender stores floats."""

from pathlib import Path

import numpy as np

HEADER = (
    "ply\nformat binary_little_endian 1.0\nelement vertex {}\n"
    "property double x\nproperty double y\nproperty double z\nend_header\n"
)


def write_ply(path, x):
    """Points (n, 3), without rounding."""
    Path(path).write_bytes(HEADER.format(len(x)).encode() + np.ascontiguousarray(x, "<f8").tobytes())


def read_ply(path):
    """Points (n, 3) of a file with the header above."""
    _, _, values = Path(path).read_bytes().partition(b"end_header\n")
    return np.frombuffer(values, "<f8").reshape(-1, 3)


def read_in_order(directory, pattern):
    """(files, n, 3), by the files' names."""
    return np.stack([read_ply(path) for path in sorted(Path(directory).glob(pattern))])


def write_obj(path, x, triangles):
    with open(path, "w") as out:
        out.writelines("v {:.9g} {:.9g} {:.9g}\n".format(*row) for row in x.tolist())
        out.writelines("f {} {} {}\n".format(*row) for row in (triangles + 1).tolist())


def rest_points(mesh):
    """(n, 3): a mesh's vertices before any shape key acts, in the object's space."""
    values = np.empty(3 * len(mesh.vertices), np.float32)
    if mesh.shape_keys:
        mesh.shape_keys.reference_key.data.foreach_get("co", values)
    else:
        mesh.vertices.foreach_get("co", values)
    return values.reshape(-1, 3).astype(float)


def triangles_of(mesh):
    """(m, 3) vertex numbers."""
    mesh.calc_loop_triangles()
    corners = np.empty(3 * len(mesh.loop_triangles), np.int32)
    mesh.loop_triangles.foreach_get("vertices", corners)
    return corners.reshape(-1, 3)


def moved(matrix, x):
    """Points (n, 3) through a 4×4 matrix."""
    return x @ matrix[:3, :3].T + matrix[:3, 3]


def map_from_object(asset, thing):
    """4×4: an object's own space to the space of the map. Raises ValueError where a scale is zero."""
    world_from_map = np.array(asset.matrix_world, float)
    world_from_object = np.array(thing.matrix_world, float)
    for owner, matrix in ((asset, world_from_map), (thing, world_from_object)):
        if not np.linalg.matrix_rank(matrix) == 4:
            raise ValueError(f"{owner.name} is scaled to nothing along an axis")
    return np.linalg.solve(world_from_map, world_from_object)
