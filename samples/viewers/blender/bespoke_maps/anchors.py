"""Anchors: empties that are children of the two models, paired by their names."""

import json
import re

import bpy
from bpy.props import BoolProperty, StringProperty
from bpy_extras.io_utils import ImportHelper
from mathutils import Vector

from .command import CommandError

SIZE_OF_EMPTIES = 0.02  # of the model's largest extent


def base_name(thing):
    """Without the number that Blender adds to a name that is taken."""
    return re.sub(r"\.\d{3,}$", "", thing.name)


def anchors_on(model):
    """Empties by name. Raises CommandError where two have the same."""
    found = {}
    for child in model.children:
        if child.type != "EMPTY":
            continue
        name = base_name(child)
        if name in found:
            raise CommandError(f"{model.name} has two anchors named {name}: {found[name].name} and {child.name}")
        found[name] = child
    return found


def pairs_of(source, target):
    """What an anchors file says, in the world's space. Raises CommandError for an anchor without its counterpart."""
    on_source, on_target = anchors_on(source), anchors_on(target)
    alone = [f"{name} on {source.name}" for name in sorted(on_source.keys() - on_target.keys())]
    alone += [f"{name} on {target.name}" for name in sorted(on_target.keys() - on_source.keys())]
    if alone:
        raise CommandError("anchors without a counterpart of the same name: " + ", ".join(alone))
    pairs = []
    for name, empty in on_source.items():
        a, b = (list(place.matrix_world.translation) for place in (empty, on_target[name]))
        pairs.append({"name": name, "a": a, "b": b} | {k: empty[k] for k in ("sigma", "weight") if k in empty})
    return pairs


def add_anchor(model, name, place):
    """An empty at `place` in the model's own space."""
    empty = bpy.data.objects.new(name, None)
    empty.empty_display_type = "SPHERE"
    empty.empty_display_size = SIZE_OF_EMPTIES * max(model.dimensions) / max(max(model.matrix_world.to_scale()), 1e-9)
    empty.parent = model
    empty.location = place
    (model.users_collection[0] if model.users_collection else bpy.context.collection).objects.link(empty)
    return empty


class AddAnchor(bpy.types.Operator):
    """Add an anchor to the active mesh at the 3D cursor; an anchor of the same name on the other model makes a pair"""

    bl_idname = "bespoke.add_anchor"
    bl_label = "Anchor at 3D cursor"
    bl_options = {"REGISTER", "UNDO"}

    name: StringProperty(name="Name", default="anchor")
    on_surface: BoolProperty(name="On the surface", description="Move it to the nearest point of the mesh", default=True)

    @classmethod
    def poll(cls, context):
        return context.mode == "OBJECT" and context.active_object is not None and context.active_object.type == "MESH"

    def invoke(self, context, event):
        return context.window_manager.invoke_props_dialog(self)

    def execute(self, context):
        model = context.active_object
        place = model.matrix_world.inverted_safe() @ context.scene.cursor.location
        if self.on_surface:
            found, nearest, _, _ = model.closest_point_on_mesh(place)
            place = nearest if found else place
        try:
            taken = self.name in anchors_on(model)
        except CommandError:
            taken = True
        if taken:
            self.report({"ERROR"}, f"{model.name} has an anchor named {self.name} already")
            return {"CANCELLED"}
        add_anchor(model, self.name, place)
        return {"FINISHED"}


class ImportAnchors(bpy.types.Operator, ImportHelper):
    """Read an anchors file (JSON, as bespoke pick saves it) onto the two selected meshes, the target active. The file's
    coordinates are taken as those of the meshes' own spaces"""

    bl_idname = "bespoke.import_anchors"
    bl_label = "Import anchors"
    bl_options = {"REGISTER", "UNDO"}

    filename_ext = ".json"
    filter_glob: StringProperty(default="*.json", options={"HIDDEN"})

    @classmethod
    def poll(cls, context):
        return models_in(context) is not None

    def execute(self, context):
        source, target = models_in(context)
        try:
            pairs = json.loads(open(self.filepath).read())["pairs"]
            read = [(str(pair["name"]), Vector(pair["a"]), Vector(pair["b"]), pair) for pair in pairs]
        except (OSError, ValueError, KeyError, TypeError) as error:
            self.report({"ERROR"}, f"{self.filepath} is no anchors file: {type(error).__name__} {error}")
            return {"CANCELLED"}
        for name, a, b, pair in read:
            empty = add_anchor(source, name, a)
            add_anchor(target, name, b)
            for key in ("sigma", "weight"):
                if key in pair:
                    empty[key] = pair[key]
        self.report({"INFO"}, f"{len(read)} pairs of anchors")
        return {"FINISHED"}


def models_in(context):
    """(source, target) where exactly two meshes are selected and one of them, the target, is active; else None."""
    meshes = [thing for thing in context.selected_objects if thing.type == "MESH"]
    if context.mode != "OBJECT" or len(meshes) != 2 or context.active_object not in meshes:
        return None
    target = context.active_object
    return next(thing for thing in meshes if thing != target), target
