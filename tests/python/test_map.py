import json
import os
import struct
import subprocess
import threading

import bespoke
import numpy as np
import pytest


def test_surfaces_and_anchors_correspond(pair):
    x, y, z = (pair.map(pair.source.vertices) - [3, -1, 2]).T
    off = np.abs((y / 1.2) ** 2 + (x / 1.3) ** 2 + (z / 1.8) ** 2 - 1)
    assert off.max() < 0.02
    a = np.array([pair_.a for pair_ in pair.anchors])
    b = np.array([pair_.b for pair_ in pair.anchors])
    assert np.linalg.norm(pair.map(a) - b, axis=1).max() < 2 * pair.map.info.tolerance


def test_identity_at_zero_and_the_map_at_one(pair, around):
    np.testing.assert_array_equal(pair.map(around, 0), around)
    np.testing.assert_array_equal(pair.map(around, 1), pair.map(around))


def test_inverse_leads_back(pair, around):
    finest = min(level["voxel_size"] for level in pair.map.info.json["levels"])
    back = pair.map.inverse(pair.map(around))
    assert np.linalg.norm(back - around, axis=1).max() < 1e-4 * finest


def test_jacobian_is_the_derivative(pair, around):
    step = 1e-6
    for t in (0.5, 1):
        jacobian = pair.map.jacobian(around, t)
        assert jacobian.shape == (500, 3, 3)
        for j in range(3):
            shift = step * np.eye(3)[j]
            difference = (pair.map(around + shift, t) - pair.map(around - shift, t)) / (2 * step)
            # The map is trilinear in cells: where a difference crosses a wall it is no derivative.
            close = np.abs(difference - jacobian[:, :, j]).max(axis=1) < 1e-2
            assert close.mean() > 0.99
    assert np.linalg.det(pair.map.jacobian(around)).min() > 0


def test_takes_any_array_and_refuses_other_shapes(pair, around):
    expected = pair.map(around)
    np.testing.assert_array_equal(pair.map(np.asfortranarray(around)), expected)
    np.testing.assert_array_equal(pair.map(np.repeat(around, 2, axis=0)[::2]), expected)
    np.testing.assert_array_equal(pair.map(around.tolist()), expected)
    assert pair.map(np.empty((0, 3))).shape == (0, 3)
    for shape in ((3,), (3, 500), (2, 2, 3)):
        with pytest.raises(bespoke.InvalidInput, match=r"\(n, 3\)"):
            pair.map(np.zeros(shape))
    with pytest.raises(bespoke.InvalidInput, match="finite"):
        pair.map([[0, np.nan, 0]])


def test_file_holds_the_same_map(pair, around, tmp_path):
    file = tmp_path / "map.vdb"
    pair.map.save(file)
    again = bespoke.Map.load(file)
    np.testing.assert_array_equal(again(around), pair.map(around))
    assert again.info == pair.map.info
    again.save(tmp_path / "again.vdb")
    assert len(again.info.anchors) == len(pair.anchors)
    np.testing.assert_array_equal(bespoke.Map.load(tmp_path / "again.vdb", untrusted=True)(around), again(around))


def test_certificate_proves_a_bijection(pair):
    for t in (0.5, 1):
        certificate = pair.map.check(t)
        assert certificate.bijection
        assert certificate.folded == certificate.undecided == 0
        assert certificate.min_determinant > 0


def test_inverted_and_composed_maps_lead_back(pair, around):
    back = pair.map.inverted()
    there_and_back = pair.map.compose(back)
    error = np.linalg.norm(there_and_back(around) - around, axis=1)
    assert error.max() < 5 * pair.map.info.tolerance
    with pytest.raises(bespoke.InvalidInput):
        pair.map.compose(pair.map)


def test_carries_files_as_points(pair, around, tmp_path):
    product = tmp_path / "product.xyz"
    product.write_text("".join(f"{x!r} {y!r} {z!r} kept\n" for x, y, z in around.tolist()))
    outputs = [tmp_path / "half.xyz", tmp_path / "whole.xyz"]
    summary = pair.map.apply(product, outputs, [0.5, 1])
    assert summary.points == 500
    assert summary.in_band + summary.affine_only == 500
    for output, t in zip(outputs, (0.5, 1)):
        rows = [line.split() for line in output.read_text().splitlines()]
        assert all(row[3] == "kept" for row in rows)
        np.testing.assert_allclose([[float(x) for x in row[:3]] for row in rows], pair.map(around, t), atol=1e-6)


