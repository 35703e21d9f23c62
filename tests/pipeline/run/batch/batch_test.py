#!/usr/bin/env python3
"""Runs of several bodies by Snakemake: batch_test.py PALPATE REPOSITORY.

What is done stays done, what fails alone fails, a run whose machine ends it is taken up again; what came of all is told as
the schema says. By a Slurm of this machine's own, of two nodes, one of which is killed in the middle, where it is installed.
"""
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

try:
    import jsonschema
except ImportError as error:
    print("skipped:", error)
    sys.exit(77)

PALPATE, REPOSITORY = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
FAST = ["--spheres", "4", "--probes", "4", "--markers", "20", "--particles", "50"]


def palpate(*arguments, code=0):
    done = subprocess.run([PALPATE, *map(str, arguments)], capture_output=True, text=True)
    assert done.returncode == code, f"{arguments}: exit code {done.returncode}, {code} is expected\n{done.stderr}\n{done.stdout}"
    return done


def batch(inputs, output, workers, code=0, flags=()):
    told = json.loads(palpate("run", *inputs, "-o", output, "--workers", workers, "--json", "-q", "--threads", 1, *FAST, *flags, code=code).stdout)
    jsonschema.validate(told, json.loads((REPOSITORY / "pipeline/schemas/batch.schema.json").read_text()))
    return {run["name"]: run for run in told["runs"]}


def bodies(folder, count):
    palpate("new", folder / "new")
    text = (folder / "new/body.stl").read_bytes()
    for k in range(count):
        (folder / f"body {k}.stl").write_bytes(text)
    return [folder / f"body {k}.stl" for k in range(count)]


def when_finished(run):
    """When each stage of a run was finished, by what it left."""
    return {path: path.stat().st_mtime_ns for path in Path(run).rglob("model.json")}


def on_this_machine(folder):
    meshes = bodies(folder, 2)
    broken = folder / "broken.stl"
    broken.write_text("solid nothing\nendsolid nothing\n")
    runs = batch([*meshes, broken], folder / "runs", "local:2", code=4)
    assert "error" in runs["broken"] and "broken.stl" in runs["broken"]["error"], runs["broken"]
    for name in ("body 0", "body 1"):
        assert 0 < runs[name]["relative"] < 0.5 and Path(runs[name]["report"]).exists(), runs[name]
    before = when_finished(folder / "runs")

    # Again: nothing is done twice, but the new one is.
    more = folder / "body 2.stl"
    shutil.copy(meshes[0], more)
    runs = batch([*meshes, more], folder / "runs", "local:2")
    assert set(runs) == {"body 0", "body 1", "body 2"}
    after = when_finished(folder / "runs")
    assert all(after[path] == at for path, at in before.items())

    # Other flags: all of them anew.
    batch(meshes, folder / "runs", "local:2", flags=["--young", "0.2"])
    changed = when_finished(folder / "runs")
    assert any(changed[path] > at for path, at in before.items() if "body 0" in str(path))

    # Another body under a name: it alone.
    shutil.copy(REPOSITORY / "samples/import/tentacle/tentacle.stl", meshes[0])
    batch(meshes, folder / "runs", "local:2", flags=["--young", "0.2"])
    moved = {Path(path).relative_to(folder / "runs").parts[0] for path, at in when_finished(folder / "runs").items() if at > changed.get(path, 0)}
    assert moved == {"body 0"}, moved

    told = palpate("run", *meshes, code=3).stderr
    assert "--workers local:2" in told, told
    shutil.copytree(folder / "new", folder / "other/new")
    told = palpate("run", folder / "new/case.yaml", folder / "other/new/case.yaml", "--workers", "local:1", code=3).stderr
    assert "both called" in told, told


