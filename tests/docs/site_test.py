#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Opens the documents' site from its files, as a reader does, and tries the site's builder on a site that is wrong.

site_test.py HTML BUILD: the folder that docs/site/build.py wrote, and that program.
"""
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "viewer"))
from browser import Page, skip  # noqa: E402

BUILD = pathlib.Path(sys.argv.pop(2)).resolve()
HTML = pathlib.Path(sys.argv.pop(1)).resolve()
sys.dont_write_bytecode = True
sys.path.insert(0, str(BUILD.parent))
import headers  # noqa: E402

if not (HTML / "index.html").exists():
    skip("there is no site: see the test Docs.Site")


class InABrowser(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.page = Page()

    @classmethod
    def tearDownClass(cls):
        cls.page.close()

    def open(self, name, width=1280, height=800):
        self.page.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {
            "width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 600})
        self.page.driver.get(f"file://{HTML}/{name}")
        self.page.settle()

    def test_pages_are_whole_and_nothing_comes_over_the_network(self):
        pages = ["index.html", "docs/energies.html", "docs/gallery.html", "api/python.html", "api/src-engine-echo.html",
                 "search.html?q=closure"]
        for name in pages:
            self.open(name)
            self.assertEqual(self.asked_for(), [], name)
            if "search" not in name:  # looks into the pages that it found, which files do not allow: it lists them bare
                self.assertEqual([m for m in self.page.messages() if m["level"] != "INFO"], [], name)
        self.page.driver.execute_async_script(
            "const i = new Image(); i.onerror = i.onload = () => arguments[0](); i.src = 'http://localhost:9/a.png'")
        self.assertEqual(self.asked_for(), ["http://localhost:9/a.png"])  # such a thing is seen

    def asked_for(self):
        """What the page has loaded or tried to; files are not told."""
        names = self.page.js("return performance.getEntriesByType('resource').map(e => e.name)")
        return [name for name in names if not name.startswith(("file:", "data:"))]

    def test_dark_as_the_reader_s_system_or_by_the_button(self):
        self.page.prefer("dark")
        self.open("docs/energies.html")
        self.assertLess(self.page.background("body"), 60)
        self.page.prefer("light")
        self.assertGreater(self.page.background("body"), 200)
        self.page.js("document.querySelector('.theme-toggle').click()")
        self.page.settle()
        self.assertLess(self.page.background("body"), 60)
        self.page.js("localStorage.clear()")

    def test_the_tree_has_every_section_of_the_index(self):
        index = (pathlib.Path(__file__).resolve().parents[2] / "docs/index.md").read_text()
        self.open("docs/energies.html")
        shown = self.page.js("return [...document.querySelectorAll('.sidebar-tree .caption-text')].map(e => e.textContent)")
        for heading in re.findall(r"^## (.*)", index, re.M):
            self.assertIn(heading, shown)
        entries = self.page.js("return [...document.querySelectorAll('.sidebar-tree a')].map(e => e.textContent.trim())")
        for entry in re.findall(r"^- \[([^\]]*)\]", index, re.M):
            self.assertIn(entry, entries)

    def test_search_finds_words_and_declarations(self):
        for words, file in [("micronavigation closure rationals", None), ("eigenray turning", "docs/notes/refraction.html"),
                            ("TubeSet", "api/geometry-tubes.html"), ("energy_lower", "api/python.html")]:
            self.open(f"search.html?q={words.replace(' ', '+')}")
            found = self.results()
            if file is None:
                self.assertEqual(found, [])
            else:
                self.assertTrue(any(f"/{file}" in link for link in found), f"{words}: {found}")

    def results(self):
        """Links that a search lists, once it is over."""
        return self.page.driver.execute_async_script("""
            const done = arguments[0], begin = Date.now();
            const look = () => {
              const over = /finished|did not match/.test(document.getElementById("search-results").textContent);
              if (over || Date.now() - begin > 60000)
                done([...document.querySelectorAll("#search-results li a")].map(a => a.href));
              else setTimeout(look, 50);
            };
            look();""")

    def test_a_picture_opens_large_and_closes(self):
        self.open("docs/gallery.html")
        self.page.js("document.querySelectorAll('img.opens')[0].click()")
        self.page.settle()
        state = """const d = document.querySelector('dialog.picture'), i = d.querySelector('img');
                   return [d.open, i.src.split('/').pop(), i.clientWidth, i.clientHeight, d.querySelector('p').textContent]"""
        first = self.page.js(state)
        self.assertTrue(first[0])
        self.assertEqual(first[1], "wellhead-camera-0.png")
        self.assertGreater(first[2], 1100)
        self.assertGreater(first[3], 650)
        self.assertEqual(first[4], "Acoustic camera south of the well head")
        self.page.js("document.querySelector('dialog.picture').dispatchEvent(new KeyboardEvent('keydown', {key: 'ArrowRight'}))")
        self.assertEqual(self.page.js(state)[1], "wellhead-camera-1.png")
        self.page.js("document.querySelector('dialog.picture').click()")
        self.assertFalse(self.page.js(state)[0])

    def test_formulas_are_formulas(self):
        self.open("docs/energies.html")
        fractions = self.page.js("return [...document.querySelectorAll('math mfrac')].map(f => f.getBoundingClientRect().height)")
        self.assertGreaterEqual(len(fractions), 10)
        self.assertGreater(min(fractions), 15)  # set as fractions, not as a line of text
        self.assertEqual(self.page.js("return document.querySelectorAll('article').length && "
                                      "(document.querySelector('article').textContent.match(/\\\\frac|\\$/) || []).length"), 0)

    def test_declarations_lead_to_their_types(self):
        self.open("api/geometry-tubes.html")
        self.page.js("[...document.querySelectorAll('a.type')].find(a => a.textContent === 'GridPoint').click()")
        self.page.settle()
        self.assertTrue(self.page.driver.current_url.endswith("/api/geometry-numbers.html#gridpoint"))
        contents = self.page.js("return [...document.querySelectorAll('.toc-tree a')].map(a => a.textContent)")
        self.assertIn("GridPoint", contents)
        self.assertIn("struct GridPoint", self.page.js("return document.getElementById('gridpoint').textContent"))

    def test_pages_are_no_wider_than_the_window(self):
        for name in ["index.html", "docs/energies.html", "docs/gallery.html", "docs/scene-keys.html", "docs/architecture.html",
                     "api/python.html", "api/src-engine-echo.html", "validation/atlas.html"]:
            for width, height in [(390, 844), (1000, 800), (1100, 800), (1280, 800), (1600, 900)]:
                self.open(name, width, height)
                self.assertLessEqual(self.page.js("return document.documentElement.scrollWidth"), width, name)


class Headers(unittest.TestCase):
    """What pages of headers show of them."""
    TEXT = """#pragma once
