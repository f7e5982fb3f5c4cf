#!/usr/bin/env python3
"""fault_table.py GROUNDLOOP FOLDER: does what goes wrong at users' desks, and prints what groundloop says to each.

Prints a table in Markdown: fault, exit code, message, what was lost. "Nothing" is a measured word: every file of the recordings
and sessions beside the fault has the same bytes afterwards, nothing was added but what a successful command was asked for, and a
refusal is one line on standard error, below warnings at most, with exit code 2. Ends with 1 where any row departs from that. FOLDER is made anew."""
import hashlib
import os
import pathlib
import re
import shutil
import signal
import struct
import subprocess
import sys
import time

WORLD = "sim:town?sensor=spin16&length=60&seed=3"
RUN = ["--set", "local_maps.max_scans=6", "--set", "keeping.checkpoint_seconds=0"]
LINE = 170  # characters of a message that the table shows


class Desk:
    """A recording in several layouts and sessions made of them, and commands beside them."""

    def __init__(self, groundloop, folder):
        self.groundloop = groundloop
        self.folder = folder
        self.rows, self.failures = [], 0
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        for layout in ("folder", "kitti", "rosbag", "rosbag2", "mcap", "mulran", "nclt"):
            self.must("simulate", WORLD, "--layout", layout, "--out", layout, "--count", "24")
        self.must("run", "folder", "--out", "session", *RUN)
        self.must("run", "kitti", "--out", "other", *RUN)

    def call(self, *words, timeout=120, **options):
        return subprocess.run([self.groundloop, "--quiet", *words], cwd=self.folder, capture_output=True, text=True,
                              errors="replace", timeout=timeout, **options)

    def must(self, *words):
        result = self.call(*words)
        if result.returncode != 0:
            sys.exit(f"{words}: {result.stderr}")

    def state(self, ignore=()):
        """Names and checksums of all files here, without those whose first part is in `ignore`."""
        found = {}
        for path in sorted(self.folder.rglob("*")):
            name = path.relative_to(self.folder)
            if path.is_file() and name.parts[0] not in ignore:
                found[str(name)] = hashlib.md5(path.read_bytes()).hexdigest()
        return found

    def fault(self, group, what, *words, code=2, out=(), **options):
        """One row: the command is expected to end with `code`; `out` are files or folders that it may write."""
        before = self.state(out)
        try:
            result = self.call(*words, **options)
            exit_code, errors = result.returncode, result.stderr.strip().splitlines()
        except subprocess.TimeoutExpired:
            exit_code, errors = "hangs", []
        after = self.state(out)
        lost = [name for name in before if after.get(name) != before[name]]
        left = [name for name in after if name not in before]
        said = errors[-1] if errors else ""
        wrong = []
        if exit_code != code:
            wrong.append(f"exit {exit_code}, not {code}")
        refusals = [line for line in errors if line.startswith("groundloop: ")]
        if code == 2 and (len(refusals) != 1 or refusals != errors[-1:]):
            wrong.append(f"{len(refusals)} lines")
        if lost:
            wrong.append("lost " + ", ".join(lost[:3]))
        if left:
            wrong.append("left " + ", ".join(left[:3]))
        for name in out:
            remove(self.folder / name)
        self.row(group, what, exit_code, said, wrong)

    def row(self, group, what, exit_code, said, wrong):
        self.failures += bool(wrong)
        said = said.replace(f"{self.folder}/", "").replace("|", "\\|")
        said = said if len(said) <= LINE else said[: LINE - 1] + "…"
        self.rows.append(f"| {len(self.rows) + 1} | {group} | {what} | {exit_code} | {said} | {'; '.join(wrong) or 'nothing'} |")
        print(self.rows[-1], file=sys.stderr)

    def copy(self, source, name):
        remove(self.folder / name)
        path = self.folder / source
        (shutil.copytree if path.is_dir() else shutil.copy)(path, self.folder / name)
        return self.folder / name


