"""Writes warp.json and enclosed_faces.json beside itself: inputs and what follows from the definitions, computed by neither
the library nor the pages.

    python3 tests/vectors/make_vectors.py

A warp is the solution of its linear system with 60 digits. What a line encloses is known where it is the cut of a plane: the
faces of which two corners at least lie beyond the plane.
"""
import json
import math
import random
from decimal import Decimal, getcontext
from pathlib import Path

getcontext().prec = 60
FOLDER = Path(__file__).parent


def rounded(rows):
    return [[float(value) for value in row] for row in rows]


def solved(matrix, right):
    """Gauss with pivots; both lists of rows, changed."""
    n = len(matrix)
    for k in range(n):
        pivot = max(range(k, n), key=lambda i: abs(matrix[i][k]))
        matrix[k], matrix[pivot], right[k], right[pivot] = matrix[pivot], matrix[k], right[pivot], right[k]
        for i in range(k + 1, n):
            share = matrix[i][k] / matrix[k][k]
            matrix[i] = [a - share * b for a, b in zip(matrix[i], matrix[k])]
            right[i] = [a - share * b for a, b in zip(right[i], right[k])]
    for k in reversed(range(n)):
        for j in range(k + 1, n):
            right[k] = [a - matrix[k][j] * b for a, b in zip(right[k], right[j])]
        right[k] = [value / matrix[k][k] for value in right[k]]
    return right


def distance(a, b):
    return sum((x - y) ** 2 for x, y in zip(a, b)).sqrt()


def diagonal(points):
    return sum((max(axis) - min(axis)) ** 2 for axis in zip(*points)).sqrt()


def warped(sources, targets, sigmas, queries):
    """sum of c_i |x - a_i|^3 with an affine tail; a sigma adds (sigma / 0.1 D_b)^2 D_a^3 to the diagonal (D: diagonals)."""
    a, b, x = ([[Decimal(value) for value in point] for point in points] for points in (sources, targets, queries))
    n = len(a)
    matrix = [[distance(p, q) ** 3 for q in a] + [Decimal(1)] + p for p in a]
    for i, sigma in enumerate(sigmas):
        matrix[i][i] += (Decimal(sigma) / (diagonal(b) / 10)) ** 2 * diagonal(a) ** 3
    matrix += [[row[n + k] for row in matrix[:n]] + [Decimal(0)] * 4 for k in range(4)]
    c = solved(matrix, b + [[Decimal(0)] * 3 for _ in range(4)])
    basis = [[distance(p, q) ** 3 for q in a] + [Decimal(1)] + p for p in x]
    return rounded([[sum(w * row[axis] for w, row in zip(weights, c)) for axis in range(3)] for weights in basis])


def warp_cases():
    random.seed(1)
    cloud = lambda count, size: [[size * round(random.uniform(-1, 1), 3) for _ in range(3)] for _ in range(count)]
    bend = lambda p: [1.2 * p[0] + 0.3 * p[1] * p[1], 0.9 * p[1] - 0.2 * p[2], p[2] + 0.25 * p[0] * p[1]]
    far = [[value + 1000 for value in point] for point in cloud(9, 50)]
    cases = [("interpolates", cloud(8, 1), bend, lambda i: 0), ("smooths where a sigma is given", cloud(10, 1), bend, lambda i: 0.05 * (i % 3)),
             ("far from the origin, other units", far, lambda p: [2 * p[1], 0.5 * p[0] + 3, p[2] + p[0] / 4], lambda i: 0)]
    result = []
    for name, a, image, sigma in cases:
        b = rounded([image(p) for p in a])
        sigmas, queries = [sigma(i) for i in range(len(a))], a[:2] + [[sum(axis) / len(a) for axis in zip(*a)], [1.5 * v for v in a[0]]]
        result.append({"name": name, "a": a, "b": b, "sigmas": sigmas, "points": queries, "images": warped(a, b, sigmas, queries)})
    return result


def sphere(n):
    """An octahedron with n parts an edge, its vertices pushed onto the unit sphere."""
    faces, vertices, number = [], [], {}

    def vertex(i, j, k):
        length = math.sqrt(i * i + j * j + k * k)
        if (i, j, k) not in number:
            number[i, j, k] = len(vertices)
            vertices.append([i / length, j / length, k / length])
        return number[i, j, k]

    for sx in (1, -1):
        for sy in (1, -1):
            for sz in (1, -1):
                for i in range(n):
                    for j in range(n - i):
                        at = lambda u, v: vertex(sx * u, sy * v, sz * (n - u - v))
                        corners = [[at(i, j), at(i + 1, j), at(i, j + 1)]]
                        if i + j < n - 1:
                            corners.append([at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)])
                        faces += [c if sx * sy * sz > 0 else c[::-1] for c in corners]
    return vertices, faces


def sheet(n):
    vertices = [[i / n, j / n, 0] for i in range(n + 1) for j in range(n + 1)]
    at = lambda i, j: i * (n + 1) + j
    faces = []
    for i in range(n):
        for j in range(n):
            faces += [[at(i, j), at(i + 1, j), at(i, j + 1)], [at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)]]
    return vertices, faces


def parallel(height, count):
    radius = math.sqrt(1 - height * height)
    return [[radius * math.cos(2 * math.pi * i / count), radius * math.sin(2 * math.pi * i / count), height] for i in range(count)]


def beyond(vertices, faces, is_beyond):
    return [f for f, corners in enumerate(faces) if sum(is_beyond(vertices[v]) for v in corners) >= 2]


def enclosed_cases():
    ball, flat = sphere(8), sheet(8)
    square = [[x, y, 0] for x, y in ((0.3, 0.3), (0.7, 0.3), (0.7, 0.7), (0.3, 0.7))]
    within = lambda p: 0.3 < p[0] < 0.7 and 0.3 < p[1] < 0.7
    cases = [("the cap above a parallel", ball, parallel(0.55, 90), beyond(*ball, lambda p: p[2] > 0.55)),
             ("the same, the other way round", ball, parallel(0.55, 90)[::-1], beyond(*ball, lambda p: p[2] > 0.55)),
             ("the cap below", ball, parallel(-0.55, 90), beyond(*ball, lambda p: p[2] < -0.55)),
             ("a square of four points on a sheet", flat, square, beyond(*flat, within)),
             ("the equator", ball, parallel(0.05, 90), "the border cuts the surface in"),
             ("three points far from the surface between", ball, parallel(0.55, 3), "the border leaves the surface"),
             ("a speck", flat, [[0.301, 0.301, 0], [0.309, 0.301, 0], [0.301, 0.309, 0]], "the border encloses no face")]
    meshes = {"sphere": ball, "sheet": flat}
    named = lambda mesh: next(name for name, each in meshes.items() if each is mesh)
    return {"meshes": {name: {"vertices": v, "faces": f} for name, (v, f) in meshes.items()},
            "cases": [{"name": name, "mesh": named(mesh), "border": border, **({"trouble": found} if isinstance(found, str) else {"inside": found})}
                      for name, mesh, border, found in cases]}


def write(name, content):
    (FOLDER / name).write_text(json.dumps(content, separators=(",", ":")) + "\n")


write("warp.json", warp_cases())
write("enclosed_faces.json", enclosed_cases())
