#!/usr/bin/python3
"""The pages of scripts/site.

stage WORK        write WORK/docs and WORK/mkdocs.yml: README.md and all that links lead to.
                  WORK/tags has the names of the class reference.
finish WORK SITE  let the search find each parameter by its name, and load MathJax in pages with formulas.
check SITE        list the links of SITE that lead nowhere, and what it loads from other servers.
"""
import html
import json
import os
import re
import shutil
import subprocess
import sys
import xml.etree.ElementTree as xml
from pathlib import Path
from urllib.parse import unquote

ROOT = Path(__file__).resolve().parent.parent
# Other files are copied as NAME.txt, which browsers show.
COPIED = (".md", ".png", ".gif", ".svg", ".csv", ".ipynb")
INDICES = ("README.md", "doc/user/index.md", "doc/gallery/index.md", "doc/results/index.md", "doc/developer/index.md")
TABS = {"Guide": ("doc/user/",), "Gallery": ("doc/gallery/", "examples/"), "Parameters": ("doc/simulation_parameters.md", "doc/parameters.md"),
        "Results": ("doc/results/", "doc/performance.md"), "Developers": ("doc/developer/", "CONTRIBUTING.md", "doc/step-greville/")}


class Stage:
    def __init__(self, work):
        self.work, self.pages, self.parameters = work, [], []
        # Headers and pages of the class reference.
        self.classes = {str(path.relative_to(ROOT)): page[1] + ".html" for path in ROOT.glob("doc/**/*.dox")
                        for page in [re.search(r"@page (\w+)", path.read_text())] if page}
        for file in xml.parse(work / "tags").iterfind("compound[@kind='file']"):
            name = file.findtext("path") + file.findtext("name")
            if name.endswith(".h"):
                self.classes[os.path.relpath(name, ROOT)] = file.findtext("filename").removesuffix(".html") + "_source.html"

    def link(self, page, target):
        """Return the target of a link in the site, and stage it."""
        folder = os.path.dirname(page)
        name = os.path.normpath(os.path.join(folder, target))
        if name in self.classes:
            return os.path.relpath(f"classes/{self.classes[name]}", folder or ".")
        if (ROOT / name).is_dir():
            target, name = f"{target.rstrip('/')}/contents.md", f"{name}/contents.md"
        elif not name.endswith(COPIED):
            target += ".txt"
        if name.endswith(".md"):
            self.pages += [name] if name not in self.pages else []
        else:
            path = self.work / "docs" / (name if name.endswith(COPIED) else name + ".txt")
            path.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / name, path)
        return target

    def convert(self, page):
        path = ROOT / page
        if path.name == "contents.md":
            text = f"# Files of {os.path.dirname(page)}\n\n" + "".join(f"- [{p.name}]({p.name})\n" for p in sorted(path.parent.iterdir()) if p.is_file())
        else:
            text = path.read_text()
        if page == "doc/gallery/index.md":
            text = gallery(text)
        if page in TABS["Parameters"]:
            text = re.sub(r"^## (.*)|^\| (?!parameter |---)(.*?) \|(.*\|)? (.*) \|$", lambda match: self.parameter(page, match), text, flags=re.M)
        text = re.sub(r"^```.*?^```$|`+[^`]+`+|\]\((?!\w+:)([^)#\s]+)", lambda match: self.replace(page, match), text, flags=re.M | re.S)
        path = self.work / "docs" / page
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)

    def replace(self, page, match):
        if match[1]:
            return "](" + self.link(page, match[1])
        if match[0].startswith("```"):
            return diagram(match[0]) if match[0].startswith("```mermaid") else match[0]
        return match[0].replace(r"\|", "|")

    def parameter(self, page, match):
        """Give a row of a table an anchor, and an entry of the search."""
        if match[1]:
            self.section = match[1]
            return match[0]
        anchor = re.sub(r"\W+", "-", f"{self.section}/{match[2]}".lower())
        self.parameters.append({"location": f"{page[:-3]}.html#{anchor}", "title": match[2], "text": html.escape(f"{self.section}: {match[4]}")})
        return match[0].replace("| ", f'| <a id="{anchor}"></a>', 1)

    def write(self):
        for index in INDICES:
            self.pages.append(index)
            # The order of the pages is that of the rows in their index.
            for target in re.findall(r"^\| \[[^]]*\]\(([^)#]+)\)", (ROOT / index).read_text(), re.M):
                self.link(index, target)
        for page in self.pages:  # which grows
            self.convert(page)
        pages = [page for page in self.pages if not page.endswith("/contents.md")]
        nav = [{tab: [page for page in pages if page.startswith(prefixes)]} for tab, prefixes in TABS.items()]
        nav.insert(0, {"Home": [page for page in pages if not page.startswith(sum(TABS.values(), ()))]})
        nav.append({"Classes": "classes/index.html"})
        (self.work / "parameters.json").write_text(json.dumps(self.parameters))
        (self.work / "mkdocs.yml").write_text((ROOT / "doc/site/mkdocs.yml").read_text() + f"nav: {json.dumps(nav)}\n")


