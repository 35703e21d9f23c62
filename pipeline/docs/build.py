#!/usr/bin/python3
"""The documentation as pages without scripts or network: pipeline/docs/build.py -o FOLDER [--palpate PROGRAM]

Every README.md and RESULTS.md, the pages of this folder, CHANGELOG.md, and the help of each command. Links to other
files of the sources lead to copies of them. It ends with code 1 where a link leads nowhere. Two of Debian's programs are
optional: blahtexml sets equations (else they stay in TeX), doxygen describes the headers (else their pages are left out).
"""

import argparse
import html
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from markdown_it import MarkdownIt

root = Path(__file__).resolve().parents[2]
pages = Path("pipeline/docs")  # of this folder
libraries = ("mesh", "fem", "skeleton", "identify")  # whose headers are installed
style = """:root{color-scheme:light dark}body{font:16px/1.55 system-ui,sans-serif;max-width:62em;margin:0 auto;padding:0 1em 4em}nav{padding:1em 0;border-bottom:1px solid #8886}
nav a{margin-right:1em;white-space:nowrap}pre{overflow-x:auto;background:#8882;padding:.8em;border-radius:6px}code{font-size:.92em}pre:has(.language-text){white-space:pre-wrap}img{max-width:100%;height:auto}
.wide{overflow-x:auto}.equation{margin:1em 0;overflow-y:hidden}math{font-size:1.12em}table{border-collapse:collapse}th,td{border-bottom:1px solid #8885;padding:.3em .7em;text-align:left;vertical-align:top}
a{color:#0b57d0}@media(prefers-color-scheme:dark){body{background:#15171a;color:#e4e6e8}a{color:#8ab4f8}}"""
top = {"Start": "pipeline/docs/start.md", "Overview": "README.md", "Your data": "pipeline/docs/measurements.md", "Planning": "pipeline/docs/planning.md",
       "Gallery": "pipeline/docs/gallery.md", "Verdicts": "pipeline/docs/verdict.md", "Messages": "pipeline/docs/troubleshooting.md",
       "Commands": "pipeline/docs/commands.md", "Theory": "pipeline/docs/theory.md", "Runtime": "skeleton/runtime/README.md",
       "Python": "pipeline/python/README.md", "C++": "samples/consumer/README.md", "Challenge": "samples/challenge/README.md", "Changes": "CHANGELOG.md"}


def anchor(heading):
    """As the hosts of repositories make them."""
    return re.sub(r"[^\w\- ]", "", re.sub(r"<[^>]*>", "", heading).lower()).strip().replace(" ", "-")


def commands(palpate):
    """Every command's help, as the program gives it."""
    told = lambda *words: subprocess.run([palpate, *words, "--help"], capture_output=True, text=True, check=True).stdout
    overview = told()
    listed = re.findall(r"^  ([a-z]+) ", overview.split("Subcommands:")[1], re.M)
    return "# Commands\n\n```\n" + overview + "```\n" + "".join(f"\n## palpate {c}\n\n```\n{told(c)}```\n" for c in listed)


def equation(tex):
    """As MathML, which browsers set without scripts."""
    if not shutil.which("blahtexml"):
        return f"<pre><code>{html.escape(tex)}</code></pre>"
    told = subprocess.run(["blahtexml", "--mathml"], input="\\displaystyle " + tex, capture_output=True, text=True, check=True).stdout
    markup = re.search(r"<markup>\s*(.*?)\s*</markup>", told, re.S)
    if not markup:
        raise SystemExit(f"an equation is not understood: {tex}{told}")
    set_ = re.sub(r"(<mo[^>]*>)-</mo>", r"\1−</mo>", markup[1])
    return f'<div class="wide equation"><math display="block">{set_}</math></div>'


def headers(output):
    """What Doxygen makes of the headers that are installed; False without it. Without scripts: neither menus nor a search."""
    if not shutil.which("doxygen"):
        return False
    output.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        return run_doxygen(output, Path(folder))


