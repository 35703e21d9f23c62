# Opens a palpate run in ParaView:  paraview --script=view.py
# Off screen, to a picture:          pvbatch view.py picture.png
#
# Four views: fit, error, stiffness, ladder (where effects were added). Each array is named alike in every file, with its
# unit: "error [mm]", "displacement [mm]", "measured [mm]", "elongation [N/mm]".
import json
import math
import os
import sys

from paraview.simple import *

script = globals().get("__file__") or sys.argv[0]
run = os.path.dirname(os.path.abspath(script))
ORANGE, GREY, DARK = [0.78, 0.45, 0.1], [0.6, 0.64, 0.68], [0.1, 0.1, 0.12]
FOUND, SOFTER = [0.69, 0.23, 0.55], [0.95, 0.66, 0.83]


def path(*names):
    return os.path.join(run, *names)


def steps():
    """Folders of the ladder's steps, the last one with all effects in; compare alone where nothing was added."""
    found, number = [], 0
    while os.path.exists(path("improve", "step_%d" % number, "skin.pvd")):
        found.append(path("improve", "step_%d" % number))
        number += 1
    return found or [path("compare")]


def size_of(source):
    source.UpdatePipeline()
    b = source.GetDataInformation().GetBounds()
    return max(b[1] - b[0], b[3] - b[2], b[5] - b[4])


def lengths(source, array):
    """Least and largest length of an array's vectors."""
    low, high = source.PointData[array].GetRange(-1)
    return low, high


def times_of(reader):
    times = reader.TimestepValues
    return list(times) if hasattr(times, "__len__") else [times]


def largest_step(reader, array):
    """The time at which the array reaches furthest, and how far; the reader is left there."""
    best = (0.0, 0.0)
    for time in times_of(reader):
        reader.UpdatePipeline(time)
        if reader.GetDataInformation().GetNumberOfPoints():
            best = max(best, (lengths(reader, array)[1], time))
    reader.UpdatePipeline(best[1])
    return best[1], best[0]


def plain(display, colour, opacity=1.0):
    display.ColorArrayName = ["POINTS", ""]
    display.AmbientColor = display.DiffuseColor = colour
    display.Opacity = opacity


def round_above(value):
    """The least of 1, 1.5, 2, 2.5, 3, 4, 5, 6, 8, 10 times a power of ten that is not below a value."""
    if value <= 0:
        return 1.0
    power = 10.0 ** math.floor(math.log10(value))
    return next(digit * power for digit in (1, 1.5, 2, 2.5, 3, 4, 5, 6, 8, 10) if digit * power >= value * (1 - 1e-9))


def round_labels(low, high, logarithmic):
    """Round numbers between two others: fifths, or powers of ten and their halves."""
    if not logarithmic:
        return [low + (high - low) * i / 5 for i in range(6)]
    powers = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
    labels = [digit * 10.0 ** p for p in powers for digit in (1, 2, 5) if low <= digit * 10.0 ** p <= high]
    return labels if len(labels) < 8 else [v for v in labels if abs(math.log10(v) % 1) < 1e-9]


def colour(view, source, association, array, low=None, high=None, logarithmic=False):
    """Colours by an array, in viridis, from low to a round number above high, with a legend in this view alone."""
    if high is not None and not logarithmic:
        high = round_above(high)
    display = GetDisplayProperties(source, view)
    ColorBy(display, (association, array), True)
    table = display.LookupTable
    table.ApplyPreset("Viridis (matplotlib)", True)
    if high is None:
        display.RescaleTransferFunctionToDataRange(False, True)
    else:
        table.RescaleTransferFunction(low, high)
    if logarithmic:
        table.MapControlPointsToLogSpace()
        table.UseLogScale = 1
    display.SetScalarBarVisibility(view, True)
    bar = GetScalarBar(table, view)
    bar.Title, bar.ComponentTitle = array, ""
    bar.TitleColor = bar.LabelColor = [0, 0, 0]
    bar.ScalarBarLength = 0.4
    if high is not None:
        bar.UseCustomLabels = 1
        bar.CustomLabels = round_labels(low, high, logarithmic)
        bar.AddRangeLabels = 0
        bar.AutomaticLabelFormat = 0
        bar.LabelFormat = "%-#6.3g"
    return display


