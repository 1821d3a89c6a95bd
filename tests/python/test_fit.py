import json
import os
from concurrent.futures import ThreadPoolExecutor

import bespoke
import numpy as np
import pytest
from conftest import SHIFT, SOURCE_RADII, TARGET_RADII, TURN


def write_anchors(path, anchors):
    pairs = [{"name": pair.name, "a": pair.a, "b": pair.b, "sigma": pair.sigma} for pair in anchors]
    path.write_text(json.dumps({"units": "cm", "pairs": pairs}))


def test_fit_is_that_of_the_command(pair, command, tmp_path):
    bespoke.write_mesh(tmp_path / "source.ply", pair.source)
    bespoke.write_mesh(tmp_path / "target.ply", pair.target)
    write_anchors(tmp_path / "anchors.json", pair.anchors)
    command(
        "fit", tmp_path / "source.ply", tmp_path / "target.ply", "--anchors", tmp_path / "anchors.json",
        "--tolerance", "0.5%", "--lambda", "15%", "-o", tmp_path / "command.vdb",
    )  # fmt: skip
    fit = bespoke.fit(
        bespoke.read_mesh(tmp_path / "source.ply"),
        bespoke.read_mesh(tmp_path / "target.ply"),
        bespoke.read_anchors(tmp_path / "anchors.json"),
        tolerance="0.5%",
        lambda_="15%",
    )
    commands = bespoke.Map.load(tmp_path / "command.vdb")
    points = np.random.default_rng(3).uniform(-2, 2, (1000, 3))
    np.testing.assert_array_equal(fit.map(points), commands(points))
    assert fit.map.info == commands.info
    assert fit.map.info.unit == "cm"


def test_goes_from_one_unit_to_another_where_any_size_is_allowed(pair):
    metres = bespoke.fit(pair.source, pair.target, pair.anchors)
    target = bespoke.Mesh(1024 * pair.target.vertices, pair.target.faces)
    anchors = [
        bespoke.Anchor(pick.a, tuple(1024 * x for x in pick.b), pick.name, pick.sigma) for pick in pair.anchors
    ]
    with pytest.raises(bespoke.InvalidInput, match="two units"):
        bespoke.fit(pair.source, target, anchors)
    # A surface without features may lie along another one in many ways, and the rounding of a unit decides between them
    # (a target 1e-12 times as large moves vertices by 0.2 %). So the maps are those of one fit in either unit: each is
    # it within the fit's and the bake's tolerance, 0.01 and 0.025 % of the diagonal.
    fitted = bespoke.Mesh(1024 * metres.fitted.vertices, pair.source.faces)
    millimetres = bespoke.fit(pair.source, target, anchors, fitted=fitted, any_size=True).map
    vertices = pair.source.vertices
    most = 2 * 0.00035 * np.linalg.norm(np.ptp(vertices, axis=0))
    np.testing.assert_allclose(millimetres(vertices) / 1024, metres.map(vertices), rtol=0, atol=most)
    # A fit of its own meets the anchors as well.
    own = bespoke.fit(pair.source, target, anchors, any_size=True).map
    picked, places = np.array([pick.a for pick in anchors]), np.array([pick.b for pick in anchors])
    np.testing.assert_allclose(own(picked) / 1024, places / 1024, rtol=0, atol=most)


def lines_and_parts(pair):
    """A waist that goes half way up on the target, and a few faces that have no counterpart."""
    angles = np.linspace(0, 2 * np.pi, 60, endpoint=False)
    circle = np.stack([np.cos(angles), np.sin(angles), np.zeros(60)], axis=1)
    higher = circle * np.sqrt(1 - 0.2**2) + (0, 0, 0.2)
    waist = bespoke.Curve(circle * SOURCE_RADII, higher * TARGET_RADII @ TURN.T + SHIFT, "waist", True, ((0, 0),))
    stand = bespoke.Patch(bespoke.PatchSide(faces=(0, 1, 2)), None, "stand", True)
    away = [anchor for anchor in pair.anchors if abs(anchor.a[2]) > 0.1]
    return bespoke.Anchors(away, "cm", [waist], [stand])


