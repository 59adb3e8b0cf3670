"""The report: complete, self-contained, honest about failures, and readable by machines for people."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from html.parser import HTMLParser
from pathlib import Path

import pytest

from hystbench.bench.cli import cli
from hystbench.bench.console import execute
from hystbench.reports import render

VOID = {"meta", "link", "br", "img", "hr", "input", "path", "use"}


class Page(HTMLParser):
    """Collects what the tests ask of a page and checks that elements nest."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.ids: list[str] = []
        self.links: list[str] = []
        self.tables = 0
        self.unlabelled = 0
        self.feed(text)
        assert self.open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = dict(attrs)
        if given.get("id"):
            self.ids.append(given["id"] or "")
        self.links += [v or "" for k, v in attrs if k in ("href", "src", "xlink:href", "srcset", "action")]
        self.tables += tag == "table"
        if tag == "svg":
            self.unlabelled += not (given.get("role") == "img" and given.get("aria-label"))
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.handle_starttag(tag, attrs)
        if tag not in VOID:
            self.open.pop()

    def handle_endtag(self, tag: str) -> None:
        if tag not in VOID:
            assert self.open.pop() == tag


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("report") / "out"
    arguments = ["run", "--quick", "--models", "maxwell-slip,cubic,bouc-wen", "--datasets", "vsa-published"]
    assert execute(cli, [*arguments, "--out", str(out)]) == 0
    return out


@pytest.fixture(scope="module")
def text(run: Path) -> str:
    return (run / "report.html").read_text(encoding="utf-8")


def test_the_page_is_one_file_that_loads_nothing(text: str) -> None:
    page = Page(text)
    assert all(link.startswith(("#", "data:")) for link in page.links)
    assert len(page.ids) == len(set(page.ids))
    assert {link[1:] for link in page.links if link.startswith("#")} <= set(page.ids)
    assert page.unlabelled == 0
    assert page.tables >= 8
    assert len(text) < 5_000_000
    assert not re.search(r"url\((?!#)", text)
    assert "@import" not in text


def test_the_papers_order_holds_and_the_printed_figures_stand_beside_it(run: Path, text: str) -> None:
    import pandas as pd

    table = pd.read_parquet(run / "results.parquet").set_index(["condition", "task", "model"]).sort_index()
    for condition in ("clean", "kalman"):
        torque = table.loc[(condition, "forward")]
        assert torque.loc["maxwell-slip", "rmse"] < torque.loc["cubic", "rmse"] < torque.loc["bouc-wen", "rmse"]
        assert torque.loc["maxwell-slip", "rmse"] < 0.081
        assert torque.loc["maxwell-slip", "max_abs"] < 0.2
        inverse = table.loc[(condition, "inverse"), "rmse"]
        assert inverse["maxwell-slip"] < min(inverse["cubic"], inverse["bouc-wen"])
    for printed in ("0.0810", "0.162", "0.211", "0.0510", "0.243"):
        assert f">{printed}<" in text
    assert text.count("holds under every condition run") == 2


def test_a_broken_order_is_said(run: Path, tmp_path: Path) -> None:
    import pandas as pd

    copy = tmp_path / "copy"
    shutil.copytree(run, copy)
    table = pd.read_parquet(copy / "results.parquet")
    table.loc[(table["model"] == "maxwell-slip") & (table["condition"] == "kalman"), "rmse"] = 9.0
    table.to_parquet(copy / "results.parquet")
    page = render(copy).read_text()
    assert page.count("does not hold under: kalman") == 2


def test_equal_results_make_equal_pages(run: Path, text: str) -> None:
    assert render(run).read_text(encoding="utf-8") == text


def test_failed_and_missing_cells_are_shown_with_their_reason(run: Path, tmp_path: Path) -> None:
    import pandas as pd

    copy = tmp_path / "copy"
    shutil.copytree(run, copy)
    table = pd.read_parquet(copy / "results.parquet")
    hit = (table["model"] == "cubic") & (table["condition"] == "kalman")
    table.loc[hit, ["status", "message"]] = ["failed", "ValueError: <i>odd</i>"]
    table.to_parquet(copy / "results.parquet")
    page = render(copy).read_text()
    assert "Failed cells" in page
    assert "ValueError: &lt;i&gt;odd&lt;/i&gt;" in page
    assert "<i>odd</i>" not in page
    Page(page)


