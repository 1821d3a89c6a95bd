"""Meshes through a map, as shape keys along Ψ(t) that the map's t drives."""

import bpy
import numpy as np
from bpy.props import BoolProperty, FloatProperty

from . import assets, command, points
from .curves import curves_of

KEY_PREFIX = "bespoke "
FRAMES_A_STEP = 8  # Between them a path may bend unseen.
MAX_KEYS = 32  # They follow half a turn to 0.1 % of its radius.


class CarryError(Exception):
    """What the user has to be told about one object."""


def own_mesh(thing):
    """The object's mesh, made its own where others share it; true when it had to be. Raises CarryError."""
    mesh = thing.data
    if thing.library or mesh.library or thing.override_library:
        raise CarryError(f"{thing.name} is linked from another file; make it local first")
    if not mesh.vertices:
        raise CarryError(f"{thing.name} has no vertices")
    shared = mesh.users - mesh.use_fake_user > 1
    if shared:
        thing.data = mesh.copy()
    return shared


def with_modifiers(context, thing):
    """A new object with the mesh that the modifiers make of this one, selected in its place."""
    evaluated = thing.evaluated_get(context.evaluated_depsgraph_get())
    mesh = bpy.data.meshes.new_from_object(evaluated)
    result = bpy.data.objects.new(f"{thing.name} carried", mesh)
    result.matrix_world = thing.matrix_world
    for collection in thing.users_collection:
        collection.objects.link(result)
    thing.select_set(False)
    result.select_set(True)
    if context.view_layer.objects.active == thing:
        context.view_layer.objects.active = result
    context.view_layer.update()
    return result


def straight_pieces(frames, pieces):
    """How far the frames (k + 1, n, 3) lie from `pieces` straight, evenly timed pieces through every (k / pieces)-th."""
    stride = (len(frames) - 1) // pieces
    share = np.arange(stride).reshape(-1, 1, 1) / stride
    worst = 0.0
    for first in range(0, len(frames) - 1, stride):
        chord = (1 - share) * frames[first] + share * frames[first + stride]
        worst = max(worst, np.sqrt(((frames[first : first + stride] - chord) ** 2).sum(2)).max())
    return worst


