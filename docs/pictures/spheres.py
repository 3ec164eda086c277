"""pvbatch spheres.py DIR PICTURE: the last frame of a particle run as spheres coloured by speed."""
import glob
import sys

from paraview.simple import (
    ColorBy,
    GetActiveViewOrCreate,
    GetColorTransferFunction,
    GetScalarBar,
    Glyph,
    Hide,
    OpenDataFile,
    Render,
    SaveScreenshot,
    Show,
)

folder, picture = sys.argv[1:3]
frame = OpenDataFile(sorted(glob.glob(folder + "/frame_*.hdf"))[-1])
frame.UpdatePipeline()
spheres = Glyph(Input=frame, GlyphType="Sphere")
spheres.GlyphType.Radius = 1
spheres.ScaleArray = ["POINTS", "radius"]
spheres.ScaleFactor = 1
spheres.GlyphMode = "All Points"
view = GetActiveViewOrCreate("RenderView")
view.ViewSize = [800, 600]
view.UseColorPaletteForBackground = 0
view.Background = [1, 1, 1]
view.OrientationAxesVisibility = 0
Hide(frame, view)
shown = Show(spheres, view)
ColorBy(shown, ("POINTS", "velocity", "Magnitude"))
shown.RescaleTransferFunctionToDataRange()
bar = GetScalarBar(GetColorTransferFunction("velocity"), view)
bar.Title, bar.ComponentTitle = "speed [m/s]", ""
bar.TitleColor = bar.LabelColor = [0, 0, 0]
shown.SetScalarBarVisibility(view, True)
view.CameraViewUp = [0, 0, 1]
view.CameraPosition = [0.35, -1, 0.25]
view.CameraFocalPoint = [0, 0, 0]
view.ResetCamera()
Render()
SaveScreenshot(picture, view)