def test_a_page_without_provenance_still_renders(run: Path, tmp_path: Path) -> None:
    shutil.copy(run / "results.parquet", tmp_path)
    Page(render(tmp_path).read_text())


def test_an_empty_folder_is_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert execute(cli, ["report", str(tmp_path)]) == 2
    told = capsys.readouterr().err
    assert told.count("\n") == 1
    assert "hystbench run" in told
    assert list(tmp_path.iterdir()) == []


def relative_luminance(colour: str) -> float:
    values = [
        int(colour[k : k + len(colour) // 3] * (2 if len(colour) == 3 else 1), 16) / 255
        for k in range(0, len(colour), len(colour) // 3)
    ]
    linear = [v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4 for v in values]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def test_text_contrast_is_at_least_wcag_aa_in_light_and_dark(text: str) -> None:
    palettes = re.findall(r":root\{(--ink:[^}]*--alarm-paper:[^}]*)\}", text)
    assert len(palettes) == 2
    for palette in palettes:
        colours = dict(re.findall(r"--([\w-]+):#([0-9a-f]+)", palette))
        for front, back in (
            ("ink", "paper"), ("soft", "paper"), ("ink", "panel"), ("soft", "panel"),
            ("accent", "paper"), ("best-ink", "best"), ("alarm", "alarm-paper"),
        ):  # fmt: skip
            high, low = sorted((relative_luminance(colours[front]), relative_luminance(colours[back])), reverse=True)
            assert (high + 0.05) / (low + 0.05) >= 4.5, (front, back)


def test_each_dataset_has_a_page_with_all_about_it(run: Path, text: str) -> None:
    (page,) = re.findall(r'<section class="page" id="dataset-vsa-published">(.*?)</section>', text, re.DOTALL)
    for heading in ("Loops", "Errors", "Conditions", "Source"):
        assert f"<h3>{heading}</h3>" in page
    digest = json.loads((run / "run.json").read_text())["data"]["vsa-published"]["sha256"]
    assert digest in page
    assert page.count("<figure") == 2
    assert 'href="#dataset-vsa-published"' in text


def test_names_that_come_to_the_same_address_keep_pages_of_their_own(run: Path, tmp_path: Path) -> None:
    import pandas as pd

    table = pd.read_parquet(run / "results.parquet")
    copies = [table.assign(dataset=name) for name in ("a b", "a/b", "<script>")]
    pd.concat(copies).to_parquet(tmp_path / "results.parquet")
    page = Page(render(tmp_path).read_text())
    assert len(page.ids) == len(set(page.ids))
    assert {"dataset-a-b", "dataset-a-b-2", "dataset-script"} <= set(page.ids)


CHROMIUM = next((path for name in ("chromium", "google-chrome", "chrome") if (path := shutil.which(name))), None)


def browse(address: str, folder: Path) -> subprocess.CompletedProcess[str]:
    assert CHROMIUM is not None
    flags = [
        "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
        "--disable-component-update", "--disable-sync", f"--user-data-dir={folder / 'profile'}", "--window-size=1400,1000",
        "--virtual-time-budget=8000", "--dump-dom",
    ]  # fmt: skip
    return subprocess.run([CHROMIUM, *flags, address], capture_output=True, text=True, timeout=120, check=False)


@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on this machine to open the report with")
def test_in_a_browser_an_address_shows_one_datasets_page_and_another_the_overview(run: Path, tmp_path: Path) -> None:
    probe = """<script>
    var errors = [], seen = [];
    window.onerror = function (message) { errors.push(message); };
    function look() {
      seen.push(Array.from(document.querySelectorAll("main>section")).filter(function (s) { return s.offsetParent; }).map(function (s) { return s.id; }));
    }
    window.addEventListener("load", function () {
      look();
      setTimeout(function () { location.hash = "noise"; setTimeout(function () {
        look();
        document.body.insertAdjacentHTML("beforeend", "<pre id=found></pre>");
        document.getElementById("found").textContent = JSON.stringify({errors: errors, seen: seen});
      }, 300); }, 300);
    });
    </script></body>"""
    page = tmp_path / "probe.html"
    page.write_text((run / "report.html").read_text().replace("</body>", probe))
    done = browse(f"{page.as_uri()}#dataset-vsa-published", tmp_path)
    found = re.search(r'<pre id="found">(.*?)</pre>', done.stdout, re.DOTALL)
    assert found, done.stderr[-2000:]
    state = json.loads(found[1])
    assert state["errors"] == []
    assert state["seen"][0] == ["dataset-vsa-published"]
    assert {"headline", "datasets", "noise"} <= set(state["seen"][1])
    assert "dataset-vsa-published" not in state["seen"][1]


@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on this machine to open the report with")
@pytest.mark.parametrize("width", [360, 1280])
def test_in_a_browser_nothing_overflows_and_tables_sort(run: Path, tmp_path: Path, width: int) -> None:
    # The page reports on itself: the probe is added to a copy and its findings are read from the dumped document.
    probe = """<script>
    var errors = []; window.onerror = function (message) { errors.push(message); };
    window.addEventListener("load", function () {
      var frame = document.createElement("iframe");
      frame.style.cssText = "width:WIDTHpx;height:900px;border:0;position:absolute;left:0;top:0";
      frame.srcdoc = document.getElementById("inner").textContent;
      frame.onload = function () {
        var page = frame.contentDocument, head = page.querySelectorAll("#headline-1 thead button")[1];
        function column() { return Array.from(page.querySelectorAll("#headline-1 tbody tr"), function (r) { return parseFloat(r.children[1].dataset.sort); }); }
        head.click(); var up = column(); head.click(); var down = column();
        var stage = page.querySelector("figure.view .stage"), drawing = stage.querySelector("svg");
        function size() { return drawing.getAttribute("viewBox").split(" ").map(Number); }
        function press(key) { stage.dispatchEvent(new frame.contentWindow.KeyboardEvent("keydown", {key: key, bubbles: true})); }
        var sizes = [size()]; ["+", "ArrowRight", "0"].forEach(function (key) { press(key); sizes.push(size()); });
        page.querySelector("figure.view button").click(); sizes.push(size());
        var saved = [];
        frame.contentWindow.HTMLAnchorElement.prototype.click = function () { saved.push(this.download + " " + this.href.slice(0, 5)); };
        page.querySelectorAll("figure.view .tools")[0].querySelectorAll("button").forEach(function (b) { if (b.textContent === "SVG") { b.click(); } });
        document.body.insertAdjacentHTML("beforeend", "<pre id=found></pre>");
        document.getElementById("found").textContent = JSON.stringify({
          overflow: page.documentElement.scrollWidth - page.documentElement.clientWidth, up: up, down: down,
          sort: head.closest("th").getAttribute("aria-sort"), errors: errors, sizes: sizes, saved: saved,
          focusable: stage.tabIndex, unnamed: Array.from(page.querySelectorAll("button")).filter(function (b) { return !(b.getAttribute("aria-label") || b.textContent).trim(); }).length});
      };
      document.body.appendChild(frame);
    });
    </script>""".replace("WIDTH", str(width))
    inner = (run / "report.html").read_text().replace("</script", "<\\/script")
    page = tmp_path / "probe.html"
    page.write_text(
        f'<!doctype html><meta charset="utf-8"><body>{probe}<script type="text/plain" id="inner">{inner}</script>'
    )
    text = page.read_text().replace(
        'document.getElementById("inner").textContent',
        'document.getElementById("inner").textContent.replaceAll("<\\\\/script", "</" + "script")',
    )
    page.write_text(text)
    done = browse(page.as_uri(), tmp_path)
    found = re.search(r'<pre id="found">(.*?)</pre>', done.stdout, re.DOTALL)
    assert found, done.stderr[-2000:]
    state = json.loads(found[1])
    assert state["errors"] == []
    assert state["overflow"] <= 0
    assert state["up"] == sorted(state["up"])
    assert state["down"] == sorted(state["up"], reverse=True)
    assert state["sort"] == "descending"
    whole, zoomed, moved, back, clicked = state["sizes"]
    assert zoomed[2] == pytest.approx(whole[2] / 1.5)
    assert moved[0] == pytest.approx(zoomed[0] + 0.1 * zoomed[2])
    assert back == whole
    assert clicked == pytest.approx(zoomed)
    assert state["saved"] == ["ranking-forward.svg blob:"]
    assert state["focusable"] == 0
    assert state["unnamed"] == 0