def run_doxygen(output, own):
    """Pages in output; own: a folder for what only Doxygen reads."""
    (own / "more.css").write_text(
        "@media(prefers-color-scheme:dark){html{background:#fff;filter:invert(.88) hue-rotate(180deg)}}\n"
        "@media(max-width:50em){.memberdecls td{display:block;text-align:left;white-space:normal!important}.contents{overflow-x:auto}}\n")
    first = own / "first.md"
    first.write_text((root / "samples/consumer/README.md").read_text() + '\n<a href="../pipeline/docs/start.html">The other pages</a>\n')
    settings = {
        "PROJECT_NAME": "Palpate", "OUTPUT_DIRECTORY": output, "HTML_OUTPUT": ".", "INPUT": " ".join(map(str, [*(root / f for f in libraries), first])),
        "USE_MDFILE_AS_MAINPAGE": first,
        "FILE_PATTERNS": "*.h", "RECURSIVE": "YES", "EXTRACT_ALL": "YES", "STRIP_FROM_PATH": root, "STRIP_FROM_INC_PATH": root,
        "FULL_PATH_NAMES": "YES", "JAVADOC_AUTOBRIEF": "YES", "HIDE_UNDOC_RELATIONS": "YES", "GENERATE_LATEX": "NO", "SEARCHENGINE": "NO",
        "HTML_DYNAMIC_MENUS": "NO", "HTML_EXTRA_STYLESHEET": own / "more.css", "SOURCE_BROWSER": "NO", "VERBATIM_HEADERS": "NO",
        "HAVE_DOT": "NO", "CLASS_GRAPH": "NO", "QUIET": "YES", "WARNINGS": "NO", "WARN_IF_DOC_ERROR": "NO", "WARN_IF_INCOMPLETE_DOC": "NO", "HTML_TIMESTAMP": "NO"}
    subprocess.run(["doxygen", "-"], input="".join(f"{k} = {v}\n" for k, v in settings.items()), text=True, check=True)
    return True


def page(source, text, where):
    """The page of a text; where: its path in the site."""
    body = MarkdownIt("commonmark", {"html": True}).enable("table").render(text)
    body = re.sub(r'<pre><code class="language-math">(.*?)</code></pre>', lambda m: equation(html.unescape(m[1])), body, flags=re.S)
    body = re.sub(r"<h([1-4])>(.*?)</h\1>", lambda m: f'<h{m[1]} id="{anchor(m[2])}">{m[2]}</h{m[1]}>', body)
    body = body.replace("<table>", '<div class="wide"><table>').replace("</table>", "</table></div>")
    wanted = []

    def leads(match):
        attribute, target = match[1], html.unescape(match[2])
        if re.match(r"[a-z]+:", target):
            return match[0]
        path, _, place = target.partition("#")
        path = os.path.normpath(source.parent / path) if path else str(source)
        if (root / path).is_dir():
            path = f"{path}/README.md" if (root / path / "README.md").exists() else path
        wanted.append((path, place))
        there = os.path.relpath(re.sub(r"\.md$", ".html", path), where.parent)
        return f'{attribute}="{html.escape(there + ("#" + place if place else ""))}"'

    body = re.sub(r'(href|src)="([^"]*)"', leads, body)
    title = re.search(r"^# (.*)", text, re.M)
    bar = " ".join(f'<a href="{os.path.relpath(re.sub("md$", "html", t), where.parent)}">{n}</a>' for n, t in top.items())
    return (f'<!doctype html><html lang="en"><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">'
            f"<title>{html.escape(title[1] if title else 'Palpate')}</title><style>{style}</style><nav>{bar}</nav>{body}</html>\n"), wanted


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--output", type=Path, required=True)
    parser.add_argument("--without-headers", action="store_true", help="leave Doxygen's pages out, which take half a minute")
    parser.add_argument("--palpate", default=str(root / "build" / "palpate"))
    told = parser.parse_args()
    skipped = ("build", ".git", "runs")
    files = [p.relative_to(root) for name in ("README.md", "RESULTS.md", "CHANGELOG.md") for p in root.rglob(name)]
    files = [p for p in files + [pages / f.name for f in (root / pages).glob("*.md")] if not p.parts[0].startswith(skipped)]
    texts = {path: (root / path).read_text() for path in files} | {pages / "commands.md": commands(told.palpate)}
    headings = {str(p): {anchor(h) for h in re.findall(r"^#+ (.*)", t, re.M)} for p, t in texts.items()}
    lost = []
    if not told.without_headers and headers(told.output / "headers"):
        top["Headers"] = "headers/index.html"
    elif not told.without_headers:
        print("doxygen is not installed: the pages of the headers are left out")
    if not shutil.which("blahtexml"):
        print("blahtexml is not installed: equations stay in TeX")
    for source, text in texts.items():
        out = told.output / source.with_suffix(".html")
        out.parent.mkdir(parents=True, exist_ok=True)
        content, wanted = page(source, text, source)
        out.write_text(content)
        for path, place in wanted:
            if path in headings:
                if place and place not in headings[path]:
                    lost.append(f"{source}: '{path}' has no heading '{place}'")
            elif (root / path).is_file():
                (told.output / path).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(root / path, told.output / path)
            elif (root / path).is_dir():
                (told.output / path).mkdir(parents=True, exist_ok=True)
                names = sorted(p.name for p in (root / path).iterdir())
                (told.output / path / "index.html").write_text("<!doctype html><pre>" + html.escape("\n".join(names)) + "</pre>\n")
            else:
                lost.append(f"{source}: there is no '{path}'")
    print("\n".join(lost) or f"{len(texts)} pages: {told.output / pages}/start.html", file=sys.stderr if lost else sys.stdout)
    return 1 if lost else 0


if __name__ == "__main__":
    sys.exit(main())
