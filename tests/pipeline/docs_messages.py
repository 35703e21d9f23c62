"""How each message of pipeline/docs/troubleshooting.md is provoked: a shell script by the message's name.

A script runs in a folder of its own that holds samples/ and README.md; the message is in what it prints. Each ends with
exit code 3 or the one told here, and writes nothing.
"""


def box(x, y, z, a, b, c, first=1, without=()):
    """A box as OBJ; `without`: faces that are left out, of bottom, top, front, right, back and left."""
    corners = [(x, y, z), (x + a, y, z), (x + a, y + b, z), (x, y + b, z)]
    corners += [(u, v, w + c) for u, v, w in corners]
    faces = [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]
    lines = ["v {:g} {:g} {:g}".format(*p) for p in corners]
    return lines + ["f " + " ".join(str(first + i) for i in f) for k, f in enumerate(faces) if k not in without]


def file(name, lines):
    return f"cat > {name} <<'END'\n" + "\n".join(lines) + "\nEND\n"


bar = box(0, 0, 0, 80, 16, 16)


def case(supports):
    return file("body.obj", bar) + file("case.yaml", ["format: palpate-case/1", "mesh: body.obj", f"supports: [{supports}]"])


def measured(change, set_yaml=()):
    """A small set of a bar, and then what is wrong with it."""
    return ("palpate new --measurements set >/dev/null; cd set\n"
            + file("probes.csv", ["probe,time,x,y,z,fx,fy,fz,radius", "0,0,100,10,20,0,0,0,0", "1,0,95,10,20,0,0,-0.02,4"])
            + file("markers.csv", ["marker,x,y,z", "tip,100,10,20", "middle,50,10,20"])
            + file("positions.csv", ["probe,time,marker,x,y,z", "0,0,tip,100,10,20", "1,0,tip,99.8,10,17.9", "1,0,middle,49.9,10,19.3"])
            + "".join(f"echo '{line}' >> set.yaml\n" for line in set_yaml) + f"{change}\ncd ..\n")


probe_once = "palpate probe {} -o made --hide none --probes 1 --markers 3"
check_set = "palpate check set"
push_hard = "sed -i 's/-0.02,4/-8,4/' probes.csv"
compare = "palpate compare samples/two-strings/start.json set --edge-length 15"
scripts = {
    "unknown-command": "palpate rnu samples/organ/case.yaml",
    "range": "palpate probe samples/plan/bar.stl -o made --probes 0",
    "no-file": "palpate check none.stl",
    "kind": "palpate mesh README.md -o made.vtu",
    "effect": "palpate effects gravty",
    "open": file("open.obj", box(0, 0, 0, 80, 16, 16, without=(1, 2))) + "palpate mesh open.obj -o made.vtu",
    "flat": file("sheet.obj", box(0, 0, 0, 80, 16, 16, without=(1, 2, 3, 4, 5))) + "palpate mesh sheet.obj -o made.vtu",
    "crossing": file("crossing.obj", bar + box(70, 4, 4, 80, 8, 8, first=9)) + "palpate check crossing.obj",
    "two": file("two.obj", bar + box(0, 40, 0, 80, 16, 16, first=9)) + "palpate mesh two.obj -o made.vtu",
    "unit": file("small.obj", box(0, 0, 0, 0.08, 0.016, 0.016)) + "palpate check small.obj",
    "nothing-held": case("{box: {min: [200, 0, 0], max: [210, 9, 9]}}") + probe_once.format("case.yaml"),
    "too-little": case("{sphere: {center: [0, 0, 0], radius: 0.05}}") + probe_once.format("case.yaml"),
    "off": measured("sed -i 's/^middle.*/middle,50,10,35/' markers.csv") + check_set,
    "column": measured("sed -i '1s/.*/marker,X,Y,Z,colour/' markers.csv") + check_set,
    "comma": measured("sed -i 's/99.8,10,17.9/99,8,10,17,9/' positions.csv") + check_set,
    "number": measured("sed -i 's/99.8,10,17.9/99.8,ten,17.9/' positions.csv") + check_set,
    "label-twice": measured("sed -i 's/^middle/tip/' markers.csv") + check_set,
    "read-twice": measured("echo '1,0,tip,99.8,10,17.9' >> positions.csv") + check_set,
    "label": measured("sed -i 's/1,0,middle/1,0,midle/' positions.csv") + check_set,
    "no-state": measured("sed -i '/^0,0,100/d' probes.csv") + check_set,
    "no-rows": "palpate new --measurements bare >/dev/null; palpate identify samples/two-strings/start.json bare -o made",
    "young": measured(push_hard, ["material: {young: 0.1}", "noise: {position: 0.05}"]) + compare,
    "explains-nothing": measured(push_hard, ["noise: {position: 0.05}"]) + compare,
    "no-equilibrium": "palpate probe samples/plan/bar.stl -o made --hide prestress:sxx=-3,syy=0,szz=0,sxy=0,syz=0,sxz=0 --probes 1 --markers 3",
    "memory": "ulimit -v 900000; " + probe_once.format("samples/plan/bar.stl") + " --threads 1 --edge-length 1",
    "folder": "mkdir by-hand; echo mine > by-hand/notes.txt; palpate run samples/plan/bar.stl -o by-hand",
    "file": "echo mine > my.vtu; palpate mesh samples/plan/bar.stl -o my.vtu",
    "address-space": "ulimit -v 700000; " + probe_once.format("samples/plan/bar.stl"),
}
exits = {"unknown-command": 2, "range": 2, "crossing": 0, "unit": 0, "young": 0, "explains-nothing": 0, "no-equilibrium": 4, "memory": 4}
