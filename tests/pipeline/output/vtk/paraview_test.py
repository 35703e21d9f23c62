"""view.py of a run draws its views in ParaView, off screen.

paraview_test.py PALPATE [PICTURE]; ends with 77 (skipped) where pvbatch, its Python modules or Xvfb are missing. Debian's
python3-paraview cannot be installed beside libvtk9-dev: unpack it elsewhere and name it in PYTHONPATH.
"""
import pathlib
import shutil
import struct
import subprocess
import sys
import tempfile
import zlib

if not shutil.which("pvbatch") or not shutil.which("xvfb-run"):
    print("skipped: there is no pvbatch or no xvfb-run")
    sys.exit(77)


def pixels_of(picture):
    """Rows of (r, g, b) of an 8-bit PNG."""
    data, at, packed = picture.read_bytes(), 8, b""
    width = height = channels = 0
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + size]
        if kind == b"IHDR":
            width, height, _, colour = struct.unpack(">IIBB", body[:10])
            channels = {2: 3, 6: 4}[colour]
        elif kind == b"IDAT":
            packed += body
        at += size + 12
    raw, stride, rows, before = zlib.decompress(packed), width * channels, [], bytes(width * channels)
    for y in range(height):
        method, line = raw[y * (stride + 1)], bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        for x in range(stride):
            left = line[x - channels] if x >= channels else 0
            corner = before[x - channels] if x >= channels else 0
            up = before[x]
            guess = left + up - corner
            paeth = min((abs(guess - left), 0, left), (abs(guess - up), 1, up), (abs(guess - corner), 2, corner))[2]
            line[x] = (line[x] + (0, left, up, (left + up) // 2, paeth)[method]) & 255
        rows.append([tuple(line[x:x + 3]) for x in range(0, stride, channels)])
        before = bytes(line)
    return rows


program = sys.argv[1]
with tempfile.TemporaryDirectory() as folder:
    at = pathlib.Path(folder)

    def palpate(*arguments):
        subprocess.run([program, *map(str, arguments), "-q"], check=True, stdout=subprocess.DEVNULL)

    palpate("new", at / "case")
    palpate("run", at / "case/case.yaml", "-o", at / "run", "--probes", 6, "--spheres", 8, "--parameters", "uniform",
            "--particles", 40, "--edge-length", 8)
    palpate("probe", at / "run/identify/model.json", "-o", at / "blind", "--hide", "gravity", "--probes", 5, "--markers", 25)
    palpate("run", at / "blind", "-o", at / "measured", "--parameters", "uniform", "--particles", 40, "--edge-length", 12)
    for run, views in (("run", 3), ("measured", 4)):
        picture = at / f"{run}.png"
        done = subprocess.run(["xvfb-run", "-a", "-s", "-screen 0 1920x1200x24 -noreset", "pvbatch", str(at / run / "view.py"), str(picture)],
                              capture_output=True, text=True)
        if "No module named 'paraview'" in done.stderr + done.stdout:
            print("skipped: pvbatch lacks its Python modules")
            sys.exit(77)
        if not picture.exists():
            print("FAILED", done.stdout[-2000:], done.stderr[-2000:])
            sys.exit(1)
        if len(sys.argv) > 2:
            shutil.copy(picture, sys.argv[2])
        rows = pixels_of(picture)
        half, middle = len(rows) // 2, len(rows[0]) // 2
        parts = [[row[:middle] for row in rows[:half]], [row[:middle] for row in rows[half:]]]
        parts += [[row[middle:] for row in rows]] if views == 3 else [[row[middle:] for row in rows[:half]], [row[middle:] for row in rows[half:]]]
        for number, part in enumerate(parts):
            colours = {pixel for row in part for pixel in row}
            print(f"{run}: view {number + 1} of {views}: {len(colours)} colours")
            if len(colours) < 100:  # a title on white has some thirty shades of grey
                print("FAILED: the view is empty")
                sys.exit(1)
