# SPDX-License-Identifier: BSD-3-Clause
"""Puts together what Sphinx makes the site of: the project's pages as they are, and what is generated.

stage.py <folder to make>

Generated are: the parameters at the end of each filter's page (from the plugin's XML), a page for each example and the
gallery (from Documentation/Examples), the list of C++ classes, the Python package's reference (from its own texts), and the navigation, which follows the headings and links
of the user guide's README. Paths stay as in the project, so that links hold; what is in no list is an error of Sphinx.
"""
import ast
import json
import os
import re
import shutil
import sys

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "Plugins", "Python", "lacuna"))
from proxies import ROOT, read_proxies  # noqa: E402

GUIDE = "Documentation/UserGuide"
EXAMPLES = "Documentation/Examples"
DEVELOPERS = "Documentation/DeveloperGuide"
DECISIONS = f"{DEVELOPERS}/decisions"
BENCHMARKS = "Documentation/Benchmarks"
PACKAGE = "Plugins/Python/lacuna"
PICTURES = (".png", ".jpg", ".svg")
LANGUAGES = {".py": "python", ".cxx": "cpp", ".txt": "cmake", ".sh": "bash"}


def read(path):
    with open(os.path.join(ROOT, path), encoding="utf-8") as file:
        return file.read()


def names(folder, endings):
    return sorted(name for name in os.listdir(os.path.join(ROOT, folder)) if name.endswith(endings))


def toctree(pages, caption="", hidden=True):
    options = (":hidden:\n" if hidden else "") + (f":caption: {caption}\n" if caption else "")
    return "\n```{toctree}\n" + options + "\n" + "\n".join(pages) + "\n```\n"


def plain(text):
    """Help as Markdown: what looks like markup and is none is escaped."""
    text = re.sub(r"(?<!\S)\*(?=\.)", r"\\*", text.replace("<", r"\<"))
    return re.sub(r"^(\d+)([.)])(?=\s)", r"\1\\\2", text, flags=re.MULTILINE)


# Parameters

def definition(each):
    default, values = each.default_text(), each.values_text()
    facts = [f"default **{default}**" if default and default not in ("empty", "none") else f"default {default}" if default else "",
             values, each.group]
    if not each.kind:
        facts = ["button"]
    elif each.kind == "Input":
        facts = ["input", "optional" if each.optional else ""]
    if each.information:
        facts = ["to read"]
    help_lines = plain(each.help).replace("\n", "\n  ")
    return f"`{each.name}`\n: {' · '.join(filter(None, facts)) or 'text'}\n\n  {help_lines}\n"


def parameters(proxy):
    groups = {"In the panel": [], "Advanced": [], "Set by ParaView's menus": [], "Results to read": []}
    for each in proxy.properties:
        if each.name != "TimestepValues":
            groups["Results to read" if each.information else "Set by ParaView's menus" if each.hidden else
                   "Advanced" if each.advanced else "In the panel"].append(definition(each))
    files = f" Files: {', '.join('.' + extension for extension in proxy.extensions.split())}." if proxy.extensions else ""
    python = f"In Python `{proxy.constructor}()`" if proxy.kind != "writer" else "In Python `SaveData(...)` with these names"
    text = (f"\n## All parameters of {proxy.label}\n{python}, in C++ "
            f'<a href="../../cpp/class{proxy.cls}.html"><code>{proxy.cls}</code></a>.{files} This list is made from the plugin itself.\n')
    for title, members in groups.items():
        if members:
            text += f"\n### {title}\n" + "\n".join(members)
    return text


# Examples

def captions():
    """Picture under Documentation/Examples: what the user guide's pages call it, and on which page."""
    found = {}
    for page in names(GUIDE, ".md"):
        for caption, path in re.findall(r"!\[([^\]]*)\]\(\.\./Examples/([^)\s]+)\)", read(f"{GUIDE}/{page}")):
            found.setdefault(path, (caption, page))
    return found


def page_of(path):
    """Title of a page."""
    return re.search(r"^# +(.*)$", read(path), re.MULTILINE).group(1)


def guide_pages(topic):
    """Pages of the user guide that speak of an example."""
    return [page for page in names(GUIDE, ".md") if f"../Examples/{topic}/" in read(f"{GUIDE}/{page}")]


def main_script(topic):
    """The script whose name is most like the folder's."""
    def likeness(name):
        return len(os.path.commonprefix([topic[3:].replace("-", "_"), name.replace("-", "_")]))
    return max(names(f"{EXAMPLES}/{topic}", ".py"), key=likeness)


