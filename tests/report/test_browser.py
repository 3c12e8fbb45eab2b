# SPDX-License-Identifier: BSD-3-Clause
"""The page in a real browser: nothing fails, nothing overflows, mouse and keyboard read values."""

from math import cos

import pytest

from sklvalve.report import write_report
from tests.report import examples
from tests.report.browser import NAMES, Browser, Page, executable

pytest.importorskip("jinja2", reason='needs pip install "sklvalve[report]"')
pytest.importorskip("matplotlib", reason='needs pip install "sklvalve[report]"')
pytestmark = pytest.mark.skipif(
    executable() is None, reason=f"needs a Chromium on the path, as one of {', '.join(NAMES)}"
)

EVIL = "<img src=x onerror=alert(1)>"
PLOT = 'document.querySelector("[data-chart=recording] .plot")'


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    with Browser(executable(), str(tmp_path_factory.mktemp("profile"))) as started:
        yield started


@pytest.fixture(scope="module")
def address(tmp_path_factory):
    """A report with long and hostile names in it."""
    made = examples.named()
    made["data"].append({"finding": "gap", "role": "flow", "detail": f"{EVIL} {'x' * 90}"})
    path = tmp_path_factory.mktemp("page") / "report.html"
    write_report(path, examples.diagnosis(made), title=f"FV-101 {EVIL}", source="/".join(["folder"] * 30))
    return path.as_uri()


@pytest.fixture
def page(browser, address, request):
    opened = Page(browser, address, **getattr(request, "param", {"width": 1000}))
    yield opened
    opened.close()


def _middle(page, share=0.5):
    box = page.ask(f"(({{x, y, width, height}}) => [x, y, width, height])({PLOT}.getBoundingClientRect())")
    return box[0] + share * box[2], box[1] + 0.5 * box[3]


def _shown(page):
    page.ask(f"{PLOT}.scrollIntoView({{block: 'center'}})")


def _said(page):
    return page.ask(f"{PLOT}.getAttribute('aria-valuetext')")


def _ticks(page):
    texts = page.ask(
        f"[...{PLOT}.lastElementChild.querySelectorAll('text[text-anchor=middle]')].map(t => t.textContent)"
    )
    return [float(text) for text in texts[:-1]]


@pytest.mark.parametrize(
    "page",
    [{"width": width, "dark": dark} for width in (360, 800, 1400) for dark in (False, True)],
    indirect=True,
    ids=lambda settings: f"{settings['width']}{'-dark' if settings['dark'] else ''}",
)
def test_page_opens_whole_and_asks_for_nothing(page, address):
    assert page.complaints() == []
    assert page.addresses() == {address}
    assert page.ask("document.querySelectorAll('figure svg').length") >= 9
    assert page.ask("document.querySelectorAll('.trend .plot path.course').length") == 9
    assert page.ask("[...document.querySelectorAll('.still')].every(s => s.hidden)")
    width = page.ask("document.documentElement.clientWidth")
    assert page.ask("document.documentElement.scrollWidth") <= width
    wide = (
        "[...document.querySelectorAll('main *, header *')]"
        ".filter(e => e.checkVisibility() && e.getBoundingClientRect().right > innerWidth + 1)"
        ".map(e => e.outerHTML.slice(0, 90))"
    )
    assert page.ask(wide) == []
    spilling = (
        "[...document.querySelectorAll('main *, header *')]"
        ".filter(e => e instanceof HTMLElement && e.checkVisibility() && e.clientWidth)"
        ".filter(e => e.scrollWidth > e.clientWidth + 1)"
        ".filter(e => !['auto', 'scroll'].includes(getComputedStyle(e).overflowX))"
        ".map(e => e.outerHTML.slice(0, 90))"
    )
    assert page.ask(spilling) == []
    assert page.ask("document.querySelectorAll('img').length") == 0


@pytest.mark.parametrize("page", [{"width": 320}, {"width": 360}], indirect=True, ids=("320", "360"))
def test_table_of_errors_stands_whole_on_a_phone(page):
    """It may scroll, but on a phone nothing shows that, and the last column is the one that counts."""
    widths = "[...document.querySelectorAll('.wide:not(.still)')].map(e => [e.scrollWidth, e.clientWidth])"
    ((inner, box),) = page.ask(widths)
    assert inner <= box


