"""Properties of the Blender add-on, run inside Blender: blender -b --factory-startup -P blender_test.py -- DIRECTORY COMMAND ADD_ONS

DIRECTORY holds source.obj, target.obj, anchors.json, product.obj and map.vdb. Prints the name of every property that holds.
"""

import json
import math
import subprocess
import sys
from pathlib import Path

import addon_utils
import bpy
import numpy as np
from mathutils import Matrix

DIRECTORY, COMMAND, ADD_ONS = sys.argv[sys.argv.index("--") + 1 :]
DIRECTORY = Path(DIRECTORY)
sys.path[:0] = [ADD_ONS, str(Path(__file__).parent)]
from held_properties import points_of, run

FLOAT_ROUNDING = 2.0**-23  # of the largest coordinate: one rounding by the add-on, one by Blender


def read_obj(name):
    vertices, faces = [], []
    for line in (DIRECTORY / name).read_text().splitlines():
        words = line.split()
        if words[:1] == ["v"]:
            vertices.append([float(word) for word in words[1:4]])
        elif words[:1] == ["f"]:
            faces.append([int(word.split("/")[0]) - 1 for word in words[1:]])
    return np.array(vertices), faces


def command(*words):
    subprocess.run([COMMAND, *map(str, words), "--quiet"], check=True)


def apply(name, t):
    command("apply", DIRECTORY / "map.vdb", DIRECTORY / name, "-o", DIRECTORY / "applied.obj", "--t", t)
    return read_obj("applied.obj")[0]


def add_mesh(name, transform=Matrix()):
    vertices, faces = read_obj(name)
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices.tolist(), [], faces)
    thing = bpy.data.objects.new(name, mesh)
    thing.matrix_world = transform
    bpy.context.collection.objects.link(thing)
    bpy.context.view_layer.update()
    return thing


def choose(*things):
    """Selects them, the last one active."""
    for other in bpy.context.view_layer.objects:
        other.select_set(False)
    for thing in things:
        thing.select_set(True)
    bpy.context.view_layer.objects.active = things[-1]


def shown_points(thing, space):
    """Where the vertices are now, in the space of an object."""
    return points_of(thing, np.linalg.solve(np.array(space.matrix_world, float), np.array(thing.matrix_world, float)))


def set_t(asset, t):
    asset["t"] = t
    asset.update_tag()
    bpy.context.view_layer.update()


def load(like=None):
    if like:
        choose(like)
    bpy.ops.bespoke.load_map(filepath=str(DIRECTORY / "map.vdb"), like_active=like is not None)
    return bpy.context.scene.bespoke.asset


def refused(operator, words, **options):
    """A Python exception is how operators report errors to scripts."""
    try:
        operator(**options)
    except RuntimeError as error:
        assert words in str(error), f"{error} does not say {words!r}"
        return
    raise AssertionError(f"not refused: {words}")


def close(found, expected, tolerance):
    worst = np.abs(found - expected).max()
    assert worst <= tolerance, f"{worst} apart, {tolerance} allowed"


def loaded_map_shows_its_grids():
    asset = load()
    assert asset.type == "VOLUME" and Path(asset.data.filepath) == DIRECTORY / "map.vdb"
    names = asset.data.grids.keys()
    assert {"displacement", "source_distance", "jacobian", "u_0"} <= set(names), names
    assert names[asset.data.grids.active_index] == "source_distance"
    bpy.ops.bespoke.show_grid(grid="jacobian")
    assert names[asset.data.grids.active_index] == "jacobian"
    assert asset.bespoke.verdict.startswith("a bijection") and asset.bespoke.unit == "cm"