def test_curves_and_patches_are_those_of_the_command(pair, command, tmp_path):
    anchors = lines_and_parts(pair)
    curve, patch = anchors.curves[0], anchors.patches[0]
    document = {
        "units": "cm",
        "pairs": [{"name": anchor.name, "a": anchor.a, "b": anchor.b, "sigma": 0} for anchor in anchors],
        "curves": [
            {"name": "waist", "a": curve.a.tolist(), "b": curve.b.tolist(), "closed": True, "fixed": curve.fixed}
        ],
        "patches": [{"name": "stand", "a": {"faces": patch.a.faces}, "exclude": True}],
    }
    (tmp_path / "anchors.json").write_text(json.dumps(document))
    bespoke.write_mesh(tmp_path / "source.ply", pair.source)
    bespoke.write_mesh(tmp_path / "target.ply", pair.target)
    models = ("source.ply", "target.ply")
    command(
        "fit", *(tmp_path / model for model in models), "--anchors", tmp_path / "anchors.json",
        "--tolerance", "0.5%", "-o", tmp_path / "command.vdb",
    )  # fmt: skip
    commands = bespoke.Map.load(tmp_path / "command.vdb")
    points = np.random.default_rng(3).uniform(-2, 2, (1000, 3))
    meshes = [bespoke.read_mesh(tmp_path / model) for model in models]
    for given in (anchors, bespoke.read_anchors(tmp_path / "anchors.json")):
        fit = bespoke.fit(*meshes, given, tolerance="0.5%")
        np.testing.assert_array_equal(fit.map(points), commands(points))
    around, higher = fit.map(curve.a), (np.asarray(curve.b) - SHIFT) @ TURN
    assert np.abs(((around - SHIFT) @ TURN)[:, 2] - higher[:, 2]).max() < 0.02


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"curves": [bespoke.Curve(np.eye(3), np.eye(3), fixed=((0, 7),))]}, "fixed"),
        ({"curves": [bespoke.Curve(np.zeros((1, 3)), np.eye(3))]}, "two points"),
        ({"curves": [bespoke.Curve(np.full((3, 3), np.nan), np.eye(3))]}, "finite"),
        ({"patches": [bespoke.Patch(bespoke.PatchSide(faces=(1,)), None, "face")]}, "face"),
        ({"patches": [bespoke.Patch(bespoke.PatchSide(), None, "face", True)]}, "border"),
    ],
)
def test_refuses_wrong_curves_and_patches(pair, changed, words):
    with pytest.raises(bespoke.InvalidInput, match=words):
        bespoke.fit(pair.source, pair.target, bespoke.Anchors(pair.anchors, **changed))


def test_fit_says_what_it_found(pair):
    assert pair.fit.fitted.vertices.shape == pair.source.vertices.shape
    assert pair.fit.confidence.shape == (len(pair.source.vertices),)
    assert pair.fit.confidence.max() <= 1
    assert [stage.name for stage in pair.fit.report.stages][0] == "rigid"
    assert pair.fit.report.anchor_residuals.count == len(pair.anchors)
    image = pair.map(pair.source.vertices)
    assert np.linalg.norm(image - pair.fit.fitted.vertices, axis=1).max() < 3 * pair.map.info.tolerance


def test_given_fit_needs_no_anchors(pair):
    fitted = bespoke.Mesh(pair.source.vertices * [1.1, 1, 0.9] + [0, 0, 5], pair.source.faces)
    fit = bespoke.fit(pair.source, pair.target, fitted=fitted, tolerance="0.2%")
    image = fit.map(pair.source.vertices)
    assert np.linalg.norm(image - fitted.vertices, axis=1).max() < 3 * fit.map.info.tolerance


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"source": "body.obj"}, "source must be a bespoke.Mesh, not str"),
        ({"fitted": np.zeros((3, 3))}, "fitted must be a bespoke.Mesh, not ndarray"),
        ({"anchors": "pairs.json"}, "bespoke.read_anchors"),
        ({"anchors": [((0, 0, 0), (1, 1, 1))]}, "anchor 0 must be a bespoke.Anchor, not tuple"),
    ],
)
def test_what_is_no_model_or_anchor_is_named(pair, changed, words):
    arguments = {"source": pair.source, "target": pair.target, "anchors": pair.anchors} | changed
    with pytest.raises(TypeError, match=words):
        bespoke.fit(**arguments)


def test_progress_is_told_and_may_stop(pair):
    stages = []
    bespoke.fit(
        pair.source, pair.target, pair.anchors, tolerance="2%", progress=lambda stage, done, total: stages.append(stage)
    )
    assert {"elastic", "certify"} <= set(stages)

    class Enough(Exception):
        pass

    def stop(stage, done, total):
        raise Enough(stage)

    with pytest.raises(Enough):
        bespoke.fit(pair.source, pair.target, pair.anchors, progress=stop)


