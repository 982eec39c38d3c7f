#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""setup_lock_test.py SOURCES: tools/setup waits while another program holds one of apt's or dpkg's locks, and says so.

The apt-get is the machine's own. Its configuration gives it a folder of its own with one package, and no dpkg to unpack
that with; the locks are held in that folder the way apt holds them.
"""
import fcntl
import hashlib
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

LOCKS = ["var/lib/apt/lists/lock", "var/lib/dpkg/lock-frontend", "var/lib/dpkg/lock", "var/cache/apt/archives/lock"]


def private_apt(folder):
    """A folder of apt with a repository of the one package of the purpose wheel; what tools/setup runs with."""
    root = folder / "root"
    for name in ["var/lib/apt/lists/partial", "var/cache/apt/archives/partial", "var/lib/dpkg", "var/log/apt", "etc/apt/apt.conf.d",
                 "etc/apt/preferences.d", "etc/apt/sources.list.d", "etc/apt/trusted.gpg.d"]:
        (root / name).mkdir(parents=True)
    (root / "var/lib/dpkg/status").touch()
    package = folder / "package"
    (package / "DEBIAN").mkdir(parents=True)
    control = "Package: patchelf\nVersion: 1\nArchitecture: all\nMaintainer: nobody <nobody@example.org>\nDescription: empty\n"
    (package / "DEBIAN/control").write_text(control)
    repository = folder / "repository"
    repository.mkdir()
    archive = repository / "patchelf_1_all.deb"
    subprocess.run(["dpkg-deb", "--build", "--root-owner-group", package, archive], check=True, stdout=subprocess.DEVNULL)
    content = archive.read_bytes()
    (repository / "Packages").write_text(
        f"{control}Filename: ./{archive.name}\nSize: {len(content)}\nSHA256: {hashlib.sha256(content).hexdigest()}\n")
    (root / "etc/apt/sources.list").write_text(f"deb [trusted=yes] file:{repository} ./\n")
    (folder / "apt.conf").write_text(f'Dir "{root}";\nDir::Bin::dpkg "/bin/true";\nAPT::Sandbox::User "root";\n')
    commands = folder / "bin"
    commands.mkdir()
    for name, script in [("dpkg-query", "exit 1"), ("id", "echo 0")]:  # nothing is installed, and nobody needs sudo
        (commands / name).write_text(f"#!/bin/sh\n{script}\n")
        (commands / name).chmod(0o755)
    environment = {**os.environ, "APT_CONFIG": str(folder / "apt.conf"), "PATH": f"{commands}:{os.environ['PATH']}"}
    return root, environment


def run_while_held(sources, root, environment, lock):
    """The status and words of tools/setup while a lock is held until it says that it waits, or until it ends."""
    (root / lock).touch()
    with open(root / lock, "r+") as held:
        fcntl.lockf(held, fcntl.LOCK_EX)
        with subprocess.Popen([sources / "tools/setup", "wheel"], env=environment, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True) as process:
            said = ""
            for line in process.stdout:
                said += line
                if "waiting up to" in line and environment.get("SETUP_WAIT_S") is None:
                    fcntl.lockf(held, fcntl.LOCK_UN)
    return process.returncode, said


def main():
    sources = pathlib.Path(sys.argv[1])
    if not shutil.which("apt-get") or not shutil.which("dpkg-deb"):
        print("Skipped: no apt-get here")
        sys.exit(77)
    with tempfile.TemporaryDirectory() as folder:
        root, environment = private_apt(pathlib.Path(folder))
        for lock in LOCKS:
            status, said = run_while_held(sources, root, environment, lock)
            assert status == 0, f"{lock}: status {status}\n{said}"
            assert said.count("tubefoot: another program installs packages, waiting up to") == 1, f"{lock}: {said}"
            assert f"{root / lock}. It is held by process" in said, f"{lock}: {said}"
            assert "packages to be installed: patchelf" in said and "with what they need 1 packages" in said, f"{lock}: {said}"
        for lock in LOCKS:  # does not wait for ever, and ends with apt's own words
            status, said = run_while_held(sources, root, {**environment, "SETUP_WAIT_S": "1"}, lock)
            assert status != 0 and f"E: Could not get lock {root / lock}" in said, f"{lock}: status {status}\n{said}"
    print("tools/setup waits for the locks of apt and dpkg")


if __name__ == "__main__":
    main()
