#!/usr/bin/env python3
"""What a batch costs beside its work: many tiny products through one map, as one `apply` and as as many jobs.

usage: overhead.py BESPOKE [--jobs 10000] [--threads 1] [--turns 1] [--directory DIR]

Prints wall-clock and CPU seconds, the medians of some turns, of: `apply` of all products in one process, the batch of one job a product, the same
batch again with nothing to do, and once more after every file was touched. Fits the map it needs; some minutes in all.
"""
import argparse
import json
import os
import pathlib
import random
import resource
import shutil
import statistics
import subprocess
import sys
import tarfile
import tempfile
import time


def timed(turns, name, command):
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    seconds = time.monotonic() - start
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    turns.setdefault(name, []).append((seconds, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime))


def one_turn(turns, bespoke, products, threads):
    """From nothing: whatever the turn before has written is removed first."""
    for directory in ["single", "batch"]:
        shutil.rmtree(directory, ignore_errors=True)
    pathlib.Path("packed.tar").unlink(missing_ok=True)
    timed(turns, "apply, one process", [bespoke, "apply", "map.vdb", *products, "--out-dir", "single", "-q", *threads])
    batch = [bespoke, "batch", "jobs.jsonl", "-q", *threads]
    timed(turns, "batch, one job a product", batch)
    timed(turns, "batch again, nothing to do", batch)
    for name in ["map.vdb", *products]:
        os.utime(name)
    timed(turns, "batch again, every input touched", batch)
    packed = [*batch, "--pack", "packed.tar"]
    timed(turns, "batch --pack", packed)
    timed(turns, "batch --pack again, nothing to do", packed)


def is_same():
    """Whether the three ways have made the same products."""
    wanted = {p.name: p.read_bytes() for p in pathlib.Path("single").glob("*.obj")}
    files = {p.name: p.read_bytes() for p in pathlib.Path("batch").glob("*.obj")}
    with tarfile.open("packed.tar") as archive:
        members = {pathlib.Path(m.name).name: archive.extractfile(m).read() for m in archive if m.name.endswith(".obj")}
    return wanted == files == members


def tiny_product(seed):
    """A strip of 60 vertices about the size of a button, somewhere around the body, with a seed's own numbers."""
    numbers = random.Random(seed)
    x, y, z = (numbers.uniform(-20, 20), numbers.uniform(60, 150), numbers.uniform(-15, 15))
    vertices = [f"v {x + numbers.uniform(-1, 1):.5f} {y + 0.1 * i:.5f} {z + numbers.uniform(-1, 1):.5f}" for i in range(60)]
    faces = [f"f {i} {i + 1} {i + 2}" for i in range(1, 59)]
    return "\n".join(vertices + faces) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bespoke")
    parser.add_argument("--jobs", type=int, default=10000)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--turns", type=int, default=1)
    parser.add_argument("--directory", default=None, help="where to work (default: a temporary directory)")
    arguments = parser.parse_args()
    bespoke = os.path.abspath(shutil.which(arguments.bespoke) or arguments.bespoke)
    directory = pathlib.Path(arguments.directory or tempfile.mkdtemp(prefix="bespoke_overhead_")).resolve()
    (directory / "products").mkdir(parents=True, exist_ok=True)
    os.chdir(directory)

    subprocess.run([bespoke, "samples", "models", "dress", "-q"], check=True)
    subprocess.run([bespoke, "fit", "models/dress/source.obj", "models/dress/target.obj", "--anchors",
                    "models/dress/anchors.json", "-o", "map.vdb", "-q"], check=True)
    products = [f"products/{i:06}.obj" for i in range(arguments.jobs)]
    for i, product in enumerate(products):
        pathlib.Path(product).write_text(tiny_product(i))
    with open("jobs.jsonl", "w") as manifest:
        for product in products:
            job = {"command": "apply", "map": "map.vdb", "product": product, "out-dir": "batch"}
            manifest.write(json.dumps(job) + "\n")

    threads = ["--threads", str(arguments.threads)]
    turns = {}
    for _ in range(arguments.turns):
        one_turn(turns, bespoke, products, threads)
    print(f"{arguments.jobs} products, {arguments.threads} thread(s), median of {arguments.turns} turn(s)")
    for name, times in turns.items():
        seconds, cpu = ([t[i] for t in times] for i in (0, 1))
        print(f"{name:36} {statistics.median(seconds):7.2f} s ({min(seconds):.2f} to {max(seconds):.2f})"
              f"   {statistics.median(cpu):7.2f} s of CPU")
    print(f"{len(os.listdir('batch'))} files, or one of {os.path.getsize('packed.tar') / 1e6:.0f} MB")
    same = is_same()
    print("same bytes" if same else "DIFFERENT BYTES")
    if not arguments.directory:
        shutil.rmtree(directory)
    if not same:
        sys.exit("overhead.py: a batch made other bytes than one process")


main()