def test_interrupt_becomes_keyboard_interrupt(pair):
    import os
    import signal

    def press(stage, done, total):
        os.kill(os.getpid(), signal.SIGINT)

    with pytest.raises(KeyboardInterrupt):
        bespoke.fit(pair.source, pair.target, pair.anchors, progress=press)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"elastic": "rubber"}, "elastic 'rubber'.*diffeomorphic"),
        ({"tolerance": "-1%"}, "tolerance"),
        ({"lambda_": "wide"}, "lambda_ wide"),
        ({"max_stretch": 0.5}, "max_stretch"),
        ({"steps": 0}, "steps"),
        ({"guides": "some"}, "guides 'some'.*steps"),
        ({"guides": "all", "elastic": "csrbf"}, "guides: .*csrbf"),
        ({"nodes": "balanced", "voxel_size": "5%"}, "nodes: .*uniform"),
        ({"max_stretch": 3, "surface_fit": "laplacian"}, "max_stretch: .*laplacian"),
        ({"paper": True, "elastic": "csrbf"}, "elastic: .*printed"),
        ({"anchors": (), "paper": True}, "paper: .*anchors"),
        ({"anchors": (), "anchor_sigma": 1}, "anchor_sigma: .*anchors"),
        ({"anchors": (), "add_corners": True}, "add_corners: .*anchors"),
    ],
)
def test_refuses_options_with_reasons(pair, options, words):
    with pytest.raises(bespoke.InvalidInput, match=words):
        bespoke.fit(pair.source, pair.target, **{"anchors": pair.anchors, **options})


def test_refuses_what_belongs_to_a_skipped_fitting(pair):
    for option in ({"surface_fit": "laplacian"}, {"max_stretch": 3}, {"boundaries": "free"}, {"as_given": True}):
        with pytest.raises(bespoke.InvalidInput, match=next(iter(option))):
            bespoke.fit(pair.source, pair.target, pair.anchors, fitted=pair.source, **option)


def test_refuses_unusable_input(pair):
    with pytest.raises(ValueError, match="anchor"):
        bespoke.fit(pair.source, pair.target, pair.anchors[:2])
    broken = bespoke.Mesh(pair.source.vertices, np.array([[0, 1, 99999]]))
    with pytest.raises(bespoke.InvalidInput, match="source"):
        bespoke.fit(broken, pair.target, pair.anchors)
    holed = pair.source.vertices.copy()
    holed[3] = np.inf
    with pytest.raises(bespoke.InvalidInput, match="source"):
        bespoke.fit(bespoke.Mesh(holed, pair.source.faces), pair.target, pair.anchors)


def test_meshes_come_back_as_written(pair, tmp_path):
    bespoke.write_mesh(tmp_path / "mesh.ply", pair.source)
    again = bespoke.read_mesh(tmp_path / "mesh.ply")
    np.testing.assert_array_equal(again.vertices, pair.source.vertices.astype(np.float32))
    np.testing.assert_array_equal(again.faces, pair.source.faces)
    (tmp_path / "mesh.obj").write_text("v 0 0\n")
    with pytest.raises(bespoke.FormatError, match="line 1|:1"):
        bespoke.read_mesh(tmp_path / "mesh.obj")


def test_pipes_are_written_into(pair, tmp_path):
    bespoke.write_mesh(tmp_path / "mesh.ply", pair.source)
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    (tmp_path / "link.ply").symlink_to(pipe)
    with ThreadPoolExecutor(1) as pool:
        read = pool.submit(pipe.read_bytes)
        bespoke.write_mesh(tmp_path / "link.ply", pair.source)
        assert read.result() == (tmp_path / "mesh.ply").read_bytes()
    assert pipe.is_fifo()
    assert (tmp_path / "link.ply").is_symlink()


def test_anchors_of_one_model_name_the_line_that_joins_them(tmp_path):
    (tmp_path / "woman.pp").write_text("<PickedPoints/>")
    with pytest.raises(bespoke.InvalidInput, match="bespoke anchors convert .*woman.pp"):
        bespoke.read_anchors(tmp_path / "woman.pp")


def test_anchors_come_with_their_accuracy(tmp_path):
    (tmp_path / "anchors.json").write_text(
        '{"units": "mm", "pairs": [{"name": "x", "a": [0, 1, 2], "b": [3, 4, 5], "sigma": 0.5},'
        ' {"a": [0, 0, 0], "b": [1, 1, 1], "weight": 2}, {"a": [0, 0, 9], "b": [1, 1, 9]}]}'
    )
    anchors = bespoke.read_anchors(tmp_path / "anchors.json")
    assert anchors.unit == "mm"
    assert anchors[0] == bespoke.Anchor((0, 1, 2), (3, 4, 5), "x", 0.5)
    assert anchors[1].weight == 2
    assert anchors[1].sigma is None
    assert anchors[2] == bespoke.Anchor((0, 0, 9), (1, 1, 9))
