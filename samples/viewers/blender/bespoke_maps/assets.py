"""A map in the scene: a volume object whose transform says where the map's space lies, and whose property t moves all it carries."""

import json

import bpy
from bpy.props import BoolProperty, EnumProperty, IntProperty, PointerProperty, StringProperty
from bpy_extras.io_utils import ImportHelper

from . import command

GRID_SHOWN_FIRST = "source_distance"
UNKNOWN_UNIT = "unknown"  # what `bespoke info` says for a map whose anchors named none


def is_asset(thing):
    return thing is not None and thing.type == "VOLUME" and thing.bespoke.is_map


def is_listed(settings, thing):
    return is_asset(thing)


class ObjectSettings(bpy.types.PropertyGroup):
    is_map: BoolProperty(description="This volume is a map that the add-on loaded")
    unit: StringProperty(description="Unit of the models that the map was made of")
    steps: IntProperty(default=1, description="Steps of the chain that the map is made of")
    verdict: StringProperty(description="What is proved about the map")
    carried_by: PointerProperty(type=bpy.types.Object, description="The map whose t moves this mesh")


class SceneSettings(bpy.types.PropertyGroup):
    asset: PointerProperty(
        type=bpy.types.Object, name="Map", description="The map that carries", poll=is_listed
    )
    map_path: StringProperty(
        name="Map file", description="Where to write the fitted map", subtype="FILE_PATH", default="//map.vdb"
    )


def unit_of(asset):
    return asset.bespoke.unit or "mesh units"


def path_of(asset):
    return bpy.path.abspath(asset.data.filepath)


def add_asset(context, path, placed_like):
    """Makes the volume object of a map and chooses it. What is proved about it is asked of the command."""
    info = json.loads(command.run("info", "--json", path))
    volume = bpy.data.volumes.new(bpy.path.display_name_from_filepath(path))
    volume.filepath = bpy.path.relpath(path) if bpy.data.is_saved else path
    asset = bpy.data.objects.new(volume.name, volume)
    # As boxes of eight voxels a side where the shown grid has values. Fog of distances would hide the models.
    asset.display_type = "WIRE"
    volume.display.wireframe_type = "BOXES"
    volume.display.wireframe_detail = "FINE"
    if placed_like:
        asset.matrix_world = placed_like.matrix_world
    context.collection.objects.link(asset)
    # A property of the object itself, not of the add-on: drivers keep working where the add-on is not installed.
    asset["t"] = 1.0
    asset.id_properties_ui("t").update(min=0.0, max=1.0, description="How far the map goes: 0 source, 1 target")
    asset.update_tag()
    asset.bespoke.is_map = True
    asset.bespoke.unit = "" if info["unit"] == UNKNOWN_UNIT else info["unit"]
    asset.bespoke.steps = max(1, len(info.get("steps", ())))
    proof = info["certificate"]
    asset.bespoke.verdict = (
        f"a bijection, det ≥ {proof['min_determinant']:.3g}"
        if proof["bijection"]
        else f"{proof['folded']} folded and {proof['undecided']} undecided cells"
    )
    context.scene.bespoke.asset = asset
    context.view_layer.update()
    show_grid(asset, GRID_SHOWN_FIRST)
    return asset


def show_grid(asset, name):
    grids = asset.data.grids
    grids.load()
    if name in grids:
        grids.active_index = list(grids.keys()).index(name)


class LoadMap(bpy.types.Operator, ImportHelper):
    """Load a map as a volume object"""

    bl_idname = "bespoke.load_map"
    bl_label = "Load map"
    bl_options = {"REGISTER", "UNDO"}

    filename_ext = ".vdb"
    filter_glob: StringProperty(default="*.vdb", options={"HIDDEN"})
    like_active: BoolProperty(
        name="Placed like the active mesh",
        description="Give the map the active mesh's transform, so that the map's space is that mesh's own: right for models "
        "imported from the files that the map was made of. Otherwise the map's space is the world's",
        default=True,
    )

    def execute(self, context):
        active = context.active_object
        like = active if self.like_active and active and active.type == "MESH" else None
        try:
            asset = add_asset(context, self.filepath, like)
        except command.CommandError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        place = f"placed like {like.name}" if like else "in the world's space"
        self.report({"INFO"}, f"{asset.name}: {asset.bespoke.verdict}; {place}, lengths in {unit_of(asset)}")
        return {"FINISHED"}


def grid_items(self, context):
    asset = context.scene.bespoke.asset
    if not is_asset(asset):
        return []
    asset.data.grids.load()
    grid_items.kept = [(name, name, "") for name in asset.data.grids.keys()]  # Blender keeps no reference of its own
    return grid_items.kept


class ShowGrid(bpy.types.Operator):
    """Choose the grid of the map that the viewport shows"""

    bl_idname = "bespoke.show_grid"
    bl_label = "Show grid"
    bl_options = {"REGISTER", "UNDO"}

    grid: EnumProperty(name="Grid", items=grid_items)

    @classmethod
    def poll(cls, context):
        return is_asset(context.scene.bespoke.asset)

    def execute(self, context):
        show_grid(context.scene.bespoke.asset, self.grid)
        return {"FINISHED"}
