#!/usr/bin/python3
"""Writes the tables of accuracy into the pages that show them, out of recorded.json.

    tests/accuracy/tables.py            # rewrites what stands between `<!-- table: NAME -->` and `<!-- end -->`
    tests/accuracy/tables.py --check    # writes nothing; exit code 1 where a page differs from recorded.json
"""
import argparse
import json
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
RECORDED = ROOT / "tests" / "accuracy" / "recorded.json"
PAGES = ("README.md", "tests/accuracy/README.md")
MARKED = re.compile(r"(?<=<!-- table: )([\w-]+)( -->\n).*?(?=<!-- end -->)", re.DOTALL)
FRONT_PAGE = {"faust-persons 088 098": "two persons in one pose (FAUST)",
              "faust-poses 058 052": "a person in two poses (FAUST)",
              "tosca horse14 horse6": "a horse in two poses (TOSCA)",
              "mouse C3H_HEOUJ C3HeB": "two skulls, 90,000 vertices (mice)"}
IN_ONE_POSE = ("d00", "d01", "d02", "d03", "d04", "d05", "d06", "d07")


def table(headings, rows):
    return "\n".join(f"| {' | '.join(row)} |" for row in (headings, ["---"] * len(headings), *rows)) + "\n"


def errors(figures):
    return f"{figures['mean']:.3f} / {figures['p95']:.3f}"


def best(figures):
    return f"{figures['program']} {figures['value']:.3f}"


def results(recorded):
    rows = {row["pair"]: row for row in recorded["public"]}
    return public_table([{**rows[name], "pair": what} for name, what in FRONT_PAGE.items()])


def pairs(recorded):
    rows = [[f"`{pair['id']}` {pair['what']}", errors(pair["default"]), str(pair["default"]["flipped"]), errors(pair["paper"]),
             str(pair["paper"]["flipped"]), best(pair["best_mean"]), best(pair["best_p95"]), f"{pair['default']['seconds']:.1f} s",
             f"{pair['default']['megabytes']:.1f} MB"] for pair in recorded["pairs"]]
    return table(["pair", "default: mean / p95", "default: flipped faces", "`--paper`: mean / p95", "`--paper`: flipped faces",
                  "best other program by its mean", "best other program by its p95", "fit, bake, write", "file"], rows)


def averages(recorded):
    chosen = [pair for pair in recorded["pairs"] if pair["id"] in IN_ONE_POSE]

    def row(name, figures):
        mean = {key: sum(each[key] for each in figures) / len(figures) for key in ("mean", "p95")}
        return [name, errors(mean), str(sum(each["flipped"] for each in figures))]

    rows = [row("default", [pair["default"] for pair in chosen]), row("`--paper`", [pair["paper"] for pair in chosen])]
    rows += [[harder["what"], errors(harder), str(harder["flipped"])] for harder in recorded["harder_anchors"]]
    rows += [[other["program"], errors(other), str(other["flipped"])] for other in recorded["other_programs"]]
    return table(["`d00` to `d07`", "average of the mean errors / of the p95", "flipped faces, sum"], rows)


def without_anchors(recorded):
    what = {pair["id"]: pair["what"] for pair in recorded["pairs"]}
    rows = [[f"`{case['id']}` {what[case['id']]}", f"{case['confidence']:.2f}",
             f"{case['mean']:.3f}" if "mean" in case else f"refused: {case['refused']}", f"{case['with_anchors']:.3f}"]
            for case in recorded["without_anchors"]]
    return table(["pair", "confidence, 0 to 1", "mean error without anchors", "with anchors"], rows)


def methods(recorded):
    rows = [[f"`{m['surface_fit']}` and `{m['elastic']}`", errors(m), str(m["flipped"])] for m in recorded["methods"]]
    return table(["methods, `d00` to `d07`", "average of the mean errors / of the p95", "flipped faces, sum"], rows)


def public_table(rows):
    """Rows of public_pairs.py; a fit that failed says why."""
    def cells(row):
        cpu = f"{row['cpu_seconds']:.0f} s"
        if "failure" in row:
            return [row["pair"], row["failure"], "", "", cpu, "", ""]
        flipped = "not known" if row["flipped"] is None else str(row["flipped"])
        return [row["pair"], errors(row), f"{row['max']:.2f}", flipped, cpu, f"{row['megabytes']:.1f} MB",
                "yes" if row["proved"] else "no"]

    headings = ["pair", "mean / p95, %", "max, %", "flipped faces", "fit, CPU", "file", "proved"]
    return table(headings, [cells(row) for row in rows])


def recorded_maps_table(rows):
    """Maps of other programs that public_pairs.py has scored."""
    return table(["pair", "map", "mean / p95, %", "max, %", "points without a place"],
                 [[row["pair"], row["method"] + (", mirrored" if row["mirrored"] else ""), errors(row),
                   f"{row['max']:.2f}", str(row["nowhere"])] for row in rows])


def public(recorded):
    return public_table(recorded["public"])


TABLES = {"public": public, "results": results, "pairs": pairs, "averages": averages,
          "without-anchors": without_anchors, "methods": methods}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--check", action="store_true", help="writes nothing, fails where a page is out of date")
    check = parser.parse_args().check
    recorded, shown, old_pages = json.loads(RECORDED.read_text()), set(), []
    for name in PAGES:
        page = ROOT / name
        old = page.read_text()
        new = MARKED.sub(lambda mark: mark.group(1) + mark.group(2) + TABLES[mark.group(1)](recorded), old)
        shown.update(mark.group(1) for mark in MARKED.finditer(old))
        old_pages += [name] if new != old else []
        if not check:
            page.write_text(new)
    if missing := set(TABLES) - shown:
        sys.exit(f"no page shows: {', '.join(sorted(missing))}")
    if check and old_pages:
        sys.exit(f"{', '.join(old_pages)}: not what recorded.json says; run tests/accuracy/tables.py")


if __name__ == "__main__":
    main()
