// Trends that can be read row by row. Without this script, or should it fail, the page shows still pictures.
const LEFT = 46, RIGHT = 10, TOP = 4, BOTTOM = 4, AXIS = 34, HEIGHT = 118;
const FEWEST = 4;
const charts = [];

function html(name, parent, attributes = {}, words = "") {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.textContent = words;
  parent.append(made);
  return made;
}

function draw(name, parent, attributes, words = "") {
  const made = document.createElementNS(document.querySelector("svg").namespaceURI, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.textContent = words;
  parent.append(made);
  return made;
}

function paint(chart) {
  const width = Math.max(chart.plot.clientWidth, 160);
  const x = (time) => LEFT + ((time - view.from) / (view.to - view.from)) * (width - LEFT - RIGHT);
  chart.time = (place) => view.from + ((place - LEFT) / (width - LEFT - RIGHT)) * (view.to - view.from);
  const first = Math.max(row(view.from) - 1, 0), last = Math.min(row(view.to), times.length - 1);
  chart.panels.forEach((panel, index) => {
    const end = index === chart.panels.length - 1;
    const height = HEIGHT + (end ? AXIS : 0), floor = HEIGHT - BOTTOM;
    panel.svg.replaceChildren();
    panel.svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    const [low, high] = range(panel.courses, first, last);
    const y = (value) => Math.round(10 * (floor - ((value - low) / (high - low)) * (floor - TOP))) / 10;
    const inside = draw("svg", panel.svg, { x: LEFT, y: 0, width: width - LEFT - RIGHT, height: HEIGHT });
    inside.setAttribute("viewBox", `${LEFT} 0 ${width - LEFT - RIGHT} ${HEIGHT}`);
    const upright = (time, kind) => draw("line", inside, { x1: x(time), x2: x(time), y1: TOP, y2: floor, class: kind });
    for (const [from, to] of data.flagged) {
      if (to < view.from || from > view.to) continue;
      draw("rect", inside, { x: x(from), y: TOP, width: Math.max(x(to) - x(from), 1), height: floor - TOP, class: "flag" });
    }
    for (const [value, words] of ticks(low, high, 4)) {
      draw("line", inside, { x1: LEFT, x2: width - RIGHT, y1: y(value), y2: y(value), class: "gridline" });
      draw("text", panel.svg, { x: LEFT - 6, y: y(value) + 4, "text-anchor": "end" }, words);
    }
    for (const [time, words] of timeTicks(view.from, view.to, Math.max(3, Math.floor(width / 90)))) {
      upright(time, "gridline");
      if (!end) continue;
      // a word at the right end would leave the picture
      const half = 3.4 * words.length, at = Math.min(x(time), width - half);
      draw("text", panel.svg, { x: at, y: HEIGHT + 11, "text-anchor": "middle" }, words);
    }
    if (end) {
      const words = timeLabel(view.from, view.to);
      draw("text", panel.svg, { x: (LEFT + width - RIGHT) / 2, y: HEIGHT + 28, "text-anchor": "middle" }, words);
    }
    if (low < 0 && high > 0 && chart.name === "residual") {
      draw("line", inside, { x1: LEFT, x2: width - RIGHT, y1: y(0), y2: y(0), class: "zero" });
    }
    data.begins.forEach((time) => upright(time, "begin"));
    if (data.until !== null) upright(data.until, "until");
    // the first stands before the others, but what is left after before what was left before
    const order = chart.name === "residual" ? panel.courses : [...panel.courses].reverse();
    for (const course of order) {
      draw("path", inside, { d: line(course, first, last, x, y), class: `course ${course.colour}` });
    }
    draw("line", panel.svg, { x1: LEFT, x2: LEFT, y1: TOP, y2: floor, class: "axis" });
    panel.over = draw("g", inside, {});
    panel.place = { x, y, floor };
  });
  chart.buttons.whole.disabled = chart.buttons.out.disabled = view.from <= times[0] && view.to >= data.end;
  chart.buttons.earlier.disabled = view.from <= times[0];
  chart.buttons.later.disabled = view.to >= data.end;
  point(chart);
}

// The cursor and the values at it.
function point(chart) {
  const at = view.at;
  const said = [];
  for (const panel of chart.panels) {
    const { x, y, floor } = panel.place;
    panel.over.replaceChildren();
    if (at !== null) {
      draw("line", panel.over, { x1: x(times[at]), x2: x(times[at]), y1: TOP, y2: floor, class: "cursor" });
    }
    panel.courses.forEach((course, k) => {
      const words = at === null ? (course.unit === "1" ? "" : `[${course.unit}]`) : saidAt(course, at);
      panel.values[k].textContent = words;
      if (at === null) return;
      said.push(`${course.name} ${words}`);
      const value = course.values[course.each * at + course.each - 1];
      if (!Number.isNaN(value)) draw("circle", panel.over, { cx: x(times[at]), cy: y(value), r: 3, class: `dot ${course.colour}` });
    });
  }
  chart.clock.textContent = at === null ? "" : `at ${moment(at)}`;
  chart.plot.setAttribute("aria-valuemax", times.length - 1);
  chart.plot.setAttribute("aria-valuenow", at === null ? 0 : at);
  chart.plot.setAttribute("aria-valuetext", at === null ? "no time chosen" : `${moment(at)}: ${said.join(", ")}`);
}

function show(from, to) {
  const whole = data.end - times[0];
  const span = Math.min(Math.max(to - from, (FEWEST * whole) / times.length), whole);
  view.from = Math.min(Math.max(from, times[0]), data.end - span);
  view.to = view.from + span;
  charts.forEach(paint);
}

function zoom(factor, around) {
  const middle = around ?? (view.at === null ? (view.from + view.to) / 2 : times[view.at]);
  show(middle - factor * (middle - view.from), middle + factor * (view.to - middle));
}

function pan(share) {
  const by = share * (view.to - view.from);
  show(view.from + by, view.to + by);
}

function choose(at) {
  view.at = at === null ? null : Math.min(Math.max(at, 0), times.length - 1);
  if (view.at !== null && (times[view.at] < view.from || times[view.at] > view.to)) {
    const half = (view.to - view.from) / 2;
    show(times[view.at] - half, times[view.at] + half);
  } else {
    charts.forEach(point);
  }
}

function step(count) {
  const rows = Math.max(1, Math.round((row(view.to) - row(view.from)) / 200));
  choose(view.at === null ? nearest(count > 0 ? view.from : view.to) : view.at + count * rows);
}

function pressed(event) {
  if (event.altKey || event.ctrlKey || event.metaKey) return;
  const far = event.shiftKey;
  const doing = {
    ArrowRight: () => (far ? pan(0.25) : step(1)),
    ArrowLeft: () => (far ? pan(-0.25) : step(-1)),
    PageDown: () => step(10),
    PageUp: () => step(-10),
    Home: () => choose(nearest(view.from)),
    End: () => choose(nearest(view.to)),
    "+": () => zoom(0.5),
    "=": () => zoom(0.5),
    "-": () => zoom(2),
    Escape: () => show(times[0], data.end),
  }[event.key];
  if (!doing) return;
  event.preventDefault();
  doing();
}

function listen(chart) {
  const { plot } = chart;
  const place = (event) => event.clientX - plot.getBoundingClientRect().left;
  let begun = null;
  const cover = (here) => {
    for (const panel of chart.panels) {
      panel.over.querySelector(".drag")?.remove();
      const { floor } = panel.place;
      if (here !== null) draw("rect", panel.over, { x: Math.min(begun, here), y: TOP, width: Math.abs(here - begun), height: floor - TOP, class: "drag" });
    }
  };
  plot.addEventListener("keydown", pressed);
  plot.addEventListener("focus", () => { if (view.at === null && plot.matches(":focus-visible")) choose(nearest(view.from)); });
  plot.addEventListener("dblclick", () => show(times[0], data.end));
  plot.addEventListener("pointerdown", (event) => {
    if (event.pointerType === "mouse" && event.button === 0) begun = place(event);
    choose(nearest(chart.time(place(event))));
  });
  plot.addEventListener("pointermove", (event) => {
    const here = place(event);
    choose(nearest(Math.min(Math.max(chart.time(here), view.from), view.to)));
    if (begun !== null) cover(here);
  });
  plot.addEventListener("pointerleave", (event) => { if (event.pointerType === "mouse" && begun === null) choose(null); });
  window.addEventListener("pointerup", (event) => {
    if (begun === null) return;
    const [from, to] = [begun, place(event)].sort((a, b) => a - b);
    begun = null;
    cover(null);
    if (to - from > 5) show(chart.time(from), chart.time(to));
  });
  plot.addEventListener("wheel", (event) => {
    if (!event.ctrlKey) return;  // the plain wheel scrolls the page
    event.preventDefault();
    zoom(event.deltaY < 0 ? 0.8 : 1.25, chart.time(place(event)));
  }, { passive: false });
}

function build(figure) {
  const name = figure.dataset.chart;
  if (!data.charts[name]) return;
  const live = document.createElement("div");
  const tools = html("div", live, { class: "tools", role: "group", "aria-label": "zoom" });
  const button = (sign, words, act) => {
    const made = html("button", tools, { type: "button", "aria-label": words, title: words }, sign);
    made.addEventListener("click", act);
    return made;
  };
  const buttons = {
    in: button("+", "zoom in", () => zoom(0.5)),
    out: button("\u2212", "zoom out", () => zoom(2)),
    earlier: button("\u25C0", "earlier", () => pan(-0.5)),
    later: button("\u25B6", "later", () => pan(0.5)),
    whole: button("whole", "whole recording", () => show(times[0], data.end)),
  };
  const clock = html("span", tools, { class: "time" });
  const label = `${figure.dataset.alt}. Arrow keys move the cursor.`;
  const plot = html("div", live, { class: "plot", tabindex: "0", role: "slider", "aria-label": label, "aria-valuemin": "0" });
  const panels = data.charts[name].map((courses) => {
    const legend = html("div", plot, { class: "legend" });
    const values = courses.map((course) => {
      const item = html("span", legend, { class: course.colour });
      html("i", item);
      item.append(`${course.name} `);
      return html("b", item);
    });
    return { courses: courses.map(unpack), values, svg: draw("svg", plot, { "aria-hidden": "true" }) };
  });
  if (!charts.length) {
    const hint = html("p", live, { class: "note hint" }, "Point or tap to read values; drag to zoom, double-click for the whole. ");
    html("span", hint, { class: "keys" }, "Keys: \u2190 \u2192 move, + \u2212 zoom, Shift with \u2190 \u2192 shifts, Esc shows the whole.");
  }
  figure.prepend(live);
  figure.querySelector(".still").hidden = true;
  const chart = { name, plot, panels, buttons, clock };
  charts.push(chart);
  paint(chart);
  listen(chart);
  let width = plot.clientWidth;
  new ResizeObserver(() => {
    if (plot.clientWidth === width) return;
    width = plot.clientWidth;
    paint(chart);
  }).observe(plot);
}

document.querySelectorAll(".trend").forEach(build);