namespace tubefoot {

/// Stands alone.

class Forward;
/// Two of one kind; "{" in words.
int first(int a, std::vector<int> of = {});
inline double second(double x) { return x < 0 ? -x : x; }

template <class T>
struct Pair {
  T a{}, b{};  ///< both
  /// The larger.
  T most() const {
    if (a < b) return b;
    return a;
  }
};

/// Keeps.
class Keeper : public Pair<int> {
 public:
  explicit Keeper(int n)  // NOLINT: on purpose
      : n_(n), letter_('{') {}
  bool operator==(const Keeper&) const = default;
  friend bool operator<(const Keeper& a, const Keeper& b) { return a.n_ < b.n_; }

 private:
  int secret() const { return n_; }
  int n_;
};

constexpr std::array<int, 2> table = {1, 2};
using Names = std::vector<std::string>;

}  // namespace tubefoot
"""

    def test_declarations_without_bodies_and_without_what_is_private(self):
        found = list(headers.declared(self.TEXT))
        self.assertEqual([entry.names for entry in found], [[], ["first", "second"], ["Pair"], ["Keeper"], ["table", "Names"]])
        self.assertEqual(found[1].comment, ['Two of one kind; "{" in words.'])
        self.assertEqual(found[1].text, "int first(int a, std::vector<int> of = {});\ninline double second(double x);")
        self.assertEqual(found[2].text, "template <class T>\nstruct Pair {\n  T a{}, b{};  ///< both\n\n"
                                        "  /// The larger.\n  T most() const;\n};")
        self.assertEqual(found[3].text, "class Keeper : public Pair<int> {\n public:\n  explicit Keeper(int n);\n"
                                        "  bool operator==(const Keeper&) const = default;\n"
                                        "  friend bool operator<(const Keeper& a, const Keeper& b);\n};")

    def test_every_type_of_every_header_is_told(self):
        sources, types = BUILD.parents[2], 0
        for area in ("geometry", "src", "sensors"):
            for file in (sources / area).rglob("*.hpp"):
                text = file.read_text()
                told = {name for entry in headers.declared(text) for name in entry.types}
                wanted = set(re.findall(r"^(?:class|struct|enum class) (\w+)[^;(]*\{$", text, re.M))
                self.assertLessEqual(wanted, told, file)
                types += len(wanted)
        self.assertGreater(types, 300)


class WrongSites(unittest.TestCase):
    """A small site with one fault of each kind: the builder names each at its line."""
    PAGES = {
        "README.md": "# Read me\n\nSee [the architecture](docs/architecture.md#modules).\n",
        "docs/site/index.md": "# Front\n\n[All](docs/index.md)\n",
        "docs/index.md": "# Documents\n\n## Learning\n\n- [Read me](../README.md)\n- [Architecture](architecture.md)\n",
        "docs/architecture.md": "# Architecture\n\n## Modules\n\n| module | content | may include |\n|---|---|---|\n"
                         "| `geometry/numbers` | numbers | |\n\n```math\n\\frac{1}{2}\n```\n",
        "geometry/numbers/point.hpp": "namespace tubefoot {\n\n/// A point.\nstruct Point {\n  int x = 0;\n};\n\n}  // namespace tubefoot\n",
        "docs/installation.md": "# Installation\n\n## Your own program\n",
        "docs/examples/own-sonar/main.cpp": "int main() {}\n",
        "python/tubefoot/__init__.py": '"""A module."""\n__all__ = []\n',
    }

    def build(self, changes):
        with tempfile.TemporaryDirectory(prefix="tubefoot-site-") as scratch:
            sources = pathlib.Path(scratch) / "sources"
            pages = dict(self.PAGES, **changes)
            pages["docs/index.md"] += "- [Installation](installation.md)\n"
            for name, text in pages.items():
                (sources / name).parent.mkdir(parents=True, exist_ok=True)
                (sources / name).write_text(text)
            done = subprocess.run([sys.executable, str(BUILD), f"{scratch}/site", str(sources)], capture_output=True, text=True)
            return done.returncode, re.sub(r"\x1b\[[\d;]*m", "", done.stderr)

    def test_a_right_one_is_built(self):
        self.assertEqual(self.build({}), (0, ""))

    def test_each_fault_is_named(self):
        faults = {
            "[a](docs/nowhere.md)": "no such file: docs/nowhere.md",
            "[b](docs/architecture.md#cellar)": "no such heading: docs/architecture.md#cellar",
            "[c](docs)": "a folder, which has no page: docs",
            "![d](docs/nothing.png)": "image file not readable: docs/nothing.png",
            "[e](../outside.md)": "no such file: ../outside.md",
            "```math\n\\nonsense{1}\n```": "a formula that is none",
            "```math\n\\frac{1\n```": "a formula that is none: braces that do not match",
        }
        text, at = "# Read me\n", {}
        for fault, message in faults.items():
            at[message] = text.count("\n") + 2
            text += f"\n{fault}\n"
        status, errors = self.build({"README.md": text, "docs/lost.md": "# Lost\n"})
        self.assertNotEqual(status, 0)
        for message, line in at.items():
            self.assertRegex(errors, rf"README\.md:{line}: .*{re.escape(message)}")
        self.assertRegex(errors, r"lost\.md.*isn't included in any toctree")

    def test_what_would_be_loaded_over_the_network_is_named(self):
        status, errors = self.build({"README.md": '# Read me\n\n<script src="https://example.org/a.js"></script>\n'})
        self.assertNotEqual(status, 0)
        self.assertIn("README.html: loads https://example.org/a.js over the network", errors)


if __name__ == "__main__":
    unittest.main(verbosity=2)