def test_ink_stands_out_in_light_and_dark(browser, address):
    for dark, light_is in ((False, "rgb(255, 255, 255)"), (True, "rgb(20, 24, 29)")):
        page = Page(browser, address, 800, dark=dark)
        assert page.ask("getComputedStyle(document.body).backgroundColor") == light_is
        inks = "[...document.querySelectorAll('figure svg text')].map(t => getComputedStyle(t).fill)"
        assert all(_contrast(ink, light_is) >= 4.5 for ink in set(page.ask(inks)))
        if dark:
            page.prefer("dark", "print")
            assert page.ask("getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)"
        page.close()


def _contrast(ink, paper):
    """Ratio of luminances by WCAG 2.1."""
    lights = sorted(_luminance(colour) for colour in (ink, paper))
    return (lights[1] + 0.05) / (lights[0] + 0.05)


def _luminance(colour):
    parts = [float(part) / 255.0 for part in colour[4:-1].split(",")]
    linear = [p / 12.92 if p <= 0.04045 else ((p + 0.055) / 1.055) ** 2.4 for p in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def test_mouse_reads_values_of_the_row_below_it(page):
    _shown(page)
    assert _said(page) == "no time chosen"
    page.move("mouseMoved", *_middle(page))
    words = _said(page)
    time = float(words.split(" s: ")[0])
    assert 1400.0 < time < 1600.0
    # examples.traces: opening follows the command, which is this course
    command = page.ask(f"{PLOT}.querySelector('.legend .other b').textContent")
    assert command.endswith(" %")
    assert abs(float(command[:-2]) - (50.0 - 50.0 * cos(time / 170.0))) < 0.1
    assert f"command {command}" in words
    page.move("mouseMoved", 5.0, 5.0)
    assert _said(page) == "no time chosen"


@pytest.mark.parametrize("page", [{"width": 360}, {"width": 1000}], indirect=True, ids=("360", "1000"))
def test_reading_moves_nothing_on_the_page(page):
    _shown(page)
    height = page.ask("document.documentElement.scrollHeight")
    for share in (0.3, 0.5, 0.9):
        page.move("mouseMoved", *_middle(page, share))
        assert _said(page) != "no time chosen"
        assert page.ask("document.documentElement.scrollHeight") == height


def test_dragging_zooms_all_trends_and_a_double_click_shows_the_whole(page):
    _shown(page)
    before = _ticks(page)
    (left, y), (right, _) = _middle(page, 0.4), _middle(page, 0.6)
    page.move("mouseMoved", left, y)
    page.move("mousePressed", left, y, held=True, clicks=1)
    page.move("mouseMoved", 0.5 * (left + right), y, held=True)
    assert page.ask(f"{PLOT}.querySelectorAll('.drag').length") == 3
    page.move("mouseMoved", right, y, held=True)
    page.move("mouseReleased", right, y, clicks=1)
    after = _ticks(page)
    assert before[0] <= 100.0
    assert before[-1] >= 2500.0
    assert min(after) > 1000.0
    assert max(after) < 2000.0
    other = "document.querySelector('[data-chart=residual] .plot').lastElementChild"
    texts = page.ask(f"[...{other}.querySelectorAll('text[text-anchor=middle]')].map(t => t.textContent)")
    assert [float(text) for text in texts[:-1]] == after
    for clicks in (1, 2):
        page.move("mousePressed", left, y, held=True, clicks=clicks)
        page.move("mouseReleased", left, y, clicks=clicks)
    assert _ticks(page) == before


def test_keyboard_alone_reads_and_zooms(page):
    for _ in range(40):
        page.press("Tab")
        if page.ask(f"document.activeElement === {PLOT}"):
            break
    else:
        pytest.fail("Tab never came to the plot")
    assert _said(page).startswith("0 s: ")
    page.press("ArrowRight")
    first = float(_said(page).split(" s")[0])
    assert first > 0.0
    page.press("End")
    assert _said(page).startswith("2999 s: ")
    page.press("ArrowLeft")
    whole = _ticks(page)
    for _ in range(3):
        page.press("+")
    near = _ticks(page)
    assert near[-1] - near[0] < 0.2 * (whole[-1] - whole[0])
    page.press("ArrowLeft", shift=True)
    assert _ticks(page)[0] < near[0]
    page.press("Escape")
    assert _ticks(page) == whole
    assert page.complaints() == []


def test_buttons_zoom_and_tell_what_they_do(page):
    named = "[...document.querySelectorAll('button')].map(b => b.getAttribute('aria-label'))"
    assert set(page.ask(named)) == {"zoom in", "zoom out", "earlier", "later", "whole recording"}
    button = "document.querySelector('[data-chart=recording] button[aria-label=\"{}\"]')"
    assert page.ask(button.format("zoom out") + ".disabled")
    whole = _ticks(page)
    page.ask(button.format("zoom in") + ".click()")
    assert _ticks(page) != whole
    assert not page.ask(button.format("zoom out") + ".disabled")
    page.ask(button.format("whole recording") + ".click()")
    assert _ticks(page) == whole


def test_page_without_scripts_shows_still_pictures(browser, address):
    page = Page(browser, address, 360, scripts=False)
    page.call("Emulation.setScriptExecutionDisabled", value=False)
    assert page.ask("document.querySelectorAll('.still svg').length") == 2
    assert page.ask("[...document.querySelectorAll('.still')].every(s => s.checkVisibility())")
    assert page.ask("document.documentElement.scrollWidth") <= 360
    page.close()


def test_no_foreign_script_may_run(page):
    foreign = "const s = document.createElement('script'); s.textContent = 'window.ran = 1';"
    page.ask(f"(() => {{ {foreign} document.body.append(s); }})()")
    assert page.ask("window.ran") is None
    assert "Content Security Policy" in str(page.complaints())


def test_long_recording_can_be_read(browser, tmp_path):
    path = tmp_path / "report.html"
    write_report(path, examples.diagnosis(examples.named(), n=86_400))
    page = Page(browser, path.as_uri(), 1000)
    _shown(page)
    page.move("mouseMoved", *_middle(page))
    assert page.complaints() == []
    assert " to " in _said(page), "of many rows in a bucket the lowest and the highest are told"
    page.close()


def test_page_prints(page, tmp_path):
    page.print(tmp_path / "report.pdf")
    assert (tmp_path / "report.pdf").read_bytes().startswith(b"%PDF")


@pytest.mark.parametrize("width", [360, 1000])
def test_times_are_those_of_the_calendar(browser, tmp_path, width):
    made = examples.diagnosis(examples.named())
    made.traces["first_stamp"] = "2024-03-01T23:28:00"
    write_report(tmp_path / "calendar.html", made)
    page = Page(browser, (tmp_path / "calendar.html").as_uri(), width)
    assert page.complaints() == []
    texts = page.ask(
        f"[...{PLOT}.lastElementChild.querySelectorAll('text[text-anchor=middle]')].map(t => t.textContent)"
    )
    # 3000 s from 23:28 on: round times, the date at midnight, both dates below
    assert texts[-1] == "time, 2024-03-01 to 2024-03-02"
    assert "03-02" in texts
    assert all(text.endswith(("0", "5")) for text in texts[:-1] if text != "03-02")
    inside = (
        f"(s => [...s.querySelectorAll('text')].every(t => t.getBoundingClientRect().right <= "
        f"s.getBoundingClientRect().right + 1))({PLOT}.lastElementChild)"
    )
    assert page.ask(inside)
    page.ask(f"{PLOT}.focus()")
    page.press("Home")
    assert _said(page).startswith("2024-03-01 23:28:00: ")
    page.close()


def test_details_open_on_demand(page):
    assert not page.ask("document.querySelector('details').open")
    page.ask("document.querySelector('summary').click()")
    assert page.ask("document.querySelector('details').innerText.includes('Test for any mismatch')")
    width = page.ask("document.documentElement.clientWidth")
    assert page.ask("document.documentElement.scrollWidth") <= width
