#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""publish_test.py SOURCES: the workflow and the container file say what can be done: they parse, and what they name is there."""
import pathlib
import re
import subprocess
import sys

try:
    import yaml
except ImportError:
    print("python3-yaml is not installed")
    sys.exit(77)

SOURCES = pathlib.Path(sys.argv[1])
wrong = []


def hold(true, words):
    if not true:
        wrong.append(words)


class OnceOnly(yaml.SafeLoader):
    """Refuses a key that is there twice, of which YAML's reader would keep the last without a word."""

    def construct_mapping(self, node, deep=False):
        keys = [self.construct_object(key) for key, _ in node.value]
        hold(len(keys) == len(set(keys)), f"line {node.start_mark.line + 1}: a key twice in {keys}")
        return super().construct_mapping(node, deep)


targets = set(re.findall(r"^([a-z][a-z-]*):", (SOURCES / "Makefile").read_text(), re.M))
workflow = yaml.load((SOURCES / ".github/workflows/packages.yml").read_text(), OnceOnly)
on = workflow.get("on", workflow.get(True))  # YAML 1.1 takes "on" for true
hold(set(on) == {"push", "pull_request", "workflow_dispatch"}, f"it runs on {on}")
hold(workflow["permissions"] == {"contents": "read"}, "all jobs may do more than read")
jobs = workflow["jobs"]
debians = jobs["packages"]["strategy"]["matrix"]["debian"]
for name, job in jobs.items():
    needs = job.get("needs", [])
    for other in [needs] if isinstance(needs, str) else needs:
        hold(other in jobs, f"job {name} needs {other}, which is none")
    matrix = job.get("strategy", {}).get("matrix", {})
    hold(matrix.get("debian", debians) == debians, f"job {name} is for other Debians than {debians}")
    for step in job["steps"]:
        hold(("run" in step) != ("uses" in step), f"a step of {name} neither runs nor uses, or both")
        hold(re.fullmatch(r"actions/[a-z-]+@v\d+", step.get("uses", "actions/x@v1")), f"unpinned: {step.get('uses')}")
        script = step.get("run", "")
        for used in re.findall(r"\$\{\{ *matrix\.(\w+)", str(step)):
            hold(used in matrix, f"job {name} has no matrix.{used}")
        shell = subprocess.run(["bash", "-n"], input=re.sub(r"\$\{\{.*?\}\}", "word", script), text=True, capture_output=True)
        hold(shell.returncode == 0, f"job {name}: {shell.stderr}")
        for line in re.findall(r"\bmake ((?:[a-z]+ ?)+)$", script, re.M):
            hold(set(line.split()) <= targets, f"make has no {set(line.split()) - targets}")
        for scene in re.findall(r"(?<![\w/])scenes/\S+\.toml", script):
            hold((SOURCES / scene).is_file(), f"{scene} is not there")
        if "docker build" in script:
            (file,) = re.findall(r"-f (\S+)", script)
            hold((SOURCES / file).is_file(), f"{file} is not there")
        publishes = "docker push" in script or "gh release" in script
        guard = step.get("if", job.get("if", ""))
        hold(not publishes or "refs/tags/v" in guard, f"job {name} publishes what no tag asks for")

# The Debians that packages are built for are those that the documents promise.
words = (SOURCES / "docs/installation.md").read_text()
for debian in debians:
    hold(f"Debian {debian}" in words, f"docs/installation.md does not know Debian {debian}")

lines = (SOURCES / "packaging/Containerfile").read_text().replace("\\\n", " ").splitlines()
steps = [line.split(None, 1) for line in lines if line and not line.startswith("#")]
order = [step for step, _ in steps]
hold(order == ["ARG", "FROM", "COPY", "RUN", "USER", "WORKDIR", "ENTRYPOINT", "CMD"], f"the container file's steps: {order}")
said = dict(steps)
hold(said["ARG"].split("=") in [["DEBIAN", debian] for debian in debians], f"ARG {said['ARG']}")
hold(said["FROM"] == "debian:${DEBIAN}", f"FROM {said['FROM']}")
hold(re.fullmatch(r"[1-9]\d*", said["USER"]), f"USER {said['USER']} is root, or no number that can be told from it")
hold(f"--uid {said['USER']} " in said["RUN"], "the user is not made")
hold(f" {said['WORKDIR']}" in said["RUN"], "the working folder is not made for the user")
hold("--no-install-recommends" in said["RUN"] and "fonts-dejavu-core" in said["RUN"], "too much, or pictures without labels")
hold(said["ENTRYPOINT"] == '["tubefoot"]', said["ENTRYPOINT"])
hold(subprocess.run(["bash", "-n"], input=said["RUN"], text=True).returncode == 0, "RUN is no shell script")

print("\n".join(wrong) or "the workflow and the container file name what is there")
sys.exit(bool(wrong))
