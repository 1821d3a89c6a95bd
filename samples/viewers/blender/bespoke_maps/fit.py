"""A map fitted between two meshes of the scene, while Blender stays usable."""

import json
import tempfile
import time
from pathlib import Path

import bpy
import numpy as np

from . import assets, points
from .anchors import models_in, pairs_of
from .command import BackgroundRun, CommandError

LOOK_EVERY = 0.2  # seconds


class Job:
    """One run of `bespoke fit`. Holds names and files only: undo may replace every object meanwhile."""

    def __init__(self, context, source, target, output):
        self.output = output
        self.started = time.monotonic()
        self.directory = tempfile.TemporaryDirectory(prefix="bespoke_")
        graph = context.evaluated_depsgraph_get()
        files = [Path(self.directory.name, name) for name in ("source.obj", "target.obj", "anchors.json")]
        for path, model in zip(files, (source, target)):
            write_model(path, model.evaluated_get(graph))
        pairs = pairs_of(source, target)
        files[2].write_text(json.dumps({"pairs": pairs}))
        anchors = ["--anchors", files[2]] if pairs else []
        self.run = BackgroundRun("fit", *files[:2], *anchors, "-o", output)

    def state(self):
        seconds = time.monotonic() - self.started
        return f"{self.run.lines[-1] if self.run.lines else 'begins'} ({seconds:.0f} s)"

    def warnings(self):
        marker = "bespoke: warning: "
        return [line.removeprefix(marker) for line in self.run.lines if line.startswith(marker)]

    def stop(self):
        self.run.stop()
        self.directory.cleanup()


running = None  # the Job, if one runs


def stop():
    global running
    if running:
        running.stop()
    running = None


def write_model(path, evaluated):
    """What is seen: modifiers and shape keys applied, in the world's space."""
    mesh = evaluated.to_mesh()
    try:
        x = np.empty(3 * len(mesh.vertices), np.float32)
        mesh.vertices.foreach_get("co", x)
        world = points.moved(np.array(evaluated.matrix_world, float), x.reshape(-1, 3).astype(float))
        triangles = points.triangles_of(mesh)
        if not len(triangles):
            raise CommandError(f"{evaluated.name} has no faces")
        points.write_obj(path, world, triangles)
    finally:
        evaluated.to_mesh_clear()


def output_path(context):
    path = context.scene.bespoke.map_path
    if path.startswith("//") and not bpy.data.is_saved:
        raise CommandError("save the .blend file first, or give the map file a full path")
    if not path.endswith(".vdb"):
        raise CommandError(f"the map file must end in .vdb, this is {path!r}")
    return bpy.path.abspath(path)


class FitMap(bpy.types.Operator):
    """Fit a map from the selected mesh to the active one, with empties that are their children as anchors"""

    bl_idname = "bespoke.fit"
    bl_label = "Fit selected to active"
    bl_options = {"UNDO"}

    timer = None

    @classmethod
    def poll(cls, context):
        if running:
            cls.poll_message_set("A fit is running")
        elif models_in(context) is None:
            cls.poll_message_set("Select two meshes in object mode, the target last")
        else:
            return True
        return False

    def start(self, context):
        global running
        source, target = models_in(context)
        running = Job(context, source, target, output_path(context))

    def finish(self, context):
        """Takes up the map. Raises CommandError if there is none."""
        global running
        job, running = running, None
        try:
            job.run.check()
        finally:
            job.directory.cleanup()
        for warning in job.warnings():
            self.report({"WARNING"}, warning)
        asset = assets.add_asset(context, job.output, None)
        self.report({"INFO"}, f"{asset.name}: {asset.bespoke.verdict}, {time.monotonic() - job.started:.0f} s")

    def execute(self, context):
        """From scripts and in the background: waits."""
        try:
            self.start(context)
            running.run.wait()
            self.finish(context)
        except CommandError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}

    def invoke(self, context, event):
        try:
            self.start(context)
        except CommandError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        self.timer = context.window_manager.event_timer_add(LOOK_EVERY, window=context.window)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        if running is None:  # cancelled, or the add-on was switched off
            self.put_away(context)
            return {"CANCELLED"}
        ended = running.run.poll()
        context.workspace.status_text_set(None if ended else "bespoke fit: " + running.state())
        for area in context.screen.areas:
            area.tag_redraw()
        if not ended:
            return {"PASS_THROUGH"}
        self.put_away(context)
        try:
            self.finish(context)
        except CommandError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}

    def cancel(self, context):
        """Blender closes the file or itself."""
        stop()
        self.put_away(context)

    def put_away(self, context):
        context.window_manager.event_timer_remove(self.timer)
        context.workspace.status_text_set(None)


class CancelFit(bpy.types.Operator):
    """Stop the fit that is running"""

    bl_idname = "bespoke.cancel_fit"
    bl_label = "Cancel"

    @classmethod
    def poll(cls, context):
        return running is not None

    def execute(self, context):
        stop()
        return {"FINISHED"}
