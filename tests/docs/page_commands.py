"""Runs every command that a page shows, as its reader would: page_commands.py BESPOKE BUILD MODELS PAGE.md [PROGRAM… python:MODULE…]

Blocks of `sh` and of `python` are run in their order, from a directory with the repository's `samples` and `src` in it, the
generated `models`, and the build as `build/release`; the command is in the PATH. One that fails, fails the page, unless the last
line of a block of `sh` says which exit code it shows. A block of `text` right below one of commands is what they print: each of its
lines is found there, in order; … stands for anything. Where a program or a module of Python is missing that the page needs, it is
skipped (exit code 77).
"""

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
FENCE = re.compile(r"^```(\w*)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
RUN = ("sh", "python")
BUILD = Path("build", "release")  # where the pages have it
EXIT_CODE = re.compile(r"# exit code (\d+)\s*$")


def missing_lines(shown, printed):
    """The lines of `shown` that do not come in `printed` in this order."""
    missing, lines = [], iter(printed.splitlines())
    for line in shown.splitlines():
        pattern = re.compile(".*".join(map(re.escape, re.split("…", line.strip()))))
        if line.strip() and not any(pattern.fullmatch(candidate.strip()) for candidate in lines):
            missing.append(line)
            break
    return missing


def in_python(build):
    return ["env", f"PYTHONPATH={build / 'python'}", "/usr/bin/python3", "-c"]


def run(language, block, directory, environment):
    program = {"sh": ["bash", "-euo", "pipefail", "-c"], "python": in_python(directory / BUILD)}[language]
    result = subprocess.run([*program, block], cwd=directory, env=environment, stdin=subprocess.DEVNULL,
                            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    shown = EXIT_CODE.search(block) if language == "sh" else None
    return result.stdout, result.returncode == int(shown.group(1) if shown else 0)


def faults(text, directory, environment):
    """What does not happen as the text says, and the number of blocks that ran."""
    found, count, printed, end = [], 0, None, 0
    for fence in FENCE.finditer(text):
        language, block = fence.groups()
        is_below = not text[end : fence.start()].strip()
        if language in RUN:
            printed, succeeded = run(language, block, directory, environment)
            count += 1
            if not succeeded:
                found.append(f"this failed:\n{block}{printed}")
        elif language == "text" and printed is not None and is_below:
            found += [f"nothing printed says, here or further down:\n  {line}\nbut\n{printed}"
                      for line in missing_lines(block, printed)]
            printed = None
        else:
            printed = None
        end = fence.end()
    return found, count


def is_missing(need, build):
    name = need.removeprefix("python:")
    if name == need:
        return shutil.which(name) is None
    return subprocess.run([*in_python(build), f"import {name}"], stderr=subprocess.DEVNULL).returncode != 0


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    for name in ("command", "build", "models", "page"):
        parser.add_argument(name, type=lambda word: Path(word).resolve())
    parser.add_argument("needs", nargs="*")
    given = parser.parse_args()
    path = f"{given.command.parent}{os.pathsep}{os.environ['PATH']}"
    environment = os.environ | {"PATH": path, "PYTHONDONTWRITEBYTECODE": "1", "BESPOKE_BUILD_DIRECTORY": str(given.build)}
    missing = [need for need in given.needs if is_missing(need, given.build)]
    if missing:
        print("not here:", *missing)
        sys.exit(77)
    given.models.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as scratch:
        directory = Path(scratch)
        for tree in ("samples", "src"):
            (directory / tree).symlink_to(ROOT / tree)
        (directory / "models").symlink_to(given.models)
        (directory / BUILD).parent.mkdir()
        (directory / BUILD).symlink_to(given.build)
        found, count = faults(given.page.read_text(), directory, environment)
    print(*found, sep="\n\n")
    if count == 0:
        sys.exit(f"{given.page}: shows no commands")
    sys.exit(bool(found))


if __name__ == "__main__":
    main()
