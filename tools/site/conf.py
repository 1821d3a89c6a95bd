"""How Sphinx makes the site out of the gathered pages; tools/docs runs it and sets both variables."""
import os
import re
import sys
import types
import __future__
from pathlib import Path

root, out = Path(os.environ["BESPOKE_ROOT"]), Path(os.environ["BESPOKE_OUT"])

project = "bespoke"
release = re.search(r"project\(bespoke VERSION ([\d.]+)", (root / "CMakeLists.txt").read_text()).group(1)
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx_copybutton"]

# What a page prints is not to be copied, what it asks for is.
copybutton_selector = ".highlight-sh pre, .highlight-python pre, .highlight-cpp pre, .highlight-json pre"

html_theme = "furo"
html_title = f"bespoke {release}"
html_static_path = [str(out / "pages" / "static")]
html_css_files = ["site.css"]
html_search_scorer = str(root / "tools" / "site" / "search_scores.js")
html_show_copyright = html_show_sphinx = html_copy_source = html_show_sourcelink = False
html_last_updated_fmt = None

myst_heading_anchors = 4
# Names of C++ and Python that no page declares (Eigen's, NumPy's) are shown without a link.
nitpicky = False
pygments_style, pygments_dark_style = "tango", "native"

cpp_index_common_prefix = ["bespoke::"]

# The package is read as its sources; its stub stands in for the compiled module.
sys.path.insert(0, str(root / "src" / "python"))
sys.dont_write_bytecode = True
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
toc_object_entries_show_parents = "hide"
autodoc_default_options = {"members": True, "undoc-members": True}


def load_stub():
    path = root / "src" / "python" / "bespoke" / "_engine.pyi"
    module = types.ModuleType("bespoke._engine")
    # A stub may name a class before it is defined.
    exec(compile(path.read_text(), path, "exec", __future__.annotations.compiler_flag), module.__dict__)
    sys.modules[module.__name__] = module


load_stub()
