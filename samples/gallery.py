#!/usr/bin/env python3
"""Runs all samples that write a page, and writes one that links them: python3 samples/gallery.py

Each page's title is its own; its sentence is the first line of its sample. Exits with 1 if a sample fails.
"""
import html
import pathlib
import re
import subprocess
import sys

SAMPLES = pathlib.Path(__file__).resolve().parent
OUT = SAMPLES / "out"
PAGE = """<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<title>physics: samples</title>
<link rel="icon" href="data:,">
<style>
{style}
body {{ display: block; max-width: 68rem; margin: 0 auto; padding-block: 2rem; }}
header {{ display: block; margin-bottom: 1.4rem; }}
ul {{ display: grid; grid-template-columns: repeat(auto-fill, minmax(18rem, 1fr)); gap: .8rem; padding: 0; list-style: none; }}
li a {{
    display: block; height: 100%; padding: .9rem 1.1rem; border-radius: 12px; color: inherit; text-decoration: none;
    background: var(--panel); box-shadow: 0 0 0 1px var(--line);
}}
li a:hover {{ background: var(--hover); }}
h2 {{ font-size: 1rem; font-weight: 600; color: var(--accent); }}
li p {{ margin: .25rem 0 .5rem; }}
li small {{ color: var(--faint); }}
</style>
</head>
<body>
<header>
    <h1>Samples</h1>
    <p id="subtitle">Each page plays what its program recorded. The commands build and run the programs.</p>
</header>
<ul>
{items}
</ul>
</body>
</html>
"""
ITEM = """<li><a href="{page}">
    <h2>{title}</h2>
    <p>{sentence}</p>
    <small class="code">bash samples/run {name}</small>
</a></li>"""


def page_of(source):
    """The page that a sample writes, by its source; None if it writes none."""
    found = re.search(r'"samples/out/(\w+\.html)"', source.read_text(encoding="utf-8"))
    return found and found.group(1)


def main():
    items, failed = [], []
    for source in sorted(SAMPLES.glob("*.cpp")):
        page = page_of(source)
        if not page:
            continue
        print(f"== {source.stem}", flush=True)
        if subprocess.run(["bash", SAMPLES / "run", source.stem]).returncode:
            failed.append(source.stem)
        if not (OUT / page).is_file():
            continue
        title = re.search("<title>(.*?)</title>", (OUT / page).read_text(encoding="utf-8")).group(1)
        sentence = source.read_text(encoding="utf-8").splitlines()[0].removeprefix("// ")
        items.append(ITEM.format(page=page, title=title, sentence=html.escape(sentence, quote=False), name=source.stem))
    style = (SAMPLES / "player/player.css").read_text(encoding="utf-8")
    (OUT / "gallery.html").write_text(PAGE.format(style=style, items="\n".join(items)), encoding="utf-8")
    print(f"\n{OUT.parent.name}/out/gallery.html links {len(items)} pages")
    if failed:
        print(f"failed: {', '.join(failed)}", file=sys.stderr)
    return bool(failed)


if __name__ == "__main__":
    sys.exit(main())
