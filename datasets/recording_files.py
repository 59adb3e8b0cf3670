"""Recordings in files: CSV, Parquet, NPZ and MAT, with every defect told in one line (what, where, what to do)."""

from __future__ import annotations

import csv
import difflib
import os
import warnings
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from ..errors import InputError
from ..files import replacing
from .base import Recording
from .column_roles import AssumptionWarning, guess_columns, quantity, seconds

__all__ = [
    "DEFAULT_TIME",
    "DEFAULT_X",
    "DEFAULT_Y",
    "MINIMUM_ROWS",
    "SUFFIXES",
    "Columns",
    "read_columns",
    "read_recording",
    "write_recording",
]

Floats = NDArray[np.float64]
DEFAULT_TIME = "time_s"
DEFAULT_X = "deflection_rad"
DEFAULT_Y = "torque_nm"
DEFAULTS = {"time": DEFAULT_TIME, "x": DEFAULT_X, "y": DEFAULT_Y}
MINIMUM_ROWS = 8
SUFFIXES = (".csv", ".txt", ".tsv", ".parquet", ".npz", ".mat")
LEAST_SPAN, GREATEST = 1e-30, 1e30
"""Beyond these, squares of accelerations would leave the range of floating-point numbers."""
SEPARATORS = {",": "comma", ";": "semicolon", "\t": "tab"}


@dataclass(frozen=True)
class Columns:
    """Columns of a recording by their role.

    Attributes
    ----------
    names : mapping of str to str
        Name of the column of each role; that of the time is the default one where the file has none.
    time : array, shape (n,)
        s, strictly increasing.
    clock : array, shape (n,)
        The time column as the file has it, in whatever unit.
    roles : mapping of str to array, shape (n,)
        What was asked for; also reached by ``columns[role]``.
    channels : mapping of str to array, shape (n,)
        All further numeric columns by their name.
    notes : list of str
        What had to be assumed of the columns.
    untimed : str
        What had to be assumed of the sample times where the file has none.
    """

    names: Mapping[str, str]
    time: Floats
    clock: Floats
    roles: Mapping[str, Floats]
    channels: Mapping[str, Floats]
    notes: list[str] = field(default_factory=list)
    untimed: str = ""

    def __getitem__(self, role: str) -> Floats:
        return self.roles[role]


def read_recording(
    file: str | os.PathLike[str], x: str | None = None, y: str | None = None, time: str | None = None
) -> Recording:
    """Read one recording; what had to be assumed is in its ``conditions`` under ``"assumed"`` and ``"untimed"``.

    Parameters
    ----------
    file : path
        .csv (comma, semicolon or tab), .parquet, .npz or .mat; a header or names are needed.
    x, y, time : str, optional
        Column names; by default ``deflection_rad``, ``torque_nm`` and ``time_s``, or what :func:`read_columns` finds
        instead.

    Raises
    ------
    InputError
        One line that says what is wrong, where (file, row, column) and what to do.
    """
    columns = read_columns(file, {"x": x, "y": y}, time)
    told = {"assumed": "; ".join(columns.notes), "untimed": columns.untimed}
    conditions = {key: text for key, text in told.items() if text}
    return Recording(
        Path(file).stem, columns.time, columns["x"], columns["y"], channels=columns.channels, conditions=conditions
    )


def read_columns(
    file: str | os.PathLike[str],
    columns: Mapping[str, str | None],
    time: str | None = None,
    companion: bool = False,
) -> Columns:
    """Read chosen columns of a recording.

    A column that is not named, and whose default name the file lacks, is guessed by name and unit; what is assumed is
    warned of (AssumptionWarning). A time column in ms, µs or min by its name is turned into seconds.

    Parameters
    ----------
    file : path
    columns : mapping of str to str or None
        Column name by role, ``x`` or ``y``; the role is also the command line's option, so that messages can name it.
    time : str, optional
        Time column. Where none is named or found samples are numbered.
    companion : bool
        Whether what is named are columns of another file that this one goes with. Those that it lacks are guessed here, and
        left out where none is found or several may be meant; only ``y`` must be there.

    Raises
    ------
    InputError
        As for :func:`read_recording`; also if several columns are equally likely.
    """
    path = Path(file)
    table = _read_table(path)
    asked = {"time": time, **columns}
    if companion:
        asked = {role: name if name in table.names else None for role, name in asked.items()}
    chosen, notes = _chosen_columns(path, table.names, asked, ("time", "x") if companion else ())
    time = chosen.get("time")
    wanted = {role: table.numbers(chosen[role]) for role in columns if role in chosen}
    rows = next(iter(wanted.values())).size
    if rows < MINIMUM_ROWS:
        raise InputError(f"{path}: {rows} rows of data are too few; give a recording of at least {MINIMUM_ROWS}")
    if time is None:
        clock = np.arange(float(rows))
    else:
        clock = table.numbers(time)
        late = np.flatnonzero(np.diff(clock) <= 0.0)
        if late.size:
            k = int(late[0]) + 1
            what = "repeats" if clock[k] == clock[k - 1] else "runs backwards"
            raise InputError(
                f"{path}: {table.place(k)}: time column {time!r} {what} ({clock[k - 1]:.9g} then {clock[k]:.9g}); "
                "sort the rows, or split the file where a new recording begins"
            )
    for role, values in (*wanted.items(), ("time", clock)):
        _require_magnitude(path, chosen.get(role, DEFAULT_TIME), values)
    untimed = ""
    if time is None:
        untimed = f"no column {DEFAULT_TIME}: samples are numbered 0, 1, 2, … s; name the time column with --time"
    elif seconds(time) != 1.0:
        notes.append(f"time column {time!r} is in {quantity(time)[1]}, turned into s")
    for note in notes:
        warnings.warn(f"{path}: {note}", AssumptionWarning, stacklevel=2)
    return Columns(
        {"time": DEFAULT_TIME, **chosen},
        clock if time is None else seconds(time) * clock,
        clock,
        wanted,
        table.other_numbers(set(chosen.values())),
        notes,
        untimed,
    )


