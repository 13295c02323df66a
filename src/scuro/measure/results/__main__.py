"""``python -m scuro.measure.results``: measure one topic and write its section of the page."""

from __future__ import annotations

import argparse
import json
import shlex
import sys
from collections.abc import Sequence
from pathlib import Path

from scuro.measure.bench import BenchOptions, label
from scuro.measure.results import topics
from scuro.measure.results.page import replace_section


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure and write the section."""
    known = topics()
    parser = argparse.ArgumentParser(prog="python -m scuro.measure.results")
    parser.add_argument("topic", choices=list(known))
    parser.add_argument("inputs", nargs="*")
    parser.add_argument("-o", "--output", type=Path, default=Path("docs/results.md"))
    parser.add_argument("--size", default="1280x720")
    parser.add_argument("--frames", type=int, default=3)
    parser.add_argument(
        "--measured", type=Path, help="JSON of earlier runs on other inputs, to go on from"
    )
    given = parser.parse_intermixed_args(arguments)
    width, height = (int(part) for part in given.size.split("x"))
    options = BenchOptions(
        tuple(given.inputs), (width, height), given.frames,
        say=lambda text: print(text, file=sys.stderr), measured=given.measured,
    )  # fmt: skip
    topic = known[given.topic]
    paragraphs = list(topic.section(options))
    # the page must not tell of this machine: inputs are named without their folders
    inputs = [label(name) for name in given.inputs]
    if given.measured:
        inputs = list(json.loads(given.measured.read_text("utf-8")))
    command = shlex.join(
        ["python", "-m", "scuro.measure.results", given.topic, *inputs, "--size", given.size]
    )
    order = [module.TITLE for module in known.values()]
    replace_section(given.output, topic.TITLE, command, paragraphs, order)


if __name__ == "__main__":
    main()
