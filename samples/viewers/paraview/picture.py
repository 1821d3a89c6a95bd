"""Draws a map: the source as a contour of its distance, a product, both carried, arrows of the displacement, det in a plane.

    PYTHONPATH=samples/viewers/paraview/python311 xvfb-run -a -s "-screen 0 1280x1024x24" \\
        pvbatch samples/viewers/paraview/picture.py MAP.vdb PRODUCT.obj PICTURE.png [STATE.pvsm]

With STATE.pvsm the scene is also saved for ParaView's File > Load State.
"""

import os
import sys

import paraview.simple as pv

MAP, PRODUCT, PICTURE = map(os.path.abspath, sys.argv[1:4])
BLACK, SKIN, CLOTH = (0.15, 0.15, 0.18), (0.86, 0.80, 0.74), (0.62, 0.2, 0.27)
ARROWS = 30
ZOOM = 0.5  # what ResetCamera shows is a ball around everything
CONTOURS_OF_DETERMINANT = 9

pv.LoadPlugin(os.path.join(os.path.dirname(os.path.abspath(__file__)), "plugin", "bespoke_maps.py"), ns=globals())
view = pv.CreateRenderView()
view.ViewSize = [1200, 560]
view.OrientationAxesVisibility = 0
view.UseColorPaletteForBackground = 0
view.Background = [1, 1, 1]


def show(what, colour, opacity=1.0):
    shown = pv.Show(what, view)
    pv.ColorBy(shown, ("POINTS", ""))
    shown.AmbientColor = shown.DiffuseColor = colour
    shown.Opacity = opacity
    return shown


def carried(what, moved=True):
    return BespokeCarry(Input=what, Map=MAP, MovePoints=moved)


reader = BespokeMap(FileName=MAP)
lattice, distance = pv.OutputPort(reader, 0), pv.OutputPort(reader, 1)
pv.Hide(lattice, view)

source = pv.Contour(Input=distance, ContourBy=["POINTS", "source_distance"], Isosurfaces=[0.0])
show(source, SKIN)
product = pv.OpenDataFile(PRODUCT)
show(product, CLOTH)
show(carried(source), SKIN)
show(carried(product), CLOTH)

arrows = pv.Glyph(Input=carried(source, moved=False), GlyphType="Arrow")
arrows.OrientationArray = ["POINTS", "displacement"]
arrows.ScaleArray = ["POINTS", "displacement"]
arrows.VectorScaleMode = "Scale by Magnitude"
arrows.ScaleFactor = 1.0
arrows.GlyphMode = "Uniform Spatial Distribution (Bounds Based)"
arrows.MaximumNumberOfSamplePoints = ARROWS
arrows.GlyphType.TipRadius, arrows.GlyphType.ShaftRadius, arrows.GlyphType.TipLength = 0.012, 0.003, 0.05
show(arrows, BLACK)

# Across the middle of the lattice, drawn beside the source.
lattice_data = pv.servermanager.Fetch(reader, idx=0)
bounds = lattice_data.GetBounds()
plane = pv.Slice(Input=lattice, SliceType="Plane")
plane.SliceType.Origin = [sum(bounds[2 * axis : 2 * axis + 2]) / 2 for axis in range(3)]
plane.SliceType.Normal = [0, 0, 1]
coloured = pv.Show(plane, view)
pv.ColorBy(coloured, ("POINTS", "determinant"))
coloured.AmbientColor = coloured.DiffuseColor = BLACK
low, high = lattice_data.GetPointData().GetArray("determinant").GetRange()
steps = [low + (high - low) * n / (CONTOURS_OF_DETERMINANT + 1) for n in range(1, CONTOURS_OF_DETERMINANT + 1)]
contours = show(pv.Contour(Input=plane, ContourBy=["POINTS", "determinant"], Isosurfaces=steps), BLACK)
coloured.Position = contours.Position = [bounds[0] - bounds[1], 0, 0]
legend = pv.GetScalarBar(pv.GetColorTransferFunction("determinant"), view)
legend.Title, legend.ComponentTitle = "least determinant nearby", ""
legend.TitleColor = legend.LabelColor = BLACK
legend.WindowLocation = "Any Location"
legend.Position, legend.ScalarBarLength = [0.01, 0.3], 0.4
coloured.SetScalarBarVisibility(view, True)

view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp = [0.12, 0.08, 1], [0, 0, 0], [0, 1, 0]
view.CameraParallelProjection = 1
pv.ResetCamera(view)
view.CameraParallelScale *= ZOOM
pv.Render(view)
pv.SaveScreenshot(PICTURE, view)
if len(sys.argv) > 4:
    pv.SaveState(sys.argv[4])