def write_recording(path: str | os.PathLike[str], columns: Mapping[str, Floats]) -> None:
    """Write columns of equal length as CSV or Parquet (by the suffix), every bit kept, whole or not at all.

    Raises
    ------
    InputError
        If the suffix is neither .csv nor .parquet.
    """
    target = Path(path)
    if target.suffix.lower() not in (".csv", ".parquet"):
        raise InputError(f"{target}: unknown suffix {target.suffix!r}; name the output .csv or .parquet")
    frame = pd.DataFrame(dict(columns))
    with replacing(target) as temporary:
        if target.suffix.lower() == ".csv":
            # The default writes the shortest text that reads back to the same double.
            frame.to_csv(temporary, index=False, lineterminator="\n")
        else:
            frame.to_parquet(temporary, index=False)


# ---- the kinds of files --------------------------------------------------------------------------------------------


class _Table:
    """Named columns, turned into numbers when asked for, because a bad cell in an unused column harms nobody."""

    def __init__(self, path: Path, columns: Mapping[str, Any], header_line: int = 0, separator: str = "") -> None:
        self.path = path
        self.columns = columns
        self.header_line = header_line
        self.separator = separator

    @property
    def names(self) -> list[str]:
        return list(self.columns)

    def place(self, k: int) -> str:
        """Where sample ``k`` stands, as an editor counts."""
        if not self.separator:
            return f"row {k + 1}"
        # Counted in the file, because a quoted cell may span lines.
        line = end = 0
        for row, (number, _) in enumerate(_csv_lines(self.path, self.separator)):
            line, end = end + 1, number
            if row == k + self.header_line:
                return f"line {line}"
        return f"line {k + self.header_line + 1}"

    def numbers(self, name: str) -> Floats:
        """The column as finite floats."""
        series = pd.Series(self.columns[name])
        if pd.api.types.is_complex_dtype(series.dtype):
            raise InputError(f"{self.path}: column {name!r} is complex; give real numbers")
        if series.dtype.kind in "mM":
            raise InputError(f"{self.path}: column {name!r} holds dates or durations; give numbers, time in seconds")
        values = pd.to_numeric(series, errors="coerce").to_numpy(dtype=np.float64, na_value=np.nan)
        bad = np.flatnonzero(~np.isfinite(values))
        if bad.size:
            k = int(bad[0])
            cell = series.iloc[k]
            told = f" ({bad.size} such rows)" if bad.size > 1 else ""
            if pd.isna(cell) or str(cell).strip() == "":
                what, advice = "is blank or NaN", "fill or remove such rows"
            elif isinstance(cell, str) and cell.strip().lower() not in ("inf", "-inf", "+inf", "infinity", "-infinity"):
                what = f"holds the text {_short(cell)}"
                is_unit = k == 0 and bad.size == 1
                advice = "if that line tells units, remove it" if is_unit else "write a number there"
                if _is_decimal_comma(cell):
                    advice = "write decimals with a point"
            else:
                what, advice = f"is {cell}", "remove such rows"
            raise InputError(f"{self.path}: {self.place(k)}, column {name!r} {what}{told}; {advice}")
        return np.ascontiguousarray(values)

    def other_numbers(self, used: set[str | None]) -> dict[str, Floats]:
        """All further columns that hold finite numbers only."""
        found = {}
        for name in self.columns:
            if name not in used:
                try:
                    found[name] = self.numbers(name)
                except InputError:
                    # A column of text or with gaps is no channel, and nobody asked for it.
                    continue
        return found