class Example:
    """A folder NN-topic: README.md or the script's text says what it is about; pictures; scripts."""

    def __init__(self, topic, called):
        folder = f"{EXAMPLES}/{topic}"
        self.topic, self.pictures = topic, names(folder, PICTURES)
        others = [name for name in names(folder, ".md") if name != "README.md"]
        if os.path.exists(os.path.join(ROOT, folder, "README.md")):
            _, self.title, self.text = re.split(r"^# +(.*)\n", read(f"{folder}/README.md"), maxsplit=1, flags=re.MULTILINE)
        else:
            self.title = re.sub(r"\b(\d)d\b", r"\1-D", topic[3:].replace("-", " ").capitalize())
            self.text = plain(ast.get_docstring(ast.parse(read(f"{folder}/{main_script(topic)}")))) + "\n"
        self.text += "".join("\n" + read(f"{folder}/{name}") for name in others)
        self.text = re.sub(r"\]\((\.\./\d\d-[^/)]+)/README\.md\)", r"](\1/index.md)", self.text)
        self.captions = {name: called.get(f"{topic}/{name}", (os.path.splitext(name)[0], ""))[0] for name in self.pictures}
        self.guides = guide_pages(topic)
        if not self.pictures:  # its pictures are the guide's
            self.pictures = [path for page in self.guides for path in re.findall(r"\]\((pictures/[^)\s]+)\)", read(f"{GUIDE}/{page}"))
                             if os.path.basename(path) in self.text]
            self.pictures = [f"../../UserGuide/{path}" for path in self.pictures]

    def page(self):
        text = f"# {self.title}\n\n{self.text}\n"
        if self.guides:
            text += "Explained in " + ", ".join(f"[{page_of(f'{GUIDE}/{page}')}](../../UserGuide/{page})" for page in self.guides) + ".\n\n"
        for name in self.pictures:
            if f"]({name})" not in text:
                caption = self.captions.get(name, "")
                text += f":::{{figure}} {name}\n:alt: {json.dumps(caption or os.path.basename(name), ensure_ascii=False)}\n\n{caption}\n:::\n\n"
        for name in names(f"{EXAMPLES}/{self.topic}", tuple(LANGUAGES) + (".pvsm",)):
            text += f"## {name}\n[Download]({name})\n\n"
            if not name.endswith(".pvsm"):
                text += f"```{{literalinclude}} {name}\n:language: {LANGUAGES[os.path.splitext(name)[1]]}\n```\n\n"
        return text

    def card(self):
        first = " ".join(re.sub(r"^#.*|!\[.*?\]\(.*?\)", "", self.text).strip().split("\n\n")[0].split())
        first = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", first)  # its links lead on from the example's folder
        shown = re.findall(r"!\[[^\]]*\]\(([^)\s]+)\)", self.text) or self.pictures[len(self.pictures) // 2:]
        picture = f"{self.topic}/{shown[0]}" if shown else ""
        image = f"[![{self.title}]({os.path.normpath(picture)})]({self.topic}/index.md)\n\n" if picture else ""
        return f":::{{container}} card\n{image}**[{self.title}]({self.topic}/index.md)**\n\n{first}\n:::\n"


# The whole

def navigation():
    """Captions and pages of the user guide, in the order of its README."""
    sections, caption, seen = [], "", {"README.md"}
    for line in read(f"{GUIDE}/README.md").splitlines():
        if line.startswith("#"):
            caption = line.lstrip("# ")
        for page in re.findall(r"^\| *\[.*?\]\(([\w-]+\.md)\)", line):
            if page not in seen:
                seen.add(page)
                if not sections or sections[-1][0] != caption:
                    sections.append((caption, []))
                sections[-1][1].append(f"{GUIDE}/{page}")
    return sections


def classes(proxies):
    rows = "".join(f'<a href="../../cpp/class{proxy.cls}.html"><code>{proxy.cls}</code></a>\n: {proxy.label}\n\n  {proxy.short_help}\n\n'
                   for proxy in proxies)
    return ("# C++ reference\n\nThe classes behind the plugin, usable with VTK alone ([how](architecture.md)). "
            'All headers, also those of the kernels: <a href="../../cpp/annotated.html">classes</a>, '
            '<a href="../../cpp/files.html">files</a>.\n\n' + rows)


def signature(function):
    """Arguments of a function as one writes them."""
    text = ast.unparse(function.args)
    return f"{function.name}({text})" if len(text) < 100 else f"{function.name}({text[:text.rfind(',', 0, 100)]}, …)"


def python_reference():
    """Every module of the Python package with its public functions and classes, from their own texts."""
    text = ("# Python reference\n\nThe package `lacuna`, beside the classes `vtkLacuna…` that it contains ([C++ reference](classes.md)): "
            "helpers for scripts. How to use it: [Scripts](../UserGuide/scripts.md). `help(lacuna.views)` says the same.\n")
    for name in names(PACKAGE, ".py"):
        tree = ast.parse(read(f"{PACKAGE}/{name}"))
        if name.startswith("demo"):  # a program
            continue
        text += f"\n## lacuna.{name[:-3]}\n\n```\n{ast.get_docstring(tree)}\n```\n"
        for each in tree.body:
            if isinstance(each, (ast.FunctionDef, ast.ClassDef)) and not each.name.startswith("_"):
                title = signature(each) if isinstance(each, ast.FunctionDef) else f"class {each.name}"
                text += f"\n`{title}`\n\n```\n{ast.get_docstring(each) or ''}\n```\n"
        constants = [each.targets[0].id for each in tree.body if isinstance(each, ast.Assign) and isinstance(each.targets[0], ast.Name)
                     and each.targets[0].id.isupper()]
        if constants:
            text += "\nConstants: " + ", ".join(f"`{constant}`" for constant in constants) + "\n"
    return text


def stage(target):
    pages = {"index.md": read("README.md"), "CHANGELOG.md": read("CHANGELOG.md"), "CONTRIBUTING.md": read("CONTRIBUTING.md")}
    for folder in (GUIDE, DEVELOPERS, DECISIONS, BENCHMARKS):
        pages.update({f"{folder}/{name}": read(f"{folder}/{name}") for name in names(folder, ".md")})
    proxies = read_proxies()
    for proxy in proxies:
        if f"{GUIDE}/{proxy.page}.md" in pages:
            pages[f"{GUIDE}/{proxy.page}.md"] += parameters(proxy)
    pages[f"{DEVELOPERS}/classes.md"] = classes(proxies)
    pages[f"{DEVELOPERS}/python.md"] = python_reference()

    called = captions()
    examples = [Example(topic, called) for topic in sorted(os.listdir(os.path.join(ROOT, EXAMPLES))) if os.path.isdir(os.path.join(ROOT, EXAMPLES, topic))]
    # Its gallery, which shows on the project's page, is made anew
    pages[f"{EXAMPLES}/index.md"] = read(f"{EXAMPLES}/README.md").split("\n## Gallery\n")[0] + "\n"
    pages[f"{EXAMPLES}/index.md"] += ("\n::::{container} gallery\n" + "".join(example.card() for example in examples) + "::::\n" +
                                      toctree([f"{example.topic}/index" for example in examples]))
    pages.update({f"{EXAMPLES}/{example.topic}/index.md": example.page() for example in examples})

    sections = navigation()
    pages["index.md"] += toctree([f"{GUIDE}/README", f"{EXAMPLES}/index"])
    pages["index.md"] += "".join(toctree(paths, caption) for caption, paths in sections)
    pages["index.md"] += toctree([f"{folder}/{name}" for folder in (DEVELOPERS, DECISIONS, BENCHMARKS) for name in names(folder, ".md")] +
                                 [f"{DEVELOPERS}/classes", f"{DEVELOPERS}/python", "CONTRIBUTING", "CHANGELOG"], "Development")

    shutil.rmtree(target, ignore_errors=True)
    shutil.copytree(os.path.join(ROOT, "Documentation"), os.path.join(target, "Documentation"), ignore=shutil.ignore_patterns("*.md", "Site", "__pycache__"))
    for path, text in pages.items():
        for link in re.findall(r"\]\(([\w/.-]+)\)", text):  # to other files of the project
            linked = os.path.normpath(os.path.join(os.path.dirname(path), link))
            if not linked.startswith("Documentation") and not linked.endswith(".md"):
                os.makedirs(os.path.dirname(os.path.join(target, linked)), exist_ok=True)
                shutil.copy(os.path.join(ROOT, linked), os.path.join(target, linked))
        if not path.startswith(EXAMPLES):  # a script's page shows it
            text = re.sub(r"(\]\([./\w]*Examples/(?:[\w-]+/)?)[\w.-]+\.(py|md|cxx)\)", r"\1index.md)", text)
        text = re.sub(r"(\]\((\.\./)*)README\.md\)", lambda match: match.group(0) if path.startswith(GUIDE) and "../" not in match.group(0) else match.group(1) + "index.md)", text)
        text = re.sub(r"^(\| *name *\| *default *\|.*\n(?:\|.*\n)+)", r":::{container} properties\n\1:::\n", text, flags=re.MULTILINE)
        os.makedirs(os.path.dirname(os.path.join(target, path)), exist_ok=True)
        with open(os.path.join(target, path), "w", encoding="utf-8") as file:
            file.write(text)


if __name__ == "__main__":
    stage(sys.argv[1])
