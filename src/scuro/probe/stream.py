"""The probe offered to other programs, such as those of haptic devices."""

from __future__ import annotations

import asyncio
import json
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from scuro.errors import SettingsError


def stream_handler(model: Any) -> Callable[[Any], Any]:
    """Offer the probe to another program over a WebSocket.

    Each message ``{"target": [x, y, z]}`` moves the hand; the answer is :meth:`Probe.state`. An
    empty object asks without moving.
    """

    async def handle(socket: Any) -> None:
        shown = 0.0
        async for message in socket:
            try:
                if model.probe is None:
                    raise SettingsError("there is no probe in the scene")
                values = json.loads(message.data)
                if not isinstance(values, dict):
                    raise ValueError
                target = values.get("target")
                if target is not None:
                    place = np.array(target, np.float64)
                    if place.shape != (3,) or not np.isfinite(place).all():
                        raise ValueError
                    model.probe.move(place)
                    # a device moves a thousand times a second; pictures need a sixtieth of that
                    if time.perf_counter() - shown > 1 / 60:
                        shown = time.perf_counter()
                        model.tell()
                answer = model.probe.state()
            except SettingsError as error:
                answer = {"error": str(error)}
            except (ValueError, TypeError, OverflowError, RecursionError):
                answer = {"error": 'send {"target": [x, y, z]} in ångström'}
            await socket.send_str(json.dumps(answer))
            await asyncio.sleep(0)  # one that sends without end leaves others their turn
        if model.probe is not None:
            model.tell()

    return handle
