"""Every JSON and YAML file that palpate writes or reads follows its schema, and nothing else does.

schemas_test.py PALPATE SOURCE_FOLDER; ends with 77 (skipped) where python3-jsonschema or python3-yaml is missing.
"""
import copy
import json
import pathlib
import subprocess
import sys
import tempfile

try:
    import jsonschema
    import yaml
except ImportError as error:
    print("skipped:", error)
    sys.exit(77)

program, source = sys.argv[1], pathlib.Path(sys.argv[2])
failures = []


def schema(name):
    if name == "model":
        return json.loads((source / "skeleton/model.schema.json").read_text())
    return json.loads((source / "pipeline/schemas" / f"{name}.schema.json").read_text())


def check(name, file):
    """The file follows its schema; with a key that nobody knows it does not."""
    content = yaml.safe_load(file.read_text()) if file.suffix == ".yaml" else json.loads(file.read_text())
    rules = schema(name)
    jsonschema.Draft202012Validator.check_schema(rules)
    validator = jsonschema.Draft202012Validator(rules)
    for error in validator.iter_errors(content):
        failures.append(f"{file}: {'/'.join(map(str, error.absolute_path))}: {error.message[:300]}")
    spoilt = copy.deepcopy(content)
    spoilt["no such key"] = 1
    if validator.is_valid(spoilt):
        failures.append(f"{name}: a key that is unknown passes")
    print("checked", name, file)


def palpate(*arguments):
    done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True)
    if done.returncode != 0:
        failures.append(f"palpate {' '.join(map(str, arguments))}: exit code {done.returncode}: {done.stderr[-500:]}")
    return done.stdout


for case in sorted(source.glob("samples/*/case.yaml")):
    check("case", case)
for described in sorted(source.glob("samples/**/set.yaml")):
    check("set", described)

for drawn in sorted(source.glob("samples/import/*/map.yaml")):
    check("map", drawn)

# A bar's four corners, filmed while its end is pulled: a rig's files in their smallest form.
points = [(0, 0, 0), (80, 0, 0), (80, 16, 0), (80, 0, 16)]
frames = ["time [s]," + ",".join(f"{name}_{axis} [mm]" for name in "abcd" for axis in "xyz") + ",load [N]"]
for frame in range(41):
    pulled = 0.0 if frame < 20 else 1.0
    places = [(x + 0.02 * pulled * x / 2, y, z) for x, y, z in points]
    frames.append(f"{frame / 10}," + ",".join(f"{value}" for place in places for value in place) + f",{2 * pulled}")
mapped = """name: bar
mesh: body.stl
supports: [{box: {min: [-1, -1, -1], max: [1, 20, 20]}}]
files: [{file: run.csv}]
register: none
forces: [{at: [80, 8, 8], radius: 4, along: [1, 0, 0], channel: load}]
"""

with tempfile.TemporaryDirectory() as scratch:
    at = pathlib.Path(scratch)
    palpate("new", at / "rig")
    (at / "rig/run.csv").write_text("\n".join(frames) + "\n")
    (at / "rig/map.yaml").write_text(mapped)
    check("map", at / "rig/map.yaml")
    palpate("import", at / "rig/run.csv", "--map", at / "rig/map.yaml", "-o", at / "imported")
    check("import", at / "imported/import.json")
    check("set", at / "imported/set.yaml")
    palpate("import", at / "rig/run.csv", "--describe", "-o", at / "drafted.yaml")
    check("map", at / "drafted.yaml")
    palpate("check", at / "imported", "-o", at / "checked")
    check("check", at / "checked/check.json")

    palpate("new", at / "case")
    check("case", at / "case/case.yaml")

    for rig in ("indenter", "tensile", "pneumatic", "tendon"):
        palpate("new", "--rig", rig, at / rig)
        check("set", at / rig / "set.yaml")

    palpate("run", at / "case/case.yaml", "-o", at / "run", "--probes", 6, "--spheres", 8, "--parameters", "uniform",
            "--particles", 40, "--edge-length", 8)
    for name, file in {"case": "case.yaml", "run": "run.json", "compare": "compare/compare.json",
                       "identify": "identify/identify.json", "model": "identify/model.json",
                       "set": "measurements/set.yaml"}.items():
        check(name, at / "run" / file)

    (at / "check.json").write_text(palpate("check", at / "run/measurements", "--cost", "--json"))
    check("check", at / "check.json")

    palpate("run", at / "case/case.yaml", "-o", at / "second", "--probes", 6, "--spheres", 8, "--parameters",
            "uniform", "--particles", 40, "--edge-length", 8, "--seed", 2)
    told = palpate("report", at / "run", at / "second", "-o", at / "runs.html", "--json")
    (at / "runs.json").write_text(told)
    check("runs", at / "runs.json")
    palpate("pool", at / "run", at / "second", "-o", at / "pooled")
    check("population", at / "pooled/population.json")

    model, blind = at / "run/identify/model.json", at / "blind"
    palpate("probe", model, "-o", blind, "--hide", "gravity", "--probes", 5, "--markers", 25)
    check("truth", blind / "truth.json")
    check("set", blind / "set.yaml")
    palpate("diagnose", model, blind, "--body", "skeleton", "-o", at / "diagnosed")
    check("diagnosis", at / "diagnosed/diagnosis.json")
    palpate("improve", model, blind, "--add", "gravity", "-o", at / "improved", "--parameters", "uniform",
            "--edge-length", 12, "--particles", 40)
    check("ladder", at / "improved/ladder.json")
    check("model", at / "improved/model.json")
    palpate("compare", at / "improved/model.json", blind, "--edge-length", 12, "-o", at / "compared")
    check("compare", at / "compared/compare.json")
    palpate("skeleton", at / "case/case.yaml", "-o", at / "small.json", "--quality", "--quality-spheres", 4,
            "--quality-probes", 4, "--spheres", 4, "--edge-length", 10)
    check("quality", at / "small_quality.json")

for failure in failures:
    print("FAILED", failure)
sys.exit(1 if failures else 0)