def _read_table(path: Path) -> _Table:
    if path.is_dir():
        raise InputError(f"{path}: is a folder; name a file in it")
    if not path.exists():
        near = difflib.get_close_matches(path.name, [p.name for p in path.parent.glob("*")], n=1)
        hint = f"; did you mean {near[0]}?" if near else "; check the path"
        raise InputError(f"{path}: no such file{hint}")
    if path.suffix.lower() not in SUFFIXES:
        raise InputError(f"{path}: unknown suffix {path.suffix!r}; give .csv, .parquet, .npz or .mat")
    if path.stat().st_size == 0:
        raise InputError(f"{path}: the file is empty; give a recording with a header and at least {MINIMUM_ROWS} rows")
    readers = {".parquet": _read_parquet, ".npz": _read_npz, ".mat": _read_mat}
    return readers.get(path.suffix.lower(), _read_csv)(path)


def _read_csv(path: Path) -> _Table:
    header, separator, decimal, skipped = _csv_layout(path)
    try:
        frame = pd.read_csv(
            path, sep=separator, decimal=decimal, encoding="utf-8-sig", skiprows=skipped, header=0, names=header,
            skip_blank_lines=False, skipinitialspace=True, low_memory=False,
        )  # fmt: skip
    except UnicodeDecodeError:
        raise _not_text(path) from None
    except (pd.errors.ParserError, ValueError) as error:
        raise _ragged(path, separator, len(header), error) from None
    # Blank lines at the end are an editor's habit, in between they are missing samples.
    filled = frame.notna().any(axis=1).to_numpy()
    last = int(np.flatnonzero(filled)[-1]) + 1 if filled.any() else 0
    if last == 0:
        raise InputError(f"{path}: there is a header but no data below it; give at least {MINIMUM_ROWS} rows")
    if not isinstance(frame.index, pd.RangeIndex):
        raise _ragged(path, separator, len(header), None)
    return _Table(path, {name: frame[name].iloc[:last] for name in header}, skipped + 1, separator)


def _csv_layout(path: Path) -> tuple[list[str], str, str, int]:
    """Column names, separator, decimal sign and the number of lines above the header."""
    lines = []
    try:
        with open(path, encoding="utf-8-sig", newline="") as stream:
            for line, _ in zip(stream, range(50), strict=False):
                lines.append(line)
    except UnicodeDecodeError:
        raise _not_text(path) from None
    skipped = next((k for k, line in enumerate(lines) if line.strip()), None)
    if skipped is None:
        raise InputError(f"{path}: the file is blank; give a recording with a header and at least {MINIMUM_ROWS} rows")
    separator = max(SEPARATORS, key=lambda s: lines[skipped].count(s))
    header = [name.strip() for name in next(csv.reader([lines[skipped]], delimiter=separator))]
    if all(_is_number(name) for name in header):
        raise InputError(
            f"{path}: line {skipped + 1} holds numbers where the column names should be; "
            f"add a header such as {DEFAULT_TIME},{DEFAULT_X},{DEFAULT_Y}"
        )
    _no_duplicates(path, header)
    header = [name or f"unnamed {k + 1}" for k, name in enumerate(header)]
    cells = [cell for line in lines[skipped + 1 :] for cell in line.strip().split(separator)]
    decimal = "," if separator != "," and any(_is_decimal_comma(cell) for cell in cells) else "."
    return header, separator, decimal, skipped


def _read_parquet(path: Path) -> _Table:
    try:
        frame = pd.read_parquet(path)
    except Exception as error:  # pyarrow raises its own types, and OSError, for damaged files
        raise InputError(f"{path}: not a readable Parquet file ({_first_line(error)}); write it again") from None
    names = [str(name) for name in frame.columns]
    _no_duplicates(path, names)
    return _Table(path, {name: frame.iloc[:, k].reset_index(drop=True) for k, name in enumerate(names)})


def _read_npz(path: Path) -> _Table:
    try:
        with np.load(path, allow_pickle=False) as stored:
            arrays = {name: stored[name] for name in stored.files}
    except Exception:  # zipfile, zlib and numpy each have their own
        raise InputError(f"{path}: not an NPZ file of numeric arrays; write it again with numpy.savez") from None
    return _series(path, arrays)


def _read_mat(path: Path) -> _Table:
    from scipy.io import loadmat

    try:
        arrays = loadmat(path)
    except NotImplementedError:
        raise InputError(f"{path}: MAT version 7.3 (HDF5) is not read; save it in MATLAB with -v7") from None
    except Exception as error:
        raise InputError(
            f"{path}: not a readable MAT file ({_first_line(error)}); save it in MATLAB with -v7"
        ) from None
    return _series(path, {name: values for name, values in arrays.items() if not name.startswith("__")})


