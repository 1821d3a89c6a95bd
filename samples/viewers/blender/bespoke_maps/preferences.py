"""Where the command is."""

import bpy


class Preferences(bpy.types.AddonPreferences):
    bl_idname = __package__

    command: bpy.props.StringProperty(
        name="bespoke command",
        description="The program that computes. Empty: the one that PATH finds",
        subtype="FILE_PATH",
    )

    def draw(self, context):
        self.layout.prop(self, "command")


def stated_command():
    """The path that the user gave, or an empty text."""
    addon = bpy.context.preferences.addons.get(__package__)
    return addon.preferences.command if addon else ""
