"""Recorded files on this machine: found, checked against their SHA-256 and fetched from their pinned commit."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable, Iterable
from functools import lru_cache
from pathlib import Path
from urllib.parse import quote

from ..errors import InputError
from ..files import replacing
from .base import DatasetUnavailableError
from .catalogue import CatalogueEntry, CatalogueFile, entry

__all__ = ["data_folder", "fetch", "require", "state"]

PUBLISHED = "https://raw.githubusercontent.com"
TIMEOUT = 30
RETRIES = 2


def data_folder() -> Path:
    """``$HYSTBENCH_DATA``, or ``hystbench`` in the platform's folder for user data."""
    named = os.environ.get("HYSTBENCH_DATA")
    if named:
        return Path(named).expanduser()
    import platformdirs

    return Path(platformdirs.user_data_dir("hystbench", appauthor=False))


def state(file: CatalogueFile) -> str:
    """``"present"``, ``"absent"`` or ``"damaged"`` (its SHA-256 is not the catalogue's)."""
    path = data_folder() / file.place
    if not path.is_file():
        return "absent"
    status = path.stat()
    return "present" if _sha256(path, status.st_size, status.st_mtime_ns) == file.sha256 else "damaged"


@lru_cache(maxsize=1024)
def _sha256(path: Path, size: int, modified: int) -> str:
    """Computed once for each version of a file; size and time of change are there to tell versions apart."""
    with open(path, "rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def require(name: str) -> dict[str, Path]:
    """Checked local files of a dataset, by their path in their repository.

    Where two repositories share a path, the repository stands before it.

    Raises
    ------
    DatasetUnavailableError
        If a file is absent; the message says how to get it.
    InputError
        If a file is not what was published.
    """
    wanted = entry(name)
    states = {file: state(file) for file in wanted.files}
    damaged = [file for file, found in states.items() if found == "damaged"]
    if damaged:
        raise InputError(
            f"{data_folder() / damaged[0].place}: its SHA-256 is not the published one; "
            f"`hystbench data fetch {name}` replaces it"
        )
    absent = sum(found == "absent" for found in states.values())
    if absent:
        raise DatasetUnavailableError(
            f"{name}: {absent} of {len(wanted.files)} files are not under {data_folder()}; "
            f"`hystbench data fetch {name}` gets them, or set HYSTBENCH_DATA to where they are"
        )
    return {name: data_folder() / file.place for name, file in wanted.published.items()}


def fetch(
    wanted: CatalogueEntry,
    *,
    accept_licence: bool = False,
    advance: Callable[[CatalogueFile], None] = lambda file: None,
) -> int:
    """Download what is absent or damaged and return the number of files downloaded.

    A file is whole and checked before it takes its place, so an interrupted fetch goes on where it stopped, and what is
    there already needs no network.

    Parameters
    ----------
    wanted : CatalogueEntry
    accept_licence : bool
        Share-alike licences bind what users derive from the data, so they must be accepted.
    advance : callable
        Called with each file that is there.

    Raises
    ------
    InputError
        If the licence is not accepted, or a file cannot be had or is not what was published.
    """
    missing = [file for file in wanted.files if state(file) != "present"]
    if missing and wanted.share_alike and not accept_licence:
        raise InputError(
            f"{wanted.id} is under {wanted.licence}: what you derive from it must carry that licence; "
            "pass --accept-licence to fetch it"
        )
    for file in _in_order(wanted.files, missing):
        if file in missing:
            _download(file)
        advance(file)
    return len(missing)


def _in_order(files: Iterable[CatalogueFile], missing: list[CatalogueFile]) -> list[CatalogueFile]:
    return sorted(files, key=lambda file: file in missing)


def _server() -> str:
    """``$HYSTBENCH_DATA_URL``, a mirror with the same layout, or where the files are published."""
    base = os.environ.get("HYSTBENCH_DATA_URL") or PUBLISHED
    if not base.startswith(("https://", "http://")):
        raise InputError(f"HYSTBENCH_DATA_URL is {base!r}; give an address that begins with https:// or http://")
    return base.rstrip("/")


def _download(file: CatalogueFile) -> None:
    import logging

    import pooch
    import requests

    pooch.get_logger().setLevel(logging.ERROR)
    base = _server()
    url = f"{base}/{quote(str(file.place))}"
    target = data_folder() / file.place
    try:
        # pooch moves the file into place only once its checksum is right. It makes private files, and a data folder may
        # be shared, so the file is handed on with the rights of an ordinary one.
        with replacing(target) as temporary:
            pooch.create(
                path=temporary.parent,
                base_url="",
                registry={temporary.name: f"sha256:{file.sha256}"},
                urls={temporary.name: url},
                retry_if_failed=RETRIES,
            ).fetch(temporary.name, downloader=pooch.HTTPDownloader(timeout=TIMEOUT))
    except requests.HTTPError as error:
        status = error.response.status_code if error.response is not None else "no answer"
        raise InputError(
            f"{url}: the server answered {status}; try again later, or copy the file to {target}"
        ) from None
    except requests.RequestException as error:
        raise InputError(
            f"{url}: cannot be downloaded ({type(error).__name__}); check the network, or copy the file to {target}"
        ) from None
    except ValueError:
        raise InputError(
            f"{url}: what came is not what was published (its SHA-256 differs); nothing was kept, try again later"
        ) from None