def _series(path: Path, arrays: Mapping[str, NDArray[Any]]) -> _Table:
    """The 1-D numeric arrays among ``arrays`` (MATLAB's rows and columns count as 1-D)."""
    found = {}
    for name, values in arrays.items():
        flat = np.squeeze(values)
        if flat.ndim == 1 and flat.dtype.kind in "fiub":
            found[name] = flat
    sizes = {values.size for values in found.values()}
    if len(sizes) > 1:
        told = ", ".join(f"{name} {values.size}" for name, values in found.items())
        raise InputError(f"{path}: its arrays differ in length ({told}); save one recording with equal lengths")
    if not found:
        raise InputError(f"{path}: holds no 1-D numeric array; save columns named {DEFAULT_X}, {DEFAULT_Y}, …")
    return _Table(path, found)


# ---- roles ---------------------------------------------------------------------------------------------------------


def _chosen_columns(
    path: Path, names: list[str], asked: Mapping[str, str | None], dispensable: Collection[str]
) -> tuple[dict[str, str], list[str]]:
    """The column of each role, and what had to be assumed to tell; ``time`` and what is ``dispensable`` is left out where the file has none."""
    known = {role: name or DEFAULTS[role] for role, name in asked.items() if name or DEFAULTS[role] in names}
    for role, name in known.items():
        _require_column(path, names, name, role)
    guessed = guess_columns(path, names, known, [role for role in asked if role not in known], dispensable)
    for role in asked:
        if role not in ("time", *dispensable, *known, *guessed):
            _require_column(path, names, DEFAULTS[role], role)
    if not guessed:
        return known, []
    told = ", ".join(f"{role} is {name!r} ({_unit(role, name)})" for role, name in sorted(guessed.items()))
    options = ", ".join(f"--{role}" for role in sorted(guessed))
    return {**known, **guessed}, [f"assumed that {told}; name other columns with {options}"]


def _unit(role: str, name: str) -> str:
    return quantity(name)[1] or ("no unit in its name, taken as s" if role == "time" else "no unit in its name")


# ---- messages ------------------------------------------------------------------------------------------------------


def _require_column(path: Path, names: list[str], name: str, role: str) -> None:
    if name in names:
        return
    near = difflib.get_close_matches(name, names, n=1, cutoff=0.5)
    hint = f"; did you mean {near[0]!r}?" if near else ";"
    raise InputError(f"{path}: no column {name!r}{hint} it has {', '.join(names)}. Choose with --{role} COLUMN")


def _require_magnitude(path: Path, name: str, values: Floats) -> None:
    greatest = float(np.max(np.abs(values)))
    if greatest > GREATEST:
        raise InputError(f"{path}: column {name!r} reaches {greatest:.3g}, too large to compute with; check its unit")
    span = float(np.ptp(values))
    if 0.0 < span < LEAST_SPAN:
        raise InputError(f"{path}: column {name!r} spans {span:.3g}, too little to compute with; check its unit")


def _no_duplicates(path: Path, names: list[str]) -> None:
    seen: set[str] = set()
    for name in names:
        if name and name in seen:
            raise InputError(f"{path}: two columns are called {name!r}; rename one of them")
        seen.add(name)


def _not_text(path: Path) -> InputError:
    try:
        path.read_bytes().decode("utf-8")
    except UnicodeDecodeError as error:
        line = path.read_bytes()[: error.start].count(b"\n") + 1
        return InputError(f"{path}: line {line} is not UTF-8 text; save the file as CSV in UTF-8")
    return InputError(f"{path}: not UTF-8 text; save the file as CSV in UTF-8")


def _ragged(path: Path, separator: str, width: int, error: Exception | None) -> InputError:
    """Which line has more cells than the header, found only after the fast parser gave up."""
    for number, cells in _csv_lines(path, separator):
        if len(cells) > width:
            return InputError(
                f"{path}: line {number} has {len(cells)} cells where the header has {width} columns; repair that line"
            )
    return InputError(f"{path}: cannot be read as CSV ({_first_line(error)}); save it again as CSV")


def _csv_lines(path: Path, separator: str) -> Iterator[tuple[int, list[str]]]:
    with open(path, encoding="utf-8-sig", newline="") as stream:
        reader = csv.reader(stream, delimiter=separator)
        try:
            for cells in reader:
                yield reader.line_num, cells
        except csv.Error:
            return


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _is_decimal_comma(text: str) -> bool:
    text = text.strip()
    return "," in text and "." not in text and not _is_number(text) and _is_number(text.replace(",", ".", 1))


def _short(text: str) -> str:
    return repr(text if len(text) <= 30 else text[:27] + "...")


def _first_line(error: BaseException | None) -> str:
    return (str(error).strip().splitlines() or [type(error).__name__])[0] if error is not None else "damaged"
