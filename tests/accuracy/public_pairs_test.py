#!/usr/bin/python3
"""Properties of public_pairs.py on meshes made here. Exit code 77 where numpy is not installed."""
import argparse
import io
import subprocess
import sys
import tempfile
import unittest
import zipfile
from pathlib import Path

try:
    import numpy as np
except ImportError:
    sys.exit(77)
import public_pairs as pairs

SQUARE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
HALVES = np.array([[0, 1, 2], [0, 2, 3]])


def area(vertices, faces):
    a, b, c = vertices[faces].transpose(1, 0, 2)
    return np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2


def grid(count=20):
    x, y = np.meshgrid(np.linspace(0, 1, count), np.linspace(0, 2, count))
    first = (np.arange(count - 1)[:, None] * count + np.arange(count - 1)).ravel()
    return (np.stack([x.ravel(), y.ravel(), 0.2 * np.sin(3 * x.ravel())], 1),
            np.concatenate([np.stack([first, first + 1, first + count + 1], 1),
                            np.stack([first, first + count + 1, first + count], 1)]))


def whole_pair(mesh, places):
    return pairs.Pair("grid", mesh, (places, mesh[1]), mesh[0], places, np.arange(len(places)))


class Readers(unittest.TestCase):
    def test_agree_on_one_square(self):
        ply = (b"ply\nformat %s 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
               b"element face 2\nproperty list uchar int vertex_indices\nend_header\n")
        faces = np.array([(3, face) for face in HALVES], [("count", "u1"), ("corners", "<i4", 3)])
        binary = SQUARE.astype("<f4").tobytes() + faces.tobytes()
        numbers = b"0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n"
        for read, data in ((pairs.parse_off, b"OFF\n4 2 0\n" + numbers),
                           (pairs.parse_obj, b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1/1 2/2 3/3 4/4\n"),
                           (pairs.parse_ply, ply % b"ascii" + numbers),
                           (pairs.parse_ply, ply % b"binary_little_endian" + binary)):
            vertices, triangles = read(data)
            np.testing.assert_array_equal(vertices, SQUARE)
            np.testing.assert_array_equal(triangles, HALVES)


class Remeshing(unittest.TestCase):
    def test_keeps_the_surface_and_its_side_in_another_connectivity(self):
        mesh = grid()
        vertices, faces = pairs.remeshed(*mesh)
        self.assertGreater(len(faces), len(mesh[1]))
        self.assertAlmostEqual(area(vertices, faces), area(*mesh))
        a, b, c = vertices[faces].transpose(1, 0, 2)
        self.assertTrue((np.cross(b - a, c - a)[:, 2] > 0).all())
        kept = {tuple(vertex) for vertex in vertices}
        self.assertTrue(all(tuple(vertex) in kept for vertex in mesh[0]))


class OtherSize(unittest.TestCase):
    def test_does_not_fold_space(self):
        points = np.random.default_rng(1).uniform([-0.5, 0, -0.5], [0.5, 2, 0.5], (500, 3))
        ends = np.array([[-0.5, 0, -0.5], [0.5, 2, 0.5]])

        def image(moved):
            return pairs.other_size(np.concatenate([ends, moved]))[2:]

        inside, step = points * 0.99, 1e-6
        columns = [(image(inside + step * axis) - image(inside)) / step for axis in np.eye(3)]
        self.assertGreater(np.linalg.det(np.stack(columns, 2)).min(), 0.5)


class Scores(unittest.TestCase):
    def test_of_the_truth_are_zero_and_of_a_shift_are_its_length(self):
        mesh = grid()
        pair = whole_pair(mesh, mesh[0] + [5, 0, 0])
        self.assertEqual(pairs.errors(pair, pair.places, []), {"mean": 0, "p95": 0, "max": 0})
        diagonal = np.linalg.norm(np.ptp(mesh[0], axis=0))
        self.assertEqual(pairs.errors(pair, pair.places + [0, 0, diagonal / 50], []), {"mean": 2, "p95": 2, "max": 2})

    def test_leave_anchors_out(self):
        mesh = grid()
        pair, carried = whole_pair(mesh, mesh[0]), mesh[0].copy()
        carried[7] += 1
        self.assertGreater(pairs.errors(pair, carried, [])["max"], 0)
        self.assertEqual(pairs.errors(pair, carried, [7])["max"], 0)

    def test_count_the_faces_around_a_vertex_that_is_carried_across_them(self):
        pair = pairs.Pair("square", (SQUARE, HALVES), None, SQUARE, SQUARE, np.arange(4))
        carried = SQUARE.copy()
        carried[1] = [0, 2, 0]
        self.assertEqual((pairs.flipped_faces(pair, SQUARE), pairs.flipped_faces(pair, carried)), (0, 1))
        pair.vertices = None
        self.assertIsNone(pairs.flipped_faces(pair, carried))


class RecordedMaps(unittest.TestCase):
    def test_take_vertices_to_the_vertices_whose_numbers_they_hold(self):
        data = io.BytesIO()
        with zipfile.ZipFile(data, "w") as archive:
            archive.writestr("A/s_t.map", "2\n1\nNaN\n")
        with zipfile.ZipFile(data) as archive:
            places = pairs.recorded_places(archive, "A/s_t.map", 1, np.array([1, 0, 2]), SQUARE)
        np.testing.assert_array_equal(places, [SQUARE[0], SQUARE[1], [np.nan] * 3])

    def test_are_scored_by_the_truth_or_its_mirror_image_without_what_they_take_nowhere(self):
        mesh = grid()
        pair = whole_pair(mesh, mesh[0])
        pair.mirrored = mesh[0] * [-1, 1, 1]
        astray = mesh[0].copy()
        astray[3] = np.nan
        pair.recorded = {"direct": astray, "other way": pair.mirrored}
        rows = pairs.recorded_rows(pair, [])
        self.assertEqual([(row["mirrored"], row["nowhere"], row["max"]) for row in rows], [(False, 1, 0), (True, 0, 0)])
        pair.recorded = {"direct": mesh[0] + [0, 0, np.linalg.norm(np.ptp(mesh[0], axis=0)) / 50]}
        self.assertEqual(pairs.recorded_rows(pair, [7])[0]["mean"], 2)


class Anchors(unittest.TestCase):
    def test_are_the_corners_of_a_square_with_its_middle(self):
        self.assertEqual(set(pairs.farthest(np.concatenate([[[0.5, 0.5, 0]], SQUARE]), 4)), {1, 2, 3, 4})


class Clones(unittest.TestCase):
    def test_that_are_missing_are_named_with_their_purpose(self):
        with tempfile.TemporaryDirectory() as folder, self.assertRaises(pairs.Missing) as caught:
            pairs.Clone(Path(folder), "faust")
        self.assertIn("yiqun-wang/LPS-data", str(caught.exception))
        self.assertIn("FAUST", str(caught.exception))

    def test_are_read_bare_and_ordinary(self):
        with tempfile.TemporaryDirectory() as folder:
            ordinary, bare = Path(folder) / "one" / "LPS-data", Path(folder) / "two" / "yiqun-wang+LPS-data" / "repo"
            subprocess.run(["git", "init", "-q", ordinary], check=True)
            (ordinary / "a.off").write_text("OFF")
            git = ["git", "-C", ordinary, "-c", "user.name=a", "-c", "user.email=a@b"]
            subprocess.run([*git, "add", "."], check=True)
            subprocess.run([*git, "commit", "-q", "-m", "a"], check=True)
            subprocess.run(["git", "clone", "-q", "--bare", ordinary, bare], check=True)
            clones = [pairs.Clone(Path(folder) / each, "faust") for each in ("one", "two")]
            self.assertEqual([clone.read("a.off") for clone in clones], [b"OFF"] * 2)
            self.assertEqual(clones[0].commit(), clones[1].commit())
            with self.assertRaisesRegex(pairs.Missing, "LPS-data.*b.off"):
                clones[0].read("b.off")


class Choosing(unittest.TestCase):
    def test_takes_no_pair_that_is_reported(self):
        class Recorder:
            def __init__(self):
                self.paths = set()

            def read(self, path):
                self.paths.add(path)
                return b"OFF\n4 2 0\n" + b"0 0 0 1 0 0 1 1 0 0 1 0 3 0 1 2 3 0 2 3"

        read = []
        for choose in (True, False):
            clone = Recorder()
            for name in ("faust-persons", "faust-poses"):
                list(pairs.faust_pairs(clone, name, argparse.Namespace(choose=choose, pairs=100)))
            read.append(clone.paths)
        self.assertEqual([len(paths) for paths in read], [50, 50])
        self.assertEqual(read[0] & read[1], set())


if __name__ == "__main__":
    unittest.main()
