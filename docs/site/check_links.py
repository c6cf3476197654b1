"""Checks a built site: check_links.py HTML. Every link, script, style and picture is a file of the site, every anchor is there,
and nothing but links of the text leads out of it."""
import html.parser
import os
import pathlib
import re
import sys
import urllib.parse


class Page(html.parser.HTMLParser):
    def __init__(self, path):
        super().__init__()
        self.ids, self.links, self.loaded = set(), [], []
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attributes):
        values = dict(attributes)
        self.ids.update(values[name] for name in ("id", "name") if values.get(name))
        if tag == "a" and values.get("href"):
            self.links.append(values["href"])
        elif tag == "link" and values.get("href") and values.get("rel") not in ("index", "search", "next", "prev", "genindex"):
            self.loaded.append(values["href"])
        elif tag in ("script", "img", "source", "iframe") and values.get("src"):
            self.loaded.append(values["src"])


def main(folder):
    root = pathlib.Path(folder).resolve()
    pages = {path: Page(path) for path in sorted(root.rglob("*.html"))}
    faults = []
    count = 0
    for path, page in pages.items():
        where = path.relative_to(root)
        for address, is_loaded in [(a, False) for a in page.links] + [(a, True) for a in page.loaded]:
            parts = urllib.parse.urlsplit(address)
            if parts.scheme or parts.netloc:
                if is_loaded and parts.scheme != "data":
                    faults.append(f"{where}: loads {address} from the network")
                continue
            count += 1
            name = urllib.parse.unquote(parts.path)
            target = pathlib.Path(os.path.normpath(path.parent / name)) if name else path
            anchor = urllib.parse.unquote(parts.fragment)
            if not target.is_file() or root not in target.parents:
                faults.append(f"{where}: {address} is not a file of the site")
            elif anchor and target in pages and anchor not in pages[target].ids:
                faults.append(f"{where}: {address} names an anchor that is not there")
    for path in sorted(root.rglob("*.css")):
        for address in re.findall(r"url\(\s*['\"]?([^)'\"]+)", path.read_text(encoding="utf-8")):
            if not address.startswith(("data:", "#")) and not (path.parent / address.split("?")[0]).is_file():
                faults.append(f"{path.relative_to(root)}: {address} is not a file of the site")
    for fault in faults:
        print(f"docs: {fault}", file=sys.stderr)
    print(f"docs: {len(pages)} pages, {count} links, {len(faults)} faults")
    return 1 if faults or not pages else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