def interrupted(folder):
    """Ctrl-C: the runs end with the command, and are taken up when it is started again."""
    meshes = bodies(folder, 2)
    runs = folder / "runs"
    command = [PALPATE, "run", *meshes, "-o", runs, "--workers", "local:2", "-q", "--threads", "1", "--probes", "30"]
    working = subprocess.Popen(list(map(str, command)), start_new_session=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    wait_for(lambda: any(runs.rglob("model.json")), runs)
    os.killpg(working.pid, signal.SIGINT)
    assert working.wait(60) != 0
    wait_for(lambda: not any(str(runs).encode() in command_line(process) for process in Path("/proc").glob("[0-9]*")), runs)
    assert not any(runs.glob("*/report.html"))
    batch(meshes, runs, "local:2")


def command_line(process):
    try:
        return (process / "cmdline").read_bytes()
    except OSError:
        return b""


def wait_for(condition, runs, seconds=60):
    end = time.time() + seconds
    while not condition():
        if time.time() > end:
            seen = "squeue; sinfo; tail -n 30 workflow/snakemake.log; tail -n 5 ../slurm/*.log"
            raise AssertionError("waited in vain\n" + subprocess.run(seen, shell=True, capture_output=True, text=True, cwd=runs).stdout)
        time.sleep(0.2)


class Slurm:
    """A cluster of two nodes of this machine's, each a process, in a folder of its own."""

    def __init__(self, folder):
        self.folder = folder
        self.munged = None
        for name in ("state", "n1", "n2"):
            (folder / name).mkdir(parents=True)
        configuration = [
            "ClusterName=here", "SlurmctldHost=localhost", "SlurmUser=root", "AuthType=auth/munge", f"StateSaveLocation={folder}/state",
            f"SlurmdSpoolDir={folder}/%n", f"SlurmctldPidFile={folder}/controller.pid", f"SlurmdPidFile={folder}/%n.pid",
            f"SlurmctldLogFile={folder}/controller.log", f"SlurmdLogFile={folder}/%n.log", "SlurmctldPort=17817",
            "ProctrackType=proctrack/pgid", "TaskPlugin=task/none", "SelectType=select/cons_tres", "SelectTypeParameters=CR_Core_Memory",
            "AccountingStorageType=accounting_storage/none", "JobAcctGatherType=jobacct_gather/none", "ReturnToService=2",
            "SlurmdTimeout=10", "InactiveLimit=0", "MpiDefault=none", "SchedulerParameters=batch_sched_delay=0,sched_interval=2",
            "NodeName=n1 NodeHostname=localhost NodeAddr=127.0.0.1 Port=17001 CPUs=1 RealMemory=8000",
            "NodeName=n2 NodeHostname=localhost NodeAddr=127.0.0.1 Port=17002 CPUs=1 RealMemory=8000",
            "PartitionName=all Nodes=n1,n2 Default=YES MaxTime=INFINITE State=UP"]
        (folder / "slurm.conf").write_text("\n".join(configuration) + "\n")
        os.environ["SLURM_CONF"] = str(folder / "slurm.conf")

    def begin(self):
        """Whether it could begin: it takes the network and a user of its own."""
        if not Path("/run/munge/munge.socket.2").exists():  # else one serves the machine already
            Path("/run/munge").mkdir(exist_ok=True)
            shutil.chown("/run/munge", "munge", "munge")
            self.munged = subprocess.Popen(["su", "munge", "-s", "/bin/sh", "-c", "exec /usr/sbin/munged --force --foreground"],
                                           stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            time.sleep(1)
        if subprocess.run(["slurmctld", "-c"], check=False).returncode:
            return False
        for node in ("n1", "n2"):
            self.start(node)
        end = time.time() + 60
        while subprocess.run(["sinfo", "-h", "-o", "%T %D"], capture_output=True, text=True).stdout.strip() != "idle 2":
            if time.time() > end:
                return False
            time.sleep(0.5)
        return True

    def start(self, node):
        subprocess.run(["slurmd", "-N", node], check=True)

    def kill(self, node):
        """The node with all that works on it."""
        daemon = int((self.folder / f"{node}.pid").read_text())
        jobs = subprocess.run(["squeue", "-h", "-w", node, "-t", "R", "-o", "%A"], capture_output=True, text=True).stdout.split()
        assert jobs, "no job is on the node that is killed"
        for process in Path("/proc").glob("[0-9]*"):
            try:
                environment = (process / "environ").read_bytes()
            except OSError:
                continue
            command = command_line(process)
            on_node = f"SLURMD_NODENAME={node}".encode() in environment or any(
                command.startswith(b"slurmstepd: [" + job.encode()) for job in jobs)
            if on_node:
                os.kill(int(process.name), signal.SIGKILL)
        os.kill(daemon, signal.SIGKILL)
        return jobs

    def end(self):
        for name in ("n1", "n2", "controller"):
            file = self.folder / f"{name}.pid"
            if file.exists():
                try:
                    os.kill(int(file.read_text()), signal.SIGTERM)
                except OSError:
                    pass
        if self.munged:
            self.munged.terminate()
            self.munged.wait()


def on_a_cluster(folder, count):
    meshes = bodies(folder, count)
    slurm = Slurm(folder / "slurm")
    try:
        if not slurm.begin():
            print("Slurm does not start on this machine: the cluster was left out")
            return
        command = [PALPATE, "run", *meshes, "-o", folder / "runs", "--workers", "slurm:memory=2,minutes=20", "--json", "-q", "--threads", "1", *FAST]
        working = subprocess.Popen(list(map(str, command)), stdout=subprocess.PIPE, text=True)
        # In the middle of the second node's work.
        wait_for(lambda: len(list((folder / "runs").glob("*.json"))) >= 1
                 and subprocess.run(["squeue", "-h", "-w", "n2", "-t", "R", "-o", "%A"], capture_output=True, text=True).stdout.split(), folder / "runs")
        lost = slurm.kill("n2")
        time.sleep(12)  # the controller gives a node up after SlurmdTimeout
        slurm.start("n2")
        told, _ = working.communicate(timeout=1200)
        assert working.returncode == 0, told
        runs = json.loads(told)["runs"]
        assert len(runs) == count and all("error" not in run for run in runs), runs
        print(f"{count} runs on two nodes, of which one was killed with job {', '.join(lost)}: all are done")
        # All bodies are the same: so are the answers, wherever they were found.
        assert len({run["rms_mm"] for run in runs}) == 1, {run["rms_mm"] for run in runs}
    finally:
        slurm.end()


def main():
    if not shutil.which("snakemake"):
        print("snakemake is not installed")
        return 77
    with tempfile.TemporaryDirectory() as folder:
        on_this_machine(Path(folder))
    with tempfile.TemporaryDirectory() as folder:
        interrupted(Path(folder))
    if os.geteuid() == 0 and all(map(shutil.which, ("slurmctld", "slurmd", "munged"))):
        with tempfile.TemporaryDirectory() as folder:
            on_a_cluster(Path(folder), int(os.environ.get("PALPATE_BATCH", "4")))
    else:
        print("Slurm is not installed: the cluster was left out")
    return 0


if __name__ == "__main__":
    sys.exit(main())
