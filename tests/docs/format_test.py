"""The test vectors of the file format against the command, the reader of samples/viewers, the formula: format_test.py BESPOKE"""

import gzip
import hashlib
import importlib.util
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
VECTORS = ROOT / "samples" / "format"
ACCURACY = 1e-6  # the images have six digits behind the point
LARGEST = 20_000  # bytes of a stored map
BLOCK = 4096  # bytes, so that these small maps have several
IMAGES = {"images.obj": ("map", 1), "halfway.obj": ("map", 0.5), "chain_images.obj": ("chain", 1)}


def points(path):
    return [[float(x) for x in line.split()[1:4]] for line in path.read_text().splitlines() if line.startswith("v ")]


def distance(some, others):
    if len(some) != len(others) or not some:
        return float("inf")
    return max(abs(x - y) for p, q in zip(some, others) for x, y in zip(p, q))


def far(name, found):
    off = distance(found, points(VECTORS / name))
    return [] if off <= ACCURACY else [f"{name}: {off} off"]


def command_gives_the_images(bespoke, maps, scratch):
    broken = []
    for name, (map_name, t) in IMAGES.items():
        out = scratch / name
        subprocess.run([bespoke, "apply", maps / f"{map_name}.vdb", VECTORS / "points.obj", "--t", str(t), "-o", out, "-q"],
                       check=True)
        broken += far(name, points(out))
    return broken


def command_proves_the_maps(bespoke, maps):
    def is_proved(name):
        command = [bespoke, "check", maps / f"{name}.vdb", "--untrusted", "-q"]
        return subprocess.run(command, stdout=subprocess.DEVNULL).returncode == 0

    return [name for name in ("map", "chain") if not is_proved(name)]


def every_changed_byte_of_the_trailer_is_refused(bespoke, maps, scratch):
    content, broken = (maps / "map.vdb").read_bytes(), []
    for place in (0, len(content) // 2, len(content) - 64, len(content) - 56, len(content) - 48, len(content) - 1):
        damaged = bytearray(content)
        damaged[place] ^= 1
        (scratch / "damaged.vdb").write_bytes(damaged)
        code = subprocess.run([bespoke, "info", scratch / "damaged.vdb"], capture_output=True).returncode
        broken += [f"byte {place}: exit code {code}"] if code != 2 else []
    return broken


def with_block_hashes(content):
    """The same map under a trailer of version 2, as the page says it."""
    lengths = content[-48:-32]
    parts = content[: sum(struct.unpack("<QQ", lengths))]
    blocks = [parts[begin : begin + BLOCK] for begin in range(0, len(parts), BLOCK)]
    table = b"".join(hashlib.sha256(block).digest() for block in blocks)
    head = b"BESPOKE\n" + struct.pack("<II", 2, BLOCK) + lengths
    return parts + table + head + hashlib.sha256(table + head).digest()


def maps_with_block_hashes_are_read(bespoke, maps, scratch):
    in_blocks = scratch / "in_blocks"
    in_blocks.mkdir()
    for name in ("map", "chain"):
        (in_blocks / f"{name}.vdb").write_bytes(with_block_hashes((maps / f"{name}.vdb").read_bytes()))
    broken = command_gives_the_images(bespoke, in_blocks, scratch)
    return broken + every_changed_byte_of_the_trailer_is_refused(bespoke, in_blocks, scratch)


def reader_gives_the_images(maps, scratch):
    reader, broken = ROOT / "samples" / "viewers" / "read_asset.py", []
    for name in ("images.obj", "chain_images.obj"):
        command = ["/usr/bin/python3", reader, maps / f"{IMAGES[name][0]}.vdb", VECTORS / "points.obj", scratch / name]
        subprocess.run(command, check=True)
        broken += far(name, points(scratch / name))
    return broken


def formula_gives_the_images(vectors):
    steps = {"map": [vectors.first_step()], "chain": [vectors.first_step(), vectors.second_step()]}
    broken = []
    for name, (map_name, t) in IMAGES.items():
        if t == 1:
            broken += far(name, [vectors.mapped(steps[map_name], point).tolist() for point in vectors.POINTS])
    # Half of a quarter turn about z.
    c = 0.5**0.5
    rotation, step = [[c, -c, 0], [c, c, 0], [0, 0, 1]], vectors.first_step()
    middles = [[(a + b) / 2 for a, b in zip(x, step(x))] for x in vectors.POINTS]
    half = [[sum(r * m for r, m in zip(row, middle)) + shift / 2 for row, shift in zip(rotation, vectors.TRANSLATION)]
            for middle in middles]
    return broken + far("halfway.obj", half)


def load_vectors():
    spec = importlib.util.spec_from_file_location("make_vectors", VECTORS / "make_vectors.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def main():
    bespoke = Path(sys.argv[1]).resolve()
    with tempfile.TemporaryDirectory() as directory:
        scratch = Path(directory)
        stored = {name: VECTORS / f"{name}.vdb.gz" for name in ("map", "chain")}
        for name, path in stored.items():
            (scratch / f"{name}.vdb").write_bytes(gzip.decompress(path.read_bytes()))
        properties = {
            "stored maps are small": [str(path) for path in stored.values() if path.stat().st_size > LARGEST],
            "the command gives the images": command_gives_the_images(bespoke, scratch, scratch),
            "the command proves the maps": command_proves_the_maps(bespoke, scratch),
            "a changed byte is refused": every_changed_byte_of_the_trailer_is_refused(bespoke, scratch, scratch),
            "maps with a hash a block are read": maps_with_block_hashes_are_read(bespoke, scratch, scratch),
        }
        if importlib.util.find_spec("numpy") and importlib.util.find_spec("pyopenvdb"):
            new = scratch / "new"
            subprocess.run(["/usr/bin/python3", "-B", VECTORS / "make_vectors.py", new], check=True)
            properties |= {
                "the reader gives the images": reader_gives_the_images(scratch, scratch),
                "the formula gives the images": formula_gives_the_images(load_vectors()),
                "maps written anew give the images": command_gives_the_images(bespoke, new, scratch),
                "maps written anew are proved": command_proves_the_maps(bespoke, new),
            }
        else:
            print("skipped: what needs pyopenvdb and NumPy (tools/setup)")
    for prop, exceptions in properties.items():
        print(f"{'broken' if exceptions else 'held'}: {prop}", *exceptions, sep="\n  ")
    sys.exit(any(properties.values()))


if __name__ == "__main__":
    main()