def test_splits_edges_and_keeps_what_the_file_says(pair, around, tmp_path):
    product, output = tmp_path / "product.obj", tmp_path / "split.obj"
    corners = "".join(f"v {x!r} {y!r} {z!r}\n" for x, y, z in around[:3].tolist())
    product.write_text(corners + "g sleeve\nusemtl wool\nf 1 2 3\n")
    report = pair.map.apply(product, output, refine="0.01%", unit="map").json["products"][0]
    lines = output.read_text().splitlines()
    splits = report["chord_error"]["splits"]
    assert splits > 0
    assert sum(line.startswith("v ") for line in lines) == 3 + splits
    assert lines[3:5] == ["g sleeve", "usemtl wool"]
    assert report["chord_error"]["length"] <= 1e-4 * np.linalg.norm(np.ptp(pair.source.vertices, axis=0))
    report = pair.map.apply(product, output, refine="0.01%", rigid=["sleeve"], unit="map").json["products"][0]
    assert report["chord_error"]["splits"] == 0  # what keeps its shape stays straight


def test_parts_keep_their_shape(pair, around, tmp_path):
    product, output = tmp_path / "product.obj", tmp_path / "rigid.obj"
    corners = around[:4]
    product.write_text("".join(f"v {x!r} {y!r} {z!r}\n" for x, y, z in corners.tolist()) + "g lens\nf 1 2 3 4\n")

    def edges(points):
        return np.linalg.norm(points - np.roll(points, 1, axis=0), axis=1)

    pair.map.apply(product, output, rigid=["lens"])
    moved = np.array([line.split()[1:] for line in output.read_text().splitlines()[:4]], dtype=float)
    np.testing.assert_allclose(edges(moved), edges(corners), atol=1e-5)


def test_clearance_keeps_products_outside_and_layers_in_order(pair, tmp_path):
    faces = "".join(f"f {a} {b} {c}\n" for a, b, c in (np.asarray(pair.source.faces) + 1).tolist())
    files = []
    for name, size in (("shirt", 1.001), ("jacket", 1.01)):
        files.append(tmp_path / f"{name}.obj")
        corners = "".join(f"v {x!r} {y!r} {z!r}\n" for x, y, z in (size * np.asarray(pair.source.vertices)).tolist())
        files[-1].write_text(corners + faces)
    output = tmp_path / "out.obj"
    found = pair.map.apply(files[0], output, clearance="keep").json["products"][0]["clearance"]
    assert found["clear"] and found["missed_before"]["samples"] > 0
    found = pair.map.apply(files[1], output, clearance="1%", layers=files[:1]).json["products"][0]["clearance"]
    assert found["layers"] == [{"lower": "shirt.obj", "intersections_on_source": 0, "new_intersections": 0}]
    assert "clearance" not in pair.map.apply(files[0], output).json["products"][0]
    with pytest.raises(bespoke.InvalidInput, match="not 'lots'"):
        pair.map.apply(files[0], output, clearance="lots")
    with pytest.raises(bespoke.InvalidInput, match="layers are kept under the product where there is a clearance"):
        pair.map.apply(files[1], output, layers=files[:1])
    with pytest.raises(bespoke.InvalidInput, match="where t is 1"):
        pair.map.apply(files[0], output, 0.5, clearance="keep")


def test_measures_the_pair_and_no_other(pair):
    quality = pair.map.measure(pair.source, pair.target)
    assert quality.flipped_faces == 0
    assert quality.source_to_target.p95 < 0.02
    with pytest.raises(bespoke.InvalidInput, match="source"):
        pair.map.measure(pair.target, pair.target)


