"""Wells of a restart step: names, kinds and the cells that they are open to."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from scuro.load.reservoir_records import RecordFile, words
from scuro.scene.cornerpoint import Well

_KINDS = {1: "producer", 2: "oil injector", 3: "water injector", 4: "gas injector"}
# places in INTEHEAD of the numbers of wells, connections and items a well, a name, a connection
_WELLS, _CONNECTIONS, _IWEL, _ZWEL, _ICON = 16, 17, 24, 27, 32


def read_wells(records: RecordFile, head: NDArray, first: int, last: int) -> tuple[Well, ...]:
    """The wells of the step whose records are those from ``first`` to ``last``."""
    if len(head) <= _ICON:
        return ()
    count, most, per_well, per_name, per_connection = (
        int(head[n]) for n in (_WELLS, _CONNECTIONS, _IWEL, _ZWEL, _ICON)
    )
    data, connections = (records.array(k, first, last) for k in ("IWEL", "ICON"))
    names = words(records.array("ZWEL", first, last))
    if data is None or connections is None or count <= 0:
        return ()
    if (
        len(data) < count * per_well
        or len(connections) < count * most * per_connection
        or len(names) < count * per_name
        or min(per_well, per_connection - 1, per_name) < 1
    ):
        return ()
    data = data[: count * per_well].reshape(count, per_well)
    cells = connections[: count * most * per_connection].reshape(count, most, per_connection)
    wells = []
    for number in range(count):
        rows = cells[number]
        rows = rows[rows[:, 0] > 0]
        rows = rows[np.argsort(rows[:, 0], kind="stable")]
        kind = _KINDS.get(int(data[number, 6]), "") if per_well > 6 else ""
        wells.append(Well(names[number * per_name], rows[:, 1:4].astype(np.int32) - 1, kind))
    return tuple(wells)