def remove(path):
    shutil.rmtree(path, ignore_errors=True) if path.is_dir() else path.unlink(missing_ok=True)


def cut(path):
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


def flip(path):
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 0x40
    path.write_bytes(content)


def command_line(desk):
    def row(what, *words):
        desk.fault("command", what, *words)
    row("no command")
    row("unknown command", "frobnicate")
    row("misspelt command", "rum", "folder", "--out", "x")
    row("unknown option", "run", "folder", "--out", "x", "--overwritte")
    row("option without its value", "run", "folder", "--out")
    row("no `--out`", "run", "folder")
    row("word where a number stands", "run", "folder", "--out", "x", "--count", "many")
    row("negative number of scans", "run", "folder", "--out", "x", "--count", "-5")
    row("too many threads", "--threads", "99999", "run", "folder", "--out", "x")
    row("first scan beyond the end", "run", "folder", "--out", "x", "--first", "1000")
    row("`--resume --overwrite` of nothing", "run", "folder", "--out", "x", "--resume", "--overwrite")
    row("`--set` without a value", "run", "folder", "--out", "x", "--set", "odometry.voxel_size")
    row("`--set` of an unknown key", "run", "folder", "--out", "x", "--set", "odometry.voxelsize=1")
    row("`--set` of a word for a number", "run", "folder", "--out", "x", "--set", "odometry.voxel_size=big")
    row("`--set` of a number out of range", "run", "folder", "--out", "x", "--set", "odometry.voxel_size=-1")
    row("`--set` of NaN", "run", "folder", "--out", "x", "--set", "odometry.max_range=nan")
    row("unknown preset", "run", "folder", "--out", "x", "--config", "handhled")
    row("configuration that is no YAML", "run", "folder", "--out", "x", "--config", "broken.yaml")
    row("configuration with an unknown key", "run", "folder", "--out", "x", "--config", "key.yaml")
    row("configuration of another kind", "run", "folder", "--out", "x", "--config", "list.yaml")
    row("format that does not exist", "run", "folder", "--out", "x", "--format", "las")
    row("export to an unknown ending", "export", "session", "--out", "map.xyz")
    row("export with a negative voxel", "export", "session", "--out", "map.ply", "--voxel", "-1")
    row("unknown alignment", "evaluate", "trajectory", "--estimate", "session/trajectory.tum", "--ground-truth",
        "session/odometry.tum", "--align", "sim4")
    row("unknown suite", "benchmark", "kity", "--out", "x")
    row("simulated world that does not exist", "run", "sim:twon", "--out", "x")
    row("simulated world of no length", "run", "sim:town?length=-1", "--out", "x")


def input_of_scans(desk):
    folder = desk.folder

    def row(what, *words, **options):
        # What a run finished before it met the fault stays for --resume.
        desk.fault("input", what, *words, out=("x",), **options)
    row("path that does not exist", "run", "missing", "--out", "x")
    (folder / "empty").mkdir()
    row("empty folder", "run", "empty", "--out", "x")
    (folder / "text.bag").write_text("no bag at all\n")
    row("text file called .bag", "run", "text.bag", "--out", "x")
    (folder / "nothing.bag").write_bytes(b"")
    row("empty file called .bag", "run", "nothing.bag", "--out", "x")
    row("a picture", "run", "picture.png", "--out", "x")
    row("session given as a recording", "run", "session", "--out", "x")
    for layout, pattern in (("rosbag", "*.bag"), ("rosbag2", "*.db3"), ("mcap", "*.mcap")):
        file = next(iter(sorted((folder / layout).rglob(pattern))))
        relative = file.relative_to(folder)
        row(f"topic that is not in the {layout}", "run", layout, "--out", "x", "--topic", "/camera")
        for how, change in (("without its second half", cut), ("with its first bytes changed", head)):
            copy = desk.copy(layout, "broken")
            change(copy / relative.relative_to(layout))
            # What stands before the break may be used; what is said is looked at, and nothing is lost.
            desk.tolerant("input", f"{layout} {how}", "run", "broken", "--out", "x", *RUN)
            remove(copy)
    metadata = desk.copy("rosbag2", "broken") / "metadata.yaml"
    for what, name in (("in another folder", "../folder/x.db3"), ("by an absolute path", "/etc/passwd")):
        lines = metadata.read_text().splitlines()
        at = next(i for i, line in enumerate(lines) if "relative_file_paths" in line)
        lines[at + 1] = f"    - {name}"
        metadata.write_text("\n".join(lines))
        row(f"metadata.yaml that names a file {what}", "run", "broken", "--out", "x")
    metadata.write_text("rosbag2_bagfile_information: [")
    row("metadata.yaml that is no YAML", "run", "broken", "--out", "x")
    remove(metadata.parent)
    scans_of_folders(desk, row)
    dataset_files(desk, row)