def arrows_of(markers, factor):
    """Error vectors, from model to measurement: the markers stand where they were measured."""
    arrows = Glyph(Input=markers, GlyphType="Arrow")
    arrows.OrientationArray = ["POINTS", "error [mm]"]
    arrows.ScaleArray = ["POINTS", "error [mm]"]
    arrows.ScaleFactor = factor
    arrows.GlyphMode = "All Points"
    arrows.GlyphTransform.Translate = [-1, 0, 0]  # the tip stands at the measurement
    return arrows


def balls_of(points, radius_array, factor):
    balls = Glyph(Input=points, GlyphType="Sphere")
    balls.ScaleArray = ["POINTS", radius_array or "No scale array"]
    balls.ScaleFactor = factor
    balls.GlyphMode = "All Points"
    return balls


def fit_view(view):
    """The best model's shape where it moves most, and what was measured."""
    folder = steps()[-1]
    skin = PVDReader(FileName=os.path.join(folder, "skin.pvd"))
    time, furthest = largest_step(skin, "displacement [mm]")
    view.ViewTime = time
    size = size_of(skin)
    magnify = 0.1 * size / furthest if 1e-6 * size < furthest < 0.03 * size else 1.0
    warp = WarpByVector(Input=skin, Vectors=["POINTS", "displacement [mm]"], ScaleFactor=magnify)
    Show(warp, view)
    colour(view, warp, "POINTS", "displacement [mm]", 0, furthest)
    if skin.PointData.GetArray("measured [mm]") is not None:
        measured = WarpByVector(Input=skin, Vectors=["POINTS", "measured [mm]"], ScaleFactor=magnify)
        plain(Show(measured, view, Representation="Wireframe"), DARK)
        shown = "measured shape as lines"
    else:
        markers = PVDReader(FileName=os.path.join(folder, "markers.pvd"))
        rest = Calculator(Input=markers, Function='coords-"measured [mm]"', ResultArrayName="rest [mm]",
                          CoordinateResults=1)
        moved = WarpByVector(Input=rest, Vectors=["POINTS", "measured [mm]"], ScaleFactor=magnify)
        balls = balls_of(moved, None, 0.018 * size)
        plain(Show(balls, view), ORANGE)
        shown = "measured markers in orange"
    factor = "" if magnify == 1 else ", displacements x %.3g" % magnify
    return "Fit: model, %s%s" % (shown, factor)


def error_view(view):
    """Error vectors of the best model's worst state."""
    folder = steps()[-1]
    skin = PVDReader(FileName=os.path.join(folder, "skin.pvd"))
    markers = PVDReader(FileName=os.path.join(folder, "markers.pvd"))
    time, worst = largest_step(markers, "error [mm]")
    view.ViewTime = time
    size = size_of(skin)
    warp = WarpByVector(Input=skin, Vectors=["POINTS", "displacement [mm]"])
    plain(Show(warp, view), GREY, 0.3)
    lengthen = max(1.0, 0.12 * size / worst) if worst > 0 else 1.0
    arrows = arrows_of(markers, lengthen)
    Show(arrows, view)
    colour(view, arrows, "POINTS", "error [mm]", 0, worst)
    return "Error: worst state, arrows x %.3g" % lengthen