def carried_vertices_agree_with_apply():
    """Also where object and map stand askew in the scene."""
    askew = Matrix.Translation((5, -3, 2)) @ Matrix.Rotation(1.1, 4, (1, 2, 3)) @ Matrix.Scale(0.3, 4)
    for place in (Matrix(), askew):
        source = add_mesh("source.obj", place)
        asset = load(like=source)
        product = add_mesh("product.obj", place)
        choose(product)
        assert bpy.ops.bespoke.carry() == {"FINISHED"}
        expected = apply("product.obj", 1)
        # A transform in floats (Blender's) moves what it is applied to once there and once back.
        slack = 1 if place == Matrix() else 20
        close(shown_points(product, asset), expected, slack * FLOAT_ROUNDING * np.abs(expected).max())
        set_t(asset, 0.0)
        x = read_obj("product.obj")[0]
        close(shown_points(product, asset), x, slack * FLOAT_ROUNDING * np.abs(expected).max())


def scaled_objects_reach_the_same_places():
    """The product's transform is not the map's."""
    asset = load()
    shape = Matrix.Translation((1, 2, 3)) @ Matrix.Diagonal((2, 0.5, -3, 1))
    product = add_mesh("product.obj", shape)
    x = np.array(product.matrix_world.inverted() @ Matrix()) @ np.c_[read_obj("product.obj")[0], np.ones(729)].T
    product.data.vertices.foreach_set("co", x[:3].T.astype(np.float32).ravel())
    choose(product)
    bpy.ops.bespoke.carry()
    expected = apply("product.obj", 1)
    close(shown_points(product, asset), expected, 20 * FLOAT_ROUNDING * np.abs(expected).max())


def keys_follow_the_path_of_the_map():
    asset = load()
    product = add_mesh("product.obj")
    choose(product)
    diagonal = np.linalg.norm(np.ptp(read_obj("product.obj")[0], axis=0))
    counts = []
    for percent in (10.0, 0.01):
        bpy.ops.bespoke.carry(tolerance=percent)
        keys = product.data.shape_keys.key_blocks
        counts.append(len(keys) - 1)
        for t in (0.31, 0.5, 0.77):
            set_t(asset, t)
            off = np.linalg.norm(shown_points(product, asset) - apply("product.obj", t), axis=1).max()
            # Measured between keys at more places than these three, so 10 % more at others.
            assert off <= 1.1 * percent / 100 * diagonal, (percent, t, off)
    assert 1 <= counts[0] < counts[1], counts
    drivers = product.data.shape_keys.animation_data.drivers
    assert len(drivers) == counts[1] and all(curve.driver.is_simple_expression for curve in drivers)


def other_shape_keys_stay():
    asset = load()
    product = add_mesh("product.obj")
    product.shape_key_add(name="Basis")
    product.shape_key_add(name="mine").value = 0.25
    choose(product)
    bpy.ops.bespoke.carry()
    bpy.ops.bespoke.carry()
    keys = product.data.shape_keys.key_blocks
    count = len(product.data.shape_keys.animation_data.drivers)
    assert keys["mine"].value == 0.25 and len(keys) == 2 + count
    assert [f"bespoke {n}/{count}" in keys for n in range(1, count + 1)] == [True] * count
    expected = apply("product.obj", 1)
    close(shown_points(product, asset), expected, FLOAT_ROUNDING * np.abs(expected).max())


def shared_meshes_become_ones_own():
    load()
    product = add_mesh("product.obj")
    twin = bpy.data.objects.new("twin", product.data)
    bpy.context.collection.objects.link(twin)
    choose(product)
    bpy.ops.bespoke.carry()
    assert product.data != twin.data and twin.data.shape_keys is None


def modifiers_are_applied_on_a_copy_on_request():
    asset = load()
    product = add_mesh("product.obj")
    shift = product.modifiers.new("shift", "DISPLACE")
    shift.direction, shift.strength, shift.mid_level = "X", 0.1, 0.0
    choose(product)
    bpy.ops.bespoke.carry(apply_modifiers=True)
    assert product.data.shape_keys is None
    copy = bpy.context.active_object
    assert copy != product and not copy.modifiers
    close(shown_points(copy, asset)[:, 0].max(), apply_to_shifted(0.1)[:, 0].max(), 1e-5)


def apply_to_shifted(distance):
    x, faces = read_obj("product.obj")
    rows = ["v {:.9g} {:.9g} {:.9g}".format(*row) for row in x + [distance, 0, 0]]
    (DIRECTORY / "shifted.obj").write_text("\n".join(rows) + "\n")
    return apply("shifted.obj", 1)