def head(path):
    content = path.read_bytes()
    path.write_bytes(b"\xff" * min(16, len(content)) + content[16:])


def scans_of_folders(desk, row):
    folder = desk.folder

    def with_scans(what, make, **options):
        own = folder / "scans"
        own.mkdir()
        make(own)
        if options.pop("tolerant", False):
            desk.tolerant("input", what, "run", "scans", "--out", "x", *RUN)
        else:
            row(what, "run", "scans", "--out", "x", *RUN)
        remove(own)

    def scans(content, extension, count=6):
        def make(own):
            for i in range(count):
                (own / f"{i:06d}.{extension}").write_bytes(content)
        return make
    nan = struct.pack("<4f", *[float("nan")] * 4)
    with_scans("scans of no bytes", scans(b"", "bin"))
    with_scans("scans of 13 bytes", scans(b"0123456789abc", "bin"))
    with_scans("scans of NaN alone", scans(nan * 1000, "bin"))
    with_scans("scans of zeros alone", scans(bytes(16000), "bin"))
    with_scans("scans of one point", scans(struct.pack("<4f", 1, 2, 3, 4), "bin"))
    with_scans("coordinates of 1e38", scans(struct.pack("<4f", 1e38, 1e38, 1e38, 1) * 1000, "bin"))
    pcd = ("VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH {0}\nHEIGHT 1\nPOINTS {0}\nDATA binary\n")
    with_scans("PCD that announces 4 billion points", scans(pcd.format(4000000000).encode() + bytes(12), "pcd"))
    with_scans("PCD without a header", scans(b"1 2 3\n4 5 6\n", "pcd"))
    with_scans("PCD whose header has no end", scans(b"VERSION 0.7\nFIELDS x y z\n", "pcd"))
    with_scans("PCD with a negative width", scans(pcd.format(-5).encode(), "pcd"))
    with_scans("PLY that announces 4 billion points",
               scans(b"ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\n"
                     b"property float z\nend_header\n", "ply"))
    with_scans("PLY without positions", scans(b"ply\nformat ascii 1.0\nelement vertex 1\nproperty float a\nend_header\n1\n", "ply"))
    with_scans("PLY of an unknown format", scans(b"ply\nformat ternary 3.0\n", "ply"))

    def one_broken(own):
        shutil.copytree(folder / "folder", own, dirs_exist_ok=True)
        broken = sorted(p for p in own.rglob("*") if p.suffix in (".bin", ".pcd", ".ply"))[5]
        cut_odd(broken)
    with_scans("one scan of 24 cut off amid a point", one_broken, tolerant=True)

    def few_points(own):
        shutil.copytree(folder / "folder", own, dirs_exist_ok=True)
        few = sorted(p for p in own.rglob("*") if p.suffix in (".bin", ".pcd", ".ply"))[5]
        head, points = few.read_bytes().split(b"DATA binary\n")
        size = len(points) // int(re.search(rb"POINTS (\d+)", head)[1])
        few.write_bytes(re.sub(rb"(WIDTH|POINTS) \d+", rb"\1 3", head) + b"DATA binary\n" + points[: 3 * size])
    with_scans("one scan of 24 with three points", few_points, tolerant=True)