def stiffness_view(view):
    """Spheres, and links as tubes, coloured by elongation stiffness."""
    best = "improve" if os.path.exists(path("improve", "model.vtp")) else "identify"
    model = XMLPolyDataReader(FileName=[path(best, "model.vtp")])
    size = size_of(model)
    tubes = Tube(Input=model, Scalars=[None, ""], Vectors=[None, ""], Radius=0.012 * size)
    Show(tubes, view)
    low, high = model.CellData["elongation [N/mm]"].GetRange(0) if model.CellData.GetArray("elongation [N/mm]") else (1, 1)
    colour(view, tubes, "CELLS", "elongation [N/mm]", low, max(high, 1.01 * low), logarithmic=True)
    plain(Show(balls_of(model, "radius [mm]", 2.0), view), GREY, 0.15)
    told = "Stiffness of the links (%s/model.vtp)" % best
    if os.path.exists(path("findings.vtp")):  # at rest, as the model is here
        findings = XMLPolyDataReader(FileName=[path("findings.vtp")])
        for low, high, hue in ((0, 1 - sys.float_info.epsilon, SOFTER), (1, sys.float_info.max, FOUND)):
            part = Threshold(Input=findings, Scalars=["CELLS", "ratio"], LowerThreshold=low, UpperThreshold=high)
            plain(Show(part, view), hue, 0.7)
        told += "\nPurple: found to be missing; pink: softer than the rest;\ndashed: not determined, one standard deviation either way"
    return told


def ladder_view(view):
    """The state that the first model errs most in, step by step of the ladder: the bent body and its error vectors."""
    skin = PVDReader(FileName=path("improve", "ladder_skin.pvd"))
    markers = PVDReader(FileName=path("improve", "ladder_markers.pvd"))
    skin.UpdatePipeline(0)
    markers.UpdatePipeline(0)
    warp = WarpByVector(Input=skin, Vectors=["POINTS", "displacement [mm]"])
    plain(Show(warp, view), GREY, 0.3)
    arrows = arrows_of(markers, 1.0)
    Show(arrows, view)
    colour(view, arrows, "POINTS", "error [mm]", 0, lengths(markers, "error [mm]")[1])
    view.ViewTime = 0
    with open(path("improve", "ladder.json")) as file:
        told = ["%s %.3g mm" % (" + ".join(s["effects"]) or "nothing added:", s["rms_mm"]) for s in json.load(file)["steps"]]
    return "Ladder, worst state: play it. " + ", ".join(told)


def look_at_all(view):
    """z up, from a little above and before the body: as large as the view holds, with room for title and legend."""
    view.ResetCamera()
    camera = view.GetActiveCamera()
    focus, distance = camera.GetFocalPoint(), camera.GetDistance()
    away = (0.31, -0.87, 0.39)
    camera.SetPosition([f + distance * d for f, d in zip(focus, away)])
    camera.SetViewUp(0, 0, 1)
    b = view.GetRenderer().ComputeVisiblePropBounds()
    flat = math.hypot(away[0], away[1])
    right = (-away[1] / flat, away[0] / flat, 0)
    up = (-away[0] * away[2] / flat, -away[1] * away[2] / flat, flat)
    across, high = (sum(abs(axis[k]) * (b[2 * k + 1] - b[2 * k]) for k in range(3)) for axis in (right, up))
    wide, tall = view.ViewSize
    view.CameraParallelScale = 0.5 * max(high, across * tall / wide) / 0.75


builders = [fit_view, error_view, stiffness_view]
if os.path.exists(path("improve", "ladder_skin.pvd")):
    builders.append(ladder_view)
layout = CreateLayout("palpate")
views = []
for build in builders:
    view = CreateView("RenderView")
    view.UseColorPaletteForBackground = 0
    view.Background = [1, 1, 1]
    view.OrientationAxesLabelColor = [0, 0, 0]
    views.append(view)
layout.SplitHorizontal(0, 0.5)
layout.SplitVertical(1, 0.5)
cells = [3, 4, 2]
if len(views) > 3:
    layout.SplitVertical(2, 0.5)
    cells = [3, 4, 5, 6]
for view, cell in zip(views, cells):
    layout.AssignView(cell, view)
for view, build in zip(views, builders):
    title = Text(Text=build(view))
    shown = Show(title, view)
    shown.Color = [0, 0, 0]
    shown.FontSize = 13
    shown.Justification = "Left"
    view.CameraParallelProjection = 1

# Views know their sizes only now.
layout.SetSize(1800, 1100)
for view in views:
    Render(view)
    look_at_all(view)
    Render(view)
if len(sys.argv) > 1 and sys.argv[-1].endswith(".png"):
    SaveScreenshot(sys.argv[-1], layout, ImageResolution=[1800, 1100])
