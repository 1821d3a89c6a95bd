"""Runs every command that a page, or a section of it, shows, as its reader would: page_commands.py BESPOKE MODELS PAGE.md [HEADING]

Blocks of `sh` are run in their order, from a directory with the repository's `samples` in it, the generated `models`, and the
command in the PATH; a command that fails, fails the page, unless the block's last line says which exit code it shows. A block of
`text` right after one of commands is what they print: each of its lines is found there, in order; … stands for anything.
"""

import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
FENCE = re.compile(r"^```(\w*)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
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


def run(block, directory, environment):
    result = subprocess.run(["bash", "-euo", "pipefail", "-c", block], cwd=directory, env=environment,
                            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    shown = EXIT_CODE.search(block)
    return result.stdout, result.returncode == int(shown.group(1) if shown else 0)


def section(text, heading):
    """From this heading to the next of its rank."""
    begin = text.index(f"\n{heading}\n") + 1
    end = text.find(f"\n{heading.split()[0]} ", begin)
    return text[begin:] if end < 0 else text[begin:end]


def faults(text, directory, environment):
    """What does not happen as the text says, and the number of blocks that ran."""
    found, count, printed = [], 0, None
    for language, block in FENCE.findall(text):
        if language == "sh":
            printed, succeeded = run(block, directory, environment)
            count += 1
            if not succeeded:
                found.append(f"this failed:\n{block}{printed}")
        elif language in ("bash", "shell", "console"):
            found.append(f"commands that no test runs; mark them as sh:\n{block}")
        elif language == "text" and printed is not None:
            found += [f"nothing printed says, here or further down:\n  {line}\nbut\n{printed}"
                      for line in missing_lines(block, printed)]
            printed = None
        else:
            printed = None
    return found, count


def main():
    command, models, page = (Path(word).resolve() for word in sys.argv[1:4])
    text = page.read_text()
    if len(sys.argv) > 4:
        text = section(text, sys.argv[4])
    models.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as scratch:
        directory = Path(scratch)
        (directory / "samples").symlink_to(ROOT / "samples")
        (directory / "models").symlink_to(models)
        path = f"{command.parent}{os.pathsep}{os.environ['PATH']}"
        found, count = faults(text, directory, os.environ | {"PATH": path, "PYTHONDONTWRITEBYTECODE": "1"})
    print(*found, sep="\n\n")
    if count == 0:
        sys.exit(f"{page}: shows no commands")
    sys.exit(bool(found))


if __name__ == "__main__":
    main()
