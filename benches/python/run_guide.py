#!/usr/bin/env python3
"""Runs a guide as it is written: its commands, its programs of Python, in an empty folder.

    python benches/python/run_guide.py docs/guide/python.md [--garnet target/release/garnet]

Needs what the page needs. `cargo test` runs the commands of `garnet` in the guides and compares what
they print; this runs the blocks of Python as well, one after the other in one namespace, and the
`sh` blocks that begin with `python`. It ends with 1 at the first that fails.
"""

import argparse
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]


def blocks(text):
    """Kinds and texts of the fenced blocks."""
    kind, lines = None, []
    for line in text.splitlines():
        if line.startswith("```"):
            if kind is None:
                kind, lines = line[3:].strip(), []
            else:
                yield kind, "\n".join(lines)
                kind = None
        elif kind is not None:
            lines.append(line)


def commands(kind, text):
    """The shell commands of a block."""
    lines = text.replace("\\\n", " ").splitlines()
    if kind == "console":
        return [line[2:] for line in lines if line.startswith("$ ")]
    if kind == "sh":
        return [line for line in lines if line.startswith("python ")]
    return []


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("page")
    parser.add_argument("--garnet", default=shutil.which("garnet") or ROOT / "target/release/garnet")
    arguments = parser.parse_args()
    garnet = pathlib.Path(arguments.garnet).resolve()
    text = pathlib.Path(arguments.page).read_text()
    os.environ["PATH"] = os.pathsep.join([str(pathlib.Path(sys.executable).parent), str(garnet.parent), os.environ["PATH"]])
    namespace = {"__name__": "__main__"}
    ran = 0
    with tempfile.TemporaryDirectory() as folder:
        for name in ("models", "benches"):
            os.symlink(ROOT / name, pathlib.Path(folder) / name)
        os.chdir(folder)
        for kind, block in blocks(text):
            for command in commands(kind, block):
                print(f"$ {command}", flush=True)
                if subprocess.run(command, shell=True).returncode:
                    sys.exit("the command failed")
                ran += 1
            if kind == "python":
                print("\n".join(f">>> {line}" for line in block.splitlines()), flush=True)
                exec(compile(block, arguments.page, "exec"), namespace)
                ran += 1
        os.chdir(ROOT)
    print(f"{ran} blocks and commands ran")
    return 0 if ran else 1


if __name__ == "__main__":
    sys.exit(main())
