#!/usr/bin/env python3
"""Two scans of one limb below the knee, a year apart, and the liner made for the first: make_limbs.py DIR

Writes last_year.stl, today.stl (binary, mm), liner.stl, and landmarks.csv, the points that a prosthetist marks on both. The
limb is a formula: a tapered tube with a rounded end, a crest along the shin and the head of the fibula. Today's limb is
shorter, thinner towards its end, and was scanned in another position and with other triangles.
"""
import math
import pathlib
import struct
import sys

LINER = 4  # mm


class Limb:
    def __init__(self, length, taper, shrunk, turn, shift):
        self.length, self.taper, self.shrunk = length, taper, shrunk
        self.cos, self.sin, self.shift = math.cos(turn), math.sin(turn), shift

    def at(self, s, phi, outwards=0.0):
        """The point a part s of the way down (0 the scan's rim, 1 the end), at the angle phi from the shin, mm."""
        crest = 4 * math.exp(-((math.remainder(phi, math.tau) / 0.35) ** 2))
        fibula = 6 * math.exp(-(((s - 0.2) / 0.09) ** 2) - (math.remainder(phi - 1.7, math.tau) / 0.4) ** 2)
        calf = 5 * math.exp(-(((s - 0.35) / 0.2) ** 2) - (math.remainder(phi - math.pi, math.tau) / 0.9) ** 2)
        width = (56 - self.taper * s) * (1 - self.shrunk * s) + crest + fibula + calf
        # The last quarter is rounded off.
        end = max(0.0, (s - 0.75) / 0.25)
        radius = (width + outwards) * math.sqrt(max(0.0, 1 - end * end))
        x, y = radius * math.sin(phi), radius * math.cos(phi)
        z = -self.length * s - outwards * end
        return (self.cos * x - self.sin * z + self.shift[0], y + self.shift[1], self.sin * x + self.cos * z + self.shift[2])


def surface(limb, rings, sectors, outwards=0.0, begin=0.0):
    """Triangles between rings of points, faces outwards; the end is closed, the rim open."""
    def point(ring, sector):
        # Rings lie denser where the end is round.
        s = begin + (1 - begin) * math.sin(math.pi / 2 * ring / rings)
        return limb.at(s, math.tau * (sector % sectors) / sectors, outwards)

    for ring in range(rings):
        for sector in range(sectors):
            a, b = point(ring, sector), point(ring, sector + 1)
            c, d = point(ring + 1, sector), point(ring + 1, sector + 1)
            yield a, b, c
            if ring + 1 < rings:
                yield b, d, c


def write_stl(path, triangles):
    records = [struct.pack("<12fH", 0, 0, 0, *(x for corner in t for x in corner), 0) for t in triangles]
    path.write_bytes(b"limb, mm".ljust(80) + struct.pack("<I", len(records)) + b"".join(records))


folder = pathlib.Path(sys.argv[1])
folder.mkdir(parents=True, exist_ok=True)
last_year = Limb(180, 12, 0.0, 0.0, (0, 0, 0))
today = Limb(174, 13, 0.10, 0.25, (30, -12, 400))
write_stl(folder / "last_year.stl", surface(last_year, 60, 96))
write_stl(folder / "today.stl", surface(today, 52, 110))
liner = [*surface(last_year, 50, 80, LINER, 0.15)]
liner += [(a, c, b) for a, b, c in surface(last_year, 50, 80, 0.5, 0.15)]
write_stl(folder / "liner.stl", liner)

marks = {"tendon": (0.06, 0.0), "shin_middle": (0.4, 0.0), "shin_low": (0.7, 0.0), "fibula_head": (0.2, 1.7),
         "outside_low": (0.6, 1.7), "calf": (0.35, math.pi), "back_low": (0.7, math.pi), "inside": (0.3, -1.6),
         "inside_low": (0.7, -1.6), "end": (1.0, 0.0)}
rows = [",".join([name, *(f"{x:.4f}" for x in (*last_year.at(*place), *today.at(*place)))]) for name, place in marks.items()]
(folder / "landmarks.csv").write_text("\n".join(["name,ax,ay,az,bx,by,bz", *rows]) + "\n")
