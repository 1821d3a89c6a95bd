"""bespoke's maps in Blender: load one, carry meshes through it as shape keys, bake the motion, fit a new one."""

import bpy

from . import anchors, assets, bake, carry, fit, panel, preferences

bl_info = {
    "name": "bespoke maps",
    "description": "Carries meshes through maps of the space around one model onto the space around another",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "3D Viewport > Sidebar > bespoke",
    "category": "Object",
}

classes = (
    preferences.Preferences,
    assets.ObjectSettings,
    assets.SceneSettings,
    assets.LoadMap,
    assets.ShowGrid,
    carry.CarryMeshes,
    bake.BakeFrames,
    anchors.AddAnchor,
    anchors.ImportAnchors,
    fit.FitMap,
    fit.CancelFit,
    panel.MapPanel,
    panel.CarryPanel,
    panel.FitPanel,
)


def register():
    for cls in classes:
        bpy.utils.register_class(cls)
    bpy.types.Object.bespoke = bpy.props.PointerProperty(type=assets.ObjectSettings)
    bpy.types.Scene.bespoke = bpy.props.PointerProperty(type=assets.SceneSettings)


def unregister():
    fit.stop()
    del bpy.types.Scene.bespoke
    del bpy.types.Object.bespoke
    for cls in reversed(classes):
        bpy.utils.unregister_class(cls)