def cut_odd(path):
    content = path.read_bytes()
    path.write_bytes(content[: len(content) // 2 // 16 * 16 + 7])


def dataset_files(desk, row):
    folder = desk.folder

    def changed(what, layout, pattern, content, tolerant=False):
        copy = desk.copy(layout, "broken")
        file = next(iter(sorted(copy.rglob(pattern))), None)
        if file is None:
            sys.exit(f"{layout} has no {pattern}")
        remove(file) if content is None else file.write_text(content(file.read_text()) if callable(content) else content)
        sequence = next((p for p in copy.rglob("velodyne") if p.is_dir()), copy / "x").parent if layout == "kitti" else copy
        words = ["run", str(sequence.relative_to(folder)), "--out", "x", *RUN]
        desk.tolerant("input", what, *words) if tolerant else row(what, *words)
        remove(copy)
    changed("KITTI with times.txt cut short", "kitti", "times.txt", "0.0\n0.1\n")
    changed("KITTI with a word in times.txt", "kitti", "times.txt", lambda t: t.replace("\n", "\nword\n", 1))
    changed("KITTI with times that run backwards", "kitti", "times.txt",
            lambda t: "\n".join(reversed(t.split())) + "\n")
    changed("KITTI with all times equal", "kitti", "times.txt", lambda t: "1.0\n" * len(t.split()))
    changed("KITTI without times.txt", "kitti", "times.txt", None, tolerant=True)
    changed("KITTI with calib.txt of words", "kitti", "calib.txt", "Tr: this is no matrix\n")
    changed("KITTI with a pose too few", "kitti", "poses/*.txt", lambda t: "\n".join(t.splitlines()[:-1]) + "\n", tolerant=True)
    changed("KITTI with a pose of eleven numbers", "kitti", "poses/*.txt", lambda t: t.replace(" ", "", 1))
    changed("MulRan with two numbers run together", "mulran", "global_pose.csv", lambda t: t.replace(",", "", 1))
    changed("MulRan with a row of a column more", "mulran", "global_pose.csv", lambda t: t.replace("\n", "\n1,", 1))
    changed("NCLT with a truth of words", "nclt", "groundtruth*.csv", "a,b,c,d,e,f,g\n")


def ground_truth(desk):
    folder = desk.folder
    truth = (folder / "session/trajectory.tum").read_text()
    rows = [line.split() for line in truth.splitlines() if line and not line.startswith("#")]

    def row(what, content, *more):
        if content is not None:
            (folder / "truth.txt").write_text(content)
        desk.fault("ground truth", what, "run", "folder", "--out", "x", "--ground-truth", "truth.txt", *more)
    row("file that does not exist", None)
    row("empty file", "")
    row("words", "this is no trajectory\n")
    row("rows of five numbers", "1 2 3 4 5\n" * 9)
    row("stamps that match nothing", "".join(f"{9e5 + i} 0 0 0 0 0 0 1\n" for i in range(30)))
    row("a NaN among the positions", "".join(" ".join([r[0], "nan", *r[2:]]) + "\n" for r in rows))
    row("quaternions of zeros", "".join(" ".join([*r[:4], "0", "0", "0", "0"]) + "\n" for r in rows))
    row("frame that is no file", truth, "--truth-frame", "camra")
    (folder / "frame.txt").write_text("1 0 0 0\n0 2 0 0\n0 0 1 0\n0 0 0 1\n")
    row("frame that is no rotation", truth, "--truth-frame", "frame.txt")
    row("camera frame without calib.txt", truth, "--truth-frame", "camera")
    for name in ("truth.txt", "frame.txt"):
        remove(folder / name)
    for what, words in (("estimate that does not exist", ["--estimate", "none", "--ground-truth", "session/trajectory.tum"]),
                        ("trajectories that share no stamp", ["--estimate", "far.tum", "--ground-truth", "session/trajectory.tum"])):
        (folder / "far.tum").write_text("".join(f"{9e5 + i} 0 0 0 0 0 0 1\n" for i in range(30)))
        desk.fault("ground truth", what, "evaluate", "trajectory", *words)
        remove(folder / "far.tum")


def sessions(desk):
    folder = desk.folder

    def row(what, *words, **options):
        desk.fault("session", what, *words, **options)
    row("run into a finished session", "run", "folder", "--out", "session", *RUN)
    row("run into a folder with other files", "run", "kitti", "--out", "folder", *RUN)
    row("run into its own recording, overwriting", "run", "folder", "--out", "folder", "--overwrite", *RUN)
    row("resume of a finished session", "run", "folder", "--out", "session", "--resume", *RUN, code=0)
    row("resume with another recording", "run", "kitti", "--out", "session", "--resume", *RUN)
    row("resume with another configuration", "run", "folder", "--out", "session", "--resume", "--set", "local_maps.max_scans=5")
    row("resume of nothing", "run", "folder", "--out", "nothing", "--resume", *RUN)
    row("resume in a folder that is no session", "run", "kitti", "--out", "folder", "--resume", *RUN)
    row("output folder that is a file", "run", "folder", "--out", "picture.png", *RUN)
    row("merge into one of its sessions", "merge", "session", "other", "--out", "session")
    row("merge of a session with itself", "merge", "session", "session", "--out", "x")
    row("merge with a folder that is no session", "merge", "session", "folder", "--out", "x")
    row("merge of one that does not exist", "merge", "session", "missing", "--out", "x")
    row("`--fix` of another name", "merge", "session", "other", "--out", "x", "--fix", "third")
    row("matches of a file that is none, made anew", "merge", "session", "other", "--out", "x", "--matches", "picture.png", code=0, out=("x",))
    row("export of a folder that is no session", "export", "folder", "--out", "map.ply")
    row("graph that is no g2o", "optimize", "picture.png", "--out", "x.g2o")
    (folder / "nan.g2o").write_text("VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\nVERTEX_SE3:QUAT 1 nan 0 0 0 0 0 1\n")
    row("graph with a NaN", "optimize", "nan.g2o", "--out", "x.g2o")
    (folder / "edge.g2o").write_text("VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\nEDGE_SE3:QUAT 0 7 0 0 0 0 0 0 1 " + "1 " * 21 + "\n")
    row("graph with an edge to nowhere", "optimize", "edge.g2o", "--out", "x.g2o")
    for name in ("nan.g2o", "edge.g2o"):
        remove(folder / name)
    for name in ("manifest.json", "closures.csv", "pose_graph.g2o", "local_maps.csv", "odometry.tum", "trajectory.tum",
                 "loop_database.bin", "local_maps/000000.pcd"):
        for how, change in (("missing", remove), ("cut off", cut), ("with one bit changed", flip)):
            broken = desk.copy("session", "damaged")
            change(broken / name)
            row(f"{name} {how}, merged", "merge", "damaged", "other", "--out", "x")
            remove(broken)
    for what, number in (("of format 1", 1), ("of a format to come", 99)):
        broken = desk.copy("session", "damaged")
        manifest, changes = re.subn(r'"session_format": \d+', f'"session_format": {number}', (broken / "manifest.json").read_text())
        if changes != 1:
            sys.exit("the manifest's format is written otherwise")
        (broken / "manifest.json").write_text(manifest)
        row(f"session {what}", "merge", "damaged", "other", "--out", "x")
        remove(broken)


def disk_and_process(desk):
    folder = desk.folder

    def row(what, *words, **options):
        desk.fault("disk", what, *words, **options)
    row("output below a file", "run", "folder", "--out", "picture.png/session", *RUN)
    row("output name of 300 characters", "run", "folder", "--out", "s" * 300, *RUN)
    row("output where nothing can be made", "run", "folder", "--out", "/proc/session", *RUN)
    row("export to a device that is full", "export", "session", "--out", "/dev/full/map.ply")
    row("export into a folder that does not exist, which is made", "export", "session", "--out", "none/map.ply", code=0, out=("none",))
    row("graph written into a folder", "optimize", "session/pose_graph.g2o", "--out", "empty")
    lock = subprocess.Popen([desk.groundloop, "--quiet", "run", "folder", "--out", "locked", *RUN, "--set", "odometry.voxel_size=0.1"],
                            cwd=folder, stderr=subprocess.DEVNULL)
    while not (folder / "locked/manifest.json").exists() and lock.poll() is None:
        time.sleep(0.002)
    lock.send_signal(signal.SIGSTOP)
    result = desk.call("run", "folder", "--out", "locked", "--resume", *RUN, "--set", "odometry.voxel_size=0.1")
    lock.send_signal(signal.SIGCONT)
    lock.wait()
    desk.row("process", "second run into the folder of one that works", result.returncode, result.stderr.strip(),
             [] if result.returncode == 2 and lock.returncode == 0 else ["not refused"])
    remove(folder / "locked")
    for name, kind in (("SIGINT", signal.SIGINT), ("SIGTERM", signal.SIGTERM), ("SIGKILL", signal.SIGKILL), ("SIGHUP", signal.SIGHUP)):
        for wait in (0.05, 0.15, 0.3):
            stop(desk, name, kind, wait)


def stop(desk, name, kind, wait):
    arguments = ["run", "folder", "--out", "stopped", *RUN]
    process = subprocess.Popen([desk.groundloop, "--quiet", *arguments], cwd=desk.folder, stderr=subprocess.PIPE, text=True)
    time.sleep(wait)
    process.send_signal(kind)
    said = process.communicate()[1].strip()
    again = desk.call(*arguments, *(["--resume"] if (desk.folder / "stopped/manifest.json").exists() else []))
    ignored = ("run.log", "metrics.json", "report.html", "manifest.json")
    wrong = [] if again.returncode == 0 else [f"resume: {again.stderr.strip()}"]
    for path in sorted((desk.folder / "session").rglob("*")):
        other = desk.folder / "stopped" / path.relative_to(desk.folder / "session")
        if path.is_file() and path.name not in ignored and (not other.exists() or other.read_bytes() != path.read_bytes()):
            wrong.append(f"{path.name} differs")
    remove(desk.folder / "stopped")
    desk.row("process", f"{name} after {wait} s, resumed", process.returncode, said, wrong)


def tolerant(desk, group, what, *words):
    """A fault that may be refused, or borne and said; nothing else."""
    code = desk.call(*words).returncode
    remove(desk.folder / "x")
    desk.fault(group, what, *words, code=code if code in (0, 2) else 2, out=("x",))


Desk.tolerant = tolerant


def main(groundloop, folder):
    desk = Desk(str(pathlib.Path(groundloop).resolve()), pathlib.Path(folder).resolve())
    (desk.folder / "picture.png").write_bytes(b"\x89PNG\r\n\x1a\n" + bytes(100))
    (desk.folder / "broken.yaml").write_text("odometry: [1, 2\n")
    (desk.folder / "key.yaml").write_text("odometry:\n  voxel_sise: 1\n")
    (desk.folder / "list.yaml").write_text("- 1\n- 2\n")
    for group in (command_line, input_of_scans, ground_truth, sessions, disk_and_process):
        group(desk)
    print("| | of | fault | exit | groundloop says | lost |\n| ---: | --- | --- | ---: | --- | --- |")
    print("\n".join(desk.rows))
    print(f"\n{len(desk.rows)} faults, {desk.failures} not borne.", file=sys.stderr)
    shutil.rmtree(desk.folder)
    return 1 if desk.failures else 0


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    sys.exit(main(*sys.argv[1:]))
