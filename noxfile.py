"""Tasks of the project: `nox -s tests`, `nox -s run`, ... `nox -l` lists them."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

import nox

ROOT = Path(__file__).parent
nox.needs_version = ">=2025.5"
nox.options.default_venv_backend = "uv|virtualenv"
nox.options.sessions = ["lint", "typing", "tests"]
# One thread a process: the runs use processes, and numerical threads beside them only slow each other down.
ENV = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}


def _install(session: nox.Session, *groups: str) -> None:
    arguments = [argument for group in groups for argument in ("--group", group)]
    session.install("-e", ".", *arguments)


def _run_tests(session: nox.Session, *arguments: str) -> None:
    # One process a core, but each compiles what it calls and holds recordings: past four there is little to gain.
    processes = str(min(os.cpu_count() or 1, 4))
    # `python -m pytest` would put this folder on sys.path, where `datasets` would shadow another package.
    session.run(
        "pytest", "--numprocesses", processes, "--dist", "loadscope", *arguments, *session.posargs, env=ENV
    )  # fmt: skip


@nox.session
def tests(session: nox.Session) -> None:
    """The test suite with statement coverage, which must not fall below 90 %."""
    _install(session, "test")
    session.run("coverage", "erase")
    _run_tests(session, "--cov", "--cov-report=term:skip-covered", "--cov-fail-under=90")


@nox.session
def thorough(session: nox.Session) -> None:
    """The test suite with all that `tests` leaves out, which takes almost twice as long."""
    _install(session, "test")
    _run_tests(session, "--thorough")


@nox.session
def lint(session: nox.Session) -> None:
    """Style and formatting."""
    session.install(*nox.project.dependency_groups(nox.project.load_toml("pyproject.toml"), "lint"))
    session.run("ruff", "check", ".")
    session.run("ruff", "format", "--check", ".")


@nox.session
def typing(session: nox.Session) -> None:
    """Static types."""
    _install(session, "typing")
    link = ROOT / ".link" / "hystbench"
    if not link.exists():
        link.parent.mkdir(exist_ok=True)
        link.symlink_to(ROOT, target_is_directory=True)
    session.run("mypy")


@nox.session
def run(session: nox.Session) -> None:
    """The whole benchmark and its report; arguments go to `hystbench run`."""
    session.install(".")
    session.run("hystbench", "run", *(session.posargs or ["--out", "hystbench-report"]))


@nox.session
def paper(session: nox.Session) -> None:
    """The source papers' tables and figures recomputed, and the audit, compared with what is committed."""
    _install(session, "test")
    session.run("hystbench", "paper", *(session.posargs or ["--out", "hystbench-paper"]))
    session.run("pytest", "-k", "paper and expectation")


@nox.session
def blind(session: nox.Session) -> None:
    """The blind check of the diagnosis and its page; arguments go to `hystbench blind`."""
    session.install(".[blind]")
    session.run("hystbench", "blind", *(session.posargs or ["--out", "hystbench-blind"]), env=ENV)


@nox.session
def docs(session: nox.Session) -> None:
    """The documentation in docs/_build/html, each example run, warnings as errors."""
    _install(session, "docs")
    session.run(
        "sphinx-build", "-W", "--keep-going", "-q", "-b", "html", "docs", "docs/_build/html", *session.posargs, env=ENV
    )


@nox.session
def bench(session: nox.Session) -> None:
    """Speed against C kernels (folder HYSTBENCH_ROOF) and other packages; writes docs/speed.md."""
    _install(session, "test")
    # Peers of the side-by-side comparison; where one cannot be installed or imported its row says so.
    for peer in ("openseespy", "sysidentpy"):
        session.install(peer, success_codes=[0, 1, 2])
    result = Path(session.create_tmp()) / "speed.json"
    session.run(
        "pytest", "tests/benchmarks/test_speed.py", "--benchmark-only", f"--benchmark-json={result}", *session.posargs,
        env={**os.environ, **ENV},
    )  # fmt: skip
    session.run("python", "tests/benchmarks/speed_table.py", str(result), "docs/speed.md")


@nox.session
def compare(session: nox.Session) -> None:
    """This tree against another commit, run on one machine: `nox -s compare -- main --models cubic --quick`.

    The first argument is the commit (default: where this branch left main), the others go to both runs.
    """
    arguments = list(session.posargs)
    commit = arguments.pop(0) if arguments and not arguments[0].startswith("-") else ""
    if not commit:
        merge_base = session.run("git", "merge-base", "HEAD", "main", external=True, silent=True)
        commit = str(merge_base).strip()
    work = Path(session.create_tmp())
    tree = work / "base"
    session.run("git", "worktree", "prune", external=True)
    session.run("git", "worktree", "add", "--detach", "--force", str(tree), commit, external=True)
    try:
        # Installed from a copy, not editable: each run must see one tree only, and none leaves anything in this one.
        copy = work / "new"
        shutil.rmtree(copy, ignore_errors=True)
        shutil.copytree(ROOT, copy, ignore=shutil.ignore_patterns(".*", "*.egg-info", "build", "dist", "hystbench-*"))
        for name, source in (("base", tree), ("new", copy)):
            session.install("--reinstall-package" if session.venv_backend == "uv" else "--force-reinstall",
                            *(["hystbench"] if session.venv_backend == "uv" else []), str(source))  # fmt: skip
            out = work / f"{name}-report"
            session.run("hystbench", "run", *(arguments or ["--quick"]), "--fresh", "--out", str(out), env=ENV)
        session.run("hystbench", "compare", str(work / "base-report"), str(work / "new-report"))
    finally:
        session.run("git", "worktree", "remove", "--force", str(tree), external=True)
