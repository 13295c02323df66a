"""The command line: ``scuro COMMAND …``. Errors become one sentence and an exit code here."""

from __future__ import annotations

import os
import signal
import sys
import time
from collections.abc import Sequence
from importlib import import_module
from types import FrameType

import click

from scuro.errors import ScuroError, SettingsError

STARTED = time.perf_counter()
"""When the process began its work, for the times that commands report."""

COMMANDS = {
    "render": "Render a picture of a file.",
    "view": "Look at files in a window.",
    "serve": "Look at files in browsers.",
    "info": "Say what a file holds.",
    "devices": "List the GPU adapters of this machine.",
    "movie": "Make a film of a file.",
    "compare": "Hold every technique against the reference.",
    "bench": "Measure speed and memory.",
    "make-mesoscale": "Build a cell-scale scene of any size from structures.",
    "save": "Write a scene file: all that a picture depends on.",
}
"""Each command is ``scuro.app.NAME`` and defines ``command``; imported when it is called."""

FAILURE, USAGE, INTERRUPTED, BROKEN_PIPE = 1, 2, 130, 141


class LazyCommands(click.Group):
    """A group that imports a command when it is called, so that ``scuro --help`` is quick."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, name: str) -> click.Command | None:
        if name not in COMMANDS:
            return None
        command: click.Command = import_module(f"scuro.app.{name.replace('-', '_')}").command
        return command

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        if args and args[0] not in COMMANDS and not args[0].startswith("-"):
            from scuro.settings import unknown

            ctx.fail(unknown("command", args[0], COMMANDS))
        return super().resolve_command(ctx, args)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        with formatter.section("Commands"):
            formatter.write_dl(list(COMMANDS.items()))


@click.command(cls=LazyCommands, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="scuro", message="scuro %(version)s")
def cli() -> None:
    """Depth you can see: occlusion and shadows for molecules, cell-scale models, volumes and
    corner-point reservoirs, on any GPU and on none.
    """


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command line and leave the process with its exit code."""
    signal.signal(signal.SIGINT, _interrupt)
    sys.exit(run(arguments))


_interrupted = False


def _interrupt(number: int, frame: FrameType | None) -> None:
    """Ctrl-C; remembered, since modules that are being imported may make another error of it."""
    global _interrupted
    _interrupted = True
    raise KeyboardInterrupt


def run(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; return its exit code. Nothing escapes as a traceback.

    ``SCURO_DEBUG=1`` shows the traceback of an unexpected error.
    """
    try:
        code = cli.main(arguments, prog_name="scuro", standalone_mode=False)
        sys.stdout.flush()
    except click.exceptions.NoArgsIsHelpError as error:
        click.echo(error.format_message(), err=True)
        return USAGE
    except click.UsageError as error:
        return _say(_usage_sentence(error), USAGE)
    except click.ClickException as error:
        return _say(error.format_message(), FAILURE)
    except SettingsError as error:
        return _say(str(error), USAGE)
    except ScuroError as error:
        return _say(str(error), FAILURE)
    except (KeyboardInterrupt, click.Abort):
        return INTERRUPTED
    except BrokenPipeError:
        # the reader of our output has gone; keep Python from complaining when it flushes again
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return BROKEN_PIPE
    except MemoryError:
        return _say("out of memory: lower --size, or show fewer atoms with --select", FAILURE)
    except Exception as error:
        if _interrupted:
            return INTERRUPTED
        if os.environ.get("SCURO_DEBUG"):
            raise
        return _say(
            f"unexpected {type(error).__name__}: {str(error)[:300]} "
            "(a fault of scuro: SCURO_DEBUG=1 shows where)",
            FAILURE,
        )
    return code if isinstance(code, int) else 0


def _usage_sentence(error: click.UsageError) -> str:
    where = error.ctx.command_path if error.ctx else "scuro"
    message = error.format_message().rstrip(".")
    return f"{message}; '{where} --help' lists the options"


def _say(sentence: str, code: int) -> int:
    click.echo(f"scuro: {' '.join(sentence.split())}", err=True)
    return code
