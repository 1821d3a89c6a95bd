"""The bespoke command: found, run, and asked for points.

The command and not the Python package does the work, because it serves every Blender alike: the package is an extension
module of one version of Python, and Blender's own downloads bring another one.
"""

import os
import queue
import shutil
import signal
import subprocess
import tempfile
import threading
from pathlib import Path

import bpy

from . import points
from .preferences import stated_command


class CommandError(Exception):
    """What the user has to be told."""


def find_command():
    """Raises CommandError where there is none."""
    stated = stated_command()
    path = bpy.path.abspath(stated) if stated else shutil.which("bespoke")
    if stated and not os.access(path, os.X_OK):
        raise CommandError(f"{path} is not a program; the add-on's preferences name it as the bespoke command")
    if not path:
        raise CommandError(
            "the bespoke command is not in PATH; give its place in Edit > Preferences > Add-ons > bespoke maps"
        )
    return path


def said(lines):
    """The last error among what the command wrote, without its name in front."""
    texts = [line.strip() for line in lines if line.strip()]
    errors = [text for text in texts if text.startswith("bespoke:")] or texts[-1:] or ["no message"]
    return errors[-1].removeprefix("bespoke:").strip()


def run(*arguments):
    """Runs to the end; what was printed. Raises CommandError with the command's own message."""
    line = [find_command(), *map(str, arguments)]
    try:
        done = subprocess.run(line, capture_output=True, text=True, stdin=subprocess.DEVNULL)
    except OSError as error:
        raise CommandError(f"cannot run {line[0]}: {error.strerror}") from error
    if done.returncode != 0:
        raise CommandError(said(done.stderr.splitlines()))
    return done.stdout


def image_at_frames(asset_path, x, frames):
    """Ψ(t) of points (n, 3) at t = 0, 1/frames, …, 1: (frames + 1, n, 3) doubles."""
    with tempfile.TemporaryDirectory(prefix="bespoke_") as directory:
        product = Path(directory, "product.ply")
        points.write_ply(product, x)
        run("apply", asset_path, product, "-o", Path(directory, "image.ply"), "--frames", frames, "--quiet")
        return points.read_in_order(directory, "image_*.ply")


class BackgroundRun:
    """A run that is looked at from time to time. `lines` is what it has written on standard error so far."""

    def __init__(self, *arguments):
        line = [find_command(), *map(str, arguments)]
        try:
            self._process = subprocess.Popen(
                line, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
            )
        except OSError as error:
            raise CommandError(f"cannot run {line[0]}: {error.strerror}") from error
        self.lines = []
        self._queue = queue.Queue()
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def _read(self):
        for line in self._process.stderr:
            self._queue.put(line)

    def poll(self):
        """Takes up what was written; true once the run has ended."""
        ended = self._process.poll() is not None
        if ended:
            self._reader.join()
        while not self._queue.empty():
            self.lines.append(self._queue.get().strip())
        return ended

    def wait(self):
        self._process.wait()
        self.poll()

    def stop(self):
        """The command leaves nothing half-written."""
        if self._process.poll() is None:
            self._process.send_signal(signal.SIGTERM)
            self._process.wait()

    def check(self):
        """Raises CommandError if the ended run failed."""
        if self._process.returncode != 0:
            raise CommandError(said(self.lines))
