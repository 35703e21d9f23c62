#include "pipeline/report/view_script.h"

#include "mesh/io/atomic_file.h"

namespace palpate::pipeline {
namespace {

constexpr const char* script_text = R"py(# Opens a palpate run in ParaView:  paraview --script=view.py
# Off screen, to a picture:          pvbatch view.py picture.png
import os
import sys

from paraview.simple import *

script = globals().get("__file__") or sys.argv[0]
run = os.path.dirname(os.path.abspath(script))


def path(*names):
    return os.path.join(run, *names)


def colour(view, source, association, array, logarithmic=False):
    display = GetDisplayProperties(source, view)
    ColorBy(display, (association, array))
    display.RescaleTransferFunctionToDataRange(True)
    display.SetScalarBarVisibility(view, True)
    table = GetColorTransferFunction(array)
    table.ApplyPreset("Viridis (matplotlib)", True)
    if logarithmic:
        table.MapControlPointsToLogSpace()
        table.UseLogScale = 1
    bar = GetScalarBar(table, view)
    bar.Title, bar.ComponentTitle = array, ""
    bar.TitleColor = bar.LabelColor = [0, 0, 0]
    return display


def has_array(source, array):
    return source.PointData.GetArray(array) is not None


def reach(source, array):
    return max(abs(x) for c in range(3) for x in source.PointData[array].GetRange(c))


def show_largest_step(view, reader, array):
    """Goes to the state in which the array reaches furthest; returns how far."""
    times = reader.TimestepValues
    best = 0.0, 0.0
    for time in times if hasattr(times, "__len__") else [times]:
        reader.UpdatePipeline(time)
        best = max(best, (reach(reader, array), time))
    view.ViewTime = best[1]
    reader.UpdatePipeline(best[1])
    return best[0]


def size_of(source):
    source.UpdatePipeline()
    b = source.GetDataInformation().GetBounds()
    return max(b[1] - b[0], b[3] - b[2], b[5] - b[4])


def shape_view(view):
    """The model's shape, displacements magnified to 10 % of the size."""
    skin = PVDReader(FileName=path("compare", "skin.pvd"))
    largest = show_largest_step(view, skin, "displacement [mm]")
    size = size_of(skin)
    warp = WarpByVector(Input=skin)
    warp.Vectors = ["POINTS", "displacement [mm]"]
    warp.ScaleFactor = 0.1 * size / largest if 1e-6 * size < largest < 0.03 * size else 1.0
    Show(warp, view)
    colour(view, warp, "POINTS", "displacement [mm]")
    if not has_array(skin, "measured [mm]"):
        return "Model, displacements x %.3g" % warp.ScaleFactor
    reference = WarpByVector(Input=skin)
    reference.Vectors = ["POINTS", "measured [mm]"]
    reference.ScaleFactor = warp.ScaleFactor
    lines = Show(reference, view, Representation="Wireframe")
    ColorBy(lines, ("POINTS", ""))
    lines.AmbientColor = lines.DiffuseColor = [0.8, 0.3, 0.1]
    return "Model, and reference as lines, displacements x %.3g" % warp.ScaleFactor


def skeleton_view(view):
    """Spheres and links, coloured by elongation stiffness."""
    surface = XMLPolyDataReader(FileName=[path("mesh", "surface.vtp")])
    Show(surface, view).Opacity = 0.15
    model = XMLPolyDataReader(FileName=[path("identify", "model.vtp")])
    tubes = Tube(Input=model)
    tubes.Scalars = [None, ""]
    tubes.Vectors = [None, ""]
    tubes.Radius = 0.005 * size_of(surface)
    Show(tubes, view)
    colour(view, tubes, "CELLS", "elongation [N/mm]", logarithmic=True)
    balls = Glyph(Input=model, GlyphType="Sphere")
    balls.ScaleArray = ["POINTS", "radius [mm]"]
    balls.ScaleFactor = 2.0
    balls.GlyphMode = "All Points"
    ball_display = Show(balls, view)
    ball_display.ColorArrayName = ["POINTS", ""]
    ball_display.DiffuseColor = [0.16, 0.44, 0.59]
    ball_display.Opacity = 0.25
    return "Skeleton"


def error_view(view):
    """Errors at the markers, from model to measurement."""
    surface = XMLPolyDataReader(FileName=[path("mesh", "surface.vtp")])
    Show(surface, view).Opacity = 0.3
    markers = PVDReader(FileName=path("compare", "markers.pvd"))
    show_largest_step(view, markers, "error [mm]")
    dots = Glyph(Input=markers, GlyphType="Sphere")
    dots.ScaleArray = ["POINTS", "No scale array"]
    dots.ScaleFactor = 0.02 * size_of(surface)
    dots.GlyphMode = "All Points"
    Show(dots, view)
    colour(view, dots, "POINTS", "error [mm]")
    return "Error at the markers"


def ladder_view(view):
    """Errors at the markers of all states, step by step of the ladder: play it to see them fall."""
    surface = XMLPolyDataReader(FileName=[path("mesh", "surface.vtp")])
    Show(surface, view).Opacity = 0.3
    markers = PVDReader(FileName=path("improve", "ladder.pvd"))
    show_largest_step(view, markers, "error [mm]")
    arrows = Glyph(Input=markers, GlyphType="Arrow")
    arrows.OrientationArray = ["POINTS", "error [mm]"]
    arrows.ScaleArray = ["POINTS", "error [mm]"]
    arrows.ScaleFactor = 1.0
    arrows.GlyphMode = "All Points"
    Show(arrows, view)
    colour(view, arrows, "POINTS", "error [mm]")
    return "Ladder: error at the markers, step by step"


builders = [shape_view, skeleton_view, error_view]
if os.path.exists(path("improve", "ladder.pvd")):
    builders.append(ladder_view)
layout = CreateLayout("palpate")
views = []
for number, build in enumerate(builders):
    view = CreateView("RenderView")
    AssignViewToLayout(view=view, layout=layout, hint=0)
    view.Background = [1, 1, 1]
    view.UseColorPaletteForBackground = 0
    view.OrientationAxesLabelColor = [0, 0, 0]
    title = Text(Text=build(view))
    shown = Show(title, view)
    shown.Color = [0, 0, 0]
    view.ResetCamera()
    view.CameraParallelProjection = 1
    camera = view.GetActiveCamera()
    camera.Elevation(-60)
    camera.Azimuth(20)
    views.append(view)
    if build is not builders[-1]:
        cell = layout.GetViewLocation(view)
        layout.SplitHorizontal(cell, 0.5) if number == 0 else layout.SplitVertical(cell, 1 / (len(builders) - number))

layout.SetSize(1800, 900)
for view in views:
    view.ResetCamera(True)
    Render(view)
if len(sys.argv) > 1 and sys.argv[-1].endswith(".png"):
    SaveScreenshot(sys.argv[-1], layout, ImageResolution=[1800, 900])
)py";

}  // namespace

void write_view_script(const std::filesystem::path& script) { mesh::write_text(script, script_text); }

}  // namespace palpate::pipeline
