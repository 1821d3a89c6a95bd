"""The curves that animate a data-block, wherever this Blender keeps them."""


def curves_of(data):
    """The F-curves of animation data, or None: an action's until Blender 4.5, since then what it holds for the data's slot."""
    action = data.action if data else None
    if not action:
        return None
    if hasattr(action, "fcurves"):
        return action.fcurves
    from bpy_extras import anim_utils

    bag = anim_utils.action_get_channelbag_for_slot(action, data.action_slot)
    return bag.fcurves if bag else None


def curves_for(data):
    """The same of an action that may be new and still have no place for them."""
    action = data.action
    if hasattr(action, "fcurves"):
        return action.fcurves
    from bpy_extras import anim_utils

    if not data.action_slot:
        block = data.id_data
        data.action_slot = action.slots.new(id_type=block.id_type, name=block.name)
    return anim_utils.action_ensure_channelbag_for_slot(action, data.action_slot).fcurves
