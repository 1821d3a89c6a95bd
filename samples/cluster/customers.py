#!/usr/bin/env python3
"""What many customers cost: one body with its dress fitted to bodies of random height and girths, as single runs and as a batch.

usage: customers.py BESPOKE [--customers 50] [--threads N] [--price EUROS] [--directory DIR]

Prints fits a minute of both, the CPU seconds, bytes and files of a customer, and what a million of them take by these rates.
The pair is that of `bespoke samples dress`, or --source, --target, --anchors and --product.
"""
import argparse
import json
import math
import os
import pathlib
import random
import resource
import shutil
import subprocess
import sys
import tempfile
import time


def timed(command):
    """Wall-clock and CPU seconds."""
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return time.monotonic() - start, cpu


class Body:
    """A seed's own: taller or shorter, wider or slimmer, and that not alike at every height."""

    def __init__(self, seed, height):
        numbers = random.Random(seed)
        self.height, self.tall, self.wide = height, numbers.gauss(1, 0.04), numbers.gauss(1, 0.06)
        self.waves = [(numbers.gauss(0, 0.03), numbers.uniform(0, 2 * math.pi)) for _ in range(2)]

    def __call__(self, x, y, z):
        wide = self.wide + sum(a * math.sin(2 * math.pi * (k + 1) * y / self.height + phase)
                               for k, (a, phase) in enumerate(self.waves))
        return wide * x, self.tall * y, wide * z


def write_customer(seed, lines, anchors, directory):
    points = [[float(word) for word in line.split()[1:4]] for line in lines if line.startswith("v ")]
    body = Body(seed, max(y for _, y, _ in points) - min(y for _, y, _ in points))
    moved = iter(points)
    with open(directory / f"{seed:06}.obj", "w") as target:
        for line in lines:
            target.write("v {:.6f} {:.6f} {:.6f}\n".format(*body(*next(moved))) if line.startswith("v ") else line)
    pairs = [pair | {"b": list(body(*pair["b"]))} for pair in anchors["pairs"]]
    (directory / f"{seed:06}.json").write_text(json.dumps(anchors | {"pairs": pairs}))


def size_of(*directories):
    files = [file for directory in directories for file in pathlib.Path(directory).rglob("*") if file.is_file()]
    return sum(file.stat().st_size for file in files), len(files)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bespoke")
    parser.add_argument("--customers", type=int, default=50)
    parser.add_argument("--threads", type=int, default=os.cpu_count())
    parser.add_argument("--price", type=float, default=0.04, help="euros a core and hour (default: 0.04)")
    parser.add_argument("--directory", help="where to work (default: a temporary directory)")
    for name in ("source", "target", "anchors"):
        parser.add_argument(f"--{name}", type=os.path.abspath)
    parser.add_argument("--product", type=os.path.abspath, action="append")
    arguments = parser.parse_args()
    bespoke = os.path.abspath(shutil.which(arguments.bespoke) or arguments.bespoke)
    directory = os.path.abspath(arguments.directory or tempfile.mkdtemp(prefix="bespoke_customers_"))
    customers = pathlib.Path(directory, "customers")
    customers.mkdir(parents=True, exist_ok=True)
    os.chdir(directory)

    if not arguments.source:
        subprocess.run([bespoke, "samples", "models", "dress", "-q"], check=True)
    source = arguments.source or "models/dress/source.obj"
    products = arguments.product or ["models/dress/dress.obj"]
    lines = open(arguments.target or "models/dress/target.obj").readlines()
    anchors = json.loads(pathlib.Path(arguments.anchors or "models/dress/anchors.json").read_text())
    names = [f"{seed:06}" for seed in range(arguments.customers)]
    for seed in range(arguments.customers):
        write_customer(seed, lines, anchors, customers)

    threads = ["-q", "--threads", str(arguments.threads)]
    pathlib.Path("single").mkdir(exist_ok=True)
    single = [timed([bespoke, "fit", source, f"customers/{name}.obj", "--anchors", f"customers/{name}.json", "-o",
                     f"single/{name}.vdb", *threads]) for name in names]
    with open("fits.jsonl", "w") as fits, open("applies.jsonl", "w") as applies:
        for name in names:
            fits.write(json.dumps({"command": "fit", "source": source, "target": f"customers/{name}.obj", "anchors":
                                   f"customers/{name}.json", "output": f"maps/{name}.vdb"}) + "\n")
            applies.write(json.dumps({"command": "apply", "map": f"maps/{name}.vdb", "product": products, "out-dir":
                                      f"carried/{name}"}) + "\n")
    fit_seconds, fit_cpu = timed([bespoke, "batch", "fits.jsonl", *threads])
    apply_seconds, apply_cpu = timed([bespoke, "batch", "applies.jsonl", *threads])
    same = all(pathlib.Path("maps", f"{n}.vdb").read_bytes() == pathlib.Path("single", f"{n}.vdb").read_bytes() for n in names)

    count = arguments.customers
    map_bytes, map_files = size_of("maps")
    carried_bytes, carried_files = size_of("carried")
    print(f"{count} customers, {len(products)} product(s) each, {arguments.threads} thread(s)")
    print(f"single fits: {60 * count / sum(s for s, _ in single):7.2f} a minute, {sum(c for _, c in single) / count:.2f} s of CPU each")
    print(f"batch:       {60 * count / fit_seconds:7.2f} a minute, {fit_cpu / count:.2f} s of CPU each, "
          + ("the same bytes" if same else "DIFFERENT BYTES"))
    print(f"products:    {count * len(products) / apply_seconds:7.2f} a second, {apply_cpu / count / len(products):.3f} s of CPU each")
    print(f"a customer:  {map_bytes / count / 1e6:.2f} MB of map, {carried_bytes / count / 1e6:.2f} MB of products, "
          f"{(map_files + carried_files) / count:.1f} files with the records")
    hours = 1e6 / count * (fit_seconds + apply_seconds) * arguments.threads / 3600
    print(f"a million:   {hours:,.0f} core hours, {hours * arguments.price:,.0f} EUR at {arguments.price} a core hour, "
          f"{1e6 / count * (map_bytes + carried_bytes) / 1e12:.2f} TB, {1e6 / count * (map_files + carried_files):,.0f} files")
    if not arguments.directory:
        shutil.rmtree(directory)
    if not same:
        sys.exit("customers.py: a batch made other bytes than single runs")


main()