def path_of_points(asset, x, tolerance):
    """Ψ(t) of points as (k + 1, n, 3), with the fewest k that follows the path to `tolerance`; and how far it is off.

    k is a power of two times the map's steps, for at their ends the path has corners.
    """
    pieces = asset.bespoke.steps
    frames = FRAMES_A_STEP * pieces
    path = command.image_at_frames(assets.path_of(asset), x, frames)
    while True:
        if 2 * pieces > frames:
            frames *= 2
            path = command.image_at_frames(assets.path_of(asset), x, frames)
        off = straight_pieces(path, pieces)
        if off <= tolerance or 2 * pieces > MAX_KEYS:
            return path[:: frames // pieces], off
        pieces *= 2


def remove_keys(thing):
    """Takes back what an earlier run left; other keys stay."""
    keys = thing.data.shape_keys
    if not keys:
        return
    for key in [key for key in keys.key_blocks if key.name.startswith(KEY_PREFIX)]:
        key.driver_remove("value")
        curves = curves_of(keys.animation_data)
        curve = curves.find(f'key_blocks["{key.name}"].value') if curves else None
        if curve:
            curves.remove(curve)
        thing.shape_key_remove(key)


def add_key(thing, name, positions):
    """A shape key at positions (n, 3), in the object's space."""
    if not thing.data.shape_keys:
        thing.shape_key_add(name="Basis")
    key = thing.shape_key_add(name=KEY_PREFIX + name, from_mix=False)
    key.relative_key = thing.data.shape_keys.reference_key
    key.data.foreach_set("co", positions.astype(np.float32).ravel())
    return key


def drive(key, asset, pieces, number):
    """The key's value is 1 at t = number / pieces and falls to 0 at its neighbours: together, straight pieces."""
    driver = key.driver_add("value").driver
    driver.type = "SCRIPTED"
    variable = driver.variables.new()
    variable.name = "t"
    variable.targets[0].id = asset
    variable.targets[0].data_path = '["t"]'
    # Of the kind that Blender evaluates without Python, so no setting for trusted files matters.
    driver.expression = f"max(0, 1 - abs(t * {pieces} - {number}))"


def carry(thing, asset, tolerance):
    """Gives the mesh object its keys. `tolerance`: fraction of its diagonal. Returns how many, how far they are
    off, and whether that meets the tolerance."""
    try:
        map_from_object = points.map_from_object(asset, thing)
    except ValueError as error:
        raise CarryError(str(error)) from error
    x = points.moved(map_from_object, points.rest_points(thing.data))
    diagonal = np.linalg.norm(np.ptp(x, axis=0))
    path, off = path_of_points(asset, x, tolerance * diagonal)
    object_from_map = np.linalg.inv(map_from_object)
    remove_keys(thing)
    pieces = len(path) - 1
    for number in range(1, pieces + 1):
        key = add_key(thing, f"{number}/{pieces}", points.moved(object_from_map, path[number]))
        drive(key, asset, pieces, number)
    thing.bespoke.carried_by = asset
    return pieces, off, off <= tolerance * diagonal


class CarryMeshes(bpy.types.Operator):
    """Carry the selected meshes through the map, as shape keys that its t drives"""

    bl_idname = "bespoke.carry"
    bl_label = "Carry selected meshes"
    bl_options = {"REGISTER", "UNDO"}

    apply_modifiers: BoolProperty(
        name="Apply modifiers first",
        description="Carry a copy with the modifiers applied. Otherwise they act on the carried mesh",
        default=False,
    )
    tolerance: FloatProperty(
        name="Straightness",
        description="How far the shape keys may be from the path of the map between source and target, per cent of the "
        "mesh's diagonal",
        default=0.1,
        min=0.0001,
        max=100.0,
        subtype="PERCENTAGE",
    )

    @classmethod
    def poll(cls, context):
        if context.mode != "OBJECT":
            cls.poll_message_set("Switch to object mode")
        elif not assets.is_asset(context.scene.bespoke.asset):
            cls.poll_message_set("Load a map and choose it")
        elif not any(thing.type == "MESH" for thing in context.selected_objects):
            cls.poll_message_set("Select the meshes to carry")
        else:
            return True
        return False

    def execute(self, context):
        asset = context.scene.bespoke.asset
        selected = [thing for thing in context.selected_objects if thing != asset]
        meshes = [thing for thing in selected if thing.type == "MESH"]
        for thing in selected:
            if thing.type != "MESH":
                self.report({"WARNING"}, f"{thing.name} is no mesh and stays as it is; convert it first")
        context.window_manager.progress_begin(0, len(meshes))
        carried = 0
        try:
            for number, thing in enumerate(meshes):
                context.window_manager.progress_update(number)
                carried += self.carry_one(context, thing, asset)
        except command.CommandError as error:
            self.report({"ERROR"}, str(error))
        finally:
            context.window_manager.progress_end()
        # What was changed can be undone, so a failure after the first mesh still counts as finished.
        return {"FINISHED"} if carried else {"CANCELLED"}

    def carry_one(self, context, thing, asset):
        try:
            if self.apply_modifiers and thing.modifiers:
                thing = with_modifiers(context, thing)
            elif thing.modifiers:
                names = ", ".join(modifier.name for modifier in thing.modifiers)
                self.report({"INFO"}, f"{thing.name}: {names} act on the carried mesh")
            if own_mesh(thing):
                self.report({"WARNING"}, f"{thing.name} shared its mesh with other objects; it has its own now")
            keys, off, is_close = carry(thing, asset, self.tolerance / 100)
        except CarryError as error:
            self.report({"ERROR"}, str(error))
            return False
        message = f"{thing.name}: shape keys: {keys}, at most {off:.3g} {assets.unit_of(asset)} off the path"
        if is_close:
            self.report({"INFO"}, message)
        else:
            self.report({"WARNING"}, message + "; more of them would not be handy: bake frames, which are exact")
        return True
