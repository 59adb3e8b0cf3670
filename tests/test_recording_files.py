"""Recordings in files: what is written reads back bit by bit, and every defect is one line with its place."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.io import savemat

from hystbench.datasets import Recording
from hystbench.datasets.recording_files import MINIMUM_ROWS, read_columns, read_recording, write_recording
from hystbench.errors import InputError

HEADER = "time_s,deflection_rad,torque_nm"
ROWS = [f"0.{k},{k},{2 * k}.5" for k in range(9)]
COLUMNS = {"time_s": 0.1 * np.arange(9), "deflection_rad": np.arange(9.0), "torque_nm": 2.0 * np.arange(9) + 0.5}


def write(folder: Path, *rows: str, name: str = "loop.csv", encoding: str = "utf-8") -> Path:
    path = folder / name
    path.write_bytes("\n".join(rows).encode(encoding))
    return path


def with_row(number: int, text: str) -> list[str]:
    """The good file with its data row ``number`` (from 0, on line number + 2) replaced."""
    return [HEADER, *ROWS[:number], text, *ROWS[number + 1 :]]


def defect(path: Path, **columns: str) -> str:
    with pytest.raises(InputError) as caught:
        read_recording(path, **columns)
    text = str(caught.value)
    assert "\n" not in text
    assert text.startswith(str(path))
    return text


def recording_or_defect(path: Path) -> Recording | str:
    try:
        return read_recording(path)
    except InputError as error:
        return str(error)


finite = st.floats(-1e30, 1e30)


@settings(max_examples=30, deadline=None)
@given(values=st.lists(finite, min_size=2 * MINIMUM_ROWS, max_size=40), suffix=st.sampled_from([".csv", ".parquet"]))
def test_every_finite_float_is_written_and_read_back_bit_by_bit(tmp_path_factory, values, suffix) -> None:
    path = tmp_path_factory.mktemp("bits") / f"a{suffix}"
    n = len(values) // 2
    columns = {
        "time_s": np.arange(float(n)),
        "deflection_rad": np.array(values[:n]),
        "torque_nm": np.array(values[n : 2 * n]),
    }
    assume(all(np.ptp(series) == 0.0 or np.ptp(series) >= 1e-30 for series in columns.values()))
    write_recording(path, columns)
    found = read_recording(path)
    assert found.x.tobytes() == columns["deflection_rad"].tobytes()
    assert found.y.tobytes() == columns["torque_nm"].tobytes()
    assert list(path.parent.iterdir()) == [path]


@pytest.mark.parametrize(
    ("column", "values", "words"),
    [
        ("deflection_rad", [1e31] * 9, "too large"),
        ("torque_nm", [5e-324 * k for k in range(9)], "too little"),
        ("time_s", [1e-200 * k for k in range(9)], "too little"),
    ],
)
def test_figures_that_cannot_be_squared_are_refused(
    column: str, values: list[float], words: str, tmp_path: Path
) -> None:
    frame = pd.DataFrame(COLUMNS)
    frame[column] = values
    frame.to_csv(tmp_path / "loop.csv", index=False)
    text = defect(tmp_path / "loop.csv")
    assert words in text
    assert column in text


@settings(max_examples=60, deadline=None)
@given(
    content=st.one_of(
        st.binary(max_size=300), st.text(alphabet='0123456789.,;\t\n"e-naif \r#', max_size=300).map(str.encode)
    )
)
@pytest.mark.parametrize("start", [b"", f"{HEADER}\n".encode(), "\n".join([HEADER, *ROWS, ""]).encode()])
@pytest.mark.parametrize("suffix", [".csv"])
def test_any_bytes_are_a_recording_or_one_line(tmp_path_factory, start, suffix, content) -> None:
    path = tmp_path_factory.mktemp("any") / f"a{suffix}"
    path.write_bytes(start + content)
    found = recording_or_defect(path)
    if isinstance(found, str):
        assert "\n" not in found
        assert found.startswith(str(path))
    else:
        assert found.x.size >= MINIMUM_ROWS
        assert np.isfinite([found.time, found.x, found.y]).all()
        assert np.all(np.diff(found.time) > 0)


@pytest.mark.parametrize("suffix", [".parquet", ".npz", ".mat"])
@settings(max_examples=25, deadline=None)
@given(data=st.data())
def test_damaged_binary_files_are_one_line(tmp_path_factory, suffix, data) -> None:
    path = tmp_path_factory.mktemp("binary") / f"a{suffix}"
    save(path, COLUMNS)
    whole = bytearray(path.read_bytes())
    cut = data.draw(st.integers(1, len(whole)))
    for _ in range(data.draw(st.integers(0, 4))):
        whole[data.draw(st.integers(0, len(whole) - 1))] = data.draw(st.integers(0, 255))
    path.write_bytes(whole[:cut])
    found = recording_or_defect(path)
    if isinstance(found, str):
        assert "\n" not in found
    else:
        assert np.isfinite([found.time, found.x, found.y]).all()


def save(path: Path, columns: dict[str, np.ndarray]) -> None:
    if path.suffix == ".npz":
        np.savez(path, **columns)
    elif path.suffix == ".mat":
        savemat(path, columns)
    else:
        write_recording(path, columns)


@pytest.mark.parametrize("suffix", [".csv", ".parquet", ".npz", ".mat"])
def test_every_format_gives_the_same_recording(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"bench 1{suffix}"
    save(path, COLUMNS | {"pressure_bar": np.full(9, 3.0)})
    found = read_recording(path)
    assert found.name == "bench 1"
    assert np.array_equal(found.time, COLUMNS["time_s"])
    assert np.array_equal(found.x, COLUMNS["deflection_rad"])
    assert np.array_equal(found.y, COLUMNS["torque_nm"])
    assert set(found.channels) == {"pressure_bar"}


@pytest.mark.parametrize(
    ("separator", "decimal", "encoding", "ending"),
    [
        (",", ".", "utf-8", "\n"),
        (";", ".", "utf-8", "\n"),
        ("\t", ".", "utf-8-sig", "\r\n"),
        (";", ",", "utf-8-sig", "\n"),
    ],
)
def test_spreadsheet_dialects(tmp_path: Path, separator: str, decimal: str, encoding: str, ending: str) -> None:
    lines = [HEADER.replace(",", separator), *(r.replace(",", separator).replace(".", decimal) for r in ROWS)]
    path = tmp_path / "loop.csv"
    path.write_bytes((ending.join(lines) + 3 * ending).encode(encoding))
    assert np.array_equal(read_recording(path).y, COLUMNS["torque_nm"])
    assert np.array_equal(read_recording(path).time, [float(f"0.{k}") for k in range(9)])


def test_columns_are_chosen_by_name_and_the_rest_are_channels(tmp_path: Path) -> None:
    path = write(
        tmp_path, "t,angle,torque,label,gap,temp", *(f"{k},{k},{-k},run,{'' if k == 3 else k},20" for k in range(9))
    )
    found = read_recording(path, x="angle", y="torque", time="t")
    assert np.array_equal(found.y, -np.arange(9.0))
    assert set(found.channels) == {"temp"}, "text and columns with gaps are no channels"
    only_x = read_columns(path, {"x": "angle"}, time="t")
    assert only_x.names == {"time": "t", "x": "angle"}
    assert set(only_x.channels) == {"torque", "temp"}
    assert only_x.notes == []


def test_without_a_time_column_samples_are_numbered_and_that_is_told(tmp_path: Path) -> None:
    path = write(tmp_path, "deflection_rad,torque_nm", *(f"{k},{k}" for k in range(9)))
    found = read_columns(path, {"x": "deflection_rad"})
    assert np.array_equal(found.time, np.arange(9.0))
    assert found.notes == []
    assert "samples are numbered" in found.untimed
    assert "--time" in found.untimed
    assert "'clock'" in defect(path, time="clock")


@pytest.mark.parametrize(
    ("row", "column", "what"),
    [
        ("0.4,,8.5", "deflection_rad", "blank"),
        ("0.4,nan,8.5", "deflection_rad", "NaN"),
        ("0.4,4", "torque_nm", "blank"),
        ("", "deflection_rad", "blank"),
        ("0.4,4,four", "torque_nm", "'four'"),
        ("0.4,inf,8.5", "deflection_rad", "inf"),
        ("0.4,4,-Infinity", "torque_nm", "-inf"),
        ("0.4,1e999,8.5", "deflection_rad", "inf"),
        ('0.4,"4,5",8.5', "deflection_rad", "decimals with a point"),
        ("x,4,8.5", "time_s", "'x'"),
    ],
)
def test_a_bad_cell_is_named_by_line_and_column(tmp_path: Path, row: str, column: str, what: str) -> None:
    text = defect(write(tmp_path, *with_row(4, row)))
    assert "line 6," in text
    assert repr(column) in text
    assert what in text


@pytest.mark.parametrize(
    ("row", "what"), [("0.2,4,8.5", "backwards (0.3 then 0.2)"), ("0.3,4,8.5", "repeats (0.3 then 0.3)")]
)
def test_time_must_increase(tmp_path: Path, row: str, what: str) -> None:
    text = defect(write(tmp_path, *with_row(4, row)))
    assert "line 6:" in text
    assert what in text


def test_lines_are_counted_as_an_editor_does(tmp_path: Path) -> None:
    rows = [f'{k},{k},{k},"two\nlines"' for k in range(3)] + [
        f"{k},{'bad' if k == 5 else k},{k},one" for k in range(3, 9)
    ]
    path = write(tmp_path, "", "", f"{HEADER},note", *rows)
    line = next(k for k, text in enumerate(path.read_text().split("\n"), start=1) if "bad" in text)
    assert f"line {line}," in defect(path)


@pytest.mark.parametrize(
    ("lines", "what"),
    [
        ([HEADER], "no data"),
        (["", " "], "blank"),
        (ROWS, "header"),
        ([HEADER, *ROWS[:7]], "7 rows"),
        (["time_s,torque_nm,torque_nm", *ROWS], "two columns are called 'torque_nm'"),
        (with_row(4, "0.4,4,8.5,1"), "line 6 has 4 cells where the header has 3"),
        ([HEADER, *(f"{row},1" for row in ROWS)], "line 2 has 4 cells"),
        (with_row(4, '0.4,"4,8.5'), "CSV"),
    ],
)
def test_a_file_that_is_no_table(tmp_path: Path, lines: list[str], what: str) -> None:
    assert what in defect(write(tmp_path, *lines))


def test_missing_columns_name_the_nearest_and_the_option(tmp_path: Path) -> None:
    path = write(tmp_path, HEADER, *ROWS)
    text = defect(path, x="deflecton_rad")
    assert "did you mean 'deflection_rad'" in text
    assert "--x" in text
    assert "time_s, deflection_rad, torque_nm" in text
    assert "--y" in defect(path, y="force")


def test_wrong_paths(tmp_path: Path) -> None:
    path = write(tmp_path, HEADER, *ROWS)
    assert "did you mean loop.csv" in defect(tmp_path / "lop.csv")
    assert "no such file" in defect(tmp_path / "nowhere" / "loop.csv")
    assert "folder" in defect(tmp_path)
    assert "'.xlsx'" in defect(path.rename(tmp_path / "loop.xlsx"))
    assert "empty" in defect(write(tmp_path))
    with pytest.raises(InputError, match=r"\.xlsx"):
        write_recording(tmp_path / "out.xlsx", COLUMNS)
    assert not (tmp_path / "out.xlsx").exists()


def test_other_encodings_are_refused_with_the_line(tmp_path: Path) -> None:
    assert "line 3 is not UTF-8" in defect(
        write(tmp_path, f"{HEADER},n", f"{ROWS[0]},a", f"{ROWS[1]},é", encoding="latin-1")
    )
    late = [HEADER + ",n", *(f"{k},{k},{k},{'é' if k == 500 else 'e'}" for k in range(600))]
    assert "line 502 is not UTF-8" in defect(write(tmp_path, *late, encoding="latin-1"))
    assert "UTF-8" in defect(write(tmp_path, HEADER, *ROWS, encoding="utf-16"))


def test_defects_of_npz_files(tmp_path: Path) -> None:
    path = tmp_path / "a.npz"
    np.savez(path, **COLUMNS, extra=np.array([{"pickled": 1}], dtype=object))
    assert "numeric arrays" in defect(path)
    np.savez(path, **{**COLUMNS, "torque_nm": np.arange(8.0)})
    assert "deflection_rad 9, torque_nm 8" in defect(path)
    np.savez(path, note=np.array("no columns"))
    assert "no 1-D numeric array" in defect(path)
    np.savez(path, **{**COLUMNS, "torque_nm": np.where(np.arange(9) == 2, np.nan, 1.0)})
    assert "row 3, column 'torque_nm'" in defect(path)


def test_mat_7_3_is_told_apart(tmp_path: Path) -> None:
    path = tmp_path / "a.mat"
    path.write_bytes(b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM" + b"\x89HDF\r\n\x1a\n".ljust(512, b"\0"))
    assert re.search(r"7\.3.*-v7$", defect(path))


def test_dates_are_not_taken_for_numbers(tmp_path: Path) -> None:
    path = tmp_path / "a.parquet"
    pd.DataFrame(COLUMNS | {"when": pd.date_range("2026-01-01", periods=9, freq="s")}).to_parquet(path)
    assert "dates" in defect(path, time="when")
    assert read_recording(path).channels == {}


def test_a_failed_write_leaves_the_old_file(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    write_recording(path, COLUMNS)
    before = path.read_bytes()
    with pytest.raises(ValueError, match="length"):
        write_recording(path, {"a": np.arange(3.0), "b": np.arange(4.0)})
    assert path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]
