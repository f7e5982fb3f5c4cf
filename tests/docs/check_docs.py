#!/usr/bin/env python3
"""check_docs.py SOURCE [GROUNDLOOP WORK]: the pages a user reads, held against what is there.

Without a program: every relative link of README.md and apps/docs leads somewhere, and every path in backticks exists.
With one: every command of the pages' `sh` blocks is run, in order, in the folder WORK, on small simulated recordings
that have the names the pages use.
"""
import re
import shutil
import subprocess
import sys
from pathlib import Path

source = Path(sys.argv[1])
docs = source / "apps/docs"
# In reading order: the index, then as it links; a later page may use what an earlier one made.
linked = re.findall(r"\]\(([a-z_]+\.md)\)", (docs / "index.md").read_text())
pages = [source / "README.md", docs / "index.md", *(docs / name for name in dict.fromkeys(linked))]
failures = []


def check_links(page, text):
    for target in re.findall(r"\]\(([^)#\s]+)", text):
        if "://" in target:
            continue
        if not (page.parent / target).exists():
            failures.append(f"{page}: link to {target}, which does not exist")


def check_paths(page, text):
    folders = "apps|backend|cmake|configs|frontend|loopclosure|tests"
    for path in re.findall(rf"`((?:{folders})/[A-Za-z0-9_./-]+)`", text):
        if not (source / path).exists():
            failures.append(f"{page}: {path} does not exist")


def commands(text):
    for block in re.findall(r"^```sh\n(.*?)^```", text, re.S | re.M):
        for line in block.splitlines():
            line = re.sub(r"\s+#.*", "", line).strip()
            if line.startswith("groundloop "):
                yield line


def prepare(groundloop, work):
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir(parents=True)
    town = "sim:town?sensor=spin16&length=130&seed=3"
    for name, recording in (("drive", town), ("monday", town), ("friday", town + "&change=1")):
        subprocess.run([groundloop, "--quiet", "simulate", recording, "--layout", "mcap", "--out", name], cwd=work, check=True)
        (file,) = (work / name).glob("*.mcap")
        file.rename(work / f"{name}.mcap")
        shutil.rmtree(work / name)
    subprocess.run([groundloop, "--quiet", "run", "drive.mcap", "--out", "session"], cwd=work, check=True)


def run_commands(groundloop, work):
    done = set()
    for page in pages:
        if page.name == "README.md":
            continue  # its commands are those of the pages, behind a build's path
        for line in commands(page.read_text()):
            # The demo has a test of its own, and the session of the page is there already.
            if line in done or line == "groundloop demo" or line.endswith("run drive.mcap --out session"):
                continue
            done.add(line)
            result = subprocess.run(line.replace("groundloop", f"'{groundloop}'", 1), shell=True, cwd=work, text=True,
                                    capture_output=True, timeout=600)
            if result.returncode != 0:
                failures.append(f"{page}: `{line}` exits with {result.returncode}: {result.stderr.strip()[-300:]}")
    return len(done)


for page in sorted(set(docs.glob("*.md")) - set(pages)):
    failures.append(f"{page}: the index does not link to it")
for page in pages:
    text = page.read_text()
    check_links(page, text)
    check_paths(page, text)
summary = f"{len(pages)} pages"
if len(sys.argv) > 2:
    groundloop, work = str(Path(sys.argv[2]).resolve()), Path(sys.argv[3])
    prepare(groundloop, work)
    summary += f", {run_commands(groundloop, work)} commands"
for failure in failures:
    print(failure)
print(f"{summary}, {len(failures)} failures")
sys.exit(1 if failures else 0)
