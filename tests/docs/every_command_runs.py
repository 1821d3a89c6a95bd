"""Every block of commands on a page of the repository is run by a test: every_command_runs.py PAGE…

The arguments are the pages that page_commands.py is told to run. What no test can run (it installs, builds, needs a display, or
files that are no part of the repository) stands in a block of another language, `text`.
"""

import re
import sys

from page_commands import FENCE, ROOT, RUN

OPENING = re.compile(r"^ *(?:```+|~~~+) *\{?(\w+)", re.MULTILINE)
# Other names of `sh`, which page_commands.py does not run.
OF_COMMANDS = (*RUN, "bash", "shell", "console", "zsh", "pycon", "py")
BUILT = ("build", "node_modules")


def blocks_of_commands(text):
    return sum(language in OF_COMMANDS for language in OPENING.findall(text))


def blocks_run(text):
    return sum(language in RUN for language, _ in FENCE.findall(text))


def pages_not_run(texts, run):
    """Names of the pages that show more than is run: of `texts`, by their names, those that `run` has are run."""
    counts = {name: (blocks_of_commands(text), blocks_run(text) if name in run else 0) for name, text in texts.items()}
    return [f"{name}: {shown} blocks of commands, {done} of them run" for name, (shown, done) in counts.items() if shown != done]


def what_is_not_run_is_found():
    sh = "```sh\nls\n```\n"
    texts = {
        "a page without a test": (sh, []),
        "a block by another name": (sh.replace("sh", "bash"), ["page"]),
        "an indented block": ("- first\n\n  ```sh\n  ls\n  ```\n", ["page"]),
    }
    found = [f"not found: {name}" for name, (text, run) in texts.items() if not pages_not_run({"page": text}, run)]
    return found + ["a page that is run is named"] * bool(pages_not_run({"page": sh}, ["page"]))


def main():
    run = set(sys.argv[1:])
    paths = [path.relative_to(ROOT) for path in ROOT.rglob("*.md")]
    texts = {str(path): (ROOT / path).read_text() for path in paths if not set(path.parts) & set(BUILT)}
    properties = {
        "every block of commands is run": pages_not_run(texts, run),
        "pages that are run exist": sorted(run - set(texts)),
        "what is not run is found": what_is_not_run_is_found(),
    }
    for prop, exceptions in properties.items():
        print(f"{'broken' if exceptions else 'held'}: {prop}", *exceptions, sep="\n  ")
    sys.exit(any(properties.values()))


if __name__ == "__main__":
    main()
