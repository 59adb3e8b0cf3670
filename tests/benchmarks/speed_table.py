"""docs/speed.md from what pytest-benchmark measured: python tests/benchmarks/speed_table.py RESULT.json docs/speed.md"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import c_kernels
import peers

TARGET = 2.0


def _table(head: tuple[str, ...], rows: list[tuple[str, ...]]) -> str:
    lines = [head, tuple("---" if k == 0 else "---:" for k in range(len(head))), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines) + "\n"


def _difference(info: dict[str, Any]) -> str:
    value = info.get("difference")
    return "another law" if value is None else f"{value:.1e}" if value == value and value < 1e6 else "diverged"


def render(result: dict[str, Any]) -> str:
    """The page: medians, and ratios to what was measured in the same session."""
    sections: dict[str, list[tuple[dict[str, Any], dict[str, float]]]] = {}
    for benchmark in result["benchmarks"]:
        info = benchmark["extra_info"]
        sections.setdefault(info["section"], []).append((info, benchmark["stats"]))
    machine = result["machine_info"]
    loads = [benchmark["extra_info"]["load"] for benchmark in result["benchmarks"]]
    cpu = machine.get("cpu", {}).get("brand_raw", machine.get("machine", "unknown"))
    parts = [
        "# Speed\n",
        f"Measured on {result['datetime'][:10]} by tests/benchmarks/test_speed.py (`nox -s bench` repeats it) on one core of: {cpu}, Python {machine['python_version']}. "
        "Medians; compilation is never counted. The C kernels were compiled with gcc and run just before each row, "
        "so that both saw the machine under the same load; other work on it disturbs the fastest passes least. "
        f"Load average meanwhile: {min(loads):.1f} to {max(loads):.1f} on {machine['cpu'].get('count', '?')} cores. "
        "Where the last column says 'another law' the kernel computes less than the model and the ratio is only a scale.\n",
    ]
    titles = {
        "c-sines": "Predicting 1e5 samples, three sines (600 reversals)",
        "c-walk": "Predicting 1e5 samples, random walk (50,000 reversals)",
    }
    for section, title in titles.items():
        parts.append(f"## {title}\n")
        reason = c_kernels.missing()
        if section not in sections:
            parts.append(f"Not measured: {reason or 'the benchmark was not run'}.\n")
            continue
        rows = []
        for info, stats in sections[section]:
            least = stats["min"] / info["c_least"]
            rows.append((
                info["row"], f"{1e3 * stats['median']:.2f}", f"{1e9 * stats['median'] / info['samples']:.1f}", info["kernel"],
                f"{1e3 * info['c_median']:.2f}", f"{stats['median'] / info['c_median']:.2f}",
                f"{least:.2f}{'' if least <= TARGET else ' (above 2)'}", _difference(info),
            ))  # fmt: skip
        head = (
            "model",
            "ms",
            "ns/sample",
            "C kernel",
            "C ms",
            "ratio of medians",
            "ratio of minima",
            "largest difference / range",
        )
        parts.append(_table(head, rows))
    plain = {
        "alone": "Models without a C counterpart, 1e5 samples",
        "samples": "Scaling with samples, streamed in blocks of 1e5",
        "operators": "Scaling with operators, 1e5 samples",
        "step": "One `stepper.step` from Python",
        "blocks": "`stepper.steps` from Python, block by block",
        "fit": "Identification",
    }
    for section, title in plain.items():
        if section not in sections:
            continue
        if section == "fit":
            head, rows = ("model", "samples", "s"), [
                (info["row"], f"{info['samples']:,}", f"{stats['median']:.3f}") for info, stats in sections[section]
            ]  # fmt: skip
        elif section == "samples":
            head, rows = ("what", "s", "ns/sample, fastest pass", "peak memory of the process, MB"), [
                (info["row"], f"{stats['median']:.4f}", f"{1e9 * stats['min'] / info['samples']:.1f}",
                 f"{info['peak_mb']:.0f}")
                for info, stats in sections[section]
            ]  # fmt: skip
        else:
            head, rows = ("what", "ms", "ms, fastest pass", "ns/sample, fastest pass"), [
                (info["row"], f"{1e3 * stats['median']:.2f}", f"{1e3 * stats['min']:.2f}",
                 f"{1e9 * stats['min'] / info['samples']:.1f}")
                for info, stats in sections[section]
            ]  # fmt: skip
        parts += [f"## {title}\n", _table(head, rows)]
    rows = [
        (
            info["row"],
            f"{1e3 * stats['median']:.1f}",
            f"{1e9 * stats['median'] / info['samples']:.0f}",
            _difference(info),
        )
        for info, stats in sections.get("peers", [])
    ]
    for package in ("openseespy.opensees", "sysidentpy"):
        reason = peers.missing(package)
        if reason and not any(package.split(".")[0] in row[0].lower() for row in rows):
            rows.append((package, "–", "–", f"not installed here ({reason})"))
    parts += [
        "## Peers, the same laws by other means\n",
        _table(("peer", "ms", "ns/sample", "largest difference to this package / range"), rows),
    ]
    return "\n".join(parts)


if __name__ == "__main__":
    source, target = map(Path, sys.argv[1:])
    target.write_text(render(json.loads(source.read_text(encoding="utf-8"))), encoding="utf-8")