def gallery(text):
    """Replace the table of contents by the pictures, those of examples first, each with its name and time."""
    pictures = dict(re.findall(r"^!\[([^]]*)\]\(([^)]*)\)", text, re.M))
    begin = text.index("| benchmark |")
    end = text.index("\n\n", begin)
    cells = [f"[![]({pictures[name]}){{loading=lazy}}<br>{name}]({target}), {time}\n\n"
             for name, target, time in re.findall(r"^\| \[(.*?)\]\((\S*?)\) \| (.*?) \|$", text[begin:end], re.M)]
    cells.sort(key=lambda cell: "/examples/" not in cell)
    return text[:begin] + '<div class="gallery" markdown>\n' + "".join(cells) + "</div>" + text[end:]


def diagram(block):
    """Draw the arrows of a Mermaid block."""
    dot = "digraph { node [shape=box, style=rounded, fontname=sans];" + ";".join(re.findall(r"\w+ --> \w+", block)).replace("-->", "->") + "}"
    svg = subprocess.run(["dot", "-Tsvg"], input=dot, text=True, capture_output=True, check=True).stdout
    return f'<div class="diagram">{svg[svg.index("<svg"):]}</div>'


def finish(work, site):
    path = site / "search/search_index.json"
    search = json.loads(path.read_text())
    search["docs"] += json.loads((work / "parameters.json").read_text())
    path.write_text(json.dumps(search))
    for path in site.rglob("*.html"):
        text = path.read_text()
        if 'class="arithmatex"' in text:
            script = f'<script async src="{os.path.relpath(site, path.parent)}/mathjax/MathJax.js?config=TeX-AMS_HTML"></script>'
            path.write_text(text.replace("</body>", script + "</body>"))


def check(site):
    pages = {path: path.read_text() for path in sorted(site.rglob("*.html"))}
    anchors = {path: {html.unescape(name) for name in re.findall(r'\b(?:id|name)="([^"]+)"', text)} for path, text in pages.items()}
    n_links, wrong = 0, set()
    for path, text in pages.items():
        # Doxygen checks its own links, and makes some anchors that no page has.
        if path.parent.name == "classes" and path.name != "index.html":
            continue
        for kind, target in re.findall(r'\b(href|src)="([^"]+)"', text):
            n_links += 1
            file, _, anchor = unquote(html.unescape(target)).partition("#")
            if re.match(r"[a-z]+:|//", file):
                if kind == "src" and not file.startswith(("data:", "javascript:")):
                    wrong.add((path, target))
                continue
            # The page of errors knows the root only.
            file = file.split("?")[0]
            to = site / file[1:] if file.startswith("/") else Path(os.path.normpath(path.parent / file)) if file else path
            if not to.is_file() or (anchor and anchor not in anchors.get(to, [anchor])):
                wrong.add((path, target))
    for path, target in sorted(wrong):
        print(f"{path.relative_to(site)}: the link {target} leads nowhere, or loads from another server")
    print(f"{len(pages)} pages, {n_links} links, {len(wrong)} wrong")
    return 1 if wrong or not n_links else 0


folders = [Path(name) for name in sys.argv[2:]]
if sys.argv[1] == "stage":
    Stage(*folders).write()
elif sys.argv[1] == "finish":
    finish(*folders)
else:
    sys.exit(check(*folders))
