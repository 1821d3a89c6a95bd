"""Properties of carried skeletons, run inside Blender: blender -b --factory-startup -P blender_rig_test.py -- DIRECTORY

DIRECTORY holds carried.glb, bound.glb and expected.csv: where the map takes the sleeve's vertices and, last, the elbow.
Prints the name of every property that holds.
"""

import math
import sys
from pathlib import Path

import bpy
import numpy as np
from mathutils import Quaternion

sys.path.insert(0, str(Path(__file__).parent))
from held_properties import points_of, run

DIRECTORY = Path(sys.argv[sys.argv.index("--") + 1])
np.bool = bool  # Blender 3.4's importer names it, and NumPy has it no longer
TOLERANCE = 1e-5  # of the diagonal
BEND = math.radians(60)

rows = (DIRECTORY / "expected.csv").read_text().splitlines()[1:]
EXPECTED = np.array([[float(word) for word in row.split(",")[:3]] for row in rows])
EXPECTED, ELBOW = EXPECTED[:-1], EXPECTED[-1]
DIAGONAL = np.linalg.norm(EXPECTED.max(0) - EXPECTED.min(0))


def in_gltf(x):
    """Blender's importer turns y up into z up."""
    return np.stack([x[:, 0], x[:, 2], -x[:, 1]], 1)


def load(name):
    bpy.ops.import_scene.gltf(filepath=str(DIRECTORY / name))
    armature = next(thing for thing in bpy.data.objects if thing.type == "ARMATURE")
    bpy.context.scene.frame_set(0)  # where the animation begins at rest
    armature.animation_data_clear()
    for bone in armature.pose.bones:
        bone.rotation_mode = "QUATERNION"
    sleeve = next(thing for thing in bpy.data.objects if thing.type == "MESH" and len(thing.data.vertices) > 3
                  and any(modifier.type == "ARMATURE" for modifier in thing.modifiers))
    return armature, sleeve


def shown(thing):
    bpy.context.view_layer.update()
    return in_gltf(points_of(thing, np.array(thing.matrix_world, float)))


def weight_of(thing, name):
    group = thing.vertex_groups[name].index
    return np.array([sum(own.weight for own in vertex.groups if own.group == group) for vertex in thing.data.vertices])


def off_expected(x):
    """Files number vertices each in their own order."""
    distances = np.linalg.norm(x[:, None] - EXPECTED[None], axis=2)
    return max(distances.min(0).max(), distances.min(1).max())


def rest(armature):
    for bone in armature.pose.bones:
        bone.matrix_basis.identity()


def bind_pose_is_the_carried_mesh():
    armature, sleeve = load("carried.glb")
    assert len(sleeve.data.vertices) == len(EXPECTED), (len(sleeve.data.vertices), len(EXPECTED))
    off = off_expected(shown(sleeve))
    assert off < TOLERANCE * DIAGONAL, off
    rest(armature)  # of the bones, which Blender takes from the inverse binds
    off = off_expected(shown(sleeve))
    assert off < TOLERANCE * DIAGONAL, off


def bends(name, tolerance):
    armature, sleeve = load(name)
    straight = shown(sleeve)
    bone = armature.pose.bones["lower"]
    bone.rotation_quaternion = bone.rotation_quaternion @ Quaternion((0, 0, 1), BEND)
    bent = shown(sleeve)
    lower = weight_of(sleeve, "lower")
    upper_half, lower_half = lower < 1e-6, lower > 1 - 1e-6
    assert upper_half.sum() > 20 and lower_half.sum() > 20
    assert np.linalg.norm(bent[upper_half] - straight[upper_half], axis=1).max() < tolerance
    # Beyond the elbow the motion is a turn by 60 degrees about the elbow of the target.
    before, after = straight[lower_half] - ELBOW, bent[lower_half] - ELBOW
    turn = np.linalg.lstsq(before, after, rcond=None)[0].T
    assert np.linalg.norm(after - before @ turn.T, axis=1).max() < tolerance
    angle = math.acos(min(1, (np.trace(turn) - 1) / 2))
    assert abs(angle - BEND) < 1e-3, math.degrees(angle)


def elbow_bends_the_carried_sleeve_where_the_targets_elbow_is():
    bends("carried.glb", TOLERANCE * DIAGONAL)


def elbow_of_the_targets_skeleton_bends_the_bound_sleeve():
    bends("bound.glb", TOLERANCE * DIAGONAL)


PROPERTIES = (
    bind_pose_is_the_carried_mesh,
    elbow_bends_the_carried_sleeve_where_the_targets_elbow_is,
    elbow_of_the_targets_skeleton_bends_the_bound_sleeve,
)

run(PROPERTIES)
