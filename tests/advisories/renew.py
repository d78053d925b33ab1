#!/usr/bin/env python3
"""Writes `database.jsonl` from a clone of RustSec's advisory database:

    git clone --depth 1 https://github.com/rustsec/advisory-db && python tests/advisories/renew.py advisory-db

One line per advisory about a crate, without those that were withdrawn; the first line says which state of the database it is.
The advisories are in the public domain (CC0-1.0), those taken over from GitHub under CC-BY-4.0.
"""

import json
import pathlib
import subprocess
import sys
import tomllib


def git(clone: str, *arguments: str) -> str:
    return subprocess.run(["git", "-C", clone, *arguments], check=True, capture_output=True, text=True).stdout


def main() -> None:
    clone = sys.argv[1]
    commit, date = git(clone, "log", "-1", "--format=%H %cs").split()
    lines = [{"database": "https://github.com/rustsec/advisory-db", "commit": commit, "date": date}]
    names = git(clone, "ls-tree", "-r", "--name-only", "HEAD", "crates").split("\n")
    for name in sorted(name for name in names if name.endswith(".md")):
        text = git(clone, "show", f"HEAD:{name}")
        head, prose = text.removeprefix("```toml\n").split("\n```", 1)
        told = tomllib.loads(head)
        advisory, versions = told["advisory"], told.get("versions", {})
        if "withdrawn" in advisory:
            continue
        title = next((line[2:].strip() for line in prose.splitlines() if line.startswith("# ")), "")
        line = {"id": advisory["id"], "package": advisory["package"], "title": title}
        line["patched"] = versions.get("patched", [])
        line["unaffected"] = versions.get("unaffected", [])
        if "informational" in advisory:
            line["informational"] = advisory["informational"]
        lines.append(line)
    written = "".join(json.dumps(line, ensure_ascii=False) + "\n" for line in lines)
    pathlib.Path(__file__).with_name("database.jsonl").write_text(written)


if __name__ == "__main__":
    main()