def trouble_is_named():
    asset = load()
    product = add_mesh("product.obj")
    choose(product)
    flat = add_mesh("product.obj", Matrix.Diagonal((1, 0, 1, 1)))
    choose(flat)
    refused(bpy.ops.bespoke.carry, "scaled to nothing")
    empty = bpy.data.objects.new("nothing", bpy.data.meshes.new("nothing"))
    bpy.context.collection.objects.link(empty)
    choose(empty)
    refused(bpy.ops.bespoke.carry, "no vertices")
    choose(product)
    bpy.ops.object.mode_set(mode="EDIT")
    refused(bpy.ops.bespoke.carry, "object mode")
    bpy.ops.object.mode_set(mode="OBJECT")
    asset.data.filepath = str(DIRECTORY / "gone.vdb")
    refused(bpy.ops.bespoke.carry, "gone.vdb")
    bpy.context.scene.bespoke.asset = None
    refused(bpy.ops.bespoke.carry, "Load a map")
    refused(bpy.ops.bespoke.load_map, "source.obj", filepath=str(DIRECTORY / "source.obj"))


def missing_command_is_named():
    preferences = bpy.context.preferences.addons["bespoke_maps"].preferences
    path = DIRECTORY / "no_such_command"
    for stated in (str(path), str(DIRECTORY / "source.obj")):
        preferences.command = stated
        refused(bpy.ops.bespoke.load_map, "not a program", filepath=str(DIRECTORY / "map.vdb"))
    preferences.command = ""
    refused(bpy.ops.bespoke.load_map, "not in PATH", filepath=str(DIRECTORY / "map.vdb"))
    preferences.command = COMMAND


def undo_takes_carrying_back():
    load()
    product = add_mesh("product.obj")
    choose(product)
    bpy.ops.ed.undo_push(message="before")
    bpy.ops.bespoke.carry()
    bpy.ops.ed.undo_push(message="after")
    bpy.ops.ed.undo()
    assert bpy.data.objects["product.obj"].data.shape_keys is None
    bpy.ops.ed.redo()
    assert len(bpy.data.objects["product.obj"].data.shape_keys.key_blocks) > 1


def baked_frames_are_exact():
    asset = load()
    product = add_mesh("product.obj")
    choose(product)
    bpy.ops.bespoke.carry(tolerance=10.0)
    bpy.ops.bespoke.bake(first=1, last=5)
    assert not product.data.shape_keys.animation_data.drivers
    for frame in range(1, 6):
        bpy.context.scene.frame_set(frame)
        expected = apply("product.obj", (frame - 1) / 4)
        close(shown_points(product, asset), expected, 2 * FLOAT_ROUNDING * np.abs(expected).max())
    bpy.ops.bespoke.carry()
    assert product.data.shape_keys.animation_data.drivers
    refused(bpy.ops.bespoke.bake, "does not come after", first=5, last=5)


def baking_follows_an_animated_t():
    asset = load()
    product = add_mesh("product.obj")
    choose(product)
    bpy.ops.bespoke.carry()
    for frame, t in ((1, 0.0), (3, 0.8), (5, 0.8)):
        asset["t"] = t
        asset.keyframe_insert('["t"]', frame=frame)
    bpy.ops.bespoke.bake(first=1, last=6)
    assert len(product.data.shape_keys.key_blocks) == 3  # Basis, t at frame 2, and 0.8
    for frame in (1, 2, 4, 6):
        bpy.context.scene.frame_set(frame)
        expected = apply("product.obj", asset["t"])
        close(shown_points(product, asset), expected, 2 * FLOAT_ROUNDING * np.abs(expected).max())


