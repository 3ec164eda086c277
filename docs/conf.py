"""Sphinx configuration of the site: scripts/site builds it. Everything that a page needs is on this
machine, so the site works without a network."""
import pathlib
import re

from docutils.nodes import SkipNode

ROOT = pathlib.Path(__file__).resolve().parents[1]
KATEX = pathlib.Path("/usr/share/javascript/katex")  # Debian: libjs-katex

project = "democles"
copyright = "the democles authors, BSD-3-Clause"
release = re.search(r"version: '([^']+)'", (ROOT / "meson.build").read_text()).group(1)
version = release

extensions = ["myst_parser"]
myst_enable_extensions = ["dollarmath", "deflist"]
myst_heading_anchors = 3
exclude_patterns = ["examples", "pictures"]
# YAML of scenes has units (5 mm), which the highlighter takes for text; that is no defect.
suppress_warnings = ["misc.highlighting_failure"]

highlight_language = "text"

html_theme = "furo"
html_title = f"democles {release}"
html_static_path = ["assets"] + ([str(KATEX)] if KATEX.is_dir() else [])
html_css_files = ["site.css"]
html_js_files = ["site.js"]
html_copy_source = False
html_show_sourcelink = False
html_math_renderer = "katex"


def visit_inline(self, node):
    self.body.append(self.starttag(node, "span", "", CLASS="math") + self.encode(node.astext()))
    self.body.append("</span>")
    raise SkipNode


def visit_block(self, node):
    self.body.append(self.starttag(node, "div", "", CLASS="math") + self.encode(node.astext()))
    self.body.append("</div>\n")
    raise SkipNode


def setup(app):
    """Formulas go into the page as TeX; KaTeX draws them in the browser.
    Without KaTeX they stay TeX, which can be read."""
    app.add_html_math_renderer("katex", (visit_inline, None), (visit_block, None))
    if KATEX.is_dir():
        app.add_css_file("katex.min.css")
        app.add_js_file("katex.min.js", priority=100)
