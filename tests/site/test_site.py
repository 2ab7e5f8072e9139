#!/usr/bin/env python3
"""The documents as a site (tools/site): built without a warning, whole, and the same without a network.

test_site.py PROGRAM SOURCE_FOLDER     exit status 77 where MkDocs is missing
"""
import html.parser
import pathlib
import re
import subprocess
import sys
import tempfile
import time
import urllib.parse

program, source = sys.argv[1], pathlib.Path(sys.argv[2])
sys.dont_write_bytecode = True
sys.path.insert(0, str(source / "tests/page"))
import browser  # noqa: E402

if not pathlib.Path("/usr/bin/mkdocs").exists() or not pathlib.Path("/usr/share/javascript/katex").exists():
    print("MkDocs or KaTeX is missing (tools/install --tests)")
    sys.exit(77)


class Page(html.parser.HTMLParser):
    """The links and anchors of a page."""

    def __init__(self, text):
        super().__init__()
        self.links, self.places, self.equations = [], {""}, 0
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        given = dict(attributes)
        self.places.add(given.get("id", ""))
        self.equations += "arithmatex" in (given.get("class") or "")
        for name in ("href", "src"):
            if given.get(name):
                self.links.append((tag, given[name]))


def check(condition, text):
    if not condition:
        sys.exit(text)


with tempfile.TemporaryDirectory() as folder:
    subprocess.run([source / "tools/site", "--into", folder, program], check=True)
    site = pathlib.Path(folder, "site")
    pages = {path: Page(path.read_text(encoding="utf-8")) for path in site.rglob("*.html")}
    local = 0
    for path, page in pages.items():
        if path.name == "404.html":  # its links are those of a server
            continue
        for tag, link in page.links:
            to = urllib.parse.urlsplit(link)
            if to.scheme in ("http", "https", "mailto"):
                check(tag == "a" or link.startswith("mailto"), f"{path.name} fetches {link}")
                continue
            target = (path.parent / urllib.parse.unquote(to.path)).resolve() if to.path else path
            check(target.exists(), f"{path.name} links {link}")
            if to.fragment and target in pages and not to.fragment.startswith("__"):
                check(urllib.parse.unquote(to.fragment) in pages[target].places, f"{path.name} links {link}")
            local += 1
    pictures = sum(tag == "img" for page in pages.values() for tag, _ in page.links)
    examples = sum(tag == "img" for tag, link in pages[site / "gallery.html"].links)
    equations = sum(page.equations for page in pages.values())
    print(f"{len(pages)} pages, {local} links, {pictures} pictures, {examples} of the gallery, {equations} equations")
    check(len(pages) >= 35 and local > 2000 and examples >= 12 and equations >= 12, "too little on the site")
    commands = (site / "commands.html").read_text(encoding="utf-8")
    for verb in ("trace", "torque-map", "diagnose", "estimate"):
        check(f'id="{verb}"' in commands, f"commands.html has no {verb}")

    if not browser.program():
        print("no Chromium: not looked at in a browser")
        sys.exit(0)
    with browser.Browser(1280, 900) as looked:
        for name in ("index", "physics", "photovoltaic", "tutorials/torque"):
            looked.errors.clear(), looked.requests.clear()
            looked.call("Page.navigate", url=(site / f"{name}.html").as_uri())
            until = time.monotonic() + 60
            while looked.value("document.readyState") != "complete" or not looked.value("location.href").startswith("file"):
                check(time.monotonic() < until, f"{name} does not load")
                time.sleep(0.05)
            looked.settle()
            # From a disk browsers refuse the theme's search its index; pictures and equations are looked at below.
            outside = [url for url in looked.requests if not url.startswith(("file:", "data:", "blob:"))]
            check(not outside, f"{name} asks for {outside}")
            errors = [e for e in looked.errors if not re.search("search_index|ERR_FAILED|Failed to fetch", str(e))]
            check(not errors, f"{name}: {errors}")
            wanted = pages[site / f"{name}.html"].equations
            set_ = looked.value("document.querySelectorAll('.arithmatex .katex-display').length")
            check(set_ == wanted, f"{name}: {set_} of {wanted} equations are set")
            broken = looked.value("[...document.images].filter(i => i.complete && !i.naturalWidth).map(i => i.src)")
            check(not broken, f"{name}: no picture {broken}")