def fitted_map_is_the_commands():
    """Byte by byte, on models and anchors as Blender keeps them: in floats."""
    from bespoke_maps import anchors, fit

    source, target = add_mesh("source.obj"), add_mesh("target.obj")
    choose(source, target)
    bpy.ops.bespoke.import_anchors(filepath=str(DIRECTORY / "anchors.json"))
    choose(source, target)
    bpy.context.scene.bespoke.map_path = str(DIRECTORY / "made_here.vdb")
    assert bpy.ops.bespoke.fit() == {"FINISHED"}
    asset = bpy.context.scene.bespoke.asset
    assert Path(asset.data.filepath) == DIRECTORY / "made_here.vdb"

    files = [DIRECTORY / name for name in ("seen_source.obj", "seen_target.obj", "seen_anchors.json")]
    graph = bpy.context.evaluated_depsgraph_get()
    for path, model in zip(files, (source, target)):
        fit.write_model(path, model.evaluated_get(graph))
        expected, faces = read_obj(model.name)
        seen, seen_faces = read_obj(path.name)
        close(seen, expected, FLOAT_ROUNDING * np.abs(expected).max())
        assert seen_faces == faces
    pairs = anchors.pairs_of(source, target)
    given = {pair["name"]: pair for pair in json.loads((DIRECTORY / "anchors.json").read_text())["pairs"]}
    for pair in pairs:
        for end in "ab":
            place = np.array(given[pair["name"]][end])
            close(np.array(pair[end]), place, FLOAT_ROUNDING * np.abs(place).max())
    assert len(pairs) == len(given)
    files[2].write_text(json.dumps({"pairs": pairs}))
    command("fit", *files[:2], "--anchors", files[2], "-o", DIRECTORY / "commands.vdb")
    assert (DIRECTORY / "made_here.vdb").read_bytes() == (DIRECTORY / "commands.vdb").read_bytes()


def fit_says_what_is_missing():
    source, target = add_mesh("source.obj"), add_mesh("target.obj")
    choose(source, target)
    bpy.context.scene.bespoke.map_path = str(DIRECTORY / "made_here.vdb")
    bpy.context.scene.cursor.location = (0, 0, 5)
    choose(target)
    bpy.ops.bespoke.add_anchor(name="crown")
    empty = target.children[0]
    bpy.context.view_layer.update()
    assert target.closest_point_on_mesh(empty.location)[1] == empty.location
    refused(bpy.ops.bespoke.add_anchor, "has an anchor named crown", name="crown")
    choose(source, target)
    refused(bpy.ops.bespoke.fit, "crown on target.obj")
    bpy.context.scene.bespoke.map_path = "//map.vdb"
    bpy.data.objects.remove(empty)
    refused(bpy.ops.bespoke.fit, "save the .blend")
    choose(source)
    refused(bpy.ops.bespoke.fit, "Select two meshes")


def t_moves_meshes_where_the_add_on_is_absent():
    asset = load()
    product = add_mesh("product.obj")
    choose(product)
    bpy.ops.bespoke.carry()
    name = asset.name
    bpy.ops.wm.save_as_mainfile(filepath=str(DIRECTORY / "scene.blend"))
    addon_utils.disable("bespoke_maps")
    bpy.ops.wm.open_mainfile(filepath=str(DIRECTORY / "scene.blend"))
    asset, product = bpy.data.objects[name], bpy.data.objects["product.obj"]
    set_t(asset, 1.0)
    expected = apply("product.obj", 1)
    close(shown_points(product, asset), expected, FLOAT_ROUNDING * np.abs(expected).max())
    enable()


def enable():
    addon_utils.enable("bespoke_maps", default_set=True)
    bpy.context.preferences.addons["bespoke_maps"].preferences.command = COMMAND


PROPERTIES = (
    loaded_map_shows_its_grids,
    carried_vertices_agree_with_apply,
    scaled_objects_reach_the_same_places,
    keys_follow_the_path_of_the_map,
    other_shape_keys_stay,
    shared_meshes_become_ones_own,
    modifiers_are_applied_on_a_copy_on_request,
    trouble_is_named,
    missing_command_is_named,
    undo_takes_carrying_back,
    baked_frames_are_exact,
    baking_follows_an_animated_t,
    fitted_map_is_the_commands,
    fit_says_what_is_missing,
    t_moves_meshes_where_the_add_on_is_absent,
)

enable()
run(PROPERTIES, enable)
