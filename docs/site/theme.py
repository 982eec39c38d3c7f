# SPDX-License-Identifier: GPL-3.0-or-later
"""Furo as Debian has it, made whole for pages that are opened as files.

Debian's links to a style sheet and to a script of other packages, by addresses that a web server with Debian's paths
would have, and has lost its dark colours for readers whose system is set to dark.
"""
import pathlib
import re

NORMALIZE = pathlib.Path("/usr/share/javascript/normalize.css/normalize.css")


def make_whole(app, exception):
    if exception:
        return
    static = pathlib.Path(app.outdir) / "_static"
    style, script, spy = (static / name for name in ("styles/furo.css", "scripts/furo.js", "scripts/gumshoe-patched.js"))
    css = re.sub(r"@import url\(/javascript/normalize[^)]*\);", lambda _: NORMALIZE.read_text(), style.read_text())
    dark = re.search(r'body\[data-theme="dark"\] \{([^}]*)\}', css)
    if dark and "prefers-color-scheme" not in css:
        css += f'@media screen and (prefers-color-scheme: dark) {{ body:not([data-theme="light"]) {{{dark[1]}}} }}\n'
    style.write_text(css)
    imported, own = re.subn(r"^import Gumshoe from .*\n", "", script.read_text())
    if own:
        script.write_text(spy.read_text() + imported)


def setup(app):
    app.connect("build-finished", make_whole)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
