#!/usr/bin/python3
"""Names the tests that did not run, with their reasons: skipped_tests.py RESULTS.xml (of ctest --output-junit)"""

import re
import sys
import xml.etree.ElementTree as ElementTree

# What GoogleTest, page_commands.py and other scripts print where they skip.
REASONS = (re.compile(r": Skipped\n(.+)"), re.compile(r"^(?:skipped: )?(.+)$", re.MULTILINE))


def reason(case):
    printed = case.findtext("system-out") or ""
    found = next((match for pattern in REASONS if (match := pattern.search(printed))), None)
    return found.group(1).strip() if found else "no reason was printed"


def main():
    cases = list(ElementTree.parse(sys.argv[1]).getroot().iter("testcase"))
    skipped = [case for case in cases if case.find("skipped") is not None]
    by_reason = {}
    for case in skipped:
        by_reason.setdefault(reason(case), []).append(case.get("name"))
    for why, names in by_reason.items():
        print(f"skipped: {why}", *names, sep="\n  ")
    failed = sum(case.find("failure") is not None for case in cases)
    print(f"{len(cases) - failed - len(skipped)} tests passed, {failed} failed, {len(skipped)} were skipped")


if __name__ == "__main__":
    main()
