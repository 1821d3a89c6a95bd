"""The motion of carried meshes, one exact shape key a frame, keyframed instead of driven."""

import json
import tempfile
from pathlib import Path

import bpy
from bpy.props import IntProperty

from . import assets, command, points
from .carry import add_key, remove_keys
from .curves import curves_for, curves_of


def has_animated_t(asset):
    data = asset.animation_data
    curves = [*data.drivers, *(curves_of(data) or [])] if data else []
    return any(curve.data_path == '["t"]' for curve in curves)


def animate_t(asset, first, last):
    """t from 0 to 1, evenly."""
    for t, frame in ((0.0, first), (1.0, last)):
        asset["t"] = t
        asset.keyframe_insert('["t"]', frame=frame)
    for curve in curves_of(asset.animation_data):
        if curve.data_path == '["t"]':
            for point in curve.keyframe_points:
                point.interpolation = "LINEAR"


def times_at(scene, asset, frames):
    """t at every frame, within [0, 1]."""
    shown = scene.frame_current
    times = []
    for frame in frames:
        scene.frame_set(frame)
        times.append(min(1.0, max(0.0, asset["t"])))
    scene.frame_set(shown)
    return times


def images_at(asset_path, products, times):
    """Ψ(t) of lists of points (n, 3): a list for every one of `times`, from one look at the map."""
    with tempfile.TemporaryDirectory(prefix="bespoke_") as directory:
        files = [Path(directory, f"{number:06d}.ply") for number in range(len(products))]
        for path, x in zip(files, products):
            points.write_ply(path, x)
        outputs = [Path(directory, f"t{number:06d}") for number in range(len(times))]
        manifest = Path(directory, "manifest.jsonl")
        with open(manifest, "w") as lines:
            for output, t in zip(outputs, times):
                output.mkdir()
                job = {"command": "apply", "map": str(asset_path), "product": list(map(str, files)), "t": t}
                lines.write(json.dumps(job | {"out-dir": str(output)}) + "\n")
        command.run("batch", manifest, "--quiet")
        return [[points.read_ply(output / path.name) for path in files] for output in outputs]


def keyframe(key, ones, frames):
    """The key's value over `frames`: 1 on those in `ones`, else 0; straight between neighbours."""
    value = {frame: float(frame in ones) for frame in frames}
    keys = key.id_data
    curve = curves_for(keys.animation_data).new(f'key_blocks["{key.name}"].value')
    # Frames between two of the same value say nothing.
    told = [f for f in frames if any(value.get(f + d, value[f]) != value[f] for d in (-1, 1))] or frames[:1]
    curve.keyframe_points.add(len(told))
    for point, frame in zip(curve.keyframe_points, told):
        point.co = frame, value[frame]
        point.interpolation = "LINEAR"
    curve.update()


def give_baked_keys(thing, frames, times, positions):
    """`positions`: (n, 3) in the object's space for every time that is not 0, which is the basis."""
    remove_keys(thing)
    keys = {t: add_key(thing, f"t {t:.6f}", x) for t, x in positions.items()}
    block = thing.data.shape_keys
    if not block.animation_data:
        block.animation_data_create()
    if not block.animation_data.action:
        block.animation_data.action = bpy.data.actions.new(f"{thing.name} bespoke")
    for t, key in keys.items():
        keyframe(key, {frame for frame, time in zip(frames, times) if time == t}, frames)


class BakeFrames(bpy.types.Operator):
    """Bake t into frames: one exact shape key a frame for the meshes that the map carries, without drivers. Where t is not
    animated, it goes from 0 to 1"""

    bl_idname = "bespoke.bake"
    bl_label = "Bake t into frames"
    bl_options = {"REGISTER", "UNDO"}

    first: IntProperty(name="First frame", default=1)
    last: IntProperty(name="Last frame", default=25)

    @classmethod
    def poll(cls, context):
        if context.mode != "OBJECT":
            cls.poll_message_set("Switch to object mode")
        elif not cls.carried(context):
            cls.poll_message_set("Carry meshes through the chosen map first")
        else:
            return True
        return False

    @staticmethod
    def carried(context):
        asset = context.scene.bespoke.asset
        if not assets.is_asset(asset):
            return []
        return [thing for thing in context.scene.objects if thing.bespoke.carried_by == asset]

    def invoke(self, context, event):
        self.first, self.last = context.scene.frame_start, context.scene.frame_end
        return context.window_manager.invoke_props_dialog(self)

    def execute(self, context):
        if self.last <= self.first:
            self.report({"ERROR"}, f"the last frame, {self.last}, does not come after the first, {self.first}")
            return {"CANCELLED"}
        asset, things = context.scene.bespoke.asset, self.carried(context)
        frames = list(range(self.first, self.last + 1))
        try:
            to_map = [points.map_from_object(asset, thing) for thing in things]
            if not has_animated_t(asset):
                animate_t(asset, self.first, self.last)
            times = times_at(context.scene, asset, frames)
            distinct = sorted(set(times) - {0.0})
            products = [points.moved(m, points.rest_points(thing.data)) for m, thing in zip(to_map, things)]
            images = images_at(assets.path_of(asset), products, distinct)
        except (command.CommandError, ValueError) as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        for number, thing in enumerate(things):
            back = points.np.linalg.inv(to_map[number])
            positions = {t: points.moved(back, image[number]) for t, image in zip(distinct, images)}
            give_baked_keys(thing, frames, times, positions)
        self.report({"INFO"}, f"frames {self.first} to {self.last}: {len(distinct)} shape keys on each of {len(things)}")
        return {"FINISHED"}