def skinned_glb(mesh, upper, turn, shifts):
    """Stored as the mesh is, and shown where two joints, turned and shifted, hold it; `upper`: the second's share."""
    count = len(mesh.vertices)
    weights = np.stack([1 - upper, upper, 0 * upper, 0 * upper], 1)
    blocks = [
        (np.asarray(mesh.vertices, "<f4"), 5126, "VEC3", count),
        (np.tile(np.array([0, 1, 0, 0], "u1"), (count, 1)), 5121, "VEC4", count),
        (weights.astype("<f4"), 5126, "VEC4", count),
        (np.stack([np.eye(4, dtype="<f4")] * 2), 5126, "MAT4", 2),
        (np.asarray(mesh.faces, "<u4"), 5125, "SCALAR", 3 * len(mesh.faces)),
    ]
    data, views, accessors = b"", [], []
    for index, (values, component, kind, number) in enumerate(blocks):
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": values.nbytes})
        accessors.append({"bufferView": index, "componentType": component, "type": kind, "count": number})
        data += values.tobytes() + b"\0" * (-values.nbytes % 4)
    root = {
        "asset": {"version": "2.0"},
        "buffers": [{"byteLength": len(data)}],
        "bufferViews": views,
        "accessors": accessors,
        "skins": [{"joints": [1, 2], "inverseBindMatrices": 3}],
        "nodes": [{"mesh": 0, "skin": 0}, *({"rotation": turn, "translation": shift} for shift in shifts)],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "JOINTS_0": 1, "WEIGHTS_0": 2}, "indices": 4}]}],
        "scenes": [{"nodes": [0, 1, 2]}],
        "scene": 0,
    }
    text = json.dumps(root).encode()
    text += b" " * (-len(text) % 4)
    head = struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(data))
    return head + struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(data), b"BIN\0") + data


def test_takes_either_pose_of_a_skinned_file(pair, tmp_path):
    file, out = tmp_path / "skinned.glb", tmp_path / "out.glb"
    half = float(np.sqrt(0.5))
    upper = (pair.source.vertices[:, 2] / 2 + 1) / 2  # the source is four high
    file.write_bytes(skinned_glb(pair.source, upper, [0, 0, half, half], [[0.5, 0, 0], [0.7, 0, 0]]))
    stored, shown = bespoke.read_mesh(file, pose="stored").vertices, bespoke.read_mesh(file).vertices
    # Vertices of a glTF file come in the order in which faces name them.
    named, first = np.unique(np.asarray(pair.source.faces), return_index=True)
    order = named[np.argsort(first)]
    np.testing.assert_allclose(stored, np.asarray(pair.source.vertices)[order], atol=1e-6)
    x, y, z = stored.T
    np.testing.assert_allclose(shown, np.stack([0.5 + 0.2 * upper[order] - y, x, z], 1), atol=1e-6)
    pair.map.apply(file, out, pose="stored", unit="map")
    np.testing.assert_allclose(bespoke.read_mesh(out, pose="stored").vertices, pair.map(stored), atol=1e-5)
    pair.map.apply(file, out, unit="map")
    np.testing.assert_allclose(bespoke.read_mesh(out).vertices, pair.map(shown), atol=1e-5)
    with pytest.raises(bespoke.InvalidInput, match="pose"):
        bespoke.read_mesh(file, pose="bound")


def test_outputs_that_are_no_files_stay_what_they_are(pair, tmp_path):
    pipe, link, product = tmp_path / "pipe", tmp_path / "link.obj", tmp_path / "product.obj"
    os.mkfifo(pipe)
    link.symlink_to(pipe)
    bespoke.write_mesh(product, pair.source)
    pair.map.save(tmp_path / "map.vdb")
    pair.map.apply(product, tmp_path / "carried.obj")
    for write, expected in (
        (lambda: pair.map.save(pipe), tmp_path / "map.vdb"),
        (lambda: pair.map.apply(product, link), tmp_path / "carried.obj"),
        (lambda: bespoke.write_mesh(link, pair.source), product),
    ):
        # Into a file: nobody empties a pipe while this process writes.
        with (tmp_path / "read").open("wb") as read, subprocess.Popen(["cat", pipe], stdout=read):
            write()
        assert (tmp_path / "read").read_bytes() == expected.read_bytes()
        assert pipe.is_fifo() and link.is_symlink()


def test_threads_share_a_map(pair, around):
    expected = pair.map(around)
    found = [None] * 8

    def ask(k):
        found[k] = pair.map(around)

    threads = [threading.Thread(target=ask, args=(k,)) for k in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for image in found:
        np.testing.assert_array_equal(image, expected)


def test_info_is_that_of_the_command(pair, command, tmp_path):
    file = tmp_path / "map.vdb"
    pair.map.save(file)
    assert json.loads(command("info", file, "--json")) == pair.map.info.json


@pytest.mark.parametrize("content", [b"", b"no volume", b"\0" * 4096])
def test_refuses_what_is_no_asset(tmp_path, content):
    file = tmp_path / "broken.vdb"
    file.write_bytes(content)
    with pytest.raises(bespoke.Error, match="broken.vdb"):
        bespoke.Map.load(file)
    with pytest.raises(OSError):
        bespoke.Map.load(tmp_path / "missing.vdb")
