"""Recorded files: fetched from a server that may cheat or fail, checked before use, and never outside their folder."""

from __future__ import annotations

import copy
import hashlib
import json
import os
import threading
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from urllib.parse import unquote

import pytest

from hystbench.datasets import DatasetUnavailableError, catalogue, store
from hystbench.datasets.catalogue import CatalogueEntry, CatalogueFile, parse
from hystbench.errors import InputError

CONTENTS = {"data/first run.csv": b"a,b\n1,2\n", "data/50%20#1.csv": b"x" * 70_000, "notes.txt": b"three"}
DOCUMENT = json.loads(Path(catalogue.__file__).with_name("catalogue.json").read_text(encoding="utf-8"))


def made_of(contents: dict[str, bytes], name: str = "made-up", licence: str = "MIT") -> CatalogueEntry:
    files = tuple(
        CatalogueFile("owner/repo", "0" * 40, path, len(content), hashlib.sha256(content).hexdigest())
        for path, content in contents.items()
    )
    return CatalogueEntry(name, "made up", licence, "nobody", files)


class Server(ThreadingHTTPServer):
    """Serves CONTENTS as raw.githubusercontent.com does; ``faults`` has what is wrong with the next answers."""

    def __init__(self) -> None:
        super().__init__(("127.0.0.1", 0), Answer)
        self.asked: list[str] = []
        self.faults: list[str] = []
        self.always = ""


class Answer(BaseHTTPRequestHandler):
    server: Server

    def do_GET(self) -> None:
        path = unquote(self.path).removeprefix(f"/owner/repo/{'0' * 40}/")
        self.server.asked.append(path)
        fault = self.server.faults.pop(0) if self.server.faults else self.server.always
        content = CONTENTS.get(path)
        if content is None or fault == "missing":
            self.send_error(404)
            return
        if fault == "tampered":
            content = b"?" + content[1:]
        self.send_response(200)
        self.send_header("Content-Length", str(len(content) if fault != "short" else len(content) - 2))
        self.end_headers()
        self.wfile.write(content[:-2] if fault in ("truncated", "short") else content)

    def log_message(self, *arguments: object) -> None:
        """Keep the test's output clean."""


@pytest.fixture
def server(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Server]:
    with Server() as running:
        threading.Thread(target=running.serve_forever, args=(0.01,), daemon=True).start()
        monkeypatch.setenv("HYSTBENCH_DATA", str(tmp_path / "data"))
        monkeypatch.setenv("HYSTBENCH_DATA_URL", f"http://127.0.0.1:{running.server_port}")
        monkeypatch.setattr(store, "RETRIES", 0)
        yield running
        running.shutdown()


@pytest.fixture
def known(monkeypatch: pytest.MonkeyPatch) -> CatalogueEntry:
    """A catalogue of one small dataset."""
    one = made_of(CONTENTS)
    monkeypatch.setattr(catalogue, "catalogue", lambda: {one.id: one})
    return one


