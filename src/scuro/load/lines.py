"""Lines of fixed columns, vectorised: all lines of a text as one array of characters."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

WIDTH = 80


class Lines:
    """All lines of a text as one (lines, 80) array of characters, padded with blanks."""

    def __init__(self, data: bytes) -> None:
        if b"\r" in data:
            data = data.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
        codes = np.frombuffer(data, np.uint8)
        ends = np.flatnonzero(codes == ord("\n"))
        if len(ends) == 0 or ends[-1] != len(codes) - 1:
            ends = np.r_[ends, len(codes)]
        starts = np.r_[0, ends[:-1] + 1]
        lengths = np.minimum(ends - starts, WIDTH)
        # padding behind the text lets every line be taken as 80 characters
        padded = np.concatenate([codes, np.full(WIDTH, ord(" "), np.uint8)])
        windows = np.lib.stride_tricks.sliding_window_view(padded, WIDTH)
        self.codes = windows[starts]
        short = np.flatnonzero(lengths < WIDTH)
        beyond = np.arange(WIDTH) >= lengths[short, None]
        self.codes[short] = np.where(beyond, ord(" "), self.codes[short])
        self.record = self.codes[:, :6].copy().view("S6").ravel()

    def of(self, *records: bytes) -> NDArray[np.intp]:
        """Numbers of the lines of these record names (six characters)."""
        found = self.record == records[0]
        for record in records[1:]:
            found |= self.record == record
        return np.flatnonzero(found)

    def atoms(self) -> NDArray[np.intp]:
        """Numbers of the atoms' lines; serials wider than five digits may begin in column 6."""
        return np.flatnonzero(
            (self.codes[:, :4].copy().view("S4").ravel() == b"ATOM") | (self.record == b"HETATM")
        )

    def columns(self, rows: NDArray, first: int, last: int) -> NDArray[np.bytes_]:
        """Columns ``first`` to ``last`` (one-based, inclusive, as the format's guide has them)."""
        part = np.ascontiguousarray(self.codes[rows, first - 1 : last])
        return part.view(f"S{last - first + 1}").ravel()
