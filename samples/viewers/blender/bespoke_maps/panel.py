"""The sidebar of the 3D viewport."""

import bpy

from . import anchors, assets, fit


class Sidebar:
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "bespoke"


class MapPanel(Sidebar, bpy.types.Panel):
    bl_idname = "VIEW3D_PT_bespoke_map"
    bl_label = "Map"

    def draw(self, context):
        layout = self.layout
        layout.operator("bespoke.load_map", icon="FILE_VOLUME")
        settings = context.scene.bespoke
        layout.prop(settings, "asset")
        asset = settings.asset
        if not assets.is_asset(asset):
            return
        layout.prop(asset.data, "filepath", text="")
        layout.label(text=asset.bespoke.verdict)
        layout.label(text="Lengths in " + assets.unit_of(asset))
        grids = asset.data.grids
        shown = grids[grids.active_index].name if grids.is_loaded and len(grids) else "grid"
        layout.operator_menu_enum("bespoke.show_grid", "grid", text="Shown: " + shown)
        layout.prop(asset, '["t"]', text="t", slider=True)


class CarryPanel(Sidebar, bpy.types.Panel):
    bl_idname = "VIEW3D_PT_bespoke_carry"
    bl_label = "Carry"

    def draw(self, context):
        self.layout.operator("bespoke.carry", icon="SHAPEKEY_DATA")
        self.layout.operator("bespoke.bake", icon="ACTION")


class FitPanel(Sidebar, bpy.types.Panel):
    bl_idname = "VIEW3D_PT_bespoke_fit"
    bl_label = "Fit"

    def draw(self, context):
        layout = self.layout
        layout.operator("bespoke.add_anchor", icon="EMPTY_AXIS")
        layout.operator("bespoke.import_anchors", icon="IMPORT")
        layout.prop(context.scene.bespoke, "map_path")
        models = anchors.models_in(context)
        if models:
            layout.label(text=f"{models[0].name} onto {models[1].name}")
        layout.operator("bespoke.fit", icon="MOD_MESHDEFORM")
        if fit.running:
            layout.label(text=fit.running.state())
            layout.operator("bespoke.cancel_fit", icon="CANCEL")
