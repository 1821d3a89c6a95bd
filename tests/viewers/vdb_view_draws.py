"""Runs vdb_view on a map, as samples/viewers/README.md says, until it has drawn the boxes of a grid: vdb_view_draws.py MAP

The display is one of Xvfb, which keeps its picture in a file.
"""

import os
import shlex
import signal
import struct
import subprocess
import sys
import tempfile
import time
from pathlib import Path

PATIENCE = 120  # seconds
BACKGROUND, BLUE_OF_BOXES = b"\xd9\xd9\xd9", b"\x9f\x47\x02"  # blue, green, red: of empty space and of leaf nodes


def colours(screen):
    """Of an XWD file with 32 bits a pixel, the set of them, three bytes each; none before there is a file."""
    data = screen.read_bytes() if screen.exists() else b""
    if len(data) < 100:
        return set()
    header = struct.unpack(">25I", data[:100])
    pixels = data[header[0] + 12 * header[19] :]
    return {pixels[i : i + 3] for i in range(0, len(pixels), 4)}


def wait_until_drawn(viewer, screen):
    started = time.monotonic()
    while not {BACKGROUND, BLUE_OF_BOXES} <= (seen := colours(screen)):
        if viewer.poll() is not None:
            sys.exit("vdb_view has ended")
        if time.monotonic() - started > PATIENCE:
            sys.exit("vdb_view has not drawn; colours: " + " ".join(sorted(c.hex() for c in seen)[:20]))
        time.sleep(0.5)


with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as directory:
    display = f"-screen 0 900x700x24 -noreset -fbdir {directory}"
    show = ["script", "-qc", "vdb_view " + shlex.quote(sys.argv[1]), "/dev/null"]
    viewer = subprocess.Popen(
        ["xvfb-run", "-a", "-s", display, *show], stdin=subprocess.DEVNULL, start_new_session=True
    )
    try:
        wait_until_drawn(viewer, Path(directory, "Xvfb_screen0"))
    finally:
        os.killpg(viewer.pid, signal.SIGTERM)
        viewer.wait()
