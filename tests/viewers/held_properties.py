"""Runs properties inside Blender, each in an empty scene."""
import sys
import traceback

import bpy


def run(properties, prepare=lambda: None):
    """Prints the name of every property that holds, then leaves Blender; with 1 where one is broken."""
    broken = 0
    for prop in properties:
        bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
        prepare()
        try:
            prop()
            print("held:", prop.__name__)
        except Exception:
            traceback.print_exc()
            print("broken:", prop.__name__)
            broken += 1
    sys.exit(1 if broken else 0)
