"""Builds the site as tools/docs does, and checks what it wrote: site_test.py OUT"""

import html.parser
import importlib.machinery
import importlib.util
import shutil
import subprocess
import sys
import urllib.parse
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


class Page(html.parser.HTMLParser):
    """The links of a page, and the places in it that links may name."""

    def __init__(self, path):
        super().__init__()
        self.links, self.places = [], {""}
        self.feed(path.read_text())

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        self.places.update(attributes[key] for key in ("id", "name") if key in attributes)
        self.links += [attributes[key] for key in ("href", "src") if attributes.get(key)]


def load_docs():
    loader = importlib.machinery.SourceFileLoader("docs", str(ROOT / "tools" / "docs"))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("docs", loader))
    loader.exec_module(module)
    return module


def links_lead_somewhere(site, pages):
    broken = []
    for path, page in pages.items():
        for link in page.links:
            parts = urllib.parse.urlsplit(link)
            if parts.scheme or parts.netloc or path.name in ("search.html", "genindex.html"):
                continue
            goal = (path.parent / urllib.parse.unquote(parts.path)).resolve() if parts.path else path
            if not goal.exists() or (goal in pages and urllib.parse.unquote(parts.fragment) not in pages[goal].places):
                broken.append(f"{path.relative_to(site)}: {link}")
    return broken


def every_page_is_on_the_site(docs, site, pages):
    return [str(page) for page in docs.pages() if site / page.with_suffix(".html") not in pages]


def every_page_is_in_the_menu(docs, site, pages):
    listed = {(site / link.split("#")[0]).resolve() for link in pages[site / "index.html"].links}
    return [str(page) for page in docs.pages() if (site / page.with_suffix(".html")) not in listed]


def every_page_has_contents_and_search(site, pages):
    """A page without the site's menu and its search field is a dead end."""
    texts = {path: path.read_text() for path in pages}
    lacking = [path for path, text in texts.items() if "sidebar-tree" not in text or 'action="' not in text]
    index = (site / "searchindex.js").read_text()
    unknown = [word for word in ("contact", "troubleshooting", "landmark") if word[:6] not in index]
    scores = "reference/" in (site / "_static" / "language_data.js").read_text()  # prose first
    return [str(path.relative_to(site)) for path in lacking] + unknown + ["search_scores.js"] * (not scores)


def links_to_nothing_are_named(docs, out):
    gathered = docs.Gathered(out / "scratch")
    gathered.link(Path("samples/viewers/README.md"), "nowhere.md", "")
    gathered.link(Path("samples/viewers/README.md"), "../figures.py", "")
    return [] if len(gathered.broken) == 1 and "nowhere.md" in gathered.broken[0] else [str(gathered.broken)]


def every_public_header_is_in_the_reference(site):
    text = "".join(path.read_text() for path in (site / "reference" / "library").glob("*.html"))
    library = ROOT / "src" / "bespoke"
    headers = [*library.glob("*.h"), *library.glob("*/*.h")]  # those in a module's folders are its own
    names = [str(header.relative_to(ROOT / "src")) for header in headers]
    return [name for name in names if name not in text] + ["apply_points"] * (text.count("apply_points") < 2)


def main():
    for program, module in (("doxygen", ""), ("", "sphinx"), ("", "myst_parser"), ("", "furo"), ("", "sphinx_copybutton")):
        if not (shutil.which(program) if program else importlib.util.find_spec(module)):
            print(f"{program or module} is not installed: tools/setup --docs")
            sys.exit(77)
    out = Path(sys.argv[1]).resolve()
    shutil.rmtree(out, ignore_errors=True)
    subprocess.run([ROOT / "tools" / "docs", "--no-setup", "--out", out], check=True)
    docs, site = load_docs(), out / "html"
    pages = {path: Page(path) for path in site.rglob("*.html")}
    properties = {
        "links lead somewhere": links_lead_somewhere(site, pages),
        "every page is on the site": every_page_is_on_the_site(docs, site, pages),
        "every page is in the menu": every_page_is_in_the_menu(docs, site, pages),
        "every page has contents and search": every_page_has_contents_and_search(site, pages),
        "links to nothing are named": links_to_nothing_are_named(docs, out),
        "every public header is in the reference": every_public_header_is_in_the_reference(site),
    }
    for prop, exceptions in properties.items():
        print(f"{'broken' if exceptions else 'held'}: {prop}", *exceptions, sep="\n  ")
    sys.exit(any(properties.values()))


if __name__ == "__main__":
    main()