def files_under(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_fetched_files_are_whole_in_place_and_not_asked_for_again(server: Server, known: CatalogueEntry) -> None:
    told: list[str] = []
    assert store.fetch(known, advance=lambda file: told.append(file.path)) == 3
    found = store.require(known.id)
    assert {name: path.read_bytes() for name, path in found.items()} == CONTENTS
    for name, path in found.items():
        assert path == store.data_folder() / "owner" / "repo" / ("0" * 40) / name
    assert sorted(told) == sorted(CONTENTS)
    server.asked.clear()
    assert store.fetch(known) == 0
    assert server.asked == []
    assert len(files_under(store.data_folder())) == 3


@pytest.mark.skipif(os.name != "posix", reason="file rights are those of POSIX")
def test_fetched_files_have_the_rights_of_ordinary_files(server: Server, known: CatalogueEntry, tmp_path: Path) -> None:
    store.fetch(known)
    ordinary = tmp_path / "ordinary"
    ordinary.write_text("")
    assert {path.stat().st_mode for path in store.require(known.id).values()} == {ordinary.stat().st_mode}


@pytest.mark.parametrize(
    ("fault", "what"),
    [("missing", "404"), ("tampered", "SHA-256"), ("truncated", "cannot be downloaded"), ("short", "SHA-256")],
)
def test_a_bad_download_is_one_line_and_leaves_nothing(
    server: Server, known: CatalogueEntry, fault: str, what: str
) -> None:
    server.always = fault
    with pytest.raises(InputError, match=what) as caught:
        store.fetch(known)
    assert "\n" not in str(caught.value)
    assert files_under(store.data_folder()) == {}


def test_a_fetch_goes_on_where_it_stopped(server: Server, known: CatalogueEntry) -> None:
    server.faults = ["", "tampered"]
    with pytest.raises(InputError):
        store.fetch(known)
    assert list(files_under(store.data_folder())) == ["first run.csv"]
    server.asked.clear()
    assert store.fetch(known) == 2
    assert sorted(server.asked) == ["data/50%20#1.csv", "notes.txt"]


def test_a_download_that_failed_once_is_tried_again(
    server: Server, known: CatalogueEntry, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(store, "RETRIES", 1)
    server.faults = ["truncated"]
    assert store.fetch(known) == 3
    assert len(server.asked) == 4


def test_an_unreachable_server_and_a_wrong_address(
    server: Server, known: CatalogueEntry, monkeypatch: pytest.MonkeyPatch
) -> None:
    server.shutdown()
    server.server_close()
    with pytest.raises(InputError, match=r"cannot be downloaded.*check the network"):
        store.fetch(known)
    monkeypatch.setenv("HYSTBENCH_DATA_URL", "ftp://example.org")
    with pytest.raises(InputError, match=r"HYSTBENCH_DATA_URL.*https://"):
        store.fetch(known)


def test_absent_and_tampered_files_are_never_handed_out(server: Server, known: CatalogueEntry) -> None:
    with pytest.raises(DatasetUnavailableError, match=r"3 of 3 files.*hystbench data fetch made-up"):
        store.require(known.id)
    store.fetch(known)
    victim = store.require(known.id)["data/50%20#1.csv"]
    before = victim.stat()
    victim.write_bytes(b"y" + CONTENTS["data/50%20#1.csv"][1:])
    # Seen although the size is the same, also when the clock was too coarse to tell: force another time of change.
    os.utime(victim, ns=(before.st_atime_ns, before.st_mtime_ns + 1))
    with pytest.raises(InputError, match=r"50%20#1\.csv.*SHA-256.*hystbench data fetch"):
        store.require(known.id)
    server.asked.clear()
    assert store.fetch(known) == 1
    assert server.asked == ["data/50%20#1.csv"]
    assert victim.read_bytes() == CONTENTS["data/50%20#1.csv"]
    victim.unlink()
    with pytest.raises(DatasetUnavailableError, match="1 of 3 files"):
        store.require(known.id)


def test_share_alike_data_need_acceptance(server: Server) -> None:
    bound = made_of(CONTENTS, licence="CC-BY-SA-4.0")
    with pytest.raises(InputError, match=r"CC-BY-SA-4\.0.*--accept-licence"):
        store.fetch(bound)
    assert server.asked == []
    assert store.fetch(bound, accept_licence=True) == 3


def test_the_data_folder_follows_the_variable_and_has_a_default(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("HYSTBENCH_DATA", str(tmp_path))
    assert store.data_folder() == tmp_path
    monkeypatch.setenv("HYSTBENCH_DATA", "~/recordings")
    assert store.data_folder() == Path.home() / "recordings"
    for unset in ("", None):
        monkeypatch.setenv("HYSTBENCH_DATA", unset) if unset is not None else monkeypatch.delenv("HYSTBENCH_DATA")
        assert store.data_folder().is_absolute()
        assert store.data_folder().name == "hystbench"


def test_a_path_that_two_repositories_share_is_told_apart() -> None:
    one = made_of({"data.csv": b"1", "only.csv": b"2"})
    other = CatalogueFile("another/repo", "1" * 40, "data.csv", 1, one.files[0].sha256)
    both = CatalogueEntry("both", "both", "MIT", "nobody", (*one.files, other))
    assert set(both.published) == {"owner/repo/data.csv", "another/repo/data.csv", "only.csv"}


# ---- the catalogue itself ------------------------------------------------------------------------------------------


def test_the_catalogue_is_complete_and_pinned() -> None:
    entries = catalogue.catalogue()
    assert set(entries) == {
        "cycloidal", "friction-backlash-damper", "mr-damper", "pneumatic-seal", "servo-pendulum", "steel-coupons",
        "timber-walls",
    }  # fmt: skip
    assert {name for name, one in entries.items() if one.share_alike} == {"friction-backlash-damper", "cycloidal"}
    for one in entries.values():
        assert one.citation
        assert one.bytes == sum(file.bytes for file in one.files) > 0
        assert all(url.startswith("https://github.com/") and one.files[0].commit in one.urls[0] for url in one.urls)


def test_the_nearest_dataset_is_named() -> None:
    assert catalogue.entry("mr-damper").id == "mr-damper"
    with pytest.raises(InputError, match="did you mean 'servo-pendulum'"):
        catalogue.entry("servo-pendulm")


@pytest.mark.parametrize(
    "change",
    [
        *({"path": p} for p in ("../x", "/x", "a/../b", "a//b", "a/./b", "", ".", "C:/x", "a\\b", "a\0b", "a\nb", 3)),
        *({"repository": r} for r in ("../x", "owner", "a/b/c", "/a", "a/..", "a/b\n", None)),
        *({"commit": c} for c in ("main", "0" * 39, "0" * 40 + "\n")),
        *({"sha256": s} for s in ("", "0" * 63, "G" * 64)),
        *({"bytes": b} for b in (0, -1, "9", True)),
        {"unknown": 1},
    ],
)
def test_a_file_that_could_leave_its_folder_or_cannot_be_checked_is_refused(change: dict) -> None:
    document = copy.deepcopy(DOCUMENT)
    assert parse(document)
    document["datasets"][2]["files"][1] |= change
    with pytest.raises(InputError, match="catalogue entry"):
        parse(document)


def test_a_malformed_catalogue_is_refused() -> None:
    with pytest.raises(InputError, match="schema"):
        parse({"datasets": []})
    for spoil in (
        lambda datasets: datasets[0].pop("licence"),
        lambda datasets: datasets[0]["files"][0].pop("sha256"),
        lambda datasets: datasets.append(datasets[0]),
        lambda datasets: datasets[0]["files"].append(datasets[0]["files"][0]),
    ):
        document = copy.deepcopy(DOCUMENT)
        spoil(document["datasets"])
        with pytest.raises(InputError, match="catalogue entry"):
            parse(document)


def test_the_files_on_this_machine_are_the_published_ones() -> None:
    folder = os.environ.get("HYSTBENCH_DATA")
    if not folder or not (Path(folder) / "MANIFEST.json").is_file():
        pytest.skip("HYSTBENCH_DATA does not name a folder with the published files and their manifest")
    manifest = json.loads((Path(folder) / "MANIFEST.json").read_text(encoding="utf-8"))
    fields = ("repository", "commit", "path", "bytes", "sha256")
    listed = {(*(item[field] for field in fields), item["licence"]) for item in manifest}
    entries = catalogue.catalogue().values()
    assert {(*(getattr(f, field) for field in fields), one.licence) for one in entries for f in one.files} == listed
    for one in entries:
        for name, path in store.require(one.id).items():
            assert hashlib.sha256(path.read_bytes()).hexdigest() == one.published[name].sha256
